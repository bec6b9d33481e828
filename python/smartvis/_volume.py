# SPDX-License-Identifier: MIT
"""What callers say of their volumes, checked: windows, masks, maps of what was scanned."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _images
from ._seen import Levels

Shape = tuple[int, int, int]


@dataclass(frozen=True)
class Given:
    """A volume as it was given, with what it says of itself."""

    source: Any
    voxels: NDArray[Any]  #: [z, y, x]
    mask: NDArray[np.bool_] | None = None  #: True where numpy's mask hides nothing; None: it hides nothing anywhere
    spacing: tuple[float, float, float] | None = None
    directions: Sequence[float] | None = None
    kretz: tuple[str, int, bool] | None = None  #: see _images.kretz
    said: _images.Said = _images.NOTHING_SAID


def given(volume: Any) -> Given:
    """An array, a SimpleITK image or a file's name. ValueError: it is no volume."""
    if isinstance(volume, Given):
        return volume
    if isinstance(volume, (str, os.PathLike)):
        from ._files import Source

        volume = Source(volume).only()
    if _images.is_image(volume):
        _images.check_unit(volume)
        spacing = volume.GetSpacing() if _images.says_spacing(volume) else None
        what = (spacing, volume.GetDirection(), _images.kretz(volume), _images.said(volume))
        return Given(volume, _images.array(volume), None, *what)
    voxels, mask = volume, None
    if isinstance(volume, np.ma.MaskedArray):
        mask = ~np.ma.getmaskarray(volume) if np.ma.is_masked(volume) else None
        voxels = volume.filled(volume.max())  # which is nowhere taken for what lies outside
    voxels = np.asarray(voxels)
    if voxels.ndim != 3 or 0 in voxels.shape:
        raise ValueError(f"the volume has shape {voxels.shape}, expected [z, y, x]")
    return Given(volume, voxels, mask)


def to_uint8(volume: NDArray[Any], window: tuple[float, float] | None = None) -> NDArray[np.uint8]:
    """The machine's mapping to 8 bit (docs/metaimage.md): uint8 stays as it is; other types are mapped linearly,
    their smallest value to 0 and their largest to 255, or `window` = (low, high) instead. NaN becomes 0.

    >>> to_uint8(np.array([[[-100, 0, 155]]])).tolist()
    [[[0, 100, 255]]]
    >>> to_uint8(np.array([[[-100, 0, 155]]]), window=(0, 310)).tolist()
    [[[0, 0, 128]]]
    """
    volume = np.asarray(volume)
    if volume.dtype == np.uint8 and window is None:
        return volume
    return Levels(volume, window=checked_window(window)).levels


def checked_spacing(spacing: Any) -> tuple[float, float, float]:
    """ValueError: it is none.

    >>> checked_spacing(0.5)
    Traceback (most recent call last):
    ValueError: spacing=0.5, expected (x, y, z): mm between voxels along each axis, 1e-6 .. 1e6
    """
    try:
        mm = tuple(float(length) for length in spacing)
    except (TypeError, ValueError):
        mm = ()
    if len(mm) != 3 or not all(1e-6 <= length <= 1e6 for length in mm):
        told = spacing if np.ndim(spacing) == 0 else tuple(spacing)
        raise ValueError(f"spacing={told}, expected (x, y, z): mm between voxels along each axis, 1e-6 .. 1e6")
    return mm[0], mm[1], mm[2]


def checked_shape(shape: Sequence[int]) -> Shape:
    if not isinstance(shape, (Sequence, np.ndarray)):
        raise TypeError(f"shape={shape!r}: expected slices, height and width, each 1 .. 8192")
    if len(shape) != 3 or not all(1 <= n <= 8192 and n == int(n) for n in shape):
        raise ValueError(f"shape={tuple(shape)}: expected slices, height and width, each 1 .. 8192")
    return int(shape[0]), int(shape[1]), int(shape[2])


def checked_probe(probe: Any) -> NDArray[np.float64]:
    told = np.asarray(probe, np.float64)
    if told.shape not in ((3, 3), (3,)):
        raise ValueError(f"probe has shape {told.shape}, expected a rotation (3, 3) or a direction (3,)")
    return told


def checked_buffer(buffer: NDArray[np.uint8] | bool) -> NDArray[np.uint8] | None:
    if isinstance(buffer, bool):
        return None
    if buffer.dtype != np.uint8 or not buffer.flags.c_contiguous:
        raise ValueError(f"buffer is {buffer.dtype}, expected a C-contiguous array of uint8")
    return buffer


def checked_window(window: Any) -> tuple[float, float] | None:
    """ValueError: it is none."""
    if window is None:
        return None
    try:
        low, high = (float(value) for value in window)
    except (TypeError, ValueError):
        low = high = math.nan
    if not -math.inf < low < high < math.inf:
        told = window if np.ndim(window) == 0 else tuple(window)
        raise ValueError(f"window={told}, expected two finite numbers, the lower first")
    return low, high


def question_of_axes(volume: NDArray[Any]) -> str:
    """What to ask of an array whose first axis is the fastest in memory, as in libraries that index [x, y, z]."""
    if volume.flags.c_contiguous or not volume.flags.f_contiguous:
        return ""
    return "Its first axis is the fastest in memory: is it [x, y, z]? Expected is [z, y, x], which is volume.T then."


def what_was_scanned(shape: tuple[int, ...], scanned: Any) -> tuple[str, NDArray[np.bool_] | None]:
    """The machine's word for it, and a mask [z, y, x] if one was given, or two maps."""
    if isinstance(scanned, str):
        if scanned not in ("auto", "all", "zeros"):
            raise ValueError(f"scanned='{scanned}', expected 'auto', 'all', 'zeros', a mask or two maps")
        return scanned, None
    if isinstance(scanned, (tuple, list)) and len(scanned) == 2:
        first, end = (_finite(m) for m in scanned)
        if first.shape != shape[1:] or end.shape != shape[1:]:
            raise ValueError(f"scanned maps of {first.shape} and {end.shape}, expected {shape[1:]} [y, x]")
        z = np.arange(shape[0])[:, None, None]
        return "zeros", (first <= z) & (z < end)
    mask = _finite(scanned)
    if mask.shape != shape:
        raise ValueError(f"scanned has shape {mask.shape}, the volume {shape}")
    return "zeros", mask.astype(bool)


def _finite(values: Any) -> NDArray[Any]:
    """What was scanned, as an array; ValueError: some of it is no number, and would be nowhere without a word."""
    array = np.asarray(values)
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        at = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"scanned is {array[at]} at {list(at)}, expected finite numbers")
    return array
