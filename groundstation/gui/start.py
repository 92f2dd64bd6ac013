"""Start the window."""

from __future__ import annotations

import sys


def run_window() -> int:
    """Open the main window and run until it is closed; returns the exit status."""
    from PySide6.QtWidgets import QApplication

    from groundstation.gui.main_window import MainWindow
    from groundstation.services.jobs import JobRunner

    application = QApplication.instance() or QApplication(sys.argv[:1])
    application.setApplicationName("Reflight")
    runner = JobRunner()
    window = MainWindow(runner)
    window.resize(1400, 900)
    window.show()
    status = int(application.exec())
    runner.shutdown()
    return status
