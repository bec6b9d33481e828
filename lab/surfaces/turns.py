# SPDX-License-Identifier: MIT
"""Other poses of a camera before a case, or before a volume that nothing hides: checks on data that nobody made for
them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import rays
from cases import Case, Told, make
from numpy.typing import NDArray

_NEAR_RAYS, _NEAR_SLICES = 2, 3
Place = NDArray[np.float64]


def _mapping(case: Case, degrees: tuple[float, float]) -> tuple[Place, Place]:
    """From voxels of the turned case to those of the case: at = rows . (x, y, z, 1); and the turn about the middle,
    which it is in mm."""
    (ca, cb), (sa, sb) = (f(np.array(degrees) * np.arccos(-1.0) / 180.0) for f in (np.cos, np.sin))
    turn = np.array([[cb, sb * sa, sb * ca], [0.0, ca, -sa], [-sb, cb * sa, cb * ca]])
    mm, middle = np.array(case.spacing), 0.5 * (np.array(case.full.shape[::-1]) - 1.0)
    rows = turn * mm / mm[:, None]
    last = middle.copy()
    for k in range(3):
        last -= rows[:, k] * middle[k]
    return np.column_stack([rows, last]), turn


def _place(rows: Place, x: Place, y: Place, z: Any) -> list[Place]:
    return [row[0] * x + row[1] * y + row[2] * z + row[3] for row in rows]


def _turned_told(case: Case, turn: Place) -> Told:
    """What the turned case tells of probe and beams, along its own axes, in the frame's float32."""
    probe, beams = case.told.probe, case.told.beams
    count, mm = np.array(case.full.shape[::-1]), np.array(case.spacing)
    if probe is not None:
        to = np.zeros((3, 3), np.float32)
        for k in range(3):
            to += np.outer(turn[k], probe[k]).astype(np.float32)
        probe = to.astype(np.float64)
    if isinstance(beams, tuple):
        middle = 0.5 * (count - 1.0) * mm
        apex = np.zeros(3)
        for k in range(3):
            apex += turn[k] * (beams[0][k] - middle[k])
        beams = (tuple(map(float, (apex + middle).astype(np.float32))), beams[1])
    return Told(probe, beams)


def _label_at(case: Case, at: list[Place], seen: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """What the rays of the case are that end in these places."""
    height, width = case.label.shape
    x, y = (np.floor(a + 0.5).astype(int) for a in at[:2])
    seen = seen & (x >= 0) & (y >= 0) & (x < width) & (y < height)
    nearest = np.full(x.shape, float(case.slices))
    for v in range(-_NEAR_RAYS, _NEAR_RAYS + 1):
        for u in range(-_NEAR_RAYS, _NEAR_RAYS + 1):
            there = seen & (x + u >= 0) & (y + v >= 0) & (x + u < width) & (y + v < height)
            off = abs(at[2][there] - case.truth[y[there] + v, x[there] + u].astype(np.float64))
            nearest[there] = np.minimum(nearest[there], off)
    label = np.zeros(x.shape, np.uint8)
    label[seen] = np.where(nearest[seen] < _NEAR_SLICES, case.label[y[seen], x[seen]], 0)
    return label


def tilted(case: Case, degrees: tuple[float, float]) -> Case:
    """The case as a camera sees it that is turned about x and then about y, around the middle of the volume: as many
    voxels of the same size; what comes to lie outside of them is lost. A voxel was scanned if all eight around its
    place were. Rays end where they do in the turned ground truth; a ray's label is that of the ray of `case` that ends
    in the same place, at most two rays and three slices away, else none. In that truth what hides is removed along the
    rays of `case`, so turns should be small."""
    rows, turn = _mapping(case, degrees)
    slices, height, width = case.full.shape
    count, scanned = np.array((width, height, slices)), case.scanned
    y, x = np.mgrid[:height, :width].astype(np.float64)
    volumes = (case.full, case.clean)
    out = np.zeros((2, slices, height, width), np.uint8)
    there = np.zeros((slices, height, width), bool)
    for z in range(slices):
        at = np.stack(_place(rows, x, y, np.float64(z)))
        inside = ((at >= 0.0) & (at < count[:, None, None] - 1.0)).all(axis=0)
        low = at[:, inside].astype(int)
        rest = at[:, inside] - low
        corners = [(k & 1, k >> 1 & 1, k >> 2) for k in range(8)]
        whole = np.logical_and.reduce([scanned[low[2] + c, low[1] + b, low[0] + a] for a, b, c in corners])
        low, rest = low[:, whole], rest[:, whole]
        there[z][inside] = whole
        for of, to in zip(volumes, out, strict=True):
            total = np.full(low.shape[1], 0.5)
            for a, b, c in corners:
                weight = (rest[0] if a else 1.0 - rest[0]) * (rest[1] if b else 1.0 - rest[1])
                weight = weight * (rest[2] if c else 1.0 - rest[2])
                total += weight * of[low[2] + c, low[1] + b, low[0] + a]
            to[z][there[z]] = total.astype(np.uint8)
    first = there.argmax(axis=0)
    end = np.where(there.any(axis=0), slices - there[::-1].argmax(axis=0), 0)
    truth = rays.ends(out[1])
    seen = (end > 0) & (truth < slices)
    label = _label_at(case, _place(rows, x, y, truth.astype(np.float64)), seen)
    name = f"{case.name[:40]} {degrees[0]:.0f},{degrees[1]:.0f}"
    return replace(case, name=name, full=out[0], clean=out[1], first=first.astype(np.uint16), end=end.astype(np.uint16),
                   truth=truth, label=label, near=None, far=None, told=_turned_told(case, turn))  # fmt: skip


def from_side(case: Case, axis: int, degrees: float, side: int) -> Case:
    """The volume as a camera sees it that is turned about axis 0 (x), 1 (y) or 2 (z, then looked at from the side): a
    cube of `side`^3 voxels that holds all of it, without a truth."""
    count, mm = np.array(case.full.shape[::-1]), np.array(case.spacing)
    cube = float(np.sqrt(np.cumsum(count * mm * count * mm)[-1])) / side
    angle = degrees * np.arccos(-1.0) / 180.0
    co, si = np.cos(angle), np.sin(angle)
    middle = cube * (np.arange(side) + 0.5 - 0.5 * side)
    y, x = np.meshgrid(middle, middle, indexing="ij")
    full = np.zeros((side, side, side), np.uint8)
    for z in range(side):
        p = [x, y, np.full_like(x, middle[z])]
        if axis == 2:  # turning about the viewing direction alone would be one view
            p[1], p[2] = p[2], -p[1]
        a, b = (1 if axis == 0 else 0), (1 if axis == 2 else 2)
        p[a], p[b] = co * p[a] - si * p[b], si * p[a] + co * p[b]
        full[z] = _sample(case.full, [p[i] / mm[i] + 0.5 * count[i] - 0.5 for i in range(3)])
    return make(f"{case.name[:50]} {'xyz'[axis]} {degrees:.0f}", (cube, cube, cube), full)


def _sample(full: NDArray[np.uint8], at: list[Place]) -> NDArray[np.uint8]:
    """Trilinear, over scanned voxels only; 0 if they weigh less than half."""
    low = [np.floor(a) for a in at]
    rest = [a - b for a, b in zip(at, low, strict=True)]
    total, weight = np.zeros(at[0].shape), np.zeros(at[0].shape)
    for corner in range(8):
        w = np.ones(at[0].shape)
        index = []
        for axis in range(3):
            step = corner >> axis & 1
            i = (low[axis] + step).astype(int)
            w = w * (rest[axis] if step else 1.0 - rest[axis])
            size = full.shape[2 - axis]
            w = np.where((i >= 0) & (i < size), w, 0.0)
            index.append(np.clip(i, 0, size - 1))
        level = full[index[2], index[1], index[0]]
        w = np.where((w > 0.0) & (level != 0), w, 0.0)
        total += w * level
        weight += w
    mean = np.divide(total, weight, out=np.zeros_like(total), where=weight > 0)
    return np.where(weight >= 0.5, np.clip(mean + 0.5, 1.0, 255.0), 0.0).astype(np.uint8)
