# SPDX-License-Identifier: MIT
"""hostile_recordings.py FOLDER [SEEDS]: recordings that nobody would write, with checksums that hold, and one that is right.

Each is a file of a folder that says what playing it may end with: `right` with 0, `wrong` with 3, `apart` with 1, for they say
of the plugin what it does not do; `needy` is for a limit below what a plugin needs; `any`, SEEDS files of calls drawn by chance, with 0, 1 or 3.
"""

import random
import struct
import sys
import zlib
from pathlib import Path

PLUGIN, CALL, RETURN, LINE, END = range(1, 6)
CREATE, _DESTROY, ACTIVATE, DEACTIVATE, BEGIN, SLAB, FINISH, ADJUST = range(8)
HOST, BUFFER, IMAGE = range(1, 4)
ERR_STATE, ERR_NO_MEMORY = -20, -40


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
    ends = struct.pack("<II", 0, 0) if kind in (FINISH, ADJUST) and not fields else fields
    return part(RETURN, struct.pack("<IIQi", kind, 1, 1, status) + text("") + ends)


def form(
    side: int = 4,
    slices: int = 4,
    *,
    tiles_x: int = 1,
    tile: int = 0,
    tile_h: int = 0,
    pitch: int = 0,
    carrier: int = HOST,
    queue: int = -1,
    rows: int = 0,
    spacing: tuple[float, float, float] = (0, 0, 0),
) -> bytes:
    """Of activate. `queue`: 1 the host's; as the carrier needs. `rows`: as many as columns."""
    tile = tile or side
    rows = rows or side
    volume = struct.pack("<6Ii", side, rows, slices, slices, 1, carrier, -1)
    tiles = struct.pack("<4I3f", tiles_x, tile, tile_h or min(tile, rows), pitch or tiles_x * tile, *spacing)
    return volume + tiles + struct.pack("<4I", 0, int(carrier != HOST) if queue < 0 else queue, 0, 0)


def frame(ranges: bytes = struct.pack("<I", 0)) -> bytes:
    return struct.pack("<IQQ12fI4fI", 0, 0, 0, *[0.0] * 12, 0, *[0.0] * 4, 0) + ranges


def slab(first: int = 0, count: int = 4, voxels: bytes = struct.pack("<I", 0)) -> bytes:
    return struct.pack("<II", first, count) + voxels


def ranges_of(side: int) -> bytes:
    return struct.pack("<I", 1) + packed(bytes(4 * side * side))


def voxels_of(side: int, slices: int, rows: int = 0) -> bytes:
    return struct.pack("<I", 1) + packed(bytes(side * (rows or side) * slices))


def done(kind: int, fields: bytes = b"", status: int = 0) -> bytes:
    return call(kind, fields) + returned(kind, status)


def plugin(parameters: bytes = struct.pack("<I", 0)) -> bytes:
    return part(PLUGIN, text("org.smartvis.example.first_edge") + text("First edge") + text("1") + parameters)


def parameter(number: int, key: str) -> bytes:
    return struct.pack("<II", number, 0) + text(key)


def scan(side: int = 4, slices: int = 4, depths: int = 1, rows: int = 0) -> bytes:
    """A frame; `depths`: 2 for an object."""
    ends = call(FINISH, struct.pack("<4I", 0, depths, 0, 0)) + returned(FINISH)
    return done(BEGIN, frame()) + done(SLAB, slab(0, slices, voxels_of(side, slices, rows))) + ends


def adjusts(count: int, depths: int = 2) -> bytes:
    return count * done(ADJUST, struct.pack("<5I", 0, depths, 0, 0, 0))


header = b"SVRECORD" + struct.pack("<II", 2, 0) + done(CREATE)
start = header + plugin()
active = start + done(ACTIVATE, form())
begun = active + done(BEGIN, frame())
result = struct.pack("<4I", 0, 1, 0, 0)
small, image = form(side=48, slices=32), form(carrier=IMAGE)
off = done(DEACTIVATE)
line = part(LINE, struct.pack("<i", 0) + text("end: 16 of 16 pixels are without a surface"))
# Frames of which the voxels were not kept: some 200 bytes each.
scan_of_nothing = done(BEGIN, frame()) + done(SLAB, slab(0, 256)) + done(FINISH, result)
# A larger activation that did not come about, or of which nobody knows: what follows is of the small one.
large = form(side=1000, slices=100)
# The debug line of author.h for a method that keeps nothing of its own.
own = part(LINE, struct.pack("<i", 0) + text("should it crash: sva.own is NULL, since sva_method.own_bytes is 0"))
whole = start + call(ACTIVATE, form()) + own + returned(ACTIVATE) + done(BEGIN, frame())
right = {"right": whole + done(SLAB, slab()) + call(FINISH, result) + line + returned(FINISH) + off}
# An activation that was refused there and is taken here: want of memory at the customer's, or a lie.
apart = {
    "refused_then_smaller": start
    + done(ACTIVATE, form(side=96, slices=64), ERR_NO_MEMORY)
    + done(ACTIVATE, small)
    + scan(48, 32)
    + off,
    "refused_then_larger": start + done(ACTIVATE, form(), ERR_NO_MEMORY) + done(ACTIVATE, small) + scan(48, 32) + off,
    # Slabs of the second format have bytes enough for the first, and its map is smaller.
    "refused_then_narrow": start
    + done(ACTIVATE, form(side=64), ERR_NO_MEMORY)
    + done(ACTIVATE, form(side=16, tile_h=96, pitch=64))
    + scan(16)
    + off,
    "refused_twice": start + 2 * done(ACTIVATE, small, ERR_NO_MEMORY) + done(ACTIVATE, form()) + scan() + off,
    "refused_at_the_end": active + scan() + off + done(ACTIVATE, small, ERR_NO_MEMORY),
    "unsound_between": start
    + done(ACTIVATE, small, ERR_NO_MEMORY)
    + call(DEACTIVATE, sound=0)
    + returned(DEACTIVATE)
    + done(ACTIVATE, form())
    + scan()
    + off,
    "other_carriers": start
    + done(ACTIVATE, form(side=9, slices=9, carrier=IMAGE), ERR_NO_MEMORY)
    + done(ACTIVATE, form(carrier=BUFFER))
    + scan(depths=2)
    + off,
    "adjusts_before_the_slab": start
    + done(ACTIVATE, image)
    + done(BEGIN, frame())
    + adjusts(200)
    + done(SLAB, slab(0, 4, voxels_of(4, 4)))
    + done(FINISH, result)
    + off,
    "adjusts_before_many_slabs": start
    + done(ACTIVATE, form(side=4, slices=64, carrier=IMAGE))
    + done(BEGIN, frame())
    + adjusts(68)
    + b"".join(done(SLAB, slab(z, 1, voxels_of(4, 1))) for z in range(64))
    + done(FINISH, result)
    + off,
    "adjusts_between_slabs": start
    + done(ACTIVATE, image)
    + done(BEGIN, frame())
    + b"".join(done(SLAB, slab(z, 1, voxels_of(4, 1))) + adjusts(9) for z in range(4))
    + done(FINISH, result)
    + off,
    "adjusts_without_frame": start + done(ACTIVATE, image) + adjusts(50) + off,
}
wrong = {
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
    "unsound_deactivate": begun + call(DEACTIVATE, sound=0) + returned(DEACTIVATE) + done(ACTIVATE, large),
    "second_plugin": start + plugin(),
    "parameters_of_one_id": header + plugin(struct.pack("<I", 1024) + 1024 * parameter(7, "a")),
    "image_without_queue": start + call(ACTIVATE, form(carrier=IMAGE, queue=0)),
    "buffer_without_queue": start + call(ACTIVATE, form(carrier=BUFFER, queue=0)),
    "many_rays": start + done(ACTIVATE, form(side=8192, slices=8)) + scan(8192, 1),
    "tall_tiles": start + done(ACTIVATE, form(side=1, slices=8192, tile_h=6144, pitch=128)) + done(BEGIN, frame()),
    "tall_image_tiles": start + done(ACTIVATE, form(1, 8192, tile=128, tile_h=6144, carrier=IMAGE)) + scan(1, 1),
    "long_rows": start + done(ACTIVATE, form(side=1, slices=64, pitch=1 << 26)) + done(BEGIN, frame()),
    "long_image": start + done(ACTIVATE, form(side=1, slices=8192, tiles_x=8192, tile=8192, carrier=IMAGE)),
    "many_large_frames": start + done(ACTIVATE, form(side=512, slices=256)) + 350 * scan_of_nothing,
    "one_row": start + done(ACTIVATE, form(side=4096, rows=1)) + scan(4096, rows=1) + off,
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


def drawn(chance: random.Random) -> bytes:
    """Calls that the reader allows but now and then, of statuses that are as they come."""
    out, side, slices, lasts = start, 4, 4, False
    for _ in range(chance.randrange(5, 40)):
        status, strange = chance.choice((0, 0, 0, ERR_NO_MEMORY)), chance.random() < 0.03
        if lasts == strange:
            side, slices = chance.choice((1, 4, 17, 48)), chance.choice((1, 4, 9))
            fields = form(side, slices, tiles_x=chance.choice((1, 3)), carrier=chance.choice((HOST, BUFFER, IMAGE)))
            out += done(ACTIVATE, fields, status)
            lasts = status == 0
            continue
        match chance.randrange(6):
            case 0:
                out += call(DEACTIVATE, sound=int(lasts)) + returned(DEACTIVATE)
                lasts = False
            case 1 | 2:
                out += scan(side, slices, chance.choice((1, 2)))
            case 3:
                out += adjusts(chance.randrange(1, 2 * slices + 9), chance.choice((1, 2)))
            case 4:
                out += done(BEGIN, frame(ranges_of(side))) + done(SLAB, slab(0, 1, voxels_of(side, 1)), status)
            case 5:
                kind = chance.choice((ACTIVATE, BEGIN, SLAB))
                out += call(kind, sound=0) + returned(kind, status)
    return out


# What costs its player 96 MiB, and a plugin more.
needy = {"many_rays": start + done(ACTIVATE, form(side=2048, slices=8)) + off}
kinds = {"right": right, "wrong": wrong, "apart": apart, "needy": needy}
kinds["any"] = {f"seed_{n}": drawn(random.Random(n)) for n in range(int(sys.argv[2]) if len(sys.argv) > 2 else 24)}
for kind, files in kinds.items():
    folder = Path(sys.argv[1], kind)
    folder.mkdir()
    for name, contents in files.items():
        (folder / f"{name}.svr").write_bytes(contents + part(END))
