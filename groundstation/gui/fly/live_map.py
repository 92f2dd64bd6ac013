"""The aircraft, its track and the state of each view, over the shared map."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, QPointF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from groundstation.gui.fly.photo_strip import state_colour
from groundstation.gui.map_view import MapView
from groundstation.gui.theme import colours
from groundstation.services.live_events import ViewState
from groundstation.services.web_mercator import world_from_geodetic
from planning.geodesy.enu import geodetic_from_enu
from planning.site import Origin

Array = NDArray[np.float64]

AIRCRAFT_PX, DOT_PX = 16.0, 5.0


class LiveMap(QWidget):
    """Lies over a map, lets the pointer through, and moves with it."""

    def __init__(self, map_view: MapView) -> None:
        super().__init__(map_view)
        self._map = map_view
        self._track = np.zeros((0, 2))
        self._views: tuple[tuple[Array, ViewState], ...] = ()
        self._heading_rad = 0.0
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setGeometry(map_view.rect())
        map_view.installEventFilter(self)
        self.lower()
        self.show()

    def set_aircraft(self, origin: Origin, track_enu_m: Array, heading_rad: float) -> None:
        """Show a track, shape (n, 3), whose last point is where the aircraft is."""
        self._track, self._heading_rad = _world(origin, track_enu_m), heading_rad
        self.update()

    def set_views(self, origin: Origin, views: tuple[tuple[tuple[float, float, float], ViewState], ...]) -> None:
        """Show how the views of the sortie stand."""
        places = _world(origin, np.array([place for place, _ in views], np.float64).reshape(-1, 3))
        self._views = tuple((place, state) for place, (_, state) in zip(places, views, strict=True))
        self.update()

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Be as large as the map."""
        if event.type() == QEvent.Type.Resize:
            self.setGeometry(self._map.rect())
        return False

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Paint over what the map shows."""
        painter, look, viewport = QPainter(self), colours(), self._map.viewport()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for place, state in self._views:
            x, y = viewport.screen(place[None])[0]
            radius = 2.0 * DOT_PX if state is ViewState.NEXT else DOT_PX
            painter.setPen(QPen(QColor(look.base), 1))
            painter.setBrush(state_colour(state, look))
            painter.drawEllipse(QPointF(x, y), radius, radius)
        if len(self._track):
            points = [QPointF(x, y) for x, y in viewport.screen(self._track).tolist()]
            painter.setPen(QPen(QColor(look.accent), 3))
            painter.drawPolyline(QPolygonF(points))
            painter.setPen(QPen(QColor(look.text), 2))
            painter.setBrush(QColor(look.error))
            painter.drawPolygon(_arrow(points[-1], self._heading_rad))
        painter.end()


def _world(origin: Origin, points_enu_m: Array) -> Array:
    """Points of the map's plane, shape (n, 2)."""
    if len(points_enu_m) == 0:
        return np.zeros((0, 2))
    lat_deg, lon_deg, _ = geodetic_from_enu(origin, points_enu_m)
    return np.asarray(world_from_geodetic(lat_deg, lon_deg))


def _arrow(at: QPointF, heading_rad: float) -> QPolygonF:
    """An arrowhead whose tip points along the heading; north is up."""
    ahead = (math.sin(heading_rad), -math.cos(heading_rad))
    right = (-ahead[1], ahead[0])
    corners = ((1.0, 0.0), (-0.8, 0.7), (-0.4, 0.0), (-0.8, -0.7))
    return QPolygonF(
        [
            QPointF(
                at.x() + AIRCRAFT_PX * (a * ahead[0] + r * right[0]),
                at.y() + AIRCRAFT_PX * (a * ahead[1] + r * right[1]),
            )
            for a, r in corners
        ]
    )
