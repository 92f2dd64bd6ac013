"""Which splats touch which square of the picture, nearest first; and running work over squares on threads."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from threading import Thread

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel, n_threads


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
