"""Coordinates as pilots type them: degrees in every writing, UTM and MGRS, and what is no place."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pyproj import Transformer

from groundstation.services.map.coordinates import BANDS, COLUMN_SETS, ROW_LETTERS, parse_place
from planning.base.errors import InputError


@pytest.mark.parametrize(
    "text",
    [
        "22.3372, 114.2636", "22.3372 114.2636", "22,3372; 114,2636", "22,3372 114,2636", "22,3372, 114,2636",
        "22.3372N 114.2636E", "N22.3372 E114.2636", "114.2636 E 22.3372 N", "22.3372°, 114.2636°",
        "22°20'13.92\"N 114°15'48.96\"E", "22 20 13.92 N 114 15 48.96 E", "n 22° 20.232′, e 114° 15.816′",
    ],
)  # fmt: skip
def test_degrees_in_every_writing(text):
    assert parse_place(text) == pytest.approx((22.3372, 114.2636), abs=1e-9)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("-33.8568,151.2153", (-33.8568, 151.2153)),
        ("S 22 20 14 W 114 15 49", (-22.337222, -114.263611)),
        ("48°51'29.9\" 2°17'40.2\"", (48.858306, 2.2945)),
        # N is a band from 0 to 8 degrees, and what people write for north; S likewise.
        ("50N 218155 2472500", (22.335303, 114.263759)),
        ("18S 323394 4306479", (38.889445, -77.036268)),
        ("33S 500000 6250000", (-33.890365, 15.0)),
        # Published: the square of MGRS that Wikipedia explains, and the Washington Monument by the US National Grid.
        ("4QFJ1234567890", (21.40980, -157.91608)),
        ("4Q FJ 12345 67890", (21.40980, -157.91608)),
        ("18SUJ2348306479", (38.889463, -77.035242)),
        ("32U 691603 5334760", (48.13722, 11.575491)),
        ("32UPU9160334760", (48.13722, 11.575491)),
    ],
)
def test_places_that_are_known(text, place):
    assert parse_place(text) == pytest.approx(place, abs=2e-5)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is no place"), ("somewhere", "is no place"), ("22.3372", "is no place"), ("1,2,3", "is no place"),
        ("22N 114N", "is no place"), ("nan, inf", "is no place"), ("1e5 2", "is no place"), ("N E", "is no place"),
        ("114.2636, 22.3372", "is the longitude written first"), ("95, 100", "expected -90 to 90"),
        ("22, 190", "expected -180 to 180"), ("12 N 34 O", "east in German"), ("22 61 0 N 114 0 0 E", "60 or more"),
        ("22.5 30 N 114 E", "decimals before"), ("61Q 218155 2472500", "zones from 1 to 60"),
        ("50I 218155 2472500", "no band"), ("32U 691603 1234760", "not lie in band U"),
        ("32U 99999 5334760", "easting"), ("4QZZ12", "no square ZZ"), ("4QFJ123", "as many digits"),
        ("4QFJ12 345", "as many digits"), ("4QFU1234567890", "no square FU in band Q"),
    ],
)  # fmt: skip
def test_what_is_no_place_is_told_in_plain_words(text, says):
    with pytest.raises(InputError, match=says):
        parse_place(text)


@given(st.text(max_size=40))
def test_any_text_is_a_place_or_refused(text):
    try:
        lat, lon = parse_place(text)
    except InputError:
        return
    assert abs(lat) <= 90.0
    assert abs(lon) <= 180.0


@given(st.floats(-90.0, 90.0), st.floats(-180.0, 180.0))
def test_decimal_degrees_come_back(lat, lon):
    assert parse_place(f"{lat:.7f}, {lon:.7f}") == pytest.approx((lat, lon), abs=6e-8)
    marked = f"{abs(lat):.7f} {'S' if lat < 0 else 'N'} {abs(lon):.7f} {'W' if lon < 0 else 'E'}"
    assert parse_place(marked) == pytest.approx((lat, lon), abs=6e-8)


@given(st.floats(-79.9, 83.9), st.floats(-179.99, 179.99))
def test_utm_and_mgrs_come_back_to_a_metre(lat, lon):
    """Squares are named here by the definition, and read by the program."""
    zone = int((lon + 180.0) // 6.0) + 1
    band = BANDS[min(int((lat + 80.0) // 8.0), 19)]
    # At the edge of a band metres are rounded to the other side.
    assume(abs(lat - 8.0 * round(lat / 8.0)) > 1e-4)
    project = Transformer.from_crs(4326, (32600 if lat >= 0 else 32700) + zone, always_xy=True)
    easting, northing = project.transform(lon, lat)
    metre = 1.1e-5
    near = (
        pytest.approx(lat, abs=metre),
        pytest.approx(lon, abs=metre / max(0.05, math.cos(math.radians(lat)))),
    )
    assert parse_place(f"{zone}{band} {easting:.2f} {northing:.2f}") == near
    column = COLUMN_SETS[(zone - 1) % 3][int(easting // 100_000) - 1]
    row = ROW_LETTERS[(int(northing // 100_000) + (5 if zone % 2 == 0 else 0)) % 20]
    digits = f"{int(easting % 100_000):05d}{int(northing % 100_000):05d}"
    read = parse_place(f"{zone}{band}{column}{row}{digits}")
    assert read == (
        pytest.approx(lat, abs=2 * metre),
        pytest.approx(lon, abs=2 * metre / max(0.05, math.cos(math.radians(lat)))),
    )
