# SPDX-License-Identifier: MIT
"""``smartvis console``: formats that the machine does not read are the same volume in its console."""

import contextlib
import http.client
import signal
import subprocess
import sys
from urllib.parse import unquote

import numpy as np
import pydicom
import pytest
import SimpleITK as sitk
from conftest import LONG, SOURCE, host, layers, write_dicom
from makers import two_places
from makers_dicom import enhanced, far_probe
from PIL import Image  # type: ignore[import-not-found]

from smartvis import clip
from smartvis import scene as of_scene
from smartvis._answers import volumes
from smartvis._errors import FileError, OutputError
from smartvis.console import Page as Door

sys.path.insert(0, str(SOURCE / "tests" / "host_sim" / "console"))
from console_client import Address, Page  # type: ignore[import-not-found]


def smartvis(*arguments):
    return subprocess.Popen(
        [sys.executable, "-m", "smartvis", "console", *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def test_an_interrupt_that_only_python_gets_ends_the_console():
    began = smartvis("--stay")
    try:
        assert began.stdout.readline().startswith("Console  http://127.0.0.1:")
        began.send_signal(signal.SIGINT)
        assert began.wait(LONG) == 0
    finally:
        began.kill()
        began.communicate()


def test_formats_are_one_volume(tmp_path):
    image = sitk.GetImageFromArray(layers((40, 32, 24)))
    image.SetSpacing((0.9, 0.7, 1.1))
    for name in ("a.nii.gz", "b.nrrd"):
        sitk.WriteImage(image, str(tmp_path / name))
    write_dicom(tmp_path / "study", image)
    began = smartvis(tmp_path / "a.nii.gz", tmp_path / "b.nrrd", tmp_path / "study")
    try:
        line = began.stdout.readline()
        assert line.startswith("Console  http://127.0.0.1:"), line + began.stderr.read()
        address = Address(line.split()[1])
        page = Page(address, timeout=LONG)
        files = [(one["folder"], one["path"]) for one in page.must("hello")["files"]]
        assert files == [(0, f"{name}.copy.mha") for name in ("a.nii.gz", "b.nrrd", "study")]
        assert unquote(address.first) == "file=0:a.nii.gz.copy.mha"
        drawn = []
        for folder, path in files:
            frame = page.show(source={"folder": folder, "path": path, "from": "probe"}, views=["full", "across"])
            assert frame["type"] == "frame", frame
            assert frame["source"]["voxels"] == [24, 32, 40] and frame["source"]["mm"]
            assert np.isclose(frame["source"]["voxel_mm"], 1.1, atol=1e-4)
            drawn.append({view: one[5] for view, one in page.pictures.items()})
        assert drawn[0] == drawn[1] == drawn[2]
        page.close()
        began.send_signal(signal.SIGTERM)
        began.wait(LONG)
        assert began.returncode == 128 + signal.SIGTERM
    finally:
        began.kill()
        began.communicate()


def test_what_a_file_says_of_probe_and_place_is_told(tmp_path):
    """The fan's apex, and which of two places counts."""
    scan = of_scene("D01", size=96).full[::2]
    far_probe(tmp_path / "far.dcm", scan)
    two_places(tmp_path / "two.nii", scan)
    clipped = clip(str(tmp_path / "far.dcm")).beams
    told = {name: (host("info", file)[1], what) for file, name, what in volumes(tmp_path / "far.dcm")}
    assert f"beams: {clipped}\n" in told["far.dcm.copy.mha"][0] and told["far.dcm.copy.mha"][1] == ""
    began = smartvis(tmp_path / "two.nii")
    try:
        assert began.stdout.readline().startswith("Console  ")
    finally:
        began.terminate()
        said = began.communicate(timeout=LONG)[1]
    assert said.startswith("two.nii: Its qform and its sform disagree, by 30 degrees")


def test_volumes_of_two_sizes_are_no_sequence(tmp_path):
    for number, side in enumerate((24, 32)):
        write_dicom(tmp_path / "study", sitk.GetImageFromArray(layers((24, 32, side))), series=f"1.2.3.{number}")
    sizes = {name: sitk.ReadImage(str(file)).GetSize() for file, name, _ in volumes(tmp_path / "study")}
    assert sizes == {"study volume 1.copy.mha": (24, 32, 24), "study volume 2.copy.mha": (32, 32, 24)}


def test_a_sequence_holds_its_volumes_in_their_place(tmp_path):
    """One volume after the other, and only as many bytes as there is room for."""
    one = sitk.GetImageFromArray(layers((24, 32, 40)).astype(np.int16))
    one.SetSpacing((0.5, 0.6, 0.7))
    one.SetOrigin((1.0, -2.0, 3.5))
    sitk.WriteImage(sitk.JoinSeries([one, one * 2, one + 1]), str(tmp_path / "beat.nrrd"))
    for file, name, told in volumes(tmp_path / "beat.nrrd"):
        assert (name, told) == ("beat.nrrd.copy.mha", "")
        whole = sitk.ReadImage(str(file))
        assert whole.GetSize() == (40, 32, 24, 3) and whole.GetSpacing()[:3] == one.GetSpacing()
        assert whole.GetOrigin()[:3] == one.GetOrigin()
        for number, image in enumerate((one, one * 2, one + 1)):
            assert np.array_equal(sitk.GetArrayViewFromImage(whole)[number], sitk.GetArrayViewFromImage(image))
    with pytest.raises(FileError, match=r"beat\.nrrd: its volumes are more than"):
        list(volumes(tmp_path / "beat.nrrd", most=100_000))


def test_what_is_no_volume_is_told(tmp_path):
    (tmp_path / "x.nii").write_text("no volume")
    began = smartvis(tmp_path / "x.nii")
    said = began.communicate(timeout=LONG)
    assert began.returncode == 3 and "x.nii" in said[1] and said[0] == ""


@contextlib.contextmanager
def started(*files):
    began = smartvis(*files)
    try:
        line = began.stdout.readline()
        assert line.startswith("Console  http://127.0.0.1:"), line + began.stderr.read()
        yield line.split()[1]
    finally:
        began.terminate()
        began.communicate(timeout=LONG)


def dicom_of(address, png, of):
    """What the console makes of a picture: the file's header and pixels, or a sentence."""
    link = http.client.HTTPConnection(address.place, timeout=LONG)
    headers = {"Origin": f"http://{address.place}"}
    link.request("POST", f"/dicom?t={address.token}&of={of}", body=png.read_bytes(), headers=headers)
    answer = link.getresponse()
    said = answer.read()
    link.close()
    if answer.status != http.client.OK:
        return said.decode()
    png.with_suffix(".dcm").write_bytes(said)
    return pydicom.dcmread(png.with_suffix(".dcm"))


def cases(folder, scan):
    """A file of each kind that is dropped, and how many volumes it has."""
    image = sitk.GetImageFromArray(scan)
    for name in ("a.nii.gz", "a.nrrd"):
        sitk.WriteImage(image, str(folder / name))
    sitk.WriteImage(sitk.JoinSeries([image] * 2), str(folder / "beat.nii.gz"))
    enhanced(folder / "scan.dcm", scan)
    said = pydicom.dcmread(folder / "scan.dcm")
    said.PatientID, said.StudyInstanceUID = "17", "1.2.3"
    said.save_as(folder / "scan.dcm")
    two_places(folder / "two.nii", scan)
    return dict.fromkeys(("a.nii.gz", "a.nrrd", "scan.dcm", "two.nii"), 1) | {"beat.nii.gz": 2}


def test_what_is_dropped_on_the_page(tmp_path):
    """Formats that the machine does not read are opened, too; DICOM of a picture says whose the scan is."""
    made = cases(tmp_path, of_scene("D01", size=96).full[::2])
    (tmp_path / "bad.nii").write_text("no volume")
    with started() as address:
        door, page = Door(address), Page(Address(address), timeout=LONG)
        assert page.must("hello")["drop"]["reader"] is True
        for name, count in made.items():
            copy = door.drop(tmp_path / name, name)
            assert copy == f"{name}.copy.mha"
            frame = page.show(source={"folder": 0, "path": copy, "from": "probe"}, views=["full"])
            assert frame["type"] == "frame" and frame["source"]["voxels"] == [96, 96, 48], frame
            assert frame["source"]["volumes"] == count
        with pytest.raises(OutputError) as refused:
            door.drop(tmp_path / "bad.nii", "bad.nii")
        assert str(refused.value).startswith("bad.nii: ")
        pixels = np.random.default_rng(1).integers(0, 256, (20, 30, 3), np.uint8)
        Image.fromarray(pixels).save(tmp_path / "seen.png")
        for copy, patient in (("scan.dcm.copy.mha", "17"), ("a.nrrd.copy.mha", ""), ("", ""), ("none.mha", "")):
            data = dicom_of(Address(address), tmp_path / "seen.png", copy)
            assert data.PatientID == patient and np.array_equal(data.pixel_array, pixels)
        (tmp_path / "seen.png").write_bytes(b"no picture")
        assert "is no PNG that can be read" in dicom_of(Address(address), tmp_path / "seen.png", "")
        page.close()


def test_a_picture_of_a_file_of_the_command_line_says_whose_it_is(tmp_path):
    files = write_dicom(tmp_path / "study", sitk.GetImageFromArray(layers((24, 32, 32))))
    for file in files:
        scan = pydicom.dcmread(file)
        scan.PatientID, scan.StudyInstanceUID = "18", "1.2.3"
        scan.save_as(file)
    Image.fromarray(np.zeros((8, 8, 3), np.uint8)).save(tmp_path / "seen.png")
    with started(tmp_path / "study") as address:
        assert dicom_of(Address(address), tmp_path / "seen.png", "study.copy.mha").PatientID == "18"
