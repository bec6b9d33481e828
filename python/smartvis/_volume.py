# SPDX-License-Identifier: MIT
"""What callers say of their volumes, checked: windows, masks, maps of what was scanned."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._seen import Levels


def to_uint8(volume: NDArray[Any], window: tuple[float, float] | None = None) -> NDArray[np.uint8]:
    """The machine's mapping to 8 bit (docs/metaimage.md): uint8 stays as it is; other types are mapped linearly,
    their smallest value to 0 and their largest to 255, or `window` = (low, high) instead. NaN becomes 0.

    >>> to_uint8(np.array([[[-100, 0, 155]]])).tolist()
    [[[0, 100, 255]]]
    >>> to_uint8(np.array([[[-100, 0, 155]]]), window=(0, 310)).tolist()
    [[[0, 0, 128]]]
    """
    if volume.dtype == np.uint8 and window is None:
        return volume
    return Levels(volume, window=checked_window(window)).levels


def checked_window(window: Any) -> tuple[float, float] | None:
    """ValueError: it is none."""
    if window is None:
        return None
    if len(window) != 2 or not -math.inf < float(window[0]) < float(window[1]) < math.inf:
        raise ValueError(f"window={tuple(window)}, expected two finite numbers, the lower first")
    return float(window[0]), float(window[1])


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
