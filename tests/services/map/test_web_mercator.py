"""Web Mercator against published worked examples, and where it breaks."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod, Transformer

from groundstation.services.map.web_mercator import (
    MAX_LAT_DEG,
    Tile,
    geodetic_from_world,
    metres_per_point,
    world_from_enu,
    world_from_geodetic,
)
from planning.geo.frames import Origin
from tests.missions.plans import ORIGINS
from tests.services.map_files import tile_at


def test_chicago_lies_where_googles_documentation_puts_it():
    """Google Maps Platform, "Map and tile coordinates": 41.85 N 87.65 W."""
    ((x, y),) = world_from_geodetic(41.85, -87.65)
    assert 256.0 * x == pytest.approx(65.67111111111113, abs=1e-9)
    assert 256.0 * y == pytest.approx(95.17492654697409, abs=1e-9)
    assert (math.floor(256 * 8 * x), math.floor(256 * 8 * y)) == (525, 761)
    assert tile_at(x, y, 3) == Tile(3, 2, 2)


def test_corner_of_a_tile_is_that_of_the_mercantile_documentation():
    """The documentation of mercantile: the bounds of tile 486, 332 at level 10."""
    lat, lon = geodetic_from_world(486 / 1024, 332 / 1024)
    assert (lat, lon) == pytest.approx((53.33087298301705, -9.140625), abs=1e-12)
    lat, lon = geodetic_from_world(487 / 1024, 333 / 1024)
    assert (lat, lon) == pytest.approx((53.12040528310657, -8.7890625), abs=1e-12)


@given(st.floats(-85.0, 85.0), st.floats(-179.999, 179.999))
def test_world_coordinates_are_epsg_3857_scaled(lat, lon):
    ((x, y),) = world_from_geodetic(lat, lon)
    east, north = Transformer.from_crs(4326, 3857, always_xy=True).transform(lon, lat)
    half = math.pi * 6378137.0
    assert (x, y) == pytest.approx((0.5 + east / (2 * half), 0.5 - north / (2 * half)), abs=1e-12)
    assert geodetic_from_world(x, y) == pytest.approx((lat, lon), abs=1e-9)


@pytest.mark.parametrize("zoom", [0, 1, 22])
def test_corners_of_the_world_are_the_corner_tiles(zoom):
    last = 2**zoom - 1
    assert tile_at(*world_from_geodetic(90.0, -180.0)[0], zoom) == Tile(zoom, 0, 0)
    assert tile_at(*world_from_geodetic(-90.0, 180.0)[0], zoom) == Tile(zoom, last, last)


def test_poles_and_the_end_of_the_world_stay_finite():
    world = world_from_geodetic([90.0, -90.0, MAX_LAT_DEG, 89.999999], [0.0, 0.0, 0.0, 0.0])
    assert np.isfinite(world).all()
    assert world[:, 1] == pytest.approx([0.0, 1.0, 0.0, 0.0], abs=1e-15)
    assert geodetic_from_world(0.5, -3.0)[0] == pytest.approx(MAX_LAT_DEG)
    assert metres_per_point(90.0, 0.0) < 1e-9


@given(st.integers(0, 22), st.floats(0.0, 1.0, exclude_max=True), st.floats(0.0, 1.0, exclude_max=True))
def test_a_tile_lies_in_its_parent_and_holds_its_points(zoom, x, y):
    tile = tile_at(x, y, zoom)
    assert tile.column <= x * 2**zoom <= tile.column + 1
    assert tile.row <= y * 2**zoom <= tile.row + 1
    for levels in range(zoom + 1):
        assert tile.parent(levels) == tile_at(x, y, zoom - levels)


@pytest.mark.parametrize("origin", ORIGINS)
def test_local_points_stay_together_wherever_the_site_lies(origin):
    """Also across the antimeridian; the picture has the true shape and scale to a thousandth."""
    points = np.array([[0.0, 0.0, 0.0], [400.0, 0.0, 0.0], [0.0, 400.0, 0.0], [-400.0, -400.0, 50.0]])
    world = world_from_enu(origin, points)
    assert np.ptp(world, axis=0).max() < 1e-3
    east, north = world[1] - world[0], world[2] - world[0]
    per_unit = 256.0 * metres_per_point(origin.lat_deg, 0.0)
    assert math.hypot(*east) * per_unit == pytest.approx(400.0, rel=1e-3)
    assert math.hypot(*north) * per_unit == pytest.approx(400.0, rel=8e-3)
    assert east[0] > 0 > north[1]


@given(st.floats(-85.0, 85.0))
def test_scale_is_that_of_the_ellipsoid(lat):
    _, _, along_m = Geod(ellps="WGS84").inv(0.0, lat, 360.0 * 1e-6, lat)
    assert metres_per_point(lat, 0.0) * 256e-6 == pytest.approx(along_m, rel=1e-6)


def test_site_at_a_pole_is_brought_to_the_edge_of_the_world():
    world = world_from_enu(Origin(90.0, 0.0, 0.0), [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
    assert world[:, 1] == pytest.approx([0.0, 0.0], abs=1e-15)
