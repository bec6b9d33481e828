# SPDX-License-Identifier: MIT
"""The console's brush in a real browser, by mouse, touch and keyboard; undo and redo."""

import math
import os
import struct
import sys
import zlib

from console_client import holds
from console_look import RESULT, a_page, all_pixels, as_run_draws_it, choose, pixels, run_of, settle

BUILD = sys.argv[1]
HOST_SIM = os.path.join(BUILD, "host_sim")
ENTER = "\ue007"
MARKS = "return state.marks"
# Pixels of the result that differ from a copy of it, beyond what JPEG does: inside the first mark's ring, and outside of it.
CHANGED = """
    const c = canvases.result.canvas, g = (x) => x.getContext('2d').getImageData(0, 0, 512, 512).data;
    const a = g(window.kept), d = g(c), [u, v, r] = lastFigures.marks[0];
    let inside = 0, outside = 0;
    for (let i = 0; i < 512 * 512; i++) {
        if (Math.abs(a[4 * i] - d[4 * i]) < 40) continue;
        Math.hypot(i % 512 - u * 512, Math.floor(i / 512) - v * 512) < r * 512 + 12 ? inside++ : outside++;
    }
    return [inside, outside];"""


def width(b, pixels_, height=900):
    b.devtools("Emulation.setDeviceMetricsOverride", width=pixels_, height=height, deviceScaleFactor=1, mobile=False)
    b.run("scrollTo(0, 0)")


def click(b, dx, dy, view="result"):
    """A click on a picture, so far from its middle; what the page says if that is no mark, else its number of marks."""
    before = len(b.run(MARKS))
    b.run("notice('', true)")
    b.drag(f".screen[data-view={view}]", (dx, dy), (dx, dy))
    b.wait_for(f"!brush.asked && (state.marks.length > {before} || !at('notice').hidden)", "a mark, or why there is none")
    settle(b, "a click with the brush")
    after = len(b.run(MARKS))
    return after if after > before else b.run("return at('notice').textContent")


def a_mark_removes_what_is_seen(b, work):
    before = all_pixels(b)
    b.run("const k = window.kept = document.createElement('canvas'); k.width = k.height = 512; k.getContext('2d').drawImage(canvases.result.canvas, 0, 0)")
    b.click("#remove")
    said = click(b, 0, -40)
    holds(said == 1, f"a click puts no mark: {said}")
    after = all_pixels(b)
    same = [view for view in before if before[view] == after[view]]
    holds(same == ["full", "truth", "across"], f"stay as they were: {same}")
    inside, outside = b.run(CHANGED)
    holds(inside > 200 and outside < inside / 20, f"{inside} pixels change inside the mark, {outside} outside of it")
    put = b.run("const r = canvases.result.screen.getBoundingClientRect(); return [lastFigures.marks[0], r.width]")
    holds(abs(put[0][0] - 0.5) < 0.01 and abs(put[0][1] - 0.5 + 40 / put[1]) < 0.01, f"the mark is shown at {put}")
    holds(b.run("return document.querySelectorAll('.screen[data-view=result] .marks circle').length") == 1, "no ring on the picture")
    as_run_draws_it(b, HOST_SIM, work, "a mark")
    return before, after


def undo_and_redo(b, before, after):
    b.press("\ue009", "z", then="undo")
    holds(b.run(MARKS) == [] and all_pixels(b) == before, "undo gives another picture back")
    b.press("\ue009", "\ue008", "Z", then="redo")
    holds(all_pixels(b) == after, "redo gives another picture")
    b.click("#clear-marks", then="no marks")
    holds(all_pixels(b) == before, "marks that were cleared are seen")
    b.click("#undo", then="marks again")
    b.run("turn(25, 0)", then="turned")
    (x, _, z, _, _), mm, shown = b.run("return [state.marks[0], lastFigures.source.window_mm, lastFigures.marks[0][0]]")
    middle, yaw = 0.5 * 95 / 96 * mm, math.radians(25)
    expected = 0.5 + ((x - middle) * math.cos(yaw) - (z - middle) * math.sin(yaw)) / mm
    holds(abs(shown - expected) < 1e-6 and abs(shown - 0.5) > 0.005, f"the mark does not turn with the volume: {shown}, expected {expected}")
    b.run("setValue(0, lanes[0].params.find(p => p.primary), 1, false)", then="another position")
    for wanted in ([25, {}], [0, {}]):
        b.click("#undo", then="one step back")
        now = b.run("return [state.camera.yaw, state.lanes[0].values]")
        holds(now == wanted and b.run("return at('primary0').value") == "0.5", f"undone to {now}, expected {wanted}")
    holds(all_pixels(b) == after, "undo of a turn gives another picture")


def keep_brings_back(b, work):
    removed = pixels(b, "result")
    b.click("#keep")
    said = click(b, 0, -40)
    holds(said == 2 and b.run(MARKS)[1][4] == 1 and pixels(b, "result") != removed, f"keep brings nothing back: {said}")
    as_run_draws_it(b, HOST_SIM, work, "two marks")
    for _ in range(6):  # layer by layer, until all is there again
        said = click(b, 0, -40)
        if not isinstance(said, int):
            break
    holds(said == "Nothing was cut at this place.", f"keep where nothing is cut any more: {said}")
    said = click(b, 40, 40, "full")
    holds(isinstance(said, int), f"keep on the full volume: {said}")
    b.click("#write")
    b.wait_for("at('written').textContent", "the written results")
    with open(os.path.join(work, "out", "0001", "depthmap.mha"), "rb") as a, \
         open(os.path.join(run_of(b, HOST_SIM, work, "--write", "depthmap"), "depthmap.mha"), "rb") as other:
        holds(a.read() == other.read(), "the command line's depthmap is another one")


def painting(b):
    b.click("#clear-marks")
    b.click("#remove")
    b.run("at('radius').value = 3; at('radius').dispatchEvent(new Event('input'))", then="no marks")
    b.drag(RESULT, (-60, -20), (60, 20), steps=30)
    b.wait_for("!brush.asked && !brush.queue.length && state.marks.length > 3", "a painted line")
    settle(b, "painted")
    places = b.run("return lastFigures.marks")
    apart = [math.dist(a[:2], c[:2]) / a[2] for a, c in zip(places, places[1:], strict=False)]
    holds(all(abs(one - 0.5) < 0.01 for one in apart), f"a stroke's marks are {apart} radii apart")
    b.click("#undo", then="undo of a stroke")
    holds(b.run(MARKS) == [], "a stroke is more than one step")
    b.click("#redo", then="the stroke again")
    holds(b.run("return state.camera.yaw") == 0, "the brush turns")
    b.run("document.querySelector('.screen[data-view=result]').focus()")
    before = len(places)
    b.keys(RESULT, ENTER)
    b.wait_for(f"!brush.asked && (state.marks.length > {before} || !at('notice').hidden)", "a mark by the keyboard")
    settle(b, "by keys")
    b.run("state.marks = Array(brush.most).fill(state.marks[0]); changed(false)", then="all marks")
    said = click(b, 0, 60)
    holds("All 256 marks" in str(said) and len(b.run(MARKS)) == 256, f"a mark more than there may be: {said}")


def an_address_has_marks(b, console):
    b.run("state.marks.length = 2; changed(false)", then="two marks")
    b.wait_for("addressDue === 0", "the address")
    hash_, marks, shown = b.run("return location.hash"), b.run(MARKS), pixels(b, "result")
    b.open("about:blank")
    b.open(console.address + hash_, then="the address")
    holds(b.run(MARKS) == marks and pixels(b, "result") == shown, f"opened with {b.run(MARKS)}")
    choose(b, "source", "scene D01", then="another volume")
    holds(b.run(MARKS) == [] and "--remove" not in b.run("return at('line').value"), "marks of another volume")
    b.click("#undo", then="the volume before")
    holds(b.run(MARKS) == marks and b.run("return at('source').value") == "scene M03", "undo does not bring the volume back")
    b.click("#clear-marks", then="no marks")


def by_touch(b):
    width(b, 390, 844)
    b.run("at('brush-bar').scrollIntoView({ block: 'center' })")
    b.click("#remove")
    before = pixels(b, "result")
    b.run("at('radius').value = 5; canvases.result.screen.scrollIntoView({ block: 'center' })")
    x, y = b.run("const r = canvases.result.screen.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]")

    def touch(kind, *points):
        b.devtools("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x + px, "y": y + py, "id": i} for i, (px, py) in enumerate(points)])

    holds(b.run("return getComputedStyle(canvases.result.screen).touchAction") == "none", "a finger that paints scrolls the page")
    touch("touchStart", (0, -50))
    touch("touchEnd")
    b.wait_for("state.marks.length === 1", "a mark by touch")
    settle(b, "by touch")
    holds(pixels(b, "result") != before, "a finger changes nothing")
    touch("touchStart", (-30, 60))
    for step in range(1, 13):
        touch("touchMove", (-30 + 8 * step, 60 + step))
    touch("touchEnd")
    b.wait_for("!brush.asked && !brush.queue.length && state.marks.length > 2", "a line by touch")
    settle(b, "painted by touch")
    marks = b.run("return [state.marks.length, state.camera.zoom]")
    touch("touchStart", (-30, 0), (30, 0))
    for step in range(1, 6):
        touch("touchMove", (-30 - 6 * step, 0), (30 + 6 * step, 0))
    touch("touchEnd")
    settle(b, "two fingers")
    now = b.run("return [state.marks.length, state.camera.zoom]")
    holds(now[0] == marks[0] and now[1] > 1.5 * marks[1], f"two fingers: from {marks} to {now}")
    wide = b.run("return document.documentElement.scrollWidth")
    holds(wide <= 390, f"{wide} pixels wide")


def with_two_results(b):
    width(b, 1440, 1000)
    b.run("resetCamera(); clearMarks()")
    choose(b, "compare", "side", then="side by side")
    before = [pixels(b, view) for view in ("result", "other")]
    said = click(b, 0, -40, "other")
    holds(said == 1, f"a mark on the second result: {said}")
    holds(all(pixels(b, view) != was for view, was in zip(("result", "other"), before)), "a mark is not for both results")
    holds(all("--remove" in line for line in b.run("return at('line').value").split("\n")), "a command line without the mark")
    choose(b, "compare", "off", then="one result")
    b.keys("body", "e")
    holds(b.run("return brush.on") == "" and b.run("return document.querySelector('.marks circle')") is None, "e does not put the brush down")
    yaw = b.run("return state.camera.yaw")
    b.drag(RESULT, (0, 0), (30, 0), then="a drag")
    holds(b.run("return state.camera.yaw") != yaw, "a drag does not turn without the brush")


def the_lamp(b, work):
    width(b, 1280)
    before, lamp, camera, marks = pixels(b, "result"), *b.run("return [state.render.light, state.camera, state.marks]")
    b.click("#lamp")
    b.drag(RESULT, (0, 0), (50, 25), pause=300)  # it rests on its way, and is one step all the same
    settle(b, "the lamp, dragged")
    now = b.run("return [state.render.light, state.camera, state.marks]")
    holds(abs(now[0][0] - lamp[0] - 20) < 1e-6 and abs(now[0][1] - lamp[1] + 10) < 1e-6, f"the lamp moved from {lamp} to {now[0]}")
    holds(now[1:] == [camera, marks] and pixels(b, "result") != before, "the lamp turns, marks, or lights nothing")
    as_run_draws_it(b, HOST_SIM, work, "another light")
    b.click("#undo", then="undo of the lamp")
    holds(pixels(b, "result") == before, "undo gives another light")


def drag_side(b, view, place, to):
    """From a place of a slice to another one, both 0 .. 1 right and down."""
    wide = b.run("const s = canvases[arguments[0]].screen; s.scrollIntoView({ block: 'center' }); return s.clientWidth", view)
    b.drag(f".screen[data-view={view}]", *([round((x - 0.5) * wide) for x in at] for at in (place, to)), then="a side of the box, dragged")


def the_box(b, console, work):
    b.run("resetCamera(); clearMarks(); state.cross = [0.5, 0.5, 0.5]", then="no box")
    before = all_pixels(b)
    b.keys("body", "b", then="the box")
    holds(b.run("return state.box") == [0] * 3 + [118.8] * 3, f"a new box is {b.run('return state.box')}")
    holds(all_pixels(b) == before, "a box as large as the volume takes something away")
    low, high = b.run("return [state.box[0], lastFigures.source.window_mm]")
    drag_side(b, "across", (low / high, 0.4), (0.4, 0.4))
    box = b.run("return state.box")
    holds(abs(box[0] - 0.4 * high) < 0.02 * high and b.run("return state.cross") == [0.5, 0.5, 0.5], f"dragged to {box} of {high} mm")
    for view in ("full", "deep"):
        left, right = b.run("""const c = canvases[arguments[0]].canvas, d = c.getContext('2d').getImageData(0, 0, 512, 512).data;
            const low = 512 * state.box[0] / lastFigures.source.window_mm - 10, most = [0, 0];
            for (let i = 0; i < 512 * 512; i++) { const k = i % 512 < low ? 0 : 1; most[k] = Math.max(most[k], d[4 * i]); } return most;""", view)
        holds(left < 40 < 120 < right, f"{view}: beside the box it is {left} bright, in it {right}")
    as_run_draws_it(b, HOST_SIM, work, "a box")
    b.run("turn(30, 20); roll(10)", then="turned")
    corners = b.run("return Object.keys(AXES).map((view) => boxIn(view))")
    holds(all(3 <= len(one) <= 10 and all(-1e-9 <= x <= 1 + 1e-9 for place in one for x in place) for one in corners), f"the turned box is {corners}")
    as_run_draws_it(b, HOST_SIM, work, "a turned box")
    b.wait_for("addressDue === 0", "the address")
    hash_, shown = b.run("return location.hash"), pixels(b, "result")
    b.open("about:blank")
    b.open(console.address + hash_, then="the address")
    holds(b.run("return state.box") == box and pixels(b, "result") == shown, "the address opens another box")
    b.run("resetCamera()", then="from the front")
    field = "#box-bar input[data-side='3']"
    b.run(f"const f = document.querySelector(\"{field}\"); f.value = 60; f.dispatchEvent(new Event('change'))", then="a side by its field")
    holds(b.run("return state.box[3]") == 60, "the field does nothing")
    b.click("#write")
    b.wait_for("at('written').textContent", "the written results")
    with open(os.path.join(work, "out", "0002", "mask.mha"), "rb") as a, \
         open(os.path.join(run_of(b, HOST_SIM, work, "--write", "mask"), "mask.mha"), "rb") as other:
        mask = a.read()
        holds(mask == other.read(), "the command line's mask is another one")
    voxels, first = zlib.decompress(mask[mask.index(b"LOCAL\n") + 6:]), math.ceil(box[0] / 1.25)
    holds(max(voxels[i + 96 * j] for i in range(first) for j in range(96 * 96)) == 0 < max(voxels), "what lies beside the box is not removed")
    with open(os.path.join(work, "out", "0002", "surface.ply"), "rb") as file:
        head, _, data = file.read().partition(b"end_header\n")
    vertices = list(struct.iter_unpack("<3f", data[:12 * int(head.split(b"element vertex ")[1].split()[0])]))
    ends, now = [(min(axis), max(axis)) for axis in zip(*vertices, strict=True)], b.run("return state.box")
    holds(len(vertices) > 500 and all(now[k] - 0.7 < low and high < now[k + 3] + 0.7 for k, (low, high) in enumerate(ends)), f"{len(vertices)} vertices of {ends} in {now}")
    choose(b, "third", "depthmap", then="the depthmap of a box")
    grey = b.run("""const d = canvases.depthmap.canvas.getContext('2d').getImageData(0, 0, 512, 512).data;
        return [(state.box[0] - 5), (state.box[0] + state.box[3]) / 2].map((mm) => { const i = 4 * (256 * 512 + Math.round(512 * mm / lastFigures.source.window_mm));
            return Math.max(d[i], d[i + 1], d[i + 2]) - Math.min(d[i], d[i + 1], d[i + 2]); });""")
    holds(grey[0] < 20 < grey[1], f"beside the box the depthmap is hatched, in it coloured: {grey}")
    choose(b, "third", "truth")
    for size in ((390, 844), (1440, 1000)):
        width(b, *size)
        holds(b.run("return document.documentElement.scrollWidth") <= size[0], f"wider than {size[0]} pixels")
    b.click("#box", then="no box again")
    holds(b.run("return state.box") == [] and all_pixels(b) == before, "what was before the box does not come back")
    b.click("#undo", then="undo of its end")
    holds(b.run("return state.box[3]") == 60 and pixels(b, "result") != before["result"], "undo does not bring the box back")
    b.click("#box", then="no box at last")


def nothing_jumps(b):
    for size in ((390, 844), (1280, 900), (1440, 1000)):
        width(b, *size)
        tops = []
        for brush in ("remove", "keep", "lamp", "lamp"):  # the last one lays the lamp down again
            tops.append(b.run("return document.querySelector('#rendered').getBoundingClientRect().top + scrollY"))
            b.run(f"at('{brush}').click()")  # on a phone a fixed bar may lie over it
        holds(len(set(tops)) == 1, f"at {size[0]} pixels the pictures jump when a brush is taken: {tops}")


def main():
    with a_page(BUILD, "#scene=M03,96,1&layout=all", []) as (b, console, work):
        settle(b, "the first frame")
        before, after = a_mark_removes_what_is_seen(b, work)
        undo_and_redo(b, before, after)
        keep_brings_back(b, work)
        painting(b)
        an_address_has_marks(b, console)
        by_touch(b)
        with_two_results(b)
        the_lamp(b, work)
        the_box(b, console, work)
        nothing_jumps(b)
    print("ok")


main()
