"""A virtual screen for pictures and tests on machines without one: Xvfb, with OpenGL in software."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

from planning.base.errors import InputError
from planning.base.messages import say

WIDTH_PX, HEIGHT_PX = 1920, 1080


def has_screen() -> bool:
    """Whether Qt finds a screen: always but on Linux, where the environment says so."""
    wanted = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
    return not sys.platform.startswith("linux") or any(os.environ.get(name) for name in wanted)


def start_virtual_screen() -> None:
    """Start Xvfb and point Qt at it, before the application is made.

    The screen ends by itself with its last client: Qt's connection lives until this process ends, and dies badly
    before.

    Raises
    ------
    InputError
        Xvfb is not installed, or does not start.
    """
    if shutil.which("Xvfb") is None:
        raise InputError(say("there is no screen, and no Xvfb to stand in for one: install the package xvfb"))
    read_end, write_end = os.pipe()
    size = f"{WIDTH_PX}x{HEIGHT_PX}x24"
    screen = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write_end), "-screen", "0", size, "-nolisten", "tcp", "-terminate"],
        pass_fds=(write_end,),
        stderr=subprocess.DEVNULL,
    )
    screen.returncode = 0  # nobody waits for it, and that is meant
    os.close(write_end)
    with os.fdopen(read_end) as numbers:
        number = numbers.readline().strip()
    if not number:
        raise InputError(say("the virtual screen Xvfb did not start; run it by hand to see why"))
    os.environ.update(DISPLAY=f":{number}", QT_QPA_PLATFORM="xcb", LIBGL_ALWAYS_SOFTWARE="1")
