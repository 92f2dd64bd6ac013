"""Whole commands from a fresh process: wall time and largest memory."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from planning.site.bundled import write_scene
from tests.benchmarks.harness import SHARED_DATA, Benchmark, Context, Row

ROOT = Path(__file__).resolve().parents[2]
REAL_SITE = SHARED_DATA / "bim" / "office_a.ifc"
"""A real building, where it is at hand."""

BUDGETS_S, QUICK_BUDGETS_S = (5.0, 10.0, 20.0, 60.0), (5.0,)
MANY_BATTERIES = 7
"""Whose plans are measured with the shortest budget: legs between many viewpoints take long."""


class Measured(NamedTuple):
    """What a process printed, its wall time, the largest resident memory of it and of any that it began, and the time
    that all of them had of processors."""

    printed: str
    seconds: float
    peak_mib: float
    processor_s: float


class Finished(NamedTuple):
    """What a command printed as JSON, with times and memory of `Measured`."""

    content: dict[str, Any]
    seconds: float
    peak_mib: float
    processor_s: float


def run_measured(arguments: Sequence[str | Path]) -> Measured:
    """Run Python with arguments, in the repository's folder.

    Raises
    ------
    RuntimeError
        It failed; the message is what it wrote to stderr.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "measured.json"
        helper = [sys.executable, "-m", "tests.benchmarks.measured_process", str(path)]
        command = [*helper, sys.executable, *map(str, arguments)]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        measured = json.loads(path.read_text("utf-8"))
    if measured["status"]:
        raise RuntimeError(done.stderr.strip())
    return Measured(done.stdout, measured["seconds"], measured["peak_mib"], measured["processor_s"])


def run_command(arguments: Sequence[str | Path]) -> Finished:
    """Run `app.py` with arguments and `--json`.

    Raises
    ------
    RuntimeError
        It failed; the message is what it wrote to stderr.
    """
    done = run_measured(["app.py", *arguments, "--json"])
    return Finished(json.loads(done.printed), done.seconds, done.peak_mib, done.processor_s)


def measure(context: Context) -> Iterator[Row]:
    """560 views on 280 panels, and 800 views on a tower of 3 640 panels."""
    cases = (
        [("office", 560, 20.0, 60.0)] if context.is_quick else [("office", 560, 20.0, 60.0), ("tower", 800, 90.0, 60.0)]
    )
    with tempfile.TemporaryDirectory() as folder:
        for scene, n_views, wanted_s, budget_s in cases:
            site = write_scene(scene, Path(folder))
            done = run_command(
                [
                    "plan",
                    site,
                    "-o",
                    Path(folder) / "plan.json",
                    "--views",
                    str(n_views),
                    "--time-budget",
                    str(budget_s),
                ]
            )
            found = done.content
            what = f"{found['views']} views in {found['sorties']} sorties, from a fresh process"
            yield Row(scene, what, done.seconds, "s", target=f"under {wanted_s:g} s", met=done.seconds < wanted_s)
            stages = ", ".join(f"{stage} {seconds:.1f} s" for stage, seconds in found["seconds_by_stage"].items())
            yield Row(scene, "of it: planning", found["seconds"], "s", against=stages)
            yield Row(
                scene, "peak memory", done.peak_mib / 1024.0, "GiB", target="under 4 GiB", met=done.peak_mib < 4096
            )
            share = 100.0 * found["covered"] / found["reachable_upper_bound"]
            yield Row(scene, "covered", share, "% of the bound")


BENCHMARK = Benchmark(
    "fresh-process",
    "Planned and routed from a fresh process",
    "`app.py plan` with a budget of 60 s, starting Python, reading the site and writing the plan included.",
    measure,
)


def measure_budgets(context: Context) -> Iterator[Row]:
    """Wall time against the budget, and what the plan is worth then: small, real and large sites."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        sites = {"office": write_scene("office", folder)}
        if not context.is_quick:
            (folder / "tower").mkdir()
            sites["tower"] = write_scene("tower", folder / "tower")
        if REAL_SITE.exists() and not context.is_quick:
            sites["office_a.ifc"] = folder / "office_a.json"
            run_measured(["app.py", "site", "import", REAL_SITE, "-o", sites["office_a.ifc"]])
        for name, site in sites.items():
            asked: list[tuple[float, int]] = [
                (each, 0) for each in (QUICK_BUDGETS_S if context.is_quick else BUDGETS_S)
            ]
            for budget_s, n_batteries in [*asked, (QUICK_BUDGETS_S[0], MANY_BATTERIES)]:
                plan = folder / f"{name}.plan.json"
                goal = ["--batteries", str(n_batteries)] if n_batteries else []
                done = run_command(["plan", site, "-o", plan, "--time-budget", str(budget_s), *goal])
                run_measured(["app.py", "check", plan, site])  # ready, or only warnings
                found, most_s = done.content, 1.1 * budget_s + 1.0
                share = 100.0 * found["covered"] / found["reachable_upper_bound"]
                worth = f"{found['covered']} sections, {share:.1f} % of the bound, {found['undecided']} not proven"
                flown = f"{found['views']} views, {found['duration_s'] / 60.0:.1f} min in {found['sorties']} sorties"
                target, is_met = f"at most {most_s:g} s", done.seconds <= most_s
                what = f"{budget_s:g} s asked" + (f" for {n_batteries} batteries" if n_batteries else "")
                yield Row(name, what, done.seconds, "s", None, f"{worth}; {flown}", target, is_met)


BUDGETS_BENCHMARK = Benchmark(
    "time-budgets",
    "Time budgets are kept, and what more time brings",
    "`app.py plan --time-budget S` from a fresh process; 10 % and 1 s more are allowed. Every plan passes `check`.",
    measure_budgets,
)
