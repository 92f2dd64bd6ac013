"""Checks of one wayline's route: coordinates, heights, spacing, speeds, headings and turns.

The limits are DJI's: Cloud API documentation (WPML), reject reasons of the Payload SDK (`dji_error.h`, trajectory
errors) and the Mobile SDK. Where DJI's own programs write what their documents forbid, the finding is no error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from missions.dji.wpml import Folder, WpmlWaypoint
from missions.legs import courses_deg, leg_lengths_m
from planning.findings import Finding, Severity

MAX_WAYPOINTS = 65535
MAX_WAYPOINTS_DJI_FLY = 99
MIN_SPACING_M = 0.5
MAX_SPACING_M = 5000.0
LONG_LEG_M = 2000.0
LOW_M, LEGAL_CEILING_M = 2.0, 120.0
MIN_HEIGHT_M, MAX_HEIGHT_M = -200.0, 1500.0
MAX_SPEED_M_S = 15.0
STALE_M, STALE_SHARE = 1.0, 0.01
"""A distance in the file this far from the waypoints' own is left over from another route."""

HEIGHT_MODES = ("WGS84", "relativeToStartPoint", "realTimeFollowSurface")
HEADING_MODES = ("followWayline", "manually", "fixed", "smoothTransition", "towardPOI")
STOP_MODES = ("toPointAndStopWithDiscontinuityCurvature", "toPointAndStopWithContinuityCurvature")
PASS_MODES = ("coordinateTurn", "toPointAndPassWithContinuityCurvature")

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


def check_route(folder: Folder, place: str, *, dji_fly: bool) -> Iterator[Finding]:
    """Findings on the route of one wayline."""
    yield from _count(folder, place, dji_fly=dji_fly)
    if folder.height_mode not in HEIGHT_MODES:
        yield Finding(
            ERROR,
            "height-mode",
            f"executeHeightMode is '{folder.height_mode}'; aircraft know {', '.join(HEIGHT_MODES)}",
            place,
        )
    bad_points = [
        f for i, w in enumerate(folder.waypoints) for f in _point(w, folder.height_mode, f"{place}waypoint {i}")
    ]
    yield from bad_points
    for i, waypoint in enumerate(folder.waypoints):
        yield from _speed(waypoint.speed_m_s or folder.speed_m_s, f"{place}waypoint {i}")
        yield from _heading(waypoint, f"{place}waypoint {i}")
    if not any(finding.severity is ERROR for finding in bad_points):
        yield from _legs(folder, place)


def _count(folder: Folder, place: str, *, dji_fly: bool) -> Iterator[Finding]:
    n = len(folder.waypoints)
    limit = MAX_WAYPOINTS_DJI_FLY if dji_fly else MAX_WAYPOINTS
    if n == 0:
        yield Finding(ERROR, "waypoint-count", "the wayline has no waypoints", place, 0, 2)
    elif n == 1:
        yield Finding(WARNING, "waypoint-count", "the wayline has one waypoint; most aircraft want two", place, 1, 2)
    elif n > limit:
        severity = WARNING if dji_fly else ERROR
        yield Finding(severity, "waypoint-count", f"the wayline has {n} waypoints; split it", place, n, limit)
    indices = [waypoint.index for waypoint in folder.waypoints]
    if indices != list(range(n)):
        wrong = next(i for i, index in enumerate(indices) if index != i)
        yield Finding(
            ERROR,
            "waypoint-index",
            f"expected indices 0 to {n - 1} in order, found {indices[wrong]} in place {wrong}",
            place,
        )


def _point(waypoint: WpmlWaypoint, height_mode: str, place: str) -> Iterator[Finding]:
    lat, lon, height_m = waypoint.lat_deg, waypoint.lon_deg, waypoint.execute_height_m
    if lat is None or lon is None:
        yield Finding(ERROR, "coordinates", "the waypoint has no coordinates (longitude,latitude)", place)
    elif not (math.isfinite(lat) and math.isfinite(lon)) or abs(lat) > 90.0 or abs(lon) > 180.0:
        swapped = abs(lon) <= 90.0 < abs(lat) <= 180.0
        hint = "latitude and longitude are swapped" if swapped else "they look like projected metres, not degrees"
        yield Finding(ERROR, "coordinates", f"coordinates {lon:g},{lat:g} are not on the globe; {hint}", place)
    elif lat == 0.0 and lon == 0.0:
        yield Finding(ERROR, "coordinates", "coordinates are 0,0, which means that they were never set", place)
    if height_m is None or not math.isfinite(height_m):
        yield Finding(ERROR, "height", "the waypoint has no executeHeight", place)
    elif height_mode == "relativeToStartPoint":
        if not MIN_HEIGHT_M <= height_m <= MAX_HEIGHT_M:
            limit = MIN_HEIGHT_M if height_m < MIN_HEIGHT_M else MAX_HEIGHT_M
            yield Finding(ERROR, "height", "the height is outside what aircraft accept", place, height_m, limit, "m")
        elif height_m < LOW_M:
            yield Finding(
                WARNING,
                "height",
                "the height is close to or below the take-off point; make sure that this is meant",
                place,
                height_m,
                LOW_M,
                "m",
            )
        elif height_m > LEGAL_CEILING_M:
            text = "the height is above what the law allows in most countries without a permit"
            yield Finding(WARNING, "height", text, place, height_m, LEGAL_CEILING_M, "m")


def _speed(speed_m_s: float | None, place: str) -> Iterator[Finding]:
    if speed_m_s is None:
        yield Finding(ERROR, "speed", "neither the waypoint nor the wayline has a speed", place)
    elif not 0.0 < speed_m_s <= MAX_SPEED_M_S:
        yield Finding(
            ERROR,
            "speed",
            "the speed must be above 0 and within the format's range",
            place,
            speed_m_s,
            MAX_SPEED_M_S,
            "m/s",
        )


def _heading(waypoint: WpmlWaypoint, place: str) -> Iterator[Finding]:
    mode, angle = waypoint.heading_mode, waypoint.heading_angle_deg
    if mode not in HEADING_MODES:
        known = ", ".join(HEADING_MODES)
        yield Finding(ERROR, "heading-mode", f"waypointHeadingMode is '{mode}'; aircraft know {known}", place)
    if angle is not None and not -180.0 <= angle <= 180.0:
        yield Finding(ERROR, "heading", "waypointHeadingAngle is not in [-180, 180]", place, angle, 180.0, "deg")
    if mode == "smoothTransition" and angle is None:
        yield Finding(ERROR, "heading", "smoothTransition needs a waypointHeadingAngle", place)
    elif mode == "smoothTransition" and not waypoint.heading_angle_enable:
        yield Finding(
            WARNING, "heading", "smoothTransition has waypointHeadingAngleEnable 0, so its angle may be ignored", place
        )
    if mode == "towardPOI" and waypoint.poi_lat_lon_deg in (None, (0.0, 0.0)):
        yield Finding(ERROR, "heading", "towardPOI has no waypointPoiPoint to look at", place)


def _legs(folder: Folder, place: str) -> Iterator[Finding]:
    waypoints = folder.waypoints
    lat, lon = [w.lat_deg or 0.0 for w in waypoints], [w.lon_deg or 0.0 for w in waypoints]
    lengths_m = [float(m) for m in leg_lengths_m(lat, lon, [w.execute_height_m or 0.0 for w in waypoints])]
    for i, (length_m, course) in enumerate(zip(lengths_m, courses_deg(lat, lon), strict=True)):
        leg = f"{place}leg {i}-{i + 1}"
        if length_m > MAX_SPACING_M:
            yield Finding(
                ERROR,
                "spacing",
                "the leg is longer than aircraft accept; put a waypoint in between",
                leg,
                length_m,
                MAX_SPACING_M,
                "m",
            )
        elif length_m > LONG_LEG_M:
            yield Finding(WARNING, "spacing", "the leg is unusually long", leg, length_m, LONG_LEG_M, "m")
        elif length_m < MIN_SPACING_M:
            # An error by the documents, but FlightHub 2's terrain routes have legs of 0.2 m and are flown.
            yield Finding(
                WARNING,
                "spacing",
                "the leg is shorter than documented; some aircraft refuse it",
                leg,
                length_m,
                MIN_SPACING_M,
                "m",
            )
        if course is None and waypoints[i].heading_mode == "followWayline":
            # The Payload SDK has an error for it (TRAJ_INVALID_YAW_MODE_IN_VERT_SEGM), and DJI's programs write it.
            text = "the leg is vertical, so there is no course to follow: the nose stays as it is"
            yield Finding(NOTE, "vertical-leg", text, leg)
    yield from _turns(waypoints, lengths_m, place)
    yield from _distance(folder, sum(lengths_m), place)


def _turns(waypoints: Sequence[WpmlWaypoint], lengths_m: Sequence[float], place: str) -> Iterator[Finding]:
    n = len(waypoints)
    dampings_m = [w.turn_damping_m or 0.0 if w.turn_mode in PASS_MODES else 0.0 for w in waypoints]
    for i, waypoint in enumerate(waypoints):
        where = f"{place}waypoint {i}"
        if waypoint.turn_mode not in (*STOP_MODES, *PASS_MODES):
            yield Finding(ERROR, "turn-mode", f"waypointTurnMode '{waypoint.turn_mode}' is not known", where)
        elif i in (0, n - 1) and waypoint.turn_mode not in STOP_MODES:
            yield Finding(ERROR, "turn-mode", "the first and the last waypoint must be of a stopping type", where)
        elif waypoint.turn_mode in PASS_MODES:
            needs = waypoint.turn_mode == "coordinateTurn" or waypoint.use_straight_line
            if needs and dampings_m[i] <= 0.0:
                yield Finding(ERROR, "turn-damping", f"{waypoint.turn_mode} needs a waypointTurnDampingDist", where)
            yield Finding(NOTE, "turn-mode", f"{waypoint.turn_mode} cuts the corner: the path is no polyline", where)
        elif waypoint.turn_damping_m:
            text = "waypointTurnDampingDist is ignored where the aircraft stops"
            yield Finding(NOTE, "turn-damping", text, where, waypoint.turn_damping_m, 0.0, "m")
    for i, length_m in enumerate(lengths_m):
        turning_m = dampings_m[i] + dampings_m[i + 1]
        if turning_m > 0.0 and turning_m >= length_m:
            text = "the leg is shorter than the turns at its two ends"
            yield Finding(ERROR, "turn-damping", text, f"{place}leg {i}-{i + 1}", turning_m, length_m, "m")


def _distance(folder: Folder, length_m: float, place: str) -> Iterator[Finding]:
    said_m = folder.distance_m
    if said_m is not None and not abs(said_m - length_m) <= STALE_M + STALE_SHARE * length_m:
        text = f"its distance is {said_m:.1f} m, but its waypoints are {length_m:.1f} m long: was it edited by hand?"
        yield Finding(WARNING, "stale-distance", text, place, said_m, length_m, "m")
