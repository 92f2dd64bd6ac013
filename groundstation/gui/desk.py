"""The desk: what happens to the project as a whole. New, open, save, autosave, recovery, settings, and the end.

It owns the workspace and the window, and makes the window anew when the language changes: everything that matters is
in the workspace, the window only shows it.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QTimer, Signal
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QApplication

from groundstation.gui.garbage import GarbageCollector
from groundstation.gui.languages import Translations
from groundstation.gui.main_window import MainWindow
from groundstation.gui.menus import Menus
from groundstation.gui.questions import Answer, Questions
from groundstation.gui.theme import apply_theme
from groundstation.gui.workspace import Workspace
from groundstation.services.autosave import Autosave, give_up_place, unsaved_place
from groundstation.services.document import Document
from groundstation.services.jobs import JobContext, JobRunner
from groundstation.services.project import OpenedProject, create_project, open_project, save_project
from groundstation.services.project_file import is_project
from groundstation.services.project_lock import ProjectLock, lock_project
from groundstation.services.recovery import Recovery, discard_recovery, find_recovery, find_unsaved, recover
from groundstation.services.session import Session
from groundstation.services.settings import Settings, read_settings, settings_path, write_settings
from planning.errors import GroundStationError, InputError
from planning.findings import Severity
from planning.request import PlanRequest


class Desk(QObject):
    """One project at a time, in one window.

    Signals
    -------
    opened()
        Another project, or a new one, is on the desk.
    autosaveFailed(str)
    """

    opened = Signal()
    autosaveFailed = Signal(str)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, application: QApplication, questions: Questions | None = None) -> None:
        super().__init__()
        self._application = application
        self._questions = Questions() if questions is None else questions
        self._settings, self._settings_problem = _read_settings()
        self._translations = Translations(application)
        self._garbage = GarbageCollector(self)
        self._runner = JobRunner(in_background=True)
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="autosave")
        self._lock: ProjectLock | None = None
        self._place: ProjectLock | None = None
        self._autosave: Autosave | None = None
        self.workspace = Workspace(Session(_first_document(self._settings)), self._runner, self)
        self.workspace.set_units(self._settings.units)
        self._dress()
        self.window = self._make_window()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.autosave_now)
        self.autosaveFailed.connect(lambda text: self.workspace.say(Severity.WARNING, text))
        self.workspace.documentChanged.connect(lambda *_: self._show_title())
        self._start_timer()

    # The window

    def _make_window(self) -> MainWindow:
        window = MainWindow(self.workspace)
        self.menus = Menus(window, self.workspace, self)
        window.closing.connect(self._window_closing)
        window.stage.tilesChanged.connect(self._tiles_changed)
        window.stage.sceneReady.connect(lambda _scene: self._garbage.settle())
        self._title_of(window)
        return window

    def show(self) -> None:
        """Show the window as it was left; then say what the settings file has wrong and look for unsaved work."""
        screen = self._application.primaryScreen().availableGeometry()
        self.window.resize(min(1400, screen.width()), min(900, screen.height()))
        self.window.set_layout_text(self._settings.window_layouts.get(self._layout_key(), ""))
        self.window.show()
        QTimer.singleShot(0, self._after_first_paint)

    def _after_first_paint(self) -> None:
        if self._settings_problem:
            self.workspace.say(
                Severity.WARNING,
                self.tr("{0}. The settings of the first start are used; the file stays as it is.").format(
                    self._settings_problem
                ),
            )
        if self._settings.map_tiles:
            self.window.stage.set_tiles(Path(self._settings.map_tiles))
        if self.workspace.session.folder is None:
            self._offer_unsaved(find_unsaved())

    def _rebuild_window(self) -> None:
        old, shown = self.window, self.window.shown_tab()
        layout, geometry = old.layout_text(), old.geometry()
        old.retire()
        self.window = self._make_window()
        self.window.setGeometry(geometry)
        self.window.show_tab(shown)
        self.window.set_layout_text(layout)
        self.window.show()
        if self._settings.map_tiles:
            self.window.stage.set_tiles(Path(self._settings.map_tiles))
        old.deleteLater()

    def _show_title(self) -> None:
        self._title_of(self.window)

    def _title_of(self, window: MainWindow) -> None:
        session = self.workspace.session
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
        self.workspace.set_units(self._settings.units)
        if before.language != self._settings.language:
            self._translations.use(self._settings.language)
            self._rebuild_window()
        if before.autosave_s != self._settings.autosave_s:
            self._start_timer()
        self._keep_settings()

    def open_map_tiles(self) -> None:
        """Ask for a file with map tiles."""
        name = self._questions.file(self.window, self.tr("Map tiles"), self.tr("Map tiles (*.mbtiles)"))
        if name is not None:
            self.window.stage.open_tiles(name)

    def _tiles_changed(self, path: str) -> None:
        self.choose(map_tiles=path)

    def _dress(self) -> None:
        self._translations.use(self._settings.language)
        apply_theme(self._application, self._settings.theme, self._settings.text_scale)

    def _keep_settings(self) -> None:
        if self._settings_problem:
            return  # the user's file has mistakes that are not ours to overwrite
        try:
            write_settings(settings_path(), self._settings)
        except InputError as error:
            self.workspace.say(Severity.WARNING, self.tr("The settings could not be kept: {0}").format(error))

    def _layout_key(self) -> str:
        size = self._application.primaryScreen().availableGeometry()
        return f"{size.width()}x{size.height()}"

    # Projects

    def new_project(self) -> None:
        """Start over, after asking about what is not saved."""
        self._leave(lambda: self._put_on_desk(_first_document(self._settings), None))

    def open_project(self) -> None:
        """Ask for a folder, and open it."""
        folder = self._questions.folder(self.window, self.tr("Open project"))
        if folder is not None:
            self.open_folder(folder)

    def open_recent(self, folder: str) -> None:
        """Open a project that was open before."""
        if not Path(folder).is_dir():
            self._settings = self._settings.without_recent(folder)
            self.workspace.say(
                Severity.ERROR,
                self.tr("{0}: this folder is not there any more; was it moved or renamed?").format(folder),
            )
            return
        self.open_folder(Path(folder))

    def open_folder(self, folder: Path) -> None:
        """Open a project, after asking about what is not saved."""
        held = self._lock if self._lock is not None and self._lock.folder.samefile(folder) else None

        def work(_context: object) -> _Taken:
            return _take_project(folder, held)

        self._leave(lambda: self._start_opening(work))

    def _start_opening(self, work: Callable[[JobContext], Any]) -> None:
        self.workspace.start(self.tr("Open project"), work, self._opened)

    def open_path(self, path: Path) -> None:
        """Open a project folder, its project.json, or a site file."""
        if path.is_dir() or path.name == "project.json":
            self.open_folder(path)
            return
        from groundstation.gui.site.site_opener import SiteOpener

        SiteOpener(self.workspace, self.window).open_site(path)

    def save(self, then: Callable[[], None] | None = None) -> None:
        """Save where the project is kept, or ask where."""
        folder = self.workspace.session.folder
        if folder is None or self._lock is None:
            self.save_as(then)
        else:
            self._save_in(folder, then)

    def save_as(self, then: Callable[[], None] | None = None) -> None:
        """Ask for a folder, and save there."""
        folder = self._questions.new_folder(self.window, self.tr("Save project as"))
        if folder is not None:
            self.save_in(folder, then)

    def save_in(self, folder: Path, then: Callable[[], None] | None = None) -> None:
        """Save as a new project in a folder."""
        self._save_in(folder, then)

    def _save_in(self, folder: Path, then: Callable[[], None] | None) -> None:
        document = self.workspace.document
        is_new = folder != self.workspace.session.folder or not is_project(folder)

        def work(_context: object) -> Document:
            if is_new:
                return create_project(folder, document, site_source=document.site_source)
            return save_project(folder, document, site_source=document.site_source)

        def done(written: Document) -> None:
            if is_new:
                self._hold(folder)
            self.workspace.session.saved(document, written, folder)
            if self._autosave is not None and self.workspace.session.is_saved:
                self._autosave.discard()
            self._remember(folder)
            self._show_title()
            self.workspace.say(Severity.OK, self.tr("Saved in {0}").format(folder))
            if then is not None:
                then()

        self.workspace.start(self.tr("Save"), work, done)

    def _opened(self, taken: _Taken) -> None:
        project, lock = taken.project, taken.lock
        if taken.problem:
            self.workspace.say(Severity.WARNING, taken.problem)
        site_source = project.folder / project.record.site if project.record.site else None
        self._put_on_desk(replace(project.document, site_source=site_source), project.folder, lock)
        for note in project.notes:
            self.workspace.say(note.severity, note.message)
        self._remember(project.folder)
        site = project.document.site
        n_panels = 0 if site is None else site.site.n_panels
        self.workspace.say(
            Severity.OK,
            self.tr("{0}: {1} panels, {2} plans").format(project.name, n_panels, len(project.document.plans)),
        )
        if lock is not None:
            found = find_recovery(project.folder)
            if found is not None:
                self._offer(found)

    def _put_on_desk(
        self, document: Document, folder: Path | None, lock: ProjectLock | None = None, *, saved: bool = True
    ) -> None:
        if lock is None or lock is not self._lock:
            self._release()
        self._lock = lock
        if lock is not None and self._autosave is None:
            self._autosave = Autosave(lock.folder, self._writer, self.autosaveFailed.emit)
        self.workspace.session.open(document, folder, saved=saved)
        self._show_title()
        self.opened.emit()

    def _hold(self, folder: Path) -> None:
        """Take a folder for this window that the document has just been saved in."""
        self._release()
        try:
            self._lock = lock_project(folder)
            self._autosave = Autosave(folder, self._writer, self.autosaveFailed.emit)
        except GroundStationError as error:
            self.workspace.say(Severity.WARNING, str(error))

    def _release(self) -> None:
        if self._autosave is not None:
            self._autosave.discard()
            self._autosave = None
        if self._place is not None:
            give_up_place(self._place)
            self._place = None
        if self._lock is not None:
            self._lock.release()
            self._lock = None

    def _remember(self, folder: Path) -> None:
        self._settings = self._settings.with_recent(folder)
        self._keep_settings()

    # Unsaved work

    def autosave_now(self) -> None:
        """Have a copy written of what is not saved."""
        session = self.workspace.session
        if session.is_saved:
            return
        if self._autosave is None:
            if session.folder is not None:
                return  # read-only, or open in another window: the user was told
            try:
                self._place = unsaved_place()
            except InputError as error:
                self._timer.stop()
                self.workspace.say(Severity.WARNING, str(error))
                return
            self._autosave = Autosave(self._place.folder, self._writer, self.autosaveFailed.emit)
        self._autosave.keep(session.document)

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
            self.workspace.say(Severity.WARNING, found.problem)
            self._discard(found)
            return False
        when = "" if found.saved_at is None else f"{found.saved_at.astimezone():%Y-%m-%d %H:%M}"
        answer = self._questions.recover(self.window, when, found.changes, found.is_of_saved_state)
        if answer is Answer.YES:
            self._take_over(found)
            return True
        if answer is Answer.NO:
            self._discard(found)
        return False

    def _take_over(self, found: Recovery) -> None:
        """Go on with unsaved work; its copy stays until it is saved."""
        project = recover(found)
        document = replace(project.document, site_source=None)
        if self.workspace.session.folder is not None:
            self.workspace.session.open(document, self.workspace.session.folder, saved=False)
            self.opened.emit()
        else:
            try:
                self._place = lock_project(found.folder)
            except GroundStationError as error:
                self.workspace.say(Severity.WARNING, str(error))
                return
            self._autosave = Autosave(found.folder, self._writer, self.autosaveFailed.emit)
            self.workspace.session.open(document, None, saved=False)
            self.opened.emit()
        self._show_title()

    def _discard(self, found: Recovery) -> None:
        try:
            discard_recovery(found)
        except InputError as error:
            self.workspace.say(Severity.WARNING, str(error))

    # The end

    def _leave(self, go_on: Callable[[], None]) -> None:
        """Go on to something else, after asking about what is not saved."""
        if self.workspace.session.is_saved:
            go_on()
            return
        answer = self._questions.save_first(self.window)
        if answer is Answer.YES:
            self.save(go_on)
        elif answer is Answer.NO:
            go_on()

    def _window_closing(self, event: QCloseEvent) -> None:
        if not self.workspace.session.is_saved:
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
        self._release()
        self._writer.shutdown(wait=True)
        self._runner.shutdown()
        self._garbage.close()


@dataclass(frozen=True, slots=True, eq=False)
class _Taken:
    """A project that was read, and the lock on it or why there is none."""

    project: OpenedProject
    lock: ProjectLock | None
    problem: str


def _take_project(folder: Path, held: ProjectLock | None) -> _Taken:
    """Lock a project, then read it; it can be looked at without the lock."""
    lock, problem = held, ""
    if lock is None:
        try:
            lock = lock_project(folder)
        except GroundStationError as error:
            problem = str(error)
    try:
        return _Taken(open_project(folder), lock, problem)
    except BaseException:
        if lock is not None and lock is not held:
            lock.release()
        raise


def _read_settings() -> tuple[Settings, str]:
    try:
        return read_settings(settings_path()), ""
    except InputError as error:
        return Settings(), str(error)


def _first_document(settings: Settings) -> Document:
    return Document(request=PlanRequest(profile_id=settings.default_profile))
