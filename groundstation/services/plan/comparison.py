"""Use cases around comparing plans: from files or from what is open, and the table as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from groundstation.services.mission.files import missions_as_plan
from groundstation.services.project.document import PlanEntry
from groundstation.services.project.input_files import FileKind, kind_of, read_input_plan, read_input_site
from planning.aircraft.catalogue import profiles
from planning.base.errors import InputError
from planning.base.files import real_path
from planning.base.findings import Finding, Severity
from planning.base.json_file import plain_values
from planning.base.messages import about, say
from planning.base.progress import QUIET, Monitor
from planning.insight.comparison import Comparison, compare_plans
from planning.plan import Plan
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare


def compare(
    site_model: SiteModel,
    plans: Sequence[Plan],
    names: Sequence[str],
    prepared: Prepared | None = None,
    monitor: Monitor = QUIET,
) -> Comparison:
    """Compare plans of one site under the first one's constraints and camera limits.

    Parameters
    ----------
    prepared
        The site as it was prepared for the first plan; prepared anew where None.

    Raises
    ------
    InputError
        Fewer than two plans, or one of them is for another place.
    InfeasibleError
        The site cannot be prepared: home cannot be used, or no allowed viewpoint sees anything.
    """
    if len(plans) < 2:
        raise InputError(say("expected two plans or more to compare, got {}", len(plans)))
    for plan, name in zip(plans, names, strict=True):
        _check_same_place(plan, name, site_model)
    if prepared is None:
        prepared = prepare(site_model, plans[0].camera, plans[0].constraints, monitor=monitor)
    return compare_plans(site_model, prepared, plans, names, monitor)


def _check_same_place(plan: Plan, name: str, site_model: SiteModel) -> None:
    site = site_model.site
    if plan.site != site.name or (plan.origin is not None and plan.origin != site.origin):
        raise InputError(
            say(
                "this plan was made for site '{}', the site here is '{}'; compare plans of one site",
                plan.site,
                site.name,
                place=name,
            )
            if plan.site != site.name
            else say(
                "this plan was made for site '{}', the site here is '{}' at another origin; compare plans of one site",
                plan.site,
                site.name,
                place=name,
            )
        )


def compare_files(plan_paths: Sequence[Path], site_path: Path, monitor: Monitor = QUIET) -> Comparison:
    """Compare plan files; they are named by their file names, or by their paths where those are alike.

    All but the first may be mission files: each is read as a plan for the aircraft and under the constraints of the
    first, and what its reading found is among the notes.

    Raises
    ------
    InputError, MissionError, InfeasibleError
        As `compare`, or a file cannot be read or is named twice.
    """
    for number, path in enumerate(plan_paths):
        if real_path(path) in [real_path(other) for other in plan_paths[:number]]:
            raise InputError(say("this plan is named twice; name each plan once", place=path))
    names = [_name_of(path) for path in plan_paths]
    if len(set(names)) < len(names):
        names = [str(path) for path in plan_paths]
    site_model, first = read_input_site(site_path), read_input_plan(plan_paths[0])
    plans, notes = [first], []
    for path, name in zip(plan_paths[1:], names[1:], strict=True):
        if kind_of(path) is FileKind.MISSION:
            plan, found = _plan_of_mission(path, site_model, first, monitor)
            notes += [about(name, finding.message) for finding in found if finding.severity is not Severity.OK]
        else:
            plan = read_input_plan(path)
        plans.append(plan)
    comparison = compare(site_model, plans, names, monitor=monitor)
    return replace(comparison, notes=(*comparison.notes, *notes))


def _name_of(path: Path) -> str:
    """What a file is called in the table: a mission keeps its ending, which tells it from the plan it was made of."""
    return path.name.removesuffix(".json").removesuffix(".plan") or str(path) if path.suffix == ".json" else path.name


def _plan_of_mission(
    path: Path, site_model: SiteModel, first: Plan, monitor: Monitor
) -> tuple[Plan, tuple[Finding, ...]]:
    if first.profile not in profiles():
        raise InputError(
            say(
                "expected a plan file, found a mission file, and the first plan does not name an aircraft of the "
                "catalogue to read it for; make a plan of it first ('import' with --profile)",
                place=path,
            )
        )
    return missions_as_plan((path,), site_model, first.profile, first.constraints, monitor)


def distinct_titles(entries: Sequence[PlanEntry]) -> tuple[str, ...]:
    """Titles of plans; alike ones with their method behind, and with a number where that is alike too."""
    names = [entry.title for entry in entries]
    names = [
        f"{name}, {entry.plan.method}" if names.count(name) > 1 else name
        for name, entry in zip(names, entries, strict=True)
    ]
    return tuple(
        f"{name} ({names[: position + 1].count(name)})" if names.count(name) > 1 else name
        for position, name in enumerate(names)
    )


def marked_as_best(texts: Sequence[str], best: Sequence[int]) -> tuple[bool, ...]:
    """Which cells of a row get the star: all that read as the best value does; none where all read alike.

    Parameters
    ----------
    texts
        The values as they are shown, one a plan.
    best
        Numbers of the plans with the better value, as in `planning.insight.comparison.Row`.
    """
    best_texts = {texts[number] for number in best}
    return tuple(text in best_texts and len(set(texts)) > 1 for text in texts)


def comparison_summary(comparison: Comparison) -> dict[str, Any]:
    """What `compare --json` prints."""
    return {
        "plans": list(comparison.names),
        "constraints": plain_values(comparison.constraints),
        "notes": list(comparison.notes),
        "rows": [{**plain_values(row), "best": list(row.best)} for row in comparison.rows],
    }
