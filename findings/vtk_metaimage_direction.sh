#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: VTK places a MetaImage whose axes are turned where ITK, which wrote it, has it.
# Found: vtkMetaImageReader takes the lines of TransformMatrix, each an axis' direction, for the matrix' rows. The image is turned the
# other way: voxel (2, 0, 0), 3 mm along the first axis of a quarter turn, lies 6 mm from its place.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages SimpleITK==2.5.7 vtk==9.7.2 numpy==2.4.6
seen 'ITK  (1.0, 5.0, 3.0)
VTK  (1.0, -1.0, 3.0)' << 'PYTHON'
import numpy as np, SimpleITK, vtk
image = SimpleITK.GetImageFromArray(np.zeros((7, 8, 9), np.uint8))
image.SetOrigin((1, 2, 3))
image.SetSpacing((1.5, 1, 1))
image.SetDirection((0, -1, 0, 1, 0, 0, 0, 0, 1))
SimpleITK.WriteImage(image, "turned.mha")
reader = vtk.vtkMetaImageReader()
reader.SetFileName("turned.mha")
reader.Update()
place = [0.0] * 3
reader.GetOutput().TransformIndexToPhysicalPoint((2, 0, 0), place)
print("ITK ", SimpleITK.ReadImage("turned.mha").TransformIndexToPhysicalPoint((2, 0, 0)))
print("VTK ", tuple(place))
PYTHON
