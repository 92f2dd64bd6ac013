"""Which way ellipsoids lie: their shortest axes, and the discs that they are nearest to."""

from __future__ import annotations

import torch
from torch import Tensor

from reconstruction.splats.rasterising.projection import rotations

LAST = torch.tensor([[0.5, 0.5, 0.5, 0.5], [0.5, -0.5, -0.5, -0.5], [1.0, 0.0, 0.0, 0.0]])
"""Turns (w, x, y, z) after which the first, second or third axis is the third, and the others come in their order."""


def thinnest_axes(quats_wxyz: Tensor, sizes: Tensor) -> Tensor:
    """Unit axes along which ellipsoids are thinnest, shape (n, 3), as the rotations have them.

    Parameters
    ----------
    quats_wxyz, sizes
        Shapes (n, 4) of any length, and (n, 3), or their logarithms; of equal ones the first counts.
    """
    shortest = sizes.detach().argmin(dim=-1)
    return rotations(quats_wxyz).gather(-1, shortest[:, None, None].expand(-1, 3, 1))[..., 0]


def shortest_axes(means: Tensor, quats_wxyz: Tensor, log_scales: Tensor, view_position: Tensor) -> Tensor:
    """Unit normals of ellipsoids, shape (n, 3): their shortest axes (GaussianShader, Jiang et al., 2024), to a camera.

    Differentiable in the quaternions; which axis is shortest and which way it points has no gradient. Of equally short
    ones it is the first.

    Parameters
    ----------
    means, quats_wxyz, log_scales
        Shapes (n, 3), (n, 4) of any length, and (n, 3).
    view_position
        The camera's, shape (3,).
    """
    axes = thinnest_axes(quats_wxyz, log_scales)
    away = (axes.detach() * (means.detach() - view_position.detach().to(means))).sum(dim=-1)
    return torch.where((away > 0.0)[:, None], -axes, axes)


def flattened(quats_wxyz: Tensor, log_scales: Tensor) -> tuple[Tensor, Tensor]:
    """Discs in the place of ellipsoids, shapes (n, 4) and (n, 2): without the shortest axis, which is the normal."""
    shortest = log_scales.detach().argmin(dim=-1)
    w, x, y, z = quats_wxyz.unbind(dim=-1)
    a, b, c, d = LAST.to(quats_wxyz)[shortest].unbind(dim=-1)
    quats = torch.stack(
        [
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        ],
        dim=-1,
    )
    others = torch.stack([(shortest + 1) % 3, (shortest + 2) % 3], dim=-1)
    return quats, log_scales.gather(-1, others)
