# SPDX-License-Identifier: MIT
"""``smartvis dicom``: saved pictures are the same pixels in DICOM, and of the patient only what the scan says."""

import numpy as np
import pydicom
import pytest
import SimpleITK as sitk
from conftest import layers, write_dicom
from PIL import Image  # type: ignore[import-not-found]

import smartvis
from smartvis.cli import main


def pictures(count, shape=(30, 41, 3)):
    return [np.random.default_rng(n).integers(0, 256, shape, np.uint8) for n in range(count)]


def saved(folder, frames, name="a.png", **more):
    first, *rest = [Image.fromarray(frame) for frame in frames]
    first.save(folder / name, save_all=bool(rest), append_images=rest, **more)
    return str(folder / name)


def test_a_picture(tmp_path):
    frames, out = pictures(1), tmp_path / "a.dcm"
    assert main(["dicom", saved(tmp_path, frames), "--out", str(out)]) == 0
    data = pydicom.dcmread(out)
    assert np.array_equal(data.pixel_array, frames[0])
    assert np.array_equal(sitk.GetArrayFromImage(sitk.ReadImage(str(out)))[0], frames[0])
    assert data.SoftwareVersions == smartvis.load().version
    assert data.SOPClassUID == "1.2.840.10008.5.1.4.1.1.7" and data.BurnedInAnnotation == "YES"
    assert (data.PatientName, data.PatientID, data.PatientSex, "NumberOfFrames" in data) == ("", "", "", False)


def test_a_cine(tmp_path):
    frames, out = pictures(3), tmp_path / "a.dcm"
    assert main(["dicom", saved(tmp_path, frames, duration=80), "--out", str(out)]) == 0
    data = pydicom.dcmread(out)
    assert data.SOPClassUID == "1.2.840.10008.5.1.4.1.1.7.4" and data.NumberOfFrames == 3 and data.FrameTime == 80
    assert data[data.FrameIncrementPointer].keyword == "FrameTime" and np.array_equal(data.pixel_array, frames)
    one_by_one = [saved(tmp_path, [frame], f"{n}.png") for n, frame in enumerate(frames)]
    assert main(["dicom", *one_by_one, "--out", str(out)]) == 0
    assert np.array_equal(pydicom.dcmread(out).pixel_array, frames)


def test_whose_it_is(tmp_path):
    """Patient and study of the scan, and no more of it; two captures are two objects."""
    image = sitk.GetImageFromArray(layers((4, 8, 8)))
    files = write_dicom(tmp_path / "study", image)
    for file in files:
        scan = pydicom.dcmread(file)
        scan.SpecificCharacterSet, scan.PatientName, scan.PatientID = "ISO_IR 192", "Müller^Änne", "17"
        scan.InstitutionName, scan.StudyDate, scan.StudyInstanceUID = "A clinic", "20260102", "1.2.3"
        scan.save_as(file)
    (tmp_path / "study" / "1_notes.txt").write_text("no DICOM")
    made = []
    for of in (tmp_path / "study", files[0]):
        arguments = ["dicom", saved(tmp_path, pictures(1)), "--out", str(tmp_path / "a.dcm"), "--of", str(of)]
        assert main(arguments) == 0
        made.append(pydicom.dcmread(tmp_path / "a.dcm"))
    for data in made:
        assert (str(data.PatientName), data.PatientID, data.StudyDate) == ("Müller^Änne", "17", "20260102")
        assert data.StudyInstanceUID == scan.StudyInstanceUID and data.SeriesInstanceUID != scan.SeriesInstanceUID
        assert "InstitutionName" not in data
    assert made[0].SOPInstanceUID != made[1].SOPInstanceUID


@pytest.mark.parametrize("wrong", ["size", "file", "scan", "several"])
def test_what_is_wrong_is_told(tmp_path, capsys, wrong):
    names, more = [saved(tmp_path, pictures(1))], []
    (tmp_path / "x.png").write_bytes(b"\x89PNG\r\n\x1a\nno picture")
    if wrong == "size":
        names.append(saved(tmp_path, pictures(1, (30, 40, 3)), "b.png"))
    elif wrong == "file":
        names.append(str(tmp_path / "x.png"))
    elif wrong == "scan":
        more = ["--of", str(tmp_path / "x.png")]
    else:
        write_dicom(tmp_path / "study", sitk.GetImageFromArray(layers((4, 8, 8))))
        for n, file in enumerate(sorted((tmp_path / "study").iterdir())):
            scan = pydicom.dcmread(file)
            scan.StudyInstanceUID, scan.PatientID = "1.2.3", str(n // 3)
            scan.save_as(file)
        more = ["--of", str(tmp_path / "study")]
    assert main(["dicom", *names, "--out", str(tmp_path / "out.dcm"), *more]) == 3
    said = {
        "size": "40 x 30 pixels",
        "file": "x.png: is no PNG",
        "scan": "is no DICOM",
        "several": "differ in PatientID",
    }
    assert said[wrong] in capsys.readouterr().err
    assert not (tmp_path / "out.dcm").exists()
