"""All checks of a DJI mission: every finding, with the severity that files written by DJI's own programs allow.

A file that Pilot 2 or FlightHub 2 wrote has no error; a file with an error is refused by an aircraft or a program.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from missions.dji.catalogue import DjiCatalogue, dji_catalogue
from missions.dji.check_actions import check_actions, check_lenses
from missions.dji.check_route import MAX_SPEED_M_S, check_route
from missions.dji.container import DjiParts
from missions.dji.wpml import Folder, MissionConfig, WpmlDocument
from missions.legs import distance_m
from planning.catalogue import profiles
from planning.findings import Finding, Severity

SECURITY_HEIGHT_M = (1.2, 1500.0)
"""Range of takeOffSecurityHeight with a remote controller; docks want 8 m at least."""

SAME_PLACE_M = 0.01
"""Template and waylines agree on a waypoint within this: both hold 9 decimals or more."""

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


def check_dji(parts: DjiParts) -> tuple[Finding, ...]:
    """All findings on a mission, waylines first; empty places concern the whole."""
    catalogue = dji_catalogue()
    findings = [
        *_document(parts.waylines, "waylines.wpml", catalogue),
        *_waylines(parts.waylines, catalogue),
    ]
    if parts.template is None:
        text = "there is no template.kml; DJI Pilot 2 and FlightHub 2 do not open the mission without it"
        findings.append(Finding(WARNING, "no-template", text))
    else:
        findings += _takeoff(parts.template.config)
        findings += _template(parts.template)
        findings += _agreement(parts.waylines, parts.template)
    return tuple(findings)


def _document(document: WpmlDocument, part: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    if not document.version.startswith("1.0."):
        yield Finding(ERROR, "version", f"WPML {document.version} is not known; expected 1.0.x", part)
    for text in document.garbled:
        yield Finding(ERROR, "garbled", f"expected a number: {text}", part)
    yield from _config(document.config, part, catalogue)


def _config(config: MissionConfig, part: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    if config.fly_to_wayline_mode == "pointToPoint":
        text = "the aircraft flies slanted to the first waypoint (pointToPoint): check that way for obstacles"
        yield Finding(WARNING, "fly-to-wayline", text, part)
    elif config.fly_to_wayline_mode != "safely":
        text = f"flyToWaylineMode is '{config.fly_to_wayline_mode}'; expected safely or pointToPoint"
        yield Finding(ERROR, "fly-to-wayline", text, part)
    if config.finish_action == "gotoFirstWaypoint":
        text = "at the end the aircraft flies straight to the first waypoint: check that way for obstacles"
        yield Finding(WARNING, "finish-action", text, part)
    elif config.finish_action not in ("goHome", "noAction", "autoLand"):
        yield Finding(ERROR, "finish-action", f"finishAction '{config.finish_action}' is not known", part)
    leaves = config.exit_on_rc_lost == "executeLostAction"
    if leaves and config.rc_lost_action not in ("goBack", "landing", "hover"):
        yield Finding(ERROR, "link-loss", "executeLostAction needs an executeRCLostAction", part)
    elif not leaves and config.exit_on_rc_lost != "goContinue":
        yield Finding(ERROR, "link-loss", f"exitOnRCLost '{config.exit_on_rc_lost}' is not known", part)
    height_m, (low, high) = config.takeoff_security_height_m, SECURITY_HEIGHT_M
    if height_m is None:
        yield Finding(ERROR, "security-height", "there is no takeOffSecurityHeight", part)
    elif not low <= height_m <= high:
        limit = low if height_m < low else high
        yield Finding(ERROR, "security-height", "takeOffSecurityHeight is out of range", part, height_m, limit, "m")
    speed_m_s = config.transitional_speed_m_s
    if speed_m_s is None or not 0.0 < speed_m_s <= MAX_SPEED_M_S:
        text = f"globalTransitionalSpeed must be above 0 and at most {MAX_SPEED_M_S:g} m/s"
        yield Finding(ERROR, "speed", text, part, speed_m_s, MAX_SPEED_M_S, "m/s")
    if config.rth_height_m is None:
        yield Finding(
            NOTE, "return-height", "globalRTHHeight is missing: the remote controller's own setting holds", part
        )
    yield from _aircraft(config, part, catalogue)


def _aircraft(config: MissionConfig, part: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    if config.drone is None or not config.payloads:
        yield Finding(ERROR, "aircraft", "droneInfo or payloadInfo is missing", part)
        return
    drone = catalogue.drone_by_numbers(config.drone)
    if drone is None:
        text = f"the aircraft {config.drone[0]}-{config.drone[1]} is not known here, so its cameras are not checked"
        yield Finding(WARNING, "aircraft", text, part)
        return
    fitting = {catalogue.payloads[name].number for name in drone.payloads}
    for number, _ in config.payloads:
        if fitting and number not in fitting:
            text = (
                f"the aircraft {config.drone[0]}-{config.drone[1]} does not carry the camera {number}; expected one of "
                f"{', '.join(map(str, sorted(fitting)))}"
            )
            yield Finding(ERROR, "payload", text, part)


def _waylines(document: WpmlDocument, catalogue: DjiCatalogue) -> Iterator[Finding]:
    drone = None if document.config.drone is None else catalogue.drone_by_numbers(document.config.drone)
    dji_fly = drone is not None and drone.dji_fly
    if not document.folders:
        yield Finding(ERROR, "waypoint-count", "there is no wayline", "waylines.wpml", 0, 1)
    group_ids: set[int] = set()
    for number, folder in enumerate(document.folders):
        place = "" if len(document.folders) == 1 else f"wayline {number}, "
        yield from check_route(folder, place, dji_fly=dji_fly)
        yield from check_actions(folder, document.config, place, is_template=False, ids_before=group_ids)
        yield from _endurance(folder, document.config, place, catalogue)
        if document.version >= "1.0.5" and not all(w.gimbal_heading for w in folder.waypoints):
            yield Finding(NOTE, "gimbal-heading", "waypointGimbalHeadingParam is missing", place)


def _endurance(folder: Folder, config: MissionConfig, place: str, catalogue: DjiCatalogue) -> Iterator[Finding]:
    """Whether the wayline's own duration, which is optimistic, already exceeds a battery of the aircraft."""
    names = [key for key, p in catalogue.profiles.items() if catalogue.drones[p.drone].numbers == config.drone]
    endurance_s = max((profiles()[name].aircraft.endurance_s for name in names), default=math.inf)
    if folder.duration_s is not None and folder.duration_s > endurance_s:
        text = "the wayline lasts longer than the aircraft flies on one battery; split it"
        yield Finding(WARNING, "endurance", text, place, folder.duration_s, endurance_s, "s")


def _takeoff(config: MissionConfig) -> Iterator[Finding]:
    reference = config.takeoff_ref_lat_lon_height
    if reference is not None and not is_on_globe(reference):
        text = f"takeOffRefPoint {reference[0]:g},{reference[1]:g} is not on the globe and is not used"
        yield Finding(WARNING, "takeoff-reference", text, "template.kml")


def is_on_globe(reference: tuple[float, float, float]) -> bool:
    """Whether a latitude, longitude and height can be a place."""
    return abs(reference[0]) <= 90.0 and abs(reference[1]) <= 180.0 and math.isfinite(reference[2])


def _template(template: WpmlDocument) -> Iterator[Finding]:
    for text in template.garbled:
        yield Finding(ERROR, "garbled", f"expected a number: {text}", "template.kml")
    group_ids: set[int] = set()
    for folder in template.folders:
        yield from check_lenses(folder.image_format, "template.kml, imageFormat")
        place = "template.kml, "
        yield from check_actions(folder, template.config, place, is_template=True, ids_before=group_ids)


def _agreement(waylines: WpmlDocument, template: WpmlDocument) -> Iterator[Finding]:
    """Where the two parts contradict each other: a program may use either."""
    if waylines.config.drone != template.config.drone:
        text = f"template and waylines name different aircraft: {template.config.drone}, {waylines.config.drone}"
        yield Finding(ERROR, "parts-disagree", text)
    if sorted(waylines.config.payloads) != sorted(template.config.payloads):
        yield Finding(ERROR, "parts-disagree", "template and waylines name different cameras")
    # Templates of mapping types hold an area, from which the waylines were made.
    if len(waylines.folders) == len(template.folders) == 1 and template.folders[0].template_type == "waypoint":
        yield from _same_route(waylines.folders[0], template.folders[0])


def _same_route(wayline: Folder, template: Folder) -> Iterator[Finding]:
    if len(wayline.waypoints) != len(template.waypoints):
        text = f"the template has {len(template.waypoints)} waypoints, the wayline {len(wayline.waypoints)}"
        yield Finding(ERROR, "parts-disagree", text)
        return
    relative = "relativeToStartPoint"
    if (wayline.height_mode == relative) != (template.height_mode == relative):
        text = (
            f"the template's heights are {template.height_mode}, but the wayline is flown in {wayline.height_mode}; "
            "the wayline counts here, while a program that starts from the template would fly elsewhere"
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
            text = "template and wayline put the waypoint in different places"
            yield Finding(ERROR, "parts-disagree", text, f"waypoint {i}", away_m, SAME_PLACE_M, "m")
