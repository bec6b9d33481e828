# SPDX-License-Identifier: MIT
"""What the console's page is given by others: cookies, which pages of all ports share, and addresses. Whatever they hold, the page works,
leaves out what is none, and says so. A browser without a clipboard, too."""

import json
import os
import sys
import urllib.parse

from console_client import holds
from console_look import a_page, settle

BUILD = sys.argv[1]

# Presets of another shape: none of them is one, and the last holds one beside them.
COOKIES = ["", "x", "%", "%E0%A4%A", "null", "7", "true", '"text"', "[]", "[1,2]", '{"a":null}', '{"a":7}', '{"a":[]}', '{"a":["x"]}', '{"a":["x",null]}', '{"a":["x",7]}',
           '{"a":["x",{"q":"0.5"}]}', '{"a":["x",{"q":null}]}', '{"a":["x",{"Q q":1}]}', '{"a":[7,{"q":1}]}', '{"a":["x",{"q":[1]}]}', '{"":["x",{}]}', '{"%s":["x",{}]}' % ("n" * 31),
           '{"__proto__":7}', '{"a":["x",{"q":1},3]}', '{"right":["x",{"q":0.5}],"wrong":[]}']

# Addresses, and what of them is left out.
ADDRESSES = [("scene=D01,64,1", ""), ("scene=NONE", "scene"), ("scene=D01,1e9", "scene"), ("scene=D01,64,x", "scene"), ("camera=1,2,0", "camera"), ("camera=20,10", ""),
             ("camera=,,", "camera"), ("camera=NaN,0", "camera"), ("volume=-1&play=1e9", "volume, play"), ("cross=0.5,2,0.5", "cross"), ("a=200", "a"), ("a=0,q:x", "a"), ("a=0,q", "a"),
             ("a=0,__proto__:1", ""), ("a=0,q:0.25", ""), ("a=1.5", "a"), ("compare=both", "compare"), ("compare=side&b=-1", "b"), ("marks=1,2,3", "marks"), ("marks=1,2,3,0,1", "marks"),
             ("marks=1,2,3,4,5", "marks"), ("marks=;", "marks"), ("box=1,2,3", "box"), ("box=9,9,9,1,1,1", "box"), ("t_low=0.9&t_high=0.1", "t_low, t_high"), ("exposure=0", "exposure"),
             ("light=900,1", "light"), ("look=x&third=y&layout=z&from=w", "from, look, layout, third"), ("wipe=x&gain=-1", "wipe, gain"), ("thick=21&turned=8", "thick, turned"), ("slices=off", "slices"), ("%F0%28=1", "�("),
             ("file=0:none.mha", ""), ("file=77:x", ""), ("a=0,nonesuch:1", ""), ("a=0,q:99", ""), ("box=5000,5000,5000,6000,6000,6000", ""), ("=&&&==", "")]
# Those that only a volume or a plugin can refuse: the page says why, and shows what it can.
REFUSED = ("file=0:none.mha", "file=77:x", "a=0,nonesuch:1", "a=0,q:99", "box=5000,5000,5000,6000,6000,6000")

RANDOM = """
    let seed = arguments[0], wrong = [];
    const next = (n) => { seed = (seed * 1103515245 + 12345) % 2147483648; return Math.floor(seed / 2147483648 * n); };
    const parts = ['null', '{', '}', '[', ']', '"q"', ':', ',', '0.5', '"a"', '1e999', '__proto__', '-1', ';', '0', 'NaN', '%', '&', '=', 'a', 'q', 'camera=', 'a=', 'b=', 'marks=',
        'box=', 'scene=D01', 'light=', 'cross=', 'compare=side', '"x"', '{"p":["x",{"q":0.5}]}', '1,2,3,4,1', ' ', 'é'];
    for (let i = 0; i < arguments[1]; i++) {
        const text = Array.from({ length: 1 + next(12) }, () => parts[next(parts.length)]).join('');
        try {
            document.cookie = 'smartvis_presets=' + encodeURIComponent(text) + '; path=/';
            for (const one of Object.entries(ownPresets().own)) if (!isPreset(one)) wrong.push(text);
            readAddress(link.hello, text);
            const numbers = [...Object.values(state.camera), ...state.cross, ...state.marks.flat(), ...state.box, ...state.lanes.flatMap((l) => [l.plugin, ...Object.values(l.values)])];
            if (!numbers.every(Number.isFinite) || state.marks.length > 256 || state.lanes.some((l) => l.plugin >= plugins.length)) wrong.push(text);
        } catch (error) { wrong.push(text + ': ' + error); }
    }
    document.cookie = 'smartvis_presets=; path=/; max-age=0';
    return wrong.slice(0, 5);"""


def opened(b, address, what):
    b.open("about:blank")
    b.open(address)
    b.wait_for("typeof lastFigures !== 'undefined' && lastFigures", what)
    settle(b, what)
    return b.run("return at('notice').hidden ? '' : at('notice').textContent")


NIGHT = "SV_NIGHT" in os.environ
SOME = slice(None) if NIGHT else slice(None, None, 3)  # each is a page of its own; by day RANDOM stands for the others


def cookies(b, address):
    for text in COOKIES[SOME]:
        value = text if text.startswith("%") else urllib.parse.quote(text)
        b.run("document.cookie = 'smartvis_presets=' + arguments[0] + '; path=/'", value)
        said = opened(b, address + "#scene=D01,64,1", f"the cookie {text}")
        own = b.run("return Object.keys(ownPresets().own)")
        holds("of another shape" in said and own == (["right"] if "right" in text else []), f"the cookie {text}: '{said}', {own}")
        b.keys(".presets input", "new")
        b.click(".presets button[title^=These]")
        kept = b.run("return ownPresets()")
        holds("new" in kept["own"] and not kept["left"], f"after the cookie {text} a preset is kept as {json.dumps(kept)}")
    b.run("document.cookie = 'smartvis_presets=; path=/; max-age=0'")


def addresses(b, address):
    for text, left in ADDRESSES[SOME]:
        said = opened(b, f"{address}#{text}", f"the address {text}")
        if text in REFUSED:
            holds(said and "no setting" not in said, f"{text}: '{said}'")
        else:
            holds(said == (f"The address says what is no setting here: {left}. It is left out." if left else ""), f"{text}: '{said}'")
        holds(b.run("return lastFigures.lanes[0].outcome") == "SV_OK", f"{text}: {b.run('return lastFigures.lanes[0]')}")


def no_clipboard(b):
    """Without one the words are copied in the old way, or marked for the hand."""
    b.run("Object.defineProperty(navigator, 'clipboard', { value: undefined, configurable: true })")
    for copied, said in ((True, "copied"), (False, "It is marked: Ctrl+C copies it.")):
        b.run("const copies = arguments[0]; at('copied').textContent = ''; document.execCommand = () => copies;"
              "getSelection().removeAllRanges(); at('copy').click()", copied)
        b.wait_for("at('copied').textContent", "a word of the copy")
        now, marked, whole = b.run("return [at('copied').textContent, [at('line').selectionStart, at('line').selectionEnd, document.activeElement.id], at('line').value.length]")
        holds(now.endswith(said) and marked == [0, whole, "line"] and whole > 0, f"without a clipboard: '{now}', {marked} of {whole}")


def main():
    with a_page(BUILD, "#scene=D01,64,1", []) as (b, console, _):
        settle(b, "the first frame")
        holds(b.run("return at('notice').hidden"), "a message where nothing is wrong")
        no_clipboard(b)
        addresses(b, console.address)
        cookies(b, console.address)
        for seed in range(5):
            wrong = b.run(RANDOM, 1 + seed, 20000 if NIGHT else 2000)
            holds(wrong == [], f"seed {seed}: {wrong}")
        opened(b, console.address + "#scene=D01,64,1", "the end")
    print("ok")


main()
