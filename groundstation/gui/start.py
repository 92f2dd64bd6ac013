"""Start the window, or take pictures of it."""

from __future__ import annotations

import sys
from pathlib import Path

from groundstation.gui.screenshots.virtual_screen import has_screen, start_virtual_screen
from planning.base.errors import InputError
from planning.base.messages import say


def run_window(path: Path | None = None) -> int:
    """Open the main window and run until it is closed; returns the exit status.

    Parameters
    ----------
    path
        Project folder or site file to begin with.

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

    from groundstation.gui.window.project_controller import ProjectController

    application = QApplication.instance() or QApplication(sys.argv[:1])
    assert isinstance(application, QApplication)
    application.setApplicationName("Reflight")
    controller = ProjectController(application)
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
    from groundstation.gui.screenshots.window import take_screenshots

    n_pictures = take_screenshots(folder, site)
    sys.stdout.write(f"{folder}: {n_pictures} pictures\n")
    return 0
