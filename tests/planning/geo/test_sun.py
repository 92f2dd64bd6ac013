"""Where the sun stands and when, against pvlib, published examples, closed forms and what everybody knows of it."""

import json
import math
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.sun import (
    END_S,
    MOST_RAD_S,
    RISE_DEG,
    is_within,
    joined_spans,
    lifted,
    refraction_rad,
    spans_within,
    sun_directions_enu,
    sun_place_deg,
    sun_track,
    total_s,
    without_spans,
)

REFERENCE = json.loads(Path(__file__).with_name("sun_reference.json").read_text())


def direction(heading_deg, elevation_deg):
    heading, elevation = math.radians(heading_deg), math.radians(elevation_deg)
    flat = math.cos(elevation)
    return np.array([flat * math.sin(heading), flat * math.cos(heading), math.sin(elevation)])


def track_of(lat_deg, lon_deg, day, hours=24.0, zone=UTC):
    start = datetime.fromisoformat(day).replace(tzinfo=zone)
    return sun_track(lat_deg, lon_deg, start, start + timedelta(hours=hours))


# Position


def test_the_example_of_the_solar_position_algorithm_is_met():
    """I. Reda and A. Andreas, "Solar Position Algorithm", NREL/TP-560-34302, table A5.1: refraction is 0.016 there."""
    at = datetime(2003, 10, 17, 12, 30, 30, tzinfo=timezone(timedelta(hours=-7)))
    heading_deg, elevation_deg = sun_place_deg(39.742476, -105.1786, at)
    assert heading_deg % 360.0 == pytest.approx(194.34024, abs=0.02)
    assert elevation_deg == pytest.approx(90.0 - 50.11162 - 0.016, abs=0.015)
    apparent = sun_directions_enu(39.742476, -105.1786, at, 0.0)
    assert math.degrees(math.asin(apparent[2])) == pytest.approx(90.0 - 50.11162, abs=0.015)


def test_positions_are_those_of_pvlib_within_what_is_stated():
    for lat_deg, lon_deg, second, azimuth_deg, elevation_deg, apparent_deg in REFERENCE["places"]:
        at = datetime.fromtimestamp(second, UTC)
        plain, apparent = (sun_directions_enu(lat_deg, lon_deg, at, 0.0, is_refracted=way) for way in (False, True))
        assert np.linalg.norm(plain - direction(azimuth_deg, elevation_deg)) < math.radians(0.015)
        if elevation_deg > -0.5:
            assert np.linalg.norm(apparent - direction(azimuth_deg, apparent_deg)) < math.radians(0.015)


def test_rise_transit_and_set_are_those_of_pvlib_within_half_a_minute():
    for lat_deg, lon_deg, rise, transit, fall in REFERENCE["days"]:
        # pvlib puts events into the day of its transit in UTC, and whole days beside it where they are of the next.
        start = datetime.fromtimestamp(transit - 86_400.0, UTC)
        track = sun_track(lat_deg, lon_deg, start, start + timedelta(days=2))
        for edges, event in zip(track.up.T, (rise, fall), strict=True):
            apart = np.remainder(edges - (event - start.timestamp()) + 43_200.0, 86_400.0) - 43_200.0
            assert np.abs(apart).min() < 30.0


@given(st.floats(-66.0, 66.0), st.floats(-180.0, 180.0), st.integers(0, 365 * 80))
def test_the_sun_is_highest_when_it_crosses_the_meridian(lat_deg, lon_deg, day):
    noon = datetime(1990, 1, 1, 12, tzinfo=UTC) + timedelta(days=day, hours=-lon_deg / 15.0)
    minutes = np.arange(-40, 41, 2)
    places = sun_directions_enu(lat_deg, lon_deg, noon, 60.0 * minutes, is_refracted=False)
    highest = places[:, 2].argmax()
    # The equation of time is at most 17 minutes.
    assert 10 < highest < 30
    if places[highest, 2] < math.sin(math.radians(85.0)):
        # Half of two minutes are 0.25 degrees of the hour angle; the sun's way north or south shifts it by as much.
        assert abs(places[highest, 0]) < math.radians(0.7)


def test_on_midsummer_it_stands_over_the_tropic_and_does_not_set_within_the_polar_circle():
    solstice = datetime(2026, 6, 21, 8, 24, tzinfo=UTC)
    around = [solstice + timedelta(minutes=10 * m) for m in range(-72, 73)]
    assert max(sun_place_deg(23.436, 114.0, at)[1] for at in around) > 89.0
    assert min(sun_place_deg(68.0, 20.0, at)[1] for at in around) > 0.0
    assert max(sun_place_deg(-68.0, 20.0, at)[1] for at in around) < 0.0


def test_a_time_without_a_zone_is_refused():
    with pytest.raises(ValueError, match="time zone"):
        sun_place_deg(0.0, 0.0, datetime(2026, 1, 1))
    with pytest.raises(ValueError, match="later time"):
        sun_track(0.0, 0.0, datetime(2026, 1, 2, tzinfo=UTC), datetime(2026, 1, 1, tzinfo=UTC))


@given(st.floats(-90.0, 90.0), st.floats(-180.0, 180.0), st.integers(0, 2_500_000_000))
def test_the_sun_never_moves_faster_than_searches_leap(lat_deg, lon_deg, second):
    at = datetime.fromtimestamp(second, UTC)
    for is_refracted in (False, True):
        places = sun_directions_enu(lat_deg, lon_deg, at, np.arange(0.0, 600.0, 60.0), is_refracted)
        np.testing.assert_allclose(np.linalg.norm(places, axis=1), 1.0, atol=1e-12)
        steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        assert steps.max() <= 60.0 * MOST_RAD_S


# Refraction


def test_refraction_is_that_of_tables_and_never_turns_the_order_of_two_suns():
    """Meeus, chapter 16: 34 minutes of arc at the apparent horizon, 28.9 at the true one, 5.4 at a true 10 degrees."""
    assert math.degrees(refraction_rad(0.0)) * 60.0 == pytest.approx(28.9, abs=0.2)
    assert math.degrees(refraction_rad(math.radians(10.0))) * 60.0 == pytest.approx(5.4, abs=0.1)
    elevations = np.radians(np.linspace(-90.0, 90.0, 100_001))
    lifts = refraction_rad(elevations)
    assert np.isfinite(lifts).all()
    assert (lifts >= 0.0).all()
    assert (np.diff(elevations + lifts) > 0.0).all()
    assert (np.diff(lifts[elevations > np.radians(-1.0)]) <= 1e-12).all()


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_a_sun_in_the_zenith_stays_there(up):
    found = lifted(np.array([[0.0, 0.0, up], [1e-300, 0.0, up]]))
    assert np.isfinite(found).all()
    np.testing.assert_allclose(found[:, 2], up, atol=1e-4)


# Days


def test_days_at_the_equinox_are_as_long_as_the_closed_form_says():
    """cos H = (sin h0 - sin lat sin d) / (cos lat cos d), d from the highest sun: 90 - lat + d."""
    for lat_deg in (0.0, 20.0, 45.0, 60.0, -50.0):
        track = track_of(lat_deg, 0.0, "2026-03-20")
        plain = sun_directions_enu(lat_deg, 0.0, track.start, np.linspace(0.0, 86_400.0, 8641), is_refracted=False)
        declination = math.radians(math.degrees(math.asin(plain[:, 2].max())) - 90.0 + abs(lat_deg))
        declination *= math.copysign(1.0, lat_deg)
        lat, low = math.radians(lat_deg), math.radians(RISE_DEG)
        cos_h = (math.sin(low) - math.sin(lat) * math.sin(declination)) / (math.cos(lat) * math.cos(declination))
        expected_s = 2.0 * math.degrees(math.acos(cos_h)) * 240.0
        # Declination changes by 0.4 degrees in a day there: up to 30 s at 60 degrees.
        assert total_s(track.up) == pytest.approx(expected_s, abs=30.0)


def test_polar_night_midnight_sun_and_a_day_of_25_hours():
    assert not len(track_of(78.2, 15.6, "2026-12-21").up)
    summer = track_of(78.2, 15.6, "2026-06-21")
    np.testing.assert_allclose(summer.up, [[0.0, 86_400.0]])
    assert track_of(-90.0, 0.0, "2026-12-21").up.tolist() == [[0.0, 86_400.0]]
    assert total_s(track_of(78.2, 15.6, "2026-06-21", 25.0).up) == 25.0 * 3600.0


def test_a_sun_that_is_up_for_minutes_is_found_however_far_searches_leap():
    """Where and when the highest sun of the day is just above rise: the polar night ends with a day of minutes."""
    found = [total_s(track_of(lat_deg, 0.0, "2026-12-21").up) for lat_deg in np.arange(67.2, 67.45, 0.002)]
    short = [each for each in found if 0.0 < each < 1800.0]
    assert short
    assert min(short) < 900.0
    assert (np.diff(found) <= 2.0 * END_S).all(), "further north it is up for less"


def test_a_zone_in_which_the_day_of_the_sun_spans_midnight_has_two_parts_of_it():
    zone = timezone(timedelta(hours=-10))
    (first, second) = track_of(48.0, 11.0, "2026-06-21", zone=zone).up
    assert first[0] == 0.0
    assert second[1] == 86_400.0
    whole = total_s(track_of(48.0, 11.0, "2026-06-21").up)
    assert total_s(np.array([first, second])) == pytest.approx(whole, abs=60.0)


def test_both_sides_of_the_date_line_see_the_same_sun():
    at = datetime(2026, 3, 1, tzinfo=UTC)
    seconds = np.arange(0.0, 86_400.0, 3600.0)
    east, west = (sun_directions_enu(-17.0, lon_deg, at, seconds) for lon_deg in (180.0, -180.0))
    np.testing.assert_allclose(east, west, atol=1e-9)


def test_at_the_equator_the_equinox_sun_passes_the_zenith():
    track = track_of(0.0, 0.0, "2026-03-20")
    seconds, elevation_deg = track.highest()
    assert elevation_deg == pytest.approx(90.0, abs=0.2)
    heading_deg, _ = sun_place_deg(0.0, 0.0, track.time(seconds))
    assert math.isfinite(heading_deg)
    assert track.seconds(track.time(seconds)) == pytest.approx(seconds, abs=1e-5)


# Regions


@given(
    st.floats(-80.0, 80.0),
    st.integers(0, 364),
    st.lists(st.tuples(st.floats(0.0, 360.0), st.floats(-90.0, 90.0)), min_size=1, max_size=5),
    st.floats(-0.2, 1.4),
)
def test_spans_are_those_of_a_slow_search_of_every_second(lat_deg, day, axes, least):
    start = datetime(2026, 1, 1, tzinfo=UTC) + timedelta(days=day)
    track = sun_track(lat_deg, 10.0, start, start + timedelta(days=1))
    planes = np.array([[direction(*axis) for axis in axes]])
    (found,) = spans_within(track, planes, least, least_s=2.0)
    seconds = np.arange(0.0, 86_400.0, 5.0)
    margins = (np.arcsin(np.clip(track.directions_enu(seconds) @ planes[0].T, -1.0, 1.0)) - least).min(axis=1)
    # Within a second of a border both may be right.
    clear = np.abs(margins) > 2.0 * MOST_RAD_S
    assert (is_within(found, seconds) == (margins >= 0.0))[clear].all()
    assert (found[:, 1] >= found[:, 0]).all()


@given(st.lists(st.tuples(st.integers(0, 30), st.integers(1, 8)), max_size=8))
def test_spans_joined_and_taken_away_are_those_of_sets(parts):
    spans = [np.array([[first, first + length]], float) for first, length in parts]
    found = joined_spans(spans)
    seconds = np.arange(0.25, 40.0, 0.5)
    expected = np.zeros(len(seconds), bool)
    for ((first, last),) in spans:
        expected |= (first <= seconds) & (seconds <= last)
    assert (is_within(found, seconds) == expected).all()
    left = without_spans(np.array([[0.0, 40.0]]), found)
    assert (is_within(left, seconds) == ~expected).all()
    assert total_s(left) + total_s(found) == pytest.approx(40.0)
