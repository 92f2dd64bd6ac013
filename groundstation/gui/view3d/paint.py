"""Colours as bytes: hex texts, shading of faces, and colour scales for values."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]

SUN = np.array([0.30, -0.55, 0.78])
"""Direction to the light, ENU: from the south-east and above, so that roof and all four sides differ."""

DARKEST = 0.62
"""Brightness of faces turned away from the light: colours must still be told apart there."""

SCALE_STOPS = (
    (0.00, "#00224e"),
    (0.20, "#35456c"),
    (0.40, "#666970"),
    (0.60, "#948e77"),
    (0.80, "#c8b866"),
    (1.00, "#fee838"),
)
"""Dark blue to yellow with steadily rising lightness: read alike with and without red-green blindness (the scale
"cividis" of Nunez, Anderton and Renslow, 2018, at six places)."""

NO_VALUE = "#8a8f94"
"""Grey of what has no value: it must not be mistaken for either end of the scale."""


def rgba(colour: str, opacity: float = 1.0) -> Bytes:
    """Bytes, shape (4,), of `#rrggbb`."""
    text = colour.removeprefix("#")
    if len(text) != 6:
        raise ValueError(f"expected a colour as #rrggbb, got '{colour}'")
    return np.array([*bytes.fromhex(text), round(255.0 * opacity)], np.uint8)


def flat(colour: str, n: int, opacity: float = 1.0) -> Bytes:
    """One colour for n cells, shape (n, 4)."""
    return np.tile(rgba(colour, opacity), (n, 1))


def shaded(colours: Bytes, normals: Array) -> Bytes:
    """Colours, shape (k, 4), by how much each face is turned to the light; unit normals have shape (k, 3).

    The shade is baked into the colours: the graphics card, or the processor in its place, then has no lamp to compute.
    """
    turned = 0.5 + 0.5 * normals @ (SUN / np.linalg.norm(SUN))
    brightness = DARKEST + (1.0 - DARKEST) * turned
    result = colours.copy()
    result[:, :3] = np.clip(np.rint(colours[:, :3] * brightness[:, None]), 0.0, 255.0).astype(np.uint8)
    return result


SKY, SKY_SHARE = "#8ab4dc", 0.6
"""What the background goes over into upwards, and how much of it: the horizon stays as pale as the scene."""


def sky_colour(scene: str, is_dark: bool) -> str:
    """Colour of the sky above a scene of this background, `#rrggbb`; a dark one stays dark."""
    share = 0.12 if is_dark else SKY_SHARE
    mixed = (1.0 - share) * rgba(scene)[:3].astype(np.float64) + share * rgba(SKY)[:3]
    return "#" + "".join(f"{round(value):02x}" for value in mixed)


class ValueKind(StrEnum):
    """What a value on panels or routes means, which decides the direction of its scale."""

    HIGH_IS_GOOD = "high is good"
    LOW_IS_GOOD = "low is good"


@dataclass(frozen=True, slots=True)
class ColourScale:
    """From values to colours.

    Parameters
    ----------
    title
        As the user reads it.
    unit
        Symbol behind the numbers; empty for none.
    low, high
        Values at the ends; values beyond get the colour of the end.
    """

    title: str
    unit: str
    low: float
    high: float
    kind: ValueKind = ValueKind.HIGH_IS_GOOD

    def __post_init__(self) -> None:
        if not (np.isfinite(self.low) and np.isfinite(self.high) and self.low < self.high):
            raise ValueError(f"expected finite low below high, got {self.low} and {self.high}")

    def colours(self, values: Array) -> Bytes:
        """Colours, shape (n, 4), of values, shape (n,); grey where a value is NaN."""
        share = (np.asarray(values, np.float64) - self.low) / (self.high - self.low)
        if self.kind is ValueKind.LOW_IS_GOOD:
            share = 1.0 - share
        places = [place for place, _ in SCALE_STOPS]
        stops = np.array([rgba(colour) for _, colour in SCALE_STOPS], np.float64)
        known = np.clip(np.nan_to_num(share), 0.0, 1.0)
        result = np.stack([np.interp(known, places, stops[:, band]) for band in range(4)], axis=1)
        colours = np.rint(result).astype(np.uint8)
        colours[np.isnan(values)] = rgba(NO_VALUE)
        return colours
