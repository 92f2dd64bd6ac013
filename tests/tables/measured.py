"""Table 1, Fig. 14, and what Table 2 depends on, of what `tests.benchmarks` has measured last."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

BENCHMARKS = "benchmarks"
"""Folder beside the page, with what was measured."""

MADE = {"planar": "made-planar", "curved": "made-curved"}
"""Facades with truth in the place of the paper's photos."""

METRICS = ("Overall mIoU", "Coverage, 20 % percentile", "Coverage, 10 %", "Coverage, 5 %", "Individual mIoU")

PAPER_1 = {
    "planar": ((0.9895, 1.0, 1.0, 1.0, 0.9787), (0.8597, 1.0, 1.0, 1.0, None)),
    "curved": ((0.9871, 1.0, 1.0, 1.0, 0.9709), (0.7316, 0.9058, 0.3126, 0.1641, None)),
}
"""For each scene the paper's own, and the best of EBLNet, GhostingNet and GlassSemNet in each line."""

SITES = {"office": "ST", "library": "UST"}

OPTIMISERS = {"PSO": "the paper's", "greedy": "ours"}

Rows = Mapping[tuple[str, str], Mapping[str, str]]


def measured_sections(folder: Path) -> Iterator[str]:
    """Lines of the page.

    Parameters
    ----------
    folder
        Of the page; files lie in `BENCHMARKS` below it.
    """
    yield from _panels(_rows(folder / BENCHMARKS / "segmentation.csv"))
    yield from _views(_rows(folder / BENCHMARKS / "fig14.csv"), folder)


def gap_section(folder: Path) -> Iterator[str]:
    """Lines of the page on what the gap of Table 2 depends on; `folder` as above."""
    rows = _rows(folder / BENCHMARKS / "plan-gap.csv")
    yield "### How the gap grows\n"
    yield (
        "The same of mirrored light alone, in photos of different sizes and with things at different distances. The "
        "paper has 13.15 dB, in photos 5280 pixels wide. "
        "[benchmarks.md](benchmarks.md#our-plan-against-noto-by-resolution-and-depth), "
        "`python -m tests.benchmarks --only plan-gap`\n"
    )
    yield "| photos, before the facade, model of light | our plan above NOTO, dB | |"
    yield "| --- | ---: | --- |"
    for (_, what), row in rows.items():
        yield f"| {what.partition(':')[0]} | {row['value']} | {row['against']} |"
    if not rows:
        yield "| not run | | |"
    yield ""


def _rows(path: Path) -> Rows:
    if not path.is_file():
        return {}
    with path.open(encoding="utf-8", newline="") as file:
        return {(row["scene"], row["what"]): row for row in csv.DictReader(file)}


def _panels(rows: Rows) -> Iterator[str]:
    yield "## Table 1: Segmentation of panels\n"
    yield (
        "Photos of made facades whose every panel is known. The networks that the paper compares with were not run: "
        "what the best of them reaches on the paper's photos stands in the last column. More detectors, sizes and real "
        "photos: [benchmarks.md](benchmarks.md#glass-panels-in-photos), "
        "`python -m tests.benchmarks --only segmentation`\n"
    )
    for scene, made in MADE.items():
        paper, others = PAPER_1[scene]
        yield f"### {scene}: panels\n"
        yield "| | ours | photos | the paper's | best other of the paper |"
        yield "| --- | ---: | ---: | ---: | ---: |"
        for metric, ours, own, other in zip(METRICS, _found(rows, made), paper, others, strict=True):
            yield f"| {metric} | {ours} | {_n_photos(rows, made)} | {_number(own)} | {_number(other)} |"
        yield ""


def _found(rows: Rows, made: str) -> list[str]:
    percentiles = rows.get((made, "coverage percentiles"), {}).get("value", "")
    coverage = re.findall(r"\d+ %: ([\d.]+)", percentiles)
    values = [
        rows.get((made, "overall mIoU (glass and the rest)"), {}).get("value", ""),
        *(coverage if len(coverage) == 3 else [""] * 3),
        rows.get((made, "individual mIoU"), {}).get("value", ""),
    ]
    return [f"{float(value):.4f}" if value else "not run" for value in values]


def _n_photos(rows: Rows, made: str) -> str:
    return rows.get((made, "individual mIoU"), {}).get("seeds", "")


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"


def _views(rows: Rows, folder: Path) -> Iterator[str]:
    yield "## Fig. 14: Number of views\n"
    yield (
        "Sections that are covered, of those that can be at all, by views of the paper's optimiser (PSO) and of ours; "
        "means of three seeds. The paper's curves level off at 560 views (ST) and 600 (UST). "
        "[benchmarks.md](benchmarks.md#coverage-against-number-of-views-fig-14), "
        "`python -m tests.benchmarks --only fig14`\n"
    )
    shares: dict[tuple[str, int, str], str] = {}
    for (site, what), row in rows.items():
        found = re.match(r"(\d+) views, (\w+), ", what)
        if found and row["ratio"]:
            shares[site, int(found[1]), found[2]] = f"{100.0 * float(row['ratio']):.1f} %"
    numbers = sorted({number for _, number, _ in shares})
    columns = [(site, how) for site in SITES for how in OPTIMISERS]
    yield f"| views | {' | '.join(f'{site}, {OPTIMISERS[how]}' for site, how in columns)} |"
    yield "| ---: |" + " ---: |" * len(columns)
    for number in numbers:
        yield f"| {number} | {' | '.join(shares.get((site, number, how), '') for site, how in columns)} |"
    if not numbers:
        yield "| not run |" + " |" * len(columns)
    yield ""
    for site, paper in SITES.items():
        picture = f"{BENCHMARKS}/fig14-{site}.png"
        if (folder / picture).is_file():
            yield f"![Share of sections against the number of views, {site} (in the place of {paper})]({picture})\n"
