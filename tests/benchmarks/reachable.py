"""What can be covered at all: the bound of every scene, and what proving it costs."""

from __future__ import annotations

from collections.abc import Iterator

from planning.aircraft.catalogue import profile
from planning.coverage.reachability import MAX_CELLS, find_reachable
from planning.parameters import Constraints
from planning.site.bundled import SCENES
from planning.viewpoints.prepare import prepare
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.problems import prepared

EFFORTS = (10, 100, 1000, MAX_CELLS)


def measure(context: Context) -> Iterator[Row]:
    """Bound, undecided sections and time; then undecided sections against effort."""
    scenes = ("office", "roof") if context.is_quick else tuple(SCENES)
    for scene in scenes:
        with timer() as seconds:
            found = prepare(SCENES[scene](), profile("m3e").camera, Constraints()).problem
        reach = found.reachability
        of_all = reach.upper_bound / found.model.n_elements
        yield Row(scene, "bound", reach.upper_bound, "sections", of_all, f"all {found.model.n_elements} sections")
        yield Row(scene, "undecided (count as reachable)", reach.n_undecided, "sections")
        yield Row(scene, "reachability", reach.seconds, "s", reach.seconds / seconds(), "the whole preparation")
    for scene in ("office",) if context.is_quick else ("library", "court"):
        problem = prepared(scene).problem
        for effort in EFFORTS:
            reach = find_reachable(problem.model, problem.space, max_cells=effort)
            share = 100.0 * reach.n_undecided / reach.upper_bound
            yield Row(scene, f"{effort} cells a section, {reach.seconds:.2f} s: undecided", share, "% of the bound")


BENCHMARK = Benchmark(
    "reachability",
    "What can be covered at all",
    "For every section a witness viewpoint, a proof that no allowed viewpoint sees it, or neither; what is left "
    "undecided counts as reachable, so the bound holds whatever the effort. Then accuracy against time: cells of the "
    "branch and bound spent on a section at most.",
    measure,
)
