# SPDX-License-Identifier: MIT
"""clip.py LIBRARY VOLUME OUT.raw [KEY=VALUE ...]: a volume's clipping depthmap, by libsmartvis_host alone."""

import ctypes as c
import sys


class Error(c.Structure):
    """svh_error."""

    _fields_ = [("size", c.c_uint32), ("code", c.c_int32), ("status", c.c_int32), ("call", c.c_char * 16),
                ("reason", c.c_char * 1024), ("text", c.c_char * 1024)]  # fmt: skip


class Result(c.Structure):
    """svh_result."""

    _fields_ = [("size", c.c_uint32), ("n", c.c_uint32 * 3), ("spacing", c.c_double * 3), ("outcome", c.c_int32),
                ("clips", c.c_uint32), ("depth", c.POINTER(c.c_float)), ("status", c.c_void_p),
                ("confidence", c.c_void_p), ("points", c.c_uint32), ("unfilled", c.c_uint32),
                ("knows_fluid", c.c_uint32), ("fluid_threshold", c.c_float), ("open_rays", c.c_uint32),
                ("knows_points", c.c_uint32), ("bone_threshold", c.c_float), ("volume_max", c.c_float),
                ("passes", c.c_uint32), ("reconstruct_ms", c.c_float), ("try_id", c.c_uint32),
                ("try_value", c.c_double), ("why", c.c_char_p)]  # fmt: skip


def must(name, *arguments):
    """Calls a function of the library, and ends with its sentence if it fails."""
    error = Error(c.sizeof(Error))
    if getattr(library, name)(*arguments, c.byref(error)) != 0:
        sys.exit(error.text.decode())


library = c.CDLL(sys.argv[1])
host, clipper, volume, result = c.c_void_p(), c.c_void_p(), c.c_void_p(), Result(c.sizeof(Result))
must("svh_open", None, c.byref(host))
must("svh_clipper_open", host, None, None, c.byref(clipper))
for setting in sys.argv[4:]:
    must("svh_set", clipper, setting.encode())
must("svh_volume_read", host, sys.argv[2].encode(), None, c.byref(volume))
must("svh_clip", clipper, volume, None, None, c.byref(result))
width, height, slices = result.n
print(f"{width} x {height} rays of {slices} slices, {result.spacing[2]:g} mm apart: outcome {result.outcome}")
print(
    result.why.decode()
    or f"in the middle it is clipped to slice {result.depth[(height // 2) * width + width // 2]:.1f}"
)
with open(sys.argv[3], "wb") as file:
    file.write(c.string_at(result.depth, 4 * width * height))
library.svh_volume_free(volume)
library.svh_clipper_free(clipper)
library.svh_close(host)
