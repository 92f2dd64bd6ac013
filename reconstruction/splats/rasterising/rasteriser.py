"""Splats to pictures: one function, whatever computes it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import torch
from torch import Tensor

from reconstruction.splats.rasterising.gsplat_backend import rasterise_gsplat
from reconstruction.splats.rasterising.numba_backend import rasterise_numba
from reconstruction.splats.rasterising.raster_types import FLAT, SOLID, Raster, RasterSettings
from reconstruction.splats.rasterising.torch_reference import rasterise_torch
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.rasterising.wgpu_backend import rasterise_wgpu

Backend = Literal["auto", "numba", "torch", "gsplat", "wgpu"]

USUAL = RasterSettings()


def rasterise(
    means: Tensor,
    quats_wxyz: Tensor,
    scales: Tensor,
    opacities: Tensor,
    features: Tensor,
    view: View,
    *,
    screen_offsets: Tensor | None = None,
    labels: Tensor | None = None,
    settings: RasterSettings = USUAL,
    backend: Backend = "auto",
) -> Raster:
    """Draw splats; differentiable in the first five arguments and `screen_offsets`.

    Parameters
    ----------
    means
        Middles in the model's frame, shape (n, 3).
    quats_wxyz
        Rotations, shape (n, 4), of any length: the first two columns are the tangents, the third is the normal.
    scales
        Standard deviations along the two tangents, shape (n, 2), metres, above 0; or along all columns, shape (n, 3),
        and the splats are ellipsoids: 3-D Gaussians.
    opacities
        Shape (n,), 0 to 1.
    features
        What is blended, shape (n, c), c of 1 or more.
    screen_offsets
        Moves splats in the picture, shape (n, 2), px. Zeros that require a gradient receive that of the screen
        position, which densification looks at.
    labels
        Shape (n,), int32; -1 where a splat belongs to nothing.
    backend
        `numba` for float32 in main memory, and `wgpu` for that by a graphics card; `gsplat` for float32 on CUDA;
        `torch` anywhere, for any precision, so slow and hungry that it suits hundreds of splats. `auto` takes the one
        that fits the tensors and `settings.on_gpu`.

    Raises
    ------
    InputError
        The tensors are on CUDA, and gsplat does not work here.
    ReconstructionError
        There is no graphics card, or it fails.
    """
    _check(means, quats_wxyz, scales, opacities, features, screen_offsets, labels)
    drawing = _DRAWING[_chosen(backend, means, settings)]
    return drawing(means, quats_wxyz, scales, opacities, features, view, screen_offsets, labels, settings)


_DRAWING: dict[str, Callable[..., Raster]] = {
    "numba": rasterise_numba,
    "torch": rasterise_torch,
    "gsplat": rasterise_gsplat,
    "wgpu": rasterise_wgpu,
}


def _chosen(backend: Backend, means: Tensor, settings: RasterSettings) -> str:
    """The backend that fits the tensors."""
    fits_numba = means.device.type == "cpu" and means.dtype == torch.float32
    fits_gsplat = means.device.type == "cuda" and means.dtype == torch.float32
    if backend == "auto":
        if fits_numba:
            return "wgpu" if settings.on_gpu else "numba"
        return "gsplat" if fits_gsplat else "torch"
    if backend in ("numba", "wgpu") and not fits_numba:
        raise ValueError(f"{backend}: expected float32 in main memory, got {means.dtype} on {means.device}")
    if backend == "gsplat" and not fits_gsplat:
        raise ValueError(f"gsplat: expected float32 on a CUDA device, got {means.dtype} on {means.device}")
    return backend


def _check(
    means: Tensor,
    quats_wxyz: Tensor,
    scales: Tensor,
    opacities: Tensor,
    features: Tensor,
    screen_offsets: Tensor | None,
    labels: Tensor | None,
) -> None:
    n = len(means)
    n_channels = max(features.shape[-1], 1) if features.dim() == 2 else 1
    shapes: dict[str, tuple[Tensor | None, list[tuple[int, ...]]]] = {
        "means": (means, [(n, 3)]),
        "quats_wxyz": (quats_wxyz, [(n, 4)]),
        "scales": (scales, [(n, FLAT), (n, SOLID)]),
        "opacities": (opacities, [(n,)]),
        "features": (features, [(n, n_channels)]),
        "screen_offsets": (screen_offsets, [(n, 2)]),
        "labels": (labels, [(n,)]),
    }
    for name, (values, expected) in shapes.items():
        if values is None:
            continue
        if tuple(values.shape) not in expected:
            raise ValueError(f"{name}: expected shape {' or '.join(map(str, expected))}, got {tuple(values.shape)}")
        if values.device != means.device or (name != "labels" and values.dtype != means.dtype):
            raise ValueError(
                f"{name}: expected {means.dtype} on {means.device} as the means are, got {values.dtype} on "
                f"{values.device}"
            )
