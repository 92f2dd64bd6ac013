"""From where a building is seen at first: square before its largest facade.

Far enough away to see all of it, there may be the house across the street; where photos were taken, there was not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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


def largest(facades: Sequence[Array]) -> int:
    """Which facade's panels have the largest area together; the first of several.

    Parameters
    ----------
    facades
        Corners of each one's panels, shape (n, 4, 3); at least one.
    """
    areas = [
        np.linalg.norm(np.cross(each[:, 2] - each[:, 0], each[:, 3] - each[:, 1]), axis=1).sum() for each in facades
    ]
    return int(np.argmax(areas))


def standoff_m(corners_enu_m: Array, places_enu_m: Array) -> float | None:
    """From how far photos of a facade were taken: the median over those before it; None where there are none.

    Nothing stood between them and the facade.

    Parameters
    ----------
    corners_enu_m
        Of the facade's panels, shape (n, 4, 3).
    places_enu_m
        Shape (k, 3).
    """
    normal = outward(corners_enu_m) if len(corners_enu_m) else None
    if normal is None:
        return None
    before = (places_enu_m - middle_of(corners_enu_m)) @ normal
    before = before[before >= LEAST_M]
    return float(np.median(before)) if len(before) else None
