"""Several lines over time in one chart; it is drawn several times a second beside a training."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen

from groundstation.gui.charts.axes import PAD_PX, Axes, Chart, box_of_axes
from groundstation.gui.widgets.theme import SORTIES, Colours

MARK_PX = 27.0

DOT_PX, MOST_DOTS = 5.0, 40
"""So few points are dots, too."""

DASHES = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine, Qt.PenStyle.DashDotLine)
"""Lines are told by these, too: not all people see all colours."""


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line with its name for the legend, x rising, shapes (n,)."""

    name: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]


class LinesPlot(Chart):
    """Draws what it gets, with titles of its axes; time begins at 0, the other axis where the lines do.

    Without lines it says `empty`.
    """

    def __init__(self, title_x: str, title_y: str, empty: str = "") -> None:
        super().__init__(title_x, title_y, least_height_px=120)
        self.empty = empty
        self._lines: tuple[Line, ...] = ()
        self._from_zero = False

    def lines(self) -> tuple[Line, ...]:
        """What is drawn."""
        return self._lines

    def set_title_x(self, title: str) -> None:
        """Another unit of time."""
        self.title_x = title

    def set_lines(self, lines: tuple[Line, ...], *, from_zero: bool = False) -> None:
        """Draw other lines; `from_zero` where the lower end of the axis is to be 0."""
        self._lines, self._from_zero = lines, from_zero
        self.update()

    def range_y(self) -> tuple[float, float]:
        """Ends of the upright axis, a little beyond the lines."""
        known = [line.y[np.isfinite(line.y)] for line in self._lines]
        values = np.concatenate(known) if known else np.zeros(0)
        if not len(values):
            return 0.0, 1.0
        low, high = float(values.min()), float(values.max())
        low = 0.0 if self._from_zero else low
        room = max(0.08 * (high - low), 1e-3 * abs(high), 1e-9)
        return (low if self._from_zero else low - room), high + room

    def axes(self) -> Axes | None:
        """Room for the legend above them."""
        if not any(len(line.x) for line in self._lines):
            return None
        rows = 0 if len(self._lines) < 2 else math.ceil(len(self._lines) / self._columns())
        box = box_of_axes(QRectF(self.rect()), self.font(), rows * QFontMetricsF(self.font()).height())
        end_x = max([1.0, *(1.02 * float(line.x[-1]) for line in self._lines if len(line.x))])
        low, high = self.range_y()
        return Axes(box, end_x, high, low)

    def paint_inside(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Lines, and dots where they are few."""
        for number, line in enumerate(self._lines):
            corners = zip(line.x.tolist(), line.y.tolist(), strict=True)
            points = [axes.place(x, y) for x, y in corners if math.isfinite(y)]
            painter.setPen(_pen(number, look))
            painter.drawPolyline(points)
            if len(points) <= MOST_DOTS:
                painter.setPen(QPen(_pen(number, look).color(), DOT_PX, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
                painter.drawPoints(points)

    def _columns(self) -> int:
        """Of the legend: two where all names have room."""
        metrics = QFontMetricsF(self.font())
        widest = max((metrics.horizontalAdvance(line.name) for line in self._lines), default=0.0)
        return 2 if 2.0 * (widest + MARK_PX + 4.0) < 0.75 * self.width() else 1

    def paint_above(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Legend."""
        box = axes.box
        if len(self._lines) < 2:
            return
        height, columns = QFontMetricsF(self.font()).height(), self._columns()
        width = box.width() / columns
        for number, line in enumerate(self._lines):
            left, top = box.left() + width * (number % columns), PAD_PX + height * (number // columns)
            painter.setPen(_pen(number, look))
            painter.drawLine(QPointF(left, top + 0.5 * height), QPointF(left + 22.0, top + 0.5 * height))
            painter.setPen(QColor(look.text))
            place = QRectF(left + MARK_PX, top, width - MARK_PX - 2.0, height)
            name = QFontMetricsF(self.font()).elidedText(line.name, Qt.TextElideMode.ElideRight, place.width())
            painter.drawText(place, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, name)


def _pen(number: int, look: Colours) -> QPen:
    colour = QColor(SORTIES[(number + 1) % len(SORTIES)])
    return QPen(colour.lighter(140) if look.is_dark else colour, 2.0, DASHES[number % len(DASHES)])
