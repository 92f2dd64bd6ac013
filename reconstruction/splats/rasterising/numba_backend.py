"""The rasteriser for processors: compiled kernels on threads, behind torch's autograd. float32."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from threading import Thread
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.autograd.function import once_differentiable

from planning.base.jit import chunks, kernel, n_threads
from reconstruction.splats.rasterising.numba_blend import LOW_PASS2, blend_tiles, bytes_a_splat, limits_of
from reconstruction.splats.rasterising.numba_gradients import (
    N_OTHERS,
    gradients_of_ellipsoids,
    gradients_of_splats,
    gradients_of_tiles,
)
from reconstruction.splats.rasterising.numba_lanes import N_LANES
from reconstruction.splats.rasterising.numba_projection import (
    N_GEOMETRY,
    Array,
    Floats,
    project_ellipsoids,
    project_splats,
)
from reconstruction.splats.rasterising.projection import slope_limits
from reconstruction.splats.rasterising.raster_types import NO_DOT, SOLID, Raster, RasterSettings, steepest
from reconstruction.splats.rasterising.views import View

# Which splats touch which square of the picture, nearest first; and running work over squares on threads.


@dataclass(frozen=True, slots=True, eq=False)
class Tiles:
    """Squares of a picture, row by row, and their splats.

    Parameters
    ----------
    starts
        Where each square's splats begin in `splats`, shape (n_tiles + 1,).
    splats
        Their numbers, nearest middle first, equally near ones in their own order.
    slots
        Shape (n_splats + 1,), where each splat's squares begin in `places`.
    places
        For each splat, its places in `splats`, ascending.
    """

    size_px: int
    n_columns: int
    starts: NDArray[np.int64]
    splats: NDArray[np.int32]
    slots: NDArray[np.int64]
    places: NDArray[np.int32]


@kernel
def _count_tiles(
    boxes: NDArray[np.int32], size: int, n_columns: int, starts: NDArray[np.int64], slots: NDArray[np.int64]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Fill in the ends of squares and splats; ranges of squares, shape (n, 4), and which are drawn come back."""
    squares, drawn, n_drawn = np.empty((len(boxes), 4), np.int32), np.empty(len(boxes), np.int32), 0
    side = np.uint32(size)
    for i in range(len(boxes)):
        slots[i + 1] = slots[i]
        if boxes[i, 1] <= boxes[i, 0]:
            continue
        drawn[n_drawn] = i
        n_drawn += 1
        for k in range(4):
            # Of the ends of ranges, which are every other one, the last pixel counts. No place is negative.
            is_end = k % 2
            squares[i, k] = np.uint32(boxes[i, k] - is_end) // side
            squares[i, k] += is_end
        slots[i + 1] += (squares[i, 1] - squares[i, 0]) * (squares[i, 3] - squares[i, 2])
        for row in range(squares[i, 2], squares[i, 3]):
            for column in range(squares[i, 0], squares[i, 1]):
                starts[row * n_columns + column + 1] += 1
    for tile in range(len(starts) - 1):
        starts[tile + 1] += starts[tile]
    return squares, drawn[:n_drawn]


@kernel
def _fill_tiles(
    squares: NDArray[np.int32],
    order: NDArray[np.int32],
    n_columns: int,
    starts: NDArray[np.int64],
    slots: NDArray[np.int64],
    splats: NDArray[np.int32],
    places: NDArray[np.int32],
) -> None:
    ends = starts.copy()
    for i in order:
        slot = slots[i]
        for row in range(squares[i, 2], squares[i, 3]):
            for column in range(squares[i, 0], squares[i, 1]):
                place = ends[row * n_columns + column]
                ends[row * n_columns + column] += 1
                splats[place] = i
                places[slot] = place
                slot += 1


DIGIT_BITS = 11
N_DIGITS = -(-64 // DIGIT_BITS)


@kernel
def _nearest_first(depths: NDArray[np.float64], which: NDArray[np.int32]) -> NDArray[np.int32]:
    """Sort some splats by depth, all of them positive, equal ones in their order: radix sort of the numbers' bits.

    Digits that all depths share, of which near ones have many, are passed over.
    """
    n, mask = len(which), np.uint64((1 << DIGIT_BITS) - 1)
    keys, moved_keys, order, moved = np.empty(n, np.uint64), np.empty(n, np.uint64), which.copy(), which.copy()
    bits = depths.view(np.uint64)
    counts = np.zeros((N_DIGITS, 1 << DIGIT_BITS), np.int32)
    for j in range(n):
        key = bits[which[j]]
        keys[j] = key
        for digit in range(N_DIGITS):
            counts[digit, (key >> np.uint64(digit * DIGIT_BITS)) & mask] += 1
    for digit in range(N_DIGITS):
        shift = np.uint64(digit * DIGIT_BITS)
        if n == 0 or counts[digit, (keys[0] >> shift) & mask] == n:
            continue
        total = 0
        for value in range(1 << DIGIT_BITS):
            here = counts[digit, value]
            counts[digit, value] = total
            total += here
        for j in range(n):
            value = (keys[j] >> shift) & mask
            place = counts[digit, value]
            counts[digit, value] += 1
            moved_keys[place], moved[place] = keys[j], order[j]
        keys, moved_keys, order, moved = moved_keys, keys, moved, order
    return order


def sort_into_tiles(
    boxes: NDArray[np.int32], depths: NDArray[np.float64], width_px: int, height_px: int, size_px: int
) -> Tiles:
    """Squares of `size_px` of a picture with the splats whose boxes, shape (n, 4), touch them.

    Depths are positive wherever there is a box.
    """
    n_columns, n_rows = -(-width_px // size_px), -(-height_px // size_px)
    starts, slots = np.zeros(n_columns * n_rows + 1, np.int64), np.zeros(len(boxes) + 1, np.int64)
    squares, drawn = _count_tiles(boxes, size_px, n_columns, starts, slots)
    order = _nearest_first(depths, drawn)
    splats, places = np.empty(starts[-1], np.int32), np.empty(starts[-1], np.int32)
    _fill_tiles(squares, order, n_columns, starts, slots, splats, places)
    return Tiles(size_px, n_columns, starts, splats, slots, places)


def run_on_threads(work: Callable[..., None], ranges: Iterable[tuple[int, int]], threads: int) -> None:
    """Call `work(start, stop)` for all ranges on `threads` threads; 0 stands for all cores.

    What is raised first comes through once all have ended. Pools of threads take three times as long to begin and end;
    with this thread as one of them it took longer where others are at work, too: a thread begins beside its maker.
    """
    todo = deque(ranges)
    n_workers = min(threads or n_threads(), len(todo))
    raised: list[BaseException] = []

    def next_range() -> tuple[int, int] | None:
        try:
            return todo.popleft()
        except IndexError:
            return None

    def work_off() -> None:
        try:
            while (ends := next_range()) is not None:
                work(*ends)
        except BaseException as error:
            raised.append(error)
            todo.clear()

    if n_workers <= 1:
        work_off()
    else:
        workers = [Thread(target=work_off) for _ in range(n_workers)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
    if raised:
        raise raised[0]


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
