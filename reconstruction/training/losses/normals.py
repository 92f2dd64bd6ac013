"""How smooth normals are, where the photo is."""

from __future__ import annotations

import math

import torch
from torch import Tensor

LEAST_SQUARE = 1e-12
"""Added below roots of squared slopes, which have no gradient at 0."""


def normal_smoothness(normals: Tensor, photo: Tensor) -> Tensor:
    """Mean of |grad N| exp(-|grad C|): normals change where the photo does (Yao et al., 2025, L_smooth).

    Parameters
    ----------
    normals, photo
        N and C, shape (h, w, 3); pictures of one row or column have 0.
    """
    if min(normals.shape[:2]) < 2:
        return normals.sum() * 0.0
    weighted: Tensor = _slopes(normals) * torch.exp(-_slopes(photo))
    return weighted.mean()


def _slopes(picture: Tensor) -> Tensor:
    """Length of the difference to the next pixel to the right and below, shape (h - 1, w - 1)."""
    here = picture[:-1, :-1]
    square = (picture[:-1, 1:] - here).square().sum(dim=-1) + (picture[1:, :-1] - here).square().sum(dim=-1)
    return torch.sqrt(square + LEAST_SQUARE) - math.sqrt(LEAST_SQUARE)
