"""Use cases around mission files: export a plan, import a mission and see what it covers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from groundstation.services.mission.files import (
    MAVLINK_FORMATS,
    PROVED_FORMATS,
    bare_site,
    missions_as_plan,
    plan_of_missions,
    read_mission_files,
    readiness,
    stated_return_m,
    within_item_limit,
)
from groundstation.services.mission.proof import mission_proof
from groundstation.services.project.input_files import read_input_plan, read_input_site
from groundstation.services.project.project_file import SITE_FOLDER, check_not_index
from missions.formats.options import DEFAULT_OPTIONS, ExportOptions
from missions.formats.registry import encode, mission_format, sortie_path, write_files
from planning.base.errors import InputError
from planning.base.files import check_ending, real_path, sha256_of_file
from planning.base.findings import Finding, Severity
from planning.base.json_file import JSON_FILE, check_output, is_device
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.parameters import DEFAULT_PROFILE, Constraints
from planning.plan import Plan, write_plan
from planning.site.file import read_site, write_site
from planning.site.records import SiteModel

__all__ = ["export_plan", "find_site", "import_missions"]


def find_site(plan: Plan, plan_path: Path, site_path: Path | None = None) -> SiteModel | None:
    """The site that a plan was made for: the one named, or one beside it or in its project with the plan's checksum.

    Raises
    ------
    InputError
        The site cannot be read, or the one named lies at another place than the plan.
    """
    if site_path is not None:
        site_model = read_input_site(site_path)
        if plan.origin is not None and plan.origin != site_model.site.origin:
            raise InputError(
                say(
                    "the origin of '{}' is not the one of the plan, which is for '{}'; name the site file that the "
                    "plan was made for",
                    site_model.site.name,
                    plan.site,
                    place=site_path,
                )
            )
        return site_model
    site_path_found = _site_beside(plan, plan_path)
    return None if site_path_found is None else read_site(site_path_found)


def _site_beside(plan: Plan, plan_path: Path) -> Path | None:
    if not plan.site_sha256:
        return None
    folder = real_path(plan_path).parent
    candidates = [*sorted(folder.glob("*.json")), *sorted((folder.parent / SITE_FOLDER).glob("*.json"))]
    return next((path for path in candidates if _is_site_of(path, plan)), None)


def _is_site_of(path: Path, plan: Plan) -> bool:
    """Whether a file beside a plan is its site; what cannot be read is not."""
    try:
        return sha256_of_file(path, JSON_FILE) == plan.site_sha256
    except InputError:
        return False


def export_plan(
    plan_path: Path,
    file_format: str,
    out: Path,
    site_path: Path | None = None,
    options: ExportOptions = DEFAULT_OPTIONS,
) -> tuple[tuple[Path, ...], tuple[Finding, ...]]:
    """Write a plan as mission files: the files, and what their checks found.

    Plans that do not say where their site lies take it from the site file. A plan that is not ready to fly on its site
    is written all the same, and a warning says why it is not. Where the site is known, the proof goes along, with the
    verifier.

    Raises
    ------
    InputError, MissionError
        A file cannot be read or written, the site is another one, or an aircraft would refuse the mission.
    """
    plan = planned = read_input_plan(plan_path)
    site_path = _site_beside(plan, plan_path) if site_path is None else site_path
    sources = [path for path in (plan_path, site_path) if path is not None]
    check_not_index(out)
    check_output(out, sources)
    check_ending(out, mission_format(file_format).endings)
    site_model = find_site(plan, plan_path, site_path)
    findings = list(_name_findings(out, file_format))
    origin, home = plan.origin, plan.home_enu_m
    if site_model is not None:
        origin = site_model.site.origin if origin is None else origin
        home = site_model.site.home_enu_m if home is None else home
        findings += readiness(plan, site_model)
    elif home is None and plan.sorties and plan.sorties[0].path_enu_m:
        home = plan.sorties[0].path_enu_m[0]
    if file_format in MAVLINK_FORMATS and site_model is not None:
        plan, split_to_fit = within_item_limit(plan, site_model, options)
        findings += split_to_fit
    with_site = replace(options, site=site_model)
    encoded = encode(plan, origin, home, file_format, with_site)
    for number in range(2, len(encoded.contents) + 1):
        check_output(sortie_path(out, number), sources)
    proof = None
    is_proved = file_format in PROVED_FORMATS and not is_device(out)
    if site_path is not None and site_model is not None and is_proved:
        return_height_m = stated_return_m(plan, origin, home, file_format, with_site)
        flown = None if plan == planned else plan
        proof = mission_proof(plan_path, flown, site_path, site_model, out, return_height_m)
    paths = write_files(encoded, out, None if proof is None else proof.files)
    findings += encoded.findings
    if proof is not None:
        findings.append(proof.judged(paths))
    return paths, tuple(findings)


def _name_findings(out: Path, file_format: str) -> Iterator[Finding]:
    suffixes = mission_format(file_format).endings
    if out.suffix.lower() not in suffixes:
        text = say(
            "{}: other programs look for {} files with names that end in {}",
            out.name,
            file_format,
            " or ".join(suffixes),
        )
        yield Finding(Severity.WARNING, "file-name", text)


def import_missions(
    paths: Sequence[Path],
    site_path: Path | None,
    out: Path,
    profile_id: str = DEFAULT_PROFILE,
    constraints: Constraints = Constraints(),
    monitor: Monitor = QUIET,
    *,
    strict: bool = False,
) -> tuple[Plan, tuple[Finding, ...], Path]:
    """Read mission files of one flight as a plan, evaluate its coverage, and write it; returns its site file, too.

    Parameters
    ----------
    site_path
        None to make a bare site of the missions, which is written beside the plan.
    strict
        Refuse missions that an aircraft would refuse.

    Raises
    ------
    InputError, MissionError
        A file cannot be read, is given twice, or belongs to another place; or plan or site cannot be written.
    """
    check_not_index(out)
    if site_path is not None:
        check_output(out, [*paths, site_path])
        plan, findings = missions_as_plan(
            paths, read_input_site(site_path), profile_id, constraints, monitor, strict=strict
        )
        write_plan(out, plan)
        return plan, findings, site_path
    site_out = out.with_name(out.name.removesuffix(".json").removesuffix(".plan") + ".site.json")
    check_output(out, [*paths, site_out])
    check_output(site_out, [*paths, out])
    if site_out.exists() and not _is_bare(site_out):
        raise InputError(
            say(
                "this is a site of its own, which the mission's bare one would replace; name it with --site, or "
                "the plan otherwise",
                place=site_out,
            )
        )
    monitor.report(say("reading the mission"), 0, 1)
    read = read_mission_files(paths, strict=strict)
    model, on_site = bare_site(read)
    plan, findings = plan_of_missions(read, model, profile_id, constraints, monitor)
    write_site(site_out, model.site)
    write_plan(out, plan)
    return plan, (*on_site, *findings), site_out


def _is_bare(path: Path) -> bool:
    """Whether a site file holds a place alone, with nothing added."""
    site = read_input_site(path).site
    return site.is_bare and site.n_panels == 0 and site.building_mesh is None and not site.obstacles
