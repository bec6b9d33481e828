# SPDX-License-Identifier: MIT
"""The same bits as host_sim run --write for the same file: depthmap, confidence, status, mask and clipped volume."""

from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import host_sim

import smartvis

SIZE = 64


def read(folder: Path, name: str) -> np.ndarray:
    return sitk.GetArrayFromImage(sitk.ReadImage(str(folder / f"{name}.mha")))


@pytest.fixture(scope="module")
def scan(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("scene")
    host_sim("scenes", "M02", "--size", SIZE, "--export", "--out", folder)
    return folder / "M02_full.mha"


@pytest.mark.parametrize("method", ["mean", "wall"])
def test_the_host_and_python_give_the_same_bits(scan: Path, tmp_path: Path, method: str) -> None:
    kinds = ["depthmap", "status", "clipped", "mask"] + ["confidence"] * (method != "mean")
    what = ["--set", f"method={method}", "--set", "q=0.4", "--write", ",".join(kinds), "--out", tmp_path]
    host_sim("run", "--volume", scan, "--picture", 32, "--frames", 1, "--setting", "smartvis", *what)
    image = sitk.ReadImage(str(scan))
    result = smartvis.clip(image, method=method, q=0.4)
    assert result.clips
    assert np.array_equal(read(tmp_path, "depthmap")[0], result.depth_mm)  # the host writes millimetres
    assert np.array_equal(read(tmp_path, "status")[0], result.status)
    if method != "mean":
        assert result.confidence is not None
        assert np.array_equal(read(tmp_path, "confidence")[0], result.confidence)
    assert np.array_equal(read(tmp_path, "mask") > 0, result.mask())
    assert np.array_equal(read(tmp_path, "clipped"), sitk.GetArrayFromImage(result.apply(image)))
