"""A record of a panel as a form: what is written down, field by field, checked when it is done."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from datetime import date
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication
from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.inputs import ChoiceBox, Form
from groundstation.gui.model.record_words import choice_words, field_words, kind_words
from groundstation.gui.questions import choose_file
from planning.errors import GroundStationError
from reconstruction.records.entries import STANDARD, TYPES, Attribute, Defect, Document, Entry, Inspection, Maintenance

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


class RecordDialog(QDialog):
    """Edits one record; it closes only with one that is as it should be.

    Parameters
    ----------
    kind
        Class of the record.
    entry
        To be changed; None for a new one.
    words
        Says what an error says in the user's language.
    """

    def __init__(
        self,
        kind: type[Any],
        global_id: str,
        entry: Entry | None,
        words: Callable[[str], str],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._kind, self._global_id, self._entry, self._words = kind, global_id, entry, words
        self.boxes: dict[str, QWidget] = {}
        self.problem = QLabel()
        self.problem.setWordWrap(True)
        self.problem.setProperty("role", "error")
        self.found: Entry | None = None
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
        """Take the record, or say what is wrong with it."""
        try:
            self.found = self.value()
        except GroundStationError as error:
            self.problem.setText(self._words(str(error)))
            self.problem.show()
            return
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


def _typed(text: str, kind: str) -> str | float | bool:
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
