"""Views from which wanted sections are seen: the views that were to show them, places around those, and others.

Each place is aimed at what is wanted; views that are known to show some of it are kept as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import Elements, codes_all_around
from planning.coverage.positions import aimed_views, spread_positions
from planning.coverage.reach_kernel import REACHABLE
from planning.parameters import FlightRules
from planning.plan import Aircraft, ViewpointArrays
from planning.routing.flights import FlightTimes, flight_times
from planning.viewpoints.budget import shortlist
from planning.viewpoints.candidates import Pool, join_pools, keep
from planning.viewpoints.locked import NONE_LOCKED
from planning.viewpoints.plan_records import as_written
from planning.viewpoints.problem import ViewProblem, concatenate

Array = NDArray[np.float64]

MAX_CANDIDATES = 400
"""Candidates whose routes are compared, beside those that were known before: their leg table takes 0.3 s."""

DEPTHS = range(1, 13)
"""They are the greedy choices for showing each wanted section once, then twice and so on: variety to route by. With
three depths top-ups of the library took 4 % longer after 5 s."""

N_SPREAD = 4000
MAX_NEIGHBOURS = 4000
"""Spread positions, and positions around known views and witnesses, per round."""

MAX_WITNESSES = 500
"""Witnesses of sections that known views show, about; those of the others are all tried."""

NEIGHBOUR_SCALES_M = (0.5, 12.0)
"""Positions around a known one are moved by 0.5 m, where waypoints may be that close, to 12 m."""

POINTS_PER_CHUNK = 4_000_000
"""Pairs of position and panel looked at at a time: bounds the memory to 16 MB."""


@dataclass(frozen=True, slots=True, eq=False)
class Wanted:
    """Sections that are to be seen, and how they may be flown to.

    Parameters
    ----------
    elements
        Panel * n_sections + section of each, shape (w,), rising.
    longest_s
        Time that a single flight may take between take-off and landing; views further away than that are left out.
    """

    problem: ViewProblem
    aircraft: Aircraft
    rules: FlightRules
    elements: NDArray[np.int64]
    longest_s: float

    def mask(self) -> NDArray[np.bool_]:
        """Whether each element is wanted, shape (n_elements,)."""
        wanted = np.zeros(self.problem.model.n_elements, np.bool_)
        wanted[self.elements] = True
        return wanted

    def pool(self, views: ViewpointArrays) -> Pool:
        """The views with the wanted sections that each shows, numbered as in `elements`."""
        number = np.full(self.problem.model.n_elements, -1, np.int32)
        number[self.elements] = np.arange(len(self.elements), dtype=np.int32)
        found = self.problem.model.elements(views)
        items = number[found.items]
        before = np.concatenate([[0], np.cumsum(items >= 0)])
        return Pool(views, Elements(before[found.starts].astype(np.int64), items[items >= 0]))


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Candidates within reach of a single flight, and the times between them.

    Parameters
    ----------
    is_known
        Which of them were known before, shape (n,); they come first.
    in_sight
        Numbers of the wanted sections that these or candidates out of reach show, rising.
    """

    pool: Pool
    is_known: NDArray[np.bool_]
    times: FlightTimes
    in_sight: NDArray[np.int32]

    @property
    def shown(self) -> NDArray[np.int32]:
        """Numbers of the wanted sections that any of them shows, rising."""
        return np.unique(self.pool.elements.items)


def candidates(
    wanted: Wanted, known: ViewpointArrays, rng: np.random.Generator, monitor: Monitor = QUIET
) -> Candidates:
    """Views to choose from; those of the `known` ones that show anything wanted come first."""
    problem = wanted.problem
    monitor.report(say("trying viewpoints"), 0, 1)
    first = _useful(wanted.pool(as_written(problem, known)))
    found = as_written(problem, _aimed(wanted, _places(wanted, first, rng), rng))
    further = shortlist(_useful(wanted.pool(found)), np.ones(len(wanted.elements)), None, MAX_CANDIDATES, DEPTHS)
    pool = join_pools(first, _well_apart(wanted, first, further))
    in_sight = np.unique(pool.elements.items)
    is_known = np.arange(len(pool.views.heading_rad)) < len(first.views.heading_rad)
    times = flight_times(problem.roadmap, pool.views, wanted.aircraft, wanted.rules, monitor)
    alone_s = times.travel_s[0, 1:] + times.service_s + times.travel_s[1:, 0]
    within = alone_s <= wanted.longest_s
    if not within.all():
        pool, is_known = keep(pool, within), is_known[within]
        times = flight_times(problem.roadmap, pool.views, wanted.aircraft, wanted.rules, monitor)
    return Candidates(pool, is_known, times, in_sight)


def _useful(pool: Pool) -> Pool:
    return keep(pool, np.diff(pool.elements.starts) > 0)


def _well_apart(wanted: Wanted, first: Pool, further: Pool) -> Pool:
    """The further views, those nearer to earlier ones than waypoints may be moved onto them.

    Those without which a section is lost are kept where they were as well.
    """
    positions = np.concatenate([first.views.positions_enu_m, further.views.positions_enu_m])
    n_first = len(first.views.heading_rad)
    for i in range(n_first, len(positions)):
        away_m = np.linalg.norm(positions[:i] - positions[i], axis=1)
        if away_m.min(initial=np.inf) < wanted.aircraft.min_waypoint_spacing_m:
            positions[i] = positions[np.argmin(away_m)]
    moved = wanted.pool(further.views._replace(positions_enu_m=positions[n_first:]))
    is_lost = np.zeros(len(wanted.elements), np.bool_)
    is_lost[further.elements.items] = True
    is_lost[np.concatenate([first.elements.items, moved.elements.items])] = False
    needed_there = [bool(is_lost[further.elements.of(view)].any()) for view in range(len(further.views.heading_rad))]
    return join_pools(_useful(moved), keep(further, np.array(needed_there, np.bool_)))


def _places(wanted: Wanted, known: Pool, rng: np.random.Generator) -> Array:
    """Allowed positions to look from, shape (n, 3)."""
    problem = wanted.problem
    reachability = problem.reachability
    is_open = np.ones(len(wanted.elements), np.bool_)
    is_open[known.elements.items] = False
    # Witnesses of what the known views show are for variety only.
    is_asked = is_open | (rng.random(len(is_open)) < MAX_WITNESSES / max(1, len(is_open)))
    is_asked &= reachability.verdicts.reshape(-1)[wanted.elements] == REACHABLE
    witnesses = reachability.witnesses_enu_m.reshape(-1, 3)[wanted.elements[is_asked]]
    centres = np.concatenate([known.views.positions_enu_m, witnesses])
    around = np.zeros((0, 3))
    if len(centres):
        copies = max(1, MAX_NEIGHBOURS // len(centres))
        low, high = np.log(NEIGHBOUR_SCALES_M)
        scale = np.exp(rng.uniform(low, high, (len(centres) * copies, 1)))
        around = np.repeat(centres, copies, axis=0) + rng.normal(size=(len(scale), 3)) * scale / np.sqrt(3.0)
    spread = spread_positions(problem.space, problem.model.frames, N_SPREAD, rng)
    places = np.concatenate([centres, around, spread])
    return places[problem.space.is_allowed(places)]


def _aimed(wanted: Wanted, places_enu_m: Array, rng: np.random.Generator) -> ViewpointArrays:
    """Two views from each place that any wanted section can be seen from.

    One looks at the middle of the panels whose wanted sections the place lies in, one at one of them, drawn at random.
    """
    model, mask = wanted.problem.model, wanted.mask()
    views = []
    for start, end in chunks(len(places_enu_m), max(1, POINTS_PER_CHUNK // max(1, len(model.frames)))):
        places = places_enu_m[start:end]
        codes = codes_all_around(model, places)
        panel, place = np.nonzero(codes)
        is_wanted = mask[panel * model.grid.n_sections + codes[panel, place] - 1]
        order = rng.permutation(np.flatnonzero(is_wanted))
        panel, place = panel[order], place[order]
        targets = model.frames.centroids[panel]
        used, first, number = np.unique(place, return_index=True, return_inverse=True)
        middle = np.zeros((len(used), 3))
        np.add.at(middle, number, targets)
        middle /= np.bincount(number, minlength=len(used))[:, None]
        views += [
            aimed_views(places[used], middle, model.camera),
            aimed_views(places[used], targets[first], model.camera),
        ]
    return concatenate([NONE_LOCKED, *views])
