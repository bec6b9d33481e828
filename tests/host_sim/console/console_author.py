# SPDX-License-Identifier: MIT
"""The console as the author of a plugin uses it: beside SmartVis, and through the builds of a day."""

import os
import shutil
import sys
import tempfile

from console_client import holds
from console_look import a_page, choose, pixels, settle

BUILD = sys.argv[1]
BUILT = os.path.join(BUILD, "tests", "plugins")


def build(library, name):
    """As a linker does: a new file of the same name. The libraries of plane.c have one id."""
    shutil.copyfile(os.path.join(BUILT, name), library + ".new")
    os.replace(library + ".new", library)


def names(b):
    return b.run("return [...at('plugin0').options].map(o => o.textContent)")


def beside_ours(b):
    """The author's plugin is shown first; SmartVis is in the list, and one button away."""
    settle(b, "the first frame")
    listed = names(b)
    holds(len(listed) == 2 and "plane" in listed[0].lower() and listed[1].startswith("SmartVis"), f"plugins: {listed}")
    holds(b.run("return lastFigures.of.plugins") == [0] and not b.run("return at('ours').hidden"), "the author's plugin is not first, or alone")
    b.run("setValue(0, lanes[0].params.find(p => p.primary), 60, false)", then="the author's setting")
    mine = pixels(b, "result")
    b.click("#ours", then="both")
    holds(b.run("return [lastFigures.of.plugins, look.compare, at('ours').getAttribute('aria-pressed')]") == [[0, 1], "side", "true"], "SmartVis is not beside it")
    named = b.run("return [...document.querySelectorAll('figcaption')].map(c => c.textContent)")
    holds({"Result 1", "Result 2"} <= set(named) and "A plane (across)" in named, f"results have the names of planes: {named}")
    holds(pixels(b, "result") == mine != pixels(b, "other"), "both have one picture, or the author's has changed")
    holds(b.run("return lastFigures.lanes[1].clipped"), "SmartVis does not clip")
    b.click("#ours", then="one again")
    holds(b.run("return [lastFigures.of.plugins, at('ours').getAttribute('aria-pressed')]") == [[0], "false"], "the same button does not end it")
    choose(b, "plugin0", "1", then="SmartVis alone")
    holds(b.run("return at('ours').hidden"), "SmartVis is offered beside itself")
    choose(b, "plugin0", "0", then="the author's plugin again")
    b.run("setValue(0, lanes[0].params.find(p => p.primary), 60, false)", then="its setting again")
    holds(pixels(b, "result") == mine, "the author's plugin comes back with another picture")


def a_build(b, library, name, what):
    """Another build while the page rests: the picture of the frame that comes by itself."""
    frame = b.run("return document.body.dataset.frame")
    build(library, name)
    b.wait_for(f"document.body.dataset.frame !== '{frame}'", what)
    settle(b, what)
    return pixels(b, "result")


def builds_of_a_day(b, library):
    key = b.run("return lanes[0].params.find(p => p.primary).key")
    whole = pixels(b, "result")
    other = a_build(b, library, "partial.so", "a build that leaves half of it out")
    holds(other != whole, "a new build makes no new picture")
    holds(b.run("return [state.lanes[0].values[arguments[0]], lastFigures.lanes[0].failed]", key) == [60, False], "the setting is lost")
    a_build(b, library, "create_fails.so", "a build that fails")
    holds("create" in b.run("return at('outcome').textContent") and "cannot be loaded" in names(b)[0], "a build that fails is not told")
    again = a_build(b, library, "plane.so", "a build that works again")
    holds(again == whole and "cannot" not in names(b)[0], f"the first build again makes {again}, not {whole}")


def a_lost_parameter(b, library):
    """A build whose primary parameter has another key: its old value is left out, and nothing is refused."""
    key = b.run("return lanes[0].params.find(p => p.primary).key")
    with open(os.path.join(BUILT, "plane.so"), "rb") as file:
        whole = file.read()
    old = b"\0" + key.encode() + b"\0"
    holds(whole.count(old) == 1, f"the key '{key}' stands {whole.count(old)} times in the library")
    b.run("delete document.body.dataset.refused")
    frame = b.run("return document.body.dataset.frame")
    with open(library + ".new", "wb") as file:
        file.write(whole.replace(old, b"\0" + b"x" * len(key) + b"\0"))
    os.replace(library + ".new", library)
    b.wait_for(f"document.body.dataset.frame !== '{frame}'", "a build with another parameter")
    b.wait_for(f"!('{key}' in state.lanes[0].values)", "the lost value")
    settle(b, "without the lost value")
    holds(b.run("return lanes[0].params.find(p => p.primary).key") == "x" * len(key), "the page does not know the new parameter")
    holds(b.run("return [lastFigures.lanes[0].clipped, document.body.dataset.refused || '']") == [True, ""], "the build is not shown")


def a_first_build(b, library):
    """What was no library when the console started becomes one."""
    settle(b, "the first frame")
    holds("cannot be loaded" in names(b)[0] and not b.run("return lastFigures.lanes[0].clipped"), "a text is a plugin")
    a_build(b, library, "plane.so", "the first build")
    holds("cannot" not in names(b)[0] and not b.run("return lastFigures.lanes[0].failed"), "the first build is not shown")


def main():
    with tempfile.TemporaryDirectory() as folder:
        library = os.path.join(folder, "early.so")
        shutil.copyfile(__file__, library)
        with a_page(BUILD, "#scene=D01,64,1", ["--plugin", library]) as (b, _console, _work):
            a_first_build(b, library)
        library = os.path.join(folder, "mine.so")
        build(library, "plane.so")
        with a_page(BUILD, "#scene=D01,64,1", ["--plugin", library]) as (b, _console, _work):
            beside_ours(b)
            builds_of_a_day(b, library)
            a_lost_parameter(b, library)
    print("ok")


main()
