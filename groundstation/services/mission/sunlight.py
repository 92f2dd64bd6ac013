"""Sun and sky over a site on a day, as window, command line and brief show them: rows of a bar, lines, JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta, timezone, tzinfo
from enum import StrEnum
from typing import Any
from zoneinfo import ZoneInfo

import numpy as np

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.base.messages import Message, glue, joined, say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import wrap_heading_deg
from planning.geo.sun import LEAST_S, Spans, SunTrack, is_within, sun_place_deg, sun_track, total_s, without_spans
from planning.insight.sun_times import PAUSE_S, FlightTimes, SortieSun, SortieTimes, flight_times, sorties_in_sun
from planning.insight.sunlight import SunDay, SunSite, sun_day
from planning.plan import Plan
from planning.site.records import SiteModel

MOST_SPANS = 6
"""Written of one kind in a line."""

DAY_MIN = 24 * 60


@dataclass(frozen=True, slots=True)
class SunRequest:
    """A day to look at.

    Parameters
    ----------
    day
        By the calendar of `zone`.
    zone
        Of all times that are said.
    first, last
        Between which flying is wanted, minutes of that day.
    pause_s
        Between two sorties.
    shortest_s
        Glare of this length is found for certain: what accuracy costs in time.
    """

    day: date
    zone: tzinfo
    first_min: int = 0
    last_min: int = DAY_MIN
    pause_s: float = PAUSE_S
    shortest_s: float = LEAST_S
    effects: tuple[tuple[str, EffectSetting], ...] = ()

    def __post_init__(self) -> None:
        if not 0 <= self.first_min < self.last_min <= DAY_MIN:
            raise ValueError(f"first_min: expected less than last_min, got {self.first_min} and {self.last_min}")


@dataclass(frozen=True, slots=True, eq=False)
class SunReport:
    """What was found for a request.

    Parameters
    ----------
    plan, site_model
        What it is of: it is as fresh as these are the ones in the window.
    sorties, times
        How the plan's sorties meet the sun, and when to start them; none and None without viewpoints.
    """

    request: SunRequest
    site_model: SiteModel
    plan: Plan | None
    day: SunDay
    sorties: tuple[SortieSun, ...]
    times: FlightTimes | None

    def is_of(self, plan: Plan | None, site_model: SiteModel | None, day: date) -> bool:
        """Whether this is about these very values."""
        return self.plan is plan and self.site_model is site_model and self.request.day == day


def local_zone(day: date) -> tzinfo:
    """Time zone of this computer, by the clock that it has at noon of a day."""
    found = datetime.combine(day, time(12)).astimezone().tzinfo
    assert found is not None
    return found


def zone_named(name: str) -> tzinfo:
    """A time zone by its IANA name.

    Raises
    ------
    InputError
        There is none of this name.
    """
    try:
        return ZoneInfo(name)
    except (LookupError, ValueError, OSError) as error:
        raise InputError(say("expected a time zone such as Europe/Berlin, got '{}'", name)) from error


def zone_of_offset(hours: float) -> tzinfo:
    """A zone by its hours before UTC.

    Raises
    ------
    InputError
        Nowhere on earth.
    """
    if not -12.0 <= hours <= 14.0:
        raise InputError(say("expected -12 to 14 hours, got {:g}", hours, place="--utc-offset"))
    return timezone(timedelta(hours=hours))


def day_bounds(day: date, zone: tzinfo) -> tuple[datetime, datetime]:
    """Midnight of a day and of the next; they are 23 or 25 hours apart where clocks change.

    Raises
    ------
    InputError
        The calendar ends.
    """
    try:
        return datetime.combine(day, time(0), zone), datetime.combine(day + timedelta(days=1), time(0), zone)
    except OverflowError as error:
        raise InputError(say("expected a day before the year 9999, got {}", day)) from error


def sun_report(
    site_model: SiteModel,
    plan: Plan | None,
    request: SunRequest,
    monitor: Monitor = QUIET,
    until: datetime | None = None,
) -> SunReport:
    """Look at a day, and further than its end where a flight lasts `until` then.

    Raises
    ------
    InputError
        The calendar ends.
    """
    start, stop = day_bounds(request.day, request.zone)
    if until is not None and until.astimezone(UTC) > stop.astimezone(UTC):
        stop = until
    origin = site_model.site.origin
    track = sun_track(origin.lat_deg, origin.lon_deg, start, stop, request.shortest_s)
    site = SunSite(site_model)
    views, camera = (plan.viewpoints, plan.camera) if plan is not None else ((), None)
    settings: Mapping[str, EffectSetting] = dict(request.effects)
    day = sun_day(site, track, views, camera, settings, request.shortest_s, monitor)
    sorties: tuple[SortieSun, ...] = ()
    times = None
    if plan is not None and plan.viewpoints:
        bounds = [_second(track, request.day, minute) for minute in (request.first_min, request.last_min)]
        sorties = sorties_in_sun(site, day, plan, monitor)
        times = flight_times(sorties, day, np.array([bounds]), request.pause_s, monitor)
    return SunReport(request, site_model, plan, day, sorties, times)


def flight_report(site_model: SiteModel, plan: Plan, at: datetime, monitor: Monitor = QUIET) -> SunReport:
    """Look at the day of a take-off, in its zone, until the last sortie has landed."""
    flight_s = sum(sortie.duration_s + PAUSE_S for sortie in plan.sorties)
    zone = at.tzinfo
    assert zone is not None
    until = at.astimezone(UTC) + timedelta(seconds=flight_s + 60.0)
    return sun_report(site_model, plan, SunRequest(at.date(), zone), monitor, until)


def _second(track: SunTrack, day: date, minute: int) -> float:
    if minute == DAY_MIN:
        return track.length_s
    return track.seconds(datetime.combine(day, time(minute // 60, minute % 60), track.start.tzinfo))


# Words


def clock_text(track: SunTrack, seconds: float) -> str:
    """Time of day, to the minute; 24:00 at the end."""
    text = f"{track.time(seconds + 30.0):%H:%M}"
    return "24:00" if text == "00:00" and seconds > 0.5 * track.length_s else text


def spans_text(track: SunTrack, spans: Spans) -> str:
    """Spans as `06:57-17:43, 18:00-18:10`; never where there are none."""
    texts = [f"{clock_text(track, first)}-{clock_text(track, last)}" for first, last in spans]
    more = [f"... ({len(texts) - MOST_SPANS})"] if len(texts) > MOST_SPANS else []
    return ", ".join((*texts[:MOST_SPANS], *more)) or say("never")


def zone_text(track: SunTrack) -> str:
    """The zone by its distance from UTC at noon, with its name where it has one."""
    offset = (track.time(track.length_s / 2).utcoffset() or timedelta(0)).total_seconds()
    hours, minutes = divmod(round(abs(offset) / 60.0), 60)
    text = f"UTC{'-' if offset < 0 else '+'}{hours:02}:{minutes:02}"
    name = getattr(track.start.tzinfo, "key", "")
    return f"{name}, {text}" if name and name != "UTC" else text


def sun_line(report: SunReport) -> Message:
    """When the sun is up."""
    track = report.day.track
    when = say("sun over '{}' on {} ({})", report.site_model.site.name, report.request.day, zone_text(track))
    if not len(track.up):
        return say("it does not rise", place=when)
    at, elevation_deg = track.highest()
    highest = say("highest at {} with {:.1f} degrees", clock_text(track, at), elevation_deg)
    if total_s(track.up) >= track.length_s - 1.0:
        return say("it does not set, {}", highest, place=when)
    return say("up {}, {}", spans_text(track, track.up), highest, place=when)


def facade_lines(report: SunReport) -> Iterator[Message]:
    """Light on each facade."""
    track = report.day.track
    for facade in report.day.facades:
        name = say("facade '{}' (heading {})", facade.id, round(wrap_heading_deg(facade.heading_deg)))
        if abs(facade.tilt_deg) > STEEP_DEG:
            up, down = say("facade '{}' (looks up)", facade.id), say("facade '{}' (looks down)", facade.id)
            name = up if facade.tilt_deg > 0.0 else down
        yield say(
            "even light {}; all of it in the sun {}; part of it {}",
            spans_text(track, facade.even(track.up)),
            spans_text(track, facade.lit),
            spans_text(track, facade.partly),
            place=name,
        )


STEEP_DEG = 80.0
"""Facades that look further up or down have no heading worth the word."""


def sortie_name(times: SortieTimes) -> Message:
    """Sortie, or all that fly at once."""
    numbers = times.sortie.numbers
    if not numbers:
        return say("all photos")
    return say("sortie {}", numbers[0]) if len(numbers) == 1 else say("sorties {} at once", joined(", ", numbers))


def sortie_line(report: SunReport, times: SortieTimes) -> Message:
    """When to start a sortie, and what that spoils."""
    track, name = report.day.track, sortie_name(times)
    if times.start_s is None or times.spoiled is None:
        return say("no room for it in the light of this day: fly it on another", place=name)
    found, n = times.spoiled, len(times.sortie.taken_s)
    when = say("take off at {} (as good: {})", clock_text(track, times.start_s), spans_text(track, times.window))
    return say(
        "{}; the sun or its mirror image is in {:.0f} of {} photos, {:.0f} show uneven light, the pilot is blinded "
        "for {:.0f} s",
        *(when, found.dazzled[0], n, found.uneven[0], found.blinded_s[0]),
        place=name,
    )


def verdict_line(times: FlightTimes) -> Message:
    """How good the times are, against what any could reach."""
    if times.is_best:
        return say("no other times of this day spoil fewer photos")
    return say("these times spoil {:.1f} photos, and any others of this day at least {:.1f}", times.loss, times.bound)


def flight_lines(report: SunReport) -> Iterator[Message]:
    """The report for whoever flies: without effects."""
    yield sun_line(report)
    yield from facade_lines(report)
    if report.times is not None:
        for times in report.times.sorties:
            yield sortie_line(report, times)
        if report.day.track.up.size:
            yield verdict_line(report.times)


def sun_lines(report: SunReport) -> Iterator[Message]:
    """The report for people."""
    yield from flight_lines(report)
    for decision in report.day.decisions:
        yield glue(str(decision))


def moment_lines(report: SunReport, seconds: float) -> Iterator[Message]:
    """What a second of the day means: where the sun stands, light on facades, and sorties that would start then."""
    track, at = report.day.track, report.day.track.time(seconds)
    heading_deg, elevation_deg = sun_place_deg(track.lat_deg, track.lon_deg, at)
    clock = clock_text(track, seconds)
    yield say("sun at heading {}, elevation {:.1f} degrees", round(heading_deg), elevation_deg, place=clock)
    if not is_within(track.up, seconds):
        return
    for facade in report.day.facades:
        name = say("facade '{}'", facade.id)
        if is_within(facade.lit, seconds):
            yield say("in the sun", place=name)
        elif is_within(facade.partly, seconds):
            yield say("in the sun in part", place=name)
        else:
            yield say("in shade", place=name)
    if report.times is None:
        return
    for times in sorted(report.times.sorties, key=lambda each: each.sortie.numbers):
        starts, n = np.array([seconds]), len(times.sortie.taken_s)
        found, name = times.sortie.spoiled(starts), sortie_name(times)
        if math.isnan(start_losses(times.sortie, report.times, starts)[0]):
            yield say("it would not land in the light", place=name)
        else:
            yield say(
                "with take-off then, the sun or its mirror image is in {:.0f} of {} photos, {:.0f} show uneven light, "
                "the pilot is blinded for {:.0f} s",
                *(found.dazzled[0], n, found.uneven[0], found.blinded_s[0]),
                place=name,
            )


def sun_summary(report: SunReport) -> dict[str, Any]:
    """The report as JSON has it; times with their zone."""
    track, day = report.day.track, report.day

    def spans(found: Spans) -> list[list[str]]:
        return [[track.time(float(t)).isoformat(timespec="seconds") for t in span] for span in found]

    content: dict[str, Any] = {
        "site": report.site_model.site.name,
        "day": report.request.day.isoformat(),
        "zone": zone_text(track),
        "up": spans(track.up),
        "facades": [
            {
                "id": facade.id,
                "heading_deg": round(facade.heading_deg, 3),
                "even": spans(facade.even(track.up)),
                "sun": spans(facade.lit),
                "partly": spans(facade.partly),
            }
            for facade in day.facades
        ],
        "effects": [
            {"effect": each.effect, "on": each.on, "reason": each.reason, "size": each.size, "unit": each.unit}
            for each in day.decisions
        ],
    }
    if report.plan is not None:
        content["views"] = [
            {"id": name, "direct": spans(view.direct), "mirrored": spans(view.mirrored)}
            for name, view in day.views.items()
            if len(view.direct) or len(view.mirrored)
        ]
    if report.times is not None:
        content["sorties"] = [_sortie_summary(track, times, spans) for times in report.times.sorties]
        content["spoiled"] = round(report.times.loss, 3)
        content["least_possible"] = round(report.times.bound, 3)
    return content


def _sortie_summary(track: SunTrack, times: SortieTimes, spans: Any) -> dict[str, Any]:
    found, start = times.spoiled, times.start_s
    return {
        "sorties": list(times.sortie.numbers),
        "take_off": None if start is None else track.time(start).isoformat(timespec="seconds"),
        "as_good": spans(times.window),
        "best": spans(times.best),
        "photos": len(times.sortie.taken_s),
        "dazzled": None if found is None else int(found.dazzled[0]),
        "uneven": None if found is None else int(found.uneven[0]),
        "blinded_s": None if found is None else float(found.blinded_s[0]),
    }


# The bar over the day


class Look(StrEnum):
    """What a stretch of a row shows."""

    NIGHT = "night"
    SKY = "sky"
    SUN = "sun"
    PARTLY = "partly"
    SHADE = "shade"
    GOOD = "good"
    FAIR = "fair"
    BAD = "bad"
    FLIGHT = "flight"


HEIGHTS = {
    Look.NIGHT: 1.0,
    Look.SKY: 1.0,
    Look.SUN: 1.0,
    Look.PARTLY: 0.6,
    Look.SHADE: 0.25,
    Look.GOOD: 1.0,
    Look.FAIR: 0.6,
    Look.BAD: 0.25,
    Look.FLIGHT: 1.0,
}
"""Of a row that a stretch takes up: not all people see all colours."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """From one part of the day to another, 0 to 1."""

    first: float
    last: float
    look: Look


@dataclass(frozen=True, slots=True)
class DayRow:
    """One row of the bar: the sky, a facade, or starts of a sortie."""

    name: str
    stretches: tuple[Stretch, ...]


MOST_STEPS = 288
"""Of a sortie's row: 5 minutes each."""

GOOD_SHARE, FAIR_SHARE = 0.01, 0.1
"""Parts of a sortie's photos up to which a start looks good, and fair."""


def day_rows(report: SunReport) -> tuple[DayRow, ...]:
    """Rows of the bar; stretches of each in order, later ones over earlier ones."""
    track, day = report.day.track, report.day
    length = track.length_s

    def stretches(spans: Spans, look: Look) -> tuple[Stretch, ...]:
        return tuple(Stretch(float(a) / length, float(b) / length, look) for a, b in spans)

    night = without_spans(np.array([[0.0, length]]), track.up)
    dark = stretches(night, Look.NIGHT)
    rows = [DayRow(say("sun"), (*dark, *stretches(track.up, Look.SKY)))]
    for facade in day.facades:
        shade = without_spans(without_spans(track.up, facade.lit), facade.partly)
        parts = ((shade, Look.SHADE), (facade.partly, Look.PARTLY), (facade.lit, Look.SUN))
        rows.append(
            DayRow(
                say("facade '{}'", facade.id), (*dark, *(s for spans, look in parts for s in stretches(spans, look)))
            )
        )
    if report.times is not None:
        for times in sorted(report.times.sorties, key=lambda each: each.sortie.numbers):
            rows.append(DayRow(sortie_name(times), (*dark, *_start_stretches(times, report.times, length))))
    return tuple(rows)


def first_take_off(report: SunReport) -> float | None:
    """The first of the proposed starts; None where there is none."""
    times = report.times
    starts = [] if times is None else [each.start_s for each in times.sorties if each.start_s is not None]
    return min(starts, default=None)


def start_losses(sortie: SortieSun, flight: FlightTimes, starts_s: np.ndarray) -> np.ndarray:
    """Part of a sortie's photos that starts spoil, shape (n,); NaN where the sun is not up for the whole sortie."""
    shares = sortie.losses(starts_s) / max(1, len(sortie.taken_s))
    inside = [(starts_s >= first) & (starts_s + sortie.duration_s <= last) for first, last in flight.allowed]
    return np.where(np.any(inside, axis=0) if inside else False, shares, np.nan)


def _start_stretches(times: SortieTimes, flight: FlightTimes, length: float) -> Iterator[Stretch]:
    edges = np.linspace(0.0, length, MOST_STEPS + 1)
    shares = start_losses(times.sortie, flight, 0.5 * (edges[:-1] + edges[1:]))
    looks = [
        Look.NIGHT if math.isnan(s) else Look.GOOD if s <= GOOD_SHARE else Look.FAIR if s <= FAIR_SHARE else Look.BAD
        for s in shares
    ]
    first = 0
    for n in range(1, len(looks) + 1):
        if n == len(looks) or looks[n] is not looks[first]:
            if looks[first] is not Look.NIGHT:
                yield Stretch(edges[first] / length, edges[n] / length, looks[first])
            first = n
    if times.start_s is not None:
        yield Stretch(times.start_s / length, (times.start_s + times.sortie.duration_s) / length, Look.FLIGHT)


def hour_marks(track: SunTrack, every: int = 3) -> Sequence[tuple[float, str]]:
    """Where hours stand on the bar, 0 to 1, and their texts."""
    marks = []
    for hour in range(0, 24, every):
        at = datetime.combine(track.start.date(), time(hour), track.start.tzinfo)
        marks.append((track.seconds(at) / track.length_s, f"{hour:02}:00"))
    return (*marks, (1.0, clock_text(track, track.length_s)))
