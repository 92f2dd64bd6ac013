"""What a web page is told about a scene besides its Gaussians: panes, facades, and where to look at first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.errors import InputError
from reconstruction.exports.ellipsoids import Ellipsoids
from reconstruction.objects.gs_scene import GsElement, GsScene
from reconstruction.objects.opening import middle_of, opening_place, outward, places_of

Array = NDArray[np.float64]

HALF_FIELD = 0.46
"""Tangent of half the page's field of view, with some room."""


def panes_of(gaussians: Ellipsoids, elements: Sequence[GsElement]) -> NDArray[np.int32]:
    """Place among `elements` of the panel that each lies on, -1 for none."""
    pane_of = np.full(max((element.panel for element in elements), default=-1) + 2, -1, np.int32)
    for pane, element in enumerate(elements):
        pane_of[element.panel] = pane
    return pane_of[gaussians.panels]  # -1 takes the last, which is none


def described_panes(scene: GsScene, elements: Sequence[GsElement]) -> dict[str, Any]:
    """Facades, and panes with their corners in metres, ENU less the scene's `origin_enu_m`.

    Raises
    ------
    InputError
        A corner is not finite.
    """
    facades = [component for component in scene.components if component.kind == "facade"]
    of_element = [number for number, facade in enumerate(facades) for _ in facade.elements]
    origin = np.asarray(scene.origin_enu_m, np.float64)
    corners = [np.asarray(element.corners_enu_m, np.float64) - origin for element in elements]
    if not all(np.isfinite(each).all() for each in corners):
        raise InputError("corners of a panel hold numbers that are not finite")
    return {
        "facades": [{"id": facade.global_id, "name": facade.name} for facade in facades],
        "panes": [
            {
                "id": element.global_id,
                "name": element.name,
                "facade": facade,
                "corners": [round(float(value), 5) for value in places.ravel()],
                "is_bare": element.n_gaussians == 0,
            }
            for element, facade, places in zip(elements, of_element, corners, strict=True)
        ],
    }


def first_view(scene: GsScene, elements: Sequence[GsElement], gaussians: Ellipsoids) -> dict[str, Any]:
    """Where to look at first: at the panels from before them, else at the Gaussians from the south.

    A place in metres, the radius of what is to be seen around it, and a heading in radians. Where it is known where
    photos were taken, the eye is there, and what is looked at is the facade that has most panels.
    """
    heading, origin = 0.0, np.asarray(scene.origin_enu_m, np.float64)
    if elements:
        corners = np.asarray([element.corners_enu_m for element in elements], np.float64) - origin
        places = corners.reshape(-1, 3)
        largest = max(
            (component for component in scene.components if component.elements), key=lambda each: len(each.elements)
        )
        quads = np.asarray([element.corners_enu_m for element in largest.elements], np.float64)
        eye = opening_place(quads, places_of(scene.training), HALF_FIELD)
        if eye is not None:
            return _view(middle_of(quads) - origin, quads.reshape(-1, 3), heading) | {"eye": _told(eye - origin)}
        normal = outward(quads)
        if normal is not None and np.hypot(normal[0], normal[1]) > 1e-9:
            heading = float(np.arctan2(-normal[0], -normal[1]))
    else:
        places = gaussians.means_m.astype(np.float64) if len(gaussians) else np.zeros((1, 3))
    # Of Gaussians a few lie far out.
    low, high = np.quantile(places, (0.0, 1.0) if elements else (0.05, 0.95), axis=0)
    return _view((low + high) / 2.0, np.array([low, high]), heading)


def _view(target: Array, points: Array, heading: float) -> dict[str, Any]:
    radius = float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) / 2.0
    return {"target": _told(target), "radius": round(max(radius, 0.5), 4), "heading": round(heading, 6)}


def _told(place: Array) -> list[float]:
    return [round(float(value), 4) for value in place]
