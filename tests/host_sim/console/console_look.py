# SPDX-License-Identifier: MIT
"""What tests of the console's page see of it: when it is at rest, and what its pictures are."""

import base64
import contextlib
import os
import shlex
import subprocess
import tempfile

from console_client import Console, holds, until
from webdriver import PATIENCE, Browser

RESULT = ".screen[data-view=result]"
SETTLED = ("document.body.dataset.serial === String(state.serial) && !state.hurried && !link.waiting "
           "&& document.body.dataset.draft === 'false'")


@contextlib.contextmanager
def a_page(build, start, arguments):
    """(browser, console, folder) of a console's page at `start`. Its console must stay empty, and end with 0."""
    with tempfile.TemporaryDirectory() as work, open(os.path.join(work, "said"), "w+") as said:
        console, b = Console(build, [*arguments, "--out", os.path.join(work, "out")], said), None
        try:
            b = Tab(work)
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


def rests(act):
    """An act of a hand, behind which the page comes to rest if `then` says what at."""
    def both(b, *arguments, then=None, **how):
        act(b, *arguments, **how)
        if then:
            settle(b, then)
    return both


class Tab(Browser):
    """A browser with the console's page."""

    click, keys, press, drag, wheel, open = map(rests, (Browser.click, Browser.keys, Browser.press, Browser.drag, Browser.wheel, Browser.open))

    def run(self, script, *arguments, then=None):
        value = super().run(script, *arguments)
        if then:
            settle(self, then)
        return value


# A number that changes with a picture: its width, and a sum over its pixels.
SUM = """
    const sum = (c) => {
        const copy = new OffscreenCanvas(c.width, c.height), g = copy.getContext('2d', { willReadFrequently: true });
        g.drawImage(c, 0, 0);
        const d = g.getImageData(0, 0, c.width, c.height).data;
        let sum = 0; for (let i = 0; i < d.length; i += 4) sum = (sum * 31 + d[i] * 65536 + d[i + 1] * 256 + d[i + 2]) % 4294967291;
        return c.width + ':' + sum;
    };"""


def pixels(b, view):
    """The number of a view's picture."""
    return b.run(SUM + "return sum(canvases[arguments[0]].canvas)", view)


def png_pixels(b, path, height=None):
    """The number of a PNG, or of its upper rows."""
    with open(path, "rb") as file:
        data = base64.b64encode(file.read()).decode()
    return b.run(SUM + "const blob = new Blob([Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0))]);"
                 "return createImageBitmap(blob).then((i) => arguments[1] ? createImageBitmap(i, 0, 0, i.width, arguments[1]) : i).then(sum)", data, height)


def all_pixels(b):
    return {view: pixels(b, view) for view in ("result", "full", "truth", "across", "along", "deep")}


def snapshot(b, work):
    """The number of the result as the page saves it."""
    path = os.path.join(work, b.run("return 'smartvis_' + lastFigures.of.source.scene + '_result.png'"))
    if os.path.exists(path):
        os.remove(path)
    b.run("at('snapshot-view').value = 'result'; at('with-caption').checked = false; delete document.body.dataset.snapshot")
    b.click("#snapshot")
    size = b.wait_for("document.body.dataset.snapshot", "the snapshot")
    until(lambda: os.path.exists(path) and os.path.getsize(path) == int(size), PATIENCE, "the snapshot's file")
    return png_pixels(b, path)


def run_of(b, host_sim, work, *more):
    """The folder of what the command line that the page shows writes."""
    words = shlex.split(b.run("return at('line').value").split("\n")[0])
    holds(words[:2] == ["host_sim", "run"], f"the command line is {words}")
    out = os.path.join(work, "run")
    done = subprocess.run([host_sim, *words[1:], "--few-pictures", "--out", out, *more], capture_output=True, text=True, check=False)
    holds(done.returncode == 0, f"{words}: {done.stderr}")
    return out


def as_run_draws_it(b, host_sim, work, what):
    shown, run = snapshot(b, work), png_pixels(b, os.path.join(run_of(b, host_sim, work), "result.png"))
    holds(shown == run and run.startswith("512:"), f"{what}: the snapshot is {shown}, run draws {run}")


def choose(b, control, value, then=None):
    b.run("at(arguments[0]).value = arguments[1]; at(arguments[0]).dispatchEvent(new Event('change'))", control, value, then=then)
