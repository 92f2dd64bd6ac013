"""Which splats touch which square of the picture, nearest first; and running work over squares on threads."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel, n_threads

F = TypeVar("F", bound=Callable[..., Any])


def lanes_kernel(function: F) -> F:
    """Compile a loop over many pixels at once.

    Unlike `planning.jit.kernel` it may add up in any order and join products with sums: without, sums over pixels are
    not vectorised. The order is fixed when compiling, so that results stay the same for any number of threads; NaN
    and infinity behave as IEEE 754 says.
    """
    fast = {"reassoc", "contract", "nsz"}
    return cast("F", numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=fast)(function))


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
    places: NDArray[np.int64]


@kernel
def _count_tiles(
    boxes: NDArray[np.int32], size: int, n_columns: int, starts: NDArray[np.int64], slots: NDArray[np.int64]
) -> None:
    for i in range(len(boxes)):
        n = 0
        if boxes[i, 1] > boxes[i, 0]:
            for row in range(boxes[i, 2] // size, (boxes[i, 3] - 1) // size + 1):
                for column in range(boxes[i, 0] // size, (boxes[i, 1] - 1) // size + 1):
                    starts[row * n_columns + column + 1] += 1
                    n += 1
        slots[i + 1] = n
    for tile in range(len(starts) - 1):
        starts[tile + 1] += starts[tile]
    for i in range(len(boxes)):
        slots[i + 1] += slots[i]


@kernel
def _fill_tiles(
    boxes: NDArray[np.int32],
    order: NDArray[np.int64],
    size: int,
    n_columns: int,
    starts: NDArray[np.int64],
    slots: NDArray[np.int64],
    splats: NDArray[np.int32],
    places: NDArray[np.int64],
) -> None:
    ends = starts.copy()
    for i in order:
        slot = slots[i]
        for row in range(boxes[i, 2] // size, (boxes[i, 3] - 1) // size + 1):
            for column in range(boxes[i, 0] // size, (boxes[i, 1] - 1) // size + 1):
                place = ends[row * n_columns + column]
                ends[row * n_columns + column] += 1
                splats[place] = i
                places[slot] = place
                slot += 1


def sort_into_tiles(
    boxes: NDArray[np.int32], depths: NDArray[np.float64], width_px: int, height_px: int, size_px: int
) -> Tiles:
    """Squares of `size_px` of a picture with the splats whose boxes, shape (n, 4), touch them."""
    n_columns, n_rows = -(-width_px // size_px), -(-height_px // size_px)
    starts, slots = np.zeros(n_columns * n_rows + 1, np.int64), np.zeros(len(boxes) + 1, np.int64)
    _count_tiles(boxes, size_px, n_columns, starts, slots)
    drawn = np.flatnonzero(boxes[:, 1] > boxes[:, 0])
    order = drawn[_nearest_first(depths[drawn])]
    splats, places = np.empty(starts[-1], np.int32), np.empty(starts[-1], np.int64)
    _fill_tiles(boxes, order, size_px, n_columns, starts, slots, splats, places)
    return Tiles(size_px, n_columns, starts, splats, slots, places)


def _nearest_first(depths: NDArray[np.float64]) -> NDArray[np.int64]:
    """Stable order of depths: the unstable one, which is several times as fast, and equal ones put right afterwards."""
    order = np.argsort(depths)
    in_order = depths[order]
    is_equal = in_order[1:] == in_order[:-1]
    is_tied = np.zeros(len(order), np.bool_)
    is_tied[1:] |= is_equal
    is_tied[:-1] |= is_equal
    tied = order[is_tied]
    order[is_tied] = tied[np.lexsort((tied, in_order[is_tied]))]
    return order


def run_on_threads(work: Callable[..., None], ranges: Iterable[tuple[int, int]], threads: int) -> None:
    """Call `work(start, stop)` for all ranges on `threads` threads; 0 stands for all cores."""
    todo = list(ranges)
    threads = min(threads or n_threads(), len(todo))
    if threads <= 1:
        for start, stop in todo:
            work(start, stop)
        return
    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(lambda ends: work(*ends), todo):
            pass
