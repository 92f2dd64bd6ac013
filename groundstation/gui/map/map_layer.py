"""Site and plan painted once into a picture larger than the map, so that panning and zooming only move that picture."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QFont, QImage, QPainter

from groundstation.gui.map.map_paint import paint_landings, paint_plan, paint_site
from groundstation.gui.map.viewport import Viewport
from groundstation.gui.widgets.theme import Colours
from groundstation.services.map.shapes import PlanShapes, SiteShapes

MARGIN = 0.5
"""Part of its width and height by which the picture reaches beyond the map on each side."""

SAME_ZOOM = 1e-6


class MapLayer:
    """The picture, and the viewport that it was painted for."""

    def __init__(self) -> None:
        self._picture: QImage | None = None
        self._made_for = Viewport()

    def forget(self) -> None:
        """What it shows has changed."""
        self._picture = None

    def is_usable(self) -> bool:
        """Whether there is a picture at all."""
        return self._picture is not None

    def is_sharp(self, viewport: Viewport) -> bool:
        """Whether the picture has the zoom of what is in sight and reaches all of it."""
        if self._picture is None or abs(viewport.zoom - self._made_for.zoom) > SAME_ZOOM:
            return False
        return self._target(viewport).contains(QRectF(0.0, 0.0, viewport.width_px, viewport.height_px))

    def make(
        self,
        viewport: Viewport,
        site: SiteShapes,
        plan: PlanShapes | None,
        found: Colours,
        font: QFont,
        pixel_ratio: float,
    ) -> None:
        """Paint site and plan for what is in sight and its margin."""
        width, height = (round(size * (1.0 + 2.0 * MARGIN)) for size in (viewport.width_px, viewport.height_px))
        wide = viewport.resized(width, height)
        picture = QImage(
            round(width * pixel_ratio), round(height * pixel_ratio), QImage.Format.Format_ARGB32_Premultiplied
        )
        picture.setDevicePixelRatio(pixel_ratio)
        picture.fill(Qt.GlobalColor.transparent)
        painter = QPainter(picture)
        painter.setFont(font)
        paint_site(painter, wide, site, found)
        if plan is not None:
            paint_plan(painter, wide, plan)
        paint_landings(painter, wide.screen(site.landings()), found)
        painter.end()
        self._picture, self._made_for = picture, wide

    def paint(self, painter: QPainter, viewport: Viewport) -> None:
        """Put the picture where it belongs in what is in sight, stretched where the zoom has changed since."""
        if self._picture is None:
            return
        target = self._target(viewport)
        if abs(viewport.zoom - self._made_for.zoom) <= SAME_ZOOM:
            painter.drawImage(QPointF(round(target.x()), round(target.y())), self._picture)
        else:
            painter.drawImage(target, self._picture, QRectF(self._picture.rect()))

    def _target(self, viewport: Viewport) -> QRectF:
        made = self._made_for
        stretch = viewport.scale / made.scale
        width, height = made.width_px * stretch, made.height_px * stretch
        x = (made.centre[0] - viewport.centre[0]) * viewport.scale + (viewport.width_px - width) / 2.0
        y = (made.centre[1] - viewport.centre[1]) * viewport.scale + (viewport.height_px - height) / 2.0
        return QRectF(x, y, width, height)
