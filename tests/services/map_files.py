"""Map files made for tests: every tile is a plain colour that says which tile it is."""

from __future__ import annotations

import contextlib
import gzip
import json
import math
import sqlite3
from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from groundstation.services.map.tiles import HEADER, tile_id
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


def varint(number: int) -> bytes:
    """A whole number as Protocol Buffers write it."""
    octets = bytearray()
    while number >= 0x80:
        octets.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*octets, number])


def field(number: int, value: int | bytes) -> bytes:
    """A field of a Protocol Buffer: a whole number, or bytes with their length."""
    if isinstance(value, int):
        return varint(number << 3) + varint(value)
    return varint(number << 3 | 2) + varint(len(value)) + value


def geometry(parts: list[list[tuple[int, int]]], is_closed: bool = False) -> bytes:
    """Commands of a vector tile for lines, or rings without their last point."""
    numbers: list[int] = []
    x = y = 0
    for part in parts:
        for place, (to_x, to_y) in enumerate(part):
            if place < 2:
                numbers.append(9 if place == 0 else len(part) - 1 << 3 | 2)
            numbers += [(step << 1) ^ (step >> 63) for step in (to_x - x, to_y - y)]
            x, y = to_x, to_y
        if is_closed:
            numbers.append(15)
    return b"".join(varint(number) for number in numbers)


def vector_layer(
    name: str, features: list[tuple[int, bytes, dict[str, str]]], extent: int = 4096, version: int = 2
) -> bytes:
    """A layer of a vector tile: kind, geometry and properties of each feature."""
    keys = list(dict.fromkeys(key for _, _, facts in features for key in facts))
    values = list(dict.fromkeys(value for _, _, facts in features for value in facts.values()))
    content = field(15, version) + field(1, name.encode())
    for kind, commands, facts in features:
        tags = b"".join(varint(keys.index(key)) + varint(values.index(value)) for key, value in facts.items())
        content += field(2, (field(2, tags) if tags else b"") + field(3, kind) + field(4, commands))
    content += b"".join(field(3, key.encode()) for key in keys)
    content += b"".join(field(4, field(1, value.encode())) for value in values)
    return field(3, content + field(5, extent))


def square(low: int, high: int) -> bytes:
    """A square area."""
    return geometry([[(low, low), (high, low), (high, high), (low, high)]], is_closed=True)


def directory(entries: list[tuple[int, int, int, int]]) -> bytes:
    """A PMTiles directory of entries (tile id, run length, length, offset), as section 4.2 has it."""
    numbers, last = [len(entries)], 0
    for entry in entries:
        numbers.append(entry[0] - last)
        last = entry[0]
    for column in (1, 2):
        numbers += [entry[column] for entry in entries]
    behind = None
    for _, _, length, offset in entries:
        numbers.append(0 if offset == behind else offset + 1)
        behind = offset + length
    return b"".join(varint(number) for number in numbers)


def write_pmtiles(
    path: Path,
    tiles: dict[Tile, bytes],
    tile_type: int = 2,
    leaf_size: int = 0,
    metadata: dict[str, str] | None = None,
    compression: int = 2,
    tile_compression: int = 1,
    bounds_deg: tuple[float, float, float, float] = (-180.0, -85.0, 180.0, 85.0),
) -> Path:
    """A PMTiles file; with `leaf_size`, directories of that many entries below the root."""
    pack = gzip.compress if compression == 2 else bytes
    data, entries = b"", []
    for number, content in sorted((tile_id(tile), content) for tile, content in tiles.items()):
        entries.append((number, 1, len(content), len(data)))
        data += content
    leaves = b""
    if leaf_size:
        root = []
        for first in range(0, len(entries), leaf_size):
            leaf = pack(directory(entries[first : first + leaf_size]))
            root.append((entries[first][0], 0, len(leaf), len(leaves)))
            leaves += leaf
        entries = root
    packed = pack(directory(entries))
    facts = {"name": "test", "attribution": "© testers"} if metadata is None else metadata
    described = pack(json.dumps(facts).encode())
    sections, at = [], HEADER.size
    for part in (packed, described, leaves, data):
        sections += [at, len(part)]
        at += len(part)
    zooms = [tile.zoom for tile in tiles]
    corners = [round(value * 1e7) for value in bounds_deg]
    head = HEADER.pack(
        b"PMTiles", 3, *sections, 0, 0, 0, 1, compression, tile_compression, tile_type, min(zooms), max(zooms),
        *corners, 0, 0, 0,
    )  # fmt: skip
    path.write_bytes(head + packed + described + leaves + data)
    return path
