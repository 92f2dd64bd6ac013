"""The whole objective of a step (paper Eq. 27), by term."""

from __future__ import annotations

from dataclasses import replace

import torch
from torch import Tensor

from reconstruction.light.losses import no_brighter
from reconstruction.training.config import LossWeights
from reconstruction.training.losses import (
    colour_loss,
    normal_consistency,
    normal_prior,
    normal_smoothness,
    surface_normals,
    worst_pixels,
)
from reconstruction.training.model.joint_model import Picture
from reconstruction.training.photos.photo_stream import Sample


def objective(
    picture: Picture, sample: Sample, weights: LossWeights, progress: float, with_glass: bool
) -> tuple[Tensor, dict[str, float]]:
    """The loss, and what each weighted term adds to it.

    Parameters
    ----------
    progress
        Of the training, 0 to 1.
    with_glass
        Whether the terms that the paper adds for glass count, too (Eqs. 23 and 24).
    """
    truth = display_of(sample)
    found, facade = picture.display, sample.facade
    if sample.shown is not None:
        # What a straightened photo does not show is as it should be.
        found = torch.where(sample.shown[..., None], found, truth)
        facade = facade & sample.shown
    found = no_brighter(found, truth, weights.white)
    terms = {"colour": colour_loss(found, truth, weights.dssim)}
    raster = picture.raster
    if weights.normal_consistency > 0.0 and progress >= weights.consistent_from:
        surface, is_known = surface_normals(raster.depths, raster.alphas, sample.view)
        consistency = normal_consistency(picture.normals, raster.alphas, surface, is_known)
        terms["normal consistency"] = weights.normal_consistency * consistency
    if with_glass and weights.normal_prior > 0.0 and sample.normals is not None:
        terms["normal prior"] = weights.normal_prior * normal_prior(picture.normals, sample.normals, facade)
    stage = weights.stage(progress) if with_glass else None
    if stage is not None and stage.weight > 0.0:
        worst = worst_pixels(found, truth, facade, stage.threshold)
        terms["high frequency"] = stage.weight * worst
    if weights.normal_smoothness > 0.0:
        terms["normal smoothness"] = weights.normal_smoothness * normal_smoothness(picture.normals, truth)
    if picture.penalty is not None:
        terms["shading"] = picture.penalty
    total = torch.stack(list(terms.values())).sum()
    return total, {name: float(term.detach()) for name, term in terms.items()}


def on_device(sample: Sample, device: torch.device) -> Sample:
    """The same sample in the memory of a device."""
    if device.type == "cpu":
        return sample
    return replace(
        sample,
        display=sample.display.to(device),
        facade=sample.facade.to(device),
        panels=sample.panels.to(device),
        normals=None if sample.normals is None else sample.normals.to(device),
        shown=None if sample.shown is None else sample.shown.to(device),
    )


def display_of(sample: Sample) -> Tensor:
    """SRGB values, 0 to 1, shape (h, w, 3), float32."""
    return sample.display.float() / 255.0
