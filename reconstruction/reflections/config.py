"""How a model of reflections is trained: one frozen configuration, every value with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from reconstruction.reflections.reflection_mlp import MlpShape

Precision = Literal["auto", "float32", "bfloat16"]

LEAST_STEPS = 300
"""Of a training on few rays: below, not even what is far away is learned."""


@dataclass(frozen=True, slots=True)
class HighFrequencyStage:
    """One step of the schedule of the high-frequency loss (paper Eq. 24).

    Parameters
    ----------
    threshold
        tau: rays whose colour, 0 to 1, is off by more, added up over red, green and blue, are looked at again.
    weight
        lambda_hf (Eq. 27).
    """

    threshold: float
    weight: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.threshold) and self.threshold >= 0.0):
            raise ValueError(f"threshold: expected 0 or more, got {self.threshold}")
        if not (math.isfinite(self.weight) and self.weight >= 0.0):
            raise ValueError(f"weight: expected 0 or more, got {self.weight}")


PAPER_STAGES = tuple(
    HighFrequencyStage(threshold, weight) for threshold, weight in ((0.2, 1.0), (0.15, 4.0), (0.12, 7.0), (0.09, 10.0))
)
"""From tau 0.2 and weight 1 to 0.09 and 10; the paper gives the ends only, and says "stepwise"."""


@dataclass(frozen=True, slots=True)
class ReflectionConfig:
    """Settings of a training.

    Parameters
    ----------
    mlp
        Shape of the Reflection MLP. The paper's 8 x 512 takes about 15 times as long as 4 x 128.
    environment_rows
        Of the finest picture of the environment map: 1.4 degrees a pixel.
    places
        Of harmonics, along each side of a panel.
    diffuse_degree
        Of the diffuse colour c beside a model of reflections; `harmonics`, which is c alone, has 3. With 0 the rooms
        that are seen through glass cost 1 dB; with the paper's 3 the MLP scores the same with 180 photos, and 0.35 dB
        less with 51.
    steps, batch
        Of Adam at most, and rays in each (drawn with replacement).
    passes
        Steps end, too, when every ray was looked at so often on average, though not before `LEAST_STEPS`. More of them
        fit the views that there are and not those that there are not: with 51 photos 31 passes scored 0.7 dB less.
    mlp_rate, table_rate, panel_rate
        Learning rates of the MLP, of tables (map, harmonics), and of what panels are made of.
    last_rate
        Share of the rates that is left at the end of half a cosine.
    warm_up
        Steps in which the rates rise from 0. Without, the MLP scored the same on rendered photos, but 3 % of its units
        died and not 0.4 %; at higher rates all of them do.
    high_frequency
        Stages of the high-frequency loss, equally long; none for the mean error alone. The paper's changed scores by
        0.04 dB with 51 rendered photos and by -0.1 dB with 180.
    precision
        Of the matrix products; features, colours and weights are float32 always. `auto` times both, once in a process.
    threads
        Of torch; with one the same seed gives the same bits.
    time_limit_s
        After which it ends, with the rates at their last; None for no limit.
    held_out
        Share of the views that are kept for scoring.
    seed
        Of weights, batches, the split, and the choice of rays where they are too many.
    memory_bytes
        For rays.
    """

    mlp: MlpShape = field(default_factory=lambda: MlpShape(width=128, layers=4, position_order=8, direction_order=4))
    environment_rows: int = 128
    places: int = 3
    diffuse_degree: int = 1
    steps: int = 1000
    batch: int = 8192
    passes: float = 9.0
    mlp_rate: float = 6e-3
    table_rate: float = 2e-2
    panel_rate: float = 1e-2
    last_rate: float = 0.02
    warm_up: int = 100
    high_frequency: tuple[HighFrequencyStage, ...] = ()
    precision: Precision = "auto"
    threads: int = 1
    time_limit_s: float | None = None
    held_out: float = 0.15
    seed: int = 0
    memory_bytes: int = 1 << 30

    def __post_init__(self) -> None:
        for name in ("steps", "batch", "threads", "memory_bytes"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}: expected 1 or more, got {getattr(self, name)}")
        for name in ("mlp_rate", "table_rate", "panel_rate", "passes"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name}: expected more than 0, got {getattr(self, name)}")
        if not 0.0 < self.last_rate <= 1.0:
            raise ValueError(f"last_rate: expected above 0, at most 1, got {self.last_rate}")
        if self.warm_up < 0:
            raise ValueError(f"warm_up: expected 0 or more, got {self.warm_up}")
        if not 0.0 < self.held_out < 1.0:
            raise ValueError(f"held_out: expected above 0 and below 1, got {self.held_out}")
        if self.time_limit_s is not None and not self.time_limit_s > 0.0:
            raise ValueError(f"time_limit_s: expected more than 0, got {self.time_limit_s}")

    def steps_for(self, n_rays: int) -> int:
        """Steps of a training on so many rays."""
        return min(self.steps, max(LEAST_STEPS, math.ceil(self.passes * n_rays / self.batch)))

    def rate(self, step: int, progress: float) -> float:
        """Share of the learning rates: rising over the warm-up, and falling along half a cosine.

        Parameters
        ----------
        progress
            Of the whole training, 0 to 1, by steps or by time, whichever is further.
        """
        cosine = 0.5 * (1.0 + math.cos(math.pi * min(progress, 1.0)))
        return min(1.0, (step + 1) / (self.warm_up + 1)) * (self.last_rate + (1.0 - self.last_rate) * cosine)

    def stage(self, progress: float) -> HighFrequencyStage | None:
        """Of the high-frequency loss, by progress, 0 to 1."""
        n_stages = len(self.high_frequency)
        return self.high_frequency[min(int(progress * n_stages), n_stages - 1)] if n_stages else None
