"""LPIPS: how unlike two pictures look, by the features of a network that was trained to recognise things.

R. Zhang, P. Isola, A. A. Efros, E. Shechtman and O. Wang, "The unreasonable effectiveness of deep features as a
perceptual metric", CVPR 2018, version 0.1: features of five layers, scaled to unit length at each place, their squared
differences weighted by learned heads, averaged over places and added up over layers. 0 is best.

The weights are the user's (`lpips_weights`). Scores of different backbones cannot be compared.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.functional import avg_pool2d, conv2d, max_pool2d, relu

from planning.base.jit import chunks
from reconstruction.metrics.lpips_weights import BACKBONES, LpipsWeights

SHIFT, SCALE = (-0.030, -0.088, -0.188), (0.458, 0.448, 0.450)
"""Mean and deviation of ImageNet's colours, for values -1 to 1 (version 0.1)."""

EPSILON = 1e-10
"""Added to the length that features are divided by."""

LEAST_PX = 64
"""Of a picture's sides: the coarsest layer has 3 places then."""

TILE_PX, MARGIN_PX = 512, 112
"""Pictures are looked at in tiles, with so much around them as the features of their places depend on (98 pixels, up to
a multiple of 16), so that tiles change nothing; VGG takes 0.7 GB for one."""


Mask = NDArray[np.bool_]


def lpips(weights: LpipsWeights, found: NDArray[Any], truth: NDArray[Any], mask: Mask | None = None) -> float | None:
    """How unlike two pictures look, 0 for equal ones; of all of them, or of what a mask shows.

    Returns
    -------
    None where the mask is empty, or a side shorter than `LEAST_PX`.
    """
    return lpips_of_masks(weights, found, truth, (mask,))[0]


@torch.no_grad()
def lpips_of_masks(
    weights: LpipsWeights, found: NDArray[Any], truth: NDArray[Any], masks: Sequence[Mask | None]
) -> tuple[float | None, ...]:
    """`lpips` of several masks, None for all of the pictures, for the work of one.

    With a mask, each layer's mean is weighted by the share of each place's pixels that are in the mask; features look
    beyond it. Without, it is the metric as published.

    Parameters
    ----------
    found, truth
        Shape (h, w, 3); floating point as 0 to 1, clipped to it, or uint8 as 0 to 255.
    masks
        Shape (h, w) each.
    """
    if found.shape != truth.shape or found.ndim != 3 or found.shape[2] != 3:
        raise ValueError(f"expected two pictures of one shape (h, w, 3), got {found.shape} and {truth.shape}")
    shapes = {mask.shape for mask in masks if mask is not None}
    if shapes - {found.shape[:2]}:
        raise ValueError(f"masks: expected shape {found.shape[:2]}, got {sorted(shapes)}")
    height, width = found.shape[:2]
    if min(height, width) < LEAST_PX:
        return (None,) * len(masks)
    sums = np.zeros((len(masks), len(weights.heads), 2))
    for rows, own_rows in _tiles(height):
        for columns, own_columns in _tiles(width):
            part = torch.cat([_scaled(picture[rows, columns]) for picture in (found, truth)])
            for layer, (features, stride) in enumerate(_layers(weights, part)):
                unlike = _difference(features, weights.heads[layer])
                own = _places(own_rows, stride), _places(own_columns, stride)
                for number, mask in enumerate(masks):
                    shares = _shares(None if mask is None else mask[rows, columns], stride, unlike.shape)
                    sums[number, layer] += float((shares * unlike)[own].sum()), float(shares[own].sum())
    return tuple(float((of[:, 0] / of[:, 1]).sum()) if of[:, 1].all() else None for of in sums)


def _tiles(length: int) -> Iterator[tuple[slice, slice]]:
    """Spans of pixels with what is around them, and which of these are the tile's own, to the end for the last tile."""
    for start, stop in chunks(length, TILE_PX):
        before = min(start, MARGIN_PX)
        own_stop = None if stop == length else before + stop - start
        yield slice(start - before, stop + MARGIN_PX), slice(before, own_stop)


def _places(pixels: slice, stride: int) -> slice:
    """Places of a layer whose blocks of pixels begin inside."""
    return slice(pixels.start // stride, None if pixels.stop is None else pixels.stop // stride)


def _scaled(picture: NDArray[Any]) -> Tensor:
    """As the networks were trained, shape (1, 3, h, w)."""
    if picture.dtype == np.uint8:
        values = torch.from_numpy(np.ascontiguousarray(picture)).float() / 255.0
    else:
        values = torch.from_numpy(np.nan_to_num(picture.astype(np.float32), nan=0.0)).clamp(0.0, 1.0)
    values = (2.0 * values - 1.0 - torch.tensor(SHIFT)) / torch.tensor(SCALE)
    return values.permute(2, 0, 1)[None].contiguous()


def _layers(weights: LpipsWeights, pictures: Tensor) -> Iterator[tuple[Tensor, int]]:
    """Features of the five layers, shape (n, c, h / stride, w / stride), and their strides."""
    values, stride = pictures, 1
    for each in BACKBONES[weights.backbone]:
        if each.pooled:
            values, stride = max_pool2d(values, each.pooled, 2), 2 * stride
        values = relu(conv2d(values, *weights.filters[each.index], each.stride, each.padding))
        stride *= each.stride
        if each.is_layer:
            yield values, stride


def _difference(features: Tensor, head: Tensor) -> Tensor:
    """Of two pictures' features, shape (2, c, h, w), at each place, shape (h, w)."""
    unit = features / (features.square().sum(dim=1, keepdim=True).sqrt() + EPSILON)
    return (head[:, None, None] * (unit[0] - unit[1]).square()).sum(dim=0)


def _shares(mask: Mask | None, stride: int, shape: torch.Size) -> Tensor:
    """Share of each place's block of pixels that is in a mask, of a layer's shape."""
    if mask is None:
        return torch.ones(shape)
    return avg_pool2d(torch.from_numpy(mask.astype(np.float32))[None], stride, ceil_mode=True)[
        0, : shape[0], : shape[1]
    ]
