#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: pyopencl.array.sum of a volume of 8 bits is what NumPy's sum is, of a wider type; the module mirrors NumPy and its page names no
# other type.
# Found: the sum is of 8 bits itself, and wraps: 512 voxels of 200 have the sum 0, without a warning; so a mean made of it is nonsense.
# NumPy widens sums, and pyopencl does with dtype=numpy.uint32 given.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pyopencl==2026.1.4 pocl-binary-distribution==3.0 mako==1.3.10 numpy==2.4.6
export POCL_CACHE_DIR=$work/kernels
seen 'NumPy                    102400 uint64
pyopencl                 0 uint8
pyopencl, dtype=uint32   102400 uint32' << 'PYTHON'
import numpy as np, pyopencl as cl, pyopencl.array as arrays
context = cl.Context([next(p for p in cl.get_platforms() if p.version.startswith("OpenCL 3.0 PoCL 3.0")).get_devices()[0]])
voxels = np.full((8, 8, 8), 200, np.uint8)
there = arrays.to_device(cl.CommandQueue(context), voxels)
for name, sum_ in (("NumPy", voxels.sum()), ("pyopencl", arrays.sum(there).get()),
                   ("pyopencl, dtype=uint32", arrays.sum(there, dtype=np.uint32).get())):
    print(f"{name:24} {sum_} {sum_.dtype}")
PYTHON
