"""Map files made for tests: every tile is a plain colour that says which tile it is."""

from __future__ import annotations

import contextlib
import math
import sqlite3
from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from groundstation.services.map.web_mercator import Tile, world_from_geodetic


def colour_of(tile: Tile) -> tuple[int, int, int]:
    """Red, green and blue of a tile."""
    return 60 + 8 * tile.zoom, 40 + tile.column % 7 * 30, 40 + tile.row % 7 * 30


def picture(tile: Tile, ending: str = ".png", size: int = 256) -> bytes:
    """A tile's picture: its colour, with a lighter frame."""
    pixels = np.full((size, size, 3), colour_of(tile)[::-1], np.uint8)
    cv2.rectangle(pixels, (0, 0), (size - 1, size - 1), (230, 230, 230), 1)
    return bytes(cv2.imencode(ending, pixels)[1])


def tile_at(x: float, y: float, zoom: int) -> Tile:
    """The tile of a level that holds a point of the world; points beyond its edge go to the tile at the edge."""
    n = 2**zoom
    return Tile(zoom, *(min(max(math.floor(value * n), 0), n - 1) for value in (x, y)))


def tiles_around(lat_deg: float, lon_deg: float, levels: Iterable[int], reach: int = 2) -> list[Tile]:
    """Tiles around a place."""
    found = []
    for zoom in levels:
        centre = tile_at(*world_from_geodetic(lat_deg, lon_deg)[0], zoom)
        n = 2**zoom
        columns = {(centre.column + i) % n for i in range(-reach, reach + 1)}
        rows = {min(max(centre.row + i, 0), n - 1) for i in range(-reach, reach + 1)}
        found += [Tile(zoom, column, row) for column in sorted(columns) for row in sorted(rows)]
    return found


def write_map(
    path: Path,
    tiles: Iterable[Tile] | dict[Tile, bytes],
    metadata: dict[str, str] | None = None,
    ending: str = ".png",
    index: bool = True,
) -> Path:
    """An MBTiles file; rows are counted from the south, as the format wants."""
    contents = tiles if isinstance(tiles, dict) else {tile: picture(tile, ending) for tile in tiles}
    facts = {"name": "test", "format": ending[1:], "attribution": "© testers"} if metadata is None else metadata
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("CREATE TABLE metadata (name TEXT, value TEXT)")
        connection.execute(
            "CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB)"
        )
        if index:
            connection.execute("CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row)")
        connection.executemany("INSERT INTO metadata VALUES (?, ?)", facts.items())
        rows = [(t.zoom, t.column, 2**t.zoom - 1 - t.row, data) for t, data in contents.items()]
        connection.executemany("INSERT INTO tiles VALUES (?, ?, ?, ?)", rows)
    return path
