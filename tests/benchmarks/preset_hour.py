"""The preset of an hour at its own hour, on photos that are too large for ten minutes."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from reconstruction.tradeoff.train_tradeoff import Setting
from reconstruction.training.presets import preset
from tests.benchmarks import presets
from tests.benchmarks.experiments import rendered
from tests.benchmarks.harness import Benchmark, Context, Row

HOUR_S = 3600.0

N_VIEWS, WIDTH_PX = 100, 1024

WANTED_DB = 30.0

LOOKS = 12
"""At held-out views on the way."""


def measure(context: Context) -> Iterator[Row]:
    """One training: some held-out views on the way, all of them in the end."""
    is_quick = context.is_quick
    n_views, width = (presets.QUICK_N_VIEWS, presets.QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    config = preset("smoke") if is_quick else preset(presets.HIGHER)
    longest_s = presets.QUICK_BUDGET_S if is_quick else HOUR_S
    setting = Setting(
        f"preset {presets.HIGHER}", "its hour", replace(config, time_limit_s=longest_s, score_every_s=longest_s / LOOKS)
    )
    with tempfile.TemporaryDirectory() as place:
        found = presets.trial(rendered("planar", Path(place) / "planar", n_views, width), setting)
    for point in found.history:
        what = f"after {point.t_s / 60.0:.0f} min, facades of some unseen views"
        yield Row("planar", what, round(point.value, 2), "dB")
    beside = (
        f"whole pictures {found.whole_db:.1f} dB, SSIM of facades {found.ssim or 0.0:.3f}; {found.n_steps} steps, "
        f"{found.n_splats} splats; light: {found.light or 'splats alone'}; "
        f"on: {', '.join(found.effects) or 'no effect'}"
    )
    what = f"in the end ({found.seconds / 60.0:.0f} min), facades of unseen views"
    target, is_met = f"at least {WANTED_DB:g} dB", found.facade_db >= WANTED_DB
    yield Row("planar", what, round(found.facade_db, 2), "dB", None, beside, *(() if is_quick else (target, is_met)))


BENCHMARK = Benchmark(
    "preset-hour",
    "The preset of an hour",
    f"The preset `{presets.HIGHER}` in its own hour of processor time, half of what two cores have in an hour, on "
    f"{N_VIEWS} rendered photos of the bundled planar scene {WIDTH_PX} pixels wide, near field, 15 % of the views held "
    "out. Its rates fall until "
    "the hour ends: on the way it has less than a shorter one in the end.",
    measure,
)
