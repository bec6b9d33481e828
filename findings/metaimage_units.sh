#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: SimpleITK and VTK keep a MetaImage's numbers whatever its DistanceUnits, and nothing of the unit is left.
# Found: the numbers stay: 0.5 mm, in cm, are 0.05. But ITK notes the unit in the image's metadata (ITK_VoxelUnits), writes a MetaImage
# of it that says cm again, and a NIfTI that says mm: with the same numbers, a tenth of the size. Nothing tells.
# Whoever reads MetaImages by SimpleITK asks for that key, and scales spacing and origin.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages SimpleITK==2.5.7 vtk==9.7.2 nibabel==5.4.2 numpy==2.4.6
seen 'in mm              0.5 0.6 0.7
SimpleITK          0.05 0.06 0.07, ITK_VoxelUnits cm
VTK                0.05 0.06 0.07
written, MetaImage 0.05 0.06 0.07, DistanceUnits = cm
written, NIfTI     0.05 0.06 0.07, mm' << 'PYTHON'
from pathlib import Path
import nibabel, SimpleITK, vtk
def say(name, spacing, more=""):
    print(f"{name:18}", " ".join(f"{value:.4g}" for value in spacing) + more)
HEAD = "ObjectType = Image\nNDims = 3\nDistanceUnits = cm\nElementSpacing = 0.05 0.06 0.07\nDimSize = 10 11 12\nElementType = MET_UCHAR\n"
Path("scan.mha").write_bytes(f"{HEAD}ElementDataFile = LOCAL\n".encode() + bytes(1320))
say("in mm", (0.5, 0.6, 0.7))
image = SimpleITK.ReadImage("scan.mha")
say("SimpleITK", image.GetSpacing(), f", ITK_VoxelUnits {image.GetMetaData('ITK_VoxelUnits')}")
reader = vtk.vtkMetaImageReader()
reader.SetFileName("scan.mha")
reader.Update()
say("VTK", reader.GetOutput().GetSpacing())
for name in ("written.mha", "written.nii"):
    SimpleITK.WriteImage(image, name)
units = next(line for line in Path("written.mha").read_bytes().split(b"\n") if line.startswith(b"DistanceUnits")).decode()
say("written, MetaImage", SimpleITK.ReadImage("written.mha").GetSpacing(), f", {units}")
header = nibabel.load("written.nii").header
say("written, NIfTI", header.get_zooms(), f", {header.get_xyzt_units()[0]}")
PYTHON
