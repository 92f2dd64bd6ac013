"""Models of mirrored light: dB on unseen views against photos and seconds, near field and far."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from groundstation.services.scene_photos import photograph_files
from groundstation.services.scene_views import SceneWish
from reconstruction.reflections.choose_light import choose_light
from reconstruction.reflections.config import GridSettings, ReflectionConfig
from reconstruction.reflections.glass_rays import glass_rays
from reconstruction.reflections.photo_set import PhotoSet, held_out_names, read_photo_set
from reconstruction.reflections.reflection_mlp import MlpShape
from reconstruction.reflections.reflective_panels import ModelName
from reconstruction.reflections.scoring import score_views
from reconstruction.reflections.training import train_reflections
from reconstruction.scenes.renderer import RenderSettings
from tests.benchmarks.harness import Benchmark, Context, Row

WIDTH_PX, QUICK_WIDTH_PX = 128, 64
N_VIEWS, QUICK_N_VIEWS = 100, 12
SEEDS, QUICK_SEEDS = (0, 1, 2), (0,)
NEAR, FAR = ("planar", "curved"), ("planar-far",)

BETTER_DB, FAR_DB = 4.0, 0.3
QUICK = ReflectionConfig(
    mlp=MlpShape(32, 4, 4, 3), grid=GridSettings(most_cells=4096, levels=1), steps=60, batch=1024, environment_rows=32
)


@dataclass(frozen=True, slots=True)
class Learned:
    """Scores of a model, seed by seed, and the processor time of its training."""

    scores_db: tuple[float, ...]
    worst_db: float
    seconds: float

    @property
    def mean_db(self) -> float:
        """Mean of the seeds."""
        return statistics.fmean(self.scores_db)


def measure(context: Context) -> Iterator[Row]:
    """Near scenes with all models, the grid with half of the photos and time too; a far one with what is chosen."""
    is_quick = context.is_quick
    seeds = QUICK_SEEDS if is_quick else SEEDS
    with tempfile.TemporaryDirectory() as place:
        for scene in NEAR:
            source = _rendered(scene, Path(place) / scene, is_quick)
            mlp = _learned(source, "mlp", is_quick, seeds)
            half = _learned(source, "radiance-grid", is_quick, seeds, 0.5, 0.5 * mlp.seconds)
            grid = _learned(source, "radiance-grid", is_quick, seeds[:1])
            far = _learned(source, "environment-map", is_quick, seeds[:1])
            yield from _rows(scene, "mlp", mlp)
            yield from _rows(scene, "environment-map", far)
            yield from _rows(scene, "radiance-grid", grid)
            yield from _rows(scene, "radiance-grid, half the photos and time", half)
            gained = half.mean_db - mlp.mean_db
            wished = ("", None) if is_quick else (f"at least {BETTER_DB:g} dB", gained >= BETTER_DB)
            what = "grid with half of both above the mlp"
            yield Row(scene, what, round(gained, 2), "dB", None, "", *wished, seeds=len(seeds))
            yield _choice(scene, source, is_quick)
        for scene in FAR:
            source = _rendered(scene, Path(place) / scene, is_quick)
            far, grid = (_learned(source, name, is_quick, seeds[:1]) for name in ("environment-map", "radiance-grid"))
            yield from _rows(scene, "environment-map", far)
            yield from _rows(scene, "radiance-grid", grid)
            gained = grid.mean_db - far.mean_db
            wished = ("", None) if is_quick else (f"at most {FAR_DB:g} dB", gained <= FAR_DB)
            yield Row(scene, "grid above the environment map", round(gained, 2), "dB", None, "", *wished, seeds=1)
            yield _choice(scene, source, is_quick)


def _rendered(scene: str, folder: Path, is_quick: bool) -> PhotoSet:
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    wish = SceneWish(scene, n_views=n_views, width_px=width, n_points=0, settings=RenderSettings())
    photograph_files(wish, folder, 1)
    return read_photo_set(folder)


def _learned(
    source: PhotoSet,
    model: ModelName,
    is_quick: bool,
    seeds: tuple[int, ...],
    share: float = 1.0,
    limit_s: float | None = None,
) -> Learned:
    """Of a share of the photos that are not held out, within a limit of processor time."""
    scores, worst, seconds = [], [], []
    for seed in seeds:
        config = replace(QUICK if is_quick else ReflectionConfig(), seed=seed, time_limit_s=limit_s)
        held_out = held_out_names([photo.name for photo in source.photos], config.held_out, seed)
        photos = [photo for photo in source.photos if photo.name not in held_out]
        order = np.random.default_rng(seed).permutation(len(photos))
        kept = [photos[number] for number in order[: round(share * len(photos))]]
        rays = glass_rays(source, kept)
        trained = train_reflections(rays, source.panels, model, config, source.exposure, clock=time.process_time)
        score = score_views(trained, source, held_out)
        scores.append(score.mean_db)
        worst.append(score.worst_db)
        seconds.append(trained.seconds)
    return Learned(tuple(scores), min(worst), statistics.fmean(seconds))


def _rows(scene: str, name: str, learned: Learned) -> Iterator[Row]:
    beside = f"worst view {learned.worst_db:.1f} dB; seeds {', '.join(f'{score:.2f}' for score in learned.scores_db)}"
    n_seeds = len(learned.scores_db)
    yield Row(scene, f"{name}, unseen views", round(learned.mean_db, 2), "dB", None, beside, seeds=n_seeds)
    yield Row(scene, f"{name}, learning", round(learned.seconds, 1), "s", seeds=n_seeds)


def _choice(scene: str, source: PhotoSet, is_quick: bool) -> Row:
    """What the scene is found to call for, and how long that takes."""
    begun_s = time.process_time()
    rays = glass_rays(source, source.photos)
    name, decisions = choose_light(rays, source.panels, QUICK if is_quick else ReflectionConfig())
    seconds = time.process_time() - begun_s
    right = "radiance-grid" if scene in NEAR else "environment-map"
    wished = ("", None) if is_quick else (right, name == right)
    beside = f"{name}: {decisions[-1].reason}" if decisions else name
    return Row(scene, "choice of a model", round(seconds, 1), "s", None, beside, *wished)


BENCHMARK = Benchmark(
    "reflections",
    "Models of mirrored light",
    f"Learned from {N_VIEWS} rendered photos of {WIDTH_PX} x 96 pixels less the 15 % that are held out, on the rays of "
    "glass pixels alone; scored on glass pixels of the views held out: mean and worst view. `mlp` is the Reflection "
    "MLP of 4 x 128, `environment-map` light by direction, `radiance-grid` density and light before the facade that "
    "mirrored rays march through. Seconds are processor time of learning with one thread of torch; the grid with half "
    "of the photos ends after half of the MLP's.",
    measure,
)
