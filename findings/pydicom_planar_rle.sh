#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: pydicom compresses an ultrasound picture in colour whose planes stand one behind the other (Planar Configuration 1) to the
# same pixels, or refuses it.
# Found: compress() takes the bytes for interleaved ones, so that a pixel holds three neighbours of one plane, and says nothing; GDCM
# reads the same wrong pixels, so the file is at fault and not a reader. With arr=dataset.pixel_array the pixels stay.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pydicom==3.0.2 SimpleITK==2.5.7 numpy==2.4.6
seen 'before               [[0, 255, 0], [1, 254, 0]]
compress(), pydicom  [[0, 1, 2], [3, 4, 5]]
compress(), GDCM     [[0, 1, 2], [3, 4, 5]]
compress(arr=...)    [[0, 255, 0], [1, 254, 0]]' << 'PYTHON'
import numpy as np, pydicom, SimpleITK
from pydicom.uid import RLELossless
from ultrasound_picture import ultrasound_picture
grey = np.arange(240, dtype=np.uint8).reshape(12, 20)
pixels = np.stack([grey, 255 - grey, grey // 2], -1)
d = ultrasound_picture(12, 20, pixels.transpose(2, 0, 1).tobytes(), samples=3, kind="RGB")
d.PlanarConfiguration = 1
d.save_as("planes.dcm", enforce_file_format=True)
first = lambda array: np.asarray(array).reshape(12, 20, 3)[0, :2].tolist()
print("before              ", first(pydicom.dcmread("planes.dcm").pixel_array))
d = pydicom.dcmread("planes.dcm")
d.compress(RLELossless, encoding_plugin="pydicom")
d.save_as("packed.dcm")
print("compress(), pydicom ", first(pydicom.dcmread("packed.dcm").pixel_array))
print("compress(), GDCM    ", first(SimpleITK.GetArrayFromImage(SimpleITK.ReadImage("packed.dcm"))))
d = pydicom.dcmread("planes.dcm")
d.compress(RLELossless, arr=d.pixel_array, encoding_plugin="pydicom")
print("compress(arr=...)   ", first(d.pixel_array))
PYTHON
