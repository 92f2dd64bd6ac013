"""Memory that a training frees in each step, kept for the next one.

Left alone, the C library gives large pieces back to the system as soon as they are free, and gets them again, page by
page, in the next step: 5 to 10 % of the time of steps that ask a Reflection MLP (`python -m tests.benchmarks --only
modelling-parts`). Only GNU's library is told; others do as they always do.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

TRIM_THRESHOLD, TOP_PAD, MMAP_THRESHOLD = -1, -2, -3
"""Parameters of `mallopt` (malloc.h)."""

KEPT, AHEAD, PIECE = 1 << 30, 1 << 26, 1 << 30
"""Free bytes that are kept, bytes that are asked for beyond what is needed, and size of pieces that are no part of
either."""

USUAL_KEPT, USUAL_AHEAD, USUAL_PIECE = 1 << 26, 1 << 17, 1 << 25
"""What the library comes to by itself in a process with large pieces."""


@contextmanager
def freed_memory_kept() -> Iterator[None]:
    """Keep what is freed within a block, up to `KEPT`; at its end all that is free is given back."""
    library = _gnu_library()
    if library is None:
        yield
        return
    _tell(library, KEPT, AHEAD, PIECE)
    try:
        yield
    finally:
        _tell(library, USUAL_KEPT, USUAL_AHEAD, USUAL_PIECE)
        library.malloc_trim(0)


def _tell(library: Any, kept: int, ahead: int, piece: int) -> None:
    for parameter, value in ((TRIM_THRESHOLD, kept), (TOP_PAD, ahead), (MMAP_THRESHOLD, piece)):
        library.mallopt(parameter, value)


def _gnu_library() -> Any:
    """The C library of this process, where it is GNU's."""
    if sys.platform != "linux":
        return None
    library = ctypes.CDLL(None)
    return library if hasattr(library, "gnu_get_libc_version") else None
