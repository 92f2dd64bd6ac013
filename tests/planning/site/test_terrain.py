"""Terrain of a site: its form in the file, the effect, and what flights keep above it."""

import base64
import zlib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InfeasibleError, InputError
from planning.base.findings import Severity
from planning.checks.rules import terrain_in_use, terrain_unknown
from planning.geo.height_field import HeightField
from planning.site.file import read_site, site_bytes, write_site
from planning.site.free_space import free_space
from planning.site.ground import Ground, decide_terrain, ground_of, height_at
from planning.site.terrain import Terrain, surfaces, terrain_of
from tests.planning.plan_cases import kiosk

STEP = 2.0


def terrain(function, accuracy_m=0.0, use="auto", half=60.0, off_m=0.0):
    nodes = np.arange(-half, half + 0.1, STEP)
    x, y = np.meshgrid(nodes, nodes)
    z = function(x, y) + 0.0 * x
    return terrain_of(HeightField(-half, -half, STEP, z), z + off_m, z - off_m, accuracy_m=accuracy_m, use=use)


def slope(x, y):
    return 0.1 * (y + 30.0)


def hill_site(function=slope, **facts):
    home = (0.0, -30.0, round(float(function(0.0, -30.0)), 3))
    return kiosk(home_enu_m=home, terrain=terrain(function, **facts))


def test_a_site_reads_back_with_its_terrain_and_without_one_its_file_is_as_ever(tmp_path):
    model = kiosk(terrain=terrain(slope, accuracy_m=4.0), building_mesh=None, obstacles=())
    write_site(tmp_path / "a.site.json", model.site)
    read = read_site(tmp_path / "a.site.json").site
    assert read == model.site
    assert b"terrain" not in site_bytes(replace(model.site, terrain=None))


@given(st.integers(0, 2**32 - 1))
def test_heights_in_the_file_are_millimetres_and_bounds_are_rounded_outwards(seed):
    rng = np.random.default_rng(seed)
    z = rng.normal(0.0, 50.0, (7, 5))
    z[rng.random((7, 5)) < 0.2] = np.nan
    upper, lower = z + rng.random((7, 5)), z - rng.random((7, 5))
    found = surfaces(terrain_of(HeightField(0.0, 0.0, 1.0, z), upper, lower))
    known = ~np.isnan(z)
    assert (np.isnan(found.ground.z_m) == ~known).all()
    assert np.abs(found.ground.z_m - z)[known].max() <= 0.0005 + 1e-12
    for bound, truth, sign in ((found.upper, upper, 1.0), (found.lower, lower, -1.0)):
        wider = sign * (bound.z_m - truth)[known]
        assert wider.min() >= -1e-8
        assert wider.max() <= 0.001 + 1e-8


def packed(values):
    return base64.b64encode(zlib.compress(np.asarray(values, "<i4").tobytes())).decode()


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"ground": "no base64 at all"}, "damaged"),
        ({"ground": base64.b64encode(b"not deflated").decode()}, "damaged"),
        ({"ground": packed(np.zeros((3, 2)))}, "expected 9 nodes, found 6"),
        ({"ground": packed(np.zeros(10**6))}, "expected 9 nodes"),
        ({"upper": packed(np.full((3, 3), -1))}, "between its bounds"),
        ({"lower": packed(np.full((3, 3), -(2**31)))}, "the same nodes"),
        ({"ground": packed(np.full((3, 3), 2**31 - 1)), "upper": packed(np.full((3, 3), 2**31 - 1))}, "within 20000 m"),
        ({"rows": 1}, "at least 2 x 2"),
        ({"columns": 10**6, "rows": 10**6}, "at most 4000000"),
        ({"step_m": 0.0}, "more than 0"),
        ({"accuracy_m": -1.0}, "0 m or more"),
        ({"west_south_m": (float("inf"), 0.0)}, "finite"),
    ],
)
def test_damaged_terrain_is_refused(changes, expected):
    flat = packed(np.zeros((3, 3)))
    fields = {"west_south_m": (0.0, 0.0), "step_m": 1.0, "columns": 3, "rows": 3}
    fields |= {"ground": flat, "upper": flat, "lower": flat}
    Terrain(**fields)
    with pytest.raises(ValueError, match=expected):
        Terrain(**{**fields, **changes})


def test_a_site_file_with_damaged_terrain_says_where(tmp_path):
    path = tmp_path / "a.site.json"
    site = kiosk(terrain=terrain(slope), building_mesh=None, obstacles=()).site
    path.write_bytes(site_bytes(site).replace(b'"ground": "e', b'"ground": "!', 1))
    with pytest.raises(InputError, match=r"a\.site\.json: terrain\.ground: the heights are damaged"):
        read_site(path)


@pytest.mark.parametrize(
    ("function", "facts", "on", "size"),
    [
        (lambda x, y: 0.3 + 0.0 * x, {}, False, 0.3),
        (lambda x, y: 0.6 + 0.0 * x, {}, True, 0.6),
        (lambda x, y: -0.6 + 0.0 * x, {}, True, 0.6),
        (lambda x, y: 0.3 + 0.0 * x, {"accuracy_m": 4.0}, True, 4.3),
        (lambda x, y: np.where((x > 50.0) | (y < -50.0), 99.0, 0.0), {}, False, 0.0),
        (lambda x, y: np.where((x == 0.0) & (y == 20.0), np.nan, 0.0), {}, True, 40.0),
        (slope, {"use": "off"}, False, 7.0),
        (lambda x, y: 0.0 * x, {"use": "on"}, True, 0.0),
    ],
)
def test_terrain_counts_where_it_departs_from_level_ground_below_the_airspace(function, facts, on, size):
    site = hill_site(function, **facts).site
    decision = decide_terrain(site)
    assert decision.on is on
    assert decision.size == pytest.approx(size, abs=0.002)
    assert (ground_of(site).terrain is not None) is on


def test_without_effect_flights_are_those_over_level_ground():
    flat, plain = hill_site(lambda x, y: 0.2 + 0.0 * x), kiosk(home_enu_m=(0.0, -30.0, 0.2))
    space, other = free_space(flat, 5.0), free_space(plain, 5.0)
    points = np.random.default_rng(0).uniform(space.low_enu_m, space.high_enu_m, (2000, 3))
    assert (space.is_allowed(points) == other.is_allowed(points)).all()
    assert space.low_enu_m.tolist() == other.low_enu_m.tolist()
    assert space.ground == Ground(0.0) or space.ground.terrain is None


def test_viewpoints_and_legs_keep_the_lowest_height_above_the_slope_below_them():
    space = free_space(hill_site(), 5.0)
    rng = np.random.default_rng(3)
    points = rng.uniform(space.low_enu_m, space.high_enu_m, (20_000, 3))
    above = points[:, 2] - slope(points[:, 0], points[:, 1])
    allowed = space.is_allowed(points)
    assert above[allowed].min() >= 5.0
    # Nothing else forbids a place this high above it in the open.
    open_air = (np.abs(points[:, 0]) > 16.0) & (points[:, 0] > -10.0) & (points[:, 1] < -20.0) & (points[:, 0] < 35.0)
    assert allowed[open_air & (above > 5.01) & (np.abs(points[:, 1]) < 35.0)].all()
    a, b = points[allowed][:3000], points[allowed][3000:6000]
    n = min(len(a), len(b))
    clear = space.legs_clear(a[:n], b[:n])
    t = np.linspace(0.0, 1.0, 200)[:, None, None]
    along = a[:n][clear] + t * (b[:n] - a[:n])[clear]
    assert clear.any()
    assert (along[..., 2] - slope(along[..., 0], along[..., 1])).min() >= 5.0 - 1e-9


def test_a_ridge_between_two_places_is_not_flown_through():
    space = free_space(hill_site(lambda x, y: np.where(np.abs(x - 12.0) < 1.0, 20.0, 0.0)), 5.0)
    a, b = np.array([[2.0, -25.0, 12.0], [2.0, -25.0, 26.0]]), np.array([[22.0, -25.0, 12.0], [22.0, -25.0, 26.0]])
    assert space.is_allowed(np.concatenate([a, b])).all()
    assert space.legs_clear(a, b).tolist() == [False, True]


def test_what_is_not_known_is_never_clear():
    space = free_space(hill_site(lambda x, y: np.where((np.abs(x - 12.0) < 3.0) & (y < -20.0), np.nan, 0.0)), 5.0)
    points = np.array([[12.0, -25.0, 30.0], [2.0, -25.0, 30.0], [22.0, -25.0, 30.0]])
    assert space.is_allowed(points).tolist() == [False, True, True]
    assert space.legs_clear(points[[1]], points[[2]]).tolist() == [False]


def test_home_where_nothing_is_known_cannot_be_used():
    site = kiosk(terrain=terrain(lambda x, y: np.where((np.abs(x) < 5.0) & (y < -25.0), np.nan, 0.0 * x)))
    with pytest.raises(InfeasibleError, match=r"home .* stands where the terrain has no heights"):
        free_space(site, 5.0)


def test_sideways_flight_begins_the_lowest_height_above_the_terrain_at_home():
    assert free_space(hill_site(), 5.0).column_top_enu_m[2] == pytest.approx(5.0, abs=0.01)
    high = free_space(hill_site(accuracy_m=4.0), 5.0)
    assert high.column_top_enu_m[2] == pytest.approx(9.0, abs=0.01)


def test_what_is_put_on_the_ground_is_put_on_the_terrain():
    site = hill_site().site
    assert height_at(site, 5.0, 10.0) == pytest.approx(4.0, abs=1e-3)
    assert height_at(site, 1000.0, 0.0) == 0.0
    assert height_at(replace(site, terrain=None), 5.0, 10.0) == 0.0


def told(model):
    """What the check of any plan says of the terrain, by code and place."""
    return {(finding.code, finding.place): finding for finding in terrain_in_use(SimpleNamespace(site_model=model))}


def test_a_site_without_terrain_says_that_its_ground_counts_as_level():
    (note,) = terrain_unknown(kiosk())
    assert not list(terrain_unknown(hill_site()))
    assert note.severity is Severity.NOTE
    assert "level at 0 m" in note.message


def test_terrain_that_does_not_fit_home_and_building_is_a_warning_and_that_of_a_slope_is_none():
    fits = {("terrain", "")}
    assert set(told(hill_site(lambda x, y: 0.03 * (y + 30.0)))) == fits
    off = told(kiosk(terrain=terrain(lambda x, y: 66.9 + 0.0 * x)))
    assert set(off) == fits | {("terrain-apart", "home"), ("terrain-apart", "building")}
    assert off["terrain-apart", "home"].severity is Severity.WARNING
    assert off["terrain-apart", "building"].value == pytest.approx(66.9)
    assert set(told(kiosk(terrain=terrain(lambda x, y: 7.0 + 0.0 * x, accuracy_m=9.0)))) == fits
    assert set(told(kiosk(terrain=terrain(lambda x, y: 0.1 * y - 0.6), home_enu_m=(0.0, 4.0, 9.0)))) == fits
    assert set(told(kiosk(terrain=terrain(lambda x, y: 66.9 + 0.0 * x, use="off")))) == fits
