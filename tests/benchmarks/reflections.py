"""Models of mirrored light: dB on unseen views against photos and seconds, near field and far."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from reconstruction.light.choose_light import choose_light
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.reflective_panels import ModelName
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

WIDTH_PX, N_VIEWS = 128, 100
SEEDS, QUICK_SEEDS = (0, 1, 2), (0,)
NEAR, FAR = ("planar", "curved"), ("planar-far", "curved-far")

LIGHTS: tuple[ModelName, ...] = ("harmonics", "environment-map", "mlp", "radiance-grid")
HALF = "radiance-grid, half the photos and time"
BETTER_DB, FAR_DB = 4.0, 0.3


def measure(context: Context) -> Iterator[Row]:
    """Near scenes with all models, the grid with half of the photos and time too; far ones with what is chosen."""
    is_quick = context.is_quick
    seeds = QUICK_SEEDS if is_quick else SEEDS
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    course = quick_course if is_quick else full_course
    with tempfile.TemporaryDirectory() as place:
        folders = [rendered(scene, Path(place) / scene, n_views, width) for scene in (*NEAR, *FAR)]
        for folder, found in zip(folders, courses(course, folders, seeds), strict=True):
            scene = folder.name
            yield from result_rows(scene, found)
            if scene in NEAR:
                least = None if is_quick else BETTER_DB
                yield gain_row(scene, "grid with half of both above the mlp", found, HALF, ["mlp"], least)
            else:
                least = None if is_quick else -FAR_DB
                others = ("mlp", "radiance-grid")
                yield gain_row(scene, "environment map above both others", found, "environment-map", others, least)
            yield _choice(folder, is_quick)


def full_course(folder: Path, seed: int) -> Results:
    """All models of light, as they are by default."""
    return _course(folder, seed, ReflectionConfig())


def quick_course(folder: Path, seed: int) -> Results:
    """The same for seconds."""
    return _course(folder, seed, QUICK)


def _course(folder: Path, seed: int, config: ReflectionConfig) -> Results:
    experiment = Experiment(folder, seed)
    found = {name: experiment.run(name, config) for name in LIGHTS}
    if folder.name in NEAR:
        found[HALF] = experiment.run("radiance-grid", config, 0.5, 0.5 * found["mlp"].seconds)
    return found


def _choice(folder: Path, is_quick: bool) -> Row:
    """What the scene is found to call for, and how long that takes."""
    source = read_photo_set(folder)
    begun_s = time.process_time()
    rays = glass_rays(source, source.photos)
    name, decisions = choose_light(rays, source.panels, QUICK if is_quick else ReflectionConfig())
    seconds = time.process_time() - begun_s
    right = "radiance-grid" if folder.name in NEAR else "environment-map"
    target = ("", None) if is_quick else (right, name == right)
    beside = f"{name}: {decisions[-1].reason}" if decisions else name
    return Row(folder.name, "choice of a model", round(seconds, 1), "s", None, beside, *target)


BENCHMARK = Benchmark(
    "reflections",
    "Models of mirrored light",
    f"Learned from {N_VIEWS} rendered photos of {WIDTH_PX} x 96 pixels less the 15 % that are held out, on the rays of "
    "glass pixels alone; scored on glass pixels of the views held out: mean and worst view. `mlp` is the Reflection "
    "MLP of 4 x 128, `environment-map` light by direction, `radiance-grid` density and light before the facade that "
    "mirrored rays march through, `harmonics` none of them. Seconds are processor time of learning with one thread of "
    "torch; the grid with half of the photos ends after half of the MLP's.",
    measure,
)
