"""Where the sun stands over a site at a time."""

from __future__ import annotations

import math
from datetime import UTC, datetime

from planning.geo.frames import wrap_heading_deg

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)

DAYS_PER_CENTURY = 36_525.0


def sun_place_deg(lat_deg: float, lon_deg: float, at: datetime) -> tuple[float, float]:
    """Heading of the sun, clockwise from north in (-180, 180], and its elevation above the horizon, degrees.

    The low-accuracy series of J. Meeus, "Astronomical Algorithms", 2nd ed., chapters 12, 13, 22 and 25: 0.01 degrees
    between 1900 and 2100. Refraction is left out: it lifts the sun by 0.5 degrees at the horizon, by 0.1 at 10 degrees.

    Parameters
    ----------
    at
        With its time zone.

    Raises
    ------
    ValueError
        The time has no time zone.
    """
    if at.tzinfo is None:
        raise ValueError(f"at: expected a time with its time zone, got {at.isoformat()}")
    days = (at - J2000).total_seconds() / 86_400.0
    right_ascension, declination = _equatorial_rad(days / DAYS_PER_CENTURY)
    sidereal = math.radians((280.46061837 + 360.98564736629 * days + lon_deg) % 360.0)
    hour_angle, lat = sidereal - right_ascension, math.radians(lat_deg)
    east = -math.cos(declination) * math.sin(hour_angle)
    north = math.sin(declination) * math.cos(lat) - math.cos(declination) * math.sin(lat) * math.cos(hour_angle)
    up = math.sin(declination) * math.sin(lat) + math.cos(declination) * math.cos(lat) * math.cos(hour_angle)
    heading_deg = float(wrap_heading_deg(math.degrees(math.atan2(east, north))))
    return heading_deg, math.degrees(math.atan2(up, math.hypot(east, north)))


def _equatorial_rad(t: float) -> tuple[float, float]:
    """Apparent right ascension and declination, `t` Julian centuries after J2000; the book's letters."""
    m = math.radians(357.52911 + 35_999.05029 * t - 0.0001537 * t * t)
    c = (
        (1.914602 - 0.004817 * t - 0.000014 * t * t) * math.sin(m)
        + (0.019993 - 0.000101 * t) * math.sin(2.0 * m)
        + 0.000289 * math.sin(3.0 * m)
    )
    omega = math.radians(125.04 - 1934.136 * t)
    longitude = 280.46646 + 36_000.76983 * t + 0.0003032 * t * t + c - 0.00569 - 0.00478 * math.sin(omega)
    lam, epsilon = math.radians(longitude), math.radians(23.439291 - 0.0130042 * t + 0.00256 * math.cos(omega))
    right_ascension = math.atan2(math.cos(epsilon) * math.sin(lam), math.cos(lam))
    return right_ascension, math.asin(math.sin(epsilon) * math.sin(lam))
