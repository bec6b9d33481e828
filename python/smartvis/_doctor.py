# SPDX-License-Identifier: MIT
"""What ``smartvis doctor`` tells: Python's own part of an installation, then all that ``host_sim verify`` finds."""

from __future__ import annotations

import base64
import hashlib
import platform
from collections.abc import Iterator
from importlib import metadata

from . import _host
from ._errors import SmartVisError
from ._plugin import load
from ._version import FULL

#: What reads files, draws and computes, by the names of their distributions.
LIBRARIES = ("numpy", "scipy", "SimpleITK", "scikit-image", "tifffile", "pydicom", "pyigtl", "distributed")


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def changed_files() -> tuple[int, list[str]]:
    """How many files of the installed package have a sum, and which of them are missing or not as installed."""
    try:
        files = metadata.distribution("smartvis").files or []
    except metadata.PackageNotFoundError:
        return 0, []
    summed = [file for file in files if file.hash is not None and file.hash.mode == "sha256"]
    return len(summed), [str(file) for file in summed if not _is_whole(file)]


def _is_whole(file: metadata.PackagePath) -> bool:
    try:
        found = hashlib.sha256(file.read_binary()).digest()
    except OSError:
        return False
    return file.hash is not None and base64.urlsafe_b64encode(found).decode().rstrip("=") == file.hash.value


def facts() -> Iterator[tuple[str, str, str]]:
    """Rows as those of host_sim: what, how it stands, details."""
    yield "Python", "is", f"{platform.python_version()} on {platform.platform()}; smartvis {FULL}"
    yield "Libraries", "is", ", ".join(f"{name} {_version(name)}" for name in LIBRARIES)
    count, changed = changed_files()
    if count == 0:
        yield "Package", "not asked", "no sums: it was not installed"
    elif changed:
        yield "Package", "FAILS", f"{len(changed)} of {count} files are not what was installed; {changed[0]}"
    else:
        yield "Package", "holds", f"{count} of {count} files are what was installed"
    try:
        yield "Python's plugin", "holds", str(load().path)
    except SmartVisError as error:
        yield "Python's plugin", "FAILS", str(error)


def verify(arguments: list[str]) -> int:
    """Runs ``host_sim verify``, which prints by itself; returns its exit code."""
    return _host.call(["verify", *arguments])
