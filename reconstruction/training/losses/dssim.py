"""Structural dissimilarity as a loss: how unlike two pictures are in brightness, contrast and structure.

Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image quality assessment: from error visibility to structural
similarity", IEEE TIP 13 (2004), Eqs. 13 to 17: a Gaussian window of 11 x 11 pixels and sigma 1.5, K1 = 0.01, K2 = 0.03,
for values whose range is 1; each colour channel by itself. Only windows that lie whole in the picture count, as in
`reconstruction.metrics.image_metrics`, so that no padding is learned; the loss is 1 less their mean. That is the
L_D-SSIM of the paper's Eq. 25 as splatting programs have it; some writers halve it.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from reconstruction.metrics.image_metrics import C1, C2, WINDOW_PX, window_weights
from reconstruction.training.losses.dssim_kernel import dissimilarity


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
