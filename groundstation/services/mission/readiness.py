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
from datetime import datetime, timedelta
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from groundstation.services.site.sun import sun_place_deg
from groundstation.services.units import UnitSystem, length_unit, minutes_text, sampling_unit, speed_unit
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import photos_that_fit
from planning.base.findings import Finding, Severity, is_flyable
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.checks import check_case
from planning.checks.case import Case, pose_of
from planning.geo.frames import Vec3, camera_axes
from planning.plan import Plan
from planning.planner import resplit_sorties
from planning.revision.top_up import METHOD as TOP_UP
from planning.site.records import SiteModel, panel_corners

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

FAR_BELOW = 0.9
"""Part of what any flight can cover, below which a plan is spoken of."""

NEAR_GLASS_M = 6.0
"""GNSS without RTK is off by up to some 3 m (95 %, horizontal); nearer to glass than twice that, nothing else helps."""

WARM_C, LOST_PER_C = 27.0, 0.5 / 45.0
"""Lithium-ion cells give half of their charge of 27 C at -18 C, evenly in between (Battery University, BU-502)."""

SHADOW_M = 500.0
"""How far along the way to the sun something that hides it is looked for."""

DAY_STEP = timedelta(minutes=30)


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


@dataclass(frozen=True, slots=True)
class FlightDay:
    """What is known of the day of a flight.

    Parameters
    ----------
    at
        The middle of the flight, with its time zone; None where nobody said.
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


def readiness_findings(case: Case, day: FlightDay = UNKNOWN_DAY, monitor: Monitor = QUIET) -> tuple[Finding, ...]:
    """All findings of the rules of planning, and of those here."""
    return (
        *check_case(case, monitor),
        *additional_findings(case),
        *_sun(case, day.at),
        *_cold(case, day.temperature_c),
    )


def additional_findings(case: Case) -> tuple[Finding, ...]:
    """What is found besides the rules of planning, whatever the day: it takes no time worth waiting for."""
    return (*_coverage(case), *_place(case), *_items(case), *_glass(case))


def _coverage(case: Case) -> Iterator[Finding]:
    covered = int(np.count_nonzero(case.measures.counts))
    bound = case.plan.coverage.reachable_upper_bound
    if case.plan.method == TOP_UP:  # a top-up adds to photos that are there
        return
    if bound and covered < FAR_BELOW * bound:
        text = say(
            "{} of the {} sections that flights can cover are covered ({:.0%}): plan with more --views, or a "
            "--coverage",
            covered,
            bound,
            covered / bound,
        )
        yield Finding(Severity.WARNING, "coverage-far", text, "", 100.0 * covered / bound, 100.0 * FAR_BELOW, "%")


def _place(case: Case) -> Iterator[Finding]:
    if case.site_model.site.place_from == "ifc-site":
        text = say(
            "the site lies where its BIM file says, which is often just the city: compare it with a map, and "
            "give its --origin"
        )
        yield Finding(Severity.WARNING, "place", text)
    if case.site_model.site.place_from == "unknown":
        text = say(
            "nobody has said where the site is, or how large: make its coarse model again with --origin, and with "
            "a distance or control points, or set its origin on the Site tab once its size is known"
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


def _sun(case: Case, at: datetime | None) -> Iterator[Finding]:
    if not case.plan.viewpoints:
        return
    if at is None:
        yield Finding(Severity.NOTE, "sun", say("where the sun stands is not looked at: no time is planned (--at)"))
        return
    origin = case.site_model.site.origin
    _, elevation_deg = sun_place_deg(origin.lat_deg, origin.lon_deg, at)
    if elevation_deg <= 0.0:
        text = say("the sun is below the horizon ({:.0f} degrees) at the planned time", elevation_deg)
        yield Finding(Severity.WARNING, "sun", text, "", elevation_deg, 0.0, "deg")
        return
    dazzled = dazzled_views(case, at)
    total = len(case.plan.viewpoints)
    if not dazzled.all():
        best, n_best = _best_time(case, at)
        better = say("; at {:%H:%M} it would be {}", best, n_best) if n_best < dazzled.count else ""
        if dazzled.direct:
            text = say(
                "the sun is in the picture of {} of {} photos at the planned time{}", len(dazzled.direct), total, better
            )
            n = float(len(dazzled.direct))
            yield Finding(Severity.WARNING, "sun-direct", text, dazzled.direct[0], n, 0.0, "photos")
        if dazzled.mirrored:
            text = say(
                "glass mirrors the sun into {} of {} photos at the planned time{}", len(dazzled.mirrored), total, better
            )
            n = float(len(dazzled.mirrored))
            yield Finding(Severity.WARNING, "sun-mirrored", text, dazzled.mirrored[0], n, 0.0, "photos")
    else:
        text = say("the sun is in no photo at the planned time, and no glass mirrors it into one")
        yield Finding(Severity.OK, "sun", text, "", elevation_deg, 0.0, "deg")


@dataclass(frozen=True, slots=True)
class Dazzled:
    """Viewpoints whose photos show the sun itself, or its mirror image in a panel."""

    direct: tuple[str, ...]
    mirrored: tuple[str, ...]

    @property
    def count(self) -> int:
        """Photos that show it in either way."""
        return len({*self.direct, *self.mirrored})

    def all(self) -> bool:
        """Whether no photo does."""
        return not self.direct and not self.mirrored


def sun_direction_enu(lat_deg: float, lon_deg: float, at: datetime) -> Vec3:
    """Unit vector towards the sun, local ENU."""
    heading_deg, elevation_deg = sun_place_deg(lat_deg, lon_deg, at)
    heading, elevation = math.radians(heading_deg), math.radians(elevation_deg)
    flat = math.cos(elevation)
    return (flat * math.sin(heading), flat * math.cos(heading), math.sin(elevation))


def dazzled_views(case: Case, at: datetime) -> Dazzled:
    """The viewpoints of a plan whose photos show the sun at a time, directly or mirrored by a panel.

    A pane mirrors a sun in direction s, in front of it, for whoever looks along d = s - 2 (s . n) n; it does so into a
    photo where the ray from the camera along d meets the pane, d lies in the picture, and nothing hides the sun there.
    """
    origin = case.site_model.site.origin
    sun = np.array(sun_direction_enu(origin.lat_deg, origin.lon_deg, at))
    views = case.plan.viewpoints
    if sun[2] <= 0.0 or not views:
        return Dazzled((), ())
    places = np.array([view.position_enu_m for view in views])
    axes = camera_axes(
        np.radians([view.heading_deg for view in views]), np.radians([view.gimbal_pitch_deg for view in views])
    )
    camera = case.plan.camera
    half = (
        camera.sensor_width_mm / (2.0 * camera.focal_length_mm),
        camera.sensor_height_mm / (2.0 * camera.focal_length_mm),
    )
    direct = [
        views[n].id for n in np.flatnonzero(_in_picture(axes, sun, half)) if _is_lit(case, places[n : n + 1], sun)[0]
    ]
    mirrored: set[int] = set()
    corners = panel_corners(case.site_model.site)
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normals = across / np.linalg.norm(across, axis=1, keepdims=True)
    for normal in np.unique(np.round(normals, 6), axis=0):
        if sun @ normal <= 0.0:
            continue
        ray = sun - 2.0 * (sun @ normal) * normal
        seen = np.flatnonzero(_in_picture(axes, ray, half))
        of_normal = np.flatnonzero(np.abs(normals - normal).max(axis=1) < 1e-5)
        for n in seen:
            points = _meets(places[n], ray, corners[of_normal], normal)
            if len(points) and _is_lit(case, points + 1e-3 * normal, sun).any():
                mirrored.add(int(n))
    return Dazzled(tuple(direct), tuple(views[n].id for n in sorted(mirrored)))


def _in_picture(axes: tuple[Array, Array, Array], direction: Array, half: tuple[float, float]) -> NDArray[np.bool_]:
    """Whether a direction lies in the picture of each camera, shape (n,)."""
    forward, right, up = axes
    depth = forward @ direction
    return (depth > 0.0) & (np.abs(right @ direction) <= half[0] * depth) & (np.abs(up @ direction) <= half[1] * depth)


def _meets(place: Array, ray: Array, corners: Array, normal: Array) -> Array:
    """Where a ray from a place meets panels of one normal, shape (k, 3); corners of shape (m, 4, 3)."""
    ahead = ((corners[:, 0] - place) @ normal) / (ray @ normal)
    points = place + ahead[:, None] * ray
    edges = np.roll(corners, -1, axis=1) - corners
    inward = np.cross(normal, edges)
    is_inside = (np.einsum("mki,mki->mk", inward, points[:, None] - corners) >= 0.0).all(axis=1)
    return np.asarray(points[is_inside & (ahead > 0.0)])


def _is_lit(case: Case, points: Array, sun: Array) -> NDArray[np.bool_]:
    """Whether nothing of the site stands between points, shape (n, 3), and the sun."""
    start = points + 1e-2 * sun
    return np.asarray(case.space.solids.segment_distances_m(start, start + SHADOW_M * sun, 1.0) > 0.0)


def _best_time(case: Case, at: datetime) -> tuple[datetime, int]:
    """The time of that day with the fewest dazzled photos, the nearest to `at` of equals, while the sun is well up."""
    origin = case.site_model.site.origin
    start = at.replace(hour=0, minute=0, second=0, microsecond=0)
    times = [start + n * DAY_STEP for n in range(48)]
    up = [time for time in times if sun_place_deg(origin.lat_deg, origin.lon_deg, time)[1] > 10.0] or [at]
    counts = [(dazzled_views(case, time).count, abs(time - at), time) for time in up]
    n_best, _, best = min(counts)
    return best, n_best


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
            "larger --reserve",
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
    """

    plan: Plan
    site_model: SiteModel
    findings: tuple[Finding, ...]
    panels_covered: Mapping[str, int]
    day: FlightDay = UNKNOWN_DAY

    def is_of(self, plan: Plan | None, site_model: SiteModel | None) -> bool:
        """Whether this is about these very values."""
        return self.plan is plan and self.site_model is site_model


def preflight(plan: Plan, site_model: SiteModel, day: FlightDay = UNKNOWN_DAY, monitor: Monitor = QUIET) -> Preflight:
    """Check a plan on its site, for a day of which something is known or not."""
    monitor.report(say("measuring"), 0, 1)
    case = Case.of(plan, site_model)
    seen = case.measures.seen
    # A view sees a panel in one section only: as many elements, as many panels.
    covered = {view.id: len(seen[pose_of(view)].elements) for view in plan.viewpoints}
    return Preflight(plan, site_model, readiness_findings(case, day, monitor), covered, day)
