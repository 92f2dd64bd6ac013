"""What the Model tab works on: a scene of objects, the panel that is looked at, its records, and who shows models."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.services.jobs.channel import ProcessEnded
from groundstation.services.jobs.runner import JobContext
from groundstation.services.jobs.worker import Worker
from groundstation.services.model.export import ModelExport, WrittenModel, export_model_in_process
from groundstation.services.model.facility_records import (
    Attachment,
    Exported,
    Imported,
    attachments_of,
    book_of_scene,
    export_tables,
    import_records,
    open_records,
    user_name,
    with_file,
)
from groundstation.services.model.panel_colours import NO_COLOURS, Colouring, colouring
from groundstation.services.model.scene_card import (
    Level,
    SceneCard,
    Subject,
    is_model,
    is_scene,
    read_card,
    scenes_beside,
)
from groundstation.services.reconstruct.messages import (
    ModelProcess,
    Organise,
    Probe,
    Probed,
    SceneMade,
    Tints,
    ViewAnswer,
    ViewRequest,
)
from planning.base.errors import GroundStationError
from planning.base.findings import Severity

if TYPE_CHECKING:
    from reconstruction.records.book import RecordBook
    from reconstruction.records.entries import Entry
    from reconstruction.records.queries import Hit


class ModelController(QObject):
    """Keeps what is known, and passes on what the user wants.

    Signals
    -------
    sceneChanged()
        Another one was read.
    selectionChanged()
        Another panel, or none.
    subjectChanged()
        Records of something else are looked at: of a facade, or the building.
    recordsChanged()
        Something was written.
    coloursChanged()
    viewAnswered(ViewAnswer or None), probed(Probed)
        A picture came (None: the process has ended, so what was asked for will not come); a probe was answered.
    """

    sceneChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    selectionChanged = Signal()  # noqa: N815
    subjectChanged = Signal()  # noqa: N815
    recordsChanged = Signal()  # noqa: N815
    coloursChanged = Signal()  # noqa: N815
    viewAnswered = Signal(object)  # noqa: N815
    probed = Signal(object)
    _came = Signal(object)

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._process = ModelProcess(self._came.emit)
        self._came.connect(self._take)
        self.card: SceneCard | None = None
        self.others: tuple[Path, ...] = ()
        self.beside: SceneCard | None = None
        self._wanted_beside: Path | None = None
        self.selected = ""
        self.level: Level = "panel"
        self.colour_by = ""
        self.colouring: Colouring = NO_COLOURS
        self.is_reading = False
        self.tables: Path | None = None
        self.sceneChanged.connect(lambda: context.note(is_model_open=self.card is not None))

    @classmethod
    def of(cls, context: ApplicationContext) -> ModelController:
        """The one of a context: it stays when the window is made anew."""
        found = context.findChild(ModelController)
        return cls(context, context) if found is None else found

    # The scene

    def open(self, folder: Path) -> None:
        """Read a scene of objects; a trained model is organised as one beside it first."""
        if self.is_reading:
            return
        self.is_reading = True
        self.sceneChanged.emit()
        if is_scene(folder) or not is_model(folder):
            self._read(folder)
        else:
            self._process.send(Organise(folder))

    def _read(self, folder: Path) -> None:
        def work(_context: JobContext) -> tuple[SceneCard, tuple[Path, ...]]:
            return read_card(folder), scenes_beside(folder)

        self._context.start(self.tr("Open the model"), work, self._opened, self._not_opened)

    def _take_scene(self, scene: SceneMade) -> None:
        if scene.folder is not None:
            self._read(scene.folder)
            return
        self._context.say(Severity.ERROR, self._context.localized(scene.problem))
        self._not_opened(None)

    def _opened(self, found: tuple[SceneCard, tuple[Path, ...]]) -> None:
        self.is_reading = False
        self.card, self.others = found
        self.selected, self.colour_by = "", ""
        self.level = "panel" if self.card.panels else "building"
        self._colour()
        self.sceneChanged.emit()
        self.selectionChanged.emit()
        self.recordsChanged.emit()

    def _not_opened(self, _error: BaseException | None) -> None:
        self.is_reading = False
        self.sceneChanged.emit()

    def set_comparison_scene(self, folder: Path | None) -> None:
        """Read what is known of another scene, whose picture stands beside: its panels have numbers of its own."""
        self._wanted_beside = folder
        if self.beside is not None and self.beside.folder == folder:
            return
        self.beside = None
        if folder is not None:
            self._context.start(self.tr("Open the model beside it"), lambda _context: read_card(folder), self._stands)

    def _stands(self, card: SceneCard) -> None:
        if card.folder == self._wanted_beside:
            self.beside = card
            self.coloursChanged.emit()

    # Pictures

    def request_view(self, look: ViewRequest) -> None:
        """Ask for a picture."""
        self._process.send(look)

    def probe(self, probe: Probe) -> None:
        """Ask what is at a place."""
        self._process.send(probe)

    def close(self) -> None:
        """The window goes."""
        self._process.close()

    # For other programs

    def export(self, out: Path, export: ModelExport) -> None:
        """Write the scene, in a process beside this one and that of the pictures."""
        card = self.card
        if card is None:
            return

        def work(context: JobContext) -> WrittenModel:
            worker = Worker()
            try:
                return worker.run(
                    export_model_in_process,
                    card.folder,
                    out,
                    export,
                    stop=context.stop,
                    trace=context.trace,
                    monitor=context,
                )
            finally:
                worker.close()

        self._context.start(self.tr("Export the model"), work, self._exported)

    def _exported(self, done: WrittenModel) -> None:
        text = self.tr("The model is written: {0}, {1} MB").format(done.path, f"{done.n_bytes / 1e6:.3g}")
        notes = [str(self._context.localized(note)) for note in done.notes]
        self._context.say(Severity.NOTE, "; ".join([text, *notes]))

    # Panels

    def select(self, global_id: str) -> None:
        """Turn to a panel; "" for none."""
        if global_id != self.selected:
            self.selected = global_id
            self.selectionChanged.emit()

    def look_at(self, level: Level) -> None:
        """Turn to records of the panel, of its facade, or of the building."""
        if level != self.level:
            self.level = level
            self.subjectChanged.emit()

    @property
    def subject(self) -> Subject | None:
        """What records are looked at of."""
        return None if self.card is None else self.card.subject(self.level, self.selected)

    def colour(self, by: str) -> None:
        """Colour panels by something (see `colouring`)."""
        self.colour_by = by
        self._colour()

    @property
    def tints(self) -> Tints:
        """Colours by panels' numbers."""
        return self._tints_of(self.card)

    @property
    def comparison_tints(self) -> Tints:
        """The same colours by the numbers that the panels have in what stands beside."""
        return self._tints_of(self.beside)

    def _tints_of(self, card: SceneCard | None) -> Tints:
        panels, found = {} if card is None else card.by_global_id, self.colouring.colours
        return tuple((panels[each].element.panel, colour) for each, colour in found.items() if each in panels)

    def _colour(self) -> None:
        facades = {} if self.card is None else {panel.global_id: panel.facade for panel in self.card.panels}
        try:
            with self._reading() as book:
                self.colouring = colouring(book, self.colour_by, facades)
        except GroundStationError as error:
            self.colouring = NO_COLOURS
            self._say(error)
        self.coloursChanged.emit()

    # Records

    @property
    def has_records(self) -> bool:
        """Whether there is a book of them beside the scene."""
        return self.card is not None and self._book_path.is_file()

    def entries(self, kind: type[Entry]) -> tuple[Any, ...]:
        """Of what is looked at."""
        return self.entries_of(kind, self.subject.global_id) if self.subject is not None else ()

    def entries_of(self, kind: type[Entry], global_id: str) -> tuple[Any, ...]:
        """Of a panel, a facade, or the building."""
        try:
            with self._reading() as book:
                return () if book is None else book.entries(kind, global_id)
        except GroundStationError as error:
            self._say(error)
            return ()

    def entries_of_all(self, global_ids: Iterable[str]) -> dict[str, dict[type[Any], tuple[Any, ...]]]:
        """Entries of several, by kind; of kinds that there are none of nothing."""
        from reconstruction.records.entries import KINDS

        found: dict[str, dict[type[Any], tuple[Any, ...]]] = {global_id: {} for global_id in global_ids}
        try:
            with self._reading() as book:
                for kind in KINDS if book is not None else ():
                    for entry in book.entries(kind.record):
                        if entry.global_id in found:
                            of_kind = found[entry.global_id]
                            of_kind[kind.record] = (*of_kind.get(kind.record, ()), entry)
        except GroundStationError as error:
            self._say(error)
        return found

    def read_attached(
        self,
        entries: Sequence[Entry],
        longest_px: int,
        when_done: Callable[[dict[str, Attachment]], None],
        when_failed: Callable[[BaseException | None], None],
    ) -> None:
        """Read the files that records name, see `attachments_of`."""
        card = self.card
        assert card is not None

        def work(context: JobContext) -> dict[str, Attachment]:
            return attachments_of(card.folder, entries, longest_px, context)

        self._context.start(self.tr("Read what is attached to records"), work, when_done, when_failed)

    def attribute_names(self) -> tuple[str, ...]:
        """Attributes that panels can be coloured by."""
        from reconstruction.records.queries import attribute_names

        try:
            with self._reading() as book:
                return () if book is None else attribute_names(book)
        except GroundStationError as error:
            self._say(error)
            return ()

    def search(self, query: str) -> tuple[Hit, ...]:
        """Records that have these words."""
        from reconstruction.records.queries import search

        try:
            with self._reading() as book:
                return () if book is None else search(book, query)
        except GroundStationError as error:
            self._say(error)
            return ()

    def put(self, entry: Entry, file: Path | None = None) -> str:
        """Add an entry, or replace the one with its key; returns why not, and nothing where it is there now.

        Parameters
        ----------
        file
            Picture of a defect, or a document: a copy is kept beside the records.
        """
        return self._refused(lambda book: book.put(with_file(book, entry, file)))

    def put_all(self, entries: Sequence[Entry]) -> bool:
        """Add several in one step that is taken back as one."""

        def change(book: RecordBook) -> None:
            with book.changing("several records") as changes:
                for entry in entries:
                    changes.put(entry)

        return self._write(change)

    def remove(self, entry: Entry) -> bool:
        """Take an entry out; the history keeps it."""
        return self._write(lambda book: book.remove(entry))

    def undo(self) -> bool:
        """Take the last change of records back."""
        return self._write(lambda book: book.undo())

    def write_tables(self, folder: Path, semicolon: bool) -> None:
        """Write all records as tables into a folder; where there are none yet, with the panels to be filled in.

        Parameters
        ----------
        semicolon
            With semicolons and decimal commas.
        """
        card = self.card
        if card is None:
            return

        def work(_context: JobContext) -> Exported:
            with open_records(card.folder) if has_records else book_of_scene(card.folder, user_name()) as book:
                return export_tables(book, folder, semicolon)

        has_records, self.tables = self.has_records, folder
        self._context.start(self.tr("Write the records as tables"), work, self._tables_written)

    def _tables_written(self, done: Exported) -> None:
        text = self.tr("{0} tables are written: {1}").format(len(done.files), done.files[0].parent)
        self._context.say(Severity.NOTE, text)

    def read_tables(self, folder: Path) -> None:
        """Take over the records of all tables in a folder, in one step that is taken back as one."""
        card = self.card
        if card is None:
            return

        def work(context: JobContext) -> Imported:
            with book_of_scene(card.folder, user_name()) as book:
                return import_records(book, folder, monitor=context)

        self.tables = folder
        self._context.start(self.tr("Read tables of records"), work, self._tables_read)

    def _tables_read(self, done: Imported) -> None:
        text = self.tr("The tables are read: {0} records are new or other.").format(sum(done.n_changed.values()))
        self._context.say(Severity.NOTE, text)
        self._colour()
        self.recordsChanged.emit()

    @property
    def _book_path(self) -> Path:
        from reconstruction.records.book import FILE

        assert self.card is not None
        return self.card.folder / FILE

    def _reading(self) -> Any:
        from contextlib import nullcontext

        from reconstruction.records.book import RecordBook

        return RecordBook(self._book_path) if self.has_records else nullcontext(None)

    def _write(self, change: Callable[[RecordBook], object]) -> bool:
        """Whether records could be changed; the message area has why not."""
        problem = self._refused(change)
        if problem:
            self._context.say(Severity.ERROR, problem)
        return not problem and self.card is not None

    def _refused(self, change: Callable[[RecordBook], object]) -> str:
        """Change records; returns why they cannot be changed, and nothing where they are."""
        if self.card is None:
            return ""
        try:
            with book_of_scene(self.card.folder, user_name()) as book:
                change(book)
        except GroundStationError as error:
            return self._context.localized(str(error))
        self._colour()
        self.recordsChanged.emit()
        return ""

    # What comes

    def _take(self, message: Any) -> None:
        match message:
            case ViewAnswer():
                self.viewAnswered.emit(message)
            case Probed():
                self.probed.emit(message)
            case SceneMade():
                self._take_scene(message)
            case ProcessEnded(status):
                if self.is_reading:
                    self._not_opened(None)
                self._context.say(
                    Severity.ERROR,
                    self.tr("The process that shows models has ended (exit status {0}); it starts anew.").format(
                        status
                    ),
                )
                self.viewAnswered.emit(None)

    def _say(self, error: GroundStationError) -> None:
        self._context.say(Severity.ERROR, self._context.localized(str(error)))
