"""The fence of a flight: the zones to keep out of as polygons, and its bounds, as MAVLink fence items.

A fence has no height: the vehicle must stay out of its polygon at any altitude. A zone that the mission passes over or
under can therefore not become a fence, or the vehicle would refuse its own mission; it is left out, and said so.

Vehicles take some dozen corners. Where the zones have more, each is drawn with fewer around its outside, as coarsely as
it must be and never nearer to the path than `FENCE_CLEARANCE_M`; what still finds no room is left out, the farthest
first, and said so. How a mission lies in a fence that a vehicle has already, `fence_fit` says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.items import MissionItem, Polygon
from missions.mavlink.messages import MissionItemInt
from missions.mission.model import GeoPoint, Mission
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.site.records import NoFlyZone, Site

# Fences and rally points as mission items, and back: what goes up as mission types 1 and 2.

MIN_CORNERS = 3

_POLYGONS = {
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False,
}
_CIRCLES = {
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION: True,
    mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION: False,
}


@dataclass(frozen=True, slots=True)
class FencePolygon:
    """Area to stay in, or out of; corners are latitude and longitude in degrees."""

    corners: Polygon
    is_inclusion: bool

    def __post_init__(self) -> None:
        if len(self.corners) < MIN_CORNERS:
            raise MissionError.say("a fence has {} corners; expected at least {}", len(self.corners), MIN_CORNERS)


@dataclass(frozen=True, slots=True)
class FenceCircle:
    """Circle to stay in, or out of."""

    lat_deg: float
    lon_deg: float
    radius_m: float
    is_inclusion: bool

    def __post_init__(self) -> None:
        if not 0.0 < self.radius_m < math.inf:
            raise MissionError.say("a fence has a radius of {:g} m; expected more than 0", self.radius_m)


Fence = FencePolygon | FenceCircle


def fence_items(fences: Sequence[Fence]) -> tuple[MissionItem, ...]:
    """Items of fences: one for each corner, which says how many its polygon has, or one for a circle."""
    return tuple(item for fence in fences for item in _fence_items(fence))


def _fence_items(fence: Fence) -> list[MissionItem]:
    frame = mavlink.MAV_FRAME_GLOBAL
    if isinstance(fence, FenceCircle):
        command = next(each for each, inside in _CIRCLES.items() if inside is fence.is_inclusion)
        place = (fence.lat_deg, fence.lon_deg)
        return [MissionItem(command, frame, (fence.radius_m, 0.0, 0.0, 0.0, *place, 0.0))]
    command = next(each for each, inside in _POLYGONS.items() if inside is fence.is_inclusion)
    n_corners = float(len(fence.corners))
    return [MissionItem(command, frame, (n_corners, 0.0, 0.0, 0.0, lat, lon, 0.0)) for lat, lon in fence.corners]


RETURN_POINT = mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT
"""Where planes wait after a breach; it encloses nothing."""

DEGREES_E7 = 1e7


def fences_of(messages: Sequence[MissionItemInt]) -> tuple[Fence, ...]:
    """The areas of a fence as it was read from a vehicle.

    Raises
    ------
    MissionError
        An item is none of a fence, a polygon has other corners than it announces, or a place is not on the globe.
    """
    fences: list[Fence] = []
    seq = 0
    while seq < len(messages):
        first, n_corners = messages[seq], 1
        if first.command in _POLYGONS:
            # Not a whole number, not even a number: then the comparison below fails.
            n_corners = int(first.param1) if 0.0 < first.param1 <= len(messages) - seq else 0
        run = messages[seq : seq + n_corners]
        places = tuple((item.x / DEGREES_E7, item.y / DEGREES_E7) for item in run)
        is_one = all(item.command == first.command and item.param1 == first.param1 for item in run)
        if not run or not is_one or any(abs(lat) > 90.0 or abs(lon) > 180.0 for lat, lon in places):
            raise MissionError.say("item {} is none of a fence", seq + 1)
        if first.command in _POLYGONS:
            fences.append(FencePolygon(places, _POLYGONS[first.command]))
        elif first.command in _CIRCLES:
            fences.append(FenceCircle(*places[0], first.param1, _CIRCLES[first.command]))
        elif first.command != RETURN_POINT:
            raise MissionError.say("item {} is none of a fence", seq + 1)
        seq += n_corners
    return tuple(fences)


@dataclass(frozen=True, slots=True)
class FenceFit:
    """How a mission lies in a fence, seen from above.

    Parameters
    ----------
    room_m
        Smallest distance of its path from the fence's lines; negative where it leaves the fence: by so much, and
        infinitely where the fence has no inside.
    waypoint
        First waypoint outside, from 1; 0 is the take-off, None where only a leg leaves it, or nothing does.
    """

    room_m: float
    waypoint: int | None = None


DATE_LINE_DEG = 179.0
"""East or west of this, longitudes are counted from the mission on; elsewhere as vehicles do, as plain numbers."""

CIRCLE_SEGMENTS = 64
"""For a quarter: the chord runs 7.5e-5 of the radius inside."""

SCALE_M = 1000.0
LEG_STEP_M = 1.0


def fence_fit(fences: Sequence[Fence], mission: Mission, *, in_all: bool) -> FenceFit:
    """How a mission lies in a fence; sides of polygons are straight in latitude and longitude, as vehicles have them.

    Parameters
    ----------
    in_all
        The vehicle must be inside of every area to stay in (ArduPilot, unless bit 1 of FENCE_OPTIONS is set), not of
        any (PX4).
    """
    import shapely

    home = mission.takeoff
    lat_deg, lon_deg, _ = geodetic_from_enu(mission.origin, [(0.0, 0.0, 0.0), (SCALE_M, 0.0, 0.0), (0.0, SCALE_M, 0.0)])
    east_deg, north_deg = float(lon_deg[1] - lon_deg[0]) % 360.0, float(lat_deg[2] - lat_deg[0])
    scale_xy = (SCALE_M / east_deg, SCALE_M / north_deg)
    wraps = abs(home.lon_deg) > DATE_LINE_DEG

    def plane(lat: float, lon: float) -> tuple[float, float]:
        east_deg = lon - home.lon_deg
        if wraps:
            east_deg = (east_deg + 180.0) % 360.0 - 180.0
        return (east_deg * scale_xy[0], (lat - home.lat_deg) * scale_xy[1])

    def area(fence: Fence) -> Any:
        if isinstance(fence, FenceCircle):
            centre = shapely.Point(plane(fence.lat_deg, fence.lon_deg))
            return centre.buffer(fence.radius_m, quad_segs=CIRCLE_SEGMENTS)
        return shapely.make_valid(shapely.Polygon([plane(*corner) for corner in fence.corners]))

    track = [plane(each.lat_deg, each.lon_deg) for each in (home, *(one.position for one in mission.waypoints))]
    path = shapely.LineString(track) if len(track) > 1 else shapely.Point(track[0])
    inside, outside = ([area(each) for each in fences if each.is_inclusion is wanted] for wanted in (True, False))
    room = path.envelope.buffer(1e6)
    if inside:
        room = shapely.intersection_all(inside) if in_all else shapely.union_all(inside)
    if outside:
        room = room.difference(shapely.union_all(outside))
    if room.is_empty:
        return FenceFit(-math.inf, 0)
    beyond = next((number for number, place in enumerate(track) if not room.covers(shapely.Point(place))), None)
    left = path.difference(room)
    if beyond is None and left.is_empty:
        return FenceFit(float(room.boundary.distance(path)))
    steps = [] if left.is_empty else shapely.get_coordinates(shapely.segmentize(left, LEG_STEP_M))
    off_m = [float(room.distance(shapely.Point(place))) for place in (*steps, *track)]
    return FenceFit(-max(off_m), beyond)


def rally_points(site: Site) -> tuple[GeoPoint, ...]:
    """The rally points of a site on the globe."""
    if not site.rally_points:
        return ()
    lat_deg, lon_deg, height_m = geodetic_from_enu(site.origin, [point.position_enu_m for point in site.rally_points])
    places = zip(lat_deg, lon_deg, height_m, strict=True)
    return tuple(GeoPoint(float(lat), float(lon), float(height)) for lat, lon, height in places)


def rally_items(points: Sequence[GeoPoint], home: GeoPoint) -> tuple[MissionItem, ...]:
    """Items of rally points; their heights count from home, and ArduPilot keeps whole metres."""
    return tuple(
        MissionItem(
            mavlink.MAV_CMD_NAV_RALLY_POINT,
            mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
            (0.0, 0.0, 0.0, 0.0, point.lat_deg, point.lon_deg, point.height_ellipsoid_m - home.height_ellipsoid_m),
        )
        for point in points
    )


FENCE_CLEARANCE_M = 2.0
"""ArduPilot's default FENCE_MARGIN: nearer than this to a fence the vehicle already brakes."""

ABOVE_GROUND_M = 1.0
"""Zones that begin no higher than this above the level ground reach down to it."""

COARSEST = 12
"""Steps of `STEP_M` doubled, up to 1 km: as far as zones are looked at around a site."""

STEP_M = 0.5

HEADER_ITEMS = 1
"""Room that each polygon takes beside its corners: 2 bytes and a share of 5 in ArduPilot (AC_PolyFence_loader), whose
corners have 8; PX4 keeps one item of its list for itself."""


def fence_polygons(
    mission: Mission,
    zones: Sequence[NoFlyZone],
    autopilot: Autopilot = Autopilot.ARDUPILOT,
    ground_z_m: float = 0.0,
    rally: Sequence[GeoPoint] = (),
) -> tuple[tuple[Polygon, ...], tuple[Finding, ...]]:
    """Polygons of the zones that the mission keeps clear of at every height, and findings on the others.

    Parameters
    ----------
    zones
        In the frame of the mission's origin; several of one name are parts of one zone.
    autopilot
        Whose vehicles have room for so many corners.
    ground_z_m
        Height of the ground, ENU z. A zone that begins above it is closed below itself, too, and said so; where the
        straight ways home or to `rally` points pass under it, it is left out.
    """
    import shapely

    track, returns = _tracks(mission, rally)
    findings: list[Finding] = []
    fenced: list[_Fenced] = []
    for zone in zones:
        area = shapely.Polygon(zone.polygon_enu_m)
        away_m, above_m = float(track.distance(area)), zone.floor_m - ground_z_m
        is_above = above_m > ABOVE_GROUND_M
        if away_m < FENCE_CLEARANCE_M:
            text = say("the mission passes over or under this zone, and fences have no height: it is not in the fence")
        elif is_above and returns.distance(area) < FENCE_CLEARANCE_M:
            text = say("a return passes under this zone, and fences have no height: it is not in the fence")
        else:
            fenced.append(_Fenced(zone.id, area, away_m))
            if is_above:
                text = say(
                    "the fence has no height: it keeps the vehicle out below this zone, too, which begins {:.0f} m "
                    "above the ground",
                    above_m,
                )
                findings.append(Finding(Severity.NOTE, "zone-fence-height", text, zone.id, above_m, None, "m"))
            continue
        findings.append(Finding(Severity.WARNING, "zone-not-fenced", text, zone.id, away_m, FENCE_CLEARANCE_M, "m"))
    drawn, on_room = _with_room(fenced, track, autopilot)
    polygons = tuple(_corners(mission, area) for area in drawn)
    return polygons, tuple({(each.code, each.place): each for each in (*findings, *on_room)}.values())


@dataclass(frozen=True, slots=True, eq=False)
class _Fenced:
    """A zone that becomes a polygon, shapely, and how far the mission keeps away from it."""

    id: str
    area: Any
    away_m: float


def _tracks(mission: Mission, rally: Sequence[GeoPoint]) -> tuple[Any, Any]:
    """The mission seen from above, and the straight ways from its waypoints to where it may land, shapely."""
    import shapely

    places = (mission.takeoff, *(waypoint.position for waypoint in mission.waypoints), *rally)
    local = enu_from_geodetic(
        mission.origin,
        [point.lat_deg for point in places],
        [point.lon_deg for point in places],
        [point.height_ellipsoid_m for point in places],
    )[:, :2]
    flown, landings = local[: len(local) - len(rally)], [local[0], *local[len(local) - len(rally) :]]
    ways = [(start, end) for start in flown for end in landings if (start != end).any()]
    track = shapely.LineString(flown) if len(flown) > 1 else shapely.Point(flown[0])
    return track, shapely.MultiLineString(ways) if ways else track


def _with_room(fenced: Sequence[_Fenced], track: Any, autopilot: Autopilot) -> tuple[list[Any], Iterator[Finding]]:
    """Areas with as few corners as a vehicle takes, and what that costs."""
    room = facts(autopilot).max_fence_items
    # What lies inside another needs no corners of its own.
    outer = [
        one
        for number, one in enumerate(fenced)
        if not any(
            other.area.covers(one.area) and (position < number or not one.area.covers(other.area))
            for position, other in enumerate(fenced)
            if position != number
        )
    ]
    areas = [one.area for one in outer]
    if sum(map(_items, areas)) <= room:
        return areas, iter(())
    nearest = sorted(outer, key=lambda one: one.away_m)
    ladders = [_ladder(one.area, track) for one in nearest]
    kept: list[int] = []
    for number, ladder in enumerate(ladders):
        if sum(_items(ladders[each][-1]) for each in kept) + _items(ladder[-1]) <= room:
            kept.append(number)
    step = next(step for step in range(COARSEST + 1) if sum(_items(ladders[number][step]) for number in kept) <= room)
    drawn = {number: ladders[number][step] for number in kept}
    return list(drawn.values()), _room_findings(nearest, drawn, autopilot)


def _room_findings(nearest: Sequence[_Fenced], drawn: Mapping[int, Any], autopilot: Autopilot) -> Iterator[Finding]:
    room, product = facts(autopilot).max_fence_items, autopilot.product
    for number, one in enumerate(nearest):
        if number not in drawn:
            text = say(
                "the fence of {} has room for {} corners, and nearer zones need them: this zone is not in the fence",
                product,
                room,
            )
            yield Finding(Severity.WARNING, "zone-not-fenced", text, one.id, one.away_m, None, "m")
            continue
        n_before, n_after = _items(one.area) - HEADER_ITEMS, _items(drawn[number]) - HEADER_ITEMS
        if n_after < n_before:
            beyond_m = float(drawn[number].hausdorff_distance(one.area))
            text = say(
                "the fence of {} has room for {} corners: this zone is drawn with {} in place of {}, up to {:.0f} m "
                "around its outside",
                product,
                room,
                n_after,
                n_before,
                beyond_m,
            )
            yield Finding(Severity.NOTE, "zone-fence-coarse", text, one.id, beyond_m, None, "m")


def _items(area: Any) -> int:
    return len(area.exterior.coords) - 1 + HEADER_ITEMS


def _ladder(area: Any, track: Any) -> list[Any]:
    """An area and ever coarser ones that hold it, none with more corners than the one before."""
    import shapely

    found = [area]
    for step in range(COARSEST):
        # Nothing of the wider border is nearer to the area than the simplified one may move.
        step_m = STEP_M * 2.0**step
        wide = area.buffer(step_m, join_style="mitre").simplify(step_m)
        wide = shapely.Polygon(wide.exterior) if wide.geom_type == "Polygon" else wide
        is_usable = (
            wide.geom_type == "Polygon"
            and _items(wide) < _items(found[-1])
            and wide.is_valid
            and wide.covers(area)
            and track.distance(wide) >= FENCE_CLEARANCE_M
        )
        found.append(wide if is_usable else found[-1])
    return found


def _corners(mission: Mission, area: Any) -> Polygon:
    corners = [(x, y, 0.0) for x, y in area.exterior.coords[:-1]]
    lat_deg, lon_deg, _ = geodetic_from_enu(mission.origin, corners)
    return tuple((round(float(lat), 9), round(float(lon), 9)) for lat, lon in zip(lat_deg, lon_deg, strict=True))
