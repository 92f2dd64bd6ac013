"""Running sums and radix sort on a graphics card, of as many numbers as a buffer holds."""

from __future__ import annotations

from itertools import pairwise

from reconstruction.gpu.device import Commands, Device, Piece, rounded_up, uniform

LANES = 64
"""Of a workgroup of kernels whose threads work alone."""
CHUNK = 128
"""Numbers that a thread adds up."""
DIGIT_BITS = 8
"""At most: a thread keeps a count for each digit."""
KEYS_A_DIGIT = 4
"""Keys that a thread sorts, over the number of digits."""


def groups_of(n_threads: int) -> int:
    """Workgroups for so many threads."""
    return rounded_up(n_threads, LANES)


def run_sums(commands: Commands, device: Device, values: Piece, n: int) -> None:
    """Replace `n` numbers (u32) by the sums of all before each; the total is written behind the last."""
    levels = [(values, n)]
    while levels[-1][1] > CHUNK:
        upper = rounded_up(levels[-1][1], CHUNK)
        levels.append((device.buffer(4 * (upper + 1)), upper))
    for (lower, count), (upper_piece, upper) in pairwise(levels):
        commands.run("add_chunks", {"CHUNK": CHUNK}, groups_of(upper), uniform(count, 0), lower, upper_piece)
    for place in range(len(levels) - 1, -1, -1):
        piece, count = levels[place]
        is_top = place == len(levels) - 1
        before = levels[place + 1][0] if not is_top else device.buffer(4)
        threads = max(rounded_up(count, CHUNK), 1)
        commands.run("run_chunks", {"CHUNK": CHUNK}, groups_of(threads), uniform(count, int(is_top)), piece, before)


def sort(commands: Commands, device: Device, keys: Piece, numbers: Piece, n: int, bits: int) -> tuple[Piece, Piece]:
    """Keys (u32, below 2^bits) from the least to the most, equal ones in their order, and the numbers beside them.

    The pieces that come back are new ones or those that were given, whose content is lost.
    """
    n_passes = max(rounded_up(bits, DIGIT_BITS), 1)
    digit_bits = max(rounded_up(bits, n_passes), 1)
    digits = 1 << digit_bits
    keys_a_thread = max(KEYS_A_DIGIT * digits, 16)
    threads = max(rounded_up(n, keys_a_thread), 1)
    constants = {"DIGITS": digits, "KEYS_A_THREAD": keys_a_thread}
    counts = device.buffer(4 * (digits * threads + 1))
    there = device.buffer(4 * n), device.buffer(4 * n)
    for number in range(n_passes):
        parameters = uniform(n, threads, number * digit_bits)
        commands.run("count_digits", constants, groups_of(threads), parameters, keys, counts)
        run_sums(commands, device, counts, digits * threads)
        commands.run("move_keys", constants, groups_of(threads), parameters, keys, numbers, counts, *there)
        (keys, numbers), there = there, (keys, numbers)
    return keys, numbers
