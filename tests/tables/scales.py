"""How large the tables' cases are: for seconds, for hours of two cores, or as in the paper."""

from __future__ import annotations

from dataclasses import dataclass, replace

from reconstruction.modelling.config import TrainConfig
from reconstruction.modelling.presets import preset
from reconstruction.reflections.config import GridSettings, ReflectionConfig
from reconstruction.reflections.reflection_mlp import MlpShape

LEAST_STEPS = 1000
"""Of a training that says something of its method."""


@dataclass(frozen=True, slots=True)
class Scale:
    """Photos and trainings of a scale.

    Parameters
    ----------
    n_views, width_px
        Photos to learn from, and their width; 3/4 of it high.
    n_unseen
        Photos that are scored: from places and directions drawn at random, of which no plan knows.
    config
        Of all trainings, before a method's own settings.
    shapes
        Of Table 4 in the place of the paper's widths of 256 and 512, layers of 6 and 8, and orders of 10, 12, 14, 16.
    """

    name: str
    n_views: int
    width_px: int
    n_unseen: int
    config: TrainConfig
    widths: tuple[int, int]
    layers: tuple[int, int]
    orders: tuple[int, int, int, int]

    @property
    def says_something(self) -> bool:
        """Whether methods can be told apart by its numbers."""
        return self.config.iterations >= LEAST_STEPS

    @property
    def shape(self) -> MlpShape:
        """Of the Reflection MLP in all other tables: case 4 of Table 4."""
        return self.config.reflections.mlp


def _scale(
    name: str,
    photos: tuple[int, int, int],
    config: TrainConfig,
    widths: tuple[int, int],
    layers: tuple[int, int],
    orders: tuple[int, int, int, int],
    direction_order: int,
) -> Scale:
    shape = MlpShape(widths[1], layers[1], orders[1], direction_order)
    config = replace(config, held_out=0.02, reflections=replace(config.reflections, mlp=shape))
    return Scale(name, *photos, config, widths, layers, orders)


SMALL = _scale(
    "small",
    (510, 128, 60),
    TrainConfig(
        time_limit_s=1800.0,
        light_share=0.4,
        n_splats=8000,
        max_splats=20_000,
        reflections=ReflectionConfig(steps=20_000, batch=2048, passes=60.0, grid=GridSettings(batch_share=1.5)),
        score_every_s=60.0,
    ),
    (128, 256),
    (4, 6),
    (3, 5, 7, 9),
    5,
)
"""A day of two cores; each training 1800 s of one at most."""

SMOKE = _scale(
    "smoke",
    (12, 64, 4),
    replace(
        preset("smoke"),
        iterations=12,
        n_splats=300,
        max_splats=400,
        reflections=ReflectionConfig(steps=12, batch=256, environment_rows=16),
    ),
    (8, 16),
    (2, 3),
    (2, 3, 4, 5),
    2,
)
"""Seconds; shows that everything works, and nothing else."""

PAPER = _scale(
    "paper", (600, 5280, 60), replace(preset("overnight"), device="cuda"), (256, 512), (6, 8), (10, 12, 14, 16), 12
)
"""The paper's photos, steps and network, for a computer with CUDA; never run."""

SCALES = {scale.name: scale for scale in (SMALL, SMOKE, PAPER)}
