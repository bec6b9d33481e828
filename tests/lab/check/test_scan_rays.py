# SPDX-License-Identifier: MIT
"""Where the labels of a scan let a ray be clipped: steps of 0.25 mm, by hand."""

import numpy as np
import pytest
from scans import rays_of

NOT, TISSUE, FLUID, FETUS, CORD, BEHIND, DOUBT = range(7)


def ray(*runs: tuple[int, int]) -> tuple[float, ...] | None:
    """Low, near, far and high of a ray of runs of labels, in steps; None: it is not judged."""
    labels = np.concatenate([np.full(length, label, np.uint8) for label, length in runs])[:, None]
    found = rays_of(labels)
    ends = (found.low, found.near, found.far, found.high)
    return tuple(float(end[0] / 0.25 + 0.5) for end in ends) if found.judged[0] else None


@pytest.mark.parametrize(("runs", "expected"), [
    (((NOT, 4), (TISSUE, 20), (FLUID, 12), (FETUS, 10), (NOT, 3)), (4, 24, 36, 46)),
    (((FLUID, 12), (FETUS, 10)), (0, 0, 12, 22)),  # nothing hides it
    (((TISSUE, 8), (FLUID, 7), (TISSUE, 8), (FLUID, 8), (FETUS, 4)), (0, 23, 31, 35)),  # a pocket is tissue
    (((TISSUE, 8), (FLUID, 8), (TISSUE, 8), (FLUID, 8), (FETUS, 4)), None),  # that is no pocket: wall follows
    (((TISSUE, 8), (CORD, 4), (BEHIND, 8), (FLUID, 9), (CORD, 3), (FETUS, 4)), (0, 20, 32, 36)),
    (((TISSUE, 8), (CORD, 7), (FETUS, 4)), (0, 8, 15, 19)),  # before the fetus it is none either
    (((TISSUE, 8), (DOUBT, 4), (FLUID, 9), (FETUS, 4)), (0, 8, 21, 25)),
    (((TISSUE, 8), (NOT, 4), (FLUID, 9), (FETUS, 4)), (0, 8, 21, 25)),
    (((DOUBT, 8), (FLUID, 9), (FETUS, 4)), None),
    (((TISSUE, 8), (FLUID, 9), (DOUBT, 4), (FETUS, 4)), (0, 8, 21, 25)),
    (((TISSUE, 8), (FLUID, 9), (TISSUE, 4)), None),
    (((TISSUE, 20),), None),
    (((NOT, 20),), None),
])  # fmt: skip
def test_labels_of_a_ray(runs: tuple[tuple[int, int], ...], expected: tuple[float, ...] | None) -> None:
    assert ray(*runs) == expected


def test_how_far_a_clipped_ray_is_off() -> None:
    labels = np.repeat(np.array([NOT, TISSUE, FLUID, FETUS], np.uint8), (4, 20, 12, 9))
    rays = rays_of(labels[:, None])
    # In the tissue 2 mm are left; before it all; in the fluid it is right; 1 mm too deep; beyond the scan.
    for depth, off in ((3.875, 2.0), (0.0, 5.0), (7.0, 0.0), (9.875, -1.0), (99.0, -2.25)):
        assert rays.off(np.array([depth]))[0] == off
