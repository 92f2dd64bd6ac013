"""Plans that are open in the window to mission files and back: everything but the reading and writing of plan files."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.mission.readiness import errors_of
from groundstation.services.project.input_files import FileKind, expecting
from groundstation.services.project.project_file import check_not_index
from missions.formats.encode import default_autopilot, dji_return_height
from missions.formats.options import DEFAULT_OPTIONS, EncodedFiles, ExportOptions
from missions.formats.registry import encode, read_missions, sortie_path, write_files
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import FileFormat
from missions.mission.model import GeoPoint, ReadMission, distance_m
from missions.mission.to_plan import viewpoints_and_sorties
from planning.aircraft.catalogue import profile
from planning.base.errors import GroundStationError, InputError, OperationCancelled
from planning.base.files import real_path
from planning.base.findings import Finding, Severity
from planning.base.messages import about, say
from planning.base.progress import QUIET, Monitor
from planning.checks.case import Case
from planning.coverage.evaluate import coverage
from planning.geo.frames import Origin, Vec3
from planning.geo.geoid import undulation_m
from planning.geo.mesh import empty_mesh
from planning.parameters import DEFAULT_PROFILE, CameraSettings, Constraints, FlightRules
from planning.plan import Coverage, Plan
from planning.planner import resplit_sorties
from planning.site.file import is_planned_on, site_sha256
from planning.site.records import MAX_DISTANCE_M, Airspace, Site, SiteModel
from planning.viewpoints.prepare import prepare

MAVLINK_FORMATS = (FileFormat.MAVLINK_PLAN, FileFormat.MAVLINK_WPL)

PROVED_FORMATS = (FileFormat.DJI_KMZ, *MAVLINK_FORMATS)
"""That the verifier of proofs reads."""

BARE_MARGIN_M = 40.0
FLOOR_M = 2.0
"""Of the airspace of a site made for missions alone, above home; as for imported buildings."""

NOT_READY = "not-ready"
"""Code of the finding on a plan that breaks a rule."""

IMPORTED = "imported"
"""Method written into plans that come from mission files."""


@dataclass(frozen=True, slots=True, eq=False)
class PreparedExport:
    """Mission files that are ready to be written, or the reason why there are none.

    Parameters
    ----------
    encoded
        None where the plan cannot be exported so; `refusal` says why then.
    findings
        What the pilot should know first; those of the files come last.
    flown
        The plan of the files: the views may be shared out anew.
    return_height_m
        Above take-off, as the files say it; None where they do not.
    """

    encoded: EncodedFiles | None
    findings: tuple[Finding, ...]
    refusal: str = ""
    flown: Plan | None = None
    return_height_m: float | None = None

    @property
    def n_files(self) -> int:
        """Number of files that would be written."""
        return 0 if self.encoded is None else len(self.encoded.contents)

    @property
    def can_be_written(self) -> bool:
        """Whether an aircraft would take the files."""
        errors = any(finding.severity is Severity.ERROR for finding in self.findings)
        return self.encoded is not None and not errors

    @property
    def is_ready_to_fly(self) -> bool:
        """Whether the plan breaks no rule of the pre-flight check."""
        return not_ready(self.findings) is None


def prepare_export(
    plan: Plan, site_model: SiteModel, file_format: str, options: ExportOptions = DEFAULT_OPTIONS
) -> PreparedExport:
    """Mission files of a plan in memory, with everything that is to be said before they are written.

    Nothing is raised for what the user can put right: the refusal is part of the result.
    """
    try:
        findings = list(readiness(plan, site_model))
        if file_format in MAVLINK_FORMATS:
            plan, split_to_fit = within_item_limit(plan, site_model, options)
            findings += split_to_fit
        site, with_site = site_model.site, replace(options, site=site_model)
        encoded = encode(plan, site.origin, site.home_enu_m, file_format, with_site)
        return_height_m = stated_return_m(plan, site.origin, site.home_enu_m, file_format, with_site)
    except GroundStationError as error:
        return PreparedExport(None, (), str(error))
    return PreparedExport(encoded, (*findings, *encoded.findings), "", plan, return_height_m)


def stated_return_m(
    plan: Plan, origin: Origin | None, home_enu_m: Vec3 | None, file_format: str, options: ExportOptions
) -> float | None:
    """Height above take-off of a return to home as mission files say it; None where they do not."""
    if file_format != FileFormat.DJI_KMZ:
        return None
    return dji_return_height(plan, missions_from_plan(plan, origin, home_enu_m), options)[0]


def export_paths(prepared: PreparedExport, path: Path) -> tuple[Path, ...]:
    """The files that writing to `path` makes."""
    return tuple(sortie_path(path, number) for number in range(1, prepared.n_files + 1))


def write_export(prepared: PreparedExport, path: Path, beside: Mapping[Path, bytes] | None = None) -> tuple[Path, ...]:
    """Write prepared mission files and what goes beside them, all or none; paths of the missions.

    Raises
    ------
    InputError, MissionError
        A file cannot be written, or an aircraft would refuse the mission.
    """
    if prepared.encoded is None:
        raise ValueError(f"nothing to write: {prepared.refusal}")
    check_not_index(path)
    return write_files(prepared.encoded, path, beside)


def write_proved_export(
    prepared: PreparedExport, site_model: SiteModel, file_format: str, path: Path, run: Callable[..., Any]
) -> tuple[tuple[Path, ...], Finding | None]:
    """Write prepared mission files with their proof: paths of the missions, and what the verifier says of them.

    The finding is None where the verifier does not read the format. Missions fly without a proof: where none can be
    made, they are written alone, and the finding says so.

    Parameters
    ----------
    run
        Calls a function in a process of its own, as `JobContext.run_in_process` does: the proof takes seconds.

    Raises
    ------
    InputError, MissionError
        As `write_export`.
    OperationCancelled
        From `run`, before anything is written.
    """
    from groundstation.services.mission.proof import judged, open_mission_proof

    if prepared.flown is None or file_format not in PROVED_FORMATS:
        return write_export(prepared, path), None
    try:
        proof = run(open_mission_proof, prepared.flown, site_model, path, prepared.return_height_m)
    except InputError as error:
        text = say("the mission is written without its proof: {}", str(error))
        return write_export(prepared, path), Finding(Severity.WARNING, "proof", text)
    paths = write_export(prepared, path, proof.files)
    try:
        return paths, run(judged, proof, paths)
    except OperationCancelled:
        text = say("the missions and their proof are written; the check of the proof was cancelled")
        return paths, Finding(Severity.NOTE, "proof", text)


def in_order_of_sorties(paths: Sequence[Path]) -> tuple[Path, ...]:
    """Mission files by name, those of one export as its sorties: `roof.plan`, `roof-2.plan`, `roof-10.plan`.

    File dialogs give them in another order (`roof-10.plan` first), and the order is that of the flight.
    """

    def key(path: Path) -> tuple[Path, str, int]:
        name, dash, number = path.stem.rpartition("-")
        is_further = bool(dash) and number.isascii() and number.isdigit()
        return (path.parent, name, int(number)) if is_further else (path.parent, path.stem, 1)

    return tuple(sorted(paths, key=key))


def readiness(plan: Plan, site_model: SiteModel) -> Iterator[Finding]:
    """What the pilot must know of a plan before it flies on this site."""
    if not is_planned_on(plan.site_sha256, site_model):
        text = say(
            "the site file of '{}' has changed since this plan was made; what the mission takes from it "
            "(return height, fences) is as it is now",
            site_model.site.name,
        )
        yield Finding(Severity.WARNING, "site-changed", text)
    errors = errors_of(Case.of(plan, site_model))
    if errors:
        first, n_more = about(errors[0].place, errors[0].message), len(errors) - 1
        text = say("NOT ready to fly: {}", first)
        if n_more:
            text = say("NOT ready to fly: {}; and {} more", first, n_more)
        yield Finding(Severity.WARNING, NOT_READY, text, "", float(len(errors)), 0.0, "findings")


def not_ready(findings: Sequence[Finding]) -> Finding | None:
    """What says among them that the plan is not ready to fly; None where it is."""
    return next((found for found in findings if found.code == NOT_READY), None)


def within_item_limit(plan: Plan, site_model: SiteModel, options: ExportOptions) -> tuple[Plan, tuple[Finding, ...]]:
    """The plan, its views shared out anew where a sortie has more than the autopilot keeps."""
    from missions.mavlink.items import photos_that_fit

    autopilot = options.autopilot or default_autopilot(plan.profile)
    limit = photos_that_fit(autopilot)
    longest = max((len(sortie.viewpoint_ids) for sortie in plan.sorties), default=0)
    if longest <= limit:
        return plan, ()
    anew = _shared_out(plan, site_model, limit)
    text = say(
        "{} keeps the items of about {} photos, but a sortie of this plan has {}; the same views were "
        "shared out among {} sorties for these files",
        autopilot,
        limit,
        longest,
        len(anew.sorties),
    )
    return anew, (Finding(Severity.WARNING, "item-limit", text, "", float(longest), float(limit), "photos"),)


@lru_cache(maxsize=2)
def _shared_out(plan: Plan, site_model: SiteModel, max_views: int) -> Plan:
    """Sharing out takes seconds and ends by the clock: kept, so that all files of one plan fly the same sorties."""
    return resplit_sorties(plan, site_model, max_views)


def read_mission_files(paths: Sequence[Path], *, strict: bool = False) -> tuple[ReadMission, ...]:
    """The sorties of mission files of one flight.

    Parameters
    ----------
    strict
        Refuse what an aircraft would refuse.

    Raises
    ------
    InputError, MissionError
        A file cannot be read, or is given twice.
    """
    resolved = [real_path(path) for path in paths]
    for number, path in enumerate(paths):
        if resolved[number] in resolved[:number]:
            raise InputError(say("this mission file is named twice; name the file of each sortie once", place=path))
    return tuple(mission for path in paths for mission in _read_missions(path, strict))


def _read_missions(path: Path, strict: bool) -> tuple[ReadMission, ...]:
    with expecting(FileKind.MISSION, path):
        return read_missions(path, strict=strict)


def bare_site(missions: Sequence[ReadMission]) -> tuple[SiteModel, tuple[Finding, ...]]:
    """A site of missions alone, without building or panels, to look at where they fly.

    Home is where the first mission takes off as its file says, else below its first waypoint. The airspace reaches
    `BARE_MARGIN_M` further than the missions. Where the file does not say how high the take-off lies, heights above
    take-off count from sea level, and other heights from just below the lowest of them; a finding tells.

    Raises
    ------
    InputError
        The missions are too far apart for one site.
    """
    first = missions[0]
    start, findings = first.waypoints[0], []
    heights_m = [w.height_ellipsoid_m for m in missions for w in m.waypoints if w.height_ellipsoid_m is not None]
    takeoff = first.takeoff
    if (
        takeoff is not None
        and distance_m(takeoff.lat_deg, takeoff.lon_deg, start.lat_deg, start.lon_deg) < MAX_DISTANCE_M
    ):
        home = takeoff
    else:
        geoid_m = float(undulation_m(start.lat_deg, start.lon_deg))
        home = GeoPoint(start.lat_deg, start.lon_deg, min(heights_m) - FLOOR_M if heights_m else geoid_m)
        text = say(
            "its file does not say where it takes off, so home is below its first waypoint, at an assumed "
            "height; what depends on that height is only to look at"
        )
        if takeoff is not None:
            away_km = distance_m(takeoff.lat_deg, takeoff.lon_deg, start.lat_deg, start.lon_deg) / 1000.0
            text = say(
                "its file says that it takes off {:.0f} km from its first waypoint, which cannot be; home is below "
                "that waypoint, at an assumed height: correct home in the file, or only look at what depends on it",
                away_km,
            )
        findings.append(Finding(Severity.WARNING, "bare-site", text, first.name))
    origin = Origin(round(home.lat_deg, 9), round(home.lon_deg, 9), round(home.height_ellipsoid_m, 3))
    here = (0.0, 0.0, 0.0)
    parts = viewpoints_and_sorties(missions, origin, here)
    path = np.array([point for sortie in parts.sorties for point in sortie.path_enu_m])
    low, high = path.min(axis=0) - BARE_MARGIN_M, path.max(axis=0) + BARE_MARGIN_M
    low[2] = min(FLOOR_M, float(path[:, 2].min()))
    box = [(round(float(x), 3), round(float(y), 3), round(float(z), 3)) for x, y, z in (low, high)]
    site = Site(
        name=first.path.stem,
        origin=origin,
        facades=(),
        airspace=Airspace(box[0], box[1], 0.0),
        home_enu_m=here,
        is_bare=True,
    )
    return SiteModel(site, empty_mesh(), (), site_sha256(site)), tuple(findings)


def missions_as_plan(
    paths: Sequence[Path],
    site_model: SiteModel,
    profile_id: str = DEFAULT_PROFILE,
    constraints: Constraints = Constraints(),
    monitor: Monitor = QUIET,
    *,
    strict: bool = False,
) -> tuple[Plan, tuple[Finding, ...]]:
    """Mission files of one flight as a plan, with the coverage that it has on this site.

    Parameters
    ----------
    strict
        Refuse missions that an aircraft would refuse.

    Raises
    ------
    InputError, MissionError
        A file cannot be read, is given twice, or belongs to another place.
    InfeasibleError
        Nothing on this site can be covered under the constraints.
    """
    monitor.report(say("reading the mission"), 0, 1)
    return plan_of_missions(read_mission_files(paths, strict=strict), site_model, profile_id, constraints, monitor)


def plan_of_missions(
    missions: Sequence[ReadMission],
    site_model: SiteModel,
    profile_id: str = DEFAULT_PROFILE,
    constraints: Constraints = Constraints(),
    monitor: Monitor = QUIET,
) -> tuple[Plan, tuple[Finding, ...]]:
    """Missions that were read as a plan; on a site without panels there is nothing that they could cover.

    Raises
    ------
    InputError
        They belong to another place.
    InfeasibleError
        Nothing on this site can be covered under the constraints.
    """
    chosen, rules = profile(profile_id), FlightRules()
    settings, on_camera = _camera_settings(missions)
    site = site_model.site
    parts = viewpoints_and_sorties(missions, site.origin, site.home_enu_m, rules, chosen.aircraft)
    speeds_m_s = [mission.speed_m_s for mission in missions if mission.speed_m_s is not None]
    if speeds_m_s and len(speeds_m_s) == len(missions):
        rules = replace(rules, max_speed_m_s=max(speeds_m_s))
    plan = Plan(
        site=site.name,
        site_sha256=site_model.sha256,
        method=IMPORTED,
        seed=0,
        camera=chosen.camera,
        aircraft=chosen.aircraft,
        constraints=replace(constraints, occlusion="off"),
        viewpoints=parts.viewpoints,
        sorties=parts.sorties,
        coverage=Coverage(0, 0, 0),
        origin=site.origin,
        home_enu_m=site.home_enu_m,
        rules=rules,
        profile=chosen.id,
        camera_settings=settings,
        camera_controls=chosen.controls,
    )
    findings = (*parts.findings, *on_camera)
    if site.n_panels == 0:
        return plan, findings
    prepared = prepare(site_model, chosen.camera, constraints, monitor=monitor)
    found = coverage(prepared.problem.model, parts.viewpoints, prepared.problem.reachability)
    return (
        replace(plan, constraints=prepared.constraints, coverage=found, effects=prepared.effects),
        findings,
    )


def _camera_settings(missions: Sequence[ReadMission]) -> tuple[CameraSettings, tuple[Finding, ...]]:
    """What missions tell the camera, over the usual settings; of the first, where they differ, which is told."""
    cameras = {mission.camera: None for mission in missions}
    if not cameras:
        return CameraSettings(), ()
    first = next(iter(cameras))
    if len(cameras) == 1:
        return first.over(CameraSettings()), ()
    text = say("its missions set the camera differently; what the first says is taken for all")
    return first.over(CameraSettings()), (Finding(Severity.WARNING, "camera", text),)
