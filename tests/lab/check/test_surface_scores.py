# SPDX-License-Identifier: MIT
"""What surfaces are scored by, on rays and counts by hand."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import turns
from cases import FETUS, NEITHER, SAC, Case, _scan, make
from flicker import _move
from harm import _bladder
from marks import _Keeper
from scans import Scan
from scores import BINS, Calibration, Score, SiteScore, judge

from smartvis import _metaimage

SLICES = 128


def wall(*ends: int, label: int = FETUS) -> Case:
    """A row of rays, each of which ends on a wall; of what hides it, nothing."""
    full = np.ones((SLICES, 1, len(ends)), np.uint8)
    for x, end in enumerate(ends):
        full[end:, 0, x] = 255
    return make("wall", (1.0, 1.0, 1.0), full, full, np.full((1, len(ends)), label, np.uint8))


def test_two_slices_are_right_and_three_are_not() -> None:
    """Rays that start so many slices behind their wall are cut; what lies before it is left."""
    case, counts = wall(50, 50, 50, 50, 50), Calibration()
    hidden = case.full.copy()
    hidden[47:, 0, 3] = 255
    depth = np.array([[50, 52, 53, 0, 55]], np.float32)
    score = judge(case, depth, np.full((1, 5), 0.5, np.float32), counts, hidden)
    assert np.allclose((score.cut, score.left, score.error), (0.4, 0.2, 13 / 5), atol=1e-6)
    assert (counts.right.sum(), counts.wrong.sum(), counts.cut.sum()) == (2, 3, 2)
    assert judge(wall(50, label=SAC), depth[:, 2:3], None, Calibration()).cut == 0  # of the fetus alone


def test_a_confidence_that_is_the_same_tells_half() -> None:
    counts = Calibration()
    counts.right[[5, 9]] = 1
    counts.wrong[5] = 2
    assert counts.auc() == 0.75 and counts.auc("cut") == 1.0  # of pairs without one
    counts.cut[5] = 1
    assert counts.auc("left") == 0.75 and counts.reliability(0, 6 / (BINS - 1))[:2] == (3, 1 / 3)


def test_the_worst_and_the_surest_case_are_named() -> None:
    site = SiteScore()
    for name, error, cut, confidence in (
        ("a", 1, 0.2, 0.4),
        ("b", 3, 0.2, 0.9),
        ("c", 2, 0.05, 1.0),
        ("d", 1, 0.2, 0.5),
    ):
        site.add(name, Score(error=error, cut=cut, confidence=confidence))
    assert site.worst == (3, "b") and site.surest == (0.9, "b") and (site.harmed, site.worst_cut) == (4, 0.2)


@pytest.mark.parametrize(("slices", "moved"), [(128, 3.0), (64, 6.0)])
def test_a_move_is_in_slices_of_128(slices: int, moved: float) -> None:
    case = make("some", (1.0, 1.0, 1.0), np.ones((slices, 1, 2), np.uint8), label=np.array([[FETUS, 0]], np.uint8))
    ends = [np.array([[10, 10]], np.float32), np.array([[13, 40]], np.float32)]
    assert _move(case, case, ends) == moved


def test_a_view_from_the_side_is_no_mirror_image() -> None:
    """A corner at low x, low y and high z: where y was the view's z is, and z runs up."""
    full = np.zeros((16, 16, 16), np.uint8)
    full[12:, :4, :4] = 200
    seen = turns.from_side(make("corner", (1.0, 1.0, 1.0), full), 2, 0.0, 32).full
    assert [float(axis.mean()) - 15.5 for axis in np.nonzero(seen)] == [-7.0, -7.0, -7.0]


def test_of_a_ray_without_a_label_nothing_need_be_scanned(tmp_path: Path) -> None:
    paths = [str(tmp_path / name) for name in ("first.mha", "end.mha")]
    for path, values in zip(paths, ([[0, 3]], [[4, 3]]), strict=True):
        _metaimage.write(Path(path), np.array(values, np.uint8))
    assert _scan(paths, (4, 1, 2), np.array([[FETUS, NEITHER]], np.uint8)).sum(axis=0).tolist() == [[4, 0]]


def test_an_orbit_goes_on_from_its_first_frame() -> None:
    went: list[bool] = []
    seen = SimpleNamespace(grid=SimpleNamespace(probe=None, beams=None))
    session = SimpleNamespace(answer="sure", frame=lambda *_, goes_on: went.append(goes_on))
    assert Scan.orbit(SimpleNamespace(seen=lambda *_, **__: seen), session, "nothing") == 0
    assert went == [False] + [True] * 199


def test_two_millimetres_of_fluid_part_runs_of_tissue() -> None:
    keeper = _Keeper.__new__(_Keeper)
    means = np.array([9, 9, 9, 1, 1, 9, 9, 9], np.uint8)[:, None, None]
    keeper._seen, keeper._slice, keeper._y, keeper._x = SimpleNamespace(means=means), 1.0, 0, 0
    assert keeper._run(5, 0.0) == (0, 3) and keeper._run(5, 3.0) == (5, 8)


def test_a_bladder_lies_before_the_wall_of_the_sac_and_beside() -> None:
    label = np.zeros((9, 9), np.uint8)
    label[3:6, 3:6] = SAC
    full = np.ones((SLICES, 9, 9), np.uint8)
    case = make("body", (6.0, 6.0, 1.0), full, full, label)
    inside = _bladder(case, np.full((9, 9), 60))
    assert inside[:, ~case.labelled].any() and inside[:, case.labelled].any()
    assert np.nonzero(inside[:, case.labelled])[0].max() + 5 < 60
