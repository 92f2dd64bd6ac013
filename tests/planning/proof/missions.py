"""Mission files as the judge reads them: where they lead, in 40 digits, and which photos they take there.

The readers know what the exporters write and refuse the rest; they share nothing with the verifiers or with ours.
"""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import mpmath

if TYPE_CHECKING:
    from tests.planning.proof.claims import Case

PLACE_M, ANGLE_DEG = 0.01, 0.01
"""How far a mission may be off its plan, as the claim says."""

SLACK = 1e-6
"""Of both, for the judge's own doubt about what is meant: a difference this much larger is certainly one."""

Place = tuple[Any, Any, Any]
Photos = list[tuple[float, float]]


@dataclass(frozen=True, slots=True)
class Stop:
    """A place, local metres, and heading and pitch of the photos taken there, degrees."""

    place: Place
    photos: Photos


class NotThePlanError(Exception):
    """The file does what no plan of ours asks for."""


def _ecef(lat_deg: Any, lon_deg: Any, height_m: Any) -> Place:
    a, f = mpmath.mpf(6378137), 1 / mpmath.mpf("298.257223563")
    e2 = f * (2 - f)
    lat, lon = mpmath.radians(mpmath.mpf(lat_deg)), mpmath.radians(mpmath.mpf(lon_deg))
    n = a / mpmath.sqrt(1 - e2 * mpmath.sin(lat) ** 2)
    flat = (n + height_m) * mpmath.cos(lat)
    return flat * mpmath.cos(lon), flat * mpmath.sin(lon), (n * (1 - e2) + height_m) * mpmath.sin(lat)


def _rows(origin: Any) -> tuple[Place, Place, Place]:
    lat, lon = (mpmath.radians(mpmath.mpf(origin[name])) for name in ("lat_deg", "lon_deg"))
    s, c, sl, cl = mpmath.sin(lat), mpmath.cos(lat), mpmath.sin(lon), mpmath.cos(lon)
    return (-sl, cl, mpmath.mpf(0)), (-s * cl, -s * sl, c), (c * cl, c * sl, s)


def enu(origin: Any, lat_deg: float, lon_deg: float, height_m: Any) -> Place:
    """Local coordinates of a geodetic place, to 40 digits."""
    with mpmath.workdps(40):
        at = _ecef(lat_deg, lon_deg, height_m)
        zero = _ecef(origin["lat_deg"], origin["lon_deg"], mpmath.mpf(origin["ellipsoid_height_m"]))
        d = [p - q for p, q in zip(at, zero, strict=True)]
        x, y, z = (sum(r * v for r, v in zip(row, d, strict=True)) for row in _rows(origin))
        return x, y, z


def height_of(origin: Any, place: Sequence[float]) -> Any:
    """Height above the ellipsoid of a local place, to 30 digits: the geodetic height that gives its local z."""
    with mpmath.workdps(40):
        zero = _ecef(origin["lat_deg"], origin["lon_deg"], mpmath.mpf(origin["ellipsoid_height_m"]))
        at = [
            q + sum(row[k] * mpmath.mpf(v) for row, v in zip(_rows(origin), place, strict=True))
            for k, q in enumerate(zero)
        ]
        f = 1 / mpmath.mpf("298.257223563")
        e2, a = f * (2 - f), mpmath.mpf(6378137)
        flat = mpmath.sqrt(at[0] ** 2 + at[1] ** 2)
        lat = mpmath.atan2(at[2], flat * (1 - e2))
        for _ in range(40):
            n = a / mpmath.sqrt(1 - e2 * mpmath.sin(lat) ** 2)
            lat = mpmath.atan2(at[2] + e2 * n * mpmath.sin(lat), flat)
        n = a / mpmath.sqrt(1 - e2 * mpmath.sin(lat) ** 2)
        return flat * mpmath.cos(lat) + at[2] * mpmath.sin(lat) - a * a / n


# DJI.


def _text(node: ElementTree.Element, name: str) -> str:
    found = [child for child in node.iter() if child.tag.rsplit("}", 1)[-1] == name]
    if len(found) != 1:
        raise NotThePlanError(f"{len(found)} elements {name}")
    return (found[0].text or "").strip()


def _all(node: ElementTree.Element, name: str) -> list[ElementTree.Element]:
    return [child for child in node.iter() if child.tag.rsplit("}", 1)[-1] == name]


def _expect(found: str, *expected: str) -> None:
    if found not in expected:
        raise NotThePlanError(f"{found}, not {expected}")


def _kmz(content: bytes, origin: Any, home: Sequence[float]) -> list[Stop]:
    archive = zipfile.ZipFile(io.BytesIO(content))
    if sorted(archive.namelist()) != ["wpmz/template.kml", "wpmz/waylines.wpml"]:
        raise NotThePlanError("other members")
    template, lines = (
        ElementTree.fromstring(archive.read(f"wpmz/{name}")) for name in ("template.kml", "waylines.wpml")
    )
    if len(_all(lines, "Folder")) != 1 or len(_all(template, "Folder")) != 1:
        raise NotThePlanError("more than one flight")
    _expect(_text(lines, "flyToWaylineMode"), "safely")
    _expect(_text(lines, "finishAction"), "goHome")
    mode = _text(lines, "executeHeightMode")
    _expect(mode, "relativeToStartPoint", "WGS84")
    for name in ("globalWaypointTurnMode", "waypointTurnMode"):
        for node in (*_all(lines, name), *_all(template, name)):
            _expect(node.text or "", "toPointAndStopWithDiscontinuityCurvature")
    for name in ("useStraightLine", "globalUseStraightLine"):
        for node in (*_all(lines, name), *_all(template, name)):
            _expect(node.text or "", "1")
    start = height_of(origin, home)
    # The app on the controller makes its waylines anew from the template.
    name_of_height = "height" if mode == "relativeToStartPoint" else "ellipsoidHeight"
    stops, drafts = [], list[tuple[float, float, float, Photos]]()
    for k, mark in enumerate(_all(template, "Placemark")):
        drafts.append((*_coordinates(mark), float(_text(mark, name_of_height)), _dji_photos(mark, k)))
    for k, mark in enumerate(_all(lines, "Placemark")):
        _text(mark, "waypointTurnMode")
        _text(mark, "useStraightLine")
        _expect(_text(mark, "index"), str(k))
        lon, lat = _coordinates(mark)
        height = float(_text(mark, "executeHeight"))
        above = mpmath.mpf(height) + (start if mode == "relativeToStartPoint" else 0)
        stops.append(Stop(enu(origin, lat, lon, above), _dji_photos(mark, k)))
        if k >= len(drafts) or drafts[k] != (lon, lat, height, stops[-1].photos):
            raise NotThePlanError("template and waylines differ")
    return stops


def _coordinates(mark: ElementTree.Element) -> tuple[float, float]:
    lon, lat = _text(mark, "coordinates").split(",")
    return float(lon), float(lat)


def _dji_photos(mark: ElementTree.Element, k: int) -> Photos:
    photos: Photos = []
    heading = pitch = math.nan
    for group in _all(mark, "actionGroup"):
        _expect(_text(group, "actionGroupStartIndex"), str(k))
        _expect(_text(group, "actionGroupEndIndex"), str(k))
        _expect(_text(group, "actionTriggerType"), "reachPoint")
        for action in _all(group, "action"):
            kind = _text(action, "actionActuatorFunc")
            if kind == "rotateYaw":
                heading = float(_text(action, "aircraftHeading"))
            elif kind == "gimbalRotate":
                _expect(_text(action, "gimbalPitchRotateEnable"), "1")
                _expect(_text(action, "gimbalRotateMode"), "absoluteAngle")
                pitch = float(_text(action, "gimbalPitchRotateAngle"))
            elif kind == "takePhoto":
                photos.append((heading, pitch))
            else:
                _expect(kind, "zoom", "focus", "setFocusType", "hover")
    return photos


# MAVLink.

Item = tuple[int, int, list[float]]
"""Command, frame and seven parameters."""

TAKEOFF, LAND, WAYPOINT, DELAY, YAW, SPEED = 22, 21, 16, 93, 115, 178
DIGICAM, MOUNT, GIMBAL, GIMBAL_OWNER, CAPTURE = 203, 205, 1000, 1001, 2000
EXPOSURE, FOCUS = 202, 532


def _plan_items(content: bytes) -> list[Item]:
    from tests.planning.proof.claims import read_json

    mission = read_json(content)["mission"]
    items = []
    for item in mission["items"]:
        _expect(item["type"], "SimpleItem")
        # QGroundControl flies these two, and not the last parameter and the frame.
        if item.get("Altitude", item["params"][6]) != item["params"][6]:
            raise NotThePlanError("two altitudes")
        if item["frame"] == 3 and item.get("AltitudeMode", 1) != 1:
            raise NotThePlanError("another altitude mode")
        params = [math.nan if value is None else float(value) for value in item["params"]]
        items.append((item["command"], item["frame"], params))
    return items


def _wpl_items(content: bytes) -> list[Item]:
    lines = content.decode("ascii").split("\n")
    _expect(lines[0].strip(), "QGC WPL 110")
    items = []
    for k, line in enumerate(line for line in lines[1:] if line.strip()):
        fields = line.strip().split("\t")
        if len(fields) != 12 or fields[0] != str(k):
            raise NotThePlanError("lines out of order")
        items.append((int(fields[3]), int(fields[2]), [float(value) for value in fields[4:11]]))
    return items[1:]


def _mavlink(items: list[Item], origin: Any, home: Sequence[float]) -> list[Stop]:
    start = height_of(origin, home)
    stops: list[Stop] = []
    heading = pitch = math.nan
    if not items or items[0][0] != TAKEOFF or items[-1][0] != LAND:
        raise NotThePlanError("no take-off or landing")
    for k, (command, frame, params) in enumerate(items):
        if command in (TAKEOFF, LAND, WAYPOINT):
            _expect(str(frame), "3")
            if command == WAYPOINT and not (params[0] >= 1.0 and params[1] <= 0.5 and params[2] == 0.0):
                raise NotThePlanError("a corner is cut")
            place = enu(origin, params[4], params[5], mpmath.mpf(params[6]) + start)
            if (command == TAKEOFF) != (k == 0) or (command == LAND) != (k == len(items) - 1):
                raise NotThePlanError("take-off or landing on the way")
            if command == WAYPOINT and not math.isnan(params[3]) and params[3] != 0.0:
                heading = params[3]
            stops.append(Stop(place, []))
        elif command in (MOUNT, GIMBAL):
            pitch = params[0]
            if params[1] != 0.0 or (command == MOUNT and (params[2] != 0.0 or params[6] != 2.0)):
                raise NotThePlanError("the camera pans or rolls")
        elif command == YAW:
            heading = params[0]
            if params[3] != 0.0:
                raise NotThePlanError("a turn by, not to an angle")
        elif command in (DIGICAM, CAPTURE):
            if (params[4] != 1.0) if command == DIGICAM else (params[2] != 1.0):
                raise NotThePlanError("not one photo")
            stops[-1].photos.append((heading, pitch))
        elif command not in (DELAY, SPEED, GIMBAL_OWNER, EXPOSURE, FOCUS):
            raise NotThePlanError(f"command {command}")
    return stops


# The claims.


def stops_of(case: Case, name: str) -> list[Stop]:
    """Where a mission file leads."""
    origin, home, content = case.site["origin"], case.home, case.files[name]
    if name.endswith(".kmz"):
        return _kmz(content, origin, home)
    items = _plan_items(content) if name.endswith(".plan") else _wpl_items(content)
    return _mavlink(items, origin, home)


def _apart(a: Sequence[Any], b: Sequence[float]) -> Any:
    return mpmath.sqrt(sum((p - q) ** 2 for p, q in zip(a, b, strict=True)))


def _turned(a: float, b: float) -> float:
    return abs((a - b + 180.0) % 360.0 - 180.0)


def sortie_of(case: Case, name: str) -> int | None:
    """The sortie that a mission flies; None where there is none."""
    key = f"sortie of {name}"
    if key not in case._read:
        case._read[key] = _sortie_of(case, name)
    found: int | None = case._read[key]
    return found


def _sortie_of(case: Case, name: str) -> int | None:
    merged: list[Stop] = []
    for stop in stops_of(case, name):
        if merged and _apart(stop.place, [float(x) for x in merged[-1].place]) < 2e-3:
            merged[-1].photos.extend(stop.photos)
        else:
            merged.append(Stop(stop.place, list(stop.photos)))
    views = {view["id"]: view for view in case.plan["viewpoints"]}
    for number, sortie in enumerate(case.plan["sorties"]):
        places: list[list[float]] = []
        # DJI missions end above home and return by themselves.
        for vertex in sortie["path_enu_m"][1 : -1 if name.endswith(".kmz") else None]:
            if not places or math.dist(vertex, places[-1]) >= 2e-3:
                places.append(vertex)
        wanted = [(views[v]["heading_deg"], views[v]["gimbal_pitch_deg"]) for v in sortie["viewpoint_ids"]]
        taken = [photo for stop in merged for photo in stop.photos]
        at = [views[v]["position_enu_m"] for v in sortie["viewpoint_ids"]]
        where = [stop.place for stop in merged for _ in stop.photos]
        if (
            len(places) == len(merged)
            and len(wanted) == len(taken)
            and all(_apart(stop.place, place) <= PLACE_M + SLACK for stop, place in zip(merged, places, strict=True))
            and all(_apart(p, q) <= 2 * PLACE_M for p, q in zip(where, at, strict=True))
            and all(
                _turned(a[0], b[0]) <= ANGLE_DEG + SLACK and abs(a[1] - b[1]) <= ANGLE_DEG + SLACK
                for a, b in zip(taken, wanted, strict=True)
            )
        ):
            return number
    return None


def mission(case: Case, name: str) -> bool:
    """It flies one sortie of the plan."""
    return sortie_of(case, name) is not None


def missions(case: Case) -> bool:
    """The files of each kind fly every sortie exactly once."""
    kinds: dict[str, list[int | None]] = {}
    for name in case.files:
        ending = name.rsplit(".", 1)[-1]
        if ending in ("kmz", "waypoints", "txt") or (ending == "plan" and name != "plan.json"):
            kinds.setdefault(ending, []).append(sortie_of(case, name))
    every = list(range(len(case.plan["sorties"])))
    return bool(kinds) and all(None not in found and sorted(found) == every for found in kinds.values())  # type: ignore[type-var]
