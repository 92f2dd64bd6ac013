"""What a web page is told about a scene besides its Gaussians: panes, facades, and where to look at first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.exports.ellipsoids import Ellipsoids
from reconstruction.objects.gs_scene import GsElement, GsScene
from reconstruction.objects.opening import largest, middle_of, outward
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View

Array = NDArray[np.float64]

HALF_FIELD = 0.46
"""Tangent of half the page's field of view, with some room."""

STEEPEST = 1.55
"""Pitch of the page's camera at most, radians."""

CLEAR_M = 1.0
"""Before a facade: frames and sunshades stand out that far, and are looked at, too."""

STEP, N_TRIED = 0.85, 9
"""Distances that are tried, each as a share of the one before: down to a quarter of what shows all of a facade."""

MOST_HIDDEN = 0.05
"""Share of the facade that may be hidden more than from the best of these distances."""

SIGHT_PX = 64, 48
"""Of the picture by which that is measured."""


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
        raise InputError(say("corners of a panel hold numbers that are not finite"))
    return {
        "facades": [{"id": facade.global_id, "name": facade.name} for facade in facades],
        "parts": [{"id": part.global_id, "name": part.name} for part in scene.components if part not in facades],
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
    """Where to look at first: square at the facade of the largest area, else at the Gaussians from the south.

    A place in metres, heading and pitch in radians, half the width and height of what is to be seen there, how far it
    comes forward, and how far from that one can go back before something else stands in the way.
    """
    origin = np.asarray(scene.origin_enu_m, np.float64)
    facades = [
        np.asarray([element.corners_enu_m for element in component.elements], np.float64) - origin
        for component in scene.components
        if component.elements
    ]
    if not facades:
        places = gaussians.means_m.astype(np.float64) if len(gaussians) else np.zeros((1, 3))
        low, high = np.quantile(places, (0.05, 0.95), axis=0)  # a few lie far out
        radius = max(float(np.linalg.norm(high - low)) / 2.0, 0.5)
        return _view((low + high) / 2.0, 0.0, -0.12, np.full(2, radius), 0.0, radius / HALF_FIELD)
    quads = facades[largest(facades)]
    normal, middle = outward(quads), middle_of(quads)
    forward = np.array([0.0, 1.0, 0.0]) if normal is None else -normal  # panels on all sides: from the south
    is_level = np.hypot(forward[0], forward[1]) > 1e-6
    heading = float(np.arctan2(forward[0], forward[1])) if is_level else 0.0
    pitch = float(np.clip(np.arcsin(np.clip(forward[2], -1.0, 1.0)), -STEEPEST, STEEPEST))
    axes = _axes(heading, pitch)
    inside = (quads.reshape(-1, 3) - middle) @ axes.T
    half, front = np.maximum(np.abs(inside[:, :2]).max(axis=0), 0.25), float(-inside[:, 2].min())
    free = _free_m(gaussians, middle, axes, half, front)
    return _view(middle, heading, pitch, half, front, free)


def _axes(heading: float, pitch: float) -> Array:
    """Right, down and forward of a camera, as rows."""
    sh, ch, sp, cp = np.sin(heading), np.cos(heading), np.sin(pitch), np.cos(pitch)
    return np.array([[ch, -sh, 0.0], [sp * sh, sp * ch, -cp], [cp * sh, cp * ch, sp]])


def _free_m(gaussians: Ellipsoids, middle: Array, axes: Array, half: Array, front: float) -> float:
    """How far before a facade one can stand so that what lies between hides hardly more of it than from near."""
    furthest = float(half.max()) / HALF_FIELD
    depths = (gaussians.means_m - middle) @ axes[2] + front
    between = gaussians.chosen((depths < -CLEAR_M) & (depths > -furthest - 1.0) & (gaussians.panels < 0))
    if not len(between):
        return furthest
    tried = [furthest * STEP**k for k in range(N_TRIED)]
    hidden = np.array([_hidden(between, middle, axes, half, front + distance) for distance in tried])
    return tried[int(np.argmax(hidden <= hidden.min() + MOST_HIDDEN))]


def _hidden(gaussians: Ellipsoids, middle: Array, axes: Array, half: Array, distance: float) -> float:
    """Share of a facade that Gaussians before it hide from a place straight in front."""
    cam_from_world = np.eye(4)
    cam_from_world[:3, :3] = axes
    cam_from_world[:3, 3] = -axes @ (middle - distance * axes[2])
    width, height = SIGHT_PX
    fx, fy = (0.5 * np.array(SIGHT_PX) / half * distance).tolist()
    view = View(width, height, fx, fy, width / 2.0, height / 2.0, torch.from_numpy(cam_from_world))
    means, quats, scales, opacities = (
        torch.from_numpy(each) for each in (gaussians.means_m, gaussians.quats, gaussians.scales_m, gaussians.opacities)
    )
    settings, nothing = RasterSettings(antialiased=True), torch.zeros(len(gaussians), 1)
    return float(rasterise(means, quats, scales, opacities, nothing, view, settings=settings).alphas.mean())


def _view(target: Array, heading: float, pitch: float, half: Array, front: float, free: float) -> dict[str, Any]:
    return {
        "target": _told(target),
        "heading": round(heading, 6),
        "pitch": round(pitch, 6),
        "half": _told(half),
        "front": round(front, 4),
        "free": round(free, 4),
    }


def _told(place: Array) -> list[float]:
    return [round(float(value), 4) for value in place]
