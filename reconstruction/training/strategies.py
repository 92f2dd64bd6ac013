"""The strategy that a configuration asks for, and what it is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import torch
from torch import Tensor

from reconstruction.splats.densification.adaptive import AdaptiveControl, AdaptiveParameters
from reconstruction.splats.densification.mcmc import MarkovChain, McmcParameters
from reconstruction.splats.densification.strategy import Densification, FixedNumber, Limits
from reconstruction.splats.rasterising.raster_types import Raster
from reconstruction.training.config import TrainConfig
from reconstruction.training.photos.photo_stream import Sample
from reconstruction.training.ranks import Ranks

ALWAYS = 1 << 62
"""Steps."""


def strategy_of(config: TrainConfig, n_splats: int) -> Densification:
    """Adds splats, to `max_splats` at most, whenever it is asked: the trainer asks between two shares of the training.

    Opacities are never reset: splats start on surfaces that are known, and trainings are short.
    """
    limits = Limits(n_most=max(config.max_splats, n_splats))
    if config.densification == "none":
        return FixedNumber(limits)
    if config.densification == "mcmc":
        return MarkovChain(McmcParameters(start=0, stop=ALWAYS, n_splats=config.max_splats), limits)
    return AdaptiveControl(AdaptiveParameters(start=0, stop=ALWAYS, reset_every=0), limits)


def show(
    strategy: Densification, raster: Raster, offsets: Tensor, samples: Sequence[Sample], ranks: Ranks, weight: float
) -> None:
    """Tell a strategy about a picture, and those of other processes, in the same order everywhere.

    Parameters
    ----------
    offsets
        Of the splats' screen positions, with their gradients.
    weight
        Of the high-frequency loss: it multiplies gradients, which says nothing about how many splats are needed.
    """
    pulls = torch.zeros_like(offsets) if offsets.grad is None else offsets.grad
    seen = torch.cat([pulls / (1.0 + weight), raster.weights[:, None], raster.radii_px[:, None].to(pulls)], dim=1)
    for found, sample in zip(ranks.gathered(seen), samples, strict=True):
        strategy.seen(replace(raster, weights=found[:, 2], radii_px=found[:, 3]), found[:, :2], sample.view)
