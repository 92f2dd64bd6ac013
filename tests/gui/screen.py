"""A virtual screen, and the one application that a process of tests has: 3-D views need OpenGL, which Qt's "offscreen"
platform does not have."""

import shutil
import sys

import pytest

from groundstation.gui.start import start_virtual_screen

__all__ = ["start_virtual_screen", "the_application"]


def the_application():
    """The Qt application of this process, made where there is none yet; skips where there can be none."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the virtual screen Xvfb exists on Linux only")
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is not installed (make setup installs it as root)")
    from PySide6.QtCore import Qt
    from PySide6.QtWidgets import QApplication

    if QApplication.instance() is not None:
        return QApplication.instance()
    start_virtual_screen()
    # Files are chosen in Qt's own dialogs, which can be clicked: those of a desktop are other programs.
    QApplication.setAttribute(Qt.ApplicationAttribute.AA_DontUseNativeDialogs)
    return QApplication(["reflight-tests"])
