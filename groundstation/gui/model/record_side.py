"""The right side: the panel that is chosen, its facade or the building, and its records by kind, to be edited."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from datetime import date
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QLocale, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QLabel,
    QLineEdit,
    QMenu,
    QPlainTextEdit,
    QPushButton,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.translate import QT_TRANSLATE_NOOP
from groundstation.gui.widgets.inputs import ChoiceBox, Form
from groundstation.gui.widgets.questions import choose_file
from groundstation.services.model.scene_card import Level, Subject
from groundstation.services.units import UnitSystem, area_unit, length_unit
from planning.base.errors import GroundStationError
from reconstruction.records.entries import STANDARD, TYPES, Attribute, Defect, Document, Entry, Inspection, Maintenance
from reconstruction.records.stored_files import display_place

# What kinds of records, their fields and choices are called.

KINDS: dict[type[Any], str] = {
    Attribute: QT_TRANSLATE_NOOP("Records", "Property"),
    Inspection: QT_TRANSLATE_NOOP("Records", "Inspection"),
    Defect: QT_TRANSLATE_NOOP("Records", "Defect"),
    Maintenance: QT_TRANSLATE_NOOP("Records", "Maintenance"),
    Document: QT_TRANSLATE_NOOP("Records", "Document"),
}

FIELDS: dict[str, str] = {
    "name": QT_TRANSLATE_NOOP("Records", "name"),
    "value": QT_TRANSLATE_NOOP("Records", "value"),
    "type": QT_TRANSLATE_NOOP("Records", "type"),
    "unit": QT_TRANSLATE_NOOP("Records", "unit"),
    "date": QT_TRANSLATE_NOOP("Records", "date"),
    "inspector": QT_TRANSLATE_NOOP("Records", "inspector"),
    "method": QT_TRANSLATE_NOOP("Records", "method"),
    "result": QT_TRANSLATE_NOOP("Records", "result"),
    "note": QT_TRANSLATE_NOOP("Records", "note"),
    "kind": QT_TRANSLATE_NOOP("Records", "kind"),
    "severity": QT_TRANSLATE_NOOP("Records", "severity"),
    "found_on": QT_TRANSLATE_NOOP("Records", "found on"),
    "u": QT_TRANSLATE_NOOP("Records", "from the left, 0 to 1"),
    "v": QT_TRANSLATE_NOOP("Records", "from below, 0 to 1"),
    "status": QT_TRANSLATE_NOOP("Records", "state"),
    "repaired_on": QT_TRANSLATE_NOOP("Records", "repaired on"),
    "work": QT_TRANSLATE_NOOP("Records", "work"),
    "done_by": QT_TRANSLATE_NOOP("Records", "done by"),
    "cost": QT_TRANSLATE_NOOP("Records", "cost"),
    "currency": QT_TRANSLATE_NOOP("Records", "currency"),
    "next_due": QT_TRANSLATE_NOOP("Records", "next due"),
    "title": QT_TRANSLATE_NOOP("Records", "title"),
    "place": QT_TRANSLATE_NOOP("Records", "address or file"),
    "material": QT_TRANSLATE_NOOP("Records", "material"),
    "maker": QT_TRANSLATE_NOOP("Records", "maker"),
    "product": QT_TRANSLATE_NOOP("Records", "product"),
    "coating": QT_TRANSLATE_NOOP("Records", "coating"),
    "thickness": QT_TRANSLATE_NOOP("Records", "thickness"),
    "installed_on": QT_TRANSLATE_NOOP("Records", "installed on"),
    "warranty_until": QT_TRANSLATE_NOOP("Records", "warranty until"),
    "width": QT_TRANSLATE_NOOP("Records", "width"),
    "height": QT_TRANSLATE_NOOP("Records", "height"),
}

CHOICE_NAMES: dict[str, str] = {
    "open": QT_TRANSLATE_NOOP("Records", "open"),
    "repaired": QT_TRANSLATE_NOOP("Records", "repaired"),
    "text": QT_TRANSLATE_NOOP("Records", "text"),
    "number": QT_TRANSLATE_NOOP("Records", "number"),
    "yes/no": QT_TRANSLATE_NOOP("Records", "yes or no"),
    "True": QT_TRANSLATE_NOOP("Records", "yes"),
    "False": QT_TRANSLATE_NOOP("Records", "no"),
}


def kind_words(kind: type[Any]) -> str:
    """Of a class of records."""
    return QCoreApplication.translate("Records", KINDS[kind])


def field_words(name: str) -> str:
    """Of a field, or an attribute that every panel may have; others are called as their makers called them."""
    return QCoreApplication.translate("Records", FIELDS[name]) if name in FIELDS else name


def choice_words(name: str) -> str:
    """Of a choice."""
    if name in FIELDS and name not in CHOICE_NAMES:
        return field_words(name)
    return QCoreApplication.translate("Records", CHOICE_NAMES[name]) if name in CHOICE_NAMES else name


# A record of a panel as a form: what is written down, field by field, checked when it is done.

SHOWN: dict[type[Any], tuple[str, ...]] = {
    Attribute: ("name", "value", "type", "unit"),
    Inspection: ("date", "inspector", "method", "result", "note"),
    Defect: ("kind", "severity", "found_on", "u", "v", "status", "repaired_on", "note"),
    Maintenance: ("date", "work", "done_by", "cost", "currency", "next_due", "note"),
    Document: ("title", "kind", "place"),
}
"""Fields of each kind, in the order in which they are asked for."""

CHOICES: dict[str, tuple[str, ...]] = {"severity": ("1", "2", "3", "4", "5"), "status": ("open", "repaired")}
CHOICES["type"] = tuple(TYPES)
NUMBERS = frozenset({"u", "v", "cost"})
MAY_BE_NONE = frozenset({"u", "v", "cost", "repaired_on", "next_due"})
TODAY = frozenset({"date", "found_on"})
LONG = frozenset({"note"})
FILES = frozenset({Defect, Document})
"""Kinds that a file can go with."""


KeepRecord = Callable[[Entry, Path | None], str]
"""Keeps a record, with a file that goes with it; returns why it cannot be kept, and nothing where it was."""


class RecordDialog(QDialog):
    """Edits one record; it closes only when that was kept, so that nothing has to be typed again.

    Parameters
    ----------
    kind
        Class of the record.
    entry
        To be changed; None for a new one.
    words
        Says what an error says in the user's language.
    keep
        Called with the record once it is as it should be.
    """

    def __init__(
        self,
        kind: type[Any],
        global_id: str,
        entry: Entry | None,
        words: Callable[[str], str],
        keep: KeepRecord,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._kind, self._global_id, self._entry, self._words, self._keep = kind, global_id, entry, words, keep
        self.boxes: dict[str, QWidget] = {}
        self.problem = QLabel()
        self.problem.setWordWrap(True)
        self.problem.setProperty("role", "error")
        self.file: Path | None = None
        self.choose = QPushButton()
        self.setWindowTitle(kind_words(kind))
        form = Form()
        for name in SHOWN[kind]:
            if name in {each.name for each in fields(kind)}:
                self.boxes[name] = self._box(name)
                form.addRow(field_words(name), self.boxes[name])
        if kind in FILES:
            self.choose.setText(self.tr("Choose ..."))
            self.choose.clicked.connect(self._choose_file)
            form.addRow(self.tr("picture") if kind is Defect else self.tr("or a file"), self.choose)
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(self.problem)
        layout.addWidget(buttons)
        self.problem.hide()
        self.setMinimumWidth(420)

    def accept(self) -> None:
        """Keep the record, or say what is wrong with it."""
        try:
            problem = self._keep(self.value(), self.file)
        except GroundStationError as error:
            problem = self._words(str(error))
        self.problem.setText(problem)
        self.problem.setVisible(bool(problem))
        if not problem:
            super().accept()

    def value(self) -> Entry:
        """The record.

        Raises
        ------
        InputError
            A field is not as it should be.
        """
        found = {name: self._value(name) for name in self.boxes}
        if self._kind is Attribute:
            found["value"] = _typed(str(found["value"]), str(found["type"]))
        if self._kind is Document and self.file is not None:
            # Its own name follows from its content, once it is kept.
            found["place"] = "document"
        if self._entry is not None:
            return replace(self._entry, **found)
        return self._kind(self._global_id, **found)  # type: ignore[no-any-return]

    def _box(self, name: str) -> QWidget:
        before = getattr(self._entry, name, None)
        if name in CHOICES:
            box = ChoiceBox()
            for choice in CHOICES[name]:
                box.addItem(choice_words(choice), choice)
            box.setCurrentIndex(max(0, box.findData(str(before))))
            return box
        if name in LONG:
            text = QPlainTextEdit(str(before or ""))
            text.setMaximumHeight(90)
            text.setTabChangesFocus(True)
            return text
        if name == "name" and self._kind is Attribute:
            names = ChoiceBox()
            names.setEditable(True)
            names.addItems(list(STANDARD))
            names.setCurrentText(str(before or ""))
            names.currentTextChanged.connect(self._name_chosen)
            names.setEnabled(self._entry is None)
            return names
        usual = date.today().isoformat() if name in TODAY and self._entry is None else ""
        line = QLineEdit(usual if before is None else _text(before))
        if name in TODAY or name in ("repaired_on", "next_due"):
            line.setPlaceholderText(QCoreApplication.translate("Records", "2026-03-31"))
        return line

    def _choose_file(self) -> None:
        kinds = self.tr("Pictures (*.png *.jpg *.jpeg *.webp)") if self._kind is Defect else self.tr("Files (*)")
        path = choose_file(self, self.windowTitle(), kinds)
        if path is not None:
            self.take_file(path)

    def take_file(self, path: Path) -> None:
        """A picture or document that goes with the record."""
        self.file = path
        self.choose.setText(path.name)

    def _name_chosen(self, name: str) -> None:
        """Attributes that every panel may have have a type and a unit of their own."""
        kind, unit = self.boxes.get("type"), self.boxes.get("unit")
        if name in STANDARD and isinstance(kind, QComboBox) and isinstance(unit, QLineEdit):
            kind.setCurrentIndex(kind.findData(STANDARD[name][0]))
            unit.setText(STANDARD[name][1])

    def _value(self, name: str) -> Any:
        box = self.boxes[name]
        if isinstance(box, QPlainTextEdit):
            return box.toPlainText()
        if isinstance(box, QComboBox):
            found = box.currentText() if box.isEditable() else str(box.currentData())
            return int(found) if name == "severity" else found
        assert isinstance(box, QLineEdit)
        text = box.text().strip()
        if name in MAY_BE_NONE and not text:
            return None
        return _number(text) if name in NUMBERS else text


def _typed(text: str, kind: str) -> Any:
    if kind == "number":
        return _number(text)
    if kind == "yes/no":
        return text.strip().casefold() in ("yes", "true", "1", "ja")
    return text


def _number(text: str) -> Any:
    """A number, with a point or a comma; what is none stays text, and is refused with the field's name."""
    try:
        return float(text.replace(",", ".", 1))
    except ValueError:
        return text


def _text(value: object) -> str:
    if not isinstance(value, float):
        return str(value)
    short = f"{value:g}"
    return short if float(short) == value else repr(value)


ENTRY = Qt.ItemDataRole.UserRole

KIND_TITLES: dict[type[Any], Callable[[], str]] = {
    Attribute: lambda: QCoreApplication.translate("RecordSide", "Properties"),
    Inspection: lambda: QCoreApplication.translate("RecordSide", "Inspections"),
    Defect: lambda: QCoreApplication.translate("RecordSide", "Defects"),
    Maintenance: lambda: QCoreApplication.translate("RecordSide", "Maintenance"),
    Document: lambda: QCoreApplication.translate("RecordSide", "Documents"),
}


class RecordSide(QWidget):
    """Shows a panel, a facade or the building, and its records.

    Signals
    -------
    removeRequested(Entry), undoRequested(), reportRequested()
    tablesWanted(), tablesGiven()
        All records are to be written as tables; or read from tables.
    levelChanged(str)
        Records of a panel, a facade or the building are wanted.
    """

    removeRequested = Signal(object)  # noqa: N815  (Qt's own way of naming)
    undoRequested = Signal()  # noqa: N815
    reportRequested = Signal()  # noqa: N815
    tablesWanted = Signal()  # noqa: N815
    tablesGiven = Signal()  # noqa: N815
    levelChanged = Signal(str)  # noqa: N815

    def __init__(self, words: Callable[[str], str], keep: KeepRecord, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._words, self._keep = words, keep
        self._subject: Subject | None = None
        self.level = ChoiceBox()
        self.title, self.facade, self.extent, self.global_id = (QLabel() for _ in range(4))
        self.tree, self.kinds = QTreeWidget(), QMenu(self)
        self._groups: dict[type[Any], QTreeWidgetItem] = {}
        self.add, self.change = QPushButton(self.tr("Add ...")), QPushButton(self.tr("Change ..."))
        self.remove, self.undo = QPushButton(self.tr("Delete")), QPushButton(self.tr("Undo"))
        self.report, self.tables = QPushButton(self.tr("Report as PDF ...")), QPushButton(self.tr("Tables"))
        self._make()
        self.show_subject("panel", None, UnitSystem.METRIC)

    def show_subject(self, level: Level, subject: Subject | None, units: UnitSystem) -> None:
        """Say what records are of; None where no panel is chosen that would tell."""
        self._subject = subject
        with QSignalBlocker(self.level):
            self.level.setCurrentIndex(self.level.findData(level))
        if subject is None:
            self.title.setText(self.tr("No panel is chosen. Click one in the picture, or in the list."))
        else:
            self.title.setText(subject.name)
        panel = None if subject is None else subject.panel
        width_m, height_m = (0.0, 0.0) if panel is None else panel.size_m
        self.facade.setText("" if panel is None else panel.facade)
        self.global_id.setText("" if subject is None else subject.global_id)
        unit, area = length_unit(units), area_unit(units)
        size = self.tr("{0} x {1}, {2}").format(unit.text(width_m), unit.text(height_m), area.text(width_m * height_m))
        self.extent.setText("" if panel is None else size)
        for label in (self.facade, self.extent):
            self._facts.setRowVisible(label, level == "panel")
        self._enable()

    def show_entries(self, found: dict[type[Any], tuple[Any, ...]]) -> None:
        """Show records by kind."""
        for kind, group in self._groups.items():
            entries = found.get(kind, ())
            group.takeChildren()
            for entry in entries:
                item = QTreeWidgetItem([line_of(entry)])
                item.setData(0, ENTRY, entry)
                item.setToolTip(0, line_of(entry))
                group.addChild(item)
            group.setText(0, f"{KIND_TITLES[kind]()} ({len(entries)})" if entries else KIND_TITLES[kind]())
            group.setExpanded(True)
        self._enable()

    def entry(self) -> Entry | None:
        """The record that is chosen."""
        item = self.tree.currentItem()
        entry: Entry | None = None if item is None else item.data(0, ENTRY)
        return entry

    def put_asked_of(self, kind: type[Any], entry: Entry | None = None) -> None:
        """Ask for a new record of a kind, or for what is to be changed."""
        if self._subject is None:
            return
        dialog = RecordDialog(kind, self._subject.global_id, entry, self._words, self._keep, self)
        dialog.exec()
        dialog.deleteLater()

    def _make(self) -> None:
        self.title.setProperty("role", "heading")
        self.title.setWordWrap(True)
        self.global_id.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.tree.setHeaderHidden(True)
        self.tree.setWordWrap(True)
        self.tree.setRootIsDecorated(False)
        self.tree.setIndentation(12)
        self.tree.setAccessibleName(self.tr("Records"))
        for level, text in (
            ("panel", self.tr("the panel")),
            ("facade", self.tr("its facade")),
            ("building", self.tr("the building")),
        ):
            self.level.addItem(text, level)
        for kind, title in KIND_TITLES.items():
            group = QTreeWidgetItem([title()])
            font = group.font(0)
            font.setBold(True)
            group.setFont(0, font)
            self.tree.addTopLevelItem(group)
            self._groups[kind] = group
            self.kinds.addAction(f"{kind_words(kind)} ...").setData(kind)
        self.tree.currentItemChanged.connect(self._enable)
        self.tree.itemActivated.connect(self._change)
        self._facts = facts = Form()
        for name, label in (
            (self.tr("Records of"), self.level),
            (self.tr("Facade"), self.facade),
            (self.tr("Size"), self.extent),
            (self.tr("GlobalId"), self.global_id),
        ):
            facts.addRow(name, label)
        buttons = QGridLayout()
        for number, button in enumerate((self.add, self.change, self.undo, self.remove)):
            buttons.addWidget(button, number // 2, number % 2)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 0, 0, 0)
        layout.addWidget(self.title)
        layout.addLayout(facts)
        layout.addWidget(self.tree, 1)
        layout.addLayout(buttons)
        buttons.addWidget(self.report, 2, 0)
        buttons.addWidget(self.tables, 2, 1)
        in_tables = QMenu(self)
        in_tables.addAction(self.tr("Write tables for a spreadsheet ...")).triggered.connect(self._ask_for_tables)
        in_tables.addAction(self.tr("Read tables ...")).triggered.connect(self._give_tables)
        self.tables.setMenu(in_tables)
        self.tables.setToolTip(self.tr("All records of the model as CSV tables, to be filled in and read again"))
        self.undo.setToolTip(self.tr("Take the last change of records back"))
        self.add.setMenu(self.kinds)
        self.kinds.triggered.connect(self._add)
        self.change.clicked.connect(self._change)
        self.remove.clicked.connect(self._remove)
        self.undo.clicked.connect(self.undoRequested)
        self.report.clicked.connect(self.reportRequested)
        self.level.currentIndexChanged.connect(self._level_chosen)

    def _enable(self) -> None:
        has_subject = self._subject is not None
        has_entry = has_subject and self.entry() is not None
        for button, is_on in ((self.add, has_subject), (self.change, has_entry), (self.remove, has_entry)):
            button.setEnabled(is_on)
        self.report.setEnabled(has_subject)

    def _ask_for_tables(self, _checked: bool = False) -> None:
        self.tablesWanted.emit()

    def _give_tables(self, _checked: bool = False) -> None:
        self.tablesGiven.emit()

    def _level_chosen(self) -> None:
        self.levelChanged.emit(self.level.currentData())

    def _add(self, action: QAction) -> None:
        self.put_asked_of(action.data())

    def _change(self) -> None:
        entry = self.entry()
        if entry is not None:
            self.put_asked_of(type(entry), entry)

    def _remove(self) -> None:
        entry = self.entry()
        if entry is not None:
            self.removeRequested.emit(entry)


def line_of(entry: Entry) -> str:
    """A record in a line or two."""
    if isinstance(entry, Attribute):
        value = choice_words(str(entry.value)) if isinstance(entry.value, bool) else _value(entry.value)
        return f"{field_words(entry.name)}: {value} {entry.unit}".strip()
    if isinstance(entry, Inspection):
        parts = [entry.method, entry.result, entry.inspector, entry.note]
        return f"{entry.date}: {_joined(parts)}"
    if isinstance(entry, Defect):
        severity = f"{field_words('severity')} {entry.severity}"
        return f"{entry.found_on}: {_joined([entry.kind, severity, choice_words(entry.status), entry.note])}"
    if isinstance(entry, Maintenance):
        cost = "" if entry.cost is None else f"{QLocale().toString(entry.cost, 'f', 2)} {entry.currency}"
        due = "" if entry.next_due is None else f"{field_words('next_due')} {entry.next_due}"
        return f"{entry.date}: {_joined([entry.work, entry.done_by, cost, due, entry.note])}"
    return _joined([entry.title, entry.kind, display_place(entry.place)])


def _joined(parts: list[str]) -> str:
    return ", ".join(part for part in parts if part)


def _value(value: object) -> str:
    return QLocale().toString(value) if isinstance(value, float) else str(value)
