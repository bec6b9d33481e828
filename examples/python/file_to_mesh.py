# SPDX-License-Identifier: MIT
"""A file to a mesh: file_to_mesh.py VOLUME MESH.stl. Any file that SimpleITK reads; the mesh is in its world, in mm."""

import sys

import numpy as np
import SimpleITK as sitk
from skimage.filters import threshold_otsu
from skimage.measure import marching_cubes

import smartvis

image = sitk.ReadImage(sys.argv[1])
result = smartvis.clip(image, scanned="auto")
clipped = np.pad(sitk.GetArrayFromImage(result.apply(image)), 1)
corners, faces, _, _ = marching_cubes(clipped, threshold_otsu(clipped))
direction = np.array(image.GetDirection()).reshape(3, 3)
world = ((corners[:, ::-1] - 1) * image.GetSpacing()) @ direction.T + image.GetOrigin()

triangles = np.zeros(len(faces), [("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("unused", "<u2")])
triangles["corner"] = world[faces]
with open(sys.argv[2], "wb") as file:
    file.write(b"SmartVis".ljust(80) + np.uint32(len(faces)).tobytes() + triangles.tobytes())
print(f"{result.outcome.name}: {len(faces)} triangles in {sys.argv[2]}")
