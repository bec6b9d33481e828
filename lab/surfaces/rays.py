# SPDX-License-Identifier: MIT
"""Where rays end: the renderer's rule along the voxels of a volume, a step a slice (host_sim/render/dvr.h, CLIPPING;
thesis, Eq. 3.22 to 3.24). All of it is float32, in the renderer's order; tests/lab/golden/test_sites.py compares."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Maps = NDArray[np.float32]
Voxels = NDArray[np.uint8]

_f = np.float32
_LOW, _HIGH, _ENOUGH, _MARGIN = _f(40.5) / _f(255), _f(0.45), _f(0.95), _f(1e-3)
#: Of every grey level.
OPACITY = np.clip((np.arange(256, dtype=_f) / _f(255) - _LOW) / (_HIGH - _LOW), _f(0), _f(1))


def starts(depth: Maps, slices: int) -> NDArray[np.float32]:
    """The first slice that is drawn of rays that start at a depth."""
    first = (depth + _f(0.5)) - _f(0.5) - _MARGIN
    clips = (depth > 0) & (depth < np.inf) & (first > 0)
    return np.where(clips, np.minimum(np.ceil(first), _f(slices)), _f(0)).astype(_f)


def ends(voxels: Voxels, depth: Maps | None = None) -> Maps:
    """The slice [y, x] at which each ray ends that starts at a surface; None: before the first slice. Rays that never
    end have the number of slices."""
    slices, height, width = voxels.shape
    end = np.full(height * width, slices, _f)
    start = None if depth is None else starts(depth, slices).ravel()
    opacity = np.zeros(height * width, _f)
    rays = np.arange(height * width)  # those that go on
    flat = voxels.reshape(slices, -1)
    for z in range(slices):
        level = OPACITY[flat[z, rays]]
        if start is not None:
            level *= start[rays] <= z
        opacity += (_f(1) - opacity) * level
        done = opacity >= _ENOUGH
        if done.any():
            end[rays[done]] = z
            rays, opacity = rays[~done], opacity[~done]
    return end.reshape(height, width)
