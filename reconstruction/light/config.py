"""How a model of reflections is trained: one frozen configuration, every value with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Literal

from planning.base.effects import EffectSetting
from planning.base.parameters import check, parameter
from reconstruction.light.reflection_mlp import MlpShape

# What is learned of panes and photos beside the light that is mirrored.


@dataclass(frozen=True, slots=True)
class GlassLearned:
    """What is learned beside the light.

    Parameters
    ----------
    rays
        Through each pixel, a square number.
    tilts, bows
        Of each pane.
    poses
        Of each photo learned from.
    """

    rays: int = 1
    tilts: bool = False
    bows: bool = False
    poses: bool = False

    def __post_init__(self) -> None:
        if self.rays < 1 or math.isqrt(self.rays) ** 2 != self.rays:
            raise ValueError(f"rays: expected a square number, got {self.rays}")


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
class GridSettings:
    """Of a radiance grid.

    Parameters
    ----------
    most_cells
        Vertices of the finest grid at most: 16 bytes each, and 48 more while it learns. With 85 photos of 256 x 192
        pixels, in the same 45 s of processor time, a quarter of them scored 0.8 dB less: so much does a grid that is
        too coarse for the pixels cost, although its steps take 0.6 times as long. Of 512 x 384 pixels, four times as
        many scored 0.5 dB less in 40 s: there are too few steps by then. Cells cut in two along each side where rays
        end, 39 000 of them, scored 0.8 dB more on glass in the same 245 s of light alone, and 0.4 dB less on facades
        after ten minutes with splats, whose steps took half as long again. Of 1024 x 768 pixels,
        in 760 s in the place of 310, 40 000 cut in four scored 0.6 dB more on glass, and four times as many cells
        0.4 dB.
    rays_per_cell
        Rays learned from, for each vertex, at least. With 43 photos 0.9 scored 0.3 to 0.4 dB more than 1.75 in as much
        time, 1.3 about as much as 0.9.
    cell
        Target side of a cell, of what a pixel covers half way to `reach_m`. Cells longer by half or twice as long
        towards the glass, as many, scored 0.1 dB more on the planar scene and 0.1 dB less on the curved one.
    reach_m
        From the glass, up to which cells are equally large; None for 1.25 times the longest side of the box around all
        panels, which is about how far apart the cameras are, and so how far away parallax can be measured well. What is
        further away is contracted.
    outer
        Of the grid, what is beyond the inner box on each side, against half of that.
    levels
        Times that it is made twice as fine; evenly over the first `grown` of the training.
    far_side
        Pixels along the picture of what is far away by direction. Four times as many scored no more.
    places, diffuse_degree
        Of the diffuse colour c beside it, in the place of those for the other models: rooms show through the panes, and
        what is mirrored no longer hides that. Degree 2 brings 0.1 dB with 85 photos, and costs 0.3 to 0.5 dB with 43.
    rough_density, rough_light
        Weights of differences between neighbours: keep empty places smooth, and fill in what no ray has seen. With 43
        photos less than half of them, and twice as much, score the same within 0.1 dB on average; four times as much
        costs 0.1 to 0.3 dB.
    emptier
        Weight of raw density: places that no ray needs become empty, and rays leap over them. Five times as much costs
        0.1 to 0.2 dB with 43 photos, fifty times as much 0.7 dB; a quarter of it scores the same.
    rest
        Steps from one look at what is empty to the next, and of the weights above, which are applied every fourth.
    rate, tilt_rate
        Learning rates of density and light, and of c beside them; of tilts and bows of panes, and corrections of poses.
        Half of `rate` scored 0.4 to 0.8 dB less after 9 s, twice as much 0.3 dB less after 30 s.
    batch_share
        Of the configuration's batch: of so many more steps, each on fewer rays, the grid learns faster.
    squared_to
        Error of a colour, 0 to 1, up to which the loss is the error's square: of what edges show in photos with
        parallax, the mean scores better than the median. Against the plain error it brings 0.1 to 0.3 dB with 43
        photos; nothing to the MLP.
    passes
        At least: a grid goes on getting better where the MLP begins to overfit.
    warm_up
        Steps in which rates rise; it cannot die as an MLP can.
    """

    most_cells: int = parameter(1 << 20, least=64)
    rays_per_cell: float = parameter(1.0, above=0.0)
    cell: float = parameter(0.6, above=0.0)
    reach_m: float | None = parameter(None, above=0.0, most=math.inf, expected="more than 0")
    outer: float = parameter(0.5, above=0.0)
    levels: int = parameter(2, least=0)
    grown: float = parameter(0.3, least=0.0, most=1.0)
    far_side: int = 128
    places: int = 5
    diffuse_degree: int = 1
    rough_density: float = 1e-8
    rough_light: float = 1e-8
    emptier: float = 2e-10
    rest: int = parameter(25, least=1)
    rate: float = parameter(2e-2, above=0.0)
    tilt_rate: float = parameter(2e-4, above=0.0)
    batch_share: float = parameter(0.375, above=0.0)
    squared_to: float = parameter(0.1, least=0.0, most=math.inf, expected="0 or more")
    passes: float = parameter(14.0, above=0.0)
    warm_up: int = 10

    def __post_init__(self) -> None:
        check(self)
        if self.far_side < 4 or self.far_side & (self.far_side - 1):
            raise ValueError(f"far_side: expected a power of 2 from 4 on, got {self.far_side}")

    def level(self, progress: float) -> int:
        """How often the grid is still to be made finer, by progress of the training, 0 to 1."""
        grown = math.floor(progress / self.grown * (self.levels + 1)) if self.grown > 0.0 else self.levels
        return max(0, self.levels - grown)


@dataclass(frozen=True, slots=True)
class ReflectionConfig:
    """Settings of a training.

    Parameters
    ----------
    mlp
        Shape of the Reflection MLP. The paper's 8 x 512 takes about 15 times as long as 4 x 128.
    grid
        Of a radiance grid.
    learned
        Rays of each pixel, and what is learned of panes and poses; None for one ray, and tilts beside a radiance grid.
    bows
        Whether bows of panes are learned there, too: `glass_light.BowedPanes`.
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
    mlp_decay
        Of the weights of the MLP's hidden layers: in each step they shrink by so much times the rate (AdamW, Loshchilov
        and Hutter, 2019). The paper says nothing of it. Here MLPs follow the photos that there are better than those
        that there are not; with it, and on 510 photos in 100 s, both by 0.2 and 0.5 dB (1.0 is worse than 0.3).
    last_rate
        Share of the rates that is left at the end of half a cosine.
    warm_up
        Steps in which the rates rise from 0. Without, the MLP scored the same on rendered photos, but 3 % of its units
        died and not 0.4 %; at higher rates all of them do.
    high_frequency
        Stages of the high-frequency loss, equally long; none for the mean error alone. The paper's changed scores by
        0.04 dB with 51 rendered photos and by -0.1 dB with 180.
    squared_to
        Of `ray_errors`: 0 for the paper's mean error. A radiance grid has its own.
    white
        See `no_brighter`.
    transients
        Whether rays of transients are left out: `transients.LeaveTransientsOut`.
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
    grid: GridSettings = field(default_factory=GridSettings)
    learned: GlassLearned | None = None
    bows: EffectSetting = "auto"
    environment_rows: int = 128
    places: int = 3
    diffuse_degree: int = 1
    steps: int = parameter(1000, least=1)
    batch: int = parameter(8192, least=1)
    passes: float = parameter(9.0, above=0.0)
    mlp_rate: float = parameter(6e-3, above=0.0)
    mlp_decay: float = parameter(0.3, least=0.0)
    table_rate: float = parameter(2e-2, above=0.0)
    panel_rate: float = parameter(1e-2, above=0.0)
    last_rate: float = parameter(0.02, above=0.0, most=1.0)
    warm_up: int = parameter(100, least=0)
    high_frequency: tuple[HighFrequencyStage, ...] = ()
    squared_to: float = 0.0
    white: float = parameter(1.0, above=0.0, most=1.0)
    transients: EffectSetting = "off"
    precision: Precision = "auto"
    threads: int = parameter(1, least=1)
    time_limit_s: float | None = parameter(None, above=0.0, most=math.inf, expected="more than 0")
    held_out: float = parameter(0.15, above=0.0, below=1.0)
    seed: int = 0
    memory_bytes: int = parameter(1 << 30, least=1)

    def __post_init__(self) -> None:
        check(self)

    @property
    def for_grid(self) -> ReflectionConfig:
        """The same with batches, steps, rates and warm-up of a radiance grid."""
        grid = self.grid
        return replace(
            self,
            batch=max(1, round(self.batch * grid.batch_share)),
            steps=max(1, round(self.steps / grid.batch_share)),
            passes=max(self.passes, grid.passes),
            table_rate=grid.rate,
            squared_to=grid.squared_to,
            warm_up=min(self.warm_up, grid.warm_up),
        )

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
