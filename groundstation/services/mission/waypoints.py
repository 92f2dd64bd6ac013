"""The waypoints of a plan as a pilot reads them (where, how high, looking where); height and speed as curves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.checks.rules import MAX_ALTITUDE_M
from planning.geo.frames import Origin, Vec3
from planning.insight.flight_profile import FlightProfile, sortie_profile
from planning.motion.timing import motion_limits, photo_vertices, sortie_flight_path, stopping_times_s
from planning.parameters import FlightRules
from planning.plan import Aircraft, Plan, Sortie, Viewpoint
from planning.site.ground import Ground, ground_of
from planning.site.records import SiteModel

# Height and speed of a plan's sorties, ready for a chart: heights count from take-off.

Floats = NDArray[np.float64]


GROUND_STEP_M = 1.0
MAX_GROUND_SAMPLES = 4000
"""Of the curve of the terrain: finer than a screen shows."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundCurve:
    """The terrain below a sortie, shapes (g,): times, distances flown, and heights above take-off, NaN if not known."""

    t_s: Floats
    distance_m: Floats
    height_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class ProfileCurves:
    """One sortie, as q samples over time and p photos.

    Parameters
    ----------
    sortie
        Number from 1.
    t_s, distance_m, height_m, speed_m_s
        Shape (q,): since the aircraft hangs above home, ready to go, flown, above take-off, along the path.
    photo_t_s, photo_distance_m, photo_height_m
        Shape (p,), at `photo_ids`.
    takeoff_landing_s
        What the sortie's duration has on top of these times: motors, take-off checks, landing.
    ground
        The terrain below; None above level ground.
    """

    sortie: int
    t_s: Floats
    distance_m: Floats
    height_m: Floats
    speed_m_s: Floats
    photo_ids: tuple[str, ...]
    photo_t_s: Floats
    photo_distance_m: Floats
    photo_height_m: Floats
    takeoff_landing_s: float
    ground: GroundCurve | None = None


@dataclass(frozen=True, slots=True)
class HeightLimits:
    """Heights above take-off that a chart marks; `legal_m` is the height above ground that needs no permit.

    `is_level`: the ground is as high everywhere; else these are those of its lowest place below the airspace.
    """

    ground_m: float
    floor_m: float
    ceiling_m: float
    legal_m: float
    is_level: bool = True


def plan_profiles(plan: Plan, ground: Ground | None = None) -> tuple[ProfileCurves, ...]:
    """Curves of all sorties that can be flown, over some ground; none in wind that the aircraft may not fly in."""
    curves = []
    for number, sortie in enumerate(plan.sorties, 1):
        try:
            profile = sortie_profile(plan, sortie)
        except InfeasibleError:
            return ()
        if profile is None:
            continue
        samples, photos = profile.samples(), profile.at(profile.photo_s)
        takeoff_z = float(profile.vertices_enu_m[0, 2])
        curves.append(
            ProfileCurves(
                number,
                samples.t_s,
                samples.distance_m,
                samples.positions_enu_m[:, 2] - takeoff_z,
                samples.speed_m_s,
                profile.photo_ids,
                profile.photo_s,
                photos.distance_m,
                photos.positions_enu_m[:, 2] - takeoff_z,
                plan.rules.takeoff_landing_s,
                None if ground is None or ground.terrain is None else _ground_curve(profile, ground),
            )
        )
    return tuple(curves)


def _ground_curve(profile: FlightProfile, ground: Ground) -> GroundCurve:
    """The terrain below a flight, at steps of about `GROUND_STEP_M` of its way and at every change of its motion."""
    changes = profile.samples()
    steps = np.diff(changes.distance_m) / max(GROUND_STEP_M, float(changes.distance_m[-1]) / MAX_GROUND_SAMPLES)
    n = np.maximum(np.ceil(steps), 1).astype(np.int64)
    part = np.concatenate([np.arange(k) / k for k in n.tolist()])
    t_s = np.append(np.repeat(changes.t_s[:-1], n) + part * np.repeat(np.diff(changes.t_s), n), changes.t_s[-1])
    found = profile.at(t_s)
    heights = ground.heights_m(found.positions_enu_m) - float(profile.vertices_enu_m[0, 2])
    return GroundCurve(t_s, found.distance_m, heights)


def height_limits(site_model: SiteModel) -> HeightLimits:
    """Ground and airspace of a site, counted from home."""
    airspace, home_z = site_model.site.airspace, site_model.site.home_enu_m[2]
    ground = ground_of(site_model.site)
    ground_m = ground.range_m(np.array(airspace.min_enu_m), np.array(airspace.max_enu_m))[0] - home_z
    floor_m, ceiling_m = airspace.min_enu_m[2] - home_z, airspace.max_enu_m[2] - home_z
    return HeightLimits(ground_m, floor_m, ceiling_m, ground_m + MAX_ALTITUDE_M, ground.terrain is None)


def nearest_photo(curves: ProfileCurves, t_s: float) -> str | None:
    """Viewpoint whose photo is taken nearest to a time; None in sorties without photos."""
    if not curves.photo_ids:
        return None
    return curves.photo_ids[int(np.argmin(np.abs(curves.photo_t_s - t_s)))]


class HeightShown(StrEnum):
    """What absolute heights on screen are measured from; each has its name, none is just "altitude"."""

    LOCAL = "local"
    """Zero of the site's own frame."""
    AMSL = "amsl"
    """Mean sea level: the EGM96 geoid."""
    ELLIPSOID = "ellipsoid"
    """WGS 84, as GNSS receivers count."""


@dataclass(frozen=True, slots=True)
class WaypointRow:
    """One photo, or one vertex of a path without any.

    Parameters
    ----------
    sortie
        Number from 1; 0 for viewpoints that are in no sortie.
    vertex
        Of the sortie's path, 0 at take-off, so that leg k ends at vertex k; None where the path misses the viewpoint.
    viewpoint
        None where no photo is taken.
    lat_deg, lon_deg, height_ellipsoid_m, altitude_amsl_m
        None for plans that do not say where they lie.
    height_above_takeoff_m
        Above the first point of the sortie, as a difference of heights in the local frame's vertical where the plan
        does not say where it lies; None without a path.
    leg_m
        Length of the leg that ends here; 0 for a second photo at one place.
    arrival_s
        After lift-off, by the plan's time model with a stop at every vertex, as missions are flown; None where the
        path cannot be flown so.
    """

    sortie: int
    vertex: int | None
    viewpoint: Viewpoint | None
    position_enu_m: Vec3
    leg_m: float | None = None
    arrival_s: float | None = None
    lat_deg: float | None = None
    lon_deg: float | None = None
    height_ellipsoid_m: float | None = None
    altitude_amsl_m: float | None = None
    height_above_takeoff_m: float | None = None

    def height_m(self, shown: HeightShown) -> float | None:
        """Height in one of the references; None where it is not known."""
        match shown:
            case HeightShown.LOCAL:
                return self.position_enu_m[2]
            case HeightShown.AMSL:
                return self.altitude_amsl_m
            case HeightShown.ELLIPSOID:
                return self.height_ellipsoid_m


def waypoint_rows(plan: Plan, origin: Origin | None = None) -> tuple[WaypointRow, ...]:
    """All waypoints in the order of flight, from take-off to landing; last the viewpoints that are in no sortie.

    `origin` is that of the site, for plans that do not say where they lie.
    """
    by_id, origin = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}, plan.origin or origin
    rows: list[WaypointRow] = []
    for number, sortie in enumerate(plan.sorties, 1):
        views = tuple(by_id[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids)
        rows += _sortie_rows(number, sortie, views, plan.aircraft, plan.rules, origin)
    flown = {viewpoint_id for sortie in plan.sorties for viewpoint_id in sortie.viewpoint_ids}
    idle = [_Stop(0, None, view, view.position_enu_m) for view in plan.viewpoints if view.id not in flown]
    return (*rows, *_placed(idle, origin))


@lru_cache(maxsize=32)  # an edit changes one sortie of many
def _sortie_rows(
    number: int,
    sortie: Sortie,
    views: tuple[Viewpoint, ...],
    aircraft: Aircraft,
    rules: FlightRules,
    origin: Origin | None,
) -> tuple[WaypointRow, ...]:
    return _placed(list(_sortie_stops(number, sortie, views, aircraft, rules)), origin)


class _Stop(NamedTuple):
    """The part of a row that needs no place on the globe."""

    sortie: int
    vertex: int | None
    viewpoint: Viewpoint | None
    position_enu_m: Vec3
    leg_m: float | None = None
    arrival_s: float | None = None


def _sortie_stops(
    number: int, sortie: Sortie, views: tuple[Viewpoint, ...], aircraft: Aircraft, rules: FlightRules
) -> Iterator[_Stop]:
    by_id = {view.id: view for view in views}
    path, vertices = sortie.path_enu_m, photo_vertices(sortie, by_id)
    if vertices is None or len(path) < 2:
        # The path misses photos: they are listed all the same, for the findings name them.
        yield from (_Stop(number, None, view, view.position_enu_m) for view in views)
        return
    at: list[list[Viewpoint]] = [[] for _ in path]
    for view, vertex in zip(views, vertices, strict=True):
        at[vertex].append(view)
    arrivals = iter(_arrivals_s(sortie, by_id, aircraft, rules))
    for vertex, (point, photos) in enumerate(zip(path, at, strict=True)):
        leg_m = math.dist(path[vertex - 1], point) if vertex else 0.0
        for nth, photo in enumerate(photos or [None]):
            yield _Stop(number, vertex, photo, point, 0.0 if nth else leg_m, next(arrivals, None))


def _arrivals_s(sortie: Sortie, by_id: dict[str, Viewpoint], aircraft: Aircraft, rules: FlightRules) -> Sequence[float]:
    """Arrival at each vertex, photos that share one following each other; empty in wind that cannot be flown in."""
    try:
        flown = sortie_flight_path(sortie, by_id, aircraft, rules)
        limits = motion_limits(aircraft, rules)
    except InfeasibleError:
        return ()
    return () if flown is None else [float(t) for t in stopping_times_s(flown[0], limits)]


def _placed(stops: Sequence[_Stop], origin: Origin | None) -> tuple[WaypointRow, ...]:
    """Rows: stops with their places on the globe and their heights."""
    if not stops:
        return ()
    points = np.array([stop.position_enu_m for stop in stops], np.float64).reshape(-1, 3)
    takeoff_row = {stop.sortie: index for index, stop in enumerate(stops) if stop.vertex == 0}
    if origin is None:
        above = _above_takeoff_m(stops, points[:, 2], takeoff_row)
        return tuple(
            WaypointRow(*stop, height_above_takeoff_m=above_m) for stop, above_m in zip(stops, above, strict=True)
        )
    from planning.geo.enu import geodetic_from_enu
    from planning.geo.geoid import amsl_from_ellipsoid_m

    lat, lon, height = geodetic_from_enu(origin, points)
    amsl = amsl_from_ellipsoid_m(lat, lon, height)
    above = _above_takeoff_m(stops, height, takeoff_row)
    placed = zip(lat.tolist(), lon.tolist(), height.tolist(), amsl.tolist(), above, strict=True)
    return tuple(WaypointRow(*stop, *place) for stop, place in zip(stops, placed, strict=True))


def _above_takeoff_m(
    stops: Sequence[_Stop], heights_m: NDArray[np.float64], takeoff_row: dict[int, int]
) -> list[float | None]:
    return [
        float(height - heights_m[takeoff_row[stop.sortie]]) if stop.sortie in takeoff_row else None
        for stop, height in zip(stops, heights_m, strict=True)
    ]
