#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: dcm2niix takes the two volumes of an Enhanced US Volume apart, by the time that each frame's dimension index says first.
# Found: it sorts the frames by their place alone. One volume of twice the slices comes, in which the two times alternate, slice by
# slice, and each slice is as thick as before: twice the depth. Its warnings speak of the patient's axes, none of time.
# Pixels' size and the distance of the slices are right, where other readers have none. Take files of one volume each.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pydicom==3.0.2 dcm2niix==1.0.20260724 nibabel==5.4.2 numpy==2.4.6
seen 'one volume:  (12, 10, 6) of 0.5 x 0.4 x 0.8 mm, slices 10 11 12 13 14 15
two volumes: (12, 10, 12) of 0.5 x 0.4 x 0.8 mm, slices 10 110 11 111 12 112 13 113 14 114 15 115' << 'PYTHON'
import subprocess
from pathlib import Path

import nibabel
import numpy as np
from enhanced_volume import enhanced_volume

for times, name in ((1, "one volume:"), (2, "two volumes:")):
    folder = Path(f"of_{times}")
    folder.mkdir()
    enhanced_volume(6, times, lambda time, plane: 10 + plane + 100 * time).save_as(folder / "volume.dcm", enforce_file_format=True)
    subprocess.run(["venv/bin/dcm2niix", "-f", "out", str(folder)], check=True, capture_output=True)
    image = nibabel.load(folder / "out.nii")
    sizes = " x ".join(f"{length:.1f}" for length in image.header.get_zooms()[:3])
    print(f"{name:12} {image.shape} of {sizes} mm, slices", *np.asarray(image.dataobj)[0, 0].ravel())
PYTHON
