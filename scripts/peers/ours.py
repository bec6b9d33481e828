# SPDX-License-Identifier: MIT
"""Our side, in the tests' environment. ours.py make FOLDER: a scan whose axes are turned, and what we write of it, in
FOLDER/ours, with what is to be read there. ours.py read FOLDER: what we read of FOLDER/theirs and again, a line of
JSON a file."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import SimpleITK as sitk
from common import NEAR_MM, SUFFIXES, Truth, far, judged

sys.path.append(str(Path(__file__).resolve().parents[2] / "python/tests"))
from result_doors import DOORS, takes, through  # type: ignore[import-not-found]

import smartvis
from smartvis import _host
from smartvis._errors import SmartVisError
from smartvis._files import Source
from smartvis._images import says_spacing
from smartvis.cli import main

AXIS, ANGLE = np.array([1, 2, 3]) / 14**0.5, np.deg2rad(30)  # no two of the patient's axes can be taken for each other
ACROSS = np.array([[0, -AXIS[2], AXIS[1]], [AXIS[2], 0, -AXIS[0]], [-AXIS[1], AXIS[0], 0]])
TURN = np.eye(3) + np.sin(ANGLE) * ACROSS + (1 - np.cos(ANGLE)) * ACROSS @ ACROSS


def image_of(voxels: np.ndarray) -> sitk.Image:
    image = sitk.GetImageFromArray(np.ascontiguousarray(voxels))
    image.SetSpacing((2.5, 2.25, 5.0))
    image.SetOrigin((10, -20, 30))
    image.SetDirection(TURN.ravel())
    return image


def affine(image: sitk.Image) -> np.ndarray:
    """From (x, y, z) of a voxel to mm, LPS."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(image.GetDirection()).reshape(3, 3) * image.GetSpacing()
    matrix[:3, 3] = image.GetOrigin()
    return matrix


def clip(path: Path, out: Path, write: str, suffix: str = ".nrrd") -> None:
    code = main(["clip", str(path), "--out", str(out), "--write", write, "--format", suffix])
    assert code == 0, f"smartvis clip ends with {code}"


def make(folder: Path) -> None:
    """The scan, a sequence of two, and our results of both."""
    full = smartvis.scene("D01", size=48).full[::2, 1:46]
    scans = [image_of(full), image_of(np.roll(full, 3, axis=2))]
    sitk.WriteImage(scans[0], str(folder / "scan.nrrd"))
    sitk.WriteImage(sitk.JoinSeries(scans), str(folder / "beat.nrrd"))
    sitk.WriteImage(sitk.JoinSeries(scans), str(folder / "beat.mha"))
    sitk.WriteImage(scans[0], str(folder / "unsaid.mha"))
    known = (folder / "unsaid.mha").read_bytes()
    (folder / "unsaid.mha").write_bytes(known.replace(b"AnatomicalOrientation = RAI", b"AnatomicalOrientation = ???"))
    ours = folder / "ours"
    for suffix in SUFFIXES:
        clip(folder / "scan.nrrd", ours, "clipped,depth,mask", suffix)
    (folder / "unsaid").mkdir()
    for door, suffix, made in through(folder / "unsaid.mha", folder / "doors"):
        made.rename(folder / "unsaid" / f"{door}{suffix}")
    clip(folder / "scan.nrrd", ours, "mesh")
    clip(folder / "beat.nrrd", ours, "clipped", ".seq.nrrd")
    few = ["--frames", "2", "--few-pictures", "--picture", "32", "--setting", "smartvis", "--write", "clipped"]
    _host.run(["run", "--volume", str(folder / "beat.mha"), *few, "--out", str(folder / "run")])
    (folder / "run/clipped.mha").rename(ours / "beat_clipped.mha")
    results = [smartvis.clip(scan) for scan in scans]
    assert all(result.clips for result in results), "nothing was clipped"
    depth = Source(ours / "scan_depth.nrrd").read()
    assert np.array_equal(sitk.GetArrayFromImage(depth)[0], results[0].depth_mm)
    mesh = smartvis._products.mesh(scans[0], results[0])
    truth = Truth(
        scan=full,
        clipped=np.stack([result.apply(sitk.GetArrayFromImage(scan)) for result, scan in zip(results, scans)]),
        depth=sitk.GetArrayFromImage(depth),
        mask=results[0].mask().astype(np.uint8),
        places=np.stack([affine(scans[0]), affine(depth)]),
        vertices=mesh[0],
        faces=np.array(len(mesh[1])),
    )
    truth.save(folder)


def told(truth: Truth, path: Path) -> str:
    """How a peer's file is read, and whether it is known there how it lies in the patient."""
    try:
        source = Source(path)
        image = source.read()
    except SmartVisError as error:
        return "refused, " + str(error).replace(str(path), path.name)
    said = judged(truth.scan, truth.places[0], sitk.GetArrayFromImage(image), affine(image))
    said += "" if says_spacing(image) else ", no spacing"
    said += "" if source.knows_patient else ", not said how it lies in the patient"
    if path.suffix == ".mha":
        info = subprocess.run([_host.find(), "info", path], capture_output=True, text=True, check=False)
        said += "" if info.returncode == 0 else ", refused by host_sim"
    return said


def read(folder: Path) -> None:
    """A peer's files are theirs/PEER/NAME: scan and a suffix, or what it is."""
    truth = Truth.load(folder)
    for path in sorted((folder / "theirs").glob("*/*")):
        if path.name != "scan.raw.gz":  # beside scan.nhdr
            form = path.name.removeprefix("scan")
            print(json.dumps({"peer": path.parent.name, "form": form, "said": told(truth, path)}))
    for path in sorted((folder / "again").glob("*/*")):
        print(json.dumps(told_again(truth, path)))


def told_again(truth: Truth, path: Path) -> dict[str, str]:
    """What a peer made of a result of ours of which nobody said how it lies in the patient, and the same door of that."""
    door, suffix = path.name.partition(".")[0], "".join(path.suffixes)
    came, said = read_of(path)
    right = judged(truth.clipped[0], truth.places[0], sitk.GetArrayFromImage(came), affine(came))
    if right == "right" and takes(door, path, suffix):
        made, says = read_of(DOORS[door](path, path.parent / f"{door}-of-it{suffix}.d", suffix))
        right = "says more" if says and not said else "right" if lies_on(made, came) else "elsewhere"
    of = {"again": path.parent.name, "form": suffix, "door": door}
    return of | {"said": "said" if said else "not said", "right": right}


def read_of(path: Path) -> tuple[sitk.Image, bool]:
    source = Source(path)
    return source.read(), source.knows_patient


def lies_on(made: sitk.Image, came: sitk.Image) -> bool:
    return far(affine(came), affine(made), came.GetSize()[::-1]) < NEAR_MM


if __name__ == "__main__":
    {"make": make, "read": read}[sys.argv[1]](Path(sys.argv[2]))
