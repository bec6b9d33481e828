#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: an ultrasound image without Pixel Spacing gets it from its first region, cm made mm, and SimpleITK, which reads DICOM by
# GDCM, hands that on.
# Found: GDCM takes the first region's Physical Delta X and Y as they are: 0.2 and 0.5 mm become 0.02 and 0.05. It looks at no unit,
# so a spectral Doppler's seconds and cm/s, if its region comes first, are lengths, too. SimpleITK and VTK say 1.0 for all.
# Who measures must read the regions: the units (0018,6024), (0018,6026), and which region a pixel lies in.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pydicom==3.0.2 python-gdcm==3.2.6 SimpleITK==2.5.7 vtk==9.7.2 numpy==2.4.6
seen 'tissue                0.2 x 0.5 mm by the standard: GDCM 0.02 x 0.05, SimpleITK 1.0 x 1.0, VTK 1.0 x 1.0
Doppler, then tissue  0.2 x 0.5 mm by the standard: GDCM 0.004 x 3.5, SimpleITK 1.0 x 1.0, VTK 1.0 x 1.0' << 'PYTHON'
import gdcm, SimpleITK, vtk
from pydicom.dataset import Dataset
from ultrasound_picture import ultrasound_picture

def region(kind, top, bottom, delta, units):
    r = Dataset()
    r.RegionSpatialFormat = r.RegionDataType = kind
    r.RegionFlags = 0
    r.RegionLocationMinX0, r.RegionLocationMaxX1 = 0, 59
    r.RegionLocationMinY0, r.RegionLocationMaxY1 = top, bottom
    r.PhysicalDeltaX, r.PhysicalDeltaY = delta
    r.PhysicalUnitsXDirection, r.PhysicalUnitsYDirection = units
    return r

CM, SECONDS, CM_A_SECOND = 3, 4, 7
tissue = region(1, 0, 19, (0.02, 0.05), (CM, CM))
doppler = region(3, 20, 39, (0.004, 3.5), (SECONDS, CM_A_SECOND))
for name, regions in (("tissue", [tissue]), ("Doppler, then tissue", [doppler, tissue])):
    d = ultrasound_picture(40, 60, bytes(40 * 60))
    d.SequenceOfUltrasoundRegions = regions
    d.save_as("regions.dcm", enforce_file_format=True)
    reader = gdcm.ImageReader()
    reader.SetFileName("regions.dcm")
    reader.Read()
    by_vtk = vtk.vtkDICOMImageReader()
    by_vtk.SetFileName("regions.dcm")
    by_vtk.Update()
    three = [reader.GetImage().GetSpacing(0), reader.GetImage().GetSpacing(1)], SimpleITK.ReadImage("regions.dcm").GetSpacing(), by_vtk.GetPixelSpacing()
    said = ", ".join(f"{who} {at[0]} x {at[1]}" for who, at in zip(("GDCM", "SimpleITK", "VTK"), three))
    print(f"{name:21} 0.2 x 0.5 mm by the standard: {said}")
PYTHON
