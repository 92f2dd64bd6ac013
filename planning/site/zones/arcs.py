"""Arcs of outlines as chords: how many, what they cost, and their corners.

Corners lie on the arc. Which side of it belongs to the area is not known while it is read, so the area is widened by
the sagitta later, and holds the true one either way.
"""

from __future__ import annotations

import math

from planning.site.zones.records import LonLat

ARC_TOLERANCE_M = 0.5
"""Largest sagitta of the chords of an arc."""

MAX_CHORDS = 720
"""Of a whole turn: on the largest arcs the tolerance is wider instead, and states so."""


def sagitta_m(radius_m: float, turn_deg: float) -> float:
    """Largest distance between an arc and its chord, r (1 - cos(a / 2)): the accuracy that chords cost."""
    return radius_m * 2.0 * math.sin(math.radians(turn_deg) / 4.0) ** 2


def chords(radius_m: float, turn_deg: float) -> int:
    """As many chords as an arc needs for `ARC_TOLERANCE_M`, at most `MAX_CHORDS` for a whole turn."""
    widest_rad = 4.0 * math.asin(min(1.0, math.sqrt(ARC_TOLERANCE_M / (2.0 * radius_m))))
    wanted = math.ceil(math.radians(turn_deg) / widest_rad)
    return max(2, min(wanted, math.ceil(MAX_CHORDS * turn_deg / 360.0)))


def arc_corners(
    centre: LonLat, start_deg: float, turn_deg: float, radii_m: tuple[float, float]
) -> tuple[tuple[LonLat, ...], float]:
    """Corners of an arc, and the tolerance of its chords, metres.

    Parameters
    ----------
    start_deg, turn_deg
        Bearing of its first end from the centre, and how far it turns, clockwise positive.
    radii_m
        At both ends. Where they differ nobody knows which holds between them, so their difference is tolerance.
    """
    from pyproj import Geod

    geod, largest_m = Geod(ellps="WGS84"), max(radii_m)
    n_chords = chords(largest_m, abs(turn_deg))
    corners = []
    for number in range(n_chords + 1):
        share = number / n_chords
        radius_m = radii_m[0] + share * (radii_m[1] - radii_m[0])
        lon, lat, _ = geod.fwd(*centre, start_deg + share * turn_deg, radius_m)
        corners.append((lon, lat))
    return tuple(corners), sagitta_m(largest_m, abs(turn_deg) / n_chords) + abs(radii_m[0] - radii_m[1])
