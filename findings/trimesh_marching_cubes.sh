#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: of a trimesh VoxelGrid, which knows its voxels' size and place, marching_cubes is a mesh in mm, there where its points and boxes
# are, only rounder.
# Found: the mesh counts in voxels from the grid's corner: neither size nor place is applied, and nothing says so. A block of 1 mm^3
# becomes one of 5.7, some 20 mm off. What is to be measured or printed needs mesh.apply_transform(grid.transform).
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages trimesh==5.2.0 scikit-image==0.26.0 numpy==2.4.6
seen 'points          11.0 21.5 32.0 to 11.5 22.0 32.5
boxes           10.8 21.2 31.8 to 11.8 22.2 32.8
marching cubes  1.5 2.5 3.5 to 3.5 4.5 5.5, volume 5.7
with transform  10.8 21.2 31.8 to 11.8 22.2 32.8, volume 0.7' << 'PYTHON'
import numpy as np, trimesh
def say(name, bounds, more=""):
    print(f"{name:15}", *np.round(bounds[0], 1), "to", " ".join(map(str, np.round(bounds[1], 1))) + more)
mask = np.zeros((6, 7, 8), bool)
mask[2:4, 3:5, 4:6] = True
place = np.diag([0.5, 0.5, 0.5, 1.0])
place[:3, 3] = 10, 20, 30
grid = trimesh.voxel.VoxelGrid(mask, transform=place)
say("points", (grid.points.min(0), grid.points.max(0)))
say("boxes", grid.as_boxes().bounds)
mesh = grid.marching_cubes
say("marching cubes", mesh.bounds, f", volume {mesh.volume:.1f}")
mesh = mesh.copy().apply_transform(grid.transform)
say("with transform", mesh.bounds, f", volume {mesh.volume:.1f}")
PYTHON
