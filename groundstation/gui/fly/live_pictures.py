"""The flight in the shared 3-D view and on the shared map, drawn a few times a second while they are seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QTimer

from groundstation.gui.fly.flight_in_hand import FlightInHand
from groundstation.gui.fly.live_map import LiveMap
from groundstation.gui.fly.live_scene import LiveScene
from groundstation.gui.map_view import MapView
from groundstation.gui.stage import Stage, StagePage
from groundstation.gui.view3d.paint import ColourScale
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.services.live_events import LiveView, PhotoCounted

DRAW_EVERY_MS = 250
"""A frame takes some 36 ms where the processor draws: four in a second leave the rest of it to everything else."""

MAX_TRACK_POINTS = 4000
"""Older points are thinned out: more are no finer on any screen."""


class LivePictures(QObject):
    """Draws the flight in hand while it is shown."""

    def __init__(self, stage: Stage, parent: QObject) -> None:
        super().__init__(parent)
        self._stage = stage
        self._flight: FlightInHand | None = None
        self._scene: LiveScene | None = None
        self._map: LiveMap | None = None
        self._is_shown = False
        self._is_stale = self._has_photo = False
        self._timer = QTimer(self, interval=DRAW_EVERY_MS)
        self._timer.timeout.connect(self.draw)

    def set_flight(self, flight: FlightInHand | None) -> None:
        """Show another flight, or none."""
        if self._is_shown and flight is not self._flight:
            self._clear()
        self._flight, self._is_stale, self._has_photo = flight, True, flight is not None and flight.counted is not None

    def show(self, flight: FlightInHand | None) -> None:
        """Draw, and go on drawing."""
        self._is_shown = True
        self.set_flight(flight)
        self._stage.with_scene(self._scene_is_there)
        self._timer.start()
        self.draw()

    def hide(self) -> None:
        """Take everything away, and draw no more."""
        self._is_shown = False
        self._timer.stop()
        self._clear()

    def take_view(self, _view: LiveView) -> None:
        """There is something new to draw."""
        self._is_stale = True

    def take_photo(self, _counted: PhotoCounted) -> None:
        """There is new coverage to paint."""
        self._is_stale = self._has_photo = True

    def draw(self) -> None:
        """Bring what is seen up to date, where anything changed."""
        flight = self._flight
        if not self._is_shown or not self._is_stale or flight is None or flight.view is None:
            return
        self._is_stale = False
        if self._stage.page() is StagePage.MAP:
            self._draw_map(flight, flight.view)
        elif self._stage.page() is StagePage.SCENE and self._scene is not None:
            self._draw_scene(self._scene, flight, flight.view)

    def _scene_is_there(self, scene: SceneView) -> None:
        if self._scene is None:
            self._scene = LiveScene(scene)
        self._is_stale = True

    def _draw_scene(self, scene: LiveScene, flight: FlightInHand, view: LiveView) -> None:
        plan = flight.sortie.case.plan
        scene.draw_views(view.view_states, {viewpoint.id: viewpoint for viewpoint in plan.viewpoints})
        scene.draw_aircraft(view.state, _thinned(flight), plan.camera, view.readouts.facade_m)
        if self._has_photo and flight.counted is not None:
            self._has_photo = False
            self._paint_coverage(flight, flight.counted)

    def _paint_coverage(self, flight: FlightInHand, counted: PhotoCounted) -> None:
        view = self._stage.scene()
        site = flight.sortie.case.site_model.site
        if view is None or counted.counts.shape[0] != site.n_panels:
            return
        planned = flight.sortie.case.measures.counts > 0
        n_planned = planned.sum(axis=1)
        share = np.full(len(n_planned), np.nan)
        np.divide(100.0 * ((counted.counts > 0) & planned).sum(axis=1), n_planned, out=share, where=n_planned > 0)
        view.set_panel_values(ColourScale(self.tr("Flown of what is planned"), "%", 0.0, 100.0), share)

    def _draw_map(self, flight: FlightInHand, view: LiveView) -> None:
        map_view = self._stage.findChild(MapView)
        if map_view is None:
            return
        if self._map is None:
            self._map = LiveMap(map_view)
        origin = flight.sortie.case.site_model.site.origin
        by_id = {viewpoint.id: viewpoint.position_enu_m for viewpoint in flight.sortie.case.plan.viewpoints}
        self._map.set_views(origin, tuple((by_id[view_id], state) for view_id, state in view.view_states))
        heading = 0.0 if view.state.attitude is None else view.state.attitude.value.heading_rad
        self._map.set_aircraft(origin, _thinned(flight), heading)
        self._map.show()

    def _clear(self) -> None:
        if self._scene is not None:
            self._scene.clear()
        scene = self._stage.scene()
        if scene is not None:
            scene.set_panel_values(None)
        if self._map is not None:
            self._map.hide()


def _thinned(flight: FlightInHand) -> NDArray[np.float64]:
    """The track, shape (n, 3), of so many points as can be drawn quickly; the last one is always in it."""
    track = flight.track_enu_m
    step = max(1, -(-len(track) // MAX_TRACK_POINTS))
    return np.array([*track[:-1:step], *track[-1:]], np.float64).reshape(-1, 3)
