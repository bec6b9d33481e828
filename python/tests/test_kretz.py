# SPDX-License-Identifier: MIT
"""Kretz volumes, bare and in DICOM, through `smartvis clip` and `host_sim info`: the host reads them, and Python has
what it read. The DICOM files are made here."""

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import host_sim, write_dicom

import smartvis
from smartvis._files import Source
from smartvis._found import find_files
from smartvis.cli import main

MEAN = ("--method", "mean")
EXPLICIT, IMPLICIT = "1.2.840.10008.1.2.1", "1.2.840.10008.1.2"


def element(tag: int, kind: str, value: bytes, implicit: bool) -> bytes:
    value += b"\0" * (len(value) % 2)
    head = struct.pack("<HH", tag >> 16, tag & 0xFFFF)
    if implicit:
        return head + struct.pack("<I", len(value)) + value
    size = struct.pack("<HI", 0, len(value)) if kind == "OB" else struct.pack("<H", len(value))
    return head + kind.encode() + size + value


def wrap(stream: bytes, syntax: str = EXPLICIT, series: str = "1.2.3") -> bytes:
    """A DICOM file as scanners write it: pictures over time, and behind them the volume in a private element."""
    meta = element(0x00020010, "UI", syntax.encode(), False)
    rows = [
        (0x00080016, "UI", b"1.2.840.10008.5.1.4.1.1.3.1"),
        (0x00080018, "UI", series.encode() + b".1"),
        (0x00100010, "PN", b"MUSTERFRAU^A"),
        (0x0020000D, "UI", b"1.2"),
        (0x0020000E, "UI", series.encode()),
        (0x7FE00010, "OB", bytes(64)),
        (0x7FE10011, "LO", b"KRETZ_US"),
        (0x7FE11101, "OB", stream),
    ]
    group = element(0x00020000, "UL", struct.pack("<I", len(meta)), False)
    return bytes(128) + b"DICM" + group + meta + b"".join(element(*row, syntax == IMPLICIT) for row in rows)


@pytest.fixture(scope="module")
def scans(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("kretz")
    host_sim("scenes", "D01", "--size", 96, "--export", "--format", "vol", "--out", folder)
    host_sim("scenes", "E02", "--size", 48, "--frames", 2, "--export", "--format", "vol", "--out", folder)
    return folder


def test_a_wrapped_volume_is_the_bare_one_and_the_hosts(scans: Path, tmp_path: Path, capsys) -> None:
    raw = (scans / "D01_full.vol").read_bytes()
    (tmp_path / "explicit.dcm").write_bytes(wrap(raw))
    (tmp_path / "implicit").write_bytes(wrap(raw, IMPLICIT))
    files = [scans / "D01_full.vol", tmp_path / "explicit.dcm", tmp_path / "implicit"]
    assert main(["clip", *map(str, files), "--out", str(tmp_path), "--write", "clipped", *MEAN]) == 0
    assert capsys.readouterr().out.count(", OK,") == 3
    clipped = [sitk.ReadImage(str(tmp_path / f"{name}_clipped.nrrd")) for name in ("D01_full", "explicit", "implicit")]
    ours = [sitk.GetArrayFromImage(image) for image in clipped]
    assert np.array_equal(ours[0], ours[1]) and np.array_equal(ours[0], ours[2]) and (ours[0] > 0).mean() > 0.05

    few = ["--frames", 1, "--setting", "smartvis", "--picture", 64, "--out", tmp_path / "host"]
    host_sim("run", "--volume", files[1], "--write", "clipped", "--set", "method=mean", *few)
    theirs = sitk.ReadImage(str(tmp_path / "host" / "clipped.mha"))
    assert clipped[0].GetSpacing() == pytest.approx(theirs.GetSpacing())
    assert clipped[0].GetOrigin() == pytest.approx(theirs.GetOrigin())
    assert np.array_equal(ours[0], sitk.GetArrayFromImage(theirs))


def test_the_plugin_sees_the_samples_as_under_the_host(scans: Path, tmp_path: Path) -> None:
    """Not the Cartesian copy, unless the caller changed that: then it is a volume as any other."""
    few = ["--frames", 2, "--setting", "smartvis", "--picture", 32, "--few-pictures", "--write", "depthmap", "--out"]
    d01, e02 = scans / "D01_full.vol", scans / "E02_full.vol"
    rows: list[tuple[Path, list[object], Any]] = [
        (d01, ["--mirror"], None),
        (d01, ["--yaw", 90], (1, 0, 0)),
        (e02, [], None),
    ]
    for path, how, view in rows:
        host_sim("run", "--volume", path, *how, *few, tmp_path)
        theirs = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / "depthmap.mha")))
        source = Source(path, mirror="--mirror" in how)
        maps = [smartvis.clip(source.read(n), view=view).depth_mm for n in range(source.count)]
        assert np.array_equal(theirs.reshape(-1, *theirs.shape[-2:])[-len(maps) :], maps)
    image = Source(d01).read()
    mine = smartvis.clip(image)
    image[3, 3, 3] = 77
    changed = smartvis.clip(image)
    assert not np.array_equal(changed.depth, mine.depth)
    assert np.array_equal(changed.depth, smartvis.clip(sitk.GetArrayFromImage(image), image.GetSpacing()).depth)
    wrong: list[dict[str, Any]] = [
        {"window": (0, 9)},
        {"probe": "-z"},
        {"spacing": (1, 1, 1)},
        {"scanned": np.ones((2, 2, 2))},
    ]
    for given in wrong:
        with pytest.raises(
            ValueError, match=f"D01_full.vol: a Kretz file says .* itself; {next(iter(given))}= was given"
        ):
            smartvis.clip(image, **given)
    clip = ["clip", str(d01), "--out", str(tmp_path), "--write", "depth"]
    assert main([*clip, "--spacing", "1,1,1"]) == main([*clip, "--probe", "-z"]) == 3


def test_the_other_side_is_a_choice(scans: Path, tmp_path: Path) -> None:
    clip = ["clip", str(scans / "D01_full.vol"), "--write", "clipped", *MEAN]
    assert main([*clip, "--out", str(tmp_path / "one")]) == 0
    assert main([*clip, "--mirror", "--out", str(tmp_path / "other")]) == 0
    one, other = (sitk.ReadImage(str(tmp_path / side / "D01_full_clipped.nrrd")) for side in ("one", "other"))
    one, other = (sitk.GetArrayFromImage(image) > 0 for image in (one, other))
    assert not np.array_equal(one, other)
    assert np.mean(one == other[:, ::-1]) > 0.99


def test_a_folder_has_slices_and_wrapped_volumes(scans: Path, tmp_path: Path, volume, capsys) -> None:
    """Kretz volumes beside the slices of a series are volumes of their own, and not slices; so is another file."""
    folder = tmp_path / "scans"
    write_dicom(folder, sitk.GetImageFromArray(volume))
    (folder / "a.dcm").write_bytes(wrap((scans / "D01_full.vol").read_bytes()))
    (folder / "b.dcm").write_bytes(wrap((scans / "E02_full.vol").read_bytes()))
    assert main(["clip", str(folder), "--out", str(tmp_path), "--write", "depth"]) == 0
    names = ["a_depth.nrrd", "b_f0000_depth.nrrd", "b_f0001_depth.nrrd", "scans_depth.nrrd"]
    assert sorted(p.name for p in tmp_path.glob("*.nrrd")) == names
    (folder / "other.nrrd").write_bytes((tmp_path / "a_depth.nrrd").read_bytes())
    found = find_files([str(folder)])
    assert found == [folder / "other.nrrd", folder / "a.dcm", folder / "b.dcm", folder]
    for slice_ in folder.glob("1.2*"):
        slice_.unlink()
    assert find_files([str(folder)]) == found[:-1]
