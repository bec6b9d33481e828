# SPDX-License-Identifier: MIT
"""Scenes and measures are the host's: the same volumes, the same figures as its report."""

import csv
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import FLUID, SKIN, host_sim, layers

import smartvis
from smartvis import HostError


def test_a_scene_and_its_truth(d01: smartvis.Scene) -> None:
    assert d01.full.shape == d01.truth.shape == (96, 96, 96)
    assert d01.label.shape == d01.near.shape == d01.far.shape == (96, 96)
    assert set(np.unique(d01.label)) == {0, 1, 2}
    seen = d01.label > 0
    assert (d01.near[~seen] == -1).all() and (d01.far[seen] >= d01.near[seen]).all()
    assert d01.spacing[0] == pytest.approx(d01.spacing[2])
    middle = np.where(seen, (d01.near + d01.far) / 2, 0)  # of the fluid: as good as a map can be
    errors = smartvis.measure(d01, middle)
    assert errors.e_abs is not None and errors.e_abs < 1.0


def test_measures_are_those_of_the_report(tmp_path) -> None:
    """A map made in Python from the scene has the e_abs that the report's own run of the plugin has."""
    scene = smartvis.scene("E02", size=64)
    ours = {}
    for q in (0.0, 0.5):
        ours[q] = smartvis.measure(scene, scene.clip(method="wall", q=q))
    options = ["--case", "E02", "--size", 64, "--lowres", 64, "--frames", 0, "--coarse", "--set", "method=wall"]
    host_sim("report", *options, "--out", tmp_path)
    rows = (tmp_path / "space_E02.csv").read_text().splitlines()
    found = {float(row["q"]): row for row in reversed(list(csv.DictReader(rows)))}  # the method knows q alone
    for q, measured in ours.items():
        assert float(found[q]["e_abs"]) == pytest.approx(measured.e_abs, rel=1e-5)
        assert float(found[q]["fetus_cut"]) == pytest.approx(measured.fetus_cut, abs=1e-4)


def test_the_arrays_of_a_scene_are_what_is_measured(d01: smartvis.Scene) -> None:
    """Others than the host's own count, and so do a scene's that has no name."""
    own = smartvis.Scene(spacing=d01.spacing, full=d01.full, truth=d01.truth, label=d01.label)
    depth = d01.clip(method="wall")
    assert smartvis.measure(own, depth) == smartvis.measure(d01, depth)
    nothing_hides = replace(d01, truth=d01.full)
    assert smartvis.measure(nothing_hides, None).e_abs == 0.0 != smartvis.measure(d01, None).e_abs
    assert smartvis.measure(replace(d01, label=np.minimum(d01.label, 1)), depth).e_abs_fetus is None
    with pytest.raises(HostError, match="truth.mha: 96 x 96 x 95 voxels"):
        smartvis.measure(replace(d01, truth=d01.truth[1:]), depth)
    with pytest.raises(ValueError, match=r"label is float64 of shape \(96, 96\)"):
        smartvis.measure(replace(d01, label=d01.label.astype(float)), depth)


@pytest.mark.parametrize("shape", [(64, 64, 64), (60, 40, 52)])
@pytest.mark.parametrize("spacing", [(1, 1, 2), (1, 1, 0.5), (0.5, 0.7, 1.1), (1, 1, 1)])
def test_a_volume_of_ones_own_has_any_shape(shape: tuple[int, int, int], spacing: tuple[float, float, float]) -> None:
    """Skin from slice 0, fluid, fetus: what starts in the fluid is right; errors are counted in the shortest side."""
    slices, *map_shape = shape
    full = layers(shape, 0.25, 0.75)
    full[:] = full[:, :, :1]
    own = smartvis.Scene(
        spacing=spacing,
        full=full,
        truth=np.where(full == SKIN, FLUID, full).astype(np.uint8),
        label=np.full(map_shape, 2, np.uint8),
    )
    maps: dict[str, Any] = {name: np.full(map_shape, float(name) * slices) for name in ("0.1", "0.3", "0.7", "0.9")}
    found = smartvis.measure_many(own, {**maps, "none": None, "clip": own.clip()})
    assert all(found[right].e_abs == 0 for right in ("0.3", "0.7", "clip"))
    steps = 0.75 * slices * spacing[2] / min(spacing)  # from the front to the fetus
    assert found["none"].e_pos == pytest.approx(steps, abs=2) and found["none"].occluder_left == 1
    assert found["0.1"].e_pos == pytest.approx(steps * 65 / 75, abs=4)
    assert found["0.9"].e_neg == pytest.approx(steps * 15 / 75, abs=4) and found["0.9"].fetus_cut == 1


def test_what_the_host_refuses_is_an_exception(d01: smartvis.Scene, monkeypatch) -> None:
    with pytest.raises(HostError) as caught:
        smartvis.scene("Z99")
    assert "Z99" in str(caught.value) and caught.value.code == 3
    with pytest.raises(HostError, match="^size: 31 is outside 32 .. 512$"):
        smartvis.scene("D01", size=31)
    with pytest.raises(ValueError, match="as many rows as columns"):
        smartvis.measure(d01, np.zeros((3, 4)))
    with pytest.raises(ValueError, match="not finite"):
        smartvis.measure(d01, np.full((96, 96), np.nan))
    with pytest.raises(ValueError, match="turned view"):
        smartvis.measure(d01, d01.clip(view=(0, 0, -1)))
    monkeypatch.setenv("SMARTVIS_HOST_SIM", "/nowhere/host_sim")
    with pytest.raises(HostError, match="SMARTVIS_HOST_SIM=/nowhere/host_sim"):
        smartvis.scene("D01")
