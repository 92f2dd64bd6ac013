"""The aircraft, its track, its picture and the state of each view, drawn into the shared 3-D view."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.fly.photo_strip import state_colour
from groundstation.gui.theme import Colours, colours
from groundstation.gui.view3d.layers import ON_TOP, Drawable
from groundstation.gui.view3d.paint import flat
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.view3d.shapes import frusta, joined, polyline
from groundstation.services.live_events import ViewState
from groundstation.vehicle.state import VehicleState
from planning.plan import Camera, Viewpoint, ViewpointArrays

AIRCRAFT_M = 6.0
"""Length of the aircraft as it is drawn: larger than it is, so that it is found in a view of the whole site."""

TRACK_PX, OUTLINE_PX, PICTURE_PX, FOOTPRINT_PX = 4.0, 5.0, 1.0, 3.0
DOT_PX = {
    ViewState.TO_COME: 5.0,
    ViewState.NEXT: 16.0,
    ViewState.TAKEN: 10.0,
    ViewState.OFF: 12.0,
    ViewState.MISSING: 14.0,
}
NAMES = ("live-track", "live-aircraft", "live-picture", "live-footprint", "live-views")


class LiveScene:
    """Draws onto a 3-D view until it is cleared."""

    def __init__(self, scene: SceneView) -> None:
        self._scene = scene
        self._drawn_states: tuple[tuple[str, ViewState], ...] | None = None

    def draw_views(self, states: tuple[tuple[str, ViewState], ...], by_id: dict[str, Viewpoint]) -> None:
        """A dot on each view of the sortie, by its state."""
        if states == self._drawn_states:
            return
        self._drawn_states = states
        look, parts = colours(), []
        for wanted in ViewState:
            places = [
                by_id[view_id].position_enu_m for view_id, state in states if state is wanted and view_id in by_id
            ]
            if places:
                points = np.array(places, np.float64)
                dots = np.arange(len(points))[:, None]
                colour = flat(state_colour(wanted, look).name(), len(points))
                # Where to look next is seen through walls, all else where it is.
                shift = ON_TOP if wanted is ViewState.NEXT else 0.0
                parts.append(Drawable(points, dots, colour, width_px=DOT_PX[wanted], depth_shift=shift))
        self._scene.canvas().draw("live-views", parts)

    def draw_aircraft(
        self, state: VehicleState, track_enu_m: NDArray[np.float64], camera: Camera, facade_m: float | None
    ) -> None:
        """Where it is, where it was, and what its camera sees: a pyramid, and the border of its picture on the site."""
        canvas, look = self._scene.canvas(), colours()
        canvas.draw("live-track", _track(track_enu_m, look))
        if state.motion is None:
            return
        place = np.array(state.motion.value.position_enu_m)
        heading = 0.0 if state.attitude is None else state.attitude.value.heading_rad
        canvas.draw("live-aircraft", _aircraft(place, heading, look))
        pointing = state.camera
        if pointing is None or facade_m is None:
            canvas.draw("live-picture", ())
            canvas.draw("live-footprint", ())
            return
        view = ViewpointArrays(
            place[None], np.array([pointing.value.heading_rad]), np.array([pointing.value.pitch_rad])
        )
        points, cells = frusta(view, camera, max(1.0, facade_m))
        canvas.draw("live-picture", [Drawable(points, cells, flat(look.accent, len(cells)), width_px=PICTURE_PX)])
        pieces = self._scene.photo_border(view, 0, camera)
        canvas.draw("live-footprint", _lines(pieces, look))

    def clear(self) -> None:
        """Take everything away."""
        self._drawn_states = None
        for name in NAMES:
            self._scene.canvas().draw(name, ())


def _track(track_enu_m: NDArray[np.float64], look: Colours) -> list[Drawable]:
    points, cells = polyline(track_enu_m)
    if len(cells) == 0:
        return []
    return [Drawable(points, cells, flat(look.accent, len(cells)), width_px=TRACK_PX)]


def _lines(pieces: list[NDArray[np.float64]], look: Colours) -> list[Drawable]:
    if not pieces:
        return []
    points, cells = joined([polyline(piece) for piece in pieces])
    return [Drawable(points, cells, flat(look.accent, len(cells)), width_px=FOOTPRINT_PX)]


def _aircraft(place: NDArray[np.float64], heading_rad: float, look: Colours) -> list[Drawable]:
    """An arrowhead that points where the nose does, level, over everything, with an outline that any ground shows."""
    ahead = np.array([math.sin(heading_rad), math.cos(heading_rad), 0.0])
    right = np.array([ahead[1], -ahead[0], 0.0])
    size = 0.5 * AIRCRAFT_M
    points = place + size * np.array([1.2 * ahead, -ahead + 0.8 * right, -0.5 * ahead, -ahead - 0.8 * right])
    body = np.array([[0, 1, 2], [0, 2, 3]])
    ring = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    centre = Drawable(place[None], np.array([[0]]), flat(look.error, 1), width_px=12.0, depth_shift=ON_TOP)
    edges = Drawable(points, ring, flat(look.text, 4), width_px=OUTLINE_PX, depth_shift=ON_TOP)
    return [Drawable(points, body, flat(look.error, 2)), edges, centre]
