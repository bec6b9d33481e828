# SPDX-License-Identifier: MIT
"""clip(keep=, remove=): the marks of host_sim run, to the bit."""

from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import FETUS, host_sim, layers

import smartvis


@pytest.fixture
def cord() -> np.ndarray:
    """Layers with a cord of tissue in their fluid, and fluid and a wall behind the fetus."""
    volume = layers((64, 56, 56), 0.1, 0.5)
    volume[20:26, 24:32, :] = FETUS
    volume[46:54] = 10
    return volume


def test_as_the_command_line_has_it(cord: np.ndarray, tmp_path: Path) -> None:
    plain = smartvis.clip(cord, spacing=(1, 1, 1), method="wall")
    remove, keep = [(28.0, 28.0, 20.0, 6.0), (28.0, 28.0, 38.0)], [(10.0, 44.0, 2.0, 4.0)]
    marked = smartvis.clip(cord, spacing=(1, 1, 1), method="wall", remove=remove, keep=keep)
    deeper, nearer = marked.depth > plain.depth, marked.depth < plain.depth
    y, x = np.mgrid[:56, :56]
    assert deeper.any() and not deeper[np.hypot(x - 28, y - 28) > 6].any()
    assert nearer.any() and not nearer[np.hypot(x - 10, y - 44) > 4].any()
    assert marked.mask().sum() != plain.mask().sum()

    image = sitk.GetImageFromArray(cord)
    sitk.WriteImage(image, str(tmp_path / "v.mha"))
    marks = [f"--remove={','.join(map(str, mark))}" for mark in remove]
    marks += [f"--keep={','.join(map(str, mark))}" for mark in keep]
    host_sim("run", "--volume", tmp_path / "v.mha", "--set", "method=wall", "--setting", "smartvis", "--frames", 1,
             "--few-pictures", "--write", "depthmap", "--out", tmp_path, *marks)  # fmt: skip
    depth = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / "depthmap.mha")))
    assert np.array_equal(np.squeeze(depth), marked.depth_mm)


@pytest.mark.parametrize("mark", [(1, 2), (1, 2, 3, 0), (1, 2, 3, 4, 5), (1, float("nan"), 3)])
def test_what_is_no_mark(cord: np.ndarray, mark: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="keep="):
        smartvis.clip(cord, spacing=(1, 1, 1), method="wall", keep=[mark])
