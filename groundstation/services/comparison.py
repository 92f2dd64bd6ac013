"""Use cases around comparing plans: from files or from what is open, and the table as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec

from planning.errors import InputError
from planning.insight.comparison import Comparison, compare_plans
from planning.plan import Plan
from planning.plan_file import read_plan
from planning.prepare import Prepared, prepare
from planning.progress import QUIET, Monitor
from planning.site import SiteModel
from planning.site_file import read_site


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
        raise InputError(f"expected two plans or more to compare, got {len(plans)}")
    for plan, name in zip(plans, names, strict=True):
        _check_same_place(plan, name, site_model)
    if prepared is None:
        prepared = prepare(site_model, plans[0].camera, plans[0].constraints, monitor=monitor)
    return compare_plans(site_model, prepared, plans, names, monitor)


def _check_same_place(plan: Plan, name: str, site_model: SiteModel) -> None:
    site = site_model.site
    if plan.site != site.name or (plan.origin is not None and plan.origin != site.origin):
        raise InputError(
            f"{name}: this plan was made for site '{plan.site}', the site here is '{site.name}'"
            f"{'' if plan.site != site.name else ' at another origin'}; compare plans of one site"
        )


def compare_files(plan_paths: Sequence[Path], site_path: Path, monitor: Monitor = QUIET) -> Comparison:
    """Compare plan files; they are named by their file names, or by their paths where those are alike.

    Raises
    ------
    InputError, InfeasibleError
        As `compare`, or a file cannot be read or is named twice.
    """
    for number, path in enumerate(plan_paths):
        if path.resolve() in [other.resolve() for other in plan_paths[:number]]:
            raise InputError(f"{path}: this plan is named twice; name each plan once")
    names = [path.name.removesuffix(".json").removesuffix(".plan") or str(path) for path in plan_paths]
    if len(set(names)) < len(names):
        names = [str(path) for path in plan_paths]
    site_model = read_site(site_path)
    return compare(site_model, [read_plan(path) for path in plan_paths], names, monitor=monitor)


def comparison_summary(comparison: Comparison) -> dict[str, Any]:
    """What `compare --json` prints."""
    return {
        "plans": list(comparison.names),
        "constraints": msgspec.to_builtins(comparison.constraints),
        "notes": list(comparison.notes),
        "rows": [{**msgspec.to_builtins(row), "best": list(row.best)} for row in comparison.rows],
    }
