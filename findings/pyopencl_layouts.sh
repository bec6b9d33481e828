#!/bin/bash
# SPDX-License-Identifier: MIT
# Guess: pyopencl adds an array stored by rows and one stored by columns element by element, or refuses, as it refuses strided ones.
# Found: it pairs them in the order of memory, in silence: v less its own transpose, v - v.T, is 0 everywhere. So do ==, maximum and dot;
# only an assignment refuses. pyopencl's tracker has it open since 2023 (issue 681).
# nibabel gives columns, pydicom and SimpleITK rows: copy to one order before two volumes meet on a device.
work=$(mktemp -d)
# shellcheck source=findings/common.bash
. "$(dirname "$0")/common.bash"
packages pyopencl==2026.1.4 pocl-binary-distribution==3.0 mako==1.3.10 numpy==2.4.6
export POCL_CACHE_DIR=$work/kernels
seen 'numpy:   rows + columns 0 11 22 33 44 55
pyopencl: rows + columns 0 31 12 43 24 55
pyopencl: rows == columns 1 0 0 0 0 1, maximum 0 3 2 4 4 5
pyopencl: dot 50, and 55 by numpy
pyopencl: one order before 0 11 22 33 44 55
v - v.T: 0 0 0 0, and 0 -1 1 0 by numpy
assignment: NotImplementedError' << 'PYTHON'
import numpy as np, pyopencl as cl, pyopencl.array as array
platform = next(p for p in cl.get_platforms() if p.version.startswith("OpenCL 3.0 PoCL 3.0"))
queue = cl.CommandQueue(cl.Context([platform.get_devices()[0]]))
def line(values):
    return " ".join(f"{value:g}" for value in np.asarray(values.get() if hasattr(values, "get") else values).ravel())
rows = np.arange(6, dtype=np.float32).reshape(2, 3)
columns = np.asfortranarray(rows)
a, b = array.to_device(queue, rows), array.to_device(queue, columns)
print("numpy:   rows + columns", line(rows + 10 * columns))
print("pyopencl: rows + columns", line(a + 10 * b))
print(f"pyopencl: rows == columns {line((a == b).astype(np.int8))}, maximum {line(array.maximum(a, b))}")
print(f"pyopencl: dot {array.dot(a, b).get():g}, and {np.vdot(rows, columns):g} by numpy")
print("pyopencl: one order before", line(a + 10 * array.to_device(queue, np.ascontiguousarray(columns))))
square = np.arange(4, dtype=np.float32).reshape(2, 2)
v = array.to_device(queue, square)
print(f"v - v.T: {line(v - v.T)}, and {line(square - square.T)} by numpy")
try:
    a[:] = b
except NotImplementedError as error:
    print("assignment:", type(error).__name__)
PYTHON
