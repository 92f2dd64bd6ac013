"""A mission as MAVLink items, in the order in which each autopilot really takes the photos.

The orders were flown in the simulations of both. On ArduPilot what follows a waypoint in the list is done *while flying
to the next navigation command*, and what is left of it when that is reached is dropped without a word. So everything
that must happen before a photo stands before its waypoint, the trigger right behind the waypoint, and behind that
another navigation command that keeps the aircraft in place while the shutter is open:

- ArduPilot: DO_MOUNT_CONTROL, CONDITION_YAW, NAV_WAYPOINT (hold), DO_DIGICAM_CONTROL, NAV_DELAY
- PX4: DO_GIMBAL_MANAGER_PITCHYAW, NAV_WAYPOINT (hold, yaw), IMAGE_START_CAPTURE, the same NAV_WAYPOINT (hold)

What the camera is told stands before the first waypoint, and a focus that is found at the first photo and then held
between that waypoint and its trigger. ArduPilot's DO_DIGICAM_CONFIGURE has ten times the f-number, as its own records
of it and the message of the same name do: it stores a whole number.

PX4 gets no NAV_DELAY. From mid 2025 on it corrects the height of home in flight, and until March 2026 it then took the
height of the item at hand, which a delay does not have: the aircraft flew towards 0 m above the sea (PX4 pull request
26662; seen in its simulation).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot, facts
from missions.mission.build import SAME_POINT_M
from missions.mission.export_choices import HeightReference
from missions.mission.model import (
    GeoPoint,
    Mission,
    Photo,
    ReadWaypoint,
    altitude_amsl_m,
    distance_m,
    leg_lengths_m,
    point_at_amsl,
)
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import wrap_heading_deg
from planning.motion.px4 import px4_turn_s
from planning.parameters import CameraSettings
from planning.plan import ANGLE_DECIMALS

NAN = math.nan
Params = tuple[float, float, float, float, float, float, float]

MIN_HOLD_S = 2.0
"""ArduPilot's position error at the shutter is 0.15 to 0.24 m with a hold of 2 s, and 1.0 to 1.4 m with none."""

PASS_HOLD_S = 1
"""Hold at a waypoint without a photo: with 0 both autopilots cut the corner, off the checked path."""

SLEW_YAW_DEG_S = 60.0
"""ArduPilot's default ATC_SLEW_YAW; it turned 180 degrees in 3.1 s from rest."""

TURN_MARGIN_S = 1.0
MIN_DELAY_S = 1.0
"""Shortest wait behind a trigger: ArduPilot loses a second trigger within 0.1 s, cameras open some tenths late."""

FOCUSING_S = 2.0
"""Wait for an automatic focus; contrast detection takes one to two seconds."""

RANGE_END = 100.0
"""FOCUS_TYPE_RANGE in per cent of the range; its far end is infinity."""

MAX_UINT8, MAX_UINT16 = 255, 65535

DIGICAM_MANUAL = 4.0
"""Shooting mode of DO_DIGICAM_CONFIGURE: 1 program, 2 aperture priority, 3 shutter priority, 4 manual (AP_Mission)."""

PX4_ACCEPTANCE_RADIUS_M = 0.5

PX4_MIN_HOLD_S = 1.0
"""PX4 counts the hold from the edge of that radius: with none the simulated vehicle took photos 0.5 m early, moving."""

HOLD_HORIZON = float(mavlink.GIMBAL_MANAGER_FLAGS_ROLL_LOCK | mavlink.GIMBAL_MANAGER_FLAGS_PITCH_LOCK)
"""The gimbal keeps pitch and roll to the horizon and follows the nose sideways."""


@dataclass(frozen=True, slots=True)
class MissionItem:
    """One mission item: params 1 to 7, of which 5 to 7 are latitude, longitude and altitude where it has a position."""

    command: int
    frame: int
    params: Params
    viewpoint_id: str = ""


Polygon = tuple[tuple[float, float], ...]
"""Corners of a fence, latitude and longitude in degrees."""


RallyPlace = tuple[float, float, float]
"""A rally point in a file: latitude and longitude in degrees, metres above home."""


@dataclass(frozen=True, slots=True)
class MavlinkFile:
    """What a mission file holds: items in order, without the home position that some files put before them.

    `autopilot` and `cruise_speed_m_s` are None where the file does not say; `fences` are polygons to stay out of;
    `findings` are what had to be put right to read it.
    """

    items: tuple[MissionItem, ...]
    home: GeoPoint | None
    autopilot: Autopilot | None = None
    cruise_speed_m_s: float | None = None
    fences: tuple[Polygon, ...] = ()
    rally: tuple[RallyPlace, ...] = ()
    findings: tuple[Finding, ...] = ()


RESERVED_ITEMS = 40
"""Of an autopilot's items, for take-off, landing and waypoints around obstacles when photos are shared out."""


def photos_that_fit(autopilot: Autopilot) -> int:
    """Photos of one sortie that an autopilot's item limit leaves room for."""
    items_per_photo = 5 if autopilot is Autopilot.ARDUPILOT else 4
    return (facts(autopilot).max_items - RESERVED_ITEMS) // items_per_photo


def mission_items(mission: Mission, autopilot: Autopilot, reference: HeightReference) -> tuple[MissionItem, ...]:
    """Items of a mission, home not among them.

    Raises
    ------
    ValueError
        `reference` is the ellipsoid, which MAVLink has no frame for.
    """
    return tuple(_Sequence(mission, autopilot, reference).items())


@dataclass(slots=True)
class _Sequence:
    """The items of one mission; remembers how the camera stands between photos (None: not known)."""

    mission: Mission
    autopilot: Autopilot
    reference: HeightReference
    nose_deg: float | None = None
    pitch_deg: float | None = None
    n_photos: int = 0

    def __post_init__(self) -> None:
        if self.reference is HeightReference.ELLIPSOID:
            raise ValueError("MAVLink has no frame for heights above the ellipsoid")

    def items(self) -> Iterator[MissionItem]:
        mission = self.mission
        points = [waypoint.position for waypoint in mission.waypoints]
        legs_m = leg_lengths_m(
            [p.lat_deg for p in points], [p.lon_deg for p in points], [p.height_ellipsoid_m for p in points]
        )
        yield self.take_off(points[0])
        yield plain(mavlink.MAV_CMD_DO_CHANGE_SPEED, mavlink.SPEED_TYPE_GROUNDSPEED, mission.speed_m_s, -1.0)
        if self.autopilot is Autopilot.PX4:
            # PX4's gimbal obeys whoever configured it last: -2 makes that the autopilot itself.
            yield plain(mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE, -2.0, -2.0, -1.0, -1.0)
        yield from camera_items(mission, self.autopilot)
        for waypoint, leg_m in zip(mission.waypoints, [0.0, *legs_m], strict=True):
            leg_s = float(leg_m) / mission.speed_m_s
            if not waypoint.photos:
                yield self.passed(waypoint.position)
            for photo in waypoint.photos:
                yield from self.view(waypoint.position, photo, leg_s)
                leg_s = 0.0
        yield self.land()

    def take_off(self, top: GeoPoint) -> MissionItem:
        home = self.mission.takeoff
        yaw = 0.0 if self.autopilot is Autopilot.ARDUPILOT else NAN
        above_home = GeoPoint(home.lat_deg, home.lon_deg, top.height_ellipsoid_m)
        return self.at(mavlink.MAV_CMD_NAV_TAKEOFF, above_home, 0.0, 0.0, 0.0, yaw)

    def land(self) -> MissionItem:
        """Landing at home, straight below the last waypoint; a return would first climb to the autopilot's height."""
        yaw = 0.0 if self.autopilot is Autopilot.ARDUPILOT else NAN
        return self.at(mavlink.MAV_CMD_NAV_LAND, self.mission.takeoff, 0.0, 0.0, 0.0, yaw)

    def passed(self, point: GeoPoint) -> MissionItem:
        # The nose may swing into the course on the way, so where it points afterwards is not known.
        self.nose_deg = None
        if self.autopilot is Autopilot.ARDUPILOT:
            return self.at(mavlink.MAV_CMD_NAV_WAYPOINT, point, PASS_HOLD_S)
        return self.at(mavlink.MAV_CMD_NAV_WAYPOINT, point, PASS_HOLD_S, PX4_ACCEPTANCE_RADIUS_M, 0.0, NAN)

    def view(self, point: GeoPoint, photo: Photo, leg_s: float) -> Iterator[MissionItem]:
        """Items of one photo."""
        self.n_photos += 1
        turn_s, tilt_s = self.turning_s(photo)
        heading_deg = round(photo.heading_deg, ANGLE_DECIMALS)
        pitch_deg = round(photo.gimbal_pitch_deg, ANGLE_DECIMALS)
        stay_s = max(MIN_DELAY_S, self.mission.rules.photo_s)
        if self.autopilot is Autopilot.ARDUPILOT:
            hold_s = self.ardupilot_hold_s(max(turn_s, tilt_s), leg_s)
            # Before CONDITION_YAW: a gimbal without a pan axis makes the vehicle turn to param 3, to north. And not
            # DO_GIMBAL_MANAGER_PITCHYAW: ArduPilot stores its angles in whole degrees.
            mode = float(mavlink.MAV_MOUNT_MODE_MAVLINK_TARGETING)
            yield plain(mavlink.MAV_CMD_DO_MOUNT_CONTROL, pitch_deg, 0.0, 0.0, 0.0, 0.0, 0.0, mode)
            yield plain(mavlink.MAV_CMD_CONDITION_YAW, heading_deg % 360.0)
            yield self.at(mavlink.MAV_CMD_NAV_WAYPOINT, point, hold_s)
            if self.is_focused_here:
                yield plain(mavlink.MAV_CMD_SET_CAMERA_FOCUS, mavlink.FOCUS_TYPE_AUTO_SINGLE)
                yield plain(mavlink.MAV_CMD_NAV_DELAY, FOCUSING_S, -1.0, -1.0, -1.0)
            yield plain(mavlink.MAV_CMD_DO_DIGICAM_CONTROL, 0.0, 0.0, 0.0, 0.0, 1.0, viewpoint_id=photo.viewpoint_id)
            yield plain(mavlink.MAV_CMD_NAV_DELAY, stay_s, -1.0, -1.0, -1.0)
        else:
            # PX4's hold runs while the gimbal still turns, and the nose up to the last MIS_YAW_ERR = 12 deg.
            turn_s = px4_turn_s(self.turn_deg(photo), self.mission.aircraft.max_yaw_rate_deg_s)
            settled_s = max(PX4_MIN_HOLD_S, self.mission.rules.settle_s) + max(0.0, max(turn_s, tilt_s) - leg_s)
            place = (PX4_ACCEPTANCE_RADIUS_M, 0.0, heading_deg)
            yield plain(mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW, pitch_deg, 0.0, NAN, NAN, HOLD_HORIZON)
            yield self.at(mavlink.MAV_CMD_NAV_WAYPOINT, point, round(settled_s, 2), *place)
            if self.is_focused_here:
                yield plain(mavlink.MAV_CMD_SET_CAMERA_FOCUS, mavlink.FOCUS_TYPE_AUTO_SINGLE)
                yield self.at(mavlink.MAV_CMD_NAV_WAYPOINT, point, FOCUSING_S, *place)
            number = float(self.n_photos)
            yield plain(mavlink.MAV_CMD_IMAGE_START_CAPTURE, 0.0, 0.0, 1.0, number, viewpoint_id=photo.viewpoint_id)
            yield self.at(mavlink.MAV_CMD_NAV_WAYPOINT, point, stay_s, *place)
        self.nose_deg, self.pitch_deg = photo.heading_deg, photo.gimbal_pitch_deg

    @property
    def is_focused_here(self) -> bool:
        """Whether the focus that is held is found at the photo at hand: the first."""
        controls = self.mission.camera_controls
        takes_focus = controls is not None and "focus" in controls.mavlink
        return takes_focus and self.mission.camera_settings.focus == "lock" and self.n_photos == 1

    def turning_s(self, photo: Photo) -> tuple[float, float]:
        """Times that the aircraft and the gimbal need to turn to a photo, from the worst where that is not known."""
        aircraft, (low, high) = self.mission.aircraft, self.mission.camera.gimbal_pitch_deg
        tilt_deg = high - low if self.pitch_deg is None else abs(photo.gimbal_pitch_deg - self.pitch_deg)
        yaw_rate_deg_s = min(SLEW_YAW_DEG_S, aircraft.max_yaw_rate_deg_s)
        return self.turn_deg(photo) / yaw_rate_deg_s, tilt_deg / aircraft.max_gimbal_rate_deg_s

    def turn_deg(self, photo: Photo) -> float:
        """How far the nose turns to a photo, half round where it may point anywhere."""
        return 180.0 if self.nose_deg is None else abs(wrap_heading_deg(photo.heading_deg - self.nose_deg))

    def ardupilot_hold_s(self, turning_s: float, leg_s: float) -> float:
        """Hold that ends after all turning and settling; whole seconds, because ArduPilot drops the rest."""
        settled_s = max(0.0, turning_s - leg_s) + self.mission.rules.settle_s
        return float(math.ceil(max(MIN_HOLD_S, settled_s, turning_s + TURN_MARGIN_S - leg_s) - 1e-9))

    def at(
        self, command: int, point: GeoPoint, p1: float, p2: float = 0.0, p3: float = 0.0, p4: float = 0.0
    ) -> MissionItem:
        """Item with a position, in the reference asked for."""
        if self.reference is HeightReference.AMSL:
            frame, altitude_m = mavlink.MAV_FRAME_GLOBAL, altitude_amsl_m(point)
        else:
            frame, altitude_m = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, self.mission.height_above_takeoff_m(point)
        lat_deg, lon_deg = round(point.lat_deg, 9), round(point.lon_deg, 9)
        return MissionItem(command, frame, (p1, p2, p3, p4, lat_deg, lon_deg, round(altitude_m, 4)))


def camera_items(mission: Mission, autopilot: Autopilot) -> Iterator[MissionItem]:
    """What the camera is told before the first waypoint, as far as it takes that; see `CameraControls.mavlink`."""
    settings, controls = mission.camera_settings, mission.camera_controls
    obeyed = () if controls is None else controls.mavlink
    exposure = digicam_exposure(settings, mission.f_number)
    if "exposure" in obeyed and autopilot is Autopilot.ARDUPILOT and exposure is not None:
        yield plain(mavlink.MAV_CMD_DO_DIGICAM_CONFIGURE, DIGICAM_MANUAL, *exposure)
    if "focus" not in obeyed:
        return
    if settings.focus == "auto":
        yield plain(mavlink.MAV_CMD_SET_CAMERA_FOCUS, mavlink.FOCUS_TYPE_AUTO_CONTINUOUS)
    elif settings.focus == "infinity":
        yield plain(mavlink.MAV_CMD_SET_CAMERA_FOCUS, mavlink.FOCUS_TYPE_RANGE, RANGE_END)
    elif settings.focus_distance_m is not None and autopilot is Autopilot.PX4:
        # ArduPilot refuses metres; PX4 hands the command on to the camera.
        yield plain(mavlink.MAV_CMD_SET_CAMERA_FOCUS, mavlink.FOCUS_TYPE_METERS, settings.focus_distance_m)


def digicam_exposure(settings: CameraSettings, f_number: float | None) -> tuple[float, float, float] | None:
    """A manual exposure in the whole numbers of DO_DIGICAM_CONFIGURE: parts of a second, f-number times 10, ISO.

    None where it is not manual, or is no such numbers, such as shutter times of half a second and more.
    """
    if settings.exposure != "manual" or settings.shutter_s is None or settings.iso is None or f_number is None:
        return None
    parts, aperture = 1.0 / settings.shutter_s, 10.0 * f_number
    if abs(parts - round(parts)) > 0.01 * parts or not (
        1 <= round(parts) <= MAX_UINT16 and round(aperture) <= MAX_UINT8
    ):
        return None
    return (float(round(parts)), float(round(aperture)), float(settings.iso)) if settings.iso <= MAX_UINT16 else None


def plain(command: int, *params: float, viewpoint_id: str = "") -> MissionItem:
    """Item without a position, in the frame that PX4 wants, and in which files keep params 5 and 6 as they are."""
    filled = (*map(float, params), *(0.0,) * (7 - len(params)))
    p1, p2, p3, p4, p5, p6, p7 = filled
    return MissionItem(command, mavlink.MAV_FRAME_MISSION, (p1, p2, p3, p4, p5, p6, p7), viewpoint_id)


# Where a mission item is: latitude, longitude and a height in the reference that its frame says.

ABSOLUTE_FRAMES, RELATIVE_FRAMES, TERRAIN_FRAMES = (0, 5), (3, 6), (10, 11)


def has_place(item: MissionItem) -> bool:
    """Whether an item says a latitude and longitude; 0, 0 and NaN mean "here"."""
    lat_deg, lon_deg = item.params[4:6]
    return (lat_deg, lon_deg) != (0.0, 0.0) and not (math.isnan(lat_deg) or math.isnan(lon_deg))


def position_of(item: MissionItem, here: ReadWaypoint | GeoPoint | None, place: str) -> ReadWaypoint:
    """Position of an item.

    Parameters
    ----------
    here
        Where the vehicle is, for items that do not say a place.
    place
        Name of the item, for messages.

    Raises
    ------
    MissionError
        The position is not on the globe, or counts from something that is not in the file.
    """
    lat_deg, lon_deg, altitude_m = item.params[4:]
    if not has_place(item):
        if here is None:
            raise MissionError.say("its position means here, but nothing says where that is", place=place)
        lat_deg, lon_deg = here.lat_deg, here.lon_deg
    if not (abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0 and math.isfinite(altitude_m)):
        raise MissionError.say(
            "the position {:g}, {:g}, {:g} m is not on the globe", lat_deg, lon_deg, altitude_m, place=place
        )
    if item.frame in RELATIVE_FRAMES:
        return ReadWaypoint(lat_deg, lon_deg, height_above_takeoff_m=altitude_m)
    if item.frame in ABSOLUTE_FRAMES:
        point = point_at_amsl(lat_deg, lon_deg, altitude_m)
        return ReadWaypoint(lat_deg, lon_deg, height_ellipsoid_m=point.height_ellipsoid_m)
    if item.frame in TERRAIN_FRAMES:
        raise MissionError.say(
            "its height counts from the terrain, which is not in the file; save the mission with heights "
            "above take-off or sea level",
            place=place,
        )
    raise MissionError.say("frame {} does not place it on the globe", item.frame, place=place)


def is_same_place(a: ReadWaypoint, b: ReadWaypoint) -> bool:
    """Whether two points with heights of the same kind are one."""
    heights = (a.height_above_takeoff_m, b.height_above_takeoff_m)
    if heights == (None, None):
        heights = (a.height_ellipsoid_m, b.height_ellipsoid_m)
    low, high = heights
    if low is None or high is None or abs(high - low) > SAME_POINT_M:
        return False
    return distance_m(a.lat_deg, a.lon_deg, b.lat_deg, b.lon_deg) <= SAME_POINT_M


def home_of(lat_deg: float, lon_deg: float, altitude_amsl_m: float) -> tuple[GeoPoint | None, tuple[Finding, ...]]:
    """The home position that a file names; None where it names none, or one that cannot be, which is told."""
    if (lat_deg, lon_deg) == (0.0, 0.0):
        return None, ()
    if abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0 and abs(altitude_amsl_m) < 1e5:
        return point_at_amsl(lat_deg, lon_deg, altitude_amsl_m), ()
    text = say(
        "its home position {:g}, {:g}, {:g} m is not on the globe and is not used", lat_deg, lon_deg, altitude_amsl_m
    )
    return None, (Finding(Severity.WARNING, "home", text),)
