"""QGroundControl's `.plan` files: simple items and fence polygons written, generated items of surveys read as well."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeGuard

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.items import MavlinkFile, MissionItem, Params, Polygon, RallyPlace, home_of
from missions.mission.export_choices import HeightReference
from missions.mission.model import GeoPoint, altitude_amsl_m
from planning.base.errors import InputError, MissionError
from planning.base.findings import Finding
from planning.base.json_file import read_json
from planning.base.messages import say

PLAN_VERSION, MISSION_VERSION, FENCE_VERSION, RALLY_VERSION = 1, 2, 2, 2

ALTITUDE_MODE = {HeightReference.ABOVE_TAKEOFF: 1, HeightReference.AMSL: 2}

VEHICLE_MULTIROTOR = 2
"""MAV_TYPE_QUADROTOR, which QGroundControl writes for any multirotor."""

VIEWPOINT_KEY = "viewpointId"
"""Our own key in the items that take a photo; other programs ignore it."""


def plan_json_bytes(
    items: Sequence[MissionItem],
    home: GeoPoint,
    autopilot: Autopilot,
    speed_m_s: float,
    reference: HeightReference,
    fences: Sequence[Polygon] = (),
    rally: Sequence[GeoPoint] = (),
) -> bytes:
    """A mission as `.plan`; `fences` are polygons to stay out of, `rally` places to return to."""
    polygons = [{"inclusion": False, "polygon": [list(corner) for corner in fence], "version": 1} for fence in fences]
    content = {
        "fileType": "Plan",
        "geoFence": {"circles": [], "polygons": polygons, "version": FENCE_VERSION},
        "groundStation": "Reflight",
        "mission": {
            "cruiseSpeed": speed_m_s,
            "firmwareType": facts(autopilot).firmware_type,
            "globalPlanAltitudeMode": ALTITUDE_MODE[reference],
            "hoverSpeed": speed_m_s,
            "items": [_item_json(item, number) for number, item in enumerate(items, 1)],
            "plannedHomePosition": [
                round(home.lat_deg, 9),
                round(home.lon_deg, 9),
                round(altitude_amsl_m(home), 4),
            ],
            "vehicleType": VEHICLE_MULTIROTOR,
            "version": MISSION_VERSION,
        },
        "rallyPoints": {"points": [_rally_json(point, home) for point in rally], "version": RALLY_VERSION},
        "version": PLAN_VERSION,
    }
    return (json.dumps(content, indent=4, allow_nan=False) + "\n").encode()


def _rally_json(point: GeoPoint, home: GeoPoint) -> list[float]:
    """Latitude, longitude, and metres above home."""
    above_m = point.height_ellipsoid_m - home.height_ellipsoid_m
    return [round(point.lat_deg, 9), round(point.lon_deg, 9), round(above_m, 4) + 0.0]


def _item_json(item: MissionItem, number: int) -> dict[str, Any]:
    """A SimpleItem; NaN, which JSON has not, is null there."""
    content: dict[str, Any] = {
        "autoContinue": True,
        "command": item.command,
        "doJumpId": number,
        "frame": item.frame,
        "params": [None if math.isnan(value) else value for value in item.params],
        "type": "SimpleItem",
    }
    if item.frame in (0, 3):
        mode = ALTITUDE_MODE[HeightReference.AMSL if item.frame == 0 else HeightReference.ABOVE_TAKEOFF]
        content |= {"AMSLAltAboveTerrain": None, "Altitude": item.params[6], "AltitudeMode": mode}
    if item.viewpoint_id:
        content[VIEWPOINT_KEY] = item.viewpoint_id
    return content


def read_plan_json(path: Path) -> MavlinkFile:
    """Items of a `.plan`.

    Raises
    ------
    InputError
        The file is missing, unreadable, no JSON, or a plan of our own.
    MissionError
        It is no plan, of another version, or holds something whose items are not in the file.
    """
    content = read_json(path)
    if isinstance(content, dict) and str(content.get("format", "")).startswith("reflight-plan/"):
        raise InputError.say("this is a Reflight plan already; it needs no import", place=path)
    if not isinstance(content, dict) or content.get("fileType") != "Plan":
        raise MissionError.say("no QGroundControl plan; expected a JSON object with fileType 'Plan'", place=path)
    mission = content.get("mission")
    if not isinstance(mission, dict):
        raise MissionError.say(
            "the plan has no mission (it may hold a fence only); save it with its mission", place=path
        )
    for name, found, expected in (
        ("version", content.get("version"), PLAN_VERSION),
        ("mission.version", mission.get("version"), MISSION_VERSION),
    ):
        if found != expected:
            raise MissionError.say(
                "{} is {}; expected {}; save it with a current QGroundControl", name, found, expected, place=path
            )
    home, on_home = _home(mission.get("plannedHomePosition"))
    firmware = mission.get("firmwareType")
    autopilot = next((a for a in Autopilot if facts(a).firmware_type == firmware), None)
    speed = mission.get("hoverSpeed")
    items: list[MissionItem] = []
    for number, item in enumerate(_list(mission.get("items"), f"{path}: mission.items"), 1):
        items += _read_item(item, say("mission.items, item {}", number, place=path))
    return MavlinkFile(
        tuple(items),
        home,
        autopilot,
        float(speed) if _is_number(speed) and speed > 0 else None,
        tuple(_fences(content.get("geoFence"))),
        tuple(_rally(content.get("rallyPoints"))),
        on_home,
    )


def _read_item(item: Any, place: str) -> list[MissionItem]:
    """The items that a simple or complex item stands for."""
    if not isinstance(item, dict):
        raise MissionError.say("expected an object, got {}", _written(item), place=place)
    if item.get("type") == "ComplexItem":
        name = item.get("complexItemType", "unnamed")
        transects = item.get("TransectStyleComplexItem")
        generated = transects.get("Items") if isinstance(transects, dict) else None
        if not generated:
            raise MissionError.say(
                "the complex item '{}' does not hold the items it generates, which only QGroundControl can make; "
                "load it there, send it to a vehicle or a simulator, receive it again as simple items, and save those",
                name,
                place=place,
            )
        inner = _list(generated, place)
        return [
            item_of_child
            for i, child in enumerate(inner, 1)
            for item_of_child in _read_item(child, f"{place} ({name} {i})")
        ]
    if item.get("type") != "SimpleItem":
        raise MissionError.say("type is '{}'; expected SimpleItem or ComplexItem", item.get("type"), place=place)
    command, frame, params = item.get("command"), item.get("frame"), item.get("params")
    if not _is_number(command) or not _is_number(frame):
        raise MissionError.say(
            "expected numbers for command and frame, got {} and {}", *map(_written, (command, frame)), place=place
        )
    if not isinstance(params, list) or len(params) != 7 or not all(p is None or _is_number(p) for p in params):
        raise MissionError.say("expected params to be 7 numbers or null, got {}", _written(params), place=place)
    values = [math.nan if value is None else float(value) for value in params]
    viewpoint_id = item.get(VIEWPOINT_KEY)
    filled: Params = (values[0], values[1], values[2], values[3], values[4], values[5], values[6])
    return [MissionItem(int(command), int(frame), filled, viewpoint_id if isinstance(viewpoint_id, str) else "")]


def _written(value: Any) -> str:
    """A value as it stands in the file, cut where it is long: who reads of it knows JSON at most, not Python."""
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:60]} ..."


def _list(content: Any, place: str) -> list[Any]:
    if not isinstance(content, list):
        raise MissionError.say("expected a list, got {}", _written(content), place=place)
    return content


def _is_number(value: object) -> TypeGuard[int | float]:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _home(position: Any) -> tuple[GeoPoint | None, tuple[Finding, ...]]:
    """Planned home; 0, 0 means that it was never set."""
    if not isinstance(position, list) or len(position) < 3 or not all(map(_is_number, position)):
        return None, ()
    return home_of(float(position[0]), float(position[1]), float(position[2]))


def _fences(fence: Any) -> Iterator[Polygon]:
    """Exclusion polygons; inclusion areas and circles are of no use here."""
    polygons = fence.get("polygons") if isinstance(fence, dict) else None
    for polygon in polygons if isinstance(polygons, list) else ():
        corners = polygon.get("polygon") if isinstance(polygon, dict) and not polygon.get("inclusion") else None
        if isinstance(corners, list):
            pairs = [c[:2] for c in corners if isinstance(c, list) and len(c) >= 2 and all(map(_is_number, c[:2]))]
            yield tuple((float(lat), float(lon)) for lat, lon in pairs)


def _rally(rally: Any) -> Iterator[RallyPlace]:
    """Rally points; what is no place is left out."""
    points = rally.get("points") if isinstance(rally, dict) else None
    for point in points if isinstance(points, list) else ():
        if isinstance(point, list) and len(point) >= 3 and all(map(_is_number, point[:3])):
            lat, lon, above_m = map(float, point[:3])
            if abs(lat) <= 90.0 and abs(lon) <= 180.0 and math.isfinite(above_m):
                yield (lat, lon, above_m)
