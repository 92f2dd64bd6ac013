"""Geo-zones in one form, whichever file they come from: what is restricted, why, where, from when to when, who decides.

Positions are WGS 84 longitude and latitude in degrees, heights are metres above what the limit says. Nothing here knows
a site. What a file leaves open stands in `questions`, and is asked of the pilot.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, date, datetime, timedelta
from enum import StrEnum

from planning.base.messages import say

LonLat = tuple[float, float]
"""Longitude and latitude, degrees, WGS 84."""


class Restriction(StrEnum):
    """What a zone asks of a flight; what is not known is kept like what is prohibited."""

    PROHIBITED = "prohibited"
    AUTHORISATION = "authorisation"
    U_SPACE = "u-space"
    CONDITIONAL = "conditional"
    NONE = "none"
    UNKNOWN = "unknown"


RESTRICTIONS = {
    Restriction.PROHIBITED: say("flights prohibited"),
    Restriction.AUTHORISATION: say("flights with an authorisation only"),
    Restriction.U_SPACE: say("U-space: flights with an authorisation of its service only"),
    Restriction.CONDITIONAL: say("flights under conditions"),
    Restriction.NONE: say("no restriction"),
    Restriction.UNKNOWN: say("a restriction that the file does not name"),
}
"""In words."""


_PROHIBITED = frozenset({"P"})
_CONTROLLED = frozenset({"A", "B", "C", "D", "CTR", "CTA", "TMA", "ATZ", "MATZ", "HTZ", "TIZ", "TIA", "LTA", "UTA"})
_RESERVED = frozenset({"R", "RESTRICTED", "TRA", "TSA", "TFR", "MTA", "MTR", "OFR", "N"})
"""Where others decide who flies: classes A to D need a clearance (ICAO Annex 11, appendix 4)."""

_INFORMED = frozenset({"E", "F", "G", "UNC", "UNCLASSIFIED", "RMZ", "TMZ", "TRZ", "AWY", "FIR", "UIR", "FIS", "ACCSEC"})
_WATCHED = frozenset({"Q", "DANGER", "ALERT", "WARNING", "W", "GP", "GSEC", "ADIZ", "ASRA", "VFRR", "VFRSEC", "TRAFR"})
"""Where it depends on the country what holds for unmanned aircraft: the pilot is asked."""


def airspace_restriction(kinds: list[str], questions: list[str]) -> Restriction:
    """What classes and types ask of a flight: the strictest of them."""
    if _PROHIBITED & set(kinds):
        return Restriction.PROHIBITED
    if (_CONTROLLED | _RESERVED) & set(kinds):
        return Restriction.AUTHORISATION
    written = " ".join(kinds)
    questions.append(
        say("what airspace '{}' means for unmanned aircraft is national law: ask what holds here", written)
    )
    return Restriction.CONDITIONAL if kinds and set(kinds) <= _INFORMED | _WATCHED else Restriction.UNKNOWN


class HeightAbove(StrEnum):
    """What a limit of a zone is counted from."""

    GROUND = "ground"
    SEA_LEVEL = "sea level"
    ELLIPSOID = "ellipsoid"
    FLIGHT_LEVEL = "1013.25 hPa"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Limit:
    """Lower or upper limit of a volume.

    Parameters
    ----------
    value_m
        Metres above `above` (for flight levels of the standard atmosphere); None for no limit.
    written
        As the file has it, for the pilot: `120 m AGL`, `FL65`.
    """

    value_m: float | None
    above: HeightAbove
    written: str


FROM_GROUND = Limit(0.0, HeightAbove.GROUND, "GND")
UNLIMITED = Limit(None, HeightAbove.SEA_LEVEL, "UNL")


@dataclass(frozen=True, slots=True)
class Outline:
    """An area: an outer ring and holes, each of longitudes and latitudes, closed or not.

    Parameters
    ----------
    tolerance_m
        By which the true area may reach beyond the rings: arcs that were drawn as chords, lines and points that have a
        width.
    """

    ring: tuple[LonLat, ...]
    holes: tuple[tuple[LonLat, ...], ...] = ()
    tolerance_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Circle:
    """All places up to a geodesic distance from a centre."""

    centre: LonLat
    radius_m: float


@dataclass(frozen=True, slots=True)
class Volume:
    """A part of a zone: an area from one height to another."""

    area: Outline | Circle
    lower: Limit = FROM_GROUND
    upper: Limit = UNLIMITED


class Daylight(StrEnum):
    """Events of a day that a schedule may begin or end with, spelled as in ED-318."""

    MORNING_TWILIGHT = "BMCT"
    SUNRISE = "SR"
    SUNSET = "SS"
    EVENING_TWILIGHT = "EECT"


@dataclass(frozen=True, slots=True)
class Clock:
    """A time of day: after midnight, and how much that clock is ahead of UTC."""

    since_midnight: timedelta
    ahead_of_utc: timedelta


@dataclass(frozen=True, slots=True)
class Daily:
    """Hours on some days of the week, 0 for Monday to 6."""

    days: frozenset[int]
    start: Clock | Daylight
    end: Clock | Daylight


@dataclass(frozen=True, slots=True)
class Period:
    """From one moment to another, None for open ends, on all hours or those of a schedule."""

    start: datetime | None = None
    end: datetime | None = None
    schedule: tuple[Daily, ...] = ()


ALWAYS = (Period(),)


@dataclass(frozen=True, slots=True)
class Authority:
    """Who decides about a zone, or is told: name, how to reach it, for what, how long before."""

    name: str
    contact: str = ""
    purpose: str = ""
    interval_before: str = ""


@dataclass(frozen=True, slots=True)
class Zone:
    """A geo-zone.

    Parameters
    ----------
    id
        Unique in its file; permissions name it.
    written_type
        The restriction as the file spells it.
    reasons, conditions, message
        As the file words them.
    volumes
        None of them: the file does not say where the zone lies.
    periods
        When it applies, any of them; None: that cannot be read.
    questions, place_questions, width_questions
        What the file leaves open about this zone, about where it lies, and about how wide it is about a known place.
    """

    id: str
    name: str
    restriction: Restriction
    written_type: str = ""
    country: str = ""
    reasons: tuple[str, ...] = ()
    conditions: str = ""
    message: str = ""
    authorities: tuple[Authority, ...] = ()
    volumes: tuple[Volume, ...] = ()
    periods: tuple[Period, ...] | None = ALWAYS
    questions: tuple[str, ...] = ()
    place_questions: tuple[str, ...] = ()
    width_questions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ZoneSet:
    """What one file says.

    Parameters
    ----------
    format
        Of the file, in words.
    publisher
        As the file names it; empty where it does not.
    issued, valid_from, valid_to
        Of the whole file; None where it does not say.
    questions
        What the file leaves open about all of its zones.
    """

    format: str
    zones: tuple[Zone, ...]
    publisher: str = ""
    issued: datetime | None = None
    valid_from: datetime | None = None
    valid_to: datetime | None = None
    questions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ZoneFile:
    """A file of zones that a site names, with what the pilot says of it.

    Parameters
    ----------
    file
        Path relative to the site file.
    sha256
        Of its content when it was added, hexadecimal.
    imported
        The day on which it was added.
    permitted
        Reference of the pilot's authorisation by identifier of the zone: flights may enter all of it.
    not_here
        Who says that what the file leaves open of a zone's place is not here, by its identifier. What can be read of
        the zone stays closed.
    """

    file: str
    sha256: str
    imported: str
    permitted: Mapping[str, str] = field(default_factory=dict, hash=False)
    not_here: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        if not self.file:
            raise ValueError(say("expected a path relative to the site file, got an empty text", place="file"))
        try:
            date.fromisoformat(self.imported)
        except ValueError as error:
            raise ValueError(
                say("expected a day such as 2026-11-28, got '{}'", self.imported, place="imported")
            ) from error
        for zone_id, reference in self.permitted.items():
            if not reference.strip():
                raise ValueError(
                    say(
                        "zone '{}': expected the reference of the authorisation, got an empty text",
                        zone_id,
                        place="permitted",
                    )
                )
        for zone_id, reference in self.not_here.items():
            if not reference.strip():
                raise ValueError(
                    say(
                        "zone '{}': expected who says that it is not here, got an empty text", zone_id, place="not_here"
                    )
                )

    @property
    def imported_at(self) -> datetime:
        """When it was added: noon of the day, UTC."""
        day = date.fromisoformat(self.imported)
        return datetime(day.year, day.month, day.day, 12, tzinfo=UTC)


@dataclass(frozen=True, slots=True, eq=False)
class SiteZones:
    """A file of zones as it was found beside its site.

    Parameters
    ----------
    content
        Of the file; empty where it could not be had.
    problem
        Why nothing in it counts as known: it is missing, was changed, or cannot be read. Empty where all is well.
    """

    source: ZoneFile
    content: bytes
    problem: str = ""


@dataclass(frozen=True, slots=True)
class TimeWindow:
    """From one moment to another, both with their time zone: zones that apply at any moment of it count."""

    start: datetime
    end: datetime

    def __post_init__(self) -> None:
        if self.start.tzinfo is None or self.end.tzinfo is None:
            raise ValueError(f"expected times with their time zone, got {self.start} and {self.end}")
        if self.end < self.start:
            raise ValueError(f"expected a start before the end, got {self.start} and {self.end}")
