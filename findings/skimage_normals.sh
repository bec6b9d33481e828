#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: the normals that scikit-image's marching_cubes gives with a spacing stand upright on the surface that it gives.
# Found: the vertices are in mm, the normals count in voxels: on a plane at 45 degrees in voxels of 0.5 x 0.5 x 1.5 mm they lie 27 degrees
# beside the triangles' own. The documentation says "as calculated from the data", and no more.
# Light, thickness along a normal, or a probe's approach are wrong with them. Divided by the spacing and made unit again, they are right.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages scikit-image==0.26.0 numpy==2.4.6
seen 'voxels of 0.5 0.5 0.5 mm: vertices off the plane by at most 0.000 mm, triangles 45.0, normals 45.0, divided 45.0 degrees
voxels of 0.5 0.5 1.5 mm: vertices off the plane by at most 0.000 mm, triangles 45.0, normals 71.6, divided 45.0 degrees' << 'PYTHON'
import numpy as np
from skimage.measure import marching_cubes
def tilt(vectors):
    angles = np.degrees(np.arctan2(abs(vectors[:, 2]), abs(vectors[:, 0])))
    assert np.ptp(angles) < 0.1, angles
    return f"{angles.mean():.1f}"
for spacing in ((0.5, 0.5, 0.5), (0.5, 0.5, 1.5)):
    x, _, z = np.meshgrid(*(np.arange(12) * step for step in spacing), indexing="ij")
    level = 0.5 * (x + z).max() + 0.1
    vertices, faces, normals, _ = marching_cubes(x + z, level, spacing=spacing)
    away = abs(vertices[:, 0] + vertices[:, 2] - level).max() / 2**0.5
    corner = vertices[faces].astype(float)
    own = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    own = own[np.linalg.norm(own, axis=1) > 1e-3]
    print(f"voxels of {' '.join(map(str, spacing))} mm: vertices off the plane by at most {away:.3f} mm,",
          f"triangles {tilt(own)}, normals {tilt(normals)}, divided {tilt(normals / spacing)} degrees")
PYTHON
