"""All checks of a DJI mission: every finding, with the severity that files written by DJI's own programs allow.

A file that Pilot 2 or FlightHub 2 wrote has no error; a file with an error is refused by an aircraft or a program.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from missions.dji.wpml import (
    Action,
    ActionGroup,
    DjiCatalogue,
    DjiParts,
    Folder,
    MissionConfig,
    WpmlDocument,
    WpmlWaypoint,
    dji_catalogue,
)
from missions.mission.model import courses_deg, distance_m, leg_lengths_m
from planning.aircraft.catalogue import profiles
from planning.base.findings import Finding, Severity
from planning.base.messages import glue, say

ERROR, WARNING, NOTE = (Severity.ERROR, Severity.WARNING, Severity.NOTE)


# Checks of one wayline's actions: groups, triggers, and the parameters that aim and release the camera.
#
# The limits are DJI's: Cloud API documentation (WPML common elements) and the reject reasons of the Payload SDK.

UNSET = 65535
"""What DJI's programs put where nothing was set; as an id or index it is refused (Mobile SDK issue 408)."""

TRIGGERS = ("reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance")

FUNCS = (
    "takePhoto", "startRecord", "stopRecord", "focus", "zoom", "customDirName", "gimbalRotate", "rotateYaw", "hover",
    "gimbalEvenlyRotate", "accurateShoot", "orientedShoot", "panoShot", "recordPointCloud", "setFocusType",
    "startTimeLapse", "stopTimeLapse", "megaphone", "searchlight",
)  # fmt: skip


def check_actions(
    folder: Folder, config: MissionConfig, place: str, *, is_template: bool, ids_before: set[int]
) -> Iterator[Finding]:
    """Findings on the actions of one wayline or template.

    Parameters
    ----------
    is_template
        DJI's own templates repeat action ids, which only waylines must not.
    ids_before
        Ids of the action groups of earlier waylines; those of this one are added.
    """
    yield from _actions(folder.start_actions, config, say("{}start actions", place), is_template=is_template)
    n, ids = len(folder.waypoints), set[int]()
    for i, waypoint in enumerate(folder.waypoints):
        for group in waypoint.groups:
            where = say("{}waypoint {}, group {}", place, i, group.group_id)
            yield from _group(group, n, where)
            yield from _actions(group.actions, config, where, is_template=is_template)
            if group.group_id in ids:
                text = say("the actionGroupId occurs twice in one wayline; number the groups from 0")
                yield Finding(ERROR, "action-group-id", text, where)
            elif group.group_id in ids_before:
                yield Finding(
                    NOTE, "action-group-id", say("the actionGroupId occurs in an earlier wayline, too"), where
                )
            ids |= set() if group.group_id is None else {group.group_id}
    ids_before |= ids


def _group(group: ActionGroup, n_waypoints: int, where: str) -> Iterator[Finding]:
    start, end = group.start_index, group.end_index
    if group.group_id is None or start is None or end is None:
        yield Finding(
            ERROR, "action-group", say("the group lacks its id, actionGroupStartIndex or actionGroupEndIndex"), where
        )
    elif UNSET in (group.group_id, start, end):
        yield Finding(ERROR, "action-group", say("the group has an id or index of 65535, which means unset"), where)
    elif not 0 <= start <= end < n_waypoints:
        text = say(
            "the group acts from waypoint {} to {}, but there are waypoints 0 to {} only", start, end, n_waypoints - 1
        )
        yield Finding(ERROR, "action-group", text, where)
    if group.trigger not in TRIGGERS:
        known = ", ".join(TRIGGERS)
        yield Finding(ERROR, "action-trigger", say("the trigger '{}' is not one of {}", group.trigger, known), where)
    elif group.trigger.startswith("multiple") and not (group.trigger_param or 0.0) > 0.0:
        yield Finding(ERROR, "action-trigger", say("{} needs an actionTriggerParam above 0", group.trigger), where)
    elif group.trigger.startswith("multiple") and start == end:
        text = say("a trigger by time or distance that ends where it begins covers no leg; its photos are not counted")
        yield Finding(WARNING, "action-trigger", text, where)
    elif group.trigger == "reachPoint" and start != end:
        yield Finding(WARNING, "action-trigger", say("a reachPoint group should act at one waypoint only"), where)
    if not group.actions:
        yield Finding(WARNING, "action-group", say("the group has no actions"), where)


def _actions(actions: Sequence[Action], config: MissionConfig, where: str, *, is_template: bool) -> Iterator[Finding]:
    seen: set[int] = set()
    for action in actions:
        place = say("{}, action {} ({})", where, action.action_id, action.func)
        if action.action_id is None or action.action_id == UNSET:
            yield Finding(ERROR, "action-id", say("the action has no actionId"), place)
        elif action.action_id in seen:
            # Pilot 2's own templates do this, and it numbers the actions anew when it makes waylines.
            severity = NOTE if is_template else ERROR
            yield Finding(severity, "action-id", say("the actionId occurs twice in its group; number from 0"), place)
        else:
            seen.add(action.action_id)
        yield from _function(action, config, place)


def _function(action: Action, config: MissionConfig, place: str) -> Iterator[Finding]:
    if action.func not in FUNCS:
        text = say(
            "'{}' is no action that DJI documents: plans made of this mission go without it, and an aircraft may "
            "refuse it",
            action.func,
        )
        yield Finding(WARNING, "action-function", text, place)
    if "payloadPositionIndex" in action.params:
        position = action.number("payloadPositionIndex")
        if position not in {position for _, position in config.payloads}:
            text = say("the action is for the camera at position {}, where payloadInfo names none", position)
            yield Finding(ERROR, "payload-position", text, place)
    yield from _angles(action, config, place)
    if action.func == "hover" and not (action.number("hoverTime") or 0.0) > 0.0:
        yield Finding(ERROR, "hover", say("hover needs a hoverTime above 0"), place)
    if action.func == "zoom" and not (action.number("focalLength") or 0.0) > 0.0:
        yield Finding(ERROR, "zoom", say("zoom needs a focalLength above 0"), place)
    if action.func == "startTimeLapse" and not (action.number("minShootInterval") or 0.0) > 0.0:
        yield Finding(
            WARNING, "time-lapse", say("the time-lapse has no interval: how many photos it takes is unknown"), place
        )
    if action.func == "panoShot":
        yield Finding(NOTE, "panorama", say("panoramas are not counted as photos"), place)
    yield from check_lenses(action.params.get("payloadLensIndex", ""), place)


def check_lenses(names: str, place: str) -> Iterator[Finding]:
    """Findings on a list of lens names, as payloadLensIndex and imageFormat have it."""
    known = dji_catalogue().lenses.names
    for name in filter(None, (name.strip() for name in names.split(","))):
        if name not in known:
            hint = say("; DJI spells it 'visable'") if name == "visible" else ""
            yield Finding(
                ERROR, "lens", say("'{}' is not one of the lenses {}", name, glue(", ".join(known), hint)), place
            )


def _angles(action: Action, config: MissionConfig, place: str) -> Iterator[Finding]:
    for name in ("aircraftHeading", "gimbalYawRotateAngle"):
        angle = action.number(name)
        if name in action.params and (angle is None or not math.isfinite(angle)):
            yield Finding(ERROR, "heading", say("{} is '{}', not an angle", name, action.params[name]), place)
        elif name == "aircraftHeading" and angle is not None and not -180.0 <= angle <= 180.0:
            yield Finding(ERROR, "heading", say("aircraftHeading is not in [-180, 180]"), place, angle, 180.0, "deg")
    if action.func == "rotateYaw" and "aircraftHeading" not in action.params:
        yield Finding(ERROR, "heading", say("rotateYaw has no aircraftHeading"), place)
    yield from _pitch(action, config, place)


def _pitch(action: Action, config: MissionConfig, place: str) -> Iterator[Finding]:
    if "gimbalPitchRotateAngle" not in action.params:
        return
    if action.func == "gimbalRotate" and not action.is_on("gimbalPitchRotateEnable"):
        return
    pitch_deg = action.number("gimbalPitchRotateAngle")
    if pitch_deg is None or not -180.0 <= pitch_deg <= 90.0:
        text = say("'{}' is no pitch of any gimbal", action.params["gimbalPitchRotateAngle"])
        yield Finding(ERROR, "gimbal-pitch", text, place)
        return
    if action.params.get("gimbalRotateMode") == "relativeAngle":
        return
    position = action.number("payloadPositionIndex") or 0
    numbers = [number for number, at in config.payloads if at == position]
    payload = dji_catalogue().payload_by_number(numbers[0]) if numbers else None
    if payload is None or payload.gimbal_pitch_deg is None:
        return
    low, high = payload.gimbal_pitch_deg
    if not low - 0.05 <= pitch_deg <= high + 0.05:
        text = say("the camera turns from {:g} to {:g} deg only", low, high)
        limit = low if pitch_deg < low else high
        yield Finding(ERROR, "gimbal-pitch", text, place, pitch_deg, limit, "deg")


# Checks of one wayline's route: coordinates, heights, spacing, speeds, headings and turns.
#
# The limits are DJI's: Cloud API documentation (WPML), reject reasons of the Payload SDK (`dji_error.h`, trajectory
# errors) and the Mobile SDK. Where DJI's own programs write what their documents forbid, the finding is no error.

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


def check_route(folder: Folder, place: str, *, dji_fly: bool) -> Iterator[Finding]:
    """Findings on the route of one wayline."""
    yield from _count(folder, place, dji_fly=dji_fly)
    if folder.height_mode not in HEIGHT_MODES:
        yield Finding(
            ERROR,
            "height-mode",
            say("executeHeightMode is '{}'; aircraft know {}", folder.height_mode, ", ".join(HEIGHT_MODES)),
            place,
        )
    bad_points = [
        f for i, w in enumerate(folder.waypoints) for f in _point(w, folder.height_mode, say("{}waypoint {}", place, i))
    ]
    yield from bad_points
    for i, waypoint in enumerate(folder.waypoints):
        yield from _speed(waypoint.speed_m_s or folder.speed_m_s, say("{}waypoint {}", place, i))
        yield from _heading(waypoint, say("{}waypoint {}", place, i))
    if not any(finding.severity is ERROR for finding in bad_points):
        yield from _legs(folder, place)


def _count(folder: Folder, place: str, *, dji_fly: bool) -> Iterator[Finding]:
    n = len(folder.waypoints)
    limit = MAX_WAYPOINTS_DJI_FLY if dji_fly else MAX_WAYPOINTS
    if n == 0:
        yield Finding(ERROR, "waypoint-count", say("the wayline has no waypoints"), place, 0, 2)
    elif n == 1:
        yield Finding(
            WARNING, "waypoint-count", say("the wayline has one waypoint; most aircraft want two"), place, 1, 2
        )
    elif n > limit:
        severity = WARNING if dji_fly else ERROR
        yield Finding(severity, "waypoint-count", say("the wayline has {} waypoints; split it", n), place, n, limit)
    indices = [waypoint.index for waypoint in folder.waypoints]
    if indices != list(range(n)):
        wrong = next(i for i, index in enumerate(indices) if index != i)
        yield Finding(
            ERROR,
            "waypoint-index",
            say("expected indices 0 to {} in order, found {} in place {}", n - 1, indices[wrong], wrong),
            place,
        )


def _point(waypoint: WpmlWaypoint, height_mode: str, place: str) -> Iterator[Finding]:
    lat, lon, height_m = waypoint.lat_deg, waypoint.lon_deg, waypoint.execute_height_m
    if lat is None or lon is None:
        yield Finding(ERROR, "coordinates", say("the waypoint has no coordinates (longitude,latitude)"), place)
    elif not (math.isfinite(lat) and math.isfinite(lon)) or abs(lat) > 90.0 or abs(lon) > 180.0:
        swapped = abs(lon) <= 90.0 < abs(lat) <= 180.0
        hint = (
            say("latitude and longitude are swapped")
            if swapped
            else say("they look like projected metres, not degrees")
        )
        yield Finding(
            ERROR, "coordinates", say("coordinates {:g},{:g} are not on the globe; {}", lon, lat, hint), place
        )
    elif lat == 0.0 and lon == 0.0:
        yield Finding(ERROR, "coordinates", say("coordinates are 0,0, which means that they were never set"), place)
    if height_m is None or not math.isfinite(height_m):
        yield Finding(ERROR, "height", say("the waypoint has no executeHeight"), place)
    elif height_mode == "relativeToStartPoint":
        if not MIN_HEIGHT_M <= height_m <= MAX_HEIGHT_M:
            limit = MIN_HEIGHT_M if height_m < MIN_HEIGHT_M else MAX_HEIGHT_M
            yield Finding(
                ERROR, "height", say("the height is outside what aircraft accept"), place, height_m, limit, "m"
            )
        elif height_m < LOW_M:
            yield Finding(
                WARNING,
                "height",
                say("the height is close to or below the take-off point; make sure that this is meant"),
                place,
                height_m,
                LOW_M,
                "m",
            )
        elif height_m > LEGAL_CEILING_M:
            text = say("the height is above what the law allows in most countries without a permit")
            yield Finding(WARNING, "height", text, place, height_m, LEGAL_CEILING_M, "m")


def _speed(speed_m_s: float | None, place: str) -> Iterator[Finding]:
    if speed_m_s is None:
        yield Finding(ERROR, "speed", say("neither the waypoint nor the wayline has a speed"), place)
    elif not 0.0 < speed_m_s <= MAX_SPEED_M_S:
        yield Finding(
            ERROR,
            "speed",
            say("the speed must be above 0 and within the format's range"),
            place,
            speed_m_s,
            MAX_SPEED_M_S,
            "m/s",
        )


def _heading(waypoint: WpmlWaypoint, place: str) -> Iterator[Finding]:
    mode, angle = waypoint.heading_mode, waypoint.heading_angle_deg
    if mode not in HEADING_MODES:
        known = ", ".join(HEADING_MODES)
        yield Finding(ERROR, "heading-mode", say("waypointHeadingMode is '{}'; aircraft know {}", mode, known), place)
    if angle is not None and not -180.0 <= angle <= 180.0:
        yield Finding(ERROR, "heading", say("waypointHeadingAngle is not in [-180, 180]"), place, angle, 180.0, "deg")
    if mode == "smoothTransition" and angle is None:
        yield Finding(ERROR, "heading", say("smoothTransition needs a waypointHeadingAngle"), place)
    elif mode == "smoothTransition" and not waypoint.heading_angle_enable:
        yield Finding(
            WARNING,
            "heading",
            say("smoothTransition has waypointHeadingAngleEnable 0, so its angle may be ignored"),
            place,
        )
    if mode == "towardPOI" and waypoint.poi_lat_lon_deg in (None, (0.0, 0.0)):
        yield Finding(ERROR, "heading", say("towardPOI has no waypointPoiPoint to look at"), place)


def _legs(folder: Folder, place: str) -> Iterator[Finding]:
    waypoints = folder.waypoints
    lat, lon = [w.lat_deg or 0.0 for w in waypoints], [w.lon_deg or 0.0 for w in waypoints]
    lengths_m = [float(m) for m in leg_lengths_m(lat, lon, [w.execute_height_m or 0.0 for w in waypoints])]
    for i, (length_m, course) in enumerate(zip(lengths_m, courses_deg(lat, lon), strict=True)):
        leg = say("{}leg {}-{}", place, i, i + 1)
        if length_m > MAX_SPACING_M:
            yield Finding(
                ERROR,
                "spacing",
                say("the leg is longer than aircraft accept; put a waypoint in between"),
                leg,
                length_m,
                MAX_SPACING_M,
                "m",
            )
        elif length_m > LONG_LEG_M:
            yield Finding(WARNING, "spacing", say("the leg is unusually long"), leg, length_m, LONG_LEG_M, "m")
        elif length_m < MIN_SPACING_M:
            # An error by the documents, but FlightHub 2's terrain routes have legs of 0.2 m and are flown.
            yield Finding(
                WARNING,
                "spacing",
                say("the leg is shorter than documented; some aircraft refuse it"),
                leg,
                length_m,
                MIN_SPACING_M,
                "m",
            )
        if course is None and waypoints[i].heading_mode == "followWayline":
            # The Payload SDK has an error for it (TRAJ_INVALID_YAW_MODE_IN_VERT_SEGM), and DJI's programs write it.
            text = say("the leg is vertical, so there is no course to follow: the nose stays as it is")
            yield Finding(NOTE, "vertical-leg", text, leg)
    yield from _turns(waypoints, lengths_m, place)
    yield from _distance(folder, sum(lengths_m), place)


def _turns(waypoints: Sequence[WpmlWaypoint], lengths_m: Sequence[float], place: str) -> Iterator[Finding]:
    n = len(waypoints)
    dampings_m = [w.turn_damping_m or 0.0 if w.turn_mode in PASS_MODES else 0.0 for w in waypoints]
    for i, waypoint in enumerate(waypoints):
        where = say("{}waypoint {}", place, i)
        if waypoint.turn_mode not in (*STOP_MODES, *PASS_MODES):
            yield Finding(ERROR, "turn-mode", say("waypointTurnMode '{}' is not known", waypoint.turn_mode), where)
        elif i in (0, n - 1) and waypoint.turn_mode not in STOP_MODES:
            yield Finding(ERROR, "turn-mode", say("the first and the last waypoint must be of a stopping type"), where)
        elif waypoint.turn_mode in PASS_MODES:
            needs = waypoint.turn_mode == "coordinateTurn" or waypoint.use_straight_line
            if needs and dampings_m[i] <= 0.0:
                yield Finding(
                    ERROR, "turn-damping", say("{} needs a waypointTurnDampingDist", waypoint.turn_mode), where
                )
            yield Finding(
                NOTE, "turn-mode", say("{} cuts the corner: the path is no polyline", waypoint.turn_mode), where
            )
        elif waypoint.turn_damping_m:
            text = say("waypointTurnDampingDist is ignored where the aircraft stops")
            yield Finding(NOTE, "turn-damping", text, where, waypoint.turn_damping_m, 0.0, "m")
    for i, length_m in enumerate(lengths_m):
        turning_m = dampings_m[i] + dampings_m[i + 1]
        if turning_m > 0.0 and turning_m >= length_m:
            text = say("the leg is shorter than the turns at its two ends")
            yield Finding(ERROR, "turn-damping", text, say("{}leg {}-{}", place, i, i + 1), turning_m, length_m, "m")


def _distance(folder: Folder, length_m: float, place: str) -> Iterator[Finding]:
    said_m = folder.distance_m
    if said_m is not None and not abs(said_m - length_m) <= STALE_M + STALE_SHARE * length_m:
        text = say(
            "its distance is {:.1f} m, but its waypoints are {:.1f} m long: was it edited by hand?", said_m, length_m
        )
        yield Finding(WARNING, "stale-distance", text, place, said_m, length_m, "m")


SECURITY_HEIGHT_M = (1.2, 1500.0)
"""Range of takeOffSecurityHeight with a remote controller; docks want 8 m at least."""

SAME_PLACE_M = 0.01
"""Template and waylines agree on a waypoint within this: both hold 9 decimals or more."""


def check_dji(parts: DjiParts) -> tuple[Finding, ...]:
    """All findings on a mission, waylines first; empty places concern the whole."""
    catalogue = dji_catalogue()
    findings = [
        *_document(parts.waylines, "waylines.wpml", catalogue),
        *_waylines(parts.waylines, catalogue),
    ]
    if parts.template is None:
        text = say("there is no template.kml; DJI Pilot 2 and FlightHub 2 do not open the mission without it")
        findings.append(Finding(WARNING, "no-template", text))
    else:
        findings += _takeoff(parts.template.config)
        findings += _template(parts.template)
        findings += _agreement(parts.waylines, parts.template)
    return tuple(findings)


def _document(document: WpmlDocument, part: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    if not document.version.startswith("1.0."):
        yield Finding(ERROR, "version", say("WPML {} is not known; expected 1.0.x", document.version), part)
    for text in document.garbled:
        yield Finding(ERROR, "garbled", say("expected a number: {}", text), part)
    yield from _config(document.config, part, catalogue)


def _config(config: MissionConfig, part: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    if config.fly_to_wayline_mode == "pointToPoint":
        text = say("the aircraft flies slanted to the first waypoint (pointToPoint): check that way for obstacles")
        yield Finding(WARNING, "fly-to-wayline", text, part)
    elif config.fly_to_wayline_mode != "safely":
        text = say("flyToWaylineMode is '{}'; expected safely or pointToPoint", config.fly_to_wayline_mode)
        yield Finding(ERROR, "fly-to-wayline", text, part)
    if config.finish_action == "gotoFirstWaypoint":
        text = say("at the end the aircraft flies straight to the first waypoint: check that way for obstacles")
        yield Finding(WARNING, "finish-action", text, part)
    elif config.finish_action not in ("goHome", "noAction", "autoLand"):
        yield Finding(ERROR, "finish-action", say("finishAction '{}' is not known", config.finish_action), part)
    leaves = config.exit_on_rc_lost == "executeLostAction"
    if leaves and config.rc_lost_action not in ("goBack", "landing", "hover"):
        yield Finding(ERROR, "link-loss", say("executeLostAction needs an executeRCLostAction"), part)
    elif not leaves and config.exit_on_rc_lost != "goContinue":
        yield Finding(ERROR, "link-loss", say("exitOnRCLost '{}' is not known", config.exit_on_rc_lost), part)
    height_m, (low, high) = config.takeoff_security_height_m, SECURITY_HEIGHT_M
    if height_m is None:
        yield Finding(ERROR, "security-height", say("there is no takeOffSecurityHeight"), part)
    elif not low <= height_m <= high:
        limit = low if height_m < low else high
        yield Finding(
            ERROR, "security-height", say("takeOffSecurityHeight is out of range"), part, height_m, limit, "m"
        )
    speed_m_s = config.transitional_speed_m_s
    if speed_m_s is None or not 0.0 < speed_m_s <= MAX_SPEED_M_S:
        text = say("globalTransitionalSpeed must be above 0 and at most {:g} m/s", MAX_SPEED_M_S)
        yield Finding(ERROR, "speed", text, part, speed_m_s, MAX_SPEED_M_S, "m/s")
    if config.rth_height_m is None:
        yield Finding(
            NOTE, "return-height", say("globalRTHHeight is missing: the remote controller's own setting holds"), part
        )
    yield from _aircraft(config, part, catalogue)


def _aircraft(config: MissionConfig, part: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    if config.drone is None or not config.payloads:
        yield Finding(ERROR, "aircraft", say("droneInfo or payloadInfo is missing"), part)
        return
    drone = catalogue.drone_by_numbers(config.drone)
    if drone is None:
        text = say(
            "the aircraft {}-{} is not known here, so its cameras are not checked", config.drone[0], config.drone[1]
        )
        yield Finding(WARNING, "aircraft", text, part)
        return
    fitting = {catalogue.payloads[name].number for name in drone.payloads}
    for number, _ in config.payloads:
        if fitting and number not in fitting:
            text = say(
                "the aircraft {}-{} does not carry the camera {}; expected one of {}",
                config.drone[0],
                config.drone[1],
                number,
                ", ".join(map(str, sorted(fitting))),
            )
            yield Finding(ERROR, "payload", text, part)


def _waylines(document: WpmlDocument, catalogue: DjiCatalogue) -> Iterator[Finding]:
    drone = None if document.config.drone is None else catalogue.drone_by_numbers(document.config.drone)
    dji_fly = drone is not None and drone.dji_fly
    if not document.folders:
        yield Finding(ERROR, "waypoint-count", say("there is no wayline"), "waylines.wpml", 0, 1)
    group_ids: set[int] = set()
    for number, folder in enumerate(document.folders):
        place = "" if len(document.folders) == 1 else say("wayline {}, ", number)
        yield from check_route(folder, place, dji_fly=dji_fly)
        yield from check_actions(folder, document.config, place, is_template=False, ids_before=group_ids)
        yield from _endurance(folder, document.config, place, catalogue)
        if document.version >= "1.0.5" and not all(w.gimbal_heading for w in folder.waypoints):
            yield Finding(NOTE, "gimbal-heading", say("waypointGimbalHeadingParam is missing"), place)


def _endurance(folder: Folder, config: MissionConfig, place: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    """Whether the wayline's own duration, which is optimistic, already exceeds a battery of the aircraft."""
    names = [key for key, p in catalogue.profiles.items() if catalogue.drones[p.drone].numbers == config.drone]
    endurance_s = max((profiles()[name].aircraft.endurance_s for name in names), default=math.inf)
    if folder.duration_s is not None and folder.duration_s > endurance_s:
        text = say("the wayline lasts longer than the aircraft flies on one battery; split it")
        yield Finding(WARNING, "endurance", text, place, folder.duration_s, endurance_s, "s")


def _takeoff(config: MissionConfig) -> Iterator[Finding]:
    reference = config.takeoff_ref_lat_lon_height
    if reference is not None and not is_on_globe(reference):
        text = say("takeOffRefPoint {:g},{:g} is not on the globe and is not used", reference[0], reference[1])
        yield Finding(WARNING, "takeoff-reference", text, "template.kml")


def is_on_globe(reference: tuple[float, float, float]) -> bool:
    """Whether a latitude, longitude and height can be a place."""
    return abs(reference[0]) <= 90.0 and abs(reference[1]) <= 180.0 and math.isfinite(reference[2])


def _template(template: WpmlDocument) -> Iterator[Finding]:
    for text in template.garbled:
        yield Finding(ERROR, "garbled", say("expected a number: {}", text), "template.kml")
    group_ids: set[int] = set()
    for folder in template.folders:
        yield from check_lenses(folder.image_format, "template.kml, imageFormat")
        place = "template.kml, "
        yield from check_actions(folder, template.config, place, is_template=True, ids_before=group_ids)


def _agreement(waylines: WpmlDocument, template: WpmlDocument) -> Iterator[Finding]:
    """Where the two parts contradict each other: a program may use either."""
    if waylines.config.drone != template.config.drone:
        text = say(
            "template and waylines name different aircraft: {}, {}", template.config.drone, waylines.config.drone
        )
        yield Finding(ERROR, "parts-disagree", text)
    if sorted(waylines.config.payloads) != sorted(template.config.payloads):
        yield Finding(ERROR, "parts-disagree", say("template and waylines name different cameras"))
    # Templates of mapping types hold an area, from which the waylines were made.
    if len(waylines.folders) == len(template.folders) == 1 and template.folders[0].template_type == "waypoint":
        yield from _same_route(waylines.folders[0], template.folders[0])


def _same_route(wayline: Folder, template: Folder) -> Iterator[Finding]:
    if len(wayline.waypoints) != len(template.waypoints):
        text = say("the template has {} waypoints, the wayline {}", len(template.waypoints), len(wayline.waypoints))
        yield Finding(ERROR, "parts-disagree", text)
        return
    relative = "relativeToStartPoint"
    if (wayline.height_mode == relative) != (template.height_mode == relative):
        text = say(
            "the template's heights are {}, but the wayline is flown in {}; the wayline counts here, while a "
            "program that starts from the template would fly elsewhere",
            template.height_mode,
            wayline.height_mode,
        )
        yield Finding(WARNING, "parts-disagree", text)
    for i, (flown, planned) in enumerate(zip(wayline.waypoints, template.waypoints, strict=True)):
        if None in (flown.lat_deg, flown.lon_deg, planned.lat_deg, planned.lon_deg):
            continue
        both = (flown.lat_deg, flown.lon_deg, planned.lat_deg, planned.lon_deg)
        if not all(value is not None and math.isfinite(value) and abs(value) <= 180.0 for value in both):
            continue
        away_m = distance_m(*both)  # type: ignore[arg-type]  # none of them is None
        if away_m > SAME_PLACE_M:
            text = say("template and wayline put the waypoint in different places")
            yield Finding(ERROR, "parts-disagree", text, say("waypoint {}", i), away_m, SAME_PLACE_M, "m")
