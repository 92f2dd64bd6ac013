"""The rasteriser in plain torch, splat by splat over the whole picture: slow, and the definition of what a raster is.

Gradients come from autograd. Meant for float64 and some hundred splats; the fast rasterisers are compared with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from reconstruction.splats.rasterising.projection import (
    Projected,
    blurred,
    depths_of,
    project,
    project_ellipsoids,
    shown_opacities,
)
from reconstruction.splats.rasterising.raster_types import SOLID, Raster, RasterSettings, steepest
from reconstruction.splats.rasterising.views import View

LEAST_AREA_PX2 = 1e-6
"""|det J| below which a splat is seen edge-on: its disc is thinner than a millionth of a pixel, and only the low-pass
filter draws it, with the depth of its middle."""

LIMITS_WIDENED = 1.001
"""So that rounding does not take a disc's own rim beyond the limits of its depth."""
MOST_CHANGE = 1e5
"""Times the depth of its middle that a splat may reach behind it: float32 cannot tell more from the horizon."""


@dataclass(frozen=True, slots=True, eq=False)
class SplatImage:
    """One splat over the picture: alpha and depth, each shape (h, w)."""

    alpha: Tensor
    depth: Tensor


def rasterise_torch(
    means: Tensor,
    quats_wxyz: Tensor,
    scales: Tensor,
    opacities: Tensor,
    features: Tensor,
    view: View,
    screen_offsets: Tensor | None,
    labels: Tensor | None,
    settings: RasterSettings,
) -> Raster:
    """See `rasteriser.rasterise`; results have the precision of `means`."""
    drawn = _drawn_in_order(means, quats_wxyz, scales, opacities, view, settings)
    is_solid = scales.shape[1] == SOLID
    shapes = means[drawn], quats_wxyz[drawn], scales[drawn]
    if is_solid:
        projected = project_ellipsoids(*shapes, view, settings.blur_px)
    else:
        projected = project(*shapes, view)
        if settings.antialiased:
            projected = blurred(projected, settings.blur_px, steepest(min(view.fx_px, view.fy_px)))
    shown = shown_opacities(*shapes, opacities[drawn], view, settings)
    if screen_offsets is not None:
        shifted = projected.centres_px + screen_offsets[drawn].to(means.dtype)
        projected = Projected(shifted, projected.depths_m, projected.jacobians_px, projected.slopes)
    x, y = _pixel_middles(view, means)
    through = torch.ones_like(x)
    sums = [x.new_zeros(*x.shape, features.shape[1]), torch.zeros_like(x), torch.zeros_like(x)]
    weights, radii = torch.zeros_like(means[:, 0]), torch.zeros_like(means[:, 0])
    votes: dict[int, Tensor] = {}
    for place, index in enumerate(drawn.tolist()):
        if is_solid:
            image = _ellipsoid_image(projected, place, shown[place], x, y, settings)
        else:
            image = _splat_image(projected, place, shown[place], x, y, min(view.fx_px, view.fy_px), settings)
        is_open = through.detach() >= settings.min_transmittance
        alpha = torch.where(is_open, image.alpha, torch.zeros_like(x))
        weight = through * alpha
        sums = [
            sums[0] + weight[..., None] * features[index],
            sums[1] + weight,
            sums[2] + weight * image.depth,
        ]
        through = through * (1.0 - alpha)
        weights[index] = weight.detach().sum()
        radii[index] = _radius_px(image.alpha.detach())
        if labels is not None:
            label = int(labels[index])
            votes[label] = votes.get(label, torch.zeros_like(x)) + weight.detach()
    return Raster(sums[0], sums[1], sums[2], _heaviest(votes, x) if labels is not None else None, weights, radii)


def _drawn_in_order(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, opacities: Tensor, view: View, settings: RasterSettings
) -> Tensor:
    """Indices of the splats that can be seen, nearest middle first; equally near ones stay in order."""
    depths = depths_of(means.detach(), view)
    is_drawn = (depths > settings.near_m) & (opacities.detach() >= settings.min_alpha)
    for values in (means, quats_wxyz, scales, opacities[:, None]):
        is_drawn &= values.detach().isfinite().all(dim=1)
    is_drawn &= (scales.detach() > 0.0).all(dim=1)
    candidates = torch.nonzero(is_drawn)[:, 0]
    return candidates[torch.argsort(depths[candidates], stable=True)]


def _pixel_middles(view: View, like: Tensor) -> tuple[Tensor, Tensor]:
    y, x = torch.meshgrid(torch.arange(view.height_px), torch.arange(view.width_px), indexing="ij")
    return x.to(like) + 0.5, y.to(like) + 0.5


def _splat_image(
    splats: Projected,
    place: int,
    opacity: Tensor,
    x_px: Tensor,
    y_px: Tensor,
    focal_px: float,
    settings: RasterSettings,
) -> SplatImage:
    """Alpha = opacity * exp(-min(disc, low pass) / 2), Eq. 11 of 2DGS; 0 where it is below the cut.

    What is blurred has no low-pass filter besides.
    """
    (j_xu, j_xv), (j_yu, j_yv) = (row.unbind() for row in splats.jacobians_px[place])
    q_u, q_v = splats.slopes[place].unbind()
    x, y = x_px - splats.centres_px[place, 0], y_px - splats.centres_px[place, 1]
    n_u, n_v = x * j_yv - y * j_xv, y * j_xu - x * j_yu
    area = j_xu * j_yv - j_xv * j_yu
    t = x * (j_yu * q_v - j_yv * q_u) + y * (j_xv * q_u - j_xu * q_v)
    middle, low_pass = splats.depths_m[place], (x * x + y * y) * settings.over_low_pass2
    if bool(area.abs() >= LEAST_AREA_PX2):
        over_area = 1.0 / area
        lowest, highest = _depth_limits(middle, splats.slopes[place], focal_px, settings)
        plane = t * over_area
        is_plane = (plane >= lowest) & (plane <= highest)
        d = 1.0 + torch.where(is_plane, plane, plane.detach().clamp(lowest, highest))
        disc = (n_u * n_u + n_v * n_v) * (over_area / d) ** 2
        exponent = torch.where(is_plane & (disc <= low_pass), disc, low_pass)
        depth = middle / d
    else:
        exponent, depth = low_pass, middle.expand_as(x)
    return SplatImage(_covered(opacity, exponent, settings), depth)


def _ellipsoid_image(
    splats: Projected, place: int, opacity: Tensor, x_px: Tensor, y_px: Tensor, settings: RasterSettings
) -> SplatImage:
    """The same of a disc that faces the camera, whose Jacobian is lower triangular."""
    (j_xu, _), (j_yu, j_yv) = (row.unbind() for row in splats.jacobians_px[place])
    u = (x_px - splats.centres_px[place, 0]) / j_xu
    v = (y_px - splats.centres_px[place, 1] - j_yu * u) / j_yv
    return SplatImage(_covered(opacity, u * u + v * v, settings), splats.depths_m[place].expand_as(u))


def _covered(opacity: Tensor, exponent: Tensor, settings: RasterSettings) -> Tensor:
    """Opacity * exp(-exponent / 2), limited, and 0 below the cut."""
    alpha = (opacity * torch.exp(-0.5 * exponent)).clamp(max=settings.max_alpha)
    return torch.where(alpha >= settings.min_alpha, alpha, torch.zeros_like(alpha))


def _depth_limits(middle: Tensor, slopes: Tensor, focal_px: float, settings: RasterSettings) -> tuple[float, float]:
    """What D = 1 + t, the depth of the middle over that of the plane, is limited to, as limits of t.

    Where only the low-pass filter draws a splat, the ray may meet its plane far off or behind the camera. So the depth
    is that of the plane as long as this lies within the splat's own extent or, for splats smaller than a pixel, as
    near as the plane's depth changes within the filter at 80 degrees; beyond it stays there. It is never less than
    `near_m`. Wherever the disc itself counts it is the plane's.
    """
    change = max(settings.reach * float(slopes.detach().norm()), settings.least_depth_change(focal_px))
    change = min(change * LIMITS_WIDENED, MOST_CHANGE)
    nearest = float(middle.detach()) / settings.near_m - 1.0
    return -change / (1.0 + change), min(change / (1.0 - change), nearest) if change < 1.0 else nearest


def _radius_px(alpha: Tensor) -> Tensor:
    rows, columns = torch.nonzero(alpha, as_tuple=True)
    if len(rows) == 0:
        return alpha.new_zeros(())
    return 0.5 * (1 + torch.maximum(rows.max() - rows.min(), columns.max() - columns.min())).to(alpha)


def _heaviest(votes: dict[int, Tensor], like: Tensor) -> Tensor:
    best, found = torch.zeros_like(like), torch.full(like.shape, -1, dtype=torch.int32, device=like.device)
    for label in sorted(votes):
        is_better = votes[label] > best
        best = torch.where(is_better, votes[label], best)
        found = torch.where(is_better, torch.full_like(found, label), found)
    return found
