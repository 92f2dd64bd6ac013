"""A Firefox on a virtual screen, driven over its own protocol (Marionette: JSON over TCP) with the standard library.

Without any screen it has no WebGL.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import socket
import subprocess
import time
from contextlib import contextmanager

import pytest

from tests.gui.screen import start_virtual_screen
from tests.reconstruction.exports.web_browser import Browser

FIREFOX = next((found for name in ("firefox-esr", "firefox") if (found := shutil.which(name))), None)

SETTINGS = {
    "app.update.disabledForTesting": True,
    "browser.shell.checkDefaultBrowser": False,
    "browser.startup.homepage_override.mstone": "ignore",
    "datareporting.policy.dataSubmissionEnabled": False,
    "gfx.webrender.software": True,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "toolkit.telemetry.enabled": False,
    "webgl.force-enabled": True,
}

COMPLAINTS = """
const found = Services.console.getMessageArray()
    .filter((each) => each instanceof Ci.nsIScriptError && !(each.flags & Ci.nsIScriptError.warningFlag)
        && each.sourceName.startsWith("file:"))
    .map((each) => each.errorMessage);
Services.console.reset();
return found;
"""

STARTS_S = 240.0


class Firefox(Browser):
    """One window."""

    def __init__(self, connection):
        super().__init__(None, "")
        self._connection, self._stream, self._number = connection, connection.makefile("rb"), 0
        self._received()

    def command(self, name, **parameters):
        self._number += 1
        content = json.dumps([0, self._number, name, parameters]).encode()
        self._connection.sendall(b"%d:" % len(content) + content)
        _, number, error, value = self._received()
        assert number == self._number
        if error is not None:
            raise RuntimeError(f"{error['error']}: {error['message'][:2000]}")
        return value

    def _received(self):
        length = b""
        while (byte := self._stream.read(1)) != b":":
            if not byte:
                raise ConnectionError("Firefox has ended")
            length += byte
        return json.loads(self._stream.read(int(length)))

    def open(self, path, fragment=""):
        self.command("WebDriver:Navigate", url=path.absolute().as_uri() + fragment)

    def run(self, script, *values):
        body = f"return (async function () {{ {script} }}).apply(null, arguments);"
        return self.command("WebDriver:ExecuteScript", script=body, args=list(values))["value"]

    def window(self, width, height, touch=False):
        assert not touch
        self.command("WebDriver:SetWindowRect", width=width, height=height)
        # What is around the page is left out.
        inner = self.run("return [innerWidth, innerHeight]")
        self.command("WebDriver:SetWindowRect", width=2 * width - inner[0], height=2 * height - inner[1])

    def log(self, kind):
        """Forgets what was complained of."""
        self.errors()
        return []

    def errors(self):
        self.command("Marionette:SetContext", value="chrome")
        found = self.command("WebDriver:ExecuteScript", script=COMPLAINTS, args=[])["value"]
        self.command("Marionette:SetContext", value="content")
        return found

    def screenshot(self):
        return base64.b64decode(self.command("WebDriver:TakeScreenshot", full=False)["value"])

    def _call(self, method, path, content=None):
        """Of WebDriver's calls, those of mouse and keys."""
        assert (method, path) == ("POST", "/actions")
        self.command("WebDriver:PerformActions", **content)


@contextmanager
def firefox(folder):
    """A browser whose profile lies in a folder; the test is skipped where there is none."""
    if FIREFOX is None or shutil.which("Xvfb") is None:
        pytest.skip("firefox or Xvfb is not on this machine (apt-get install firefox-esr xvfb)")
    start_virtual_screen()
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    profile = folder / "profile"
    profile.mkdir()
    settings = SETTINGS | {"marionette.port": port}
    lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in settings.items()]
    (profile / "user.js").write_text("".join(lines))
    flags = ["--marionette", "--remote-allow-system-access", "--no-remote", "--profile", str(profile)]
    process = subprocess.Popen(
        [FIREFOX, *flags],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "HOME": str(folder)},
    )
    try:
        with _connected(port, process) as connection:
            browser = Firefox(connection)
            browser.command("WebDriver:NewSession", capabilities={"alwaysMatch": {"unhandledPromptBehavior": "ignore"}})
            yield browser
    finally:
        process.terminate()
        process.wait(30)


def _connected(port, process):
    until = time.monotonic() + STARTS_S
    while time.monotonic() < until:
        if process.poll() is not None:
            pytest.skip("firefox does not start on this machine")
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=300)
        except ConnectionError:
            time.sleep(0.05)
    raise RuntimeError(f"firefox did not answer within {STARTS_S:g} s")
