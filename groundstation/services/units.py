"""Metric and imperial display: everything inside is metric, only what stands on screen and on paper is not."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

FOOT_M = 0.3048
MILE_M = 1609.344
INCH_M = 0.0254
"""By definition (international foot, mile and inch)."""


class UnitSystem(StrEnum):
    """What the user reads lengths and speeds in."""

    METRIC = "metric"
    IMPERIAL = "imperial"


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit on screen: `shown = value * factor`, written with `decimals` and the symbol."""

    symbol: str
    factor: float
    decimals: int

    def shown(self, value: float) -> float:
        """A metric value in this unit."""
        return value * self.factor

    def metric(self, shown: float) -> float:
        """The metric value of a number in this unit."""
        return shown / self.factor

    def text(self, value: float) -> str:
        """A metric value as it is read, with its unit."""
        text = f"{self.shown(value):.{self.decimals}f}"
        # A rounded "-0.0" has lost its meaning.
        return f"{text.removeprefix('-') if float(text) == 0.0 else text} {self.symbol}"


_UNITS = {
    "length": (Unit("m", 1.0, 1), Unit("ft", 1.0 / FOOT_M, 1)),
    "distance": (Unit("km", 1e-3, 2), Unit("mi", 1.0 / MILE_M, 2)),
    "speed": (Unit("m/s", 1.0, 1), Unit("mph", 3600.0 / MILE_M, 1)),
    "sampling": (Unit("mm", 1e3, 2), Unit("in", 1.0 / INCH_M, 3)),
    "area": (Unit("m²", 1.0, 1), Unit("ft²", 1.0 / FOOT_M**2, 0)),
}


def length_unit(system: UnitSystem) -> Unit:
    """For metres of sites and plans."""
    return _UNITS["length"][system is UnitSystem.IMPERIAL]


def distance_unit(system: UnitSystem) -> Unit:
    """For metres of whole flights."""
    return _UNITS["distance"][system is UnitSystem.IMPERIAL]


def speed_unit(system: UnitSystem) -> Unit:
    """For metres per second."""
    return _UNITS["speed"][system is UnitSystem.IMPERIAL]


def sampling_unit(system: UnitSystem) -> Unit:
    """For ground sampling distances, metres per pixel."""
    return _UNITS["sampling"][system is UnitSystem.IMPERIAL]


def area_unit(system: UnitSystem) -> Unit:
    """For square metres."""
    return _UNITS["area"][system is UnitSystem.IMPERIAL]


def per_cent(part: float, whole: float, decimals: int = 1) -> float:
    """A share in per cent, rounded down: 100 means that nothing is missing. 0 of nothing is 0."""
    if not whole > 0.0:
        return 0.0
    # A share such as 0.29 is a little less than 29 hundredths in binary.
    scale = float(10**decimals)
    return math.floor(100.0 * scale * part / whole + 1e-6) / scale


def minutes_text(duration_s: float) -> str:
    """A duration as pilots read it: `12:05`, `1:02:05` from an hour on."""
    seconds = round(duration_s)
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}" if hours else f"{minutes}:{seconds:02d}"
