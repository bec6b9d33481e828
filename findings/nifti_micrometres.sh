#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: ITK turns the spacing of a NIfTI file in micrometres into mm, and forgets the offset; VTK does likewise.
# Found: ITK turns both, rightly. VTK and nibabel hand on the file's own numbers, so that two readers of one file lie a factor of 1000
# apart without a word. nibabel's users can ask header.get_xyzt_units(); of VTK's NIfTI header it is GetXYZTUnits().
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages SimpleITK==2.5.7 nibabel==5.4.2 vtk==9.7.2 numpy==2.4.6
seen 'SimpleITK 0.5 0.5 0.5, first voxel at 30.0
nibabel   500.0 500.0 500.0, first voxel at 30000.0
VTK       500.0 500.0 500.0, first voxel at 30000.0, units 3' << 'PYTHON'
import nibabel, numpy as np, SimpleITK, vtk
affine = np.diag([500.0, 500.0, 500.0, 1.0])
affine[:3, 3] = 10000, 20000, 30000
image = nibabel.Nifti1Image(np.zeros((4, 5, 6), np.uint8), affine)
image.header.set_xyzt_units("micron")
image.set_qform(affine, 1)
image.set_sform(affine, 1)
nibabel.save(image, "fine.nii")
itk = SimpleITK.ReadImage("fine.nii")
print("SimpleITK", *itk.GetSpacing(), end="")
print(", first voxel at", itk.GetOrigin()[2])
read = nibabel.load("fine.nii")
print("nibabel  ", *map(float, read.header.get_zooms()), end="")
print(", first voxel at", float(read.affine[2, 3]))
reader = vtk.vtkNIFTIImageReader()
reader.SetFileName("fine.nii")
reader.Update()
print("VTK      ", *reader.GetOutput().GetSpacing(), end="")
print(", first voxel at", f"{reader.GetQFormMatrix().GetElement(2, 3)}, units {reader.GetNIFTIHeader().GetXYZTUnits()}")
PYTHON
