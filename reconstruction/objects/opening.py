"""From where a building is seen at first: from where a photo was taken, since nothing stood before the facade there.

Straight in front of a facade, far enough away to see all of it, there may be the house across the street.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_M = 2.0
"""Before the facade's plane."""


def places_of(training: Mapping[str, Any]) -> Array:
    """Where a scene's photos were taken, ENU, shape (k, 3); of models that do not know it none."""
    try:
        places = np.asarray(training.get("places_enu_m", ()), np.float64).reshape(-1, 3)
    except (TypeError, ValueError):
        return np.zeros((0, 3))
    return places[np.isfinite(places).all(axis=1)]


def outward(corners_enu_m: Array) -> Array | None:
    """Mean unit normal of panels, shape (3,); None where they have no side in common.

    Parameters
    ----------
    corners_enu_m
        Shape (n, 4, 3), counter-clockwise as seen from outside.
    """
    normal = np.cross(corners_enu_m[:, 2] - corners_enu_m[:, 0], corners_enu_m[:, 3] - corners_enu_m[:, 1]).sum(axis=0)
    length = float(np.linalg.norm(normal))
    return normal / length if length > 1e-9 else None


def middle_of(corners_enu_m: Array) -> Array:
    """Of the box around panels, shape (3,)."""
    points = corners_enu_m.reshape(-1, 3)
    middle: Array = 0.5 * (points.min(axis=0) + points.max(axis=0))
    return middle


def opening_place(corners_enu_m: Array, places_enu_m: Array, half_field: float) -> Array | None:
    """The place of a photo from which a facade is seen best, shape (3,); None where no photo was taken before it.

    It is the one with the least of: by which share the facade is larger than the field of view, and 1 less the cosine
    between the line of sight and the facade's normal.

    Parameters
    ----------
    corners_enu_m
        Of the facade's panels, shape (n, 4, 3).
    places_enu_m
        Shape (k, 3).
    half_field
        Tangent of half the field of view.
    """
    normal = outward(corners_enu_m) if len(corners_enu_m) else None
    if normal is None or not len(places_enu_m):
        return None
    points, middle = corners_enu_m.reshape(-1, 3), middle_of(corners_enu_m)
    towards = middle - places_enu_m
    before = -towards @ normal
    forward = towards / np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    rays = points[None] - places_enu_m[:, None]
    depths = np.einsum("kpi,ki->kp", rays, forward)
    across = np.sqrt(np.maximum((rays**2).sum(axis=2) - depths**2, 0.0))
    tangents = np.where(depths > 0.0, across / np.maximum(depths, 1e-9), np.inf).max(axis=1)
    cost = np.maximum(tangents / half_field - 1.0, 0.0) + 1.0 + forward @ normal
    cost[before < LEAST_M] = np.inf
    best = int(np.argmin(cost))
    return places_enu_m[best] if np.isfinite(cost[best]) else None
