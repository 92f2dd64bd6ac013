"""Terrain of a site: heights of the ground over a grid of the local frame, and how they stand in `site.json`.

Three heights belong to each node: the ground as its source interpolates it, and an upper and a lower bound. Surfaces
through the bounds enclose every height that the source states, however coarse the grid is; what the source itself may
be wrong by, `accuracy_m`, is kept on top. Least heights are counted from the upper surface, greatest from the lower.

In the file a grid is text, so that a site stays one file whose checksum holds all that plans rely on: millimetres as
little-endian int32, rows from south to north, deflated, in base64; -2147483648 where nothing is known.
"""

from __future__ import annotations

import base64
import binascii
import math
import zlib
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from planning.base.messages import say
from planning.geo.height_field import HeightField
from planning.geo.mesh import MAX_COORDINATE_M

Array = NDArray[np.float64]

MAX_NODES = 4_000_000
"""Of a grid: 1 km x 1 km in steps of half a metre."""

NOT_KNOWN = -(2**31)
MM_PER_M = 1000.0


@dataclass(frozen=True, slots=True)
class TerrainSource:
    """A file that heights are from: its name, SHA-256, reference system, and what its heights are above."""

    file: str
    sha256: str
    crs: str
    vertical: str


@dataclass(frozen=True, slots=True)
class Terrain:
    """Heights of the ground on a grid, as in `site.json`.

    Parameters
    ----------
    west_south_m
        Node (0, 0), ENU x and y.
    step_m
        Between neighbouring nodes.
    columns, rows
        Numbers of nodes eastwards and northwards.
    ground, upper, lower
        Heights of the nodes, ENU z, in the form of `grid_text`.
    accuracy_m
        How far the ground may lie above or below what the sources say.
    use
        Whether flights are held to it; `auto`: where it departs from the level ground of the airspace.
    """

    west_south_m: tuple[float, float]
    step_m: float
    columns: int
    rows: int
    ground: str
    upper: str
    lower: str
    accuracy_m: float = 0.0
    use: EffectSetting = "auto"
    sources: tuple[TerrainSource, ...] = ()

    def __post_init__(self) -> None:
        for value in self.west_south_m:
            if not (math.isfinite(value) and abs(value) <= 2.0 * MAX_COORDINATE_M):
                raise ValueError(say("expected finite local metres, got {}", value, place="west_south_m"))
        if not (math.isfinite(self.step_m) and 0.0 < self.step_m <= MAX_COORDINATE_M):
            raise ValueError(say("expected more than 0 m, got {}", self.step_m, place="step_m"))
        if min(self.columns, self.rows) < 2 or self.columns * self.rows > MAX_NODES:
            raise ValueError(
                say(
                    "expected at least 2 x 2 and at most {} nodes, got {} x {}",
                    MAX_NODES,
                    self.columns,
                    self.rows,
                    place="columns",
                )
            )
        if not (math.isfinite(self.accuracy_m) and self.accuracy_m >= 0.0):
            raise ValueError(say("expected 0 m or more, got {}", self.accuracy_m, place="accuracy_m"))
        surfaces(self)


class Surfaces(NamedTuple):
    """Of a terrain: the ground, and the bounds of it, the accuracy of the sources included."""

    ground: HeightField
    upper: HeightField
    lower: HeightField


@lru_cache(maxsize=8)
def surfaces(terrain: Terrain) -> Surfaces:
    """The surfaces of a terrain, the same arrays for all who ask: not to be written to.

    Raises
    ------
    ValueError
        A grid is damaged, or the bounds do not lie on both sides of the ground.
    """
    shape = terrain.rows, terrain.columns
    grids = [grid_of(getattr(terrain, name), shape, name) for name in ("ground", "upper", "lower")]
    ground, upper, lower = grids
    unknown = np.isnan(ground)
    if not ((np.isnan(upper) == unknown).all() and (np.isnan(lower) == unknown).all()):
        raise ValueError(say("expected heights for the same nodes in all three grids", place="ground"))
    if not ((upper >= ground) & (lower <= ground) | unknown).all():
        raise ValueError(say("expected the ground between its bounds", place="ground"))
    upper, lower = upper + terrain.accuracy_m, lower - terrain.accuracy_m
    west, south = terrain.west_south_m
    return Surfaces(*(HeightField(west, south, terrain.step_m, grid) for grid in (ground, upper, lower)))


def terrain_of(ground: HeightField, upper: Array, lower: Array, **facts: Any) -> Terrain:
    """A terrain from heights of the nodes, shapes as `ground.z_m`; `facts` are fields of `Terrain`.

    In the file heights are millimetres: the bounds are rounded outwards.
    """
    rows, columns = ground.z_m.shape
    # A height that is a whole number of millimetres stays it: what floating point adds to it is no height.
    slack = 1e-6
    return Terrain(
        west_south_m=(ground.west_m, ground.south_m),
        step_m=ground.step_m,
        columns=columns,
        rows=rows,
        ground=grid_text(np.round(MM_PER_M * ground.z_m)),
        upper=grid_text(np.ceil(MM_PER_M * np.maximum(upper, ground.z_m) - slack)),
        lower=grid_text(np.floor(MM_PER_M * np.minimum(lower, ground.z_m) + slack)),
        **facts,
    )


def grid_text(heights_mm: Array) -> str:
    """Heights in millimetres, whole or NaN, as text."""
    whole = np.where(np.isnan(heights_mm), NOT_KNOWN, heights_mm).astype("<i4")
    return base64.b64encode(zlib.compress(whole.tobytes(), 9)).decode("ascii")


def grid_of(text: str, shape: tuple[int, int], name: str) -> Array:
    """Heights in metres from `grid_text`, NaN where nothing is known.

    Raises
    ------
    ValueError
        The text is no such grid, or has a height that no local ground has.
    """
    n_bytes = 4 * shape[0] * shape[1]
    try:
        unpacker = zlib.decompressobj()
        content = unpacker.decompress(base64.b64decode(text, validate=True), n_bytes + 1)
    except (binascii.Error, ValueError, zlib.error) as error:
        raise ValueError(
            say("the heights are damaged ({}); attach the terrain again", str(error), place=name)
        ) from error
    if len(content) != n_bytes or not unpacker.eof:
        raise ValueError(
            say(
                "the heights are damaged (expected {} nodes, found {}); attach the terrain again",
                n_bytes // 4,
                len(content) // 4,
                place=name,
            )
        )
    whole = np.frombuffer(content, "<i4").reshape(shape)
    heights = np.where(whole == NOT_KNOWN, np.nan, whole / MM_PER_M)
    if (np.abs(heights) > MAX_COORDINATE_M).any():
        raise ValueError(say("expected local heights within {:.0f} m", MAX_COORDINATE_M, place=name))
    return heights
