"""Rows of forms made from declared parameters: the box that fits type, unit and range, with title and tool tip.

Titles and tool tips are what the parameter declares, translated in the context `Parameters`. Qt Linguist finds them in
`groundstation.gui.application.parameter_texts`, which `make docs` writes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from PySide6.QtCore import QCoreApplication, QObject, QSignalBlocker, Signal
from PySide6.QtWidgets import QCheckBox, QWidget

from groundstation.gui.widgets.inputs import (
    ChoiceBox,
    Form,
    LengthBox,
    NumberBox,
    PercentBox,
    QuantityBox,
    SpeedBox,
    WholeBox,
)
from groundstation.services.units import UnitSystem, sampling_unit
from planning.base.parameters import Declared, Parameter
from planning.optics import shutter_text

CONTEXT = "Parameters"

MM_PER_M = 1000.0


def title_of(known: Parameter) -> str:
    """The label of a parameter in the user's language."""
    return QCoreApplication.translate(CONTEXT, known.label)


def tip_of(known: Parameter) -> str:
    """What a parameter is, in the user's language."""
    text = QCoreApplication.translate(CONTEXT, known.help)
    return text[:1].upper() + text[1:]


def choice_text(known: Parameter, value: Any) -> str:
    """What one of the values of a parameter is called in the user's language; its value where it has no name.

    None is called what it stands for.
    """
    label = next((choice.label for choice in known.choices if choice.value == value and choice.label), "")
    if label:
        return QCoreApplication.translate(CONTEXT, label)
    if value is None:
        return QCoreApplication.translate(CONTEXT, known.unset)
    if known.unit == "s" and 0.0 < value < 1.0:
        return shutter_text(value)
    return f"{value:.4g}°" if known.unit == "deg" else str(value)


def typed_range(known: Parameter) -> tuple[float, float]:
    """What can be typed: the range itself, and where that has no end what is offered.

    Raises
    ------
    ValueError
        The parameter says neither.
    """
    smallest = 10.0**-known.decimals * (0.01 if known.unit == "share" else 1.0)
    low, high = known.offered or (None, None)
    least = known.least if known.least is not None else low
    if least is None and known.above is not None:
        least = known.above + smallest
    most = known.most if known.most not in (None, float("inf")) else None
    if most is None:
        most = known.below - smallest if known.below is not None else high
    if least is None or most is None:
        raise ValueError(f"{known.label}: expected a range with two ends, or what is offered; found neither")
    return least, most


class ParameterRow(QObject):
    """`value()`, `setValue()` and `valueChanged` of one parameter; what the box cannot show it keeps.

    Parameters
    ----------
    names
        What values are called, for lists; without it as they are declared.

    Signals
    -------
    valueChanged()
        By the user.
    """

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, declared: Declared, names: Callable[[Any], str] | None = None) -> None:
        super().__init__()
        self.declared = declared
        self._names = names or (lambda value: choice_text(declared.parameter, value))
        self._set_mm: float | None = None
        self._shown_m: float | None = None
        self.widget = self._made()
        self.widget.setToolTip(tip_of(declared.parameter))
        if isinstance(self.widget, QCheckBox):
            self.widget.toggled.connect(self.valueChanged)
        elif isinstance(self.widget, ChoiceBox):
            self.widget.currentIndexChanged.connect(self.valueChanged)
        else:
            self.widget.valueChanged.connect(self.valueChanged)
        self.setValue(declared.default)

    def _made(self) -> QCheckBox | ChoiceBox | NumberBox | WholeBox | QuantityBox:
        known, kind = self.declared.parameter, self.declared.kind
        if kind is bool and not any(choice.label for choice in known.choices):
            return QCheckBox(title_of(known))
        listed = [choice.value for choice in known.choices] or list(known.suggested)
        if listed:
            box = ChoiceBox()
            if self.declared.default is None:
                box.addItem(self._names(None), None)
            for value in listed:
                box.addItem(self._names(value), value)
            return box
        low, high = typed_range(known)
        if kind is int:
            return WholeBox(int(low), int(high))
        if known.unit == "m":
            return LengthBox(low, high, known.step)
        if known.unit == "m/s":
            return SpeedBox(low, high, known.step)
        if known.unit == "share":
            return PercentBox(low, high, known.step, known.decimals)
        if known.unit == "mm":
            return QuantityBox(sampling_unit, low / MM_PER_M, high / MM_PER_M, known.step)
        suffix = {"deg": "°", "": ""}.get(known.unit, f" {known.unit}")
        return NumberBox(low, high, known.step, suffix, known.decimals)

    def value(self) -> Any:
        """What the box says."""
        if isinstance(self.widget, QCheckBox):
            return self.widget.isChecked()
        if isinstance(self.widget, ChoiceBox):
            return self.widget.currentData()
        value = self.widget.value()
        if value == self._shown_m:
            return self._set_mm  # as it was: there and back it would be rounded
        return round(MM_PER_M * value, 6) if self.declared.parameter.unit == "mm" else value

    def setValue(self, value: Any) -> None:  # noqa: N802
        """Show a value; None, which only lists of such a default have, leaves other boxes as they are."""
        if value is None:
            if self.declared.default is None and isinstance(self.widget, ChoiceBox):
                self.widget.setCurrentIndex(0)
            return
        if isinstance(self.widget, QCheckBox):
            self.widget.setChecked(value)
        elif isinstance(self.widget, ChoiceBox):
            self.widget.show_value(value, self._names(value))
        elif self.declared.parameter.unit == "mm":
            self.widget.setValue(value / MM_PER_M)
            self._set_mm, self._shown_m = value, self.widget.value()
        else:
            self.widget.setValue(value)

    def offer(self, values: Iterable[Any]) -> None:
        """Let a list offer these values alone; the first stands in where the one that was shown is not among them."""
        if not isinstance(self.widget, ChoiceBox):
            raise TypeError(f"{self.declared.name}: expected a list, got {type(self.widget).__name__}")
        shown = self.value()
        with QSignalBlocker(self.widget):
            self.widget.clear()
            for value in values:
                self.widget.addItem(self._names(value), value)
            self.widget.setCurrentIndex(max(0, self.widget.findData(shown)))

    def set_units(self, system: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        if isinstance(self.widget, QuantityBox):
            self.widget.set_units(system)

    def add_to(self, form: Form) -> None:
        """Put it at the end of a form."""
        if isinstance(self.widget, QCheckBox):
            form.addRow(self.widget)
        else:
            form.addRow(title_of(self.declared.parameter), self.widget)


def rows_of(declared: Mapping[str, Declared], *, but: tuple[str, ...] = ()) -> dict[str, ParameterRow]:
    """A row for each parameter that has one in forms, by its name; `but` are made by the form itself."""
    return {name: ParameterRow(each) for name, each in declared.items() if each.parameter.row and name not in but}


def add_rows(form: Form, rows: Mapping[str, ParameterRow | tuple[str, QWidget]], order: tuple[str, ...] = ()) -> None:
    """Put rows into a form: those of `order` first, the others behind them as they are declared."""
    for name in dict.fromkeys((*order, *rows)):
        row = rows[name]
        if isinstance(row, ParameterRow):
            row.add_to(form)
        else:
            form.addRow(*([row[0]] if row[0] else []), row[1])
