#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: pyopencl's RadixSort, whose key is "an integer", sorts negative integers before positive ones.
# Found: it takes the key's bits for a number without a sign: what is negative comes last, in 8, 16 and 32 bits, and nothing tells.
# A median or a rank of a signed volume (a distance, a Doppler's velocity) is another voxel then. The sign bit turned in the key is right.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pyopencl==2026.1.4 pocl-binary-distribution==3.0 mako==1.3.10 numpy==2.4.6
export POCL_CACHE_DIR=$work/kernels
seen 'by numpy       -7 -3 1 2 5
int8           1 2 5 -7 -3
int16          1 2 5 -7 -3
int32          1 2 5 -7 -3
int32, turned  -7 -3 1 2 5' << 'PYTHON'
import numpy as np, pyopencl as cl, pyopencl.array as array
from pyopencl.algorithm import RadixSort
platform = next(p for p in cl.get_platforms() if p.version.startswith("OpenCL 3.0 PoCL 3.0"))
context = cl.Context([platform.get_devices()[0]])
queue = cl.CommandQueue(context)
def say(name, values):
    print(f"{name:14}", *values)
VALUES = (5, -3, 1, -7, 2)
say("by numpy", np.sort(VALUES))
for name, kind, c, key in (("int8", np.int8, "char", "v[i]"), ("int16", np.int16, "short", "v[i]"), ("int32", np.int32, "int", "v[i]"),
                           ("int32, turned", np.int32, "int", "v[i] ^ 0x80000000")):
    sort = RadixSort(context, f"{c} *v", key_expr=key, sort_arg_names=["v"])
    (out,), done = sort(array.to_device(queue, np.array(VALUES, kind)))
    done.wait()
    say(name, out.get())
PYTHON
