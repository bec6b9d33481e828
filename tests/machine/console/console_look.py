# SPDX-License-Identifier: MIT
"""What tests of the console's page see of it: when it is at rest, and what its pictures are."""

import contextlib
import os
import struct
import tempfile
import zlib

from console_client import Console, holds
from webdriver import Browser

RESULT = ".screen[data-view=result]"
SETTLED = ("document.body.dataset.serial === String(state.serial) && !state.hurried && !link.waiting "
           "&& document.body.dataset.draft === 'false'")


@contextlib.contextmanager
def a_page(build, start, arguments):
    """(browser, console, folder) of a console's page at `start`. Its console must stay empty, and end with 0."""
    with tempfile.TemporaryDirectory() as work, open(os.path.join(work, "said"), "w+") as said:
        console, b = Console(build, [*arguments, "--out", os.path.join(work, "out")], said), None
        try:
            b = Browser(work)
            b.open(console.address + start)
            yield b, console, work
            lines = b.console()
            holds(lines == [], f"the browser's console is not empty: {lines}")
            console.interrupt()
            ended = console.wait(60)
            said.seek(0)
            holds(ended == 0, f"SIGINT with the page open ends it with {ended}: {said.read()[-2000:]}")
        finally:
            if b:
                b.close()
            console.end()


def settle(b, what):
    b.wait_for(SETTLED, what)


def pixels(b, view):
    """A number that changes with the view's picture."""
    return b.run("""
        const c = canvases[arguments[0]].canvas, copy = new OffscreenCanvas(c.width, c.height);
        const g = copy.getContext('2d', { willReadFrequently: true });
        g.drawImage(c, 0, 0);
        const d = g.getImageData(0, 0, c.width, c.height).data;
        let sum = 0; for (let i = 0; i < d.length; i += 4) sum = (sum * 31 + d[i] * 65536 + d[i + 1] * 256 + d[i + 2]) % 4294967291;
        return c.width + ':' + sum;""", view)


def all_pixels(b):
    return {view: pixels(b, view) for view in ("result", "full", "truth", "across", "along", "deep")}


def read_png(data):
    """Width and rows of RGB bytes of a PNG of 8 bits without interlacing."""
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            size = struct.unpack(">II", data[at + 8:at + 16])
        elif kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, row, out = zlib.decompress(packed), bytearray(size[0] * 3), []
    for y in range(size[1]):
        kind, line = raw[y * (len(row) + 1)], bytearray(raw[y * (len(row) + 1) + 1:(y + 1) * (len(row) + 1)])
        for x, value in enumerate(line):
            left = line[x - 3] if x > 2 else 0
            up, corner = row[x], (row[x - 3] if x > 2 else 0)
            guess = left + up - corner
            near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[x] = (value + (0, left, up, (left + up) // 2, near)[kind]) & 255
        row = line
        out.append(bytes(row))
    return size[0], out


def snapshot(b, work):
    """The result as the page saves it."""
    path = os.path.join(work, "smartvis_D01_result.png")
    if os.path.exists(path):
        os.remove(path)
    b.run("at('snapshot-view').value = 'result'; delete document.body.dataset.snapshot")
    b.click("#snapshot")
    size = b.wait_for("document.body.dataset.snapshot", "the snapshot")
    for _ in range(200):
        if os.path.exists(path) and os.path.getsize(path) == int(size):
            break
        b.run("return 0")
    with open(path, "rb") as file:
        return read_png(file.read())


def choose(b, control, value):
    b.run("at(arguments[0]).value = arguments[1]; at(arguments[0]).dispatchEvent(new Event('change'))", control, value)
