"""Charts that are painted by Qt alone: their axes, and the widget that all of them are.

Charts that are drawn several times a second beside a running plan or training are of this kind, and others to look
alike: with 500 points a new curve costs half of what pyqtgraph takes to lay its plot out. Charts of a whole flight
that are zoomed and clicked into, and drawn once, are pyqtgraph's: `profile_chart.py`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from groundstation.gui.widgets.scrolling import fitted
from groundstation.gui.widgets.theme import SORTIES, Colours, colours
from groundstation.services.map.shapes import round_length

PAD_PX = 6.0

WIDEST_NUMBER = "0.0005"
"""The left margin has room for it, so that what is drawn does not jump sideways while numbers grow."""

APART_X_PX, APART_Y = 16.0, 1.6
"""Between the numbers of neighbouring ticks, and of those above one another in lines: they must not touch."""

GRID_ALPHA = 130

BELOW = Qt.AlignmentFlag.AlignHCenter
BESIDE = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter


@dataclass(frozen=True, slots=True)
class Axes:
    """What lies where in a chart; the axis to the right begins at 0.

    Parameters
    ----------
    box
        Between the numbers and titles of the axes, px.
    end_x
        Of the axis to the right; positive.
    low, high
        Ends of the upright axis, `low` below `high`.
    """

    box: QRectF
    end_x: float
    high: float
    low: float = 0.0

    def place(self, x: float, y: float) -> QPointF:
        """Where a point is drawn."""
        box, rise = self.box, (y - self.low) / (self.high - self.low)
        return QPointF(box.left() + box.width() * x / self.end_x, box.bottom() - box.height() * rise)

    def paint(self, painter: QPainter, look: Colours, title_x: str, title_y: str = "") -> None:
        """Grid, numbers, titles and the axes themselves, in the painter's font."""
        metrics = QFontMetricsF(painter.font())
        box, line, wide = self.box, metrics.height(), metrics.horizontalAdvance(WIDEST_NUMBER)
        grid = QColor(look.line)
        grid.setAlpha(GRID_ALPHA)
        for x in ticks(0.0, self.end_x, (wide + APART_X_PX) / box.width()):
            at = self.place(x, self.low)
            painter.setPen(grid)
            painter.drawLine(at, QPointF(at.x(), box.top()))
            painter.setPen(QColor(look.text))
            painter.drawText(QRectF(at.x() - wide, box.bottom() + 2.0, 2.0 * wide, line), BELOW, f"{x:g}")
        for y in ticks(self.low, self.high, APART_Y * line / box.height()):
            at = self.place(0.0, y)
            painter.setPen(grid)
            painter.drawLine(at, QPointF(box.right(), at.y()))
            painter.setPen(QColor(look.text))
            painter.drawText(QRectF(0.0, at.y() - line, box.left() - PAD_PX, 2.0 * line), BESIDE, f"{y:g}")
        painter.drawText(QRectF(box.left(), box.bottom() + line, box.width(), line), BELOW, title_x)
        if title_y:
            _paint_upright(painter, box, title_y)
        painter.setPen(QColor(look.line))
        painter.drawLine(box.topLeft(), box.bottomLeft())
        painter.drawLine(box.bottomLeft(), box.bottomRight())


def box_of_axes(chart: QRectF, font: QFont, above_px: float = 0.0) -> QRectF:
    """Where in a chart things are drawn; at least a pixel wide and high.

    Parameters
    ----------
    above_px
        Left free for what stands above.
    """
    metrics = QFontMetricsF(font)
    line, top = metrics.height(), PAD_PX + above_px
    left = line + metrics.horizontalAdvance(WIDEST_NUMBER) + 2.0 * PAD_PX
    inner = chart.adjusted(left, top, -2.0 * PAD_PX, -2.0 * line - PAD_PX)
    return inner if inner.width() > 1.0 and inner.height() > 1.0 else QRectF(left, PAD_PX, 1.0, 1.0)


def ticks(low: float, high: float, least: float) -> list[float]:
    """Round numbers from `low` to `high`, evenly apart, by at least the part `least` of their distance."""
    step = round_length(max(2.5 * least * (high - low), 1e-12))
    first = math.ceil(low / step - 1e-9)
    return [step * number for number in range(first, math.floor(high / step + 1e-9) + 1)]


class Chart(QWidget):
    """Paints axes and what lies in them, in the colours of the theme; a chart says where its axes are and what.

    Without anything to draw it says `empty`.
    """

    def __init__(self, title_x: str, title_y: str = "", least_height_px: int = 110) -> None:
        super().__init__()
        self.title_x, self.title_y, self.empty = title_x, title_y, ""
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMinimumHeight(least_height_px)
        self.setAccessibleName(title_y)

    def axes(self) -> Axes | None:
        """Where things lie; None where there is nothing to draw."""
        raise NotImplementedError

    def paint_inside(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Paint what lies between the axes; nothing reaches beyond them."""
        raise NotImplementedError

    def paint_above(self, painter: QPainter, axes: Axes, look: Colours) -> None:
        """Paint what stands above them, such as a legend."""

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Axes, what lies in them, what stands above."""
        painter, look, axes = QPainter(self), colours(), self.axes()
        painter.fillRect(self.rect(), QColor(look.base))
        if axes is None:
            painter.setPen(QColor(look.muted))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(QRectF(self.rect()).adjusted(PAD_PX, PAD_PX, -PAD_PX, -PAD_PX), int(flags), self.empty)
        else:
            axes.paint(painter, look, self.title_x, self.title_y)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setClipRect(axes.box.adjusted(-1.0, -1.0, 1.0, 1.0))
            self.paint_inside(painter, axes, look)
            painter.setClipping(False)
            self.paint_above(painter, axes, look)
        painter.end()


def _paint_upright(painter: QPainter, box: QRectF, title: str) -> None:
    """A title along the upright axis; one that is longer reaches below it, and is written smaller in a low widget."""
    painter.save()
    font, title = fitted(painter.font(), title, painter.device().height() - 2.0 * PAD_PX)
    painter.setFont(font)
    metrics = QFontMetricsF(font)
    length = metrics.horizontalAdvance(title)
    painter.translate(PAD_PX, max(box.center().y(), 0.5 * length))
    painter.rotate(-90.0)
    painter.drawText(QRectF(-0.5 * length, 0.0, length, metrics.height()), BELOW, title)
    painter.restore()


# Several lines over time in one chart; it is drawn several times a second beside a training.

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
            font, name = fitted(self.font(), line.name, place.width())
            painter.setFont(font)
            painter.drawText(place, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, name)


def _pen(number: int, look: Colours) -> QPen:
    colour = QColor(SORTIES[(number + 1) % len(SORTIES)])
    return QPen(colour.lighter(140) if look.is_dark else colour, 2.0, DASHES[number % len(DASHES)])
