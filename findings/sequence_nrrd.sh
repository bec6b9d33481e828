#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: .seq.nrrd files whose list of frames is the first axis (as some recorders write) and those in which it is the last (as slicerio
# writes) are the same to whoever reads "kinds"; a reader that has no sequences gives four dimensions.
# Found: slicerio finds the frames in the last axis alone: of a list in front it counts one frame, and takes the list for the first axis
# of space. SimpleITK gives three dimensions and a vector a voxel for both: what looks like colour is time.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages slicerio==1.4.0 pynrrd==1.1.3 SimpleITK==2.5.7 numpy==2.4.6
seen 'list last:  slicerio 3 frames of (4, 5, 6), SimpleITK (4, 5, 6) with 3 components
list first: slicerio 1 frames of (3, 4, 5, 6), SimpleITK (4, 5, 6) with 3 components' << 'PYTHON'
import nrrd, numpy as np, SimpleITK, slicerio
frames = np.arange(3 * 4 * 5 * 6, dtype=np.uint16).reshape(3, 4, 5, 6)
space = [[0.5, 0, 0], [0, 0.6, 0], [0, 0, 0.7]]
for where, axis in (("last: ", 3), ("first:", 0)):
    kinds, directions = ["domain"] * 3, [list(row) for row in space]
    kinds.insert(axis, "list")
    directions.insert(axis, [np.nan] * 3)
    header = {"space": "left-posterior-superior", "kinds": kinds, "space directions": np.array(directions), "space origin": [1, 2, 3]}
    nrrd.write("frames.seq.nrrd", np.moveaxis(frames, 0, axis), header)
    volume = slicerio.read_volume("frames.seq.nrrd")
    count = slicerio.number_of_frames(volume)
    shape = volume["voxels"].shape if count == 1 else volume["voxels"].shape[:3]
    image = SimpleITK.ReadImage("frames.seq.nrrd")
    print(f"list {where} slicerio {count} frames of {shape}, SimpleITK {image.GetSize()} with {image.GetNumberOfComponentsPerPixel()} components")
PYTHON
