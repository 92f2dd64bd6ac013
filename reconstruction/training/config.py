"""How a model is trained: one frozen configuration of paper Eqs. 23 to 27 and all that the paper leaves open."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.base.json_file import settings_over
from planning.base.messages import about
from planning.base.parameters import check, like, parameter
from reconstruction.light.config import PAPER_STAGES, HighFrequencyStage, ReflectionConfig
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.training.method_registry import DEFAULT_METHOD, Method, method_named
from reconstruction.training.parameters import TrainRequest

LightSetting = Literal["auto", "harmonics", "environment-map", "mlp", "radiance-grid"]
"""What mirrored light is learned with; `auto` leaves it to the scene."""

GeometrySource = Literal["panels", "splats"]
"""Where place and normal of a mirroring pixel come from: the panels' planes, or the splats as rendered."""

StartFrom = Literal["surfaces", "points"]
"""What splats begin on: panels and mesh, or points of photogrammetry, as published methods do."""

Device = Literal["auto", "cpu", "gpu", "cuda"]
"""What splats are drawn on, and with `cuda` all else, too; `auto` measures a step: `devices.SplatsByCard`."""

DensifySetting = Literal["adaptive", "mcmc", "none"]

ANTIALIASED = RasterSettings(blur_px=math.sqrt(0.1), antialiased=True)
"""With the blur of Mip-Splatting (Yu et al., 2024), about as wide as a pixel, which is 1/12 px^2; 3DGS has 0.3."""


@dataclass(frozen=True, slots=True)
class LossWeights:
    """Weights of the terms, Eq. 27.

    Parameters
    ----------
    dssim
        lambda of Eq. 25; the paper's.
    normal_consistency
        lambda_n; the paper's.
    normal_prior
        lambda_np; 1 in the paper, where mirrored directions follow the splats' normals: use it with `geometry`
        `splats`. With exact planes nothing mirrored depends on them, and 1 holds splats back: against 0 it cost 0.34 dB
        on facades of unseen views, and 0.1 cost 0.11 dB. It still closes panes, behind which nothing is to be seen.
    normal_smoothness
        Of changes of normals where the photo does not change (Yao et al., 2025): 0 but for the method it is from.
    consistent_from
        Share of the training after which normals have to agree with the depth map (Eq. 26). Before, depths are those
        of the start and of splats that still move; 2DGS, too, waits for about a quarter.
    high_frequency
        tau and lambda_hf, stages of equal length (Eq. 24). The paper's rise from 0.2 and 1 to 0.09 and 10; of the steps
        between it says nothing. They brought 0.55 dB on facades of unseen views (the paper: 0.53).
    high_frequency_from
        Share of the training after which they begin: before, every pixel is among the worst.
    white
        See `no_brighter`; `overexposed` sets it.
    """

    dssim: float = parameter(0.2, least=0.0, most=1.0)
    normal_consistency: float = parameter(0.05, least=0.0)
    normal_prior: float = parameter(0.1, least=0.0)
    normal_smoothness: float = parameter(0.0, least=0.0)
    consistent_from: float = parameter(0.25, least=0.0, most=1.0)
    high_frequency: tuple[HighFrequencyStage, ...] = PAPER_STAGES
    high_frequency_from: float = parameter(0.25, least=0.0, most=1.0)
    white: float = parameter(1.0, above=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)

    def stage(self, progress: float) -> HighFrequencyStage | None:
        """Of the high-frequency loss by progress, 0 to 1; None where it does not count."""
        if not self.high_frequency or progress < self.high_frequency_from:
            return None
        share = (progress - self.high_frequency_from) / max(1.0 - self.high_frequency_from, 1e-9)
        return self.high_frequency[min(int(share * len(self.high_frequency)), len(self.high_frequency) - 1)]


@dataclass(frozen=True, slots=True)
class Rates:
    """Learning rates of Adam for what splats and pictures are made of.

    The ones of splats are those that 3-D and 2-D Gaussian splatting are known to work with, where not said otherwise.

    Parameters
    ----------
    means
        Share of the scene's size (half the cameras' and splats' extent) a step; falls to `means_last` of it.
    quats, scales, opacities, colours
        Of the parameters as they are stored (logarithms, logits). Colours three times as fast scored 0.1 to 0.3 dB more
        on facades after 300 to 400 steps, and no more after 1000; all of them faster less.
    colour_details
        Of the bands of spherical harmonics above the first, as a share of `colours`.
    glass_geometry
        Of places and rotations of splats on panels, as a share of the others'. Where mirrored directions follow them,
        each step of Adam turns all that is mirrored.
    reflectivity, f0
        Of the logits of r and F0: as quick as opacities are slow, since the pre-training has found them.
    light
        Of everything in the model of mirrored light, as a share of its own rates when it was learned alone: it has
        been learned already, and the colours around it settle only now.
    sky, exposures, corner_loss
        Of the sky, the gains of photos, and vignetting.
    poses
        Of corrections of photos' poses, pixels.
    last
        Share of all rates but `means` that is left at the end of half a cosine.
    warm_up
        Steps in which all rates rise from 0: the first gradients come from one photo each.
    """

    means: float = parameter(1.6e-4, least=0.0)
    means_last: float = parameter(0.01, least=0.0, most=1.0)
    quats: float = parameter(1e-3, least=0.0)
    scales: float = parameter(5e-3, least=0.0)
    opacities: float = parameter(5e-2, least=0.0)
    colours: float = parameter(2.5e-3, least=0.0)
    colour_details: float = parameter(0.05, least=0.0)
    glass_geometry: float = parameter(1.0, least=0.0, most=1.0)
    reflectivity: float = parameter(1e-2, least=0.0)
    f0: float = parameter(1e-2, least=0.0)
    light: float = parameter(0.25, least=0.0)
    sky: float = parameter(1e-2, least=0.0)
    exposures: float = parameter(1e-3, least=0.0)
    poses: float = parameter(0.1, least=0.0)
    corner_loss: float = parameter(2e-3, least=0.0)
    last: float = parameter(0.1, least=0.0, most=1.0)
    warm_up: int = parameter(30, least=0)

    def __post_init__(self) -> None:
        check(self)

    def share(self, step: int, progress: float) -> float:
        """Of the rates but that of means: rising over the warm-up, falling along half a cosine."""
        cosine = 0.5 * (1.0 + math.cos(math.pi * min(progress, 1.0)))
        return self._rising(step) * (self.last + (1.0 - self.last) * cosine)

    def means_share(self, step: int, progress: float) -> float:
        """Of the rate of means: falling by the same factor in every step."""
        return self._rising(step) * math.pow(max(self.means_last, 1e-9), min(progress, 1.0))

    def _rising(self, step: int) -> float:
        return min(1.0, (step + 1) / (self.warm_up + 1))


@dataclass(frozen=True, slots=True)
class TrainConfig:
    """Settings of a training.

    Parameters
    ----------
    method, light, geometry
        What is trained, and one of `METHODS` as how. With `panels`, place and normal of glass are exact; with `splats`
        they are the rendered ones, as in the paper, and errors of both show in what is mirrored.
    light_share
        Of the time that is left when light begins to be learned alone, at most, for that.
    reflections
        How light is learned alone, from random rays of glass.
    overexposed
        Whether values next to white say "at least so bright", as white does: `choose_light.Overexposure`.
    own_exposures
        Whether each photo has a gain and a white balance of its own: `exposures.OwnExposures`. Off, gains stay what the
        folder says.
    outlier_photos
        Whether photos are left out that do not show what others show of the same points: `exposures.OutlierPhotos`.
    own_poses
        Whether each photo's pose is corrected while splats are learned: `poses.PoseCorrections`.
    transients
        Whether what only single photos show is left out of them: `transients.LeaveTransientsOut`.
    light_apart
        Whether light that is learned apart from the splats is worth it: `start.SeparateLight`. On, rays of glass alone
        decide which; off, nothing is tried.
    points_for_mesh
        Whether splats begin on points in the place of a mesh that these do not lie on: `surfels.PointsForMesh`.
    start_from
        With `points`, no mesh and no ground are known, and panels to methods alone that know panels. Points on glass
        are left out: photogrammetry finds none there that is where it seems.
    n_splats, max_splats
        To start from, and never more than.
    densification
        2DGS's adaptive control, the Markov chain Monte Carlo one (Kheradmand et al., 2024), or none.
    densify_from, densify_until
        Shares of the training between which splats are added: later ones have no time to settle.
    degree, degree_every
        Of spherical harmonics at last, and share of the training after which it rises by one.
    window_px
        Pixels of a photo that a step looks at, at most: a random window of larger photos. Where a time limit leaves
        room for too few steps, windows are smaller: `trainer.ENOUGH_STEPS`.
    reduce
        Pixels of a photo, along each side, that one is made of before it is learned from; 0 for as many as leave some
        windows of it: `photos.decoded_photo.usual_reduce`.
    raster
        Settings of the rasteriser. Splats are antialiased, other than in 2DGS and 3DGS: frames are finer than a pixel
        in many photos (`python -m tests.tables --only 3b`).
    held_out
        Share of the views that are kept for scoring, chosen by their names and `seed`.
    threads
        Of torch. With one, the same seed gives the same bits on a processor. All else takes `raster.threads`, or all
        cores, and has the same bits with any number.
    checkpoint_every_s
        Between checkpoints; the last state is always kept.
    score_every_s
        Between looks at views that are held out, for the curve of quality against time.
    """

    method: str = DEFAULT_METHOD
    light: LightSetting = like(TrainRequest, "light", "auto")
    geometry: GeometrySource = "panels"
    iterations: int = like(TrainRequest, "iterations", 6000)
    time_limit_s: float | None = like(TrainRequest, "time_limit_s", None, unset="none")
    light_share: float = parameter(0.35, least=0.0, most=1.0)
    reflections: ReflectionConfig = field(default_factory=ReflectionConfig)
    overexposed: EffectSetting = "auto"
    own_exposures: EffectSetting = "auto"
    outlier_photos: EffectSetting = "auto"
    own_poses: EffectSetting = "auto"
    transients: EffectSetting = "auto"
    light_apart: EffectSetting = "auto"
    points_for_mesh: EffectSetting = "auto"
    start_from: StartFrom = "surfaces"
    n_splats: int = parameter(12_000, least=1)
    max_splats: int = parameter(30_000, least=1)
    densification: DensifySetting = "adaptive"
    densify_from: float = parameter(0.05, least=0.0, most=1.0)
    densify_until: float = parameter(0.6, least=0.0, most=1.0)
    degree: int = parameter(3, least=0, most=3)
    degree_every: float = parameter(0.0, least=0.0, most=1.0)
    window_px: int = parameter(256 * 192, least=1)
    reduce: int = parameter(0, least=0)
    raster: RasterSettings = ANTIALIASED
    losses: LossWeights = field(default_factory=LossWeights)
    rates: Rates = field(default_factory=Rates)
    held_out: float = parameter(0.15, above=0.0, below=1.0)
    seed: int = like(TrainRequest, "seed", 0)
    memory_bytes: int = like(TrainRequest, "memory_bytes", 1 << 30)
    device: Device = like(TrainRequest, "device", "auto")
    threads: int = parameter(1, least=1)
    checkpoint_every_s: float = parameter(120.0, above=0.0)
    score_every_s: float = parameter(20.0, above=0.0)

    def __post_init__(self) -> None:
        method_named(self.method)
        check(self)
        if self.max_splats < self.n_splats:
            raise ValueError(f"max_splats: expected n_splats ({self.n_splats}) or more, got {self.max_splats}")

    @property
    def tensors_on(self) -> Literal["cpu", "cuda"]:
        """Where parameters lie: kernels by WebGPU take them from main memory."""
        return "cuda" if self.device == "cuda" else "cpu"

    @property
    def trained_by(self) -> Method:
        """What its method is."""
        return method_named(self.method)

    def degree_at(self, progress: float) -> int:
        """Of spherical harmonics, by progress, 0 to 1."""
        return self.degree if self.degree_every == 0.0 else min(self.degree, int(progress / self.degree_every))


def config_of(content: dict[str, Any], base: TrainConfig, path: Path) -> TrainConfig:
    """Settings that are those of `base` where `content`, as read from TOML or JSON, does not say otherwise.

    A method that it names brings its own settings.

    Raises
    ------
    InputError
        A key is not known, a value of the wrong type or out of range; the message names file and key.
    """
    try:
        of_method = method_named(content["method"]).settings if isinstance(content.get("method"), str) else {}
    except ValueError as error:
        raise InputError(about(path, error)) from error
    return settings_over(settings_over(base, of_method, path), content, path)
