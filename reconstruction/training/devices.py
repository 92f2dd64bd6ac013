"""What splats are drawn on in a training: the processor, or a graphics card where that takes less time for a step.

A card is asked by one step of the training's own splats, forward and backward, and its picture and gradients are
compared with the processor's: what drivers and cards make of the kernels is not known beforehand. Where it is taken,
splats, losses and Adam are the card's, see `card_step`. Pictures of models that somebody looks at are decided about in
the same way, by one picture each way. Programs that stand in for a card are never chosen by themselves.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.errors import InputError, ReconstructionError
from planning.base.messages import say
from reconstruction.base.adam import Adam
from reconstruction.gpu.device import adapters, open_device, rounded_up, why_no_gpu
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.splats.card_splats import (
    BYTES_FOR_ALL,
    OTHER_FEATURES,
    RATED,
    AdamStep,
    CardSplats,
    PictureSize,
    fits_card,
    needed_bytes,
)
from reconstruction.splats.densification.strategy import NO_CHANGES, Limits
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import LANE_ROWS, PATCH_COLUMNS
from reconstruction.splats.splats import Splats
from reconstruction.training.config import ANTIALIASED, TrainConfig

MOST_APART = 0.02
"""Of a picture or gradients, relative, from the processor's: 1e-3 was measured, of splats equally deep in float32."""

LEAST_DB = 40.0
"""PSNR of a card's picture against the processor's, at least: 90 dB was measured, and 8 bits alone come to 59 dB."""

MODULE = "reconstruction.training.devices"

TRIAL_S = 120.0
"""For compiling the kernels and drawing two splats, at most."""

SHOWN_BYTES = 640
"""Of a card's memory for each splat of a model that is looked at: 35 texels, and lists of a picture."""


@dataclass(frozen=True, slots=True)
class CardTrial:
    """What one step, or picture, takes on a card and on the processor.

    Parameters
    ----------
    card
        Its name.
    lacking
        Why it was not tried or did not work; empty where it did.
    processor_s, card_s
        Of a step of splats, kernels compiled.
    first_s
        Of the first one on the card.
    needed_bytes
        Of its memory, at most.
    """

    card: str
    lacking: str = ""
    processor_s: float = 0.0
    card_s: float = math.inf
    first_s: float = 0.0
    needed_bytes: int = 0


@dataclass(frozen=True, slots=True)
class SplatsByCard:
    """Draw splats, forward and backward, on a graphics card."""

    name: str = say("splats drawn by the graphics card")
    unit: str = say("of a step's time for splats saved")
    tolerance: float = 0.1

    def assess(self, trial: CardTrial) -> Assessment:
        """Share of the time that a step takes less."""
        if trial.lacking:
            return Assessment(0.0, trial.lacking, 0.0)
        reason = say(
            "{} takes {:.0f} ms, the processor {:.0f} ms; about {:.1f} GB of its memory are needed",
            *(trial.card, 1e3 * trial.card_s, 1e3 * trial.processor_s, trial.needed_bytes / 1e9),
        )
        return Assessment(max(0.0, 1.0 - trial.card_s / max(trial.processor_s, 1e-9)), reason, trial.first_s)


def device_setting(config: TrainConfig) -> EffectSetting:
    """The effect's setting by the device that is asked for."""
    return "auto" if config.device == "auto" else "on" if config.device == "gpu" else "off"


def check_device(config: TrainConfig) -> None:
    """Refuse a device that is not there.

    Raises
    ------
    InputError
        It is asked for by name.
    """
    if config.device == "cuda" and not torch.cuda.is_available():
        raise InputError(say("device: 'cuda' is asked for, and torch finds no CUDA device; leave it out"))
    if config.device == "gpu" and (reason := why_no_gpu()):
        raise InputError(say("device: 'gpu' is asked for, and {}; leave it out", reason))


def drawn_by_card(config: TrainConfig, splats: Splats, view: View) -> tuple[bool, Decision | None]:
    """Whether a training draws its splats on a graphics card, and the decision; None where there is none to be made.

    Parameters
    ----------
    view
        Of a photo that is learned from; a window of it is drawn.

    Raises
    ------
    ReconstructionError
        It was asked for, and fails.
    """
    setting = device_setting(config)
    if setting == "off":
        return False, None
    found = decide(SplatsByCard(), _tried(config, splats, view), setting)
    return found.on, found


def why_no_card() -> str:
    """What there is in the place of a graphics card that may be chosen by itself; empty where there is one."""
    reason = why_no_gpu()
    if reason:
        return say("no graphics card: {}", reason)
    card = adapters()[0]
    return say("there is no graphics card but {}, which the processor runs", card.name) if card.is_software else ""


def _untried(is_auto: bool) -> CardTrial | None:
    """Why the first card is not even tried; None where it is to be."""
    reason = why_no_card()
    if why_no_gpu() or (reason and is_auto):
        return CardTrial("", reason)
    card = adapters()[0]
    if is_auto and not _survives():
        return CardTrial(card.name, say("{} ended the process that tried it, or did not answer", card.name))
    return None


def _tried(config: TrainConfig, splats: Splats, view: View) -> CardTrial:
    """A step on the first card, or why there is none."""
    untried = _untried(config.device == "auto")
    if untried is not None:
        return untried
    card = adapters()[0]
    scale = math.sqrt(min(1.0, config.window_px / (view.width_px * view.height_px)))
    size = max(1, round(scale * view.width_px)), max(1, round(scale * view.height_px))
    window = view.cropped((view.width_px - size[0]) // 2, (view.height_px - size[1]) // 2, *size)
    settings = config.raster
    here_s, expected = _step(splats, window, settings)
    here_s = min(here_s, _step(splats, window, settings)[0])
    try:
        first_s, found = _step(splats, window, replace(settings, on_gpu=True))
        there_s = _step(splats, window, replace(settings, on_gpu=True))[0]
        if fits_card(splats):
            here_s, there_s = (learning_s(splats, window, settings, on_card) for on_card in (False, True))
    except ReconstructionError as error:
        if config.device == "gpu":
            raise
        return CardTrial(card.name, say("it was tried, and {}", error))
    apart = max(float((a - b).norm() / b.norm().clamp(min=1e-12)) for a, b in zip(found, expected, strict=True))
    if not apart < MOST_APART and config.device == "auto":
        return CardTrial(card.name, say("{} does not draw what the processor draws (apart: {:.2g})", card.name, apart))
    needed = training_bytes(splats, window, settings, max(config.max_splats, len(splats)), card.is_software)
    return CardTrial(card.name, "", here_s, there_s, first_s, needed)


@torch.no_grad()
def training_bytes(splats: Splats, view: View, settings: RasterSettings, n: int, is_software: bool) -> int:
    """Of a card's memory, at most, for steps with `n` splats of which a view shows as large a share as of these.

    Pictures are as large as that of the view.
    """
    given = splats.means, splats.quats, splats.scales, splats.opacities, splats.means[:, :1]
    means, quats, scales, opacities, features = (values.detach().cpu() for values in given)
    radii_px = rasterise(means, quats, scales, opacities, features, view, settings=settings).radii_px
    radii_px = radii_px[radii_px > 0].double()
    # Boxes begin anywhere in a patch, so that on average they reach into one more each way than they are large.
    sides = (view.width_px, PATCH_COLUMNS), (view.height_px, LANE_ROWS)
    across, down = ((2.0 * radii_px / of_patch + 1.0).clamp(max=rounded_up(side, of_patch)) for side, of_patch in sides)
    share = n / max(len(splats), 1)
    n_patches = share * float((across * down).sum())
    size = PictureSize(math.ceil(share * len(radii_px)), math.ceil(n_patches), view.width_px * view.height_px)
    return needed_bytes(n, size, is_software=is_software)


Draw = Callable[[bool], NDArray[np.float32]]
"""Draws a picture, shape (h, w, 3), 0 to 1, by the graphics card or by the processor."""


def shown_by_card(draw: Draw, n_splats: int, setting: EffectSetting) -> Decision:
    """Whether pictures of a model are drawn on a graphics card: a trial picture each way.

    Where it is asked for, it is not measured, and what fails is seen by whoever draws.
    """
    trial = CardTrial("", say("it was not measured"))
    if setting == "auto":
        trial = _untried(True) or _compared(draw, n_splats)
    effect = SplatsByCard(say("pictures of models drawn by the graphics card"), say("of a picture's time saved"))
    return decide(effect, trial, setting)


def _compared(draw: Draw, n_splats: int) -> CardTrial:
    card = adapters()[0]
    try:
        (first_s, found), (_, expected) = _timed(draw, True), _timed(draw, False)
        (there_s, _), (here_s, _) = _timed(draw, True), _timed(draw, False)
    except ReconstructionError as error:
        return CardTrial(card.name, say("it was tried, and {}", error))
    alike_db = psnr_db(float(np.mean(np.square(found - expected), dtype=np.float64)))
    # Not less: what is no number at all is not alike either.
    if not alike_db >= LEAST_DB:
        return CardTrial(card.name, say("{} does not draw what the processor draws ({:.0f} dB)", card.name, alike_db))
    return CardTrial(card.name, "", here_s, there_s, first_s, BYTES_FOR_ALL + SHOWN_BYTES * n_splats)


def _timed(draw: Draw, on_card: bool) -> tuple[float, NDArray[np.float32]]:
    began = time.perf_counter()
    found = draw(on_card)
    return time.perf_counter() - began, found


def _survives() -> bool:
    """Whether a process of its own that tries the first card comes to its end: a driver may take the process along."""
    return _ends_well(sys.executable)


@cache
def _ends_well(python: str) -> bool:
    inherited, root = os.environ.get("PYTHONPATH"), Path(__file__).resolve().parents[2]
    environment = {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{inherited}" if inherited else str(root)}
    # -P: modules that lie about in the current folder are not ours.
    command = [python, "-P", "-m", MODULE]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, timeout=TRIAL_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def try_card() -> None:
    """Draw a few splats on the first card, forward and backward.

    Raises
    ------
    ReconstructionError
        It fails.
    """
    means = torch.tensor([[0.0, 0.0, 4.0], [0.1, 0.0, 5.0]], requires_grad=True)
    quats, features = torch.tensor([[1.0, 0.1, 0.0, 0.0]] * 2), torch.ones(2, 3)
    view = View(32, 24, 30.0, 30.0, 16.0, 12.0, torch.eye(4, dtype=torch.float64))
    settings = replace(ANTIALIASED, on_gpu=True)
    raster = rasterise(means, quats, torch.full((2, 2), 0.3), torch.full((2,), 0.8), features, view, settings=settings)
    raster.features.sum().backward()  # type: ignore[no-untyped-call]
    half = torch.full((2,), 0.5)
    splats = Splats.of(means.detach(), quats, torch.full((2, 2), 0.3), half, half[:, None].expand(2, 3))
    learning_s(splats, view, settings, True)


def _step(splats: Splats, view: View, settings: RasterSettings) -> tuple[float, list[Tensor]]:
    """Seconds of a picture of splats and its gradients, and what comes of it."""
    given = splats.means, splats.quats, splats.scales, splats.opacities, splats.features(view.position_m, 0)
    means, quats, scales, opacities, features = (values.detach().cpu().requires_grad_() for values in given)
    generator = torch.Generator().manual_seed(0)
    pull = torch.rand((view.height_px, view.width_px, features.shape[1]), generator=generator)
    began = time.perf_counter()
    raster = rasterise(means, quats, scales, opacities, features, view, settings=settings)
    (raster.features * pull).sum().backward()  # type: ignore[no-untyped-call]
    seconds = time.perf_counter() - began
    gradients = [values.grad for values in (means, scales, opacities, features) if values.grad is not None]
    return seconds, [raster.features.detach(), *gradients]


def learning_s(splats: Splats, view: View, settings: RasterSettings, on_card: bool) -> float:
    """Seconds of what a step does with splats, from what is learned of them to what has been: the second of two."""
    own = splats.some(torch.arange(len(splats)))
    optimiser = Adam([{"name": name, "params": [getattr(own, name)]} for name in own.names], lr=0.0)
    shape = view.height_px, view.width_px
    pull = torch.rand((*shape, 4 * OTHER_FEATURES + 4), generator=torch.Generator().manual_seed(0))
    rates = dict.fromkeys((*RATED, "details"), 0.0)
    by = AdamStep(rates, 1.0, 1.0, 0.0, Limits(), NO_CHANGES, 0)
    card = CardSplats(open_device(), own, optimiser, with_glass=False) if on_card else None
    seconds = 0.0
    for _ in range(2):
        began = time.perf_counter()
        if card is None:
            optimiser.zero_grad(set_to_none=True)
            features = own.features(view.position_m)
            raster = rasterise(own.means, own.quats, own.scales, own.opacities, features, view, settings=settings)
            (raster.features[..., :8] * pull[..., :8]).sum().backward()  # type: ignore[no-untyped-call]
            optimiser.step()
        else:
            card.try_step(view, settings, pull.numpy(), by)
        seconds = time.perf_counter() - began
    return seconds


if __name__ == "__main__":
    try_card()
