# SPDX-License-Identifier: MIT
"""console_shots.py BUILD_FOLDER OUT: the console's page at 390, 1280 and 1920 pixels, light and dark, as PNG files to look
at, and the small picture of the README."""

import base64
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "console"))
from console_client import Console  # noqa: E402
from webdriver import Browser  # noqa: E402

SHOWN = "#scene=D01,192,1&camera=14,-8,1.1&a=0,method:7&b=0&cross=0.5,0.45,0.5"
SETTLED = "document.body.dataset.serial === String(state.serial) && document.body.dataset.draft === 'false'"


def shoot(address, out, width, height, theme):
    with tempfile.TemporaryDirectory() as work:
        browser = Browser(work, (width, height), theme)
        try:
            browser.open(address + SHOWN)
            browser.wait_for(SETTLED, "the picture", 120)
            browser.screenshot(os.path.join(out, f"console_{width}_{theme}.png"), full=width < 600)
            if (width, theme) == (1280, "dark"):
                clip = {"x": 0, "y": 0, "width": width, "height": 740, "scale": 0.65}
                shot = browser.devtools("Page.captureScreenshot", format="jpeg", quality=82, clip=clip)["data"]
                with open(os.path.join(out, "console.jpg"), "wb") as file:
                    file.write(base64.b64decode(shot))
        finally:
            browser.close()


def main():
    build, out = sys.argv[1:3]
    os.makedirs(out, exist_ok=True)
    console = Console(build, ["--stay"])
    try:
        for width, height in ((390, 844), (1280, 900), (1920, 1080)):
            for theme in ("light", "dark"):
                shoot(console.address, out, width, height, theme)
        console.interrupt()
        console.wait(60)
    finally:
        console.end()


main()
