"""Where the sun stands, against published examples and what everybody knows of it."""

from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.site.sun import sun_place_deg


def test_the_example_of_the_solar_position_algorithm_is_met():
    """I. Reda and A. Andreas, "Solar Position Algorithm", NREL/TP-560-34302, table A5.1: refraction is 0.016 there."""
    at = datetime(2003, 10, 17, 12, 30, 30, tzinfo=timezone(timedelta(hours=-7)))
    heading_deg, elevation_deg = sun_place_deg(39.742476, -105.1786, at)
    assert heading_deg % 360.0 == pytest.approx(194.34024, abs=0.02)
    assert elevation_deg == pytest.approx(90.0 - 50.11162, abs=0.03)


@given(st.floats(-66.0, 66.0), st.floats(-180.0, 180.0), st.integers(0, 365 * 80))
def test_the_sun_is_highest_when_it_crosses_the_meridian(lat_deg, lon_deg, day):
    noon = datetime(1990, 1, 1, 12, tzinfo=UTC) + timedelta(days=day, hours=-lon_deg / 15.0)
    minutes = range(-40, 41, 2)
    places = np.array([sun_place_deg(lat_deg, lon_deg, noon + timedelta(minutes=m)) for m in minutes])
    highest = places[:, 1].argmax()
    # The equation of time is at most 17 minutes.
    assert 10 < highest < 30
    if places[highest, 1] < 85.0:
        away = np.abs(np.sin(np.radians(places[highest, 0])))
        # Half of two minutes are 0.25 degrees of the hour angle; the sun's way north or south shifts it by as much.
        assert away * np.cos(np.radians(places[highest, 1])) < np.radians(0.7)


def test_on_midsummer_it_stands_over_the_tropic_and_does_not_set_within_the_polar_circle():
    solstice = datetime(2026, 6, 21, 8, 24, tzinfo=UTC)
    around = [solstice + timedelta(minutes=10 * m) for m in range(-72, 73)]
    assert max(sun_place_deg(23.436, 114.0, at)[1] for at in around) > 89.0
    assert min(sun_place_deg(68.0, 20.0, at)[1] for at in around) > 0.0
    assert max(sun_place_deg(-68.0, 20.0, at)[1] for at in around) < 0.0


def test_a_time_without_a_zone_is_refused():
    with pytest.raises(ValueError, match="time zone"):
        sun_place_deg(0.0, 0.0, datetime(2026, 1, 1))
