# SPDX-License-Identifier: MIT
"""hostile_recordings.py FOLDER: recordings that nobody would write, with checksums that hold, and one that is right.

Each is a file NAME of the folder; right.svr can be played into examples/first_edge, all others must end with code 3.
"""

import struct
import sys
import zlib
from pathlib import Path

PLUGIN, CALL, RETURN, LINE, END = range(1, 6)
CREATE, _DESTROY, ACTIVATE, DEACTIVATE, BEGIN, SLAB, FINISH = range(7)
ERR_STATE = -20


def part(kind: int, contents: bytes = b"") -> bytes:
    head = struct.pack("<II", kind, len(contents)) + contents
    return head + struct.pack("<I", zlib.crc32(head))


def text(words: str) -> bytes:
    return struct.pack("<I", len(words)) + words.encode()


def packed(contents: bytes) -> bytes:
    shrunk = zlib.compress(contents)
    return struct.pack("<I", len(shrunk)) + shrunk


def call(kind: int, fields: bytes = b"", sound: int = 1) -> bytes:
    return part(CALL, struct.pack("<IIQ", kind, sound, 1) + fields)


def returned(kind: int, status: int = 0, fields: bytes = b"") -> bytes:
    ends = struct.pack("<II", 0, 0) if kind == FINISH and not fields else fields
    return part(RETURN, struct.pack("<IIQi", kind, 1, 1, status) + text("") + ends)


def form(side: int = 4, slices: int = 4, tiles_x: int = 1, tile: int = 0, pitch: int = 0, carrier: int = 1) -> bytes:
    tile = tile or side
    volume = struct.pack("<6Ii", side, side, slices, slices, 1, carrier, -1)
    return volume + struct.pack("<4I", tiles_x, tile, tile, pitch or tiles_x * tile) + bytes(28)


def frame(ranges: bytes = struct.pack("<I", 0)) -> bytes:
    return struct.pack("<IQQ12fI", 0, 0, 0, *[0.0] * 12, 0) + ranges


def slab(first: int = 0, count: int = 4, voxels: bytes = struct.pack("<I", 0)) -> bytes:
    return struct.pack("<II", first, count) + voxels


def ranges_of(side: int) -> bytes:
    return struct.pack("<I", 1) + packed(bytes(4 * side * side))


def voxels_of(side: int, slices: int) -> bytes:
    return struct.pack("<I", 1) + packed(bytes(side * side * slices))


def done(kind: int, fields: bytes = b"", status: int = 0) -> bytes:
    return call(kind, fields) + returned(kind, status)


start = b"SVRECORD" + struct.pack("<II", 1, 0) + done(CREATE)
start += part(PLUGIN, text("org.smartvis.example.first_edge") + text("First edge") + text("1") + struct.pack("<I", 0))
active = start + done(ACTIVATE, form())
begun = active + done(BEGIN, frame())
result = struct.pack("<4I", 0, 1, 0, 0)
line = part(LINE, struct.pack("<i", 0) + text("end: 16 of 16 pixels are without a surface"))
# A larger activation that did not come about, or of which nobody knows: what follows is of the small one.
large = form(side=1000, slices=100)
files = {
    "right": begun + done(SLAB, slab()) + call(FINISH, result) + line + returned(FINISH) + done(DEACTIVATE),
    "second_activation": active
    + done(ACTIVATE, large, ERR_STATE)
    + done(BEGIN, frame())
    + call(SLAB, slab(0, 4, voxels_of(4, 4))),
    "activation_without_return": active
    + call(ACTIVATE, large)
    + done(BEGIN, frame())
    + call(SLAB, slab(0, 4, voxels_of(4, 4))),
    "smaller_activation_without_return": start
    + done(ACTIVATE, large)
    + call(ACTIVATE, form())
    + call(BEGIN, frame(ranges_of(1000))),
    "return_without_call": active + returned(BEGIN),
    "return_of_another_call": active + call(BEGIN, frame()) + returned(FINISH),
    "frame_without_activation": start + call(BEGIN, frame()),
    "frame_after_deactivate": active + done(DEACTIVATE) + call(BEGIN, frame()),
    "slab_without_frame": active + call(SLAB, slab()),
    "slab_of_the_frame_before": begun + done(DEACTIVATE) + done(ACTIVATE, form()) + call(SLAB, slab()),
    "slab_left_out": begun + call(SLAB, slab(1, 2)),
    "slab_beyond": begun + call(SLAB, slab(0, 5)),
    "slab_of_nothing": begun + call(SLAB, slab(0, 0)),
    "slab_of_others": begun + done(SLAB, slab(0, 3)) + call(SLAB, slab(3, 2)),
    "no_carrier": start + call(ACTIVATE, form(carrier=0)),
    "unknown_carrier": start + call(ACTIVATE, form(carrier=200)),
    "no_tiles": start + call(ACTIVATE, form(tiles_x=0)),
    "narrow_tiles": start + call(ACTIVATE, form(tile=3)),
    "no_width": start + call(ACTIVATE, form(side=0, tile=1)),
    "huge": start + call(ACTIVATE, form(side=8192, slices=8192, tile=16384, pitch=0x7FFFFFFF)),
    "huge_slab": start
    + done(ACTIVATE, form(side=8192, slices=8))
    + done(BEGIN, frame())
    + call(SLAB, slab(0, 8, voxels_of(1, 1))),
    "voxels_that_are_short": begun + call(SLAB, slab(0, 4, voxels_of(4, 3))),
    "voxels_that_are_long": begun + call(SLAB, slab(0, 4, voxels_of(4, 5))),
    "unknown_call": active + call(99),
    "unknown_part": active + part(17),
    "values_without_end": active + call(BEGIN, frame()[:-8] + struct.pack("<II", 1000, 0)),
}
for name, contents in files.items():
    Path(sys.argv[1], name + ".svr").write_bytes(contents + part(END))
