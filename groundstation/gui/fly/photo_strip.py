"""A time line of the sortie's photos: planned, next, taken with the error of its place, or missing."""

from __future__ import annotations

import math

from PySide6.QtCore import QEvent, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QHelpEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QFrame, QScrollArea, QSizePolicy, QToolTip, QWidget

from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.fly.events import PhotoCounted, ViewState
from groundstation.services.units import UnitSystem, length_unit

CELL_PX, ROW_PX = 30, 34
"""Wanted size of a cell; they get half as wide before the strip takes another row."""

LEAST_CELL_PX = 15.0
SIGNS = {
    ViewState.TO_COME: "\u00b7",
    ViewState.NEXT: "\u25b6",
    ViewState.TAKEN: "\u2713",
    ViewState.OFF: "!",
    ViewState.MISSING: "\u2717",
}
"""No state is told by colour alone."""


class PhotoStrip(QWidget):
    """Shows the views of a sortie in the order of flight; a click goes to one.

    Signals
    -------
    picked(str)
        Identifier of a view.
    reached(int)
        Number of the view that comes next, or that the keyboard is at.
    resized()
        It takes another number of rows.
    """

    picked = Signal(str)
    reached = Signal(int)
    resized = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._states: tuple[tuple[str, ViewState], ...] = ()
        self._photos: dict[str, PhotoCounted] = {}
        self._units = UnitSystem.METRIC
        self._focused = 0
        self.setAccessibleName(self.tr("Photos of the sortie"))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def set_states(self, states: tuple[tuple[str, ViewState], ...]) -> None:
        """Show how each view stands."""
        if states != self._states:
            had, self._states = len(self._states), states
            if had != len(states):
                self._focused = 0
                self._make_room()
            self.update()
            following = next((i for i, (_, state) in enumerate(states) if state is ViewState.NEXT), None)
            if following is not None:
                self.reached.emit(following)

    def set_photos(self, photos: dict[str, PhotoCounted]) -> None:
        """Photos by the view that they are of."""
        self._photos = photos
        self.update()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units

    def states(self) -> tuple[tuple[str, ViewState], ...]:
        """What is shown."""
        return self._states

    def cell(self, number: int) -> QRectF:
        """Where a view is drawn, counted from 0."""
        columns, width = self._columns()
        row, column = divmod(number, columns)
        return QRectF(column * width, row * ROW_PX, width, ROW_PX)

    def words(self, number: int) -> str:
        """What is known of a view's photo."""
        view_id, state = self._states[number]
        said = {
            ViewState.TO_COME: self.tr("still to come"),
            ViewState.NEXT: self.tr("next"),
            ViewState.TAKEN: self.tr("taken"),
            ViewState.OFF: self.tr("taken, but not where it was planned"),
            ViewState.MISSING: self.tr("passed without a photo"),
        }[state]
        text = self.tr("{0}: {1}").format(view_id, said)
        photo = self._photos.get(view_id)
        if photo is not None and photo.position_error_m is not None:
            text += "\n" + self.tr("place off by {0}").format(length_unit(self._units).text(photo.position_error_m))
            if photo.heading_error_deg is not None:
                text += "\n" + self.tr("heading off by {0:.1f} deg").format(photo.heading_error_deg)
            if photo.gimbal_pitch_error_deg is not None:
                text += "\n" + self.tr("pitch off by {0:.1f} deg").format(photo.gimbal_pitch_error_deg)
            text += "\n" + self.tr("new sections: {0}").format(photo.n_new)
        return text

    def sizeHint(self) -> QSize:  # noqa: N802
        """Room for all rows."""
        columns, _ = self._columns()
        rows = max(1, math.ceil(len(self._states) / columns))
        return QSize(400, rows * ROW_PX + 2)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """As high as its rows."""
        return QSize(100, self.sizeHint().height())

    def resizeEvent(self, event: object) -> None:  # noqa: N802
        """Another width takes other rows."""
        super().resizeEvent(event)  # type: ignore[arg-type]
        self._make_room()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Paint the cells."""
        painter, look = QPainter(self), colours()
        for number, (_, state) in enumerate(self._states):
            box = self.cell(number).adjusted(1, 1, -1, -1)
            colour = state_colour(state, look)
            is_filled = state is not ViewState.TO_COME
            painter.setPen(QPen(QColor(look.line if state is ViewState.TO_COME else colour.name()), 1))
            painter.setBrush(colour if is_filled else QColor(look.base))
            painter.drawRect(box)
            painter.setPen(QColor(look.base if is_filled else look.muted))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, SIGNS[state])
            if self.hasFocus() and number == self._focused:
                painter.setBrush(Qt.BrushStyle.NoBrush)
                painter.setPen(QPen(QColor(look.text), 3))
                painter.drawRect(box)
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Go to a view."""
        number = self._number_at(event.position().x(), event.position().y())
        if number is not None:
            self._focused = number
            self.update()
            self.picked.emit(self._states[number][0])

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Left and right go along, Return goes to the view."""
        step = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(Qt.Key(event.key()))
        if step is not None and self._states:
            self._focused = min(max(self._focused + step, 0), len(self._states) - 1)
            self.update()
            self.reached.emit(self._focused)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space) and self._states:
            self.picked.emit(self._states[self._focused][0])
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Say what is known of the view under the pointer."""
        if isinstance(event, QHelpEvent):
            number = self._number_at(event.pos().x(), event.pos().y())
            QToolTip.showText(event.globalPos(), "" if number is None else self.words(number), self)
            return True
        return super().event(event)

    def _make_room(self) -> None:
        self.updateGeometry()
        self.resized.emit()

    def _columns(self) -> tuple[int, float]:
        n, width = max(1, len(self._states)), max(1.0, float(self.width()))
        rows = math.ceil(n * LEAST_CELL_PX / width)
        columns = math.ceil(n / rows)
        return columns, min(float(CELL_PX), width / columns)

    def _number_at(self, x: float, y: float) -> int | None:
        columns, cell = self._columns()
        column, row = int(x // cell), int(y // ROW_PX)
        number = row * columns + column
        return number if 0 <= column < columns and 0 <= number < len(self._states) else None


class ScrolledStrip(QScrollArea):
    """A strip in as much room as there is, one row at least; what is reached is in sight."""

    def __init__(self, strip: PhotoStrip, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._strip, self._at = strip, 0
        self.setWidget(strip)
        self.setWidgetResizable(True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Maximum)
        strip.resized.connect(self._make_room)
        strip.reached.connect(self._show)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Room for all rows."""
        return self._strip.sizeHint()

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """One row."""
        return QSize(100, ROW_PX + 2)

    def _make_room(self) -> None:
        self.updateGeometry()
        self._show(self._at)

    def _show(self, number: int) -> None:
        self._at = number
        middle = self._strip.cell(number).center()
        self.ensureVisible(int(middle.x()), int(middle.y()), 0, ROW_PX // 2)


def state_colour(state: ViewState, look: Colours) -> QColor:
    """Colour of a view's state, in the strip, in the 3-D view and on the map."""
    return QColor(
        {
            ViewState.TO_COME: look.muted,
            ViewState.NEXT: look.accent,
            ViewState.TAKEN: look.ok,
            ViewState.OFF: look.warning,
            ViewState.MISSING: look.error,
        }[state]
    )
