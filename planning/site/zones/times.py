"""When zones apply: times as files write them, and whether a period and a schedule meet the time of a flight.

Whatever can be read in two ways counts in both, and what cannot be read is undecided. Hours that end before they begin
run past midnight; they also count on the morning of the day itself, since publishers mean either.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from datetime import UTC, date, datetime, time, timedelta
from enum import Enum

from planning.geo.sun import sun_place_deg
from planning.site.zones.records import Clock, Daily, Daylight, Period, TimeWindow, Zone

DAY = timedelta(days=1)

DAYS = {name: number for number, name in enumerate(("MON", "TUE", "WED", "THU", "FRI", "SAT", "SUN"))}

ALL_DAYS = frozenset(range(7))

LAST_MINUTE = timedelta(minutes=1)
"""Ends are inclusive: 23:59 is the end of the day."""

DAYLIGHT_MARGIN = timedelta(minutes=10)
"""Added to both ends where they are events of the day: refraction, the height of the horizon, twilight tables."""

SUN_ELEVATION_DEG = {
    Daylight.MORNING_TWILIGHT: -6.0,
    Daylight.SUNRISE: -0.833,
    Daylight.SUNSET: -0.833,
    Daylight.EVENING_TWILIGHT: -6.0,
}
"""Of the sun's centre, refraction and radius included (Astronomical Almanac: civil twilight, rise and set)."""

_CLOCK = re.compile(r"(\d{2}):(\d{2})(?::(\d{2})(?:[.,](\d+))?)?\s*(Z|[+-]\d{2}:?\d{2})?", re.IGNORECASE)


def moment(text: str) -> datetime | None:
    """A date and time with its time zone; None where it is none, or has no time zone. 24:00 is the next day's 0:00."""
    written = text.strip()
    is_next_day = re.search(r"[T ]24:00(:00(\.0+)?)?", written, re.IGNORECASE)
    if is_next_day:
        written = written[: is_next_day.start() + 1] + "00" + written[is_next_day.start() + 3 :]
    try:
        found = datetime.fromisoformat(written)
        if found.tzinfo is None:
            return None
        # Comparing moments of the first and the last year overflows.
        found = found.astimezone(UTC) + (DAY if is_next_day else timedelta())
    except (ValueError, OverflowError):
        return None
    return found if 2 < found.year < 9998 else None


def clock(text: str) -> Clock | None:
    """A time of day with its time zone, `17:00Z` or `17:00:00.00+02:00`; None where it is none or has none."""
    found = _CLOCK.fullmatch(text.strip())
    if found is None or found[5] is None:
        return None
    hours, minutes, seconds = int(found[1]), int(found[2]), int(found[3] or 0)
    if hours > 24 or minutes > 59 or seconds > 60 or (hours == 24 and (minutes or seconds)):
        return None
    ahead = timedelta()
    if found[5].upper() != "Z":
        away = timedelta(hours=int(found[5][1:3]), minutes=int(found[5][-2:]))
        if away > timedelta(hours=18):
            return None
        ahead = -away if found[5][0] == "-" else away
    return Clock(timedelta(hours=hours, minutes=minutes, seconds=seconds), ahead)


def week_days(names: Collection[object]) -> frozenset[int] | None:
    """Days of the week from `MON` to `SUN` or `ANY`; None where one is not known, or there is none."""
    words = [str(name).strip().upper() for name in names]
    if "ANY" in words:
        return ALL_DAYS
    if not words or not all(word in DAYS for word in words):
        return None
    return frozenset(DAYS[word] for word in words)


class State(Enum):
    """Whether a zone applies."""

    APPLIES = "applies"
    NOT_THEN = "not then"
    UNDECIDED = "undecided"

    @property
    def counts(self) -> bool:
        """Whether flights keep to it."""
        return self is not State.NOT_THEN


def state_of(zone: Zone, window: TimeWindow | None, lat_deg: float, lon_deg: float) -> State:
    """Whether a zone applies at any moment of a window at a place.

    Parameters
    ----------
    window
        None where no time is planned: what applies at some time only is undecided then.
    lat_deg, lon_deg
        Of the place, for events of the day.
    """
    if zone.periods is None:
        return State.UNDECIDED
    states = {_period_state(period, window, lat_deg, lon_deg) for period in zone.periods}
    return next((state for state in (State.APPLIES, State.UNDECIDED) if state in states), State.NOT_THEN)


def _period_state(period: Period, window: TimeWindow | None, lat_deg: float, lon_deg: float) -> State:
    if period == Period():
        return State.APPLIES
    if window is None:
        return State.UNDECIDED
    start = window.start if period.start is None else max(window.start, period.start)
    end = window.end if period.end is None else min(window.end, period.end + LAST_MINUTE)
    if start > end:
        return State.NOT_THEN
    if not period.schedule:
        return State.APPLIES
    states = {_daily_state(daily, start, end, lat_deg, lon_deg) for daily in period.schedule}
    return next((state for state in (State.APPLIES, State.UNDECIDED) if state in states), State.NOT_THEN)


def _daily_state(daily: Daily, start: datetime, end: datetime, lat_deg: float, lon_deg: float) -> State:
    state = State.NOT_THEN
    # Clocks are up to 18 hours from UTC, and hours past midnight belong to the day before.
    day = (start - 3 * DAY).date()
    while day <= (end + 2 * DAY).date():
        if day.weekday() in daily.days:
            hours = list(_hours(daily, day, lat_deg, lon_deg))
            if not hours and start - 2 * DAY <= _noon(day, lon_deg) <= end + 2 * DAY:
                state = State.UNDECIDED
            if any(a <= end and start <= b for a, b in hours):
                return State.APPLIES
        day += DAY
    return state


def _hours(daily: Daily, day: date, lat_deg: float, lon_deg: float) -> Iterator[tuple[datetime, datetime]]:
    """Hours of a schedule that begin or end on a day; none where the sun neither rises nor sets then."""
    start, end = (_moment_of(each, day, lat_deg, lon_deg) for each in (daily.start, daily.end))
    next_end = _moment_of(daily.end, day + DAY, lat_deg, lon_deg)
    if start is None or end is None or next_end is None:
        return
    if isinstance(daily.start, Daylight):
        start -= DAYLIGHT_MARGIN
    late = DAYLIGHT_MARGIN if isinstance(daily.end, Daylight) else LAST_MINUTE
    if end > start:
        yield start, end + late
    else:
        yield start, next_end + late
        if end != start:
            yield (
                _noon(day, lon_deg) - DAY / 2 if isinstance(daily.start, Daylight) else _midnight(daily.start, day),
                end + late,
            )


def _midnight(at: Clock, day: date) -> datetime:
    return datetime.combine(day, time(), UTC) - at.ahead_of_utc


def _moment_of(at: Clock | Daylight, day: date, lat_deg: float, lon_deg: float) -> datetime | None:
    if isinstance(at, Clock):
        return _midnight(at, day) + at.since_midnight
    return daylight_event(at, day, lat_deg, lon_deg)


def _noon(day: date, lon_deg: float) -> datetime:
    """Mean solar noon of the place."""
    return datetime.combine(day, time(12), UTC) - timedelta(hours=lon_deg / 15.0)


def daylight_event(event: Daylight, day: date, lat_deg: float, lon_deg: float) -> datetime | None:
    """When an event of the day happens at a place, to some seconds of `sun_place_deg`; None where it does not.

    Between mean solar noon and midnight the sun sinks all the time, but for minutes about the two, so halving the
    interval finds the moment.
    """
    noon, limit_deg = _noon(day, lon_deg), SUN_ELEVATION_DEG[event]
    is_morning = event in (Daylight.MORNING_TWILIGHT, Daylight.SUNRISE)
    dark, light = (noon - DAY / 2 if is_morning else noon + DAY / 2), noon

    def elevation_deg(at: datetime) -> float:
        return sun_place_deg(lat_deg, lon_deg, at)[1]

    if not elevation_deg(dark) < limit_deg < elevation_deg(light):
        return None
    while abs(light - dark) > timedelta(seconds=5):
        middle = dark + (light - dark) / 2
        if elevation_deg(middle) < limit_deg:
            dark = middle
        else:
            light = middle
    return light
