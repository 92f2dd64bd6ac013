"""Views that stand almost at the same place are put at exactly the same place.

Autopilots want waypoints at least half a metre apart (DJI), and every stop costs time; two photos from one waypoint
are fine.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import CoverageModel
from planning.optimise.problem import ViewProblem, take
from planning.plan import ViewpointArrays
from planning.routing.legs import MIN_SPACING_M

MAX_LOST, MAX_LOST_SHARE = 1, 1 / 2000
"""Elements that clearing one place may cost, as a number and as a part of those covered, whichever is more: an aircraft
that refuses the mission costs all of them. On office, library and court two or three places need more than one."""


def merge_close_views(
    problem: ViewProblem,
    views: ViewpointArrays,
    spacing_m: float = MIN_SPACING_M,
    n_fixed: int = 0,
    covered: NDArray[np.int32] | None = None,
) -> ViewpointArrays:
    """Same views, those closer than `spacing_m` to others moved onto them where that loses (almost) no coverage.

    Views at one place move together, so that each move leaves one place less. The first `n_fixed` views stay.
    `covered` counts the views that each element has all the same.
    """
    from scipy.spatial import cKDTree

    model, positions = problem.model, views.positions_enu_m.copy()
    if len(positions) == 0:
        return views
    moved = ViewpointArrays(positions, views.heading_rad, views.pitch_rad)
    counts = np.bincount(model.elements(views).items, minlength=model.n_elements)
    if covered is not None:
        counts += covered
    close = sorted(cKDTree(positions).query_pairs(spacing_m))
    for allowed_loss in (0, MAX_LOST, int(MAX_LOST_SHARE * np.count_nonzero(counts))):
        for pair in close:
            if (positions[pair[0]] == positions[pair[1]]).all():
                continue
            moves = [_Move.of(model, moved, *ends) for ends in (pair, pair[::-1])]
            moves = [move for move in moves if move.movers[0] >= n_fixed]
            best = min(moves, key=lambda move: move.loss(counts), default=None)
            if best is not None and best.loss(counts) <= allowed_loss:
                positions[best.movers] = best.place
                counts += best.change
    return moved


class _Move(NamedTuple):
    """All views of one place put at another: who moves, where to, and the change of the views per element."""

    movers: NDArray[np.int64]
    place: NDArray[np.float64]
    change: NDArray[np.int64]

    @classmethod
    def of(cls, model: CoverageModel, views: ViewpointArrays, mover: int, anchor: int) -> _Move:
        positions = views.positions_enu_m
        movers, place = np.flatnonzero((positions == positions[mover]).all(axis=1)), positions[anchor].copy()
        here = take(views, movers)
        there = here._replace(positions_enu_m=np.broadcast_to(place, (len(movers), 3)))
        before, after = (np.bincount(model.elements(v).items, minlength=model.n_elements) for v in (here, there))
        return cls(movers, place, after - before)

    def loss(self, counts: NDArray[np.int64]) -> int:
        """Elements that no view covers any more."""
        return int(np.count_nonzero((counts > 0) & (counts + self.change == 0)))
