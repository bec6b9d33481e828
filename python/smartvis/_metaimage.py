# SPDX-License-Identifier: MIT
"""The MetaImage files that host_sim writes and reads. For files of others there is SimpleITK."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from ._errors import SmartVisError

_TYPES: dict[str, np.dtype[Any]] = {
    "MET_UCHAR": np.dtype("u1"),
    "MET_USHORT": np.dtype("<u2"),
    "MET_FLOAT": np.dtype("<f4"),
}


_FOURTH = {"ElementSpacing": "1", "Offset": "0", "CenterOfRotation": "0"}  # of the axis that counts volumes


def read(path: Path) -> tuple[NDArray[Any], tuple[float, ...]]:
    """Voxels [z, y, x], of a map [1, y, x], and the spacing x, y, z in mm of a .mha file that host_sim wrote."""
    raw = path.read_bytes()
    marker = raw.find(b"ElementDataFile = LOCAL\n")
    if marker < 0:
        raise SmartVisError(f"{path}: no 'ElementDataFile = LOCAL'")
    fields = dict(line.split(" = ", 1) for line in raw[:marker].decode("ascii").splitlines())
    data = raw[marker + len(b"ElementDataFile = LOCAL\n") :]
    if fields.get("CompressedData") == "True":
        data = zlib.decompress(data)
    if fields["ElementType"] not in _TYPES:
        raise SmartVisError(f"{path}: ElementType is '{fields['ElementType']}', expected one of {', '.join(_TYPES)}")
    shape = [int(n) for n in fields["DimSize"].split()][::-1]
    spacing = tuple(float(s) for s in fields["ElementSpacing"].split())
    return np.frombuffer(data, _TYPES[fields["ElementType"]]).reshape(shape).copy(), spacing


def say_probe(path: Path, side: str, apex: tuple[float, ...] | None) -> None:
    """Writes into a .mha file at which side the probe was, as PLUS does, and where the lines met that scanned it."""
    letters = ["U", "A"]  # the first axis as "M" would make PLUS' constant, which says nothing
    letters.insert("xyz".index(side[1]), "F" if side[0] == "-" else "N")
    lines = [f"UltrasoundImageOrientation = {''.join(letters)}"]
    lines += [f"UltrasoundApex = {' '.join(map(repr, apex))}"] if apex else []
    head, last, voxels = path.read_bytes().partition(b"\nElementDataFile")
    path.write_bytes(b"\n".join([head, *(line.encode() for line in lines)]) + last + voxels)


def _header(path: Path) -> tuple[dict[str, str], bytes]:
    """The fields of a .mha file that ITK wrote, in their order, and its voxels."""
    head, _, voxels = path.read_bytes().partition(b"ElementDataFile = LOCAL\n")
    fields = dict(line.split(" = ", 1) for line in head.decode(errors="surrogateescape").splitlines())
    fields.pop("CompressedDataSize", None)
    return fields, zlib.decompress(voxels) if fields.pop("CompressedData", "") == "True" else voxels


class Joined:
    """Volumes, each a .mha file that ITK wrote, as one of four dimensions: what is said of them has to be the same."""

    def __init__(self, file: BinaryIO, count: int) -> None:
        self._file, self._count = file, count
        self._fields: dict[str, str] = {}

    def add(self, path: Path) -> bool:
        """The next volume; False: it is no further one of the same."""
        fields, voxels = _header(path)
        if not self._fields:
            self._fields = fields
            self._file.write(self._head().encode(errors="surrogateescape"))
        if fields != self._fields:
            return False
        self._file.write(voxels)
        return True

    def _head(self) -> str:
        more = {"NDims": "4", "DimSize": f"{self._fields['DimSize']} {self._count}"}
        more |= {key: f"{self._fields[key]} {end}" for key, end in _FOURTH.items() if key in self._fields}
        axes = self._fields.get("TransformMatrix", "").split()
        if axes:
            rows = [*(" ".join([*axes[at : at + 3], "0"]) for at in (0, 3, 6)), "0 0 0 1"]
            more["TransformMatrix"] = " ".join(rows)
        lines = [f"{key} = {value}\n" for key, value in (self._fields | more).items()]
        return "".join([*lines, "ElementDataFile = LOCAL\n"])


def write(path: Path, values: NDArray[Any], spacing: tuple[float, ...] = (1.0, 1.0, 1.0)) -> None:
    """A volume [z, y, x] or a map [y, x] of one of these types as the host reads it."""
    types = {dtype: name for name, dtype in _TYPES.items()}
    size = " ".join(str(n) for n in (*values.shape[::-1], 1)[:3])
    header = (
        f"ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = {size}\nElementType = {types[values.dtype]}\n"
        f"ElementSpacing = {' '.join(repr(float(s)) for s in spacing)}\nElementDataFile = LOCAL\n"
    )
    path.write_bytes(header.encode() + np.ascontiguousarray(values).tobytes())
