"""Benchmark results kept as CSV files, and the Markdown page made from all of them.

Each benchmark has a table of its own, `runs.csv` says when each was run and how; so a part can be measured anew without
losing the others.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path

from tests.benchmarks.harness import Benchmark, Outcome, Row

HEADER = """# Benchmarks

Written by `make benchmark` (`python -m tests.benchmarks`); do not edit by hand. `--only NAME` measures one part again
and keeps the others, `--quick` takes two minutes and writes elsewhere. Sites are those of `planning.site.bundled`;
camera and aircraft the DJI M3E; 10 m distance, sections of 30 degrees and float32 unless something else is said.

"Load" is the number of processes that wanted to run in the minute before: above 0.5 or so the times are those of a
shared machine. Coverage is counted by the definition in float64. Shares are shares of the proven bound on what can be
covered at all.
"""

COLUMNS = [field.name for field in fields(Row)]
RUN_COLUMNS = ["name", "status", "message", "seconds", "is_quick", "machine", "load"]


def save(outcome: Outcome, folder: Path, *, is_added: bool = False) -> None:
    """Keep the rows and the circumstances of one run; one that was skipped leaves an earlier run's as they are.

    One that added to what was recorded took its own seconds and those recorded.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if outcome.status == "skipped" and (folder / f"{outcome.name}.csv").exists():
        return
    _write_csv(folder / f"{outcome.name}.csv", COLUMNS, [asdict(row) for row in outcome.rows])
    runs = {run["name"]: run for run in _read_csv(folder / "runs.csv")}
    content = asdict(outcome)
    before_s = float(runs[outcome.name]["seconds"]) if is_added and outcome.name in runs else 0.0
    content["seconds"], content["load"] = f"{before_s + outcome.seconds:.0f}", f"{outcome.load:.1f}"
    runs[outcome.name] = {column: str(content[column]) for column in RUN_COLUMNS}
    _write_csv(folder / "runs.csv", RUN_COLUMNS, runs.values())


def recorded_rows(name: str, folder: Path, *, is_quick: bool) -> tuple[Row, ...]:
    """What `save` kept of a benchmark that was run so; none where it kept nothing."""
    if not any(run["name"] == name and run["is_quick"] == str(is_quick) for run in _read_csv(folder / "runs.csv")):
        return ()
    return tuple(
        Row(
            **{column: row[column] for column in ("scene", "what", "unit", "against", "target")},
            value=_value(row["value"]),
            ratio=float(row["ratio"]) if row["ratio"] else None,
            met=row["met"] == "True" if row["met"] else None,
            seeds=int(row["seeds"]),
        )
        for row in _read_csv(folder / f"{name}.csv")
    )


def write_page(path: Path, benchmarks: Sequence[Benchmark], folder: Path) -> None:
    """Write the Markdown page from all results in `folder`."""
    runs = {run["name"]: run for run in _read_csv(folder / "runs.csv")}
    known = [benchmark for benchmark in benchmarks if benchmark.name in runs]
    tables = {benchmark.name: _read_csv(folder / f"{benchmark.name}.csv") for benchmark in known}
    parts = [HEADER, _machines(runs.values()), _targets(known, tables), _not_done(runs.values())]
    parts += [_section(benchmark, runs[benchmark.name], tables[benchmark.name], folder) for benchmark in known]
    path.write_text("\n".join(part for part in parts if part), "utf-8")


def anchor(title: str) -> str:
    """What a heading is linked by, on GitHub and in the site of the docs alike."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def _machines(runs: Iterable[Mapping[str, str]]) -> str:
    machines = sorted({run["machine"] for run in runs})
    return "Machine: " + "; ".join(machines) + ".\n"


def _targets(benchmarks: Sequence[Benchmark], tables: Mapping[str, Sequence[Mapping[str, str]]]) -> str:
    lines = ["## Targets\n", "| part | on | what | measured | target | |", "| --- | --- | --- | ---: | --- | --- |"]
    for benchmark in benchmarks:
        for row in tables[benchmark.name]:
            if row["met"]:
                measured = f"{_measured(row)} ({_ratio(row)})" if row["ratio"] else _measured(row)
                met = "met" if row["met"] == "True" else "**missed**"
                link = f"[{benchmark.name}](#{anchor(benchmark.title)})"
                lines.append(f"| {link} | {row['scene']} | {row['what']} | {measured} | {row['target']} | {met} |")
    return "\n".join(lines) + "\n" if len(lines) > 3 else ""


def _not_done(runs: Iterable[Mapping[str, str]]) -> str:
    lines = [f"- {run['name']} {run['status']}: {run['message']}" for run in runs if run["status"] != "done"]
    return "## Not done\n\n" + "\n".join(lines) + "\n" if lines else ""


def _section(benchmark: Benchmark, run: Mapping[str, str], rows: Sequence[Mapping[str, str]], folder: Path) -> str:
    command = f"python -m tests.benchmarks --only {benchmark.name}"
    quick = " --quick" if run["is_quick"] == "True" else ""
    lines = [f"## {benchmark.title}\n", benchmark.about.strip() + "\n"]
    lines.append(f"`{command}{quick}`: {run['seconds']} s, load {run['load']}.\n")
    lines += [f"![{benchmark.title}]({folder.name}/{path.name})\n" for path in _pictures(benchmark.name, folder)]
    if rows:
        lines += ["| on | what | value | ratio | seeds |", "| --- | --- | ---: | --- | ---: |"]
        lines += [_line(row) for row in rows]
    return "\n".join(lines) + "\n"


def _pictures(name: str, folder: Path) -> list[Path]:
    pictures = (path for path in folder.iterdir() if path.suffix in (".png", ".jpg"))
    return sorted(path for path in pictures if path.stem == name or path.stem.startswith(f"{name}-"))


def _line(row: Mapping[str, str]) -> str:
    return f"| {row['scene']} | {row['what']} | {_measured(row)} | {_ratio(row)} | {row['seeds']} |"


def _ratio(row: Mapping[str, str]) -> str:
    return f"{number_text(float(row['ratio']))} x {row['against']}" if row["ratio"] else row["against"]


def _measured(row: Mapping[str, str]) -> str:
    value = _value(row["value"])
    return f"{value if isinstance(value, str) else number_text(value)} {row['unit']}".strip()


def _value(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def number_text(value: float) -> str:
    """Four significant digits, whole numbers in full; thousands apart from 10 000 on."""
    if not math.isfinite(value) or value == 0.0:
        return f"{value:g}"
    if value == int(value) and abs(value) < 1e15:
        return f"{int(value):,}".replace(",", " ") if abs(value) >= 1e4 else f"{int(value)}"
    if abs(value) >= 1e4:
        return f"{float(f'{value:.4g}'):,.0f}".replace(",", " ")
    return f"{value:.4g}"


def _write_csv(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows({column: "" if row[column] is None else row[column] for column in columns} for row in rows)


def _read_csv(path: Path) -> list[dict[str, str]]:
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
