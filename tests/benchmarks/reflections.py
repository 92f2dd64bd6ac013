"""Models of reflections: what each is worth on unseen views, and what photos that lack the near field cost."""

from __future__ import annotations

import statistics
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from groundstation.services.scene_photos import photograph_files
from groundstation.services.scene_views import SceneWish
from reconstruction.reflections.config import ReflectionConfig
from reconstruction.reflections.downstream import downstream_psnr
from reconstruction.reflections.reflection_mlp import MlpShape
from reconstruction.reflections.reflective_panels import ModelName
from reconstruction.scenes.effect_names import NEAR_FIELD
from reconstruction.scenes.renderer import RenderSettings
from tests.benchmarks.harness import Benchmark, Context, Row, stopwatch

WIDTH_PX, QUICK_WIDTH_PX = 128, 64
N_VIEWS, QUICK_N_VIEWS = 100, 12
SEEDS, QUICK_SEEDS = (0, 1, 2), (0,)
TABLE_STEPS = 400
"""Of the map and the harmonics, whose curves are flat from there on."""

NEAR_DB, FAR_DB = 3.0, 0.3
QUICK = ReflectionConfig(mlp=MlpShape(32, 4, 4, 3), steps=60, batch=1024)

Scores = dict[ModelName, list[float]]


def measure(context: Context) -> Iterator[Row]:
    """The bundled planar scene, with what is near and without."""
    with tempfile.TemporaryDirectory() as place:
        for scene in ("planar", "planar-far"):
            folder = _rendered(scene, Path(place) / scene, context.is_quick, RenderSettings())
            scores: Scores = {}
            for model in ("mlp", "environment-map", "harmonics"):
                yield from _model(scene, folder, model, context.is_quick, scores)
            yield _difference(scene, scores, context.is_quick)
            if scene == "planar":
                yield _without_near_field(folder, scores["mlp"][0], context.is_quick)


def _rendered(scene: str, folder: Path, is_quick: bool, settings: RenderSettings) -> Path:
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    photograph_files(SceneWish(scene, n_views=n_views, width_px=width, n_points=0, settings=settings), folder, 1)
    return folder


def _config(model: ModelName, is_quick: bool, seed: int) -> ReflectionConfig:
    config = replace(QUICK if is_quick else ReflectionConfig(), seed=seed)
    return config if model == "mlp" or is_quick else replace(config, steps=TABLE_STEPS)


def _model(scene: str, folder: Path, model: ModelName, is_quick: bool, scores: Scores) -> Iterator[Row]:
    """Scores of a model, and how long it takes from the folder to the score."""
    means, worst = [], []
    seeds = QUICK_SEEDS if is_quick else SEEDS
    with stopwatch() as seconds:
        for seed in seeds:
            score = downstream_psnr(folder, folder, model, _config(model, is_quick, seed)).score
            means.append(score.mean_db)
            worst.append(score.worst_db)
    scores[model] = means
    beside = f"worst view {min(worst):.1f} dB; seeds {', '.join(f'{mean:.2f}' for mean in means)}"
    yield Row(scene, f"{model}, unseen views", round(statistics.fmean(means), 2), "dB", None, beside, seeds=len(seeds))
    yield Row(scene, f"{model}, folder to score", round(seconds() / len(seeds), 1), "s", seeds=len(seeds))


def _difference(scene: str, scores: Scores, is_quick: bool) -> Row:
    """The MLP against the better of the cheaper models."""
    cheaper = [max(pair) for pair in zip(scores["environment-map"], scores["harmonics"], strict=True)]
    gained = statistics.fmean(one - other for one, other in zip(scores["mlp"], cheaper, strict=True))
    is_near = scene == "planar"
    target, met = (
        (f"at least {NEAR_DB:g} dB", gained >= NEAR_DB) if is_near else (f"at most {FAR_DB:g} dB", gained <= FAR_DB)
    )
    wished = ("", None) if is_quick else (target, met)
    what = "mlp above the better cheaper model"
    return Row(scene, what, round(gained, 2), "dB", None, "", *wished, seeds=len(cheaper))


def _without_near_field(folder: Path, right_db: float, is_quick: bool) -> Row:
    """Learned from photos in which glass mirrors one picture of the surroundings, scored on the true ones.

    `right_db` was scored by what learned from the true ones, with the first seed.
    """
    wrong = _rendered("planar", folder.parent / "wrong", is_quick, RenderSettings(wishes={NEAR_FIELD: "off"}))
    wrong_db = downstream_psnr(wrong, folder, "mlp", _config("mlp", is_quick, SEEDS[0])).score.mean_db
    beside = f"{right_db:.2f} dB learned from photos with it, {wrong_db:.2f} dB without"
    lost = round(right_db - wrong_db, 2)
    return Row("planar", "lost where photos lack near-field reflection", lost, "dB", None, beside)


BENCHMARK = Benchmark(
    "reflections",
    "Models of reflections",
    f"Learned from {N_VIEWS} rendered photos of {WIDTH_PX} x 96 pixels of the bundled planar scene, near and far, on "
    "the rays of glass pixels alone; scored on glass pixels of the 15 % of views that were held out: mean and worst "
    "view. `mlp` is the Reflection MLP of 4 x 128, `environment-map` light by direction, `harmonics` a texture of "
    "spherical harmonics of degree 3 as splats without reflections have it. Seconds include reading the folder, "
    "learning on one thread, and scoring.",
    measure,
)
