"""Use cases of weighing plans and tours against time: which files are compared, and with what."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from groundstation.services.mission.export import find_site
from groundstation.services.project.input_files import (
    TSPLIB_SUFFIXES,
    FileKind,
    expecting,
    kind_of,
    read_input_plan,
    read_input_site,
)
from planning.base.errors import InfeasibleError, InputError
from planning.base.messages import say
from planning.base.parallel_map import sweep
from planning.base.progress import QUIET, Monitor
from planning.parameters import DEFAULT_VIEWS
from planning.plan import Plan
from planning.request import PlanRequest
from planning.routing.methods import TourMethod
from planning.site.records import SiteModel
from planning.tradeoff.plans import (
    FailedRun,
    PlanReport,
    PlanRun,
    Variants,
    common_steps,
    load_kernels,
    plan_panels,
    plan_report,
    plan_rows,
    plan_title,
    run_plan,
    settings,
)
from planning.tradeoff.runner import COVERAGE_AXIS, TOUR_AXIS, ComparisonFiles, NumberedRuns, Subject, compare
from planning.tradeoff.tours import (
    TOUR_METHODS,
    TourCase,
    TourReport,
    plan_case,
    run_tours,
    tour_panel,
    tour_report,
    tour_rows,
    tour_title,
    tsplib_case,
)


@dataclass(frozen=True, slots=True)
class PlanRuns:
    """What `tradeoff plan` found: a report a site, and runs that could not be done."""

    reports: tuple[PlanReport, ...]
    failed: tuple[FailedRun, ...]


PLANS: Subject[PlanRuns] = Subject(
    "plan",
    COVERAGE_AXIS,
    rows=lambda found: [row for report in found.reports for row in plan_rows(report)],
    title=lambda found: "\n".join(plan_title(report) for report in found.reports),
    panels=lambda found: [panel for report in found.reports for panel in plan_panels(report)],
)

TOURS: Subject[tuple[TourReport, ...]] = Subject(
    "route",
    TOUR_AXIS,
    rows=lambda reports: [row for report in reports for row in tour_rows(report)],
    title=lambda reports: "\n".join(tour_title(report) for report in reports),
    panels=lambda reports: [tour_panel(report) for report in reports],
)


def plan_tradeoff(
    site_paths: Sequence[Path],
    base: PlanRequest,
    variants: Variants,
    out: Path,
    *,
    n_seeds: int = 1,
    n_processes: int = 1,
    address: str | None = None,
    monitor: Monitor = QUIET,
) -> ComparisonFiles[PlanRuns]:
    """Plan every site with the base request and every variant; write `tradeoff-plan.csv` and `.png` into `out`.

    Without any goal in `base` every run gets the same number of views, `DEFAULT_VIEWS`; views are chosen for sections.
    With one process and no cluster the runs follow each other, so that times can be compared.

    Raises
    ------
    InputError
        A site cannot be read, two sites have the same name, the folder cannot be made, no cluster answers.
    InfeasibleError
        No run with the sections asked for could be done on a site.
    """
    if all(goal is None for goal in (base.n_views, base.share, base.n_batteries, base.least_gain_db)):
        base = replace(base, n_views=DEFAULT_VIEWS)
    # Coverage is what is compared; what flights are worth is another question (`groundstation.services.worth`).
    base = replace(base, greedy=replace(base.greedy, objective="sections"))
    sites = [_timed_site(path) for path in site_paths]
    _check_names([model.site.name for model, _ in sites])
    requests = settings(base, variants, n_seeds)
    steps = common_steps(requests)
    arguments = [(model, request, steps, read_s) for model, read_s in sites for request in requests]

    def run(_folder: Path) -> PlanRuns:
        is_timed = n_processes == 1 and address is None
        progress, plan_once = monitor, run_plan
        if is_timed:
            monitor.report(say("loading kernels"), 0, 1)
            load_kernels(requests)
            progress = NumberedRuns(monitor)
            plan_once = partial(run_plan, monitor=progress)
        results = sweep(plan_once, arguments, n_processes=n_processes, address=address, monitor=progress)
        failed = tuple(result for result in results if isinstance(result, FailedRun))
        reports = []
        for model, _ in sites:
            name = model.site.name
            done = [result for result in results if isinstance(result, PlanRun) and result.site == name]
            if all(run.request.constraints.section_step_deg != steps[0] for run in done):
                raise InfeasibleError(next(run.message for run in failed if run.site == name))
            reports.append(plan_report(done, base))
        return PlanRuns(tuple(reports), failed)

    return compare(PLANS, out, run)


def route_tradeoff(
    paths: Sequence[Path],
    seconds: float,
    out: Path,
    *,
    methods: Sequence[TourMethod] = TOUR_METHODS,
    seed: int = 0,
    monitor: Monitor = QUIET,
) -> ComparisonFiles[tuple[TourReport, ...]]:
    """Run the routing methods on TSPLIB files and plans; write `tradeoff-route.csv` and `.png` into `out`.

    `paths` are TSPLIB files, plan files and site files in any order. A plan's site is the one given that it was made
    for; with none given, the one beside the plan.

    Raises
    ------
    InputError
        A file cannot be read, a plan's site is missing, the folder cannot be made.
    """
    tsplib_paths = [path for path in paths if path.suffix.lower() in TSPLIB_SUFFIXES]
    plans = _plans_with_sites([path for path in paths if path not in tsplib_paths])

    def run(_folder: Path) -> tuple[TourReport, ...]:
        cases = [_tsplib_case(path, monitor) for path in tsplib_paths]
        cases += [plan_case(plan, model, monitor) for plan, model in plans]
        _check_names([case.name for case in cases])
        return tuple(tour_report(case, run_tours(case, seconds, methods, seed, monitor)) for case in cases)

    return compare(TOURS, out, run)


def _timed_site(path: Path) -> tuple[SiteModel, float]:
    started = time.perf_counter()
    model = read_input_site(path)
    return model, time.perf_counter() - started


def _tsplib_case(path: Path, monitor: Monitor) -> TourCase:
    with expecting(FileKind.TSPLIB, path):
        return tsplib_case(path, monitor)


def _check_names(names: Sequence[str]) -> None:
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(
            say("two of the files are called '{}'; their names must differ to tell the results apart", twice)
        )


def _plans_with_sites(paths: Sequence[Path]) -> list[tuple[Plan, SiteModel]]:
    """Plans among JSON files, each with its site."""
    sites, plans = [], []
    for path in paths:
        if kind_of(path) is FileKind.SITE:
            sites.append(read_input_site(path))
        else:
            plans.append((path, read_input_plan(path)))
    if sites and not plans:
        raise InputError(say("a site alone has no viewpoints to fly to; name a plan as well", place=paths[0]))
    return [(plan, _site_for(plan, path, sites)) for path, plan in plans]


def _site_for(plan: Plan, plan_path: Path, sites: Sequence[SiteModel]) -> SiteModel:
    for wanted in (plan.site_sha256, plan.site):
        for model in sites:
            if wanted and wanted in (model.sha256, model.site.name):
                return model
    beside = None if sites else find_site(plan, plan_path)
    if beside is None:
        raise InputError(say("the plan is for the site '{}'; name its site file as well", plan.site, place=plan_path))
    return beside
