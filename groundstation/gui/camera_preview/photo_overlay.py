"""What lies over the preview: the rendered photo with panels' outlines, cross, horizon, figures, and the shutter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import QWidget

from groundstation.gui.view3d.pinhole import Pinhole
from groundstation.gui.widgets.theme import colours

CROSS_PX = 14.0
FLASH_OPACITY = 150
HORIZON = "#d55e00"
"""Vermilion, which building, sky and panels have nothing of."""


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Lines of one pen; `ends_px` are x and y of both ends, shape (n, 4)."""

    ends_px: NDArray[np.float64]
    colour: str
    width_px: float


class PhotoOverlay(QWidget):
    """Transparent for the mouse."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self._view: Pinhole | None = None
        self._text, self._note = "", ""
        self._is_flashing = False
        self._picture: QImage | None = None
        self._lines: tuple[Lines, ...] = ()
        self._painted: QPixmap | None = None
        """Picture and lines as they were painted last: there can be thousands of lines."""

    def show_photo(self, view: Pinhole | None, text: str) -> None:
        """Draw for a view; None draws nothing but the text."""
        self._view, self._text = view, text
        self.update()

    def show_picture(self, picture: QImage | None, lines: Sequence[Lines] = ()) -> None:
        """Put a photo in the place of what is drawn below, and lines over it; None takes both away."""
        self._picture, self._lines, self._painted = picture, tuple(lines), None
        self.update()

    def show_note(self, text: str) -> None:
        """Say something at the lower edge; nothing where it is empty."""
        if text != self._note:
            self._note = text
            self.update()

    def note(self) -> str:
        """What is said there."""
        return self._note

    def flash(self, is_on: bool) -> None:
        """Whiten the picture as long as the shutter is open."""
        if is_on != self._is_flashing:
            self._is_flashing = is_on
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw everything."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._picture is not None:
            painter.drawPixmap(0, 0, self._photo(self._picture))
        if self._is_flashing:
            painter.fillRect(self.rect(), QColor(255, 255, 255, FLASH_OPACITY))
        # A photo without outlines is seen as it is.
        if self._view is not None and (self._picture is None or self._lines):
            self._paint_horizon(painter, self._view)
            self._paint_cross(painter)
        if self._text:
            self._paint_plate(painter, self._text, QPointF(8.0, 8.0))
        if self._note:
            self._paint_plate(painter, self._note, QPointF(8.0, self.height() - 8.0), is_low=True)
        painter.end()

    def _photo(self, picture: QImage) -> QPixmap:
        size = self.size() * self.devicePixelRatio()
        if self._painted is None or self._painted.size() != size:
            self._painted = QPixmap(size)
            self._painted.setDevicePixelRatio(self.devicePixelRatio())
            painter = QPainter(self._painted)
            painter.setRenderHints(QPainter.RenderHint.SmoothPixmapTransform | QPainter.RenderHint.Antialiasing)
            painter.drawImage(QRectF(self.rect()), picture)
            for lines in self._lines:
                painter.setPen(QPen(QColor(lines.colour), lines.width_px))
                painter.drawLines([QLineF(*ends) for ends in lines.ends_px.tolist()])
            painter.end()
        return self._painted

    def _paint_cross(self, painter: QPainter) -> None:
        x, y = 0.5 * self.width(), 0.5 * self.height()
        for colour, width in (("#000000", 3.0), ("#ffffff", 1.2)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawLine(QPointF(x - CROSS_PX, y), QPointF(x + CROSS_PX, y))
            painter.drawLine(QPointF(x, y - CROSS_PX), QPointF(x, y + CROSS_PX))

    def _paint_horizon(self, painter: QPainter, view: Pinhole) -> None:
        """Roll is 0, so the horizon is level; it is in the picture where the pitch is within half the angle of view."""
        y = horizon_px(view)
        if not 0.0 <= y <= view.height_px:
            return
        for pen in (QPen(QColor("#ffffff"), 3.0), QPen(QColor(HORIZON), 1.5, Qt.PenStyle.DashLine)):
            painter.setPen(pen)
            painter.drawLine(QPointF(0.0, y), QPointF(self.width(), y))
        self._paint_plate(painter, self.tr("horizon"), QPointF(self.width() - 8.0, y + 4.0), is_right=True)

    def _paint_plate(
        self, painter: QPainter, shown: str, corner: QPointF, *, is_right: bool = False, is_low: bool = False
    ) -> None:
        """A text on a plate; `corner` is its upper left corner, unless it is one on the right or a lower one."""
        limit = QRectF(0.0, 0.0, self.width() - 30.0, self.height())
        size = QFontMetricsF(self.font()).boundingRect(limit, Qt.TextFlag.TextWordWrap, shown).size()
        box = QRectF(corner.x(), corner.y(), size.width() + 14.0, size.height() + 8.0)
        if is_right:
            box.moveRight(corner.x())
        if is_low:
            box.moveBottom(corner.y())
        plate = QColor(colours().base)
        plate.setAlpha(225)
        painter.setPen(QPen(QColor(colours().line), 1.0))
        painter.setBrush(plate)
        painter.drawRoundedRect(box, 3.0, 3.0)
        painter.setPen(QColor(colours().text))
        inner = box.adjusted(7.0, 4.0, -7.0, -4.0)
        painter.drawText(inner, Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap, shown)


def horizon_px(view: Pinhole) -> float:
    """Row of the horizon in a picture without roll; infinite where the camera looks straight up or down."""
    level = float(np.hypot(view.forward[0], view.forward[1]))
    if level < 1e-9:
        return float("inf")
    rise = -float(view.forward[2]) / level
    return 0.5 * view.height_px * (1.0 - rise / view.half_height)
