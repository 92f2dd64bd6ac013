"""A mission as DJI's KMZ: template.kml and waylines.wpml that agree, in the element order of DJI's own files.

Every waypoint stops (`toPointAndStopWithDiscontinuityCurvature`) and every leg is straight, because only then is the
flown path the checked polyline. At each view one action group turns the aircraft, tilts the gimbal, waits until both
have settled and takes the photo. Between views the nose stays where it is (`fixed`) or, where the plan turns in flight,
moves on to the next heading (`smoothTransition`); it never swings to the course and back.
"""

from __future__ import annotations

import io
import itertools
import math
import re
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

from missions.dji.wpml import DjiCatalogue, DjiProfile, dji_catalogue, dji_profile
from missions.mission.export_choices import HIGHEST_RETURN_M, LOWEST_RETURN_M, HeightReference, LinkLoss
from missions.mission.model import GeoPoint, Mission, Photo, Waypoint, altitude_amsl_m, leg_lengths_m
from planning.geo.frames import wrap_heading_deg
from planning.parameters import FocusMode
from planning.plan import ANGLE_DECIMALS
from planning.site.records import MIN_HEIGHT_ABOVE_GROUND_M

VERSION = "1.0.6"
"""Of all files that Pilot 2 and FlightHub 2 have written since 2024."""

Node = tuple[str, "str | Sequence[Node]"]
"""An element: its name without the wpml prefix, and its text or its children."""

_PLAIN_KML = {"Document", "Folder", "Placemark", "Point", "coordinates"}


def render(document: Node) -> str:
    """A whole file around its Document element."""
    namespaces = f'xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/{VERSION}"'
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<kml {namespaces}>", *_lines(document, "  "), "</kml>", ""]
    return "\n".join(lines)


def _lines(node: Node, indent: str) -> Iterator[str]:
    name, content = node
    tag = name if name in _PLAIN_KML else f"wpml:{name}"
    if isinstance(content, str):
        yield f"{indent}<{tag}>{escape(content)}</{tag}>"
        return
    yield f"{indent}<{tag}>"
    for child in content:
        yield from _lines(child, indent + "  ")
    yield f"{indent}</{tag}>"


def number(value: float, decimals: int) -> str:
    """A number with at most `decimals` decimals and nothing superfluous, never "-0"."""
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


# What the aircraft does at a waypoint: the action group that turns, tilts, settles and takes each of its photos.

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

_INFINITE_FOCUS: list[Node] = [
    *((name, "0") for name in ("focusX", "focusY", "focusRegionWidth", "focusRegionHeight", "isPointFocus")),
    ("isInfiniteFocus", "1"),
    _POSITION,
]

_HELD_FOCUS: list[Node] = [("cameraFocusType", "manual"), _POSITION]
"""From here on nothing focuses any more. FlightHub 2 writes it into facade routes, before the focus at infinity."""


def photo_group(
    group_id: int,
    waypoint_index: int,
    photos: Sequence[Photo],
    nose_deg: float | None,
    profile: DjiProfile,
    settle_s: float,
    *,
    is_template: bool,
    focus: FocusMode = "auto",
    is_first: bool = False,
) -> Node:
    """The actionGroup of one waypoint.

    Parameters
    ----------
    nose_deg
        Heading of the aircraft before it; None where that is not known.
    is_template
        Templates name neither focus nor lens: Pilot 2 and FlightHub 2 add them when they make waylines.
    focus, is_first
        How the camera focuses, and whether the first of the photos is that of the mission, where a focus is set that
        is held.
    """
    actions: list[list[Node]] = []
    for photo in photos:
        turn_deg = 0.0 if nose_deg is None else wrap_heading_deg(photo.heading_deg - nose_deg)
        focusing = [] if is_template else _focus_actions(profile, focus, is_first=is_first)
        actions += _photo_actions(photo, turn_deg, profile, settle_s, focusing, is_template=is_template)
        nose_deg, is_first = photo.heading_deg, False
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


def _focus_actions(profile: DjiProfile, focus: FocusMode, *, is_first: bool) -> list[list[Node]]:
    """What focuses before a photo; nothing where the camera takes no such actions."""
    hold, automatic = _action("setFocusType", _HELD_FOCUS), _action("focus", _CENTRE_FOCUS)
    if not profile.focus or not (is_first or focus == "auto"):
        return []
    if focus == "infinity":
        return [hold, *([_action("focus", _INFINITE_FOCUS)] if profile.infinity else [])]
    return {"auto": [automatic], "lock": [automatic, hold], "distance": [hold]}[focus]


def _photo_actions(
    photo: Photo,
    turn_deg: float,
    profile: DjiProfile,
    settle_s: float,
    focusing: list[list[Node]],
    *,
    is_template: bool,
) -> Iterator[list[Node]]:
    path_mode = "clockwise" if turn_deg >= 0 else "counterClockwise"
    yield _action(
        "rotateYaw", [("aircraftHeading", number(photo.heading_deg, ANGLE_DECIMALS)), ("aircraftPathMode", path_mode)]
    )
    yield _action("gimbalRotate", _gimbal_pitch(photo.gimbal_pitch_deg))
    if profile.wide_zoom_mm > 0:
        zoom = number(profile.wide_zoom_mm, 1)
        yield _action("zoom", [("focalLength", zoom), ("isUseFocalFactor", "0"), _POSITION])
    yield from focusing
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


MAX_SPEED_M_S = 15.0
"""Highest autoFlightSpeed and globalTransitionalSpeed of the format."""

STOP_MODE = "toPointAndStopWithDiscontinuityCurvature"


@dataclass(frozen=True, slots=True)
class DjiOptions:
    """What a pilot may choose.

    Parameters
    ----------
    rth_height_m
        Height above take-off at which the aircraft returns when it leaves the mission (low battery, the return button,
        `LinkLoss.GO_HOME`); it must clear everything on the site. From `LOWEST_RETURN_M` to `HIGHEST_RETURN_M`.
    created_ms
        Time of writing, milliseconds since 1970 UTC, for createTime and updateTime.
    """

    rth_height_m: float
    created_ms: int
    height_reference: HeightReference = HeightReference.ABOVE_TAKEOFF
    link_loss: LinkLoss = LinkLoss.CONTINUE
    security_height_m: float = MIN_HEIGHT_ABOVE_GROUND_M

    def __post_init__(self) -> None:
        if not LOWEST_RETURN_M <= self.rth_height_m <= HIGHEST_RETURN_M:
            raise ValueError(
                f"rth_height_m: expected {LOWEST_RETURN_M:g} to {HIGHEST_RETURN_M:g} m, got {self.rth_height_m:g}"
            )


def kmz_bytes(mission: Mission, options: DjiOptions) -> bytes:
    """A mission as KMZ; the same mission and options give the same bytes.

    Raises
    ------
    MissionError
        The mission's profile is none of DJI's aircraft.
    """
    writer = _Writer(mission, options, dji_profile(mission.profile), dji_catalogue())
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, document in (("template.kml", writer.template()), ("waylines.wpml", writer.waylines())):
            member = zipfile.ZipInfo(f"wpmz/{name}", date_time=(1980, 1, 1, 0, 0, 0))
            member.compress_type, member.create_system, member.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            archive.writestr(member, render(document))
    return content.getvalue()


@dataclass(frozen=True, slots=True)
class _Writer:
    mission: Mission
    options: DjiOptions
    profile: DjiProfile
    catalogue: DjiCatalogue

    @property
    def speed(self) -> str:
        return number(min(self.mission.speed_m_s, MAX_SPEED_M_S), 2)

    @property
    def is_relative(self) -> bool:
        return self.options.height_reference is HeightReference.ABOVE_TAKEOFF

    def template(self) -> Node:
        time = str(self.options.created_ms)
        times: list[Node] = [("author", "Reflight"), ("createTime", time), ("updateTime", time)]
        mode = "relativeToStartPoint" if self.is_relative else "EGM96"
        folder: list[Node] = [
            ("templateType", "waypoint"),
            ("templateId", "0"),
            ("waylineCoordinateSysParam", [("coordinateMode", "WGS84"), ("heightMode", mode)]),
            ("autoFlightSpeed", self.speed),
            ("globalHeight", self.template_heights(self.mission.waypoints[0].position)[1]),
            ("caliFlightEnable", "0"),
            ("gimbalPitchMode", "manual"),
            ("globalWaypointHeadingParam", _heading_param("fixed", 0.0, None)),
            ("globalWaypointTurnMode", STOP_MODE),
            ("globalUseStraightLine", "1"),
            *(("Placemark", placemark) for placemark in self.placemarks(is_template=True)),
            ("payloadParam", self.payload_param()),
        ]
        config: list[Node] = [*times, ("missionConfig", self.config(is_template=True)), ("Folder", folder)]
        return ("Document", config)

    def waylines(self) -> Node:
        points = [waypoint.position for waypoint in self.mission.waypoints]
        legs_m = leg_lengths_m(
            [p.lat_deg for p in points], [p.lon_deg for p in points], [p.height_ellipsoid_m for p in points]
        )
        folder: list[Node] = [
            ("templateId", "0"),
            ("executeHeightMode", "relativeToStartPoint" if self.is_relative else "WGS84"),
            ("waylineId", "0"),
            ("distance", number(float(legs_m.sum()), 3)),
            ("duration", number(self.mission.duration_s, 3)),
            ("autoFlightSpeed", self.speed),
            *(("Placemark", placemark) for placemark in self.placemarks(is_template=False)),
        ]
        return ("Document", [("missionConfig", self.config(is_template=False)), ("Folder", folder)])

    def config(self, *, is_template: bool) -> list[Node]:
        mission, home = self.mission, self.mission.takeoff
        drone = self.catalogue.drones[self.profile.drone].numbers
        payload = self.catalogue.payloads[self.profile.payload].number
        stays = self.options.link_loss is LinkLoss.CONTINUE
        # As high as the first waypoint, which is straight above home, and not higher (rounded down), unless that is too
        # low to fly sideways.
        first_m = mission.height_above_takeoff_m(mission.waypoints[0].position)
        climb_m = max(math.floor(first_m * 10.0), math.ceil(self.options.security_height_m * 10.0 - 1e-6)) / 10.0
        reference: list[Node] = [
            ("takeOffRefPoint", f"{home.lat_deg:.6f},{home.lon_deg:.6f},{home.height_ellipsoid_m:.6f}"),
            ("takeOffRefPointAGLHeight", "0"),
        ]
        return [
            ("flyToWaylineMode", "safely"),
            ("finishAction", "goHome"),
            ("exitOnRCLost", "goContinue" if stays else "executeLostAction"),
            ("executeRCLostAction", "goBack"),
            ("takeOffSecurityHeight", number(climb_m, 1)),
            *(reference if is_template else []),
            ("globalTransitionalSpeed", self.speed),
            ("globalRTHHeight", number(self.options.rth_height_m, 1)),
            ("droneInfo", [("droneEnumValue", str(drone[0])), ("droneSubEnumValue", str(drone[1]))]),
            ("waylineAvoidLimitAreaMode", "0"),
            (
                "payloadInfo",
                [("payloadEnumValue", str(payload)), ("payloadSubEnumValue", "0"), ("payloadPositionIndex", "0")],
            ),
        ]

    def payload_param(self) -> list[Node]:
        return [
            ("payloadPositionIndex", "0"),
            ("focusMode", "firstPoint" if self.mission.camera_settings.focus in ("auto", "lock") else "custom"),
            ("meteringMode", "average"),
            ("imageFormat", self.profile.lens),
        ]

    def template_heights(self, point: GeoPoint) -> tuple[str, str]:
        """Ellipsoid height and height of a template; where the mission is relative DJI writes that into both."""
        if self.is_relative:
            relative = number(self.mission.height_above_takeoff_m(point), 4)
            return relative, relative
        return number(point.height_ellipsoid_m, 4), number(altitude_amsl_m(point), 4)

    def placemarks(self, *, is_template: bool) -> Iterator[list[Node]]:
        headings = _headings_at(self.mission.waypoints) if self.mission.rules.turn_in_flight else None
        group_ids = itertools.count()
        nose_deg: float | None = None
        is_first = True
        for index, waypoint in enumerate(self.mission.waypoints):
            mode, angle_deg = ("fixed", 0.0) if headings is None else ("smoothTransition", headings[index])
            enable = None if is_template else headings is not None
            heading: Node = ("waypointHeadingParam", _heading_param(mode, angle_deg, enable))
            groups: list[Node] = []
            if waypoint.photos:
                args = (next(group_ids), index, waypoint.photos, nose_deg, self.profile, self.mission.rules.settle_s)
                focus = self.mission.camera_settings.focus
                groups = [photo_group(*args, is_template=is_template, focus=focus, is_first=is_first)]
                nose_deg, is_first = waypoint.photos[-1].heading_deg, False
            place: list[Node] = [("Point", [("coordinates", _lon_lat(waypoint.position))]), ("index", str(index))]
            if is_template:
                ellipsoid, height = self.template_heights(waypoint.position)
                yield [
                    *place,
                    ("ellipsoidHeight", ellipsoid),
                    ("height", height),
                    heading,
                    *((f"useGlobal{what}", value) for what, value in _USE_GLOBAL),
                    ("useStraightLine", "1"),
                    *groups,
                    ("isRisky", "0"),
                ]
            else:
                height_m = waypoint.position.height_ellipsoid_m
                if self.is_relative:
                    height_m = self.mission.height_above_takeoff_m(waypoint.position)
                yield [
                    *place,
                    ("executeHeight", number(height_m, 4)),
                    ("waypointSpeed", self.speed),
                    heading,
                    ("waypointTurnParam", [("waypointTurnMode", STOP_MODE), ("waypointTurnDampingDist", "0")]),
                    ("useStraightLine", "1"),
                    *groups,
                    (
                        "waypointGimbalHeadingParam",
                        [("waypointGimbalPitchAngle", "0"), ("waypointGimbalYawAngle", "0")],
                    ),
                    ("isRisky", "0"),
                    ("waypointWorkType", "0"),
                ]


_USE_GLOBAL = (("Height", "0"), ("Speed", "1"), ("HeadingParam", "0"), ("TurnParam", "1"))


def _lon_lat(point: GeoPoint) -> str:
    return f"{number(point.lon_deg, 10)},{number(point.lat_deg, 10)}"


def _headings_at(waypoints: Sequence[Waypoint]) -> list[float]:
    """Heading with which each waypoint is reached: that of its photo, and before a photo that of the next one."""
    headings: list[float] = []
    ahead: float | None = None
    for waypoint in reversed(waypoints):
        if waypoint.photos:
            ahead = waypoint.photos[0].heading_deg
        headings.append(math.nan if ahead is None else ahead)
    headings.reverse()
    last = next((w.photos[-1].heading_deg for w in reversed(waypoints) if w.photos), 0.0)
    return [last if math.isnan(heading) else heading for heading in headings]


def _heading_param(mode: str, angle_deg: float, enable: bool | None) -> list[Node]:
    """Heading of a waypoint; templates have no waypointHeadingAngleEnable (`enable` None)."""
    return [
        ("waypointHeadingMode", mode),
        ("waypointHeadingAngle", number(angle_deg, ANGLE_DECIMALS)),
        ("waypointPoiPoint", "0.000000,0.000000,0.000000"),
        *([] if enable is None else [("waypointHeadingAngleEnable", "1" if enable else "0")]),
        ("waypointHeadingPathMode", "followBadArc"),
        ("waypointHeadingPoiIndex", "0"),
    ]
