#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: of an Enhanced US Volume, the standard's own form of a 3D ultrasound scan, GDCM and so SimpleITK read the pixels' size and the
# distance of the slices, as they do of enhanced CT and MR; only the place is lost.
# Found: nothing is read. Voxels of 0.5 x 0.4 x 0.8 mm are 1 x 1 x 1 mm, without a word; two volumes of one file are one of twice the
# slices. VTK says as much, of the first slice alone. highdicom, at least, refuses: it looks for a patient's frame of reference, and
# such a scan has one of the volume. Who measures takes pydicom: Shared Functional Groups, Pixel Measures; Plane Position (Volume).
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pydicom==3.0.2 python-gdcm==3.2.6 SimpleITK==2.5.7 vtk==9.7.2 highdicom==0.28.2 numpy==2.4.6
seen 'one volume: 0.5 x 0.4 x 0.8 mm, 6 slices by the standard
  GDCM       1.0 x 1.0 x 1.0 mm, 6 slices
  SimpleITK  1.0 x 1.0 x 1.0 mm, 6 slices
  VTK        1.0 x 1.0 x 1.0 mm, 1 slices
  highdicom  Image does not exist within a frame-of-reference coordinate system.
two volumes: 0.5 x 0.4 x 0.8 mm, 6 slices by the standard
  GDCM       1.0 x 1.0 x 1.0 mm, 12 slices
  SimpleITK  1.0 x 1.0 x 1.0 mm, 12 slices
  VTK        1.0 x 1.0 x 1.0 mm, 1 slices
  highdicom  Image does not exist within a frame-of-reference coordinate system.' << 'PYTHON'
import gdcm, highdicom, SimpleITK, vtk
from enhanced_volume import enhanced_volume

def said(who, spacing, slices):
    print(f"  {who:10} {' x '.join(str(float(length)) for length in spacing)} mm, {slices} slices")

for times, name in ((1, "one volume"), (2, "two volumes")):
    enhanced_volume(6, times, lambda time, plane: 10 + plane).save_as("volume.dcm", enforce_file_format=True)
    print(f"{name}: 0.5 x 0.4 x 0.8 mm, 6 slices by the standard")
    reader = gdcm.ImageReader()
    reader.SetFileName("volume.dcm")
    reader.Read()
    image = reader.GetImage()
    said("GDCM", [image.GetSpacing(axis) for axis in range(3)], image.GetDimension(2))
    image = SimpleITK.ReadImage("volume.dcm")
    said("SimpleITK", image.GetSpacing(), image.GetDepth())
    by_vtk = vtk.vtkDICOMImageReader()
    by_vtk.SetFileName("volume.dcm")
    by_vtk.Update()
    said("VTK", by_vtk.GetPixelSpacing(), by_vtk.GetOutput().GetDimensions()[2])
    try:
        volume = highdicom.imread("volume.dcm").get_volume()
        said("highdicom", volume.spacing[::-1], volume.spatial_shape[0])
    except RuntimeError as error:
        print("  highdicom ", error)
PYTHON
