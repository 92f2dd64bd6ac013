"""How close greedy and its bounds are to the exact optimum, on scenes small enough to have one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from planning.aircraft.catalogue import profile
from planning.base.progress import never
from planning.parameters import Constraints
from planning.site.bundled import SCENES, panel_grid
from planning.site.records import SiteModel
from planning.viewpoints import cover_kernel as kernel
from planning.viewpoints.candidates import spread_candidates
from planning.viewpoints.greedy import dual_bound
from planning.viewpoints.improve import Exchange, cover_state
from planning.viewpoints.prepare import prepare
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.planning.viewpoints.exact_optimum import exact_optimum

CASES = ((100, 20), (100, 25), (200, 25), (400, 30))
"""Candidates and views."""

EXACT_S = 60.0


def coarse_office() -> SiteModel:
    """The office with 5 x 4 large panels instead of 20 x 14: small enough for the integer programme."""
    office = SCENES["office"]()
    facade = panel_grid("A", ((-18.0, 0.0, 0.0), (18.0, 0.0, 0.0), (-18.0, 0.0, 42.0)), 4, 5)
    return replace(office, site=replace(office.site, facades=(facade,)))


def measure(context: Context) -> Iterator[Row]:
    """Greedy, greedy with exchange and the bounds, each as a multiple of the optimum of the integer programme."""
    problem = prepare(coarse_office(), profile("m3e").camera, Constraints()).problem
    weights = np.ones(problem.model.n_elements)
    for n_candidates, n_views in CASES[:2] if context.is_quick else CASES:
        elements = problem.model.elements(spread_candidates(problem, n_candidates, np.random.default_rng(0)))
        scene = f"{len(problem.model.frames)} panels, {n_views} of {len(elements.starts) - 1} candidates"
        with timer() as seconds:
            optimum, _, proven = exact_optimum(elements, weights, n_views, 10.0 if context.is_quick else EXACT_S)
        remark = "" if proven - optimum < 0.5 else f" (out of time; not above {proven:.0f})"
        yield Row(scene, f"integer programme{remark}, {seconds():.1f} s", optimum, "sections")
        state, chosen = cover_state(elements, weights), np.zeros(n_views, np.int64)
        with timer() as seconds:
            kernel.greedy_steps(state, chosen, 0, n_views, np.inf)
        value = float(kernel.objective(state))
        yield Row(scene, f"greedy, {1e3 * seconds():.2g} ms", value, "sections", value / optimum, "the optimum")
        with timer() as seconds:
            exchange = Exchange(elements, weights, chosen, 0)
            exchange.run(never)
        better = exchange.value()
        what = f"greedy and exchange, {1e3 * seconds():.2g} ms"
        yield Row(scene, what, better, "sections", better / optimum, "the optimum")
        simple = value + float(np.sort(state.gains)[-n_views:].sum())
        yield Row(scene, "bound from marginal gains", simple, "sections", simple / optimum, "the optimum")
        with timer() as seconds:
            dual = dual_bound(elements, weights, n_views, better)
        what = f"dual bound (the certificate), {1e3 * seconds():.2g} ms"
        yield Row(scene, what, dual, "sections", dual / optimum, "the optimum")


BENCHMARK = Benchmark(
    "certificates",
    "Optimality gap",
    "Greedy comes with an upper bound on what as many of its candidates can cover. On the office with 20 panels an "
    "integer programme (HiGHS) finds the exact optimum of the same candidates; greedy lies below it, the bounds above.",
    measure,
)
