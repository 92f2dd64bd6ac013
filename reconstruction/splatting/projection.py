"""Splats as a camera sees them, in float64 torch: the readable form, with gradients by autograd.

A splat is P(u, v) = p + s_u t_u u + s_v t_v v with weight exp(-(u^2 + v^2) / 2) (Huang et al., "2D Gaussian Splatting",
2024, Eqs. 4 to 6). A pixel's ray meets it where a vector h(x, y) = (n_u, n_v, D) that is affine in the pixel gives
u = n_u / D, v = n_v / D. Counted from the projection of the splat's own middle, with J the change of the pixel with
(u, v) there, q the relative change of the depth and (x, y) pixels from the middle:

    n_u = x J_yv - y J_xv        n_v = y J_xu - x J_yu
    a = det J                    D = a + t
    t = x (J_yu q_v - J_yv q_u) + y (J_xv q_u - J_xu q_v)

and the depth of the meeting is z = Z a / D, with Z that of the middle. Nothing large cancels near the splat, wherever
in the picture it is.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from reconstruction.splatting.views import View

LEAST_NORM = 1e-12
"""Quaternions shorter than this say nothing about a rotation; they stand for none, and have no gradient."""


@dataclass(frozen=True, slots=True, eq=False)
class Projected:
    """Splats in front of a camera.

    Parameters
    ----------
    centres_px
        Where their middles fall, shape (n, 2): column, row.
    depths_m
        Of their middles along the optical axis, shape (n,).
    jacobians_px
        Change of the pixel with (u, v) at the middle, shape (n, 2, 2): [[J_xu, J_xv], [J_yu, J_yv]].
    slopes
        Change of the depth with (u, v) over the depth, shape (n, 2).
    """

    centres_px: Tensor
    depths_m: Tensor
    jacobians_px: Tensor
    slopes: Tensor


def rotations(quats_wxyz: Tensor) -> Tensor:
    """Rotations, shape (n, 3, 3), of quaternions of any length, shape (n, 4)."""
    norm = quats_wxyz.norm(dim=-1, keepdim=True)
    means_something = norm > LEAST_NORM
    unit = quats_wxyz / torch.where(means_something, norm, torch.ones_like(norm))
    identity = torch.tensor([1.0, 0.0, 0.0, 0.0], dtype=unit.dtype, device=unit.device)
    w, x, y, z = torch.where(means_something, unit, identity).unbind(-1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return torch.stack([torch.stack(row, dim=-1) for row in rows], dim=-2)


def depths_of(means: Tensor, view: View) -> Tensor:
    """Depths along the optical axis, shape (n,), of places in the model's frame, shape (n, 3)."""
    forward = view.cam_from_world[2].to(means)
    return means @ forward[:3] + forward[3]


def project(means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View) -> Projected:
    """Splats, all of them in front of the camera, as it sees them."""
    camera = view.cam_from_world.to(means)
    x, y, z = (means @ camera[:3, :3].T + camera[:3, 3]).unbind(-1)
    tangents = camera[:3, :3] @ rotations(quats_wxyz)[..., :2] * scales[:, None, :]
    slopes = tangents[:, 2] / z[:, None]
    jacobians = torch.stack(
        [
            view.fx_px * (tangents[:, 0] / z[:, None] - (x / z)[:, None] * slopes),
            view.fy_px * (tangents[:, 1] / z[:, None] - (y / z)[:, None] * slopes),
        ],
        dim=1,
    )
    centres = torch.stack([view.fx_px * x / z + view.cx_px, view.fy_px * y / z + view.cy_px], dim=-1)
    return Projected(centres, z, jacobians, slopes)
