# SPDX-License-Identifier: MIT
"""The peers' side: what each reads of ours. read.py FOLDER PEER: of FOLDER/ours by one peer, a line of JSON a kind of
file. A function here reads a file as the peer's own pages show it, and turns what came into what all are judged by:
an array [z, y, x], and where its voxels (x, y, z) lie, in mm, LPS; None: the peer knows no place."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from common import RAS, Truth, judged, judged_mesh

Volume = tuple[np.ndarray, "np.ndarray | None"]


def placed(origin: Any, spacing: Any, direction: Any) -> np.ndarray:
    made = np.eye(4)
    made[:3, :3] = np.reshape(np.asarray(direction, float), (3, 3)) * np.asarray(spacing, float)
    made[:3, 3] = origin
    return made


def first_three(matrix: Any) -> np.ndarray:
    return np.array(matrix, float).reshape(4, 4)[:3, :3]


def of_zyx(values: np.ndarray, place: np.ndarray, axes: int) -> list[Volume]:
    """Of an array with z, y and x; a sequence is a fourth axis before them, or a vector a voxel of three."""
    frames = np.moveaxis(values, -1, 0) if axes == 3 and values.ndim == 4 else values
    return [(one, place) for one in (frames if frames.ndim == 4 else [frames])]


def of_xyz(values: np.ndarray, place: np.ndarray) -> list[Volume]:
    """Of an array with x, y and z, and perhaps time behind them."""
    return [(one.T, place) for one in (np.moveaxis(values, 3, 0) if values.ndim == 4 else [values])]


def of_itk_like(image: Any, values: np.ndarray) -> list[Volume]:
    """Of ITK's classes and those that look like them; a sequence is a fourth axis, or a vector a voxel."""
    if len(image.GetSize()) == 4:
        place = placed(image.GetOrigin()[:3], image.GetSpacing()[:3], first_three(image.GetDirection()))
    else:
        place = placed(image.GetOrigin(), image.GetSpacing(), image.GetDirection())
    return of_zyx(values, place, len(image.GetSize()))


def simpleitk(path: Path) -> list[Volume]:
    import SimpleITK as sitk

    image = sitk.ReadImage(str(path))
    return of_itk_like(image, sitk.GetArrayFromImage(image))


def itk(path: Path) -> list[Volume]:
    import itk as peer

    image = peer.imread(str(path))
    values, size = peer.array_from_image(image), peer.size(image)
    direction = peer.array_from_matrix(image.GetDirection())
    place = placed(tuple(image.GetOrigin())[:3], tuple(image.GetSpacing())[:3], direction[:3, :3])
    return of_zyx(values, place, len(size))


def itkwasm(path: Path) -> list[Volume]:
    import itkwasm_image_io as peer

    image = peer.read_image(str(path))
    place = placed(image.origin[:3], image.spacing[:3], np.asarray(image.direction)[:3, :3])
    return of_zyx(np.asarray(image.data), place, len(image.size))


def nibabel(path: Path) -> list[Volume]:
    import nibabel as peer

    image = peer.load(path)
    return [(np.asarray(image.dataobj).T, RAS @ image.affine)]


def pynrrd(path: Path) -> list[Volume]:
    import nrrd as peer

    values, header = peer.read(str(path))
    assert header["space"] == "left-posterior-superior"
    place = np.eye(4)
    place[:3, :3], place[:3, 3] = np.asarray(header["space directions"], float)[:3].T, header["space origin"]
    return of_xyz(values, place)


def slicerio(path: Path) -> list[Volume]:
    import slicerio as peer

    volume = peer.read_volume(str(path))
    values, place = volume["voxels"], volume["ijkToLPS"]
    return of_xyz(values, place)


def ants(path: Path) -> list[Volume]:
    import ants as peer

    image = peer.image_read(str(path))
    values, directions = image.numpy(), np.asarray(image.direction)[:3, :3]
    place = placed(image.origin[:3], image.spacing[:3], directions)
    return of_xyz(values, place)


def c3d(path: Path) -> list[Volume]:
    import io

    import picsl_c3d as peer
    import SimpleITK as sitk

    tool = peer.Convert3D()
    tool.execute(f"{path} -info", out=io.StringIO())
    image = tool.peek(-1)
    return of_itk_like(image, sitk.GetArrayFromImage(image))


def plastimatch(path: Path) -> list[Volume]:
    """It has no arrays: what it writes of a file is read."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder, "made.mha")
        command = ["plastimatch", "convert", "--input", str(path), "--output-img", str(made)]
        subprocess.run(command, check=True, capture_output=True)
        return simpleitk(made)


def of_vtk(image: Any, matrix: Any = None) -> list[Volume]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    values = vtk_to_numpy(image.GetPointData().GetScalars())
    shape = (*image.GetDimensions()[::-1], -1)
    place = np.array([matrix.GetElement(i, j) for i in range(4) for j in range(4)]).reshape(4, 4) if matrix else None
    frames = np.moveaxis(values.reshape(shape), -1, 0)
    return [(one, place) for one in frames]


def vtk(path: Path) -> list[Volume]:
    import vtk as peer

    readers = {".mha": peer.vtkMetaImageReader, ".nrrd": peer.vtkNrrdReader, ".gz": peer.vtkNIFTIImageReader}
    reader = readers[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    if path.suffix != ".gz":
        return of_vtk(image, image.GetIndexToPhysicalMatrix())
    spacing = np.diag([*image.GetSpacing(), 1])  # the header's matrix is from mm along the axes
    (values, place), *_ = of_vtk(image, reader.GetQFormMatrix())
    return [(values, RAS @ place @ spacing)]


def pyvista(path: Path) -> list[Volume]:
    import pyvista as peer

    image = peer.read(path)
    return of_vtk(image, image.GetIndexToPhysicalMatrix())


def monai(path: Path) -> list[Volume]:
    from monai.transforms import LoadImage

    image = LoadImage(image_only=True, ensure_channel_first=False)(str(path))
    values = np.asarray(image.array)
    place = RAS @ np.asarray(image.affine)
    return of_xyz(values, place)


def torchio(path: Path) -> list[Volume]:
    import torchio as peer

    image = peer.ScalarImage(path)
    return [(one.T, RAS @ np.asarray(image.affine)) for one in image.data.numpy()]


def of_slicer(node: Any, storage: Any, path: Path) -> Any:
    import slicer_core as peer

    scene = peer.vtkMRMLScene()
    for one in (node, storage):
        scene.AddNode(one)
    storage.SetFileName(str(path))
    assert storage.ReadData(node), storage.GetUserMessages().GetAllMessagesAsString()
    return node, scene


def slicer(path: Path) -> list[Volume]:
    import slicer_core as peer
    from vtkmodules.vtkCommonMath import vtkMatrix4x4

    if path.name.startswith("beat"):
        sequence, kept = of_slicer(peer.vtkMRMLSequenceNode(), peer.vtkMRMLVolumeSequenceStorageNode(), path)
        nodes = [sequence.GetNthDataNode(n) for n in range(sequence.GetNumberOfDataNodes())]
    else:
        node, kept = of_slicer(peer.vtkMRMLScalarVolumeNode(), peer.vtkMRMLVolumeArchetypeStorageNode(), path)
        nodes = [node]
    assert kept
    volumes = []
    for node in nodes:
        matrix = vtkMatrix4x4()
        node.GetIJKToRASMatrix(matrix)
        volumes += [(values, RAS @ place) for values, place in of_vtk(node.GetImageData(), matrix) if place is not None]
    return volumes


def slicer_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    import slicer_core as peer

    node, kept = of_slicer(peer.vtkMRMLModelNode(), peer.vtkMRMLModelStorageNode(), path)
    assert kept
    points, faces = of_polydata(node.GetPolyData())
    return points @ RAS[:3, :3], faces


def of_mesh(points: Any, faces: Any) -> tuple[np.ndarray, np.ndarray]:
    return np.asarray(points, float), np.asarray(faces)


def of_polydata(mesh: Any) -> tuple[np.ndarray, np.ndarray]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    points = vtk_to_numpy(mesh.GetPoints().GetData())
    return of_mesh(points, vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3))


def trimesh_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    import trimesh as peer

    mesh = peer.load(path, process=False)
    return of_mesh(mesh.vertices, mesh.faces)


def meshio_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    import meshio as peer

    mesh = peer.read(path)
    return of_mesh(mesh.points, mesh.cells_dict["triangle"])


def vtk_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    import vtk as peer

    reader = peer.vtkPLYReader()
    reader.SetFileName(str(path))
    reader.Update()
    return of_polydata(reader.GetOutput())


def pyvista_mesh(path: Path) -> tuple[np.ndarray, np.ndarray]:
    import pyvista as peer

    mesh = peer.read(path)
    return of_mesh(mesh.points, mesh.regular_faces)


def pyigtl(truth: Truth) -> str:
    """The scan is sent to `smartvis serve`; of its answers the clipped volume, in the axes in which it was sent."""
    import pyigtl as peer

    command = [os.environ["OURS"], "-m", "smartvis", "serve", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as server:
        try:
            assert server.stdout
            port = next(int(found[1]) for line in server.stdout if (found := re.search(r":(\d+);", line)))
            client = peer.OpenIGTLinkClient("127.0.0.1", port)
            client.send_message(peer.ImageMessage(truth.scan, RAS @ truth.places[0], device_name="Scan"), wait=True)
            answer = client.wait_for_message("Scan_clipped", timeout=60)
            client.stop()
        finally:
            server.terminate()
    assert answer, "no answer"
    return judged(truth.clipped[0], truth.places[0], answer.image, RAS @ answer.ijk_to_world_matrix)


FILES = {".nrrd": "scan", ".mha": "scan", ".nii.gz": "scan", ".seq.nrrd": "beat", "beat.mha": "beat"}


def told(truth: Truth, peer: str, folder: Path, kind: str) -> str:
    """Of one kind of file: the clipped volume and its depthmap, or the two volumes of a sequence."""
    if kind == "IMAGE":
        return pyigtl(truth)
    if kind == ".ply":
        return judged_mesh(truth, *globals()[f"{peer}_mesh"](folder / "scan_mesh.ply"))
    read, suffix = globals()[peer], kind.removeprefix("beat")
    if FILES[kind] == "scan":
        expected = [("clipped", truth.clipped[:1], truth.places[0]), ("mask", truth.mask[None], truth.places[0]),
                    ("depth", truth.depth[None], truth.places[1])]  # fmt: skip
    else:
        expected = [("clipped", truth.clipped, truth.places[0])]
    said = []
    for product, values, place in expected:
        came = read(folder / f"{FILES[kind]}_{product}{suffix}")
        said += [judged(one, place, *volume) for one, volume in zip(values, came, strict=False)]
        said += ["the first alone"] if len(came) < len(values) else []
    return "; ".join(dict.fromkeys(said))


if __name__ == "__main__":
    scene = Truth.load(Path(sys.argv[1]))
    for kind in sys.argv[3:]:
        try:
            said = told(scene, sys.argv[2], Path(sys.argv[1], "ours"), kind)
        except Exception as error:  # noqa: BLE001 (each library has its own)
            print(f"{sys.argv[2]} {kind}: {type(error).__name__}: {error}", file=sys.stderr)
            said = "refused"
        print(json.dumps({"kind": kind, "said": said}))
