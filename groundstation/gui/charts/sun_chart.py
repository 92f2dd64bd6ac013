"""The day of a site as a bar: when the sun is up, light on facades, and what take-offs of sorties spoil.

Rows tell by height as well as by colour: tall is all in the sun, or a take-off that spoils nothing. Where there is no
room for all rows, they get lower, their letters with them, down to those of usual size; then they scroll, under hours
that stay.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QMouseEvent, QMoveEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.mission.sunlight import HEIGHTS, DayRow, Look

PAD_PX, GAP_PX, TICK_PX = 6.0, 4.0, 4.0

LEAST_LINE_PX = 17.0
"""Height of a line of letters of usual size: those of large ones get no smaller."""

NAMES_SHARE = 0.3
"""Of the width that names may take; longer ones lose their middle."""

HOURS_APART = 1.25
"""Least distance of neighbouring hours in widths of their text."""


class SunChart(QWidget):
    """Draws rows, each with its name beside it, and the hours below.

    Signals
    -------
    picked(float)
        The part of the day, 0 to 1, that was clicked.
    """

    picked = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._rows: tuple[DayRow, ...] = ()
        self._hours: tuple[tuple[float, str], ...] = ()
        self._mark: float | None = None
        self.empty = ""
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName(self.tr("The day of the site"))
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self._make_room()

    def set_rows(self, rows: Sequence[DayRow], hours: Sequence[tuple[float, str]]) -> None:
        """Show a day: rows with names in the user's language, and where the hours are; none for nothing."""
        self._rows, self._hours = tuple(rows), tuple(hours)
        self._make_room()
        self.update()

    def set_mark(self, place: float | None) -> None:
        """Mark a part of the day, 0 to 1."""
        self._mark = place
        self.update()

    def mark(self) -> float | None:
        """The part of the day that is marked."""
        return self._mark

    def rows(self) -> tuple[DayRow, ...]:
        """What is drawn."""
        return self._rows

    def place_of(self, share: float, row: int = 0) -> QPointF:
        """Where a part of the day is drawn, in the middle of a row."""
        box = self._box(row)
        return QPointF(box.left() + share * box.width(), box.center().y())

    def _make_room(self) -> None:
        n, usual = max(1, len(self._rows)), QFontMetricsF(self.font()).height()
        self.setMinimumHeight(math.ceil(self._between_px() + (n + 1) * min(LEAST_LINE_PX, usual)))

    def _between_px(self) -> float:
        """Height of all but the rows and the hours themselves."""
        return 2.0 * PAD_PX + max(0, len(self._rows) - 1) * GAP_PX + TICK_PX

    def line_px(self) -> float:
        """Height of a row, and of the hours: that of the letters where there is room for it."""
        n, usual = max(1, len(self._rows)), QFontMetricsF(self.font()).height()
        return min(usual, max((self.height() - self._between_px()) / (n + 1), LEAST_LINE_PX))

    def _letters(self) -> QFont:
        font = QFont(self.font())
        font.setPointSizeF(font.pointSizeF() * self.line_px() / QFontMetricsF(font).height())
        return font

    def hours_top_px(self) -> float:
        """Where the hours begin: below the last row, or over the rows, at the lower edge of what is seen of them."""
        seen = self.visibleRegion().boundingRect()
        lower_edge = self.height() if seen.isEmpty() else seen.bottom() + 1
        return min(self._box(len(self._rows) - 1).bottom(), lower_edge - PAD_PX - self.line_px() - TICK_PX)

    def _box(self, row: int) -> QRectF:
        metrics = QFontMetricsF(self._letters())
        right = PAD_PX + 0.5 * metrics.horizontalAdvance("24:00")
        names = max((metrics.horizontalAdvance(each.name) for each in self._rows), default=0.0)
        left = max(right, 2.0 * PAD_PX + min(names, NAMES_SHARE * self.width()))
        line = self.line_px()
        return QRectF(left, PAD_PX + row * (line + GAP_PX), max(1.0, self.width() - left - right), line)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Say which part of the day is meant."""
        if self._rows and event.button() == Qt.MouseButton.LeftButton:
            box = self._box(0)
            self.picked.emit(min(1.0, max(0.0, (event.position().x() - box.left()) / box.width())))

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme, and the size of letters."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.PaletteChange, QEvent.Type.FontChange):
            self._make_room()
            self.update()

    def moveEvent(self, event: QMoveEvent) -> None:  # noqa: N802
        """Have the hours stay where they are while rows scroll below them."""
        super().moveEvent(event)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Names, rows, hours, the mark."""
        painter, look = QPainter(self), colours()
        painter.fillRect(self.rect(), QColor(look.base))
        if not self._rows:
            painter.setPen(QColor(look.muted))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(QRectF(self.rect()).adjusted(PAD_PX, PAD_PX, -PAD_PX, -PAD_PX), int(flags), self.empty)
            return
        painter.setFont(self._letters())
        for number, row in enumerate(self._rows):
            box = self._box(number)
            painter.setPen(QColor(look.text))
            room = QRectF(PAD_PX, box.top(), box.left() - 2.0 * PAD_PX, box.height())
            name = painter.fontMetrics().elidedText(row.name, Qt.TextElideMode.ElideMiddle, int(room.width()) + 1)
            painter.drawText(room, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter), name)
            self._paint_row(painter, box, row, look)
        last = self._box(len(self._rows) - 1)
        if self._mark is not None:
            x = self.place_of(self._mark).x()
            for colour, width_px in ((look.base, 4.0), (look.text, 2.0)):
                painter.setPen(QPen(QColor(colour), width_px))
                painter.drawLine(QPointF(x, self._box(0).top()), QPointF(x, last.bottom()))
        self._paint_hours(painter, last, look)

    def _paint_row(self, painter: QPainter, box: QRectF, row: DayRow, look: Colours) -> None:
        fills = {
            Look.NIGHT: look.line,
            Look.SKY: look.note,
            Look.SUN: look.open,
            Look.PARTLY: look.undecided,
            Look.SHADE: look.unreachable,
            Look.GOOD: look.ok,
            Look.FAIR: look.open,
            Look.BAD: look.error,
        }
        painter.setPen(Qt.PenStyle.NoPen)
        for stretch in row.stretches:
            tall = HEIGHTS[stretch.look] * box.height()
            x, end = (box.left() + share * box.width() for share in (stretch.first, stretch.last))
            part = QRectF(x, box.bottom() - tall, end - x, tall)
            if stretch.look is Look.FLIGHT:
                # Dark on light on whatever colour lies below.
                for colour, width_px in ((look.base, 4.0), (look.text, 2.0)):
                    painter.setPen(QPen(QColor(colour), width_px))
                    painter.drawRect(part)
                painter.setPen(Qt.PenStyle.NoPen)
            else:
                painter.fillRect(part, QColor(fills[stretch.look]))
        painter.setPen(QColor(look.line))
        painter.drawRect(box)

    def _paint_hours(self, painter: QPainter, last: QRectF, look: Colours) -> None:
        top = self.hours_top_px()
        if top < last.bottom():
            painter.fillRect(QRectF(0.0, top, self.width(), self.height() - top), QColor(look.base))
        painter.setPen(QColor(look.text))
        hour_px = HOURS_APART * QFontMetricsF(painter.font()).horizontalAdvance("24:00")
        every = 1 + int(hour_px * max(1, len(self._hours) - 1) / max(1.0, last.width()))
        for number, (share, text) in enumerate(self._hours):
            x = last.left() + share * last.width()
            painter.drawLine(QPointF(x, top), QPointF(x, top + TICK_PX))
            if number % every == 0:
                at = QRectF(x - hour_px, top + TICK_PX, 2.0 * hour_px, self.line_px())
                painter.drawText(at, int(Qt.AlignmentFlag.AlignHCenter), text)
