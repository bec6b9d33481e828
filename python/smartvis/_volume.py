# SPDX-License-Identifier: MIT
"""Volumes as the plugin takes them: 8 bits a voxel, and what of them was scanned."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import MissingExtraError

_MOST = 1e30  # as in the host: beyond stand marks and rubbish


def to_uint8(volume: NDArray[Any], window: tuple[float, float] | None = None) -> NDArray[np.uint8]:
    """The host's mapping to 8 bit (docs/metaimage.md): uint8 stays as it is; other types are mapped linearly,
    their smallest value to 0 and their largest to 255, or `window` = (low, high) instead.

    >>> to_uint8(np.array([[[-100, 0, 155]]])).tolist()
    [[[0, 100, 255]]]
    """
    if volume.dtype == np.uint8 and window is None:
        return volume
    if volume.dtype.kind not in "uifb":
        raise ValueError(f"the volume holds {volume.dtype}, expected whole or floating-point numbers")
    if window is None:
        low, high = float(volume.min()), float(volume.max())
    else:
        if len(window) != 2 or not -math.inf < float(window[0]) < float(window[1]) < math.inf:
            raise ValueError(f"window={tuple(window)}, expected two finite numbers, the lower first")
        low, high = float(window[0]), float(window[1])
    if not (np.isfinite(low) and np.isfinite(high)):
        at = np.argwhere(~np.isfinite(volume))
        where = f": the voxel (x, y, z) = {tuple(int(i) for i in at[0][::-1])}" if len(at) else ""
        raise ValueError(f"the volume has values that are not finite{where}")
    if window is None and max(-low, high) > _MOST:
        raise ValueError(f"the values are {low:g} .. {high:g}, expected -1e30 .. 1e30; give a window")
    if not low < high:
        raise ValueError(f"the values {low:g} .. {high:g} have no range that could become 0 .. 255")
    if volume.dtype.kind == "f" and not np.isfinite(volume).all():
        raise ValueError("the volume has values that are not finite")
    # The host's own arithmetic, halves included, so that both make the same levels.
    scale = 255.0 / (high * 0.5 - low * 0.5)
    levels = np.clip((volume.astype(np.float64) * 0.5 - low * 0.5) * scale, 0.0, 255.0)
    return (levels + 0.5).astype(np.uint8)


def fan(volume: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """The host's padding "auto": zeros that touch the volume's border through zeros were not scanned. Returns
    the volume, in which zeros that were scanned are 1, and the mask of what was scanned."""
    try:
        from scipy.ndimage import label
    except ImportError:
        raise MissingExtraError("SciPy", "scipy", "scanned='auto'") from None
    zero = volume == 0
    parts, count = label(zero)
    outside = np.zeros(count + 1, bool)
    for axis in range(3):
        for face in (0, -1):
            outside[np.unique(np.take(parts, face, axis=axis))] = True
    outside[0] = False
    scanned = ~outside[parts]
    return np.where(zero & scanned, np.uint8(1), volume), scanned


def ranges(scanned: NDArray[np.bool_]) -> NDArray[np.uint16]:
    """Of a mask [z, y, x] the first scanned slice and the first one behind the scan, [y, x, 2]."""
    first, end = _first_true(scanned), scanned.shape[0] - _first_true(scanned[::-1])
    first[end == 0] = 0
    return np.stack([first, end], axis=-1).astype(np.uint16)


def _first_true(mask: NDArray[np.bool_]) -> NDArray[np.int32]:
    """On every ray the first slice that is True, or how many there are if none is. Most rays begin early, so this ends
    long before argmax would, which reads across memory."""
    first = np.full(mask.shape[1:], mask.shape[0], np.int32)
    left = np.ones(mask.shape[1:], bool)
    for z, plane in enumerate(mask):
        first[left & plane] = z
        left &= ~plane
        if not left.any():
            break
    return first
