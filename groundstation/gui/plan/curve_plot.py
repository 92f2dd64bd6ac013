"""A rising curve over time with the bound above it, painted by Qt alone.

It is drawn ten times a second beside a running plan, and laid out anew when one begins: a plot of pyqtgraph takes 5 to
20 ms for that, this one less than one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from groundstation.gui.theme import Colours, colours
from groundstation.services.map_shapes import round_length

Array = NDArray[np.float64]

PAD_PX = 6.0

TICKS_X_PX, TICKS_Y_PX = 55.0, 26.0
"""Least distance of neighbouring ticks: their numbers must not touch."""

WIDEST_NUMBER = "88888"
"""The left margin has room for it, so that the curve does not jump sideways while numbers grow."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """What is drawn.

    Parameters
    ----------
    x, y
        Corners of a line of steps, both rising, shape (n,): each value holds until the next one comes.
    end_x, end_y
        Ends of the axes, which begin at 0; positive.
    bound
        Height of the dashed line; None for none.
    now
        Place of the dotted line; None for none.
    """

    x: Array
    y: Array
    end_x: float
    end_y: float
    bound: float | None = None
    now: float | None = None

    def place(self, box: QRectF, x: float, y: float) -> QPointF:
        """Where a point is drawn, with the axes at the left and lower sides of a box."""
        return QPointF(box.left() + box.width() * x / self.end_x, box.bottom() - box.height() * y / self.end_y)


class CurvePlot(QWidget):
    """Draws what it gets, with the titles of its axes."""

    def __init__(self, title_x: str, title_y: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._title_x, self._title_y = title_x, title_y
        self._curve = Curve(np.zeros(0), np.zeros(0), 1.0, 1.0)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMinimumHeight(110)

    def curve(self) -> Curve:
        """What is drawn."""
        return self._curve

    def set_curve(self, curve: Curve) -> None:
        """Draw another curve."""
        self._curve = curve
        self.update()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Axes, then what lies in them."""
        painter, look, curve, box = QPainter(self), colours(), self._curve, self._box()
        painter.fillRect(self.rect(), QColor(look.base))
        self._paint_axes(painter, look, box)
        painter.setClipRect(box.adjusted(-1.0, -1.0, 1.0, 1.0))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if curve.bound is not None:
            painter.setPen(QPen(QColor(look.error), 1.5, Qt.PenStyle.DashLine))
            painter.drawLine(curve.place(box, 0.0, curve.bound), curve.place(box, curve.end_x, curve.bound))
        if curve.now is not None:
            painter.setPen(QPen(QColor(look.muted), 1.0, Qt.PenStyle.DotLine))
            painter.drawLine(curve.place(box, curve.now, 0.0), curve.place(box, curve.now, curve.end_y))
        painter.setPen(QPen(QColor(look.accent if look.is_dark else look.covered), 2.5))
        painter.drawPolyline(steps(curve, box))
        painter.end()

    def _box(self) -> QRectF:
        """Where the curve is, between the numbers and titles of the axes."""
        metrics = QFontMetricsF(self.font())
        line = metrics.height()
        left = line + metrics.horizontalAdvance(WIDEST_NUMBER) + 2.0 * PAD_PX
        inner = QRectF(self.rect()).adjusted(left, PAD_PX, -2.0 * PAD_PX, -2.0 * line - PAD_PX)
        return inner if inner.width() > 1.0 and inner.height() > 1.0 else QRectF(left, PAD_PX, 1.0, 1.0)

    def _paint_axes(self, painter: QPainter, look: Colours, box: QRectF) -> None:
        curve, metrics = self._curve, QFontMetricsF(self.font())
        line = metrics.height()
        grid, text = QColor(look.line), QColor(look.text)
        grid.setAlpha(130)
        below, beside = Qt.AlignmentFlag.AlignHCenter, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        for x in ticks(curve.end_x, TICKS_X_PX / box.width()):
            at = curve.place(box, x, 0.0)
            painter.setPen(grid)
            painter.drawLine(at, QPointF(at.x(), box.top()))
            painter.setPen(text)
            painter.drawText(QRectF(at.x() - 40.0, box.bottom() + 2.0, 80.0, line), below, f"{x:g}")
        for y in ticks(curve.end_y, TICKS_Y_PX / box.height()):
            at = curve.place(box, 0.0, y)
            painter.setPen(grid)
            painter.drawLine(at, QPointF(box.right(), at.y()))
            painter.setPen(text)
            painter.drawText(QRectF(0.0, at.y() - line, box.left() - PAD_PX, 2.0 * line), beside, f"{y:g}")
        painter.drawText(QRectF(box.left(), box.bottom() + line, box.width(), line), below, self._title_x)
        painter.save()
        # A title that is longer than the axis reaches below it rather than out of the widget.
        length = metrics.horizontalAdvance(self._title_y)
        painter.translate(PAD_PX, max(box.center().y(), 0.5 * length))
        painter.rotate(-90.0)
        painter.drawText(QRectF(-0.5 * length, 0.0, length, line), below, self._title_y)
        painter.restore()
        painter.setPen(QColor(look.line))
        painter.drawLine(box.topLeft(), box.bottomLeft())
        painter.drawLine(box.bottomLeft(), box.bottomRight())


def steps(curve: Curve, box: QRectF) -> list[QPointF]:
    """The line of steps; of corners that share a column of pixels, the last."""
    if len(curve.x) == 0:
        return []
    column = (curve.x / curve.end_x * box.width()).astype(np.int64)
    kept = np.append(np.flatnonzero(np.diff(column)), len(column) - 1)
    points: list[QPointF] = []
    for x, y in zip(curve.x[kept].tolist(), curve.y[kept].tolist(), strict=True):
        corner = curve.place(box, x, y)
        if points:
            points.append(QPointF(corner.x(), points[-1].y()))
        points.append(corner)
    return points


def ticks(end: float, least: float) -> list[float]:
    """Round numbers from 0 to `end`, evenly apart, by at least the part `least` of all."""
    step = round_length(2.5 * least * end)
    return [step * number for number in range(int(end / step * (1.0 + 1e-9)) + 1)]
