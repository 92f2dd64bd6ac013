"""A headless Chromium, driven by chromedriver over HTTP (WebDriver) with the standard library alone."""

from __future__ import annotations

import base64
import json
import os
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from contextlib import contextmanager

import numpy as np
import pytest

from reconstruction.exports.web import WebOptions, write_web

GREY = np.full((4, 8, 3), 0.2158605, np.float16)  # sRGB 128

CHROMIUM = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)
DRIVER = shutil.which("chromedriver")

FLAGS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--enable-unsafe-webgpu",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--hide-scrollbars",
    "--force-device-scale-factor=1",
    "--disable-background-networking",
    "--disable-component-update",
    "--no-first-run",
]


class Browser:
    """One window."""

    def __init__(self, port, address):
        self.port, self.address = port, address

    def _call(self, method, path, content=None):
        body = None if content is None else json.dumps(content).encode()
        request = urllib.request.Request(
            f"{self.address}{path}", body, {"Content-Type": "application/json"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=300) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            value = json.load(error)["value"]
            raise RuntimeError(f"{value['error']}: {value['message'][:2000]}") from None

    def open(self, path, fragment=""):
        self.visit(path.absolute().as_uri() + fragment)

    def visit(self, address):
        self._call("POST", "/url", {"url": address})

    def run(self, script, *values):
        """What a function body returns; promises are waited for."""
        return self._call("POST", "/execute/sync", {"script": script, "args": list(values)})

    def texts(self, selector):
        """Of all elements that a selector finds."""
        script = "return [...document.querySelectorAll(arguments[0])].map((each) => each.textContent)"
        return self.run(script, selector)

    def choose(self, name, value):
        """Fill in a field of the page."""
        script = """const box = document.getElementById(arguments[0]);
        box.value = arguments[1];
        for (const kind of ["input", "change"]) box.dispatchEvent(new Event(kind));"""
        self.run(script, name, value)

    def errors(self):
        """What the page's console has complained of since the last call."""
        return [line["message"] for line in self.log("browser") if line["level"] == "SEVERE"]

    def settled(self):
        self.run("await reflight.settled()")

    def cdp(self, command, **parameters):
        return self._call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def window(self, width, height, touch=False):
        self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=touch)
        self.cdp("Emulation.setTouchEmulationEnabled", enabled=touch, maxTouchPoints=2 if touch else 1)

    def scheme(self, name):
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def screenshot(self):
        return base64.b64decode(self._call("GET", "/screenshot"))

    def pixels(self):
        """The picture alone, shape (h, w, 3), uint8, from above."""
        found = self.run("return reflight.pixels()")
        rgba = np.frombuffer(base64.b64decode(found["rgba"]), np.uint8)
        return rgba.reshape(found["height"], found["width"], 4)[::-1, :, :3]

    def log(self, kind):
        return self._call("POST", "/se/log", {"type": kind})

    def alert(self):
        """Text of a dialog that is open; None where there is none."""
        try:
            return self._call("GET", "/alert/text")
        except RuntimeError as error:
            if "no such alert" in str(error):
                return None
            raise

    def mouse(self, *steps):
        """Pointer actions: ('move', x, y), ('down',), ('up',)."""
        actions = []
        for step in steps:
            if step[0] == "move":
                actions.append({"type": "pointerMove", "duration": 0, "x": step[1], "y": step[2]})
            else:
                actions.append({"type": f"pointer{step[0].capitalize()}", "button": 0})
        pointer = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}
        self._call("POST", "/actions", {"actions": [pointer]})

    def press(self, *keys):
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self._call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": actions}]})


@contextmanager
def chromium(folder):
    """A browser whose profile lies in a folder; the test is skipped where there is none."""
    if CHROMIUM is None or DRIVER is None:
        pytest.skip("chromium or chromedriver is not on this machine (apt-get install chromium chromium-driver)")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    # On the virtual screen that other tests start, WebGL of software has no context.
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment |= dict.fromkeys(("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME"), str(folder))
    driver = subprocess.Popen(
        [DRIVER, f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment
    )
    browser = Browser(port, f"http://127.0.0.1:{port}")
    session = None
    try:
        _wait_until_ready(browser, driver)
        options = {"binary": CHROMIUM, "args": [*FLAGS, f"--user-data-dir={folder}/profile"]}
        wanted = {
            "goog:chromeOptions": options,
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
            "unhandledPromptBehavior": "ignore",
        }
        session = browser._call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
        browser.address += f"/session/{session}"
        yield browser
    finally:
        if session is not None:
            browser._call("DELETE", "")
        driver.terminate()
        driver.wait(30)


def axes_of(camera):
    """Rows right, down, forward, from the contract's definition."""
    h, p = np.radians([camera["heading"], camera["pitch"]])
    forward = np.array([np.cos(p) * np.sin(h), np.cos(p) * np.cos(h), np.sin(p)])
    right = np.array([np.cos(h), -np.sin(h), 0.0])
    return np.stack([right, -np.cross(right, forward), forward])


def pixel(camera, place):
    """Where a place is in the picture."""
    x, y, z = axes_of(camera) @ (np.asarray(place) - camera["eye"])
    return camera["width"] / 2 + camera["focal"] * x / z, camera["height"] / 2 + camera["focal"] * y / z


def middle(scene, element):
    """Of a pane, in the frame of the page."""
    return np.mean(element.corners_enu_m, axis=0) - scene.origin_enu_m


def opened(browser, folder, scene, records=(), size=(900, 500), **options):
    """Write a page and wait until it is shown."""
    page = write_web(scene, folder, records, WebOptions(**{"sky": GREY} | options))
    browser.window(*size)
    browser.log("browser")
    browser.open(page.path)
    browser.settled()
    return page


def _wait_until_ready(browser, driver):
    for _ in range(1200):
        if driver.poll() is not None:
            pytest.skip("chromedriver does not start on this machine")
        try:
            if browser._call("GET", "/status")["ready"]:
                return
        except (urllib.error.URLError, ConnectionError):
            time.sleep(0.05)
    raise RuntimeError("chromedriver did not answer within a minute")
