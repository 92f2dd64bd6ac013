"""How far apart views stand: at one place, or as far as the autopilot wants waypoints (half a metre for DJI).

Two photos from one waypoint are fine. The greedy method keeps the rule (`SpacingRule`) while it chooses, and looks for
other places for what it keeps it from (`spaced_views`). Methods that know nothing of it, and flights through candidates
that were compared without it, are put right afterwards (`merge_close_views`), which may cost coverage.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.base.progress import Stop, never
from planning.coverage.model import CoverageModel, codes_all_around
from planning.coverage.positions import aimed_views, rounded
from planning.plan import POSITION_DECIMALS, ViewpointArrays
from planning.viewpoints.candidates import places_around
from planning.viewpoints.problem import ViewProblem, take

PLACES_PER_BLOCK = 500
"""Places of which ways from home are looked for between two looks at the clock."""

MAX_LOST, MAX_LOST_SHARE = 1, 1 / 2000
"""Elements that clearing one place may cost, as a number and as a part of those covered, whichever is more: an aircraft
that refuses the mission costs all of them. On office, library and court two or three places need more than one."""


def merge_close_views(
    problem: ViewProblem,
    views: ViewpointArrays,
    spacing_m: float,
    covered: NDArray[np.int32] | None = None,
) -> ViewpointArrays:
    """Same views, those closer than `spacing_m` to others moved onto them where that loses (almost) no coverage.

    For methods that choose without looking at spacing.

    Views at one place move together, so that each move leaves one place less.
    `covered` counts the views that each element has all the same.
    """
    from scipy.spatial import cKDTree

    model, positions = problem.model, views.positions_enu_m.copy()
    if len(positions) == 0 or spacing_m <= 0.0:
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
            best = min(moves, key=lambda move: move.loss(counts))
            if best.loss(counts) <= allowed_loss:
                positions[best.movers] = best.place
                counts += best.change
    return moved


class SpacingRule(NamedTuple):
    """How far apart views must stand that are chosen from some.

    Parameters
    ----------
    positions_enu_m
        Of those that are chosen from, shape (n, 3).
    present_enu_m
        Places of views that are there in any case, shape (k, 3).
    spacing_m
        Two stand at one place or at least this far apart; 0: it does not matter.
    """

    positions_enu_m: NDArray[np.float64]
    present_enu_m: NDArray[np.float64]
    spacing_m: float

    def is_too_close(self, point_enu_m: NDArray[np.float64]) -> bool:
        """Whether a place, shape (3,), is too close to any of those taken."""
        away_m = np.linalg.norm(self.present_enu_m - point_enu_m, axis=1)
        return bool(((away_m > 0.0) & (away_m < self.spacing_m)).any())

    def are_too_close(self, points_enu_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether places, shape (m, 3), are too close to any of those taken."""
        from scipy.spatial import cKDTree

        if self.spacing_m <= 0.0 or len(self.present_enu_m) == 0:
            return np.zeros(len(points_enu_m), np.bool_)
        # The nearest but one counts where the nearest is at the very place.
        places = cKDTree(np.unique(self.present_enu_m, axis=0))
        away_m = np.asarray(places.query(points_enu_m, k=[1, 2], distance_upper_bound=self.spacing_m)[0])
        return np.asarray(((away_m > 0.0) & (away_m < self.spacing_m)).any(axis=1))

    def of_others(self, positions_enu_m: NDArray[np.float64], but: int) -> SpacingRule:
        """With the places of all views but one as taken."""
        if self.spacing_m <= 0.0:
            return self
        others = np.delete(positions_enu_m, but, axis=0)
        return self._replace(present_enu_m=np.concatenate([self.present_enu_m, others]))


_NOWHERE = np.zeros((0, 3))
ANYWHERE = SpacingRule(_NOWHERE, _NOWHERE, 0.0)


def spacing_rule(views: ViewpointArrays, present: ViewpointArrays, spacing_m: float) -> SpacingRule:
    """The rule for views that are chosen beside others that are there in any case."""
    return SpacingRule(views.positions_enu_m, present.positions_enu_m, spacing_m)


def rounding_spacing_m(spacing_m: float) -> float:
    """What views must keep before their coordinates are rounded, so that they keep `spacing_m` after it."""
    return spacing_m + 2.0 * 10.0**-POSITION_DECIMALS if spacing_m > 0.0 else 0.0


def spaced_views(
    problem: ViewProblem,
    elements: NDArray[np.int64],
    seen_from_enu_m: NDArray[np.float64],
    chosen_enu_m: NDArray[np.float64],
    rng: np.random.Generator,
    stop: Stop = never,
) -> ViewpointArrays:
    """Further flyable views for elements whose views are too close to others, each aimed at its panel, as written.

    They stand at places of chosen views from which the element is seen, and around the place from which it is to be
    seen.

    Parameters
    ----------
    elements
        Shape (k,).
    seen_from_enu_m
        A place from which each is seen, shape (k, 3).
    chosen_enu_m
        Where views are chosen, shape (n, 3).
    stop
        When it asks for an end, places not yet looked at are left out.
    """
    model = problem.model
    panel, section = np.divmod(elements, model.grid.n_sections)
    places = np.unique(chosen_enu_m, axis=0)
    codes = codes_all_around(model, places)[panel]
    element, place = np.nonzero(codes == section[:, None] + 1)
    around, number = places_around(problem, elements, seen_from_enu_m, rng, stop=stop)
    kept = np.zeros(len(around), np.bool_)
    for start, end in chunks(len(around), PLACES_PER_BLOCK):
        if stop():
            break
        kept[start:end] = problem.flyable(around[start:end])
    positions = np.concatenate([places[place], around[kept]])
    targets = model.frames.centroids[panel[np.concatenate([element, number[kept]])]]
    views = rounded(aimed_views(positions, targets, model.camera), model.camera)
    _, first = np.unique(np.column_stack(views), axis=0, return_index=True)
    return take(views, np.sort(first))


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
