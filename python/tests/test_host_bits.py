# SPDX-License-Identifier: MIT
"""The same bits as host_sim run --write for the same file: depthmap, confidence, status, mask, surface and clipped
volume.
Requirement: R15."""

from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import FETUS, FLUID, host_sim, layers

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
    kinds = ["depthmap", "status", "clipped", "mask", "surface"] + ["confidence"] * (method != "mean")
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
    vertices, triangles = result.surface()
    ply = (tmp_path / "surface.ply").read_bytes()
    corners = np.array([3], np.uint8)
    faces = b"".join(corners.tobytes() + face.astype("<i4").tobytes() for face in triangles)
    assert ply.endswith(b"end_header\n" + vertices.astype("<f4").tobytes() + faces)
    assert np.array_equal(read(tmp_path, "clipped"), sitk.GetArrayFromImage(result.apply(image)))


def test_marks_are_those_of_the_host(tmp_path: Path) -> None:
    """A cord of tissue lies in the fluid; behind the fetus are fluid and a wall."""
    cord = layers((64, 56, 56), 0.1, 0.5)
    cord[20:26, 24:32, :] = FETUS
    cord[46:54] = FLUID
    plain = smartvis.clip(cord, spacing=(1, 1, 1), method="wall")
    remove, keep = [(28.0, 28.0, 20.0, 6.0), (28.0, 28.0, 38.0)], [(10.0, 44.0, 2.0, 4.0)]
    marked = smartvis.clip(cord, spacing=(1, 1, 1), method="wall", remove=remove, keep=keep)
    deeper, nearer = marked.depth > plain.depth, marked.depth < plain.depth
    y, x = np.mgrid[:56, :56]
    assert deeper.any() and not deeper[np.hypot(x - 28, y - 28) > 6].any()
    assert nearer.any() and not nearer[np.hypot(x - 10, y - 44) > 4].any()
    assert marked.mask().sum() != plain.mask().sum()

    sitk.WriteImage(sitk.GetImageFromArray(cord), str(tmp_path / "v.mha"))
    marks = [f"--remove={','.join(map(str, mark))}" for mark in remove]
    marks += [f"--keep={','.join(map(str, mark))}" for mark in keep]
    host_sim("run", "--volume", tmp_path / "v.mha", "--set", "method=wall", "--setting", "smartvis", "--frames", 1,
             "--few-pictures", "--write", "depthmap", "--out", tmp_path, *marks)  # fmt: skip
    assert np.array_equal(read(tmp_path, "depthmap")[0], marked.depth_mm)
