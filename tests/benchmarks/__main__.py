"""Run benchmarks and write docs/benchmarks.md: `python -m tests.benchmarks [--only NAME ...] [--quick] [--out DIR]`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.benchmarks.catalogue import BENCHMARKS
from tests.benchmarks.harness import Benchmark, Context, run_benchmark
from tests.benchmarks.report import save, write_page

DOCS, QUICK_OUT = Path("docs"), Path("benchmark-out")


def main(arguments: Sequence[str]) -> int:
    """Run what is asked for; returns 1 where a benchmark failed."""
    names = [benchmark.name for benchmark in BENCHMARKS]
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME", help=", ".join(names))
    parser.add_argument("--quick", action="store_true", help="smaller cases, about two minutes in all")
    parser.add_argument("--out", type=Path, help=f"default: {DOCS}, with --quick {QUICK_OUT}")
    options = parser.parse_args(arguments)
    out = options.out or (QUICK_OUT if options.quick else DOCS)
    return run_all([benchmark for benchmark in BENCHMARKS if benchmark.name in options.only], out, options.quick)


def run_all(benchmarks: Sequence[Benchmark], out: Path, is_quick: bool, known: Sequence[Benchmark] = BENCHMARKS) -> int:
    """Run benchmarks one after the other and write the page, of all that are `known`, after each.

    Returns 1 where one failed.
    """
    folder = out / "benchmarks"
    folder.mkdir(parents=True, exist_ok=True)
    failed = []
    for benchmark in benchmarks:
        print(f"{benchmark.name}: {benchmark.title}", flush=True)  # noqa: T201
        outcome = run_benchmark(benchmark, Context(is_quick, folder))
        save(outcome, folder)
        write_page(out / "benchmarks.md", known, folder)
        print(f"  {outcome.status} after {outcome.seconds:.0f} s {outcome.message}", flush=True)  # noqa: T201
        if outcome.status == "failed":
            failed.append(outcome.name)
    if failed:
        print(f"failed: {', '.join(failed)}")  # noqa: T201
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
