"""How large the tables' cases are: for seconds, for hours of two cores, or as in the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from reconstruction.light.config import ReflectionConfig
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.training.config import TrainConfig
from reconstruction.training.method_registry import METHODS
from reconstruction.training.presets import preset

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
    own
        Settings of `TrainConfig`, as in TOML, by method: those that were found to bring it more in the same time. A
        case's own ones come after them.
    longer, larger
        The same of trainings that take longer, and of those from larger photos: larger networks pay there.
    """

    name: str
    n_views: int
    width_px: int
    n_unseen: int
    config: TrainConfig
    widths: tuple[int, int]
    layers: tuple[int, int]
    orders: tuple[int, int, int, int]
    own: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    longer: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    larger: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def says_something(self) -> bool:
        """Whether methods can be told apart by its numbers."""
        return self.config.iterations >= LEAST_STEPS

    @property
    def shape(self) -> MlpShape:
        """Of the Reflection MLP in case 4 of Table 4, and in the others where `own` says nothing."""
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


OF_PAPER: dict[str, Any] = {
    "light_share": 0.4,
    "reflections": {
        "steps": 20_000,
        "batch": 2048,
        "mlp_decay": 0.3,
        "mlp": {"width": 128, "position_order": 4, "direction_order": 4},
    },
}
"""For RefGlass-GS and its ablations: many small steps of light alone, and time for joint ones, which are dear."""

SMALL = replace(
    _scale(
        "small",
        (510, 128, 60),
        TrainConfig(
            time_limit_s=600.0,
            light_share=0.6,
            n_splats=8000,
            max_splats=20_000,
            reflections=ReflectionConfig(steps=3500, passes=60.0, mlp_decay=0.0),
            score_every_s=60.0,
        ),
        (128, 256),
        (4, 6),
        (6, 8, 10, 12),
        4,
    ),
    own={name: OF_PAPER for name in METHODS if name.startswith("refglass-gs")},
    longer={"refglass-gs": {"reflections": {"mlp": {"width": 256, "position_order": 6, "direction_order": 5}}}},
    larger={"refglass-gs": {"reflections": {"mlp": {"width": 192, "position_order": 5, "direction_order": 5}}}},
)
"""Hours of two cores; each training 600 s of one."""

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
