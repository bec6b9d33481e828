#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: an image of one channel of halves (CL_R, CL_HALF_FLOAT), which PoCL lists among the formats that it supports, gives back what
# was stored in it: half of the memory for a depth or a confidence map.
# Found: read_imagef gives 234 for every pixel, whatever is stored, and write_imagef stores other numbers; no call fails. Four channels
# of halves are right, as is one of float32. Debian 12's PoCL 3.1 does the same as PyPI's 3.0.
# That a format is listed says little: let the device prove a format on known values before a frame depends on it.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pyopencl==2026.1.4 pocl-binary-distribution==3.0 numpy==2.4.6
export POCL_CACHE_DIR=$work/kernels
seen 'R    FLOAT      listed: True, read: 0 0.25 0.5 2 100, written: right
R    HALF_FLOAT listed: True, read: 234 234 234 234 234, written: wrong
RGBA HALF_FLOAT listed: True, read: 0 0.25 0.5 2 100, written: right' << 'PYTHON'
import numpy as np, pyopencl as cl
from pyopencl import channel_order, channel_type, mem_flags
CODE = """
constant sampler_t plain = CLK_NORMALIZED_COORDS_FALSE | CLK_ADDRESS_NONE | CLK_FILTER_NEAREST;
kernel void get(read_only image2d_t image, global float *out) {
    out[get_global_id(0)] = read_imagef(image, plain, (int2)(get_global_id(0), 0)).x;
}
kernel void put(write_only image2d_t image, global const float *in) {
    write_imagef(image, (int2)(get_global_id(0), 0), (float4)(in[get_global_id(0)]));
}"""
VALUES = np.array([0, 0.25, 0.5, 2, 100], np.float32)
context = cl.Context([next(p for p in cl.get_platforms() if p.version.startswith("OpenCL 3.0 PoCL 3.0")).get_devices()[0]])
queue, kernels = cl.CommandQueue(context), cl.Program(context, CODE).build()
listed = cl.get_supported_image_formats(context, mem_flags.READ_WRITE, cl.mem_object_type.IMAGE2D)
for order, kind, type_ in (("R", "FLOAT", np.float32), ("R", "HALF_FLOAT", np.float16), ("RGBA", "HALF_FLOAT", np.float16)):
    form = cl.ImageFormat(getattr(channel_order, order), getattr(channel_type, kind))
    pixels = np.repeat(VALUES.astype(type_), len(order))
    image = cl.Image(context, mem_flags.READ_ONLY | mem_flags.COPY_HOST_PTR, form, shape=(5, 1), hostbuf=pixels)
    buffer = cl.Buffer(context, mem_flags.READ_WRITE, VALUES.nbytes)
    kernels.get(queue, (5,), None, image, buffer)
    read = np.zeros_like(VALUES)
    cl.enqueue_copy(queue, read, buffer)
    image = cl.Image(context, mem_flags.READ_WRITE, form, shape=(5, 1))
    cl.enqueue_copy(queue, buffer, VALUES)
    kernels.put(queue, (5,), None, image, buffer)
    written = np.zeros_like(pixels)
    cl.enqueue_copy(queue, written, image, origin=(0, 0), region=(5, 1))
    right = "right" if (written == pixels).all() else "wrong"
    print(f"{order:4} {kind:10} listed: {form in listed}, read: {' '.join(f'{value:g}' for value in read)}, written: {right}")
PYTHON
