"""What pre-flight rules look at, what they measure, and how they put it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.messages import glue, say
from planning.coverage.evaluate import Sight, section_counts, sights
from planning.coverage.model import CoverageModel
from planning.geo.frames import Vec3, camera_axes
from planning.geo.solids import Solids
from planning.motion.speed_profile import corner_saving_s
from planning.motion.timing import (
    FlightPath,
    MotionLimits,
    motion_limits,
    sortie_flight_path,
    stopping_duration_s,
    stopping_times_s,
)
from planning.plan import Plan, Sortie, Viewpoint, viewpoint_arrays
from planning.routing.rally import ReturnRoute, return_routes
from planning.site.free_space import FreeSpace, unchecked_space
from planning.site.records import SiteModel
from planning.viewpoints.prepare import coverage_model, decide_occlusion

Array = NDArray[np.float64]


# What the rules measure on a plan, kept by what it was measured on: an edited plan measures only what is new.
#
# Keys are values (a pose, the two ends of a leg, a path with its photos), so what is taken over from another plan is
# what measuring it again would give.

Key = TypeVar("Key")
Value = TypeVar("Value")

Pose = tuple[Vec3, float, float]
"""Position, heading and gimbal pitch of a viewpoint."""

Leg = tuple[Vec3, Vec3]

FlightKey = tuple[tuple[Vec3, ...], tuple[Pose, ...], tuple[int, ...]]
"""A path, the photos taken along it, and the places in their order of those that are taken in passing."""


@dataclass(frozen=True, slots=True, eq=False)
class Gaps:
    """Distances to some solids: of points (negative inside), and along whole legs (0 where they meet one)."""

    points_m: Mapping[Vec3, float]
    legs_m: Mapping[Leg, float]


@dataclass(frozen=True, slots=True, eq=False)
class TimedFlight:
    """How long a sortie takes whose path passes all its viewpoints.

    Parameters
    ----------
    length_m
        Of the path.
    stopping_s
        Duration when it stops at every vertex, take-off and landing included.
    corners, corner_saving_s
        The stretches that have corners without a photo (`corner_stretches`) as a key, and what flying through these
        corners would save.
    photos_done_s
        When each photo is done, stopping at every vertex, shape (m,).
    """

    length_m: float
    stopping_s: float
    corners: bytes
    corner_saving_s: float
    photos_done_s: Array


@dataclass(frozen=True, slots=True, eq=False)
class Measures:
    """Everything measured on one plan.

    Parameters
    ----------
    seen
        What each viewpoint covers.
    nearest_m
        Distance of each viewpoint to the nearest panel in its picture, also where that is too far away to count.
    glass_m
        Nearest and farthest glass in each photo, see `_glass_m`.
    counts
        Views of each section, shape (m, n_sections).
    solid_gaps, no_fly_gaps
        To panels, building and obstacles; to no-fly volumes.
    return_routes
        Of an aircraft that returns from anywhere on a leg, at `planning.routing.rally.return_height`.
    flights
        By path and photos; None where the path is none or misses a viewpoint. Empty in wind that allows no flight.
    """

    seen: Mapping[Pose, Sight]
    nearest_m: Mapping[Pose, float]
    glass_m: Mapping[Pose, tuple[float, float]]
    counts: NDArray[np.int64]
    solid_gaps: Gaps
    no_fly_gaps: Gaps
    return_routes: Mapping[Leg, ReturnRoute]
    flights: Mapping[FlightKey, TimedFlight | None]


NEAREST_GLASS_M = 0.1
"""Glass counts as no nearer: a photo of it would be an accident."""

_NOT_KNOWN = object()
_NO_GAPS = Gaps({}, {})
NOTHING_KNOWN = Measures({}, {}, {}, np.zeros((0, 0), np.int64), _NO_GAPS, _NO_GAPS, {}, {})


def pose_of(viewpoint: Viewpoint) -> Pose:
    """What decides what a viewpoint covers."""
    return viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg


def legs_of(sortie: Sortie) -> list[Leg]:
    """Legs of a sortie's path, in order."""
    return list(itertools.pairwise(sortie.path_enu_m))


def flight_key(sortie: Sortie, by_id: Mapping[str, Viewpoint]) -> FlightKey:
    """What decides how long a sortie takes."""
    poses = tuple(pose_of(by_id[viewpoint_id]) for viewpoint_id in sortie.viewpoint_ids)
    passing = frozenset(sortie.in_passing_ids)
    return sortie.path_enu_m, poses, tuple(k for k, name in enumerate(sortie.viewpoint_ids) if name in passing)


def measure(plan: Plan, space: FreeSpace, model: CoverageModel, known: Measures = NOTHING_KNOWN) -> Measures:
    """Measure a plan, taking over from `known` what it has.

    `known` must come from a plan for the same site, camera, constraints, aircraft and flight rules.
    """
    by_pose = {pose_of(viewpoint): viewpoint for viewpoint in plan.viewpoints}
    seen = _completed(by_pose, known.seen, lambda poses: sights(model, [by_pose[pose] for pose in poses]))
    nearest_m = {pose: sight.nearest_m for pose, sight in seen.items()}
    if model.max_distance_m is not None:
        anywhere = replace(model, max_distance_m=None)
        nearest_m = _completed(by_pose, known.nearest_m, lambda poses: _nearest_m(anywhere, by_pose, poses))
    return Measures(
        seen=seen,
        nearest_m=nearest_m,
        glass_m=_completed(by_pose, known.glass_m, lambda poses: _glass_m(model, by_pose, seen, poses)),
        counts=section_counts(model, [seen[pose_of(viewpoint)] for viewpoint in plan.viewpoints]),
        solid_gaps=_gaps(space.solids, plan, known.solid_gaps),
        no_fly_gaps=_gaps(space.no_fly, plan, known.no_fly_gaps) if len(space.no_fly.part) else _NO_GAPS,
        return_routes=_completed(
            itertools.chain.from_iterable(legs_of(sortie) for sortie in plan.sorties),
            known.return_routes,
            lambda legs: return_routes(space, [np.array(leg) for leg in legs]),
        ),
        flights=_flights(plan, known.flights),
    )


def _completed(
    keys: Iterable[Key], known: Mapping[Key, Value], measured: Callable[[list[Key]], Sequence[Value]]
) -> dict[Key, Value]:
    """Values of all keys: those that are known, the others `measured` together."""
    # A key is a path or a pair of places: hashing it is what takes time.
    values: dict[Key, Any] = {key: known.get(key, _NOT_KNOWN) for key in keys}
    missing = [key for key, value in values.items() if value is _NOT_KNOWN]
    if missing:
        values.update(zip(missing, measured(missing), strict=True))
    return values


def _nearest_m(model: CoverageModel, by_pose: Mapping[Pose, Viewpoint], poses: list[Pose]) -> list[float]:
    return [sight.nearest_m for sight in sights(model, [by_pose[pose] for pose in poses])]


def _glass_m(
    model: CoverageModel, by_pose: Mapping[Pose, Viewpoint], seen: Mapping[Pose, Sight], poses: list[Pose]
) -> list[tuple[float, float]]:
    """Nearest and farthest glass in photos along their axes; inf and -inf where a photo covers no panel.

    Of the panels that a photo covers: their middles, and those of their corners that it shows.
    """
    covered = [seen[pose].elements // model.grid.n_sections for pose in poses]
    panels, photos = np.concatenate(covered), np.repeat(np.arange(len(poses)), [len(each) for each in covered])
    views = viewpoint_arrays(tuple(by_pose[pose] for pose in poses))
    axes = [axis[photos] for axis in camera_axes(views.heading_rad, views.pitch_rad)]
    nearest, farthest = np.full(len(poses), np.inf), np.full(len(poses), -np.inf)
    for number, places in enumerate((model.frames.centroids, *model.frames.corners.transpose(1, 0, 2))):
        rays = places[panels] - views.positions_enu_m[photos]
        depths, aside, above = (np.einsum("ij,ij->i", rays, axis) for axis in axes)
        shown = (np.abs(aside) <= model.camera.half_width * depths) & (
            np.abs(above) <= model.camera.half_height * depths
        )
        chosen = slice(None) if number == 0 else shown
        inside = np.maximum(depths[chosen], NEAREST_GLASS_M)
        np.minimum.at(nearest, photos[chosen], inside)
        np.maximum.at(farthest, photos[chosen], inside)
    return list(zip(nearest.tolist(), farthest.tolist(), strict=True))


def _gaps(solids: Solids, plan: Plan, known: Gaps) -> Gaps:
    def legs_m(legs: list[Leg]) -> list[float]:
        ends = np.array(legs, np.float64)
        return solids.segment_distances_m(ends[:, 0], ends[:, 1]).tolist()  # type: ignore[no-any-return]

    def points_m(points: list[Vec3]) -> list[float]:
        return solids.clearance_m(np.array(points, np.float64)).tolist()  # type: ignore[no-any-return]

    legs = itertools.chain.from_iterable(legs_of(sortie) for sortie in plan.sorties)
    positions = (viewpoint.position_enu_m for viewpoint in plan.viewpoints)
    vertices = itertools.chain.from_iterable(sortie.path_enu_m for sortie in plan.sorties)
    return Gaps(
        _completed(itertools.chain(positions, vertices), known.points_m, points_m),
        _completed(legs, known.legs_m, legs_m),
    )


def _flights(plan: Plan, known: Mapping[FlightKey, TimedFlight | None]) -> dict[FlightKey, TimedFlight | None]:
    try:
        limits = motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError:  # no flying in this wind: the rule about durations says so
        return {}
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    by_key = {flight_key(sortie, by_id): sortie for sortie in plan.sorties}
    savings_s = {flight.corners: flight.corner_saving_s for flight in known.values() if flight is not None}
    return _completed(
        by_key, known, lambda keys: [_flight(by_key[key], by_id, plan, limits, savings_s) for key in keys]
    )


def _flight(
    sortie: Sortie,
    by_id: Mapping[str, Viewpoint],
    plan: Plan,
    limits: MotionLimits,
    savings_s: Mapping[bytes, float],
) -> TimedFlight | None:
    """A sortie timed; what flying through its corners saves is taken from `savings_s` where it is there."""
    timed = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules, stop_at_corners=False)
    if timed is None:
        return None
    through, at_photos = timed
    stretches = corner_stretches(through)
    corners = b"".join(part.tobytes() for part in (stretches.vertices_enu_m, stretches.is_stop, stretches.turn_s))
    return TimedFlight(
        length_m=float(np.linalg.norm(through.deltas_enu_m, axis=1).sum()),
        stopping_s=stopping_duration_s(through, plan.aircraft, plan.rules),
        corners=corners,
        corner_saving_s=savings_s[corners] if corners in savings_s else corner_saving_s(stretches, limits)[0],
        photos_done_s=(stopping_times_s(through, limits) + through.hover_s)[at_photos],
    )


def corner_stretches(path: FlightPath) -> FlightPath:
    """The stretches from stop to stop that have corners between them, moved end to end and without the hovers.

    Nothing else differs between stopping at each corner and flying through: a flight of hundreds of photos has a few
    such stretches, and they stay as they are when a viewpoint elsewhere is edited.
    """
    path = path.without_passed()
    stops = np.flatnonzero(path.is_stop)
    n_legs = np.diff(stops)
    kept = np.repeat(n_legs > 1, n_legs)
    deltas = path.deltas_enu_m[kept]
    vertices = np.concatenate([np.zeros((1, 3)), np.cumsum(deltas, axis=0)])
    is_stop = np.append(path.is_stop[:-1][kept], True)
    return FlightPath(vertices, is_stop, np.zeros(len(vertices)), path.turn_s[kept])


ROUNDING_M = 1e-4
"""Coordinates in plan files are rounded to 0.1 mm; no rule breaks over that."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A plan on its site, measured."""

    plan: Plan
    site_model: SiteModel
    space: FreeSpace
    model: CoverageModel
    measures: Measures

    @classmethod
    def of(cls, plan: Plan, site_model: SiteModel) -> Case:
        """The case of a plan; occlusion is decided here where the plan leaves it to the scene."""
        space = unchecked_space(site_model, plan.constraints.min_distance_m)
        constraints = plan.constraints
        if constraints.occlusion == "auto":
            on = decide_occlusion(site_model, space, "auto").on
            constraints = replace(constraints, occlusion="on" if on else "off")
        model = coverage_model(site_model, space, plan.camera, constraints)
        return cls(plan, site_model, space, model, measure(plan, space, model))

    def with_plan(self, plan: Plan) -> Case:
        """The case of another plan for the same site; what both have in common is not measured again."""
        mine = self.plan
        if (plan.camera, plan.constraints, plan.aircraft, plan.rules) != (
            mine.camera,
            mine.constraints,
            mine.aircraft,
            mine.rules,
        ):
            return Case.of(plan, self.site_model)
        return replace(self, plan=plan, measures=measure(plan, self.space, self.model, self.measures))

    def sorties(self) -> Iterator[tuple[str, Sortie, Array]]:
        """Name, record and path, shape (k, 3), of each sortie whose path has any leg."""
        for number, sortie in enumerate(self.plan.sorties, 1):
            if len(sortie.path_enu_m) > 1:
                yield say("sortie {}", number), sortie, np.array(sortie.path_enu_m, np.float64)

    def timed_sorties(self) -> Iterator[tuple[str, Sortie, TimedFlight]]:
        """Name, record and times of each sortie whose path passes all its viewpoints; none where nothing can fly."""
        by_id = {viewpoint.id: viewpoint for viewpoint in self.plan.viewpoints}
        for number, sortie in enumerate(self.plan.sorties, 1):
            flight = self.measures.flights.get(flight_key(sortie, by_id))
            if flight is not None:
                yield say("sortie {}", number), sortie, flight


Rule = Callable[[Case], Iterator[Finding]]


def judge(
    kept: bool,
    code: str,
    subject: str,
    value: float,
    limit: float,
    unit: str,
    place: str = "",
    advice: str = "",
    severity: Severity = Severity.ERROR,
    *,
    least: bool = False,
) -> Finding:
    """A finding about one measured value: OK where `kept`. The limit is the most allowed, or else the `least`."""
    text = (
        say("{}, at least {}", _number(value, unit), _number(limit, unit), place=subject)
        if least
        else say("{}, at most {}", _number(value, unit), _number(limit, unit), place=subject)
    )
    if kept:
        return Finding(Severity.OK, code, text, place, value, limit, unit)
    return Finding(severity, code, glue(text, "; " if advice else "", advice), place, value, limit, unit)


def _number(value: float, unit: str) -> str:
    """A measured value as a pilot reads it: centimetres are enough, micrometres are noise."""
    return f"{round(value, 3):g} {unit}".rstrip()
