# SPDX-License-Identifier: MIT
"""Method wall through the ABI, on three scenes of ours at 128^3, or on the nine volumes of the folder SV_SITE: what
moves, brightens or resamples the scan must move or keep the surface (docs/surface.md). Errors are those of the judges,
the mean over the cases. That a mirrored scan has the mirrored surface, to the bit: test_wall_definition.
Requirement: R3.
"""

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cases import Case, changed, in_folder, scene
from scores import Calibration, judge
from session import Session, opened

SITE = os.environ.get("SV_SITE")
NAMES = ("E01", "E04", "M01", "E02", "E03", "M02", "M03", "D01", "D02")
LARGEST = 1.25  # error against that of the unchanged scan


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    if SITE:
        return [in_folder(Path(SITE), name) for name in NAMES]
    return [case for name in NAMES[:3] for case in scene(name, seed=1)]


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with opened(None, "method=wall") as one:
        yield one


def map_of(session: Session, case: Case) -> np.ndarray:
    result = session.clip(case)
    assert result.clips
    return result.depth.copy()


def error_of(case: Case, depth: np.ndarray) -> float:
    return judge(case, depth, None, Calibration()).error


@pytest.fixture(scope="module")
def base(session: Session, cases: list[Case]) -> float:
    return float(np.mean([error_of(case, map_of(session, case)) for case in cases]))


def hold(what: str, errors: list[float], base: float) -> None:
    print(f"{what}: {np.mean(errors):.3f} slices, {base:.3f} as it is")
    assert np.mean(errors) <= LARGEST * base


def moved(values: np.ndarray) -> np.ndarray:
    """One pixel to the right; the first column stays."""
    return np.concatenate([values[..., :1], values[..., :-1]], axis=-1)


def test_moved_sideways(session: Session, cases: list[Case]) -> None:
    """By less than a block, so every block is another one."""
    off = []
    for case in cases:
        other = replace(case, full=moved(case.full), first=moved(case.first), end=moved(case.end))
        before, after = map_of(session, case), map_of(session, other)
        off.append(abs(after[:, 1:] - before[:, :-1])[case.labelled[:, :-1]])
    mean = np.concatenate(off).mean()
    print(f"one pixel sideways: {mean:.3f} slices")
    assert mean <= 0.2


def test_room_in_front(session: Session, cases: list[Case]) -> None:
    """The scan begins farther back, behind room that was not scanned. Eight slices are no whole number of layers at
    every spacing."""
    room = 8
    for case in cases:
        full = np.concatenate([np.zeros((room, *case.label.shape), np.uint8), case.full])
        more = np.where(case.end > case.first, room, 0).astype(np.uint16)
        far = replace(case, full=full, first=case.first + more, end=case.end + more)
        off = map_of(session, far) - map_of(session, case) - room
        mean = abs(off[case.labelled]).mean()
        print(f"{case.name}: room in front: {mean:.4f} slices")
        assert mean <= 0.3


def speckled(case: Case) -> Case:
    """Up to a quarter more or less, which depends on the voxel's place only."""
    factor = np.random.default_rng(12345).uniform(0.75, 1.25, case.full.shape)
    return replace(case, full=np.minimum(case.full * factor + 0.5, 255.0).astype(np.uint8))


def blurred(case: Case) -> Case:
    """Weights 1 2 1 along every axis."""
    full = case.full
    for axis in range(3):
        low, high = (
            np.take(full, np.clip(np.arange(full.shape[axis]) + step, 0, full.shape[axis] - 1), axis)
            for step in (-1, 1)
        )
        full = ((low.astype(np.uint16) + 2 * full.astype(np.uint16) + high + 2) // 4).astype(np.uint8)
    return replace(case, full=full)


@pytest.mark.parametrize("change", [
    *(lambda case, kw=kw: changed(case, **kw) for kw in (
        {"gain": 0.5}, {"gain": 2.0}, {"gamma": 0.7}, {"gamma": 1.4}, {"black": 15.0}, {"black": -15.0})),
    speckled, blurred])  # fmt: skip
def test_grey_levels(session: Session, cases: list[Case], base: float, change: Callable[[Case], Case]) -> None:
    hold("changed", [error_of(case, map_of(session, change(case))) for case in cases], base)


def between(values: np.ndarray, count: int, axis: int) -> np.ndarray:
    """So many values along an axis, linear between the centres of voxels; beyond the outermost their value counts."""
    size = values.shape[axis]
    at = np.clip((np.arange(count) + 0.5) * size / count - 0.5, 0, size - 1).astype(np.float32)
    low = at.astype(int)
    share = (at - low).reshape([-1 if a == axis else 1 for a in range(values.ndim)])
    first, last = np.take(values, low, axis), np.take(values, np.minimum(low + 1, size - 1), axis)
    return first + share * (last - first)


def resampled(case: Case, shape: tuple[int, int, int]) -> Case:
    full = case.full.astype(np.float32)
    for axis, count in enumerate(shape):
        full = between(full, count, axis)
    step = np.array(case.full.shape) / shape
    y, x = ((2 * np.arange(n) + 1) * old // (2 * n) for n, old in zip(shape[1:], case.label.shape, strict=True))
    end = (case.end[np.ix_(y, x)] / step[0]).astype(np.uint16)
    first = np.minimum(np.ceil(case.first[np.ix_(y, x)] / step[0]).astype(np.uint16), end)
    spacing = tuple(float(mm) for mm in np.array(case.spacing) * step[::-1])
    return replace(case, full=(full + 0.5).astype(np.uint8), first=first, end=end, spacing=spacing)


def map_back(case: Case, depth: np.ndarray, slices: int) -> np.ndarray:
    """The map at the pixels of `case`, which shows the same scan."""
    height, width = case.label.shape
    there = between(between(depth, height, 0), width, 1)
    return np.where(there > 0, (there + 0.5) * case.slices / slices - 0.5, 0).astype(np.float32)


@pytest.mark.parametrize("size", [(192, 128, 128), (193, 128, 128), (133, 133, 133), (128, 160, 192), (256, 256, 256),
                                  (96, 96, 96), (240, 144, 100)])  # fmt: skip
def test_sizes(session: Session, cases: list[Case], base: float, size: tuple[int, int, int]) -> None:
    """Lengths are in mm: other voxels of the same scan, and voxels of unequal sides, give as good a surface."""
    errors = [error_of(case, map_back(case, map_of(session, resampled(case, size)), size[0])) for case in cases]
    hold("{2} x {1} x {0} voxels".format(*size), errors, base)
