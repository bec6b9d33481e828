#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: shuffle(v, (uint4)(1, 2, 3, 4)) turns the lanes by one on every OpenCL runtime: of a mask's number only the lowest bits count,
# says OpenCL C (Miscellaneous Vector Functions), so 4 means lane 0.
# Found: Intel's runtime for CPUs takes it for a lane that is not there, where the mask is a constant, its numbers reach from n to 2n - 1
# and kernels are optimised, as they are by default: the last lane is 0, or what happens to be there. With a mask from memory, with
# -cl-opt-disable, and by PoCL it is right; so is shuffle2.
# Nobody is warned. Write the mask modulo n.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pyopencl==2026.1.4 intel-opencl-rt==2026.2.0 intel-cmplr-lib-rt==2026.2.0 numpy==2.4.6
mkdir vendors
echo "$work/venv/lib/libintelocl.so" > vendors/intel.icd
export OCL_ICD_VENDORS=$work/vendors LD_LIBRARY_PATH=$work/venv/lib
seen 'Intel(R) OpenCL
constant mask to n       uchar4 11 12 13 other, uchar16 11 .. 25 other
the same, not optimised  uchar4 11 12 13 10, uchar16 11 .. 25 10
the same from memory     uchar4 11 12 13 10, uchar16 11 .. 25 10
constant mask modulo n   uchar4 11 12 13 10, uchar16 11 .. 25 10' << 'PYTHON'
import numpy as np, pyopencl as cl
platform = cl.get_platforms()[0]
context = cl.Context(platform.get_devices()[:1])
queue = cl.CommandQueue(context)
def turned(lanes, mask, options=()):
    numbers = [lane % lanes if mask == "modulo" else lane for lane in range(1, lanes + 1)]
    words = ", ".join(map(str, numbers))
    taken = f"vload{lanes}(1, in)" if mask == "memory" else f"(uchar{lanes})({words})"
    code = f"kernel void turn(global uchar *out, global const uchar *in) {{ vstore{lanes}(shuffle(vload{lanes}(0, in), {taken}), 0, out); }}"
    given = np.array([*range(10, 10 + lanes), *numbers], np.uint8)
    source = cl.Buffer(context, cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR, hostbuf=given)
    target = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, lanes)
    cl.Program(context, code).build(list(options)).turn(queue, (1,), None, target, source)
    out = np.zeros(lanes, np.uint8)
    cl.enqueue_copy(queue, out, target)
    words = [str(lane) for lane in out[:-1]] + ["10" if out[-1] == 10 else "other"]
    return " ".join(words if lanes == 4 else [words[0], "..", *words[-2:]])
print(platform.name)
for name, how in (("constant mask to n", ("constant",)), ("the same, not optimised", ("constant", ["-cl-opt-disable"])),
                  ("the same from memory", ("memory",)), ("constant mask modulo n", ("modulo",))):
    print(f"{name:24}", f"uchar4 {turned(4, *how)}, uchar16 {turned(16, *how)}")
PYTHON
