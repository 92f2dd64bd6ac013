from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.fence import FENCE_CLEARANCE_M, HEADER_ITEMS, Polygon, fence_polygons
from missions.mission.build import missions_from_plan
from missions.mission.model import GeoPoint, Mission
from planning.base.findings import Severity
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
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
