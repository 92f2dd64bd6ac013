"""The file of SPZ's version 4: header and table of contents as they are, and a ZSTD frame for each stream."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from backports import zstd

from planning.base.progress import Monitor

MAGIC = b"NGSP"
VERSION = 4

HEADER = struct.Struct("<4sIIBBBBI12x")
"""Magic, version, count, degree, bits after the binary point, flags, streams, where the table begins; reserved."""

ENTRY = struct.Struct("<QQ")
"""Of the table: bytes of a stream in the file, and unpacked."""

LEVEL = 12
"""As the format's own library has it."""

AT_ONCE_BYTES = 1 << 22


def zstd_file(n: int, degree: int, fraction: int, flags: int, streams: Sequence[memoryview], monitor: Monitor) -> bytes:
    """A whole file.

    Parameters
    ----------
    n
        Gaussians.
    fraction
        Bits after the binary point.
    streams
        In the format's order, without empty ones.
    """
    total, done = sum(map(len, streams)), 0
    frames = []
    for stream in streams:
        compressor = zstd.ZstdCompressor(LEVEL)
        compressor.set_pledged_input_size(len(stream))
        pieces = []
        for start in range(0, len(stream), AT_ONCE_BYTES):
            monitor.report("compressing", done, total)
            piece = stream[start : start + AT_ONCE_BYTES]
            pieces.append(compressor.compress(piece))
            done += len(piece)
        frames.append(b"".join([*pieces, compressor.flush()]))
    header = HEADER.pack(MAGIC, VERSION, n, degree, fraction, flags, len(frames), HEADER.size)
    table = [ENTRY.pack(len(frame), len(stream)) for frame, stream in zip(frames, streams, strict=True)]
    return b"".join([header, *table, *frames])
