"""OpenAir: airspace in lines of text (WinPilot 1998; Naviter's extension 2.1 of 2025).

An airspace begins at its `AC` line. Distances are nautical miles.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from planning.base.files import check_lines
from planning.base.messages import say
from planning.site.zones.arcs import arc_corners
from planning.site.zones.fields import quoted
from planning.site.zones.heights import EVERYWHERE_BELOW, FOOT_M, NAUTICAL_MILE_M, REFERENCES, no_limit, unread_limit
from planning.site.zones.records import (
    ALWAYS,
    FROM_GROUND,
    UNLIMITED,
    Circle,
    HeightAbove,
    Limit,
    LonLat,
    Outline,
    Period,
    Volume,
    Zone,
    ZoneSet,
    airspace_restriction,
)
from planning.site.zones.times import moment

MAX_LINES = 2_000_000
"""Of a file of the whole world."""

MAX_RADIUS_NM = 2000.0

_POINT = re.compile(
    r"(\d{1,3})[:°](\d{1,2}(?:\.\d+)?)(?:[:'](\d{1,2}(?:\.\d+)?))?\s*\"?\s*([NS])[\s,]*"
    r"(\d{1,3})[:°](\d{1,2}(?:\.\d+)?)(?:[:'](\d{1,2}(?:\.\d+)?))?\s*\"?\s*([EW])",
    re.IGNORECASE,
)
_HEIGHT = re.compile(r"([+-]?\d+(?:\.\d+)?)\s*(FT|F|M)?\s*(AGL|GND|SFC|AMSL|MSL|ALT|STD)?", re.IGNORECASE)
_LEVEL = re.compile(r"FL\s*(\d+(?:\.\d+)?)(?:\s*(?:AMSL|MSL|STD))?", re.IGNORECASE)

_SKIPPED = ("AF", "AG", "AT", "AX", "AI", "SP", "SB", "TO", "TC")
"""Frequencies, labels, pens and terrain: they change no area."""

_OUTLINE = ("AN", "AH", "AL", "DP", "DC", "DA", "DB")
"""Where such lines stand before any `AC`, that of their airspace is lost."""


def recognises(content: bytes) -> bool:
    """Whether a file is OpenAir: a line begins with `AC` and one with `AN`, `AH`, `AL` or a `D` command."""
    head = re.split(rb"[\r\n]+", content[:200_000].removeprefix(b"\xef\xbb\xbf"))
    return any(re.match(rb"\s*AC\s+\S", line) for line in head) and any(
        re.match(rb"\s*(AN|AH|AL|DP|DC|DA|DB|V)\s", line) for line in head
    )


@dataclass
class _Airspace:
    """An airspace while its lines are read."""

    kind: str
    name: str = ""
    more: str = ""
    heights: dict[str, str] = field(default_factory=dict)
    times: list[str] = field(default_factory=list)
    points: list[LonLat] = field(default_factory=list)
    circles: list[Circle] = field(default_factory=list)
    tolerance_m: float = 0.0
    questions: list[str] = field(default_factory=list)
    centre: LonLat | None = None
    clockwise: bool = True


def read(content: bytes, path: Path) -> ZoneSet:
    """Airspaces of an OpenAir file.

    Raises
    ------
    InputError
        It has too many lines.
    """
    check_lines(content, MAX_LINES, path)
    questions: list[str] = []
    zones = [_zone(each, f"{path.stem} {number}") for number, each in enumerate(_airspaces(content, questions), 1)]
    return ZoneSet("OpenAir", tuple(zones), questions=tuple(questions))


def _text(content: bytes) -> str:
    """UTF-8, or else the Windows code page that old files are in: only names differ."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace")


def _airspaces(content: bytes, questions: list[str]) -> Iterator[_Airspace]:
    current: _Airspace | None = None
    for line in re.split(r"\r\n|\r|\n", _text(content)):
        written = line.partition("*")[0].strip()
        command, _, rest = written.replace("\t", " ").partition(" ")
        command, rest = command.upper(), rest.strip()
        if command == "AC":
            if current is not None:
                yield current
            current = _Airspace(rest.partition(";")[0].strip().upper())
        elif command and (current is not None or command in _OUTLINE):
            if current is None:
                current = _Airspace("", questions=[say("line '{}' belongs to no airspace", quoted(written))])
            _take(current, command, rest)
        elif command and command not in _SKIPPED and not command.startswith("V"):
            questions.append(say("line '{}' belongs to no airspace", quoted(written)))
    if current is not None:
        yield current


def _take(airspace: _Airspace, command: str, rest: str) -> None:
    """One line of an airspace."""
    if command == "AN":
        airspace.name = rest
    elif command == "AY":
        airspace.more = rest.partition(";")[0].strip().upper()
    elif command in ("AH", "AL"):
        if command in airspace.heights:
            airspace.questions.append(say("there are two lines '{}'", command))
        airspace.heights[command] = rest.partition(";")[0].strip()
    elif command == "AA":
        airspace.times.append(rest.partition(";")[0].strip())
    elif command == "V" or command.startswith(("V=", "VX", "VD")):
        _variable(airspace, rest)
    elif command == "DP":
        points = _points(rest)
        if len(points) == 1:
            airspace.points += points
        else:
            airspace.questions.append(say("line '{}' cannot be read", quoted(f"{command} {rest}")))
    elif command == "DC":
        radius_m = _radius_m(rest)
        if radius_m is None or airspace.centre is None:
            airspace.questions.append(say("line '{}' cannot be read", quoted(f"{command} {rest}")))
        else:
            airspace.circles.append(Circle(airspace.centre, radius_m))
    elif command in ("DA", "DB"):
        _arc(airspace, command, rest)
    elif command not in _SKIPPED:
        airspace.questions.append(say("line '{}' cannot be read", quoted(f"{command} {rest}")))


def _variable(airspace: _Airspace, rest: str) -> None:
    name, _, value = rest.partition("=")
    name, value = name.strip().upper(), value.strip()
    if name == "X" and len(points := _points(value)) == 1:
        airspace.centre = points[0]
    elif name == "D" and value[:1] in ("+", "-"):
        airspace.clockwise = value[0] == "+"
    elif name not in ("W", "Z", "T"):
        airspace.questions.append(say("line '{}' cannot be read", quoted(f"V {rest}")))
        if name == "X":
            airspace.centre = None


def _points(text: str) -> list[LonLat]:
    """Positions in degrees, minutes and seconds, or degrees and decimal minutes."""
    found = []
    for match in _POINT.finditer(text):
        lat = int(match[1]) + float(match[2]) / 60.0 + float(match[3] or 0.0) / 3600.0
        lon = int(match[5]) + float(match[6]) / 60.0 + float(match[7] or 0.0) / 3600.0
        is_sexagesimal = all(float(match[k] or 0.0) < 60.0 for k in (2, 3, 6, 7))
        if is_sexagesimal and lat <= 90.0 and lon <= 180.0:
            found.append((-lon if match[8].upper() == "W" else lon, -lat if match[4].upper() == "S" else lat))
    return found


def _radius_m(text: str) -> float | None:
    try:
        radius_nm = float(text.partition(";")[0].strip())
    except ValueError:
        return None
    return radius_nm * NAUTICAL_MILE_M if 0.0 < radius_nm <= MAX_RADIUS_NM else None


def _arc(airspace: _Airspace, command: str, rest: str) -> None:
    """Points on an arc: `DA radius, from, to` in degrees from north, or `DB` from one point to another."""
    from pyproj import Geod

    centre = airspace.centre
    ends: list[float] | None = None
    radii_m: tuple[float, float] = (0.0, 0.0)
    if centre is not None and command == "DA":
        numbers = [_number(word) for word in rest.partition(";")[0].split(",")]
        if len(numbers) == 3 and all(math.isfinite(each) for each in numbers) and 0.0 < numbers[0] <= MAX_RADIUS_NM:
            ends, radii_m = [numbers[1] % 360.0, numbers[2] % 360.0], (numbers[0] * NAUTICAL_MILE_M,) * 2
    elif centre is not None and len(points := _points(rest)) == 2:
        found = [Geod(ellps="WGS84").inv(*centre, *point) for point in points]
        ends, radii_m = [each[0] % 360.0 for each in found], (found[0][2], found[1][2])
    if ends is None or centre is None or not 0.0 < max(radii_m) <= MAX_RADIUS_NM * NAUTICAL_MILE_M:
        airspace.questions.append(say("line '{}' cannot be read", quoted(f"{command} {rest}")))
        return
    turn = (ends[1] - ends[0]) % 360.0 if airspace.clockwise else -((ends[0] - ends[1]) % 360.0)
    corners, tolerance_m = arc_corners(centre, ends[0], turn or (360.0 if airspace.clockwise else -360.0), radii_m)
    airspace.points += corners
    airspace.tolerance_m = max(airspace.tolerance_m, tolerance_m)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _zone(airspace: _Airspace, unnamed: str) -> Zone:
    questions: list[str] = []
    kinds = [kind for kind in (airspace.more, airspace.kind) if kind and kind != "NONE"]
    lower = _limit(airspace.heights.get("AL"), questions, is_lower=True)
    upper = _limit(airspace.heights.get("AH"), questions, is_lower=False)
    volumes = [Volume(circle, lower, upper) for circle in airspace.circles]
    places = list(airspace.questions)
    if airspace.points:
        volumes.append(Volume(Outline(tuple(airspace.points), tolerance_m=airspace.tolerance_m), lower, upper))
    if not volumes:
        places.append(say("an area has no outline that can be read"))
    name = airspace.name or unnamed
    return Zone(
        id=name,
        name=name,
        restriction=airspace_restriction(kinds, questions),
        written_type=" ".join(reversed(kinds)),
        volumes=tuple(volumes),
        periods=_periods(airspace.times, questions),
        questions=tuple(questions),
        place_questions=tuple(places),
    )


def _limit(text: str | None, questions: list[str], *, is_lower: bool) -> Limit:
    if text is None:
        return no_limit(questions, is_lower=is_lower)
    word = text.upper().strip()
    if word in ("GND", "SFC", "0"):
        return FROM_GROUND
    if word.startswith("UNL"):
        return EVERYWHERE_BELOW if is_lower else UNLIMITED
    if level := _LEVEL.fullmatch(word):
        return Limit(float(level[1]) * 100.0 * FOOT_M, HeightAbove.FLIGHT_LEVEL, f"FL{level[1]}")
    found = _HEIGHT.fullmatch(word)
    if found is None or found[3] is None:
        if found is None:
            unread_limit(quoted(text), questions)
        else:
            questions.append(
                say(
                    "the height '{}' does not say whether it is above ground or sea, so every height counts",
                    quoted(text),
                )
            )
        return replace(EVERYWHERE_BELOW, written=f"{quoted(text)} ?")
    above = HeightAbove.SEA_LEVEL if found[3] == "ALT" else REFERENCES[found[3]]
    return Limit(float(found[1]) * (1.0 if found[2] == "M" else FOOT_M), above, text)


def _periods(times: list[str], questions: list[str]) -> tuple[Period, ...] | None:
    """Activation times of Naviter's extension; `NONE` waits for a NOTAM, which nobody here can read."""
    if not times:
        return ALWAYS
    periods = []
    for text in times:
        start, slash, end = (part.strip() for part in text.partition("/"))
        moments = [None if word.upper() == "NONE" else moment(word) for word in (start, end)]
        is_read = all(
            found is not None or word.upper() == "NONE" for found, word in zip(moments, (start, end), strict=True)
        )
        if not slash or not is_read or moments == [None, None]:
            questions.append(say("when it is active, '{}', is decided elsewhere: ask for NOTAMs", quoted(text)))
            return None
        periods.append(Period(moments[0], moments[1]))
    return tuple(periods)
