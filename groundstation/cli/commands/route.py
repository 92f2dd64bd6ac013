"""`route`: a short tour through a TSPLIB instance, for comparison with known optima."""

from __future__ import annotations

import argparse
import json
import math
import time
from pathlib import Path
from typing import Any

from groundstation.cli.console import tell
from groundstation.cli.options import checked_seed, number
from planning.base.messages import say

METHODS = ("local-search", "pyvrp", "nearest-neighbour")
DEFAULT_BUDGET_S = 10.0

START_AND_END_S = 0.3
"""Part of the budget for starting Python before `run` and for leaving it afterwards."""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "route",
        help="find a short tour through a TSPLIB instance",
        description="Find a short closed tour through the points of a TSPLIB file (TSP, or ATSP with pyvrp), print its "
        "length in TSPLIB's own rounding, and prove how far from the shortest it can be.",
    )
    parser.add_argument("file", type=Path, metavar="FILE.tsp", help="TSPLIB instance")
    parser.add_argument(
        "--time-budget",
        type=number,
        default=DEFAULT_BUDGET_S,
        metavar="S",
        help="longest time to take, seconds (default %(default)g); a proven shortest tour ends it sooner",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the search (default 0)")
    parser.add_argument(
        "--method",
        choices=METHODS,
        default=METHODS[0],
        help="local-search (default): iterated 3-opt; pyvrp; nearest-neighbour: the paper's greedy",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read, solve, print."""
    begin = time.perf_counter()
    from groundstation.services.project.input_files import FileKind, expecting
    from planning.base.errors import InputError
    from planning.base.progress import TimeLimit, Trace
    from planning.routing.methods import solve_tour
    from planning.routing.tour import nearest_neighbour, tour_length
    from planning.routing.tsplib import read_instance

    seed = checked_seed(options.seed)
    if options.time_budget <= 0.0:
        raise InputError(
            say("expected a positive number of seconds, got {:g}", options.time_budget, place="--time-budget")
        )
    with expecting(FileKind.TSPLIB, options.file):
        instance = read_instance(options.file)
    if instance.kind == "CVRP":
        raise InputError(say("a CVRP needs several routes; expected a TSP or ATSP", place=options.file))
    if instance.kind == "ATSP" and options.method == "local-search":
        raise InputError(say("local-search needs a symmetric instance; add --method pyvrp", place=options.file))
    left_s = options.time_budget - (time.perf_counter() - begin) - START_AND_END_S
    trace = Trace()
    result = solve_tour(instance.cost, options.method, TimeLimit(left_s), seed=seed, trace=trace)
    greedy = tour_length(instance.cost, nearest_neighbour(instance.cost))
    answer = {
        "name": instance.name,
        "points": len(instance.ids),
        "length": _number(result.length),
        "method": options.method,
        "seed": seed,
        "lower_bound": _number(result.lower_bound),
        "gap": result.gap,
        "nearest_neighbour_length": _number(greedy),
        "seconds": time.perf_counter() - begin,
        "tour": [instance.ids[point] for point in result.order],
        "history": [{"t_s": point.t_s, "length": _number(point.value)} for point in trace.points],
    }
    if options.json:
        print(json.dumps(answer, allow_nan=False))
        return 0
    proof = (
        say("the shortest there is")
        if result.gap == 0.0
        else say("at most {:.2%} longer than the shortest", result.gap)
    )
    tell(
        "{} through {} points, proven to be {}\n{}, {:.1f} s; the nearest neighbour gives {} ({:+.1%})",
        answer["length"],
        answer["points"],
        proof,
        answer["method"],
        answer["seconds"],
        answer["nearest_neighbour_length"],
        greedy / result.length - 1.0,
        place=instance.name,
    )
    return 0


def _number(value: float) -> float | None:
    """As a whole number where it is one; null where a greedy tour needs a leg that does not exist."""
    if math.isinf(value):
        return None
    return int(value) if value == int(value) else value
