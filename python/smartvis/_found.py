# SPDX-License-Identifier: MIT
"""The volumes of a study: which files they are, and whether one has changed since."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from . import _kretz
from ._errors import FileError
from ._files import SUFFIXES

ROWS = "rows"  #: folder of the rows beside a batch's results
SETTINGS = "settings.json"  #: in there, what it was made with
_ENDS = 4096  # bytes of a file's beginning and end that are looked at


def find_files(paths: Sequence[str], out: Path | None = None, tell: Callable[[str], object] = print) -> list[Path]:
    """The files named, and of folders all below them, also behind links, with a suffix of a volume or DICOM's mark. A
    folder's DICOM slices are one volume; one that cannot be read stands for itself, so that it is told. Results of a
    batch, those in `out` and others, are no study: `tell` is told of others. FileError: a path is not there."""
    found: list[Path] = []
    for path in map(Path, paths):
        if not path.exists():
            raise FileError(f"{path}: no such file or folder")
        if not path.is_dir():
            found.append(path)
            continue
        closed: list[Path] = []
        inside = sorted(_below(path, out, tell, closed.append, ()))
        slices = {p.parent for p in inside if _is_slice(p)}
        found += [*closed, *(p for p in inside if p.name.lower().endswith(SUFFIXES) and p.suffix.lower() != ".dcm")]
        found += [part for folder in sorted(slices) for part in _kretz.split(folder)]
    return found


def _below(
    folder: Path, out: Path | None, tell: Callable[[str], object], closed: Callable[[Path], object],
    above: tuple[tuple[int, int], ...],
) -> Iterator[Path]:  # fmt: skip
    """All files. `above`: the folders on the way here, into which a link may lead back."""
    try:
        here = folder.stat()
        inside = sorted(folder.iterdir())
    except OSError:
        closed(folder)
        return
    above = (*above, (here.st_dev, here.st_ino))
    for path in inside:
        if not path.is_dir():
            yield path
            continue
        there = path.stat()
        if (there.st_dev, there.st_ino) in above or (out is not None and out.exists() and path.samefile(out)):
            continue
        if os.path.exists(path / ROWS / SETTINGS):  # no, also where nobody may look
            tell(f"{path}: holds results of a batch, which are left out")
            continue
        yield from _below(path, out, tell, closed, above)


def _is_slice(path: Path) -> bool:
    """DICOM by its suffix, or without one by its content; a DICOMDIR lists others."""
    name = path.name.lower()
    if name.endswith(SUFFIXES) or name == "dicomdir":
        return name.endswith(".dcm")
    return path.is_file() and _kretz.is_dicom(path)


def state_of(path: Path) -> str:
    """Another text when a file is another one, its data file, or one of a folder's slices. "": it cannot be told."""
    state = hashlib.sha256()
    try:
        for part in _parts(path):
            facts = part.stat()
            state.update(repr((part.name, facts.st_size, facts.st_mtime_ns)).encode())
            with open(part, "rb") as file:
                state.update(file.read(_ENDS))
                file.seek(max(facts.st_size - _ENDS, 0))
                state.update(file.read(_ENDS))
    except OSError:
        return ""
    return state.hexdigest()


def _parts(path: Path) -> list[Path]:
    """The files that a volume is made of. A header names its data, or has a pattern for their names."""
    if path.is_dir():
        return sorted(part for part in path.iterdir() if part.is_file())
    if path.suffix.lower() not in (".mhd", ".nhdr") or not path.is_file():
        return [path] if path.is_file() else []
    with open(path, "rb") as file:
        header = file.read(1 << 20)
    beside = sorted(part for part in path.parent.iterdir() if part.is_file() and part != path)
    return [path, *(part for part in beside if b"%" in header or os.fsencode(part.name) in header)]
