# SPDX-License-Identifier: MIT
"""A user who knows the truth puts marks on the largest wrong regions, as the console's brush does. Each is the best of
twelve: on one of the three largest regions, of 3, 5, 8 or 12 mm; none if all are worse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import rays
from cases import FETUS, Case
from numpy.typing import NDArray
from scores import TOLERANCE, total
from seen import Depth, Mark, Seen

ROWS = (0, 1, 3, 6)  # marks
_SEEN = 0.5  # the opacity that the console's brush finds
_REGIONS, _RADII_MM = 3, (3.0, 5.0, 8.0, 12.0)
_GAP_MM = 2.0  # of fluid, between two runs of tissue


@dataclass
class Sums:
    """Mean error in slices of 128, of scans in mm; shares of rays that are more than 2 of them off."""

    error: float
    cut: float
    left: float

    @classmethod
    def _of(cls, off: NDArray[Any], judged: NDArray[np.bool_], fetus: NDArray[np.bool_]) -> Sums:
        count = max(int(judged.sum()), 1)
        cut = ((off < -TOLERANCE) & fetus & judged).sum() / max(int((fetus & judged).sum()), 1)
        return cls(total(abs(off[judged]).astype(np.float64)) / count, cut, (off > TOLERANCE)[judged].sum() / count)

    @classmethod
    def of_rays(cls, of: Any, depth: Depth, seen: Seen) -> tuple[Sums, NDArray[Any]]:
        """Of a map of rays with labels; and how far each of them is off, 0 if it is not judged."""
        off = np.where(of.judged, of.off(depth.ravel().astype(np.float64) * seen.voxel_mm[2]), 0.0)
        return cls._of(off, of.judged, of.judged), off.reshape(depth.shape)

    @classmethod
    def of_case(cls, case: Case, depth: Depth) -> tuple[Sums, NDArray[Any]]:
        """The same of a map of a case."""
        scale = np.float32(128.0)
        off = (case.truth - rays.ends(case.full, depth)) * scale / np.float32(case.slices)
        off = np.where(case.labelled, off, np.float32(0))
        return cls._of(off, case.labelled, case.label == FETUS), off


Judge = Callable[[Depth], tuple[Sums, NDArray[Any]]]
Scores = list[Sums]  # after 0, 1, 3 and 6 marks

# ------------------------------------------------------------------------------------------- where a mark goes


def _wrong(off: NDArray[Any]) -> NDArray[np.int8]:
    """1: too much is left, -1: it is cut."""
    return ((off > TOLERANCE).astype(np.int8) - (off < -TOLERANCE)).astype(np.int8)


def _regions(wrong: NDArray[np.int8]) -> list[NDArray[np.bool_]]:
    """The largest regions of rays that are wrong alike; of equal ones the first."""
    from scipy import ndimage

    found = []
    for sign in (1, -1):
        labels, count = ndimage.label(wrong == sign)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)
        firsts: Any = np.unique(labels, return_index=True)[1][-count:] if count else []
        found += [(-int(sizes[n + 1]), int(at), labels, n + 1) for n, at in enumerate(firsts)]
    found.sort(key=lambda region: region[:2])
    return [labels == n for _, _, labels, n in found[:_REGIONS]]


def _middle(region: NDArray[np.bool_]) -> tuple[int, int]:
    """The ray of a region with the most room to all four sides: y, x."""
    room = np.full(region.shape, np.iinfo(int).max)
    for axis in (0, 1):
        for flip in (False, True):
            way = np.flip(region, axis) if flip else region
            lines = way if axis == 0 else way.T
            run = np.zeros(lines.shape, int)
            run[0] = lines[0]
            for i in range(1, len(lines)):
                run[i] = (run[i - 1] + 1) * lines[i]
            run = run if axis == 0 else run.T
            room = np.minimum(room, np.flip(run, axis) if flip else run)
    y, x = np.unravel_index(int(np.where(region, room, -1).argmax()), region.shape)
    return int(y), int(x)


class _Keeper:
    """Moves a mark to keep along its ray to the last tissue before where the map starts the ray, as the console does
    (hs_marks_find_cut of host_sim/loop/marks.c)."""

    def __init__(self, seen: Seen, place: NDArray[np.float64], radius: float) -> None:
        self._seen, self._radius = seen, radius
        width_mm, _, self._slice = seen.voxel_mm
        box = np.array([seen.grid.box[0], seen.grid.box[0], seen.grid.box[1]])
        self._from_middle = seen.camera.from_middle(place)
        at = (self._from_middle + 0.5 * box) / np.array([width_mm, width_mm, self._slice]) - 0.5
        _, height, width = seen.grid.shape
        y, x = np.mgrid[:height, :width]
        right, down = x - at[0], y - at[1]
        near = (abs(right) * width_mm <= radius) & (np.hypot(right, down) * width_mm <= radius)
        self._near = seen.means[:, near]
        self._y, self._x = int(at[1] + 0.5), int(at[0] + 0.5)
        self._inside = bool(((at[:2] > -0.5) & (at[:2] < np.array([width, height]) - 0.5)).all())

    def _threshold(self, z: float, reach: float) -> int:
        """Otsu's, of what is at most `reach` slices before or behind."""
        there = abs(np.arange(len(self._near)) - z) <= reach
        histogram = np.bincount(self._near[there].ravel(), minlength=256)[1:].astype(np.float64)
        below, sum_below = np.cumsum(histogram), np.cumsum(histogram * np.arange(1, 256))
        all_of, sum_of = below[-1], sum_below[-1]
        some = (below > 0) & (below < all_of)
        if not some.any():
            return 0
        b, s = below[some], sum_below[some]
        apart = s / b - (sum_of - s) / (all_of - b)
        return int(np.nonzero(some)[0][(b * (all_of - b) * apart * apart).argmax()]) + 1

    def _run(self, threshold: int, behind: float) -> tuple[int, int] | None:
        """The first run of tissue that ends behind a slice."""
        gap = int(max(1.0, np.ceil(_GAP_MM / self._slice)))
        first, end = -1, 0
        for z, level in enumerate(self._seen.means[:, self._y, self._x].tolist()):
            if level > threshold:
                first = z if first < 0 else first
                end = z + 1
            elif first >= 0 and z + 1 - end >= gap:
                if end > behind:
                    return first, end
                first = -1
        return (first, end) if first >= 0 and end > behind else None

    def find(self, depth: Depth) -> NDArray[np.float64] | None:
        """The place; None: nothing is cut there."""
        slices = len(self._near)
        start = min(float(depth[self._y, self._x]), slices - 1.0)
        reach = 2.0 * self._radius / self._slice
        least = 0.25 * self._threshold(0.0, slices)  # of that of the whole ray
        for z in range(int(np.floor(start)) if self._inside and start > 0.0 else -1, -1, -1):
            threshold = self._threshold(z, reach)
            run = self._run(threshold, max(0.0, z - reach)) if threshold >= least else None
            if run and run[0] <= z < run[1] and max(run[0] - 1, 0) < start:
                away = (z + 0.5) * self._slice - 0.5 * self._seen.grid.box[1]
                return self._seen.camera.in_volume(np.array([*self._from_middle[:2], away]))
        return None


def _seen_at(seen: Seen, y: int, x: int, depth: Depth) -> int:
    """The slice at which a ray that starts at its depth has met what is seen."""
    z, clear = int(max(0.0, float(depth[y, x]))), 1.0
    column = seen.voxels[:, y, x]
    while z < len(column) and clear > 1.0 - _SEEN:
        clear *= 1.0 - float(rays.OPACITY[column[z]])
        z += 1
    return z


def _mark(seen: Seen, ray: tuple[int, int], radius: float, keep: bool, depth: Depth) -> Mark | None:
    """On a ray; None: nothing was cut there."""
    y, x = ray
    slices, height, width = seen.grid.shape
    shares = np.array([(x + 0.5) / width, (y + 0.5) / height, (_seen_at(seen, y, x, depth) + 0.5) / slices])
    found = seen.camera.in_volume((shares - 0.5) * np.array([seen.grid.box[0], seen.grid.box[0], seen.grid.box[1]]))
    place = _Keeper(seen, found, radius).find(depth) if keep else found
    return None if place is None else ((*map(float, place), radius), keep)


def play(seen: Seen, judge: Judge, depth: Depth, clips: bool) -> Scores:
    """Plays from a depthmap on. A map that does not clip has no marks."""
    depth = depth.copy()
    score, off = judge(depth)
    rows = []
    for count in range(ROWS[-1] + 1):
        if count in ROWS:
            rows.append(score)
        best = depth
        for region in _regions(_wrong(off)) if clips else ():
            ray = _middle(region)
            for radius in _RADII_MM:
                mark = _mark(seen, ray, radius, bool(off[ray] < 0), depth)
                trial = depth if mark is None else seen.apply(mark, depth)
                now = judge(trial)[0]
                if now.error < score.error:
                    score, best = now, trial
        depth = best
        off = judge(depth)[1]
    return rows


def line(what: str, unit: str, plays: list[Scores]) -> str:
    """The means."""
    out, count = f"  {what:<32} {len(plays):3} ", max(len(plays), 1)
    for row in range(len(ROWS)):
        error, cut, left = (
            sum(getattr(scores[row], name) for scores in plays) / count for name in ("error", "cut", "left")
        )
        out += f"{'  | ' if row else ''}{error:5.2f} / {100 * cut:5.2f} / {100 * left:5.2f}"
    return f"{out}  {unit}"
