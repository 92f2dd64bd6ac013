"""A DJI mission read back: one sortie per wayline, with the photos that the aircraft would take."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from missions.dji.check import check_dji, is_on_globe
from missions.dji.wpml import Action, ActionGroup, DjiParts, Folder, WpmlWaypoint, load_parts
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import (
    NOTHING_SAID,
    ON_THE_WAY,
    Finish,
    GeoPoint,
    ReadCamera,
    ReadMission,
    ReadPhoto,
    ReadWaypoint,
    Stay,
    are_too_many,
    as_warning,
    bearing_deg,
    courses_deg,
    leg_lengths_m,
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
from planning.parameters import FocusMode

# What the aircraft would do with a wayline: where it takes photos, and how the camera stands at each.
#
# The order of things at a waypoint: the aircraft arrives with the heading that the waypoint before gave it, does the
# actions triggered by its arrival, turns as the leg that begins wants it, does the actions triggered by that, and
# leaves.
# Sources: DJI Cloud API documentation, WPML common elements (heading modes, triggers); files of FlightHub 2 (a time-
# lapse
# started on a leg). That a photo trigger by time or distance shoots at once when it is armed is assumed.

PHOTO_FUNCS = ("takePhoto", "orientedShoot", "accurateShoot")

RELEASE_S = 1.2
"""Of a photo at a waypoint, and of a zoom or a focus: DJI publishes none. A route of two turns of the nose, two of the
gimbal, zoom, focus and a photo at one place is stated by FlightHub 2 as 6.8 s."""

RESTING_FUNCS = ("hover", "rotateYaw", "orientedShoot", "accurateShoot", "panoShot")
"""What is done at rest, also at a waypoint that is flown through."""

CAMERA_FUNCS = ("zoom", "focus", "setFocusType")

FLOWN_THROUGH = ("coordinateTurn", "toPointAndPassWithContinuityCurvature")
"""Turn modes that do not stop at the waypoint."""

_LAPSE_SHOT = Action(None, "takePhoto", {})


@dataclass(frozen=True, slots=True)
class FlownPoint:
    """A point of the flight with the photos taken there; the height is in the wayline's own reference."""

    lat_deg: float
    lon_deg: float
    height_m: float
    photos: tuple[ReadPhoto, ...] = ()
    stay: Stay | None = ON_THE_WAY
    speed_m_s: float | None = None


@dataclass(frozen=True, slots=True)
class _Leg:
    """A leg as flown: headings and pitches at its two ends; None where they are not known."""

    start: FlownPoint
    end: FlownPoint
    mode: str
    heading_deg: tuple[float | None, float | None]
    pitch_deg: tuple[float | None, float | None]
    poi_lat_lon_deg: tuple[float, float] | None

    def point_at(self, fraction: float) -> FlownPoint:
        """Point at `fraction` of the leg, without photos."""
        ends = (self.start.lat_deg, self.start.lon_deg, self.end.lat_deg, self.end.lon_deg)
        height_m = self.start.height_m + fraction * (self.end.height_m - self.start.height_m)
        return FlownPoint(*point_between(*ends, fraction), height_m)

    def heading_at(self, fraction: float) -> float | None:
        """Heading of the nose at `fraction` of the leg."""
        start, end = self.heading_deg
        if self.mode == "towardPOI" and self.poi_lat_lon_deg is not None:
            point = self.point_at(fraction)
            return bearing_deg(point.lat_deg, point.lon_deg, *self.poi_lat_lon_deg)
        if self.mode == "smoothTransition" and end is not None:
            return end if start is None else start + fraction * wrap_heading_deg(end - start)
        return start

    def pitch_at(self, fraction: float) -> float | None:
        """Gimbal pitch at `fraction` of the leg."""
        start, end = self.pitch_deg
        return end if start is None or end is None else start + fraction * (end - start)


@dataclass(slots=True)
class _Trigger:
    """Something that takes photos along legs, every so many seconds or metres, up to a waypoint."""

    actions: tuple[Action, ...]
    every: float
    in_seconds: bool
    end_index: int
    travelled: float = 0.0


class _Groups:
    """Action groups by where they act; groups of at most one leg are found without a search."""

    def __init__(self, groups: Iterable[ActionGroup]) -> None:
        self._short: dict[int, list[tuple[range, ActionGroup]]] = {}
        self._long: list[tuple[range, ActionGroup]] = []
        for group in groups:
            if group.start_index is not None and group.end_index is not None:
                legs = range(group.start_index, group.end_index)
                near = self._long if len(legs) > 1 else self._short.setdefault(group.start_index, [])
                near.append((legs, group))

    def at_waypoint(self, trigger: str, index: int) -> Iterator[ActionGroup]:
        """Groups of one trigger that act at waypoint `index`."""
        return (group for legs, group in self._near(trigger, index) if index in legs or index == legs.stop)

    def on_leg(self, trigger: str, index: int) -> Iterator[ActionGroup]:
        """Groups of one trigger that act on the leg from waypoint `index` to the next."""
        return (group for legs, group in self._near(trigger, index) if index in legs)

    def _near(self, trigger: str, index: int) -> Iterator[tuple[range, ActionGroup]]:
        candidates = (*self._short.get(index - 1, ()), *self._short.get(index, ()), *self._long)
        return ((legs, group) for legs, group in candidates if group.trigger == trigger)


@dataclass(slots=True)
class Flight:
    """A wayline being flown.

    Parameters
    ----------
    is_ours
        Whether the file is one of ours: then the suffixes of the photos' names are viewpoint ids, and stops take what
        plans give them.
    """

    folder: Folder
    is_ours: bool
    nose_deg: float | None = None
    gimbal_yaw_deg: float = 0.0
    pitch_deg: float | None = None
    lapse: _Trigger | None = None
    triggers: list[_Trigger] = field(default_factory=list)
    wait_s: float = 0.0
    turn_deg: float = 0.0
    needs_rest: bool = False
    findings: list[Finding] = field(default_factory=list)

    def points(self) -> list[FlownPoint]:
        """All waypoints, and between them the points where photos are taken on the way.

        Coordinates and heights must be there. What else is wrong is passed over; `missions.dji.check` tells of it.
        """
        waypoints = self.folder.waypoints
        places = [_place(waypoint) for waypoint in waypoints]
        lat, lon, height = [p.lat_deg for p in places], [p.lon_deg for p in places], [p.height_m for p in places]
        courses, lengths_m = courses_deg(lat, lon), leg_lengths_m(lat, lon, height)
        groups = _Groups(group for waypoint in waypoints for group in waypoint.groups)
        self._act(self.folder.start_actions)
        flown: list[FlownPoint] = []
        photos: list[ReadPhoto] = []
        for index, waypoint in enumerate(waypoints):
            self._arrive(waypoint, is_first=index == 0, courses=courses)
            released = [
                photo for group in groups.at_waypoint("reachPoint", index) for photo in self._act(group.actions)
            ]
            is_last = index == len(waypoints) - 1
            stay = self._stay(waypoint, is_end=is_last or index == 0)
            photos += [replace(photo, in_passing=not stay.is_stop) for photo in released]
            speed_m_s = _speed_m_s(waypoint, self.folder)
            if is_last:
                flown.append(replace(places[index], photos=tuple(photos), stay=stay))
                break
            self._turn_for_leg(waypoint, places[index], courses[index])
            photos += self._begin_leg(groups, index)
            leg = self._leg(waypoint, waypoints[index + 1], places[index], places[index + 1], groups, index)
            flown.append(replace(places[index], photos=tuple(photos), stay=stay, speed_m_s=speed_m_s))
            on_the_way = self._shots(leg, float(lengths_m[index]), speed_m_s or 1.0, index)
            flown += [
                replace(leg.point_at(fraction), photos=(shot,), speed_m_s=speed_m_s)
                for fraction, shot in on_the_way
                if fraction < 1.0
            ]
            photos = [shot for fraction, shot in on_the_way if fraction == 1.0]
            self.nose_deg, self.pitch_deg = leg.heading_at(1.0), leg.pitch_at(1.0)
        return flown

    def _stay(self, waypoint: WpmlWaypoint, *, is_end: bool) -> Stay:
        """What was done at a waypoint since the last was left; at one that is passed, what needs no rest is free."""
        is_passed = waypoint.turn_mode in FLOWN_THROUGH and not is_end
        stay = Stay(_cut_m(waypoint) if is_passed else None, self.wait_s, self.turn_deg)
        needs_rest, self.needs_rest, self.wait_s, self.turn_deg = self.needs_rest, False, 0.0, 0.0
        return Stay(stay.passing_m) if is_passed and not needs_rest else stay

    def _arrive(self, waypoint: WpmlWaypoint, *, is_first: bool, courses: Sequence[float | None]) -> None:
        """Set the heading that a waypoint itself demands; the first one is reached looking along its leg."""
        is_fixed = waypoint.heading_mode == "fixed" and waypoint.heading_angle_enable
        if is_fixed or (is_first and waypoint.heading_mode == "smoothTransition"):
            self.nose_deg = _finite(waypoint.heading_angle_deg)
        elif is_first and waypoint.heading_mode == "followWayline":
            self.nose_deg = next((course for course in courses if course is not None), None)

    def _turn_for_leg(self, waypoint: WpmlWaypoint, place: FlownPoint, course_deg: float | None) -> None:
        if waypoint.heading_mode == "followWayline" and course_deg is not None:
            self.nose_deg = course_deg
        elif waypoint.heading_mode == "manually":
            self.nose_deg = None
        elif waypoint.heading_mode == "towardPOI" and waypoint.poi_lat_lon_deg is not None:
            self.nose_deg = bearing_deg(place.lat_deg, place.lon_deg, *waypoint.poi_lat_lon_deg)

    def _begin_leg(self, groups: _Groups, index: int) -> list[ReadPhoto]:
        """Actions and triggers that begin with the leg from waypoint `index`; the photos taken there and then."""
        photos: list[ReadPhoto] = []
        for group in groups.on_leg("betweenAdjacentPoints", index):
            photos += self._in_flight(group.actions)
        for name, in_seconds in (("multipleTiming", True), ("multipleDistance", False)):
            for group in groups.on_leg(name, index):
                shoots = any(action.func in PHOTO_FUNCS for action in group.actions)
                every = _finite(group.trigger_param) or 0.0
                if group.start_index == index and shoots and every > 0.0 and group.end_index is not None:
                    photos += self._in_flight(group.actions)
                    trigger = _Trigger(group.actions, every, in_seconds, group.end_index)
                    self.triggers.append(trigger)
        return photos

    def _leg(
        self,
        waypoint: WpmlWaypoint,
        following: WpmlWaypoint,
        start: FlownPoint,
        end: FlownPoint,
        groups: _Groups,
        index: int,
    ) -> _Leg:
        pitch_after_deg = self.pitch_deg
        for group in groups.on_leg("betweenAdjacentPoints", index):
            for action in group.actions:
                if action.func == "gimbalEvenlyRotate":
                    pitch_after_deg = _finite(action.number("gimbalPitchRotateAngle"))
        headings = (self.nose_deg, _finite(following.heading_angle_deg))
        pitches = (self.pitch_deg, pitch_after_deg)
        return _Leg(start, end, waypoint.heading_mode, headings, pitches, waypoint.poi_lat_lon_deg)

    def _shots(self, leg: _Leg, length_m: float, speed_m_s: float, index: int) -> list[tuple[float, ReadPhoto]]:
        """Photos on a leg in order, each with its fraction of the leg in (0, 1]."""
        self.triggers = [trigger for trigger in self.triggers if trigger.end_index > index]
        due: list[tuple[float, tuple[Action, ...]]] = []
        for trigger in (*self.triggers, *([] if self.lapse is None else [self.lapse])):
            length = length_m / speed_m_s if trigger.in_seconds else length_m
            if are_too_many(length, trigger.every):
                self.findings.append(Finding(Severity.WARNING, "trigger", too_many_shots(length, trigger.every)))
                continue
            due += [(fraction, trigger.actions) for fraction in shots_on_leg(trigger.travelled, length, trigger.every)]
            trigger.travelled += length
        shots: list[tuple[float, ReadPhoto]] = []
        for fraction, actions in sorted(due, key=lambda shot: shot[0]):
            self.nose_deg, self.pitch_deg = leg.heading_at(fraction), leg.pitch_at(fraction)
            shots += [(fraction, photo) for photo in self._in_flight(actions)]
        return shots

    def _in_flight(self, actions: Sequence[Action]) -> list[ReadPhoto]:
        """Do actions that cost no time, as the aircraft flies on; the photos they take."""
        before = self.wait_s, self.turn_deg, self.needs_rest
        photos = self._act(actions)
        self.wait_s, self.turn_deg, self.needs_rest = before
        return [replace(photo, in_passing=True) for photo in photos]

    def _act(self, actions: Sequence[Action]) -> list[ReadPhoto]:
        """Do actions in order; the photos they take."""
        photos: list[ReadPhoto] = []
        for action in actions:
            before = self.nose_deg, self.pitch_deg
            if action.func in PHOTO_FUNCS or action.func in CAMERA_FUNCS:
                self.wait_s += RELEASE_S
            self.needs_rest |= action.func in RESTING_FUNCS
            if action.func == "hover":
                self.wait_s += max(0.0, _finite(action.number("hoverTime")) or 0.0)
            elif action.func == "rotateYaw":
                self.nose_deg = _finite(action.number("aircraftHeading"))
            elif action.func == "gimbalRotate":
                self._rotate_gimbal(action)
            elif action.func == "takePhoto":
                photos.append(self._photo(action.params.get("fileSuffix", "")))
            elif action.func in PHOTO_FUNCS:
                photos.append(self._oriented_photo(action))
            elif action.func == "startTimeLapse" and self.lapse is None:
                every_s = _finite(action.number("minShootInterval")) or 0.0
                self.lapse = _Trigger((_LAPSE_SHOT,), every_s, in_seconds=True, end_index=len(self.folder.waypoints))
                photos.append(self._photo(""))
            elif action.func == "stopTimeLapse":
                self.lapse = None
            self.turn_deg += _turned_deg(before, (self.nose_deg, self.pitch_deg))
        return photos

    def _rotate_gimbal(self, action: Action) -> None:
        pitch = _finite(action.number("gimbalPitchRotateAngle"))
        yaw = _finite(action.number("gimbalYawRotateAngle"))
        is_relative = action.params.get("gimbalRotateMode") == "relativeAngle"
        if action.is_on("gimbalPitchRotateEnable") and pitch is not None:
            if not is_relative:
                self.pitch_deg = pitch
            elif self.pitch_deg is not None:
                self.pitch_deg += pitch
        if action.is_on("gimbalYawRotateEnable") and yaw is not None:
            from_north = action.params.get("gimbalHeadingYawBase") == "north" and not is_relative
            self.gimbal_yaw_deg = yaw - (self.nose_deg or 0.0) if from_north else yaw

    def _photo(self, suffix: str) -> ReadPhoto:
        heading = None if self.nose_deg is None else wrap_heading_deg(self.nose_deg + self.gimbal_yaw_deg)
        return ReadPhoto(heading, _pitch_deg(self.pitch_deg), suffix if self.is_ours else "")

    def _oriented_photo(self, action: Action) -> ReadPhoto:
        """A photo that says all its angles itself; the gimbal's yaw counts from north."""
        self.nose_deg, self.gimbal_yaw_deg = _finite(action.number("aircraftHeading")), 0.0
        self.pitch_deg = _finite(action.number("gimbalPitchRotateAngle"))
        yaw = _finite(action.number("gimbalYawRotateAngle"))
        heading = self.nose_deg if yaw is None else yaw
        return ReadPhoto(None if heading is None else wrap_heading_deg(heading), _pitch_deg(self.pitch_deg))


def _place(waypoint: WpmlWaypoint) -> FlownPoint:
    assert waypoint.lat_deg is not None  # missions.dji.check made sure of all three
    assert waypoint.lon_deg is not None
    assert waypoint.execute_height_m is not None
    return FlownPoint(waypoint.lat_deg, waypoint.lon_deg, waypoint.execute_height_m)


def _cut_m(waypoint: WpmlWaypoint) -> float:
    """How far before a waypoint that is flown through the turn begins; as early as it likes on a curved route."""
    damping_m = waypoint.turn_damping_m or 0.0
    return damping_m if damping_m > 0.0 else math.inf


def _turned_deg(before: tuple[float | None, float | None], after: tuple[float | None, float | None]) -> float:
    """The longer of the turns of nose and gimbal; what is not known is not counted."""
    (nose_0, pitch_0), (nose_1, pitch_1) = before, after
    nose = 0.0 if nose_0 is None or nose_1 is None else abs(wrap_heading_deg(nose_1 - nose_0))
    pitch = 0.0 if pitch_0 is None or pitch_1 is None else abs(pitch_1 - pitch_0)
    return max(nose, pitch)


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else value


def _pitch_deg(value: float | None) -> float | None:
    """A gimbal pitch that a camera can have; None for any other."""
    return value if value is not None and -180.0 <= value <= 90.0 else None


def _speed_m_s(waypoint: WpmlWaypoint, folder: Folder) -> float | None:
    """Speed on the leg from a waypoint; None where neither it nor the wayline has one that can be flown."""
    return next((v for v in (waypoint.speed_m_s, folder.speed_m_s) if v is not None and 0.0 < v < math.inf), None)


# What a mission tells the camera. WPML has actions for focus and zoom, and a template has focusMode and meteringMode,
# which DJI documents for the M300 and M350 alone. Nothing says exposure, ISO, shutter, aperture or white balance.

WITH_FOCUS_MODE = ((60, 0), (89, 0))
"""droneEnumValue and droneSubEnumValue of the M300 and M350."""

AIMED_FOCUS = ("orientedShoot", "accurateShoot")
"""Photos that focus by themselves on a region of their own."""


def _camera_of(parts: DjiParts, folder: Folder, place: str) -> tuple[ReadCamera, list[Finding]]:
    """What a wayline tells the camera, and what there is to say of it."""
    actions = [*folder.start_actions]
    actions += [action for waypoint in folder.waypoints for group in waypoint.groups for action in group.actions]
    focusing = [action.is_on("isInfiniteFocus") for action in actions if action.func == "focus"]
    infinite = sum(focusing)
    automatic = len(focusing) - infinite + sum(action.func in AIMED_FOCUS for action in actions)
    is_held = any(a.func == "setFocusType" and a.params.get("cameraFocusType") == "manual" for a in actions)
    focus: FocusMode | None = None
    findings: list[Finding] = []

    def note(text: str, severity: Severity = Severity.NOTE) -> None:
        findings.append(Finding(severity, "camera", text, place))

    template = parts.template.folders[0] if parts.template is not None and parts.template.folders else None
    has_mode = template is not None and parts.waylines.config.drone in WITH_FOCUS_MODE
    mode = template.focus_mode if template is not None and has_mode else ""
    if automatic and infinite:
        note(say("it focuses at infinity for some photos and automatically for others, which is not taken over"))
    elif infinite:
        focus = "infinity"
    elif automatic:
        focus = "lock" if is_held and automatic == 1 else "auto"
    elif is_held or mode == "custom":
        note(say("the focus is set by hand before the flight, and the file does not say to which distance"))
    elif mode == "firstPoint":
        focus = "lock"
    if focus is not None:
        note(say("its camera: {}", FOCUSES[focus]))
    if template is not None and template.metering_mode == "spot":
        note(say("its camera measures exposures at a spot; plans do not say that, so set it on the controller"))
    zooms = {value for a in actions if a.func == "zoom" and (value := _finite(a.number("focalLength"))) is not None}
    if len(zooms) > 1:
        lengths = ", ".join(f"{value:g}" for value in sorted(zooms))
        text = say("it zooms to {} mm (35 mm equivalent), but all photos count with one field of view", lengths)
        note(text, Severity.WARNING)
    return (NOTHING_SAID if focus is None else ReadCamera(focus=focus)), findings


_FINISH = {"goHome": Finish.RETURN, "autoLand": Finish.LAND}


def read_dji(path: Path, *, strict: bool = False) -> tuple[ReadMission, ...]:
    """The waylines of a KMZ, or of a folder with its two unpacked parts.

    The waylines count, as for the aircraft; where the template says otherwise a finding tells. What an aircraft would
    refuse is a finding, too, and no reason to refuse, unless `strict` asks for it or the path is not known.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        It is no DJI mission, its path is not in the file, or aircraft refuse it, if `strict`; the message says why.
    """
    parts = load_parts(path)
    findings = check_dji(parts)
    errors = [finding for finding in findings if finding.severity is Severity.ERROR]
    unknown = [finding for finding in errors if _hides_path(finding)]
    if unknown or (strict and errors):
        others = [finding for finding in errors if finding not in unknown]
        raise MissionError.say("aircraft would refuse this mission: {}", reasons([*unknown, *others]), place=path)
    remarks = tuple(map(as_warning, findings))
    return tuple(_read_wayline(path, parts, folder, remarks) for folder in parts.waylines.folders)


def _hides_path(error: Finding) -> bool:
    """Whether an error leaves open where the aircraft flies: no waypoints, no place, no height, heights of no kind."""
    return error.code in ("coordinates", "height-mode") or (
        error.code in ("height", "waypoint-count") and error.value in (None, 0.0)
    )


def _read_wayline(path: Path, parts: DjiParts, folder: Folder, findings: tuple[Finding, ...]) -> ReadMission:
    if folder.height_mode == "realTimeFollowSurface":
        raise MissionError.say(
            "the mission follows the ground as the aircraft senses it, so its heights are not in the file; "
            "save it with fixed heights",
            place=path,
        )
    is_relative = folder.height_mode == "relativeToStartPoint"
    is_ours = _is_ours(parts)
    flight = Flight(folder, is_ours)
    flown = flight.points()
    if is_ours:
        flown = [replace(point, stay=None) for point in flown]
    several = len(parts.waylines.folders) > 1
    camera, on_camera = _camera_of(parts, folder, path.stem)
    return ReadMission(
        name=f"{path.stem}-{(folder.wayline_id or 0) + 1}" if several else path.stem,
        path=path,
        format=FileFormat.DJI_KMZ,
        waypoints=tuple(_waypoint(point, is_relative=is_relative) for point in flown),
        takeoff=_takeoff(parts),
        height_reference=HeightReference.ABOVE_TAKEOFF if is_relative else HeightReference.ELLIPSOID,
        finish=_FINISH.get(parts.waylines.config.finish_action, Finish.HOVER),
        climb_above_takeoff_m=parts.waylines.config.takeoff_security_height_m or 0.0,
        return_above_takeoff_m=parts.waylines.config.rth_height_m or 0.0,
        speed_m_s=_possible(folder.speed_m_s),
        transit_speed_m_s=_possible(parts.waylines.config.transitional_speed_m_s),
        stated_s=None if is_ours else folder.duration_s,
        findings=(*findings, *flight.findings, *on_camera),
        camera=camera,
    )


def _possible(speed_m_s: float | None) -> float | None:
    """A speed, or None where it is none."""
    return speed_m_s if speed_m_s is not None and 0.0 < speed_m_s < math.inf else None


def _is_ours(parts: DjiParts) -> bool:
    return parts.template is not None and parts.template.author == "Reflight"


def _waypoint(point: FlownPoint, *, is_relative: bool) -> ReadWaypoint:
    height = {"height_above_takeoff_m" if is_relative else "height_ellipsoid_m": point.height_m}
    return ReadWaypoint(
        point.lat_deg, point.lon_deg, photos=point.photos, stay=point.stay, speed_m_s=point.speed_m_s, **height
    )


def _takeoff(parts: DjiParts) -> GeoPoint | None:
    """The template's takeOffRefPoint; latitude and longitude 0 mean that only a height was recorded."""
    reference = None if parts.template is None else parts.template.config.takeoff_ref_lat_lon_height
    if reference is None or reference[:2] == (0.0, 0.0) or not is_on_globe(reference):
        return None
    return GeoPoint(*reference)
