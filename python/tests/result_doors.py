# SPDX-License-Identifier: MIT
"""The doors that write a clipped volume into a file: each takes a scan, a folder of its own and a suffix, and returns
the file. For the tests, and for `make peers`."""

from collections.abc import Callable, Iterator
from pathlib import Path

import smartvis
from smartvis import _host, slicer
from smartvis._files import stem
from smartvis._rows import folder_of
from smartvis.cli import main

SUFFIXES = (".mha", ".nrrd", ".nii.gz")


def ended(code: int) -> None:
    """Of a command: well."""
    assert code == 0, f"exit code {code}"


def by_clip(scan: Path, folder: Path, suffix: str) -> Path:
    ended(main(["clip", str(scan), "--out", str(folder), "--write", "clipped", "--format", suffix]))
    return folder / f"{stem(scan)}_clipped{suffix}"


def by_batch(scan: Path, folder: Path, suffix: str) -> Path:
    ended(main(["batch", str(scan), "--out", str(folder), "--write", "clipped", "--format", suffix, "--workers", "1"]))
    return folder_of(folder, scan) / f"{stem(scan)}_clipped{suffix}"


def by_save(scan: Path, folder: Path, suffix: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return smartvis.clip(scan).save(folder / f"clipped{suffix}")[0]


def by_module(scan: Path, folder: Path, suffix: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    ended(slicer.main([str(scan), "--clipped", str(folder / f"clipped{suffix}")]))
    return folder / f"clipped{suffix}"


def by_host(scan: Path, folder: Path, suffix: str) -> Path:
    few = ["--frames", "1", "--few-pictures", "--picture", "32", "--setting", "smartvis", "--write", "clipped"]
    _host.run(["run", "--volume", str(scan), *few, "--out", str(folder)])
    return folder / "clipped.mha"


def takes(name: str, scan: Path, suffix: str) -> bool:
    """The machine reads and writes MetaImage."""
    return name != "run" or scan.suffix == suffix == ".mha"


DOORS: dict[str, Callable[[Path, Path, str], Path]] = {
    "clip": by_clip, "batch": by_batch, "save": by_save, "module": by_module, "run": by_host,
}  # fmt: skip


def through(scan: Path, folder: Path) -> Iterator[tuple[str, str, Path]]:
    """Every door that takes the scan, with every suffix that it writes, and the file."""
    for name, door in DOORS.items():
        for suffix in SUFFIXES:
            if takes(name, scan, suffix):
                yield name, suffix, door(scan, folder / f"{name}{suffix}", suffix)
