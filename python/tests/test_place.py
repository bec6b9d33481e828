# SPDX-License-Identifier: MIT
"""What a file says of how its volume lies in the patient, through all doors: what is not said stays not said, what is
said in two ways is told."""

import itertools
import os
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import host, layers
from makers import meta, nrrd
from makers_dicom import enhanced
from result_doors import DOORS, SUFFIXES, takes

import smartvis
from smartvis import _images
from smartvis._files import Source, write_image
from smartvis.cli import main

COS, SIN = np.cos(0.5), np.sin(0.5)
TURN = np.array([[COS, -SIN, 0], [SIN, COS, 0], [0, 0, 1]])
SPACING = (1.25, 1.25, 2.5)
NIGHT = bool(os.environ.get("SV_NIGHT"))


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


SOURCES: dict[str, tuple[Callable[[Path, np.ndarray], None], bool]] = {
    "a.mha": (turned, True),
    "b.nrrd": (turned, True),
    "c.nii.gz": (turned, True),
    "d.mha": (nobody_knew, False),
    "e.nrrd": (other_space, False),
    "f.dcm": (machine_axes, False),
}


def trips(name: str) -> Iterator[tuple[str, str, str]]:
    """A door, its result's format and that of the result's result: at night all, by day each with some source."""
    if NIGHT:
        yield from itertools.product(DOORS, SUFFIXES, SUFFIXES)
        return
    for turn, door in enumerate(DOORS, list(SOURCES).index(name)):
        if door == "run":
            yield door, ".mha", ".mha"
        elif turn % 3 < 2 and (door != "batch" or name == "d.mha"):  # its workers take seconds to begin
            yield door, SUFFIXES[(turn + turn // 3) % 3], SUFFIXES[(turn + turn // 3 + 1) % 3]


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.night if NIGHT else ()) for name in SOURCES])
def test_a_result_says_no_more_of_the_patient_than_its_source(tmp_path: Path, scan: np.ndarray, name: str) -> None:
    """Nor does a result of a result, and of what SimpleITK makes of it. Other peers: scripts/peers/."""
    make, said = SOURCES[name]
    make(source := tmp_path / name, scan)
    first = facts(source)
    assert first[0] == said and np.allclose(first[1], TURN.ravel(), atol=1e-6)
    for number, (door, one, two) in enumerate(trips(name)):
        if not takes(door, source, one):
            continue
        folder = tmp_path / str(number)
        result = DOORS[door](source, folder / "result", one)
        sitk.WriteImage(sitk.ReadImage(str(result)), str(copy := folder / f"copy{two}"))
        came = [path for path in (result, copy) if takes(door, path, two)]
        again = [DOORS[door](path, folder / f"again_{path.stem}", two) for path in came]
        for path in (result, copy, *again):
            now = facts(path)
            assert now[0] == said, (door, path)
            assert np.allclose(now[1], first[1], atol=1e-5) and np.allclose(now[2], first[2], atol=1e-3), (door, path)


def test_a_depthmap_says_whose_axes_it_has(tmp_path: Path, scan: np.ndarray) -> None:
    for name in ("a.mha", "d.mha"):
        make, said = SOURCES[name]
        make(tmp_path / name, scan)
        assert main(["clip", str(tmp_path / name), "--out", str(tmp_path), "--write", "depth"]) == 0
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


def test_a_metaimage_keeps_all_digits_of_its_spacing(tmp_path: Path, scan: np.ndarray) -> None:
    """As the machine reads them: of a voxel that lies between two pixels a last digit decides to which it goes."""
    path, said = tmp_path / "scan.mha", ("0.5003821940361699", "0.50216141089195632", "0.5032360990282515")
    meta(path, scan, f"ElementSpacing = {' '.join(said)}")
    assert Source(path).read().GetSpacing() == tuple(map(float, said))
