# SPDX-License-Identifier: MIT
"""The console's page in a real browser, by its own driver: what a hand, a keyboard and a plugin of a stranger do to it."""

import json
import os
import subprocess
import sys
import time

import console_look
from console_client import holds
from console_look import RESULT, a_page, all_pixels, choose, pixels, settle
from page_looks import looks, tab_order
from webdriver import KEYS, PATIENCE

BUILD = sys.argv[1]
HOST_SIM = os.path.join(BUILD, "host_sim")
PLUGINS = [os.path.join(BUILD, name) for name in ("smartvis.so", "tests/plugins/plane.so", "tests/plugins/by_crash.so")]
START = "#scene=D01,96,3&layout=all"
# The sanitizers' own handlers would turn the plugin's crash into an exit.
os.environ["ASAN_OPTIONS"] = os.environ.get("ASAN_OPTIONS", "") + ":handle_segv=0"


def as_run_draws_it(b, work, what):
    console_look.as_run_draws_it(b, HOST_SIM, work, what)


def it_loads(b):
    settle(b, "the first frame")
    holds(b.run("return document.title") == "SmartVis console", "another page")
    holds(b.run("return at('notice').hidden"), "a notice: " + b.run("return at('notice').textContent"))
    for view, name in (("across", "A plane"), ("along", "B plane"), ("deep", "C plane")):
        holds(b.run("return canvases[arguments[0]].caption.textContent", view).startswith(name), f"{view} is no {name}")
    bar = b.run("const s = canvases.across.scale; return [s.textContent, s.getBoundingClientRect().width / "
                "canvases.across.screen.getBoundingClientRect().width * lastFigures.source.window_mm]")
    holds(abs(float(bar[0].split()[0]) - bar[1]) < 0.5, f"a bar of {bar[0]} is {bar[1]} mm wide")
    b.wait_for("at('fps').textContent === 'at rest'", "a page at rest")
    holds(b.run("return document.querySelector('#primary label').textContent").startswith("Surface position"), "another name for the surface position")
    holds("0.5 is the best guess. Stay between 0 and 1." in b.run("return at('primary').innerText"), "no sentence at the surface position")
    digits = b.run("return [[0.5, 0.05], [0.5, 0.25], [30, 2.5], [7, 1], [0.1588, 0.01], [1e-3, 1e-4]].map(([v, s]) => inSteps(v, s))")
    holds(digits == ["0.50", "0.50", "30.0", "7", "0.16", "0.0010"], f"values in the digits of their steps: {digits}")
    shown = b.run("return ['#primary', '#renderer'].map(id => [...document.querySelectorAll(id + ' output')].map(o => o.textContent))")
    holds(shown[0] == ["0.50"] and "1.00" in shown[1], f"surface position and exposure 1 are shown as {shown}")
    holds("Points" not in b.run("return document.body.innerText") and b.run("return at('numbers').textContent.includes('Points')"),
          "point counts stand before who did not ask for expert figures")
    drawn = all_pixels(b)
    holds(len(set(drawn.values())) == 6 and all(p.startswith("512:") for p in drawn.values()), f"views: {drawn}")
    names = b.run("return [...document.querySelectorAll('input, select, textarea, button, [role=application]')].filter(e => "
                  "!(e.labels && e.labels.length) && !e.getAttribute('aria-label') && !e.textContent.trim()).map(e => e.outerHTML)")
    holds(names == [], f"without a name for a screen reader: {names}")


def it_can_be_read(b):
    """With everything open, light, dark and printed; and by the tab key alone."""
    b.run("document.querySelectorAll('details').forEach((fold) => { fold.open = true; }); notice('What went wrong', false)")
    looks(b, "the console")
    tab_order(b, "the console")
    b.run("document.querySelectorAll('details').forEach((fold) => { fold.open = false; }); notice('', true); document.activeElement.blur(); scrollTo(0, 0)")


# Controls and captions that stand in each other's way; what belongs to a label may touch it.
OVERPRINTED = """
    const shown = [...document.querySelectorAll('input, select, button, output, figcaption, summary, h1, h2, #shown')].filter(e => e.checkVisibility()
        && !e.closest('#primary, .screen')).map(e => [e, e.getBoundingClientRect()]);
    const over = [];
    shown.forEach(([a, p], i) => shown.slice(i + 1).forEach(([b, q]) => {
        if (p.left < q.right - 1 && q.left < p.right - 1 && p.top < q.bottom - 1 && q.top < p.bottom - 1) over.push((a.id || a.outerHTML) + ' / ' + (b.id || b.outerHTML));
    }));
    return [document.documentElement.scrollWidth, over];"""


def on_a_phone(b):
    """The whole result and the surface position are on the screen together, and neither covers the other, from the start."""
    b.devtools("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=1, mobile=False)
    top, result, slider, end = b.run("scrollTo(0, 0); const r = canvases.result.screen.getBoundingClientRect(), "
                                   "k = at('primary').getBoundingClientRect(); return [r.top, r.bottom, k.top, k.bottom]")
    holds("Stay between 0 and 1." in b.run("return at('primary').innerText"), "no sentence beside the surface position")
    holds(-1 <= top and result <= slider and end <= 844, f"the result from {top} to {result}, the slider from {slider} to {end}")
    for how in ("side", "wipe", "off"):
        choose(b, "compare", how, then=f"compare: {how}")
        wide, over = b.run(OVERPRINTED)
        holds(wide <= 390 and over == [], f"compare {how}: {wide} pixels wide, over each other: {over}")
    b.run("toggleBox()")
    rows = b.run("return [...document.querySelectorAll('.pair')].map((pair) => new Set([...pair.querySelectorAll('input')].map((i) => i.offsetTop)).size)")
    b.run("toggleBox()", then="no box")
    holds(rows == [1, 1, 1], f"the two ends of a box's axis lie in {rows} rows")
    b.devtools("Emulation.setDeviceMetricsOverride", width=1280, height=900, deviceScaleFactor=1, mobile=False)
    wide, over = b.run(OVERPRINTED)
    holds(wide <= 1280 and over == [], f"{wide} pixels wide, over each other: {over}")


def the_surface_position(b, work):
    before = all_pixels(b)
    wide = b.run("return document.querySelector('#primary0').getBoundingClientRect().width")
    b.drag("#primary0", (-wide / 6, 0), (wide / 4, 0), then="the surface position, dragged")
    by_mouse = b.run("return state.lanes[0].values.q")
    holds(by_mouse and by_mouse != 0.5, f"the surface position stands at {by_mouse}")
    after = all_pixels(b)
    holds(after["result"] != before["result"] and after["full"] == before["full"], "the surface position changed the wrong pictures")
    figures = b.run("return lastFigures.lanes[0]")
    holds(figures["adjusted"] and figures["clipped"] and figures["activations"] == 1, f"the surface position did not adjust: {figures}")
    as_run_draws_it(b, work, "the surface position by mouse")
    b.run("at('primary0').focus()")
    b.keys("#primary0", KEYS["left"] * 7, then="the surface position, by keys")
    step = b.run("return sliderStep(lanes[0].params.find(p => p.primary))")
    by_keys = b.run("return state.lanes[0].values.q")
    holds(abs(by_mouse - by_keys - 7 * step) < 1e-6, f"seven steps of {step} lead from {by_mouse} to {by_keys}")
    holds(pixels(b, "result") != after["result"], "keys move the surface position, and the picture stays")
    as_run_draws_it(b, work, "the surface position by keys")
    b.run("document.activeElement.blur()")
    b.keys("body", "]", then="the surface position by its own key")
    holds(b.run("return valueOf(0, lanes[0].params.find(p => p.primary))") > by_keys, "] does not turn it up")


def with_two_fingers(b):
    """Spread apart they zoom and do not turn, twisted they roll; a page scrolls beneath one."""
    before = b.run("return state.camera")
    x, y = b.run("const r = canvases.result.screen.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]")

    def touch(kind, *points):
        b.devtools("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x + px, "y": y + py, "id": i} for i, (px, py) in enumerate(points)])

    touch("touchStart", (-30, 0), (30, 0))
    for step in range(1, 6):
        touch("touchMove", (-30 - 6 * step, 0), (30 + 6 * step, 0))
    spread = b.run("return state.camera")
    holds(1.8 < spread["zoom"] / before["zoom"] < 2.2, f"two fingers twice as far apart: zoom {before['zoom']} to {spread['zoom']}")
    holds(abs(spread["yaw"] - before["yaw"]) < 1 and abs(spread["roll"] - before["roll"]) < 1e-6, f"a pinch turns: {spread}")
    touch("touchMove", (-52, -30), (52, 30))
    touch("touchEnd")
    rolled = b.run("return state.camera.roll")
    holds(25 < rolled - before["roll"] < 35, f"twisted by 30 degrees: rolled from {before['roll']} to {rolled}")
    holds(b.run("return getComputedStyle(canvases.result.screen).touchAction") == "pan-y", "the page does not scroll beneath a finger")


def turning(b, work):
    before = all_pixels(b)
    written = b.run("""const replace = history.replaceState; window.written = 0;
        history.replaceState = (...all) => { window.written++; replace.apply(history, all); };
        return new Promise((done) => { let left = 60; const step = () => { turn(left % 2 ? 1 : -1, 0); if (--left) requestAnimationFrame(step);
            else { history.replaceState = replace; done(window.written); } }; step(); });""")
    holds(written < 20, f"the address was written {written} times in 60 moves")
    settle(b, "the camera, there and back")
    b.drag(RESULT, (0, 0), (70, 25), then="the camera, dragged")
    camera = b.run("return state.camera")
    holds(camera["yaw"] > 20 and camera["pitch"] < -5, f"dragged to {camera}")
    after = all_pixels(b)
    same = [view for view in before if before[view] == after[view]]
    holds(not same, f"do not turn: {same}")
    as_run_draws_it(b, work, "a turned camera")
    b.wheel(".screen[data-view=full]", -200, then="the wheel")
    holds(b.run("return state.camera.zoom") > 1.1, "the wheel does not zoom")
    as_run_draws_it(b, work, "a zoomed camera")
    b.run("document.querySelector('.screen[data-view=truth]').focus()")
    b.keys(".screen[data-view=truth]", KEYS["left"] + KEYS["up"], then="the arrows")
    keyed = b.run("return state.camera")
    holds(abs(keyed["yaw"] - camera["yaw"] + 5) < 1e-6 and abs(keyed["pitch"] - camera["pitch"] - 5) < 1e-6, f"by keys: {keyed}")
    b.keys(".screen[data-view=truth]", "z", then="a roll")
    holds(b.run("return state.camera.roll") == 5, "z does not roll")
    as_run_draws_it(b, work, "a rolled camera")
    with_two_fingers(b)
    b.keys(".screen[data-view=truth]", KEYS["home"], then="Home")
    holds(b.run("return state.camera") == {"yaw": 0, "pitch": 0, "roll": 0, "zoom": 1}, "Home does not reset")
    b.drag(".screen[data-view=across]", (0, 0), (30, 40), then="the crosshair")
    moved = all_pixels(b)
    cross = b.run("return state.cross")
    holds(cross[0] > 0.5 and cross[1] == 0.5 and cross[2] > 0.5, f"the crosshair: {cross}")
    holds(moved["along"] != after["along"] and moved["deep"] != after["deep"], "the other slices do not follow")


def playing(b):
    before = all_pixels(b)
    b.click("#step", then="a step")
    holds(b.run("return state.play.index") == 1 and pixels(b, "full") != before["full"], "a step shows the same volume")
    start = int(b.run("return document.body.dataset.frame"))
    b.click("#play")
    indices, end = set(), time.monotonic() + PATIENCE
    while len(indices) < 3 and time.monotonic() < end:
        indices.add(b.run("return lastFigures.index"))
    b.click("#play", then="the pause")
    holds(indices == {0, 1, 2}, f"played volumes {indices}")
    for _ in range(3):  # it freezes at the volume that is seen, not at a later one that is under way
        b.click("#play")
        b.wait_for("at('play').textContent === 'Freeze' && lastFigures.serial === state.serial", "it plays")
        seen = b.run("at('play').click(); return lastFigures.index")
        settle(b, "it is frozen")
        holds(b.run("return [lastFigures.index, at('play').textContent]") == [seen, "Play"], f"volume {seen} was seen when it was frozen")
    holds(int(b.run("return document.body.dataset.frame")) >= start + 2, "few frames")
    holds(b.run("return at('play').getAttribute('aria-pressed')") == "false", "it still plays")


def shown_as(b):
    """How a reader sees the pictures, and what stands beside them."""
    return b.run("""return [Number(getComputedStyle(canvases.result.canvas).opacity), Number(getComputedStyle(at('line')).opacity),
        at('copy').disabled, at('shown').textContent, at('notice').textContent]""")


def a_slow_host(b):
    """Another size, then another source, while the host is behind: whatever is not of the menus is dimmed, and named."""
    b.run("link.held = []; link.take = link.socket.onmessage; link.socket.onmessage = (event) => link.held.push(event)")
    choose(b, "size", "64")
    first = shown_as(b)
    holds(first[0] < 0.3 and first[1] < 0.3 and first[2] and first[3] == "Still shown: D01, 96 voxels, from probe", f"another size: {first}")
    frame = ("link.held.findIndex((e) => typeof e.data === 'string' && JSON.parse(e.data).type === 'frame' "
             "&& JSON.parse(e.data).serial === state.serial)")
    b.wait_for(f"!link.waiting && {frame} >= 0", "the frame of 64 voxels")
    serial = b.run(f"link.until = {frame} + 1; return state.serial")
    choose(b, "source", "scene E02")
    b.run("link.held.splice(0, link.until).forEach(link.take)")
    b.wait_for(f"document.body.dataset.serial === '{serial}'", "pictures of D01 with 64 voxels")
    late = shown_as(b)
    holds(late[0] < 0.3 and late[1] < 0.3 and late[2] and late[3] == "Still shown: D01, 64 voxels, from probe", f"E02 in the menu, D01 beside it: {late}")
    b.run("link.socket.onmessage = link.take; link.held.splice(0).forEach(link.take)", then="E02")
    holds(shown_as(b) == [1, 1, False, "Shown: E02, 64 voxels, from probe", ""], f"E02: {shown_as(b)}")
    holds("--scene E02 --size 64" in b.run("return at('line').value"), "the command line is of another scene")
    choose(b, "from", "left")
    b.wait_for("document.body.dataset.refused", "the refusal of a direction that a scene does not have")
    refused = shown_as(b)
    holds(refused[0] < 0.3 and "no view left" in refused[4], f"refused, and shown as {refused}")
    for control, value in (("from", "probe"), ("size", "96"), ("source", "scene D01")):
        choose(b, control, value)
    settle(b, "D01 again")
    holds(shown_as(b) == [1, 1, False, "Shown: D01, 96 voxels, from probe", ""], f"D01 again: {shown_as(b)}")


def what_is_doubtful_can_be_tried(work):
    """A file whose fluid is doubtful: the rule, its figures, and a button that clips all the same."""
    folder = os.path.join(work, "given")
    subprocess.run([HOST_SIM, "scenes", "R9_26", "--size", "64", "--export", "--out", folder], check=True, capture_output=True)
    with a_page(BUILD, "#file=0:R9_26_full.mha", [folder]) as (b, _, _):
        settle(b, "R9_26")
        holds(not b.run("return lastFigures.lanes[0].clipped"), "it is clipped before it is tried")
        said = b.run("return at('outcome').textContent")
        for words in ("nothing removed.", "Why, and what to try", " % of what is as dark as fluid", " on it is sure"):
            holds(words in said, f"the outcome is '{said}'")
        b.click("#outcome button", then="it is tried")
        figures = b.run("return lastFigures.lanes[0]")
        holds(figures["clipped"] and b.run("return state.lanes[0].values.unsure") == 1, f"it is not clipped: {figures}")
        holds("on it is sure" in figures["why"] and not b.run("return document.querySelector('#outcome button')"), f"it is still offered: {figures}")


def a_view_comes_back(b):
    before = pixels(b, "truth")
    choose(b, "third", "depthmap", then="the depthmap")
    words, (near, far), ends = b.run("""const g = canvases.depthmap.canvas.getContext('2d'), d = g.getImageData(0, 0, 512, 512).data, off = [1e9, 1e9];
        for (let i = 0; i < d.length; i += 4) [[0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]].forEach((end, k) => {
            off[k] = Math.min(off[k], Math.hypot(...end.map((c, j) => c - d[i + j])));
        });
        return [canvases.depthmap.figure.querySelector('.legend').innerText, lastFigures.source.depth_mm, off]""")
    holds(words.split("\n")[:2] == [f"{near:.0f} mm", f"{far:.0f} mm"] and 10 < near < far - 10 and far < 170, f"the depthmap's legend: {words}, {near}, {far}")
    holds(max(ends) < 40, f"the picture does not reach both ends of the legend: {ends}")
    choose(b, "third", "truth", then="the ground truth again")
    holds(pixels(b, "truth") == before, f"the ground truth comes back as {pixels(b, 'truth')}")


def gain_and_contrast(b):
    """They change how slices look, nothing that is drawn, and are undone; a double click resets one."""
    before = all_pixels(b)
    b.drag("#gain", (0, 0), (20, 0))
    b.run("setGrey('contrast', 2)")
    look = "return [look.gain, getComputedStyle(canvases.across.canvas).filter, getComputedStyle(canvases.result.canvas).filter]"
    gain, slices, result = b.run(look)
    holds(gain > 1.5 and slices == f"brightness({gain:g}) contrast(2)" and result == "none", f"gain {gain}: {slices}, {result}")
    b.wait_for("location.hash.includes('contrast=2')", "the address")
    b.click("#undo")
    b.run("at('gain').dispatchEvent(new MouseEvent('dblclick'))", then="gain and contrast as they were")
    holds(b.run(look)[:2] == [1, "brightness(1) contrast(1)"] and all_pixels(b) == before, f"reset: {b.run(look)}")


def grey_is_told_where_it_is_shown(b):
    """The truth of D01 touches nothing; that of M02 does, and shows it in grey, from the probe alone."""
    truth, grey = "return canvases.truth.legend.textContent", "Grey: touches the occluder, cut"
    holds(b.run(truth) == "", f"D01: {b.run(truth)}")
    choose(b, "source", "scene M02", then="M02")
    holds(b.run(truth) == grey, f"M02: {b.run(truth)}")
    b.run("turn(20, 0)", then="M02, turned")
    holds(b.run(truth) == "", f"M02, turned: {b.run(truth)}")
    b.run("turn(-20, 0)")
    choose(b, "source", "scene D01", then="D01 again")


def a_reactivation(b):
    before = b.run("return lastFigures.lanes[0].activations")
    b.run("setValue(0, lanes[0].params.find(p => p.key === 'method'), 1, false)", then="another method")
    figures = b.run("return lastFigures.lanes[0]")
    holds(figures["activations"] == before + 1 and figures["activation_ms"] > 0 and not figures["failed"], f"no activation: {figures}")
    note = b.run("return document.querySelector('#p0-method-note').textContent")
    holds("activates the plugin anew (" in note and " ms the last time)" in note, f"the note says '{note}'")
    b.run("setValue(0, lanes[0].params.find(p => p.key === 'method'), 0, false)", then="the first method")


def a_plugin_nobody_wrote_controls_for(b, work):
    b.run("at('plugin0').value = '1'; at('plugin0').dispatchEvent(new Event('change'))", then="the plane plugin")
    names = b.run("return [...lanes[0].controls.keys()]")
    holds(names == ["depth", "fail", "every", "note", "shape"], f"controls: {names}")
    holds(b.run("return document.querySelector('#primary label').textContent").startswith("Depth"), "no primary parameter")
    before = pixels(b, "result")
    wide = b.run("return at('primary0').getBoundingClientRect().width")
    b.drag("#primary0", (-wide / 2 + 8, 0), (0.45 * wide, 0), then="the plane's depth")
    holds(pixels(b, "result") != before, "the plane does not move")
    as_run_draws_it(b, work, "the plane")
    link = b.run("return location.hash")
    holds("a=1" in link and "depth" in link, f"the address has {link}")


def a_crash(b):
    b.run("at('plugin0').value = '2'; at('plugin0').dispatchEvent(new Event('change'))", then="the plugin that will crash")
    b.run("setValue(0, lanes[0].params.find(p => p.primary), 60, false)", then="its position")
    holds(b.run("return lastFigures.lanes[0].clipped"), "it does not clip before it crashes")
    clipped = pixels(b, "result")
    b.run("setValue(0, lanes[0].params.find(p => p.key === 'fail'), 4, false)", then="the crash")
    words = b.run("return at('outcome').textContent")
    holds("crashed: SIGSEGV" in words, f"the outcome is '{words}'")
    holds("crashed: SIGSEGV" in b.run("return canvases.result.legend.textContent"), "the view does not say why")
    holds(pixels(b, "result") == pixels(b, "full") != clipped, "the view is not unclipped")
    for i in range(5):  # more often than the guard starts it anew
        b.run("turn(3, 0)", then=f"the crash, {i + 2}")
    holds(b.run("return lastFigures.lanes[0].restarts") == 3, "the guard does not give it up")
    b.run("resetCamera(); setValue(0, lanes[0].params.find(p => p.key === 'fail'), 0, false)", then="the plugin without its fault")
    holds(b.run("return lastFigures.lanes[0].clipped") and pixels(b, "result") == clipped, "it gets no other chance")
    b.run("at('plugin0').value = '0'; at('plugin0').dispatchEvent(new Event('change'))", then="another plugin after the crash")
    holds(b.run("return lastFigures.lanes[0].clipped"), "nothing clips after the crash")


def comparing(b):
    b.run("at('compare').value = 'side'; at('compare').dispatchEvent(new Event('change'))", then="side by side")
    holds(pixels(b, "result") != pixels(b, "other"), "two results that are the same tell nothing")
    b.devtools("Emulation.setDeviceMetricsOverride", width=1440, height=1000, deviceScaleFactor=1, mobile=False)
    boxes = b.run("scrollTo(0, 0); return ['result', 'other'].map((v) => canvases[v].screen.getBoundingClientRect()).map((r) => [r.top, r.bottom])")
    holds(boxes[0] == boxes[1] and boxes[0][1] <= 1000, f"the two results are not in one row, or below the fold: {boxes}")
    b.devtools("Emulation.setDeviceMetricsOverride", width=1280, height=900, deviceScaleFactor=1, mobile=False)
    b.run("const p = lanes[1].params.find(p => p.primary); setValue(1, p, valueOf(0, p), false)", then="the same position")
    holds(pixels(b, "result") == pixels(b, "other"), "the same settings give two pictures")
    b.run("setValue(1, lanes[1].params.find(p => p.primary), 1.2, false)", then="the other position")
    other = pixels(b, "other")
    holds(pixels(b, "result") != other, "other settings give one picture")
    b.run("at('compare').value = 'wipe'; at('compare').dispatchEvent(new Event('change'))", then="the wipe")
    holds(pixels(b, "other") == other, "the wipe has another picture")
    holds(b.run("return canvases.other.canvas.style.clipPath") == "inset(0px 0px 0px 50%)", "no wipe")
    b.run("at('wipe').focus()")
    b.keys("#wipe", KEYS["right"])
    holds(b.run("return canvases.other.seam.style.left") == "51%", "the wipe does not move by keys")


def an_address_opens_what_it_says(b, console):
    b.wait_for("addressDue === 0", "the address")
    link = b.run("return location.hash")
    wanted = b.run("return [state.camera, state.lanes, state.source, look.compare, look.wipe]")
    b.open("about:blank")
    b.open(console.address + link, then="the address")
    again = b.run("return [state.camera, state.lanes, state.source, look.compare, look.wipe]")
    holds(json.dumps(again) == json.dumps(wanted), f"opened {again}, wanted {wanted}")


def results(b, work):
    b.click("#write")
    said = b.wait_for("at('written').textContent", "the written results")
    folder = os.path.join(work, "out", "0001")
    holds(folder in said and "depthmap" in said, f"it says '{said}'")
    holds({"depthmap.mha", "mask.mha", "clipped.mha"} <= set(os.listdir(folder)), f"files: {os.listdir(folder)}")
    settle(b, "a frame after writing")


def main():
    with a_page(BUILD, START, [word for path in PLUGINS for word in ("--plugin", path)]) as (b, console, work):
        it_loads(b)
        it_can_be_read(b)
        on_a_phone(b)
        the_surface_position(b, work)
        turning(b, work)
        playing(b)
        a_slow_host(b)
        what_is_doubtful_can_be_tried(work)
        a_view_comes_back(b)
        gain_and_contrast(b)
        grey_is_told_where_it_is_shown(b)
        a_reactivation(b)
        a_plugin_nobody_wrote_controls_for(b, work)
        a_crash(b)
        comparing(b)
        an_address_opens_what_it_says(b, console)
        results(b, work)
    print("ok")


main()
