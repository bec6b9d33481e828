# SPDX-License-Identifier: MIT
"""The command line: any file in, volume, depthmap, mesh and picture out, in the file's own geometry; exit codes."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from conftest import LONG, host_sim, write_dicom

import smartvis
from smartvis._files import write_ply
from smartvis._products import depth_image, mesh
from smartvis.cli import main

PROGRAM = str(Path(sys.executable).with_name("smartvis"))


@pytest.fixture
def image(volume: np.ndarray):
    made = sitk.GetImageFromArray(volume)
    made.SetSpacing((0.5, 0.6, 0.7))
    made.SetOrigin((5, -6, 7))
    made.SetDirection((0, 1, 0, -1, 0, 0, 0, 0, 1))
    return made


@pytest.mark.parametrize("suffix", [".nrrd", ".mha", ".nii.gz"])
def test_files_of_every_format_keep_their_geometry(tmp_path: Path, image, volume, suffix: str, capsys) -> None:
    path = tmp_path / f"head{suffix}"
    sitk.WriteImage(image, str(path))
    out = tmp_path / "out"
    arguments = ["clip", str(path), "--out", str(out), "--method", "wall", "--write", "clipped,depth,mask"]
    assert main([*arguments, "--format", suffix]) == 0
    assert "OK" in capsys.readouterr().out
    clipped = sitk.ReadImage(str(out / f"head_clipped{suffix}"))
    expected = smartvis.clip(volume, (0.5, 0.6, 0.7), method="wall")
    assert np.array_equal(sitk.GetArrayFromImage(clipped), expected.apply(volume))
    depth, mask = (sitk.ReadImage(str(out / f"head_{what}{suffix}")) for what in ("depth", "mask"))
    assert np.allclose(sitk.GetArrayFromImage(depth)[0], expected.depth_mm)
    assert np.array_equal(sitk.GetArrayFromImage(mask), expected.mask())
    for made, there in ((clipped, image), (depth, depth_image(image, expected)), (mask, image)):
        assert np.allclose(made.GetSpacing(), there.GetSpacing(), atol=1e-5)
        assert np.allclose(made.GetOrigin(), there.GetOrigin(), atol=1e-4)
        assert np.allclose(made.GetDirection(), image.GetDirection(), atol=1e-5)
    assert sorted(p.name for p in out.iterdir()) == [f"head_{what}{suffix}" for what in ("clipped", "depth", "mask")]


def test_mesh_and_picture(tmp_path: Path, image) -> None:
    sitk.WriteImage(image, str(tmp_path / "head.nrrd"))
    command = ["clip", str(tmp_path / "head.nrrd"), "--out", str(tmp_path), "--write", "mesh,look", "--method", "wall"]
    assert main(command) == 0
    raw = (tmp_path / "head_mesh.ply").read_bytes()
    head, body = raw.split(b"end_header\n", 1)
    count = int(head.split(b"element vertex ")[1].split()[0])
    corners = np.frombuffer(body[: 12 * count], "<f4").reshape(-1, 3)
    index = np.array([image.TransformPhysicalPointToContinuousIndex(c) for c in corners[::50].astype(float)])
    z_of_the_fetus = 0.6 * 64
    assert index[:, 2].min() > z_of_the_fetus - 1.5  # of the skin nothing is left
    assert index.min() > -1.5 and (index.max(axis=0) < np.array([56, 56, 64]) + 0.5).all()
    look = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / "head_look.png")))
    assert look.shape[0] == 34 and look.shape[2] == 3 and look.std() > 10


@pytest.mark.parametrize("axes", [(1, 1, 1), (-1, 1, 1), (1, 1, -1), (-1, -1, 1)])
def test_faces_look_outwards_whatever_the_axes(tmp_path: Path, volume: np.ndarray, axes: tuple[int, ...]) -> None:
    """What they enclose is positive; of a left-handed box, too. The file says axes and unit as 3D Slicer looks for."""
    image = sitk.GetImageFromArray(volume)
    image.SetDirection(np.diag(np.array(axes, float)).ravel())
    vertices, faces = mesh(image, smartvis.clip(image))
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    enclosed = float((a * np.cross(b, c)).sum() / 6)
    assert 0.2 < enclosed / volume.size < 0.6  # the fetus is 0.35 of it
    write_ply(tmp_path / "a.ply", vertices, faces)
    write_ply(tmp_path / "b.ply", vertices, faces, mm=False)
    for name, line in (("a", b"\ncomment SPACE=LPS UNIT=mm\n"), ("b", b"\ncomment SPACE=LPS\n")):
        assert line in (tmp_path / f"{name}.ply").read_bytes()[:300]


def test_sequences_are_clipped_volume_by_volume(tmp_path: Path, volume, capsys) -> None:
    frames = [volume, np.roll(volume, 4, axis=2), np.full_like(volume, 120)]
    series = sitk.JoinSeries([sitk.GetImageFromArray(f) for f in frames])
    sitk.WriteImage(series, str(tmp_path / "beat.nii.gz"))
    assert main(["clip", str(tmp_path / "beat.nii.gz"), "--out", str(tmp_path), "--write", "clipped"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "[0]" in lines[0] and any("[2]" in line and "NO_SURFACE" in line for line in lines)
    for number, frame in enumerate(frames[:2]):
        clipped = sitk.GetArrayFromImage(sitk.ReadImage(str(tmp_path / f"beat_f{number:04d}_clipped.nrrd")))
        assert np.array_equal(clipped, smartvis.clip(frame, (1, 1, 1)).apply(frame))


def test_a_dicom_folder_gives_what_other_files_give(tmp_path: Path, image, capsys) -> None:
    write_dicom(tmp_path / "series", image)
    sitk.WriteImage(image, str(tmp_path / "file.nrrd"))
    out = ["--out", str(tmp_path), "--write", "clipped,depth", "--method", "wall"]
    assert main(["clip", str(tmp_path / "series"), str(tmp_path / "file.nrrd"), *out]) == 0
    for what in ("clipped", "depth"):
        one, other = (sitk.ReadImage(str(tmp_path / f"{name}_{what}.nrrd")) for name in ("series", "file"))
        assert np.allclose(sitk.GetArrayFromImage(one), sitk.GetArrayFromImage(other), atol=1e-4)
        assert np.allclose(one.GetSpacing(), other.GetSpacing()) and np.allclose(one.GetOrigin(), other.GetOrigin())
        assert np.allclose(one.GetDirection(), other.GetDirection())
    write_dicom(tmp_path / "series", image[:, :, 8:], "1.2.3.5")
    assert main(["clip", str(tmp_path / "series"), *out]) == 0  # two series: both
    sizes = [sitk.ReadImage(str(tmp_path / f"series_f000{n}_clipped.nrrd")).GetSize()[2] for n in range(2)]
    assert sizes == [64, 56]


def test_dicom_that_is_no_whole_volume_is_refused(tmp_path: Path, image, capsys) -> None:
    files = write_dicom(tmp_path / "gap", image)
    files[20].unlink()
    write_dicom(tmp_path / "uneven", image, step=0.07)  # a tenth of the distance of slices
    cine = tmp_path / "cine.dcm"
    image.SetMetaData("0008|0060", "US")
    sitk.WriteImage(image, str(cine))
    for path, words in {files[0]: "name the folder", tmp_path / "gap": f"{files[21]}: it lies 1.4 mm behind",
                        tmp_path / "uneven": "it lies 0.77 mm behind the slice before it",
                        cine: "pictures over time"}.items():  # fmt: skip
        assert main(["clip", str(path), "--out", str(tmp_path / "out")]) == 3
        told = "".join(capsys.readouterr())
        assert words in told and str(path) in told, told


def test_files_that_are_no_volumes_are_named(tmp_path: Path, image, capsys) -> None:
    image.SetSpacing((0.5, 0.6, 1.0))  # of pictures nobody says how far apart they are
    image.SetOrigin((5.0, -6.0, 0.0))
    sitk.WriteImage(image, str(pictures := tmp_path / "plus.mha"))
    pictures.write_bytes(pictures.read_bytes().replace(b"NDims", b"Kinds = domain domain list\nNDims", 1))
    said = {"none.nrrd": "no such file", "plus.mha": "sequence of pictures"}
    assert main(["clip", *(str(tmp_path / name) for name in said), "--out", str(tmp_path / "out")]) == 3
    told = "".join(capsys.readouterr())
    assert all(re.search(f"{name}:.*{words}", told) for name, words in said.items()), told


def test_exit_codes(tmp_path: Path, image, capsys) -> None:
    path = str(tmp_path / "head.nrrd")
    sitk.WriteImage(image, path)
    out = ["--out", str(tmp_path / "out")]
    assert main(["clip", path, *out, "--set", "knob=1"]) == 2 and "'knob'" in capsys.readouterr().err
    assert main(["clip", path, *out, "--write", "volume"]) == 2 and "'volume'" in capsys.readouterr().err
    for value in ("99", "nan"):
        assert main(["clip", path, *out, "--set", f"q={value}"]) == 2
        assert f"--set: q is {value}, expected 0 to 1.5" in capsys.readouterr().err
    wrong = ["--set", "kernel=24", "--method", "mean"]  # within its range; the plugin knows its steps
    assert main(["clip", path, *out, *wrong]) == 4 and "kernel" in capsys.readouterr().out
    assert main(["clip", path, *out, "--plugin", "nope.so"]) == 4 and "nope.so" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["clip", path, "--out", str(tmp_path / "file")]) == 6
    assert main(["batch", path, "--out", str(tmp_path / "file")]) == 6
    with pytest.raises(SystemExit) as caught:
        main(["clip", path, "--view", "1,2"])
    assert caught.value.code == 2
    folder = tmp_path / "taken" / "head_clipped.nrrd"
    folder.mkdir(parents=True)
    assert main(["clip", path, "--out", str(tmp_path / "taken"), "--write", "clipped"]) == 6
    assert [p.name for p in (tmp_path / "taken").iterdir()] == ["head_clipped.nrrd"]  # no part is left


def test_without_the_host_a_file_that_needs_it_is_named(tmp_path: Path, image, monkeypatch, capsys) -> None:
    """What pip alone brings clips NRRD and NIfTI; the host's own formats need the host."""
    monkeypatch.setenv("SMARTVIS_HOST_SIM", "/nowhere/host_sim")
    (tmp_path / "head.vol").write_bytes(b"KRETZFILE 1.0   ")
    for name, code in (("a.nrrd", 0), ("b.nii.gz", 0), ("head.mha", 3), ("head.vol", 3)):
        if not (tmp_path / name).exists():
            sitk.WriteImage(image, str(tmp_path / name))
        clip = ["clip", str(tmp_path / name), "--out", str(tmp_path), "--write", "depth", "--method", "wall"]
        assert main(clip) == code
        told = capsys.readouterr().err
        wanted = (
            f"{tmp_path / name}: this format is read by host_sim; NRRD, NIfTI and DICOM need no host. SMARTVIS_HOST"
        )
        assert (wanted in told) == (code == 3), told


def test_parameters_are_listed(capsys) -> None:
    assert main(["parameters", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert [p["key"] for p in facts["parameters"]] == list(smartvis.parameters())
    assert main(["parameters"]) == 0 and "method" in capsys.readouterr().out


def test_what_goes_wrong_is_said_once(tmp_path: Path, image) -> None:
    """As a program: what its logger, a full disk and the interpreter's end say is part of it."""
    sitk.WriteImage(image, str(tmp_path / "head.nrrd"))
    command = [PROGRAM, "clip", "head.nrrd", "--out", "o", "--method", "mean", "--set", "kernel=24"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=LONG, check=False)
    said = ended.stdout + ended.stderr
    assert ended.returncode == 4 and said.count("kernel is 24") == 1 and "Files are in" not in said
    (tmp_path / "file").write_text("")
    environment = os.environ | {"POCL_CACHE_DIR": str(tmp_path / "file")}
    if any(Path("/etc/OpenCL/vendors").glob("pocl*")):
        command = [PROGRAM, "clip", "head.nrrd", "--out", "o"]
        ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment, check=False)
        assert ended.returncode == 5 and "kernel cache" in ended.stdout and "Files are in" not in ended.stdout
    with open("/dev/full", "w") as full:
        command = [PROGRAM, "parameters"]
        ended = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=LONG, check=False)
    assert ended.returncode == 6 and "No space left" in ended.stderr and "Traceback" not in ended.stderr


@pytest.mark.parametrize(
    ("option", "words"),
    [
        (["clip", "{}", "--window", "nan,1"], "two finite numbers, the lower first"),
        (["clip", "{}", "--window", "5,1"], "two finite numbers, the lower first"),
        (["clip", "{}", "--level", "nan"], "'nan', expected a finite number"),
        (["clip", "{}", "--write", ","], "--write: ',' names none of"),
        (["clip", "{}", "--format", ".png"], "'.png', expected one of .nrrd "),
        (["batch", "{}", "--format", "nrrd"], "'nrrd', expected one of .nrrd "),
        (["clip", "{}", "--mirror"], "--mirror: is for Kretz volumes"),
        (["batch", "{}", "--mirror"], "--mirror: is for Kretz volumes"),
        (["serve", "--port", "0", "--limit", "-1"], "'-1', expected a whole number above 0"),
        (["serve", "--port", "0", "--clients", "0"], "'0', expected a whole number above 0"),
        (["serve", "--port", "0", "--window", "9,1"], "two finite numbers, the lower first"),
    ],
)
def test_options_that_would_do_nothing_are_refused(tmp_path, image, option, words: str, monkeypatch, capsys) -> None:
    sitk.WriteImage(image, str(tmp_path / "head.nrrd"))
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        sys.exit(main([part.format("head.nrrd") for part in option]))
    assert ended.value.code == 2 and words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("others", [["head.nii.gz"], ["head.nrrd"], ["below/head.nrrd"]])
def test_files_that_would_have_one_name_are_refused(tmp_path: Path, image, others: list[str], capsys) -> None:
    files = [tmp_path / name for name in ["head.nrrd", *others]]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        sitk.WriteImage(image, str(file))
    assert main(["clip", *map(str, files), "--out", str(tmp_path / "out")]) == 2
    assert f"{files[0]} and {files[1]} would both be written as head" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_program_is_installed() -> None:
    said = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True, timeout=LONG).stdout
    assert said == f"smartvis {smartvis.load().version}\n"
    assert smartvis.load().version == "+".join(filter(None, (smartvis.__version__, smartvis.__commit__)))


def test_a_view_by_its_place_needs_a_file_that_knows_the_patient(tmp_path: Path, image, capsys) -> None:
    """As with host_sim: of MetaImage it decides; of the others the fields do that say so."""
    sitk.WriteImage(image, str(tmp_path / "knows.nrrd"))
    sitk.WriteImage(image, str(tmp_path / "knows.mha"))
    sitk.WriteImage(image, str(tmp_path / "knows.nii"))
    write_dicom(tmp_path / "series", image)
    raw = (tmp_path / "knows.nrrd").read_bytes()
    (tmp_path / "not.nrrd").write_bytes(raw.replace(b"space: left-posterior-superior", b"space dimension: 3"))
    host_sim("scenes", "D01", "--size", 48, "--export", "--out", tmp_path)
    host_sim("scenes", "D01", "--size", 48, "--export", "--format", "vol", "--out", tmp_path)
    sitk.WriteImage(image, str(tmp_path / "not.vtk"))
    clip = ["--view", "left", "--method", "wall", "--write", "depth", "--out", str(tmp_path / "out")]
    for name in ("knows.nrrd", "knows.mha", "knows.nii", "series"):
        assert main(["clip", str(tmp_path / name), *clip]) == 0, capsys.readouterr().err
        made = sitk.ReadImage(str(tmp_path / "out" / f"{name.split('.')[0]}_depth.nrrd"))
        assert np.allclose(made.GetDirection()[2::3], (-1, 0, 0), atol=1e-6)  # from the left, that is where it looks
        capsys.readouterr()
    for name in ("not.nrrd", "D01_full.mha", "D01_full.vol", "not.vtk"):
        assert main(["clip", str(tmp_path / name), *clip]) == 3
        assert f"{name}: does not say how it lies in the patient, so there is no view left" in capsys.readouterr().out
    with pytest.raises(SystemExit) as ended:
        main(["clip", "x.nrrd", "--view", "above"])
    assert ended.value.code == 2 and "'above', expected 3 numbers" in capsys.readouterr().err
