"""From a plan to missions: one per sortie, with geodetic positions, and every photo at its place on the path.

The aircraft flies three pieces of a sortie by itself: the climb, the approach to the first waypoint and the landing.
They are the checked path only if the path leaves and reaches home along the column above it, so that is demanded here,
and the two ends of the column stay in the mission as its first and last waypoint: whatever the autopilot does between
the ground and them happens in the column, also when the pilot stands a step beside the planned home.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeVar

from missions.mission.model import GeoPoint, Mission, Photo, Waypoint
from planning.aircraft.camera_use import camera_use_of, controls_of
from planning.aircraft.catalogue import profiles
from planning.base.errors import InputError, MissionError
from planning.base.messages import say
from planning.geo.frames import Origin, Vec3, wrap_heading_deg
from planning.motion.timing import with_stops
from planning.plan import Plan, Sortie, Viewpoint

Value = TypeVar("Value")

SAME_POINT_M = 1e-3
"""Positions closer than this are one point: plans are written to the millimetre, no aircraft holds a centimetre."""

COLUMN_RADIUS_M = 0.5
"""How far from the vertical above home the ends of a path may lie; a hovering aircraft with RTK keeps about 0.1 m."""


def missions_from_plan(plan: Plan, origin: Origin | None = None, home_enu_m: Vec3 | None = None) -> tuple[Mission, ...]:
    """One mission per sortie of a plan.

    Parameters
    ----------
    origin, home_enu_m
        Of the plan's site; needed for plans that do not carry them, and compared with those of plans that do.

    Raises
    ------
    InputError
        The plan does not say where its local frame or its home lies, and neither do the arguments, or they disagree.
    MissionError
        The plan cannot be flown as it stands: no sortie, a viewpoint in none or in two, a viewpoint that is not on its
        path, a gimbal pitch that the camera cannot reach, or a path that does not start and end in the column above
        home.
    """
    plan = with_stops(plan)
    origin = _agreed(plan.origin, origin, "origin")
    home_enu_m = _agreed(plan.home_enu_m, home_enu_m, "home_enu_m")
    _check_each_viewpoint_once(plan)
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    profile = _profile_of(plan)
    speed_m_s = min(plan.aircraft.max_speed_m_s, plan.rules.max_speed_m_s or math.inf)
    f_number = camera_use_of(plan).f_number
    missions = []
    for number, sortie in enumerate(plan.sorties, 1):
        place = say("sortie {}", number)
        _check_ends_at_home(sortie.path_enu_m, home_enu_m, place)
        views = [by_id[viewpoint_id] for viewpoint_id in sortie.viewpoint_ids]
        for view in views:
            _check_pitch(view, plan)
        takeoff, waypoints = _geodetic(origin, sortie, views, place)
        missions.append(
            Mission(
                name=plan.site if number == 1 else f"{plan.site}-{number}",
                number=number,
                takeoff=takeoff,
                waypoints=waypoints,
                aircraft=plan.aircraft,
                camera=plan.camera,
                profile=profile,
                rules=plan.rules,
                speed_m_s=speed_m_s,
                length_m=sortie.length_m,
                duration_s=sortie.duration_s,
                origin=origin,
                camera_settings=plan.camera_settings,
                camera_controls=controls_of(plan),
                f_number=f_number,
            )
        )
    return tuple(missions)


def _agreed(of_plan: Value | None, of_site: Value | None, name: str) -> Value:
    if of_plan is None:
        if of_site is None:
            raise InputError.say("the plan has no {}, so nothing can be placed on the globe; add --site SITE", name)
        return of_site
    if of_site is not None and of_plan != of_site:
        raise InputError.say(
            "the plan was made for the {} {}, but the site says {}; plan again", name, of_plan, of_site
        )
    return of_plan


def _check_each_viewpoint_once(plan: Plan) -> None:
    if not plan.sorties:
        raise MissionError.say(
            "the plan has no sorties: nothing says which way to fly; plan again, locked views are kept"
        )
    seen: dict[str, int] = {}
    for number, sortie in enumerate(plan.sorties, 1):
        for viewpoint_id in sortie.viewpoint_ids:
            if viewpoint_id in seen:
                raise MissionError.say(
                    "viewpoint '{}' is in sortie {} and again in sortie {}; expected each viewpoint once",
                    viewpoint_id,
                    seen[viewpoint_id],
                    number,
                )
            seen[viewpoint_id] = number
    missing = [viewpoint.id for viewpoint in plan.viewpoints if viewpoint.id not in seen]
    if missing:
        raise MissionError.say(
            "{} viewpoints are in no sortie (the first is '{}'): their photos would be lost; plan the route again",
            len(missing),
            missing[0],
        )


def _profile_of(plan: Plan) -> str:
    """Identifier of the plan's profile; a plan without one has the profile whose aircraft and camera it names."""
    if plan.profile:
        return plan.profile
    names = (plan.aircraft.name, plan.camera.name)
    matches = [key for key, profile in profiles().items() if (profile.aircraft.name, profile.camera.name) == names]
    return matches[0] if len(matches) == 1 else ""


def _check_pitch(view: Viewpoint, plan: Plan) -> None:
    low, high = plan.camera.gimbal_pitch_deg
    if not low - 1e-6 <= view.gimbal_pitch_deg <= high + 1e-6:
        raise MissionError.say(
            "viewpoint '{}' needs a gimbal pitch of {:.1f} deg, but {} turns from {:g} to {:g} deg and would "
            "be stopped there; plan with this camera's limits",
            view.id,
            view.gimbal_pitch_deg,
            plan.camera.name,
            low,
            high,
        )


def _check_ends_at_home(path_enu_m: Sequence[Vec3], home_enu_m: Vec3, place: str) -> None:
    if len(path_enu_m) < 3:
        raise MissionError.say(
            "its path has {} points; expected take-off, flight and landing", len(path_enu_m), place=place
        )
    for end, neighbour, verb in ((path_enu_m[0], path_enu_m[1], "starts"), (path_enu_m[-1], path_enu_m[-2], "ends")):
        away_m = math.dist(end, home_enu_m)
        if away_m > COLUMN_RADIUS_M:
            raise MissionError.say(
                "its path {} {:.1f} m from home; expected it to start and end on the ground at home, where "
                "heights above take-off are counted from",
                verb,
                away_m,
                place=place,
            )
        if math.dist(neighbour[:2], end[:2]) > COLUMN_RADIUS_M or neighbour[2] <= end[2]:
            raise MissionError.say(
                "its path {} with a slanted leg, but aircraft climb and land vertically and would leave the "
                "checked path; expected a vertex straight above home",
                verb,
                place=place,
            )


def _geodetic(
    origin: Origin, sortie: Sortie, views: Sequence[Viewpoint], place: str
) -> tuple[GeoPoint, tuple[Waypoint, ...]]:
    """Take-off point and waypoints: the vertices between the two ground points, with the photos taken at them."""
    from planning.geo.enu import geodetic_from_enu

    vertices = [sortie.path_enu_m[1]]
    for vertex in sortie.path_enu_m[2:-1]:
        if math.dist(vertex, vertices[-1]) > SAME_POINT_M:
            vertices.append(vertex)
    photos = _photos_at(vertices, views, place)
    lat_deg, lon_deg, height_m = geodetic_from_enu(origin, [sortie.path_enu_m[0], *vertices])
    points = [GeoPoint(float(a), float(b), float(c)) for a, b, c in zip(lat_deg, lon_deg, height_m, strict=True)]
    return points[0], tuple(Waypoint(point, tuple(p)) for point, p in zip(points[1:], photos, strict=True))


def _photos_at(vertices: Sequence[Vec3], views: Sequence[Viewpoint], place: str) -> list[list[Photo]]:
    """Photos by vertex: the viewpoints in order, each at the first vertex with its position."""
    photos: list[list[Photo]] = [[] for _ in vertices]
    index = 0
    for view in views:
        while index < len(vertices) and math.dist(vertices[index], view.position_enu_m) > SAME_POINT_M:
            index += 1
        if index == len(vertices):
            raise MissionError.say(
                "viewpoint '{}' is not on the path, or not in the order of viewpoint_ids, so its photo would be "
                "lost; plan the route again",
                view.id,
                place=place,
            )
        photos[index].append(Photo(view.id, wrap_heading_deg(view.heading_deg), view.gimbal_pitch_deg))
    return photos
