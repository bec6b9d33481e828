# SPDX-License-Identifier: MIT
"""The table of what users have, in Python: every kind of file is clipped as the plain one is, or refused in one true
sentence. test_doors has it at every door."""

import itertools
import locale
import os
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
import tifffile
from conftest import LONG, host
from makers import SPACING, nrrd, written
from makers_dicom import by_offset, by_table, enhanced
from users import NAMES, RIGHT, SAID, TOLD, expected

import smartvis
from smartvis import _content, _images, _process
from smartvis._errors import FileError
from smartvis._files import Source
from smartvis.cli import main


@pytest.fixture(scope="module")
def scan() -> np.ndarray:
    return smartvis.scene("D01", size=96).full[::2]


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_is_not_the_content_is_told_as_such(tmp_path: Path, scan: np.ndarray, name: str, capsys) -> None:
    make, words = NAMES[name]
    make(tmp_path / name, scan)
    assert main(["clip", str(tmp_path / name), "--out", str(tmp_path / "out")]) == 3
    told = capsys.readouterr().err
    assert words in told and told.count("\n") == 1 and "itk" not in told, told
    if name == "._a.mha":
        assert "is what macOS keeps beside a file" in host("info", tmp_path / name)[1]


HEADS = {  # first bytes, and what they are by the machine and by Python
    b"BZh91AY&SY": "compressed as a whole",
    b"\xfd7zXZ\0\0": "compressed as a whole",
    b"7z\xbc\xaf\x27\x1c": "compressed as a whole",
    b"\x28\xb5\x2f\xfd\0": "compressed as a whole",
    b"Rar!\x1a\7": "compressed as a whole",
    b"\x1f\x8b\x08\0": "compressed as a whole",
    b"\x89HDF\r\n\x1a\n": "HDF5",
    b"\x93NUMPY\1\0": "array of NumPy",
    b"%PDF-1.7\n": "a PDF document",
    b"\xff\xfeN\0D\0": "text in UTF-16",
    b"\xfe\xff\0N\0D": "text in UTF-16",
    b"\xef\xbb\xbfNDims = 3\n": "a byte order mark",
    b"\0\0\0\x20ftypisom": "a video",
    b"BM\0\0": "a picture",
    b"\x89PNG": "a picture",
    b'\n<?xml version="1.0"?>\n<Error/>': "XML",
    b'<VTKFile type="ImageData">': "VTK's XML format",
    b' {"error": "not found"}': "JSON",
    b"<!DOCTYPE html>": "a web page",
    b"version https://git-lfs.github.com": "a pointer of Git LFS",
    b"\0\5\x16\7": "what macOS keeps beside a file",
}


@pytest.mark.parametrize("head", HEADS)
def test_what_is_no_volume_is_named_by_machine_and_package(tmp_path: Path, head: bytes) -> None:
    for name in ("scan.mha", "scan.nrrd", "scan.nii"):
        (tmp_path / name).write_bytes(head + bytes(400))
        with pytest.raises(FileError, match=HEADS[head]):
            _content.check(tmp_path / name)
    code, told = host("info", tmp_path / "scan.mha")
    assert code == 3 and f"{tmp_path / 'scan.mha'}: is " in told and HEADS[head] in told, told


@pytest.fixture(scope="module")
def plain_mm(scan: np.ndarray) -> float:
    return float(smartvis.clip(scan, SPACING).depth_mm.mean())


@pytest.mark.parametrize("name", RIGHT)
def test_every_kind_is_the_plain_file(tmp_path: Path, scan: np.ndarray, plain_mm: float, name: str) -> None:
    """The same voxels, or others of which the plugin gets the levels that are wanted."""
    RIGHT[name](tmp_path / name, scan)
    source = Source(tmp_path / name)
    several = {"times.dcm": 3, "folder": 2, "supra.mha": 2, "last.nrrd": 2}
    assert source.count == several.get(name, 1)
    for number in range(source.count):
        image = source.read(number)
        assert np.allclose(image.GetSpacing(), SPACING) and image.GetSize() == (96, 96, 48)
        assert _images.says_spacing(image) and not _images.said(image).told
        assert source.knows_patient == (name in ("series", "captures"))
        if not np.array_equal(sitk.GetArrayFromImage(image), scan):
            result = smartvis.clip(image)
            wanted = smartvis.clip(expected(name, scan), SPACING, scanned="zeros")
            assert np.array_equal(result.depth, wanted.depth) and not result.doubt
            assert name == "outside.mha" or abs(result.depth_mm.mean() - plain_mm) < 2


def test_volumes_follow_their_time(tmp_path: Path, scan: np.ndarray) -> None:
    times = [scan, scan // 2, scan // 3]
    by_offset(tmp_path / "any.dcm", times, np.random.default_rng(5))
    source = Source(tmp_path / "any.dcm")
    assert source.count == 3 and source.names == ["time offset 9.96", "time offset 10.0", "time offset 10.04"]
    for number, voxels in enumerate(times):
        assert np.array_equal(sitk.GetArrayFromImage(source.read(number)), voxels)


def test_slices_may_lie_near(tmp_path: Path, scan: np.ndarray) -> None:
    enhanced(tmp_path / "near.dcm", scan, step=(0, 0, 0.25))
    source = Source(tmp_path / "near.dcm")
    assert source.count == 1 and source.read().GetSpacing() == (1.25, 1.25, 0.25)


@pytest.mark.parametrize("name", SAID)
def test_what_is_not_so_is_said(tmp_path: Path, scan: np.ndarray, name: str, capsys) -> None:
    make, code, words = SAID[name]
    make(tmp_path / name, scan)
    command = ["clip", str(tmp_path / name), "--out", str(tmp_path / "out"), "--write", "mesh"]
    assert main(command) == code
    told = "".join(capsys.readouterr())
    assert words in told and name in told and "nrrd]" not in told, told
    if code == 0:
        assert main([*command, "--spacing", "1.25,1.25,2.5"]) == 0
        told = "".join(capsys.readouterr())
        assert words not in told and " mm on average" in told


@pytest.mark.parametrize("name", TOLD)
def test_which_of_two_truths_counts_is_told(tmp_path: Path, scan: np.ndarray, name: str) -> None:
    make, words = TOLD[name]
    make(tmp_path / name, scan)
    image = Source(tmp_path / name).read()
    assert _images.said(image).told == words and np.allclose(image.GetSpacing(), SPACING)


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".nii.gz"])
def test_what_is_written_says_no_spacing_that_nobody_knows(tmp_path: Path, scan: np.ndarray, suffix: str) -> None:
    nrrd(tmp_path / "scan.nrrd", scan)
    command = ["clip", str(tmp_path / "scan.nrrd"), "--out", str(tmp_path), "--format", suffix]
    for more, told in (([], False), (["--spacing", "1.25,1.25,2.5"], True)):
        assert main([*command, "--write", "clipped,depth", *more]) == 0
        for product in ("clipped", "depth"):
            image = Source(tmp_path / f"scan_{product}{suffix}").read()
            assert _images.says_spacing(image) == told
            assert np.allclose(image.GetSpacing()[:2], SPACING[:2] if told else (1, 1))
            voxels = sitk.GetArrayFromImage(image)
            assert voxels.shape[1:] == (96, 96) and voxels.max() > 20


def test_a_table_of_values_counts(tmp_path: Path, scan: np.ndarray) -> None:
    by_table(tmp_path / "table.dcm", scan)
    assert np.array_equal(sitk.GetArrayFromImage(Source(tmp_path / "table.dcm").read()), scan)


def test_a_library_that_dies_takes_one_file(tmp_path: Path, scan: np.ndarray, capsys, monkeypatch) -> None:
    """The reader's own function that dies on purpose stands for it."""
    for name in ("dies.nrrd", "good.nrrd"):
        written(scan, tmp_path / name)
    ask = _process.ask

    def one_dies(what: str, path: object, *more: Any) -> Any:
        return ask("crash", path) if Path(str(path)).name == "dies.nrrd" else ask(what, path, *more)

    monkeypatch.setattr(_process, "ask", one_dies)
    command = ["clip", str(tmp_path / "dies.nrrd"), str(tmp_path / "good.nrrd"), "--out", str(tmp_path / "o")]
    assert main(command) == 3
    told = "".join(capsys.readouterr())
    assert "dies.nrrd: the library that reads it crashes at it (SIGABRT)" in told, told
    assert "good.nrrd: 96 x 96 x 48, OK" in told and "Traceback" not in told, told


def test_forked_processes_are_told_and_spawned_ones_work(tmp_path: Path) -> None:
    code = """
import multiprocessing, sys, numpy, smartvis
def work(_):
    try:
        return smartvis.clip(numpy.zeros((16, 16, 16), numpy.uint8)).outcome.name
    except RuntimeError as error:
        return str(error)
if __name__ == "__main__":
    work(0)
    for way in ("fork", "spawn", "forkserver"):
        with multiprocessing.get_context(way).Pool(1) as pool:
            print(way, pool.map_async(work, [0]).get(600)[0])
"""
    (tmp_path / "program.py").write_text(code)
    command = [sys.executable, "-P", str(tmp_path / "program.py")]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=False)
    lines = dict(line.split(" ", 1) for line in ended.stdout.splitlines())
    assert "before this process was forked" in lines["fork"] and "spawn" in lines["fork"], ended.stderr
    assert lines["spawn"] == lines["forkserver"] == "NO_SURFACE"


def test_a_comma_for_a_decimal_mark_changes_nothing(
    tmp_path: Path, scan: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As Qt sets it. ITK would read a spacing of 1, 1, 2, and write it."""

    command = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(tmp_path / "comma")]
    said = subprocess.run(command, capture_output=True, text=True, check=False).stderr  # also of what is no failure
    before = locale.setlocale(locale.LC_NUMERIC)
    written(scan, tmp_path / "scan.nrrd")
    monkeypatch.setenv("LOCPATH", str(tmp_path))
    try:
        locale.setlocale(locale.LC_NUMERIC, "comma")
    except locale.Error:
        assert not os.environ.get("SV_SKIP_NOTHING"), said
        pytest.skip(f"no locale with a comma can be made of what Debian's package locales has: {said.strip()[-200:]}")
    try:
        assert locale.localeconv()["decimal_point"] == ","
        assert Source(tmp_path / "scan.nrrd").read().GetSpacing() == SPACING
        assert main(["clip", str(tmp_path / "scan.nrrd"), "--out", str(tmp_path), "--write", "clipped"]) == 0
    finally:
        locale.setlocale(locale.LC_NUMERIC, before)
    assert sitk.ReadImage(str(tmp_path / "scan_clipped.nrrd")).GetSpacing() == SPACING


def test_a_fill_value_far_away_costs_no_bins(tmp_path: Path, scan: np.ndarray) -> None:
    wide = scan.astype(np.int32)
    wide[20, 40, 40] = -300_000_000
    written(wide, tmp_path / "wide.nrrd")
    command = ["clip", str(tmp_path / "wide.nrrd"), "--out", str(tmp_path), "--write", "mesh", "--window", "0,255"]
    assert main(command) == 0
    assert (tmp_path / "wide_mesh.ply").stat().st_size > 10_000


def test_pages_that_never_end_are_noticed(tmp_path: Path, scan: np.ndarray) -> None:
    """No file that keeps a library busy is made here."""
    for large in (False, True):
        tifffile.imwrite(tmp_path / "scan.tif", scan[:4], bigtiff=large, photometric="minisblack")
        pages = list(_content.pages_of_tiff(tmp_path / "scan.tif"))
        assert pages == [page.offset for page in tifffile.TiffFile(tmp_path / "scan.tif").pages]
        assert not _content.in_circle(pages) and _content.in_circle([*pages, pages[-1]])
        assert _content.in_circle(itertools.cycle(pages))


@pytest.mark.parametrize("order", "<>")
def test_a_header_beside_its_voxels_tells_what_they_are(tmp_path: Path, order: str) -> None:
    for size, at, mark, words in (
        (348, 344, b"ni1", ""),
        (348, 344, b"\0\0\0", "Analyze 7.5"),
        (540, 4, b"ni2", "NIfTI-2"),
    ):
        head = bytearray(600)
        struct.pack_into(f"{order}i", head, 0, size)
        head[at : at + 3] = mark
        (tmp_path / "scan.hdr").write_bytes(head)
        (tmp_path / "scan.img").write_bytes(bytes(8))
        for path in (tmp_path / "scan.hdr", tmp_path / "scan.img"):
            if words:
                with pytest.raises(FileError, match=words):
                    _content.check(path)
            else:
                _content.check(path)


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        ("dataset structured_points\npoint_data 8\nscalars v unsigned_char\n", ""),
        ("dataset structured_points\ncell_data 8\nscalars v unsigned_char\n", "belong to cells"),
        ("dataset structured_points\npoint_data 8\nfield v 1\n", "in a FIELD"),
        ("dataset polydata\n", "its dataset is polydata"),
    ],
)
def test_words_of_vtk_may_be_small(tmp_path: Path, rest: str, words: str) -> None:
    path = tmp_path / "scan.vtk"
    path.write_text(f"# vtk DataFile Version 3.0\nscan\nBINARY\n{rest}")
    if words:
        with pytest.raises(FileError, match=words):
            _content.check(path)
    else:
        _content.check(path)


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("large", [False, True])
def test_a_page_that_follows_itself_is_a_circle(tmp_path: Path, order: str, large: bool) -> None:
    """Of TIFF and BigTIFF, of either byte order."""
    place, count = (f"{order}Q", f"{order}Q") if large else (f"{order}I", f"{order}H")
    head = b"II" if order == "<" else b"MM"
    head += struct.pack(f"{order}HHH", 43, 8, 0) if large else struct.pack(f"{order}H", 42)
    at = len(head) + struct.calcsize(place)
    path = tmp_path / "scan.tif"
    path.write_bytes(head + struct.pack(place, at) + struct.pack(count, 0) + struct.pack(place, at))
    with pytest.raises(FileError, match="in a circle"):
        _content.check(path)
