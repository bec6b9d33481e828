# SPDX-License-Identifier: MIT
"""The console's page for who holds the probe: how the planes lie in the patient, and what can be done with a picture."""

import base64
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import zlib

from console_client import Console, holds
from console_look import PATIENCE, RESULT, SUM, a_page, choose, pixels, png_pixels, settle, snapshot, until
from webdriver import KEYS, Browser

BUILD = sys.argv[1]
ENTER = "\ue007"


def make_scans(folder):
    """A scene as a file that does not say how the patient lies, and as one that does: x to the front, y to the left, z to the
    feet, and away from the probe. These axes are left-handed, so pictures have x reversed."""
    subprocess.run([os.path.join(BUILD, "host_sim"), "scenes", "D01", "--size", "64", "--export", "--out", folder], check=True,
                   stdout=subprocess.DEVNULL, timeout=900)
    with open(os.path.join(folder, "D01_full.mha"), "rb") as file:
        unsaid = file.read()
    matrix = b"TransformMatrix = 1 0 0 0 1 0 0 0 1"
    letters = b"AnatomicalOrientation = ???"
    holds(matrix in unsaid and letters in unsaid, "another header")
    with open(os.path.join(folder, "lying.mha"), "wb") as file:
        file.write(unsaid.replace(matrix, b"TransformMatrix = 0 -1 0 1 0 0 0 0 -1")
                   .replace(letters, b"AnatomicalOrientation = PRS\nUltrasoundImageOrientation = MAF"))


def directions(b, view):
    """Caption, letters at the left, right, upper and lower side, and where the probe is said to be."""
    return b.run("""const one = canvases[arguments[0]];
        return [one.caption.textContent, ['left', 'right', 'up', 'down'].map((side) => one.ends[side].innerText).join(' '),
            one.probe && !one.probe.hidden ? one.probe.dataset.side + ' ' + one.probe.innerText.replace('➤', '') : '']""", view)


def planes_lie_in_the_patient(b):
    """Names, letters at the sides and the probe's side, straight from the probe, then turned; nothing that the file does not say."""
    straight = {"across": ["A plane (across), sagittal", "A P H F", "up probe"], "along": ["B plane (along), coronal", "H F R L", "left probe"],
                "deep": ["C plane (at depth), transverse", "A P R L", "off probe in front"], "result": ["Result", "A P R L", ""]}
    # A quarter turn to the right: what was right is depth now, and what was before the eye is at the right. Then half of that.
    turned = {"across": ["A plane (across), sagittal", "F H A P", "right probe"], "along": ["B plane (along), transverse", "A P R L", "off probe in front"],
              "deep": ["C plane (at depth), coronal", "F H R L", "right probe"], "result": ["Result", "F H R L", ""]}
    between = ["C plane (at depth), oblique", "AF PH R L", "off probe in front"]
    settle(b, "the first frame")
    holds(b.run("return [at('third').value, at('third').disabled]") == ["depthmap", True], "a file's ground truth is offered")
    for yaw, expected in ((0, straight), (90, turned)):
        b.run("state.camera.yaw = arguments[0]; changed(false)", yaw, then=f"yaw {yaw}")
        found = {view: directions(b, view) for view in expected}
        holds(found == expected, f"yaw {yaw}: {found}")
    b.run("state.camera.yaw = 44; changed(false)", then="between")
    found = directions(b, "deep")
    holds(found == between, f"yaw 44: {found}")
    b.run("resetCamera()")
    choose(b, "source", "file 0 D01_full.mha", then="a file that does not say how the patient lies")
    found = {view: directions(b, view) for view in straight}
    unsaid = {view: [name.split(",")[0], "   ", probe] for view, (name, _, probe) in straight.items()}  # the fan shows the probe
    holds(found == unsaid, f"not said: {found}")


def captions_can_be_read(b):
    """Which plane a slice shows is never cut off, nor that it is mirrored, however narrow it stands."""
    settle(b, "the first frame")
    b.run("flip(['deep'])")
    for wide, high in ((390, 844), (768, 1024), (1280, 800), (1440, 900)):
        b.devtools("Emulation.setDeviceMetricsOverride", width=wide, height=high, deviceScaleFactor=1, mobile=False)
        b.run("", then=f"{wide} pixels")
        for view, plane in (("across", "sagittal"), ("along", "coronal"), ("deep", "Mirrored: C")):
            seen, room, needed, full = b.run("const c = canvases[arguments[0]].caption; return [c.innerText, c.clientWidth, c.scrollWidth, c.title]", view)
            holds(plane in seen and (needed <= room or seen.startswith(plane)), f"{wide} pixels: of '{full}' {room} of {needed} are seen: '{seen}'")
    b.run("flip(['deep'])")
    b.devtools("Emulation.setDeviceMetricsOverride", width=1280, height=900, deviceScaleFactor=1, mobile=False)
    b.run("", then="as before")


def distances(b):
    """Two clicks, a drag and the keyboard; millimetres stay when the picture zooms, and go with the tissue."""
    wide = b.run("return canvases.across.screen.getBoundingClientRect().width")
    mm = b.run("return lastFigures.source.window_mm")
    across = ".screen[data-view=across]"
    cross = b.run("return state.cross")
    b.click("#measure")
    for x, y in ((-30, -40), (60, 30)):
        b.drag(across, (x, y), (x, y))
    expected = math.hypot(90, 70) * mm / wide
    said = b.run("return [canvases.across.labels.textContent, at('brushed').textContent, state.cross]")
    holds(abs(float(said[0].split()[0]) - expected) < 0.06 and said[0].endswith(" mm"), f"{expected} mm are {said}")
    holds(said[1].split(" ± ")[0] == "A plane (across): " + said[0] and said[2] == cross, f"it is said as {said}")
    b.run("zoom(2)", then="zoomed")
    holds(b.run("return canvases.across.labels.textContent") == said[0], "zooming changes a distance")
    ends = b.run("return [...canvases.across.lines.querySelectorAll('circle')].map(c => Number(c.getAttribute('cx')))")
    holds(abs((ends[1] - ends[0]) * wide - 180) < 2, f"the points do not zoom with the picture: {ends}")
    b.run("resetCamera()", then="unzoomed")
    b.drag(across, (0, 0), (0, 45))
    b.drag(across, (40, 0), (0, 0))
    expected = 45 * mm / wide
    said = b.run("return canvases.across.labels.lastChild.textContent")
    holds(abs(float(said.split()[0]) - expected) < 0.06, f"dragged points are {said} apart, not {expected}")
    for move in ("turn(5, 0)", "roll(5)"):
        b.run("resetCamera(); " + move, then=move)
        holds(b.run("return canvases.across.labels.textContent + canvases.across.lines.childElementCount") == "0", f"{move}: points stay when the tissue goes")
    b.run("resetCamera(); canvases.deep.screen.focus()", then="straight")
    holds(b.run("return canvases.across.labels.childElementCount") == 2, "they do not come back with the tissue")
    b.keys(".screen[data-view=deep]", ENTER + KEYS["right"] * 5 + ENTER, then="by keys")
    said = b.run("return canvases.deep.labels.textContent")
    holds(abs(float(said.split()[0]) - 0.1 * mm) < 0.06, f"five steps by keys are {said}, not {0.1 * mm}")
    b.run("document.activeElement.blur()")
    kinds = []
    for _ in range(5):
        kinds.append(b.run("return measured.on"))
        b.keys("body", "m")
    holds(kinds == ["distance", "angle", "ellipse", "trace", "text"], f"m leads from one to the next: {kinds}")
    holds(b.run("return [measured.on, at('measure').getAttribute('aria-pressed')]") == ["", "false"], "it still measures")
    b.drag(across, (0, 0), (20, 20), then="the crosshair")
    holds(b.run("return state.cross[0]") > 0.5, "the crosshair does not move any more")


def several_distances_are_kept(b):
    """What was measured before stays in a list, from which one can go, and stands in the words for a report."""
    kept = b.run("return [...document.querySelectorAll('#measured li')].map(li => li.firstChild.textContent.trim())")
    holds(len(kept) == 3 and kept[0].startswith("A plane (across): ") and kept[2].startswith("C plane (at depth): "), f"kept are {kept}")
    b.click("#measured li:nth-child(2) button")
    words = b.run("return at('report').value")
    holds(kept[0] in words and kept[1] not in words and kept[2] in words and "D01_full.mha" in words and "not a medical device" in words, words)


def angles_and_areas(b):
    """As they are by hand: an angle, an ellipse, an outline that is drawn; each with how far it may be off. What is begun goes by Escape,
    what is there by Delete."""
    wide, mm, voxel = b.run("return [canvases.across.screen.getBoundingClientRect().width, lastFigures.source.window_mm, lastFigures.source.voxel_mm]")
    across, pixel, begun = ".screen[data-view=across]", mm / wide, b.run("return measured.made.length")

    def points(*places):
        for place in places:
            b.drag(across, place, place)

    def numbers():
        return [float(word) for word in re.findall(r"[\d.]+(?= (?:mm|cm²|±)|°|$)|(?<=± )[\d.]+", b.run("return measurements().pop()"))]

    b.click("#measure")
    choose(b, "measure-of", "angle")
    points((40, 0), (0, 0), (0, -30))
    degrees, doubt = numbers()
    off = max(voxel, pixel)
    holds(degrees == 90 and abs(doubt - math.degrees(off / (40 * pixel) + off / (30 * pixel))) < 1, f"a right angle is {degrees} ± {doubt}")
    choose(b, "measure-of", "ellipse")
    points((-40, 10), (40, 10), (0, 35))
    area, doubt, around, _ = numbers()
    ring = math.pi * (3 * 65 - math.sqrt((3 * 40 + 25) * (40 + 3 * 25))) * pixel  # Ramanujan's
    holds(abs(area - math.pi * 40 * 25 * pixel ** 2 / 100) < 0.02 and abs(around - ring) < 0.3, f"an ellipse of {area} cm² and {around} mm")
    holds(abs(doubt - ring * off / 200) < 0.1, f"its area is said to be off by {doubt}")
    choose(b, "measure-of", "trace")
    hand = [(x, -20) for x in range(-30, 31, 5)] + [(30, y) for y in range(-20, 21, 5)] + [(x, 20) for x in range(30, -31, -5)] + [(-30, y) for y in range(20, -20, -5)]
    b.run("""const r = canvases.across.screen.getBoundingClientRect();
        arguments[0].forEach(([x, y], i) => setPoint('across', 0.5 + x / r.width, 0.5 + y / r.height, i === 0));""", hand)
    area, _, around, _ = numbers()
    holds(abs(area - 60 * 40 * pixel ** 2 / 100) < 0.02 and abs(around - 200 * pixel) < 0.1, f"an outline of {area} cm² and {around} mm")
    choose(b, "measure-of", "distance")
    points((0, 0))
    drawn = "return [measured.made.length, canvases.across.lines.querySelectorAll('circle').length, measured.on]"
    b.run("document.activeElement.blur()")
    before = b.run(drawn)
    b.press(KEYS["escape"])
    after = b.run(drawn)
    holds(after == [before[0] - 1, before[1] - 1, "distance"], f"Escape makes of {before} {after}")
    for left in (2, 1, 0):
        b.press(KEYS["delete"])
        holds(b.run("return measured.made.length") == begun + left, f"Delete leaves {b.run(drawn)}")
    b.press(KEYS["escape"])
    holds(b.run("return [measured.on, at('measure-bar').hidden]") == ["", True], "Escape does not leave the tool")


def saved_pictures_show_what_is_measured(b):
    """A line of a distance is in the picture that is saved of its slice, and in no other."""
    found = b.run("""const green = (image) => { const g = new OffscreenCanvas(image.width, image.width).getContext('2d'); g.drawImage(image, 0, 0);
            const d = g.getImageData(0, 0, image.width, image.width).data; let count = 0;
            for (let i = 0; i < d.length; i += 4) count += d[i] === 0x7f && d[i + 1] === 0xd6 && d[i + 2] === 0xa0; return count; };
        return Promise.all(['across', 'along'].map((view) => new Promise((done) => canvases[view].canvas.toBlob(done))
            .then((blob) => captioned(blob, [], view)).then(createImageBitmap).then(green)))""")
    holds(found[0] > 100 and found[1] == 0, f"green in the saved slices: {found}")


def words_on_a_picture(b):
    """On slices and on the result, where they turn away with what they were written on."""
    b.click("#measure")
    choose(b, "measure-of", "text")
    b.drag(RESULT, (10, 10), (10, 10))
    holds(b.run("return [measured.made.filter((one) => one.kind === 'text').length, document.activeElement.id]") == [0, "words"], "words without words")
    b.keys("#words", "left hand")
    camera = b.run("return state.camera")
    for css in (RESULT, ".screen[data-view=deep]"):
        b.drag(css, (-20, 10), (10, 10))
    said = "return ['result', 'deep'].map((view) => canvases[view].labels.textContent)"
    holds("Result: left hand" in b.run("return at('report').value"), "a report tells words with the next frame only")
    holds(b.run(said)[0] == "left hand" and b.run(said)[1].endswith("left hand") and b.run("return state.camera") == camera, f"written: {b.run(said)}")
    b.run("turn(5, 0)", then="turned")
    holds(b.run(said) == ["", ""], f"written on what has turned away: {b.run(said)}")
    b.run("resetCamera()", then="straight")
    holds("Result: left hand" in b.run("return at('report').value"), "a report does not tell the words")
    b.run("measure('')")


def slices_turn_and_mirror(b):
    """Flipped and turned by quarters, a slice has its letters, its crosshair and its measurements at the tissue that they belong to."""
    letters = {"": "A P H F", "r": "F H A P", "ri": "H F A P", "rir": "P A H F"}
    choose(b, "source", "file 0 lying.mha", then="a file that says how the patient lies")
    b.run("canvases.across.screen.focus(); state.cross = [0.7, 0.5, 0.4]; placeCross(); changed(false)", then="a crosshair")
    b.run("measure('distance'); setPoint('across', 0.2, 0.5, true); setPoint('across', 0.4, 0.6, true); measure('')")
    before = b.run("return canvases.across.labels.textContent")
    done = ""
    for key, expected in zip(["", *"rir"], letters.values(), strict=True):
        if key:
            b.keys(".screen[data-view=across]", key)
        done += key
        holds(directions(b, "across")[1] == expected, f"'{done}': {directions(b, 'across')}, expected {expected}")
    holds(directions(b, "across")[0] == "Mirrored: A plane (across), sagittal" and directions(b, "across")[2] == "up probe", f"turned and mirrored: {directions(b, 'across')}")
    holds(b.run("return [look.turned.across, look.turned.deep, canvases.across.canvas.style.transform]") == [4, 0, "rotate(0deg) scale(-1, 1)"], "it stands otherwise")
    cross = b.run("return [canvases.across.down.style.left, canvases.across.right.style.top].map(parseFloat)")
    holds(abs(cross[0] - 30) < 1e-6 and abs(cross[1] - 40) < 1e-6, f"the crosshair of 0.7, 0.4 stands at {cross}")
    wide = b.run("return canvases.across.screen.getBoundingClientRect().width")
    b.drag(".screen[data-view=across]", (0.1 * wide, 0), (0.1 * wide, 0), then="a click right of the middle")
    holds(abs(b.run("return state.cross[0]") - 0.4) < 0.02, f"a click on a mirrored slice goes to {b.run('return state.cross')}")
    holds(b.run("return canvases.across.labels.textContent") == before and before, "a measured distance changes")
    b.wait_for("location.hash.includes('turned=4')", "the address")
    thin = [pixels(b, view) for view in ("across", "result")]
    b.run("setThick(10)", then="a thick slice")
    thick = [pixels(b, view) for view in ("across", "result")]
    holds(thick[0] != thin[0] and thick[1] == thin[1] and directions(b, "across")[0].endswith(", 10 mm thick"), f"10 mm: {thin}, {thick}, {directions(b, 'across')}")
    b.run("setThick(0)", then="a thin slice")
    holds(pixels(b, "across") == thin[0], "a slice stays thick")
    saved = b.run("""const { canvas } = canvases.across, row = (c) => { const g = new OffscreenCanvas(512, 512).getContext('2d'); g.drawImage(c, 0, 0); return [...g.getImageData(0, 300, 512, 1).data].filter((_, i) => i % 4 === 0); };
        return new Promise((done) => canvas.toBlob(done)).then((blob) => captioned(blob, [], 'across')).then(createImageBitmap).then((image) => [row(canvas), row(image)])""")
    far = sum(abs(a - b) > 8 for a, b in zip(saved[0][::-1], saved[1], strict=True))
    holds("A plane (across), mirrored, " in b.run("return wordsOf('across', state).join()"), "a caption does not say that its slice is mirrored")
    holds(far < 60 and saved[0] != saved[0][::-1], f"a saved slice is not mirrored: {far} pixels differ")
    for _ in range(2):
        b.run("document.activeElement.blur()")
        b.click("#flip")
    holds(b.run("return look.turned") == {"across": 4, "along": 0, "deep": 0}, "both flips of all do not end where they began")
    b.run("flip(['across']); state.cross = [0.5, 0.5, 0.5]; placeCross()")
    choose(b, "source", "file 0 D01_full.mha", then="the other file")


def names_its_version(b, path, what):
    """A PNG whose chunks are whole, and which says version and commit once."""
    with open(path, "rb") as file:
        data, texts, at = file.read(), [], 8
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body, crc = data[at + 8:at + 8 + length], struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0]
        holds(zlib.crc32(kind + body) == crc, f"{what}: the sum of {kind} is wrong")
        texts += [body] if kind == b"tEXt" else []
        at += 12 + length
    version = subprocess.run([os.path.join(BUILD, "host_sim"), "--version"], capture_output=True, text=True, check=True).stdout.split()[1].rstrip(",")
    holds(texts == [b"Software\0SmartVis " + version.encode()], f"{what}: its texts are {texts}")
    holds(f"SmartVis {version}, for research" in b.run("return wordsOf('result', state).join('; ')"), f"a caption without {version}")


def a_captioned_picture(b, work):
    """The picture as it is, and below it words and a scale."""
    path, found = os.path.join(work, "smartvis_D01_full.mha_result.png"), []
    for caption in (False, True):
        b.run("at('snapshot-view').value = 'result'; at('with-caption').checked = arguments[0]; delete document.body.dataset.snapshot", caption)
        b.click("#snapshot")
        size = int(b.wait_for("document.body.dataset.snapshot", "the snapshot"))
        until(lambda size=size: os.path.exists(path) and os.path.getsize(path) == size, PATIENCE, "the snapshot's file")
        with open(path, "rb") as file:
            width, height = struct.unpack(">2I", file.read(24)[16:])
        found.append((width, height, png_pixels(b, path, width), png_pixels(b, path)))
        names_its_version(b, path, "with a caption" if caption else "as it was drawn")
        os.remove(path)
    (width, height, picture, _), (wide, high, upper, whole) = found
    holds((width, picture) == (wide, upper) and high > height + 60 and whole != upper, f"captions: {found}")


# So many pixels near the four sides of a picture that saving it with a caption turns white.
SIDES = """
    const { canvas } = canvases[arguments[0]], bits = (c) => {
        const g = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
        g.drawImage(c, 0, 0);
        return g.getImageData(0, 0, canvas.width, canvas.height).data;
    };
    return new Promise((done) => canvas.toBlob(done)).then((blob) => captioned(blob, ['words'], arguments[0])).then((blob) => createImageBitmap(blob)).then((image) => {
        const line = image.width / 16, half = image.width / 2;
        const [a, b] = [bits(canvas), bits(image)], middles = [[line / 2, half], [image.width - line / 2, half], [half, line / 2], [half, image.width - line / 2]];
        return middles.map(([x, y]) => {
            let count = 0;
            for (let i = 0; i < a.length; i += 4) {
                const u = (i / 4) % image.width, v = Math.floor(i / 4 / image.width);
                if (Math.abs(u - x) < line / 2 && Math.abs(v - y) < line / 2) count += b[i] + b[i + 1] + b[i + 2] > 740 && a[i] + a[i + 1] + a[i + 2] < 600;
            }
            return count;
        });
    });"""


def saved_pictures_say_how_they_lie(b):
    """With what is ticked from the start: letters where the file says how the patient lies, else none; and only pictures that there are."""
    holds(b.run("return at('with-caption').checked"), "a picture is saved without its caption")
    offered = b.run("return [...at('snapshot-view').options].map((o) => o.value)")
    holds("truth" not in offered and "other" not in offered and "result" in offered, f"offered are {offered}")
    holds(b.run(SIDES, "result") == [0] * 4, "letters that the file does not say")
    choose(b, "source", "file 0 lying.mha", then="a file that says how the patient lies")
    for view in ("result", "across"):
        found = b.run(SIDES, view)
        holds(all(10 < count < 400 for count in found), f"the letters of {view} have {found} pixels")
    choose(b, "source", "file 0 D01_full.mha", then="the other file")


def one_volume_stands_still(b):
    b.run("document.activeElement.blur()")
    for key in " f":
        b.keys("body", key)
        holds(b.run("return [state.play.on, at('player').hidden]") == [False, True], f"'{key}' plays the one volume")


def presets(b):
    """Either sets all that it names, from wherever one is."""
    b.run("setValue(0, lanes[0].params.find(p => p.key === 'method'), 1, false)", then="another method")
    found = []
    for i in (1, 2):
        b.click(f".presets button:nth-of-type({i})", then="a preset")
        found.append((b.run("return state.lanes[0].values"), b.run("return [...document.querySelectorAll('.presets button[aria-pressed]')].map(b => b.ariaPressed)"),
                      pixels(b, "result")))
    holds([one[:2] for one in found] == [({"q": 0.75}, ["true", "false"]), ({"q": 0.25, "unsure": 1}, ["false", "true"])], f"presets: {found}")
    holds(found[0][2] != found[1][2], "both presets give one picture")


def own_presets(b, console):
    """A preset under a name comes back on another page, whatever its port, and is refused by another plugin."""
    b.keys(".presets input", "mine")
    b.run("setValue(0, lanes[0].params.find(p => p.primary), 0.4, false)")
    b.click(".presets button[title^=These]")
    other = Console(BUILD, ["--plugin", os.path.join(BUILD, "tests", "plugins", "plane.so")])
    try:
        b.open(other.address + "#scene=D01,64,1", then="the plane")
        b.click(".presets button[title^=Saved]")
        said = b.run("return at('notice').textContent")
        holds("\"mine\" was saved with" in said and "does not fit" in said and b.run("return state.lanes[0].values") == {}, f"another plugin's preset: {said}")
        choose(b, "plugin0", "1", then="SmartVis")
        b.click(".presets button[title^=Saved]", then="the preset")
        holds(b.run("return state.lanes[0].values") == {"q": 0.4, "unsure": 1}, "the preset is another one")
        b.click(".presets button[title^='The preset']")
        holds(b.run("return [document.querySelectorAll('.presets button').length, ownPresets().own]") == [4, {}], "the preset is not deleted")
    finally:
        b.open(console.address + "#scene=D01,64,3", then="three volumes")
        other.interrupt()
        other.wait(60)
        other.end()


def a_cine(b, work):
    """Cancelled, it leaves the camera as it was; of the volumes, its pictures are those of the volumes."""
    b.run("at('with-caption').checked = false; at('snapshot-view').value = 'result'; delete document.body.dataset.snapshot")
    b.click("#cine")
    b.wait_for("at('written').textContent === 'Cine: picture 3 of 36'", "a third picture")
    b.click("#cine")
    b.wait_for("at('cine').textContent === 'Save a cine'", "the end of a cancelled cine")
    settle(b, "the first camera")
    holds(b.run("return [state.camera.yaw, at('written').textContent, document.body.dataset.snapshot || '']") == [0, "Cine: cancelled", ""], "it is not cancelled")
    b.run("at('cine-of').value = 'volumes'")
    b.click("#cine")
    size = int(b.wait_for("document.body.dataset.snapshot", "a cine"))
    path, seen = os.path.join(work, "smartvis_D01_result_cine.png"), []
    until(lambda: os.path.exists(path) and os.path.getsize(path) == size, PATIENCE, "its file")
    names_its_version(b, path, "a cine")
    with open(path, "rb") as file:
        data = base64.b64encode(file.read()).decode()
    for i in range(3):
        b.run("state.play.index = arguments[0]; changed(false)", i, then=f"volume {i}")
        b.run("delete document.body.dataset.snapshot")
        seen.append(snapshot(b, work))
    found = b.run(SUM + """const decoder = new ImageDecoder({ data: Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0)), type: 'image/png' });
        const sumOf = ({ image }) => { const c = new OffscreenCanvas(image.codedWidth, image.codedHeight); c.getContext('2d').drawImage(image, 0, 0); return sum(c); };
        return decoder.completed.then(() => Promise.all([0, 1, 2].map((frameIndex) => decoder.decode({ frameIndex }).then(sumOf))))
            .then((sums) => [decoder.tracks.selectedTrack.frameCount, sums]);""", data)
    holds(found == [3, seen] and len(set(seen)) == 3, f"{found}, and one by one {seen}")


def a_film(b, console, work):
    """A video of the volumes begins with the first one and ends with the last; where the browser has no recorder it is not offered."""
    offered = "offerCines(); return [[...at('cine-as').options].map((o) => o.value), at('cine-as').hidden]"
    kinds = b.run(offered)[0]
    without = b.run("const all = window.MediaRecorder; window.MediaRecorder = undefined; try { return (() => { " + offered + " })(); } finally { window.MediaRecorder = all; offerCines(); }")
    holds(kinds[0] == "png" and "webm" in kinds and without == [["png"], True], f"offered are {kinds}, without a recorder {without}")
    small = "const small = (one) => { const g = new OffscreenCanvas(32, 32).getContext('2d'); g.drawImage(one, 0, 0, 32, 32); return [...g.getImageData(0, 0, 32, 32).data]; };"
    last = b.run(small + "at('cine-as').value = 'webm'; at('with-caption').checked = false; delete document.body.dataset.snapshot; return small(canvases.result.canvas)")
    b.click("#cine")
    size, path = int(b.wait_for("document.body.dataset.snapshot", "a film")), os.path.join(work, "smartvis_D01_result_cine.webm")
    until(lambda: os.path.exists(path) and os.path.getsize(path) == size, PATIENCE, "its file")
    b.wait_for("at('cine').textContent === 'Save a cine'", "the end of a film")
    b.run("at('cine-as').value = 'png'", then="the page at rest")
    with open(path, "rb") as file:
        data = base64.b64encode(file.read()).decode()
    Browser.open(b, "about:blank")  # where no policy forbids to play it
    b.run("""const video = document.createElement('video'); Object.assign(video, { muted: true, autoplay: true });
        video.src = URL.createObjectURL(new Blob([Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0))])); document.body.append(video);""", data)
    b.wait_for("document.querySelector('video')?.ended", "the end of a film", 60)
    wide, seconds, shown = b.run(small + "const video = document.querySelector('video'); return [video.videoWidth, video.duration, small(video)]")
    far = sum(abs(x - y) for x, y in zip(last, shown, strict=True)) / len(last)
    holds(wide == 512 and 0.1 < seconds < 1 and far < 6, f"a film {wide} wide, of {seconds} s, whose end is {far} levels beside the last volume")
    b.open(console.address + "#scene=D01,64,3", then="the page again")


def drop(b, *paths):
    data = {"items": [], "files": list(paths), "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        b.devtools("Input.dispatchDragEvent", type=kind, x=200, y=300, data=data)


def dropped_files(b, scans):
    """A volume that is dropped is copied and opened; whatever else is dropped, the page stays and says why not."""
    scan = os.path.join(scans, "D01_full.mha")
    for i, path in enumerate(("D01_full.mha", "2_D01_full.mha")):
        drop(b, scan)
        b.wait_for(f"state.source.path === '{path}'", "a dropped file")
        settle(b, "a dropped file")
        holds(b.run("return [lastFigures.of.source.folder, lastFigures.source.voxels, at('source').value]") == [1, [64, 64, 64], f"file 1 {path}"], f"{i}: another volume")
    for paths, words in (((__file__,), "only .mha and .vol can be dropped"), ((scan, scan), "Drop one file"), ((os.path.join(scans, "bad.mha"),), "bad.mha:1: ")):
        drop(b, *paths)
        b.wait_for(f"at('notice').textContent.includes('{words}')", words)
    holds(b.run("return [location.pathname, at('notice').textContent.includes('host_sim_console')]") == ["/", False], "the page has gone, or tells where copies lie")


def taken_away(b, work):
    b.click("#write")
    b.wait_for("at('written').textContent", "what was written")
    folder = os.path.join(work, "out", "0001")
    with open(os.path.join(folder, "surface.ply"), "rb") as file:
        vertices = int(next(line for line in file if line.startswith(b"element vertex")).split()[2])
    holds(vertices > 1000 and os.path.getsize(os.path.join(folder, "clipped.mha")) > 10000, f"{vertices} vertices, {os.listdir(folder)}")


def main():
    with tempfile.TemporaryDirectory() as scans:
        make_scans(scans)
        copies = os.environ["TMPDIR"] = os.path.join(scans, ".copies")
        os.mkdir(copies)
        with open(os.path.join(scans, "bad.mha"), "w") as file:
            file.write("no volume")
        with a_page(BUILD, "#file=0:lying.mha", [scans]) as (b, console, work):
            captions_can_be_read(b)
            planes_lie_in_the_patient(b)
            distances(b)
            several_distances_are_kept(b)
            angles_and_areas(b)
            saved_pictures_show_what_is_measured(b)
            words_on_a_picture(b)
            saved_pictures_say_how_they_lie(b)
            slices_turn_and_mirror(b)
            a_captioned_picture(b, work)
            one_volume_stands_still(b)
            presets(b)
            taken_away(b, work)
            own_presets(b, console)
            a_cine(b, work)
            a_film(b, console, work)
            dropped_files(b, scans)
            folder = [name for name in os.listdir(copies) if name.startswith("host_sim_console_")]
            holds(len(folder) == 1 and len(os.listdir(os.path.join(copies, folder[0]))) == 3, f"copies: {folder}")
        holds(not [name for name in os.listdir(copies) if name.startswith("host_sim_console_")], "the copies outlive the console")
    print("ok")


main()
