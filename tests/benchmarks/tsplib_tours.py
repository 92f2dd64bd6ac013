"""Tours through TSPLIB's instances: gap to the proven optimum after a fixed time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from planning.base.progress import TimeLimit, Trace, any_of
from planning.routing.methods import TourMethod, find_tour
from planning.routing.tour import tour_length
from planning.routing.tsplib import read_instance
from tests.benchmarks.harness import Benchmark, Context, Row

MAX_POINTS = 1000
METHODS: tuple[TourMethod, ...] = ("nearest-neighbour", "local-search", "pyvrp", "pyvrp-cold")
WANTED_GAP = 0.03


def measure(context: Context) -> Iterator[Row]:
    """Gap of every method, and when it was reached."""
    folder = context.data("routing/tsplib")
    seconds = 3.0 if context.is_quick else 30.0
    optima = known_optima(folder / "solutions")
    paths = [path for path in sorted(folder.glob("*.tsp")) if path.stem in optima]
    gaps: dict[TourMethod, list[float]] = {method: [] for method in METHODS}
    methods = METHODS[:2] if context.is_quick else METHODS
    for path in paths:
        instance = read_instance(path)
        if len(instance.ids) > MAX_POINTS:
            continue
        for method in methods:
            if method == "pyvrp-cold" and len(instance.ids) < 400:
                continue
            trace = Trace()
            optimum = optima[path.stem]
            enough = any_of(TimeLimit(seconds), lambda t=trace, o=optimum: bool(t.points) and t.points[-1].value <= o)
            length = tour_length(instance.cost, find_tour(instance.cost, method, stop=enough, trace=trace))
            gap = length / optimum - 1.0
            gaps[method].append(gap)
            reached_s = min(point.t_s for point in trace.points if point.value <= length)
            what = f"{method}, reached after {reached_s:.2g} s"
            yield Row(instance.name, what, length, "", length / optimum, "the optimum")
    for method, found in gaps.items():
        if found:
            is_goal = method == "local-search"
            yield Row(
                f"{len(found)} instances",
                f"{method}: largest gap (mean {math.fsum(found) / len(found):.2%})",
                100.0 * max(found),
                "%",
                target=f"at most {WANTED_GAP:.0%} after {seconds:g} s" if is_goal else "",
                met=max(found) <= WANTED_GAP if is_goal else None,
            )


def known_optima(path: Path) -> dict[str, int]:
    """Proven optima by name, from lines `name : length`."""
    lines = path.read_text("utf-8").splitlines()
    pairs = (line.split(":") for line in lines if ":" in line)
    return {name.strip(): int(value) for name, value in pairs}


BENCHMARK = Benchmark(
    "tsplib",
    "Tours: TSPLIB",
    "Every instance of the input data with up to 1000 points, each method for 30 s (3 s in a quick run) or until it "
    "has the proven optimum: the nearest neighbour (the paper's greedy), our local search, PyVRP started from a 3-opt "
    "tour and, on instances of 400 points and more, from one of its own.",
    measure,
)
