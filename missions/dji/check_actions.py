"""Checks of one wayline's actions: groups, triggers, and the parameters that aim and release the camera.

The limits are DJI's: Cloud API documentation (WPML common elements) and the reject reasons of the Payload SDK.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from missions.dji.catalogue import dji_catalogue
from missions.dji.wpml import Action, ActionGroup, Folder, MissionConfig
from planning.findings import Finding, Severity

UNSET = 65535
"""What DJI's programs put where nothing was set; as an id or index it is refused (Mobile SDK issue 408)."""

TRIGGERS = ("reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance")

FUNCS = (
    "takePhoto", "startRecord", "stopRecord", "focus", "zoom", "customDirName", "gimbalRotate", "rotateYaw", "hover",
    "gimbalEvenlyRotate", "accurateShoot", "orientedShoot", "panoShot", "recordPointCloud", "setFocusType",
    "startTimeLapse", "stopTimeLapse", "megaphone", "searchlight",
)  # fmt: skip

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


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
    yield from _actions(folder.start_actions, config, f"{place}start actions", is_template=is_template)
    n, ids = len(folder.waypoints), set[int]()
    for i, waypoint in enumerate(folder.waypoints):
        for group in waypoint.groups:
            where = f"{place}waypoint {i}, group {group.group_id}"
            yield from _group(group, n, where)
            yield from _actions(group.actions, config, where, is_template=is_template)
            if group.group_id in ids:
                text = "the actionGroupId occurs twice in one wayline; number the groups from 0"
                yield Finding(ERROR, "action-group-id", text, where)
            elif group.group_id in ids_before:
                yield Finding(NOTE, "action-group-id", "the actionGroupId occurs in an earlier wayline, too", where)
            ids |= set() if group.group_id is None else {group.group_id}
    ids_before |= ids


def _group(group: ActionGroup, n_waypoints: int, where: str) -> Iterator[Finding]:
    start, end = group.start_index, group.end_index
    if group.group_id is None or start is None or end is None:
        yield Finding(
            ERROR, "action-group", "the group lacks its id, actionGroupStartIndex or actionGroupEndIndex", where
        )
    elif UNSET in (group.group_id, start, end):
        yield Finding(ERROR, "action-group", "the group has an id or index of 65535, which means unset", where)
    elif not 0 <= start <= end < n_waypoints:
        text = f"the group acts from waypoint {start} to {end}, but there are waypoints 0 to {n_waypoints - 1} only"
        yield Finding(ERROR, "action-group", text, where)
    if group.trigger not in TRIGGERS:
        known = ", ".join(TRIGGERS)
        yield Finding(ERROR, "action-trigger", f"the trigger '{group.trigger}' is not one of {known}", where)
    elif group.trigger.startswith("multiple") and not (group.trigger_param or 0.0) > 0.0:
        yield Finding(ERROR, "action-trigger", f"{group.trigger} needs an actionTriggerParam above 0", where)
    elif group.trigger.startswith("multiple") and start == end:
        text = "a trigger by time or distance that ends where it begins covers no leg; its photos are not counted"
        yield Finding(WARNING, "action-trigger", text, where)
    elif group.trigger == "reachPoint" and start != end:
        yield Finding(WARNING, "action-trigger", "a reachPoint group should act at one waypoint only", where)
    if not group.actions:
        yield Finding(WARNING, "action-group", "the group has no actions", where)


def _actions(actions: Sequence[Action], config: MissionConfig, where: str, *, is_template: bool) -> Iterator[Finding]:
    seen: set[int] = set()
    for action in actions:
        place = f"{where}, action {action.action_id} ({action.func})"
        if action.action_id is None or action.action_id == UNSET:
            yield Finding(ERROR, "action-id", "the action has no actionId", place)
        elif action.action_id in seen:
            # Pilot 2's own templates do this, and it numbers the actions anew when it makes waylines.
            severity = NOTE if is_template else ERROR
            yield Finding(severity, "action-id", "the actionId occurs twice in its group; number from 0", place)
        else:
            seen.add(action.action_id)
        yield from _function(action, config, place)


def _function(action: Action, config: MissionConfig, place: str) -> Iterator[Finding]:
    if action.func not in FUNCS:
        yield Finding(WARNING, "action-function", f"'{action.func}' is not a documented action", place)
    if "payloadPositionIndex" in action.params:
        position = action.number("payloadPositionIndex")
        if position not in {position for _, position in config.payloads}:
            text = f"the action is for the camera at position {position}, where payloadInfo names none"
            yield Finding(ERROR, "payload-position", text, place)
    yield from _angles(action, config, place)
    if action.func == "hover" and not (action.number("hoverTime") or 0.0) > 0.0:
        yield Finding(ERROR, "hover", "hover needs a hoverTime above 0", place)
    if action.func == "zoom" and not (action.number("focalLength") or 0.0) > 0.0:
        yield Finding(ERROR, "zoom", "zoom needs a focalLength above 0", place)
    if action.func == "startTimeLapse" and not (action.number("minShootInterval") or 0.0) > 0.0:
        yield Finding(
            WARNING, "time-lapse", "the time-lapse has no interval: how many photos it takes is unknown", place
        )
    if action.func == "panoShot":
        yield Finding(NOTE, "panorama", "panoramas are not counted as photos", place)
    yield from check_lenses(action.params.get("payloadLensIndex", ""), place)


def check_lenses(names: str, place: str) -> Iterator[Finding]:
    """Findings on a list of lens names, as payloadLensIndex and imageFormat have it."""
    known = dji_catalogue().lenses.names
    for name in filter(None, (name.strip() for name in names.split(","))):
        if name not in known:
            hint = "; DJI spells it 'visable'" if name == "visible" else ""
            yield Finding(ERROR, "lens", f"'{name}' is not one of the lenses {', '.join(known)}{hint}", place)


def _angles(action: Action, config: MissionConfig, place: str) -> Iterator[Finding]:
    for name in ("aircraftHeading", "gimbalYawRotateAngle"):
        angle = action.number(name)
        if name in action.params and (angle is None or not math.isfinite(angle)):
            yield Finding(ERROR, "heading", f"{name} is '{action.params[name]}', not an angle", place)
        elif name == "aircraftHeading" and angle is not None and not -180.0 <= angle <= 180.0:
            yield Finding(ERROR, "heading", "aircraftHeading is not in [-180, 180]", place, angle, 180.0, "deg")
    if action.func == "rotateYaw" and "aircraftHeading" not in action.params:
        yield Finding(ERROR, "heading", "rotateYaw has no aircraftHeading", place)
    yield from _pitch(action, config, place)


def _pitch(action: Action, config: MissionConfig, place: str) -> Iterator[Finding]:
    if "gimbalPitchRotateAngle" not in action.params:
        return
    if action.func == "gimbalRotate" and not action.is_on("gimbalPitchRotateEnable"):
        return
    pitch_deg = action.number("gimbalPitchRotateAngle")
    if pitch_deg is None or not -180.0 <= pitch_deg <= 90.0:
        text = f"'{action.params['gimbalPitchRotateAngle']}' is no pitch of any gimbal"
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
        text = f"the camera turns from {low:g} to {high:g} deg only"
        limit = low if pitch_deg < low else high
        yield Finding(ERROR, "gimbal-pitch", text, place, pitch_deg, limit, "deg")
