"""Whole models of the bundled scene: splats alone, and with mirrored light learned in several ways, on unseen views."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from groundstation.services.scenes.photos import render_photos
from reconstruction.light.photo_set import read_photo_set
from reconstruction.scenes.parameters import SceneRequest
from reconstruction.training.config import LightSetting, TrainConfig
from reconstruction.training.model.score import mean_of, score_views
from reconstruction.training.train import train_model
from tests.benchmarks.experiments import on_one_thread
from tests.benchmarks.harness import Benchmark, Context, Row, timer

N_VIEWS, WIDTH_PX = 60, 128
QUICK_N_VIEWS, QUICK_WIDTH_PX = 10, 48

KINDS: tuple[tuple[str, str, LightSetting], ...] = (
    ("2DGS", "2dgs", "auto"),
    ("with an environment map", "reflight", "environment-map"),
    ("with the Reflection MLP", "reflight", "mlp"),
    ("with a radiance grid", "reflight", "radiance-grid"),
)


def measure(context: Context) -> Iterator[Row]:
    """Each kind of model, of the same photos and with the same number of steps."""
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if context.is_quick else (N_VIEWS, WIDTH_PX)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "planar"
        render_photos(SceneRequest("planar", n_views=n_views, width_px=width), folder, 1)
        source = read_photo_set(folder)
        found: dict[str, float] = {}
        for name, method, light in KINDS:
            with timer() as seconds:
                begun_s = time.process_time()
                trained = train_model(folder, on_one_thread(_config(context.is_quick, method, light)))
                processor_s = time.process_time() - begun_s
            scores = score_views(trained, source, trained.record.held_out)
            found[name] = mean_of(score.facade.psnr_db for score in scores) or 0.0
            whole = mean_of(score.whole.psnr_db for score in scores) or 0.0
            beside = f"whole pictures {whole:.1f} dB; {trained.n_splats} splats, {trained.n_steps} steps"
            yield Row("planar", f"{name}, facades of unseen views", round(found[name], 2), "dB", None, beside)
            yield Row(
                "planar", f"{name}, training", round(seconds(), 1), "s", None, f"{processor_s:.0f} s of processor"
            )
    gained = max(value for name, value in found.items() if name != "2DGS") - found["2DGS"]
    target = ("", None) if context.is_quick else ("above 2DGS", gained > 0.0)
    yield Row("planar", "the best above 2DGS", round(gained, 2), "dB", None, "", *target)


def _config(is_quick: bool, method: str, light: LightSetting) -> TrainConfig:
    config = TrainConfig(method=method, light=light, iterations=700, n_splats=8000, max_splats=16_000)
    if not is_quick:
        return replace(config, reflections=replace(config.reflections, steps=500))
    reflections = replace(config.reflections, steps=10, batch=256)
    return replace(config, iterations=10, n_splats=500, reflections=reflections)


BENCHMARK = Benchmark(
    "models",
    "Models of splats and mirrored light",
    f"{N_VIEWS} rendered photos of {WIDTH_PX} x 96 pixels of the bundled planar scene, near field; 15 % of the views "
    "held out. 700 steps of the joint training of 8000 splats to begin with, light learned alone for 500 steps before, "
    "on one thread. PSNR of facades and of whole pictures, mean over the views held out.",
    measure,
)
