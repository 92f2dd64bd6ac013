"""A rasteriser of splats as one writes it in torch: square by square, with gradients by autograd.

The same picture as `reconstruction.splats.rasterise` draws, as what the compiled one is measured against.
"""

from __future__ import annotations

import torch
from torch import Tensor

from reconstruction.splats.rasterising.numba_backend import sort_into_tiles
from reconstruction.splats.rasterising.projection import Projected, project
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View

TILE_PX = 16


def rasterise_in_torch(
    means: Tensor, quats: Tensor, scales: Tensor, opacities: Tensor, features: Tensor, view: View
) -> tuple[Tensor, Tensor, Tensor, float]:
    """Features, shape (h, w, c), alphas and depths, shape (h, w), and how many splats count in a pixel on average.

    All splats have to lie well in front of the camera, and be seen less flat than 80 degrees.
    """
    settings = RasterSettings()
    splats = project(means, quats, scales, view)
    boxes = _boxes(splats, settings, view)
    depths = splats.depths_m.detach().double().numpy()
    tiles = sort_into_tiles(boxes.numpy(), depths, view.width_px, view.height_px, TILE_PX)
    rows, n_counted = [], 0
    for first_row in range(0, view.height_px, TILE_PX):
        squares = []
        for first_column in range(0, view.width_px, TILE_PX):
            tile = first_row // TILE_PX * tiles.n_columns + first_column // TILE_PX
            which = torch.from_numpy(tiles.splats[tiles.starts[tile] : tiles.starts[tile + 1]]).long()
            square, n = _blend(splats, opacities, features, which, first_column, first_row, settings)
            squares.append(square)
            n_counted += n
        rows.append(torch.cat(squares, dim=1))
    picture = torch.cat(rows)[: view.height_px, : view.width_px]
    return picture[..., :-2], picture[..., -2], picture[..., -1], n_counted / (view.width_px * view.height_px)


@torch.no_grad()
def _boxes(splats: Projected, settings: RasterSettings, view: View) -> Tensor:
    """Half-open ranges of columns and rows, shape (n, 4): left, right, top, bottom."""
    half = settings.reach * splats.jacobians_px.norm(dim=2).clamp(min=settings.low_pass_px) * 1.1 + 1.0
    low, high = (splats.centres_px - half).floor().int(), (splats.centres_px + half).ceil().int()
    width, height = view.width_px, view.height_px
    left, right = low[:, 0].clamp(0, width), high[:, 0].clamp(0, width)
    top, bottom = low[:, 1].clamp(0, height), high[:, 1].clamp(0, height)
    is_in = ((right > left) & (bottom > top)).int()
    return torch.stack([left * is_in, right * is_in, top * is_in, bottom * is_in], dim=1)


def _blend(
    splats: Projected,
    opacities: Tensor,
    features: Tensor,
    which: Tensor,
    first_column: int,
    first_row: int,
    settings: RasterSettings,
) -> tuple[Tensor, int]:
    """Features, alpha and depth of a square, shape (16, 16, c + 2), and how many splats count in its pixels."""
    p = torch.arange(TILE_PX * TILE_PX)
    centres, jacobian, slopes = splats.centres_px[which], splats.jacobians_px[which], splats.slopes[which]
    x = (first_column + p % TILE_PX + 0.5) - centres[:, :1]
    y = (first_row + p // TILE_PX + 0.5) - centres[:, 1:]
    j_xu, j_xv, j_yu, j_yv = jacobian.reshape(-1, 4).T[..., None]
    q_u, q_v = slopes.T[..., None]
    area = j_xu * j_yv - j_xv * j_yu
    d = 1.0 + (x * (j_yu * q_v - j_yv * q_u) + y * (j_xv * q_u - j_xu * q_v)) / area
    disc = ((x * j_yv - y * j_xv) ** 2 + (y * j_xu - x * j_yu) ** 2) / (area * d) ** 2
    exponent = torch.minimum(disc, (x * x + y * y) / settings.low_pass_px**2)
    alpha = (opacities[which, None] * torch.exp(-0.5 * exponent)).clamp(max=settings.max_alpha)
    alpha = torch.where(alpha >= settings.min_alpha, alpha, torch.zeros_like(alpha))
    through = torch.cumprod(torch.cat([torch.ones_like(x[:1]), 1.0 - alpha]), dim=0)[:-1]
    weights = torch.where(through >= settings.min_transmittance, through * alpha, torch.zeros_like(alpha))
    depth = (weights * splats.depths_m[which, None] / d).sum(dim=0)
    found = torch.cat([weights.T @ features[which], weights.sum(dim=0)[:, None], depth[:, None]], dim=1)
    return found.reshape(TILE_PX, TILE_PX, -1), int((weights.detach() > 0.0).sum())
