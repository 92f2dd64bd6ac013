"""Quality of unseen views against time: a preset with more and less of it, and each setting turned for itself."""

from __future__ import annotations

import multiprocessing
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

from planning.base.jit import n_threads
from planning.base.progress import QUIET
from planning.tradeoff.runner import draw
from reconstruction.tradeoff.scene_tradeoff import ERROR_AXIS
from reconstruction.tradeoff.train_tradeoff import BASE, Setting, Trial, run_settings, settings_of, trial_panels
from reconstruction.training.config import TrainConfig
from reconstruction.training.presets import preset
from tests.benchmarks.experiments import on_one_thread, rendered
from tests.benchmarks.harness import Benchmark, Context, Row

N_VIEWS, WIDTH_PX = 100, 256
QUICK_N_VIEWS, QUICK_WIDTH_PX = 10, 48

BUDGET_S, QUICK_BUDGET_S = 60.0, 6.0
MORE_AND_LESS = (0.5, 2.0, 10.0)
"""Times the budget."""

POINTS = 12
"""Looks at unseen views on the way of each."""

KNOBS: dict[str, tuple[Any, ...]] = {
    "max_splats": (12_000, 60_000),
    "reflections.grid.most_cells": (1 << 16, 1 << 18),
    "window_px": (128 * 96, 192 * 144),
    "reduce": (2,),
    "light_share": (0.2, 0.55),
    "densification": ("mcmc", "none"),
    "raster.min_transmittance": (1e-2,),
}
MLP_PRECISIONS = ("float32", "bfloat16")

HIGHER = "1h"
"""The preset that is compared with at the longest time."""


def measure(context: Context) -> Iterator[Row]:
    """The preset of ten minutes in less and more time, its settings one by one, and the next higher preset."""
    is_quick = context.is_quick
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    budget_s = QUICK_BUDGET_S if is_quick else BUDGET_S
    with tempfile.TemporaryDirectory() as place:
        folder = rendered("planar", Path(place) / "planar", n_views, width)
        turned, timed = _settings(budget_s, is_quick), _times(budget_s, is_quick)
        with ProcessPoolExecutor(n_threads(), multiprocessing.get_context("spawn")) as pool:
            # The longest first, so that none is waited for alone in the end.
            long = [pool.submit(trial, folder, setting) for setting in reversed(timed)]
            short = [pool.submit(trial, folder, setting) for setting in turned]
            found = [each.result() for each in short]
            beside = [each.result() for each in reversed(long)]
    for each in (*found, *beside):
        yield _row(each, found[0], is_quick)
    panels = [*trial_panels([found[0], *beside]), *trial_panels(found)]
    draw("planar: facades of unseen views", panels, ERROR_AXIS, context.folder / "presets.png")


def trial(folder: Path, setting: Setting) -> Trial:
    """One training, by processor time."""
    return run_settings(folder, [setting], QUIET, time.process_time)[0]


def _preset(is_quick: bool) -> str:
    return "smoke" if is_quick else "10min"


def _budget(config: TrainConfig, seconds: float) -> TrainConfig:
    return on_one_thread(replace(config, time_limit_s=seconds, score_every_s=seconds / POINTS))


def _settings(budget_s: float, is_quick: bool) -> list[Setting]:
    base = _budget(preset(_preset(is_quick)), budget_s)
    if is_quick:
        return [*settings_of(base, {"reduce": (2,)})]
    # Both precisions are of the MLP: all other lights are float32.
    mlps = settings_of(replace(base, light="mlp"), {"reflections.precision": MLP_PRECISIONS})[1:]
    return [*settings_of(base, KNOBS), *(replace(each, knob=f"mlp, {each.knob}") for each in mlps)]


def _times(budget_s: float, is_quick: bool) -> list[Setting]:
    name = _preset(is_quick)
    found = [
        Setting(f"preset {name}", f"{times * budget_s:g} s", _budget(preset(name), times * budget_s))
        for times in MORE_AND_LESS
    ]
    if is_quick:
        return found
    longest = MORE_AND_LESS[-1] * budget_s
    return [*found, Setting(f"preset {HIGHER}", f"{longest:g} s", _budget(preset(HIGHER), longest))]


def _row(each: Trial, base: Trial, is_quick: bool) -> Row:
    name = each.setting.name if each.setting.name != BASE else f"preset {_preset(is_quick)} = {base.seconds:.0f} s"
    gained = each.facade_db - base.facade_db
    beside = (
        f"{gained:+.2f} dB; whole pictures {each.whole_db:.1f} dB, SSIM of facades {each.ssim or 0.0:.3f}; "
        f"{each.n_steps} steps, {each.n_splats} splats"
    )
    return Row("planar", f"{name}, facades of unseen views", round(each.facade_db, 2), "dB", None, beside)


BENCHMARK = Benchmark(
    "presets",
    "Presets and settings against time",
    f"The preset `10min` on {N_VIEWS} rendered photos of {WIDTH_PX} x 192 pixels of the bundled planar scene, near "
    f"field, 15 % of the views held out: with {BUDGET_S:g} s of processor time and with half, twice and ten times as "
    "much, each of its settings turned for itself, and the next higher preset with the longest of these times. Two "
    "trainings run side by side, each on one thread. Changes are against the preset with the first of these times.",
    measure,
)
