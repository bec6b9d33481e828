# SPDX-License-Identifier: MIT
"""What DICOM says of its pixels, where SimpleITK takes them otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._errors import FileError

_RLE = "1.2.840.10008.1.2.5"
_NEUTRAL = 128  # of YBR_FULL's colours


class Table(NamedTuple):
    """A modality look-up table: the values of the pixels `first`, `first` + 1, ..."""

    first: int
    values: tuple[int, ...]


def table_of(data: Any, path: Path) -> Table | None:
    """Of a file's header; FileError: it is damaged."""
    items = data.get("ModalityLUTSequence")
    if not items:
        return None
    try:
        count, first, _ = items[0].LUTDescriptor
        values = items[0].LUTData
        if isinstance(values, bytes):
            order = "<" if data.file_meta.TransferSyntaxUID.is_little_endian else ">"
            values = np.frombuffer(values, f"{order}u2")
        values = tuple(int(value) for value in values)[: count or 1 << 16]
    except (AttributeError, ValueError, TypeError):
        values, first, count = (), 0, 0
    if not values or (count and len(values) != count):
        raise FileError(f"{path}: its modality look-up table is damaged")
    return Table(int(first), values)


def by_table(voxels: NDArray[Any], tables: Sequence[Table | None], path: Path) -> NDArray[Any]:
    """What the pixels stand for; the voxels if there is no table. FileError: the pictures have several."""
    table = tables[0]
    if any(other != table for other in tables):
        raise FileError(f"{path}: its modality look-up tables differ from picture to picture")
    if table is None:
        return voxels
    values = np.array(table.values, np.uint16)
    return values[np.clip(voxels.astype(np.int64) - table.first, 0, len(values) - 1)]


def grey_of_planes(path: Path) -> NDArray[Any] | None:
    """Grey in three channels whose planes were packed as if they were pixels, as pydicom 3 packs PlanarConfiguration 1
    by RLE: [z, y, x]. None: the file is no such."""
    pydicom = _images.pydicom()
    data = pydicom.dcmread(path, stop_before_pixels=True)
    if data.file_meta.get("TransferSyntaxUID") != _RLE or data.get("PlanarConfiguration") != 1:
        return None
    try:
        raw = _images.pydicom(".pixels").pixel_array(path, raw=True)
        planes = raw.reshape(-1, 3, data.Rows, data.Columns)
    except (ValueError, RuntimeError, AttributeError, NotImplementedError):
        return None
    is_ybr = data.get("PhotometricInterpretation") == "YBR_FULL"
    same = np.array(_NEUTRAL) if is_ybr else planes[:, :1]
    return planes[:, 0] if (planes[:, 1:] == same).all() else None
