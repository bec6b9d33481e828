# SPDX-License-Identifier: MIT
"""page_shots.py BUILD_FOLDER OUT [PAGE...]: the console's page and pages of files, as demo and report write them, at 390, 768, 1280,
1440 and 1920 pixels, light, dark and printed, as PNG files and side by side in OUT/index.html; and the picture of docs/console.md."""

import base64
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "host_sim", "console"))
from console_client import Console  # noqa: E402
from webdriver import Browser  # noqa: E402

SHOWN = "#scene=D01,192,1&camera=14,-8,1.1&cross=0.5,0.45,0.5"
SETTLED = "typeof state === 'undefined' || (document.body.dataset.serial === String(state.serial) && document.body.dataset.draft === 'false')"
WIDTHS = ((390, 844), (768, 1024), (1280, 900), (1440, 900), (1920, 1080))
PAPER = (794, 1123)  # A4


def shoot(name, address, out, size, theme, medium=""):
    with tempfile.TemporaryDirectory() as work:
        browser = Browser(work, size, theme)
        try:
            if medium:
                browser.devtools("Emulation.setEmulatedMedia", media=medium, features=[{"name": "prefers-color-scheme", "value": theme}])
            browser.open(address)
            browser.wait_for(SETTLED, "the picture", 120)
            shot = f"{name}_{medium or size[0]}_{theme}.png"
            browser.screenshot(os.path.join(out, shot), full=True)
            lines = browser.console()
            if lines:
                sys.exit(f"{shot}: {lines}")
            if (name, size[0], theme) == ("console", 1280, "dark"):
                clip = {"x": 0, "y": 0, "width": 1280, "height": 740, "scale": 0.65}
                data = browser.devtools("Page.captureScreenshot", format="jpeg", quality=82, clip=clip)["data"]
                with open(os.path.join(out, "console.jpg"), "wb") as file:
                    file.write(base64.b64decode(data))
            return shot
        finally:
            browser.close()


def main():
    build, out, pages = sys.argv[1], sys.argv[2], sys.argv[3:]
    os.makedirs(out, exist_ok=True)
    console = Console(build, ["--stay"])
    shots = []
    try:
        addresses = {"console": console.address + SHOWN}
        for page in pages:
            addresses[os.path.basename(os.path.dirname(os.path.abspath(page)))] = "file://" + os.path.abspath(page)
        for name, address in addresses.items():
            for theme in ("light", "dark"):
                shots += [shoot(name, address, out, size, theme) for size in WIDTHS]
                shots.append(shoot(name, address, out, PAPER, theme, "print"))
        console.interrupt()
        console.wait(60)
    finally:
        console.end()
    with open(os.path.join(out, "index.html"), "w", encoding="utf-8") as file:
        file.write("<!doctype html><title>Pages</title>\n")
        file.writelines(f'<a href="{shot}"><img src="{shot}" alt="{shot}" title="{shot}" width="300"></a>\n' for shot in shots)


main()
