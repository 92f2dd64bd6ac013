"""What the aircraft does at a waypoint: the action group that turns, tilts, settles and takes each of its photos."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from missions.dji.catalogue import DjiProfile
from missions.dji.xml_text import Node, number
from missions.model import Photo
from planning.frames import wrap_heading_deg
from planning.plan import ANGLE_DECIMALS

_NOT_IN_FILE_NAMES = re.compile(r"[^\w-]")

_POSITION: Node = ("payloadPositionIndex", "0")

_CENTRE_FOCUS: list[Node] = [
    ("focusX", "0.25"),
    ("focusY", "0.25"),
    ("focusRegionWidth", "0.5"),
    ("focusRegionHeight", "0.5"),
    ("isPointFocus", "0"),
    ("isInfiniteFocus", "0"),
    _POSITION,
]
"""Autofocus on the middle half of the picture, as Pilot 2 and FlightHub 2 write it."""


def photo_group(
    group_id: int,
    waypoint_index: int,
    photos: Sequence[Photo],
    nose_deg: float | None,
    profile: DjiProfile,
    settle_s: float,
    *,
    is_template: bool,
) -> Node:
    """The actionGroup of one waypoint.

    Parameters
    ----------
    nose_deg
        Heading of the aircraft before it; None where that is not known.
    is_template
        Templates name neither focus nor lens: Pilot 2 and FlightHub 2 add them when they make waylines.
    """
    actions: list[list[Node]] = []
    for photo in photos:
        turn_deg = 0.0 if nose_deg is None else wrap_heading_deg(photo.heading_deg - nose_deg)
        actions += _photo_actions(photo, turn_deg, profile, settle_s, is_template=is_template)
        nose_deg = photo.heading_deg
    return (
        "actionGroup",
        [
            ("actionGroupId", str(group_id)),
            ("actionGroupStartIndex", str(waypoint_index)),
            ("actionGroupEndIndex", str(waypoint_index)),
            ("actionGroupMode", "sequence"),
            ("actionTrigger", [("actionTriggerType", "reachPoint")]),
            *(("action", [("actionId", str(i)), *action]) for i, action in enumerate(actions)),
        ],
    )


def _photo_actions(
    photo: Photo, turn_deg: float, profile: DjiProfile, settle_s: float, *, is_template: bool
) -> Iterator[list[Node]]:
    path_mode = "clockwise" if turn_deg >= 0 else "counterClockwise"
    yield _action(
        "rotateYaw", [("aircraftHeading", number(photo.heading_deg, ANGLE_DECIMALS)), ("aircraftPathMode", path_mode)]
    )
    yield _action("gimbalRotate", _gimbal_pitch(photo.gimbal_pitch_deg))
    if profile.wide_zoom_mm > 0:
        zoom = number(profile.wide_zoom_mm, 1)
        yield _action("zoom", [("focalLength", zoom), ("isUseFocalFactor", "0"), _POSITION])
    if profile.focus and not is_template:
        yield _action("focus", _CENTRE_FOCUS)
    if settle_s > 0:
        yield _action("hover", [("hoverTime", number(settle_s, 2))])
    # The suffix goes into the names of the photos, so that each can be found by its viewpoint afterwards.
    suffix: Node = ("fileSuffix", _NOT_IN_FILE_NAMES.sub("_", photo.viewpoint_id))
    photo_params: list[Node] = [suffix, _POSITION, ("useGlobalPayloadLensIndex", "1")]
    yield _action("takePhoto", photo_params if is_template else [*photo_params, ("payloadLensIndex", profile.lens)])


def _action(func: str, params: Sequence[Node]) -> list[Node]:
    return [("actionActuatorFunc", func), ("actionActuatorFuncParam", params)]


def _gimbal_pitch(pitch_deg: float) -> list[Node]:
    """Pitch only, in the frame of the horizon: the aircraft's heading aims the camera sideways."""
    return [
        ("gimbalHeadingYawBase", "north"),
        ("gimbalRotateMode", "absoluteAngle"),
        ("gimbalPitchRotateEnable", "1"),
        ("gimbalPitchRotateAngle", number(pitch_deg, ANGLE_DECIMALS)),
        ("gimbalRollRotateEnable", "0"),
        ("gimbalRollRotateAngle", "0"),
        ("gimbalYawRotateEnable", "0"),
        ("gimbalYawRotateAngle", "0"),
        ("gimbalRotateTimeEnable", "0"),
        ("gimbalRotateTime", "0"),
        _POSITION,
    ]
