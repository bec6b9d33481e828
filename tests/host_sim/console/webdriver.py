# SPDX-License-Identifier: MIT
"""A browser by its own driver: as much of the WebDriver protocol as the console's tests need, with Python's library alone."""

import base64
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
KEYS = {"left": "\ue012", "up": "\ue013", "right": "\ue014", "down": "\ue015", "home": "\ue011", "tab": "\ue004", "delete": "\ue017", "escape": "\ue00c"}
# Seconds in which what a test waits for has come, kernels compiled before included; instrumented code takes longer.
PATIENCE = 400  # s: kernels that no cache has, on a machine with much else to do; CTest ends a test after 1500


def programs():
    """(browser, driver). Where one of them is missing the test ends, as skipped."""
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    driver = shutil.which("chromedriver")
    if not browser or not driver:
        print("skipped: no Chromium, or no chromedriver")
        sys.exit(77)
    return browser, driver


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Browser:
    """A headless browser with one window of `size` pixels; "dark" or "light"."""

    def __init__(self, folder, size=(1280, 900), theme="light"):
        browser, driver = programs()
        self.port = free_port()
        self.log = open(os.path.join(folder, "chromedriver.log"), "wb")
        self.driver = subprocess.Popen([driver, f"--port={self.port}"], stdout=self.log, stderr=self.log)
        arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--force-device-scale-factor=1",
                     f"--window-size={size[0]},{size[1]}", f"--user-data-dir={folder}/profile"]
        if theme == "dark":
            arguments.append("--force-dark-mode")
        options = {"binary": browser, "args": arguments,
                   "prefs": {"download.default_directory": folder}}
        wanted = {"capabilities": {"alwaysMatch": {"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}}
        self.session = ""
        self.session = "/session/" + self._first(wanted)["sessionId"]
        self.devtools("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
        self.devtools("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=False)

    def _first(self, wanted):
        for _ in range(100):
            try:
                return self.call("POST", "/session", wanted)
            except (urllib.error.URLError, ConnectionError):
                time.sleep(0.1)
        raise RuntimeError("the browser's driver does not answer")

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{self.session}{path}", data, method=method,
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(f"{path}: {error.read().decode()[:600]}") from None

    def devtools(self, command, **parameters):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def open(self, address):
        self.call("POST", "/url", {"url": address})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait_for(self, script, what, seconds=PATIENCE):
        """Until the expression is true; its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.run("return " + script)
            if value:
                return value
            time.sleep(0.05)
        notice = self.run("return document.getElementById('notice')?.textContent || ''")
        raise AssertionError(f"{what}: did not come within {seconds} s; notice: '{notice}'")

    def element(self, css):
        return self.call("POST", "/element", {"using": "css selector", "value": css})[ELEMENT]

    def keys(self, css, text):
        self.call("POST", f"/element/{self.element(css)}/value", {"text": text})

    def press(self, *keys):
        """Keys that are held together, for whatever has the focus."""
        actions = [{"type": "keyDown", "value": key} for key in keys] + [{"type": "keyUp", "value": key} for key in reversed(keys)]
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": actions}]})

    def click(self, css):
        self.run("document.querySelector(arguments[0]).scrollIntoView({ block: 'nearest' })", css)  # what is covered is not scrolled to
        self.call("POST", f"/element/{self.element(css)}/click", {})

    def drag(self, css, start, end, steps=6, pause=30):
        """The left button from one place to another, in pixels from the element's middle."""
        origin = {ELEMENT: self.element(css)}
        moves = [{"type": "pointerMove", "origin": origin, "x": round(start[0]), "y": round(start[1]), "duration": 0},
                 {"type": "pointerDown", "button": 0}]
        for i in range(1, steps + 1):
            x, y = (round(start[k] + (end[k] - start[k]) * i / steps) for k in (0, 1))
            moves.append({"type": "pointerMove", "origin": origin, "x": x, "y": y, "duration": pause})
        moves.append({"type": "pointerUp", "button": 0})
        self.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"},
                                                    "actions": moves}]})
        self.call("DELETE", "/actions")

    def wheel(self, css, delta):
        origin = {ELEMENT: self.element(css)}
        self.call("POST", "/actions", {"actions": [{"type": "wheel", "id": "wheel", "actions": [
            {"type": "scroll", "x": 0, "y": 0, "deltaX": 0, "deltaY": delta, "origin": origin, "duration": 0}]}]})

    def console(self):
        """Lines of the page's console since the last call."""
        return [one["level"] + " " + one["message"] for one in self.call("POST", "/se/log", {"type": "browser"})]

    def screenshot(self, path, full=False):
        shot = self.devtools("Page.captureScreenshot", captureBeyondViewport=full)["data"]
        with open(path, "wb") as out:
            out.write(base64.b64decode(shot))

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.wait()
            self.log.close()
