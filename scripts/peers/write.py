# SPDX-License-Identifier: MIT
"""The peers' side: what each writes of the scan, as its own pages show it. write.py FOLDER PEER: files of one peer in
FOLDER/theirs/PEER; a file is called scan and its suffix, or what it is."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from common import RAS, SUFFIXES, Truth, parts_of


def of_simpleitk(scan: np.ndarray, place: np.ndarray) -> Any:
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(scan)
    origin, spacing, direction = parts_of(place)
    image.SetOrigin(origin.tolist())
    image.SetSpacing(spacing.tolist())
    image.SetDirection(direction.ravel().tolist())
    return image


def series(scan: np.ndarray, place: np.ndarray, folder: Path) -> list[Path]:
    """A DICOM series by pydicom, Ultrasound Images with their place: a file a slice."""
    import pydicom

    folder.mkdir(parents=True)
    spacing, direction = parts_of(place)[1:]
    data, kind, uid = pydicom.Dataset(), "1.2.840.10008.5.1.4.1.1.6.1", "1.2.826.0.1.3680043.8.498.1"
    data.SOPClassUID, data.Modality, data.PatientName, data.PatientID = kind, "US", "None^None", "0"
    data.StudyInstanceUID, data.SeriesInstanceUID, data.FrameOfReferenceUID = f"{uid}.1", f"{uid}.2", f"{uid}.3"
    data.StudyDate, data.StudyTime, data.StudyID, data.AccessionNumber = "20200101", "000000", "1", ""
    data.PatientBirthDate = data.PatientSex = data.ReferringPhysicianName = data.PositionReferenceIndicator = ""
    data.SeriesNumber, data.Manufacturer, data.ImageType = 1, "NONE", ["ORIGINAL", "PRIMARY"]
    data.ImageOrientationPatient = [f"{part:.12g}" for part in (*direction[:, 0], *direction[:, 1])]
    data.PixelSpacing, data.SliceThickness = [f"{part:g}" for part in spacing[1::-1]], f"{spacing[2]:g}"
    data.SamplesPerPixel, data.PhotometricInterpretation, data.PixelRepresentation = 1, "MONOCHROME2", 0
    data.BitsAllocated, data.BitsStored, data.HighBit = 8, 8, 7
    data.Rows, data.Columns = scan.shape[1:]
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    files = []
    for z, plane in enumerate(scan):
        data.SOPInstanceUID, data.InstanceNumber = f"{uid}.4.{z + 1}", z + 1
        data.ImagePositionPatient = [f"{part:.9g}" for part in (place @ (0, 0, z, 1))[:3]]
        data.PixelData = plane.tobytes()
        files.append(folder / f"{z:03d}.dcm")
        data.save_as(files[-1], enforce_file_format=True)
    return files


def pydicom(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    series(scan, place, folder / "DICOM series")


def simpleitk(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import SimpleITK as sitk

    for suffix in (*SUFFIXES, ".vtk"):
        sitk.WriteImage(of_simpleitk(scan, place), str(folder / f"scan{suffix}"))


def simpleitk_again(path: Path, made: Path) -> None:
    import SimpleITK as sitk

    sitk.WriteImage(sitk.ReadImage(str(path)), str(made))


def itk(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import itk as peer

    image = peer.image_from_array(scan)
    origin, spacing, direction = parts_of(place)
    image.SetOrigin(origin)
    image.SetSpacing(spacing)
    image.SetDirection(peer.matrix_from_array(direction))
    for suffix in SUFFIXES:
        peer.imwrite(image, str(folder / f"scan{suffix}"))


def itkwasm(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import itkwasm
    import itkwasm_image_io as peer

    origin, spacing, direction = parts_of(place)
    kind = itkwasm.ImageType(3, itkwasm.IntTypes.UInt8, itkwasm.PixelTypes.Scalar, 1)
    image = itkwasm.Image(kind, "scan", origin.tolist(), spacing.tolist(), direction, list(scan.shape[::-1]), {}, scan)
    for suffix in SUFFIXES:
        peer.write_image(image, str(folder / f"scan{suffix}"))


def nibabel(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import nibabel as peer

    image = peer.Nifti1Image(scan.T, RAS @ place)
    image.header.set_xyzt_units("mm")
    for suffix in (".nii", ".nii.gz"):
        peer.save(image, folder / f"scan{suffix}")
    peer.save(peer.Nifti2Image(scan.T, RAS @ place), folder / "NIfTI-2.nii")


def pynrrd(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import nrrd as peer

    head = {"space": "left-posterior-superior", "space directions": place[:3, :3].T, "space origin": place[:3, 3]}
    peer.write(str(folder / "scan.nrrd"), scan.T, head)
    peer.write(str(folder / "scan.nhdr"), scan.T, head)


def ants(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import ants as peer

    origin, spacing, direction = parts_of(place)
    image = peer.from_numpy(scan.T, origin.tolist(), spacing.tolist(), direction)
    for suffix in SUFFIXES:
        peer.image_write(image, str(folder / f"scan{suffix}"))


def c3d_again(path: Path, made: Path) -> None:
    import picsl_c3d as peer

    peer.Convert3D().execute(f"{path} -type uchar -o {made}")


def c3d(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import picsl_c3d as peer

    tool = peer.Convert3D()
    tool.push(of_simpleitk(scan, place))
    for suffix in SUFFIXES:
        tool.execute(f"-type uchar -o {folder / ('scan' + suffix)}")


def plastimatch(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import SimpleITK as sitk

    given = folder.parent.parent / "given.nrrd"
    sitk.WriteImage(of_simpleitk(scan, place), str(given))
    for suffix in SUFFIXES:
        convert(given, "--output-img", folder / f"scan{suffix}")
    convert(given, "--output-dicom", folder / "DICOM series", "--modality", "US")


def convert(given: Path, *how: object) -> None:
    run("plastimatch", "convert", "--input", given, *how)


def run(*command: object) -> None:
    subprocess.run([str(part) for part in command], check=True, capture_output=True)


def of_vtk(scan: np.ndarray, place: np.ndarray) -> Any:
    import vtk as peer
    from vtkmodules.util.numpy_support import numpy_to_vtk

    image = peer.vtkImageData()
    origin, spacing, direction = parts_of(place)
    image.SetDimensions(*scan.shape[::-1])
    image.SetOrigin(*origin)
    image.SetSpacing(*spacing)
    image.SetDirectionMatrix(*direction.ravel())
    image.GetPointData().SetScalars(numpy_to_vtk(scan.ravel(), deep=True))
    return image


def vtk(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import vtk as peer

    for writer, suffix in ((peer.vtkMetaImageWriter(), ".mha"), (peer.vtkStructuredPointsWriter(), ".vtk")):
        writer.SetFileName(str(folder / f"scan{suffix}"))
        writer.SetInputData(of_vtk(scan, place))
        if suffix == ".vtk":
            writer.SetFileTypeToBinary()  # as text it writes grey of 8 bits as parts of 1
        writer.Write()
    writer, matrix = peer.vtkNIFTIImageWriter(), peer.vtkMatrix4x4()
    turned = RAS @ place @ np.diag([*1 / parts_of(place)[1], 1])
    matrix.DeepCopy(turned.ravel())
    writer.SetFileName(str(folder / "scan.nii.gz"))
    image = of_vtk(scan, place)
    image.SetOrigin(0, 0, 0)
    image.SetDirectionMatrix(*np.eye(3).ravel())
    writer.SetInputData(image)
    writer.SetQFormMatrix(matrix)
    writer.Write()


def pyvista(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import pyvista as peer

    peer.wrap(of_vtk(scan, place)).save(folder / "scan.vti")


def monai(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    from monai.data import ITKWriter, NibabelWriter

    for writer, suffix in ((NibabelWriter(), ".nii.gz"), (ITKWriter(), ".nrrd"), (ITKWriter(), ".mha")):
        writer.set_data_array(scan.T[None], channel_dim=0)
        writer.set_metadata({"affine": RAS @ place}, resample=False)
        writer.write(str(folder / f"scan{suffix}"))


def torchio(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import torchio as peer

    image = peer.ScalarImage(tensor=scan.T[None].copy(), affine=RAS @ place)
    for suffix in SUFFIXES:
        image.save(folder / f"scan{suffix}")


def slicer_storage(scene: Any, path: Path) -> Any:
    import slicer_core as peer

    storage = peer.vtkMRMLVolumeArchetypeStorageNode()
    scene.AddNode(storage)
    storage.SetFileName(str(path))
    return storage


def slicer_again(path: Path, made: Path) -> None:
    import slicer_core as peer

    scene, node = peer.vtkMRMLScene(), peer.vtkMRMLScalarVolumeNode()
    scene.AddNode(node)
    assert slicer_storage(scene, path).ReadData(node) and slicer_storage(scene, made).WriteData(node)


def slicer(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import slicer_core as peer
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkCommonMath import vtkMatrix4x4
    from vtkmodules.util.numpy_support import numpy_to_vtk

    scene, node, matrix, image = peer.vtkMRMLScene(), peer.vtkMRMLScalarVolumeNode(), vtkMatrix4x4(), vtkImageData()
    scene.AddNode(node)
    image.SetDimensions(*scan.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(scan.ravel(), deep=True))
    matrix.DeepCopy((RAS @ place).ravel())
    node.SetAndObserveImageData(image)
    node.SetIJKToRASMatrix(matrix)
    for suffix in SUFFIXES:
        assert slicer_storage(scene, folder / f"scan{suffix}").WriteData(node)
    sequence, storage = peer.vtkMRMLSequenceNode(), peer.vtkMRMLVolumeSequenceStorageNode()
    for one in (sequence, storage):
        scene.AddNode(one)
    for time in range(2):
        sequence.SetDataNodeAtValue(node, str(time))
    storage.SetFileName(str(folder / "scan.seq.nrrd"))
    assert storage.WriteData(sequence)


def of_series(scan: np.ndarray, place: np.ndarray, folder: Path) -> list[Path]:
    return series(scan, place, Path(tempfile.mkdtemp(dir=folder.parent.parent)) / "given")


def dcm2niix(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    given = of_series(scan, place, folder)[0].parent
    run("dcm2niix", "-f", "scan", "-z", "y", "-b", "n", "-o", folder, given)


def packed(scan: np.ndarray, place: np.ndarray, folder: Path, by: dict[str, tuple[str, ...]]) -> None:
    """The same series in other transfer syntaxes."""
    for name, command in by.items():
        made = folder / f"DICOM series, {name}"
        made.mkdir()
        for path in of_series(scan, place, folder):
            run(*command, path, made / path.name)


def gdcm(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    syntaxes = {"JPEG 2000": "--j2k", "JPEG-LS": "--jpegls", "JPEG": "--jpeg", "RLE": "--rle", "deflated": "--deflated"}
    packed(scan, place, folder, {name: ("gdcmconv", option) for name, option in syntaxes.items()})


def dcmtk(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    syntaxes = {"JPEG": ("dcmcjpeg", "+e1"), "JPEG-LS": ("dcmcjpls",), "RLE": ("dcmcrle",)}
    syntaxes |= {"big endian": ("dcmconv", "+tb"), "deflated": ("dcmconv", "+td")}
    packed(scan, place, folder, syntaxes)


def highdicom(scan: np.ndarray, place: np.ndarray, folder: Path) -> None:
    import highdicom as peer
    import pydicom

    given = [pydicom.dcmread(path) for path in of_series(scan, place, folder)]
    common: dict[str, Any] = {"series_instance_uid": peer.UID(), "series_number": 2, "instance_number": 1}
    common |= {"sop_instance_uid": peer.UID(), "manufacturer": "NONE", "manufacturer_model_name": "NONE"}
    common |= {"software_versions": "0", "device_serial_number": "0"}
    code = peer.sr.CodedConcept("T-D0050", "SRT", "Tissue")
    known = peer.AlgorithmIdentificationSequence("none", code, "0")
    kind = peer.seg.SegmentDescription(
        1, "tissue", code, code, peer.seg.SegmentAlgorithmTypeValues.AUTOMATIC, algorithm_identification=known
    )
    mask = (scan > 0).astype(np.uint8)
    binary = peer.seg.SegmentationTypeValues.BINARY
    peer.seg.Segmentation(given, mask, binary, [kind], **common).save_as(folder / "Segmentation.dcm")
    mapped = peer.pm.RealWorldValueMapping(
        "1", "grey", peer.sr.CodedConcept("1", "UCUM", "no units"), (0, 255), 0.0, 1.0
    )
    peer.pm.ParametricMap(
        given, scan.astype(np.uint16), contains_recognizable_visual_features=True, real_world_value_mappings=[mapped],
        window_center=128, window_width=256, **common,
    ).save_as(folder / "Parametric Map.dcm")  # fmt: skip


if __name__ == "__main__":
    truth, peer = Truth.load(Path(sys.argv[1])), sys.argv[2]
    made = Path(sys.argv[1], "theirs", peer)
    made.mkdir(parents=True)
    globals()[peer](truth.scan, truth.places[0], made)
    again = globals().get(f"{peer}_again")  # results, by all doors, of which nobody said how they lie in the patient
    for path in sorted(Path(sys.argv[1], "unsaid").iterdir()) if again else ():
        Path(sys.argv[1], "again", peer).mkdir(parents=True, exist_ok=True)
        again(path, Path(sys.argv[1], "again", peer, path.name))
