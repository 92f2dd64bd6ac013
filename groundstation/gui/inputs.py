"""Input boxes for quantities: `value()` and `setValue()` are metric, what stands in them is in the user's units."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QLocale, QSignalBlocker, Signal
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QDoubleSpinBox, QWidget

from groundstation.services.units import Unit, UnitSystem, length_unit, speed_unit

SAME = 1e-9
"""Part of a value below which a box that rounds for display still holds the value it was given."""


class NumberBox(QDoubleSpinBox):
    """A number with a fixed unit. The mouse wheel scrolls the form, and changes a box only when it has the focus."""

    def __init__(
        self, low: float, high: float, step: float, suffix: str = "", decimals: int = 1, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setRange(low, high)
        self.setDecimals(decimals)
        self.setSingleStep(step)
        self.setSuffix(suffix)
        self.setAccelerated(True)
        self.setKeyboardTracking(False)
        # As all texts of the window have it; in a German locale the point would group thousands, and 3.5 become 35.
        self.setLocale(QLocale.c())

    def validate(self, text: str, position: int) -> object:
        """Take a comma for the decimal point too."""
        return super().validate(text.replace(",", "."), position)

    def valueFromText(self, text: str) -> float:  # noqa: N802
        """Take a comma for the decimal point too."""
        return super().valueFromText(text.replace(",", "."))

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Leave the wheel to the form around."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class QuantityBox(QWidget):
    """A quantity: metric inside, in the user's units on screen.

    A value that was set comes back exactly until the user edits it, however it is rounded for display.
    """

    valueChanged = Signal(float)  # noqa: N815  (Qt's own way of naming)

    def __init__(
        self,
        unit_of: Callable[[UnitSystem], Unit],
        low: float,
        high: float,
        step: float,
        system: UnitSystem = UnitSystem.METRIC,
        decimals: int | None = None,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        from PySide6.QtWidgets import QHBoxLayout

        self._unit_of, self._low, self._high, self._step, self._decimals = unit_of, low, high, step, decimals
        self._value = min(max(0.0, low), high)
        self._box = NumberBox(low, high, step)
        self._unit = unit_of(system)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._box)
        self.setFocusProxy(self._box)
        self.set_units(system)
        self._box.valueChanged.connect(self._edited)

    def value(self) -> float:
        """Metric value."""
        return self._value

    def setValue(self, value: float) -> None:  # noqa: N802
        """Show a metric value; values outside the range go to its nearest end."""
        self._value = min(max(value, self._low), self._high)
        self._show()

    def set_units(self, system: UnitSystem) -> None:
        """Show the same value in other units."""
        self._unit = self._unit_of(system)
        with QSignalBlocker(self._box):
            self._box.setDecimals(self._unit.decimals if self._decimals is None else self._decimals)
            self._box.setRange(self._unit.shown(self._low), self._unit.shown(self._high))
            self._box.setSingleStep(self._step)
            self._box.setSuffix(f" {self._unit.symbol}")
        self._show()

    def box(self) -> NumberBox:
        """The box itself, for focus and tests."""
        return self._box

    def _show(self) -> None:
        with QSignalBlocker(self._box):
            self._box.setValue(self._unit.shown(self._value))

    def _edited(self, shown: float) -> None:
        # At an end of the range the rounded number would lie outside it.
        value = min(max(self._unit.metric(shown), self._low), self._high)
        if abs(value - self._value) > SAME * max(1.0, abs(self._value)):
            self._value = value
            self.valueChanged.emit(value)


class LengthBox(QuantityBox):
    """Metres, shown as metres or feet."""

    def __init__(
        self,
        low_m: float,
        high_m: float,
        step: float = 0.5,
        system: UnitSystem = UnitSystem.METRIC,
        decimals: int | None = None,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(length_unit, low_m, high_m, step, system, decimals, parent)


class SpeedBox(QuantityBox):
    """Metres per second, shown so or as miles per hour."""

    def __init__(
        self,
        low_m_s: float,
        high_m_s: float,
        step: float = 0.5,
        system: UnitSystem = UnitSystem.METRIC,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(speed_unit, low_m_s, high_m_s, step, system, None, parent)
