"""The rasteriser for CUDA: gsplat's kernels (Apache-2.0, extra `cuda`), with what they lack made from channels.

gsplat's own depth is that of splats' middles, centimetres off on a plane seen at an angle. Here each splat's normal and
the distance of its plane are blended as four more channels, and the depth is where the pixel's ray meets the blended
plane. It is exact on planes; across an edge it is that of a plane between the two.

Ellipsoids are drawn by its 3DGS kernels, with the depth of the middle as one more channel.

Discs that are antialiased are projected and blurred in torch, and drawn by its 2DGS kernels from there; the low-pass
filter that these have compiled in is laid far outside the picture.

Differences from the other rasterisers that its compiled kernels fix: alpha up to 0.999, the splat that would close a
pixel is left out, the low-pass filter lies in the middle of the disc's box, discs end at three standard deviations, and
gradients are added up in any order. Settings other than `low_pass_px`, `blur_px`, `min_alpha` and `near_m` have no
effect; the first and the third cannot be changed. Where its 2DGS part has no kernel for so many channels, it fills them
up with memory as it finds it, and what is no number there makes gradients none: here they are filled up with zeros.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, replace

import torch
from torch import Tensor
from torch.nn import functional

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.splats.rasterising.projection import (
    Projected,
    blurred,
    depths_of,
    project,
    rotations,
    shown_opacities,
)
from reconstruction.splats.rasterising.raster_types import SOLID, Raster, RasterSettings, steepest
from reconstruction.splats.rasterising.views import View

Blend = Callable[[Tensor], Tensor]
"""Features, shape (n, c), to the picture of them, shape (h, w, c)."""

TILE_PX = 16
LABELS_AT_ONCE = 32
"""Channels in one pass that gsplat has kernels for."""

FAR_PX = -1e6
"""Where a low-pass filter lies that is not to count."""

WIDEST_PX = 1e6
"""Of half a box: more than any picture, and little enough for whole numbers."""

LEAST_COSINE = 1e-3
"""Between a ray and the blended plane: seen flatter, the plane's depth says nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class _ProjectedSplats:
    """Splats as gsplat projects them, each with one camera in front.

    Parameters
    ----------
    radii_px, centres_px, depths_m
        Shapes (1, n, 2), (1, n, 2) and (1, n); the first two are half the sizes and the middles of what is drawn.
    shapes
        Ray transforms of discs, shape (1, n, 3, 3), or conics of ellipsoids, shape (1, n, 3).
    normals
        Of discs, shape (1, n, 3).
    has_low_pass
        Of discs: whether they are drawn as a circle at their middles where they are smaller.
    """

    radii_px: Tensor
    centres_px: Tensor
    depths_m: Tensor
    shapes: Tensor
    normals: Tensor | None
    has_low_pass: bool = True

    def detached(self) -> _ProjectedSplats:
        """Without gradients."""
        return replace(
            self,
            centres_px=self.centres_px.detach(),
            depths_m=self.depths_m.detach(),
            shapes=self.shapes.detach(),
            normals=None if self.normals is None else self.normals.detach(),
        )


def why_not_gsplat() -> str:
    """What keeps gsplat from working here; empty where nothing does. Its kernels are compiled on the first call."""
    if not torch.cuda.is_available():
        return say("torch finds no CUDA device")
    if importlib.util.find_spec("gsplat") is None:
        return say("gsplat is not installed (pip install 'reflight-groundstation[cuda]')")
    from gsplat.cuda import _backend

    return (
        "" if _backend._C is not None else say("gsplat's kernels are not compiled, which takes NVIDIA's CUDA toolkit")
    )


def rasterise_gsplat(
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
    """See `rasteriser.rasterise`; all float32 on one CUDA device.

    Weights take one more pass forward and backward over one channel, labels one more for every 32 different ones.

    Raises
    ------
    InputError
        gsplat does not work here.
    """
    reason = why_not_gsplat()
    if reason:
        raise InputError(say("splats on CUDA are drawn by gsplat, and {}; or compute on the processor", reason))
    usual = RasterSettings()
    if (settings.low_pass_px, settings.min_alpha) != (usual.low_pass_px, usual.min_alpha):
        raise ValueError(f"low_pass_px, min_alpha: gsplat has {usual.low_pass_px} and {usual.min_alpha} compiled in")
    lens = means.new_tensor([[view.fx_px, 0.0, view.cx_px], [0.0, view.fy_px, view.cy_px], [0.0, 0.0, 1.0]])
    if scales.shape[1] == SOLID:
        projected = _projected_ellipsoids(means, quats_wxyz, scales, view, lens, settings)
        depths = depths_of(means, view)[:, None]
    else:
        projecting = _blurred_discs if settings.antialiased else _projected_discs
        projected = projecting(means, quats_wxyz, scales, view, lens, settings)
        depths = plane_channels(means, quats_wxyz, view)
    if screen_offsets is not None:
        projected = _moved(projected, screen_offsets)
    opacities = _shown(means, quats_wxyz, scales, opacities, view, settings)
    picture, alphas = _blend(torch.cat([features, depths], dim=1), opacities, projected, view)
    fixed = projected.detached()

    def again(values: Tensor) -> Tensor:
        return _blend(values, opacities.detach(), fixed, view)[0]

    blended = picture[..., features.shape[1] :]
    return Raster(
        picture[..., : features.shape[1]],
        alphas,
        blended[..., 0] if scales.shape[1] == SOLID else plane_depths(blended, alphas, view, settings.near_m),
        None if labels is None else heaviest_labels(again, labels),
        accumulated_weights(again, means),
        projected.radii_px[0].amax(dim=-1).to(means),
    )


def _shown(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, opacities: Tensor, view: View, settings: RasterSettings
) -> Tensor:
    """Opacities that splats are drawn with; in float64, where nothing of what is before the camera overflows."""
    rows = torch.nonzero(depths_of(means.detach(), view) > settings.near_m).squeeze(-1)
    shapes = means[rows].double(), quats_wxyz[rows].double(), scales[rows].double()
    shown = shown_opacities(*shapes, opacities[rows].double(), view, settings)
    return opacities.index_put((rows,), shown.to(opacities))


def _projected_discs(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View, lens: Tensor, settings: RasterSettings
) -> _ProjectedSplats:
    """Of standard deviations along two tangents."""
    from gsplat import fully_fused_projection_2dgs

    thickness = torch.ones_like(scales[:, :1])
    return _ProjectedSplats(
        *fully_fused_projection_2dgs(
            means, quats_wxyz, torch.cat([scales, thickness], dim=1), view.cam_from_world.to(means)[None], lens[None],
            view.width_px, view.height_px, near_plane=settings.near_m,
        )
    )  # fmt: skip


def _blurred_discs(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View, lens: Tensor, settings: RasterSettings
) -> _ProjectedSplats:
    """The same, blurred; in float64, as `_shown`."""
    rows = torch.nonzero(depths_of(means.detach(), view) > settings.near_m).squeeze(-1)
    seen = project(means[rows].double(), quats_wxyz[rows].double(), scales[rows].double(), view)
    seen = blurred(seen, settings.blur_px, steepest(min(view.fx_px, view.fy_px)))
    middles, halves = boxes_of(seen, settings.reach, view)

    def of_all(values: Tensor, like: Tensor) -> Tensor:
        found = torch.zeros((len(means), *values.shape[1:]), dtype=like.dtype, device=means.device)
        return found.index_put((rows,), values.to(like.dtype))[None]

    return _ProjectedSplats(
        of_all(halves.ceil(), torch.zeros((), dtype=torch.int32)),
        of_all(middles, means),
        of_all(seen.depths_m, means),
        of_all(ray_transforms(seen), means),
        (rotations(quats_wxyz)[..., 2] @ view.cam_from_world.to(means)[:3, :3].T)[None],
        False,
    )


def ray_transforms(projected: Projected) -> Tensor:
    """Of discs, shape (n, 3, 3): (u, v, 1) to (x w, y w, w), with (x, y) the pixel and w the depth, metres."""
    ones = torch.ones_like(projected.slopes[:, :1])
    depths = torch.cat([projected.slopes, ones], dim=1)
    moved = torch.cat([projected.jacobians_px, torch.zeros_like(projected.centres_px)[..., None]], dim=2)
    rows = moved + projected.centres_px[..., None] * depths[:, None]
    return projected.depths_m[:, None, None] * torch.cat([rows, depths[:, None]], dim=1)


@torch.no_grad()
def boxes_of(projected: Projected, reach: float, view: View) -> tuple[Tensor, Tensor]:
    """Middles and half sizes of what discs cover up to so many standard deviations, each shape (n, 2), px.

    Of those that reach behind the camera it is the whole picture.
    """
    jacobians, slopes = projected.jacobians_px, projected.slopes
    left = 1.0 - reach * reach * slopes.square().sum(dim=1)
    is_before = left > 0.0
    share = (reach * reach / torch.where(is_before, left, 1.0))[:, None]
    shift = -share * (jacobians @ slopes[..., None])[..., 0]
    halves = torch.sqrt(shift.square() + share * jacobians.square().sum(dim=2))
    whole = shift.new_tensor([view.width_px, view.height_px])
    middles = torch.where(is_before[:, None], projected.centres_px + shift, 0.5 * whole)
    return middles, torch.where(is_before[:, None], halves, whole).clamp(max=WIDEST_PX)


def _projected_ellipsoids(
    means: Tensor, quats_wxyz: Tensor, scales: Tensor, view: View, lens: Tensor, settings: RasterSettings
) -> _ProjectedSplats:
    """Of standard deviations along three axes, by the whole picture, whose field of view limits their shape."""
    from gsplat import fully_fused_projection

    left, right, top, bottom = view.of_picture_px
    corner = means.new_tensor([left, top])
    of_picture = torch.cat([torch.cat([lens[:2, :2], (lens[:2, 2] - corner)[:, None]], dim=1), lens[2:]])
    radii, centres, depths, conics, _ = fully_fused_projection(
        means, None, quats_wxyz, scales, view.cam_from_world.to(means)[None], of_picture[None],
        right - left, bottom - top, eps2d=settings.blur_px**2, near_plane=settings.near_m,
    )  # fmt: skip
    return _ProjectedSplats(radii, centres + corner, depths, conics, None)


def _moved(projected: _ProjectedSplats, offsets: Tensor) -> _ProjectedSplats:
    """Moved in the picture by offsets, shape (n, 2), px."""
    shapes = projected.shapes
    if projected.normals is not None:
        # Rows of a disc's transform are x w, y w and w: a shift by o adds o w, as the definition has it.
        rows = shapes[..., :2, :] + offsets[..., None] * shapes[..., 2:, :]
        shapes = torch.cat([rows, shapes[..., 2:, :]], dim=-2)
    return replace(projected, centres_px=projected.centres_px + offsets, shapes=shapes)


def _blend(channels: Tensor, opacities: Tensor, projected: _ProjectedSplats, view: View) -> tuple[Tensor, Tensor]:
    """Channels, shape (n, c), and alphas of all splats as pictures, shapes (h, w, c) and (h, w)."""
    n_channels = channels.shape[1]
    channels = filled_up(channels)
    from gsplat import isect_offset_encode, isect_tiles, rasterize_to_pixels, rasterize_to_pixels_2dgs

    n_columns, n_rows = -(-view.width_px // TILE_PX), -(-view.height_px // TILE_PX)
    _, tile_ids, splat_ids = isect_tiles(
        projected.centres_px.detach(), projected.radii_px, projected.depths_m.detach(), TILE_PX, n_columns, n_rows
    )
    starts = isect_offset_encode(tile_ids, 1, n_columns, n_rows).reshape(1, n_rows, n_columns)
    of_tiles = view.width_px, view.height_px, TILE_PX, starts, splat_ids
    colours = channels[None], opacities[None]
    if projected.normals is None:
        picture, alphas = rasterize_to_pixels(projected.centres_px, projected.shapes, *colours, *of_tiles)
    else:
        densify = torch.zeros_like(projected.centres_px)
        circles = projected.centres_px if projected.has_low_pass else torch.full_like(projected.centres_px, FAR_PX)
        picture, alphas, *_ = rasterize_to_pixels_2dgs(
            circles, projected.shapes, *colours, projected.normals, densify, *of_tiles
        )
    return picture[0, ..., :n_channels], alphas[0, ..., 0]


def filled_up(channels: Tensor) -> Tensor:
    """Channels, shape (n, c), and zeros up to the next power of two, of which gsplat has kernels."""
    missing = (1 << (channels.shape[1] - 1).bit_length()) - channels.shape[1]
    return functional.pad(channels, (0, missing))


def plane_channels(means: Tensor, quats_wxyz: Tensor, view: View) -> Tensor:
    """Normals that face the camera, in its axes, and normal . middle, shape (n, 4)."""
    camera = view.cam_from_world.to(means)
    normals = rotations(quats_wxyz)[..., 2] @ camera[:3, :3].T
    offsets = (normals * (means @ camera[:3, :3].T + camera[:3, 3])).sum(dim=-1, keepdim=True)
    facing = torch.where(offsets.detach() > 0.0, -1.0, 1.0)
    return torch.cat([normals * facing, offsets * facing], dim=1)


def plane_depths(planes: Tensor, alphas: Tensor, view: View, near_m: float) -> Tensor:
    """Sum of weights times depth, shape (h, w), from blended `plane_channels`, shape (h, w, 4).

    A blended plane sum(w n) . p = sum(w o) meets the ray p = z d, with d_z = 1, at z = sum(w o) / (sum(w n) . d).
    """
    x = (torch.arange(view.width_px).to(planes) + 0.5 - view.cx_px) / view.fx_px
    y = (torch.arange(view.height_px).to(planes) + 0.5 - view.cy_px) / view.fy_px
    along = planes[..., 0] * x + planes[..., 1] * y[:, None] + planes[..., 2]
    length = (1.0 + x * x + (y * y)[:, None]).sqrt()
    is_met = along < -LEAST_COSINE * length * alphas.detach().clamp(min=1e-6)
    depths = planes[..., 3] / torch.where(is_met, along, -torch.ones_like(along))
    return torch.where(is_met, depths, torch.zeros_like(depths)).clamp(min=near_m) * alphas


def accumulated_weights(blend: Blend, means: Tensor) -> Tensor:
    """Each splat's weight added up over the picture, shape (n,): a channel's sum's gradient to the splat's value."""
    with torch.enable_grad():
        values = torch.zeros_like(means[:, :1]).detach().requires_grad_()
        total = blend(values).sum()
        (weights,) = torch.autograd.grad(total, values)
    return weights[:, 0]


@torch.no_grad()
def heaviest_labels(blend: Blend, labels: Tensor) -> Tensor:
    """Label of the heaviest accumulated weight of each pixel, shape (h, w): each label's splats are a channel of 1s."""
    best, found = None, None
    for known in torch.unique(labels).split(LABELS_AT_ONCE):
        votes, which = blend((labels[:, None] == known).to(torch.float32)).max(dim=-1)
        these = torch.where(votes > 0.0, known[which].to(torch.int32), -1)
        if best is None or found is None:
            best, found = votes, these
        else:
            is_better = votes > best
            best, found = torch.where(is_better, votes, best), torch.where(is_better, these, found)
    if found is None:
        raise ValueError("labels: expected one for each of at least one splat")
    return found.to(torch.int32)
