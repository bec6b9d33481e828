# SPDX-License-Identifier: MIT
"""Where the probe was: as an Enhanced US Volume says it, and told as assumed at every door where nobody says it."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pydicom
import pytest
import SimpleITK as sitk
from conftest import host, host_sim, layers
from makers import SPACING, written
from makers_dicom import enhanced
from pyigtl.messages import ImageMessage

import smartvis
from smartvis import _images
from smartvis._files import Source
from smartvis._seen import Levels
from smartvis._work import Settings
from smartvis.cli import main
from smartvis.serve import Budget, Session

BOX = np.array(SPACING) * (96, 96, 48)


@pytest.fixture(scope="module")
def scan() -> np.ndarray:
    """A box that is full, so that its outline tells nothing; the probe at slice 0."""
    return layers((48, 96, 96))


def said(path: Path, voxels: np.ndarray, **more: object) -> smartvis.Result:
    """Of a file in which the first voxel is at 0, with more of the module Ultrasound Frame of Reference."""
    enhanced(path, voxels)
    data = pydicom.dcmread(path)
    for name, value in more.items():
        setattr(data, name, value)
    data.save_as(path)
    return smartvis.clip(Source(path).only())


def at_apex(*place: float) -> dict[str, object]:
    return {"UltrasoundAcquisitionGeometry": "APEX", "ApexPosition": list(place)}


def mapped(depth: Sequence[float], face: Sequence[float]) -> dict[str, object]:
    """A transducer whose face is there and looks there: y is normal to it."""
    y = np.array(depth, float)
    x = np.roll(np.abs(y), 1)
    turn = np.stack([x, y, np.cross(x, y)])
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, -turn @ np.array(face, float)
    return {"VolumeToTransducerMappingMatrix": matrix.ravel().tolist(), "VolumeToTransducerRelationship": "FIXED"}


def test_the_probe_is_where_the_apex_is(tmp_path: Path, scan: np.ndarray) -> None:
    near = said(tmp_path / "near.dcm", scan, **at_apex(59, 59, -40))
    far = said(tmp_path / "far.dcm", scan[::-1], **at_apex(59, 59, 157.5))
    assert near.beams.startswith("a fan from -z: lines from 39 mm")
    assert far.beams.startswith("a fan from +z: lines from 39 mm")
    assert near.clips and far.clips
    plain = smartvis.clip(scan[::-1], SPACING, probe="+z")
    assert far.depth_mm.mean() == pytest.approx(plain.depth_mm.mean(), abs=1)
    assumed = smartvis.clip(scan[::-1], SPACING)
    assert "-z is assumed" in assumed.beams and abs(assumed.depth_mm.mean() - plain.depth_mm.mean()) > 5


def test_the_plugin_is_told_the_apex(tmp_path: Path, scan: np.ndarray) -> None:
    said(tmp_path / "far.dcm", scan[::-1], **at_apex(69, 59, 157.5))
    image = Source(tmp_path / "far.dcm").only()
    apex = _images.said(image).apex
    assert apex == pytest.approx((69 + 0.625, 59 + 0.625, 157.5 + 1.25))
    grid = Levels(_images.array(image), SPACING, side="+z", apex=apex).plan()
    (x, y, z), sweep = grid.beams
    pixel = grid.box[0] / grid.shape[2]
    # From +z the camera's right is the volume's -x: the apex is 9.625 mm to the left of the middle.
    assert x == pytest.approx(grid.box[0] / 2 - pixel / 2 - 9.625, abs=1e-3)
    assert y == pytest.approx(grid.box[0] / 2 - pixel / 2 - 0.375, abs=1e-3)
    assert z == pytest.approx((grid.box[1] - 120) / 2 - 38.75 - grid.box[1] / grid.shape[0] / 2, abs=1e-3)
    assert sweep == 0


@pytest.mark.parametrize(
    ("more", "beams"),
    [
        (at_apex(-60, 59, 60), "a fan from -x"),
        (at_apex(59, 59, 2), "a fan from -z: lines from 0 mm"),  # inside, and close to a side
        (at_apex(59, 59, 60), "unknown; nobody says"),  # in the middle
        (at_apex(59, 59), "unknown; nobody says"),
        ({"ApexPosition": [59.0, 59.0, -40.0], "UltrasoundAcquisitionGeometry": "PATIENT"}, "unknown; nobody says"),
        (mapped((0, 0, -1), (59, 59, 120)), "parallel, from +z"),
        (mapped((0, 0, 1), (59, 59, 120)), "parallel, from +z"),  # the face's place counts
        (mapped((0, 1, 0), (59, -9, 60)), "parallel, from -y"),
        (mapped((0, 1, 0), (59, 59, 60)), "parallel, from -y"),  # no place: it looks along y
        (mapped((0, 0, -1), (59, 59, 120)) | at_apex(59, 59, 150), "a fan from +z"),
        ({"VolumeToTransducerMappingMatrix": [0.0] * 16}, "unknown; nobody says"),
    ],
)
def test_a_side_is_what_the_file_says(tmp_path: Path, scan: np.ndarray, more: dict[str, object], beams: str) -> None:
    assert said(tmp_path / "a.dcm", scan, **more).beams.startswith(beams)


def test_the_apex_is_in_the_volumes_own_frame(tmp_path: Path, scan: np.ndarray) -> None:
    """Beside a place in the patient, that runs the other way."""
    enhanced(tmp_path / "a.dcm", scan)
    data = pydicom.dcmread(tmp_path / "a.dcm")
    for number, frame in enumerate(data.PerFrameFunctionalGroupsSequence):
        place = pydicom.Dataset()
        place.ImagePositionPatient = [10, 20, 300 - 2.5 * number]
        frame.PlanePositionSequence = [place]
    across = pydicom.Dataset()
    across.ImageOrientationPatient = [1, 0, 0, 0, -1, 0]
    data.SharedFunctionalGroupsSequence[0].PlaneOrientationSequence = [across]
    data.UltrasoundAcquisitionGeometry, data.ApexPosition = "APEX", [59.0, 59.0, 157.5]
    data.save_as(tmp_path / "a.dcm")
    source = Source(tmp_path / "a.dcm")
    assert smartvis.clip(source.only()).beams.startswith("a fan from +z: lines from 39 mm")
    assert source.knows_patient


def test_what_is_assumed_of_the_probe_is_told_at_every_door(tmp_path: Path, scan: np.ndarray, capsys) -> None:
    host_sim("scenes", "D01", "--size", 96, "--export", "--out", tmp_path)
    written(scan, tmp_path / "box.mha")
    doors = {
        "box.mha": "nobody says where the probe was: -z is assumed",
        "D01_full.mha": "from -z, which the scan narrows to",
    }
    batched = ["batch", *(str(tmp_path / name) for name in doors), "--out", str(tmp_path / "o"), "--workers", "1"]
    assert main([*batched, "--write", "depth"]) == 0
    with open(tmp_path / "o" / "table.csv", newline="") as table:
        rows = {Path(row["file"]).name: row["beams"] for row in csv.DictReader(table)}
    page = (tmp_path / "o" / "index.html").read_text()
    for name, words in doors.items():
        path = tmp_path / name
        capsys.readouterr()
        assert main(["clip", str(path), "--out", str(tmp_path / "c"), "--write", "depth"]) == 0
        image = sitk.ReadImage(str(path))
        voxels, matrix = sitk.GetArrayFromImage(image), np.diag([*image.GetSpacing(), 1])
        message = ImageMessage(voxels, ijk_to_world_matrix=matrix, device_name="Scan")
        told = {
            "clip": capsys.readouterr().out,
            "info": host("info", path)[1],
            "run": host("run", "--volume", path, "--frames", 1, "--setting", "smartvis", "--picture", 32,
                        "--few-pictures", "--out", tmp_path / "r")[1],
            "batch": rows[name],
            "page": page,
            "serve": Session(Settings(), Budget(1 << 40, 1 << 40)).answer(message)[-1].string,
            "clip()": smartvis.clip(image).beams,
        }  # fmt: skip
        for door, text in told.items():
            assert words in text, (door, name, text)
    parts = ",".join(str(tmp_path / f"D01_{part}.mha") for part in ("full", "truth", "label"))
    assert doors["D01_full.mha"] in host("measure", "--case", parts, "-")[1]
    assert main(["clip", str(tmp_path / "box.mha"), "--out", str(tmp_path / "c"), "--probe", "-z"]) == 0
    assert "Beams: parallel, from -z" in capsys.readouterr().out
