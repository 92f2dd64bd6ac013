"""Ellipsoids as a camera sees them, in float64 torch: the readable form, with gradients by autograd.

A 3-D Gaussian (Kerbl et al., "3D Gaussian Splatting", 2023) has the weight exp(-(P - p)^T Sigma^-1 (P - p) / 2) with
Sigma = R S S^T R^T. Its picture is taken for that of a Gaussian again (EWA splatting: Zwicker et al., 2001), with

    Sigma' = J W Sigma W^T J^T + k^2 I        J = [[fx / z, 0, -fx x / z^2], [0, fy / z, -fy y / z^2]]

W the camera's rotation, (x, y, z) the middle in camera axes, and k the blur by which none falls between pixels. So it
is a disc that faces the camera: (u, v) = L^-1 (x', y') with any L for which L L^T = Sigma', here Cholesky's, and one
depth all over it. In J, x / z and y / z are kept near the picture, as in 3DGS: far outside, the picture of an ellipsoid
is no Gaussian, and it would smear over everything.
"""

from __future__ import annotations

import torch
from torch import Tensor

from reconstruction.splats.rasterising.projection import Projected, rotations
from reconstruction.splats.rasterising.views import View

BESIDE = 0.15
"""Share of the picture's width and height by which x / z and y / z in J may lie outside: with the principal point in
the middle, 1.3 times the field of view, as 3DGS has it."""

SlopeLimits = tuple[float, float, float, float]
"""Of x / z and y / z in J: least and most of each."""


def slope_limits(view: View) -> SlopeLimits:
    """What x / z and y / z are limited to in J: the same for all windows of a picture."""
    left, right, top, bottom = view.of_picture_px
    beside_x, beside_y = BESIDE * (right - left), BESIDE * (bottom - top)
    return (
        (left - beside_x - view.cx_px) / view.fx_px,
        (right + beside_x - view.cx_px) / view.fx_px,
        (top - beside_y - view.cy_px) / view.fy_px,
        (bottom + beside_y - view.cy_px) / view.fy_px,
    )


def project_ellipsoids(means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View, blur_px: float) -> Projected:
    """Ellipsoids, all of them in front of the camera, as it sees them: discs that face it.

    Parameters
    ----------
    means, quats_wxyz, scales
        Shapes (n, 3), (n, 4) of any length, and (n, 3), metres.
    blur_px
        k, standard deviation.
    """
    camera = view.cam_from_world.to(means)
    x, y, z = (means @ camera[:3, :3].T + camera[:3, 3]).unbind(-1)
    row_x, row_y = rows_of(means, quats_wxyz, scales, view)
    centres = torch.stack([view.fx_px * x / z + view.cx_px, view.fy_px * y / z + view.cy_px], dim=-1)
    return Projected(centres, z, _root(row_x, row_y, blur_px), torch.zeros_like(centres))


def rows_of(means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View) -> tuple[Tensor, Tensor]:
    """The two rows of J W R S, each shape (n, 3), px: without blur, Sigma' is what they have with each other."""
    camera = view.cam_from_world.to(means)
    x, y, z = (means @ camera[:3, :3].T + camera[:3, 3]).unbind(-1)
    axes = camera[:3, :3] @ rotations(quats_wxyz) * scales[:, None, :]
    left, right, top, bottom = slope_limits(view)
    across, down = (x / z).clamp(left, right), (y / z).clamp(top, bottom)
    row_x = (view.fx_px / z)[:, None] * (axes[:, 0] - across[:, None] * axes[:, 2])
    row_y = (view.fy_px / z)[:, None] * (axes[:, 1] - down[:, None] * axes[:, 2])
    return row_x, row_y


def _root(row_x: Tensor, row_y: Tensor, blur_px: float) -> Tensor:
    """L of L L^T = Sigma', shape (n, 2, 2), lower triangular.

    With the rows a and b the determinant is |a x b|^2 + k^2 (|a|^2 + |b|^2 + k^2): nothing cancels, however thin the
    disc is.
    """
    blur2 = blur_px * blur_px
    xx, xy, yy = ((a * b).sum(dim=-1) for a, b in ((row_x, row_x), (row_x, row_y), (row_y, row_y)))
    across = torch.linalg.cross(row_x, row_y)
    determinant = (across * across).sum(dim=-1) + blur2 * (xx + yy + blur2)
    upper = torch.sqrt(xx + blur2)
    zero = torch.zeros_like(upper)
    rows = torch.stack([upper, zero], dim=-1), torch.stack([xy / upper, torch.sqrt(determinant) / upper], dim=-1)
    return torch.stack(rows, dim=-2)
