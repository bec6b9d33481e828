#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: whatever makes a surface of a volume whose axes are turned (vtkImageData's direction matrix) puts it where the voxels are, since
# VTK's data model says where that is.
# Found: vtkContourFilter, the usual one, leaves the turn out on volumes, without a word: it hands them to vtkSynchronizedTemplates3D,
# and so do contour() of PyVista and isosurface() of vedo. A voxel at (6, 29, 33) gets its surface at (19, 24, 33), and normals that are
# not turned, either. vtkFlyingEdges3D and vtkMarchingCubes have it right, as have threshold, probe and reslice.
# In one scene the volume and the skin made of it lie apart. In PyVista take method="flying_edges".
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages vtk==9.7.2 pyvista==0.49.1 vedo==2026.6.3 numpy==2.4.6
seen 'the voxel                   (6.0, 29.0, 33.0)
vtkContourFilter            (19.0, 24.0, 33.0)
vtkSynchronizedTemplates3D  (19.0, 24.0, 33.0)
vtkFlyingEdges3D            (6.0, 29.0, 33.0)
vtkMarchingCubes            (6.0, 29.0, 33.0)
PyVista contour             (19.0, 24.0, 33.0)
PyVista flying_edges        (6.0, 29.0, 33.0)
vedo isosurface             (19.0, 24.0, 33.0)' << 'PYTHON'
import numpy as np, pyvista, vedo
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkFlyingEdges3D, vtkMarchingCubes, vtkSynchronizedTemplates3D
def say(name, place):
    print(f"{name:27} {tuple(round(float(value), 3) for value in place)}")
volume = pyvista.ImageData(dimensions=(9, 8, 7), spacing=(1.5, 1, 1), origin=(10, 20, 30))
volume.direction_matrix = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], float)
voxels = np.zeros((7, 8, 9), np.uint8)
voxels[3, 4, 6] = 100
volume.point_data["grey"] = voxels.ravel()
say("the voxel", volume.GetPoint(int(voxels.argmax())))
for kind in (vtkContourFilter, vtkSynchronizedTemplates3D, vtkFlyingEdges3D, vtkMarchingCubes):
    surface = kind()
    surface.SetInputData(volume)
    surface.SetValue(0, 50)
    surface.Update()
    say(kind.__name__, pyvista.wrap(surface.GetOutput()).center)
for method in ("contour", "flying_edges"):
    say(f"PyVista {method}", volume.contour([50], method=method).center)
say("vedo isosurface", vedo.Volume(volume).isosurface(50).center_of_mass())
PYTHON
