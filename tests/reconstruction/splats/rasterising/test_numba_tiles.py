"""Splats sorted into the squares of a picture, against counting them one by one."""

from __future__ import annotations

import numpy as np
import pytest

from reconstruction.splats.rasterising.numba_backend import run_on_threads, sort_into_tiles


@pytest.mark.parametrize("n_depths", [3, 40, 10**6])
def test_every_square_has_its_splats_nearest_first_and_equal_ones_in_order(n_depths: int) -> None:
    rng = np.random.default_rng(n_depths)
    n, width, height, size = 300, 70, 45, 16
    left, top = rng.integers(0, width, n), rng.integers(0, height, n)
    right, bottom = np.minimum(left + rng.integers(0, 30, n), width), np.minimum(top + rng.integers(1, 30, n), height)
    boxes = np.column_stack([left, right, top, bottom]).astype(np.int32)
    boxes[right <= left] = 0
    depths = rng.integers(0, n_depths, n) / 7.0
    tiles = sort_into_tiles(boxes, depths, width, height, size)
    assert len(tiles.starts) == 5 * 3 + 1
    assert tiles.n_columns == 5
    nearest_first = np.argsort(depths, kind="stable")
    for tile in range(15):
        x, y = tile % 5 * size, tile // 5 * size
        is_in = (boxes[:, 1] > x) & (boxes[:, 0] < x + size) & (boxes[:, 3] > y) & (boxes[:, 2] < y + size)
        expected = [i for i in nearest_first if is_in[i]]
        assert tiles.splats[tiles.starts[tile] : tiles.starts[tile + 1]].tolist() == expected
    for i in range(n):
        places = tiles.places[tiles.slots[i] : tiles.slots[i + 1]]
        assert (tiles.splats[places] == i).all()
        assert (np.diff(places) > 0).all()
    assert len(np.unique(tiles.places)) == len(tiles.splats)


@pytest.mark.parametrize("threads", [0, 1, 3])
def test_all_ranges_are_worked_and_errors_come_through(threads: int) -> None:
    seen = np.zeros(10, int)

    def work(start: int, stop: int) -> None:
        seen[start:stop] += 1

    run_on_threads(work, [(0, 4), (4, 5), (5, 10)], threads)
    assert (seen == 1).all()

    def fail(start: int, stop: int) -> None:
        raise MemoryError(start)

    with pytest.raises(MemoryError):
        run_on_threads(fail, [(0, 1), (1, 2)], threads)
