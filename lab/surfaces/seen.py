# SPDX-License-Identifier: MIT
"""A volume as a camera of the machine sees it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smartvis._seen import Grid, Levels
from smartvis._view import Camera, on_grid

Depth = NDArray[np.float32]
Mark = tuple[tuple[float, ...], bool]  # x, y, z, radius in mm; keep


@dataclass
class Seen:
    """A volume as a camera sees it."""

    levels: Levels
    grid: Grid
    spacing: tuple[float, float, float]

    @property
    def camera(self) -> Camera:
        """As results have it."""
        return on_grid(self.levels.levels.shape, self.spacing, self.grid)

    @property
    def voxel_mm(self) -> tuple[float, float, float]:
        """Of the grid."""
        slices, height, width = self.grid.shape
        return self.grid.box[0] / width, self.grid.box[0] / height, self.grid.box[1] / slices

    def sampler(self, voxels: NDArray[Any], spacing: tuple[float, float, float]) -> Callable[[float], NDArray[Any]]:
        """What gives the voxels [y, x] nearest to the rays' places in a depth, a share of the box; outside 0."""
        _, height, width = self.grid.shape
        count = np.array(voxels.shape[::-1])
        box = (self.grid.box[0], self.grid.box[0], self.grid.box[1])
        du, dv, dw = (self.grid.rotation[a] * box[a] / np.array(spacing) for a in range(3))
        origin = 0.5 * (count - 1.0) - 0.5 * (du + dv + dw)
        across, down = (np.arange(width) + 0.5) / width, (np.arange(height)[:, None] + 0.5) / height
        start = [origin[k] + across * du[k] + down * dv[k] for k in range(3)]

        def sample(depth: float) -> NDArray[Any]:
            at = [np.floor(start[k] + depth * dw[k] + 0.5).astype(np.int32) for k in range(3)]
            inside = np.logical_and.reduce([(i >= 0) & (i < n) for i, n in zip(at, count, strict=True)])
            x, y, z = (np.where(inside, i, 0) for i in at)
            return np.where(inside, voxels[z, y, x], 0)

        return sample

    def _sampled(self, voxels: NDArray[Any]) -> NDArray[Any]:
        slices = self.grid.shape[0]
        sample = self.sampler(voxels, self.spacing)
        return np.stack([sample((z + 0.5) / slices) for z in range(slices)])

    @cached_property
    def voxels(self) -> NDArray[np.uint8]:
        """The nearest ones; outside 0, which is transparent."""
        return self._sampled(self.levels.levels)

    @cached_property
    def means(self) -> NDArray[np.uint8]:
        """The means of the scanned voxels around the nearest ones; 0: nothing was scanned there."""
        level = self.levels.levels
        sums, count = (_around(a.astype(np.uint16)) for a in (level, level != 0))
        return self._sampled((sums // np.maximum(count, 1)).astype(np.uint8))

    def apply(self, mark: Mark, depth: Depth) -> Depth:
        """The map with one more mark, by the machine's definition (host_sim/loop/marks.h)."""
        out = depth.copy()
        self.levels.mark(self.grid, [mark], out)
        return out


def _around(values: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Sums of 3 x 3 x 3."""
    for axis in range(3):
        padded = np.pad(values, [(int(a == axis),) * 2 for a in range(3)])
        parts = [np.take(padded, range(i, i + values.shape[axis]), axis) for i in range(3)]
        values = parts[0] + parts[1] + parts[2]
    return values
