"""A virtual screen: 3-D views need OpenGL, which Qt's "offscreen" platform does not have."""

from __future__ import annotations

import os
import subprocess


def start_virtual_screen() -> None:
    """Start Xvfb and point Qt at it.

    The screen ends by itself with its last client: Qt's connection lives until this process ends, and dies badly
    before.
    """
    read_end, write_end = os.pipe()
    screen = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write_end), "-screen", "0", "1400x900x24", "-nolisten", "tcp", "-terminate"],
        pass_fds=(write_end,),
        stderr=subprocess.DEVNULL,
    )
    screen.returncode = 0  # nobody waits for it, and that is meant
    os.close(write_end)
    with os.fdopen(read_end) as numbers:
        number = numbers.readline().strip()
    os.environ.update(DISPLAY=f":{number}", QT_QPA_PLATFORM="xcb", LIBGL_ALWAYS_SOFTWARE="1")
