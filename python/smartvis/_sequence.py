# SPDX-License-Identifier: MIT
"""Sequences as one NRRD, as 3D Slicer writes and reads them: three axes of space, and a list."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from . import _images
from ._errors import FileError

SUFFIX = ".seq.nrrd"
_TYPES = {"u1": "uint8", "i1": "int8", "u2": "uint16", "i2": "int16", "u4": "uint32", "i4": "int32", "u8": "uint64"}
_TYPES |= {"i8": "int64", "f4": "float", "f8": "double"}


class Writer:
    """Volumes one after the other; the file is there under its name when all of `count` are."""

    def __init__(self, path: Path, count: int) -> None:
        self.path = path
        self._count = count
        self._done = 0
        self._part = path.with_name(f".part-{path.name}")
        self._file: BinaryIO | None = None
        self._form: tuple[Any, ...] = ()

    def add(self, image: Any) -> None:
        """The next volume. OSError; FileError: it has another size, type or place than the first."""
        voxels = _images.array(image)
        form = (voxels.shape, voxels.dtype.str, image.GetSpacing(), image.GetOrigin(), image.GetDirection())
        if self._file is None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(self._part, "wb")  # noqa: SIM115  # closed by `close`
            self._form = form
            self._file.write(_header(image, voxels, self._count).encode())
        if form != self._form:
            raise FileError(f"{self.path}: volumes of one sequence differ in size, type or place")
        self._file.write(np.ascontiguousarray(voxels, voxels.dtype.newbyteorder("<")).tobytes())
        self._done += 1

    def close(self) -> bool:
        """Names the file, or removes it where volumes are missing: False then."""
        if self._file is not None:
            self._file.close()
        if self._done == self._count:
            self._part.replace(self.path)
            return True
        with contextlib.suppress(OSError):
            self._part.unlink()
        return False


def _header(image: Any, voxels: Any, count: int) -> str:
    size = " ".join(str(n) for n in (*image.GetSize(), count))
    lines = ["NRRD0005", f"type: {_TYPES[voxels.dtype.str[1:]]}", "dimension: 4", f"sizes: {size}"]
    lines += ["kinds: domain domain domain list", "endian: little", "encoding: raw"]
    if _images.says_spacing(image):
        axes = np.reshape(image.GetDirection(), (3, 3)) * np.array(image.GetSpacing())
        vectors = " ".join(f"({','.join(repr(float(part)) for part in axes[:, axis])})" for axis in range(3))
        origin = ",".join(repr(float(part)) for part in image.GetOrigin())
        # Any other space 3D Slicer's reader of sequences would take for one that looks the other way.
        lines += ["space: left-posterior-superior", f"space directions: {vectors} none", f"space origin: ({origin})"]
    if image.HasMetaDataKey(_images.PLACE):
        lines.append(f"{_images.FILE_NOTES}:={_images.UNPLACED}")
    return "\n".join([*lines, "", ""])
