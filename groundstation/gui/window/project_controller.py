"""The controller: what happens to the project as a whole. New, open, save, autosave, recovery, settings, and the end.

It owns the context and the window, and makes the window anew when the language changes: everything that matters is
in the context, the window only shows it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from PySide6.QtCore import QCoreApplication, QEvent, QObject, QTimer, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QApplication, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.interpreter import (
    GarbageCollector,
    leave_modules_alone,
    make_types_of_qt,
    take_short_turns,
)
from groundstation.gui.application.translate import Translations
from groundstation.gui.start_page import StartPage
from groundstation.gui.widgets.icons import tint_all
from groundstation.gui.widgets.questions import Answer, Questions, file_name
from groundstation.gui.widgets.theme import apply_theme
from groundstation.gui.window.help import Stop, Tour
from groundstation.gui.window.main_window import MainWindow
from groundstation.gui.window.menus import Menus
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.jobs.worker import Worker
from groundstation.services.map.online import OnlineMap
from groundstation.services.project.document import Document
from groundstation.services.project.folder import create_project, save_project
from groundstation.services.project.lock import ProjectLock
from groundstation.services.project.project_file import is_project
from groundstation.services.project.recovery import Recovery, discard_recovery, find_recovery, find_unsaved, recover
from groundstation.services.project.sample import sample_folder, unpack_sample
from groundstation.services.project.session import LockedProject, ProjectSession, Session
from groundstation.services.project.steps import Act, FoundFiles, steps_in_folder
from groundstation.services.settings import Settings, settings_at_start, settings_path, write_settings
from planning.aircraft.catalogue import profiles
from planning.base.errors import GroundStationError, InputError
from planning.base.findings import Severity
from planning.base.progress import hear_compiling
from planning.geo.enu import geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.request import PlanRequest

if TYPE_CHECKING:
    from groundstation.gui.site.site_opener import SiteOpener


class ProjectController(QObject):
    """One project at a time, in one window.

    Signals
    -------
    opened()
        Another project, or a new one, is on the controller.
    autosaveFailed(Message)
    """

    opened = Signal()
    autosaveFailed = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(
        self, application: QApplication, questions: Questions | None = None, worker: Worker | None = None
    ) -> None:
        super().__init__()
        leave_modules_alone()
        take_short_turns()
        self._application = application
        self._questions = Questions() if questions is None else questions
        self._settings_problems: list[str] = []
        self._settings = settings_at_start(settings_path(), self._settings_problems.append)
        self._translations = Translations(application)
        self._garbage = GarbageCollector(self, lambda: self.context.is_busy)
        self._owns_worker, self._worker = worker is None, worker or Worker()
        self._runner = JobRunner(worker=self._worker)
        self.project_session = ProjectSession(self.autosaveFailed.emit)
        self.context = ApplicationContext(Session(_first_document(self._settings)), self._runner, self)
        self.context.set_units(self._settings.units)
        self.context.set_models_drawn_by(self._settings.models_drawn_by)
        self._translations.use(self._settings.language)
        self._dress()
        self.window = self._make_window()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.autosave_now)
        self.autosaveFailed.connect(lambda text: self._warn(text, "project.copy"))
        self.context.documentChanged.connect(lambda *_: self._show_title())
        self.context.documentChanged.connect(self._site_came)
        self._start_timer()
        self._hear_no_more = hear_compiling(self._say_compiling)
        make_types_of_qt()
        self._garbage.freeze()

    # The window

    def _make_window(self) -> MainWindow:
        window = MainWindow(self.context)
        self.menus = Menus(window, self.context, self)
        window.closing.connect(self._window_closing)
        window.shared_view.tilesChanged.connect(self._tiles_changed)
        window.shared_view.overlaysChanged.connect(self._overlays_changed)
        window.shared_view.onlineChanged.connect(self._online_changed)
        window.shared_view.sceneReady.connect(lambda _scene: self._scene_is_ready())
        self._title_of(window)
        self._serve(start_page_of(window))
        return window

    def _serve(self, start: StartPage) -> None:
        """Do what the start page offers."""
        start.sampleRequested.connect(self.open_sample)
        start.bundledRequested.connect(self._open_bundled)
        start.projectRequested.connect(self.open_project)
        start.recentRequested.connect(self.open_recent)
        for signal, tab, act in (
            (start.buildingRequested, "site", Act.IMPORT_BUILDING),
            (start.photosRequested, "photos", Act.FROM_PHOTOS),
            (start.missionRequested, "mission", Act.IMPORT_MISSION),
        ):
            signal.connect(partial(self._begin, tab, act))
        start.tourRequested.connect(self._answer_tour)
        start.manualRequested.connect(lambda: self.window.open_manual())
        start.set_recent(self._settings.recent_projects)
        start.offer_tour(not self._settings.has_seen_tour)

    def take_tour(self) -> None:
        """Show the window part by part."""
        Tour(self.window, _stops_of(self.window)).begin()

    def _answer_tour(self, is_wanted: bool) -> None:
        """Take the tour or not; it is not offered again."""
        self.choose(has_seen_tour=True)
        start_page_of(self.window).offer_tour(False)
        if is_wanted:
            self.take_tour()

    def _begin(self, tab: str, act: Act) -> None:
        """Begin a project in the way that was chosen; what is open is left first."""

        def go_on() -> None:
            if self.context.document.site is not None:
                self._put_on_controller(_first_document(self._settings), None)
            self.window.lead_to(tab, act)

        self._leave(go_on)

    def _open_bundled(self) -> None:
        def go_on() -> None:
            self._put_on_controller(_first_document(self._settings), None)
            self._with_opener(self.tr("Bundled site"), lambda opener: opener.open_bundled("office"))

        self._leave(go_on)

    def _with_opener(self, job: str, then: Callable[[SiteOpener], object]) -> None:
        """Open a site, once what opens one is imported: the window would stand still for that, over a second."""

        def go_on(module: ModuleType) -> None:
            then(module.SiteOpener(self.context, self.window))

        def work(_context: object) -> ModuleType:
            self._make_ready()
            return import_module("groundstation.gui.site.site_opener")

        self.context.start(job, work, go_on)

    def open_sample(self) -> None:
        """Open the finished sample; a copy of it is made where there is none yet."""

        def go_on() -> None:
            job = self.tr("Sample project")
            self.context.start(job, lambda context: unpack_sample(sample_folder(), context), self.open_folder)

        self._leave(go_on)

    def show(self) -> None:
        """Show the window as it was left; then say what the settings file has wrong and look for unsaved work."""
        screen = self._application.primaryScreen().availableGeometry()
        self.window.resize(min(1400, screen.width()), min(900, screen.height()))
        self.window.set_layout_text(self._settings.window_layouts.get(self._layout_key(), ""))
        self.window.show()
        QTimer.singleShot(0, self._after_first_paint)

    def _scene_is_ready(self) -> None:
        self._garbage.freeze()
        threading.Thread(target=self._read_tables, name="read-tables", daemon=True).start()

    def _read_tables(self) -> None:
        """On another thread: read what the window's thread would stand still for when it first wants it."""
        profiles()
        undulation_m(0.0, 0.0)

    def _make_ready(self) -> None:
        """On another thread: load what a site is shown with; a start page can do without, and without its memory."""
        from groundstation.gui.view3d.picking import load_kernels

        self._read_tables()
        geodetic_from_enu(Origin(0.0, 0.0, 0.0), np.zeros((1, 3)))
        load_kernels()

    def _site_came(self, before: Document, after: Document) -> None:
        """On another thread: start the process that plans, which a start page can do without, too."""
        if before.site is None and after.site is not None:
            threading.Thread(target=self._start_worker, name="start-worker", daemon=True).start()

    def _say_compiling(self, text: str) -> None:
        """On whatever thread: say why something takes long this once."""
        self.context.say(Severity.NOTE, self.context.localized(text))

    def _start_worker(self) -> None:
        self._make_ready()  # for a site that no job of this controller has opened
        from groundstation.services.plan.planning import load_planning

        self._worker.start(load_planning)

    def _after_first_paint(self) -> None:
        for problem in self._settings_problems:
            self.context.say(Severity.WARNING, self.context.localized(problem), about=f"settings.{problem}")
        self._set_map()
        if self.context.session.folder is None:
            self._offer_unsaved(find_unsaved())

    def _change_language(self) -> None:
        if self.context.jobs():
            # Their results belong to widgets of this window.
            text = self.tr("Something is running: the language changes when Reflight is started next.")
            self.context.say(Severity.NOTE, text)
            return
        self._translations.use(self._settings.language)
        self._rebuild_window()

    def _rebuild_window(self) -> None:
        old, shown = self.window, self.window.shown_tab()
        layout, geometry = old.layout_text(), old.geometry()
        old.retire()
        self.window = self._make_window()
        self.window.messages.take_over(old.messages)
        self.window.setGeometry(geometry)
        if shown:
            self.window.show_tab(shown)
        self.window.set_layout_text(layout)
        self.window.show()
        self._set_map()
        old.deleteLater()

    def _show_title(self) -> None:
        self._title_of(self.window)

    def _title_of(self, window: MainWindow) -> None:
        session = self.context.session
        site = session.document.site
        name = session.folder.name if session.folder is not None else self.tr("New project")
        if site is not None and session.folder is None:
            name = site.site.name
        window.setWindowTitle(f"{name}[*] - Reflight")
        window.setWindowModified(not session.is_saved)

    # Settings

    def settings(self) -> Settings:
        """As they are."""
        return self._settings

    def choose(self, **changes: Any) -> None:
        """Change settings by name, take them over at once, and keep them."""
        before, self._settings = self._settings, replace(self._settings, **changes)
        if (before.theme, before.text_scale) != (self._settings.theme, self._settings.text_scale):
            self._dress()
        self.context.set_units(self._settings.units)
        self.context.set_models_drawn_by(self._settings.models_drawn_by)
        if before.language != self._settings.language:
            self._change_language()
        if before.autosave_s != self._settings.autosave_s:
            self._start_timer()
        self._keep_settings()

    def open_map_tiles(self) -> None:
        """Ask for a file with map tiles."""
        name = self._questions.file(self.window, self.tr("Map tiles"), self.tr("Map tiles (*.mbtiles *.pmtiles)"))
        if name is not None:
            self.window.shared_view.open_tiles(name)

    def _set_map(self) -> None:
        """Let the map be as it was left, once it is shown."""
        kept, view = self._settings, self.window.shared_view
        if kept.map_tiles:
            view.set_tiles(Path(kept.map_tiles))
        online = OnlineMap(
            kept.online_map_url,
            kept.online_map_attribution,
            kept.online_map_max_zoom,
            kept.online_map_cache_mb,
            kept.online_map_is_on,
        )
        view.set_map(tuple(map(Path, kept.map_overlays)), online)

    def _tiles_changed(self, path: str) -> None:
        self.choose(map_tiles=path)

    def _overlays_changed(self, paths: tuple[Path, ...]) -> None:
        self.choose(map_overlays=tuple(map(str, paths)))

    def _online_changed(self, online: OnlineMap) -> None:
        self.choose(
            online_map_url=online.url,
            online_map_attribution=online.attribution,
            online_map_max_zoom=online.max_zoom,
            online_map_cache_mb=online.cache_mb,
            online_map_is_on=online.is_on,
        )

    def _dress(self) -> None:
        apply_theme(self._application, self._settings.theme, self._settings.text_scale)
        tint_all(self._application)

    def _keep_settings(self) -> None:
        try:
            write_settings(settings_path(), self._settings)
        except InputError as error:
            self.context.say(
                Severity.WARNING,
                self.tr("The settings could not be kept: {0}").format(self.context.localized(str(error))),
                about="settings.kept",
            )
        else:
            self.context.withdraw("settings.kept")

    def _layout_key(self) -> str:
        size = self._application.primaryScreen().availableGeometry()
        return f"{size.width()}x{size.height()}"

    # Projects

    def new_project(self) -> None:
        """Start over, after asking about what is not saved."""
        self._leave(lambda: self._put_on_controller(_first_document(self._settings), None))

    def open_project(self) -> None:
        """Ask for a folder, and open it."""
        project = self.context.session.folder
        start_folder = None if project is None else project.parent
        folder = self._questions.folder(self.window, self.tr("Open project"), start_folder)
        if folder is not None:
            self.open_folder(folder)

    def open_recent(self, folder: str) -> None:
        """Open a project that was open before."""
        if not Path(folder).is_dir():
            self._settings = self._settings.without_recent(folder)
            self.context.say(
                Severity.ERROR,
                self.tr("{0}: this folder is not there any more; was it moved or renamed?").format(folder),
            )
            return
        self.open_folder(Path(folder))

    def open_folder(self, folder: Path) -> None:
        """Open a project, after asking about what is not saved; a finished model on its tab, beside what is open."""
        if is_project(folder):
            self._open_project(folder)
        else:
            module = "groundstation.gui.model.model_controller"
            self.context.start(
                self.tr("Open the model"), lambda _context: import_module(module), partial(self._open_model, folder)
            )

    def _open_model(self, folder: Path, module: ModuleType) -> None:
        """Open a finished model; what is neither that nor a project is told of."""
        if module.is_scene(folder) or module.is_model(folder):
            self.window.lead_to("model")
            module.ModelController.of(self.context).open(folder)
        else:
            self._open_project(folder)

    def _open_project(self, folder: Path) -> None:
        def open_it() -> None:
            take = self.project_session.opening_job(folder)

            def work(_context: object) -> LockedProject:
                self._make_ready()
                return take()

            self.context.start(self.tr("Open project"), work, self._opened)

        self._leave(open_it)

    def open_path(self, path: Path) -> None:
        """Open the folder of a project or a finished model, a project.json, or a site file."""
        if path.is_dir() or path.name == "project.json":
            self.open_folder(path)
            return
        self._with_opener(self.tr("Open {0}").format(path.name), lambda opener: opener.open_site(path))

    def save(self, then: Callable[[], object] | None = None) -> None:
        """Save where the project is kept, or ask where."""
        folder = self.context.session.folder
        if folder is None or not self.project_session.may_save:
            self.save_as(then)
        else:
            self._save_in(folder, then)

    def save_as(self, then: Callable[[], object] | None = None) -> None:
        """Ask for a folder, and save there."""
        session = self.context.session
        site = session.document.site
        name = self.tr("New project") if site is None else file_name(site.site.name)
        start_folder = Path.home() if session.folder is None else session.folder.parent
        folder = self._questions.new_folder(self.window, self.tr("Save project as"), start_folder / name)
        if folder is not None:
            self.save_in(folder, then)

    def save_in(self, folder: Path, then: Callable[[], object] | None = None) -> None:
        """Save as a new project in a folder."""
        self._save_in(folder, then)

    def _save_in(self, folder: Path, then: Callable[[], object] | None) -> None:
        document = self.context.document
        is_new = folder != self.context.session.folder or not is_project(folder)

        def work(_context: object) -> Document:
            if is_new:
                return create_project(folder, document, site_source=document.site_source)
            return save_project(folder, document, site_source=document.site_source)

        def done(written: Document) -> None:
            if is_new:
                self.context.withdraw("project.lock")  # it spoke of the folder that was left
                self._or_warn(lambda: self.project_session.switch_to_saved(folder))
            self.context.session.saved(document, written, folder)
            self.context.withdraw("project.copy")
            if self.context.session.is_saved:
                self.project_session.drop_copy()
            self._remember(folder)
            self._show_title()
            self.context.say(Severity.OK, self.tr("Saved in {0}").format(folder))
            if then is not None:
                then()

        self.context.start(self.tr("Save"), work, done)

    def _opened(self, opened: LockedProject) -> None:
        project = opened.project
        site_source = project.folder / project.record.site if project.record.site else None
        self._put_on_controller(replace(project.document, site_source=site_source), project.folder, opened.lock)
        if opened.problem:
            self._warn(opened.problem, "project.lock")
        for note in project.notes:
            text = self.context.localized(note.message)
            self.context.say(note.severity, text, about=f"project.note.{text}")
        self._remember(project.folder)
        site = project.document.site
        n_panels = 0 if site is None else site.site.n_panels
        self.context.say(
            Severity.OK,
            self.tr("{0}: {1} panels, {2} plans").format(project.name, n_panels, len(project.document.plans)),
        )
        found = find_recovery(project.folder) if opened.lock is not None else None
        if found is not None:
            self._offer(found)

    def _put_on_controller(self, document: Document, folder: Path | None, lock: ProjectLock | None = None) -> None:
        self.project_session.switch_to(lock)
        for topic in ("project.", "plan.", "job."):
            self.context.withdraw(topic)
        self.context.session.open(document, folder)
        self.context.begin_anew()
        if folder is not None:
            self._look_at_steps(folder)
        self._show_title()
        self.opened.emit()

    def _look_at_steps(self, folder: Path) -> None:
        """Tick what was done in a project on other days."""
        current = self.context.document.current
        plan = None if current is None else current.plan

        def done(found: FoundFiles) -> None:
            shown = self.context.document.current
            if self.context.session.folder == folder and (None if shown is None else shown.plan) is plan:
                self.context.note(**{field.name: getattr(found, field.name) for field in fields(found)})

        self.context.start(self.tr("Look at the project"), lambda _context: steps_in_folder(folder, plan), done)

    def _or_warn(self, action: Callable[[], None]) -> bool:
        """Do something whose failure the user is told of; True where it was done."""
        try:
            action()
        except GroundStationError as error:
            self._warn(str(error))
            return False
        return True

    def _warn(self, text: str, about: str = "") -> None:
        """Show what a part without Qt warns of."""
        self.context.say(Severity.WARNING, self.context.localized(text), about=about)

    def _remember(self, folder: Path) -> None:
        self._settings = self._settings.with_recent(folder)
        self._keep_settings()
        start_page_of(self.window).set_recent(self._settings.recent_projects)

    # Unsaved work

    def autosave_now(self) -> None:
        """Have a copy written of what is not saved."""
        if not self._or_warn(lambda: self.project_session.copy(self.context.session)):
            self._timer.stop()

    def _start_timer(self) -> None:
        self._timer.stop()
        if self._settings.autosave_s > 0.0:
            self._timer.start(round(1000.0 * self._settings.autosave_s))

    def _offer_unsaved(self, found: tuple[Recovery, ...]) -> None:
        for recovery in found:
            if self._offer(recovery):
                return

    def _offer(self, found: Recovery) -> bool:
        """Ask whether unsaved work is wanted; True where it was taken over."""
        if found.problem:
            self._warn(found.problem)
            self._discard(found)
            return False
        when = "" if found.saved_at is None else f"{found.saved_at.astimezone():%Y-%m-%d %H:%M}"
        changes = tuple(map(self.context.localized, found.changes)) if found.was_saved else ()
        answer = self._questions.recover(self.window, when, changes, found.is_of_saved_state)
        if answer is Answer.YES:
            self._take_over(found)
            return True
        if answer is Answer.NO:
            self._discard(found)
        return False

    def _take_over(self, found: Recovery) -> None:
        """Go on with unsaved work; its copy stays until it is saved."""
        document = replace(recover(found).document, site_source=None)
        folder = self.context.session.folder
        if folder is None and not self._or_warn(lambda: self.project_session.switch_to_recovered(found.folder)):
            return
        self.context.session.open(document, folder, saved=False)
        self._show_title()
        self.opened.emit()
        text = self.tr("Your work is back. It is not saved yet: Project > Save keeps it.")
        self.context.say(Severity.OK, text)

    def _discard(self, found: Recovery) -> None:
        self._or_warn(lambda: discard_recovery(found))

    # The end

    def _leave(self, go_on: Callable[[], None]) -> None:
        """Go on to something else, after asking about what is not saved."""
        if self.context.session.is_saved:
            go_on()
            return
        answer = self._questions.save_first(self.window)
        if answer is Answer.YES:
            self.save(go_on)
        elif answer is Answer.NO:
            self.project_session.drop_copy()
            go_on()

    def _window_closing(self, event: QCloseEvent) -> None:
        if not self.context.session.is_saved:
            answer = self._questions.save_first(self.window)
            if answer is Answer.YES:
                event.ignore()
                self.save(self.window.close)
                return
            if answer is Answer.CANCEL:
                event.ignore()
                return
        layouts = {**self._settings.window_layouts, self._layout_key(): self.window.layout_text()}
        self._settings = replace(self._settings, window_layouts=layouts)
        self._keep_settings()

    def close(self) -> None:
        """After the window has gone: let go of everything."""
        self._timer.stop()
        # With the window go the timers that would still start jobs.
        self.window.deleteLater()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        self._translations.remove()
        self.project_session.close()
        self._hear_no_more()
        if self._owns_worker:
            self._worker.close()
        self._runner.shutdown()
        self._garbage.close()


def start_page_of(window: MainWindow) -> StartPage:
    """The start page of a window."""
    page = window.tab("start")
    assert isinstance(page, StartPage)
    return page


def _first_document(settings: Settings) -> Document:
    return Document(request=PlanRequest(profile_id=settings.default_profile))


def _stops_of(window: MainWindow) -> tuple[Stop, ...]:
    """What the tour shows, in order."""
    translate = QCoreApplication.translate

    def on_tab(name: str, part: QWidget) -> Callable[[], QWidget]:
        def found() -> QWidget:
            if window.shown_tab() != name:
                window.show_tab(name)
            return part

        return found

    return (
        Stop(
            translate("Tour", "Where to begin"),
            translate("Tour", "The sample project has every step done: look around in it, nothing can break."),
            on_tab("start", window.tab("start").left),
        ),
        Stop(
            translate("Tour", "Seven steps"),
            translate("Tour", "They stand in the order of the work. A tick says that a step is done."),
            on_tab("start", window.tab_bar()),
        ),
        Stop(
            translate("Tour", "What comes next"),
            translate("Tour", "This line says what is done and what comes next. The blue button leads there."),
            on_tab("site", window.next_step),
        ),
        Stop(
            translate("Tour", "The view"),
            translate("Tour", "The site in 3-D, on the map, or as a camera will see it. Drag to turn, wheel to zoom."),
            on_tab("site", window.shared_view),
        ),
        Stop(
            translate("Tour", "Help"),
            translate("Tour", "The manual's page of this tab. A “?” beside a word says what it means."),
            on_tab("site", window.next_step.help),
        ),
        Stop(
            translate("Tour", "Messages"),
            translate("Tour", "What holds now, and all that was told. What runs stands beside it, with its time."),
            on_tab("site", window.messages),
        ),
    )
