# SPDX-License-Identifier: MIT
"""A case with its truth, as a turned camera sees it: where voxels, ends of rays and labels come to lie, and what is
told of the probe."""

from dataclasses import replace

import numpy as np
import pytest
from cases import FETUS, SAC, Case, Told, make
from turns import tilted

N, BACK, HIDES, FIRST = 40, 24, 8, 2


@pytest.fixture
def case() -> Case:
    """A back from slice BACK on, of which the half with x < N / 2 is the fetus; grain before it; and what hides in
    slices HIDES to HIDES + 3, which the truth lacks. All was scanned from slice FIRST on."""
    clean = np.random.default_rng(1).integers(1, 16, (N, N, N)).astype(np.uint8)
    clean[BACK:] = 250
    full = clean.copy()
    full[HIDES : HIDES + 4] = 250
    label = np.where(np.arange(N) < N // 2, FETUS, SAC).astype(np.uint8) + np.zeros((N, 1), np.uint8)
    told = Told(np.eye(3), ((16.0, 18.0, -40.0), 7.0))
    made = replace(
        make("back", (0.8, 0.8, 0.8), full, clean, label, told=told), first=np.full((N, N), FIRST, np.uint16)
    )
    assert (made.truth == BACK).all()
    return made


def test_a_quarter_turn_puts_voxels_on_voxels(case: Case) -> None:
    """Of one about x: y becomes z, and z runs against y. So do probe and beams."""
    t = tilted(case, (90.0, 0.0))
    z, y, x = (a.ravel() for a in np.mgrid[1 : N - 1, 1 : N - 1, 1 : N - 1])
    sure = y != FIRST  # there rounding decides
    z, y, x = z[sure], y[sure], x[sure]
    scanned = t.scanned[z, y, x]
    assert (scanned == (y > FIRST)).all()
    z, y, x = z[scanned], y[scanned], x[scanned]
    assert (t.full[z, y, x] == case.full[y, N - 1 - z, x]).all()
    assert (t.clean[z, y, x] == case.clean[y, N - 1 - z, x]).all()
    assert t.told.probe is not None and np.allclose(t.told.probe, [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-5)
    assert np.allclose(t.told.beams[0], (16, -40, 0.8 * (N - 1) - 18), atol=1e-4) and t.told.beams[1] == 7.0


def test_a_small_turn_lets_the_back_rise_to_one_side(case: Case) -> None:
    """By the tangent; labels stay on what they were on."""
    t, middle, angle = tilted(case, (0.0, 12.0)), 0.5 * (N - 1), np.radians(12.0)
    y, x = np.nonzero(t.label)
    inside = (np.minimum(x, y) >= 4) & (np.maximum(x, y) < N - 4)
    y, x = y[inside], x[inside]
    back = middle + (BACK - middle) / np.cos(angle) + np.tan(angle) * (x - middle)
    assert (abs(t.truth[y, x] - back) < 1.5).all()
    across = np.cos(angle) * (x - middle) + np.sin(angle) * (t.truth[y, x] - middle)
    far = abs(across) > 2.0
    assert (t.label[y, x][far] == np.where(across[far] < 0, FETUS, SAC)).all()
    assert 700 <= len(x) <= 1024


def test_voxels_between_others_are_mixed(case: Case) -> None:
    """A volume that grows along all axes does so in the turned one."""
    z, y, x = np.mgrid[:N, :N, :N]
    t = tilted(replace(case, full=(x + 2 * y + 3 * z).astype(np.uint8)), (10.0, 7.0))
    (ca, cb), (sa, sb) = np.cos(np.radians((10.0, 7.0))), np.sin(np.radians((10.0, 7.0)))
    about_x, about_y = [[1, 0, 0], [0, ca, -sa], [0, sa, ca]], [[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]]
    middle = 0.5 * (N - 1)
    at = np.array(about_y) @ about_x @ (np.stack([x, y, z])[:, t.scanned] - middle) + middle
    assert t.scanned.sum() > N**3 / 2 and (abs(np.array([1, 2, 3]) @ at - t.full[t.scanned]) <= 0.5001).all()
