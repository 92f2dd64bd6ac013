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

A disc that is blurred in the picture by a standard deviation b is again a disc, with J' and q' in the place of J and q:

    J' J'^T = J J^T + b^2 I = C        q' = -J'^T p'        t / a = p' . (x, y)

J' is Cholesky's root here: any other draws the same. C is that of EWA splatting (Zwicker et al., 2001), by which
ellipsoids are blurred too. The disc's own plane has p = -J^-T q, which grows without end as it is seen from the side.
So p' is p up to the slope s of a plane at `FLAT_ENOUGH_RAD`, and (s / |p|)^2 of it beyond, where the rest is from
-C^-1 J q: that is finite, and gives each pixel the depth of the disc's point that is most likely seen in it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from reconstruction.splats.rasterising.raster_types import SOLID, RasterSettings
from reconstruction.splats.rasterising.views import View

LEAST_NORM = 1e-12
"""Quaternions shorter than this say nothing about a rotation; they stand for none, and have no gradient."""


SMALLEST = 1e-150
"""Of areas, px^2, that are divided by; the square is still a number."""


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


def blurred(projected: Projected, blur_px: float, steepest: float) -> Projected:
    """Discs as a picture shows them that is blurred by so much; each still has an area of `blur_px` squared or more.

    Parameters
    ----------
    steepest
        |p| up to which p' is p, 1 / px; see `raster.steepest`.
    """
    jacobians, (q_u, q_v) = projected.jacobians_px, projected.slopes.unbind(dim=1)
    (xu, xv), (yu, yv) = ((row[:, 0], row[:, 1]) for row in jacobians.unbind(dim=1))
    blur2, area, square = blur_px * blur_px, areas_of(jacobians), blurred_areas2(jacobians, blur_px)
    xx, xy, yy = xu * xu + xv * xv + blur2, xu * yu + xv * yv, yu * yu + yv * yv + blur2
    along_x, along_y = xu * q_u + xv * q_v, yu * q_u + yv * q_v
    likely = torch.stack([xy * along_y - yy * along_x, xy * along_x - xx * along_y], dim=1) / square[:, None]
    plane = torch.stack([yu * q_v - yv * q_u, xv * q_u - xu * q_v], dim=1)
    limit, steepness2 = steepest * steepest, plane.square().sum(dim=1)
    is_flat = (limit * area * area >= steepness2) & (area.abs() >= SMALLEST)
    tapered = limit * area / steepness2.clamp(min=SMALLEST**2)
    over = torch.where(is_flat, 1.0 / torch.where(is_flat, area, 1.0), tapered)
    p_x, p_y = ((1.0 - over * area)[:, None] * likely + over[:, None] * plane).unbind(dim=1)
    upper = torch.sqrt(xx)
    beside, lower = xy / upper, torch.sqrt(square) / upper
    rows = torch.stack([upper, torch.zeros_like(upper)], dim=1), torch.stack([beside, lower], dim=1)
    slopes = -torch.stack([upper * p_x + beside * p_y, lower * p_y], dim=1)
    return replace(projected, jacobians_px=torch.stack(rows, dim=1), slopes=slopes)


def blurred_areas2(jacobians_px: Tensor, blur_px: float) -> Tensor:
    """det(J J^T + b^2 I), shape (n,): a^2 + b^2 (|J|^2 + b^2), in which nothing cancels, however thin a disc is."""
    blur2 = blur_px * blur_px
    return areas_of(jacobians_px).square() + blur2 * (jacobians_px.square().sum(dim=(1, 2)) + blur2)


def areas_of(jacobians_px: Tensor) -> Tensor:
    """Det J, shape (n,), px^2; below 0 where a disc is seen from behind."""
    return jacobians_px[:, 0, 0] * jacobians_px[:, 1, 1] - jacobians_px[:, 0, 1] * jacobians_px[:, 1, 0]


# Ellipsoids as a camera sees them, in float64 torch: the readable form, with gradients by autograd.
#
# A 3-D Gaussian (Kerbl et al., "3D Gaussian Splatting", 2023) has the weight exp(-(P - p)^T Sigma^-1 (P - p) / 2)
# with
# Sigma = R S S^T R^T. Its picture is taken for that of a Gaussian again (EWA splatting: Zwicker et al., 2001), with
#
#     Sigma' = J W Sigma W^T J^T + k^2 I        J = [[fx / z, 0, -fx x / z^2], [0, fy / z, -fy y / z^2]]
#
# W the camera's rotation, (x, y, z) the middle in camera axes, and k the blur by which none falls between pixels. So
# it
# is a disc that faces the camera: (u, v) = L^-1 (x', y') with any L for which L L^T = Sigma', here Cholesky's, and
# one
# depth all over it. In J, x / z and y / z are kept near the picture, as in 3DGS: far outside, the picture of an
# ellipsoid
# is no Gaussian, and it would smear over everything.

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


# How much of its opacity a splat keeps where it is drawn larger than a camera sees it, in torch.
#
# What is finer than a pixel is drawn about a pixel wide, by a blur of the picture. Were it as opaque as it is, a bar
# would grow with its distance, and a model that was learned from near would be wrong from afar. So the opacity is
# multiplied by the share that the splat has of what is drawn: |Sigma'|^(1/2) of its picture without blur over the
# same
# with it (Yu et al., "Mip-Splatting", CVPR 2024), of discs as of ellipsoids.

SMALLEST_FOOTPRINT = 1e-30
"""Of areas, px^2, whose roots have gradients."""


def shown_opacities(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, opacities: Tensor, view: View, settings: RasterSettings
) -> Tensor:
    """Opacities, shape (n,), that splats in front of the camera are drawn with; as they are if not `antialiased`.

    However small its share, a splat keeps `settings.faintest`: a surface of many still hides what is behind it then.

    Parameters
    ----------
    means, quats_wxyz, scales, opacities
        As `rasteriser.rasterise` takes them.
    """
    if not settings.antialiased:
        return opacities
    shown = opacities * footprint_shares(means, quats_wxyz, scales, view, settings)
    return torch.minimum(opacities, shown.clamp(min=settings.faintest))


def footprint_shares(means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View, settings: RasterSettings) -> Tensor:
    """Shares of what is drawn, shape (n,), 0 to 1, that are the splats' own."""
    if scales.shape[1] == SOLID:
        row_x, row_y = rows_of(means, quats_wxyz, scales, view)
        across = torch.linalg.cross(row_x, row_y).square().sum(dim=-1).clamp(min=SMALLEST_FOOTPRINT**2)
        blur2 = settings.blur_px**2
        blurred = across + blur2 * (row_x.square().sum(dim=-1) + row_y.square().sum(dim=-1) + blur2)
        return torch.sqrt(across / blurred)
    jacobians = project(means, quats_wxyz, scales, view).jacobians_px
    return areas_of(jacobians).abs() / torch.sqrt(blurred_areas2(jacobians, settings.blur_px))
