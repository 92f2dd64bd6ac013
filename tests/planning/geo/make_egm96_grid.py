"""Make `planning/geo/data/egm96_15_mm.xz`: `python -m tests.planning.geo.make_egm96_grid [EGM96_15.GTX]`.

Source: the 15-minute grid of geoid heights of the Earth Gravitational Model 1996 (WW15MGH.GRD of NIMA, now NGA, and
NASA Goddard), a work of the United States government and in the public domain. Debian's package `proj-data` carries it
as /usr/share/proj/egm96_15.gtx: a header of 40 bytes (south, west, steps in degrees as big-endian doubles, rows and
columns as big-endian integers), then rows from the south, columns from 180 degrees west, metres as big-endian float32.

The file made here holds millimetres as little-endian int16, differenced twice along the rows and twice across them,
which leaves small numbers, and compressed with xz: 0.85 MB instead of 4.15 MB, exact to half a millimetre.
"""

from __future__ import annotations

import lzma
import struct
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.json_file import write_atomically
from planning.geo.geoid import GRID_PATH, N_COLUMNS, N_ROWS

DEFAULT_SOURCE = Path("/usr/share/proj/egm96_15.gtx")

XZ_FILTERS = [{"id": lzma.FILTER_LZMA2, "preset": 9 | lzma.PRESET_EXTREME, "lc": 0, "lp": 1, "pb": 1}]
"""xz settings for 2-byte numbers."""


def read_gtx_m(path: Path) -> NDArray[np.float64]:
    """Geoid heights of a global 15-minute .gtx file, metres, shape (721, 1440).

    Raises
    ------
    ValueError
        The header is not that of a global 15-minute grid.
    """
    content = path.read_bytes()
    header = struct.unpack(">ddddii", content[:40])
    expected = (-90.0, -180.0, 0.25, 0.25, N_ROWS, N_COLUMNS)
    if header != expected:
        raise ValueError(f"{path}: expected a grid with the header {expected}, got {header}")
    return np.frombuffer(content, ">f4", offset=40).reshape(N_ROWS, N_COLUMNS).astype(np.float64)


def packed(grid_m: NDArray[np.float64]) -> bytes:
    """Content of the grid file for geoid heights of shape (721, 1440), metres."""
    differences = np.rint(grid_m * 1000.0).astype(np.int64)
    for axis in (1, 1, 0, 0):
        differences = np.diff(differences, axis=axis, prepend=0)
    small = differences.astype("<i2")
    if not (small == differences).all():
        raise ValueError("a difference does not fit 16 bits; this is not the EGM96 grid")
    return lzma.compress(small.tobytes(), filters=XZ_FILTERS)


if __name__ == "__main__":
    write_atomically(GRID_PATH, packed(read_gtx_m(Path(sys.argv[1]) if len(sys.argv) > 1 else DEFAULT_SOURCE)))
