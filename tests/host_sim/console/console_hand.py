# SPDX-License-Identifier: MIT
"""What a hand does on the console's page, at four sizes, by mouse and touch, while every message comes and goes: nothing moves under
it, and what it paints, drags and measures lies where it was."""

import itertools
import math
import sys

from console_client import holds
from console_look import a_page, choose, settle

BUILD = sys.argv[1]
ESCAPE = "\ue00c"
SIZES = ((390, 844), (768, 1024), (1280, 800), (1440, 900))
# What each layout shows, and how wide the result is at least at each size.
LAYOUTS = {"quad": (["result", "across", "along", "deep"], (370, 540, 540, 640)),
           "slice": (["result", "across", "along", "deep"], (110, 150, 150, 180)),
           "all": (["full", "result", "truth", "across", "along", "deep"], (370, 230, 270, 320)),
           "single": (["result"], (370, 660, 540, 640)), "dual": (["full", "result"], (370, 360, 410, 490))}
LONG = "A message of many words, which a console has to say about a volume that cannot be read: " * 4

# Where every picture, its control and its tools are on the page.
PLACES = """
    const of = (e) => { const r = e.getBoundingClientRect(); return [r.left + scrollX, r.top + scrollY, r.width, r.height].map((x) => Math.round(x * 10) / 10); };
    return Object.fromEntries([...Object.keys(canvases).map((view) => [view, of(canvases[view].screen)]),
        ...['remove', 'measure', 'primary0'].map((id) => [id, of(at(id))])]);"""

# All that the page may say without being asked, one after the other: what it calls, and what it says then.
SAID = {
    "an error": "notice(arguments[0], false)",
    "what is under way": "takeText({ type: 'busy', text: arguments[0] })",
    "a refusal": "takeText({ type: 'refused', text: arguments[0] })",
    "no message": "notice('', true)",
    "an outcome with its reason": "showFigures({ ...lastFigures, lanes: lastFigures.lanes.map((l) => ({ ...l, clipped: false, doubtful: false, words: arguments[0], why: arguments[0] })) })",
    "a doubtful outcome": "showFigures({ ...lastFigures, lanes: lastFigures.lanes.map((l) => ({ ...l, doubtful: true, words: arguments[0] })) })",
    "a failure": "showFigures({ ...lastFigures, lanes: lastFigures.lanes.map((l) => ({ ...l, clipped: false, failed: true, words: arguments[0] })) })",
    "a doubt about the spacing": "showFigures({ ...lastFigures, source: { ...lastFigures.source, doubt: arguments[0], question: arguments[0] } })",
    "a long name": "showFigures({ ...lastFigures, of: { ...lastFigures.of, source: { folder: 0, path: arguments[0], from: 'probe' } } })",
    "several volumes": "showFigures({ ...lastFigures, source: { ...lastFigures.source, volumes: 9 } })",
    "how the patient lies": "showFigures({ ...lastFigures, source: { ...lastFigures.source, patient: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], probe: [0, 0, -1], truth_cut: true } })",
    "what was written": "showWritten({ of: lastFigures.of, folder: arguments[0], names: [] })",
    "a file without a truth": "state.source = { folder: 0, path: 'x.mha', from: 'probe' }; showChosenSource()",
    "a brush": "chooseBrush('remove')",
    "another brush": "chooseBrush('keep')",
    "no brush": "chooseBrush('keep')",
    "measuring": "measure('distance')",
    "no measuring": "measure('')",
    "the first frame again": "state.source = structuredClone(window.first.of.source); showChosenSource(); showFigures(window.first)",
}


# Those of them that come by themselves while a hand is on a picture, round and round.
COMING = itertools.cycle(list(SAID.values())[:list(SAID).index("a file without a truth")])


def size(b, wide, high):
    b.devtools("Emulation.setDeviceMetricsOverride", width=wide, height=high, deviceScaleFactor=1, mobile=False)
    b.run("scrollTo(0, 0)", then=f"{wide} pixels")


def nothing_moves(b, what):
    """Whatever is said, pictures, their control and the tools stay where they are."""
    b.run("window.first = structuredClone(lastFigures)")
    before = b.run(PLACES)
    for name, script in SAID.items():
        b.run(script, LONG)
        after = b.run(PLACES)
        moved = {key: (before[key], after[key]) for key in before if before[key] != after[key]}
        holds(not moved, f"{what}: {name} moves {moved}")
    holds(b.run("return at('notice').hidden"), f"{what}: a message stays")
    b.run("changed(false)", then="the page itself again")


def no_caption_is_cut(b, what):
    """Whatever is to be said of a slice, in whichever layout."""
    for layout in ("quad", "slice", "all"):
        cut = b.run("""
            setLayout(arguments[0]);
            state.thick = 2.5;
            for (const view in look.turned) look.turned[view] = MIRRORED;
            placeDirections({ ...lastFigures.source, patient: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], probe: [0, 0, -1] });
            const captions = Object.keys(AXES).map((view) => canvases[view].caption), said = captions.map((one) => one.title);
            const cut = captions.filter((one) => one.scrollWidth > one.clientWidth || one.scrollHeight > one.clientHeight || !one.innerText.startsWith("Mirrored: "));
            state.thick = 0;
            for (const view in look.turned) look.turned[view] = 0;
            placeDirections(lastFigures.source);
            cut.push(...captions.filter((one) => one.scrollWidth > one.clientWidth || !one.innerText.includes("plane (")));
            return [cut.length, ...said];""", layout)
        holds(cut[0] == 0 and "Mirrored: C plane (at depth), transverse, 2.5 mm thick" in cut, f"{what}: captions of {layout} are cut: {cut}")
    b.run("setLayout('quad')", then="the quad again")


def a_plane_is_large(b, at, what):
    """That which is chosen, beside the others and the result."""
    b.run("setLayout('slice')", then="a plane large")
    for plane in ("deep", "along", "across"):
        choose(b, "plane", plane, then="another plane")
        widths = b.run("return Object.fromEntries(Object.keys(canvases).map((view) => [view, canvases[view].screen.getBoundingClientRect().width]))")
        large = widths.pop(plane)
        holds(large >= LAYOUTS["quad"][1][at] and large > 2.5 * max(widths.values()) and len(widths) == 3, f"{what}: {plane} is {large} wide, {widths}")
    b.wait_for("location.hash.includes('layout=slice') && !location.hash.includes('plane=')", f"{what}: the usual plane's address")
    holds(b.run("return at('third').checkVisibility()") is False, f"{what}: a third view is offered that is not there")
    b.run("setLayout('quad')", then="the quad again")


def the_result_is_large(b, at, what):
    """Every layout, one key from the next, has the result and the surface position on the screen, and neither covers the other."""
    for layout, (views, widths) in LAYOUTS.items():
        left, top, right, bottom = b.run("""scrollTo(0, 0); const r = canvases.result.screen.getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]""")
        p_left, p_top, p_right, p_bottom = b.run("const r = at('primary').getBoundingClientRect(); return [r.left, r.top, r.right, r.bottom]")
        holds(b.run("return [look.layout, at('layout').value, Object.keys(canvases).sort()]") == [layout, layout, sorted(views)], f"{what}: {layout} shows {b.run('return Object.keys(canvases)')}")
        wide, high = SIZES[at]
        holds(right - left >= widths[at], f"{what}: the result of {layout} is {right - left} wide")
        holds(0 <= left and right <= wide and 0 <= top and bottom <= high, f"{what}: the result of {layout} ends at {right}, {bottom}")
        holds(0 <= p_left and p_right <= wide and 0 <= p_top and p_bottom <= high, f"{what}: the surface position of {layout} ends at {p_bottom}")
        holds(right <= p_left or bottom <= p_top, f"{what}: the surface position of {layout} covers the result")
        b.keys("body", "v", then="another layout")
    holds(b.run("scrollTo(0, 400); return at('primary0').getBoundingClientRect().top") > 0, f"{what}: the surface position is scrolled away")
    b.run("scrollTo(0, 0)")


# What a hand may bring about, one after the other, and what is then looked at for size: whatever can be on the page at some time.
STATES = ("setLayout('all')", "setLayout('dual')", "compare('side')", "compare('wipe')", "compare('off'); setLayout('quad')", "measure('text')", "toggleBox()",
          "measure('distance'); setPoint('across', 0.3, 0.4, true); setPoint('across', 0.7, 0.6, true)", "chooseBrush('keep')", "notice(arguments[0], false)",
          "closeNotice(); measured.made = []; toggleBox(); leaveTool()")

# What is pressed and is less than 24 pixels wide or high (WCAG 2.2, 2.5.8): a control, or the label that it stands in.
SMALL = """
    document.querySelectorAll('details').forEach((fold) => { fold.open = true; });
    const small = [...document.querySelectorAll('button, input, select, summary, textarea')].filter((e) => e.checkVisibility({ visibilityProperty: true })).filter((e) => {
        const [a, b] = [e, e.closest('label') || e].map((one) => one.getBoundingClientRect());
        return Math.max(a.width, e.type === 'checkbox' ? b.width : 0) < 24 || Math.max(a.height, e.type === 'checkbox' ? b.height : 0) < 24;
    }).map((e) => e.outerHTML.slice(0, 80));
    document.querySelectorAll('details').forEach((fold) => { fold.open = false; });
    return small;"""


def all_can_be_pressed(b, wide, what):
    for script in ("", *STATES):
        b.run(script, LONG, then=script)
        holds(b.run(SMALL) == [], f"{what}, {script}: too small to press: {b.run(SMALL)}")
        holds(b.run("return document.documentElement.scrollWidth") <= wide, f"{what}, {script}: the page is wider")
    holds(b.run("return [measured.on, brush.on, look.layout, state.box.length]") == ["", "", "quad", 0], "it is not as it was")


def what_is_not_there_is_not_offered(b):
    """What cannot be used looks so; a key does nothing to slices that are not seen; no lamp where nothing is lit; no preset to delete."""
    look = "const of = (e) => Number(getComputedStyle(e).opacity); return [[...document.querySelectorAll(':disabled')].map(of), of(at('remove'))]"
    disabled, other = b.run(look)
    holds(len(disabled) > 1 and max(disabled) < 0.6 and other == 1, f"what cannot be used looks as {disabled}, the others as {other}")
    b.run("setLayout('single'); document.activeElement.blur()", then="the result alone")
    b.keys("body", "r")
    b.keys("body", "i")
    holds(b.run("return Object.values(look.turned)") == [0, 0, 0], "slices turn that are not seen")
    b.run("setLayout('quad'); chooseBrush('lamp'); state.render.look = 'thesis'; buildRenderer(); changed(false)", then="the thesis' look")
    holds(b.run("return [brush.on, at('lamp').disabled, at('lamp').ariaPressed]") == ["", True, "false"], "a lamp for what is not lit")
    b.run("state.render.look = 'lit'; buildRenderer(); changed(false)", then="the lit look")
    gone = "return document.querySelector('.presets button[title^=\"The preset\"]').disabled"
    found = [b.run(gone)]
    for text in ("constructor", "mine"):
        b.run("keepOwn({ mine: [plugins[0].id, {}] }); const name = document.querySelector('.presets input'); name.value = arguments[0]; name.dispatchEvent(new Event('input'))", text)
        found.append(b.run(gone))
    b.run("keepOwn({})")
    holds(found == [True, True, False], f"a preset that is not there can be deleted: {found}")


def captions_tell_of_their_own_result(b):
    """Of two results each picture names its own surface position and outcome, what shows none names none, and a report names both."""
    b.run("compare('side'); setValue(1, lanes[1].params.find((p) => p.primary), 0.8, false)", then="two results")
    said = {view: b.run("return wordsOf(arguments[0], state).join('; ')", view) for view in ("result", "other", "full", "")}
    words = {view: [word in text for word in ("position 1 0.5", "position 2 0.8", "; 1: ", "; 2: ")] for view, text in said.items()}
    wanted = {"result": [True, False, True, False], "other": [False, True, False, True], "full": [False] * 4, "": [True] * 4}
    holds(words == wanted, f"captions of two results: {said}")
    holds(".;" not in b.run("return at('report').value"), f"a report of {b.run('return at(arguments[0]).value', 'report')}")
    b.run("compare('off')", then="one result")


def escape_leaves_a_tool(b):
    """A message first, then the tool; what was begun with it is nothing."""
    for tool, pressed in (("e", "remove"), ("k", "keep"), ("l", "lamp"), ("m", "measure")):
        b.run("at('notice').hidden || closeNotice(); document.activeElement.blur()")
        b.keys("body", tool)
        b.run("notice('A message', false)")
        for wanted in ("true", "false"):
            holds(b.run("return at(arguments[0]).ariaPressed", pressed) == wanted or wanted == "false", f"{tool}: {pressed} is not taken")
            b.press(ESCAPE)
            holds(b.run("return at('notice').hidden"), "Escape does not close a message")
            holds(b.run("return at(arguments[0]).ariaPressed", pressed) == wanted, f"Escape: {pressed} is not {wanted}")
    for narrow, stays in ((False, "false"), (True, "true")):
        b.run("toggleBox(); if (arguments[0]) setSide(0, 20, false); document.activeElement.blur()", narrow, then="a box")
        b.press(ESCAPE)
        holds(b.run("return at('box').ariaPressed") == stays, f"Escape: a box that {'leaves something out' if narrow else 'was begun'} is not {stays}")
    b.run("toggleBox()", then="no box")
    b.click("#cine")
    b.press(ESCAPE)
    b.wait_for("at('cine').textContent === 'Save a cine' && at('written').textContent === 'Cine: cancelled'", "the end of a cine that Escape cancels")
    settle(b, "the page behind a cine")


def in_a_users_own_colours(b):
    """Where forced colours hold, legends and what is pressed still have theirs."""
    colours = """return [...document.querySelectorAll('.key, .legend .colours')].map((e) => [getComputedStyle(e).backgroundColor, getComputedStyle(e).backgroundImage].join())"""
    before = b.run("viewOf('depthmap'); look.third = 'depthmap'; setLayout('all'); " + colours, then="the depthmap")
    b.devtools("Emulation.setEmulatedMedia", features=[{"name": "forced-colors", "value": "active"}])
    after = b.run(colours)
    pressed = b.run("at('lamp').click(); const c = ['lamp', 'box'].map((id) => getComputedStyle(at(id)).backgroundColor); at('lamp').click(); return c")
    b.devtools("Emulation.setEmulatedMedia", features=[])
    holds(after == before and len(set(after)) > 4, f"in forced colours legends are {after}")
    holds(pressed[0] != pressed[1], f"what is pressed looks as what is not: {pressed}")
    b.run("look.third = 'truth'; setLayout('quad')", then="the quad layout")


class Hand:
    """The mouse at places of the screen, which stay where they are whatever the page does: pixels from where a picture's middle was."""

    def __init__(self, b, view):
        self.b = b
        left, top, wide, _ = b.run("canvases[arguments[0]].screen.scrollIntoView({ block: 'center' }); const r = canvases[arguments[0]].screen.getBoundingClientRect();"
                                   "return [r.left, r.top, r.width, r.height]", view)
        self.wide, self.middle = wide, (left + wide / 2, top + wide / 2)

    def _act(self, kind, x, y, buttons):
        self.b.devtools("Input.dispatchMouseEvent", type=kind, x=self.middle[0] + x, y=self.middle[1] + y, button="left", buttons=buttons, clickCount=1)

    def along(self, *places):
        """Pressed at the first place, lifted at the last; at each of them another message."""
        self._act("mousePressed", *places[0], 1)
        for place in places:
            self._act("mouseMoved", *place, 1)
            self.b.run(next(COMING), LONG)
        self._act("mouseReleased", *places[-1], 0)


class Finger(Hand):
    """The same by touch, where the browser would scroll the page."""

    def _act(self, kind, x, y, buttons):
        points = [{"x": self.middle[0] + x, "y": self.middle[1] + y}] if buttons else []
        self.b.devtools("Input.dispatchTouchEvent", type={"mousePressed": "touchStart", "mouseMoved": "touchMove", "mouseReleased": "touchEnd"}[kind], touchPoints=points)


def outlines(b, hand, step, what):
    """What is drawn around has the area that a hand drew, wherever the drawing begins to go."""
    b.run("measure('trace')")
    hand.along((-4 * step, -3 * step), (-4 * step, 0), (-4 * step, 3 * step), (4 * step, 3 * step), (4 * step, -3 * step))
    area, mm, scrolled = b.run("return [areaOf(measured.made[measured.made.length - 1]), lastFigures.source.window_mm, scrollY]")
    expected = 8 * 6 * (mm / 20) ** 2
    holds(abs(area / expected - 1) < 0.05, f"{what}: an outline of {area} mm², not {expected}, at {scrolled}")


def drags_and_measures(b, kind, what):
    """The crosshair follows a hand, and two points of a slice are as far apart as they were clicked."""
    hand = kind(b, "across")
    step = hand.wide / 20
    hand.along((0, 0), (step, 0), (2 * step, step), (4 * step, 2 * step))
    settle(b, "a dragged crosshair")
    cross = b.run("return state.cross")
    holds(abs(cross[0] - 0.7) < 2 / hand.wide and abs(cross[2] - 0.6) < 2 / hand.wide, f"{what}: dragged to {cross}")
    b.run("measure('distance')")
    for place in ((-3 * step, -4 * step), (6 * step, 4 * step)):
        hand.along(place)
    length, mm = b.run("return [between(...measured.made[measured.made.length - 1].points), lastFigures.source.window_mm]")
    expected = mm * (9 ** 2 + 8 ** 2) ** 0.5 / 20
    holds(abs(length - expected) < 2.5 * mm / hand.wide, f"{what}: measured {length} mm, not {expected}")
    outlines(b, hand, step, what)
    b.run("notice('', true); measured.made = []; measure(''); state.cross = [0.5, 0.5, 0.5]; placeCross(); changed(false)", then="the crosshair in the middle")


def paints(b, kind, what):
    """The marks of a stroke lie on the line that the hand painted, half a radius apart from end to end."""
    b.run("at('remove').click(); setRadius(6)")
    hand, mm = kind(b, "result"), b.run("return lastFigures.source.window_mm")
    step = hand.wide / 20
    hand.along((-4 * step, -3 * step), (-3 * step, -3 * step), (step, -3 * step), (2 * step, -3 * step), (4 * step, -3 * step))
    b.wait_for("!brush.asked && !brush.stroke && state.marks.length > 0", "a painted stroke")
    settle(b, "painted")
    marks = b.run("return lastFigures.marks")
    places = [(u - 0.3) * mm / 3 for u, _, _, _ in marks]  # in steps of half a radius; where nothing is to remove there is none
    off = [math.hypot((place - round(place)) * 3, (v - 0.35) * mm) for place, (_, v, _, _) in zip(places, marks, strict=True)]
    steps = [round(b - a) for a, b in zip(places, places[1:], strict=False)]
    holds(len(marks) > 8 and max(off) < 1 and set(steps) == {1}, f"{what}: {len(marks)} marks beside the line by {off} mm, in steps of {steps}")
    b.run("notice('', true); clearMarks(); chooseBrush('remove')", then="no marks")


def wipes(b, kind, what):
    """The seam of two results in one screen follows a hand, and nothing turns; each is named below it."""
    camera = b.run("setWipe(50); compare('wipe'); return state.camera", then="two results in one screen")
    holds(b.run("return canvases.result.caption.textContent") == "Result 1 | Result 2", f"{what}: a caption of {b.run('return canvases.result.caption.textContent')}")
    hand = kind(b, "result")
    hand.along((4, 0), (hand.wide / 10, 10), (hand.wide / 4, 20))
    wipe = b.run("return [look.wipe, at('wipe').value, state.camera, parseFloat(canvases.other.seam.style.left)]")
    holds(abs(wipe[0] - 75) <= 1 and wipe[1] == str(wipe[0]) and wipe[2] == camera and wipe[3] == wipe[0], f"{what}: the seam is dragged to {wipe}")
    hand.along((0, 0), (hand.wide / 10, 0))
    holds(b.run("return look.wipe") == wipe[0] and b.run("return state.camera") != camera, f"{what}: beside the seam nothing turns")
    b.run("notice('', true); compare('off'); resetCamera()", then="one result")


def main():
    with a_page(BUILD, "#scene=M03,96,1", []) as (b, _, _):
        settle(b, "the first frame")
        for i, (wide, high) in enumerate(SIZES):
            what = f"{wide} x {high}"
            size(b, wide, high)
            the_result_is_large(b, i, what)
            a_plane_is_large(b, i, what)
            no_caption_is_cut(b, what)
            nothing_moves(b, what)
            for kind, touches in ((Hand, False), (Finger, True)):
                b.devtools("Emulation.setTouchEmulationEnabled", enabled=touches, maxTouchPoints=5)
                paints(b, kind, f"{what}, {kind.__name__}")
                drags_and_measures(b, kind, f"{what}, {kind.__name__}")
                wipes(b, kind, f"{what}, {kind.__name__}")
            all_can_be_pressed(b, wide, what)
            b.devtools("Emulation.setTouchEmulationEnabled", enabled=False)
        captions_tell_of_their_own_result(b)
        what_is_not_there_is_not_offered(b)
        escape_leaves_a_tool(b)
        in_a_users_own_colours(b)
    print("ok")


if __name__ == "__main__":
    main()
