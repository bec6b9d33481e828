#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: where a NRRD says its axes' limits (axis mins, axis maxs), SimpleITK and VTK have the first voxel half a voxel from the lower one.
# Found: SimpleITK has. But where no spacings stand beside the limits, as the definition allows, it says voxels of 1 mm, though it needed
# the 0.5 mm for that half voxel. VTK drops the place even where spacings are given. Neither says a word.
# A volume of 5 mm becomes one of 10. Whoever reads such files computes (max - min) / samples, or / (samples - 1) where samples are nodes.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages SimpleITK==2.5.7 vtk==9.7.2 numpy==2.4.6
seen 'by definition           0.5 0.6 0.7 mm, first voxel at 10.25 20.3 30.35
limits: SimpleITK       1.0 1.0 1.0 mm, first voxel at 10.25 20.3 30.35
limits: VTK             1.0 1.0 1.0 mm, first voxel at 0.0 0.0 0.0
and spacings: SimpleITK 0.5 0.6 0.7 mm, first voxel at 10.25 20.3 30.35
and spacings: VTK       0.5 0.6 0.7 mm, first voxel at 0.0 0.0 0.0' << 'PYTHON'
import SimpleITK, vtk
def say(name, spacing, origin):
    print(f"{name:23}", *(round(value, 3) for value in spacing), "mm, first voxel at", *(round(value, 3) for value in origin))
LIMITS = "axis mins: 10 20 30\naxis maxs: 15 26.6 38.4\ncenters: cell cell cell\n"
say("by definition", (5 / 10, 6.6 / 11, 8.4 / 12), (10 + 0.5 / 2, 20 + 0.6 / 2, 30 + 0.7 / 2))
for name, more in (("limits", ""), ("and spacings", "spacings: 0.5 0.6 0.7\n")):
    with open("scan.nrrd", "wb") as file:
        file.write(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 10 11 12\n{LIMITS}{more}encoding: raw\n\n".encode() + bytes(1320))
    image = SimpleITK.ReadImage("scan.nrrd")
    say(f"{name}: SimpleITK", image.GetSpacing(), image.GetOrigin())
    reader = vtk.vtkNrrdReader()
    reader.SetFileName("scan.nrrd")
    reader.Update()
    say(f"{name}: VTK", reader.GetOutput().GetSpacing(), reader.GetOutput().GetOrigin())
PYTHON
