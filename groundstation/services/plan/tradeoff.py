"""Use cases around quality against time: run settings side by side, write a table and a picture, name the winner.

Both files are written into a temporary folder and moved together: runs that fail or are cancelled leave nothing behind.
"""

from __future__ import annotations

import csv
import io
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from groundstation.services.mission.export import find_site
from groundstation.services.project.input_files import (
    TSPLIB_SUFFIXES,
    FileKind,
    expecting,
    kind_of,
    read_given_plan,
    read_given_site,
)
from planning.base.errors import InfeasibleError, InputError
from planning.base.json_file import part_folder, write_atomically
from planning.base.parallel_map import sweep
from planning.base.progress import QUIET, Monitor
from planning.parameters import DEFAULT_VIEWS
from planning.plan import Plan
from planning.request import PlanRequest
from planning.routing.methods import TourMethod
from planning.site.records import SiteModel
from planning.tradeoff.picture import COVERAGE_AXIS, TOUR_AXIS, GapAxis, Panel, draw
from planning.tradeoff.plan_report import PlanReport, plan_panels, plan_report, plan_rows, plan_title
from planning.tradeoff.plan_runs import FailedRun, PlanRun, Variants, common_steps, load_kernels, run_plan, settings
from planning.tradeoff.tour_report import TourReport, tour_panel, tour_report, tour_rows, tour_title
from planning.tradeoff.tour_runs import TOUR_METHODS, TourCase, plan_case, run_tours, tsplib_case


@dataclass(frozen=True, slots=True)
class PlanTradeoff:
    """What `tradeoff plan` found: a report a site, runs that could not be done, and the files written."""

    reports: tuple[PlanReport, ...]
    failed: tuple[FailedRun, ...]
    csv_path: Path
    picture_path: Path


@dataclass(frozen=True, slots=True)
class RouteTradeoff:
    """What `tradeoff route` found: a report a tour, and the files written."""

    reports: tuple[TourReport, ...]
    csv_path: Path
    picture_path: Path


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
) -> PlanTradeoff:
    """Plan every site with the base request and every variant; write `tradeoff-plan.csv` and `.png` into `out`.

    Without any goal in `base` every run gets the same number of views, `DEFAULT_VIEWS`. With one process and no cluster
    the runs follow each other, so that times can be compared.

    Raises
    ------
    InputError
        A site cannot be read, two sites have the same name, the folder cannot be made, no cluster answers.
    InfeasibleError
        No run with the sections asked for could be done on a site.
    """
    if base.n_views is None and base.share is None and base.n_batteries is None:
        base = replace(base, n_views=DEFAULT_VIEWS)
    sites = [_timed_site(path) for path in site_paths]
    _check_names([model.site.name for model, _ in sites])
    requests = settings(base, variants, n_seeds)
    steps = common_steps(requests)
    with output_folder(out) as folder:
        is_timed = n_processes == 1 and address is None
        if is_timed:
            monitor.report("loading kernels", 0, 1)
            load_kernels(requests)
            monitor = _NumberedRuns(monitor)
        arguments = [(model, request, steps, read_s) for model, read_s in sites for request in requests]
        run = partial(run_plan, monitor=monitor) if is_timed else run_plan
        results = sweep(run, arguments, n_processes=n_processes, address=address, monitor=monitor)
        failed = tuple(result for result in results if isinstance(result, FailedRun))
        reports = []
        for model, _ in sites:
            name = model.site.name
            done = [result for result in results if isinstance(result, PlanRun) and result.site == name]
            if all(run.request.constraints.section_step_deg != steps[0] for run in done):
                raise InfeasibleError(next(run.message for run in failed if run.site == name))
            reports.append(plan_report(done, base))
        rows = [row for report in reports for row in plan_rows(report)]
        panels = [panel for report in reports for panel in plan_panels(report)]
        title = "\n".join(plan_title(report) for report in reports)
        names = write_results(folder, "tradeoff-plan", rows, title, panels, COVERAGE_AXIS)
    return PlanTradeoff(tuple(reports), failed, *(out / name for name in names))


def route_tradeoff(
    paths: Sequence[Path],
    seconds: float,
    out: Path,
    *,
    methods: Sequence[TourMethod] = TOUR_METHODS,
    seed: int = 0,
    monitor: Monitor = QUIET,
) -> RouteTradeoff:
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
    with output_folder(out) as folder:
        cases = [_tsplib_case(path, monitor) for path in tsplib_paths]
        cases += [plan_case(plan, model, monitor) for plan, model in plans]
        _check_names([case.name for case in cases])
        reports = tuple(tour_report(case, run_tours(case, seconds, methods, seed, monitor)) for case in cases)
        rows = [row for report in reports for row in tour_rows(report)]
        title = "\n".join(tour_title(report) for report in reports)
        panels = [tour_panel(report) for report in reports]
        names = write_results(folder, "tradeoff-route", rows, title, panels, TOUR_AXIS)
    return RouteTradeoff(reports, *(out / name for name in names))


class _NumberedRuns:
    """Progress of the run at hand, with its number among all runs."""

    def __init__(self, monitor: Monitor) -> None:
        self._monitor, self._prefix = monitor, ""

    def report(self, stage: str, done: float, total: float) -> None:
        """Take the number of the run from the sweep, everything else from the run itself."""
        if stage == "running":
            self._prefix = f"run {done + 1:.0f} of {total:.0f}, "
        else:
            self._monitor.report(self._prefix + stage, done, total)


def _timed_site(path: Path) -> tuple[SiteModel, float]:
    started = time.perf_counter()
    model = read_given_site(path)
    return model, time.perf_counter() - started


def _tsplib_case(path: Path, monitor: Monitor) -> TourCase:
    with expecting(FileKind.TSPLIB, path):
        return tsplib_case(path, monitor)


def _check_names(names: Sequence[str]) -> None:
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"two of the files are called '{twice}'; their names must differ to tell the results apart")


def _plans_with_sites(paths: Sequence[Path]) -> list[tuple[Plan, SiteModel]]:
    """Plans among JSON files, each with its site."""
    sites, plans = [], []
    for path in paths:
        if kind_of(path) is FileKind.SITE:
            sites.append(read_given_site(path))
        else:
            plans.append((path, read_given_plan(path)))
    if sites and not plans:
        raise InputError(f"{paths[0]}: a site alone has no viewpoints to fly to; name a plan as well")
    return [(plan, _site_for(plan, path, sites)) for path, plan in plans]


def _site_for(plan: Plan, plan_path: Path, sites: Sequence[SiteModel]) -> SiteModel:
    for wanted in (plan.site_sha256, plan.site):
        for model in sites:
            if wanted and wanted in (model.sha256, model.site.name):
                return model
    beside = None if sites else find_site(plan, plan_path)
    if beside is None:
        raise InputError(f"{plan_path}: the plan is for the site '{plan.site}'; name its site file as well")
    return beside


@contextmanager
def output_folder(path: Path) -> Iterator[Path]:
    """A temporary folder whose files are moved into `path` in the end; nothing is left where that end is an error.

    Raises
    ------
    InputError
        The folder cannot be made or written into.
    """
    made = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        with part_folder(path, "tradeoff") as temporary:
            yield temporary
            for file in sorted(temporary.iterdir()):
                file.replace(path / file.name)
            made = []
    except OSError as error:
        text = f"{path}: this folder cannot be made or written into ({error.strerror or error}); name another"
        raise InputError(text) from error
    finally:
        for folder in made:
            with suppress(OSError):  # it was never made, or holds something
                folder.rmdir()


def write_results(
    folder: Path, stem: str, rows: Sequence[Mapping[str, Any]], title: str, panels: Sequence[Panel], axis: GapAxis
) -> tuple[str, str]:
    """Write a table and a picture into a folder; returns their names."""
    write_rows(folder / f"{stem}.csv", rows)
    draw(title, panels, axis, folder / f"{stem}.png")
    return f"{stem}.csv", f"{stem}.png"


def write_rows(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a table; cells stay empty where a row lacks a column."""
    columns = list(dict.fromkeys(column for row in rows for column in row))
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, columns, restval="")
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(path, text.getvalue().encode())
