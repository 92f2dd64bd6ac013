"""A rising curve over time with the bound above it; it is drawn ten times a second beside a running plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from groundstation.gui.charts.axes import Axes, box_of_axes
from groundstation.gui.widgets.theme import colours

Array = NDArray[np.float64]


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

    def axes(self, box: QRectF) -> Axes:
        """To draw it in a box."""
        return Axes(box, self.end_x, self.end_y)


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
        painter, look, curve = QPainter(self), colours(), self._curve
        axes = curve.axes(box_of_axes(QRectF(self.rect()), self.font()))
        painter.fillRect(self.rect(), QColor(look.base))
        axes.paint(painter, look, self._title_x, self._title_y)
        painter.setClipRect(axes.box.adjusted(-1.0, -1.0, 1.0, 1.0))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if curve.bound is not None:
            painter.setPen(QPen(QColor(look.error), 1.5, Qt.PenStyle.DashLine))
            painter.drawLine(axes.place(0.0, curve.bound), axes.place(curve.end_x, curve.bound))
        if curve.now is not None:
            painter.setPen(QPen(QColor(look.muted), 1.0, Qt.PenStyle.DotLine))
            painter.drawLine(axes.place(curve.now, 0.0), axes.place(curve.now, curve.end_y))
        painter.setPen(QPen(QColor(look.accent if look.is_dark else look.covered), 2.5))
        painter.drawPolyline(steps(curve, axes))
        painter.end()


def steps(curve: Curve, axes: Axes) -> list[QPointF]:
    """The line of steps; of corners that share a column of pixels, the last."""
    if len(curve.x) == 0:
        return []
    column = (curve.x / curve.end_x * axes.box.width()).astype(np.int64)
    kept = np.append(np.flatnonzero(np.diff(column)), len(column) - 1)
    points: list[QPointF] = []
    for x, y in zip(curve.x[kept].tolist(), curve.y[kept].tolist(), strict=True):
        corner = axes.place(x, y)
        if points:
            points.append(QPointF(corner.x(), points[-1].y()))
        points.append(corner)
    return points
