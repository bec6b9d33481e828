#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: SimpleITK applies a Modality LUT Sequence as it applies Rescale Slope and Intercept, or refuses the file.
# Found: the slope is applied, the table is left out without a word: stored values come as if they were the modality's. pydicom applies
# neither unless asked, and then both (apply_modality_lut).
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pydicom==3.0.2 SimpleITK==2.5.7 numpy==2.4.6
seen 'slope 0.5: SimpleITK [0.0, 0.5, 1.0], apply_modality_lut [0.0, 0.5, 1.0]
table x10: SimpleITK [0.0, 1.0, 2.0], apply_modality_lut [0.0, 10.0, 20.0]' << 'PYTHON'
import numpy as np, pydicom, SimpleITK
from pydicom.dataset import Dataset
from pydicom.pixels import apply_modality_lut
from ultrasound_picture import ultrasound_picture
for name in ("slope 0.5", "table x10"):
    d = ultrasound_picture(12, 20, bytes(range(240)))
    if name == "slope 0.5":
        d.RescaleSlope, d.RescaleIntercept = "0.5", "0"
    else:
        table = Dataset()
        table.LUTDescriptor, table.ModalityLUTType, table.LUTData = [256, 0, 16], "US", (np.arange(256, dtype="<u2") * 10).tobytes()
        d.ModalityLUTSequence = [table]
    d.save_as("table.dcm", enforce_file_format=True)
    itk = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage("table.dcm")).reshape(12, 20)[0, :3]
    read = pydicom.dcmread("table.dcm")
    asked = apply_modality_lut(read.pixel_array, read)[0, :3]
    print(f"{name}: SimpleITK {itk.astype(float).tolist()}, apply_modality_lut {asked.astype(float).tolist()}")
PYTHON
