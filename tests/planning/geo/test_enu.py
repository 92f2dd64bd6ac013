"""ENU against the published example, against 50 digits, and there and back again at the places where formulas break."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import hypothesis.strategies as st
import mpmath
import numpy as np
import pytest
from hypothesis import given

from planning.geo.enu import enu_from_geodetic, geodetic_from_enu, wrap_longitude_deg
from planning.geo.frames import Origin

HARD_ORIGINS = [
    Origin(0.0, 180.0, 0.0),
    Origin(75.0, 179.9999, -300.0),
    Origin(-45.0, -180.0, 9000.0),
    Origin(90.0, 0.0, 0.0),
    Origin(-90.0, 12.0, 50.0),
    Origin(89.999999, -45.0, 10_000.0),
    Origin(31.5, 35.4, -430.0),
    Origin(0.0, 1e-7, 0.0),
]


def test_iogp_worked_example_is_met_to_a_millimetre() -> None:
    # IOGP Publication 373-7-2, geographic/topocentric conversion: Lat 53 48 33.82 N, Lon 2 07 46.38 E, h 73 m.
    enu = enu_from_geodetic(Origin(55.0, 5.0, 200.0), 53.80939444444444, 2.12955, 73.0)
    np.testing.assert_allclose(enu, [[-189013.869, -128642.040, -4220.171]], atol=1e-3)


def enu_with_50_digits(origin: Origin, lat_deg: float, lon_deg: float, height_m: float) -> list[float]:
    """Textbook geocentric difference, rotated, in 50 digits."""
    with mpmath.workdps(50):
        semi_major, flattening = mpmath.mpf(6378137), 1 / mpmath.mpf("298.257223563")
        e2 = flattening * (2 - flattening)

        def geocentric(lat: float, lon: float, height: float) -> list[mpmath.mpf]:
            phi, lam, h = mpmath.radians(mpmath.mpf(lat)), mpmath.radians(mpmath.mpf(lon)), mpmath.mpf(height)
            normal = semi_major / mpmath.sqrt(1 - e2 * mpmath.sin(phi) ** 2)
            return [
                (normal + h) * mpmath.cos(phi) * mpmath.cos(lam),
                (normal + h) * mpmath.cos(phi) * mpmath.sin(lam),
                (normal * (1 - e2) + h) * mpmath.sin(phi),
            ]

        here = geocentric(lat_deg, lon_deg, height_m)
        there = geocentric(origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m)
        x, y, z = (a - b for a, b in zip(here, there, strict=True))
        phi, lam = mpmath.radians(mpmath.mpf(origin.lat_deg)), mpmath.radians(mpmath.mpf(origin.lon_deg))
        sp, cp, sl, cl = mpmath.sin(phi), mpmath.cos(phi), mpmath.sin(lam), mpmath.cos(lam)
        enu = [-sl * x + cl * y, -sp * cl * x - sp * sl * y + cp * z, cp * cl * x + cp * sl * y + sp * z]
        return [float(v) for v in enu]


@pytest.mark.parametrize("origin", HARD_ORIGINS)
def test_enu_agrees_with_fifty_digits(origin: Origin) -> None:
    rng = np.random.default_rng(1)
    lat = np.clip(origin.lat_deg + rng.uniform(-0.15, 0.15, 20), -90.0, 90.0)
    lon = origin.lon_deg + rng.uniform(-0.15, 0.15, 20)
    height = origin.ellipsoid_height_m + rng.uniform(-500.0, 2000.0, 20)
    expected = [enu_with_50_digits(origin, *place) for place in zip(lat, lon, height, strict=True)]
    np.testing.assert_allclose(enu_from_geodetic(origin, lat, lon, height), expected, atol=2e-8)


coordinates = st.floats(-20_000.0, 20_000.0)


@given(
    lat=st.one_of(st.floats(-90.0, 90.0), st.sampled_from([-90.0, 90.0, 0.0, 75.0])),
    lon=st.one_of(st.floats(-180.0, 180.0), st.sampled_from([-180.0, 180.0, 179.99999999, 0.0])),
    height=st.floats(-1000.0, 10_000.0),
    point=st.tuples(coordinates, coordinates, coordinates),
)
def test_round_trip_is_good_to_a_tenth_of_a_micrometre(
    lat: float, lon: float, height: float, point: tuple[float, float, float]
) -> None:
    origin = Origin(lat, lon, height)
    place = geodetic_from_enu(origin, [point])
    assert -180.0 <= place.lon_deg[0] < 180.0
    assert -90.0 <= place.lat_deg[0] <= 90.0
    np.testing.assert_allclose(enu_from_geodetic(origin, *place), [point], atol=1e-7)


@pytest.mark.parametrize("origin", HARD_ORIGINS)
def test_the_origin_itself_is_zero_and_comes_back(origin: Origin) -> None:
    enu = enu_from_geodetic(origin, origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m)
    np.testing.assert_allclose(enu, np.zeros((1, 3)), atol=5e-9)
    place = geodetic_from_enu(origin, np.zeros((1, 3)))
    assert place.lat_deg[0] == pytest.approx(origin.lat_deg, abs=1e-12)
    assert place.ellipsoid_height_m[0] == pytest.approx(origin.ellipsoid_height_m, abs=1e-8)


def test_neighbours_across_the_antimeridian_are_neighbours() -> None:
    enu = enu_from_geodetic(Origin(-17.0, 179.9999, 0.0), [-17.0, -17.0], [-179.9999, 180.0001], [0.0, 0.0])
    np.testing.assert_allclose(enu[0], enu[1], atol=1e-7)
    assert 21.0 < enu[0, 0] < 21.5  # 0.0002 degrees of a parallel of 6 102 km radius
    back = geodetic_from_enu(Origin(-17.0, 179.9999, 0.0), [[100.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert back.lon_deg[0] < -179.999 < 179.999 < back.lon_deg[1]


def test_at_the_north_pole_east_is_along_the_meridian_90_degrees_from_the_origins() -> None:
    place = geodetic_from_enu(Origin(90.0, 0.0, 0.0), [[1000.0, 0.0, 0.0], [0.0, 1000.0, 0.0]])
    np.testing.assert_allclose(place.lon_deg, [90.0, -180.0], atol=1e-9)


def test_short_distances_agree_with_geodesics() -> None:
    from pyproj import Geod

    lat, lon = np.array([48.76, 48.7609]), np.array([11.42, 11.4213])
    enu = enu_from_geodetic(Origin(48.76, 11.42, 0.0), lat, lon, np.zeros(2))
    _, _, geodesic_m = Geod(ellps="WGS84").inv(lon[0], lat[0], lon[1], lat[1])
    assert np.linalg.norm(enu[1] - enu[0]) == pytest.approx(geodesic_m, abs=1e-7)  # chord and arc differ by L^3/24R^2


def test_values_broadcast_and_nothing_gives_nothing() -> None:
    origin = Origin(10.0, 20.0, 0.0)
    assert enu_from_geodetic(origin, [10.0, 10.1, 10.2], 20.0, 5.0).shape == (3, 3)
    assert enu_from_geodetic(origin, [], [], []).shape == (0, 3)
    assert geodetic_from_enu(origin, np.zeros((0, 3))).lat_deg.shape == (0,)


def test_wrong_values_are_refused_instead_of_becoming_infinite() -> None:
    origin = Origin(10.0, 20.0, 0.0)
    with pytest.raises(ValueError, match="finite"):
        enu_from_geodetic(origin, np.nan, 0.0, 0.0)
    with pytest.raises(ValueError, match=r"-90 to 90, got 90\.1"):
        enu_from_geodetic(origin, [0.0, 90.1], 0.0, 0.0)
    with pytest.raises(ValueError, match="not finite"):
        geodetic_from_enu(origin, [[0.0, np.inf, 0.0]])
    with pytest.raises(ValueError, match=r"\(n, 3\)"):
        geodetic_from_enu(origin, [0.0, 0.0, 0.0])


def test_threads_share_an_origin_and_get_the_same_numbers() -> None:
    origin = Origin(48.7, 11.4, 400.0)
    points = np.random.default_rng(0).uniform(-1000.0, 1000.0, (2000, 3))
    expected = geodetic_from_enu(origin, points)
    with ThreadPoolExecutor(8) as pool:
        for place in pool.map(lambda _: geodetic_from_enu(origin, points), range(64)):
            assert all(np.array_equal(a, b) for a, b in zip(place, expected, strict=True))


@given(st.floats(-1e6, 1e6))
def test_wrapped_longitudes_are_the_same_meridian(lon_deg: float) -> None:
    wrapped = float(wrap_longitude_deg(lon_deg))
    assert -180.0 <= wrapped < 180.0
    turns = (wrapped - lon_deg) / 360.0
    assert turns == pytest.approx(round(turns), abs=1e-9)


@pytest.mark.parametrize(
    ("lon_deg", "wrapped"), [(180.0, -180.0), (-180.0, -180.0), (-180.00000000000003, -180.0), (540.0, -180.0)]
)
def test_the_antimeridian_itself_is_minus_180(lon_deg: float, wrapped: float) -> None:
    assert float(wrap_longitude_deg(lon_deg)) == wrapped
