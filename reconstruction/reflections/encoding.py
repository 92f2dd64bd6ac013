"""Fourier features of positions and directions (paper Eq. 22), exact to float32's rounding at every order."""

from __future__ import annotations

import math

import torch
from torch import Tensor

MAX_ORDER = 24
"""From there on the finest wave is shorter than float32 can tell places in [-1, 1] apart."""


def fourier_features(values: Tensor, order: int) -> Tensor:
    """sin(2^k pi p) and cos(2^k pi p) for k = 0 to `order` - 1 (Eq. 22), float32 or float64 as the values.

    The sine of 2^k pi p itself is wrong by 4e-4 in float32 at k = 11: pi times 2^11 is rounded before the sine is
    taken. Here whole periods are taken away first, which is exact in binary: with h = 2^(k-1) p, the angle is
    2 pi (h - round h). What is left is the rounding of one sine, 2e-7, whatever k is.

    Parameters
    ----------
    values
        Shape (n, c), meant for [-1, 1]; gradients flow through. Half precision is refused: at order 12 it would be
        noise.
    order
        L of the paper, 0 to `MAX_ORDER`.

    Returns
    -------
    Tensor
        Shape (n, 2 `order` c): for each k all sines, then all cosines.
    """
    if values.dtype not in (torch.float32, torch.float64):
        raise TypeError(f"expected float32 or float64, got {values.dtype}")
    if values.ndim != 2:
        raise ValueError(f"values: expected shape (n, c), got {tuple(values.shape)}")
    if not 0 <= order <= MAX_ORDER:
        raise ValueError(f"order: expected 0 to {MAX_ORDER}, got {order}")
    n, c = values.shape
    powers = torch.exp2(torch.arange(order, dtype=values.dtype, device=values.device) - 1.0)
    half_turns = values[:, None, :] * powers[:, None]
    angles = (2.0 * math.pi) * (half_turns - torch.round(half_turns))
    return torch.stack([torch.sin(angles), torch.cos(angles)], dim=2).reshape(n, 2 * order * c)


def n_features(n_channels: int, order: int) -> int:
    """Columns that `fourier_features` makes."""
    return 2 * order * n_channels
