"""Zones in a site's frame: never smaller than the true ones, hardly larger, wherever on earth."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod

from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.geo.height_field import HeightField
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.site.ground import Ground
from planning.site.records import Airspace
from planning.site.terrain import Surfaces
from planning.site.zones.arcs import sagitta_m
from planning.site.zones.local import (
    AREA_TOLERANCE_M,
    CIRCLE_TOLERANCE_M,
    GEOID_TOLERANCE_M,
    NARROW_M,
    circle_excess_m,
    local_zones,
    prisms,
    simple_parts,
    tangents,
)
from planning.site.zones.records import (
    FROM_GROUND,
    UNLIMITED,
    Circle,
    HeightAbove,
    Limit,
    Outline,
    Restriction,
    Volume,
    Zone,
    ZoneSet,
)
from tests.planning.site.zones.zone_files import AIRSPACE, ORIGIN, square
from tests.slow import slow

GEOD = Geod(ellps="WGS84")

WIDE = Airspace((-3000.0, -3000.0, 3.0), (3000.0, 3000.0, 80.0), ground_z_m=0.0)


def found(*volumes, origin=ORIGIN, airspace=AIRSPACE):
    zone = Zone("Z", "Z", Restriction.PROHIBITED, volumes=tuple(volumes))
    return local_zones(ZoneSet("test", (zone,)), origin, airspace)


def area_of(area, origin=ORIGIN, airspace=AIRSPACE):
    """Area of a zone in the local frame."""
    (near,) = found(Volume(area), origin=origin, airspace=airspace).near
    return near.volumes[0].area


PLACES = [
    Origin(47.0, 8.0, 500.0),
    Origin(-17.5, 180.0, 0.0),
    Origin(65.0, -179.9995, 30.0),
    Origin(89.995, 20.0, 0.0),
    Origin(-90.0, 0.0, 2800.0),
    Origin(0.0, 0.0, 0.0),
]


@pytest.mark.parametrize("origin", PLACES, ids=str)
@pytest.mark.parametrize("radius_m", [300.0, slow(1852.0), 20_000.0])
def test_a_circle_holds_the_true_one_and_is_larger_by_the_stated_tolerance_at_most(origin, radius_m):
    """Oracle: geodesic distances of places on both sides of the circle's edge near the site."""
    lon, lat, _ = GEOD.fwd(origin.lon_deg, origin.lat_deg, 130.0, radius_m)
    area = area_of(Circle((lon, lat), radius_m), origin, WIDE)
    azimuths = np.linspace(0.0, 360.0, 721)
    for beyond_m, is_inside in ((-0.01, True), (CIRCLE_TOLERANCE_M + 2.0 * AREA_TOLERANCE_M, False)):
        n = len(azimuths)
        lons, lats, _ = GEOD.fwd(np.full(n, lon), np.full(n, lat), azimuths, np.full(n, radius_m + beyond_m))
        points = enu_from_geodetic(origin, lats, lons, np.full(n, origin.ellipsoid_height_m))
        near = points[np.hypot(points[:, 0], points[:, 1]) < 3000.0]
        assert len(near) > 5
        assert (shapely.contains_xy(area, near[:, 0], near[:, 1]) == is_inside).all()


def test_what_tangents_and_chords_cost_is_the_closed_form_and_falls_with_the_square_of_their_number():
    for n in (32, 233, 1000):
        polygon = np.array([(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)) for k in range(n)])
        outside = polygon * (5000.0 + circle_excess_m(5000.0, n))
        assert shapely.Polygon(outside).exterior.distance(shapely.Point(0, 0)) == pytest.approx(5000.0, rel=1e-9)
        chords = shapely.Polygon(polygon * 5000.0)
        assert 5000.0 - chords.exterior.distance(shapely.Point(0, 0)) == pytest.approx(sagitta_m(5000.0, 360.0 / n))
    assert circle_excess_m(5000.0, 100) / circle_excess_m(5000.0, 200) == pytest.approx(4.0, rel=1e-2)
    for radius_m in (1.0, 500.0, 5500.0, 100_000.0):
        assert circle_excess_m(radius_m, tangents(radius_m)) <= CIRCLE_TOLERANCE_M * 1.001
    assert circle_excess_m(2e6, tangents(2e6)) < 1.0


@pytest.mark.parametrize("origin", PLACES[:4], ids=str)
def test_a_square_lies_where_it_was_drawn_also_across_the_date_line(origin):
    ring = tuple((lon, lat) for lon, lat in square(40.0, -20.0, 30.0, origin))
    area = area_of(Outline(ring), origin)
    assert area.symmetric_difference(shapely.box(10.0, -50.0, 70.0, 10.0)).area < 4 * 60.0 * 3.0 * AREA_TOLERANCE_M
    assert area.covers(shapely.box(10.0, -50.0, 70.0, 10.0))


def test_a_zone_that_is_cut_at_the_date_line_or_at_the_edge_of_a_sheet_has_no_gap_there():
    """RFC 7946, 3.1.9: polygons that cross the antimeridian are cut there into two."""
    origin = Origin(-17.5, 180.0, 0.0)
    west = ((179.999, -17.5005), (180.0, -17.5005), (180.0, -17.4995), (179.999, -17.4995))
    east = ((-180.0, -17.5005), (-179.999, -17.5005), (-179.999, -17.4995), (-180.0, -17.4995))
    (near,) = found(Volume(Outline(west)), Volume(Outline(east)), origin=origin).near
    solids = Solids.of(join([prism.prism() for prism in prisms(near, AIRSPACE)]).corners_enu_m)
    for x in np.linspace(-0.3, 0.3, 13):
        way = np.array([[x, -200.0, 20.0]]), np.array([[x, 200.0, 20.0]])
        assert solids.segment_distances_m(*way)[0] == 0.0


@pytest.mark.parametrize("winding", [1, -1])
def test_windings_and_spellings_of_longitudes_make_no_difference(winding):
    origin = Origin(-17.5, 179.9999, 0.0)
    ring = [(lon % 360.0, lat) for lon, lat in square(0.0, 0.0, 60.0, origin)][::winding]
    assert area_of(Outline(tuple(ring)), origin).area == pytest.approx(120.2**2, rel=1e-3)


def test_a_ring_around_a_pole_holds_the_pole_and_not_the_rest_of_the_world():
    ring = tuple((lon, 85.0) for lon in (0.0, 90.0, 180.0, -90.0))
    assert found(Volume(Outline(ring)), origin=Origin(89.9, 45.0, 0.0)).near
    assert found(Volume(Outline(ring)), origin=Origin(-89.9, 45.0, 0.0)).nearest_m > 1e6
    assert found(Volume(Outline(ring)), origin=ORIGIN).nearest_m > 1e6


def test_long_edges_count_both_straight_in_degrees_and_as_geodesics():
    """At 60 degrees north an edge of 10 degrees along the parallel, 556 km, and its geodesic are 10.5 km apart."""
    ring = ((0.0, 60.0), (10.0, 60.0), (10.0, 59.0), (0.0, 59.0))
    ((lon, lat),) = GEOD.npts(0.0, 60.0, 10.0, 60.0, 1)
    between = Origin((lat + 60.0) / 2.0, lon, 0.0)
    assert (lat - 60.0) * 111_400.0 == pytest.approx(
        556_000.0**2 * math.tan(math.radians(60)) / (8 * 6.371e6), rel=0.02
    )
    assert found(Volume(Outline(ring)), origin=between).near[0].distance_m == 0.0
    assert area_of(Outline(ring), between).area == pytest.approx(2200.0**2, rel=1e-6)
    beyond = Origin(lat + 0.012, lon, 0.0)
    assert not found(Volume(Outline(ring)), origin=beyond).near
    # The other way round: a hole is one where both agree.
    outer = ((-1.0, 61.0), (11.0, 61.0), (11.0, 58.0), (-1.0, 58.0))
    assert found(Volume(Outline(outer, (ring,))), origin=between).near[0].distance_m == 0.0
    assert not found(Volume(Outline(outer, (ring,))), origin=Origin(59.5, 5.0, 0.0)).near


def test_holes_are_left_out_and_the_prisms_have_none():
    outer, hole = square(0.0, 0.0, 90.0), square(0.0, 0.0, 40.0)
    area = area_of(Outline(tuple(map(tuple, outer)), (tuple(map(tuple, hole)),)))
    assert not area.contains(shapely.Point(0.0, 0.0))
    assert area.contains(shapely.Point(60.0, 0.0))
    parts = list(simple_parts(area))
    assert all(not part.interiors for part in parts)
    assert sum(part.area for part in parts) == pytest.approx(area.area, rel=1e-9)
    (near,) = found(Volume(Outline(tuple(map(tuple, outer)), (tuple(map(tuple, hole)),)))).near
    assert sum(shapely.Polygon(each.polygon_enu_m).area for each in prisms(near, AIRSPACE)) == pytest.approx(area.area)


def local_ring(points):
    from tests.planning.site.zones.zone_files import lon_lat

    return tuple((lon, lat) for lon, lat in lon_lat(points))


def test_rings_that_cross_touch_or_enclose_nothing_count_whole_and_ask():
    bow = found(Volume(Outline(local_ring([(-50, -50), (50, 50), (50, -50), (-50, 50)])))).near[0]
    assert bow.volumes[0].area.area == pytest.approx(2 * 0.5 * 50 * 100, rel=0.02)
    assert "crosses itself" in bow.questions[0]
    twice = [(-50, -50), (50, -50), (50, 50), (-50, 50)]
    assert found(Volume(Outline(local_ring([*twice, *twice])))).near[0].volumes[0].area.area > 9_900.0
    touching = found(Volume(Outline(local_ring([(0, 0), (50, 0), (50, 50), (0, 0), (-50, 50), (-50, 0)])))).near[0]
    assert touching.volumes[0].area.area == pytest.approx(2500.0, rel=0.05)
    for points in ([(10, 10)], [(10, 10), (10, 10), (10, 10)], [(0, 0), (50, 0)], [(0, 0), (50, 0), (25, 0), (0, 0)]):
        flat = found(Volume(Outline(local_ring(points)))).near[0]
        assert flat.volumes[0].area.contains(shapely.Point(10.0, 10.0 if len({*points}) == 1 else 0.0))
        assert flat.volumes[0].area.area > 0.9 * math.pi * NARROW_M**2
        assert "encloses nothing" in flat.place_questions[0]


def test_heights_above_ground_sea_and_ellipsoid_become_local_ones_by_their_closed_forms():
    ring = tuple((lon, lat) for lon, lat in square(0.0, 0.0, 50.0))
    airspace = Airspace((-100.0, -100.0, 3.0), (100.0, 100.0, 80.0), ground_z_m=7.0)
    geoid_m = float(undulation_m(ORIGIN.lat_deg, ORIGIN.lon_deg))
    sinks_m = 1141.4**2 / (2 * 6.37e6)

    def span(lower, upper):
        near = found(Volume(Outline(ring), lower, upper), airspace=airspace).near[0]
        return near.volumes[0].floor_m, near.volumes[0].ceiling_m

    def limit(value_m, above):
        return Limit(value_m, above, "")

    assert span(FROM_GROUND, UNLIMITED) == (-math.inf, math.inf)
    assert span(limit(20.0, HeightAbove.GROUND), limit(120.0, HeightAbove.GROUND)) == (27.0, 127.0)
    low, high = span(limit(520.0, HeightAbove.ELLIPSOID), limit(620.0, HeightAbove.ELLIPSOID))
    assert low == pytest.approx(20.0 - sinks_m, abs=0.01)
    assert high == 120.0
    low, high = span(limit(520.0, HeightAbove.SEA_LEVEL), limit(620.0, HeightAbove.SEA_LEVEL))
    assert low == pytest.approx(20.0 + geoid_m - GEOID_TOLERANCE_M - sinks_m, abs=0.5)
    assert high == pytest.approx(120.0 + geoid_m + GEOID_TOLERANCE_M, abs=0.5)
    assert span(limit(5.0, HeightAbove.UNKNOWN), limit(9.0, HeightAbove.UNKNOWN)) == (-math.inf, math.inf)


@given(st.floats(300.0, 6000.0), st.floats(930.0, 1085.0), st.floats(-50.0, 45.0))
def test_flight_levels_count_wherever_pressure_and_temperature_may_bring_them(level_m, sea_hpa, sea_c):
    """Oracle: the hypsometric equation with 6.5 K/km, against the standard atmosphere of the same pressure."""
    pressure = 1013.25 * (1.0 - 0.0065 * level_m / 288.15) ** 5.25588
    true_m = (273.15 + sea_c) / 0.0065 * (1.0 - (pressure / sea_hpa) ** (1.0 / 5.25588))
    ring = tuple((lon, lat) for lon, lat in square(0.0, 0.0, 50.0))
    level = Limit(level_m, HeightAbove.FLIGHT_LEVEL, "")
    geoid_m = float(undulation_m(ORIGIN.lat_deg, ORIGIN.lon_deg))
    z_m = true_m + geoid_m - ORIGIN.ellipsoid_height_m
    below, above = Volume(Outline(ring), level, UNLIMITED), Volume(Outline(ring), FROM_GROUND, level)
    assert found(below).near[0].volumes[0].floor_m <= z_m <= found(above).near[0].volumes[0].ceiling_m


def test_heights_above_ground_count_from_the_bounds_of_terrain_and_are_open_where_it_has_none():
    grid = HeightField(-200.0, -200.0, 10.0, np.add.outer(np.zeros(41), np.linspace(-20.0, 20.0, 41)))
    ground = Ground(0.0, Surfaces(grid, replace(grid, z_m=grid.z_m + 1.0), replace(grid, z_m=grid.z_m - 1.0)))
    ring = tuple((lon, lat) for lon, lat in square(0.0, 0.0, 50.0))
    limits = Limit(30.0, HeightAbove.GROUND, ""), Limit(60.0, HeightAbove.GROUND, "")
    zones = ZoneSet("test", (Zone("Z", "Z", Restriction.PROHIBITED, volumes=(Volume(Outline(ring), *limits),)),))
    (near,) = local_zones(zones, ORIGIN, AIRSPACE, ground).near
    assert near.volumes[0].floor_m == pytest.approx(30.0 - 6.0 - 1.0, abs=1e-9)
    assert near.volumes[0].ceiling_m == pytest.approx(60.0 + 6.0 + 1.0, abs=1e-9)
    lost = replace(grid, z_m=np.where(grid.z_m > 4.5, np.nan, grid.z_m))
    (near,) = local_zones(zones, ORIGIN, AIRSPACE, Ground(0.0, Surfaces(lost, lost, lost))).near
    assert (near.volumes[0].floor_m, near.volumes[0].ceiling_m) == (-math.inf, math.inf)
    assert "no heights" in near.questions[0]


def test_limits_that_contradict_each_other_count_at_all_heights_and_ask():
    ring = tuple((lon, lat) for lon, lat in square(0.0, 0.0, 50.0))
    near = found(Volume(Outline(ring), Limit(500.0, HeightAbove.GROUND, "500 m AGL"), FROM_GROUND)).near[0]
    assert (near.volumes[0].floor_m, near.volumes[0].ceiling_m) == (-math.inf, math.inf)
    assert "500 m AGL" in near.questions[0]


def test_a_file_of_another_place_is_told_and_one_with_latitude_and_longitude_exchanged():
    ring = tuple((lon, lat) for lon, lat in square(0.0, 0.0, 50.0))
    swapped = found(Volume(Outline(tuple((lat, lon) for lon, lat in ring))))
    assert [each.is_unsure for each in swapped.near] == [True]
    assert swapped.is_swapped
    far = found(Volume(Circle((30.0, 10.0), 100.0)))
    assert far.nearest_m == pytest.approx(GEOD.inv(30.0, 10.0, 8.0, 47.0)[2], rel=0.2)
    assert not far.near
    assert not far.is_swapped


@given(st.floats(-89.0, 89.0), st.floats(-180.0, 180.0), st.floats(-89.0, 89.0), st.floats(-180.0, 180.0))
def test_the_distance_that_sorts_zones_out_is_never_more_than_the_true_one(lat, lon, zone_lat, zone_lon):
    origin = Origin(lat, lon, 0.0)
    ring = (
        (zone_lon, zone_lat),
        (zone_lon + 0.5, zone_lat),
        (zone_lon + 0.5, zone_lat + 0.4),
        (zone_lon, zone_lat + 0.4),
    )
    true_m = min(GEOD.inv(lon, lat, *corner)[2] for corner in ring)
    assert found(Volume(Outline(ring)), origin=origin).nearest_m <= true_m + 1.0


def test_ten_thousand_zones_take_a_moment():
    zones = tuple(
        Zone(
            f"Z{k}",
            "Z",
            Restriction.PROHIBITED,
            volumes=(Volume(Circle((6.0 + 0.0004 * k, 46.0 + 0.0002 * k), 300.0)),),
        )
        for k in range(10_000)
    )
    started = time.process_time()
    near = local_zones(ZoneSet("test", zones), ORIGIN, AIRSPACE).near
    assert time.process_time() - started < 2.0
    assert 1 <= len(near) < 100
