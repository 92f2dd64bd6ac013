"""How fast the fitness is evaluated, and whether it counts what the definition counts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from planning.base.jit import chunks, n_threads, run_chunks
from planning.coverage.model import CoverageModel, exact_coverage
from planning.coverage.sections import sections_seen
from planning.parameters import Precision
from planning.plan import ViewpointArrays
from planning.viewpoints.candidates import spread_candidates
from planning.viewpoints.problem import take
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.problems import prepared

CHUNK = 1000
"""Views a call: the arrays of NumPy's intermediate results stay below 50 MB."""


def measure(context: Context) -> Iterator[Row]:
    """Pairs of view and panel per second, and pairs that differ."""
    seconds = 0.5 if context.is_quick else 3.0
    problem = prepared("office").problem
    views = spread_candidates(problem, 20_000, np.random.default_rng(0))
    n_pairs = len(views.heading_rad) * len(problem.model.frames)
    numpy_rate = _numpy_rate(problem.model, views, seconds)
    yield Row("office", "vectorised NumPy, float64, 1 core", numpy_rate / 1e6, "M pairs/s")
    precisions: tuple[Precision, ...] = ("f32", "f64")
    for precision in precisions:
        model = replace(problem.model, precision=precision)
        one = _kernel_rate(model, views, seconds, n_at_once=1)
        every = _kernel_rate(model, views, seconds, n_at_once=n_threads())
        is_goal = precision == "f32"
        yield Row("office", f"kernel {precision}, 1 core", one / 1e6, "M pairs/s", one / numpy_rate, "NumPy")
        yield Row(
            "office",
            f"kernel {precision}, {n_threads()} cores",
            every / 1e6,
            "M pairs/s",
            every / numpy_rate,
            "NumPy",
            "at least 100 times NumPy" if is_goal else "",
            every >= 100.0 * numpy_rate if is_goal else None,
        )
        differing = _pairs_that_differ(model, views)
        yield Row("office", f"pairs in another section than NumPy's, {precision}", differing, f"of {n_pairs}")
        few = take(views, np.arange(560))
        exact, fast = int((exact_coverage(model, few) > 0).sum()), model.covered_count(few)
        yield Row("office", f"sections covered by 560 views, {precision}", fast, "", fast / exact, "the definition")


def _numpy_rate(model: CoverageModel, views: ViewpointArrays, wanted_s: float) -> float:
    few = take(views, np.arange(CHUNK))
    return _fastest(lambda: sections_seen(few, model.frames, model.camera, model.grid), model, CHUNK, wanted_s)


def _kernel_rate(model: CoverageModel, views: ViewpointArrays, wanted_s: float, n_at_once: int) -> float:
    """Whole evaluations of the fitness, as many at once as the swarm would do."""

    def evaluate() -> None:
        run_chunks(lambda _start, _stop: model.covered_count(views), [(i, i + 1) for i in range(n_at_once)])

    return _fastest(evaluate, model, n_at_once * len(views.heading_rad), wanted_s)


def _fastest(work: Callable[[], object], model: CoverageModel, n_views: int, wanted_s: float) -> float:
    """Pairs per second of the fastest of many repetitions: what else the machine does only makes some slower."""
    work()
    fastest_s = np.inf
    with timer() as total:
        while total() < wanted_s:
            with timer() as once:
                work()
            fastest_s = min(fastest_s, once())
    return n_views * len(model.frames) / fastest_s


def _pairs_that_differ(model: CoverageModel, views: ViewpointArrays) -> int:
    differing = 0
    elements = model.elements(views)
    for start, stop in chunks(len(views.heading_rad), CHUNK):
        exact = sections_seen(take(views, np.arange(start, stop)), model.frames, model.camera, model.grid)
        found = np.full(exact.shape, -1, np.int64)
        counts = np.diff(elements.starts[start : stop + 1])
        items = elements.items[elements.starts[start] : elements.starts[stop]]
        found[np.repeat(np.arange(stop - start), counts), items // model.grid.n_sections] = (
            items % model.grid.n_sections
        )
        differing += int(np.count_nonzero(found != exact))
    return differing


BENCHMARK = Benchmark(
    "kernel",
    "Fitness kernel",
    "Pairs of viewpoint and panel evaluated per second (the paper's Eq. 10): the compiled kernel against the same "
    "definition in vectorised NumPy, in one run on the same 20 000 views; and how often they disagree. They can only "
    "do so where a line of sight falls on the border of a section or of the picture.",
    measure,
)
