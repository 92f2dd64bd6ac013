"""Use cases around mission files: export a plan, import a mission and see what it covers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from missions.encode import DEFAULT_OPTIONS, ExportOptions, default_autopilot, encode
from missions.formats import read_missions, write_files
from missions.model import FileFormat
from missions.to_plan import viewpoints_and_sorties
from planning.catalogue import DEFAULT_PROFILE, profile
from planning.evaluate import coverage
from planning.findings import Finding, Severity
from planning.plan import Constraints, FlightRules, Plan
from planning.plan_file import read_plan, write_plan
from planning.planner import share_out_anew
from planning.prepare import prepare
from planning.progress import QUIET, Monitor
from planning.site import SiteModel
from planning.site_file import read_site

MAVLINK_FORMATS = (FileFormat.MAVLINK_PLAN, FileFormat.MAVLINK_WPL)

IMPORTED = "imported"
"""Method written into plans that come from mission files."""


def find_site(plan: Plan, plan_path: Path, site_path: Path | None = None) -> SiteModel | None:
    """The site that a plan was made for: the one named, or the one beside the plan with the plan's checksum.

    Raises
    ------
    InputError
        The site named cannot be read.
    """
    if site_path is not None:
        return read_site(site_path)
    if not plan.site_sha256:
        return None
    import hashlib

    for candidate in sorted(plan_path.parent.glob("*.json")):
        if candidate != plan_path and hashlib.sha256(candidate.read_bytes()).hexdigest() == plan.site_sha256:
            return read_site(candidate)
    return None


def export_plan(
    plan_path: Path,
    file_format: FileFormat,
    out: Path,
    site_path: Path | None = None,
    options: ExportOptions = DEFAULT_OPTIONS,
) -> tuple[tuple[Path, ...], tuple[Finding, ...]]:
    """Write a plan as mission files (see `missions.formats.export`): the files, and what their checks found.

    Plans that do not say where their site lies take it from the site file.
    """
    plan = read_plan(plan_path)
    site_model = find_site(plan, plan_path, site_path)
    origin, home = plan.origin, plan.home_enu_m
    if site_model is not None:
        origin = site_model.site.origin if origin is None else origin
        home = site_model.site.home_enu_m if home is None else home
    elif home is None and plan.sorties and plan.sorties[0].path_enu_m:
        home = plan.sorties[0].path_enu_m[0]
    shared_out: tuple[Finding, ...] = ()
    if file_format in MAVLINK_FORMATS and site_model is not None:
        plan, shared_out = _within_item_limit(plan, site_model, options)
    encoded = encode(plan, origin, home, file_format, replace(options, site=site_model))
    return write_files(encoded, out), (*shared_out, *encoded.findings)


def _within_item_limit(plan: Plan, site_model: SiteModel, options: ExportOptions) -> tuple[Plan, tuple[Finding, ...]]:
    """The plan, its views shared out anew where a sortie has more than the autopilot keeps."""
    from missions.mavlink.items import photos_that_fit

    autopilot = options.autopilot or default_autopilot(plan.profile)
    limit = photos_that_fit(autopilot)
    longest = max((len(sortie.viewpoint_ids) for sortie in plan.sorties), default=0)
    if longest <= limit:
        return plan, ()
    anew = share_out_anew(plan, site_model, limit)
    text = (
        f"{autopilot} keeps the items of about {limit} photos, but a sortie of this plan has {longest}; the same views "
        f"were shared out among {len(anew.sorties)} sorties for these files"
    )
    return anew, (Finding(Severity.WARNING, "item-limit", text, "", float(longest), float(limit), "photos"),)


def import_missions(
    paths: Sequence[Path],
    site_path: Path,
    out: Path,
    profile_id: str = DEFAULT_PROFILE,
    constraints: Constraints = Constraints(),
    monitor: Monitor = QUIET,
) -> tuple[Plan, tuple[Finding, ...]]:
    """Read mission files of one flight as a plan, evaluate its coverage, and write it.

    Raises
    ------
    InputError, MissionError
        A file cannot be read, or belongs to another place.
    """
    site_model = read_site(site_path)
    chosen = profile(profile_id)
    rules = FlightRules()
    read = [mission for path in paths for mission in read_missions(path)]
    parts = viewpoints_and_sorties(read, site_model.site.origin, site_model.site.home_enu_m, rules)
    prepared = prepare(site_model, chosen.camera, constraints, monitor=monitor)
    plan = Plan(
        site=site_model.site.name,
        site_sha256=site_model.sha256,
        method=IMPORTED,
        seed=0,
        camera=chosen.camera,
        aircraft=chosen.aircraft,
        constraints=prepared.constraints,
        viewpoints=parts.viewpoints,
        sorties=parts.sorties,
        coverage=coverage(prepared.problem.model, parts.viewpoints, prepared.problem.reachability),
        origin=site_model.site.origin,
        home_enu_m=site_model.site.home_enu_m,
        rules=rules,
        effects=prepared.effects,
        profile=profile_id,
    )
    write_plan(out, plan)
    return plan, parts.findings
