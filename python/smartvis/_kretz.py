# SPDX-License-Identifier: MIT
"""Kretz volumes, bare or in DICOM. Only host_sim reads them: it hands over its Cartesian copy, whose note
leads the library of `_seen` to the samples."""

from __future__ import annotations

import mmap
import os
import re
import tempfile
from pathlib import Path
from typing import Any

from . import _host, _images

SUFFIXES = (".vol", ".v00", ".v01", ".v02", ".v03", ".v04", ".v05")
_MAGIC = b"KRETZFILE 1.0   "


def is_one(path: Path) -> bool:
    """True for a file that host_sim reads or refuses: a Kretz file by name or content, and DICOM with such bytes."""
    return path.suffix.lower() in SUFFIXES or _begins(path, 0, _MAGIC) or _is_wrapped(path)


def split(folder: Path) -> list[Path]:
    """The Kretz volumes in DICOM of a folder, and the folder itself if it holds other DICOM or nothing of that."""
    inside = sorted(folder.iterdir()) if os.access(folder, os.R_OK | os.X_OK) else []
    dicom = [path for path in inside if path.is_file() and is_dicom(path)]
    whole = [path for path in dicom if _is_wrapped(path)]
    return whole if whole and len(whole) == len(dicom) else [*whole, folder]


def _begins(path: Path, at: int, mark: bytes) -> bool:
    if not os.access(path, os.R_OK):
        return False  # who reads it then says why not
    with open(path, "rb") as file:
        file.seek(at)
        return file.read(len(mark)) == mark


def is_dicom(path: Path) -> bool:
    """True for a DICOM file that can be read."""
    return _begins(path, 128, b"DICM")


def _is_wrapped(path: Path) -> bool:
    if not is_dicom(path):
        return False
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        return content.find(_MAGIC) >= 0


def read(path: Path, number: int, mirror: bool) -> tuple[Any, int]:
    """Volume `number` as a SimpleITK image, and how many there are. HostError with the host's reason."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy.mha"
        options = ["--mirror"] if mirror else []
        said = _host.run(["info", *options, "--number", str(number + 1), "--cartesian", str(copy), "--", str(path)])
        image = _images.sitk().ReadImage(str(copy))
    image.SetMetaData(_images.KRETZ, f"{number} {int(mirror)} {os.path.abspath(path)}")
    count = re.search(r"^  a sequence of (\d+) volumes", said, re.MULTILINE)
    return image, int(count[1]) if count else 1
