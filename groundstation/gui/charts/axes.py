"""The axes of charts, painted by Qt alone.

Charts that are drawn several times a second beside a running plan or training use them, and others to look alike; a
plot of pyqtgraph takes 5 to 20 ms to be laid out anew, these less than one to be painted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter

from groundstation.gui.widgets.theme import Colours
from groundstation.services.map.shapes import round_length

PAD_PX = 6.0

TICKS_X_PX, TICKS_Y_PX = 60.0, 26.0
"""Least distance of neighbouring ticks: their numbers must not touch."""

WIDEST_NUMBER = "0.0005"
"""The left margin has room for it, so that what is drawn does not jump sideways while numbers grow."""

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
        box, line = self.box, QFontMetricsF(painter.font()).height()
        grid = QColor(look.line)
        grid.setAlpha(GRID_ALPHA)
        for x in ticks(0.0, self.end_x, TICKS_X_PX / box.width()):
            at = self.place(x, self.low)
            painter.setPen(grid)
            painter.drawLine(at, QPointF(at.x(), box.top()))
            painter.setPen(QColor(look.text))
            painter.drawText(QRectF(at.x() - 40.0, box.bottom() + 2.0, 80.0, line), BELOW, f"{x:g}")
        for y in ticks(self.low, self.high, TICKS_Y_PX / box.height()):
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


def _paint_upright(painter: QPainter, box: QRectF, title: str) -> None:
    """A title along the upright axis; one that is longer reaches below it rather than out of the widget."""
    metrics = QFontMetricsF(painter.font())
    length = metrics.horizontalAdvance(title)
    painter.save()
    painter.translate(PAD_PX, max(box.center().y(), 0.5 * length))
    painter.rotate(-90.0)
    painter.drawText(QRectF(-0.5 * length, 0.0, length, metrics.height()), BELOW, title)
    painter.restore()
