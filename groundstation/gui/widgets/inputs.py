"""Input boxes: numbers, quantities in the user's units, and lists to choose from.

`value()` gives back exactly what `setValue()` was given until the user edits it, however it is rounded for display, and
though the user could not have typed it: a form must not change what it only shows. The mouse wheel scrolls what is
around and changes no box: the one typed into last may slide under the pointer. What was typed counts before a shortcut
does.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any

from PySide6.QtCore import QEvent, QLocale, QObject, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QHelpEvent, QKeyEvent, QKeySequence, QPaintEvent, QStandardItemModel, QValidator
from PySide6.QtWidgets import (
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QDateTimeEdit,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QStyle,
    QStyleOptionComboBox,
    QStylePainter,
    QToolTip,
    QWidget,
)

from groundstation.gui.widgets.terms import label_of
from groundstation.services.units import Unit, UnitSystem, length_unit, speed_unit

SAME = 1e-9
"""Part of a value below which a box that rounds for display still holds the value it was given."""

PERCENT = Unit("%", 100.0, 1)

N_LETTERS_SHOWN, ARROW_PX = 6, 40
"""Least room of a list to choose from."""

N_LETTERS_IN_FORM = 16
"""Least room of one in a form; what is beside it goes above it before it has less."""

TEXT_MARGIN_PX = 2
"""Between the frame of a list to choose from and its text."""

N_DIGITS_SHOWN = 9
"""Width of a box for whole numbers; longer ones scroll in it."""


EDITING = (
    QKeySequence.StandardKey.Copy,
    QKeySequence.StandardKey.Cut,
    QKeySequence.StandardKey.Paste,
    QKeySequence.StandardKey.SelectAll,
    QKeySequence.StandardKey.Undo,
    QKeySequence.StandardKey.Redo,
)
"""Keys of the text itself; any other with Ctrl or Alt asks for something that is done with the number."""

ALONE = frozenset({Qt.Key.Key_Control, Qt.Key.Key_Alt, Qt.Key.Key_Meta, Qt.Key.Key_Shift, Qt.Key.Key_AltGr})
"""Keys that begin others."""


class _Calm(QObject):
    """Keeps the wheel from boxes, and has what was typed taken before a shortcut is followed."""

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Leave the wheel to what is around; sliders, which stand in no form, have it after a click."""
        kind = event.type()
        if kind == QEvent.Type.Wheel:
            is_own = isinstance(watched, QAbstractSlider) and watched.hasFocus()
            if not is_own:
                event.ignore()
            return not is_own
        if kind == QEvent.Type.ShortcutOverride and isinstance(watched, QAbstractSpinBox) and _is_order(event):
            watched.interpretText()
        return False


def _is_order(event: QEvent) -> bool:
    """Whether a key may be a shortcut that something is done by."""
    modifiers = Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.AltModifier | Qt.KeyboardModifier.MetaModifier
    if not isinstance(event, QKeyEvent) or event.key() in ALONE or any(event.matches(key) for key in EDITING):
        return False
    is_function = Qt.Key.Key_F1 <= event.key() <= Qt.Key.Key_F35
    return is_function or bool(event.modifiers() & modifiers)


def calm(widget: QWidget) -> None:
    """Let the wheel scroll the form over a widget, and take what was typed into it before a shortcut is followed."""
    widget.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    widget.installEventFilter(_Calm(widget))


class ChoiceBox(QComboBox):
    """A list to choose from, each entry with its value.

    A text that has no room ends in an ellipsis, and the tool tip says all of it.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._n_letters = N_LETTERS_SHOWN
        # A model of our own: Qt's may lie where an item was that Python still knows, and comes back as that item.
        model = QStandardItemModel(0, 1, self)
        self.setModel(model)
        for changed in (model.rowsInserted, model.rowsRemoved, model.dataChanged):
            changed.connect(self.updateGeometry)
        calm(self)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Room for a few letters: a long text is cut before it pushes other things off a small screen."""
        hint, metrics = super().minimumSizeHint(), self.fontMetrics()
        longest = max((metrics.horizontalAdvance(self.itemText(n)) for n in range(self.count())), default=0)
        letters = min(longest, self._n_letters * metrics.averageCharWidth())
        return QSize(letters + ARROW_PX, hint.height())

    def want_letters(self, n_letters: int) -> None:
        """Have room for more letters at least, where an entry is that long."""
        self._n_letters = n_letters
        self.updateGeometry()

    def shown_text(self) -> str:
        """The choice, as far as there is room for it."""
        option = QStyleOptionComboBox()
        self.initStyleOption(option)
        control, field = QStyle.ComplexControl.CC_ComboBox, QStyle.SubControl.SC_ComboBoxEditField
        room = self.style().subControlRect(control, option, field, self).width() - 2 * TEXT_MARGIN_PX
        if not option.currentIcon.isNull():
            room -= option.iconSize.width() + 2 * TEXT_MARGIN_PX
        return self.fontMetrics().elidedText(self.currentText(), Qt.TextElideMode.ElideRight, room)

    def is_cut(self) -> bool:
        """Whether the choice is longer than what is shown of it."""
        return self.shown_text() != self.currentText()

    def help_text(self) -> str:
        """What the tool tip says: all of a choice that is cut, and what the box is for."""
        return "\n".join(text for text in (self.currentText() if self.is_cut() else "", self.toolTip()) if text)

    def event(self, event: QEvent) -> bool:
        """Say all of what is cut."""
        if event.type() == QEvent.Type.ToolTip and isinstance(event, QHelpEvent) and self.is_cut():
            QToolTip.showText(event.globalPos(), self.help_text(), self)
            return True
        return super().event(event)

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Draw the choice with an ellipsis where it is cut."""
        painter, option = QStylePainter(self), QStyleOptionComboBox()
        self.initStyleOption(option)
        painter.drawComplexControl(QStyle.ComplexControl.CC_ComboBox, option)
        option.currentText = self.shown_text()
        painter.drawControl(QStyle.ControlElement.CE_ComboBoxLabel, option)

    def show_value(self, value: object, text: str = "") -> None:
        """Choose the entry with a value; where there is none, such as one from a file, it gets one."""
        if self.findData(value) < 0:
            self.addItem(text or str(value), value)
        self.setCurrentIndex(self.findData(value))


class Form(QFormLayout):
    """Titles and fields; a title goes above its field where there is no room for both beside each other."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        self.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        self.setLabelAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)

    def addRow(self, *parts: Any) -> None:  # noqa: N802
        """As forms do; a list to choose from has room for its words, and a term has a "?"."""
        field = parts[-1]
        if isinstance(field, ChoiceBox):
            field.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            field.want_letters(N_LETTERS_IN_FORM)
        if len(parts) == 2 and isinstance(parts[0], str) and isinstance(field, QWidget):
            label = label_of(parts[0], field)
            label.setBuddy(field)
            parts = label, field
        super().addRow(*parts)


def moment_of(edit: QDateTimeEdit) -> datetime:
    """The time that stands in a box, to the second, in this computer's time zone."""
    return datetime.fromtimestamp(edit.dateTime().toSecsSinceEpoch(), tz=UTC).astimezone()


class NumberBox(QDoubleSpinBox):
    """A number with a fixed unit."""

    def __init__(
        self, low: float, high: float, step: float, suffix: str = "", decimals: int = 1, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self._held: tuple[float, float] | None = None
        self._coming: float | None = None
        self._typed = low, high
        self.setRange(low, high)
        self.setDecimals(decimals)
        self.setSingleStep(step)
        self.setSuffix(suffix)
        self.setAccelerated(True)
        self.setKeyboardTracking(False)
        calm(self)
        # As all texts of the window have it; in a German locale the point would group thousands, and 3.5 become 35.
        self.setLocale(QLocale.c())

    def value(self) -> float:
        """What was set, or what the user made of it."""
        if self._coming is not None:
            return self._coming
        shown = super().value()
        return self._held[0] if self._held is not None and self._held[1] == shown else shown

    def setValue(self, value: float) -> None:  # noqa: N802
        """Show a value; as long as it stands, the range holds it though it could not be typed."""
        self._coming = value
        try:
            self._hold(value)
            super().setValue(value)
        finally:
            self._coming = None
        self._held = value, super().value()

    def setRange(self, low: float, high: float) -> None:  # noqa: N802
        """What can be typed; a value that was set stays."""
        self._typed = low, high
        if self._held is None:
            super().setRange(low, high)
        else:
            self._hold(self.value())

    def _hold(self, value: float) -> None:
        low, high = self._typed
        super().setRange(min(low, value), max(high, value))

    def setDecimals(self, decimals: int) -> None:  # noqa: N802
        """How many are shown; the value stays."""
        is_held = self._held is not None and self._held[1] == super().value()
        value = self.value()
        super().setDecimals(decimals)
        self._held = (value, super().value()) if is_held else None

    def forget(self) -> None:
        """Hold only what is shown, as if it had been typed."""
        self._held = None

    def validate(self, text: str, position: int) -> Any:
        """Take a comma for the decimal point too."""
        return super().validate(text.replace(",", "."), position)

    def valueFromText(self, text: str) -> float:  # noqa: N802
        """Take a comma for the decimal point too."""
        return super().valueFromText(text.replace(",", "."))


class WholeBox(QAbstractSpinBox):
    """A whole number of any size: those of Qt end at 2 147 483 647.

    Signals
    -------
    valueChanged(int)
        The user took another number: by Enter, by leaving the box, or by a step.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, low: int, high: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._typed, self._value = (low, high), low
        self.setAccelerated(True)
        calm(self)
        self.setMinimumWidth(self.fontMetrics().horizontalAdvance("0") * N_DIGITS_SHOWN)
        self.editingFinished.connect(self._finish)
        self._show()

    def value(self) -> int:
        """The number."""
        return self._value

    def setValue(self, value: int) -> None:  # noqa: N802
        """Show a number; as long as it stands, it counts as one that can be typed."""
        self._take(value)

    def minimum(self) -> int:
        """The least that can be typed."""
        return min(self._typed[0], self._value)

    def maximum(self) -> int:
        """The most that can be typed."""
        return max(self._typed[1], self._value)

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        """Digits, a sign where there are negative numbers, and no more than the most."""
        low, high = self.minimum(), self.maximum()
        digits = text.strip().removeprefix("-") if low < 0 else text.strip()
        if not digits:
            return QValidator.State.Intermediate, text, position
        if not (digits.isascii() and digits.isdigit()) or int(digits) > max(high, -low):
            return QValidator.State.Invalid, text, position
        is_good = low <= int(text) <= high
        return QValidator.State.Acceptable if is_good else QValidator.State.Intermediate, text, position

    def stepBy(self, steps: int) -> None:  # noqa: N802
        """By arrow, key or wheel."""
        self._take(min(max(self._value + steps, self.minimum()), self.maximum()))
        self.selectAll()

    def stepEnabled(self) -> QAbstractSpinBox.StepEnabledFlag:  # noqa: N802
        """Whether there is a number above and below."""
        flag = QAbstractSpinBox.StepEnabledFlag
        up = flag.StepUpEnabled if self._value < self.maximum() else flag.StepNone
        return up | (flag.StepDownEnabled if self._value > self.minimum() else flag.StepNone)

    def interpretText(self) -> None:  # noqa: N802
        """Take what was typed."""
        self._finish()

    def _finish(self) -> None:
        state, _, _ = self.validate(self.text(), 0)
        if state == QValidator.State.Acceptable:
            self._take(int(self.text()))
        self._show()

    def _take(self, value: int) -> None:
        changed, self._value = value != self._value, value
        self._show()
        if changed:
            self.valueChanged.emit(value)

    def _show(self) -> None:
        self.lineEdit().setText(str(self._value))


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
        """Show a metric value; as long as it stands, the range holds it though it could not be typed."""
        self._value = value
        self._show()

    def set_units(self, system: UnitSystem) -> None:
        """Show the same value in other units."""
        self._unit = self._unit_of(system)
        with QSignalBlocker(self._box):
            self._box.setDecimals(self._unit.decimals if self._decimals is None else self._decimals)
            self._box.forget()
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
        low, high = min(self._low, self._value), max(self._high, self._value)
        value = min(max(self._unit.metric(shown), low), high)
        if abs(value - self._value) > SAME * max(1.0, abs(self._value)):
            self._value = value
            self.valueChanged.emit(value)


class PercentBox(QuantityBox):
    """A ratio, shown in percent."""

    def __init__(self, low: float, high: float, step: float, decimals: int = 1, parent: QWidget | None = None) -> None:
        super().__init__(lambda _system: PERCENT, low, high, 100.0 * step, decimals=decimals, parent=parent)


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
