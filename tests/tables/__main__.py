"""Train, score and write docs/tables.md: `python -m tests.tables [--only N ...] [--scale SCALE] [--seeds N ...]`.

What was trained with the settings of now is not trained again; after every few trainings their results are kept.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from planning.base.jit import n_threads
from planning.base.parallel_map import sweep
from tests.tables.definitions import Table, tables
from tests.tables.page import write_page
from tests.tables.photos import Photos, photos_in, site_file
from tests.tables.pictures import draw, picture_of
from tests.tables.results import keep, read_results
from tests.tables.scales import SCALES, Scale
from tests.tables.trainings import trained_and_scored

DOCS, OUT = Path("docs"), Path("tables-out")
USUAL = "small"
RESULTS = "results.csv"


def main(arguments: Sequence[str]) -> int:
    """Run what is asked for; returns the exit status."""
    parser = _parser()
    options = parser.parse_args(arguments)
    unknown = set(options.only) - {table.number for table in tables(SCALES[USUAL])}
    if unknown:
        parser.error(f"there is no table {', '.join(sorted(unknown))}")
    scale = SCALES[options.scale]
    out = options.out or (DOCS if scale.name == USUAL else OUT)
    folder = out / "tables"
    for made in (folder, options.work):
        made.mkdir(parents=True, exist_ok=True)
    chosen = [table for table in tables(scale) if table.number in options.only]
    jobs = _jobs(chosen, scale, options, folder)
    photos = dict.fromkeys(each for job in jobs for each in job[0].photos(job[1], scale))
    for scene in dict.fromkeys(each.scene for each in photos):
        site_file(options.work, scene)
    sweep(photos_in, [(options.work, each) for each in photos], n_processes=options.jobs, address=options.cluster)
    for start in range(0, len(jobs), options.jobs):
        some = jobs[start : start + options.jobs]
        results = sweep(trained_and_scored, some, n_processes=options.jobs, address=options.cluster)
        keep(folder / RESULTS, results)
        write_page(out / "tables.md", tables(scale), scale, read_results(folder / RESULTS))
        for result in results:
            print(f"{result.scene}, {result.case}, seed {result.seed}: {result.psnr_db} dB", flush=True)  # noqa: T201
    for table in chosen:
        for scene in table.scenes:
            draw(table, scene, scale, _truth(scene, scale, table, options.work), options.work, folder)
    write_page(out / "tables.md", tables(scale), scale, read_results(folder / RESULTS))
    return 0


def _parser() -> argparse.ArgumentParser:
    numbers = [table.number for table in tables(SCALES[USUAL])]
    parser = argparse.ArgumentParser(prog="python -m tests.tables", description=__doc__)
    add = parser.add_argument
    add("--only", nargs="*", default=numbers, metavar="N", help=f"of {', '.join(numbers)}; none: write the page anew")
    add("--scale", choices=tuple(SCALES), default=USUAL, help=f"default {USUAL}")
    add("--scene", help="one of the table's, for a part of it")
    add("--case", nargs="+", help="beginnings of titles, for a part of it")
    add("--seeds", nargs="+", type=int, default=[0], metavar="N", help="default 0")
    add("--jobs", type=int, default=n_threads(), metavar="N", help="trainings side by side (default: one a core)")
    add("--cluster", metavar="ADDRESS", help="scheduler of a Dask cluster that sees the same folders")
    add("--lpips", type=Path, action="append", default=[], metavar="WEIGHTS", help="file of weights; give it again")
    add("--work", type=Path, default=OUT / "work", help=f"folder for photos (default {OUT / 'work'})")
    add("--out", type=Path, help=f"default: {DOCS}; of other scales {OUT}")
    return parser


def _jobs(chosen: Sequence[Table], scale: Scale, options: argparse.Namespace, folder: Path) -> list[tuple[Any, ...]]:
    """Arguments of `trained_and_scored`, of what has no result yet; seed by seed, so that each is whole first."""
    done = {result.key for result in read_results(folder / RESULTS)}
    jobs = []
    for seed in options.seeds:
        for scene, case in ((scene, case) for table in chosen for scene in table.scenes for case in table.cases):
            key = (scene, case.made_with(scene, scale), seed)
            if options.scene not in (None, scene) or not _is_wanted(case.title, options.case) or key in done:
                continue
            done.add(key)
            picture = picture_of(options.work, scene, scale, case) if seed == 0 else None
            jobs.append((case, scene, scale.name, seed, options.work, tuple(options.lpips), picture))
    return jobs


def _is_wanted(title: str, beginnings: Sequence[str] | None) -> bool:
    return beginnings is None or any(title.startswith(beginning) for beginning in beginnings)


def _truth(scene: str, scale: Scale, table: Table, work: Path) -> Path:
    """Folder of the photos that are scored."""
    unseen: Photos = table.cases[0].photos(scene, scale)[1]
    return work / unseen.name


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
