"""Running sums and radix sort on a graphics card, against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from reconstruction.gpu.device import Device
from reconstruction.gpu.sorting import CHUNK, run_sums, sort


@pytest.mark.parametrize("n", [0, 1, CHUNK, CHUNK + 1, CHUNK * CHUNK + 5])
def test_running_sums_are_those_of_numpy(card: Device, n: int) -> None:
    values = np.random.default_rng(n).integers(0, 1000, n + 1, np.uint32)
    piece = card.buffer(4 * (n + 1))
    card.write(piece, values)
    commands = card.commands()
    run_sums(commands, card, piece, n)
    found = commands.read((piece, 4 * (n + 1)))[0].view(np.uint32)
    expected = np.concatenate([[0], np.cumsum(values[:n])])
    assert np.array_equal(found, expected)


@pytest.mark.parametrize(("n", "bits"), [(1, 28), (1000, 1), (5000, 8), (20_001, 28), (3000, 32)])
def test_sorted_keys_are_those_of_numpy_and_equal_ones_keep_their_order(card: Device, n: int, bits: int) -> None:
    rng = np.random.default_rng(bits)
    # Few different ones, so that many are equal.
    keys = rng.choice(rng.integers(0, 1 << bits, 1 + n // 3, np.uint64).astype(np.uint32), n)
    pieces = card.buffer(4 * n), card.buffer(4 * n)
    card.write(pieces[0], keys)
    card.write(pieces[1], np.arange(n, dtype=np.uint32))
    commands = card.commands()
    found = sort(commands, card, *pieces, n, bits)
    moved_keys, numbers = (part.view(np.uint32) for part in commands.read((found[0], 4 * n), (found[1], 4 * n)))
    order = np.argsort(keys, kind="stable")
    assert np.array_equal(numbers, order)
    assert np.array_equal(moved_keys, keys[order])


@pytest.mark.slow
def test_more_keys_than_float32_can_count_are_sorted(card: Device) -> None:
    n = (1 << 24) + 77
    keys = np.random.default_rng(0).integers(0, 1 << 16, n, np.uint32)
    pieces = card.buffer(4 * n), card.buffer(4 * n)
    card.write(pieces[0], keys)
    card.write(pieces[1], np.arange(n, dtype=np.uint32))
    commands = card.commands()
    _, numbers = sort(commands, card, *pieces, n, 16)
    found = commands.read((numbers, 4 * n))[0].view(np.uint32)
    assert np.array_equal(found, np.argsort(keys, kind="stable"))
