# SPDX-License-Identifier: MIT
"""Sequences as one NRRD, which 3D Slicer and SimpleITK read, and what peers cut out of a sequence of ours."""

from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import host_sim, layers
from makers import meta

import smartvis
from smartvis._errors import FileError
from smartvis._files import Source
from smartvis._geometry import check_kinds
from smartvis.cli import main

TURN = "TransformMatrix = 0 1 0 0 -1 0 0 0 0 0 1 0 0 0 0 1"
MORE = ("ElementSpacing = 1.25 1.25 2.5 1", "Offset = 1 2 3 0", "Kinds = domain domain domain list",
        "Seq_Frame0000_ImageStatus = OK", "Seq_Frame0001_ImageStatus = OK")  # fmt: skip


@pytest.fixture(scope="module")
def scan() -> np.ndarray:
    return layers((48, 96, 96))


@pytest.mark.parametrize(("letters", "said"), [("RAI?", True), ("????", False)])
def test_a_sequence_becomes_one_file(tmp_path: Path, scan: np.ndarray, letters: str, said: bool) -> None:
    meta(tmp_path / "beat.mha", scan, TURN, f"AnatomicalOrientation = {letters}", *MORE, frames=2)
    command = ["clip", str(tmp_path / "beat.mha"), "--out", str(tmp_path), "--write", "clipped,depth,mask"]
    assert main([*command, "--format", ".seq.nrrd"]) == 0
    assert main([*command, "--format", ".nrrd"]) == 0
    for product in ("clipped", "depth", "mask"):
        whole = Source(tmp_path / f"beat_{product}.seq.nrrd")
        assert whole.count == 2
        for number in range(2):
            alone, image = Source(tmp_path / f"beat_f{number:04d}_{product}.nrrd"), whole.read(number)
            one = alone.read()
            assert np.array_equal(sitk.GetArrayFromImage(image), sitk.GetArrayFromImage(one))
            for get in ("GetSpacing", "GetOrigin", "GetDirection"):
                assert np.allclose(getattr(image, get)(), getattr(one, get)(), atol=1e-6), (product, get)
            assert whole.knows_patient == alone.knows_patient == said
    peer = sitk.ReadImage(str(tmp_path / "beat_clipped.seq.nrrd"))
    assert peer.GetSize()[:3] == (96, 96, 48) and peer.GetNumberOfComponentsPerPixel() == 2
    assert np.allclose(peer.GetSpacing()[:3], (1.25, 1.25, 2.5)) and np.allclose(peer.GetOrigin()[:3], (1, 2, 3))
    assert not list(tmp_path.glob(".part-*"))


def test_a_sequence_of_which_a_volume_fails_is_not_written(tmp_path: Path, scan: np.ndarray, capsys) -> None:
    """Its second volume has nothing to be mapped to levels."""
    flat = np.stack([scan.astype("<f4"), np.full(scan.shape, np.nan, "<f4")])
    image = sitk.JoinSeries([sitk.GetImageFromArray(part) for part in flat])
    sitk.WriteImage(image, str(tmp_path / "beat.nii"))
    command = ["clip", str(tmp_path / "beat.nii"), "--out", str(tmp_path / "o"), "--write", "clipped"]
    assert main([*command, "--format", ".seq.nrrd"]) == 3
    assert "beat_clipped.seq.nrrd: not written, since volumes of it failed" in capsys.readouterr().err
    assert not list((tmp_path / "o").iterdir())


def test_what_is_cut_out_of_a_sequence_is_read(tmp_path: Path, scan: np.ndarray) -> None:
    """A peer keeps what our file says of all volumes."""
    meta(tmp_path / "beat.mha", scan, TURN, "AnatomicalOrientation = RAI?", *MORE, frames=2)
    host_sim("run", "--volume", tmp_path / "beat.mha", "--frames", 2, "--setting", "smartvis", "--picture", 32,
             "--few-pictures", "--write", "clipped", "--out", tmp_path)  # fmt: skip
    whole = sitk.ReadImage(str(tmp_path / "clipped.mha"))
    part = whole[:, :, :, 1]
    for key in ("Kinds", "Seq_Frame0000_ImageStatus", "Seq_Frame0001_ImageStatus"):
        part.SetMetaData(key, whole.GetMetaData(key))
    sitk.WriteImage(part, str(tmp_path / "part.mha"))
    source = Source(tmp_path / "part.mha")
    image = source.read()
    assert source.count == 1 and source.knows_patient
    assert np.array_equal(sitk.GetArrayFromImage(image), sitk.GetArrayFromImage(part))
    assert smartvis.clip(image).spacing_known


def test_which_axis_of_a_nrrd_may_be_time() -> None:
    """ITK takes a list of values at each voxel for it, too; 3D Slicer writes sequences so."""
    path = Path("scan.nrrd")
    for kinds, over_time in [("list domain domain domain", True), ("domain domain domain", False)]:
        assert check_kinds(path, {"kinds": kinds}) is over_time
    for kinds, axis in [("time domain domain domain", 1), ("domain list domain domain", 2)]:
        with pytest.raises(FileError, match=f"axis {axis} is time, expected the last one"):
            check_kinds(path, {"kinds": kinds})
