# SPDX-License-Identifier: MIT
"""The plugin ABI of smartvis_plugin.h in ctypes: structs, constants, and nothing else.

Names and order of the fields are the header's. ``tests/test_abi.py`` compiles the headers and compares every
size, offset and number with what stands here.
"""

import ctypes
from ctypes import (
    CFUNCTYPE,
    POINTER,
    Structure,
    c_char_p,
    c_double,
    c_float,
    c_int32,
    c_uint16,
    c_uint32,
    c_uint64,
    c_void_p,
)
from typing import TypeVar

SV_ABI_MAJOR = 1
SV_ABI_MINOR = 1
SV_ENTRY_SYMBOL = "smartvis_plugin_entry"

SV_OK = 0
SV_NO_SURFACE = 1
SV_PARTIAL = 2
SV_ERR_INTERNAL = -1
SV_ERR_ARGUMENT = -10
SV_ERR_SIZE = -11
SV_ERR_FORMAT = -12
SV_ERR_PARAM_ID = -13
SV_ERR_PARAM_RANGE = -14
SV_ERR_PARAM_FIXED = -15
SV_ERR_UNKNOWN_ID = -16
SV_ERR_STATE = -20
SV_ERR_SLAB_ORDER = -21
SV_ERR_SLAB_MISSING = -22
SV_ERR_SLAB_SHAPE = -23
SV_ERR_NO_DEVICE = -30
SV_ERR_BUILD = -31
SV_ERR_OPENCL = -32
SV_ERR_SELF_TEST = -33
SV_ERR_NO_MEMORY = -40

SV_LOG_DEBUG = 0
SV_LOG_INFO = 1
SV_LOG_WARNING = 2
SV_LOG_ERROR = 3
SV_LOG_HOST_MISBEHAVING = 4
SV_LOG_PLUGIN_MISBEHAVING = 5

SV_PARAM_FLOAT = 0
SV_PARAM_INT = 1
SV_PARAM_BOOL = 2
SV_PARAM_ENUM = 3
SV_PARAM_PRIMARY = 1 << 0
SV_PARAM_EXPERT = 1 << 1
SV_PARAM_REACTIVATE = 1 << 2
SV_PARAM_ADJUST = 1 << 3

SV_VOXEL_U8 = 1
SV_CARRIER_HOST = 1
SV_NO_PADDING = -1
SV_FORMAT_SCANNED = 1 << 0
SV_FRAME_DISCONTINUITY = 1 << 0
SV_FRAME_SAME_VOLUME = 1 << 1
SV_BEAMS_UNKNOWN = 0
SV_BEAMS_PARALLEL = 1
SV_BEAMS_FAN = 2
SV_POINT_NONE = 0
SV_POINT_INITIAL = 1
SV_POINT_EMPTY = 2
SV_QUEUE_OWN = 1 << 0
SV_QUEUE_HOST = 1 << 1
SV_FEATURE_SCANNED = 1 << 0
SV_FEATURE_PADDING = 1 << 1
SV_FEATURE_ADJUST = 1 << 2
SV_FEATURE_PROBE = 1 << 3

SV_EXT_CONFIDENCE = "smartvis.confidence/1"
SV_EXT_POINTS = "smartvis.points/1"
SV_EXT_NEEDS = "smartvis.needs/1"
SV_NEEDS_CPU = 1 << 0
SV_NEEDS_UNIFIED = 1 << 1
SV_NEEDS_DOUBLES = 1 << 2


class sv_host(Structure):
    pass


class sv_plugin(Structure):
    pass


LOG = CFUNCTYPE(None, POINTER(sv_host), c_int32, c_char_p)
GET_HOST_EXTENSION = CFUNCTYPE(c_void_p, POINTER(sv_host), c_char_p)

sv_host._fields_ = [
    ("size", c_uint32),
    ("abi_minor", c_uint32),
    ("host_data", c_void_p),
    ("name", c_char_p),
    ("version", c_char_p),
    ("log", LOG),
    ("get_extension", GET_HOST_EXTENSION),
]


class sv_param_info(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("id", c_uint32),
        ("type", c_uint32),
        ("flags", c_uint32),
        ("key", c_char_p),
        ("label", c_char_p),
        ("unit", c_char_p),
        ("help", c_char_p),
        ("min_value", c_double),
        ("max_value", c_double),
        ("display_min", c_double),
        ("display_max", c_double),
        ("default_value", c_double),
        ("step", c_double),
        ("group", c_char_p),
        ("depends_on", c_uint32),
        ("reserved", c_uint32),
        ("depends_values", c_uint64),
    ]


class sv_param_value(Structure):
    _fields_ = [("id", c_uint32), ("reserved", c_uint32), ("value", c_double)]


class sv_format(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("slices", c_uint32),
        ("max_slab_slices", c_uint32),
        ("voxel_type", c_uint32),
        ("carrier", c_uint32),
        ("padding_value", c_int32),
        ("tiles_x", c_uint32),
        ("tile_w", c_uint32),
        ("tile_h", c_uint32),
        ("row_pitch", c_uint32),
        ("spacing_mm", c_float * 3),
        ("flags", c_uint32),
        ("context", c_void_p),
        ("device", c_void_p),
        ("queue", c_void_p),
        ("host_memory", c_void_p),
        ("host_memory_bytes", c_uint64),
        ("values", POINTER(sv_param_value)),
        ("value_count", c_uint32),
        ("reserved", c_uint32),
    ]


class sv_scanned(Structure):
    _fields_ = [("first", c_uint16), ("end", c_uint16)]


class sv_frame(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("flags", c_uint32),
        ("index", c_uint64),
        ("time_ns", c_uint64),
        ("values", POINTER(sv_param_value)),
        ("value_count", c_uint32),
        ("reserved", c_uint32),
        ("scanned", c_void_p),
        ("scanned_object", c_void_p),
        ("scanned_offset", c_uint64),
        ("probe_rotation", c_float * 9),
        ("probe_side", c_float * 3),
        ("beams", c_uint32),
        ("beam_apex_mm", c_float * 3),
        ("beam_sweep_mm", c_float),
        ("reserved_beams", c_uint32),
    ]


class sv_slab(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("first_slice", c_uint32),
        ("slice_count", c_uint32),
        ("reserved", c_uint32),
        ("memory", c_void_p),
        ("object", c_void_p),
        ("offset", c_uint64),
        ("bytes", c_uint64),
    ]


class sv_stats(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("outcome", c_int32),
        ("rays", c_uint32),
        ("points", c_uint32),
        ("unfilled", c_uint32),
    ]


class sv_result(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("depth_pitch", c_uint32),
        ("depth", c_void_p),
        ("depth_object", c_void_p),
        ("depth_offset", c_uint64),
        ("status", c_void_p),
        ("stats", POINTER(sv_stats)),
    ]


class sv_descriptor(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("carriers", c_uint32),
        ("id", c_char_p),
        ("name", c_char_p),
        ("vendor", c_char_p),
        ("version", c_char_p),
        ("summary", c_char_p),
        ("voxel_types", c_uint32),
        ("queues", c_uint32),
        ("features", c_uint32),
        ("reserved", c_uint32),
        ("extensions", POINTER(c_char_p)),
    ]


SELF = POINTER(sv_plugin)
DESTROY = CFUNCTYPE(None, SELF)
ACTIVATE = CFUNCTYPE(c_int32, SELF, POINTER(sv_format))
DEACTIVATE = CFUNCTYPE(None, SELF)
BEGIN = CFUNCTYPE(c_int32, SELF, POINTER(sv_frame))
SLAB = CFUNCTYPE(c_int32, SELF, POINTER(sv_slab))
END = CFUNCTYPE(c_int32, SELF, POINTER(sv_result))
ADJUST = CFUNCTYPE(c_int32, SELF, POINTER(sv_param_value), c_uint32, POINTER(sv_result))
PARAM_COUNT = CFUNCTYPE(c_uint32, SELF)
PARAM_INFO = CFUNCTYPE(c_int32, SELF, c_uint32, POINTER(sv_param_info))
PARAM_TEXT = CFUNCTYPE(c_int32, SELF, c_uint32, c_double, c_char_p, c_uint32)
LAST_ERROR = CFUNCTYPE(c_char_p, SELF)
GET_EXTENSION = CFUNCTYPE(c_void_p, SELF, c_char_p)

sv_plugin._fields_ = [
    ("size", c_uint32),
    ("reserved", c_uint32),
    ("descriptor", POINTER(sv_descriptor)),
    ("plugin_data", c_void_p),
    ("destroy", DESTROY),
    ("activate", ACTIVATE),
    ("deactivate", DEACTIVATE),
    ("begin", BEGIN),
    ("slab", SLAB),
    ("end", END),
    ("adjust", ADJUST),
    ("param_count", PARAM_COUNT),
    ("param_info", PARAM_INFO),
    ("param_text", PARAM_TEXT),
    ("last_error", LAST_ERROR),
    ("get_extension", GET_EXTENSION),
]


class sv_entry(Structure):
    _fields_ = [
        ("abi_major", c_uint32),
        ("abi_minor", c_uint32),
        ("size", c_uint32),
        ("count", c_uint32),
        ("descriptor", CFUNCTYPE(POINTER(sv_descriptor), c_uint32)),
        ("create", CFUNCTYPE(c_int32, POINTER(sv_host), c_char_p, POINTER(SELF))),
    ]


class sv_confidence_report(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("fluid_threshold", c_float),
        ("rays", c_uint32),
        ("open_rays", c_uint32),
        ("reason", c_uint32),
        ("found", c_float),
        ("wanted", c_float),
        ("try_id", c_uint32),
        ("try_value", c_float),
    ]


class sv_ext_confidence(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("read", CFUNCTYPE(c_int32, SELF, c_void_p, POINTER(sv_confidence_report))),
        ("offered", CFUNCTYPE(c_uint32, SELF)),
        ("write", CFUNCTYPE(c_int32, SELF, c_void_p, c_void_p, c_uint64)),
    ]


class sv_points_report(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("empty_points", c_uint32),
        ("passes", c_uint32),
        ("volume_max", c_float),
        ("bone_threshold", c_float),
        ("sure_points", c_uint32),
    ]


class sv_ext_points(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("write", CFUNCTYPE(c_int32, SELF, POINTER(sv_points_report))),
    ]


class sv_needs_device(Structure):
    _fields_ = [("size", c_uint32), ("flags", c_uint32), ("compute_units", c_uint32), ("reserved", c_uint32)]


class sv_needs(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("commands", c_uint32),
        ("adjust_commands", c_uint32),
        ("reserved", c_uint32),
        ("device_bytes", c_uint64),
        ("largest_buffer", c_uint64),
        ("host_bytes", c_uint64),
    ]


class sv_ext_needs(Structure):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        (
            "of",
            CFUNCTYPE(
                c_int32,
                SELF,
                POINTER(sv_format),
                POINTER(sv_param_value),
                c_uint32,
                POINTER(sv_needs_device),
                POINTER(sv_needs),
            ),
        ),
    ]


_Struct = TypeVar("_Struct", bound=Structure)


def sized(struct: type[_Struct], **fields: object) -> _Struct:
    """A struct with its ``size`` set, as the header asks of whoever owns the memory."""
    made = struct(**fields)
    made.size = ctypes.sizeof(struct)
    return made
