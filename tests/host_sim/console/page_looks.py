# SPDX-License-Identifier: MIT
"""page_looks.py PAGE...: whether pages of files can be read: a picture on the first screen, nothing wider than the screen when all is
opened, labels that a screen shows, a slider that shows another picture; contrast of text and controls, in light, dark and print. The
console's tests use the same functions on a page that is open."""

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

OPEN_ALL = "document.querySelectorAll('details').forEach((fold) => { fold.open = true; })"

# What a press of the tab key should lead to, one after the other: all that can be used, as the page reads.
IN_ORDER = """
    return [...document.querySelectorAll('a[href], button, input, select, textarea, summary, [tabindex="0"]')]
        .filter((e) => e.checkVisibility({ visibilityProperty: true }) && !e.disabled).map((e) => e.outerHTML.slice(0, 60));"""

# How long the page is as a reader first sees it, and where its first picture ends.
FIRST_SEEN = "return [document.documentElement.scrollHeight, document.querySelector('img').getBoundingClientRect().bottom + scrollY]"

# What scrolls sideways, and what a screen shows too small: the smallest letters of pictures have 17 pixels, and on a phone pictures are zoomed.
UNFIT = """
    const phone = innerWidth < 500, all = (css) => [...document.querySelectorAll(css)];
    const size = (e) => { const box = e.getBoundingClientRect(); return Math.min(box.width, box.height); };
    return all('html, body *').filter((e) => e.clientWidth > 0 && e.scrollWidth > e.clientWidth && !e.closest('svg'))
        .concat(all('.row.wide img').filter((i) => !phone && 17 * i.getBoundingClientRect().width / i.naturalWidth < 8))
        .concat(all('svg.plot text').filter((t) => size(t) > 0 && size(t) < (phone ? 8 : 11) && t.textContent.length > 1))
        .map((e) => e.outerHTML.slice(0, 80));"""

# Both ends of a slider, as a user turns it: one picture each, and another.
SLID = """
    const slider = document.querySelector('.slider'), input = slider?.querySelector('input');
    const shown = (value) => {
        input.value = value;
        input.dispatchEvent(new Event('input'));
        const seen = [...slider.querySelectorAll('figure')].filter((f) => f.offsetHeight > 0);
        return seen.length === 1 ? seen[0].querySelector('img') : null;
    };
    if (!slider) return null;
    const [first, last] = [shown(0), shown(input.max)];
    input.focus();
    return [first.src !== last.src, last.naturalWidth > 0, input.getAttribute('aria-valuetext'), document.activeElement === input];"""


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


def on_screens(b, what):
    for width in (390, 1280):
        b.devtools("Emulation.setDeviceMetricsOverride", width=width, height=844, deviceScaleFactor=1, mobile=False)
        height, end = b.run(FIRST_SEEN)
        assert height <= 15000 and end <= 844, f"{what}, {width} wide: {height} pixels long, its first picture ends at {end}"
        b.run(OPEN_ALL)
        assert b.run(UNFIT) == [], f"{what}, {width} wide: {b.run(UNFIT)[:8]}"
        assert b.run(SLID) in (None, [True, True, "q = 1.5", True]), f"{what}, {width} wide: the slider: {b.run(SLID)}"
        b.run(OPEN_ALL.replace("true", "false"))
    b.devtools("Emulation.clearDeviceMetricsOverride")


def main():
    for path in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as work:
            b = Browser(work)
            try:
                b.open("file://" + os.path.abspath(path))
                on_screens(b, path)
                b.open("file://" + os.path.abspath(path))
                b.run(OPEN_ALL)
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
