from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.fence import (
    FENCE_CLEARANCE_M,
    HEADER_ITEMS,
    FenceCircle,
    FenceFit,
    FencePolygon,
    Polygon,
    fence_fit,
    fence_items,
    fence_polygons,
    fences_of,
)
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.mission.build import missions_from_plan
from missions.mission.model import GeoPoint, Mission
from missions.simulator.autopilot.failsafe import FenceZone
from planning.base.errors import MissionError
from planning.base.findings import Severity
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.site.records import NoFlyZone
from tests.missions.plans import HONG_KONG, example_plan


def square(name: str, x: float, y: float, half_m: float = 5.0) -> NoFlyZone:
    corners = ((x - half_m, y - half_m), (x + half_m, y - half_m), (x + half_m, y + half_m), (x - half_m, y + half_m))
    return NoFlyZone(name, corners, 0.0, 10.0)


def test_zone_beside_the_path_becomes_a_polygon_in_its_place() -> None:
    zone = square("road", 60.0, 60.0)
    polygons, findings = fence_polygons(missions_from_plan(example_plan())[0], (zone,))
    assert findings == ()
    (polygon,) = polygons
    local = enu_from_geodetic(HONG_KONG, [p[0] for p in polygon], [p[1] for p in polygon], HONG_KONG.ellipsoid_height_m)
    for corner, (x, y, _) in zip(zone.polygon_enu_m, local, strict=True):
        assert math.dist(corner, (x, y)) < 0.01


def test_zone_that_is_flown_over_is_left_out_and_said_because_fences_have_no_height() -> None:
    over, near = square("yard", 25.0, 0.0), square("kerb", 3.0 + 6.0, -41.0)
    polygons, findings = fence_polygons(missions_from_plan(example_plan())[0], (over, near, square("road", 60.0, 60.0)))
    assert len(polygons) == 1
    assert [(f.code, f.place) for f in findings] == [("zone-not-fenced", "yard"), ("zone-not-fenced", "kerb")]


def mission() -> Mission:
    return missions_from_plan(example_plan())[0]


def local(polygon: Polygon) -> shapely.Polygon:
    """A polygon of the fence in the site's frame."""
    lat, lon = zip(*polygon, strict=True)
    places = enu_from_geodetic(HONG_KONG, list(lat), list(lon), [HONG_KONG.ellipsoid_height_m] * len(lat))
    return shapely.Polygon(places[:, :2])


def track() -> shapely.LineString:
    flown = mission()
    points = [flown.takeoff, *(waypoint.position for waypoint in flown.waypoints)]
    places = enu_from_geodetic(
        HONG_KONG,
        [point.lat_deg for point in points],
        [point.lon_deg for point in points],
        [point.height_ellipsoid_m for point in points],
    )
    return shapely.LineString(places[:, :2])


def star(name: str, x: float, y: float, radii: np.ndarray) -> NoFlyZone:
    """A zone whose border goes in and out."""
    angles = np.linspace(0.0, 2.0 * math.pi, len(radii), endpoint=False)
    return NoFlyZone(
        name, tuple(zip(x + radii * np.cos(angles), y + radii * np.sin(angles), strict=True)), -1000.0, 1000.0
    )


def test_a_zone_that_begins_above_the_ground_closes_the_room_below_it_and_says_so() -> None:
    shelf = NoFlyZone("shelf", square("", 80.0, 80.0).polygon_enu_m, 60.0, 300.0)
    polygons, (note,) = fence_polygons(mission(), (shelf,), ground_z_m=2.0)
    assert len(polygons) == 1
    assert (note.severity, note.place, note.value) == (Severity.NOTE, "shelf", 58.0)
    assert "keeps the vehicle out below this zone, too, which begins 58 m above the ground" in note.message


def test_a_zone_above_the_straight_way_home_is_left_out_and_one_from_the_ground_is_not() -> None:
    """Between a view and home, beside the flown path."""
    flown = track()
    ways = [shapely.LineString([flown.coords[0], place]) for place in flown.coords[2:-2]]
    spots = (way.interpolate(share, normalized=True) for way in ways for share in np.linspace(0.1, 0.9, 50))
    spot = next(point for point in spots if flown.distance(point) > 3.0)
    ring = square("", spot.x, spot.y, 0.5).polygon_enu_m
    polygons, (finding,) = fence_polygons(mission(), (NoFlyZone("shelf", ring, 60.0, 300.0),))
    assert polygons == ()
    assert finding.severity is Severity.WARNING
    assert "a return passes under" in finding.message
    assert len(fence_polygons(mission(), (NoFlyZone("yard", ring, 0.0, 300.0),))[0]) == 1


def test_a_zone_on_the_way_to_a_rally_point_counts_too() -> None:
    lat, lon, height = geodetic_from_enu(HONG_KONG, [(200.0, 0.0, 2.0)])
    rally = (GeoPoint(float(lat[0]), float(lon[0]), float(height[0])),)
    shelf = NoFlyZone("shelf", square("", 150.0, 0.0, 40.0).polygon_enu_m, 60.0, 300.0)
    assert len(fence_polygons(mission(), (shelf,))[0]) == 1
    assert fence_polygons(mission(), (shelf,), rally=rally)[0] == ()


def test_what_lies_inside_another_zone_takes_no_corners_and_equal_ones_take_them_once() -> None:
    large, small = square("large", 100.0, 100.0, 40.0), square("small", 105.0, 95.0, 5.0)
    polygons, findings = fence_polygons(mission(), (small, large, square("again", 100.0, 100.0, 40.0)))
    assert findings == ()
    assert len(polygons) == 1
    assert local(polygons[0]).area == pytest.approx(6400.0, rel=1e-4)


@pytest.mark.parametrize("autopilot", Autopilot)
def test_a_circle_of_many_corners_is_drawn_with_those_that_there_is_room_for(autopilot: Autopilot) -> None:
    circle = star("heliport", 300.0, 0.0, np.full(400, 200.0))
    (polygon,), (note,) = fence_polygons(mission(), (circle,), autopilot)
    assert len(polygon) + HEADER_ITEMS <= facts(autopilot).max_fence_items
    assert local(polygon).buffer(1e-3).covers(shapely.Polygon(circle.polygon_enu_m))
    assert note.code == "zone-fence-coarse"
    assert f"with {len(polygon)} in place of 400" in note.message
    # r (1 / cos(pi / n) - 1) is what n tangents cost at least; twice that is still drawn well.
    assert note.value is not None
    assert 200.0 * (1.0 / math.cos(math.pi / len(polygon)) - 1.0) < note.value < 2.5


def test_the_nearest_zones_come_first_where_there_is_no_room_for_all() -> None:
    zones = [square(f"z{n}", 60.0 + 30.0 * (n % 20), 60.0 + 30.0 * (n // 20)) for n in range(60)]
    polygons, findings = fence_polygons(mission(), zones, Autopilot.PX4)
    room = facts(Autopilot.PX4).max_fence_items
    assert sum(len(polygon) + HEADER_ITEMS for polygon in polygons) <= room
    left = {finding.place: finding.value for finding in findings if finding.code == "zone-not-fenced"}
    assert len(left) + len(polygons) == 60
    flown = track()
    farthest_m = max(flown.distance(local(polygon)) for polygon in polygons)
    assert all(away_m is not None and away_m >= farthest_m - 1e-3 for away_m in left.values())
    assert "room for 64 corners" in findings[0].message


@pytest.mark.long
@settings(deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 12),
    st.sampled_from(list(Autopilot)),
)
def test_every_zone_is_held_by_the_fence_or_named_and_the_path_stays_clear(
    seed: int, n_zones: int, autopilot: Autopilot
) -> None:
    rng, flown = np.random.default_rng(seed), track()
    zones = [
        star(f"z{n}", *rng.uniform(-150.0, 150.0, 2), rng.uniform(0.3, 1.0, rng.integers(3, 90)) * rng.uniform(3, 90))
        for n in range(n_zones)
    ]
    polygons, findings = fence_polygons(mission(), zones, autopilot)
    assert sum(len(polygon) + HEADER_ITEMS for polygon in polygons) <= facts(autopilot).max_fence_items
    drawn = [local(polygon) for polygon in polygons]
    assert all(each.is_valid and flown.distance(each) > FENCE_CLEARANCE_M - 1e-3 for each in drawn)
    left = {finding.place for finding in findings if finding.code == "zone-not-fenced"}
    for zone in zones:
        area = shapely.Polygon(zone.polygon_enu_m)
        assert (zone.id in left) or any(each.buffer(1e-3).covers(area) for each in drawn)
        if flown.distance(area) < FENCE_CLEARANCE_M:
            assert zone.id in left


# A fence that is on a vehicle already, and how a mission lies in it


def on_globe(places: list[tuple[float, float]]) -> Polygon:
    lat, lon, _ = geodetic_from_enu(HONG_KONG, [(x, y, 0.0) for x, y in places])
    return tuple(zip(map(float, lat), map(float, lon), strict=True))


def box(x: float, y: float, half_m: float, *, inside: bool) -> FencePolygon:
    places = [(x - half_m, y - half_m), (x + half_m, y - half_m), (x + half_m, y + half_m), (x - half_m, y + half_m)]
    return FencePolygon(on_globe(places), inside)


@pytest.mark.parametrize("half_m", [60.0, 200.0, 5000.0])
def test_the_room_in_a_square_is_that_of_plane_geometry(half_m: float) -> None:
    fit = fence_fit([box(0.0, 0.0, half_m, inside=True)], mission(), in_all=True)
    min_x, min_y, max_x, max_y = track().bounds
    farthest_m = max(-min_x, -min_y, max_x, max_y)
    assert fit.room_m == pytest.approx(half_m - farthest_m, abs=0.01 + 3e-4 * half_m)
    assert (fit.waypoint is None) == (fit.room_m >= 0.0)


def test_areas_to_stay_in_count_together_or_each_as_the_autopilot_has_it() -> None:
    areas = [box(0.0, 0.0, 500.0, inside=True), box(3000.0, 0.0, 500.0, inside=True)]
    assert fence_fit(areas, mission(), in_all=False).room_m > 300.0
    assert fence_fit(areas, mission(), in_all=True) == FenceFit(-math.inf, 0), "they have nothing in common"


def test_a_leg_through_a_small_area_leaves_no_waypoint_outside() -> None:
    flown = track()
    start, end = np.array(flown.coords[1]), np.array(flown.coords[2])
    middle = (start + end) / 2.0
    half_m = 0.2 * float(np.linalg.norm(end - start))
    fit = fence_fit([box(*middle, half_m, inside=False)], mission(), in_all=True)
    assert fit.waypoint is None
    assert -1.5 * half_m < fit.room_m < -0.4 * half_m


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_a_mission_is_outside_where_the_simulated_vehicle_says_so_of_a_waypoint(seed: int, in_all: bool) -> None:
    """Against the simulator's own test of points, which shares no code."""
    rng = np.random.default_rng(seed)
    fences: list[FencePolygon | FenceCircle] = []
    zones: list[FenceZone] = []
    for _ in range(rng.integers(1, 5)):
        inside, (x, y) = bool(rng.random() < 0.6), rng.uniform(-80.0, 80.0, 2)
        if rng.random() < 0.4:
            radius_m = float(rng.uniform(5.0, 200.0))
            (place,) = on_globe([(x, y)])
            fences.append(FenceCircle(*place, radius_m, inside))
            zones.append(FenceZone(inside, ((float(x), float(y)),), radius_m))
        else:
            radii, angles = rng.uniform(5.0, 250.0, 7), np.sort(rng.uniform(0.0, 2.0 * math.pi, 7))
            corners = tuple(zip(x + radii * np.cos(angles), y + radii * np.sin(angles), strict=True))
            fences.append(FencePolygon(on_globe(list(corners)), inside))
            zones.append(FenceZone(inside, corners))
    fit = fence_fit(fences, mission(), in_all=in_all)

    def forbids(x: float, y: float) -> bool:
        wanted = [zone.holds(x, y) for zone in zones if zone.is_inclusion]
        left = bool(wanted) and not (all(wanted) if in_all else any(wanted))
        return left or any(zone.holds(x, y) for zone in zones if not zone.is_inclusion)

    outside = [forbids(*place) for place in track().coords]
    if abs(fit.room_m) > 0.1 and math.isfinite(fit.room_m):
        assert (fit.room_m < 0.0) >= any(outside)
        if fit.room_m > 0.0:
            assert not any(outside)
        if fit.waypoint is not None and not outside[fit.waypoint]:
            # At most a chord's breadth from the edge.
            assert any(
                abs(math.dist(zone.corners_m[0], track().coords[fit.waypoint]) - zone.radius_m) < 0.05
                for zone in zones
                if zone.radius_m > 0.0
            )


def test_across_the_date_line_a_fence_lies_where_it_is() -> None:
    east = replace(mission(), takeoff=GeoPoint(10.0, 179.9995, 5.0), waypoints=(), origin=Origin(10.0, 179.9995, 5.0))
    around = FencePolygon(((9.99, 179.99), (9.99, -179.99), (10.01, -179.99), (10.01, 179.99)), is_inclusion=True)
    assert fence_fit([around], east, in_all=True).room_m == pytest.approx(1041.0, rel=0.01)
    world = FencePolygon(((-89.0, -180.0), (-89.0, 180.0), (89.0, 180.0), (89.0, -180.0)), is_inclusion=True)
    assert fence_fit([world], mission(), in_all=True).room_m > 1e6, "as plain numbers, as vehicles count"


@pytest.mark.parametrize("half_m", [1.0, 1e3, 1e6])
def test_fences_far_away_hold_nothing_and_forbid_nothing(half_m: float) -> None:
    far = tuple((-lat, lon - 180.0) for lat, lon in box(0.0, 0.0, min(half_m, 5e5), inside=True).corners)
    assert fence_fit([FencePolygon(far, True)], mission(), in_all=True).room_m < -1e6
    assert fence_fit([FencePolygon(far, False)], mission(), in_all=True).room_m > 0.0


@given(st.integers(0, 2**32 - 1))
def test_items_of_fences_come_back_as_they_were_and_damaged_ones_are_refused(seed: int) -> None:
    rng = np.random.default_rng(seed)
    fences = [
        FenceCircle(1.0 + n, 2.0, float(np.float32(rng.uniform(1.0, 90.0))), bool(rng.integers(2)))
        if rng.random() < 0.4
        else FencePolygon(tuple((n + k / 8.0, -k / 4.0) for k in range(rng.integers(3, 9))), bool(rng.integers(2)))
        for n in range(rng.integers(0, 5))
    ]
    items = list(to_wire(fence_items(fences), Autopilot.PX4, MissionType.FENCE))
    assert fences_of(items) == tuple(fences)
    if items:
        place = int(rng.integers(len(items)))
        value = rng.choice([math.nan, math.inf, -1.0, 0.0])
        items[place] = replace(items[place], param1=float(value))
        with pytest.raises(MissionError, match=r"fence"):
            fences_of(items)
