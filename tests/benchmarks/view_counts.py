"""The paper's Fig. 14: coverage against the number of views, for the paper's swarm and for greedy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from planning.base.progress import TimeLimit
from planning.viewpoints.greedy import greedy
from planning.viewpoints.problem import Optimiser
from planning.viewpoints.pso import pso
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.problems import choose, covered, prepared

GREEDY_S = 8.0
N_SEEDS = 3
"""As in the paper, which takes the mean of three runs."""

Curves = Mapping[str, Mapping[int, Sequence[int]]]
"""Sections covered by each seed, by method and number of views."""


def measure(context: Context) -> Iterator[Row]:
    """Means over seeds, and a picture of each site."""
    counts = (100, 400, 800) if context.is_quick else tuple(range(100, 801, 100))
    few = (50,) if context.is_quick else (20, 40, 60, 80)
    n_seeds = 1 if context.is_quick else N_SEEDS
    scenes = ("office",) if context.is_quick else ("office", "library")
    for scene in scenes:
        problem = prepared(scene).problem
        bound = problem.reachability.upper_bound
        yield Row(scene, "bound", bound, f"of {problem.model.n_elements} sections")
        curves: dict[str, dict[int, list[int]]] = {"greedy": {}, "PSO": {}}
        for n_views in (*few, *counts):
            methods: dict[str, Optimiser] = {"greedy": greedy} if n_views in few else {"PSO": pso, "greedy": greedy}
            for name, method in methods.items():
                with timer() as seconds:
                    found = []
                    for seed in range(n_seeds):
                        limit = TimeLimit(GREEDY_S if name == "greedy" else 600.0)
                        found.append(covered(problem, choose(method, problem, n_views, seed, limit)[0]))
                curves[name][n_views] = found
                mean = sum(found) / n_seeds
                what = f"{n_views} views, {name}, {seconds() / n_seeds:.1f} s"
                yield Row(scene, what, mean, "sections", mean / bound, "the bound", seeds=n_seeds)
        _draw(scene, curves, bound, context.folder / f"fig14-{scene}.png")


def _draw(scene: str, curves: Curves, bound: int, path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.5, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    for name, colour in (("greedy", "#0072b2"), ("PSO", "#d55e00")):
        counts = list(curves[name])
        means = [sum(curves[name][n]) / len(curves[name][n]) for n in counts]
        axes.plot(counts, means, "o-", color=colour, linewidth=2, label=f"{name} (mean)")
        seeds = [(n, value) for n in counts for value in curves[name][n]]
        axes.plot(*zip(*seeds, strict=True), ".", color=colour, alpha=0.5)
    axes.axhline(bound, color="black", linewidth=1.5)
    text = f"bound: {bound} can be reached at all"
    axes.annotate(text, (counts[-1], bound), (0, 6), textcoords="offset points", ha="right", va="bottom", fontsize=9)
    axes.set_xlabel("number of views")
    axes.set_ylabel("hemisphere sections covered (Eq. 10)")
    axes.set_title(f"{scene}: coverage against number of views (the paper's Fig. 14)")
    low = min(value for by_count in curves.values() for found in by_count.values() for value in found)
    axes.set_ylim(low - 0.05 * (bound - low), bound + 0.1 * (bound - low))
    axes.grid(color="#dddddd")
    axes.legend(loc="lower right")
    figure.savefig(path, dpi=110)


BENCHMARK = Benchmark(
    "fig14",
    "Coverage against number of views (Fig. 14)",
    "The paper's parametric analysis (4.2.1): for each number of views the mean of three runs of its particle swarm "
    "with Clerc and Kennedy's settings, and beside it greedy (search ended after 8 s, where it does not end by "
    "itself), from 20 views on. The paper finds its curve levelling off at 560 (planar) and 600 views (curved).",
    measure,
)
