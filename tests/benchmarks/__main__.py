"""Run benchmarks and write docs/benchmarks.md.

`python -m tests.benchmarks [--only NAME ...] [--add] [--quick] [--out DIR]`
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.benchmarks.catalogue import BENCHMARKS
from tests.benchmarks.harness import Benchmark, Context, run_benchmark
from tests.benchmarks.report import recorded_rows, save, write_page

DOCS, QUICK_OUT = Path("docs"), Path("benchmark-out")


def main(arguments: Sequence[str]) -> int:
    """Run what is asked for; returns 1 where a benchmark failed."""
    names = [benchmark.name for benchmark in BENCHMARKS]
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("--only", nargs="+", choices=names, default=names, metavar="NAME", help=", ".join(names))
    parser.add_argument("--quick", action="store_true", help="smaller cases, about two minutes in all")
    parser.add_argument(
        "--add", action="store_true", help="only what is not recorded yet, where a benchmark knows: scenes, seeds"
    )
    parser.add_argument("--out", type=Path, help=f"default: {DOCS}, with --quick {QUICK_OUT}")
    options = parser.parse_args(arguments)
    out = options.out or (QUICK_OUT if options.quick else DOCS)
    return run_all(
        [benchmark for benchmark in BENCHMARKS if benchmark.name in options.only], out, options.quick, add=options.add
    )


def run_all(
    benchmarks: Sequence[Benchmark],
    out: Path,
    is_quick: bool,
    known: Sequence[Benchmark] = BENCHMARKS,
    *,
    add: bool = False,
) -> int:
    """Run benchmarks one after the other and write the page, of all that are `known`, after each.

    With `add` each is told what is recorded of it, and its seconds are added to those recorded. Returns 1 where one
    failed.
    """
    folder = out / "benchmarks"
    folder.mkdir(parents=True, exist_ok=True)
    failed = []
    for benchmark in benchmarks:
        print(f"{benchmark.name}: {benchmark.title}", flush=True)  # noqa: T201
        recorded = recorded_rows(benchmark.name, folder, is_quick=is_quick) if add else ()
        outcome = run_benchmark(benchmark, Context(is_quick, folder, recorded))
        save(outcome, folder, is_added=add)
        write_page(out / "benchmarks.md", known, folder)
        print(f"  {outcome.status} after {outcome.seconds:.0f} s {outcome.message}", flush=True)  # noqa: T201
        if outcome.status == "failed":
            failed.append(outcome.name)
    if failed:
        print(f"failed: {', '.join(failed)}")  # noqa: T201
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
