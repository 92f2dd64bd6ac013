"""What a training makes small, ray by ray: the mean error, and that of the worst rays (paper Eqs. 24, 27)."""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn.functional import huber_loss

from reconstruction.light.config import HighFrequencyStage

EPSILON = 1e-6
"""Of Eq. 24: with no ray above the threshold the loss is 0, and so is its gradient."""


def no_brighter(found: Tensor, truth: Tensor, white: float = 1.0) -> Tensor:
    """What was found, but nowhere brighter than a photo that is overexposed there: that says "at least so bright".

    Parameters
    ----------
    white
        Value of sRGB, 0 to 1, from which on a photo is overexposed.
    """
    return torch.where(truth >= white, torch.minimum(found, truth), found)


def ray_errors(found: Tensor, truth: Tensor, squared_to: float = 0.0) -> Tensor:
    """Sum of the absolute errors of red, green and blue, shape (n,), of colours 0 to 1, shape (n, 3).

    Parameters
    ----------
    squared_to
        Errors e up to s count e^2 / (2 s), larger ones e - s / 2 (P. J. Huber, 1964); 0 for e.
    """
    if squared_to == 0.0:
        return (found - truth).abs().sum(dim=-1)
    return huber_loss(found, truth, reduction="none", delta=squared_to).sum(dim=-1) / squared_to


def high_frequency_loss(errors: Tensor, threshold: float) -> Tensor:
    """Mean error of the rays whose error is above the threshold (Eq. 24); 0 where there are none.

    Parameters
    ----------
    errors
        Of `ray_errors`, shape (n,).
    """
    large = (errors > threshold).to(errors.dtype)
    return (large * errors).sum() / (large.sum() + EPSILON)


def ray_loss(errors: Tensor, stage: HighFrequencyStage | None) -> Tensor:
    """Mean error per channel, plus the weighted high-frequency loss.

    Of Eq. 27 these are the terms that single rays have: D-SSIM needs patches, and the normals are given.
    """
    loss = errors.mean() / 3.0
    return loss if stage is None else loss + stage.weight * high_frequency_loss(errors, stage.threshold)
