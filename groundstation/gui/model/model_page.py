"""The Model tab's widgets put together, with its list of panels: signals go to the controller, changes come back."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from pathlib import Path

from PySide6.QtCore import (
    QAbstractListModel,
    QLocale,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QSignalBlocker,
    Qt,
    QTimer,
    Signal,
)
from PySide6.QtGui import QAction, QCloseEvent, QColor, QIcon, QPixmap
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QLabel,
    QLineEdit,
    QListView,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import translated
from groundstation.gui.model.model_controller import ModelController
from groundstation.gui.model.record_side import KIND_TITLES, RecordSide
from groundstation.gui.model.report_maker import ReportMaker
from groundstation.gui.model.scene_pane import ScenePane
from groundstation.gui.shared_view import SharedView
from groundstation.gui.widgets.inputs import ChoiceBox, Form
from groundstation.gui.widgets.parameter_form import add_rows, rows_of
from groundstation.gui.widgets.questions import Questions, choose_new_file, file_name
from groundstation.gui.widgets.scrolling import padded, split
from groundstation.services.model.export import ModelExport, model_exporter, model_exporters, with_ending
from groundstation.services.model.panel_colours import Colouring, Computed, LegendLine
from groundstation.services.model.scene_card import PanelRow
from groundstation.services.project.steps import Act
from groundstation.services.reconstruct.folders import MODELS_FOLDER
from groundstation.services.units import UnitSystem
from planning.base.findings import Severity
from planning.base.parameters import declared
from planning.base.searching import folded

LEAST_WIDTH_PX = 440


class ExportDialog(QDialog):
    """Asks for all but the place.

    Parameters
    ----------
    facades
        Names of those that can be written alone.
    """

    def __init__(self, facades: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export the model"))
        self.format, self.part = ChoiceBox(), ChoiceBox()
        self.rows = rows_of(declared(ModelExport))
        self.about = QLabel()
        self.about.setWordWrap(True)
        self.about.setProperty("role", "muted")
        for name, exporter in model_exporters().items():
            self.format.addItem(translated(exporter.title, UnitSystem.METRIC), name)
        self.part.addItem(self.tr("the whole model"), None)
        for facade in facades:
            self.part.addItem(facade, facade)
        form = Form()
        form.addRow(self.tr("Format"), self.format)
        form.addRow(self.about)
        form.addRow(self.tr("Part"), self.part)
        add_rows(form, self.rows)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.button(QDialogButtonBox.StandardButton.Ok).setText(self.tr("Choose a place ..."))
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(buttons)
        self.setMinimumWidth(LEAST_WIDTH_PX)
        self.format.currentIndexChanged.connect(self._show_format)
        self.rows["gaussians"].valueChanged.connect(self._show_format)
        self._show_format()

    def wanted(self) -> ModelExport:
        """What is chosen; what the format does not ask for is left as it usually is."""
        facade = self.part.currentData() if self.part.isEnabled() else None
        chosen = {name: row.value() for name, row in self.rows.items() if row.widget.isEnabled()}
        return ModelExport(self._kind(), components=None if facade is None else (str(facade),), **chosen)

    def _kind(self) -> str:
        return str(self.format.currentData())

    def _show_format(self) -> None:
        exporter = model_exporter(self._kind())
        self.about.setText(translated(exporter.about, UnitSystem.METRIC))
        gaussians = self.rows["gaussians"].value()
        self.part.setEnabled(exporter.takes("components", gaussians))
        for name, row in self.rows.items():
            row.widget.setEnabled(exporter.takes(name, gaussians))


# The left side: which model, its panels as a list that can be searched, and what they are coloured by.

Index = QModelIndex | QPersistentModelIndex

SWATCH_PX = 14
MOST_LINES = 7


class _Rows(QAbstractListModel):
    """Panels, each with its colour."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.panels: tuple[PanelRow, ...] = ()
        self._icons: dict[str, QIcon] = {}
        self._notes: dict[str, str] = {}

    def set_panels(self, panels: Sequence[PanelRow], notes: dict[str, str]) -> None:
        """Show others; `notes` stand behind their names, by GlobalId."""
        self.beginResetModel()
        self.panels, self._notes = tuple(panels), notes
        self.endResetModel()

    def set_colours(self, found: Colouring) -> None:
        """Colour them."""
        icons = {colour: _swatch(colour) for colour in set(found.colours.values())}
        self._icons = {each: icons[colour] for each, colour in found.colours.items()}
        if self.panels:
            self.dataChanged.emit(self.index(0), self.index(len(self.panels) - 1))

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: B008, N802
        """How many there are."""
        return 0 if parent.isValid() else len(self.panels)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> object:
        """Name, colour, GlobalId."""
        panel = self.panels[index.row()]
        note = self._notes.get(panel.global_id, "")
        if role == Qt.ItemDataRole.DisplayRole:
            return f"{panel.name}: {note}" if note else panel.name
        if role == Qt.ItemDataRole.DecorationRole:
            return self._icons.get(panel.global_id)
        if role == Qt.ItemDataRole.ToolTipRole:
            return panel.global_id
        return None


class PanelSide(QWidget):
    """Shows panels, and edits which one is looked at and what they are coloured by.

    Signals
    -------
    chosen(str)
        GlobalId of a panel.
    colourChanged(str), searched(str)
    """

    chosen = Signal(str)
    colourChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    searched = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.open, self.title = QPushButton(self.tr("Open a model ...")), QLabel()
        self.export = QPushButton(self.tr("Export ..."))
        self.export.setToolTip(self.tr("Write the model for other programs"))
        self.search, self.list, self.colour = QLineEdit(), QListView(), ChoiceBox()
        self.rows = _Rows(self)
        self._is_told = False
        self._lines: list[tuple[QLabel, QLabel]] = []
        self.without = QLabel()
        self.list.setModel(self.rows)
        self.list.setUniformItemSizes(True)
        self.list.setSelectionMode(QListView.SelectionMode.ExtendedSelection)
        self.list.setToolTip(self.tr("Several can be marked, with Ctrl or Shift, for a report"))
        self.list.setAccessibleName(self.tr("Panels"))
        self.search.setPlaceholderText(self.tr("Search panels and records"))
        self.search.setClearButtonEnabled(True)
        self.search.setAccessibleName(self.tr("Search panels and records"))
        self.title.setWordWrap(True)
        self.without.setProperty("role", "muted")
        self.without.setWordWrap(True)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 6, 0)
        for widget in (self.open, self.title, self.export, self.search):
            layout.addWidget(widget)
        layout.addWidget(self.list, 1)
        label = QLabel(self.tr("Colour panels by"))
        label.setWordWrap(True)
        label.setBuddy(self.colour)
        layout.addWidget(label)
        layout.addWidget(self.colour)
        self._legend = QGridLayout()
        self._legend.setColumnStretch(1, 1)
        layout.addLayout(self._legend)
        layout.addWidget(self.without)
        self.set_attributes(())
        self.search.textChanged.connect(self.searched)
        self.colour.currentIndexChanged.connect(self._colour_chosen)
        self.list.selectionModel().currentChanged.connect(self._row_chosen)

    def set_panels(self, panels: Sequence[PanelRow], notes: dict[str, str], selected: str) -> None:
        """Show these panels."""
        self.rows.set_panels(panels, notes)
        self.select(selected)

    def select(self, global_id: str) -> None:
        """Show which one is looked at."""
        number = next((row for row, panel in enumerate(self.rows.panels) if panel.global_id == global_id), -1)
        self._is_told = True
        if number >= 0:
            self.list.setCurrentIndex(self.rows.index(number))
        else:
            self.list.clearSelection()
            self.list.setCurrentIndex(QModelIndex())
        self._is_told = False

    def marked(self) -> tuple[PanelRow, ...]:
        """Panels that are marked in the list, in its order."""
        rows = sorted(index.row() for index in self.list.selectionModel().selectedIndexes())
        return tuple(self.rows.panels[row] for row in rows)

    def set_attributes(self, names: Sequence[str]) -> None:
        """Offer attributes to colour by."""
        before = self.value()
        with QSignalBlocker(self.colour):
            self.colour.clear()
            for name, text in (
                ("", self.tr("nothing")),
                (Computed.INSPECTED, self.tr("last inspection")),
                (Computed.DEFECTS, self.tr("worst open defect")),
                (Computed.FACADE, self.tr("facade")),
            ):
                self.colour.addItem(text, str(name))
            for name in names:
                self.colour.addItem(name, name)
            self.colour.setCurrentIndex(max(0, self.colour.findData(before)))

    def value(self) -> str:
        """What panels are coloured by."""
        return str(self.colour.currentData() or "")

    def show_colours(self, found: Colouring) -> None:
        """Colour the list, and say what colours stand for."""
        self.rows.set_colours(found)
        while len(self._lines) < min(len(found.legend), MOST_LINES):
            line = QLabel(), QLabel()
            for column, label in enumerate(line):
                self._legend.addWidget(label, len(self._lines), column)
            self._lines.append(line)
        for number, (swatch, text) in enumerate(self._lines):
            is_shown = number < len(found.legend)
            swatch.setVisible(is_shown)
            text.setVisible(is_shown)
            if is_shown:
                swatch.setPixmap(_swatch(found.legend[number].colour).pixmap(SWATCH_PX, SWATCH_PX))
                text.setText(_words(found.legend[number], found.unit))
        self.without.setText(self.tr("{0} without a value").format(found.n_without))
        self.without.setVisible(bool(self.value()) and found.n_without > 0)
        self.list.scrollTo(self.list.currentIndex())

    def _row_chosen(self, current: QModelIndex) -> None:
        if current.isValid() and not self._is_told:
            self.chosen.emit(self.rows.panels[current.row()].global_id)

    def _colour_chosen(self) -> None:
        self.colourChanged.emit(self.value())


def _swatch(colour: tuple[int, int, int]) -> QIcon:
    picture = QPixmap(SWATCH_PX, SWATCH_PX)
    picture.fill(QColor(*colour))
    return QIcon(picture)


def _words(line: LegendLine, unit: str) -> str:
    value = line.value
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, float):
        return f"{value:.4g} {unit}".strip()
    return value


SIDE_PX, DETAIL_PX, LEAST_PX = 230, 330, 200
"""Widths beside the view, at 1280 pixels."""

PICTURES = (".jpg", ".jpeg", ".webp")
"""Endings of pictures that can be saved, besides the usual one."""

SEARCH_MS = 200
"""After the last letter."""


class ModelPage(QObject):
    """The tab."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView) -> None:
        super().__init__(shared_view)
        self._context, self._shared_view = context, shared_view
        self.controller, self.questions = ModelController.of(context), Questions()
        self.side, self.pane = PanelSide(), ScenePane(context, self.controller)
        self.records = RecordSide(context.localized, self.controller.put)
        self.report = ReportMaker(self.controller, self)
        self.left = self._make_page()
        self.right: QWidget | None = None
        self.bottom: QWidget | None = None
        self._search = QTimer(self)
        self._search.setSingleShot(True)
        self._search.setInterval(SEARCH_MS)
        self._connect()
        self._units_changed(context.units)
        self._show_scene()

    # A tab

    def shown(self) -> None:
        """Nothing is read before it is asked for."""

    def hidden(self) -> None:
        """Pictures stay."""

    def actions(self) -> tuple[QAction, ...]:
        """There are none."""
        return ()

    def take_step(self, act: Act) -> None:
        """Open the model that was trained, or export the one that is open."""
        match act:
            case Act.OPEN_MODEL:
                trained = self._context.milestones.model
                if trained is not None:
                    self.controller.open(trained)
            case Act.EXPORT_MODEL:
                self._export()
            case _:
                pass

    # How it is put together

    def _make_page(self) -> QWidget:
        parts = (self.side, self.pane, self.records)
        for part in parts:
            part.setMinimumWidth(LEAST_PX)
        self.splitter = split(parts, (SIDE_PX, 1280 - SIDE_PX - DETAIL_PX, DETAIL_PX), 1)
        return padded(self.splitter)

    def _connect(self) -> None:
        controller, side, records = self.controller, self.side, self.records
        side.open.clicked.connect(self._open)
        side.export.clicked.connect(self._export)
        side.chosen.connect(controller.select)
        side.colourChanged.connect(controller.colour)
        side.searched.connect(self._search_later)
        self._search.timeout.connect(self._show_panels)
        records.removeRequested.connect(controller.remove)
        records.undoRequested.connect(controller.undo)
        records.levelChanged.connect(controller.look_at)
        records.reportRequested.connect(self._make_report)
        records.tablesWanted.connect(self._write_tables)
        records.tablesGiven.connect(self._read_tables)
        self.report.done.connect(self._report_done)
        self.report.failed.connect(self._report_failed)
        self.pane.saveRequested.connect(self._save_picture)
        controller.sceneChanged.connect(self._show_scene)
        controller.selectionChanged.connect(self._show_selection)
        controller.subjectChanged.connect(self._show_subject)
        controller.recordsChanged.connect(self._show_records)
        controller.coloursChanged.connect(self._show_colours)
        self._context.unitsChanged.connect(self._units_changed)
        self._shared_view.closing.connect(self._window_closing)

    # What the user does

    def _open(self) -> None:
        card, project = self.controller.card, self._context.session.folder
        places = (
            None if project is None else project / MODELS_FOLDER,
            None if card is None else card.folder.parent,
            project,
        )
        folder = self.questions.folder(self._shared_view.window(), self.tr("Folder of a model"), *places)
        if folder is not None:
            self.controller.open(folder)

    def _search_later(self, _words: str) -> None:
        self._search.start()

    def _save_picture(self) -> None:
        title, kinds = self.tr("Save the picture"), self.tr("Pictures (*.png)")
        path = choose_new_file(self._shared_view.window(), title, self._proposed(".png"), kinds, ".png", PICTURES)
        if path is not None:
            self.save_picture(path)

    def save_picture(self, path: Path) -> None:
        """Keep what is shown, with what is drawn over it."""
        path = path if path.suffix else path.with_suffix(".png")
        if self.pane.picture().save(str(path)):
            self._context.say(Severity.NOTE, self.tr("The picture is written: {0}").format(path))
        else:
            self._context.say(Severity.ERROR, self.tr("{0} cannot be written; choose another place").format(path))

    def _export(self) -> None:
        card = self.controller.card
        if card is None:
            return
        dialog = ExportDialog(tuple(dict.fromkeys(panel.facade for panel in card.panels)), self._shared_view.window())
        self._context.report_plugin_problems()
        if dialog.exec() == QDialog.DialogCode.Accepted:
            out = self._place_for(dialog.wanted().format, card.name)
            if out is not None:
                self.controller.export(out, dialog.wanted())
        dialog.deleteLater()

    def _place_for(self, kind: str, name: str) -> Path | None:
        """Where a file or folder is to be."""
        title, endings = self.tr("Export the model"), model_exporter(kind).endings
        if not endings:
            return self.questions.new_folder(self._shared_view.window(), title, Path.home() / file_name(name))
        ending, *others = endings
        kinds = " ".join(f"*{each}" for each in endings)
        found = choose_new_file(
            self._shared_view.window(), title, Path(f"{file_name(name)}{ending}"), kinds, ending, others
        )
        return None if found is None else with_ending(found, kind)

    def _make_report(self) -> None:
        title, kinds = self.tr("Save the report"), self.tr("Documents (*.pdf)")
        path = choose_new_file(self._shared_view.window(), title, self._proposed(".pdf"), kinds, ".pdf")
        if path is not None:
            self.make_report(path)

    def _write_tables(self) -> None:
        card, title = self.controller.card, self.tr("Write the records as tables")
        if card is None:
            return
        proposed = Path.home() / file_name(self.tr("{0} records").format(card.name))
        folder = self.questions.new_folder(self._shared_view.window(), title, proposed)
        if folder is not None:
            # As spreadsheets of this computer have it: they go by the system, not by the window's language.
            self.controller.write_tables(folder, QLocale.system().decimalPoint() == ",")

    def _read_tables(self) -> None:
        card = self.controller.card
        if card is None:
            return
        title = self.tr("Folder of tables")
        folder = self.questions.folder(self._shared_view.window(), title, self.controller.tables, card.folder.parent)
        if folder is not None:
            self.controller.read_tables(folder)

    def _proposed(self, ending: str) -> Path:
        """A name for a file about the model that is open."""
        name = self.tr("model") if self.controller.card is None else self.controller.card.name
        return Path(f"{file_name(name)}{ending}")

    def make_report(self, path: Path) -> None:
        """Write a report of the panels that are marked in the list, or of what records are shown of.

        Of a facade or the building, it has all panels that something is known of.
        """
        card, subject = self.controller.card, self.controller.subject
        if card is None:
            return
        panels, facades = self.side.marked(), tuple[PanelRow, ...]()
        if len(panels) < 2 and subject is not None:
            facades = tuple(
                each
                for each in card.panels
                if self.controller.level == "building" or each.facade_id == subject.global_id
            )
            known = self.controller.entries_of_all(each.global_id for each in facades)
            panels = tuple(each for each in facades if known[each.global_id])
            if subject.panel is not None:
                panels = (subject.panel,)
        is_letter = self._context.units is UnitSystem.IMPERIAL
        path = path if path.suffix else path.with_suffix(".pdf")
        self.report.make(panels, path, self._context.units, is_letter, facades)

    def _report_done(self, path: Path) -> None:
        self._context.say(Severity.NOTE, self.tr("The report is written: {0}").format(path))

    def _report_failed(self, problem: str) -> None:
        self._context.say(Severity.ERROR, self._context.localized(problem))

    def _window_closing(self, event: QCloseEvent) -> None:
        if event.isAccepted():
            self.controller.close()

    # What is shown

    def _show_scene(self) -> None:
        card = self.controller.card
        self.side.open.setEnabled(not self.controller.is_reading)
        self.side.export.setEnabled(card is not None and not self.controller.is_reading)
        self.records.tables.setEnabled(card is not None and not self.controller.is_reading)
        if self.controller.is_reading:
            self.side.title.setText(self.tr("The model is being opened ..."))
        elif card is None:
            self.side.title.setText(self.tr("No model is open."))
        else:
            words = self.tr("{0}: {1} panels, {2} Gaussians").format(
                card.folder.name, len(card.panels), card.n_gaussians
            )
            self.side.title.setText(words)
            self.side.title.setToolTip(str(card.folder))
        self.side.search.clear()
        self.pane.set_scene()
        self._show_panels()
        self._show_selection()
        self._show_records()

    def _show_panels(self) -> None:
        """Those whose names or records have what is searched for."""
        card, words = self.controller.card, self.side.search.text().strip()
        panels: tuple[PanelRow, ...] = () if card is None else card.panels
        notes: dict[str, str] = {}
        if words and card is not None:
            notes = {hit.global_id: hit.text for hit in reversed(self.controller.search(words)) if hit.kind != "object"}
            notes = {panel.global_id: notes[panel.facade_id] for panel in panels if panel.facade_id in notes} | notes
            panels = tuple(
                panel for panel in panels if folded(words) in folded(panel.name) or panel.global_id in {*notes, words}
            )
        self.side.set_panels(panels, notes, self.controller.selected)
        self.side.show_colours(self.controller.colouring)

    def _show_selection(self) -> None:
        self.side.select(self.controller.selected)
        self._show_subject()

    def _show_subject(self) -> None:
        self.records.show_subject(self.controller.level, self.controller.subject, self._context.units)
        self._show_entries()

    def _show_records(self) -> None:
        self.side.set_attributes(self.controller.attribute_names())
        self._show_entries()

    def _show_entries(self) -> None:
        self.records.show_entries({kind: self.controller.entries(kind) for kind in KIND_TITLES})

    def _show_colours(self) -> None:
        self.side.show_colours(self.controller.colouring)

    def _units_changed(self, units: UnitSystem) -> None:
        self.pane.set_units(units)
        self._show_selection()
