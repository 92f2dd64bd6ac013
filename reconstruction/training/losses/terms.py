"""What the joint training makes small (paper Eqs. 23 to 27); terms that nothing counts for are 0, with gradients 0.

Normals are world axes (ENU). Sums over splats (`sum w n`) are as the rasteriser blends them: not divided by alpha, so
that a term also asks for surfaces that are closed.
"""

from __future__ import annotations

import torch
from torch import Tensor

from reconstruction.light.losses import high_frequency_loss, ray_errors
from reconstruction.metrics.image_metrics import WINDOW_PX
from reconstruction.splats.rasterising.views import View
from reconstruction.training.losses.dssim import dssim

SHORTEST = 1e-12
"""Squared length below which a vector has no direction."""

CLOSED = 0.5
"""Least alpha of a pixel whose depth says where a surface is; below, most of what is seen lies behind it."""


def unit(vectors: Tensor) -> Tensor:
    """Unit vectors along the last axis; 0, with gradients 0, where a vector has no length."""
    square = (vectors * vectors).sum(dim=-1, keepdim=True)
    is_short = square < SHORTEST
    length = torch.sqrt(torch.where(is_short, torch.ones_like(square), square))
    return torch.where(is_short, torch.zeros_like(vectors), vectors / length)


def colour_loss(found: Tensor, truth: Tensor, dssim_weight: float) -> Tensor:
    """(1 - lambda) L1 + lambda D-SSIM (Eq. 25) of pictures, shape (h, w, 3), sRGB values 0 to 1.

    Where the photo is overexposed, what is brighter than it can show is no error. Pictures that D-SSIM's window does
    not fit into have L1 alone.
    """
    found = torch.where(truth >= 1.0, found.clamp(max=1.0), found)
    absolute = (found - truth).abs().mean()
    if dssim_weight == 0.0 or min(found.shape[:2]) < WINDOW_PX:
        return absolute
    return (1.0 - dssim_weight) * absolute + dssim_weight * dssim(found, truth)


def surface_normals(depths: Tensor, alphas: Tensor, view: View) -> tuple[Tensor, Tensor]:
    """Unit normals N of the surface that a depth map shows, turned to the camera, and where they are known.

    The places that each pixel's left and right, upper and lower neighbours show span a plane.

    Parameters
    ----------
    depths
        Sum of w_i z_i along the optical axis, m, shape (h, w).
    alphas
        Sum of w_i, shape (h, w).

    Returns
    -------
    normals
        World axes, shape (h, w, 3); 0 where not known.
    is_known
        Shape (h, w): all four neighbours are `CLOSED`. False in the outermost pixels.
    """
    is_closed = alphas > CLOSED
    z = depths / torch.where(is_closed, alphas, torch.ones_like(alphas))
    rays = _rays_with_depth_1(view, depths)
    places = rays * z[..., None]
    across = places[1:-1, 2:] - places[1:-1, :-2]
    down = places[2:, 1:-1] - places[:-2, 1:-1]
    normals = torch.zeros_like(places)
    # Pictures' x is to the right and y downwards: their product points away from the camera.
    normals[1:-1, 1:-1] = unit(torch.linalg.cross(down, across))
    is_known = torch.zeros_like(is_closed)
    is_known[1:-1, 1:-1] = is_closed[1:-1, 2:] & is_closed[1:-1, :-2] & is_closed[2:, 1:-1] & is_closed[:-2, 1:-1]
    faces_away = (normals * rays).sum(dim=-1, keepdim=True) > 0.0
    normals = torch.where(faces_away, -normals, normals)
    return torch.where(is_known[..., None], normals, torch.zeros_like(normals)), is_known


def _rays_with_depth_1(view: View, like: Tensor) -> Tensor:
    """World axes, shape (h, w, 3), as long as makes their depth 1."""
    x = (torch.arange(view.width_px, device=like.device) + 0.5 - view.cx_px) / view.fx_px
    y = (torch.arange(view.height_px, device=like.device) + 0.5 - view.cy_px) / view.fy_px
    rows, columns = torch.meshgrid(y, x, indexing="ij")
    rays = torch.stack([columns, rows, torch.ones_like(rows)], dim=-1).to(like.dtype)
    return rays @ view.cam_from_world[:3, :3].to(like)


def normal_consistency(normals: Tensor, alphas: Tensor, surface: Tensor, is_known: Tensor) -> Tensor:
    """Mean over pixels of sum_i w_i (1 - n_i . N) = sum w - (sum w n) . N (Eq. 26), over pixels where N is known.

    Parameters
    ----------
    normals
        Sum of w_i n_i, shape (h, w, 3), turned to the camera.
    alphas
        Sum of w_i, shape (h, w).
    surface, is_known
        Of `surface_normals`.
    """
    off = alphas - (normals * surface).sum(dim=-1)
    return _mean_where(off, is_known)


def normal_prior(normals: Tensor, reference: Tensor, mask: Tensor) -> Tensor:
    """L1 distance of rendered normals to those of the refined mesh (Eq. 23), over masked pixels that have one.

    Parameters
    ----------
    normals
        Sum of w_i n_i, shape (h, w, 3).
    reference
        Unit, turned to the camera, shape (h, w, 3); 0 where there is none.
    mask
        Facade, shape (h, w).
    """
    is_counted = mask & (reference != 0.0).any(dim=-1)
    return _mean_where((normals - reference).abs().sum(dim=-1), is_counted)


def worst_pixels(found: Tensor, truth: Tensor, mask: Tensor, threshold: float) -> Tensor:
    """Mean error of the masked pixels whose error is above the threshold (Eq. 24).

    Parameters
    ----------
    found, truth
        sRGB values 0 to 1, shape (h, w, 3).
    mask
        Omega, shape (h, w).
    """
    return high_frequency_loss(ray_errors(found, truth) * mask.to(found.dtype), threshold)


def _mean_where(values: Tensor, is_counted: Tensor) -> Tensor:
    counted = is_counted.to(values.dtype)
    return (torch.where(is_counted, values, torch.zeros_like(values))).sum() / counted.sum().clamp(min=1.0)
