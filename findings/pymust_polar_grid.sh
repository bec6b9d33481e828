#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: pymust.impolgrid, the fan on which an image is formed before scan conversion, takes the size as its documentation's example
# does, [100 50], and gives x, z and the origin's depth z0.
# Found: a list or a tuple is a TypeError, though the annotation names list; a NumPy array works. There are two results, not three, so
# the apex of the fan, which scan conversion needs, has to be computed from the probe's pitch and radius.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pymust==0.1.9 numpy==2.4.6
seen "list   TypeError: '>' not supported between instances of 'list' and 'int'
tuple  TypeError: '>' not supported between instances of 'tuple' and 'int'
array  2 results of (100, 50)
z0 is documented: True" << 'PYTHON'
import math
import numpy as np, pymust
probe = pymust.getparam("P4-2v")
for name, size in (("list", [100, 50]), ("tuple", (100, 50)), ("array", np.array([100, 50]))):
    try:
        out = pymust.impolgrid(size, 10e-2, math.pi / 3, probe)
        print(f"{name:6} {len(out)} results of {out[0].shape}")
    except TypeError as error:
        print(f"{name:6} TypeError: {error}")
print("z0 is documented:", "[X,Z,Z0] = IMPOLGRID" in pymust.impolgrid.__doc__)
PYTHON
