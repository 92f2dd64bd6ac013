"""A MAVLink mission file read back: the sortie it describes, with the photos that the vehicle would take."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.check import check_items
from missions.mavlink.items import (
    DIGICAM_MANUAL,
    RANGE_END,
    RELATIVE_FRAMES,
    MavlinkFile,
    MissionItem,
    has_place,
    is_same_place,
    position_of,
)
from missions.mission.export_choices import HeightReference
from missions.mission.model import (
    NOTHING_SAID,
    ON_THE_WAY,
    Finish,
    ReadCamera,
    ReadMission,
    ReadPhoto,
    ReadWaypoint,
    Stay,
    are_too_many,
    as_warning,
    bearing_deg,
    courses_deg,
    distance_m,
    point_between,
    reasons,
    shots_on_leg,
    too_many_shots,
)
from planning.aircraft.camera_use import FOCUSES
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import wrap_heading_deg
from planning.optics import shutter_text
from planning.parameters import FocusMode

# What an autopilot would do with mission items: where photos are taken, and how the camera stands at each.
#
# One pass over the items, with the camera's state. Two rules make most of it: what follows a waypoint in the list
# happens
# when that waypoint is reached (photos are there), and a yaw, gimbal or region of interest once set stays until it is
# set
# again, except that ArduPilot's CONDITION_YAW holds for one leg. Without any of them the nose follows the course, the
# default of both autopilots.

FLOWN_TO = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    mavlink.MAV_CMD_NAV_LOITER_TURNS,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
    mavlink.MAV_CMD_NAV_LOITER_TO_ALT,
)
ACCEPTANCE_M = 2.0
"""Radius within which a waypoint is reached where its item names none: ArduPilot's WPNAV_RADIUS and, for multirotors,
PX4's NAV_ACC_RAD by default."""

TAKEOFFS = (mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_VTOL_TAKEOFF)
LANDINGS = (mavlink.MAV_CMD_NAV_LAND, mavlink.MAV_CMD_NAV_VTOL_LAND)

NOT_FLOWN = {
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT: say("spline legs are taken as straight"),
    mavlink.MAV_CMD_NAV_LOITER_TURNS: say("circles are taken as a stop at their centre"),
    mavlink.MAV_CMD_DO_JUMP: say("jumps are not followed: each item counts once"),
}

CHANGES_NOTHING = (
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
    mavlink.MAV_CMD_DO_MOUNT_CONFIGURE,
    mavlink.MAV_CMD_DO_LAND_START,
    mavlink.MAV_CMD_JUMP_TAG,
)
"""Of what a plan holds: who moves the gimbal, and marks in the list."""


@dataclass(slots=True)
class _Trigger:
    """A camera that shoots every so many metres or seconds, `left` more times (None: until it is stopped)."""

    every: float
    in_seconds: bool
    left: int | None = None
    travelled: float = 0.0


@dataclass(slots=True)
class MavlinkFlight:
    """Items being flown; `flown`, `finish`, `climb_m` and `findings` are the result."""

    file: MavlinkFile
    place: str
    autopilot: Autopilot | None = None
    flown: list[ReadWaypoint] = field(default_factory=list)
    finish: Finish = Finish.HOVER
    climb_m: float = 0.0
    findings: list[Finding] = field(default_factory=list)
    nose_deg: float | None = None
    pitch_deg: float | None = None
    gimbal_yaw_deg: float = 0.0
    gimbal_north_deg: float | None = None
    wanted_yaw_deg: float | None = None
    roi: ReadWaypoint | None = None
    trigger: _Trigger | None = None
    speed_m_s: float | None = None
    camera: ReadCamera = NOTHING_SAID

    def fly(self) -> None:
        """Go through all items, up to the one that ends the flight.

        Raises
        ------
        MissionError
            A height counts from terrain, or heights of both kinds cannot be brought together.
        """
        self.autopilot = self.file.autopilot or autopilot_by_items(self.file.items)
        self.speed_m_s = self.file.cruise_speed_m_s
        self._go_through()
        self.flown = [_with_passing(point) for point in self.flown]

    def _go_through(self) -> None:
        left_out: dict[int, list[int]] = {}
        number = 0
        for number, item in enumerate(self.file.items, 1):
            self._note_simplification(item, number)
            if item.command in FLOWN_TO:
                self._fly_to(replace(self._position(item, number), stay=self._stay(item)), self._yaw_of(item))
            elif item.command in TAKEOFFS:
                self._take_off(item, number)
            elif item.command in LANDINGS:
                self._land(item, number)
                break
            elif item.command == mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
                self.finish = Finish.RETURN
                break
            elif item.command in _HANDLERS:
                _HANDLERS[item.command](self, item, number)
            elif item.command not in NOT_FLOWN and item.command not in CHANGES_NOTHING:
                left_out.setdefault(item.command, []).append(number)
        self._note_left_out(left_out, number)

    def _note_left_out(self, left_out: Mapping[int, Sequence[int]], n_read: int) -> None:
        """Say what of the mission the plan does not hold: items by command, and those behind the `n_read` first."""
        for command, numbers in left_out.items():
            entry = mavlink.enums["MAV_CMD"].get(command)
            name = str(command) if entry is None else f"{command}, {entry.name.removeprefix('MAV_CMD_')}"
            text = say(
                "a plan cannot hold this command ({}; items: {}): it is left out, and missions made of the plan do "
                "without it",
                *(name, len(numbers)),
            )
            self.findings.append(Finding(Severity.WARNING, "left-out", text, say("{}item {}", self.place, numbers[0])))
        n_behind = len(self.file.items) - n_read
        if n_behind:
            text = say("the flight ends with this item; what stands behind it is left out, items: {}", n_behind)
            self.findings.append(Finding(Severity.WARNING, "left-out", text, say("{}item {}", self.place, n_read)))

    def _stay(self, item: MissionItem) -> Stay:
        """How long the vehicle stays at a waypoint; without a hold it flies through, within its acceptance radius."""
        hold, radius, *_ = item.params
        if item.command == mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT:
            return Stay(None, hold) if hold > 0.0 else Stay(math.inf)
        if item.command == mavlink.MAV_CMD_NAV_WAYPOINT:
            return Stay(None, hold) if hold > 0.0 else Stay(radius if radius > 0.0 else ACCEPTANCE_M)
        if item.command == mavlink.MAV_CMD_NAV_LOITER_TIME:
            return Stay(None, max(0.0, hold) if math.isfinite(hold) else 0.0)
        if item.command == mavlink.MAV_CMD_NAV_LOITER_TURNS and math.isfinite(hold) and math.isfinite(item.params[2]):
            return Stay(None, max(0.0, hold) * 2.0 * math.pi * abs(item.params[2]) / (self.speed_m_s or 1.0))
        return Stay()

    def _note_simplification(self, item: MissionItem, number: int) -> None:
        text = NOT_FLOWN.get(item.command)
        if text is not None:
            self.findings.append(Finding(Severity.WARNING, "simplified", text, say("{}item {}", self.place, number)))

    # Positions ------------------------------------------------------------------------------------------------------

    def _position(self, item: MissionItem, number: int) -> ReadWaypoint:
        here = self.flown[-1] if self.flown else self.file.home
        return position_of(item, here, say("{}item {}", self.place, number))

    def _metric_height_m(self, point: ReadWaypoint) -> float:
        """Height that can be compared with that of any other point of this mission."""
        if point.height_above_takeoff_m is None:
            return point.height_ellipsoid_m or 0.0
        return point.height_above_takeoff_m + (self.file.home.height_ellipsoid_m if self.file.home else 0.0)

    def _take_off(self, item: MissionItem, number: int) -> None:
        if self.file.home is not None or has_place(item):
            self.flown.append(replace(self._position(item, number), stay=Stay()))
        if item.frame in RELATIVE_FRAMES and math.isfinite(item.params[6]):
            self.climb_m = item.params[6]

    def _land(self, item: MissionItem, number: int) -> None:
        """Landing flies level to above its place, and descends there."""
        self.finish = Finish.LAND
        if self.flown and has_place(item):
            ground = self._position(item, number)
            there = replace(self.flown[-1], lat_deg=ground.lat_deg, lon_deg=ground.lon_deg, photos=(), stay=Stay())
            self._fly_to(there, None)

    def _fly_to(self, end: ReadWaypoint, yaw_deg: float | None) -> None:
        start = self.flown[-1] if self.flown else None
        course_deg = None
        if start is not None:
            course_deg = courses_deg([start.lat_deg, end.lat_deg], [start.lon_deg, end.lon_deg])[0]
        headings_deg = (self.wanted_yaw_deg, yaw_deg, course_deg, self.nose_deg)
        self.nose_deg = next((heading for heading in headings_deg if heading is not None), None)
        self.wanted_yaw_deg = None
        if start is not None:
            self.flown[-1] = start = replace(start, speed_m_s=self.speed_m_s)
        if start is not None and self.trigger is not None:
            self.flown += self._shots_between(start, end, self.trigger)
        # A waypoint where the aircraft already is adds nothing but perhaps another photo there, and a hold.
        if not self.flown or not is_same_place(self.flown[-1], end):
            self.flown.append(end)
        elif end.stay is not None and end.stay.is_stop:
            here = self.flown[-1].stay or Stay()
            self.flown[-1] = replace(self.flown[-1], stay=Stay(None, here.wait_s + end.stay.wait_s))
        elif self.flown[-1].stay == ON_THE_WAY:
            self.flown[-1] = replace(self.flown[-1], stay=end.stay)

    def _shots_between(self, start: ReadWaypoint, end: ReadWaypoint, trigger: _Trigger) -> list[ReadWaypoint]:
        """Points of a leg where the trigger releases the camera, each with its photo."""
        same_kind = (start.height_above_takeoff_m is None) == (end.height_above_takeoff_m is None)
        if not same_kind and self.file.home is None:
            raise MissionError.say(
                "{}heights above take-off and above sea level are mixed, and home is not known", self.place
            )
        rise_m = self._metric_height_m(end) - self._metric_height_m(start)
        length_m = math.hypot(distance_m(start.lat_deg, start.lon_deg, end.lat_deg, end.lon_deg), rise_m)
        length = length_m / (self.speed_m_s or 1.0) if trigger.in_seconds else length_m
        if are_too_many(length, trigger.every):
            self.findings.append(
                Finding(Severity.WARNING, "trigger", too_many_shots(length, trigger.every), self.place.rstrip(": "))
            )
            self.trigger = None
            return []
        fractions = shots_on_leg(trigger.travelled, length, trigger.every)
        trigger.travelled += length
        if trigger.left is not None:
            fractions = fractions[: trigger.left]
            trigger.left -= len(fractions)
        return [self._shot_at(start, end, rise_m, fraction) for fraction in fractions]

    def _shot_at(self, start: ReadWaypoint, end: ReadWaypoint, rise_m: float, fraction: float) -> ReadWaypoint:
        lat_deg, lon_deg = end.lat_deg, end.lon_deg
        if fraction < 1.0:  # the end itself exactly, so that it is known to be the same place
            lat_deg, lon_deg = point_between(start.lat_deg, start.lon_deg, end.lat_deg, end.lon_deg, fraction)
        below_m = rise_m * (1.0 - fraction)  # the end's own height at fraction 1
        if end.height_above_takeoff_m is None:
            point = ReadWaypoint(lat_deg, lon_deg, height_ellipsoid_m=(end.height_ellipsoid_m or 0.0) - below_m)
        else:
            point = ReadWaypoint(lat_deg, lon_deg, height_above_takeoff_m=end.height_above_takeoff_m - below_m)
        photo = replace(self._photo(point), in_passing=True)
        return replace(point, photos=(photo,), stay=ON_THE_WAY, speed_m_s=self.speed_m_s)

    # Aiming ---------------------------------------------------------------------------------------------------------

    def _yaw_of(self, item: MissionItem) -> float | None:
        """Yaw that a waypoint itself demands: PX4's param 4. ArduPilot ignores it, and writes 0 there."""
        yaw_deg = item.params[3]
        if self.autopilot is Autopilot.ARDUPILOT or item.command != mavlink.MAV_CMD_NAV_WAYPOINT:
            return None
        if not math.isfinite(yaw_deg) or (yaw_deg == 0.0 and self.autopilot is None):
            return None
        return wrap_heading_deg(yaw_deg)

    def _angle(self, item: MissionItem, index: int, number: int) -> float | None:
        """An angle of an item; None, which is told, where it is none. Pitch, the first, must be one of a camera."""
        angle_deg = item.params[index]
        low, high = (-180.0, 90.0) if index == 0 else (-360.0, 360.0)
        if low <= angle_deg <= high:
            return angle_deg
        text = say("param {} is {:g}; expected an angle in deg, so it is not followed", index + 1, angle_deg)
        self.findings.append(Finding(Severity.WARNING, "angle", text, say("{}item {}", self.place, number)))
        return None

    def condition_yaw(self, item: MissionItem, number: int) -> None:
        """CONDITION_YAW: an absolute heading, or a turn from the present one."""
        angle_deg, _, direction, is_relative = item.params[:4]
        if not math.isfinite(angle_deg):
            text = say("param 1 is {:g}; expected an angle in deg, so it is not followed", angle_deg)
            self.findings.append(Finding(Severity.WARNING, "angle", text, say("{}item {}", self.place, number)))
        elif is_relative == 1.0:
            turn_deg = -angle_deg if direction < 0 else angle_deg
            self.wanted_yaw_deg = None if self.nose_deg is None else wrap_heading_deg(self.nose_deg + turn_deg)
        else:
            self.wanted_yaw_deg = wrap_heading_deg(angle_deg)

    def mount_control(self, item: MissionItem, number: int) -> None:
        """DO_MOUNT_CONTROL: angles, a place to look at, or the neutral position."""
        mode = item.params[6]
        if mode == mavlink.MAV_MOUNT_MODE_GPS_POINT:
            self.roi = ReadWaypoint(item.params[4], item.params[5], height_above_takeoff_m=item.params[3])
            return
        self.roi, self.gimbal_north_deg = None, None
        if mode in (mavlink.MAV_MOUNT_MODE_RETRACT, mavlink.MAV_MOUNT_MODE_NEUTRAL) and item.params[:3] == (
            0.0,
            0.0,
            0.0,
        ):
            self.pitch_deg, self.gimbal_yaw_deg = 0.0, 0.0
            return
        self.pitch_deg, self.gimbal_yaw_deg = self._angle(item, 0, number), self._angle(item, 2, number) or 0.0

    def gimbal_pitch_yaw(self, item: MissionItem, number: int) -> None:
        """DO_GIMBAL_MANAGER_PITCHYAW: pitch, and yaw from north where the yaw lock flag is set, else from the nose."""
        pitch_deg, yaw_deg, flags = item.params[0], item.params[1], item.params[4]
        self.roi = None
        if not math.isnan(pitch_deg):
            self.pitch_deg = self._angle(item, 0, number)
        if not math.isnan(yaw_deg):
            if self._angle(item, 1, number) is None:
                return
            is_locked = math.isfinite(flags) and int(flags) & mavlink.GIMBAL_MANAGER_FLAGS_YAW_LOCK
            self.gimbal_north_deg, self.gimbal_yaw_deg = (yaw_deg, 0.0) if is_locked else (None, yaw_deg)

    def set_roi(self, item: MissionItem, number: int) -> None:
        """DO_SET_ROI and DO_SET_ROI_LOCATION: look at a place until told otherwise."""
        is_old = item.command in (mavlink.MAV_CMD_DO_SET_ROI, mavlink.MAV_CMD_NAV_ROI)
        if is_old and item.params[0] not in (0.0, mavlink.MAV_ROI_LOCATION):
            text = say("a region of interest of mode {:g} is not followed", item.params[0])
            self.findings.append(Finding(Severity.WARNING, "simplified", text, say("{}item {}", self.place, number)))
        is_somewhere = has_place(item) and item.frame != mavlink.MAV_FRAME_MISSION
        self.roi = self._position(item, number) if is_somewhere else None

    def clear_roi(self, item: MissionItem, number: int) -> None:
        """DO_SET_ROI_NONE."""
        self.roi = None

    def delay(self, item: MissionItem, number: int) -> None:
        """NAV_DELAY: the aircraft stays, and a yaw that was asked for is reached here."""
        if self.wanted_yaw_deg is not None:
            self.nose_deg, self.wanted_yaw_deg = self.wanted_yaw_deg, None
        if self.flown and item.params[0] > 0.0:
            here = self.flown[-1].stay or Stay()
            self.flown[-1] = replace(self.flown[-1], stay=Stay(None, here.wait_s + item.params[0], here.turn_deg))

    def change_speed(self, item: MissionItem, number: int) -> None:
        """DO_CHANGE_SPEED."""
        if math.isfinite(item.params[1]) and item.params[1] > 0.0:
            self.speed_m_s = item.params[1]

    def _photo(self, point: ReadWaypoint, viewpoint_id: str = "") -> ReadPhoto:
        if self.roi is not None:
            roi, here = self.roi, (point.lat_deg, point.lon_deg)
            away_m = distance_m(*here, roi.lat_deg, roi.lon_deg)
            rise_m = self._metric_height_m(roi) - self._metric_height_m(point)
            pitch_deg = math.degrees(math.atan2(rise_m, away_m))
            return ReadPhoto(bearing_deg(*here, roi.lat_deg, roi.lon_deg), pitch_deg, viewpoint_id)
        nose_deg = self.nose_deg if self.wanted_yaw_deg is None else self.wanted_yaw_deg
        if self.gimbal_north_deg is not None:
            return ReadPhoto(wrap_heading_deg(self.gimbal_north_deg), self.pitch_deg, viewpoint_id)
        heading_deg = None if nose_deg is None else wrap_heading_deg(nose_deg + self.gimbal_yaw_deg)
        return ReadPhoto(heading_deg, self.pitch_deg, viewpoint_id)

    # Releasing ------------------------------------------------------------------------------------------------------

    def _shoot(self, item: MissionItem, number: int) -> None:
        if not self.flown:
            text = say("a photo is taken before the first waypoint, so where is not known; it is left out")
            self.findings.append(
                Finding(Severity.WARNING, "photo-without-place", text, say("{}item {}", self.place, number))
            )
            return
        here = self.flown[-1]
        self.flown[-1] = replace(here, photos=(*here.photos, self._photo(here, item.viewpoint_id)))

    def digicam(self, item: MissionItem, number: int) -> None:
        """DO_DIGICAM_CONTROL: a photo where param 5 is 1."""
        if item.params[4] == 1.0:
            self._shoot(item, number)

    def image_start(self, item: MissionItem, number: int) -> None:
        """IMAGE_START_CAPTURE: one photo, several, or one every so many seconds until stopped."""
        interval_s, count = item.params[1], item.params[2]
        self._shoot(item, number)
        if count != 1.0 and interval_s > 0.0:
            self.trigger = _Trigger(interval_s, in_seconds=True, left=int(count) - 1 if count > 1.0 else None)

    def trigger_distance(self, item: MissionItem, number: int) -> None:
        """DO_SET_CAM_TRIGG_DIST: a photo every so many metres (0 stops), with param 3 one at once."""
        every_m = item.params[0]
        self.trigger = _Trigger(every_m, in_seconds=False) if every_m > 0.0 else None
        if every_m > 0.0 and item.params[2] == 1.0:
            self._shoot(item, number)

    def trigger_interval(self, item: MissionItem, number: int) -> None:
        """DO_SET_CAM_TRIGG_INTERVAL: a photo every so many milliseconds (0 or less stops)."""
        cycle_s = item.params[0] / 1000.0
        self.trigger = _Trigger(cycle_s, in_seconds=True) if cycle_s > 0.0 else None

    def image_stop(self, item: MissionItem, number: int) -> None:
        """IMAGE_STOP_CAPTURE."""
        self.trigger = None

    # What the camera is told ------------------------------------------------------------------------------------------

    def _say_camera(self, text: str, number: int, severity: Severity = Severity.NOTE) -> None:
        self.findings.append(Finding(severity, "camera", text, say("{}item {}", self.place, number)))

    def digicam_configure(self, item: MissionItem, number: int) -> None:
        """DO_DIGICAM_CONFIGURE: mode, parts of a second, ten times the f-number (or itself), ISO; 0 says nothing."""
        mode, parts, aperture, iso = (value if math.isfinite(value) else 0.0 for value in item.params[:4])
        aperture = aperture / 10.0 if aperture >= 10.0 else aperture
        found = ReadCamera(
            "manual" if mode == DIGICAM_MANUAL else None,
            1.0 / parts if 1.0 / 60.0 <= parts <= 1e5 else None,
            aperture if 0.5 <= aperture <= 64.0 else None,
            round(iso) if 25.0 <= iso <= 409_600.0 else None,
        )
        said = [] if found.shutter_s is None else [shutter_text(found.shutter_s)]
        said += [] if found.aperture is None else [f"f/{found.aperture:g}"]
        said += [] if found.iso is None else [f"ISO {found.iso}"]
        if not said:
            self._say_camera(say("DO_DIGICAM_CONFIGURE says nothing that is understood; it is not taken over"), number)
            return
        self.camera = replace(found, focus=self.camera.focus, focus_distance_m=self.camera.focus_distance_m)
        self._say_camera(say("its camera: {}", ", ".join(said)), number)

    def camera_focus(self, item: MissionItem, number: int) -> None:
        """SET_CAMERA_FOCUS: once, again and again, at infinity, or at a distance in metres."""
        kind, value = item.params[:2]
        focus: FocusMode | None = None
        distance_m = None
        if kind == mavlink.FOCUS_TYPE_AUTO_CONTINUOUS:
            focus = "auto"
        elif kind in (mavlink.FOCUS_TYPE_AUTO, mavlink.FOCUS_TYPE_AUTO_SINGLE):
            focus = "lock" if self.camera.focus is None else "auto"
        elif kind == mavlink.FOCUS_TYPE_RANGE and value >= RANGE_END:
            focus = "infinity"
        elif kind == mavlink.FOCUS_TYPE_METERS and 0.0 < value <= 10_000.0:
            focus, distance_m = "distance", value
        if focus is None:
            text = say("a focus of type {:g} with {:g} is not taken over; set it on the camera", kind, value)
            self._say_camera(text, number, Severity.WARNING)
            return
        self.camera = replace(self.camera, focus=focus, focus_distance_m=distance_m)
        told = FOCUSES[focus] if distance_m is None else say("focus at {:g} m", distance_m)
        self._say_camera(say("its camera: {}", told), number)

    def camera_mode(self, item: MissionItem, number: int) -> None:
        """SET_CAMERA_MODE: photos, or video, in which most cameras take none."""
        if item.params[1] == mavlink.CAMERA_MODE_VIDEO:
            self._say_camera(say("it sets the camera to video: most take no photos then"), number, Severity.WARNING)

    def camera_zoom(self, item: MissionItem, number: int) -> None:
        """SET_CAMERA_ZOOM: another field of view than the one that photos count with."""
        text = say("it zooms, but all photos count with the field of view of the camera that is named")
        self._say_camera(text, number, Severity.WARNING)


_HANDLERS: dict[int, Callable[[MavlinkFlight, MissionItem, int], None]] = {
    mavlink.MAV_CMD_DO_DIGICAM_CONFIGURE: MavlinkFlight.digicam_configure,
    mavlink.MAV_CMD_SET_CAMERA_FOCUS: MavlinkFlight.camera_focus,
    mavlink.MAV_CMD_SET_CAMERA_MODE: MavlinkFlight.camera_mode,
    mavlink.MAV_CMD_SET_CAMERA_ZOOM: MavlinkFlight.camera_zoom,
    mavlink.MAV_CMD_CONDITION_YAW: MavlinkFlight.condition_yaw,
    mavlink.MAV_CMD_NAV_DELAY: MavlinkFlight.delay,
    mavlink.MAV_CMD_DO_CHANGE_SPEED: MavlinkFlight.change_speed,
    mavlink.MAV_CMD_DO_MOUNT_CONTROL: MavlinkFlight.mount_control,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW: MavlinkFlight.gimbal_pitch_yaw,
    mavlink.MAV_CMD_DO_SET_ROI: MavlinkFlight.set_roi,
    mavlink.MAV_CMD_NAV_ROI: MavlinkFlight.set_roi,
    mavlink.MAV_CMD_DO_SET_ROI_LOCATION: MavlinkFlight.set_roi,
    mavlink.MAV_CMD_DO_SET_ROI_NONE: MavlinkFlight.clear_roi,
    mavlink.MAV_CMD_DO_DIGICAM_CONTROL: MavlinkFlight.digicam,
    mavlink.MAV_CMD_IMAGE_START_CAPTURE: MavlinkFlight.image_start,
    mavlink.MAV_CMD_IMAGE_STOP_CAPTURE: MavlinkFlight.image_stop,
    mavlink.MAV_CMD_DO_SET_CAM_TRIGG_DIST: MavlinkFlight.trigger_distance,
    mavlink.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL: MavlinkFlight.trigger_interval,
}


def _with_passing(point: ReadWaypoint) -> ReadWaypoint:
    """A waypoint whose photos are taken in passing, if the vehicle does not stop there."""
    if point.stay is None or point.stay.is_stop or not point.photos:
        return point
    return replace(point, photos=tuple(replace(photo, in_passing=True) for photo in point.photos))


def autopilot_by_items(items: tuple[MissionItem, ...]) -> Autopilot | None:
    """Autopilot that alone understands the items; None where both might."""
    commands = {item.command for item in items}
    if mavlink.MAV_CMD_CONDITION_YAW in commands:
        return Autopilot.ARDUPILOT
    only_px4 = mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE in commands
    if only_px4 or any(math.isnan(value) for item in items for value in item.params):
        return Autopilot.PX4
    return None


def read_mavlink(path: Path, file: MavlinkFile, file_format: str, *, strict: bool = False) -> ReadMission:
    """The sortie that the items of a file describe.

    What an autopilot would refuse is a finding here and no reason to refuse: the file may be for another autopilot.
    Only what keeps the flight from being known is refused, unless `strict` asks for more.

    Raises
    ------
    MissionError
        There is no waypoint, or one whose place or height cannot be known; or, if `strict`, autopilots refuse it.
    """
    flight = MavlinkFlight(file, f"{path}: ")
    flight.fly()
    if not flight.flown:
        raise MissionError.say("the mission has no waypoint, so there is nothing to fly", place=path)
    is_relative = any(point.height_above_takeoff_m is not None for point in flight.flown)
    checks = check_items(file, flight.autopilot)
    errors = [finding for finding in checks if finding.severity is Severity.ERROR]
    if strict and errors:
        raise MissionError.say("the vehicle would refuse this mission: {}", reasons(errors), place=path)
    return ReadMission(
        name=path.stem,
        path=path,
        format=file_format,
        waypoints=tuple(flight.flown),
        takeoff=file.home,
        height_reference=HeightReference.ABOVE_TAKEOFF if is_relative else HeightReference.AMSL,
        finish=flight.finish,
        climb_above_takeoff_m=flight.climb_m,
        speed_m_s=file.cruise_speed_m_s or flight.speed_m_s,
        findings=(*file.findings, *map(as_warning, checks), *flight.findings, *_on_rally(file)),
        camera=flight.camera,
    )


def _on_rally(file: MavlinkFile) -> tuple[Finding, ...]:
    if not file.rally:
        return ()
    text = say(
        "the file has {} rally points, which belong to a site and not to a plan; mark them there", len(file.rally)
    )
    return (Finding(Severity.NOTE, "rally-points", text, "", float(len(file.rally))),)
