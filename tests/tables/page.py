"""docs/tables.md, made of all results that there are."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from reconstruction.modelling.methods import METHODS
from tests.tables.definitions import Above, Table
from tests.tables.measured import gap_section, measured_sections
from tests.tables.results import Result, of_case
from tests.tables.scales import Scale
from tests.tables.trainings import Case

PAPER_SCENES = {"planar": "ST", "curved": "UST"}

PICTURES = "tables"
"""Folder beside the page."""

HEADER = """# The paper's tables

Written by `make tables` (`python -m tests.tables`); do not edit by hand. `--only 3 --scene planar --seeds 0 1` runs a
part, and keeps the others; `--scale paper` is for a computer with CUDA; `--cluster ADDRESS` shares the work over a Dask
cluster; `--lpips FILE` adds LPIPS. PSNR and SSIM are of the facades of unseen views, drawn at random among all places
that can be flown to, mean over views and then over seeds; each view's PSNR, and how much of it is glass, are in
[tables/results.csv](tables/results.csv) of the later trainings. Seconds are those of a processor's core, without
rendering photos. The paper's numbers are of its real photos, with other sites, cameras and times: orders can be
compared, values cannot.
"""


def write_page(path: Path, tables: Sequence[Table], scale: Scale, results: Sequence[Result]) -> None:
    """Write the page, of results of one scale."""
    parts = [HEADER, _setup(scale), _methods(), "\n".join(measured_sections(path.parent))]
    for table in tables:
        parts.append("\n".join(_section(table, scale, results, path.parent / PICTURES)))
        if table.compares_plans:
            parts.append("\n".join(gap_section(path.parent)))
    path.write_text("\n".join(parts), "utf-8")


def _setup(scale: Scale) -> str:
    config = scale.config
    shape = Case("of RefGlass-GS", "refglass-gs").config(scale, 0).reflections.mlp
    longest = f"{config.iterations} steps"
    if config.time_limit_s is not None:
        longest += f" of the joint training, or {config.time_limit_s:g} s of processor in all, whichever comes first"
    return (
        f"Scale `{scale.name}`: {scale.n_views} photos of {scale.width_px} x {3 * scale.width_px // 4} pixels to learn "
        f"from, {scale.n_unseen} to be scored on; each training {longest}, splats from {config.n_splats} to "
        f"{config.max_splats}; Reflection MLP {shape.layers} x {shape.width}, L = {shape.position_order}, unless "
        "something else is said. Settings of Reflight, of RefGlass-GS and of its ablations were chosen by trials on "
        "these scenes; those of the others are their papers' where these give any.\n"
    )


def _methods() -> str:
    lines = ["## Methods\n", "| `--method` | | source | what we simplified |", "| --- | --- | --- | --- |"]
    for name, method in METHODS.items():
        lines.append(f"| `{name}` | {method.title}: {method.what} | {method.source} | {method.simplified} |")
    return "\n".join(lines) + "\n"


def _section(table: Table, scale: Scale, results: Sequence[Result], folder: Path) -> Iterator[str]:
    yield f"## Table {table.number}: {table.title}\n"
    yield f"{table.about} `python -m tests.tables --only {table.number} --scale {scale.name}`\n"
    for scene in table.scenes:
        yield f"### {scene}\n"
        yield f"| | PSNR | worst view | SSIM | LPIPS | s | steps | seeds | the paper's, {PAPER_SCENES[scene]} |"
        yield "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: |"
        for case in table.cases:
            yield _line(case, scene, scale, results)
        yield ""
        if scale.says_something:
            yield from _held(table, scene, scale, results)
        picture = f"{table.number}-{scene}-{scale.name}.png"
        if (folder / picture).is_file():
            yield f"![Table {table.number}, {scene}: photo, and models of the first seed]({PICTURES}/{picture})\n"


def _line(case: Case, scene: str, scale: Scale, results: Sequence[Result]) -> str:
    paper = f"{case.paper[scene]:.2f}" if scene in case.paper else ""
    found = of_case(results, scene, case.made_with(scene, scale))
    if not found:
        return f"| {case.title} | not run | | | | | | | {paper} |"
    mean = statistics.fmean(each.psnr_db for each in found)
    lpips = [each.lpips for each in found if each.lpips is not None]
    cells = (
        case.title,
        f"{mean:.2f}",
        f"{min(each.worst_db for each in found):.2f}",
        f"{statistics.fmean(each.ssim for each in found):.4f}",
        f"{statistics.fmean(lpips):.4f}" if lpips else "",
        f"{statistics.fmean(each.seconds for each in found):.0f}",
        f"{statistics.fmean(each.n_steps for each in found):.0f}",
        ", ".join(f"{each.seed}: {each.psnr_db:.2f}" for each in sorted(found, key=lambda each: each.seed)),
        paper,
    )
    return f"| {' | '.join(cells)} |"


def _held(table: Table, scene: str, scale: Scale, results: Sequence[Result]) -> Iterator[str]:
    for wish in table.must_hold:
        run = {case.title for case in table.cases if of_case(results, scene, case.made_with(scene, scale))}
        against = tuple(other for other in wish.others if other in run)
        gap = gap_db(table, replace(wish, others=against), scene, scale, results) if against else None
        if gap is not None:
            met = "met" if gap >= wish.least_db else "**missed**"
            left = [other for other in wish.others if other not in run]
            so_far = f"; not run: {', '.join(left)}" if left else ""
            words = f"{gap:+.2f} dB (at least {wish.least_db:g}: {met}{so_far})"
            yield f"- {wish.better} above {' / '.join(against)}: {words}"
    yield ""


def gap_db(table: Table, wish: Above, scene: str, scale: Scale, results: Sequence[Result]) -> float | None:
    """Between a case and the best of others, means over seeds; None where one of them was not run."""
    means = {}
    for case in table.cases:
        found = of_case(results, scene, case.made_with(scene, scale))
        if found:
            means[case.title] = statistics.fmean(each.psnr_db for each in found)
    if wish.better not in means or not set(wish.others) <= means.keys():
        return None
    return means[wish.better] - max(means[other] for other in wish.others)
