"""Table 1, Fig. 14, what Table 2 depends on, and real photos, of what `tests.benchmarks` has measured last."""

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

OVERALL, INDIVIDUAL = "overall mIoU (glass and the rest)", "individual mIoU"
"""How the benchmarks call the first and the last of them,"""

AUTO = "individual mIoU, --network auto"
"""and on real photos."""

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
    yield from _real_panels(_rows(folder / BENCHMARKS / "network.csv"))
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


LIKENESS = ("SSIM", "LPIPS", "FLIP")


def real_section(folder: Path) -> Iterator[str]:
    """Lines of the page on methods with real photos; `folder` as above."""
    rows = {key: row for key, row in _rows(folder / BENCHMARKS / "real-photos.csv").items() if "against" not in key[1]}
    methods = list(dict.fromkeys(what for (_, what), row in rows.items() if row["unit"] == "dB"))
    yield "## Methods on real photos\n"
    yield (
        "Not in the paper, whose own photos are not published. Photos that were held out of a real glass wall, on its "
        "facade, and, from photos alone and without panels, of a castle, a door and a ruin under a drone: whole "
        "pictures. RefGlass-GS needs panels. As much processor time for each. "
        "[benchmarks.md](benchmarks.md#models-of-real-photos), `python -m tests.benchmarks --only real-photos`\n"
    )
    if not methods:
        yield "Not run.\n"
        return
    yield f"| | | PSNR | {' | '.join(LIKENESS)} |"
    yield "| --- | --- |" + " ---: |" * (1 + len(LIKENESS))
    for (scene, method), row in rows.items():
        if method in methods:
            yield f"| {scene} | {method} | {' | '.join(_scores(row))} |"
    yield ""


def _scores(row: Mapping[str, str]) -> list[str]:
    """PSNR and likeness of a method on a set, as far as they were measured."""
    if row["unit"] != "dB":
        return [row["value"], *[""] * len(LIKENESS)]
    found = [re.search(rf"{name} ([\d.]+)", row["against"]) for name in LIKENESS]
    return [f"{float(row['value']):.2f}", *("" if each is None else each[1] for each in found)]


def _rows(path: Path) -> Rows:
    if not path.is_file():
        return {}
    with path.open(encoding="utf-8", newline="") as file:
        return {(row["scene"], row["what"]): row for row in csv.DictReader(file)}


def _panels(rows: Rows) -> Iterator[str]:
    yield "## Table 1: Segmentation of panels\n"
    yield (
        "Photos of synthetic facades whose every panel is known. The networks that the paper compares with were not "
        "run: what the best of them reaches on the paper's photos stands in the last column. More detectors, sizes and "
        "real photos: [benchmarks.md](benchmarks.md#glass-panels-in-photos), "
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


def _real_panels(rows: Rows) -> Iterator[str]:
    sets = dict.fromkeys(scene for scene, what in rows if what == OVERALL)
    yield "### Real photos\n"
    yield (
        "Photos that nothing was learned from, `--network auto`: a curtain wall (1:25), offices at night, and windows "
        "in walls (CMP). "
        "[benchmarks.md](benchmarks.md#the-network-for-panes-on-real-photos), "
        "`python -m tests.benchmarks --only network`\n"
    )
    if not sets:
        yield "Not run.\n"
        return
    yield f"| | {' | '.join(sets)} |"
    yield "| --- |" + " ---: |" * len(sets)
    columns = [_found(rows, scene, AUTO) for scene in sets]
    for metric, *values in zip(METRICS, *columns, strict=True):
        yield f"| {metric} | {' | '.join(values)} |"
    yield ""


def _found(rows: Rows, made: str, individual: str = INDIVIDUAL) -> list[str]:
    """Values of `METRICS`, as far as they were measured."""
    percentiles = rows.get((made, "coverage percentiles"), {}).get("value", "")
    coverage = re.findall(r"\d+ %: ([\d.]+)", percentiles)
    values = [
        rows.get((made, OVERALL), {}).get("value", ""),
        *(coverage if len(coverage) == 3 else [""] * 3),
        rows.get((made, individual), {}).get("value", ""),
    ]
    return [f"{float(value):.4f}" if value else "not run" for value in values]


def _n_photos(rows: Rows, made: str) -> str:
    return rows.get((made, INDIVIDUAL), {}).get("seeds", "")


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
