"""docs/tables.md, made of all results that there are."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

from reconstruction.training.method_registry import METHODS
from tests.tables.definitions import Above, Table
from tests.tables.measured import gap_section, measured_sections, real_section
from tests.tables.results import Result, of_case, older_of_case
from tests.tables.scales import Scale
from tests.tables.trainings import LEAST_GLASS, Case

PAPER_SCENES = {"planar": "ST", "curved": "UST"}

Score = Literal["psnr_db", "glass_db"]

OF_WHAT: dict[Score, str] = {"psnr_db": "", "glass_db": ", on glass alone"}
"""What is compared, and how a line says so."""

OLDER = "older settings"
"""Of a row that was not made again after something of its settings was changed."""

METHODS_TABLE = "3"
"""What real photos stand beside."""

PICTURES = "tables"
"""Folder beside the page."""

HEADER = """# The paper's tables

Written by `make tables` (`python -m tests.tables`); do not edit by hand. `--only 3 --scene planar --seeds 0 1` runs a
part, and keeps the others; `--scale paper` is for a computer with CUDA; `--cluster ADDRESS` shares the work over a Dask
cluster; `--lpips FILE` adds LPIPS. PSNR and SSIM are of the facades of unseen views, drawn at random among all places
that can be flown to, mean over views and then over seeds. In photos as small as those of `small` most pixels of a
facade show a frame, too; the column glass has the PSNR of pixels whose neighbours, too, show the same panel, of views
of which these are {least_glass:.0%} or more. Each view's PSNR, and how much of it is glass, are in
[tables/results.csv](tables/results.csv) of the later trainings. Seconds are those of a processor's core, without
rendering photos. Rows of {older} were made before some setting was changed; they are not compared with others, nor
shown in later pictures. The paper's numbers are of its real photos, with other sites, cameras and times: orders can be
compared, values cannot.
"""


def write_page(path: Path, tables: Sequence[Table], scale: Scale, results: Sequence[Result]) -> None:
    """Write the page, of results of one scale."""
    parts = [
        HEADER.format(least_glass=LEAST_GLASS, older=OLDER),
        _setup(scale),
        _methods(),
        "\n".join(measured_sections(path.parent)),
    ]
    for table in tables:
        parts.append("\n".join(_section(table, scale, results, path.parent / PICTURES)))
        if table.compares_plans:
            parts.append("\n".join(gap_section(path.parent)))
        if table.number == METHODS_TABLE:
            parts.append("\n".join(real_section(path.parent)))
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
        yield f"| | PSNR | worst view | glass | SSIM | LPIPS | s | steps | seeds | the paper's, {PAPER_SCENES[scene]} |"
        yield "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: |"
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
    found, title = of_case(results, scene, case.made_with(scene, scale)), case.title
    if not found:
        found, title = older_of_case(results, scene, scale.name, case.title), f"{case.title} ({OLDER})"
    if not found:
        return f"| {case.title} | not run | | | | | | | | {paper} |"
    mean, glass_db = (_mean(found, name) for name in ("psnr_db", "glass_db"))
    lpips = [each.lpips for each in found if each.lpips is not None]
    cells = (
        title,
        f"{mean:.2f}",
        f"{min(each.worst_db for each in found):.2f}",
        "" if glass_db is None else f"{glass_db:.2f}",
        f"{statistics.fmean(each.ssim for each in found):.4f}",
        f"{statistics.fmean(lpips):.4f}" if lpips else "",
        f"{statistics.fmean(each.seconds for each in found):.0f}",
        f"{statistics.fmean(each.n_steps for each in found):.0f}",
        ", ".join(f"{each.seed}: {each.psnr_db:.2f}" for each in sorted(found, key=lambda each: each.seed)),
        paper,
    )
    return f"| {' | '.join(cells)} |"


def _held(table: Table, scene: str, scale: Scale, results: Sequence[Result]) -> Iterator[str]:
    for request in table.must_hold:
        run = {case.title for case in table.cases if of_case(results, scene, case.made_with(scene, scale))}
        against = tuple(other for other in request.others if other in run)
        compared = replace(request, others=against)
        left = [other for other in request.others if other not in run]
        so_far = f"; not run: {', '.join(left)}" if left else ""
        for score, of_what in OF_WHAT.items():
            gap = gap_db(table, compared, scene, scale, results, score) if against else None
            if gap is not None:
                met = "met" if gap >= request.least_db else "**missed**"
                words = f"{gap:+.2f} dB (at least {request.least_db:g}: {met}{so_far})"
                yield f"- {request.better} above {' / '.join(against)}{of_what}: {words}"
    yield ""


def _mean(found: Sequence[Result], score: Score) -> float | None:
    """Over seeds; None where it is not known of one."""
    values = [each.psnr_db if score == "psnr_db" else each.glass_db for each in found]
    known = [value for value in values if value is not None]
    return statistics.fmean(known) if len(known) == len(values) else None


def gap_db(
    table: Table, request: Above, scene: str, scale: Scale, results: Sequence[Result], score: Score = "psnr_db"
) -> float | None:
    """Between a case and the best of others, means over seeds; None where one of them was not run."""
    means = {}
    for case in table.cases:
        found = of_case(results, scene, case.made_with(scene, scale))
        mean = _mean(found, score) if found else None
        if mean is not None:
            means[case.title] = mean
    if request.better not in means or not set(request.others) <= means.keys():
        return None
    return means[request.better] - max(means[other] for other in request.others)
