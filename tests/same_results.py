"""Whether another version gives the same results: `python -m tests.same_results TREE [--out DIR]`.

TREE is a checkout of the other version. Both plan two bundled sites, write the plan in every mission format, render
photos and train two methods on them, with one seed and by the command line. Every difference is a line, but for times:
those in plans, and when a DJI file was made. `--settings MINE OTHER` names TOML files of the two versions' trainings,
for a version that has effects which the other lacks.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from safetensors.numpy import load_file

from planning.site.bundled import write_scene

ROOT = Path(__file__).parents[1]
SITES, METHODS = ("office", "court"), ("2dgs", "refglass-gs")
FORMATS = {"dji-kmz": "kmz", "mavlink-plan": "plan", "mavlink-wpl": "waypoints", "kml": "kml", "csv": "csv"}
# All of the search ends before the time does, so that the machine's speed decides nothing.
PLAN = [
    "--coverage",
    "0.9",
    "--seed",
    "7",
    "--occlusion",
    "on",
    "--min-distance",
    "10",
    "--step",
    "30",
    "--precision",
    "f64",
    "--time-budget",
    "600",
]
SCENE = ["--views", "12", "--width", "96", "--seed", "3"]
TRAIN = ["--preset", "smoke", "--iterations", "60", "--seed", "5"]
TIMED = {"history": None, "effects": None}
"""Of a plan: seconds of the search, and what effects are expected to cost."""


def make(tree: Path, out: Path, sites: Path, settings: Path | None) -> None:
    """All results of one version; the sites are those in `sites`, `settings` are of its trainings."""

    def run(*words: str | Path) -> None:
        environment = os.environ | {"PYTHONPATH": str(tree)}
        subprocess.run([sys.executable, tree / "app.py", *words], check=True, env=environment, capture_output=True)

    for name in SITES:
        site, plan = sites / name / f"{name}.site.json", out / f"{name}.plan.json"
        run("plan", site, "-o", plan, *PLAN)
        for kind, ending in FORMATS.items():
            run("export", plan, "--site", site, "--format", kind, "-o", out / f"{name}.{ending}")
    run("scene", "render", "planar", "-o", out / "photos", *SCENE)
    given = [] if settings is None else ["--settings", settings.resolve()]
    for method in METHODS:
        run("train", out / "photos", "-o", out / f"{method}.model", "--method", method, *TRAIN, *given)


def content(path: Path) -> Any:
    """What is compared of a file."""
    if path.suffix == ".json":
        found = json.loads(path.read_bytes())
        return {**found, **TIMED} if path.name.endswith("plan.json") else found
    if path.suffix == ".kmz":
        with zipfile.ZipFile(path) as archive:
            return [re.sub(rb"Time>\d+<", b"Time><", archive.read(name)) for name in archive.namelist()]
    if path.suffix == ".safetensors":
        return {name: values.tobytes() for name, values in load_file(path).items()}
    return path.read_bytes()


def results(folder: Path) -> Iterator[Path]:
    """Files that are compared; weights have a name by their content, which is taken off."""
    for path in folder.rglob("*"):
        if path.match("*.model/weights-*.safetensors"):
            yield path.replace(path.with_name("weights.safetensors"))
        elif path.is_file() and ".model" not in path.parent.name:
            yield path


def differences(mine: Path, other: Path) -> Iterator[str]:
    """Files that differ or that one version alone has; of trainings their weights."""
    names = {path.relative_to(folder) for folder in (mine, other) for path in results(folder)}
    for name in sorted(names):
        pair = [folder / name for folder in (mine, other)]
        if not all(path.is_file() for path in pair):
            yield f"{name}: only in one of them"
        elif content(pair[0]) != content(pair[1]):
            yield f"{name}: differs"


def main() -> int:
    """Compare; 1 where something differs."""
    parser = argparse.ArgumentParser(prog="python -m tests.same_results", description=__doc__)
    parser.add_argument("tree", type=Path, metavar="TREE")
    parser.add_argument("--out", type=Path, metavar="DIR", help="keep the results in this new folder")
    parser.add_argument("--settings", type=Path, nargs=2, default=(None, None), metavar=("MINE", "OTHER"))
    options = parser.parse_args()
    out = (options.out or Path(tempfile.mkdtemp())).resolve()
    for name in SITES:
        (out / "sites" / name).mkdir(parents=True)
        write_scene(name, out / "sites" / name)
    trees = (("mine", ROOT), ("other", options.tree.resolve()))
    for (label, tree), settings in zip(trees, options.settings, strict=True):
        (out / label).mkdir(parents=True)
        make(tree, out / label, out / "sites", settings)
    found = list(differences(out / "mine", out / "other"))
    print("\n".join(found) or "no difference")  # noqa: T201
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
