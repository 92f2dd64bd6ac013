"""When to fly the sorties of a plan on a day, by the sun: how many photos each start spoils, and the best starts.

A photo is spoiled where its picture shows the sun or its mirror image, or a facade that is in the sun in part. So is
what is flown while the sun blinds the pilot who watches the aircraft from home. A photo is taken a known time after
take-off. Its bad spans, moved back by that time, are bad spans of the start, and the number of spoiled photos is a
stair of the start whose steps are known to the second.

Sorties are flown one after the other, in any order. Starts are chosen together, from a grid of `START_STEP_S`, by mixed
integer programming (HiGHS) where the best starts of each sortie get into each other's way. What the sorties would lose
at their own best times, each alone, bounds what any order can reach.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.sun import (
    NO_SPANS,
    Spans,
    is_within,
    joined_spans,
    spans_within,
    without_spans,
)
from planning.insight.sunlight import BLINDING_RAD, EYE_M, SunDay, SunSite, spans_that_hold
from planning.motion.timing import motion_limits, sortie_flight_path, stopping_times_s
from planning.plan import Plan, Sortie, Viewpoint

Array = NDArray[np.float64]

START_STEP_S = 120.0
"""Between starts that are weighed against each other."""

PAUSE_S = 300.0
"""Between landing and the next take-off, to change batteries."""

WATCH_S = 10.0
"""Between looks of the pilot at the aircraft."""

NEAR_M = 3.0
"""Where an aircraft is nearer to the pilot's eyes, at take-off, nobody looks for it."""

DELAYS_S = (-900.0, -600.0, -300.0, 300.0, 600.0, 900.0)
DELAY_WEIGHT, LIGHT_WEIGHT = 0.1, 1e-3
"""Of equally good starts the one is taken that stays good if it comes earlier or later, and then that of the most
light; both count less than a photo."""

SEARCH_S = 10.0
"""For the order of sorties; after that the best that was found is taken."""


@dataclass(frozen=True, slots=True, eq=False)
class Spoiled:
    """What starts spoil, shape (n,) each.

    Photos with the sun in them, photos in uneven light, photos of either kind, and seconds in which the pilot is
    blinded.
    """

    dazzled: Array
    uneven: Array
    photos: Array
    blinded_s: Array


class _Stair:
    """How many of some moments lie in their bad spans, by the start that they count from: a sum of steps, sorted once.

    Right at a step either side may be said.
    """

    def __init__(self, moments_s: Array, bad: Sequence[Spans]) -> None:
        parts = [spans - at for at, spans in zip(moments_s, bad, strict=True)]
        edges = np.concatenate([NO_SPANS, *parts])
        changes = np.concatenate([np.ones(len(edges), np.int64), -np.ones(len(edges), np.int64)])
        order = np.argsort(edges.T.ravel(), kind="stable")
        self.edges_s: Array = edges.T.ravel()[order]
        self._counts = np.concatenate([[0], np.cumsum(changes[order])])

    def counts(self, starts_s: Array) -> Array:
        """Of starts, shape (n,)."""
        return np.asarray(self._counts[np.searchsorted(self.edges_s, starts_s, side="right")], np.float64)


@dataclass(frozen=True, eq=False)
class SortieSun:
    """How a sortie meets the sun. Spans are of the day, times from its start.

    Parameters
    ----------
    numbers
        Of the plan's sorties that it stands for, from 1: one, or all where several aircraft fly at once.
    duration_s
        From the motors' start to landing.
    viewpoint_ids, taken_s
        Of its photos, and when each is taken, m of them.
    dazzled, uneven
        Bad spans of each photo.
    watched_s, blinded
        When the pilot looks, shape (q,), every `WATCH_S` of each aircraft, and the spans in which that blinds.
    """

    numbers: tuple[int, ...]
    duration_s: float
    viewpoint_ids: tuple[str, ...]
    taken_s: Array
    dazzled: tuple[Spans, ...]
    uneven: tuple[Spans, ...]
    watched_s: Array
    blinded: tuple[Spans, ...]

    @property
    def photo_s(self) -> float:
        """Time that a photo takes in the mean: what blinds so long counts as one."""
        return max(1.0, self.duration_s / max(1, len(self.taken_s)))

    @cached_property
    def _stairs(self) -> tuple[_Stair, _Stair, _Stair, _Stair]:
        either = [joined_spans(list(pair)) for pair in zip(self.dazzled, self.uneven, strict=True)]
        photos = (_Stair(self.taken_s, bad) for bad in (self.dazzled, self.uneven, either))
        return (*photos, _Stair(self.watched_s, self.blinded))  # type: ignore[return-value]

    def spoiled(self, starts_s: Array) -> Spoiled:
        """What starts, shape (n,), spoil."""
        dazzled, uneven, photos, blinded = (stair.counts(starts_s) for stair in self._stairs)
        return Spoiled(dazzled, uneven, photos, WATCH_S * blinded)

    def losses(self, starts_s: Array) -> Array:
        """Spoiled photos and time flown blinded, in photos, shape (n,)."""
        _, _, photos, blinded = self._stairs
        return np.asarray(photos.counts(starts_s) + WATCH_S / self.photo_s * blinded.counts(starts_s))

    def stair(self, allowed: Spans) -> tuple[Spans, Array]:
        """Steps of starts within allowed spans, shape (k, 2), and what is lost on each, shape (k,)."""
        _, _, photos, blinded = self._stairs
        every = np.unique(np.concatenate([photos.edges_s, blinded.edges_s]))
        steps = [NO_SPANS]
        for first, last in allowed:
            inner = every[(every > first) & (every < last)]
            bounds = np.concatenate([[first], inner, [last]])
            steps.append(np.column_stack([bounds[:-1], bounds[1:]]))
        found = np.concatenate(steps)
        return found, self.losses(found.mean(axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class SortieTimes:
    """When to start a sortie.

    Parameters
    ----------
    start_s
        Proposed; None where the day has no room for it.
    window
        Around the start, as long as nothing gets worse; empty without one.
    spoiled
        At the start.
    best
        All starts that lose least, alone in the day.
    least
        What they lose, in photos.
    """

    sortie: SortieSun
    start_s: float | None
    window: Spans
    spoiled: Spoiled | None
    best: Spans
    least: float

    @property
    def loss(self) -> float:
        """Of the start, in photos; nan without one."""
        if self.spoiled is None:
            return math.nan
        return float(self.spoiled.photos[0] + self.spoiled.blinded_s[0] / self.sortie.photo_s)


@dataclass(frozen=True, slots=True, eq=False)
class FlightTimes:
    """The sorties of a plan during a day.

    Parameters
    ----------
    sorties
        In the order in which they are flown; those without room last.
    allowed
        When aircraft may be in the air.
    bound
        Fewest photos that any times could lose.
    """

    sorties: tuple[SortieTimes, ...]
    allowed: Spans
    bound: float

    @property
    def loss(self) -> float:
        """Photos that are lost with the proposed starts."""
        return sum(sortie.loss for sortie in self.sorties if sortie.start_s is not None)

    @property
    def is_best(self) -> bool:
        """Whether no other times lose fewer photos."""
        return all(sortie.start_s is not None for sortie in self.sorties) and self.loss <= self.bound + 1e-6


def sorties_in_sun(site: SunSite, day: SunDay, plan: Plan, monitor: Monitor = QUIET) -> tuple[SortieSun, ...]:
    """How each sortie of a plan meets the sun of a day.

    One for all where several aircraft fly at once; and one of no length for a plan without sorties, all of whose photos
    are taken as it starts.
    """
    if not plan.sorties:
        names = tuple(viewpoint.id for viewpoint in plan.viewpoints)
        all_views = [day.views[name] for name in names]
        dazzled, uneven = tuple(view.dazzled for view in all_views), tuple(view.uneven for view in all_views)
        return (SortieSun((), 0.0, names, np.zeros(len(names)), dazzled, uneven, np.zeros(0), ()),)
    home = np.array(plan.home_enu_m or site.site_model.site.home_enu_m, np.float64)
    eye = home + np.array([0.0, 0.0, EYE_M])

    def sees(_of: NDArray[np.int64], times: Array) -> NDArray[np.bool_]:
        return site.sees_sun(np.broadcast_to(eye, (len(times), 3)), day.track.directions_enu(times))

    seen = joined_spans([spans for _, spans in spans_that_hold(day.track.up, sees)])
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    found = []
    for number, sortie in enumerate(plan.sorties, 1):
        monitor.report(say("sun over the pilot"), number - 1, len(plan.sorties))
        taken_s, path_s, path = _flown(plan, sortie, by_id)
        watched_s = np.arange(0.0, sortie.duration_s, WATCH_S)
        # Before the first and behind the last moment of its path the aircraft is above home.
        places = np.column_stack([np.interp(watched_s, path_s, path[:, axis]) for axis in range(3)])
        sight = places - eye
        distance = np.linalg.norm(sight, axis=1)
        is_far = distance > NEAR_M
        cones = (sight[is_far] / distance[is_far, None])[:, None]
        blinded = spans_within(day.track, cones, 0.5 * math.pi - BLINDING_RAD, seen)
        views = [day.views[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids]
        dazzled, uneven = tuple(view.dazzled for view in views), tuple(view.uneven for view in views)
        photos = (sortie.viewpoint_ids, taken_s, dazzled, uneven)
        found.append(SortieSun((number,), sortie.duration_s, *photos, watched_s[is_far], tuple(blinded)))
    return (_at_once(plan, found),) if plan.landed_s is not None else tuple(found)


def _at_once(plan: Plan, sorties: Sequence[SortieSun]) -> SortieSun:
    """Sorties with starts of their own as one."""
    starts = [sortie.start_s or 0.0 for sortie in plan.sorties]
    pairs = list(zip(starts, sorties, strict=True))
    return SortieSun(
        tuple(range(1, len(sorties) + 1)),
        plan.landed_s or 0.0,
        tuple(name for sortie in sorties for name in sortie.viewpoint_ids),
        np.concatenate([start + sortie.taken_s for start, sortie in pairs]),
        tuple(spans for sortie in sorties for spans in sortie.dazzled),
        tuple(spans for sortie in sorties for spans in sortie.uneven),
        np.concatenate([start + sortie.watched_s for start, sortie in pairs]),
        tuple(spans for sortie in sorties for spans in sortie.blinded),
    )


def _flown(plan: Plan, sortie: Sortie, by_id: Mapping[str, Viewpoint]) -> tuple[Array, Array, Array]:
    """When each photo is taken, shape (m,), and when the aircraft is where, shape (k,) and (k, 3).

    Half of what take-off and landing take comes before the path. Photos of a sortie that cannot be timed are spread
    evenly over what it says it takes.
    """
    m = len(sortie.viewpoint_ids)
    before_s = 0.5 * plan.rules.takeoff_landing_s
    try:
        flown = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules)
        limits = motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError:
        flown = None
    if flown is None:
        places = np.array([by_id[name].position_enu_m for name in sortie.viewpoint_ids], np.float64).reshape(-1, 3)
        taken_s = (np.arange(m) + 0.5) / max(1, m) * sortie.duration_s
        return (taken_s, taken_s, places) if m else (taken_s, np.zeros(1), np.zeros((1, 3)))
    path, at_photos = flown
    arrival_s = before_s + stopping_times_s(path, limits)
    left_s = arrival_s + path.hover_s
    times = np.column_stack([arrival_s, left_s]).ravel()
    return left_s[at_photos], times, np.repeat(path.vertices_enu_m, 2, axis=0)


@dataclass(frozen=True, slots=True, eq=False)
class FlownFrom:
    """What sorties meet that are flown one after the other from a time on.

    Parameters
    ----------
    direct, mirrored, uneven
        Viewpoints whose photos show the sun, its mirror image, or a facade that is in the sun in part.
    blinded_s
        While the pilot is blinded.
    landed_in_light
        Whether the sun is up for all of it.
    """

    direct: tuple[str, ...]
    mirrored: tuple[str, ...]
    uneven: tuple[str, ...]
    blinded_s: float
    landed_in_light: bool


def flown_from(sorties: Sequence[SortieSun], day: SunDay, start_s: float, pause_s: float = PAUSE_S) -> FlownFrom:
    """What sorties meet, in their order, with the first take-off at a second of the day."""
    ids: tuple[list[str], list[str], list[str]] = ([], [], [])
    blinded_s, landed_in_light = 0.0, True
    for sortie in sorties:
        for name, at in zip(sortie.viewpoint_ids, start_s + sortie.taken_s, strict=True):
            view = day.views[name]
            for found, spans in zip(ids, (view.direct, view.mirrored, view.uneven), strict=True):
                if is_within(spans, at):
                    found.append(name)
        blinded_s += float(sortie.spoiled(np.array([start_s])).blinded_s[0])
        flown = (start_s, start_s + sortie.duration_s)
        landed_in_light &= any(first <= flown[0] and flown[1] <= last for first, last in day.track.up)
        start_s = flown[1] + pause_s
    direct, mirrored, uneven = map(tuple, ids)
    return FlownFrom(direct, mirrored, uneven, blinded_s, landed_in_light)


def flight_times(
    sorties: Sequence[SortieSun],
    day: SunDay,
    within: Spans | None = None,
    pause_s: float = PAUSE_S,
    monitor: Monitor = QUIET,
) -> FlightTimes:
    """Starts of sorties that lose the fewest photos.

    Parameters
    ----------
    within
        When flying is wanted; the whole day where None. The sun has to be up, too.
    """
    whole = np.array([[0.0, day.track.length_s]]) if within is None else within
    allowed = without_spans(day.track.up, without_spans(np.array([[0.0, day.track.length_s]]), whole))
    chances = [_Chances(sortie, allowed, day) for sortie in sorties]
    monitor.report(say("order of sorties"), 0, 1)
    starts = _in_turn(chances, pause_s)
    wanted = sum(chance.least for chance in chances)
    if any(start is None for start in starts) or _lost(chances, starts) > wanted + 1e-6:
        starts = _together(chances, pause_s, starts)
    monitor.report(say("order of sorties"), 1, 1)
    found = [chance.times(start) for chance, start in zip(chances, starts, strict=True)]
    found.sort(key=lambda times: math.inf if times.start_s is None else times.start_s)
    return FlightTimes(tuple(found), allowed, wanted)


class _Chances:
    """Starts of a sortie on the grid, and what each loses."""

    def __init__(self, sortie: SortieSun, allowed: Spans, day: SunDay) -> None:
        self.sortie = sortie
        self._starts = allowed - np.array([0.0, sortie.duration_s])
        self._starts = self._starts[self._starts[:, 1] >= self._starts[:, 0]]
        steps, self._lost = sortie.stair(self._starts)
        self._steps = steps
        self.least = float(self._lost.min()) if len(self._lost) else 0.0
        parts = [np.arange(math.ceil(a / START_STEP_S), math.floor(b / START_STEP_S) + 1) for a, b in self._starts]
        self.slots = np.concatenate([np.zeros(0, np.int64), *parts]).astype(np.int64)
        at: Array = np.asarray(self.slots * START_STEP_S, np.float64)
        self.losses = sortie.losses(at)
        later = np.mean([np.maximum(sortie.losses(at + delay) - self.losses, 0.0) for delay in DELAYS_S], axis=0)
        light = day.track.directions_enu(at + 0.5 * sortie.duration_s)[:, 2] if len(at) else np.zeros(0)
        self.costs: Array = self.losses + DELAY_WEIGHT * later - LIGHT_WEIGHT * light

    def times(self, slot: int | None) -> SortieTimes:
        """The sortie with a start; None where there is none."""
        best = joined_spans([self._steps[self._lost <= self.least + 1e-6]])
        if slot is None:
            return SortieTimes(self.sortie, None, NO_SPANS, None, best, self.least)
        start_s = slot * START_STEP_S
        spoiled = self.sortie.spoiled(np.array([start_s]))
        loss = float(self.sortie.losses(np.array([start_s]))[0])
        good = joined_spans([self._steps[self._lost <= loss + 1e-6]])
        window = good[(good[:, 0] <= start_s) & (start_s <= good[:, 1])][:1]
        return SortieTimes(self.sortie, start_s, window, spoiled, best, self.least)


def _n_slots(sortie: SortieSun, pause_s: float) -> int:
    return math.ceil((sortie.duration_s + pause_s) / START_STEP_S)


def _lost(chances: Sequence[_Chances], starts: Sequence[int | None]) -> float:
    return sum(
        float(chance.losses[np.searchsorted(chance.slots, start)])
        for chance, start in zip(chances, starts, strict=True)
        if start is not None
    )


def _in_turn(chances: Sequence[_Chances], pause_s: float) -> list[int | None]:
    """Each sortie at the best start that others leave, those with the fewest good starts first."""
    starts: list[int | None] = [None] * len(chances)
    taken: list[tuple[int, int]] = []

    def choice(n: int) -> int:
        return int(np.count_nonzero(chances[n].losses <= chances[n].least + 1e-6))

    for n in sorted(range(len(chances)), key=choice):
        size = _n_slots(chances[n].sortie, pause_s)
        is_open = np.ones(len(chances[n].slots), np.bool_)
        for first, last in taken:
            is_open &= (chances[n].slots >= last) | (chances[n].slots + size <= first)
        if is_open.any():
            slot = int(chances[n].slots[np.where(is_open, chances[n].costs, np.inf).argmin()])
            starts[n] = slot
            taken.append((slot, slot + size))
    return starts


def _together(chances: Sequence[_Chances], pause_s: float, first: list[int | None]) -> list[int | None]:
    """Starts of all sorties that lose least together; those of `first` where none better are found in `SEARCH_S`.

    One variable says whether a sortie starts in a slot. At most one sortie is under way in each slot, and each starts
    at most once (time-indexed scheduling, J. Sousa and L. Wolsey, 1992). A sortie that is not flown costs more than
    any start.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import coo_array

    sizes = [len(chance.slots) for chance in chances]
    if not sum(sizes):
        return first
    left_out = 1.0 + max((float(chance.costs.max()) for chance in chances if len(chance.costs)), default=0.0)
    left_out *= 1.0 + len(chances)
    costs = np.concatenate([chance.costs - left_out for chance in chances])
    slots = np.concatenate([chance.slots for chance in chances])
    of = np.repeat(np.arange(len(chances)), sizes)
    length = np.array([_n_slots(chance.sortie, pause_s) for chance in chances])[of]
    earliest = int(slots.min())
    column = np.repeat(np.arange(len(slots)), length)
    under_way = np.repeat(slots - earliest, length)
    under_way += np.arange(len(column)) - np.repeat(np.cumsum(length) - length, length)
    rows = np.concatenate([of, len(chances) + under_way])
    columns = np.concatenate([np.arange(len(slots)), column])
    matrix = coo_array((np.ones(len(rows)), (rows, columns)), shape=(int(rows.max()) + 1, len(slots))).tocsr()
    found = milp(
        costs,
        integrality=np.ones(len(slots), np.int64),
        bounds=Bounds(0.0, 1.0),
        constraints=LinearConstraint(matrix, -np.inf, 1.0),
        options={"time_limit": SEARCH_S, "mip_rel_gap": 1e-6},
    )
    if found.x is None:
        return first
    starts: list[int | None] = [None] * len(chances)
    for index in np.flatnonzero(found.x > 0.5):
        starts[of[index]] = int(slots[index])
    missed, missed_first = starts.count(None), first.count(None)
    is_better = (missed, _lost(chances, starts)) <= (missed_first, _lost(chances, first))
    return starts if is_better else first
