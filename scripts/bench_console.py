# SPDX-License-Identifier: MIT
"""bench_console.py BUILD_FOLDER [SIZE]: how fast the console is in a browser of this machine: pictures a second while the
camera turns, and the time from the slider to the picture, as the page itself measures them."""

import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "host_sim", "console"))
from console_client import Console  # noqa: E402
from webdriver import Browser  # noqa: E402

MOVES = 200
SECONDS = 8
SETTLED = "document.body.dataset.serial === String(state.serial) && !state.hurried && document.body.dataset.draft === 'false'"

# Turns with every picture of the screen; what comes back are the times at which a frame was painted.
TURN = """
    const [seconds, draft] = arguments, done = arguments[arguments.length - 1], start = performance.now(), times = [], all = [], sizes = [];
    const show = window.showFigures;
    window.showFigures = (text) => { show(text); times.push(performance.now()); all.push(text.ms.all); sizes.push(state.draft);
        if (draft) state.draft = draft; };
    if (draft) state.draft = draft;
    const step = () => {
        if (performance.now() - start < 1000 * seconds) { turn(1.5, 0); requestAnimationFrame(step); return; }
        window.showFigures = show;
        const late = times.filter((t) => t - start > 2000);
        done({ rate: (late.length - 1) * 1000 / (late[late.length - 1] - late[0]), size: sizes[sizes.length - 1],
               ms: all.sort((a, b) => a - b)[Math.floor(all.length / 2)] });
    };
    step();"""

# Moves the surface as a hand would, the next time when the picture of the last is there.
MOVE = """
    const [moves] = arguments, done = arguments[arguments.length - 1], took = [], slider = document.getElementById('primary0');
    const show = window.showFigures;
    let begun = 0, wanted = 0;
    const move = () => {
        if (took.length === moves) { window.showFigures = show; done(took.sort((a, b) => a - b)); return; }
        slider.value = 0.3 + 0.4 * ((took.length * 7) % 10) / 10;
        begun = performance.now();
        slider.dispatchEvent(new Event('input'));
        wanted = state.serial + 1;
    };
    window.showFigures = (text) => {
        show(text);
        if (text.serial < wanted || !wanted) return;
        took.push(performance.now() - begun);
        wanted = 0;
        setTimeout(move, 5);
    };
    move();"""


def wait_and_run(browser, script, *arguments):
    browser.call("POST", "/timeouts", {"script": 110000})
    return browser.call("POST", "/execute/async", {"script": script, "args": list(arguments)})


def busy_ms(console):
    """Milliseconds of processor time that the console has taken: what other programs do does not change it much."""
    with open(f"/proc/{console.process.pid}/stat", encoding="ascii") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) * 1000 / os.sysconf("SC_CLK_TCK")


def main():
    build, size = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 256
    with tempfile.TemporaryDirectory() as work:
        console = Console(build)
        try:
            browser = Browser(work, (1280, 1000))
            browser.open(f"{console.address}#scene=D01,{size},1&layout=all")
            browser.wait_for(SETTLED, "the first picture", 120)
            browser.run("wantedViews = () => ['result', 'full', 'truth']; changed(false)")
            browser.wait_for(SETTLED, "these pictures alone", 120)
            print(f"console: D01, {size}^3 voxels, result, full volume and ground truth; load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
            for draft in (0, 256, 512):
                before, frame = busy_ms(console), int(browser.run("return document.body.dataset.frame"))
                turned = wait_and_run(browser, TURN, SECONDS, draft)
                frames = int(browser.run("return document.body.dataset.frame")) - frame
                busy = (busy_ms(console) - before) / max(1, frames)
                kind = f"drafts of {draft} x {draft}" if draft else f"drafts as there is time for, {turned['size']} x {turned['size']} in the end"
                print(f"turning, {kind}: {turned['rate']:.1f} frames a second of three pictures each, {turned['ms']:.1f} ms a frame in the console (median), "
                      f"{busy:.1f} ms of processor time")
                browser.run("state.draft = 256; resetCamera()")
                browser.wait_for(SETTLED, "the camera at rest", 60)
            took = wait_and_run(browser, MOVE, MOVES)
            print(f"slider to picture: median {took[MOVES // 2]:.1f} ms, 95th percentile {took[MOVES * 95 // 100]:.1f} ms of {MOVES} moves")
            browser.wait_for(SETTLED, "the surface at rest", 60)
            browser.close()
        finally:
            console.end()


main()
