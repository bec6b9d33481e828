# SPDX-License-Identifier: MIT
"""page_looks.py PAGE...: whether pages of files can be read: contrast of text and controls, in light, dark and print, and nothing wider
than the screen. The console's tests use the same functions on a page that is open."""

import os
import sys
import tempfile

from webdriver import KEYS, Browser

# WCAG 2.2, 1.4.3 and 1.4.11: text against its ground, and the edge of what is filled in against what is around it. Text over pictures has a
# shadow of its own, and what cannot be used needs no contrast.
FAINT = """
    const luminance = (c) => [0.2126, 0.7152, 0.0722].reduce((sum, weight, k) => {
        const x = c[k] / 255;
        return sum + weight * (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
    }, 0);
    const ratio = (a, b) => { const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y); return (high + 0.05) / (low + 0.05); };
    const colour = (text) => { const c = text.match(/[\\d.]+/g).map(Number); return c.length > 3 ? c : [...c, 1]; };
    const over = (a, b) => [0, 1, 2].map((k) => a[k] * a[3] + b[k] * (1 - a[3])).concat(1);
    const page = matchMedia('(prefers-color-scheme: dark)').matches && getComputedStyle(document.documentElement).colorScheme.includes('dark') ? [18, 18, 18, 1] : [255, 255, 255, 1];
    const ground = (e) => { const own = e ? colour(getComputedStyle(e).backgroundColor) : page; return own[3] >= 1 || !e ? own : over(own, ground(e.parentElement)); };
    const faint = [];
    const note = (e, kind, is, wanted) => { if (is < wanted) faint.push(kind + ' ' + is.toFixed(2) + ' of ' + (e.id || e.getAttribute('class') || e.tagName) + ': ' + e.textContent.trim().slice(0, 40)); };
    let seen = 0;
    for (const e of document.querySelectorAll('body *')) {
        if (!e.checkVisibility({ visibilityProperty: true }) || e.disabled || e.closest('.screen, option, script, style')) continue;
        const style = getComputedStyle(e), size = parseFloat(style.fontSize);
        if ([...e.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim())) {
            seen++;
            const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
            note(e, 'text', ratio(over(colour(e instanceof SVGElement ? style.fill : style.color), ground(e)), ground(e)), large ? 3 : 4.5);
        }
        if (e.matches('select, textarea, input[type=number]') && parseFloat(style.borderTopWidth) > 0)
            note(e, 'edge', ratio(over(colour(style.borderTopColor), ground(e.parentElement)), ground(e.parentElement)), 3);
    }
    return [seen, faint];"""

# What a press of the tab key should lead to, one after the other: all that can be used, as the page reads.
IN_ORDER = """
    return [...document.querySelectorAll('a[href], button, input, select, textarea, summary, [tabindex="0"]')]
        .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.disabled).map((e) => e.outerHTML.slice(0, 60));"""


def contrast(b, what):
    """Every text and every field that is shown stands out from what is around it."""
    seen, faint = b.run(FAINT)
    assert seen > 10 and faint == [], f"{what}: of {seen} texts {len(faint)} are faint: {faint[:8]}"


def tab_order(b, what):
    """The tab key reaches all that can be used, in the order of the page, and shows where it is."""
    wanted = b.run(IN_ORDER)
    b.run("document.activeElement.blur(); scrollTo(0, 0)")
    for i, expected in enumerate(wanted):
        b.press(KEYS["tab"])
        found, outlined = b.run("const e = document.activeElement; return [e.outerHTML.slice(0, 60), parseFloat(getComputedStyle(e).outlineWidth) > 0]")
        assert found == expected, f"{what}: {i + 1} tabs lead to {found}, expected {expected}"
        assert outlined, f"{what}: {found} does not show that it has the focus"


def looks(b, what):
    for medium in ("", "print"):
        for theme in ("light", "dark"):
            b.devtools("Emulation.setEmulatedMedia", media=medium, features=[{"name": "prefers-color-scheme", "value": theme}])
            contrast(b, f"{what}, {theme} {medium}")
            ground = b.run("return getComputedStyle(document.body).backgroundColor")
            light = all(int(part) > 200 for part in ground.strip("rgb()").split(","))
            assert light == (theme == "light" or medium == "print"), f"{what}, {theme} {medium}: the ground is {ground}"
    b.devtools("Emulation.setEmulatedMedia", media="", features=[{"name": "prefers-color-scheme", "value": "light"}])


def whole_on_paper(b, what):
    """What scrolls on a screen is not cut off on A4 with margins of 1 cm."""
    b.devtools("Emulation.setDeviceMetricsOverride", width=718, height=1047, deviceScaleFactor=1, mobile=False)
    b.devtools("Emulation.setEmulatedMedia", media="print")
    cut = b.run("return [...document.querySelectorAll('pre, .wide, body')].filter((e) => e.scrollWidth > e.clientWidth + 1)"
                ".map((e) => e.tagName + ' ' + e.className + ', ' + e.scrollWidth + ' of ' + e.clientWidth + ': ' + e.textContent.slice(0, 60))")
    assert cut == [], f"{what}, printed: {len(cut)} cut off: {cut[:4]}"
    b.devtools("Emulation.setEmulatedMedia", media="")
    b.devtools("Emulation.clearDeviceMetricsOverride")


def main():
    for path in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as work:
            b = Browser(work)
            try:
                b.open("file://" + os.path.abspath(path))
                b.run("document.querySelectorAll('details').forEach((fold) => { fold.open = true; })")
                looks(b, path)
                whole_on_paper(b, path)
                tab_order(b, path)
                lines = b.console()
                assert lines == [], f"{path}: {lines}"
            finally:
                b.close()
    print("ok")


if __name__ == "__main__":
    main()
