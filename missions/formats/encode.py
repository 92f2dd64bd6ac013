"""Sorties as the contents of DJI and MAVLink files, with everything the checks of their format found on them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from missions.formats.camera_steps import camera_steps
from missions.formats.options import EncodedFiles, ExportOptions
from missions.mavlink.autopilots import Autopilot
from missions.mission.export_choices import HIGHEST_RETURN_M, LOWEST_RETURN_M, FileFormat, HeightReference
from missions.mission.model import GeoPoint, Mission
from planning.base.errors import MissionError
from planning.base.findings import Finding, Severity
from planning.base.messages import glue, say
from planning.plan import Plan
from planning.routing.rally import CLEARANCE_M, clear_height_z_m, return_height
from planning.site.free_space import unchecked_space
from planning.site.ground import ground_of
from planning.site.records import MIN_HEIGHT_ABOVE_GROUND_M, Site
from planning.site.zones.keep_out import no_fly_volumes

if TYPE_CHECKING:
    from missions.mavlink.items import Polygon


def encode_dji(plan: Plan, missions: Sequence[Mission], options: ExportOptions) -> EncodedFiles:
    """A DJI KMZ for each sortie."""
    from missions.dji.check import check_dji
    from missions.dji.wpml import parts_of_kmz
    from missions.dji.write import MAX_SPEED_M_S, DjiOptions, kmz_bytes

    created_ms = round(options.clock() * 1000.0)
    rth_height_m, findings = dji_return_height(plan, missions, options)
    planned_m_s = max(mission.speed_m_s for mission in missions)
    if planned_m_s > MAX_SPEED_M_S:
        text = say(
            "the aircraft flies at {:g} m/s, which is all that DJI's format takes, and not at the plan's {:g} m/s: the "
            "flight takes longer than planned; plan with the lower speed",
            MAX_SPEED_M_S,
            planned_m_s,
        )
        findings.append(Finding(Severity.WARNING, "speed-limited", text, "", planned_m_s, MAX_SPEED_M_S, "m/s"))
    dji_options = DjiOptions(
        rth_height_m, created_ms, options.height_reference, options.link_loss, _security_height_m(plan, options)
    )
    contents = [kmz_bytes(mission, dji_options) for mission in missions]
    if options.site is not None and options.height_reference is HeightReference.ABOVE_TAKEOFF:
        for mission in missions:
            check = takeoff_check(plan, options.site.site, mission.number)
            if check is not None:
                note = Finding(Severity.NOTE, "takeoff-check", str(check), "", check.above_takeoff_m, None, "m")
                findings += _in_sortie([note], mission, missions)
    for mission, content in zip(missions, contents, strict=True):
        findings += _in_sortie(check_dji(parts_of_kmz(content)), mission, missions)
    findings += camera_steps(plan, FileFormat.DJI_KMZ).findings()
    return EncodedFiles(tuple(contents), tuple(findings))


@dataclass(frozen=True, slots=True)
class TakeoffCheck:
    """What a pilot sees at the first waypoint, before any photo, where the aircraft took off from the planned height.

    Heights of DJI missions count from the take-off place, and nothing on board knows how high that is.

    Parameters
    ----------
    above_takeoff_m
        Of the first waypoint, at which the aircraft stops: what the remote controller shows.
    facade, is_upper_edge
        The edge of a facade that lies nearest in height; empty where the site has no panels.
    above_edge_m
        Of the first waypoint; negative below it.
    """

    sortie: int
    above_takeoff_m: float
    facade: str
    is_upper_edge: bool
    above_edge_m: float

    def __str__(self) -> str:
        if not self.facade:
            return say(
                "before any photo the aircraft stops {:.1f} m above take-off; where it does not, land: it took "
                "off from another height than planned",
                self.above_takeoff_m,
            )
        return (
            (
                say(
                    "before any photo the aircraft stops {:.1f} m above take-off, {:.1f} m above the upper edge of "
                    "facade '{}'; where it does not, land: it took off from another height than planned",
                    self.above_takeoff_m,
                    abs(self.above_edge_m),
                    self.facade,
                )
                if self.is_upper_edge
                else say(
                    "before any photo the aircraft stops {:.1f} m above take-off, {:.1f} m above the lower edge of "
                    "facade '{}'; where it does not, land: it took off from another height than planned",
                    self.above_takeoff_m,
                    abs(self.above_edge_m),
                    self.facade,
                )
            )
            if self.above_edge_m >= 0.0
            else say(
                "before any photo the aircraft stops {:.1f} m above take-off, {:.1f} m below the upper edge of "
                "facade '{}'; where it does not, land: it took off from another height than planned",
                self.above_takeoff_m,
                abs(self.above_edge_m),
                self.facade,
            )
            if self.is_upper_edge
            else say(
                "before any photo the aircraft stops {:.1f} m above take-off, {:.1f} m below the lower edge of "
                "facade '{}'; where it does not, land: it took off from another height than planned",
                self.above_takeoff_m,
                abs(self.above_edge_m),
                self.facade,
            )
        )


def takeoff_check(plan: Plan, site: Site, number: int) -> TakeoffCheck | None:
    """The check of a sortie, counted from 1; None where it has no path."""
    path, home_z_m = plan.sorties[number - 1].path_enu_m, site.home_enu_m[2]
    if len(path) < 2:
        return None
    first_z_m = path[1][2]
    edges: list[tuple[float, str, bool]] = []
    for facade in site.facades:
        heights = [corner[2] for panel in facade.panels for corner in panel.corners_enu_m]
        if heights:
            edges += [(max(heights), facade.id, True), (min(heights), facade.id, False)]
    edge_z_m, facade_id, is_upper = min(edges, key=lambda edge: abs(edge[0] - first_z_m), default=(0.0, "", False))
    return TakeoffCheck(number, first_z_m - home_z_m, facade_id, is_upper, first_z_m - edge_z_m)


def _security_height_m(plan: Plan, options: ExportOptions) -> float:
    """Height above take-off below which DJI aircraft must not fly sideways: the lowest flight, where that is higher.

    The ground that counts is the highest between home and the first waypoints.

    Without the site, home counts as standing on the ground.
    """
    lowest_m = plan.constraints.min_height_above_ground_m
    if options.site is None:
        return MIN_HEIGHT_ABOVE_GROUND_M if lowest_m is None else lowest_m
    site = options.site.site
    first = np.array(
        [site.home_enu_m, *(sortie.path_enu_m[1] for sortie in plan.sorties if len(sortie.path_enu_m) > 1)]
    )
    _, ground_z_m = ground_of(site).range_m(first.min(axis=0), first.max(axis=0))
    return site.airspace.lowest_height_m(lowest_m) + ground_z_m - site.home_enu_m[2]


def dji_return_height(plan: Plan, missions: Sequence[Mission], options: ExportOptions) -> tuple[float, list[Finding]]:
    """Height above take-off at which an aircraft that leaves its mission flies home, and what there is to say of it.

    The height is always one that DJI's remote controllers take.
    """
    asked_m = options.rth_height_m
    if asked_m is not None and not LOWEST_RETURN_M <= asked_m <= HIGHEST_RETURN_M:
        text = say(
            "the return height is none that DJI's remote controllers take: expected {:g} to {:g} m above take-off, "
            "got {:g} m",
            LOWEST_RETURN_M,
            HIGHEST_RETURN_M,
            asked_m,
        )
        limit_m = LOWEST_RETURN_M if asked_m < LOWEST_RETURN_M else HIGHEST_RETURN_M
        return limit_m, [Finding(Severity.ERROR, "return-height", text, "", asked_m, limit_m, "m")]
    wanted_m, findings = _clear_return_height(plan, missions, options)
    flown_m = min(max(wanted_m, LOWEST_RETURN_M), HIGHEST_RETURN_M)
    if flown_m < wanted_m:
        text = say(
            "the return height would have to be {:g} m above take-off: DJI's remote controllers take no more than "
            "{:g} m",
            wanted_m,
            flown_m,
        )
        findings.append(Finding(Severity.ERROR, "return-height", text, "", wanted_m, flown_m, "m"))
    elif flown_m > wanted_m:
        ceiling_m = math.inf
        if options.site is not None:
            site = options.site.site
            ceiling_m = site.airspace.max_enu_m[2] - site.home_enu_m[2]
        findings.append(_raised_return(wanted_m, flown_m, ceiling_m))
    return flown_m, findings


def _raised_return(wanted_m: float, flown_m: float, ceiling_m: float) -> Finding:
    if flown_m <= ceiling_m:
        text = say(
            "an aircraft that leaves its mission returns {:g} m above take-off, where {:g} m would do: DJI's remote "
            "controllers take no less",
            flown_m,
            wanted_m,
        )
        return Finding(Severity.NOTE, "return-height", text, "", flown_m, None, "m")
    text = say(
        "an aircraft that leaves its mission returns {:g} m above take-off, though the airspace ends at {:.1f} m: "
        "DJI's remote controllers take no less",
        flown_m,
        ceiling_m,
    )
    return Finding(Severity.WARNING, "return-height", text, "", flown_m, ceiling_m, "m")


def _clear_return_height(
    plan: Plan, missions: Sequence[Mission], options: ExportOptions
) -> tuple[float, list[Finding]]:
    """The pilot's height, else one that clears what is known, and what there is to say of it."""
    path_m = max(m.height_above_takeoff_m(w.position) for m in missions for w in m.waypoints)
    if options.site is None:
        if options.rth_height_m is not None:
            return options.rth_height_m, []
        text = say(
            "the return height clears the path only, because the site was not given; check that it clears everything"
        )
        return path_m, [Finding(Severity.WARNING, "return-height", text, "", path_m, None, "m")]
    space = unchecked_space(options.site, plan.constraints.min_distance_m)
    own = return_height(space)
    # What speaks against the height that the program chooses is said by the check of the plan.
    if options.rth_height_m is None:
        return own.above_home_m, []
    top_m = clear_height_z_m(space, 0.0) - options.site.site.home_enu_m[2]
    if options.rth_height_m > own.ceiling_above_home_m:
        text = say(
            "the return height is above the airspace: expected at most {:.1f} m above take-off, got {:g} m; "
            "{:g} m are right",
            own.ceiling_above_home_m,
            options.rth_height_m,
            own.above_home_m,
        )
        return options.rth_height_m, [
            Finding(Severity.ERROR, "return-height", text, "", options.rth_height_m, own.ceiling_above_home_m, "m")
        ]
    if options.rth_height_m < top_m:
        text = say(
            "the return height is below the highest point of the site: a returning aircraft may hit it; "
            "expected {} m or more above take-off, got {:g} m, and {} m keep {:g} m from everything",
            _metres_up(top_m),
            options.rth_height_m,
            _metres_up(top_m + CLEARANCE_M),
            CLEARANCE_M,
        )
        return options.rth_height_m, [
            Finding(Severity.ERROR, "return-height", text, "", options.rth_height_m, top_m, "m")
        ]
    return options.rth_height_m, []


def _metres_up(height_m: float) -> str:
    """A height that must be reached, rounded upwards to decimetres."""
    return f"{math.ceil(round(10.0 * height_m, 6)) / 10.0:g}"


def default_autopilot(profile_id: str) -> Autopilot:
    """Whose rules MAVLink files follow when nobody says."""
    return Autopilot.PX4 if profile_id == Autopilot.PX4 else Autopilot.ARDUPILOT


def encode_mavlink(missions: Sequence[Mission], file_format: FileFormat, options: ExportOptions) -> EncodedFiles:
    """A `.plan` or a `.waypoints` file for each sortie."""
    from missions.mavlink.check import check_items
    from missions.mavlink.fence import fence_polygons, rally_points
    from missions.mavlink.items import MavlinkFile, mission_items
    from missions.mavlink.plan_json import plan_json_bytes
    from missions.mavlink.wpl import wpl_bytes

    reference = options.height_reference
    if reference is HeightReference.ELLIPSOID:
        raise MissionError.say(
            "MAVLink has no heights above the ellipsoid; expected above-takeoff or amsl (its absolute altitude)"
        )
    contents: list[bytes] = []
    findings: list[Finding] = []
    for mission in missions:
        autopilot = options.autopilot or default_autopilot(mission.profile)
        items = mission_items(mission, autopilot, reference)
        found = list(check_items(MavlinkFile(items, mission.takeoff, autopilot), autopilot))
        if file_format is FileFormat.MAVLINK_WPL:
            contents.append(wpl_bytes(items, mission.takeoff))
            if options.site is not None and no_fly_volumes(options.site):
                text = say("this file has no fence: only a .plan file tells the vehicle the zones to keep out of")
                found.append(Finding(Severity.NOTE, "no-fence", text))
        else:
            speed_m_s = mission.speed_m_s
            fences: tuple[Polygon, ...] = ()
            rally: tuple[GeoPoint, ...] = ()
            if (model := options.site) is not None:
                rally = rally_points(model.site)
                ground_z_m = model.site.airspace.ground_z_m
                fences, on_fences = fence_polygons(mission, no_fly_volumes(model), autopilot, ground_z_m, rally)
                found += on_fences
            contents.append(plan_json_bytes(items, mission.takeoff, autopilot, speed_m_s, reference, fences, rally))
        findings += _in_sortie(found, mission, missions)
    return EncodedFiles(tuple(contents), tuple(findings))


def _in_sortie(findings: Sequence[Finding], mission: Mission, missions: Sequence[Mission]) -> list[Finding]:
    """Findings with the sortie in their place where there are several."""
    if len(missions) == 1:
        return list(findings)
    prefix = say("sortie {}", mission.number)
    return [replace(found, place=glue(prefix, ", ", found.place) if found.place else prefix) for found in findings]
