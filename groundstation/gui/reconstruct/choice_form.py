"""How a model is to be trained: method, time, and what to compute on."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QComboBox, QLabel, QSizePolicy, QVBoxLayout, QWidget

from groundstation.gui.inputs import ChoiceBox, Form, NumberBox
from groundstation.gui.own_words import own_words
from groundstation.services.reconstruct_choices import (
    LONGEST_MIN,
    TrainChoice,
    method_rows,
    preset_rows,
)
from groundstation.services.units import UnitSystem

OWN = "own"
"""Of the list of times."""


class ChoiceForm(QWidget):
    """Edits a `TrainChoice`, but for its light.

    Signals
    -------
    valueChanged(TrainChoice)
        By the user.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = TrainChoice()
        self._methods = {row.name: row for row in method_rows()}
        self.method, self.time, self.device = ChoiceBox(), ChoiceBox(), ChoiceBox()
        self.minutes = NumberBox(1.0, float(LONGEST_MIN), 5.0, self.tr(" min"), 0)
        self.about = QLabel()
        self._make()
        self._fill()
        self.setValue(self._value)
        self.method.currentIndexChanged.connect(self._changed)
        self.time.currentIndexChanged.connect(self._changed)
        self.device.currentIndexChanged.connect(self._changed)
        self.minutes.valueChanged.connect(self._changed)

    def value(self) -> TrainChoice:
        """What is chosen."""
        return self._value

    def setValue(self, value: TrainChoice) -> None:  # noqa: N802
        """Show another choice."""
        self._value = value
        blockers = [QSignalBlocker(each) for each in (self.method, self.time, self.device, self.minutes)]
        self.method.show_value(value.method)
        self.time.show_value(value.preset if value.minutes is None else OWN)
        if value.minutes is not None:
            self.minutes.setValue(value.minutes)
        self.device.setCurrentIndex(int(value.on_cuda and self.device.count() > 1))
        del blockers
        self._show()

    def set_cuda(self, devices: tuple[str, ...]) -> None:
        """Offer devices besides the processor; without any there is nothing to choose."""
        with QSignalBlocker(self.device):
            while self.device.count() > 1:
                self.device.removeItem(1)
            if devices:
                self.device.addItem(devices[0])
        self._show()

    def set_light(self, light: str) -> None:
        """Another light is wished for, elsewhere."""
        self._value = replace(self._value, light=light)

    def _make(self) -> None:
        self.minutes.setValue(30.0)
        for box in (self.method, self.time, self.device):
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(10)
            box.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.about.setWordWrap(True)
        self.about.setProperty("role", "muted")
        self._form = Form()
        self._form.addRow(self.tr("Method"), self.method)
        self._form.addRow(self.about)
        self._form.addRow(self.tr("Time"), self.time)
        self._form.addRow(self.tr("At most"), self.minutes)
        self._form.addRow(self.tr("Compute on"), self.device)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(self._form)

    def _fill(self) -> None:
        for number, row in enumerate(self._methods.values()):
            self.method.addItem(row.title, row.name)
            self.method.setItemData(number, own_words(row.what, UnitSystem.METRIC), Qt.ItemDataRole.ToolTipRole)
        times = {"10min": self.tr("10 minutes"), "1h": self.tr("1 hour"), "overnight": self.tr("overnight, 10 hours")}
        for number, preset in enumerate(preset_rows()):
            self.time.addItem(times.get(preset.name, preset.name), preset.name)
            self.time.setItemData(number, own_words(preset.what, UnitSystem.METRIC), Qt.ItemDataRole.ToolTipRole)
        self.time.addItem(self.tr("own time"), OWN)
        self.device.addItem(self.tr("the processor"))

    def _changed(self) -> None:
        preset = str(self.time.currentData())
        own = preset == OWN
        self._value = replace(
            self._value,
            method=str(self.method.currentData()),
            preset=self._value.preset if own else preset,
            minutes=self.minutes.value() if own else None,
            on_cuda=self.device.currentIndex() > 0,
        )
        self._show()
        self.valueChanged.emit(self._value)

    def _show(self) -> None:
        row = self._methods[self._value.method]
        self.about.setText(own_words(row.what, UnitSystem.METRIC))
        self._form.setRowVisible(self.minutes, self._value.minutes is not None)
        self._form.setRowVisible(self.device, self.device.count() > 1)
