"""One small picture per severity: shapes differ, so that nobody depends on their colours."""

from __future__ import annotations

import math

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap, QPolygonF

from groundstation.gui.widgets.theme import Colours
from planning.base.findings import Severity

SIZE_PX = 22


def severity_colour(severity: Severity, found: Colours) -> QColor:
    """Colour of a severity in a theme."""
    return QColor(
        {Severity.ERROR: found.error, Severity.WARNING: found.warning, Severity.OK: found.ok}.get(severity, found.note)
    )


def severity_icon(severity: Severity, found: Colours) -> QIcon:
    """An octagon with a cross, a triangle with a bar, a circle with an i, or a tick."""
    ratio = 2.0  # sharp on screens with two pixels to the point
    picture = QPixmap(int(SIZE_PX * ratio), int(SIZE_PX * ratio))
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    colour, paper = severity_colour(severity, found), QColor(found.base)
    # A rim keeps the shape visible on a pressed button of the same colour.
    painter.setPen(QPen(paper, 1.5))
    painter.setBrush(colour)
    sign = QPen(paper, 2.4, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap)
    match severity:
        case Severity.ERROR:
            painter.drawPolygon(_polygon(8, 11.0, 10.5, math.pi / 8.0))
            painter.setPen(sign)
            painter.drawLine(QPointF(7.5, 7.5), QPointF(14.5, 14.5))
            painter.drawLine(QPointF(14.5, 7.5), QPointF(7.5, 14.5))
        case Severity.WARNING:
            painter.drawPolygon(_polygon(3, 12.5, 12.0, -math.pi / 2.0))
            painter.setPen(sign)
            painter.drawLine(QPointF(11.0, 8.0), QPointF(11.0, 12.5))
            painter.drawPoint(QPointF(11.0, 16.0))
        case Severity.NOTE:
            painter.drawEllipse(QRectF(1.5, 1.5, 19.0, 19.0))
            painter.setPen(sign)
            painter.drawPoint(QPointF(11.0, 6.5))
            painter.drawLine(QPointF(11.0, 10.5), QPointF(11.0, 16.0))
        case Severity.OK:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            for ink, width in ((paper, 5.0), (colour, 3.0)):
                painter.setPen(QPen(ink, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
                painter.drawPolyline(QPolygonF([QPointF(4.0, 12.0), QPointF(9.0, 17.0), QPointF(18.0, 5.0)]))
    painter.end()
    return QIcon(picture)


def _polygon(corners: int, centre_y: float, radius: float, first_rad: float) -> QPolygonF:
    angles = [first_rad + 2.0 * math.pi * i / corners for i in range(corners)]
    return QPolygonF([QPointF(11.0 + radius * math.cos(a), centre_y + radius * math.sin(a)) for a in angles])
