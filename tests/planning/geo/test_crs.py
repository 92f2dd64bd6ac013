"""Coordinate reference systems: names, axis order, datum shifts and heights, against published positions."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.geo.crs import CrsConversion, crs_conversion, parse_crs
from planning.geo.enu import enu_from_geodetic
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m

INGOLSTADT_UTM32 = (678052.0, 5403685.0, 415.0)


def convert(name: str, point: tuple[float, float, float], **wishes: str) -> tuple[float, float, float, CrsConversion]:
    conversion = crs_conversion(name, np.array([point]), **wishes)  # type: ignore[arg-type]
    place = conversion.geodetic(np.array([point]))
    return float(place.lat_deg[0]), float(place.lon_deg[0]), float(place.ellipsoid_height_m[0]), conversion


def metres_apart(lat_deg: float, lon_deg: float, other_lat_deg: float, other_lon_deg: float) -> float:
    enu = enu_from_geodetic(Origin(lat_deg, lon_deg, 0.0), other_lat_deg, other_lon_deg, 0.0)
    return float(np.linalg.norm(enu[0, :2]))


def degrees(text: str) -> float:
    """Decimal degrees of "52 39 28.723 N"."""
    whole, minutes, seconds, side = text.split()
    return (float(whole) + float(minutes) / 60.0 + float(seconds) / 3600.0) * (-1.0 if side in "SW" else 1.0)


@pytest.mark.parametrize(
    ("name", "meaning"),
    [
        ("EPSG:25832", "ETRS89 / UTM zone 32N"),
        (" epsg:25832 ", "ETRS89 / UTM zone 32N"),
        ("25832", "ETRS89 / UTM zone 32N"),
        ("urn:ogc:def:crs:EPSG::25832", "ETRS89 / UTM zone 32N"),
        ("urn:ogc:def:crs:EPSG:6.12:25832", "ETRS89 / UTM zone 32N"),
        ("https://www.opengis.net/def/crs/EPSG/0/7415", "Amersfoort / RD New + NAP height"),
        ("http://www.opengis.net/def/crs/EPSG/9.9.1/7415", "Amersfoort / RD New + NAP height"),
        ("urn:ogc:def:crs:EPSG::7415", "Amersfoort / RD New + NAP height"),
        ("urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837", "ETRS89 / UTM zone 32N + DHHN2016 height"),
        ("urn:ogc:def:crs,crs:EPSG:6.12:25832,crs:EPSG:6.12:5783", "ETRS89 / UTM zone 32N + DHHN92 height"),
        ("urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", "ETRS89 / UTM zone 32N + DHHN2016 height"),
        ("urn:adv:crs:ETRS89_UTM33", "ETRS89 / UTM zone 33N"),
        ("urn:adv:crs:DE_DHDN_3GK4*DE_DHHN92_NH", "DHDN / 3-degree Gauss-Kruger zone 4 + DHHN92 height"),
        ("EPSG:25832+7837", "ETRS89 / UTM zone 32N + DHHN2016 height"),
        ("http://www.opengis.net/gml/srs/epsg.xml#4326", "WGS 84"),
        (
            "http://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/25832"
            "&2=http://www.opengis.net/def/crs/EPSG/0/7837",
            "ETRS89 / UTM zone 32N + DHHN2016 height",
        ),
    ],
)
def test_names_are_understood_in_every_form(name: str, meaning: str) -> None:
    assert parse_crs(name).name == meaning


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("", "not a coordinate reference system"),
        ("Gauss-Boaga-ish", "not a coordinate reference system"),
        ("EPSG:999999", "'EPSG:999999' is not a coordinate reference system"),
        ("EPSG:4978", "Geocentric CRS"),
        ("EPSG:5773", "Vertical CRS"),
        ("urn:adv:crs:DE_42-83_3GK9", "not a coordinate reference system"),
    ],
)
def test_names_that_say_nothing_are_refused_with_an_example(name: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)) as error:
        parse_crs(name)
    assert "expected" in str(error.value)


def test_ordnance_survey_worked_example(shared_data: Path) -> None:
    lines = (shared_data / "geodesy" / "osgb_os_guide.csv").read_text().splitlines()
    row = next(csv.reader([lines[-1]]))
    lat, lon, _, conversion = convert("EPSG:27700", (float(row[2]), float(row[3]), 0.0))
    # The guide's own ETRS89 position by the same seven parameters, printed to 0.001 seconds (3 cm).
    assert metres_apart(lat, lon, degrees(row[4]), degrees(row[5])) < 0.04
    assert conversion.accuracy_m == pytest.approx(2.0)
    assert any("uk_os_OSTN15" in note for note in conversion.notes)


def test_swiss_example_agrees_to_centimetres_and_its_height_shows_what_egm96_costs_in_the_alps() -> None:
    # swisstopo, "Formulas and constants ...": LV95 2700000 / 1100000 / 600 m is 46 2 38.87 N, 8 43 49.79 E, 650.60 m.
    lat, lon, height, conversion = convert("EPSG:2056+5728", (2_700_000.0, 1_100_000.0, 600.0))
    assert metres_apart(lat, lon, degrees("46 2 38.87 N"), degrees("8 43 49.79 E")) < 0.3
    assert 1.5 < 650.60 - height < 2.5
    assert any("in mountains by 2 m" in note for note in conversion.notes)


def test_dutch_example_agrees_within_the_accuracy_of_the_helmert_shift() -> None:
    # Westertoren, Amsterdam, in Rijksdriehoek and ETRS89 (Kadaster); without the correction grid up to 0.25 m remain.
    lat, lon, _, conversion = convert("EPSG:28992", (120_700.723, 487_525.501, 0.0))
    assert 0.05 < metres_apart(lat, lon, 52.37453253, 4.88352559) < 0.5
    assert conversion.accuracy_m == pytest.approx(1.0)


def test_geographiclibs_polar_stereographic_vector(shared_data: Path) -> None:
    rows = csv.DictReader((shared_data / "geodesy" / "geographiclib_cli_vectors.csv").read_text().splitlines())
    row = next(row for row in rows if row["name"] == "GeoConvert8")
    assert "86 0" in row["args"]
    assert "1555731" in row["expected_regex"]
    lat, lon, _, _ = convert("EPSG:32661", (2_000_000.0, 1_555_731.570643, 0.0))
    assert lat == pytest.approx(86.0, abs=1e-10)
    assert lon == pytest.approx(0.0, abs=1e-10)


def test_prime_example_of_gie_inverse_transverse_mercator_over_the_whole_country(shared_data: Path) -> None:
    # British National Grid's projection on WGS 84 (so without any datum shift), points of Finland's JHS test 5101.
    text = (shared_data / "geodesy" / "proj_gie" / "5101.1-jhs.gie").read_text()
    pairs = re.findall(r"accept\s+(\S+)\s+(\S+)\s+expect\s+(\S+)\s+(\S+)", text)
    name = "+proj=tmerc +lat_0=49 +lon_0=-2 +k_0=0.9996012717 +x_0=400000 +y_0=-100000 +datum=WGS84 +units=m +type=crs"
    inside = [tuple(float(v) for v in pair) for pair in pairs if 49.0 <= float(pair[1]) <= 80.0]
    assert len(inside) >= 5
    for lon, lat, east, north in inside:
        found_lat, found_lon, _, _ = convert(name, (east, north, 0.0), axis_order="xy", height_reference="ellipsoid")
        assert metres_apart(lat, lon, found_lat, found_lon) < 0.03


@pytest.mark.parametrize(
    ("name", "point", "lat_lon", "note"),
    [
        # Listed north first, written east first, and the other way round: the area of use tells.
        ("EPSG:31467", (3_478_052.0, 5_403_685.0, 0.0), (48.770, 8.700), "read as (east, north)"),
        ("EPSG:31467", (5_403_685.0, 3_478_052.0, 0.0), (48.770, 8.700), None),
        ("urn:ogc:def:crs:EPSG::31467", (3_478_052.0, 5_403_685.0, 0.0), (48.770, 8.700), "read as (east, north)"),
        ("EPSG:25832", (5_403_685.0, 678_052.0, 0.0), (48.761, 11.423), "read as (north, east)"),
        ("EPSG:6697", (35.6, 139.7, 0.0), (35.6, 139.7), None),
        ("EPSG:6697", (139.7, 35.6, 0.0), (35.6, 139.7), "read as (east, north)"),
        # Both possible: a URN means what the authority lists, the old short form longitude first.
        ("urn:ogc:def:crs:EPSG::4326", (48.7, 11.4, 0.0), (48.7, 11.4), None),
        ("http://www.opengis.net/def/crs/EPSG/0/4979", (48.7, 11.4, 0.0), (48.7, 11.4), None),
        ("EPSG:4326", (11.4, 48.7, 0.0), (48.7, 11.4), "read as (east, north)"),
        ("OGC:CRS84h", (11.4, 48.7, 0.0), (48.7, 11.4), None),
        ("urn:ogc:def:crs:EPSG::4979", (-95.0, 40.0, 0.0), (40.0, -95.0), "read as (east, north)"),
        # German data east of 12 degrees is kept in zone 32 all the same.
        ("EPSG:25832", (890_000.0, 5_690_000.0, 0.0), (51.2, 14.6), None),
    ],
)
def test_axis_order_is_what_the_numbers_allow(
    name: str, point: tuple[float, float, float], lat_lon: tuple[float, float], note: str | None
) -> None:
    lat, lon, _, conversion = convert(name, point)
    assert (lat, lon) == pytest.approx(lat_lon, abs=0.1)
    said = [text for text in conversion.notes if "read as" in text]
    assert said == [] if note is None else note in said[0]


def test_the_user_overrules_the_axis_order() -> None:
    lat, lon, _, conversion = convert("EPSG:4326", (11.4, 48.7, 0.0), axis_order="yx")
    assert (lat, lon) == pytest.approx((11.4, 48.7))
    assert conversion.swaps


@pytest.mark.parametrize("point", [(4.0, 5.0, 6.0), (0.0, 0.0, 0.0), (2_682_000.0, 1_247_000.0, 400.0)])
def test_coordinates_of_another_system_are_refused(point: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match=r"far outside the area of use of EPSG:25832.*--crs"):
        convert("EPSG:25832", point)


def test_a_system_with_only_a_ballpark_shift_is_refused() -> None:
    with pytest.raises(InputError, match="no transformation to WGS 84 of known accuracy"):
        convert("EPSG:2355", (31_500_000.0, 3_500_000.0, 0.0))


@pytest.mark.parametrize(
    ("name", "point"),
    [
        ("EPSG:7415", (85_000.0, 447_480.0, 5.0)),
        ("urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837", INGOLSTADT_UTM32),
        ("EPSG:2056+5728", (2_682_000.0, 1_247_000.0, 420.0)),
        ("EPSG:6697", (35.6, 139.7, 4.0)),
        ("EPSG:4326+5773", (11.4, 48.7, 400.0)),
        ("EPSG:32632", INGOLSTADT_UTM32),
    ],
)
def test_heights_above_sea_level_are_never_passed_through_unchanged(
    name: str, point: tuple[float, float, float]
) -> None:
    lat, lon, height, conversion = convert(name, point)
    assert conversion.is_orthometric
    assert height - point[2] == pytest.approx(float(undulation_m(lat, lon)), abs=1e-6)
    assert abs(height - point[2]) > 30.0
    assert any("EGM96" in note for note in conversion.notes)


def test_ellipsoidal_heights_stay() -> None:
    for name in ("EPSG:4979", "EPSG:4937", "OGC:CRS84h"):
        _, _, height, conversion = convert(name, (11.4, 48.7, 123.25))
        assert height == pytest.approx(123.25, abs=1e-6)
        assert any("as the system says" in note for note in conversion.notes)


def test_the_user_says_what_heights_are_above() -> None:
    _, _, plain, conversion = convert("EPSG:32632", INGOLSTADT_UTM32, height_reference="ellipsoid")
    assert plain == pytest.approx(415.0)
    assert any("as you asked" in note for note in conversion.notes)
    _, _, overruled, _ = convert("EPSG:7415", (85_000.0, 447_480.0, 5.0), height_reference="ellipsoid")
    assert overruled == pytest.approx(5.0)
    lat, lon, lifted, _ = convert("EPSG:4979", (11.4, 48.7, 100.0), height_reference="orthometric")
    assert lifted == pytest.approx(100.0 + float(undulation_m(lat, lon)))


def test_units_and_directions_of_heights_are_kept() -> None:
    feet = 0.3048006096012192
    point = (985_320.0, 219_464.0, 100.0)
    lat, lon, in_feet, _ = convert("EPSG:2263+6360", point)
    assert in_feet - float(undulation_m(lat, lon)) == pytest.approx(100.0 * feet, abs=1e-6)
    _, _, undeclared, conversion = convert("EPSG:2263", point)
    assert undeclared == pytest.approx(in_feet, abs=1e-6)
    assert any("US survey foot" in note for note in conversion.notes)
    lat, lon, depth, _ = convert("EPSG:4326+5715", (35.4, 31.5, 430.0))
    assert depth == pytest.approx(float(undulation_m(lat, lon)) - 430.0, abs=1e-6)


def test_every_vertex_is_converted_so_grid_convergence_and_scale_are_undone() -> None:
    # 3.9 degrees from the central meridian at 75 N: grid north is turned by almost 4 degrees, the scale is 0.99977.
    # On the ellipsoid itself: 35 m above it lengths grow by 5e-6, which would show here.
    conversion = crs_conversion("EPSG:32632", np.array([[612e3, 8330e3, 0.0]]), height_reference="ellipsoid")
    ends = conversion.geodetic(np.array([[612_000.0, 8_330_000.0, 0.0], [612_000.0, 8_330_100.0, 0.0]]))
    origin = Origin(float(ends.lat_deg[0]), float(ends.lon_deg[0]), float(ends.ellipsoid_height_m[0]))
    north = enu_from_geodetic(origin, *ends)[1]
    convergence_deg = (origin.lon_deg - 9.0) * np.sin(np.radians(origin.lat_deg))  # to first order
    assert 3.5 < convergence_deg < 4.0
    assert np.degrees(np.arctan2(north[0], north[1])) == pytest.approx(convergence_deg, abs=0.02)
    scale = 0.9996 * (1.0 + 0.5 * (112_000.0 / 0.9996 / 6_386_000.0) ** 2)  # Snyder 1987, Eq. 8-11, to second order
    assert 100.0 / float(np.linalg.norm(north)) == pytest.approx(scale, abs=1e-6)


def test_a_utm_zone_used_across_the_antimeridian_stays_one_neighbourhood() -> None:
    points = np.array([[413_000.0, 8_330_000.0, 10.0], [415_000.0, 8_330_000.0, 10.0]])
    place = crs_conversion("EPSG:32601", points).geodetic(points)
    assert place.lon_deg[0] > 179.9
    assert place.lon_deg[1] < -179.9
    origin = Origin(float(place.lat_deg[0]), float(place.lon_deg[0]), 0.0)
    enu = enu_from_geodetic(origin, *place)
    assert np.linalg.norm(enu[1] - enu[0]) == pytest.approx(2000.0, rel=5e-4)


def test_points_without_a_position_are_named() -> None:
    conversion = crs_conversion("EPSG:32632", np.array([INGOLSTADT_UTM32]))
    with pytest.raises(InputError, match=r"\(1e\+30, 0.0, 0.0\) has no position in EPSG:32632"):
        conversion.geodetic(np.array([INGOLSTADT_UTM32, (1e30, 0.0, 0.0)]))


def test_no_points_give_no_points() -> None:
    conversion = crs_conversion("EPSG:32632", np.array([INGOLSTADT_UTM32]))
    assert conversion.geodetic(np.zeros((0, 3))).lat_deg.shape == (0,)
