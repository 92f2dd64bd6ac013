"""Settings by how long one can wait; measured, see docs/concepts/training.md."""

from __future__ import annotations

from dataclasses import replace

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.light.config import LEAST_STEPS, GridSettings, ReflectionConfig
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.training.config import TrainConfig
from reconstruction.training.parameters import PRESETS, TrainRequest

LEAST_LIGHT_STEPS = 20
"""Of learning light alone, in however short a training."""

MINUTE_S = 60.0

PAPER_MLP = MlpShape(width=512, layers=8, position_order=12, direction_order=12)

_CONFIGS = {
    "10min": TrainConfig(),
    "1h": TrainConfig(
        iterations=30_000,
        n_splats=25_000,
        max_splats=80_000,
        reflections=ReflectionConfig(
            mlp=MlpShape(width=256, layers=6, position_order=10, direction_order=6),
            steps=20_000,
            passes=20.0,
        ),
    ),
    "overnight": TrainConfig(
        iterations=200_000,
        n_splats=60_000,
        max_splats=300_000,
        reflections=ReflectionConfig(mlp=PAPER_MLP, steps=20_000, passes=60.0),
    ),
    "smoke": TrainConfig(
        iterations=60,
        n_splats=1500,
        max_splats=2500,
        reflections=ReflectionConfig(steps=60, batch=1024, environment_rows=32, grid=GridSettings(most_cells=1 << 18)),
        score_every_s=5.0,
    ),
}


def preset(name: str) -> TrainConfig:
    """Settings of a preset.

    Raises
    ------
    InputError
        There is none of that name.
    """
    if name not in _CONFIGS:
        raise InputError(say("expected {}, got '{}'", ", ".join(PRESETS), name, place="--preset"))
    row = PRESETS[name]
    limit_s = None if row.minutes is None else row.minutes * MINUTE_S
    return replace(_CONFIGS[name], time_limit_s=limit_s, window_px=row.window_px)


def with_request(base: TrainConfig, request: TrainRequest) -> TrainConfig:
    """Settings with what was asked for by itself; iterations alone take the preset's time limit away.

    Raises
    ------
    ValueError
        A value is out of range.
    """
    if request.iterations is not None:
        # Fewer steps learn light for a shorter time, too, but not so much shorter that nothing is learned.
        full, share = base.reflections.steps, min(1.0, request.iterations / base.iterations)
        steps = max(LEAST_LIGHT_STEPS, round(share * full), min(LEAST_STEPS, request.iterations, full))
        base = replace(base, time_limit_s=None, reflections=replace(base.reflections, steps=steps))
    names = ("light", "iterations", "time_limit_s", "seed", "device", "memory_bytes")
    values = {name: value for name in names if (value := getattr(request, name)) is not None}
    return replace(base, **values)
