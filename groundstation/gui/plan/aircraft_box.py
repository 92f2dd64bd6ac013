"""Chooses the aircraft and camera of a plan: one that the program knows, or one from a file of the user's own."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QWidget

from groundstation.gui.inputs import ChoiceBox
from groundstation.gui.questions import choose_file
from planning.catalogue import Profile, profile, profiles
from planning.errors import GroundStationError


class AircraftBox(ChoiceBox):
    """`value()`, `setValue()` and `valueChanged` of a profile's identifier: its name in the catalogue, or its file.

    Signals
    -------
    valueChanged(str)
    refused(str)
        Why a file cannot be used; the aircraft before stays.
    """

    valueChanged = Signal(str)  # noqa: N815  (Qt's own way of naming)
    refused = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        for identifier, found in sorted(profiles().items()):
            self.addItem(_text(found), identifier)
        self._value = str(self.itemData(0))
        self.addItem(self.tr("From a file ..."), None)
        self.currentIndexChanged.connect(self._chosen)

    def value(self) -> str:
        """Identifier of the profile."""
        return self._value

    def setValue(self, identifier: str) -> None:  # noqa: N802
        """Show a profile; raises `InputError` where it is a file that cannot be read."""
        index = self.findData(identifier)
        with QSignalBlocker(self):
            if index < 0:
                found = profile(identifier)
                index = self.count() - 1
                self.insertItem(index, _text(found), identifier)
            self.setCurrentIndex(index)
        self._value = identifier

    def use_file(self, path: Path | None) -> None:
        """Take an aircraft from a file; for None, or a file that is wrong, the one before stays."""
        before = self._value
        try:
            self.setValue(before if path is None else str(path))
        except GroundStationError as error:
            self.setValue(before)
            self.refused.emit(str(error))
            return
        if self._value != before:
            self.valueChanged.emit(self._value)

    def _chosen(self) -> None:
        if self.currentData() is None:
            self.use_file(choose_file(self, self.tr("Aircraft and camera"), self.tr("Aircraft (*.toml)")))
        elif self.currentData() != self._value:
            self._value = str(self.currentData())
            self.valueChanged.emit(self._value)


def _text(found: Profile) -> str:
    return " / ".join(dict.fromkeys([found.aircraft.name, found.camera.name]))
