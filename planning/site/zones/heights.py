"""Heights of zones as files write them: numbers, units, what they are counted from."""

from __future__ import annotations

import math

from planning.base.messages import say
from planning.site.zones.records import FROM_GROUND, HeightAbove, Limit

FOOT_M, NAUTICAL_MILE_M = 0.3048, 1852.0

UNITS_M = {"M": 1.0, "FT": FOOT_M}

REFERENCES = {
    "AGL": HeightAbove.GROUND,
    "SFC": HeightAbove.GROUND,
    "GND": HeightAbove.GROUND,
    "AMSL": HeightAbove.SEA_LEVEL,
    "MSL": HeightAbove.SEA_LEVEL,
    "WGS84": HeightAbove.ELLIPSOID,
    "W84": HeightAbove.ELLIPSOID,
    "STD": HeightAbove.FLIGHT_LEVEL,
}

EVERYWHERE_BELOW = Limit(None, HeightAbove.UNKNOWN, "?")
"""In the place of a limit that cannot be read: as low or as high as there is."""


def no_limit(questions: list[str], *, is_lower: bool) -> Limit:
    """In the place of a limit that a file has to give and does not, with a question."""
    questions.append(
        say("the file gives no lower limit, so it counts from the ground up")
        if is_lower
        else say("the file gives no upper limit, so it counts at any height above")
    )
    return EVERYWHERE_BELOW


def unread_limit(written: str, questions: list[str]) -> None:
    """Ask about a height that is none."""
    questions.append(say("the height '{}' cannot be read, so every height counts", written))


def limit(
    value: float | None, unit: str, reference: str, questions: list[str], *, is_lower: bool, is_stated: bool = True
) -> Limit:
    """A limit from its number, unit and reference as spelled.

    What cannot be read is asked, and reaches as far as there is.

    Parameters
    ----------
    value
        None where the file has none, or one that is no number.
    is_stated
        Whether the file says anything about it; a limit it does not speak of is the ground or endless.
    """
    word = reference.strip().upper()
    above, unit_m = REFERENCES.get(word), UNITS_M.get(unit.strip().upper())
    if value is None or not math.isfinite(value):
        if not is_stated:
            return FROM_GROUND if is_lower else Limit(None, HeightAbove.SEA_LEVEL, "UNL")
        return EVERYWHERE_BELOW
    written = " ".join(word for word in (f"{value:g}", unit.strip(), reference.strip()) if word)
    if unit_m is None:
        questions.append(
            say("the height '{}' does not say whether it is in metres or feet, so every height counts", written)
        )
    if above is None:
        questions.append(
            say(
                "the height '{}' does not say whether it is above ground (AGL), sea level (AMSL) or the ellipsoid "
                "(WGS84), so every height counts",
                written,
            )
        )
    if above is None or unit_m is None:
        return Limit(None, HeightAbove.UNKNOWN, f"{written} ?")
    return Limit(value * unit_m, above, f"{value:g} {unit.strip().lower()} {word}")
