"""Units on screen: exact factors, values that come back, numbers that read well."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.units import (
    UnitSystem,
    area_unit,
    distance_unit,
    length_unit,
    minutes_text,
    per_cent,
    sampling_unit,
    speed_unit,
)

UNITS = [
    unit(system) for unit in (length_unit, distance_unit, speed_unit, sampling_unit, area_unit) for system in UnitSystem
]


@given(st.sampled_from(UNITS), st.floats(-1e6, 1e6))
def test_a_value_comes_back_from_any_unit(unit, value):
    assert unit.metric(unit.shown(value)) == pytest.approx(value, rel=1e-14, abs=1e-300)


def test_published_conversions_hold():
    """BIPM and NIST: 1 ft = 0.3048 m, 1 mi = 1609.344 m; NIST SP 811: 1 mi/h = 0.44704 m/s."""
    imperial = UnitSystem.IMPERIAL
    assert length_unit(imperial).text(0.3048 * 12.5) == "12.5 ft"
    assert distance_unit(imperial).text(1609.344) == "1.00 mi"
    assert speed_unit(imperial).text(0.44704 * 20.0) == "20.0 mph"
    assert sampling_unit(imperial).text(0.0254) == "1.000 in"
    assert area_unit(imperial).text(0.3048**2 * 7) == "7 ft²"


def test_a_value_that_rounds_to_nothing_has_no_sign():
    assert length_unit(UnitSystem.METRIC).text(-0.01) == "0.0 m"
    assert length_unit(UnitSystem.METRIC).text(-0.06) == "-0.1 m"


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0, "0:00"), (59.4, "0:59"), (59.6, "1:00"), (725, "12:05"), (3599.7, "1:00:00"), (3725, "1:02:05")],
)
def test_durations_read_as_minutes(seconds, text):
    assert minutes_text(seconds) == text


@given(st.integers(1, 10**7), st.data())
def test_a_hundred_per_cent_is_said_only_of_all(whole, data):
    part = data.draw(st.integers(0, whole))
    shown = per_cent(part, whole)
    assert (shown == 100.0) == (part == whole)
    # Never above the share, and less than one step below it.
    assert -1e-6 <= 100.0 * part / whole - shown < 0.1 + 1e-6


def test_shares_that_are_whole_steps_lose_nothing_to_binary_fractions():
    assert [per_cent(n, 1000) for n in range(1001)] == pytest.approx([n / 10.0 for n in range(1001)], abs=1e-12)
    assert per_cent(9288, 9292) == 99.9
    assert per_cent(2, 3, 2) == 66.66
    assert per_cent(0, 0) == 0.0
