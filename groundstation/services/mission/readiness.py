"""Whether a plan is ready to be flown: one verdict of the rules of planning and of what the day brings.

The rules of `planning.checks` know the plan and its site. What is added here needs more: the sun at the planned time,
the temperature, what autopilots hold, what obstacle sensing does not see, and how sure the place itself is. Each item
has its measured value, and names what mends it. Window and command line show the same items and the same verdict.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from groundstation.services.mission.sunlight import SunReport, flight_report
from groundstation.services.units import UnitSystem, length_unit, minutes_text, sampling_unit, speed_unit
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import photos_that_fit
from planning.aircraft.camera_use import camera_use_of
from planning.base.findings import Finding, Severity, is_flyable
from planning.base.messages import Message, first_few, glue, say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.checks import check_case
from planning.checks.case import Case, pose_of
from planning.checks.rules import terrain_unknown
from planning.checks.zones import source_ages
from planning.geo.sun import is_within, sun_place_deg
from planning.insight.sun_times import PAUSE_S, flown_from
from planning.insight.sunlight import BLINDING_RAD
from planning.optics import clear_sky_ev, exposure_value, shutter_text
from planning.plan import Plan
from planning.planner import resplit_sorties
from planning.revision.top_up import METHOD as TOP_UP
from planning.site.records import SiteModel
from planning.site.zones.keep_out import at_time

# Sorties with more photos than an autopilot keeps items for: found before a link is opened, and shared out anew.


@dataclass(frozen=True, slots=True)
class TooLong:
    """A sortie has too many photos for an autopilot.

    Parameters
    ----------
    autopilot
        The one with the least room, of those that may be met.
    longest, limit
        Photos of the longest sortie, and those that the autopilot has room for.
    """

    autopilot: Autopilot
    longest: int
    limit: int


def too_long(plan: Plan, autopilots: Sequence[Autopilot] = tuple(Autopilot)) -> TooLong | None:
    """Whether a sortie has more photos than all of these autopilots keep items for; None where all fit."""
    autopilot = min(autopilots, key=photos_that_fit)
    limit = photos_that_fit(autopilot)
    longest = max((len(sortie.viewpoint_ids) for sortie in plan.sorties), default=0)
    return TooLong(autopilot, longest, limit) if longest > limit else None


def split_to_fit(plan: Plan, site_model: SiteModel, found: TooLong, monitor: Monitor = QUIET) -> Plan:
    """The same views in sorties that fit.

    Raises
    ------
    InfeasibleError
        Home cannot be used, or a view cannot be reached from it.
    """
    return resplit_sorties(plan, site_model, found.limit, monitor)


# Findings in the order and units in which a pilot reads them.

SEVERITIES = (Severity.ERROR, Severity.WARNING, Severity.NOTE, Severity.OK)
"""The gravest first."""

HOUR_S = 3600

LONG_S = 120.0
"""Durations from here on are read as minutes and seconds."""


SUBJECTS = {
    code: subject
    for subject, codes in (
        (say("Airspace"), "airspace altitude low-flight no-fly home-near-no-fly"),
        (say("Geo-zones"), "zone zones"),
        (say("Ground risk"), "sora ground-risk"),
        (say("Safety distance"), "distance distance-unknown leg-distance glass-sensing"),
        (
            say("Coverage"),
            "coverage coverage-far less-coverage open left-open negligible-rest not-good-enough sections "
            "panel panels-lost views views-taken fewer-views few-compared too-many-views",
        ),
        (say("Planning"), "compiled time-budget request-left-out"),
        (say("Sharpness"), "gsd sharpness motion-blur rolling-shutter depth-of-field blur"),
        (say("Exposure"), "exposure"),
        (say("Sun"), "sun"),
        (say("Wind"), "wind"),
        (say("Battery"), "battery cold duration endurance"),
        (say("Sorties"), "sorties fewer-sorties sortie at-once waypoints duplicates length"),
        (
            say("Route"),
            "path no-path spacing leg-spacing order in-passing views-walled-in vertical-leg turn hold "
            "settle hover speed",
        ),
        (say("Return height"), "return-height security-height"),
        (say("Home"), "home takeoff no-takeoff"),
        (say("Rally points"), "rally"),
        (say("Signal lost"), "link-loss"),
        (say("Geofence"), "no-fence"),
        (
            say("Camera"),
            "camera cameras-scaled lens zoom payload no-trigger trigger triggers-only photo-interval "
            "panorama time-lapse fisheye-cut-off",
        ),
        (
            say("Camera direction"),
            "gimbal angle no-gimbal-pitch mount-after-yaw heading no-heading yaw-ignored photo-direction "
            "photo-while-turning",
        ),
        (say("Heights"), "height heights mixed-heights terrain"),
        (say("Photos"), "photo photos reports-lost images-missing masks-missing dropped-photo not-ready"),
        (say("Positions"), "position positions coordinates rtk-not-fixed"),
        (
            say("Poses"),
            "pose poses-refined refined-pose refinement-refused angles-off-in-common accuracy-estimated "
            "unposed photos-turned photos-not-refined",
        ),
        (say("Panels"), "no-panels panels-with-more-corners panel-faces-inwards facade facades-left-out"),
        (say("Site"), "site bare-site place ground walls looks-down no-points"),
        (say("Coarse model"), "model control north-unknown scale frame-of-model"),
        (
            say("Mission file"),
            "action autopilot-items item waypoint fly-to-wayline fly-waypoints file-name finish garbled "
            "nan not-checked stale-distance no-mission no-template option-left-out other-app parts-disagree route "
            "simplified stated-time dropped-do after-the-end left-out unknown-command unsupported version "
            "aircraft",
        ),
        (say("Project"), "loose-files old-format plan-changed plan-left-out read-only site-changed"),
        (say("Flight record"), "ends-in-air motors-off no-flight time-went-back log raw"),
        (say("Proof"), "proof"),
    )
    for code in codes.split()
}
"""What findings are about, as a pilot calls it, by their code or how it begins; files and scripts have the codes."""


def subject_of(code: str) -> Message:
    """What a finding is about, in a word that a pilot knows; empty for an unknown code, as of a plug-in."""
    words = code.split("-")
    beginnings = ("-".join(words[:n]) for n in range(len(words), 0, -1))
    return next((SUBJECTS[each] for each in beginnings if each in SUBJECTS), glue())


def by_severity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Findings, the gravest first, else in the order in which they came."""
    return tuple(sorted(findings, key=lambda finding: SEVERITIES.index(finding.severity)))


def counts_by_severity(findings: Iterable[Finding]) -> Mapping[Severity, int]:
    """Number of findings of each severity, 0 included."""
    counts = Counter(finding.severity for finding in findings)
    return {severity: counts[severity] for severity in SEVERITIES}


def duration_text(duration_s: float) -> str:
    """A duration with its unit: `12:05 min`, `1:02:05 h` from an hour on."""
    return f"{minutes_text(duration_s)} {'min' if round(duration_s) < HOUR_S else 'h'}"


def measured_text(value: float, unit: str, system: UnitSystem) -> str:
    """A value of a finding with its unit, as the user reads it.

    Lengths, speeds and sizes of pixels go to the user's units; what has no imperial form stays.
    """
    match unit:
        case "m":
            return length_unit(system).text(value)
        case "m/s":
            return speed_unit(system).text(value)
        case "mm":
            return sampling_unit(system).text(value / 1e3)
        case "s":
            return f"{value:.1f} s" if abs(value) < LONG_S else duration_text(value)
        case "deg":
            return f"{value:.1f}°"
        case _:
            return say(f"{{:g}} {unit}", round(value, 3)) if unit else f"{round(value, 3):g}"


Array = NDArray[np.float64]

FAR_BELOW, MUCH_DB = 0.9, 1.0
"""Part of what any flight can cover, below which a plan is spoken of; and what another battery brings, from which on
that is a warning: a ninth of the error less."""

NEAR_GLASS_M = 6.0
"""GNSS without RTK is off by up to some 3 m (95 %, horizontal); nearer to glass than twice that, nothing else helps."""

WARM_C, LOST_PER_C = 27.0, 0.5 / 45.0
"""Lithium-ion cells give half of their charge of 27 C at -18 C, evenly in between (Battery University, BU-502)."""


class Readiness(StrEnum):
    """The verdict."""

    READY = "ready"
    WITH_WARNINGS = "with-warnings"
    NOT_READY = "not-ready"


def readiness_of(findings: Sequence[Finding]) -> Readiness:
    """The verdict on findings."""
    if not is_flyable(tuple(findings)):
        return Readiness.NOT_READY
    has_warnings = any(finding.severity is Severity.WARNING for finding in findings)
    return Readiness.WITH_WARNINGS if has_warnings else Readiness.READY


NOT_LOOKED_AT = {"zones": say("zones"), "sun": say("sun"), "cold": say("batteries' temperature")}
"""What a note says is not known, by the note's code: checks that passed say nothing of it."""


def not_looked_at(findings: Iterable[Finding]) -> tuple[Message, ...]:
    """What could not be looked at, since nobody said the day, or which zones there are."""
    codes = {finding.code for finding in findings if finding.severity is Severity.NOTE}
    return tuple(name for code, name in NOT_LOOKED_AT.items() if code in codes)


@dataclass(frozen=True, slots=True)
class FlightDay:
    """What is known of the day of a flight.

    Parameters
    ----------
    at
        Take-off of the first sortie, with its time zone; None where nobody said.
    temperature_c
        Of air and batteries; None where nobody said.
    """

    at: datetime | None = None
    temperature_c: float | None = None

    def __post_init__(self) -> None:
        if self.at is not None and self.at.tzinfo is None:
            raise ValueError(f"at: expected a time with its time zone, got {self.at.isoformat()}")
        if self.temperature_c is not None and not -60.0 <= self.temperature_c <= 60.0:
            raise ValueError(f"temperature_c: expected -60 to 60, got {self.temperature_c:g}")


UNKNOWN_DAY = FlightDay()


def readiness_findings(
    case: Case, day: FlightDay = UNKNOWN_DAY, monitor: Monitor = QUIET, sun: SunReport | None = None
) -> tuple[Finding, ...]:
    """All findings of the rules of planning, and of those here; `sun` is of that day, where it was looked at."""
    return (
        *check_case(case, monitor),
        *additional_findings(case),
        *_sun(case, day.at, sun),
        *_light(case, day.at),
        *_cold(case, day.temperature_c),
        *source_ages(case.site_model, day.at or datetime.now(UTC)),
        *terrain_unknown(case.site_model),
    )


def additional_findings(case: Case) -> tuple[Finding, ...]:
    """What is found besides the rules of planning, whatever the day: it takes no time worth waiting for."""
    return (*_coverage(case), *_place(case), *_items(case), *_glass(case))


def errors_of(case: Case, monitor: Monitor = QUIET) -> tuple[Finding, ...]:
    """Why a plan is not ready to fly, whatever the day; empty where nothing forbids it."""
    found = (*check_case(case, monitor), *additional_findings(case))
    return tuple(each for each in found if each.severity is Severity.ERROR)


def _coverage(case: Case) -> Iterator[Finding]:
    covered = int(np.count_nonzero(case.measures.counts))
    bound = case.plan.coverage.reachable_upper_bound
    if case.plan.method == TOP_UP:  # a top-up adds to photos that are there
        return
    if not bound or covered >= FAR_BELOW * bound:
        return
    seen, worth = (covered, bound, covered / bound), case.plan.present_worth
    if worth is None:
        text = say(
            "{} of the {} sections that flights can cover are covered ({:.0%}): plan more views, or more batteries",
            *seen,
        )
    else:
        text = say(
            "{} of the {} sections that flights can cover are covered ({:.0%}), which says what is seen and not how "
            "good the model will be: another battery would make its pictures {:.1f} dB better",
            *seen,
            worth.gain_db,
        )
    severity = Severity.WARNING if worth is None or worth.gain_db >= MUCH_DB else Severity.NOTE
    yield Finding(severity, "coverage-far", text, "", 100.0 * covered / bound, 100.0 * FAR_BELOW, "%")


def _place(case: Case) -> Iterator[Finding]:
    if case.site_model.site.place_from == "ifc-site":
        text = say(
            "the site lies where its BIM file says, which is often just the city: compare it with a map, and "
            "set the site origin (--origin)"
        )
        yield Finding(Severity.WARNING, "place", text)
    if case.site_model.site.place_from == "unknown":
        text = say(
            "nobody has said where the site is, or how large: make its coarse model again with its origin "
            "(--origin) and with a distance or control points, or set the site origin on the Site tab once its "
            "size is known"
        )
        yield Finding(Severity.ERROR, "place", text)


def _items(case: Case) -> Iterator[Finding]:
    plan = case.plan
    known = [autopilot for autopilot in Autopilot if autopilot.value == plan.profile]
    found = too_long(plan, known) if known else None
    if found is not None:
        text = say(
            "a sortie has {} photos, and {} keeps items for {}: it is shared out among more sorties before "
            "it is uploaded",
            found.longest,
            found.autopilot.product,
            found.limit,
        )
        yield Finding(Severity.WARNING, "autopilot-items", text, "", float(found.longest), float(found.limit), "photos")


def _glass(case: Case) -> Iterator[Finding]:
    """Obstacle sensing by cameras and lidar looks through glass, or at what it mirrors."""
    site = case.site_model.site
    paths = [path for _, _, path in case.sorties()]
    if not paths or not site.n_panels:
        return
    nearest_m = min(case.measures.solid_gaps.legs_m.values())
    is_near = nearest_m < NEAR_GLASS_M
    text = (
        say(
            "obstacle sensing does not see glass: the distance kept, {:.1f} m at the least, rests on the "
            "position alone; fly with RTK",
            nearest_m,
        )
        if is_near
        else say(
            "obstacle sensing does not see glass: the distance kept, {:.1f} m at the least, rests on the "
            "position alone",
            nearest_m,
        )
    )
    severity = Severity.WARNING if is_near else Severity.NOTE
    yield Finding(severity, "glass-sensing", text, "", nearest_m, NEAR_GLASS_M, "m")


# Sun


DARKER_EV, BRIGHTER_EV = 4.0, 1.0
"""How far light on a facade lies below that of things in the sun (shade, thick clouds), and above it (bright walls)."""


def _light(case: Case, at: datetime | None) -> Iterator[Finding]:
    """A manual exposure is one that daylight at the planned time can want; others the camera measures itself."""
    use = camera_use_of(case.plan)
    settings, origin = use.settings, case.site_model.site.origin
    shutter_s, iso, f_number = settings.shutter_s, settings.iso, use.f_number
    if at is None or settings.exposure != "manual" or shutter_s is None or iso is None or f_number is None:
        return
    _, elevation_deg = sun_place_deg(origin.lat_deg, origin.lon_deg, at)
    clear_ev = clear_sky_ev(math.radians(elevation_deg))
    if math.isinf(clear_ev):  # that there is no sun is said by the rule about it
        return
    set_ev = exposure_value(f_number, shutter_s, iso)
    text = say(
        "{}, f/{:g}, ISO {} is an exposure for EV {:.1f}; with the sun {:.0f} degrees high a clear sky gives EV {:.1f}",
        *(shutter_text(shutter_s), f_number, iso, set_ev, elevation_deg, clear_ev),
    )
    off_ev = set_ev - clear_ev
    if off_ev > BRIGHTER_EV:
        text = say("{}: photos would be {:.1f} stops too dark; open up, expose longer, or raise ISO", text, off_ev)
        yield Finding(Severity.WARNING, "exposure", text, "", set_ev, clear_ev + BRIGHTER_EV, "EV")
    elif off_ev < -DARKER_EV:
        text = say("{}: even in shade photos would be too bright; expose for less time", text)
        yield Finding(Severity.WARNING, "exposure", text, "", set_ev, clear_ev - DARKER_EV, "EV")
    else:
        yield Finding(Severity.OK, "exposure", text, "", set_ev, clear_ev + BRIGHTER_EV, "EV")


def _sun(case: Case, at: datetime | None, known: SunReport | None) -> Iterator[Finding]:
    plan = case.plan
    if not plan.viewpoints:
        return
    if at is None:
        yield Finding(Severity.NOTE, "sun", say("where the sun stands is not looked at: no time is planned (--at)"))
        return
    origin = case.site_model.site.origin
    report = flight_report(case.site_model, plan, at) if known is None else known
    day = report.day
    start_s = day.track.seconds(at)
    if not is_within(day.track.up, start_s):
        _, elevation_deg = sun_place_deg(origin.lat_deg, origin.lon_deg, at)
        text = say("the sun is below the horizon ({:.0f} degrees) at the planned time", elevation_deg)
        yield Finding(Severity.WARNING, "sun", text, "", elevation_deg, 0.0, "deg")
        return
    found = flown_from(report.sorties, day, start_s)
    spoiled = [*found.direct, *found.mirrored, *found.uneven]
    better, better_for_pilot = _better_times(report, len(set(spoiled)), found.blinded_s)
    total = len(plan.viewpoints)
    for code, ids, text in (
        (
            "sun-direct",
            found.direct,
            say("the sun is in the picture of {} of {} photos with take-off at {:%H:%M}", len(found.direct), total, at),
        ),
        (
            "sun-mirrored",
            found.mirrored,
            say("glass mirrors the sun into {} of {} photos with take-off at {:%H:%M}", len(found.mirrored), total, at),
        ),
        (
            "sun-uneven",
            found.uneven,
            say(
                "{} of {} photos show a facade half in the sun with take-off at {:%H:%M}", len(found.uneven), total, at
            ),
        ),
    ):
        if ids:
            yield Finding(Severity.WARNING, code, glue(text, better), ids[0], float(len(ids)), 0.0, "photos")
    if found.blinded_s:
        text = say(
            "the sun stands within {:.0f} degrees of the aircraft as the pilot sees it from home for {:.0f} s with "
            "take-off at {:%H:%M}: fly at another time, or with an observer who stands elsewhere",
            *(math.degrees(BLINDING_RAD), found.blinded_s, at),
        )
        yield Finding(Severity.WARNING, "sun-pilot", glue(text, better_for_pilot), "", found.blinded_s, 0.0, "s")
    if not found.landed_in_light:
        yield Finding(Severity.WARNING, "sun", say("the sun sets before the last sortie has landed"))
    if not spoiled and not found.blinded_s and found.landed_in_light:
        text = say("the sun is in no photo at the planned time, and no glass mirrors it into one")
        _, elevation_deg = sun_place_deg(origin.lat_deg, origin.lon_deg, at)
        yield Finding(Severity.OK, "sun", text, "", elevation_deg, 0.0, "deg")


MOST_TIMES = 4
"""Of take-offs that a finding names."""


def _better_times(report: SunReport, n_now: int, blinded_now_s: float) -> tuple[Message, Message]:
    """Take-offs of that day with fewer photos spoiled, and with the pilot blinded for less; nothing where none are."""
    times = report.times
    if times is None or any(each.spoiled is None for each in times.sorties):
        return glue(), glue()
    spoiled = [each.spoiled for each in times.sorties if each.spoiled is not None]
    texts = [f"{report.day.track.time(each.start_s):%H:%M}" for each in times.sorties if each.start_s is not None]
    starts = first_few(texts, MOST_TIMES)
    n_best = sum(float(each.photos[0]) for each in spoiled)
    blinded_s = sum(float(each.blinded_s[0]) for each in spoiled)
    photos = say("; with take-off at {} it would be {:.0f}", starts, n_best) if n_best < n_now else glue()
    pilot = (
        say("; with take-off at {} it would be {:.0f} s", starts, blinded_s) if blinded_s < blinded_now_s else glue()
    )
    return photos, pilot


# Cold


def charge_at(temperature_c: float) -> float:
    """Part of its charge that a battery gives at a temperature."""
    return min(1.0, max(0.0, 1.0 - LOST_PER_C * (WARM_C - temperature_c)))


def _cold(case: Case, temperature_c: float | None) -> Iterator[Finding]:
    plan = case.plan
    if not plan.sorties:
        return
    if temperature_c is None:
        yield Finding(Severity.NOTE, "cold", say("what cold takes from the batteries is not looked at (--temperature)"))
        return
    share = charge_at(temperature_c)
    usable_s = plan.aircraft.endurance_s * max(0.0, share - plan.rules.battery_reserve)
    longest = max(range(len(plan.sorties)), key=lambda n: plan.sorties[n].duration_s)
    takes_s, place = plan.sorties[longest].duration_s, say("sortie {}", longest + 1)
    if takes_s > usable_s:
        text = say(
            "at {:g} degrees a battery gives some {:.0%} of its charge, {:.0f} s above the reserve, and the "
            "longest sortie takes {:.0f} s: warm the batteries to 20 degrees, or plan shorter sorties with a "
            "larger battery reserve (--reserve)",
            temperature_c,
            share,
            usable_s,
            takes_s,
        )
        yield Finding(Severity.WARNING, "cold", text, place, takes_s, usable_s, "s")
    else:
        text = say(
            "at {:g} degrees a battery gives some {:.0%} of its charge, and that is enough", temperature_c, share
        )
        yield Finding(Severity.OK, "cold", text, place, takes_s, usable_s, "s")


# A plan before the flight: every finding, and what each photo shows.


@dataclass(frozen=True, slots=True, eq=False)
class Preflight:
    """What a check found.

    Parameters
    ----------
    plan, site_model
        What was checked: findings are as fresh as these are the ones in the window.
    panels_covered
        Number of panels by viewpoint.
    day
        What was known of the day of the flight.
    sun
        Of that day; None where no time was known.
    """

    plan: Plan
    site_model: SiteModel
    findings: tuple[Finding, ...]
    panels_covered: Mapping[str, int]
    day: FlightDay = UNKNOWN_DAY
    sun: SunReport | None = None

    def is_of(self, plan: Plan | None, site_model: SiteModel | None) -> bool:
        """Whether this is about these very values."""
        return self.plan is plan and self.site_model is site_model


def preflight(
    plan: Plan,
    site_model: SiteModel,
    day: FlightDay = UNKNOWN_DAY,
    monitor: Monitor = QUIET,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
) -> Preflight:
    """Check a plan on its site, for a day of which something is known or not; in a process of its own, too."""
    monitor.report(say("measuring"), 0, 1)
    case = Case.of(plan, at_time(site_model, day.at, plan.duration_s + PAUSE_S * len(plan.sorties)))
    seen = case.measures.seen
    # A view sees a panel in one section only: as many elements, as many panels.
    covered = {view.id: len(seen[pose_of(view)].elements) for view in plan.viewpoints}
    sun = None
    if day.at is not None and plan.viewpoints:
        sun = flight_report(site_model, plan, day.at, monitor)
    return Preflight(plan, site_model, readiness_findings(case, day, monitor, sun), covered, day, sun)
