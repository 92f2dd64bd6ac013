"""Models of mirrored light that learn from hundreds of photos: where the Reflection MLP is at its best."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from reconstruction.light.config import ReflectionConfig
from reconstruction.light.reflection_mlp import MlpShape
from tests.benchmarks.experiments import (
    QUICK,
    QUICK_N_VIEWS,
    QUICK_WIDTH_PX,
    Experiment,
    Results,
    courses,
    gain_row,
    rendered,
    result_rows,
)
from tests.benchmarks.harness import Benchmark, Context, Row

SCENES, WIDTH_PX, N_VIEWS = ("planar", "curved"), 128, 600
SEEDS, QUICK_SEEDS = (0, 1, 2), (0,)

MLP_DB, LONGEST_S = 3.0, 600.0

LONGER = "environment-map, as many steps as the mlp"

FULL = ReflectionConfig(mlp=MlpShape(256, 6, 8, 4), steps=3500, passes=60.0)
"""Larger and longer than by default, as so many photos allow."""


def measure(context: Context) -> Iterator[Row]:
    """The MLP against light that knows no places."""
    is_quick = context.is_quick
    seeds = QUICK_SEEDS if is_quick else SEEDS
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    with tempfile.TemporaryDirectory() as place:
        folders = [rendered(scene, Path(place) / scene, n_views, width) for scene in SCENES]
        for folder, found in zip(
            folders, courses(quick_course if is_quick else full_course, folders, seeds), strict=True
        ):
            scene = folder.name
            yield from result_rows(scene, found)
            others = ("environment-map", LONGER, "harmonics")
            yield gain_row(scene, "mlp above all others", found, "mlp", others, None if is_quick else MLP_DB)
            longest = max(each.seconds for course in found for each in course.values())
            target = ("", None) if is_quick else (f"under {LONGEST_S:g} s", longest < LONGEST_S)
            yield Row(scene, "longest training", round(longest), "s", None, "", *target, seeds=len(seeds))


def full_course(folder: Path, seed: int) -> Results:
    """Longer than by default."""
    return _course(folder, seed, FULL, ReflectionConfig())


def quick_course(folder: Path, seed: int) -> Results:
    """The same for seconds."""
    return _course(folder, seed, QUICK, QUICK)


def _course(folder: Path, seed: int, config: ReflectionConfig, short: ReflectionConfig) -> Results:
    experiment = Experiment(folder, seed)
    return {
        "harmonics": experiment.run("harmonics", short),
        "environment-map": experiment.run("environment-map", short),
        LONGER: experiment.run("environment-map", config),
        "mlp": experiment.run("mlp", config),
    }


BENCHMARK = Benchmark(
    "reflections-many",
    "Models of mirrored light with many photos",
    f"As above with {N_VIEWS} photos, of which 510 are learned from. `mlp` is the Reflection MLP of 6 x 256 with 3500 "
    "steps; `environment-map` and `harmonics` are as by default.",
    measure,
)
