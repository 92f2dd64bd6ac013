"""A virtual screen and one application for all window tests."""

import os
import shutil
import subprocess
import sys

import pytest


@pytest.fixture(scope="session")
def application():
    """The Qt application, on a virtual screen of its own: 3-D views need OpenGL, which "offscreen" does not have."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the virtual screen Xvfb exists on Linux only")
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed (make setup installs it as root)")
    read_end, write_end = os.pipe()
    # It ends by itself with its last client: Qt's connection lives until this process ends, and dies badly before.
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
    from PySide6.QtWidgets import QApplication

    return QApplication(["reflight-tests"])
