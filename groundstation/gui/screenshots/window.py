"""Pictures of the real window in every tab and state, for the README and for looking at: `app.py --screenshots DIR`.

The window is driven as a user drives it, through its own widgets and controller; files are read and written in a folder
that goes away afterwards, settings too.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QEventLoop, QObject, QTimer
from PySide6.QtWidgets import QApplication, QWidget

from groundstation.gui.fly.questions import FlightQuestions
from groundstation.gui.screenshots.camera import camera_states, rendered_photo
from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.widgets.questions import Answer, Questions
from groundstation.gui.window.project_controller import ProjectController
from groundstation.services.fly.sortie import TakeOff
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.settings import CONFIG_VARIABLE, Language, Theme
from groundstation.services.site.sources import open_site
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.base.messages import say
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.records import require_panels

SIZES_PX = ((1280, 720), (1920, 1080))

SETTLE_MS = 400
"""For the 3-D view to come to rest and the charts to redraw."""

TIMEOUT_S = 600.0

FLY_SPEED_UP, FLY_PHOTOS = 30.0, 12
"""Of the simulated flight, and after how many photos it is broken off."""


class _NoQuestions(Questions):
    """Nobody is there to answer."""

    def save_first(self, parent: QWidget) -> Answer:
        return Answer.NO

    def recover(self, parent: QWidget, when: str, changes: tuple[str, ...], is_of_saved_state: bool) -> Answer:
        return Answer.NO


class _ReadyToFly(FlightQuestions):
    """Everybody is clear of the simulated aircraft."""

    def start(self, parent: QWidget, take_off: TakeOff, units: UnitSystem) -> bool:
        return True

    def leave_in_flight(self, parent: QWidget) -> bool:
        return True


def take_screenshots(folder: Path, site: Path | None = None, sizes_px: tuple[tuple[int, int], ...] = SIZES_PX) -> int:
    """Drive the window through its tabs and states and save a picture of each; returns the number of pictures.

    Parameters
    ----------
    folder
        Made where it is missing; one folder in it for each size.
    site
        Site file to show; the bundled library where None.

    Raises
    ------
    InputError
        The site cannot be read or has no panels, or the folder not written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            say("this folder cannot be made ({}); name another", error.strerror or error, place=folder)
        ) from error
    if site is not None:
        require_panels(open_site(site).site)
    application = QApplication.instance() or QApplication(["reflight"])
    assert isinstance(application, QApplication)
    n_pictures = 0
    with tempfile.TemporaryDirectory(prefix="reflight-") as scratch:
        before = os.environ.get(CONFIG_VARIABLE)
        os.environ[CONFIG_VARIABLE] = scratch
        try:
            for width, height in sizes_px:
                into = folder / f"{width}x{height}"
                into.mkdir(exist_ok=True)
                n_pictures += _Photographer(application, into, Path(scratch), site, (width, height)).run()
        finally:
            if before is None:
                del os.environ[CONFIG_VARIABLE]
            else:
                os.environ[CONFIG_VARIABLE] = before
    return n_pictures


class _Photographer(QObject):
    """One run through the window at one size."""

    def __init__(
        self, application: QApplication, folder: Path, scratch: Path, site: Path | None, size_px: tuple[int, int]
    ) -> None:
        super().__init__()
        self._application, self._folder, self._scratch = application, folder, scratch
        self._site = write_scene("library", scratch) if site is None else site
        self._controller = ProjectController(application, _NoQuestions())
        self._size_px = size_px
        self._n_pictures = 0

    def run(self) -> int:
        """All pictures; returns their number."""
        controller = self._controller
        controller.show()
        controller.window.setGeometry(0, 0, *self._size_px)
        self._wait_for(lambda: controller.window.stage.scene() is not None)
        controller.choose(theme=Theme.LIGHT, language=Language.ENGLISH)
        self._empty()
        self._site_states()
        self._planning()
        self._planned()
        self._by_hand()
        self._mission()
        self._fly()
        self._error()
        self._looks()
        self._photos()
        self._reconstruct()
        controller.window.close()
        controller.close()
        return self._n_pictures

    # States

    def _empty(self) -> None:
        for name in self._controller.window.tab_names():
            self._controller.window.show_tab(name)
            self._take(f"empty-{name}")

    def _site_states(self) -> None:
        window, workspace = self._controller.window, self._controller.workspace
        window.show_tab("site")
        self._controller.open_path(self._site)
        self._wait_until_idle()
        self._take("site")
        site = workspace.document.site
        assert site is not None
        middle = site.site.panels[len(site.site.panels) // 2].id
        for name, item in (
            ("panel", Item(ItemKind.PANEL, middle)),
            ("home", Item(ItemKind.HOME)),
            ("airspace", Item(ItemKind.AIRSPACE)),
        ):
            workspace.select(item)
            self._take(f"site-{name}")
        workspace.select(None)

    def _planning(self) -> None:
        window, workspace = self._controller.window, self._controller.workspace
        window.show_tab("plan")
        page = window.tab("plan")
        self._take("plan-nothing-yet")
        page.controller.set_request(PlanRequest(n_views=80, time_budget_s=12.0))  # type: ignore[attr-defined]
        page.controller.plan()  # type: ignore[attr-defined]
        self._wait_for(lambda: "sections" in page.chart.text())  # type: ignore[attr-defined]
        self._take("plan-running")
        self._wait_until_idle()
        self._take("plan-planned")
        page.controller.set_request(PlanRequest(method="noto", share=0.9, time_budget_s=6.0))  # type: ignore[attr-defined]
        page.controller.plan()  # type: ignore[attr-defined]
        self._wait_until_idle()
        page.controller.choose(workspace.document.plans[0].id)  # type: ignore[attr-defined]
        self._wait_until_idle()

    def _planned(self) -> None:
        from groundstation.gui.plan.plan_page import PanelPaint, RoutePaint

        workspace, page = self._controller.workspace, self._controller.window.tab("plan")
        site = workspace.document.site
        assert site is not None
        lists, paint = page.lists, page.paint  # type: ignore[attr-defined]
        for panels in PanelPaint:
            paint.setValue(panels, RoutePaint.CLEARANCE if panels is PanelPaint.FACADE else RoutePaint.SORTIE)
            self._take(f"plan-{panels.value}")
        paint.setValue(PanelPaint.SHARE, RoutePaint.SORTIE)
        workspace.jump_to(Item(ItemKind.PANEL, site.site.panels[len(site.site.panels) // 3].id))
        page.panel.pick_section(8)  # type: ignore[attr-defined]
        self._take("plan-panel")
        page.right.setCurrentWidget(page.effects)  # type: ignore[attr-defined]
        for widget, name in (
            (lists.reach, "not-covered"),
            (lists.clearance, "clearance"),
            (lists.plans, "plans"),
        ):
            lists.setCurrentWidget(widget)
            self._wait_until_idle()
            self._take(f"plan-{name}")
        lists.setCurrentIndex(0)
        lists.compare(tuple(entry.id for entry in workspace.document.plans))
        self._wait_until_idle()
        self._take("plan-compare", lists.compare_window)
        lists.compare_window.close()

    def _by_hand(self) -> None:
        from dataclasses import replace

        window, workspace, page = (
            self._controller.window,
            self._controller.workspace,
            self._controller.window.tab("plan"),
        )
        entry = workspace.document.current
        assert entry is not None
        viewpoint = entry.plan.viewpoints[len(entry.plan.viewpoints) // 2]
        workspace.jump_to(Item(ItemKind.VIEWPOINT, viewpoint.id))
        self._take("plan-viewpoint")
        window.stage.show_page(SharedViewPage.CAMERA)
        self._take("plan-camera")
        camera_states(self._controller, self._take, self._wait_until_idle)
        window.stage.show_page(SharedViewPage.SCENE)
        site = workspace.document.site
        assert site is not None
        panel = site.site.panels[len(site.site.panels) // 2].corners_enu_m[0]
        page.controller.set_viewpoint(  # type: ignore[attr-defined]
            replace(viewpoint, position_enu_m=(panel[0], panel[1] - 3.0, panel[2]))
        )
        self._wait_until_idle()
        self._take("plan-finding")

    def _mission(self) -> None:
        window, workspace = self._controller.window, self._controller.workspace
        window.show_tab("mission")
        self._wait_until_idle()
        self._take("mission-finding")
        workspace.session.undo()
        self._wait_until_idle()
        bottom = window.tab("mission").bottom
        n_pages = bottom.count() if bottom is not None and hasattr(bottom, "count") else 0
        for page in range(n_pages):
            bottom.setCurrentIndex(page)  # type: ignore[union-attr]
            self._wait_until_idle()
            self._take(f"mission-{page + 1}")
        window.stage.show_page(SharedViewPage.MAP)
        self._take("mission-map")
        window.stage.show_page(SharedViewPage.SCENE)

    def _fly(self) -> None:
        """A simulated flight that is broken off, from connecting to the top-up that closes what it missed."""
        from groundstation.gui.fly.fly_page import FlyPage
        from groundstation.services.fly.events import Request
        from groundstation.services.fly.options import ConnectionChoice

        window = self._controller.window
        window.show_tab("fly")
        page = window.tab("fly")
        assert isinstance(page, FlyPage)
        page.questions = _ReadyToFly()
        self._controller.workspace.select(None)
        scene = window.stage.scene()
        assert scene is not None
        scene.look_at_all()
        self._wait_until_idle()
        self._take("fly-disconnected")
        page.controller.set_choice(ConnectionChoice(speed_up=FLY_SPEED_UP))
        page.controller.connect_vehicle()
        for request, name in ((Request.UPLOAD, "fly-connected"), (Request.START, "fly-ready")):
            button = page.buttons.button(request)
            self._wait_for(button.isEnabled)
            self._take(name)
            button.click()
        self._wait_for(lambda: page.n_photos() >= FLY_PHOTOS // 2)
        window.stage.show_page(SharedViewPage.MAP)
        self._take("fly-map")
        window.stage.show_page(SharedViewPage.SCENE)
        self._wait_for(lambda: page.n_photos() >= FLY_PHOTOS)
        page.buttons.button(Request.PAUSE).click()
        self._wait_for(page.buttons.button(Request.RESUME).isEnabled)
        self._take("fly-paused")
        page.band.show_lost(7.0)
        self._take("fly-link-lost", rest_ms=0)
        page.buttons.button(Request.RETURN).click()
        self._wait_for(lambda: page.report.top_up.isEnabled())
        self._take("fly-report")
        page.controller.disconnect_vehicle()
        self._wait_for(lambda: not page.controller.is_connected)

    def _error(self) -> None:
        damaged = self._scratch / "damaged"
        damaged.mkdir(exist_ok=True)
        (damaged / "project.json").write_text('{"format": "reflight-project/2", "name": ')
        self._controller.window.show_tab("site")
        self._controller.open_folder(damaged)
        self._wait_until_idle()
        self._take("error")

    def _looks(self) -> None:
        controller = self._controller
        for name, changes in (
            ("dark", {"theme": Theme.DARK}),
            ("sunlight", {"theme": Theme.SUNLIGHT}),
            ("feet", {"theme": Theme.LIGHT, "units": UnitSystem.IMPERIAL}),
            ("german", {"units": UnitSystem.METRIC, "language": Language.GERMAN}),
        ):
            controller.choose(**changes)
            self._wait_for(lambda: controller.window.stage.scene() is not None)
            for tab in ("site", "plan", "mission", "fly"):
                controller.window.show_tab(tab)
                self._wait_until_idle()
                self._take(f"{name}-{tab}")
            controller.window.show_tab("plan")
            rendered_photo(controller, f"{name}-photo", self._take, self._wait_until_idle)
        controller.choose(language=Language.ENGLISH)

    def _photos(self) -> None:
        from groundstation.gui.screenshots.photos import photo_states

        photo_states(self._controller, self._scratch, self._take, self._wait_until_idle)

    # The camera

    def _reconstruct(self) -> None:
        from groundstation.gui.screenshots.reconstruct import reconstruct_states

        model = reconstruct_states(self._controller, self._scratch, self._take, self._wait_for)
        from groundstation.gui.screenshots.model import model_states

        model_states(self._controller, model, self._take, self._wait_for)

    def _take(self, name: str, widget: QWidget | None = None, rest_ms: int = SETTLE_MS) -> None:
        self._rest(rest_ms)
        path = self._folder / f"{name}.png"
        if not (self._controller.window if widget is None else widget).grab().save(str(path)):
            raise InputError(say("the picture cannot be written", place=path))
        self._n_pictures += 1

    def _rest(self, duration_ms: int) -> None:
        loop = QEventLoop()
        QTimer.singleShot(duration_ms, loop.quit)
        loop.exec()

    def _wait_until_idle(self) -> None:
        self._wait_for(lambda: not self._controller.workspace.jobs())
        # A job's end can start the next one a little later.
        self._rest(SETTLE_MS)
        self._wait_for(lambda: not self._controller.workspace.jobs())

    def _wait_for(self, condition: Callable[[], bool]) -> None:
        end_s = time.monotonic() + TIMEOUT_S
        while not condition():
            if time.monotonic() > end_s:
                raise TimeoutError("the window did not get where it should")
            self._rest(20)
