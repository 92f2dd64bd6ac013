"""The picture of the window in the README: `python -m tests.gui.picture docs/window.png`."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from groundstation.services.jobs import JobRunner
from planning.planner import PlanRequest
from planning.scenes import write_scene
from tests.gui.screen import start_virtual_screen


def main(out: Path) -> None:
    """Open the library site, plan 100 views, and take the picture."""
    start_virtual_screen()
    from PySide6.QtWidgets import QApplication

    application = QApplication(["reflight"])
    from groundstation.gui.main_window import MainWindow

    runner = JobRunner()
    window = MainWindow(runner)
    window.resize(1280, 800)
    window.show()

    def wait() -> None:
        while window.is_busy():
            application.processEvents()
            time.sleep(0.002)
        for _ in range(20):
            application.processEvents()

    with tempfile.TemporaryDirectory() as folder:
        window.open_site(write_scene("library", Path(folder)))
        wait()
        window.form().setValue(PlanRequest(n_views=100, time_budget_s=20.0))
        window.plan()
        wait()
        window.check()
        wait()
        screen = application.primaryScreen()
        position = window.mapToGlobal(window.rect().topLeft())
        screen.grabWindow(0, position.x(), position.y(), window.width(), window.height()).save(str(out))
    window.close()
    runner.shutdown()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
