"""How wide the frames between panels are, and panels grown to cover them: the facade as one region."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planning.site.records import Facade
from reconstruction.dataset.refined_mesh import drawn_in

Array = NDArray[np.float64]

WIDEST_FRAME_M = 0.6
"""Panels further apart than this have a wall between them, not a frame."""

BARE_M = 0.05
"""Grown by where a facade's panels have no neighbours to measure a frame by."""


def grown_corners(facades: Sequence[Facade]) -> Array:
    """Corners of all panels, in the facades' order, moved outwards by half a frame, shape (n, 4, 3)."""
    grown = []
    for facade in facades:
        corners = np.array([panel.corners_enu_m for panel in facade.panels], float).reshape(-1, 4, 3)
        by = 0.5 * frame_width_m(corners)
        for panel in corners:
            moved = drawn_in(panel, -by)
            grown.append(panel if moved is None else moved)
    return np.array(grown, float).reshape(-1, 4, 3)


def frame_width_m(corners_enu_m: Array) -> float:
    """Usual width of the frames between panels, shape (n, 4, 3): from each edge's middle to the nearest other one."""
    from scipy.spatial import cKDTree

    middles = 0.5 * (corners_enu_m + np.roll(corners_enu_m, -1, axis=1)).reshape(-1, 3)
    if len(corners_enu_m) < 2:
        return BARE_M
    distances, others = cKDTree(middles).query(middles, k=min(4, len(middles)))
    foreign = others // 4 != np.arange(len(middles))[:, None] // 4
    near = np.where(foreign, distances, np.inf).min(axis=1)
    near = near[near <= WIDEST_FRAME_M]
    return float(np.percentile(near, 75.0)) if len(near) else BARE_M
