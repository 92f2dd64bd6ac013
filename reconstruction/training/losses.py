"""What the joint training makes small (paper Eqs. 23 to 27); terms that nothing counts for are 0, with gradients 0.

Normals are world axes (ENU). Sums over splats (`sum w n`) are as the rasteriser blends them: not divided by alpha, so
that a term also asks for surfaces that are closed.
"""

from __future__ import annotations

import math
from functools import partial as bound
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.jit import chunks, kernel, run_chunks
from reconstruction.light.losses import high_frequency_loss, no_brighter, ray_errors
from reconstruction.metrics.image_metrics import C1, C2, WINDOW_PX, window_weights
from reconstruction.splats.rasterising.views import View

# Structural similarity of two pictures and its gradient by rows: compiled, in double precision inside.
#
# The window is separable, so a row of means is made by adding up weighted rows and then shifted copies of the sum;
# inner
# loops run along the picture's rows, which compilers turn into vector instructions.

Array = NDArray[np.float64]

BAND_ROWS = 256
"""Rows that a thread does at once: 5 ms of work at 256 columns, against 0.1 ms to start threads."""


def dissimilarity(
    found: NDArray[Any], truth: NDArray[Any], channels: int, with_gradient: bool
) -> tuple[float, Array | None]:
    """1 less the mean structural similarity, and its gradient by `found` where it is wanted.

    Parameters
    ----------
    found, truth
        Shape (h, w * channels), h and w `WINDOW_PX` or more.
    """
    found, truth = np.ascontiguousarray(found, np.float64), np.ascontiguousarray(truth, np.float64)
    weights = window_weights()
    (height, width), n_rows = found.shape, len(found) - WINDOW_PX + 1
    sums = np.empty(n_rows)
    partial = np.empty((n_rows, 3, width) if with_gradient else (0, 3, 0))
    similar = bound(similarity_rows, found, truth, weights, channels, C1, C2)
    run_chunks(lambda start, stop: similar(start, stop, sums, partial), chunks(n_rows, BAND_ROWS))
    n_windows = n_rows * (width - (WINDOW_PX - 1) * channels)
    value = 1.0 - math.fsum(sums) / n_windows
    if not with_gradient:
        return value, None
    gradient = np.empty_like(found)
    spread = bound(gradient_rows, found, truth, weights, partial, -1.0 / n_windows)
    run_chunks(lambda start, stop: spread(start, stop, gradient), chunks(height, BAND_ROWS))
    return value, gradient


@kernel
def similarity_rows(
    found: Array,
    truth: Array,
    weights: Array,
    channels: int,
    c1: float,
    c2: float,
    start: int,
    stop: int,
    sums: Array,
    partial: Array,
) -> None:
    """Similarity summed over each row of windows, and what its gradient is made of.

    With a = found, b = truth, and E the mean over a window, similarity is a function of E a, E aa and E ab. Its
    derivatives by these three are spread back along the row to the pixels they depend on; along the columns that is
    left to `gradient_rows`, because it takes rows of other bands.

    Parameters
    ----------
    found, truth
        Shape (h, w * channels).
    weights
        Of the window, shape (k,), adding up to 1.
    c1, c2
        Constants of the index.
    start, stop
        Rows of windows: the first one covers the picture's rows 0 to k - 1.
    sums
        Written, shape (h - k + 1,).
    partial
        Written, shape (h - k + 1, 3, w * channels); shape (0, 3, 0) where no gradient is wanted.
    """
    size = len(weights)
    width = found.shape[1]
    inner = width - (size - 1) * channels
    by_rows, means = np.empty((5, width)), np.empty((5, inner))
    # Zeros on both sides, so that windows beyond the picture add nothing.
    spread = np.zeros((3, inner + 2 * (size - 1) * channels))
    left = (size - 1) * channels
    for row in range(start, stop):
        by_rows[:] = 0.0
        a1, b1, aa1, bb1, ab1 = by_rows[0], by_rows[1], by_rows[2], by_rows[3], by_rows[4]
        for k in range(size):
            weight, a, b = weights[k], found[row + k], truth[row + k]
            for i in range(width):
                a1[i] += weight * a[i]
            for i in range(width):
                b1[i] += weight * b[i]
            for i in range(width):
                aa1[i] += weight * a[i] * a[i]
            for i in range(width):
                bb1[i] += weight * b[i] * b[i]
            for i in range(width):
                ab1[i] += weight * a[i] * b[i]
        means[:] = 0.0
        for q in range(5):
            mean = means[q]
            for k in range(size):
                weight, shifted = weights[k], by_rows[q, k * channels : k * channels + inner]
                for i in range(inner):
                    mean[i] += weight * shifted[i]
        ma, mb, maa, mbb, mab = means[0], means[1], means[2], means[3], means[4]
        by_a, by_aa, by_ab = spread[0, left:], spread[1, left:], spread[2, left:]
        total = 0.0
        for i in range(inner):
            a_, b_ = ma[i], mb[i]
            # Rounding leaves variances of flat windows below 0, and covariances above what variances allow.
            variances = max(maa[i] - a_ * a_, 0.0) + max(mbb[i] - b_ * b_, 0.0)
            twice = min(max(2.0 * (mab[i] - a_ * b_), -variances), variances)
            over, under = 2.0 * a_ * b_ + c1, a_ * a_ + b_ * b_ + c1
            top, bottom = twice + c2, variances + c2
            light, contrast = over / under, top / bottom
            value = light * contrast
            total += value
            aa_, ab_ = -value / bottom, 2.0 * light / bottom
            by_a[i] = 2.0 * (b_ * contrast - a_ * value) / under - ab_ * b_ - 2.0 * aa_ * a_
            by_aa[i], by_ab[i] = aa_, ab_
        sums[row] = total
        if partial.shape[0] == 0:
            continue
        for q in range(3):
            target = partial[row, q]
            target[:] = 0.0
            for k in range(size):
                weight, shifted = weights[k], spread[q, k * channels : k * channels + width]
                for i in range(width):
                    target[i] += weight * shifted[i]


@kernel
def gradient_rows(
    found: Array,
    truth: Array,
    weights: Array,
    partial: Array,
    factor: float,
    start: int,
    stop: int,
    gradient: Array,
) -> None:
    """Gradient of `factor` times the sum of all similarities by `found`, for some of the picture's rows.

    Parameters
    ----------
    partial
        Of `similarity_rows`.
    gradient
        Written, shape (h, w * channels).
    """
    size, n_rows, width = len(weights), partial.shape[0], found.shape[1]
    spread = np.empty((3, width))
    for row in range(start, stop):
        spread[:] = 0.0
        for k in range(size):
            if not 0 <= row - k < n_rows:
                continue
            weight = weights[k]
            for q in range(3):
                source, target = partial[row - k, q], spread[q]
                for i in range(width):
                    target[i] += weight * source[i]
        by_a, by_aa, by_ab = spread[0], spread[1], spread[2]
        a, b, out = found[row], truth[row], gradient[row]
        for i in range(width):
            out[i] = factor * (by_a[i] + 2.0 * a[i] * by_aa[i] + b[i] * by_ab[i])


# Structural dissimilarity as a loss: how unlike two pictures are in brightness, contrast and structure.
#
# Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image quality assessment: from error visibility to
# structural
# similarity", IEEE TIP 13 (2004), Eqs. 13 to 17: a Gaussian window of 11 x 11 pixels and sigma 1.5, K1 = 0.01, K2 =
# 0.03,
# for values whose range is 1; each colour channel by itself. Only windows that lie whole in the picture count, as in
# `reconstruction.metrics.image_metrics`, so that no padding is learned; the loss is 1 less their mean. That is the
# L_D-SSIM of the paper's Eq. 25 as splatting programs have it; some writers halve it.


def dssim(found: Tensor, truth: Tensor) -> Tensor:
    """1 less the mean structural similarity, 0 for equal pictures and 2 at most; a scalar.

    0, too, and without a gradient, for pictures that are smaller than the window: nothing is compared there.

    On a processor a compiled kernel does it, value and gradient together, in double precision inside; the same bits for
    any number of threads. Elsewhere it is made of torch's operations.

    Parameters
    ----------
    found, truth
        Shape (h, w, c), float32 or float64, 0 to 1, though values beyond do no harm. Gradients reach `found` only.
    """
    _check(found, truth)
    if min(found.shape[:2]) < WINDOW_PX:
        return (0.0 * found.nan_to_num(0.0, 0.0, 0.0)).sum()
    if found.device.type == "cpu":
        return _Dissimilarity.apply(found, truth)  # type: ignore[no-any-return,no-untyped-call]
    return dssim_torch(found, truth)


def dssim_torch(found: Tensor, truth: Tensor) -> Tensor:
    """`dssim` of torch's operations, for any device and pictures of a window at least; slow on a processor."""
    weights = torch.tensor(window_weights()).to(found)
    a, b = found.movedim(-1, 0), truth.movedim(-1, 0)
    stacked = torch.cat([a, b, a * a, b * b, a * b])[:, None]
    stacked = torch.nn.functional.conv2d(stacked, weights[None, None, :, None])
    mean_a, mean_b, aa, bb, ab = torch.nn.functional.conv2d(stacked, weights[None, None, None, :])[:, 0].chunk(5)
    variances = (aa - mean_a * mean_a).clamp(min=0.0) + (bb - mean_b * mean_b).clamp(min=0.0)
    twice = torch.minimum(torch.maximum(2.0 * (ab - mean_a * mean_b), -variances), variances)
    light = (2.0 * mean_a * mean_b + C1) / (mean_a * mean_a + mean_b * mean_b + C1)
    return 1.0 - (light * (twice + C2) / (variances + C2)).mean()


def _check(found: Tensor, truth: Tensor) -> None:
    if found.shape != truth.shape or found.ndim != 3:
        raise ValueError(f"expected two pictures of one shape (h, w, c), got {[*found.shape]} and {[*truth.shape]}")
    if found.dtype not in (torch.float32, torch.float64) or truth.dtype != found.dtype:
        raise ValueError(f"expected float32 or float64, both alike, got {found.dtype} and {truth.dtype}")
    if truth.requires_grad:
        raise ValueError("truth: gradients reach the first picture only; exchange them, or detach it")


class _Dissimilarity(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, found: Tensor, truth: Tensor) -> Tensor:
        a, b = (picture.detach().reshape(len(picture), -1).numpy() for picture in (found, truth))
        value, gradient = dissimilarity(a, b, found.shape[-1], ctx.needs_input_grad[0])
        if gradient is not None:
            ctx.save_for_backward(torch.from_numpy(gradient).to(found.dtype).reshape(found.shape))
        return found.new_tensor(value)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, upstream: Tensor) -> tuple[Tensor, None]:
        (gradient,) = ctx.saved_tensors
        return upstream * gradient, None


# How smooth normals are, where the photo is.

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
    found = no_brighter(found, truth)
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
