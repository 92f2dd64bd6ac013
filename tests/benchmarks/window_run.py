"""One measurement of the real window in a own process: `python -m tests.benchmarks.window_run WHAT FILE [FOLDER]`.

Writes what was measured to FILE as JSON. Without a screen it starts a virtual one and a second process, whose time does
not hold the start of the screen.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import psutil

from groundstation.gui.start import has_screen, start_virtual_screen

N_VIEWS, N_EDITS = 560, 40
BUDGET_S, IDLE_S, N_PLANS = 20.0, 4.0, 3
TICK_MS = 2

LOADED_S = 6.0
"""After which nothing more is loaded in the background."""

TRAINING_S, TURN_EVERY_S = 45.0, 0.3
"""How long a training is watched, and how often the view is turned in the second half of it."""


def _turn_until(application: Any, condition: Callable[[], bool], timeout_s: float = 200.0) -> None:
    end_s = time.perf_counter() + timeout_s
    while not condition():
        application.processEvents()
        if time.perf_counter() > end_s:
            raise TimeoutError("the window did not get where it should")
        time.sleep(0.0005)


def _turn_until_idle(application: Any, controller: Any) -> None:
    for _ in range(2):
        _turn_until(application, lambda: not controller.context.jobs())
        _turn_for(application, 0.5)
    _turn_until(application, lambda: not controller.context.jobs())


def _turn_for(application: Any, duration_s: float) -> None:
    end_s = time.perf_counter() + duration_s
    _turn_until(application, lambda: time.perf_counter() > end_s)


def startup(*, eager: bool) -> dict[str, float]:
    """Seconds from the start of the process to the first picture, and to the 3-D view; then the resident memory of all
    its processes, once everything is loaded. `eager` imports the 3-D view first."""
    started_s = psutil.Process().create_time()
    from PySide6.QtWidgets import QApplication

    application = QApplication(["reflight"])
    if eager:
        importlib.import_module("groundstation.gui.view3d.scene_view")
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application)
    controller.show()
    application.processEvents()
    painted_s = time.time() - started_s
    _turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    application.processEvents()
    ready_s = time.time() - started_s
    _turn_for(application, LOADED_S)
    process = psutil.Process()
    resident_gb = sum(one.memory_info().rss for one in (process, *process.children(recursive=True))) / 1e9
    controller.window.close()
    controller.close()
    return {"painted_s": painted_s, "ready_s": ready_s, "resident_gb": resident_gb}


class _Gaps:
    """Times between the ticks of a timer in the window's thread."""

    def __init__(self) -> None:
        from PySide6.QtCore import Qt, QTimer

        self.gaps_ms: list[float] = []
        self._last_s = time.perf_counter()
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self._timer.start(TICK_MS)

    def restart(self) -> None:
        """Forget what was before."""
        self.gaps_ms, self._last_s = [], time.perf_counter()

    def _tick(self) -> None:
        now_s = time.perf_counter()
        self.gaps_ms.append(1e3 * (now_s - self._last_s))
        self._last_s = now_s


def planning() -> dict[str, Any]:
    """Gaps of the window's thread while it idles and while a plan of the office runs; then times of edits by hand."""
    from PySide6.QtWidgets import QApplication

    from groundstation.gui.window.project_controller import ProjectController
    from groundstation.services.project.document import Item, ItemKind
    from planning.request import PlanRequest
    from planning.revision import edits

    application = QApplication(["reflight"])
    controller = ProjectController(application)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    _turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    controller.window.tab("site").left.opener.open_bundled("office")
    controller.window.show_tab("plan")
    page = controller.window.tab("plan")
    page.controller.set_request(PlanRequest(n_views=N_VIEWS, time_budget_s=BUDGET_S))
    _turn_until_idle(application, controller)
    gaps = _Gaps()
    _turn_for(application, IDLE_S)
    idle_ms = gaps.gaps_ms
    planning_ms = []
    for seed in range(N_PLANS):
        page.controller.set_request(PlanRequest(n_views=N_VIEWS, time_budget_s=BUDGET_S, seed=seed))
        gaps.restart()
        page.controller.plan()
        _turn_until(application, lambda: not page.controller.is_planning)
        planning_ms.append(gaps.gaps_ms[:-1])  # the last one shows the result
        _turn_until_idle(application, controller)
    plan = controller.context.document.current.plan
    shown_ms, pure_ms = [], []
    for number in range(N_EDITS):
        viewpoint = plan.viewpoints[(37 * number) % len(plan.viewpoints)]
        x, y, z = viewpoint.position_enu_m
        controller.context.select(Item(ItemKind.VIEWPOINT, viewpoint.id))
        application.processEvents()
        before = page.controller.active.revision
        moved = replace(viewpoint, position_enu_m=(x + 0.3, y - 0.3, z + 0.2))
        began_s = time.perf_counter()
        edits.move(before, moved.id, moved.position_enu_m, moved.heading_deg, moved.gimbal_pitch_deg)
        pure_ms.append(1e3 * (time.perf_counter() - began_s))
        began_s = time.perf_counter()
        page.controller.set_viewpoint(moved)
        application.processEvents()
        shown_ms.append(1e3 * (time.perf_counter() - began_s))
    return {"idle_ms": idle_ms, "planning_ms": planning_ms, "shown_ms": shown_ms, "pure_ms": pure_ms}


def training(dataset: Path, out: Path) -> dict[str, Any]:
    """Gaps while the Reconstruct tab idles, while it trains, and while its view is turned beside that; and the waits
    from a turn of the view to its first picture."""
    from PySide6.QtWidgets import QApplication

    from groundstation.gui.reconstruct.reconstruct_controller import Phase
    from groundstation.gui.window.project_controller import ProjectController

    application = QApplication(["reflight"])
    controller = ProjectController(application)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    _turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    controller.window.show_tab("reconstruct")
    page = controller.window.tab("reconstruct")
    page.controller.read(dataset)
    _turn_until(application, lambda: page.controller.card is not None)
    page.controller.choose(replace(page.controller.choice, minutes=5.0))
    page.controller.choose_out(out)
    _turn_until_idle(application, controller)
    gaps = _Gaps()
    _turn_for(application, IDLE_S)
    idle_ms = gaps.gaps_ms
    page.side.train.click()
    _turn_until(application, lambda: page.controller.phase is Phase.TRAINING)
    gaps.restart()
    _turn_for(application, 0.5 * TRAINING_S)
    watched_ms = gaps.gaps_ms
    came: list[bytes] = []
    page.pane.pictures_in_view.pictureCame.connect(
        lambda _place, _image, seen: came.append(_place_of(seen.look.camera))
    )
    waits_ms = []
    gaps.restart()
    end_s = time.perf_counter() + 0.5 * TRAINING_S
    while time.perf_counter() < end_s:
        page.pane.view.orbited.emit(0.02, 0.0)
        began_s, place = time.perf_counter(), _place_of(page.pane.camera())
        _turn_until(application, lambda place=place: place in came)
        waits_ms.append(1e3 * (time.perf_counter() - began_s))
        came.clear()
        _turn_for(application, TURN_EVERY_S)
    turned_ms = gaps.gaps_ms
    page.controller.cancel_training()
    _turn_until(application, lambda: not page.controller.is_busy)
    return {"idle_ms": idle_ms, "watched_ms": watched_ms, "turned_ms": turned_ms, "waits_ms": waits_ms}


def _place_of(camera: Any) -> bytes:
    return bytes(camera.pose.position_enu_m.tobytes())


def _measured(what: str, folders: list[Path]) -> dict[str, Any]:
    if what == "planning":
        return planning()
    if what == "training":
        return training(folders[0] / "photos", folders[0] / "model")
    return startup(eager=what == "startup-eager")


if __name__ == "__main__":
    if not has_screen():
        start_virtual_screen()
        sys.exit(subprocess.run([sys.executable, "-m", "tests.benchmarks.window_run", *sys.argv[1:]]).returncode)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["REFLIGHT_CONFIG_DIR"] = folder
        what, path, *folders = sys.argv[1:]
        Path(path).write_text(json.dumps(_measured(what, [Path(each) for each in folders])), "utf-8")
        sys.stdout.flush()
        os._exit(0)  # nothing of the window is worth saving
