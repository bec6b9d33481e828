# SPDX-License-Identifier: MIT
"""What foreign libraries say of a file, warnings too, as errors in one sentence."""

from __future__ import annotations

import contextlib
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from . import _images
from ._errors import FileError
from ._text import plain

_MOST = 1 << 24  # bytes of what libtiff says
RIGHT_ANGLES = "its axes are not at right angles, as voxels are taken to be"


@contextlib.contextmanager
def no_warning(path: Path) -> Iterator[None]:
    """FileError for what ITK only warns of, or libtiff."""
    said: list[str] = []
    is_tiff = path.suffix.lower() in (".tif", ".tiff")

    class Logger(_images.sitk().LoggerBase):  # type: ignore[misc]
        def DisplayWarningText(self, text: str) -> None:  # noqa: N802
            said.append(text)

    logger = Logger()
    before = logger.SetAsGlobalITKLogger()
    try:
        with _libtiff(said) if is_tiff else contextlib.nullcontext():
            yield
    finally:
        before.SetAsGlobalITKLogger()
    if said:
        raise FileError(f"{path}: {reason(RuntimeError(said[0]))}")


@contextlib.contextmanager
def _libtiff(said: list[str]) -> Iterator[None]:
    """Puts into `said` the errors that libtiff writes to the standard error, and nowhere else. ITK goes on after them:
    with the pages before the cut, or with voxels that were never read. Warnings of tags that nobody needs do not
    count."""
    with tempfile.TemporaryFile() as file:
        before = os.dup(2)
        os.dup2(file.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(before, 2)
            os.close(before)
            file.seek(0)
            for line in file.read(_MOST).decode("utf-8", "replace").splitlines():
                if not re.match(r"\w+: ", line):
                    print(plain(line), file=sys.stderr)  # not libtiff's
                elif "Warning" not in line or "IO error" in line:
                    said.append(line)


def unreadable(path: Path, error: OSError) -> FileError:
    return FileError(f"{error.filename or path}: cannot be read: {error.strerror or error}")


_SAID = (  # what SimpleITK's libraries say, and what it means
    (r"bzip2 encoding not available", "it is compressed with bzip2, which is not read here: save it with gzip"),
    (r"couldn't open \"(.*?)\"", "its data file cannot be opened: {}"),
    (r"fread got only|ran out of|hit EOF|premature EOF", "its data end early"),
    (r"couldn't parse three ints", "a data file's name has a %, which NRRD takes for a pattern of names: rename it"),
    (r"Unable to determine ImageIO", "its header is damaged: it is not what its name says"),
    (r"spacing \((.*?)\) invalid", "a spacing is {}, expected lengths above 0"),
    (r"nrrdTypeBlock", "its values are of type block, expected numbers"),
    (r"has a direction vector", "it has spacings and space directions, of which only one may be there"),
    (r"orthonormal", RIGHT_ANGLES),
    (r"unexpected scales in sform", "its sform and its pixdim disagree about how far apart voxels are"),
)


def reason(error: RuntimeError) -> str:
    """What SimpleITK means by its many lines; the last one, without its places in the source, if that is not known."""
    if isinstance(error, RecursionError):
        return "its sequences are nested too deep"
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    for pattern, meaning in _SAID:
        if found := re.search(pattern, str(error)):
            return meaning.format(*found.groups())
    return re.sub(r"^.*(?:ERROR: |\): )|^\[nrrd\] \w+: ", "", lines[-1]) if lines else "not readable"
