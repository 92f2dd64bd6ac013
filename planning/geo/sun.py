"""Where the sun stands over a place, and when it stands within a region of the sky.

Position: the low-accuracy series of J. Meeus, "Astronomical Algorithms", 2nd ed., chapters 12, 13, 22 and 25, within
0.015 degrees of the Solar Position Algorithm between 1990 and 2070. The sun moves so far in 4 s. Left out: parallax
(0.0024 degrees), and the minute between universal and terrestrial time (0.0008 degrees).

Refraction lifts what is seen of the sun by 0.5 degrees at the horizon and by 0.1 at 10 degrees. `sun_place_deg` leaves
it out; a `SunTrack` has it, because pictures show the sun where it appears.

A region of the sky is what lies on one side of some planes through the eye: a picture, a pane, a cone around a line of
sight. Over the ground the sun never moves faster than `MOST_RAD_S`. So a sun that is an angle away from a region cannot
be there before that angle has passed, and a search may leap so far (conservative advancement, as in B. Mirtich,
"Impulse-based dynamic simulation", 1996). What it misses is shorter than its shortest leap, whatever the region.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.jit import inline, kernel
from planning.geo.frames import wrap_heading_deg

Array = NDArray[np.float64]
Spans = NDArray[np.float64]
"""Spans of time in order, shape (k, 2): first and last second of each."""

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)

DAY_S = 86_400.0
DAYS_PER_CENTURY = 36_525.0

RADIUS_RAD = math.radians(16.0 / 60.0)
"""Of the sun's disc; over the year it differs from that by 0.3 minutes of arc."""

RISE_DEG = -50.0 / 60.0
"""Elevation of the disc's middle, without refraction, at which its upper edge is on a level horizon (almanacs)."""

MOST_RAD_S = math.radians(363.0) / DAY_S
"""Of the hour angle, which grows by 360.09 degrees a day at most, and what refraction adds: 0.7 % below the horizon,
where it fades; above, it slows."""

TABLE_S = 30.0
"""Between the places that searches know; a straight line between two is off by 0.0001 degrees at most."""

LEAST_S, END_S = 10.0, 0.5
"""Shortest leap of a search, and how well the ends of spans are found, seconds."""


def sun_place_deg(lat_deg: float, lon_deg: float, at: datetime) -> tuple[float, float]:
    """Heading of the sun, clockwise from north in (-180, 180], and its elevation, degrees, without refraction.

    In the zenith the heading is a matter of rounding.

    Parameters
    ----------
    at
        With its time zone.

    Raises
    ------
    ValueError
        The time has no time zone.
    """
    east, north, up = sun_directions_enu(lat_deg, lon_deg, at, 0.0, is_refracted=False)
    heading_deg = wrap_heading_deg(math.degrees(math.atan2(east, north)))
    return heading_deg, math.degrees(math.atan2(up, math.hypot(east, north)))


def sun_directions_enu(
    lat_deg: float, lon_deg: float, start: datetime, seconds: ArrayLike, is_refracted: bool = True
) -> Array:
    """Unit vectors towards the sun, local ENU.

    Parameters
    ----------
    start
        With its time zone.
    seconds
        After it, shape (...).
    is_refracted
        Where it appears, or where it is.

    Returns
    -------
    directions_enu
        Shape (..., 3).

    Raises
    ------
    ValueError
        The time has no time zone.
    """
    if start.tzinfo is None:
        raise ValueError(f"at: expected a time with its time zone, got {start.isoformat()}")
    # A whole number of microseconds: what is added to it keeps its digits.
    days = (start - J2000) / timedelta(days=1) + np.asarray(seconds, np.float64) / DAY_S
    right_ascension, declination = _equatorial_rad(days / DAYS_PER_CENTURY)
    sidereal = np.radians(np.remainder(280.46061837 + 360.98564736629 * days + lon_deg, 360.0))
    hour_angle, lat = sidereal - right_ascension, math.radians(lat_deg)
    cos_d, sin_d, cos_h = np.cos(declination), np.sin(declination), np.cos(hour_angle)
    east = -cos_d * np.sin(hour_angle)
    north = sin_d * math.cos(lat) - cos_d * math.sin(lat) * cos_h
    up = sin_d * math.sin(lat) + cos_d * math.cos(lat) * cos_h
    found = np.stack([east, north, up], axis=-1)
    return lifted(found) if is_refracted else found


def _equatorial_rad(t: Array) -> tuple[Array, Array]:
    """Apparent right ascension and declination, `t` Julian centuries after J2000; the book's letters."""
    m = np.radians(357.52911 + 35_999.05029 * t - 0.0001537 * t * t)
    c = (
        (1.914602 - 0.004817 * t - 0.000014 * t * t) * np.sin(m)
        + (0.019993 - 0.000101 * t) * np.sin(2.0 * m)
        + 0.000289 * np.sin(3.0 * m)
    )
    omega = np.radians(125.04 - 1934.136 * t)
    longitude = 280.46646 + 36_000.76983 * t + 0.0003032 * t * t + c - 0.00569 - 0.00478 * np.sin(omega)
    lam, epsilon = np.radians(longitude), np.radians(23.439291 - 0.0130042 * t + 0.00256 * np.cos(omega))
    right_ascension = np.arctan2(np.cos(epsilon) * np.sin(lam), np.cos(lam))
    return right_ascension, np.arcsin(np.sin(epsilon) * np.sin(lam))


def refraction_rad(elevation_rad: ArrayLike) -> Array:
    """How far air at 1010 hPa and 10 degrees Celsius lifts what stands at an elevation, shape as given, radians.

    G. Saemundsson (1986), Meeus Eq. 16.4, within 0.1 minutes of arc of tables. Below -1 degree, where nothing is seen,
    it fades evenly to the nadir, so that nothing jumps.
    """
    true = np.degrees(np.asarray(elevation_rad, np.float64))
    h = np.maximum(true, -1.0)
    minutes = 1.02 / np.tan(np.radians(h + 10.3 / (h + 5.11)))
    fading = np.clip((90.0 + true) / 89.0, 0.0, 1.0)
    return np.asarray(np.radians(fading * np.maximum(minutes, 0.0) / 60.0))


def lifted(directions_enu: Array) -> Array:
    """Unit directions, shape (..., 3), as refraction shows them."""
    flat, up = np.hypot(directions_enu[..., 0], directions_enu[..., 1]), directions_enu[..., 2]
    lift = refraction_rad(np.arctan2(up, flat))
    cos_l, sin_l = np.cos(lift), np.sin(lift)
    # In the zenith nothing is lifted, and nothing is divided by.
    wider = np.where(flat > 0.0, (flat * cos_l - up * sin_l) / np.where(flat > 0.0, flat, 1.0), 1.0)
    return np.stack([directions_enu[..., 0] * wider, directions_enu[..., 1] * wider, up * cos_l + flat * sin_l], -1)


@dataclass(frozen=True, slots=True, eq=False)
class SunTrack:
    """The sun over a place during a span of time. Seconds count from `start`.

    Parameters
    ----------
    start
        With the time zone that people there use.
    length_s
        A day; of 23 or 25 hours where clocks change.
    table_enu
        Where the sun appears every `TABLE_S`, shape (k, 3); it begins one step early and ends late.
    up
        While its upper edge is above a level horizon; empty in polar night.
    """

    lat_deg: float
    lon_deg: float
    start: datetime
    length_s: float
    table_enu: Array
    up: Spans

    def directions_enu(self, seconds: ArrayLike) -> Array:
        """Where the sun appears, shape (..., 3)."""
        return sun_directions_enu(self.lat_deg, self.lon_deg, self.start, seconds)

    def time(self, seconds: float) -> datetime:
        """The time of a second, in the zone of `start`."""
        return (self.start.astimezone(UTC) + timedelta(seconds=seconds)).astimezone(self.start.tzinfo)

    def seconds(self, at: datetime) -> float:
        """Seconds from `start` to a time; both have a zone."""
        return (at.astimezone(UTC) - self.start.astimezone(UTC)).total_seconds()

    def highest(self) -> tuple[float, float]:
        """When the sun stands highest, and its elevation there as it appears, seconds and degrees."""
        within = self.table_enu[1:-1, 2]
        middle = int(within.argmax())
        low, high = max(0.0, (middle - 1) * TABLE_S), min(self.length_s, (middle + 1) * TABLE_S)
        times = np.linspace(low, high, 121)
        up = np.clip(self.directions_enu(times)[:, 2], -1.0, 1.0)
        best = int(up.argmax())
        return float(times[best]), math.degrees(math.asin(up[best]))


def sun_track(lat_deg: float, lon_deg: float, start: datetime, stop: datetime, least_s: float = LEAST_S) -> SunTrack:
    """The sun over a place from one time to another.

    Raises
    ------
    ValueError
        A time has no zone, or they are not in order.
    """
    if stop.tzinfo is None or not stop.astimezone(UTC) > start.astimezone(UTC):
        raise ValueError(f"stop: expected a later time than {start.isoformat()}, got {stop.isoformat()}")
    length_s = (stop.astimezone(UTC) - start.astimezone(UTC)).total_seconds()
    times = np.arange(-1, math.ceil(length_s / TABLE_S) + 2) * TABLE_S
    # Rise and set are defined without refraction.
    plain = sun_directions_enu(lat_deg, lon_deg, start, times, is_refracted=False)
    whole, zenith = np.array([[0.0, length_s]]), np.array([[[0.0, 0.0, 1.0]]])
    (up,) = _spans_within(plain, zenith, np.array([math.radians(RISE_DEG)]), whole, least_s)
    return SunTrack(lat_deg, lon_deg, start, length_s, lifted(plain), up)


def spans_within(
    track: SunTrack, planes: Array, least_rad: ArrayLike, during: Spans | None = None, least_s: float = LEAST_S
) -> list[Spans]:
    """When the middle of the sun stands within regions of the sky.

    Parameters
    ----------
    planes
        Unit vectors, shape (n, j, 3): a region is where all j of them are at `90 degrees - least_rad` to the sun, or
        less.
    least_rad
        Shape (n,) or one for all: 0 for half a sky, below for a margin around it, above for a cone about each.
    during
        Spans to search; the whole track where None.
    least_s
        Stays in a region, and ways out of it, of this length are found for certain; shorter ones may be missed.

    Returns
    -------
    spans
        n arrays of shape (k, 2), whose ends are good to `END_S`.
    """
    whole = np.array([[0.0, track.length_s]]) if during is None else during
    # A kernel is compiled anew for arrays that may not be written to.
    least = np.array(np.broadcast_to(np.asarray(least_rad, np.float64), (len(planes),)))
    return _spans_within(track.table_enu, np.ascontiguousarray(planes), least, whole, least_s)


def _spans_within(table: Array, planes: Array, least: Array, during: Spans, least_s: float) -> list[Spans]:
    room = 64 + 4 * len(planes)
    while True:
        which, found = np.empty(room, np.int64), np.empty((room, 2))
        n = _trace_all(table, planes, least, during, least_s, which, found)
        if n <= room:
            break
        room = n
    return [found[:n][which[:n] == region] for region in range(len(planes))] if n else [NO_SPANS] * len(planes)


@inline
def _margin(table: Array, planes: Array, least: float, t: float) -> float:
    """How far the sun is within a region, an angle; negative outside. Never more than it would have to move."""
    place = t / TABLE_S + 1.0
    before = min(max(int(place), 0), len(table) - 2)
    share = place - before
    x = table[before, 0] + share * (table[before + 1, 0] - table[before, 0])
    y = table[before, 1] + share * (table[before + 1, 1] - table[before, 1])
    z = table[before, 2] + share * (table[before + 1, 2] - table[before, 2])
    lowest = 1.0
    for k in range(len(planes)):
        lowest = min(lowest, planes[k, 0] * x + planes[k, 1] * y + planes[k, 2] * z)
    return math.asin(max(lowest, -1.0)) - least


@kernel
def trace_region(
    table: Array, planes: Array, least: float, first_s: float, last_s: float, least_s: float, found: Spans, n: int
) -> int:
    """Append the spans of one region, planes of shape (j, 3), to the first `n` of `found`; returns how many there are.

    What does not fit into `found` is counted only.
    """
    t = first_s
    margin = _margin(table, planes, least, t)
    inside, entered = margin >= 0.0, first_s
    while t < last_s:
        later = min(t + max(abs(margin) / MOST_RAD_S, least_s), last_s)
        next_margin = _margin(table, planes, least, later)
        if (next_margin >= 0.0) != inside:
            low, high = t, later
            while high - low > END_S:
                middle = 0.5 * (low + high)
                if (_margin(table, planes, least, middle) >= 0.0) == inside:
                    low = middle
                else:
                    high = middle
            crossing = 0.5 * (low + high)
            if inside:
                if n < len(found):
                    found[n, 0], found[n, 1] = entered, crossing
                n += 1
            entered, inside = crossing, not inside
        t, margin = later, next_margin
    if inside:
        if n < len(found):
            found[n, 0], found[n, 1] = entered, last_s
        n += 1
    return n


@kernel
def _trace_all(
    table: Array,
    planes: Array,
    least: Array,
    during: Spans,
    least_s: float,
    which: NDArray[np.int64],
    found: Spans,
) -> int:
    n = 0
    for region in range(len(planes)):
        for k in range(len(during)):
            before = n
            n = trace_region(table, planes[region], least[region], during[k, 0], during[k, 1], least_s, found, n)
            which[before : min(n, len(which))] = region
    return n


# Spans of time


NO_SPANS: Spans = np.zeros((0, 2))


def joined_spans(parts: list[Spans], apart_s: float = 0.0) -> Spans:
    """What at least one of several lists covers; spans that are no more than `apart_s` apart become one."""
    spans = np.concatenate([NO_SPANS, *parts])
    if not len(spans):
        return NO_SPANS
    spans = spans[np.argsort(spans[:, 0], kind="stable")]
    reach = np.maximum.accumulate(spans[:, 1])
    first = np.concatenate([[True], spans[1:, 0] > reach[:-1] + apart_s])
    last = np.append(np.flatnonzero(first)[1:] - 1, len(spans) - 1)
    return np.column_stack([spans[first, 0], reach[last]])


def without_spans(whole: Spans, taken: Spans) -> Spans:
    """What is left of some spans without others; both are in order and do not overlap."""
    left = []
    for first, last in whole:
        for start, stop in taken[(taken[:, 1] > first) & (taken[:, 0] < last)]:
            if start > first:
                left.append((first, start))
            first = max(first, stop)
        if first < last:
            left.append((first, last))
    return np.array(left).reshape(-1, 2)


def is_within(spans: Spans, seconds: ArrayLike) -> NDArray[np.bool_]:
    """Whether seconds, shape (...), lie in one of some spans, which are in order and do not overlap."""
    t = np.asarray(seconds, np.float64)
    before = np.searchsorted(spans[:, 0], t, side="right") - 1
    ends = np.append(spans[:, 1], -np.inf)
    return np.asarray(t <= ends[before])


def total_s(spans: Spans) -> float:
    """Length of spans together, seconds."""
    return float((spans[:, 1] - spans[:, 0]).sum())
