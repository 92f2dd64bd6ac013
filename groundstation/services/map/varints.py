"""Variable-width integers of Protocol Buffers, many at a time: seven bits a byte, the lowest first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MAX_BYTES = 10
"""Of one integer of 64 bits."""


def read_varints(data: bytes | memoryview) -> NDArray[np.uint64]:
    """All integers of a run of bytes, shape (n,).

    Raises
    ------
    ValueError
        The last one is cut off, or one has more than ten bytes.
    """
    octets = np.frombuffer(data, np.uint8)
    if not len(octets):
        return np.zeros(0, np.uint64)
    is_last = octets < 0x80
    ends = np.flatnonzero(is_last)
    if not is_last[-1]:
        raise ValueError("expected whole integers, found one that is cut off")
    starts = np.concatenate([[0], ends[:-1] + 1])
    lengths = ends - starts + 1
    if int(lengths.max()) > MAX_BYTES:
        raise ValueError(f"expected integers of at most {MAX_BYTES} bytes, found {int(lengths.max())}")
    shifts = (7 * (np.arange(len(octets)) - np.repeat(starts, lengths))).astype(np.uint64)
    return np.add.reduceat((octets & 0x7F).astype(np.uint64) << shifts, starts)


def zigzag(values: NDArray[np.uint64]) -> NDArray[np.int64]:
    """Signed integers from such that count 0, -1, 1, -2 ...; same shape."""
    half = (values >> np.uint64(1)).astype(np.int64)
    return half ^ -(values & np.uint64(1)).astype(np.int64)
