"""Zones in the local frame of a site: which of them are near it, and the volumes that flights keep out of.

Idea: a lower bound of the distance by longitudes and latitudes sorts out what is far, so that files of whole countries
take a moment. The others are projected about the site (azimuthal equidistant on the ellipsoid: true to 0.1 mm within
3 km, and with neither date line nor poles), repaired, widened by what is not known of them, and cut to the site's
surroundings. Everything errs to the outside: the volumes hold the true ones.

Edges run straight in longitude and latitude (RFC 7946) or along geodesics, as publishers mean it; both count. They are
drawn in steps s, which costs s^2 tan(lat) / (4 R) at most; circles are drawn from outside by n tangents, which costs
r (1 / cos(pi / n) - 1).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.site.ground import Ground
from planning.site.records import Airspace, NoFlyZone
from planning.site.zones.records import Circle, HeightAbove, Limit, LonLat, Outline, Volume, Zone, ZoneSet

if TYPE_CHECKING:
    from pyproj import Proj

Array = NDArray[np.float64]

REACH_M = 1000.0
"""Beside and above the airspace: zones within are looked at, drawn and told about."""

COUNTRY_M = 50_000.0
"""What is not known of zones up to here is asked; files without any zone so near are of another place."""

EXCHANGED_M = 1_000_000.0
"""Zones further away that would lie at the site with latitude and longitude exchanged are asked about. Nearer ones may
well lie there: about Cairo, where both are near 30 degrees, others lie so to each other."""

EDGE_STEP_M = 1000.0
MAX_STEPS = 2000
"""Of one edge; the tolerance follows from the step."""

CIRCLE_TOLERANCE_M = 0.5
MIN_TANGENTS, MAX_TANGENTS = 32, 4096

AREA_TOLERANCE_M = 0.1
"""Widening of all areas: verticals lean outwards by 6 mm at 400 m from the origin and 100 m above it."""

GEOID_TOLERANCE_M = 2.0
"""Of EGM96 against a national geoid (`planning.geo.crs`)."""

NARROW_M = 50.0
"""Half the width of outlines that enclose nothing."""

LEAST_AREA_M2 = 1.0
LEAST_PART_M2 = 1e-3
"""Smaller areas enclose nothing; smaller parts are left by cutting."""

EARTH_RADIUS_M = 6_371_000.0
DEGREE_M = 110_500.0
"""Shortest degree of latitude on the ellipsoid (110 574 m)."""

FAR_SIDE_M = 15_000_000.0
"""Outlines that reach this far around the earth have no inside that can be told."""

FLAT_BELOW, FLAT_ABOVE = (0.8, -700.0), (1.15, 600.0)
"""True height above sea level of a flight level, as factor and offset: air from -50 to 45 degrees Celsius against the
standard atmosphere, and 930 to 1085 hPa at sea level, 8.3 m for each."""


@dataclass(frozen=True, slots=True, eq=False)
class LocalVolume:
    """A volume of a zone near a site.

    Parameters
    ----------
    area
        shapely area, ENU metres, cut to the surroundings.
    floor_m, ceiling_m
        ENU z; infinite where nothing ends it.
    volume
        As the file says it.
    """

    area: Any
    floor_m: float
    ceiling_m: float
    volume: Volume


@dataclass(frozen=True, slots=True, eq=False)
class LocalZone:
    """A zone near a site.

    Parameters
    ----------
    distance_m
        Horizontally from the airspace box, 0 where it overlaps. A lower bound for zones beyond `REACH_M`.
    volumes
        None of them beyond `REACH_M`.
    questions, place_questions
        What its shape leaves open, and of that what may put it elsewhere.
    doubtful
        Hull of outlines that cross themselves, shapely: whoever mixed up corners meant an area within. Else None.
    """

    zone: Zone
    distance_m: float
    volumes: tuple[LocalVolume, ...] = ()
    questions: tuple[str, ...] = ()
    place_questions: tuple[str, ...] = ()
    doubtful: Any = None

    @property
    def open_places(self) -> tuple[str, ...]:
        """What is open about where it lies; how wide it is only where it lies near enough to matter."""
        widths = self.zone.width_questions if self.volumes else ()
        return (*self.zone.place_questions, *widths, *self.place_questions)

    @property
    def is_unsure(self) -> bool:
        """Whether anything is open about where it lies."""
        return bool(self.open_places) or not self.volumes or self.doubtful is not None

    @property
    def all_questions(self) -> tuple[str, ...]:
        """Whatever is open about it."""
        zone = self.zone
        of_zone = *zone.questions, *zone.place_questions, *zone.width_questions
        return tuple(dict.fromkeys((*of_zone, *self.questions, *self.place_questions)))


@dataclass(frozen=True, slots=True, eq=False)
class LocalZones:
    """Zones of one file about a site.

    Parameters
    ----------
    near
        Those within `REACH_M`, those up to `COUNTRY_M` of which it is open where they lie, and those that would lie
        within `REACH_M` with latitude and longitude exchanged.
    nearest_m
        Lower bound of the distance of the nearest; infinite where none says where it lies.
    is_swapped
        Whether the file would lie here if latitude and longitude were changed for each other.
    """

    near: tuple[LocalZone, ...]
    nearest_m: float
    is_swapped: bool


def local_zones(found: ZoneSet, origin: Origin, airspace: Airspace, ground: Ground | None = None) -> LocalZones:
    """Zones of a file about a site; takes 0.3 s for 10 000 zones of which few are near.

    Parameters
    ----------
    ground
        From which heights above the ground count; None: the level ground of the airspace.
    """
    frame = _Frame(origin, airspace, Ground(airspace.ground_z_m) if ground is None else ground)
    near, nearest_m = [], math.inf
    for zone in found.zones:
        bounds = [frame.least_distance_m(volume) for volume in zone.volumes]
        bound_m = min(bounds, default=math.inf)
        nearest_m = min(nearest_m, bound_m)
        if bound_m <= REACH_M:
            local = _local_zone(zone, bounds, frame)
            if local.volumes or zone.place_questions or zone.width_questions:
                near.append(local)
        elif not zone.volumes:
            lost = () if zone.place_questions else (say("the file does not say where this zone lies"),)
            near.append(LocalZone(zone, bound_m, place_questions=lost))
        elif (zone.place_questions or zone.width_questions) and bound_m <= COUNTRY_M:
            near.append(LocalZone(zone, bound_m))
        elif bound_m > EXCHANGED_M and _is_here_exchanged(zone, frame):
            text = say("it lies {:.0f} km away, but here if its latitude and longitude are exchanged", bound_m / 1000.0)
            near.append(LocalZone(zone, bound_m, place_questions=(text,)))
    return LocalZones(tuple(near), nearest_m, nearest_m > COUNTRY_M and _is_swapped(found, frame))


def _is_swapped(found: ZoneSet, frame: _Frame) -> bool:
    return any(_begins_here_exchanged(volume, frame) for zone in found.zones for volume in zone.volumes)


def _begins_here_exchanged(volume: Volume, frame: _Frame) -> bool:
    lat_deg, lon_deg = volume.area.centre if isinstance(volume.area, Circle) else volume.area.ring[0]
    return abs(lat_deg) <= 90.0 and frame.distance_of_m(lon_deg, lat_deg) <= COUNTRY_M


def _is_here_exchanged(zone: Zone, frame: _Frame) -> bool:
    """Whether a zone would lie within `REACH_M` if latitude and longitude were changed for each other."""
    for volume in zone.volumes:
        area = volume.area
        if not _begins_here_exchanged(volume, frame):
            continue
        if isinstance(area, Circle):
            other: Outline | Circle = replace(area, centre=area.centre[::-1])
        elif all(abs(first) <= 90.0 for first, _ in area.ring):
            other = replace(area, ring=tuple(corner[::-1] for corner in area.ring))
        else:
            continue
        if frame.least_distance_m(replace(volume, area=other)) <= REACH_M:
            return True
    return False


class _Frame:
    """The local frame of a site, and its surroundings."""

    def __init__(self, origin: Origin, airspace: Airspace, ground: Ground) -> None:
        self.origin, self.airspace, self.ground = origin, airspace, ground
        (x0, y0, _), (x1, y1, _) = airspace.min_enu_m, airspace.max_enu_m
        self.box = x0, y0, x1, y1
        self.radius_m = max(math.hypot(x, y) for x in (x0, x1) for y in (y0, y1))

    def project(self, lons_deg: Array, lats_deg: Array) -> Array:
        """Places on the globe in local metres, shape (n, 2), where verticals through them meet the origin's height."""
        east, north = _projection(self.origin)(lons_deg, lats_deg)
        return np.stack([east, north], axis=-1) * (1.0 + self.origin.ellipsoid_height_m / EARTH_RADIUS_M)

    def distance_of_m(self, lon_deg: float, lat_deg: float) -> float:
        """Lower bound of the distance between a place and the airspace."""
        return max(0.0, _least_m(self.origin, lat_deg, lat_deg, lon_deg, lon_deg) - self.radius_m)

    def least_distance_m(self, volume: Volume) -> float:
        """Lower bound of the distance between a volume's area and the airspace."""
        area = volume.area
        if isinstance(area, Circle):
            return max(0.0, self.distance_of_m(*area.centre) - area.radius_m)
        west, south, east, north, bulge_m = _bounds(area.ring)
        least_m = _least_m(self.origin, south, north, west, east)
        return max(0.0, least_m - self.radius_m - area.tolerance_m - bulge_m - NARROW_M)


def _bounds(ring: Sequence[LonLat]) -> tuple[float, float, float, float, float]:
    """West, south, east, north of a ring, degrees, going the short way round; and how far geodesics bulge beyond, m."""
    lons = [ring[0][0]]
    longest_deg = 0.0
    for lon, _ in (*ring[1:], ring[0]):
        step = (lon - lons[-1] + 180.0) % 360.0 - 180.0
        longest_deg = max(longest_deg, abs(step))
        lons.append(lons[-1] + step)
    lats = [lat for _, lat in ring]
    south, north = min(lats), max(lats)
    west, east = min(lons), max(lons)
    if abs(lons[-1] - lons[0]) > 180.0:  # once around a pole, the nearer one
        west, east = -180.0, 180.0
        south, north = (-90.0, north) if south + north < 0.0 else (south, 90.0)
    lat_rad = math.radians(min(89.9, max(abs(south), abs(north))))
    length_m = math.radians(longest_deg) * EARTH_RADIUS_M * math.cos(math.radians(min(abs(south), abs(north))))
    return west, south, east, north, min(length_m**2 * math.tan(lat_rad) / (4.0 * EARTH_RADIUS_M), length_m)


def _least_m(origin: Origin, south: float, north: float, west: float, east: float) -> float:
    """Lower bound of the distance from the origin to a box of longitudes and latitudes, metres."""
    lat = origin.lat_deg
    gap_lat_deg = max(0.0, south - lat, lat - north)
    if east - west >= 360.0:
        return gap_lat_deg * DEGREE_M
    middle, half = 0.5 * (west + east), 0.5 * (east - west)
    gap_lon_deg = abs((origin.lon_deg - middle + 180.0) % 360.0 - 180.0) - half
    if gap_lon_deg <= 0.0:
        return gap_lat_deg * DEGREE_M
    # To the nearest meridian; from 90 degrees on its nearest point is a pole.
    aside_deg = (
        math.degrees(math.asin(math.sin(math.radians(gap_lon_deg)) * math.cos(math.radians(lat))))
        if gap_lon_deg < 90.0
        else 90.0 - abs(lat)
    )
    return max(gap_lat_deg, aside_deg) * DEGREE_M


def _local_zone(zone: Zone, bounds: Sequence[float], frame: _Frame) -> LocalZone:
    import shapely

    doubts, volumes = _Doubts(), []
    box = shapely.box(*frame.box)
    for volume, bound_m in zip(zone.volumes, bounds, strict=True):
        if bound_m > REACH_M:
            continue
        of_volume = _Doubts()
        area = _area(volume.area, frame, of_volume)
        if area.is_empty:
            continue
        floor_m, ceiling_m = _span(volume, area, frame, of_volume.questions)
        if not floor_m < ceiling_m or _is_upside_down(volume):
            text = say(
                "its lower limit '{}' does not lie below the upper one '{}', so every height counts",
                volume.lower.written,
                volume.upper.written,
            )
            of_volume.questions.append(text)
            floor_m, ceiling_m = -math.inf, math.inf
        doubts.add(of_volume)
        volumes.append(LocalVolume(area, floor_m, ceiling_m, volume))
    distance_m = min((float(each.area.distance(box)) for each in volumes), default=max(REACH_M, min(bounds)))
    # What has no width anyhow, by its file, encloses nothing.
    places = () if zone.width_questions else tuple(dict.fromkeys(doubts.places))
    hull = shapely.union_all(doubts.hulls) if doubts.hulls else None
    return LocalZone(zone, distance_m, tuple(volumes), tuple(dict.fromkeys(doubts.questions)), places, hull)


@dataclass(frozen=True, slots=True)
class _Doubts:
    """What shapes leave open: see `LocalZone`."""

    questions: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    hulls: list[Any] = field(default_factory=list)

    def add(self, others: _Doubts) -> None:
        self.questions.extend(others.questions)
        self.places.extend(others.places)
        self.hulls.extend(others.hulls)


def _is_upside_down(volume: Volume) -> bool:
    """Whether limits that are counted from the same leave no height between them."""
    lower, upper = volume.lower, volume.upper
    if lower.value_m is None or upper.value_m is None or lower.above is not upper.above:
        return False
    return upper.value_m <= lower.value_m


def _area(area: Outline | Circle, frame: _Frame, doubts: _Doubts) -> Any:
    """Area in the local frame, shapely, cut to the surroundings; empty where it lies beside them."""
    import shapely

    window = _window(frame)
    if isinstance(area, Circle):
        found, widened_m = shapely.Polygon(_tangents(area, frame)), AREA_TOLERANCE_M
    else:
        rings = [_rings(ring, frame) for ring in (area.ring, *area.holes)]
        reach_m = max(float(np.hypot(*points.T).max()) for outlines, _ in rings for points in outlines)
        if reach_m > FAR_SIDE_M:
            doubts.questions.append(say("its outline reaches around the earth, so it counts as lying here"))
            return window
        outer = [_whole(points, doubts) for points in rings[0][0]]
        # A hole is one where both ways to draw its edges say so.
        unasked = _Doubts()
        holes = [_whole(drawn[0], unasked).intersection(_whole(drawn[-1], unasked)) for drawn, _ in rings[1:]]
        found = shapely.union_all(outer)
        if holes:
            found = found.difference(shapely.union_all(holes))
        widened_m = area.tolerance_m + max(step_m for _, step_m in rings) + AREA_TOLERANCE_M
    found = found.buffer(widened_m, join_style="mitre").intersection(window)
    return found if found.area > LEAST_PART_M2 else shapely.Polygon()


def _window(frame: _Frame) -> Any:
    """The surroundings that are looked at, shapely."""
    import shapely

    from planning.geo.mesh import MAX_COORDINATE_M

    x0, y0, x1, y1 = frame.box
    most = 0.999 * MAX_COORDINATE_M
    return shapely.box(
        max(x0 - REACH_M, -most), max(y0 - REACH_M, -most), min(x1 + REACH_M, most), min(y1 + REACH_M, most)
    )


@lru_cache(maxsize=16)
def _projection(origin: Origin) -> Proj:
    from pyproj import Proj

    return Proj(proj="aeqd", lat_0=origin.lat_deg, lon_0=origin.lon_deg, ellps="WGS84")


def tangents(radius_m: float) -> int:
    """How many tangents draw a circle to `CIRCLE_TOLERANCE_M`."""
    wanted = math.ceil(math.pi / math.acos(radius_m / (radius_m + CIRCLE_TOLERANCE_M)))
    return min(max(wanted, MIN_TANGENTS), MAX_TANGENTS)


def circle_excess_m(radius_m: float, n_tangents: int) -> float:
    """How far a circle drawn from outside reaches beyond it at most: r (1 / cos(pi / n) - 1)."""
    return radius_m * (1.0 / math.cos(math.pi / n_tangents) - 1.0)


def _tangents(circle: Circle, frame: _Frame) -> Array:
    """Corners of the polygon about a circle, shape (n, 2), local metres."""
    from pyproj import Geod

    n = tangents(circle.radius_m)
    azimuths = np.arange(n) * 360.0 / n
    radius = np.full(n, circle.radius_m + circle_excess_m(circle.radius_m, n))
    lon, lat = np.full(n, circle.centre[0]), np.full(n, circle.centre[1])
    lons, lats, _ = Geod(ellps="WGS84").fwd(lon, lat, azimuths, radius)
    return frame.project(lons, lats)


def _rings(ring: Sequence[LonLat], frame: _Frame) -> tuple[list[Array], float]:
    """A ring in local metres, shape (k, 2): with edges straight in degrees, and along geodesics where these differ.

    Returns also what the steps cost, metres.
    """
    from pyproj import Geod

    corners = np.array(ring, np.float64)
    if not (corners[0] == corners[-1]).all() or len(corners) == 1:
        corners = np.concatenate([corners, corners[:1]])
    ahead = np.diff(corners, axis=0)
    ahead[:, 0] = (ahead[:, 0] + 180.0) % 360.0 - 180.0
    widest = np.cos(np.radians(np.minimum(np.abs(corners[:-1, 1]), np.abs(corners[1:, 1]))))
    lengths_m = np.radians(np.hypot(ahead[:, 1], ahead[:, 0] * widest)) * EARTH_RADIUS_M
    n_steps = np.clip(np.ceil(lengths_m / EDGE_STEP_M), 1, MAX_STEPS).astype(np.int64)
    step_m = float((lengths_m / n_steps).max())
    lat_rad = math.radians(min(89.9, float(np.abs(corners[:, 1]).max())))
    cost_m = min(step_m**2 * math.tan(lat_rad) / (4.0 * EARTH_RADIUS_M), step_m)
    if (n_steps == 1).all():
        return [frame.project(corners[:, 0], corners[:, 1])], cost_m
    edge = np.repeat(np.arange(len(ahead)), n_steps)
    share = (np.arange(len(edge)) - np.repeat(np.cumsum(n_steps) - n_steps, n_steps)) / n_steps[edge]
    straight = corners[edge] + share[:, None] * ahead[edge]
    straight[:, 0] = (straight[:, 0] + 180.0) % 360.0 - 180.0
    geod = Geod(ellps="WGS84")
    azimuths, _, distances = geod.inv(corners[:-1, 0], corners[:-1, 1], corners[1:, 0], corners[1:, 1])
    lons, lats, _ = geod.fwd(corners[edge, 0], corners[edge, 1], azimuths[edge], share * distances[edge])
    drawn = [frame.project(straight[:, 0], straight[:, 1]), frame.project(lons, lats)]
    return drawn, cost_m


def _whole(points: Array, doubts: _Doubts) -> Any:
    """What a ring encloses, shapely; all lobes where it crosses itself, a band where it encloses nothing."""
    import shapely

    distinct = np.unique(points, axis=0)
    polygon = shapely.Polygon(points) if len(points) >= 4 else shapely.Polygon()
    if not polygon.is_valid:
        if shapely.is_valid_reason(polygon).startswith("Self-intersection"):
            doubts.questions.append(say("its outline crosses itself, so all that it goes around counts"))
            doubts.hulls.append(polygon.convex_hull)
        polygon = shapely.make_valid(polygon, method="structure", keep_collapsed=False)
    if polygon.area >= LEAST_AREA_M2:
        return polygon
    doubts.places.append(say("its outline encloses nothing, so {:.0f} m to each side of it count", NARROW_M))
    band = shapely.Point(distinct[0]) if len(distinct) == 1 else shapely.LineString(points)
    return band.buffer(NARROW_M)


def _span(volume: Volume, area: Any, frame: _Frame, questions: list[str]) -> tuple[float, float]:
    """Lowest floor and highest ceiling of a volume anywhere in the surroundings, ENU z."""
    lower, upper = volume.lower, volume.upper
    is_from_ground = lower.above is HeightAbove.GROUND and lower.value_m is not None and lower.value_m <= 0.0
    floor_m = -math.inf if lower.value_m is None or is_from_ground else _z_range(lower, area, frame, questions)[0]
    ceiling_m = math.inf if upper.value_m is None else _z_range(upper, area, frame, questions)[1]
    return floor_m, ceiling_m


def _z_range(limit: Limit, area: Any, frame: _Frame, questions: list[str]) -> tuple[float, float]:
    """Lowest and highest ENU z that a limit may have anywhere in the surroundings.

    A surface of one height sinks below the local plane by d^2 / 2R at a distance d.
    """
    value_m = limit.value_m
    assert value_m is not None  # only limits that end something come here
    if limit.above is HeightAbove.GROUND:
        low_m, high_m = _ground_range(area, frame)
        if not math.isfinite(low_m):
            questions.append(say("the terrain has no heights for a part below it, so its heights are not known"))
        return low_m + value_m, high_m + value_m
    if limit.above is HeightAbove.UNKNOWN:
        return -math.inf, math.inf
    sinks_m = (frame.radius_m + REACH_M) ** 2 / (2.0 * EARTH_RADIUS_M)
    low_m = high_m = value_m - frame.origin.ellipsoid_height_m
    if limit.above is not HeightAbove.ELLIPSOID:
        if limit.above is HeightAbove.FLIGHT_LEVEL:
            low_m += (FLAT_BELOW[0] - 1.0) * value_m + FLAT_BELOW[1]
            high_m += (FLAT_ABOVE[0] - 1.0) * value_m + FLAT_ABOVE[1]
        lats, lons = _corners_deg(frame)
        geoid_m = undulation_m(lats, lons)
        low_m += float(geoid_m.min()) - GEOID_TOLERANCE_M
        high_m += float(geoid_m.max()) + GEOID_TOLERANCE_M
    return low_m - sinks_m, high_m


def _ground_range(area: Any, frame: _Frame) -> tuple[float, float]:
    """Lowest and highest ground below an area, as far as it lies below the airspace; infinite where it is not known."""
    terrain = frame.ground.terrain
    if terrain is None:
        return frame.ground.level_z_m, frame.ground.level_z_m
    west, south, east, north = area.bounds
    x0, y0, x1, y1 = frame.box
    low, high = np.array([max(west, x0), max(south, y0), 0.0]), np.array([min(east, x1), min(north, y1), 0.0])
    if (low[:2] > high[:2]).any():
        return frame.ground.level_z_m, frame.ground.level_z_m
    lower, upper = terrain.lower.part_m(low, high), terrain.upper.part_m(low, high)
    if not lower.size or np.isnan(lower).any():
        return -math.inf, math.inf
    return float(lower.min()), float(upper.max())


def _corners_deg(frame: _Frame) -> tuple[Array, Array]:
    """Latitudes and longitudes of the origin and of the corners of the surroundings."""
    lat, lon = frame.origin.lat_deg, frame.origin.lon_deg
    aside = math.degrees((frame.radius_m + REACH_M) / EARTH_RADIUS_M)
    lats = np.clip(lat + aside * np.array([0.0, -1.0, 1.0, 0.0, 0.0]), -90.0, 90.0)
    lons = lon + aside / max(0.01, math.cos(math.radians(lat))) * np.array([0.0, 0.0, 0.0, -1.0, 1.0])
    return lats, lons


def prisms(local: LocalZone, airspace: Airspace) -> tuple[NoFlyZone, ...]:
    """Volumes that flights keep out of, as far as they reach into the surroundings of an airspace."""
    low_z_m = min(airspace.min_enu_m[2], airspace.ground_z_m) - REACH_M
    high_z_m = airspace.max_enu_m[2] + REACH_M
    found = []
    for each in local.volumes:
        floor_m, ceiling_m = max(each.floor_m, low_z_m), min(each.ceiling_m, high_z_m)
        if floor_m < ceiling_m:
            for part in simple_parts(each.area):
                ring = tuple((float(x), float(y)) for x, y in part.exterior.coords[:-1])
                found.append(NoFlyZone(local.zone.id, ring, floor_m, ceiling_m))
    return tuple(found)


def simple_parts(area: Any) -> Iterator[Any]:
    """Polygons without holes that make up an area, shapely: it is cut through its holes from south to north."""
    import shapely

    waiting = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon"]
    while waiting:
        part = waiting.pop()
        if part.area <= LEAST_PART_M2:
            continue
        if not part.interiors:
            yield part
            continue
        x = part.interiors[0].centroid.x
        x0, y0, x1, y1 = part.bounds
        for half in (shapely.box(x0, y0, x, y1), shapely.box(x, y0, x1, y1)):
            waiting += [one for one in shapely.get_parts(part.intersection(half)) if one.geom_type == "Polygon"]
