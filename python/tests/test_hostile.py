# SPDX-License-Identifier: MIT
"""Files that are wrong, or mean harm: refused by name with exit code 3, through every door.
Requirement: R12."""

import csv
import gzip
import importlib
import math
import os
import re
import struct
import subprocess
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import BUILD, LONG, SOURCE, write_dicom
from test_kretz import wrap

from smartvis.cli import main

VOXELS = np.random.default_rng(7).integers(1, 255, 4096, np.uint8).tobytes()
PACKED = zlib.compress(VOXELS)


def meta(data: bytes = VOXELS, extra: str = "", **fields: object) -> bytes:
    head = {"DimSize": "16 16 16", "ElementSpacing": "1 1 1", "ElementType": "MET_UCHAR"} | fields
    dims, last = head.pop("NDims", 3), head.pop("ElementDataFile", "LOCAL")
    text = "".join(f"{name} = {value}\n" for name, value in head.items())
    return f"ObjectType = Image\nNDims = {dims}\n{extra}{text}ElementDataFile = {last}\n".encode() + data


def nrrd(last: str, sizes: str = "16 16 16") -> bytes:
    head = f"NRRD0004\ntype: unsigned char\ndimension: {len(sizes.split())}\nsizes: {sizes}\nencoding: raw\n"
    return f"{head}{last}\n\n".encode()


def nifti(tmp_path: Path, at: int = 0, *put: Any) -> bytes:
    image = sitk.GetImageFromArray(np.frombuffer(VOXELS, np.uint8).reshape(16, 16, 16))
    sitk.WriteImage(image, str(tmp_path / "made.nii"))
    raw = bytearray((tmp_path / "made.nii").read_bytes())
    if put:
        struct.pack_into(put[0], raw, at, *put[1:])
    return bytes(raw)


SEQUENCE = {"NDims": 4, "DimSize": "16 16 16 2", "ElementSpacing": "1 1 1 1"}
STATES = "\nSeq_Frame0000_ImageStatus = OK\nSeq_Frame0001_ImageStatus = INVALID\n"
HOSTILE = {
    "zlib.mha": (meta(PACKED[:2000] + b"!" + PACKED[2001:], "CompressedData = True\n"), "CompressedData is damaged"),
    "cut.mha": (meta(PACKED[:2000], "CompressedData = True\n"), "CompressedData is cut off"),
    "bomb.mha": (meta(PACKED, "CompressedData = True\n", DimSize="2000 2000 500"), "compressed bytes cannot hold"),
    "negative.mha": (meta(ElementSpacing="1 -1 1"), "1e-6 .. 1e6"),
    "endless.mha": (meta(ElementSpacing="1 1e308 1"), "1e-6 .. 1e6"),
    "offset.mha": (meta(extra="Offset = nan 0 0\n"), "Offset is 'nan 0 0'"),
    "header.mha": (meta(extra="HeaderSize = 999999\n"), "0 bytes of data, expected 4096"),
    "invalid.mha": (meta(VOXELS * 2, STATES, **SEQUENCE), "ImageStatus of volume 1 is INVALID"),
    "invalid.nrrd": (
        nrrd("kinds: domain domain domain list" + STATES.replace(" = ", ":=").rstrip(), "16 16 16 2") + VOXELS * 2,
        "ImageStatus of volume 1 is INVALID",
    ),
    "flood.mha": (meta(NDims=4, DimSize="16 16 16 100000"), "expected 409600000"),
    "far.mha": (meta(np.array([-1.7e308, 1.7e308] * 2048).tobytes(), ElementType="MET_DOUBLE"), "give a window"),
    "above.mhd": (meta(b"", ElementDataFile="../outside"), "'../outside', expected a file in the header's folder"),
    "root.mhd": (meta(b"", ElementDataFile="/etc/hostname"), "expected a file in the header's folder"),
    "link.mhd": (meta(b"", ElementDataFile="link"), "'link': cannot be read: a link leads out"),
    "behind.mhd": (meta(b"", ElementDataFile="up/outside"), "a link leads out"),
    "pipe.mhd": (meta(b"", ElementDataFile="pipe"), "not a regular file"),
    "above.nhdr": (nrrd("data file: ../outside"), "data file is '../outside', expected a regular file"),
    "link.nhdr": (nrrd("data file: link"), "data file is 'link', expected a regular file"),
    "pipe.nhdr": (nrrd("data file: pipe"), "data file is 'pipe', expected a regular file"),
    "list.nhdr": (nrrd("data file: LIST\n" + "../outside\n" * 16), "data file is '../outside'"),
    "percent.nhdr": (nrrd("data file: a %.raw"), "data file is 'a %.raw'"),
    "pattern.nhdr": (nrrd("data file: lin%c.raw 1 16 1".replace("%c", "%d")), "data file is 'lin%d.raw 1 16 1'"),
    "endless.nrrd": (nrrd("spacings: 1 1e308 1") + VOXELS, "spacing=(1.0, 1e+308, 1.0)"),
    "steep.nrrd": (
        nrrd("space dimension: 3\nspace directions: (1,0,0) (0,1e308,0) (0,0,1)") + VOXELS,
        "spacedirections is '(1,0,0) (0,1e308,0) (0,0,1)'",
    ),
    "cut.vol": (b"KRETZFILE 1.0   " + bytes(5), "5 bytes are left, an item's header needs 8"),
    "cut.dcm": (wrap(b"KRETZFILE 1.0   " + bytes(6)), "6 bytes are left, an item's header needs 8"),
    "bomb.nrrd": (nrrd("").replace(b"raw", b"gzip").replace(b"16 16 16", b"2000 1000 1000"), "bytes, the file holds"),
}


@pytest.fixture
def inside(tmp_path: Path) -> Path:
    """A folder with links out of it, and a pipe that nobody writes to."""
    (tmp_path / "outside").write_bytes(VOXELS)
    folder = tmp_path / "inside"
    folder.mkdir()
    (folder / "link").symlink_to("../outside")
    (folder / "lin1.raw").symlink_to("../outside")
    (folder / "a %.raw").symlink_to("../outside")
    (folder / "up").symlink_to("..")
    os.mkfifo(folder / "pipe")
    return folder


CLIP = [sys.executable, "-P", "-m", "smartvis", "clip", "{0}", "--out", "out", "--write", "clipped"]
HOST = [str(BUILD / "host_sim")]
OF_HOST = (
    [*HOST, "info", "{0}"],
    [*HOST, "run", "--volume", "{0}", "--out", "out"],
    [*HOST, "measure", "--case", "{0},{0},{0}", "-"],
    [*HOST, "report", "--case", "{0},{0},{0}", "--coarse", "--out", "out"],
)


def refused(path: Path, words: str, door: list[str] = CLIP) -> None:
    """As a program, since what hangs must not take the tests with it."""
    command = [part.format(path.name) for part in door]
    ended = subprocess.run(command, cwd=path.parent, capture_output=True, text=True, timeout=LONG, check=False)
    said = ended.stdout + ended.stderr
    assert ended.returncode == 3 and words in said and path.name in said and "Traceback" not in said, (command, said)


OF_THE_HOST = [  # of invalid.mha it leaves a part out
    n for n in HOSTILE if n.endswith((".mha", ".mhd", ".vol")) and n != "invalid.mha"
]


@pytest.mark.parametrize("name", OF_THE_HOST)
def test_every_door_of_the_host_refuses(inside: Path, name: str) -> None:
    content, words = HOSTILE[name]
    (inside / name).write_bytes(content)
    for door in OF_HOST:
        refused(inside / name, words, door)


def test_the_console_refuses_them_and_goes_on(inside: Path, monkeypatch) -> None:
    """The last of the doors: one page asks for all of them in turn, and then for one that is right."""
    monkeypatch.syspath_prepend(str(SOURCE / "tests" / "host_sim" / "console"))
    client = importlib.import_module("console_client")
    for name in OF_THE_HOST:
        (inside / name).write_bytes(HOSTILE[name][0])
    (inside / "right.mha").write_bytes(meta())
    console = client.Console(str(BUILD), [str(inside), "--plugin", str(BUILD / "examples" / "first_edge.so"), "--stay"])
    try:
        page = client.Page(console, timeout=LONG)
        for name in [*OF_THE_HOST, "right.mha"]:
            said = page.show(source={"folder": 0, "path": name, "from": "probe"})
            assert said["type"] == ("frame" if name == "right.mha" else "refused"), (name, said)
            if name in HOSTILE:
                assert HOSTILE[name][1] in said["text"] and name in said["text"], said
                assert str(inside) not in said["text"], said
    finally:
        console.end()


def clip_names(folder: Path, files: dict[str, tuple[bytes, str]], capsys) -> None:
    """`smartvis clip` of all of them at once says of each what it must."""
    for name, (content, _) in files.items():
        (folder / name).write_bytes(content)
    options = ["--out", str(folder / "out"), "--write", "clipped"]
    assert main(["clip", *(str(folder / name) for name in files), *options]) == 3
    told = "".join(capsys.readouterr())
    assert all(re.search(f"{name}:.*{re.escape(words)}", told) for name, (_, words) in files.items()), told


def test_clip_names_them_and_a_batch_of_them_is_a_table(inside: Path, capsys) -> None:
    for suffixes in ((".mha", ".mhd"), (".nrrd", ".nhdr"), (".vol",), (".dcm",)):  # some differ in their suffix alone
        clip_names(inside, {name: row for name, row in HOSTILE.items() if name.endswith(suffixes)}, capsys)
    os.mkfifo(inside / "pipe.nrrd")
    assert main(["batch", str(inside), "--out", str(inside / "out"), "--write", "clipped", "--workers", "1"]) == 1
    with open(inside / "out" / "table.csv", newline="") as file:
        rows = {Path(row["file"]).name: row for row in csv.DictReader(file) if row["state"] != "ok"}
    assert set(rows) == {*HOSTILE, "pipe.nrrd"}
    for name, (_, words) in HOSTILE.items():
        assert rows[name]["state"] == "input" and words in rows[name]["reason"], rows[name]


def test_nifti_that_is_cut_or_has_no_geometry_is_refused(inside: Path, capsys) -> None:
    """ITK fills what is missing with what was in memory."""
    files = {
        "cut.nii": (nifti(inside)[:2000], "the file holds 2000"),
        "packed.nii.gz": (gzip.compress(nifti(inside))[:2000], "ended before"),
        "flood.nii": (nifti(inside, 40, "<8h", 4, 16, 16, 16, 32000, 1, 1, 1), "the file holds 4448"),
        "endless.nii": (nifti(inside, 280, "<f", math.inf), "srow_x is 'inf"),
        "negative.nii": (nifti(inside, 80, "<f", -1.0), "disagree about"),
    }
    clip_names(inside, files, capsys)


def test_tiff_that_is_cut_or_damaged_is_refused(inside: Path) -> None:
    """libtiff says so on the standard error alone, and ITK returns what there is."""
    image = sitk.GetImageFromArray(np.frombuffer(VOXELS, np.uint8).reshape(16, 16, 16))
    sitk.WriteImage(image, str(inside / "good.tif"), useCompression=True, compressor="Deflate")
    good = (inside / "good.tif").read_bytes()
    wrong = {f"cut{n}.tif": good[:-n] for n in (1, 100, len(good) // 2)}
    wrong["data.tif"] = good[:100] + b"!!!" + good[103:]
    for name, content in wrong.items():
        (inside / name).write_bytes(content)
    (inside / "pipe").unlink()
    assert main(["batch", str(inside), "--out", str(inside / "out"), "--workers", "1", "--write", "clipped"]) == 1
    with open(inside / "out" / "table.csv", newline="") as file:
        states = {Path(row["file"]).name: row["state"] for row in csv.DictReader(file)}
    assert states == {"good.tif": "ok"} | dict.fromkeys(wrong, "input")


@pytest.fixture
def without_rights() -> list[str]:
    """What a command begins with that must ask for its rights, as root's need not."""
    drop = "-dac_override,-dac_read_search"
    command = ["setpriv", f"--bounding-set={drop}", f"--inh-caps={drop}"] if os.geteuid() == 0 else []
    if command and subprocess.run([*command, "true"], capture_output=True, timeout=LONG, check=False).returncode != 0:
        pytest.skip("setpriv cannot drop root's rights here")
    return command


def test_what_must_not_be_read_is_told(inside: Path, without_rights: list[str]) -> None:
    """Neither does it stop a batch, nor is it left out without a word."""
    (inside / "pipe").unlink()
    image = sitk.GetImageFromArray(np.frombuffer(VOXELS, np.uint8).reshape(16, 16, 16))
    sitk.WriteImage(image, str(inside / "good.nrrd"))
    last = min(write_dicom(inside / "slices", image))
    (inside / "shut").mkdir()
    for name in ("closed.nrrd", "closed.mha", "closed.vol", "shut/hidden.nrrd"):
        (inside / name).write_bytes(b"")
    closed = [inside / "closed.nrrd", inside / "closed.mha", inside / "closed.vol", inside / "shut", last]
    for path in closed:
        path.chmod(0)
    for path in (*closed[:-1], inside / "slices"):
        name = f"slices/{last.name}" if path.name == "slices" else path.name
        refused(path, f"{name}: cannot be read: ", [*without_rights, *CLIP])
    command = [*without_rights, *CLIP[:4], "batch", str(inside), "--out", str(inside / "out"), "--workers", "1"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=LONG, check=False)
    (inside / "shut").chmod(0o700)
    with open(inside / "out" / "table.csv", newline="") as file:
        rows = {Path(row["file"]).name: row for row in csv.DictReader(file)}
    assert ended.returncode == 1, ended.stderr
    assert {name: row["state"] for name, row in rows.items()} == {
        "good.nrrd": "ok", "closed.nrrd": "input", "closed.mha": "input", "closed.vol": "input", "shut": "input",
        "slices": "input"}  # fmt: skip
    assert all("cannot be read" in row["reason"] for row in rows.values() if row["state"] != "ok"), rows


@pytest.mark.parametrize("name", ["clip", "batch"])
def test_a_folder_that_must_not_be_written_is_6(inside: Path, without_rights: list[str], name: str) -> None:
    (inside / "good.mha").write_bytes(meta())
    (inside / "out").mkdir(0o500)
    command = [*without_rights, *CLIP[:4], name, "good.mha", "--out", "out"]
    ended = subprocess.run(command, cwd=inside, capture_output=True, text=True, timeout=LONG, check=False)
    said = ended.stdout + ended.stderr
    assert ended.returncode == 6 and "Permission denied" in said and "Traceback" not in said, said


def test_links_that_stay_in_the_folder_are_read(inside: Path) -> None:
    (inside / "data").write_bytes(VOXELS)
    (inside / "near").symlink_to("data")
    for name, content in (("near.mhd", meta(b"", ElementDataFile="near")), ("near.nhdr", nrrd("data file: near"))):
        (inside / name).write_bytes(content)
        assert main(["clip", str(inside / name), "--out", str(inside / "out"), "--write", "clipped"]) == 0
        clipped = sitk.ReadImage(str(inside / "out" / "near_clipped.nrrd"))
        assert clipped.GetSize() == (16, 16, 16)


def test_pipes_are_not_waited_for(inside: Path) -> None:
    (inside / "pipe").rename(inside / "pipe.nrrd")
    refused(inside / "pipe.nrrd", "not a regular file")
    refused(inside, "pipe.nrrd: not a regular file")  # a folder of DICOM
