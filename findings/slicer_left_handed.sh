#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: 3D Slicer, which stands on ITK, counts the voxels of a volume as ITK does, whichever way the file's axes turn: a voxel has the
# same index there as in SimpleITK, and only axes that are not at right angles are changed on reading.
# Found: where the axes are left-handed, Slicer reverses the order of slices and moves the origin, without a word. Places in the patient
# stay; the first slice is the last. What it saves is right-handed.
# Who takes indices from one to the other (a slice's number, the side of a probe, a list of frames) goes by the place in the patient.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages slicer-core==5.13.31053.0 SimpleITK==2.5.7 numpy==2.4.6
seen 'right-handed: SimpleITK [1, 2, 0], Slicer [1, 2, 0], as saved [1, 2, 0]; all at [11.0, 22.0, 30.0]
left-handed:  SimpleITK [1, 2, 0], Slicer [1, 2, 3], as saved [1, 2, 3]; all at [11.0, 22.0, 30.0]' << 'PYTHON'
from pathlib import Path
import numpy as np, SimpleITK, slicer_core
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonMath import vtkMatrix4x4

def by_simpleitk(name):
    image = SimpleITK.ReadImage(name)
    index = np.argwhere(SimpleITK.GetArrayFromImage(image))[0][::-1].tolist()
    return index, list(image.TransformIndexToPhysicalPoint(index))

def by_slicer(node):
    image, matrix = node.GetImageData(), vtkMatrix4x4()
    voxels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(image.GetDimensions()[::-1])
    index = np.argwhere(voxels)[0][::-1].tolist()
    node.GetIJKToRASMatrix(matrix)
    right, anterior, superior, _ = matrix.MultiplyPoint((*index, 1))
    return index, [-right, -anterior, superior]

for what, z in (("right-handed:", 1), ("left-handed: ", -1)):
    voxels = np.zeros((4, 3, 2), np.uint8)
    voxels[0, 2, 1] = 200
    given = SimpleITK.GetImageFromArray(voxels)
    given.SetOrigin((10, 20, 30))
    given.SetDirection((1, 0, 0, 0, 1, 0, 0, 0, z))
    SimpleITK.WriteImage(given, "given.nrrd")
    scene, node = slicer_core.vtkMRMLScene(), slicer_core.vtkMRMLScalarVolumeNode()
    scene.AddNode(node)
    storage = node.CreateDefaultStorageNode()
    scene.AddNode(storage)
    storage.SetFileName("given.nrrd")
    storage.ReadData(node)
    Path("saved.nrrd").unlink(missing_ok=True)
    storage.SetFileName("saved.nrrd")
    storage.WriteData(node)
    found = [by_simpleitk("given.nrrd"), by_slicer(node), by_simpleitk("saved.nrrd")]
    assert all(np.allclose(place, found[0][1]) for _, place in found)
    index = [index for index, _ in found]
    print(f"{what} SimpleITK {index[0]}, Slicer {index[1]}, as saved {index[2]}; all at {found[0][1]}")
PYTHON
