# SPDX-License-Identifier: MIT
"""The files of ../shared/cases, which users elsewhere have, where they are at hand: smartvis clip, batch and host_sim
run find the surface where it lies in a plain file of the same scene, or say one true sentence."""

import csv
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import SOURCE
from test_kinds import MM, host, meta

import smartvis
from smartvis._study import folder_of
from smartvis.cli import main

CASES = SOURCE / "../shared/cases"
ROWS = {  # name: volumes, and what is said; "": the surface is where the plain file's is
    "enhanced.dcm": (1, ""), "enhanced_t.dcm": (3, ""), "folder_enh": (3, ""), "folder_time": (3, ""),
    "um.nrrd": (1, ""), "rgb.nrrd": (1, ""), "outside_16.mha": (1, ""), "db_nan.mha": (1, ""),
    "db_999.mha": (1, ""), "supra.mhd": (3, ""), "nospace.mha": (1, "does not say how far apart its voxels are"),
    "nospace.nrrd": (1, "does not say how far apart its voxels are"),
    "plus_reconstructed.mha": (1, "The scan narrows towards -z"),
}  # fmt: skip
NEAR_MM = 1.5  # other levels, and the scenes of supra.mhd and of times are not the very same volume
FEW = ("--frames", 1, "--setting", "smartvis", "--picture", 32, "--few-pictures", "--write", "depthmap", "--out")


def read(path: Path) -> np.ndarray:
    return sitk.GetArrayFromImage(sitk.ReadImage(str(path)))


@pytest.fixture(scope="module")
def plain_mm(tmp_path_factory) -> float:
    path = tmp_path_factory.mktemp("plain") / "plain.mha"
    meta(path, smartvis.scene("D01", size=96).full[::2], MM)
    return float(smartvis.clip(path).depth_mm.mean())


@pytest.mark.skipif(not CASES.is_dir(), reason="../shared/cases is not at hand")
@pytest.mark.parametrize("name", ROWS)
def test_what_users_have_is_read_right_or_said(name: str, plain_mm: float, tmp_path: Path, capsys) -> None:
    count, words = ROWS[name]
    path = CASES / name
    assert main(["clip", str(path), "--out", str(tmp_path), "--write", "depth"]) == 0
    said = {"clip": "".join(capsys.readouterr())}
    maps = [read(one)[-1] for one in sorted(tmp_path.glob("*_depth.nrrd"))]
    assert len(maps) == count
    assert main(["batch", str(path), "--out", str(tmp_path / "batch"), "--workers", "1", "--write", "depth"]) == 0
    with open(tmp_path / "batch" / "table.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    said["batch"] = str(rows)
    for row, depth in zip(rows, maps, strict=True):
        assert np.array_equal(read(folder_of(tmp_path / "batch", Path(row["file"])) / row["files"])[-1], depth)
    code, said["run"] = host("run", "--volume", path, *FEW, tmp_path / "run")
    if path.suffix in (".mha", ".mhd"):
        assert code == 0 and np.array_equal(read(tmp_path / "run/depthmap.mha").reshape(-1, *maps[0].shape)[0], maps[0])
    else:
        assert "'smartvis clip' of the Python package" in said.pop("run")
    for door, text in said.items():
        assert (words in text) if words else ("--spacing X,Y,Z" not in text), (door, text)
    if not words:
        assert [float(depth.mean()) for depth in maps] == pytest.approx([plain_mm] * count, abs=NEAR_MM)
