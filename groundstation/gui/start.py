"""Start the window, or take pictures of it: on a machine without a screen on Xvfb, with OpenGL in software."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

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


def run_window(path: Path | None = None) -> int:
    """Open the main window and run until it is closed; returns the exit status.

    Parameters
    ----------
    path
        Folder of a project or a finished model, or site file to begin with.

    Raises
    ------
    InputError
        There is no screen, or nothing at that path.
    """
    if not has_screen():
        raise InputError(
            say(
                "there is no screen for the window (DISPLAY and WAYLAND_DISPLAY are not set); run it on a "
                "desktop, or use the commands (-h lists them)"
            )
        )
    if path is not None and not path.exists():
        raise InputError(say("there is no such project folder or site file", place=path))
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    from groundstation.gui.application.errors import tell_errors
    from groundstation.gui.window.project_controller import ProjectController

    application = QApplication.instance() or QApplication(sys.argv[:1])
    assert isinstance(application, QApplication)
    application.setApplicationName("Reflight")
    controller = ProjectController(application)
    tell_errors(controller.context)
    controller.show()
    if path is not None:
        QTimer.singleShot(0, lambda: controller.open_path(path))
    status = int(application.exec())
    controller.close()
    return status


def take_pictures(folder: Path, site: Path | None) -> int:
    """Save pictures of every tab and state; on a machine without a screen, on a virtual one. Returns the exit status.

    Raises
    ------
    InputError
        There is no screen, the site cannot be read, or the folder not written.
    """
    if not has_screen():
        start_virtual_screen()
    from groundstation.gui.screenshots import take_screenshots

    n_pictures = take_screenshots(folder, site)
    sys.stdout.write(f"{folder}: {n_pictures} pictures\n")
    return 0
