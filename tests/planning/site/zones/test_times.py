"""Whether a zone applies at the time of a flight: schedules, nights, events of the day, and what is undecided."""

from datetime import UTC, date, datetime, timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.site.zones.records import Clock, Daily, Daylight, Period, Restriction, TimeWindow, Zone
from planning.site.zones.times import (
    ALL_DAYS,
    State,
    clock,
    daylight_event,
    moment,
    state_of,
    week_days,
)


def zone(*periods):
    return Zone("Z", "Z", Restriction.PROHIBITED, periods=periods)


def at(text, minutes=0):
    start = datetime.fromisoformat(text)
    return TimeWindow(start, start + timedelta(minutes=minutes))


def hours(start, end, days=ALL_DAYS):
    return Period(schedule=(Daily(frozenset(days), clock(start), clock(end)),))


def state(period, window, lat=47.0, lon=8.0):
    return state_of(zone(period), window, lat, lon)


def test_times_are_read_with_their_zone_alone():
    assert moment("2022-06-15T09:00:00.00Z") == datetime(2022, 6, 15, 9, tzinfo=UTC)
    assert moment("2024-12-17T24:00Z") == datetime(2024, 12, 18, tzinfo=UTC)
    assert moment("2024-12-17T10:00+02:00") == datetime(2024, 12, 17, 8, tzinfo=UTC)
    assert moment("2024-12-17T10:00") is None
    assert moment("0001-01-01T00:00:00+14:00") is None
    assert clock("24:00Z") == Clock(timedelta(days=1), timedelta())
    assert clock("12:34:56.78-0130").ahead_of_utc == -timedelta(hours=1, minutes=30)
    assert [clock(text) for text in ("12:34", "25:00Z", "12:61Z", "noon", "12:00+19:00")] == [None] * 5
    assert week_days(["MON", "sun"]) == {0, 6}
    assert week_days(["ANY", "FEST"]) == ALL_DAYS
    assert week_days([]) is None
    assert week_days(["FEST"]) is None


@pytest.mark.parametrize(
    ("window", "wanted"),
    [
        (at("2026-11-28T16:30+00:00", 60), State.APPLIES),
        (at("2026-11-28T15:00+00:00", 60), State.NOT_THEN),
        (at("2026-11-28T23:59+00:00"), State.APPLIES),
        (at("2026-11-29T00:30+00:00"), State.NOT_THEN),
        (at("2026-11-28T18:30+01:00"), State.APPLIES),
        (at("2026-11-26T18:00+00:00"), State.NOT_THEN),
        (None, State.UNDECIDED),
    ],
)
def test_a_weekly_schedule_counts_on_its_days_and_hours(window, wanted):
    assert state(hours("17:00Z", "23:59Z", {5}), window) is wanted


def test_hours_past_midnight_count_into_the_next_day_and_on_the_morning_of_their_own():
    saturday_night = hours("22:00Z", "06:00Z", {5})
    states = {
        text: state(saturday_night, at(text))
        for text in ("2026-11-28T23:00+00:00", "2026-11-29T05:00+00:00", "2026-11-28T05:00+00:00")
    }
    assert set(states.values()) == {State.APPLIES}
    assert state(saturday_night, at("2026-11-28T12:00+00:00")) is State.NOT_THEN
    assert state(saturday_night, at("2026-11-29T12:00+00:00")) is State.NOT_THEN
    assert state(hours("00:00Z", "00:00Z", {5}), at("2026-11-28T12:00+00:00")) is State.APPLIES


@given(
    st.datetimes(datetime(2020, 1, 1), datetime(2030, 1, 1)),
    st.integers(0, 24 * 60 - 1),
    st.integers(0, 24 * 60 - 1),
    st.sets(st.integers(0, 6), min_size=1),
    st.integers(-14, 14),
)
def test_a_schedule_never_misses_a_moment_of_the_plainest_reading(when, start, end, days, ahead):
    offset = timedelta(hours=ahead)
    when = when.replace(tzinfo=UTC)
    daily = Daily(frozenset(days), Clock(timedelta(minutes=start), offset), Clock(timedelta(minutes=end), offset))
    local = when.replace(tzinfo=None) + offset
    minutes = local.hour * 60 + local.minute
    applies = (
        local.weekday() in days and start <= minutes <= end
        if end > start
        else (local.weekday() in days and minutes >= start) or ((local.weekday() - 1) % 7 in days and minutes <= end)
    )
    if applies:
        found = state_of(zone(Period(schedule=(daily,))), TimeWindow(when, when), 0.0, 0.0)
        assert found is State.APPLIES


def test_periods_begin_and_end_and_one_of_several_is_enough():
    summer = Period(datetime(2026, 6, 1, tzinfo=UTC), datetime(2026, 9, 1, tzinfo=UTC))
    assert state(summer, at("2026-05-31T23:50+00:00", 20)) is State.APPLIES
    assert state(summer, at("2026-05-31T23:30+00:00", 20)) is State.NOT_THEN
    assert state(summer, at("2026-09-01T00:02+00:00")) is State.NOT_THEN
    both = zone(summer, hours("10:00Z", "12:00Z"))
    assert state_of(both, at("2026-11-28T11:00+00:00"), 47.0, 8.0) is State.APPLIES
    assert state_of(zone(Period()), None, 47.0, 8.0) is State.APPLIES
    unread = Zone("Z", "Z", Restriction.PROHIBITED, periods=None)
    assert state_of(unread, at("2026-11-28T11:00+00:00"), 47.0, 8.0) is State.UNDECIDED


def test_sunrise_sunset_and_twilight_are_those_of_the_almanac():
    """Greenwich, 2026-06-21: sunrise 3:43, sunset 20:21 UT, civil twilight from 2:55 to 21:09 (USNO tables)."""
    day = date(2026, 6, 21)
    wanted = {"SR": (3, 43), "SS": (20, 21), "BMCT": (2, 55), "EECT": (21, 9)}
    for name, (hour, minute) in wanted.items():
        found = daylight_event(Daylight(name), day, 51.48, 0.0)
        assert abs(found - datetime(2026, 6, 21, hour, minute, tzinfo=UTC)) < timedelta(minutes=3), name


def test_nights_are_from_sunset_to_sunrise_and_undecided_where_the_sun_does_not_set():
    night = Period(schedule=(Daily(ALL_DAYS, Daylight.SUNSET, Daylight.SUNRISE),))
    assert state(night, at("2026-11-28T23:00+00:00")) is State.APPLIES
    assert state(night, at("2026-11-28T12:00+00:00")) is State.NOT_THEN
    assert state(night, at("2026-11-28T15:36+00:00"), 47.0, 8.0) is State.APPLIES
    assert state(night, at("2026-06-21T12:00+00:00"), 78.0, 15.0) is State.UNDECIDED
    assert state(night, at("2026-11-28T12:00+00:00"), 0.0, 179.9) is State.APPLIES
    assert state(night, at("2026-11-28T00:30+00:00"), 0.0, -179.9) is State.NOT_THEN
