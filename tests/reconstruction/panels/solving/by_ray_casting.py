"""Panel corners as the paper makes them: rays onto the coarse model, then averages along rows and columns (Fig. 5b).

Kept to compare with, and for a photo whose facade has no surface fitted. `adjustment.py` is what is used: it needs no
vertical facade, weighs several photos, and says how good the corners are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]


def cast_corners(photo: PosedPhoto, corners_px: Array, caster: RayCaster) -> Array:
    """Points of the coarse model behind corners in a photo.

    Parameters
    ----------
    corners_px
        Shape (rows, columns, 2): the crossings of the grid's lines; NaN where there is none.

    Returns
    -------
    NDArray
        Shape (rows, columns, 3), ENU; NaN where a ray hits nothing.
    """
    if corners_px.ndim != 3 or corners_px.shape[2] != 2:
        raise ValueError(f"corners_px: expected shape (rows, columns, 2), got {corners_px.shape}")
    flat = corners_px.reshape(-1, 2)
    known = np.isfinite(flat).all(axis=1)
    points = np.full((len(flat), 3), np.nan)
    origins, directions = photo.rays(flat[known])
    hits = caster.cast(origins, directions)
    reached = np.where(hits.is_hit, hits.distance_m, np.nan)[:, None] * directions + origins
    points[known] = reached
    return points.reshape(*corners_px.shape[:2], 3)


def averaged(corners_enu_m: Array) -> Array:
    """Corners whose z is the mean of their row, and x and y those of their column; NaN are left out of the means.

    Right for an upright facade with level rows, plane or cylinder, which is what the paper has.

    Parameters
    ----------
    corners_enu_m
        Shape (rows, columns, 3). A row or column without any corner stays NaN.
    """
    known = np.asarray(np.isfinite(corners_enu_m).all(axis=2))
    values = np.where(known[..., None], corners_enu_m, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = values[..., 2].sum(axis=1) / known.sum(axis=1)
        xy = values[..., :2].sum(axis=0) / known.sum(axis=0)[:, None]
    rows, columns = known.shape
    return np.concatenate(
        [np.broadcast_to(xy[None], (rows, columns, 2)), np.broadcast_to(z[:, None, None], (rows, columns, 1))], axis=2
    )
