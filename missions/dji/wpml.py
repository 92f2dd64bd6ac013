"""The KMZ that DJI aircraft read, the numbers WPML has for aircraft and cameras, and its content as records.

The content of template.kml and waylines.wpml is read as tolerantly as a check of it needs. Nothing is judged here but
whether the text is XML and WPML at all: a missing element is None, an element that does not hold what it should is
None and listed in `WpmlDocument.garbled`. `missions.dji.check` says what is wrong, `missions.dji.read` what the
aircraft would do.
"""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from missions.mission.safe_files import open_archive, read_limited, read_member
from planning.base.errors import MissionError
from planning.base.files import HostileXml, local_name, parse_xml
from planning.base.json_file import read_toml
from planning.base.messages import about, say

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


# DJI's numbers for aircraft and cameras, which go together, and our profiles in those terms: `data/dji.toml`.

DATA_PATH = Path(__file__).parents[1] / "data" / "dji.toml"


@dataclass(frozen=True, slots=True)
class Drone:
    """An aircraft: droneEnumValue and droneSubEnumValue, the payloads it may carry, and whether DJI Fly flies it."""

    numbers: tuple[int, int]
    payloads: tuple[str, ...]
    dji_fly: bool = False


@dataclass(frozen=True, slots=True)
class Payload:
    """A camera: its payloadEnumValue and the pitch range of its gimbal, degrees (None: not published)."""

    number: int
    gimbal_pitch_deg: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class DjiProfile:
    """How one of our profiles is written; `data/dji.toml` explains the fields."""

    drone: str
    payload: str
    lens: str
    focus: bool
    wide_zoom_mm: float
    infinity: bool = False
    focus_mode: bool = False


@dataclass(frozen=True, slots=True)
class Lenses:
    """Names that payloadLensIndex and imageFormat may hold."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class DjiCatalogue:
    """The content of `data/dji.toml`."""

    drones: dict[str, Drone]
    payloads: dict[str, Payload]
    profiles: dict[str, DjiProfile]
    lenses: Lenses

    def drone_by_numbers(self, numbers: tuple[int, int]) -> Drone | None:
        """Aircraft with these droneEnumValue and droneSubEnumValue; None where it is not known."""
        return next((drone for drone in self.drones.values() if drone.numbers == numbers), None)

    def payload_by_number(self, number: int) -> Payload | None:
        """Camera with this payloadEnumValue; None where it is not known."""
        return next((payload for payload in self.payloads.values() if payload.number == number), None)


@cache
def dji_catalogue() -> DjiCatalogue:
    """DJI's numbers and names."""
    return read_toml(DATA_PATH, DjiCatalogue)


def dji_profile(identifier: str) -> DjiProfile:
    """How a profile is written for DJI.

    Raises
    ------
    MissionError
        The profile is none of DJI's aircraft that are known here; which numbers to write must not be guessed.
    """
    known = dji_catalogue().profiles
    if identifier not in known:
        found = say("the profile '{}'", identifier) if identifier else say("no profile")
        raise MissionError.say(
            "a DJI mission names its aircraft and camera, but the plan has {}; expected one of {}; plan with "
            "one of them, or export for MAVLink",
            found,
            ", ".join(sorted(known)),
        )
    return known[identifier]


Number = TypeVar("Number", int, float)

_WPML_NAMESPACE = re.compile(r"\{https?://www\.(?:dji|uav)\.com/wpmz/(\d+\.\d+\.\d+)\}")


@dataclass(frozen=True, slots=True)
class Action:
    """One action: its actionActuatorFunc and the text of each parameter."""

    action_id: int | None
    func: str
    params: dict[str, str]

    def number(self, name: str) -> float | None:
        """A numeric parameter; None where it is missing or no number."""
        return _as_number(self.params.get(name, ""), float)

    def is_on(self, name: str) -> bool:
        """Whether a 0/1 parameter is 1."""
        return self.params.get(name, "") in ("1", "true")


@dataclass(frozen=True, slots=True)
class ActionGroup:
    """Actions and what triggers them between two waypoint indices, both included."""

    group_id: int | None
    start_index: int | None
    end_index: int | None
    trigger: str
    trigger_param: float | None
    actions: tuple[Action, ...]


@dataclass(frozen=True, slots=True)
class WpmlWaypoint:
    """One Placemark with a Point. `execute_height_m` stands in waylines, the other two heights in templates."""

    index: int | None
    lon_deg: float | None
    lat_deg: float | None
    execute_height_m: float | None
    height_m: float | None
    ellipsoid_height_m: float | None
    speed_m_s: float | None
    heading_mode: str
    heading_angle_deg: float | None
    heading_angle_enable: bool
    heading_path_mode: str
    poi_lat_lon_deg: tuple[float, float] | None
    turn_mode: str
    turn_damping_m: float | None
    use_straight_line: bool
    gimbal_heading: bool
    groups: tuple[ActionGroup, ...]


@dataclass(frozen=True, slots=True)
class Folder:
    """One wayline, or one template. `height_mode` is executeHeightMode in waylines and heightMode in templates."""

    template_type: str
    wayline_id: int | None
    height_mode: str
    speed_m_s: float | None
    distance_m: float | None
    duration_s: float | None
    image_format: str
    start_actions: tuple[Action, ...]
    waypoints: tuple[WpmlWaypoint, ...]
    focus_mode: str = ""
    metering_mode: str = ""


@dataclass(frozen=True, slots=True)
class MissionConfig:
    """The missionConfig element. `payloads` are (payloadEnumValue, payloadPositionIndex)."""

    fly_to_wayline_mode: str
    finish_action: str
    exit_on_rc_lost: str
    rc_lost_action: str
    takeoff_security_height_m: float | None
    takeoff_ref_lat_lon_height: tuple[float, float, float] | None
    transitional_speed_m_s: float | None
    rth_height_m: float | None
    drone: tuple[int, int] | None
    payloads: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class WpmlDocument:
    """template.kml or waylines.wpml."""

    version: str
    author: str
    config: MissionConfig
    folders: tuple[Folder, ...]
    garbled: tuple[str, ...]


def parse_wpml(content: bytes, part: str) -> WpmlDocument:
    """Records of one part of a mission.

    Parameters
    ----------
    part
        Name of the file, for messages.

    Raises
    ------
    MissionError
        The content is not XML, declares entities (which no mission needs and attacks do), or is not WPML.
    """
    try:
        root = parse_xml(content, part)
    except HostileXml as error:
        raise MissionError.say("{}, which no mission needs; refused as hostile", error, place=part) from error
    except ValueError as error:
        raise MissionError.say("not readable as XML ({}); export the mission again", error, place=part) from error
    version = next((found[1] for element in root.iter() if (found := _WPML_NAMESPACE.match(element.tag))), "")
    document = _child(root, "Document")
    if not version or document is None:
        raise MissionError.say(
            "this is XML, but not a DJI mission; expected kml/Document with the namespace "
            "http://www.dji.com/wpmz/1.0.x, found <{}>",
            local_name(root),
            place=part,
        )
    return _Parser().document(document, version)


def _children(element: Element | None, name: str) -> Iterator[Element]:
    return (child for child in (element if element is not None else ()) if local_name(child) == name)


def _child(element: Element | None, name: str) -> Element | None:
    return next(_children(element, name), None)


def _text(element: Element | None, name: str) -> str:
    child = _child(element, name)
    return "" if child is None else (child.text or "").strip()


def _as_number(text: str, kind: Callable[[str], Number]) -> Number | None:
    try:
        return None if "_" in text else kind(text)
    except ValueError:
        return None


@dataclass(slots=True)
class _Parser:
    """Elements to records; collects the texts that are no numbers where numbers belong."""

    garbled: list[str] = field(default_factory=list)

    def number(self, element: Element | None, name: str, kind: Callable[[str], Number]) -> Number | None:
        """Number in a child element; None, noted in `garbled`, where it holds something else."""
        text = _text(element, name)
        value = _as_number(text, kind)
        if text and value is None:
            self.garbled.append(say("{} is '{}'", name, text[:40]))
        return value

    def numbers(self, text: str, n: int, name: str) -> tuple[float, ...] | None:
        """The first `n` numbers of a comma-separated text; None where there are fewer."""
        values = [_as_number(part.strip(), float) for part in text.split(",")[:n]]
        found = tuple(value for value in values if value is not None)
        if len(found) == n:
            return found
        if text:
            self.garbled.append(say("{} is '{}'", name, text[:40]))
        return None

    def document(self, element: Element, version: str) -> WpmlDocument:
        config = self.config(_child(element, "missionConfig"))
        folders = tuple(self.folder(folder) for folder in _children(element, "Folder"))
        return WpmlDocument(version, _text(element, "author"), config, folders, tuple(self.garbled))

    def config(self, element: Element | None) -> MissionConfig:
        drone = _child(element, "droneInfo")
        drone_number = self.number(drone, "droneEnumValue", int)
        payloads = [
            (self.number(payload, "payloadEnumValue", int), self.number(payload, "payloadPositionIndex", int) or 0)
            for payload in _children(element, "payloadInfo")
        ]
        reference = self.numbers(_text(element, "takeOffRefPoint"), 3, "takeOffRefPoint")
        return MissionConfig(
            fly_to_wayline_mode=_text(element, "flyToWaylineMode"),
            finish_action=_text(element, "finishAction"),
            exit_on_rc_lost=_text(element, "exitOnRCLost"),
            rc_lost_action=_text(element, "executeRCLostAction"),
            takeoff_security_height_m=self.number(element, "takeOffSecurityHeight", float),
            takeoff_ref_lat_lon_height=None if reference is None else (reference[0], reference[1], reference[2]),
            transitional_speed_m_s=self.number(element, "globalTransitionalSpeed", float),
            rth_height_m=self.number(element, "globalRTHHeight", float),
            drone=None if drone_number is None else (drone_number, self.number(drone, "droneSubEnumValue", int) or 0),
            payloads=tuple((number, position) for number, position in payloads if number is not None),
        )

    def folder(self, element: Element) -> Folder:
        placemarks = [p for p in _children(element, "Placemark") if _child(p, "Point") is not None]
        coordinates = _child(element, "waylineCoordinateSysParam")
        return Folder(
            template_type=_text(element, "templateType"),
            wayline_id=self.number(element, "waylineId", int),
            height_mode=_text(element, "executeHeightMode") or _text(coordinates, "heightMode"),
            speed_m_s=self.number(element, "autoFlightSpeed", float),
            distance_m=self.number(element, "distance", float),
            duration_s=self.number(element, "duration", float),
            image_format=_text(_child(element, "payloadParam"), "imageFormat"),
            start_actions=self.actions(_child(element, "startActionGroup")),
            waypoints=tuple(self.waypoint(placemark) for placemark in placemarks),
            focus_mode=_text(_child(element, "payloadParam"), "focusMode"),
            metering_mode=_text(_child(element, "payloadParam"), "meteringMode"),
        )

    def waypoint(self, element: Element) -> WpmlWaypoint:
        heading, turn = _child(element, "waypointHeadingParam"), _child(element, "waypointTurnParam")
        position = self.numbers(_text(_child(element, "Point"), "coordinates"), 2, "coordinates")
        poi = self.numbers(_text(heading, "waypointPoiPoint"), 2, "waypointPoiPoint")
        return WpmlWaypoint(
            index=self.number(element, "index", int),
            lon_deg=None if position is None else position[0],
            lat_deg=None if position is None else position[1],
            execute_height_m=self.number(element, "executeHeight", float),
            height_m=self.number(element, "height", float),
            ellipsoid_height_m=self.number(element, "ellipsoidHeight", float),
            speed_m_s=self.number(element, "waypointSpeed", float),
            heading_mode=_text(heading, "waypointHeadingMode"),
            heading_angle_deg=self.number(heading, "waypointHeadingAngle", float),
            heading_angle_enable=_text(heading, "waypointHeadingAngleEnable") in ("1", "true"),
            heading_path_mode=_text(heading, "waypointHeadingPathMode"),
            poi_lat_lon_deg=None if poi is None else (poi[0], poi[1]),
            turn_mode=_text(turn, "waypointTurnMode"),
            turn_damping_m=self.number(turn, "waypointTurnDampingDist", float),
            use_straight_line=_text(element, "useStraightLine") in ("1", "true"),
            gimbal_heading=_child(element, "waypointGimbalHeadingParam") is not None,
            groups=tuple(self.group(group) for group in _children(element, "actionGroup")),
        )

    def group(self, element: Element) -> ActionGroup:
        trigger = _child(element, "actionTrigger")
        return ActionGroup(
            group_id=self.number(element, "actionGroupId", int),
            start_index=self.number(element, "actionGroupStartIndex", int),
            end_index=self.number(element, "actionGroupEndIndex", int),
            trigger=_text(trigger, "actionTriggerType"),
            trigger_param=self.number(trigger, "actionTriggerParam", float),
            actions=self.actions(element),
        )

    def actions(self, element: Element | None) -> tuple[Action, ...]:
        return tuple(self.action(action) for action in _children(element, "action"))

    def action(self, element: Element) -> Action:
        params = _child(element, "actionActuatorFuncParam")
        return Action(
            action_id=self.number(element, "actionId", int),
            func=_text(element, "actionActuatorFunc"),
            params={local_name(p): (p.text or "").strip() for p in (params if params is not None else ())},
        )


# Where the two parts of a DJI mission lie: in the folder wpmz of a KMZ, or side by side in an unpacked folder.

TEMPLATE, WAYLINES = "template.kml", "waylines.wpml"


@dataclass(frozen=True, slots=True)
class DjiParts:
    """The parts of a mission; without a template only some programs open it."""

    waylines: WpmlDocument
    template: WpmlDocument | None


def load_parts(path: Path) -> DjiParts:
    """Parts of a mission from a KMZ, from a folder that holds them (or their folder wpmz), or from one of the two.

    Raises
    ------
    InputError
        The file or folder is missing or unreadable.
    MissionError
        It is no DJI mission, has another layout than DJI's programs find, or is hostile.
    """
    if path.is_dir() or path.name in (TEMPLATE, WAYLINES):
        return _from_folder(path if path.is_dir() else path.parent)
    return _from_archive(path, str(path))


def parts_of_kmz(content: bytes) -> DjiParts:
    """Parts of a KMZ that is not in a file yet."""
    return _from_archive(io.BytesIO(content), "KMZ")


def _from_archive(source: Path | io.BytesIO, label: str) -> DjiParts:
    archive, members = open_archive(source, label)
    with archive:
        waylines = members.get(f"wpmz/{WAYLINES}")
        if waylines is None:
            raise MissionError(about(label, _what_is_there(set(members))))
        template = members.get(f"wpmz/{TEMPLATE}")
        inside = f"{label}: wpmz/"
        return DjiParts(
            parse_wpml(read_member(archive, waylines, label), inside + WAYLINES),
            None if template is None else parse_wpml(read_member(archive, template, label), inside + TEMPLATE),
        )


def _from_folder(folder: Path) -> DjiParts:
    inner = folder / "wpmz"
    folder = inner if inner.is_dir() else folder
    if not (folder / WAYLINES).is_file():
        raise MissionError.say("expected the {} of an unpacked DJI mission, there is none", WAYLINES, place=folder)
    template = folder / TEMPLATE
    return DjiParts(
        parse_wpml(read_limited(folder / WAYLINES), str(folder / WAYLINES)),
        parse_wpml(read_limited(template), str(template)) if template.is_file() else None,
    )


def _what_is_there(names: set[str]) -> str:
    """Why an archive without wpmz/waylines.wpml is no mission, from what it holds instead."""
    at_root = sorted(names & {TEMPLATE, WAYLINES})
    elsewhere = sorted(name for name in names if name.endswith(("/" + TEMPLATE, "/" + WAYLINES)))
    if at_root:
        return say(
            "{} at the top of the archive, where no DJI program looks; expected both in its folder wpmz; "
            "pack it again with that folder",
            " and ".join(at_root),
        )
    if f"wpmz/{TEMPLATE}" in names:
        return say(
            "has a template but no waylines, so what would be flown is not in it; open and save it in DJI Pilot 2"
        )
    if elsewhere:
        return say("has {}; expected wpmz/{} at the top of the archive; pack it again", elsewhere[0], WAYLINES)
    return say("no DJI mission; expected wpmz/{}, found {}", WAYLINES, ", ".join(sorted(names)[:3]) or "nothing")
