"""Views that stand almost at the same place are put at exactly the same place.

Autopilots want waypoints at least half a metre apart (DJI), and every stop costs time; two photos from one waypoint
are fine.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel
from planning.optimise.problem import ViewProblem, take
from planning.plan import ViewpointArrays

MIN_SPACING_M = 0.5
"""Smallest distance between waypoints that DJI's firmware accepts (Payload SDK, waypoint errors)."""


MAX_LOST = 1
"""Elements that moving one view may cost: an aircraft that refuses the mission costs all of them."""


def merge_close_views(
    problem: ViewProblem, views: ViewpointArrays, spacing_m: float = MIN_SPACING_M
) -> ViewpointArrays:
    """Same views, those closer than `spacing_m` to another moved onto it where that loses (almost) no coverage."""
    from scipy.spatial import cKDTree

    model, n = problem.model, len(views.heading_rad)
    positions = views.positions_enu_m.copy()
    moved = ViewpointArrays(positions, views.heading_rad, views.pitch_rad)
    items = [_items(model, moved, i) for i in range(n)]
    counts = np.bincount(np.concatenate(items), minlength=model.n_elements) if n else np.zeros(0, np.int64)
    close = sorted(cKDTree(positions).query_pairs(spacing_m)) if n else []
    for allowed_loss in range(MAX_LOST + 1):
        for pair in close:
            if (positions[pair[0]] == positions[pair[1]]).all():
                continue
            for mover, anchor in (pair, pair[::-1]):
                before = positions[mover].copy()
                positions[mover] = positions[anchor]
                new_items = _items(model, moved, mover)
                counts[items[mover]] -= 1
                counts[new_items] += 1
                if np.count_nonzero(counts[items[mover]] == 0) <= allowed_loss:
                    items[mover] = new_items
                    break
                counts[new_items] -= 1
                counts[items[mover]] += 1
                positions[mover] = before
    return moved


def _items(model: CoverageModel, views: ViewpointArrays, view: int) -> NDArray[np.int32]:
    return model.elements(take(views, np.array([view]))).items
