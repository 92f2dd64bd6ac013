"""Missions that were read, as viewpoints and sorties of a site, so that their coverage can be evaluated.

What the file leaves open is filled in by what the aircraft does then, and each time a finding says so: heights above
take-off count from the site's home, a gimbal that was never told anything stands level, the pieces that the autopilot
flies by itself (climb, approach, return, landing) become part of the path.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from missions.mission.build import COLUMN_RADIUS_M
from missions.mission.export_choices import HeightReference
from missions.mission.model import Finish, ReadMission, ReadPhoto, Stay, distance_m
from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3
from planning.geo.mesh import MAX_COORDINATE_M
from planning.motion.timing import (
    SAME_PLACE_M,
    MotionLimits,
    motion_limits,
    rest_to_rest_s,
    sortie_flight_path,
    speed_limits_m_s,
    stopping_duration_s,
)
from planning.parameters import DEFAULT_PROFILE, FlightRules
from planning.plan import Aircraft, Sortie, Viewpoint
from planning.site.records import MAX_DISTANCE_M

Array = NDArray[np.float64]

STRAIGHT_RAD = math.radians(1.0)
SHARPEST_TURN_RAD = math.radians(175.0)
"""Corners that turn less are none; those that turn more are stops."""

CORNER_SHARE = 0.5
"""Of the acceleration, around corners. Ten routes of FlightHub 2 with 3 to 860 such turns state times that ours meets
within 6 % with it; with all of the acceleration ours are up to 12 % shorter."""

TAKEOFF_MOVED_M = 20.0
"""A take-off point of the file this far from the site's home is worth a warning; a launch area is smaller."""

TAKEOFF_LIFTED_M = 2.0
"""Likewise for its height, which shifts all heights above take-off; GNSS without RTK is good to about 2 m."""

RTH_NEAR_M = 5.0
"""DJI aircraft that are told to return within this distance of home land at once (DJI Mavic 3 user manual)."""

ASSUMED_SPEED_M_S = 5.0
"""Cruise speed of missions that name none: QGroundControl's and PX4's default."""


@dataclass(frozen=True, slots=True)
class PlanParts:
    """Viewpoints and sorties in a site's local frame, and what had to be assumed to get them."""

    viewpoints: tuple[Viewpoint, ...]
    sorties: tuple[Sortie, ...]
    findings: tuple[Finding, ...]


def viewpoints_and_sorties(
    missions: Sequence[ReadMission],
    origin: Origin,
    home_enu_m: Vec3,
    rules: FlightRules | None = None,
    aircraft: Aircraft | None = None,
) -> PlanParts:
    """One sortie per mission, and a viewpoint per photo.

    Parameters
    ----------
    rules, aircraft
        For durations (stopping at every waypoint, at the mission's own speed); by default the usual rules and the
        default profile's aircraft.

    Raises
    ------
    InputError
        A mission stays more than `MAX_DISTANCE_M` from home, or goes further than the local frame reaches.
    """
    from planning.geo.enu import geodetic_from_enu

    rules, aircraft = rules or FlightRules(), aircraft or profile(DEFAULT_PROFILE).aircraft
    lat, lon, height_m = geodetic_from_enu(origin, [home_enu_m])
    home = (float(lat[0]), float(lon[0]), float(height_m[0]))
    ids = _Ids()
    viewpoints: list[Viewpoint] = []
    sorties: list[Sortie] = []
    findings: list[Finding] = []
    for mission in missions:
        _check_is_near(mission, home)
        findings += mission.findings
        findings += _takeoff_findings(mission, home)
        points = _points_enu_m(mission, origin, home[2])
        before, after = _ways(mission, points, home_enu_m)
        path = _flown_path(mission, before, points, after)
        _check_is_local(mission, path)
        views: list[Viewpoint] = []
        in_passing: list[str] = []
        unaimed = _Unaimed()
        for waypoint, point in zip(mission.waypoints, points, strict=True):
            for photo in waypoint.photos:
                if unaimed.count(photo) and photo.heading_deg is not None:
                    pitch_deg = 0.0 if photo.gimbal_pitch_deg is None else photo.gimbal_pitch_deg
                    views.append(Viewpoint(ids.next(photo.viewpoint_id), point, photo.heading_deg, pitch_deg))
                    in_passing += [views[-1].id] * photo.in_passing
        findings += unaimed.findings(mission.name)
        findings += _end_findings(mission)
        length_m = float(sum(math.dist(a, b) for a, b in itertools.pairwise(path)))
        sortie = Sortie(tuple(view.id for view in views), tuple(path), length_m, 0.0, tuple(in_passing))
        if all(waypoint.stay is not None for waypoint in mission.waypoints):
            duration_s, time_findings = _time_as_told(mission, before, points, after, rules, aircraft)
            findings += time_findings
        else:
            duration_s = _time_as_planned(sortie, views, mission, rules, aircraft)
        sorties.append(replace(sortie, duration_s=duration_s))
        viewpoints += views
    return PlanParts(tuple(viewpoints), tuple(sorties), tuple(findings))


@dataclass(slots=True)
class _Ids:
    """Viewpoint ids: the file's own where it has them, else v0000, v0001, ... in the order of flight."""

    used: set[str] = field(default_factory=set)
    count: int = 0

    def next(self, stated: str) -> str:
        identifier = stated
        while not identifier or identifier in self.used:
            identifier = f"v{self.count:04d}"
            self.count += 1
        self.used.add(identifier)
        return identifier


@dataclass(slots=True)
class _Unaimed:
    """Photos whose angles the file leaves open."""

    n_without_heading: int = 0
    n_without_pitch: int = 0

    def count(self, photo: ReadPhoto) -> bool:
        """Whether the photo can be used."""
        if photo.heading_deg is None:
            self.n_without_heading += 1
            return False
        self.n_without_pitch += photo.gimbal_pitch_deg is None
        return True

    def findings(self, name: str) -> Iterator[Finding]:
        if self.n_without_heading:
            text = say("{} photos are left out: the pilot turns the aircraft by hand there", self.n_without_heading)
            yield Finding(Severity.WARNING, "no-heading", text, name, self.n_without_heading)
        if self.n_without_pitch:
            text = say(
                "{} photos have no gimbal pitch in the file; a gimbal starts level: 0 deg assumed", self.n_without_pitch
            )
            yield Finding(Severity.WARNING, "no-gimbal-pitch", text, name, self.n_without_pitch)


def _check_is_near(mission: ReadMission, home: tuple[float, float, float]) -> None:
    if not mission.waypoints:
        raise InputError.say("the mission has no waypoints", place=mission.path)
    nearest_m = min(distance_m(w.lat_deg, w.lon_deg, home[0], home[1]) for w in mission.waypoints)
    if nearest_m > MAX_DISTANCE_M:
        raise InputError.say(
            "the mission '{}' is {:.1f} km from the site's home; expected at most {:g} km; is it the right "
            "site? Imported without one, the mission gets a bare site of its own, to look at it",
            mission.name,
            nearest_m / 1000.0,
            MAX_DISTANCE_M / 1000.0,
            place=mission.path,
        )


def _check_is_local(mission: ReadMission, path: Sequence[Vec3]) -> None:
    for point in path:
        away_m = max(map(abs, point))
        if away_m > MAX_COORDINATE_M:
            raise InputError.say(
                "the mission '{}' reaches {:.0f} km from the origin of the site; expected at most {:g} km; a "
                "coordinate or a height in it is wrong",
                mission.name,
                away_m / 1000.0,
                MAX_COORDINATE_M / 1000.0,
                place=mission.path,
            )


def _takeoff_findings(mission: ReadMission, home: tuple[float, float, float]) -> Iterator[Finding]:
    is_relative = mission.height_reference is HeightReference.ABOVE_TAKEOFF
    if is_relative:
        text = say("its heights are above take-off and were counted from the site's home")
        yield Finding(Severity.NOTE, "height-reference", text, mission.name)
    elif mission.height_reference is HeightReference.AMSL:
        text = say("its heights are above sea level and were brought to the ellipsoid with EGM96")
        yield Finding(Severity.NOTE, "height-reference", text, mission.name)
    if mission.takeoff is None:
        return
    away_m = distance_m(mission.takeoff.lat_deg, mission.takeoff.lon_deg, home[0], home[1])
    if away_m > TAKEOFF_MOVED_M:
        text = say(
            "it was planned for a take-off {:.0f} m from the site's home; the way there is not the planned one", away_m
        )
        yield Finding(Severity.WARNING, "takeoff-moved", text, mission.name, away_m, TAKEOFF_MOVED_M, "m")
    lifted_m = mission.takeoff.height_ellipsoid_m - home[2]
    if is_relative and abs(lifted_m) > TAKEOFF_LIFTED_M:
        text = (
            say(
                "its take-off point lies {:.1f} m above the site's home, so counted from home all its heights "
                "are off by that",
                abs(lifted_m),
            )
            if lifted_m > 0
            else say(
                "its take-off point lies {:.1f} m below the site's home, so counted from home all its heights "
                "are off by that",
                abs(lifted_m),
            )
        )
        yield Finding(Severity.WARNING, "takeoff-lifted", text, mission.name, lifted_m, TAKEOFF_LIFTED_M, "m")


def _end_findings(mission: ReadMission) -> Iterator[Finding]:
    if mission.finish is Finish.HOVER:
        text = say("the mission ends hovering at its last waypoint; the way home is the pilot's and not in the path")
        yield Finding(Severity.NOTE, "finish", text, mission.name)


def _points_enu_m(mission: ReadMission, origin: Origin, home_height_ellipsoid_m: float) -> list[Vec3]:
    from planning.geo.enu import enu_from_geodetic

    heights_m = [
        w.height_ellipsoid_m if w.height_above_takeoff_m is None else home_height_ellipsoid_m + w.height_above_takeoff_m
        for w in mission.waypoints
    ]
    lat, lon = [w.lat_deg for w in mission.waypoints], [w.lon_deg for w in mission.waypoints]
    points = enu_from_geodetic(origin, lat, lon, np.array(heights_m, np.float64))
    # Rounded to 0.1 mm, so that a place that is visited twice is one point.
    return [(round(float(x), 4), round(float(y), 4), round(float(z), 4)) for x, y, z in points]


def _ways(mission: ReadMission, points: Sequence[Vec3], home: Vec3) -> tuple[list[Vec3], list[Vec3]]:
    """The pieces that the autopilot flies by itself: from take-off to the first waypoint, from the last to landing."""
    first, last = points[0], points[-1]
    climb_z = max(first[2], home[2] + mission.climb_above_takeoff_m)
    before = [home]
    if math.dist(first[:2], home[:2]) > COLUMN_RADIUS_M:
        before += [(home[0], home[1], climb_z), (first[0], first[1], climb_z)]
    after: list[Vec3] = []
    home_m = math.dist(last[:2], home[:2])
    if home_m <= COLUMN_RADIUS_M and mission.finish is not Finish.HOVER:
        after = [home]
    elif mission.finish is Finish.RETURN:
        climbs = home_m > RTH_NEAR_M
        return_z = max(last[2], home[2] + mission.return_above_takeoff_m) if climbs else last[2]
        after = [(last[0], last[1], return_z), (home[0], home[1], return_z), home]
    elif mission.finish is Finish.LAND:
        after = [(last[0], last[1], home[2])]
    return before, after


def _flown_path(
    mission: ReadMission, before: Sequence[Vec3], points: Sequence[Vec3], after: Sequence[Vec3]
) -> list[Vec3]:
    """From take-off to landing. Each photo has a vertex of its own, also where several are taken at one place."""
    path: list[Vec3] = []
    is_free = False
    n_photos = [len(waypoint.photos) for waypoint in mission.waypoints]
    for point, n in [*((p, 0) for p in before), *zip(points, n_photos, strict=True), *((p, 0) for p in after)]:
        is_there = bool(path) and path[-1] == point and (is_free or n == 0)
        path += [point] * (max(1, n) - is_there)
        is_free = n == 0 and (is_free or not is_there)
    return path


def _time_as_planned(
    sortie: Sortie, views: Sequence[Viewpoint], mission: ReadMission, rules: FlightRules, aircraft: Aircraft
) -> float:
    """Duration of a sortie that stops for every photo as long as plans do, for files that say nothing about it."""
    rules = replace(rules, max_speed_m_s=mission.speed_m_s or ASSUMED_SPEED_M_S)
    timed = sortie_flight_path(sortie, {view.id: view for view in views}, aircraft, rules)
    return 0.0 if timed is None else stopping_duration_s(timed[0], aircraft, rules)


def _time_as_told(
    mission: ReadMission,
    before: Sequence[Vec3],
    points: Sequence[Vec3],
    after: Sequence[Vec3],
    rules: FlightRules,
    aircraft: Aircraft,
) -> tuple[float, tuple[Finding, ...]]:
    """Duration of a sortie by what the file tells the aircraft to do, and how the file's own time compares."""
    limits = motion_limits(aircraft, rules)
    speed_m_s = mission.speed_m_s or ASSUMED_SPEED_M_S
    stays = [waypoint.stay or Stay() for waypoint in mission.waypoints]
    speeds = [waypoint.speed_m_s or speed_m_s for waypoint in mission.waypoints]
    route_s = flown_s(list(map(RoutePoint, points, stays, speeds)), limits)
    ways = ([*before, points[0]], [points[-1], *after])
    transit_m_s = mission.transit_speed_m_s or speed_m_s
    way_s = sum(flown_s(timed_route(way, [Stay()] * len(way), transit_m_s), limits) for way in ways)
    duration_s = rules.takeoff_landing_s + way_s + route_s
    if not mission.stated_s:
        return duration_s, ()
    text = say(
        "the file states {:.0f} s for its route, and by what it tells the aircraft to do it takes {:.0f} "
        "s; with the way there and back, take-off and landing the flight takes {:.0f} s",
        mission.stated_s,
        route_s,
        duration_s,
    )
    return duration_s, (Finding(Severity.NOTE, "stated-time", text, mission.name, mission.stated_s, route_s, "s"),)


class RoutePoint(NamedTuple):
    """A waypoint to be timed; the speed is that along the leg behind it, also where this climbs."""

    place_enu_m: Vec3
    stay: Stay
    speed_m_s: float


def timed_route(places_enu_m: Sequence[Vec3], stays: Sequence[Stay], speed_m_s: float) -> list[RoutePoint]:
    """A route at one speed."""
    return [RoutePoint(place, stay, speed_m_s) for place, stay in zip(places_enu_m, stays, strict=True)]


def flown_s(route: Sequence[RoutePoint], limits: MotionLimits) -> float:
    """Time from the first to the last of some waypoints, at rest at both, seconds.

    Legs are flown with constant acceleration up to their speed. A corner that is flown through is an arc that leaves
    its leg as far before the waypoint as the file says, at most half of either leg, at the speed that the acceleration
    allows on it. Jerk counts on legs from rest to rest.
    """
    rests = [point.stay for point in route if point.stay.is_stop]
    rests_s = sum(stay.wait_s + math.radians(stay.turn_deg) / limits.yaw_rate_rad_s for stay in rests)
    kept = _without_straight_places(route)
    legs = np.diff([point.place_enu_m for point in kept], axis=0)
    if not len(legs):
        return rests_s
    speeds = [
        min(point.speed_m_s, float(speed_limits_m_s(leg, limits))) for leg, point in zip(legs, kept, strict=False)
    ]
    cuts = [None if point.stay.is_stop else point.stay.passing_m for point in kept]
    return rests_s + _legs_s(legs, np.array(speeds, np.float64), cuts, limits)


def _without_straight_places(route: Sequence[RoutePoint]) -> list[RoutePoint]:
    """The route without places on straight legs, and with those at which it does not move on as one."""
    apart: list[RoutePoint] = []
    for point in route:
        if apart and math.dist(apart[-1].place_enu_m, point.place_enu_m) <= SAME_PLACE_M:
            stay = apart[-1].stay if apart[-1].stay.is_stop else point.stay
            apart[-1] = RoutePoint(apart[-1].place_enu_m, stay, point.speed_m_s)
        else:
            apart.append(point)
    kept = apart[:1]
    for point, following in itertools.pairwise(apart[1:]):
        is_on_leg = not point.stay.is_stop and point.speed_m_s == kept[-1].speed_m_s
        if not (is_on_leg and _turn_rad(*(p.place_enu_m for p in (kept[-1], point, following))) < STRAIGHT_RAD):
            kept.append(point)
    return kept + apart[1:][-1:]


def _turn_rad(before: Vec3, here: Vec3, behind: Vec3) -> float:
    """By how much a route turns at a place, 0 to pi."""
    u, v = np.subtract(here, before), np.subtract(behind, here)
    u, v = u / np.linalg.norm(u), v / np.linalg.norm(v)
    return 2.0 * math.atan2(float(np.linalg.norm(u - v)), float(np.linalg.norm(u + v)))


def _legs_s(legs: Array, speed_m_s: Array, cuts_m: Sequence[float | None], limits: MotionLimits) -> float:
    """Time over legs, shape (n, 3), with their speeds, shape (n,), and how corners are cut, n + 1 (None: a stop)."""
    length, a = np.linalg.norm(legs, axis=1), limits.acceleration_m_s2
    n = len(legs)
    corner_m_s, cut, arc = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    for k in range(1, n):
        wanted = cuts_m[k]
        if wanted is None:
            continue
        turn = _turn_rad((0.0, 0.0, 0.0), legs[k - 1], legs[k - 1] + legs[k])
        slower = float(min(speed_m_s[k - 1], speed_m_s[k]))
        if turn < STRAIGHT_RAD:
            corner_m_s[k] = slower
        elif turn < SHARPEST_TURN_RAD:
            cut[k] = min(wanted, length[k - 1] / 2.0, length[k] / 2.0)
            radius = cut[k] / math.tan(turn / 2.0)
            corner_m_s[k], arc[k] = min(slower, math.sqrt(CORNER_SHARE * a * radius)), radius * turn
    straight = np.maximum(length - cut[:-1] - cut[1:], 0.0)
    for k in range(1, n + 1):
        corner_m_s[k] = min(corner_m_s[k], math.sqrt(corner_m_s[k - 1] ** 2 + 2.0 * a * straight[k - 1]))
    for k in range(n - 1, -1, -1):
        corner_m_s[k] = min(corner_m_s[k], math.sqrt(corner_m_s[k + 1] ** 2 + 2.0 * a * straight[k]))
    total_s = sum(arc[k] / corner_m_s[k] for k in range(1, n) if arc[k] > 0.0)
    for k in range(n):
        start, end = corner_m_s[k], corner_m_s[k + 1]
        if start == end == 0.0:
            total_s += float(rest_to_rest_s(straight[k], speed_m_s[k], a, limits.jerk_m_s3))
            continue
        peak = min(speed_m_s[k], math.sqrt(a * straight[k] + (start**2 + end**2) / 2.0))
        cruised = straight[k] - (2.0 * peak**2 - start**2 - end**2) / (2.0 * a)
        total_s += (2.0 * peak - start - end) / a + max(0.0, cruised) / peak
    return float(total_s)
