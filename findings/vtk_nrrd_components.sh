#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: VTK reads a small NRRD volume, of three axes that are all called "domain", as a volume.
# Found: up to nine samples on the first axis are taken for the components of a voxel, whatever "kinds" says: a volume of 9 x 8 x 7
# becomes a picture of 8 x 7. From ten on it is a volume. A crop of a scan for a test, or a slab of few columns, meets that.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages SimpleITK==2.5.7 vtk==9.7.2 numpy==2.4.6
seen 'kinds: domain domain domain
9 x 8 x 7 is read as (8, 7, 1), 9 components
10 x 8 x 7 is read as (10, 8, 7), 1 components' << 'PYTHON'
import numpy as np, SimpleITK, vtk
for columns in (9, 10):
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(np.zeros((7, 8, columns), np.uint8)), "small.nrrd")
    if columns == 9:
        with open("small.nrrd", "rb") as file:
            print(next(line for line in file.read().split(b"\n") if line.startswith(b"kinds")).decode())
    reader = vtk.vtkNrrdReader()
    reader.SetFileName("small.nrrd")
    reader.Update()
    out = reader.GetOutput()
    print(columns, "x 8 x 7 is read as", f"{out.GetDimensions()},", out.GetNumberOfScalarComponents(), "components")
PYTHON
