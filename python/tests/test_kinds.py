# SPDX-License-Identifier: MIT
"""What users have, made of one scene: every kind of file is clipped as the plain one is, or refused in one true
sentence. test_doors has them at every door."""

import gzip
import os
import struct
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
import tifffile
from conftest import BUILD, LONG

import smartvis
from smartvis import _images, _process
from smartvis._files import Source
from smartvis.cli import main

Make = Callable[[Path, np.ndarray], None]
SPACING = (1.25, 1.25, 2.5)


@pytest.fixture(scope="module")
def scan() -> np.ndarray:
    return smartvis.scene("D01", size=96).full[::2]


def written(voxels: np.ndarray, path: Path, spacing: tuple[float, ...] = SPACING) -> None:
    image = sitk.GetImageFromArray(voxels)
    image.SetSpacing(spacing)
    sitk.WriteImage(image, str(path))


def meta(
    path: Path, voxels: np.ndarray, *lines: str, kind: str = "MET_UCHAR", frames: int = 1, data: str = "LOCAL"
) -> None:
    many = f" {frames}" if frames > 1 else ""
    head = [f"NDims = {3 + (frames > 1)}", f"DimSize = 96 96 48{many}", *lines, f"ElementType = {kind}"]
    path.write_bytes("\n".join([*head, f"ElementDataFile = {data}", ""]).encode() + voxels.tobytes() * frames)


def nrrd(path: Path, voxels: np.ndarray, *lines: str, sizes: str = "96 96 48", by: str = "raw") -> None:
    head = ["NRRD0005", "type: uchar", f"dimension: {len(sizes.split())}", f"sizes: {sizes}", f"encoding: {by}", *lines]
    path.write_bytes("\n".join([*head, "", ""]).encode() + voxels.tobytes())


def enhanced(
    path: Path, voxels: np.ndarray, times: int = 1, measures: bool = True, missing: int = -1, grey: str = "MONOCHROME2",
    step: Sequence[float] = (0.0, 0.0, 2.5), across: Sequence[float] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
    of_class: str = "6.2",
) -> None:  # fmt: skip
    """An Enhanced US Volume: spacing in the shared functional groups, place and time in those of each frame. Without a
    `step` only how thick they are."""
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import ExplicitVRLittleEndian, generate_uid

    def of(**fields: Any) -> Dataset:
        made = Dataset()
        for name, value in fields.items():
            setattr(made, name, value)
        return made

    where = [(t, z) for t in range(times) for z in range(48) if (t, z) != (0, missing)]
    shared = of(PlaneOrientationVolumeSequence=[of(ImageOrientationVolume=list(across))])
    if measures:
        apart = {"SpacingBetweenSlices": 2.5} if step else {}
        shared.PixelMeasuresSequence = [of(PixelSpacing=[1.25, 1.25], SliceThickness=2.5, **apart)]
    frames = [
        of(
            FrameContentSequence=[of(TemporalPositionIndex=t + 1, DimensionIndexValues=[t + 1, z + 1])],
            PlanePositionVolumeSequence=[of(ImagePositionVolume=[part * z for part in step])] if step else [],
        )
        for t, z in where
    ]
    kind = f"1.2.840.10008.5.1.4.1.1.{of_class}"
    data = of(SOPClassUID=kind, SOPInstanceUID=generate_uid(), Modality="US", SeriesInstanceUID=generate_uid())
    data.SamplesPerPixel, data.PhotometricInterpretation, data.NumberOfFrames = 1, grey, len(where)
    data.Rows, data.Columns, data.BitsAllocated, data.BitsStored, data.HighBit = 96, 96, 8, 8, 7
    data.PixelRepresentation, data.PixelData = 0, b"".join(voxels[z].tobytes() for _, z in where)
    data.SharedFunctionalGroupsSequence, data.PerFrameFunctionalGroupsSequence = [shared], frames
    data.file_meta = FileMetaDataset()
    data.file_meta.MediaStorageSOPClassUID, data.file_meta.TransferSyntaxUID = kind, ExplicitVRLittleEndian
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID
    data.save_as(path, enforce_file_format=True)


def folder_of(path: Path, voxels: np.ndarray) -> None:
    path.mkdir()
    enhanced(path / "segments.dcm", voxels, of_class="66.4")  # of a study, beside its volumes
    for number in range(2):
        enhanced(path / f"t{number}.dcm", voxels)


def odd_apart(path: Path, voxels: np.ndarray, length: float) -> None:
    """A NIfTI whose distances are 0 or no number, for which ITK says 1 mm."""
    written(voxels, path)
    data = bytearray(path.read_bytes())
    data[80:92], data[252:256] = 3 * struct.pack("<f", length), bytes(4)
    path.write_bytes(data)


def packed(path: Path, voxels: np.ndarray) -> None:
    path.write_bytes(gzip.compress(voxels.tobytes()))


def pictures_in(path: Path, voxels: np.ndarray) -> None:
    path.mkdir()
    for number, plane in enumerate(voxels[:3]):
        sitk.WriteImage(sitk.GetImageFromArray(plane), str(path / f"{number}.png"))


def vtk(path: Path, voxels: np.ndarray, of: str, more: int) -> None:
    """Legacy VTK as text: values of points, or of cells, of which each row has one less."""
    z, y, x = voxels.shape
    head = f"# vtk DataFile Version 3.0\nscan\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS {x + more} {y + more} "
    head += f"{z + more}\nSPACING 1.25 1.25 2.5\nORIGIN 0 0 0\n{of} {voxels.size}\nSCALARS v unsigned_char 1\n"
    rows = "\n".join(" ".join(map(str, row)) for row in voxels.reshape(-1, x))
    path.write_text(f"{head}LOOKUP_TABLE default\n{rows}\n")


def in_members(path: Path, voxels: np.ndarray) -> None:
    """A NIfTI in gzip in three pieces, as pigz and bgzip write it."""
    written(voxels, path)
    data = gzip.decompress(path.read_bytes())
    third = len(data) // 3
    pieces = (data[:third], data[third : 2 * third], data[2 * third :])
    path.write_bytes(b"".join(map(gzip.compress, pieces)))


def in_db(voxels: np.ndarray, outside: float) -> np.ndarray:
    return np.where(voxels > 0, voxels / 4.0 - 60.0, outside).astype("<f4")


def expected(name: str, voxels: np.ndarray) -> np.ndarray:
    """The levels that a plugin is to get: of dB by the range of what was scanned, else the voxels as they are."""
    if name == "outside.mha":
        return np.where(voxels, np.maximum(voxels, 17), 0).astype(np.uint8)
    if name == "white.nrrd":
        return np.where(voxels, np.minimum(voxels, 254), 0).astype(np.uint8)
    if name.startswith(("db", "inf")):
        low, high = voxels[voxels > 0].min(), voxels.max()
        levels = np.floor((voxels.astype(float) - low) / (float(high) - low) * 255 + 0.5)
        return np.where(voxels, np.maximum(levels, 1), 0).astype(np.uint8)
    return voxels


MM = "ElementSpacing = 1.25 1.25 2.5"
RIGHT: dict[str, Make] = {  # clipped as the plain file is
    "enhanced.dcm": enhanced,
    "times.dcm": lambda path, v: enhanced(path, v, times=3),
    "folder": folder_of,
    "outside.mha": lambda path, v: meta(path, np.where(v, expected(path.name, v), np.uint8(16)), MM),
    "white.nrrd": lambda path, v: written(np.where(v, expected(path.name, v), np.uint8(255)), path),
    "db_nan.mha": lambda path, v: meta(path, in_db(v, np.nan), MM, kind="MET_FLOAT"),
    "db_999.mha": lambda path, v: meta(path, in_db(v, -999), MM, kind="MET_FLOAT"),
    "inf.nrrd": lambda path, v: written(in_db(v, -np.inf), path),
    "grey.mha": lambda path, v: meta(path, np.repeat(v[..., None], 3, -1), MM, "ElementNumberOfChannels = 3"),
    "rgb.nrrd": lambda path, v: nrrd(
        path, np.repeat(v[..., None], 4, -1), "space: LPS", "kinds: RGBA-color domain domain domain",
        "space directions: none (1.25,0,0) (0,1.25,0) (0,0,2.5)", sizes="4 96 96 48"),
    "last.nrrd": lambda path, v: nrrd(
        path, np.stack([v, v]), "kinds: domain domain domain list", "spacings: 1.25 1.25 2.5 nan", sizes="96 96 48 2"),
    "ome.tif": lambda path, v: tifffile.imwrite(path, v, ome=True, metadata={"axes": "ZYX"} | {
        f"PhysicalSize{axis}": 1e3 * length for axis, length in zip("XYZ", SPACING, strict=True)}),
    "um.nrrd": lambda path, v: nrrd(
        path, v, "space: LPS", "space directions: (1250,0,0) (0,1250,0) (0,0,2500)", 'space units: "um" "um" "um"'),
    "cm.nrrd": lambda path, v: nrrd(
        path, v, "space: LPS", "space directions: (.125,0,0) (0,.125,0) (0,0,.25)", 'space units: "cm" "cm" "cm"'),
    "plus.mha": lambda path, v: meta(
        path, v, MM, "TransformMatrix = 1 0 0 0 1 0 0 0 1", "Kinds = domain domain domain",
        "AnatomicalOrientation = RAI", "UltrasoundImageOrientation = MFA", "Seq_Frame0000_ImageStatus = OK"),
    "supra.mha": lambda path, v: meta(
        path, v, MM + " 1", "TransformMatrix = 1 0 0 0 1 0 0 0 1", "Seq_Frame0000_Timestamp = 1",
        "Seq_Frame0001_Timestamp = 2", frames=2),
}  # fmt: skip


def coloured(path: Path, voxels: np.ndarray, planes: int) -> None:
    """Grey in YBR_FULL by RLE, of pixels or of planes: pydicom packs these as if they were pixels."""
    import pydicom

    enhanced(path, voxels)
    data = pydicom.dcmread(path)
    ybr = np.stack([voxels, np.full_like(voxels, 128), np.full_like(voxels, 128)], -1)
    data.SamplesPerPixel, data.PhotometricInterpretation, data.PlanarConfiguration = 3, "YBR_FULL", planes
    data.PixelData = (np.moveaxis(ybr, -1, 1) if planes else ybr).tobytes()
    data.compress(pydicom.uid.RLELossless, generate_instance_uid=False)
    data.save_as(path)


def by_table(path: Path, voxels: np.ndarray, entries: int = 256) -> None:
    """Its pixels stand for values of a table, which turns them round."""
    import pydicom

    enhanced(path, 255 - voxels)
    data, item = pydicom.dcmread(path), pydicom.Dataset()
    item.LUTDescriptor, item.ModalityLUTType = [256, 0, 12], "US"
    item.add_new(0x00283006, "OW", np.arange(256, dtype="<u2")[::-1][:entries].tobytes())
    data.ModalityLUTSequence = [item]
    data.save_as(path)


RIGHT |= {
    "rle.dcm": lambda path, v: coloured(path, v, 0),
    "rle_planes.dcm": lambda path, v: coloured(path, v, 1),
    "points.vtk": lambda path, v: vtk(path, v, "POINT_DATA", 0),
    "50%d.nrrd": lambda path, v: written(v, path),
    "members.nii.gz": in_members,
}
SAID: dict[str, tuple[Make, int, str]] = {  # a code, and the sentence
    "nospace.mha": (meta, 0, "does not say how far apart its voxels are"),
    "nospace.nrrd": (nrrd, 0, "does not say how far apart its voxels are"),
    "pages.tif": (lambda path, v: written(v, path), 0, "does not say how far apart its voxels are"),
    "bare.dcm": (lambda path, v: enhanced(path, v, measures=False), 0, "does not say how far apart"),
    "metres.mha": (lambda path, v: meta(path, v, "ElementSpacing = 1.25e-3 1.25e-3 2.5e-3"), 0, "spacing in metres?"),
    "zero.nii": (lambda path, v: odd_apart(path, v, 0), 0, "does not say how far apart its voxels are"),
    "nan.nii": (lambda path, v: odd_apart(path, v, np.nan), 0, "does not say how far apart its voxels are"),
    "none.nrrd": (
        lambda path, v: nrrd(path, v, "space: LPS", "space directions: (1.25,0,0) (0,1.25,0) none"), 0,
        "does not say how far apart its voxels are"),
    "thick.dcm": (lambda path, v: enhanced(path, v, step=()), 0, "does not say how far apart its voxels are"),
    "zero.nrrd": (lambda path, v: nrrd(path, v, "spacings: 0 0 0"), 3, "a spacing is 0, expected lengths above 0"),
    "askew.nrrd": (
        lambda path, v: nrrd(path, v, "space: LPS", "space directions: (1.25,0,0) (.4,1.25,0) (0,0,2.5)"), 3,
        "its axes are not at right angles"),
    "two.nrrd": (
        lambda path, v: nrrd(path, np.stack([v, v], -1), "kinds: vector domain domain domain", sizes="2 96 96 48"), 3,
        "its voxels have 2 values each"),
    "times.tif": (
        lambda path, v: tifffile.imwrite(path, np.stack([v, v]), imagej=True, metadata={"axes": "TZYX"}), 3,
        "its pages are of 2 times"),
    "white.tif": (lambda path, v: tifffile.imwrite(path, v, photometric="miniswhite"), 3, "its grey is inverted"),
    "packed.mha.gz": (packed, 3, "it is compressed as a whole"),
    "colour.nrrd": (
        lambda path, v: nrrd(path, np.stack([v, v // 2, v], -1), "kinds: RGB-color domain domain domain",
                             sizes="3 96 96 48"), 3, "it is in colour"),
    "feet.nrrd": (
        lambda path, v: nrrd(path, v, "space: LPS", "space directions: (1,0,0) (0,1,0) (0,0,1)",
                             'space units: "ft" "ft" "ft"'), 3, "its lengths are in 'ft'"),
    "lost.dcm": (lambda path, v: enhanced(path, v, times=2, missing=5), 3, "which of them make up a volume is not"),
    "gap.dcm": (lambda path, v: enhanced(path, v, missing=5), 3, "slices are missing or not evenly spaced"),
    "beside.dcm": (lambda path, v: enhanced(path, v, step=(0.5, 0, 2.5)), 3, "lie 0.5 mm beside the one before"),
    "place.dcm": (lambda path, v: enhanced(path, v, step=(0, 0, 0)), 3, "48 pictures, lie at one place"),
    "white.dcm": (lambda path, v: enhanced(path, v, grey="MONOCHROME1"), 3, "its grey is inverted"),
    "seg.dcm": (lambda path, v: enhanced(path, v, of_class="66.4"), 3, "but made of one (Segmentation Storage)"),
    "map.dcm": (lambda path, v: enhanced(path, v, of_class="30"), 3, "but made of one (Parametric Map Storage)"),
    "table.dcm": (lambda path, v: by_table(path, v, 200), 3, "its modality look-up table is damaged"),
    "bzip2.nrrd": (lambda path, v: nrrd(path, v, by="bzip2"), 3, "it is compressed with bzip2"),
    "lost.nrrd": (lambda path, v: nrrd(path, v, "data file: lost.raw"), 3, "its data file cannot be opened"),
    "early.nrrd": (lambda path, v: nrrd(path, v[:9]), 3, "its data end early"),
    "flat.nrrd": (lambda path, v: nrrd(path, v[0], sizes="96 96"), 3, "it has 2 dimensions"),
    "comma.nrrd": (lambda path, v: nrrd(path, v, "spacings: 1,25 1,25 2,5"), 3, "expected a point as decimal mark"),
    "nothing": (lambda path, v: path.mkdir(), 3, "there is no file in the folder"),
    "slices": (pictures_in, 3, "no DICOM series, but 3 pictures, which tell no length"),
}  # fmt: skip


def named(suffix: str, head: bytes = b"", pack: bool = False) -> Make:
    """What is written as `suffix` under another name, or other bytes."""

    def make(path: Path, voxels: np.ndarray) -> None:
        written(voxels, path.parent / f"as{suffix}")
        data = head or (path.parent / f"as{suffix}").read_bytes()
        path.write_bytes(gzip.compress(data) if pack else data)

    return make


def nifti(size: int, mark: bytes, at: int) -> bytes:
    head = bytearray(600)
    head[:4], head[at : at + len(mark)] = struct.pack("<i", size), mark
    return bytes(head)


NAMES: dict[str, tuple[Make, str]] = {  # a name that is not the content: the cause
    "gz.nii": (named(".nii.gz"), "by its content it is NIfTI in gzip, not by its name: let it end in .nii.gz"),
    "plain.nii.gz": (named(".nii"), "by its content it is NIfTI, not by its name: let it end in .nii"),
    "none": (named(".nii.gz"), "let it end in .nii.gz"),
    "meta.nrrd": (named(".mha"), "by its content it is MetaImage, not by its name: let it end in .mha"),
    "nrrd.mha": (named(".nrrd"), "by its content it is NRRD, not by its name: let it end in .nrrd"),
    "two.nii.gz": (named(".nii", nifti(540, b"n+2", 4), pack=True), "it is NIfTI-2, which is not read here"),
    "old.hdr": (named(".nii", nifti(348, b"", 0)), "it is Analyze 7.5, which does not say where left is"),
    "._a.nrrd": (named(".nii", b"\0\5\x16\7\0\2\0\0"), "it is what macOS keeps beside a file, not the file"),
    "._a.mha": (named(".nii", b"\0\5\x16\7\0\2\0\0"), "it is what macOS keeps beside a file, not the file"),
    "lfs.nrrd": (named(".nii", b"version https://git-lfs.github.com/spec/v1\n"), "it is a pointer of Git LFS"),
    "page.nii": (named(".nii", b"<!DOCTYPE html><html>"), "it is a web page"),
    "bare.dcm": (named(".nii", b"\x08\x00\x05\x00CS\x0a\x00ISO_IR 100"), "it is DICOM without its preamble"),
    "gz.nrrd": (named(".nrrd", pack=True), "it is compressed as a whole: unpack it first"),
    "empty.nii": (lambda path, v: path.touch(), "the file is empty"),
    "scan.gipl": (lambda path, v: written(v, path), "is none of NRRD, MetaImage, NIfTI, TIFF, VTK, DICOM and Kretz"),
    "cells.vtk": (lambda path, v: vtk(path, v, "CELL_DATA", 1), "its values belong to cells (CELL_DATA)"),
    "100%d.nhdr": (
        lambda path, v: written(v, path), "a data file's name has a %, which NRRD takes for a pattern of names"),
    "50%.mhd": (
        lambda path, v: meta(path, v, MM, data="50%.raw"), "expected a name without %, which MetaImage takes for a"),
}  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_is_not_the_content_is_told_as_such(tmp_path: Path, scan: np.ndarray, name: str, capsys) -> None:
    make, words = NAMES[name]
    make(tmp_path / name, scan)
    assert main(["clip", str(tmp_path / name), "--out", str(tmp_path / "out")]) == 3
    told = capsys.readouterr().err
    assert words in told and told.count("\n") == 1 and "itk" not in told, told
    if name == "._a.mha":
        assert "is what macOS keeps beside a file" in host("info", tmp_path / name)[1]


def host(*arguments: object) -> tuple[int, str]:
    ended = subprocess.run(
        [str(BUILD / "host_sim"), *map(str, arguments)], capture_output=True, text=True, timeout=LONG, check=False
    )
    return ended.returncode, ended.stdout + ended.stderr


@pytest.fixture(scope="module")
def plain(scan: np.ndarray) -> smartvis.Result:
    return smartvis.clip(scan, SPACING)


@pytest.mark.parametrize("name", RIGHT)
def test_every_kind_is_clipped_as_the_plain_file_is(
    tmp_path: Path, scan: np.ndarray, plain: smartvis.Result, name: str
) -> None:
    RIGHT[name](tmp_path / name, scan)
    source = Source(tmp_path / name)
    several = {"times.dcm": 3, "folder": 2, "supra.mha": 2, "last.nrrd": 2}
    assert source.count == several.get(name, 1)
    for number in range(source.count):
        image = source.read(number)
        assert np.allclose(image.GetSpacing(), SPACING) and image.GetSize() == (96, 96, 48)
        result = smartvis.clip(image)
        assert result.spacing_known and not result.doubt and not source.knows_patient
        same = expected(name, scan)
        wanted = plain if same is scan else smartvis.clip(same, SPACING, scanned="zeros")
        assert np.array_equal(result.depth, wanted.depth)
        assert name == "outside.mha" or abs(result.depth_mm.mean() - plain.depth_mm.mean()) < 2


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
            assert voxels.shape[1:] == (96, 96) and voxels.max() > 30


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
    import locale

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
