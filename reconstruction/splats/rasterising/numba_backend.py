"""The rasteriser for processors: compiled kernels on threads, behind torch's autograd. float32."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from planning.base.jit import chunks
from reconstruction.splats.rasterising.ellipsoid_projection import slope_limits
from reconstruction.splats.rasterising.numba_blend import blend_tiles
from reconstruction.splats.rasterising.numba_blocks import LOW_PASS2, bytes_a_splat, limits_of
from reconstruction.splats.rasterising.numba_ellipsoids import gradients_of_ellipsoids, project_ellipsoids
from reconstruction.splats.rasterising.numba_gradients import gradients_of_tiles
from reconstruction.splats.rasterising.numba_lanes import N_LANES
from reconstruction.splats.rasterising.numba_projection import N_GEOMETRY, Array, Floats, project_splats
from reconstruction.splats.rasterising.numba_splat_gradients import N_OTHERS, gradients_of_splats
from reconstruction.splats.rasterising.numba_tiles import Tiles, run_on_threads, sort_into_tiles
from reconstruction.splats.rasterising.raster_types import NO_DOT, SOLID, Raster, RasterSettings, steepest
from reconstruction.splats.rasterising.views import View

SPLATS_AT_ONCE, TILES_AT_ONCE = 4096, 8
"""Of one call of a kernel: a millisecond or so, so that threads end together."""


class _Rasterise(torch.autograd.Function):
    """Means, quats, scales, opacities, features and offsets to features, alphas, depths, labels, weights and radii."""

    @staticmethod
    def forward(ctx: Any, view: View, settings: RasterSettings, labels: Any, *inputs: Tensor) -> tuple[Tensor, ...]:
        ctx.set_materialize_grads(False)
        means, quats, scales, opacities, features, offsets = (np.ascontiguousarray(t.detach().numpy()) for t in inputs)
        n_channels, features = features.shape[1], _padded(features)
        n, limits, size = len(means), limits_of(settings), settings.tile_px
        if scales.shape[1] == SOLID:
            limits[LOW_PASS2] = NO_DOT
        geometry, depth, boxes, radii = _projected(view, settings, means, quats, scales, opacities, offsets)
        tiles = sort_into_tiles(boxes, depth, view.width_px, view.height_px, size)
        picture = np.empty((view.height_px, view.width_px, n_channels), np.float32)
        alphas, depths = np.empty(picture.shape[:2], np.float32), np.empty(picture.shape[:2], np.float32)
        wanted_labels = (
            np.zeros(0, np.int32) if labels is None else np.ascontiguousarray(labels.to(torch.int32).numpy())
        )
        heaviest = np.full(picture.shape[:2] if labels is not None else (0, 0), -1, np.int32)
        slot_weights = np.empty(len(tiles.splats), np.float32)
        reached = np.empty((len(tiles.splats), bytes_a_splat(size)), np.uint8)

        def blend(start: int, stop: int) -> None:
            blend_tiles(
                geometry, features, tiles.starts, tiles.splats, limits, size, tiles.n_columns,
                wanted_labels, start, stop, picture, alphas, depths, heaviest, slot_weights, reached,
            )  # fmt: skip

        run_on_threads(blend, chunks(len(tiles.starts) - 1, TILES_AT_ONCE), settings.threads)
        weights = np.bincount(tiles.splats, slot_weights, n).astype(np.float32)
        ctx.kept = (view, settings, tiles, geometry, reached, limits)
        ctx.save_for_backward(*inputs)
        out = [torch.from_numpy(a) for a in (picture, alphas, depths, heaviest, weights, radii)]
        ctx.mark_non_differentiable(*out[3:])
        return tuple(out)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *wanted: Any) -> Any:
        view, settings, tiles, geometry, reached, limits = ctx.kept
        arrays = [np.ascontiguousarray(t.detach().numpy()) for t in ctx.saved_tensors]
        features = _padded(arrays[4])
        shape = (view.height_px, view.width_px)
        of_features = _gradient(wanted[0], (*shape, arrays[4].shape[1]))
        of_alphas, of_depths = (_gradient(w, shape) for w in wanted[1:3])
        slots = np.empty((len(tiles.splats), N_OTHERS + features.shape[1]), np.float32)

        def of_tiles(start: int, stop: int) -> None:
            gradients_of_tiles(
                geometry, features, tiles.starts, tiles.splats, limits, settings.tile_px,
                tiles.n_columns, reached, of_features, of_alphas, of_depths, start, stop, slots,
            )  # fmt: skip

        run_on_threads(of_tiles, chunks(len(tiles.starts) - 1, TILES_AT_ONCE), settings.threads)
        found = [np.zeros(a.shape, np.float32) for a in arrays[:5]] + [np.zeros((len(arrays[0]), 2), np.float32)]
        _take_back(view, settings, arrays, geometry, tiles, slots, found)
        if len(arrays[5]) == 0:
            found[5] = np.zeros((0, 2), np.float32)
        return (None, None, None, *(torch.from_numpy(a) for a in found))


def _projected(
    view: View,
    settings: RasterSettings,
    means: Floats,
    quats: Floats,
    scales: Floats,
    opacities: Floats,
    offsets: Floats,
) -> tuple[Floats, Array, NDArray[np.int32], Floats]:
    """Geometry, depths, boxes and radii of discs or ellipsoids."""
    n, (camera, lens), size = len(means), _camera_of(view), (view.width_px, view.height_px)
    found = np.empty((n, N_GEOMETRY), np.float32), np.empty(n), np.empty((n, 4), np.int32), np.empty(n, np.float32)
    shared = means, quats, scales, opacities, offsets, camera, lens, size
    focal_px = min(view.fx_px, view.fy_px)
    least_change = settings.least_depth_change(focal_px)
    both = settings.near_m, settings.min_alpha
    blur = _blur_of_discs(settings), steepest(focal_px)
    of_discs = np.array([*both, settings.low_pass_px, settings.reach, least_change, *blur])
    of_ellipsoids = np.array([*both, settings.blur_px, settings.antialiased])
    slopes = np.array(slope_limits(view))

    def project(start: int, stop: int) -> None:
        if scales.shape[1] == SOLID:
            project_ellipsoids(*shared, of_ellipsoids, slopes, start, stop, *found)
        else:
            project_splats(*shared, of_discs, start, stop, *found)

    run_on_threads(project, chunks(n, SPLATS_AT_ONCE), settings.threads)
    return found


def _take_back(
    view: View,
    settings: RasterSettings,
    inputs: list[Floats],
    geometry: Floats,
    tiles: Tiles,
    slots: Floats,
    found: list[Floats],
) -> None:
    """From the slots to gradients of the inputs, which begin as 0."""
    means, quats, scales, opacities = inputs[:4]
    (camera, lens), slopes = _camera_of(view), np.array(slope_limits(view))
    shapes, least = (means, quats, scales, opacities, camera, lens), settings.min_alpha
    blur_px, limit = _blur_of_discs(settings), steepest(min(view.fx_px, view.fy_px))

    def of_splats(start: int, stop: int) -> None:
        places = tiles.slots, tiles.places, slots, start, stop
        if scales.shape[1] == SOLID:
            gradients_of_ellipsoids(*shapes, least, settings.blur_px, settings.antialiased, slopes, *places, *found)
        else:
            gradients_of_splats(*shapes, geometry, least, blur_px, limit, *places, *found)

    run_on_threads(of_splats, chunks(len(scales), SPLATS_AT_ONCE), settings.threads)


def _blur_of_discs(settings: RasterSettings) -> float:
    """Standard deviation, px; 0 where discs have a low-pass filter and stay as opaque as they are."""
    return settings.blur_px if settings.antialiased else 0.0


def _camera_of(view: View) -> tuple[Array, Array]:
    """Model's frame to camera axes, shape (4, 4), and fx, fy, cx, cy."""
    lens = np.array([view.fx_px, view.fy_px, view.cx_px, view.cy_px])
    return np.ascontiguousarray(view.cam_from_world.numpy()), lens


def _gradient(wanted: Tensor | None, shape: tuple[int, ...]) -> NDArray[np.float32]:
    if wanted is None:
        return np.zeros(shape, np.float32)
    return np.ascontiguousarray(wanted.detach().numpy())


def _padded(features: NDArray[np.float32]) -> NDArray[np.float32]:
    """With as many columns of 0 as make their number a multiple of eight, which are taken at once."""
    n, n_channels = features.shape
    missing = -n_channels % N_LANES
    if not missing:
        return features
    wide = np.zeros((n, n_channels + missing), np.float32)
    wide[:, :n_channels] = features
    return wide


def rasterise_numba(
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
    """See `rasteriser.rasterise`; all float32 in main memory."""
    offsets = means.new_zeros((0, 2)) if screen_offsets is None else screen_offsets
    apply: Callable[..., tuple[Tensor, ...]] = _Rasterise.apply
    picture, alphas, depths, heaviest, weights, radii = apply(
        view, settings, labels, means, quats_wxyz, scales, opacities, features, offsets
    )
    return Raster(picture, alphas, depths, heaviest if labels is not None else None, weights, radii)
