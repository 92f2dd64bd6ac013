"""The flight brief: what the pilot needs on paper, as one record. `brief_html` makes a page of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from groundstation.services.mission.readiness import UNKNOWN_DAY, FlightDay, Readiness, by_severity, readiness_of
from groundstation.services.mission.sunlight import SunReport, flight_lines
from groundstation.services.mission.waypoints import WaypointRow, waypoint_rows
from missions.formats.camera_steps import camera_steps
from missions.formats.encode import TakeoffCheck, dji_return_height, takeoff_check
from missions.formats.options import ExportOptions
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import LinkLoss
from planning.base.errors import GroundStationError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.insight.flight_profile import LowFlight, highest_above_ground_m, low_flight, lowest_flight
from planning.insight.ground_risk import GroundRisk, assess_ground_risk
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.plan import FlightWorth, Plan
from planning.site.ground import ground_of, height_at
from planning.site.records import Site, SiteModel


@dataclass(frozen=True, slots=True)
class TakeoffPlace:
    """Where every sortie begins and ends: WGS 84, and its height in both references; `ground_m` above the ground."""

    lat_deg: float
    lon_deg: float
    height_ellipsoid_m: float
    altitude_amsl_m: float
    above_ground_m: float


@dataclass(frozen=True, slots=True)
class SortieBrief:
    """One battery.

    Parameters
    ----------
    battery_share
        Part of the endurance that the sortie takes, take-off and landing included.
    max_above_takeoff_m, max_altitude_amsl_m
        Of its highest point.
    low
        How low it flies beside the column above home; None where it never leaves that.
    smallest_clearance_m
        To building, panels and obstacles along the path; None where no check measured it.
    takeoff_check
        What the pilot sees at its first waypoint; None where it has no path.
    start_s, aircraft
        Of sorties that are flown at once: when it starts, from the first start on, and by which aircraft.
    """

    number: int
    n_photos: int
    length_m: float
    duration_s: float
    battery_share: float
    max_above_takeoff_m: float
    max_altitude_amsl_m: float
    low: LowFlight | None
    smallest_clearance_m: float | None
    takeoff_check: TakeoffCheck | None = None
    start_s: float | None = None
    aircraft: int | None = None


@dataclass(frozen=True, slots=True)
class FlightBrief:
    """Everything that stands in the brief but the pictures.

    Parameters
    ----------
    planned_on
        Date of printing, as text.
    day
        When it is flown and how cold it is, as far as that is known.
    max_above_ground_m
        What rules of the air count from.
    low
        How low all sorties together fly; None where none leaves the column above home.
    min_height_m
        Lowest flight above the ground that was to be kept.
    return_height_m
        Above take-off, to be set on the remote controller; None where it cannot be worked out, which a finding says.
    zones
        All that was found about geo-zones, what is kept included.
    findings
        All that are not OK, the gravest first.
    covered_share
        Of what can be covered.
    sharp_share
        Of what is covered, by pixels up to `wanted_gsd_mm`; None where the plan does not say.
    coarsest_gsd_mm
        Pixel of the sharpest view of the section that is seen most coarsely.
    camera_by_hand, camera_by_mission
        Settings of the camera that the pilot has to make, in the order of the menus, and those that the mission makes.
    ground_risk
        Volumes and class by SORA; None where the pilot stated nothing for it.
    worth
        What a model of the photos is expected to be like; None where the plan does not say.
    sun
        Of the day it is flown on, in lines; empty where no time is known.
    proof
        What an independent check says of the plan, in words; empty where none did.
    """

    site: str
    plan_title: str
    planned_on: str
    day: FlightDay
    aircraft: str
    camera: str
    takeoff: TakeoffPlace
    sorties: tuple[SortieBrief, ...]
    n_photos: int
    max_above_ground_m: float
    low: LowFlight | None
    min_height_m: float
    min_distance_m: float
    covered_share: float
    sharp_share: float | None
    wanted_gsd_mm: float | None
    coarsest_gsd_mm: float | None
    worth: FlightWorth | None
    wind_m_s: float
    max_wind_m_s: float
    battery_reserve: float
    settle_s: float
    max_speed_m_s: float
    return_height_m: float | None
    link_loss: LinkLoss
    no_fly: tuple[str, ...]
    obstacles: tuple[str, ...]
    findings: tuple[Finding, ...]
    sun: tuple[str, ...] = ()
    camera_by_hand: tuple[str, ...] = ()
    camera_by_mission: tuple[str, ...] = ()
    zones: tuple[Finding, ...] = ()
    ground_risk: GroundRisk | None = None
    proof: str = ""

    def in_words(self, localize: Callable[[str], str]) -> FlightBrief:
        """The brief with its lines and findings in the pilot's language."""

        def worded(findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
            return tuple(replace(each, message=localize(each.message), place=localize(each.place)) for each in findings)

        risk = self.ground_risk
        if risk is not None:
            how_intrinsic, how_final = localize(risk.how_intrinsic), localize(risk.how_final)
            risk = replace(risk, how_intrinsic=how_intrinsic, how_final=how_final)
        return replace(
            self,
            ground_risk=risk,
            findings=worded(self.findings),
            zones=worded(self.zones),
            proof=localize(self.proof),
            sun=tuple(map(localize, self.sun)),
            camera_by_hand=tuple(map(localize, self.camera_by_hand)),
            camera_by_mission=tuple(map(localize, self.camera_by_mission)),
        )

    @property
    def readiness(self) -> Readiness:
        """The verdict on the findings."""
        return readiness_of(self.findings)

    @property
    def n_batteries(self) -> int:
        """One for each sortie."""
        return len(self.sorties)


def flight_brief(
    site_model: SiteModel,
    plan: Plan,
    findings: Sequence[Finding],
    planned_on: str,
    title: str = "",
    options: ExportOptions | None = None,
    day: FlightDay = UNKNOWN_DAY,
    sun: SunReport | None = None,
    ground_risk: GroundRiskRequest | None = None,
) -> FlightBrief:
    """The brief of a plan on its site.

    Parameters
    ----------
    findings
        Of the pre-flight check of this very plan.
    options
        Those of the export, for the return height and what happens without a radio link.
    day, sun
        For which the findings hold, and what the sun does on it.
    ground_risk
        What the pilot stated for the ground risk; None leaves it out.
    """
    options = options or ExportOptions(site=site_model)
    site = site_model.site
    rows = waypoint_rows(plan, site.origin)
    clearances = {found.place: found.value for found in findings if found.code == "leg-distance"}
    height_m, objections = return_height(plan, site_model, options)
    risk = None
    if ground_risk is not None:
        try:
            risk = assess_ground_risk(plan, site, ground_risk, height_m)
        except GroundStationError as error:
            text = say("the ground risk cannot be assessed: {}", error)
            objections = (*objections, Finding(Severity.WARNING, "ground-risk", text))
    camera = camera_steps(plan, autopilot=options.autopilot)
    stated, bound = plan.coverage, plan.coverage.reachable_upper_bound
    return FlightBrief(
        site=site.name,
        plan_title=title or plan.method,
        planned_on=planned_on,
        day=day,
        aircraft=plan.aircraft.name,
        camera=plan.camera.name,
        takeoff=_takeoff(site_model),
        sorties=tuple(_sortie(number, plan, site, rows, clearances) for number in range(1, len(plan.sorties) + 1)),
        n_photos=len(plan.viewpoints),
        max_above_ground_m=highest_above_ground_m(plan, ground_of(site)),
        low=lowest_flight(plan, site.home_enu_m, ground_of(site)),
        min_height_m=site.airspace.lowest_height_m(plan.constraints.min_height_above_ground_m),
        min_distance_m=plan.constraints.min_distance_m,
        covered_share=stated.covered / bound if bound else 0.0,
        sharp_share=None if stated.sharp is None else stated.sharp / max(1, stated.covered),
        wanted_gsd_mm=plan.constraints.wanted_gsd_mm,
        coarsest_gsd_mm=stated.coarsest_gsd_mm,
        worth=plan.present_worth,
        wind_m_s=plan.rules.wind_m_s,
        max_wind_m_s=plan.aircraft.max_wind_m_s,
        battery_reserve=plan.rules.battery_reserve,
        settle_s=plan.rules.settle_s,
        max_speed_m_s=min(plan.aircraft.max_speed_m_s, plan.rules.max_speed_m_s or math.inf),
        return_height_m=height_m,
        link_loss=options.link_loss,
        no_fly=tuple(zone.id for zone in site.airspace.no_fly),
        obstacles=tuple(obstacle.id for obstacle in site.obstacles),
        findings=by_severity(found for found in (*findings, *objections) if found.severity is not Severity.OK),
        proof=next((found.message for found in findings if found.code == "proof"), ""),
        sun=() if sun is None else tuple(flight_lines(sun)),
        camera_by_hand=camera.by_hand,
        camera_by_mission=camera.by_mission,
        zones=tuple(found for found in findings if found.code in ("zone", "zone-question", "zones-file")),
        ground_risk=risk,
    )


def _takeoff(site_model: SiteModel) -> TakeoffPlace:
    from planning.geo.enu import geodetic_from_enu
    from planning.geo.geoid import amsl_from_ellipsoid_m

    site = site_model.site
    lat, lon, height = (float(values[0]) for values in geodetic_from_enu(site.origin, [site.home_enu_m]))
    amsl_m = float(amsl_from_ellipsoid_m(lat, lon, height))
    return TakeoffPlace(lat, lon, height, amsl_m, site.home_enu_m[2] - height_at(site, *site.home_enu_m[:2]))


def _sortie(
    number: int, plan: Plan, site: Site, rows: Sequence[WaypointRow], clearances: dict[str, float | None]
) -> SortieBrief:
    sortie = plan.sorties[number - 1]
    own = [row for row in rows if row.sortie == number]
    near = [
        value
        for place, value in clearances.items()
        if value is not None and place.partition(",")[0] == f"sortie {number}"
    ]
    return SortieBrief(
        number=number,
        n_photos=len(sortie.viewpoint_ids),
        length_m=sortie.length_m,
        duration_s=sortie.duration_s,
        battery_share=sortie.duration_s / plan.aircraft.endurance_s,
        max_above_takeoff_m=max((row.height_above_takeoff_m or 0.0 for row in own), default=0.0),
        max_altitude_amsl_m=max((row.altitude_amsl_m or -math.inf for row in own), default=-math.inf),
        low=low_flight(plan, sortie, site.home_enu_m, ground_of(site)),
        smallest_clearance_m=min(near, default=None),
        takeoff_check=takeoff_check(plan, site, number),
        start_s=sortie.start_s,
        aircraft=sortie.aircraft,
    )


def return_height(
    plan: Plan, site_model: SiteModel, options: ExportOptions
) -> tuple[float | None, tuple[Finding, ...]]:
    """Return height as an export writes it, and what there is to say; no height where the plan cannot be exported."""
    site = site_model.site
    try:
        missions = missions_from_plan(plan, site.origin, site.home_enu_m)
    except GroundStationError as error:
        return None, (Finding(Severity.ERROR, "no-mission", say("no mission can be made of this plan: {}", error)),)
    height_m, findings = dji_return_height(plan, missions, options)
    return height_m, tuple(findings)
