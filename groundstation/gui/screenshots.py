"""Pictures of the real window in every tab and state, for the README and for looking at: `app.py --screenshots DIR`.

The window is driven as a user drives it, through its own widgets and controller; files are read and written in a folder
that goes away afterwards, settings too.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import date, timedelta
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from PySide6.QtCore import QDate, QDateTime, QEventLoop, QObject, Qt, QTime, QTimer
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QTabWidget, QWidget

from groundstation.gui.fly.fly_page import FlyPage
from groundstation.gui.fly.questions import FlightQuestions
from groundstation.gui.model.model_page import ModelPage
from groundstation.gui.photos.photos_page import PhotosPage
from groundstation.gui.plan.plan_page import PanelPaint, PlanPage, RoutePaint
from groundstation.gui.reconstruct.reconstruct_controller import Phase
from groundstation.gui.reconstruct.reconstruct_page import ReconstructPage
from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.view3d.canvas import Canvas
from groundstation.gui.widgets.questions import Answer, Questions
from groundstation.gui.window.main_window import MainWindow
from groundstation.gui.window.project_controller import ProjectController
from groundstation.services.fly.events import Request
from groundstation.services.fly.options import ConnectionChoice
from groundstation.services.fly.sortie import TakeOff
from groundstation.services.model.panel_colours import Computed
from groundstation.services.photos.synthetic_flight import write_synthetic_flight
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.reconstruct.choices import TrainChoice
from groundstation.services.settings import CONFIG_VARIABLE, Language, Theme
from groundstation.services.site.sources import open_site
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.messages import say
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.records import SiteModel, require_panels
from reconstruction.records.entries import Attribute, Defect, Inspection

Page = TypeVar("Page", bound=object)

SIZES_PX = ((1280, 720), (1920, 1080))

SETTLE_MS = 400
"""For the 3-D view to come to rest and the charts to redraw."""

TIMEOUT_S = 600.0

LOOKS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("dark", {"theme": Theme.DARK}),
    ("sunlight", {"theme": Theme.SUNLIGHT}),
    ("feet", {"theme": Theme.LIGHT, "units": UnitSystem.IMPERIAL}),
    ("german", {"units": UnitSystem.METRIC, "language": Language.GERMAN}),
)

MORNING = QDateTime(QDate(2026, 6, 21), QTime(9, 0))

FLY_SPEED_UP, FLY_PHOTOS = 30.0, 12
"""Of the simulated flight, and after how many photos it is broken off."""

N_VIEWS, WIDTH_PX = 48, 256
"""Of the rendered photos that a model learns from."""

MINUTES = 8.0
"""Of the training."""

SHOWN_FROM = 0.6
"""Of the joint training, after which the model can be seen for what it is."""

FIRST_DAY = date(2026, 1, 12)
LEFT_OUT = 7
"""Every so manyth panel has not been inspected yet."""

CHOSEN = 0.55
"""Of the panels of a model, which one is looked at."""


class _NoQuestions(Questions):
    """Nobody is there to answer."""

    def save_first(self, parent: QWidget) -> Answer:
        return Answer.NO

    def recover(self, parent: QWidget, when: str, changes: tuple[str, ...], is_of_saved_state: bool) -> Answer:
        return Answer.NO


class _ReadyToFly(FlightQuestions):
    """Everybody is clear of the simulated aircraft."""

    def start(self, parent: QWidget, take_off: TakeOff, units: UnitSystem, wait_s: float = 0.0) -> bool:
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
    make_folder(folder)
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
                n_pictures += _Tour(application, into, Path(scratch), site, (width, height)).run()
        finally:
            if before is None:
                del os.environ[CONFIG_VARIABLE]
            else:
                os.environ[CONFIG_VARIABLE] = before
    return n_pictures


class _Tour(QObject):
    """One run through the window at one size. Photos and flights that are in the scratch folder already are taken."""

    def __init__(
        self, application: QApplication, folder: Path, scratch: Path, site: Path | None, size_px: tuple[int, int]
    ) -> None:
        super().__init__()
        self._folder, self._scratch = folder, scratch
        self._site = write_scene("library", scratch) if site is None else site
        self._controller = ProjectController(application, _NoQuestions())
        self._context = self._controller.context
        self._size_px = size_px
        self._n_pictures = 0

    def run(self) -> int:
        """All pictures; returns their number."""
        self._controller.show()
        self._window.setGeometry(0, 0, *self._size_px)
        self._wait_for(lambda: self._window.shared_view.scene() is not None)
        self._controller.choose(theme=Theme.LIGHT, language=Language.ENGLISH)
        self._empty()
        self._site_states()
        self._planning()
        self._planned()
        self._by_hand()
        self._mission()
        self._fly()
        self._error()
        self._other_looks()
        self._photos()
        self._model(self._reconstruct())
        self._window.close()
        self._controller.close()
        return self._n_pictures

    # States

    def _empty(self) -> None:
        for name in self._window.tab_names():
            self._window.show_tab(name)
            self._take(f"empty-{name}")

    def _site_states(self) -> None:
        self._window.show_tab("site")
        self._controller.open_path(self._site)
        self._wait_until_idle()
        self._take("site")
        panels = self._opened_site().site.panels
        for name, item in (
            ("panel", Item(ItemKind.PANEL, panels[len(panels) // 2].id)),
            ("home", Item(ItemKind.HOME)),
            ("airspace", Item(ItemKind.AIRSPACE)),
        ):
            self._context.select(item)
            self._take(f"site-{name}")
        self._context.select(None)

    def _planning(self) -> None:
        self._window.show_tab("plan")
        page = self._page("plan", PlanPage)
        self._take("plan-nothing-yet")
        # A plan to compare with comes first: what the window says last is of the plan that it shows.
        page.controller.set_request(PlanRequest(method="noto", share=0.9, time_budget_s=6.0))
        page.controller.plan()
        self._wait_until_idle()
        page.controller.set_request(PlanRequest(n_views=80, time_budget_s=12.0))
        page.controller.plan()
        self._wait_for(lambda: bool(self._context.jobs()) and "sections" in page.chart.text())
        self._take("plan-running")
        self._wait_until_idle()
        self._take("plan-planned")

    def _planned(self) -> None:
        page = self._page("plan", PlanPage)
        lists, panels = page.lists, self._opened_site().site.panels
        assert isinstance(page.right, QTabWidget)
        page.right.setCurrentWidget(page.chart)
        for paint in PanelPaint:
            page.paint.setValue(paint, RoutePaint.CLEARANCE if paint is PanelPaint.FACADE else RoutePaint.SORTIE)
            self._take(f"plan-{paint.value}")
        page.paint.setValue(PanelPaint.SHARE, RoutePaint.SORTIE)
        self._context.jump_to(Item(ItemKind.PANEL, panels[len(panels) // 3].id))
        page.panel.pick_section(8)
        self._take("plan-panel")
        page.right.setCurrentWidget(page.effects)
        for widget, name in ((lists.reach, "not-covered"), (lists.clearance, "clearance"), (lists.plans, "plans")):
            lists.setCurrentWidget(widget)
            self._wait_until_idle()
            self._take(f"plan-{name}")
        lists.setCurrentIndex(0)
        lists.compare(tuple(entry.id for entry in self._context.document.plans))
        self._wait_until_idle()
        assert lists.compare_window is not None
        self._take("plan-compare", lists.compare_window)
        lists.compare_window.close()

    def _by_hand(self) -> None:
        entry = self._context.document.current
        assert entry is not None
        viewpoint = entry.plan.viewpoints[len(entry.plan.viewpoints) // 2]
        self._context.jump_to(Item(ItemKind.VIEWPOINT, viewpoint.id))
        self._take("plan-viewpoint")
        self._window.shared_view.show_page(SharedViewPage.CAMERA)
        self._take("plan-camera")
        self._camera()
        panels = self._opened_site().site.panels
        corner = panels[len(panels) // 2].corners_enu_m[0]
        self._page("plan", PlanPage).controller.set_viewpoint(
            replace(viewpoint, position_enu_m=(corner[0], corner[1] - 3.0, corner[2]))
        )
        self._wait_until_idle()
        self._take("plan-finding")

    def _camera(self) -> None:
        """The photo of the selected viewpoint: with outlines, as it is, its effects, at another time of the day."""
        shared_view = self._window.shared_view
        self._rendered_photo("plan-photo-outlines")
        shared_view.show_page(SharedViewPage.CAMERA)
        box, photos = shared_view.camera_page().box, shared_view.photo_controller
        assert photos is not None
        box.photo.click()
        self._rest_until(photos.is_at_rest)
        self._take("plan-photo")
        effects = photos.effects_window()
        effects.show()
        self._take("plan-photo-effects", effects)
        effects.close()
        usual = box.light.value()
        box.light.set_time(MORNING)
        photos.look()
        self._rest_until(photos.is_at_rest)
        self._take("plan-photo-by-time")
        box.light.setValue(usual)
        box.lines.click()
        shared_view.show_page(SharedViewPage.SCENE)

    def _rendered_photo(self, name: str) -> None:
        """A picture of the selected viewpoint's photo with the panels' outlines; the scene is shown again after it."""
        shared_view = self._window.shared_view
        shared_view.show_page(SharedViewPage.CAMERA)
        box, photos = shared_view.camera_page().box, shared_view.photo_controller
        assert photos is not None
        box.photo.click()
        box.outlines.setChecked(True)
        self._rest_until(photos.is_at_rest)
        self._take(name)
        box.outlines.setChecked(False)
        box.lines.click()
        shared_view.show_page(SharedViewPage.SCENE)

    def _mission(self) -> None:
        self._window.show_tab("mission")
        self._wait_until_idle()
        self._take("mission-finding")
        self._context.session.undo()
        self._wait_until_idle()
        bottom = self._window.tab("mission").bottom
        assert isinstance(bottom, QTabWidget)
        for page in range(bottom.count()):
            bottom.setCurrentIndex(page)
            self._wait_until_idle()
            self._take(f"mission-{page + 1}")
        self._window.shared_view.show_page(SharedViewPage.MAP)
        self._take("mission-map")
        self._window.shared_view.show_page(SharedViewPage.SCENE)

    def _fly(self) -> None:
        """A simulated flight that is broken off, from connecting to the top-up that closes what it missed."""
        window = self._window
        window.show_tab("fly")
        page = self._page("fly", FlyPage)
        page.questions = _ReadyToFly()
        self._context.select(None)
        scene = window.shared_view.scene()
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
        window.shared_view.show_page(SharedViewPage.MAP)
        self._take("fly-map")
        window.shared_view.show_page(SharedViewPage.SCENE)
        self._wait_for(lambda: page.n_photos() >= FLY_PHOTOS)
        page.buttons.button(Request.PAUSE).click()
        self._wait_for(page.buttons.button(Request.RESUME).isEnabled)
        self._take("fly-paused")
        page.buttons.button(Request.RETURN).click()
        self._wait_for(lambda: page.report.top_up.isEnabled())
        self._take("fly-report")
        page.controller.disconnect_vehicle()
        self._wait_for(lambda: not page.controller.is_connected)

    def _error(self) -> None:
        damaged = self._scratch / "damaged"
        damaged.mkdir(exist_ok=True)
        (damaged / "project.json").write_text('{"format": "reflight-project/2", "name": ')
        self._window.show_tab("site")
        self._controller.open_folder(damaged)
        self._wait_until_idle()
        self._take("error")
        for message in self._window.messages.standing():
            self._window.messages.dismiss(message)

    def _other_looks(self) -> None:
        for name in self._in_each_look():
            self._wait_for(lambda: self._window.shared_view.scene() is not None)
            for tab in ("site", "plan", "mission", "fly"):
                self._window.show_tab(tab)
                self._wait_until_idle()
                self._take(f"{name}-{tab}")
            self._window.show_tab("plan")
            self._rendered_photo(f"{name}-photo")

    def _photos(self) -> None:
        """A rendered flight is read, looked at in 3-D, searched and corrected."""
        flight = self._scratch / "made-flight"
        site, photos = flight / "made.site.json", flight / "photos"
        if not site.exists():
            flight.mkdir()
            site, photos = write_synthetic_flight(flight)

        def page() -> PhotosPage:
            return self._page("photos", PhotosPage)

        def rest() -> None:
            self._wait_until_idle()
            self._rest_until(lambda: not page().store.is_busy())

        self._controller.open_path(site)
        self._wait_until_idle()
        self._window.show_tab("photos")
        page().controller.read(photos)
        rest()
        page().strip.choose(len(page().controller.cards) - 1)
        rest()
        self._take("photos-read")
        panels = self._opened_site().site.panels
        self._context.select(Item(ItemKind.PANEL, panels[len(panels) // 2].id))
        page().pane.coverage.click()
        rest()
        self._take("photos-coverage")
        page().pane.photo.click()
        page().details.setCurrentIndex(0)
        page().controller.find()
        rest()
        page().strip.choose(len(page().controller.cards) - 1)
        rest()
        self._take("photos-known")
        page().strip.choose(0)
        rest()
        _choose_line(page())
        self._take("photos-grid")
        page().pane.rectified.click()
        rest()
        self._take("photos-rectified")
        page().pane.photo.click()
        for name in self._in_each_look():
            self._window.show_tab("photos")
            rest()
            _choose_line(page())
            self._take(f"{name}-photos")
            if name == "german":
                page().pane.coverage.click()
                rest()
                self._take("german-photos-coverage")
        self._window.show_tab("photos")
        page().use.click()
        self._wait_until_idle()
        self._context.select(Item(ItemKind.PANEL, self._opened_site().site.panels[0].id))
        self._take("photos-used")

    def _reconstruct(self) -> Path:
        """Photos of a bundled scene are rendered, and a model learns from them; returns its folder."""
        photos = self._scratch / "planar.photos"
        if not (photos / "dataset.json").exists():
            # Rendering is loaded by its name only: it is no part of the window.
            request = import_module("groundstation.services.scenes.views").SceneRequest
            render = import_module("groundstation.services.scenes.photos").render_photos
            render(request("planar", n_views=N_VIEWS, width_px=WIDTH_PX), photos)
        out = self._scratch / f"planar-{self._window.width()}.model"

        def page() -> ReconstructPage:
            return self._page("reconstruct", ReconstructPage)

        def rest() -> None:
            self._wait_for(lambda: page().pane.pictures_in_view.is_at_rest() and not page().pane.pictures.is_busy())
            self._wait_for(lambda: not self._context.jobs())

        def has_learned() -> bool:
            stepped = page().controller.training.stepped
            return stepped is not None and stepped.progress >= SHOWN_FROM

        self._controller.open_path(photos / "site.json")
        self._wait_until_idle()
        self._window.show_tab("reconstruct")
        page().controller.read(photos)
        self._wait_for(lambda: page().controller.card is not None and page().controller.cuda is not None)
        choice = TrainChoice(minutes=MINUTES)
        page().side.form.setValue(choice)
        page().controller.choose(choice)
        page().controller.choose_out(out)
        rest()
        self._take("reconstruct-chosen")
        page().side.train.click()
        self._wait_for(lambda: page().controller.training.stage is not None)
        self._take("reconstruct-preparing")
        self._wait_for(lambda: page().controller.training.n_first_looks > 0)
        rest()
        self._take("reconstruct-first-look")
        self._wait_for(has_learned)
        page().side.pause.click()
        rest()
        self._take("reconstruct-training")
        for layer in ("reflectivity", "fresnel", "reflection", "mirrored", "normals", "panels", "depth"):
            page().pane.bar.setValue("", layer, "")
            rest()
            self._take(f"reconstruct-{layer}")
        page().pane.bar.setValue("", "picture", "photo")
        rest()
        self._take("reconstruct-compare")
        for _ in range(6):
            page().pane.view.orbited.emit(-0.08, 0.02)
        rest()
        self._take("reconstruct-from-elsewhere")
        page().pane.view.homeRequested.emit()
        rest()
        for name in self._in_each_look():
            self._window.show_tab("reconstruct")
            page().pane.bar.setValue("", "depth" if name == "feet" else "picture", "photo")
            page().details.setCurrentWidget(page().progress)
            rest()
            self._take(f"{name}-reconstruct")
            page().details.setCurrentIndex(0)
            self._take(f"{name}-reconstruct-computer")
        self._window.show_tab("reconstruct")
        rest()
        page().side.pause.click()
        self._wait_for(lambda: page().controller.phase is Phase.IDLE)
        page().pane.worst.click()
        page().details.setCurrentIndex(2)
        rest()
        self._take("reconstruct-done")
        return out

    def _model(self, model: Path) -> None:
        """The model that was trained, with records of its panels."""

        def page() -> ModelPage:
            return self._page("model", ModelPage)

        def rest() -> None:
            self._wait_for(lambda: page().pane.pictures_in_view.is_at_rest() and not self._context.jobs())

        def colour_by(attribute: Computed) -> None:
            page().side.colour.setCurrentIndex(page().side.colour.findData(str(attribute)))

        self._window.show_tab("model")
        self._take("model-empty")
        page().controller.open(model)
        self._wait_for(lambda: page().controller.card is not None)
        rest()
        self._take("model-open")
        page().controller.select(_write_records(page()))
        colour_by(Computed.INSPECTED)
        rest()
        self._take("model-inspections")
        colour_by(Computed.DEFECTS)
        page().pane.front.click()
        rest()
        self._take("model-panel")
        page().side.colour.setCurrentIndex(0)
        page().pane.home.click()
        page().pane.axis.setCurrentIndex(1)
        rest()
        self._take("model-section")
        page().pane.axis.setCurrentIndex(0)
        for name in self._in_each_look():
            if name != "feet":
                self._window.show_tab("model")
                colour_by(Computed.INSPECTED)
                rest()
                self._take(f"{name}-model")

    # The window

    @property
    def _window(self) -> MainWindow:
        """The window as it is now: another language makes a new one."""
        return self._controller.window

    def _page(self, name: str, kind: type[Page]) -> Page:
        """The page of a tab."""
        page = self._window.tab(name)
        assert isinstance(page, kind)
        return page

    def _opened_site(self) -> SiteModel:
        site = self._context.document.site
        assert site is not None
        return site

    def _in_each_look(self) -> Iterator[str]:
        """Other themes, units and language one after the other, by name; English comes back at the end."""
        for name, changes in LOOKS:
            self._controller.choose(**changes)
            yield name
        self._controller.choose(language=Language.ENGLISH)

    def _take(self, name: str, widget: QWidget | None = None) -> None:
        self._rest(SETTLE_MS)
        for canvas in self._window.findChildren(Canvas):
            canvas.show_all_layers()
        path = self._folder / f"{name}.png"
        if not (self._window if widget is None else widget).grab().save(str(path)):
            raise InputError(say("the picture cannot be written", place=path))
        self._n_pictures += 1

    def _rest(self, duration_ms: int) -> None:
        loop = QEventLoop()
        QTimer.singleShot(duration_ms, loop.quit)
        loop.exec()

    def _rest_until(self, condition: Callable[[], bool]) -> None:
        while not condition():
            self._wait_until_idle()

    def _wait_until_idle(self) -> None:
        self._wait_for(lambda: not self._context.jobs())
        # A job's end can start the next one a little later.
        self._rest(SETTLE_MS)
        self._wait_for(lambda: not self._context.jobs())

    def _wait_for(self, condition: Callable[[], bool]) -> None:
        end_s = time.monotonic() + TIMEOUT_S
        while not condition():
            if time.monotonic() > end_s:
                raise TimeoutError("the window did not get where it should")
            self._rest(20)


def _choose_line(page: PhotosPage) -> None:
    """With the keyboard, as a user does."""
    page.pane.view.setFocus()
    for _ in range(4):
        QTest.keyClick(page.pane.view, Qt.Key.Key_Tab)


def _write_records(page: ModelPage) -> str:
    """Inspections of most panels, and some of all else for the one that is chosen; returns its global id."""
    card = page.controller.card
    assert card is not None
    chosen = int(CHOSEN * len(card.panels))
    entries: list[Inspection | Defect | Attribute] = []
    for number, panel in enumerate(card.panels):
        if number % LEFT_OUT or number == chosen:
            day = FIRST_DAY + timedelta(days=3 * (number % 60))
            entries.append(Inspection(panel.global_id, day.isoformat(), "M. Weber", "photos from the air", "good"))
    global_id = card.panels[chosen].global_id
    entries += [
        Attribute(global_id, "maker", "Glas Nord"),
        Attribute(global_id, "thickness", 8.0, "number", "mm"),
        Attribute(global_id, "installed_on", "2011-09-01", "date"),
        Defect(global_id, "crack", 3, "2026-05-04", 0.2, 0.7, note="from the left edge, 12 cm"),
    ]
    page.controller.put_all(entries)
    return global_id
