# SPDX-License-Identifier: MIT
"""What a file says of how its volume lies in the patient, through all doors: what is not said stays not said, what is
said in two ways is told."""

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import host, host_sim, layers
from makers import meta, nrrd
from makers_dicom import enhanced

import smartvis
from smartvis import _images
from smartvis._files import Source, write_image
from smartvis.cli import main

FORMATS = (".mha", ".nrrd", ".nii.gz")
COS, SIN = np.cos(0.5), np.sin(0.5)
TURN = np.array([[COS, -SIN, 0], [SIN, COS, 0], [0, 0, 1]])
SPACING = (1.25, 1.25, 2.5)


def turned(path: Path, voxels: np.ndarray) -> None:
    """In the axes of ITK, which says that they are the patient's."""
    image = sitk.GetImageFromArray(voxels)
    image.SetSpacing(SPACING)
    image.SetOrigin((10, -20, 30))
    image.SetDirection(TURN.ravel())
    sitk.WriteImage(image, str(path))


def nobody_knew(path: Path, voxels: np.ndarray) -> None:
    turned(path, voxels)
    path.write_bytes(path.read_bytes().replace(b"AnatomicalOrientation = RAI", b"AnatomicalOrientation = ???"))


def other_space(path: Path, voxels: np.ndarray) -> None:
    turned(path, voxels)
    path.write_bytes(path.read_bytes().replace(b"left-posterior-superior", b"scanner-xyz"))


def machine_axes(path: Path, voxels: np.ndarray) -> None:
    """Those of the volume's own frame of reference."""
    enhanced(path, voxels, across=TURN[:, :2].T.ravel().tolist())


@pytest.fixture(scope="module")
def scan() -> np.ndarray:
    return layers((48, 96, 96))


def facts(path: Path) -> tuple[bool, np.ndarray, np.ndarray]:
    """Whether it says how it lies in the patient, and where it lies."""
    source = Source(path)
    image = source.read()
    return source.knows_patient, np.array(image.GetDirection()), np.array(image.GetOrigin())


@pytest.mark.parametrize(
    ("name", "make", "said"),
    [("a.mha", turned, True), ("b.nrrd", turned, True), ("c.nii.gz", turned, True), ("d.mha", nobody_knew, False),
     ("e.nrrd", other_space, False), ("f.dcm", machine_axes, False)],
)  # fmt: skip
def test_a_result_says_no_more_of_the_patient_than_its_source(
    tmp_path: Path, scan: np.ndarray, name: str, make: Callable[[Path, np.ndarray], None], said: bool
) -> None:
    make(tmp_path / name, scan)
    first = facts(tmp_path / name)
    assert first[0] == said and np.allclose(first[1], TURN.ravel(), atol=1e-6)
    names = [tmp_path / name]
    for suffix in FORMATS:  # source -> result, by its door
        command = ["clip", str(tmp_path / name), "--out", str(tmp_path), "--write", "clipped,depth", "--format", suffix]
        assert main(command) == 0
        names.append(tmp_path / f"{name.partition('.')[0]}_clipped{suffix}")
    for before in tuple(names):  # -> result of a result; and what SimpleITK makes of it
        for suffix in FORMATS:
            names.append(tmp_path / f"{before.name.replace('.', '_')}_again{suffix}")
            write_image(names[-1], Source(before).read())
            if before != names[0]:  # the source's words are not ours
                names.append(tmp_path / f"{before.name.replace('.', '_')}_itk{suffix}")
                sitk.WriteImage(sitk.ReadImage(str(before)), str(names[-1]))
    host_sim("run", "--volume", tmp_path / f"{name[0]}_clipped.mha", "--frames", 1, "--setting", "smartvis",
             "--picture", 32, "--few-pictures", "--write", "clipped", "--out", tmp_path / "run")  # fmt: skip
    names.append(tmp_path / "run/clipped.mha")
    for path in names:
        now = facts(path)
        assert now[0] == said, path.name
        assert np.allclose(now[1], first[1], atol=1e-5) and np.allclose(now[2], first[2], atol=1e-3), path.name
    assert Source(tmp_path / f"{name[0]}_depth.nrrd").read().HasMetaDataKey(_images.PLACE) == (not said)


def test_letters_without_a_matrix_count_at_no_door(tmp_path: Path, scan: np.ndarray, capsys) -> None:
    """As in ITK, 3D Slicer and all that stands on them: results lie on their source there."""
    path = tmp_path / "letters.mha"
    meta(path, scan, "ElementSpacing = 1.25 1.25 2.5", "AnatomicalOrientation = LPI")
    words = "AnatomicalOrientation says LPI instead: only TransformMatrix counts"
    assert words in host("info", path)[1]
    assert main(["clip", str(path), "--out", str(tmp_path), "--write", "clipped"]) == 0
    assert words in capsys.readouterr().out
    assert words in smartvis.clip(str(path)).doubt
    assert main(["clip", str(path), "--view", "anterior"]) == 3
    refused = ("letters.mha: does not say how it lies in the patient", "there is no view anterior")
    asked = host("run", "--volume", path, "--view", "anterior")
    told = capsys.readouterr().out
    for part in refused:
        assert part in told and part in asked[1] and asked[0] == 3
    assert facts(tmp_path / "letters_clipped.nrrd")[0] is False


@pytest.mark.parametrize("codes", [(1, 1), (1, 2), (2, 1), (2, 2), (0, 1), (1, 0)])
def test_two_places_in_a_nifti_are_told(tmp_path: Path, scan: np.ndarray, codes: tuple[int, int]) -> None:
    """The sform is turned by 30 degrees, 36 mm away."""
    path = tmp_path / "two.nii"
    image = sitk.GetImageFromArray(scan)
    image.SetSpacing(SPACING)
    image.SetOrigin((-1, -2, 3))
    image.SetDirection((-1, 0, 0, 0, -1, 0, 0, 0, 1))  # the patient's right, front and head
    sitk.WriteImage(image, str(path))
    data = bytearray(path.read_bytes())
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    rows = np.array([[cos, -sin, 0, 10], [sin, cos, 0, -20], [0, 0, 1, 30]]) * (*SPACING, 1)
    data[252:256] = struct.pack("<2h", *codes)
    data[280:328] = rows.astype("<f4").tobytes()
    path.write_bytes(data)
    image = Source(path).read()
    said = _images.said(image).told
    if 0 in codes:
        assert not said
        return
    taken = "qform" if np.allclose(image.GetOrigin(), (-1, -2, 3)) else "sform"
    assert f"disagree, by 30 degrees and 36 mm at the first voxel: the {taken} counts" in said
    assert said in smartvis.clip(image).doubt
    write_image(tmp_path / "again.nii", image)
    assert not _images.said(Source(tmp_path / "again.nii").read()).told


def test_a_nrrd_without_a_space_gives_results_without_one(tmp_path: Path, scan: np.ndarray) -> None:
    nrrd(tmp_path / "bare.nrrd", scan, "spacings: 1.25 1.25 2.5")
    assert main(["clip", str(tmp_path / "bare.nrrd"), "--out", str(tmp_path), "--write", "clipped"]) == 0
    assert b"left" not in (tmp_path / "bare_clipped.nrrd").read_bytes()[:600]
