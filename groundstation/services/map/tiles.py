"""Offline map tiles: opens map files, and reads both kinds.

- PMTiles, version 3: all tiles in one file, found by their place on a Hilbert curve. A header of 127 bytes says where
  the root directory, the leaf directories, the metadata and the tiles lie. A directory is a list of entries (tile id,
  offset, length, run length), sorted by id; an entry with run length 0 leads to a leaf directory. Names are those of
  the specification (sections 3 and 4).
- MBTiles, version 1.3: an SQLite database with tables `metadata` and `tiles`.

Nothing in a file is trusted. Every place must lie in the file; directories, values and what is unpacked have a largest
size; queries are read-only and end after `MAX_QUERY_S`. A map that is not what it says is refused when it is opened,
with what to do.
"""

from __future__ import annotations

import math
import sqlite3
import struct
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray

from groundstation.services.map.tile_source import (
    GZIP,
    MAX_TILE_BYTES,
    MAX_VECTOR_BYTES,
    VECTOR_FORMAT,
    TileSetInfo,
    TileSource,
    area_of,
    gunzipped,
    picture_format,
    plain_text,
    unzstd,
)
from groundstation.services.map.varints import read_varints
from groundstation.services.map.web_mercator import MAX_ZOOM, Tile
from planning.base.errors import InputError
from planning.base.files import FileLimit, open_input_file, real_path
from planning.base.json_file import parse_json
from planning.base.messages import say

MAGIC = b"PMTiles"
HEADER = struct.Struct("<7sB11Q6B4iB2i")

PMTILES_FILE = FileLimit(say("a map in PMTiles format"), 2**42)
"""A map of the whole planet has some 130 GB."""

MAX_ROOT_BYTES = 16_384
"""Of header and root directory together (section 4)."""

MAX_DIRECTORY_BYTES = 4 * 2**20
"""Of a directory without compression: half a million entries; writers aim at 16 KiB with compression."""

MAX_LEAF_BYTES = 2**20

MAX_METADATA_BYTES = 2**20

MAX_DEPTH = 4
"""Directories on the way to a tile; writers make two."""

MAX_LEAVES = 64
"""Leaf directories that are kept, of up to some MB each."""


class Compression(IntEnum):
    """Section 3.3."""

    NONE = 1
    GZIP = 2
    ZSTD = 4


class TileType(IntEnum):
    """Section 3.2, as far as it can be drawn."""

    MVT = 1
    PNG = 2
    JPEG = 3
    WEBP = 4


FORMATS = {TileType.MVT: VECTOR_FORMAT, TileType.PNG: "png", TileType.JPEG: "jpg", TileType.WEBP: "webp"}

_UNPACK: dict[int, Callable[[bytes, int], bytes | None]] = {
    Compression.NONE: lambda data, most: data if len(data) <= most else None,
    Compression.GZIP: gunzipped,
    Compression.ZSTD: unzstd,
}


@dataclass(frozen=True, slots=True)
class _Section:
    """A part of the file."""

    offset: int
    length: int


@dataclass(frozen=True, slots=True, eq=False)
class Directory:
    """Entries, each shape (n,), sorted by tile id."""

    tile_ids: NDArray[np.uint64]
    run_lengths: NDArray[np.uint64]
    lengths: NDArray[np.uint64]
    offsets: NDArray[np.uint64]

    def entry(self, tile_id: int) -> tuple[int, int, int] | None:
        """Run length, length and offset of the entry that holds a tile; None where there is none."""
        place = int(np.searchsorted(self.tile_ids, np.uint64(tile_id), side="right")) - 1
        if place < 0:
            return None
        run_length = int(self.run_lengths[place])
        if run_length and tile_id - int(self.tile_ids[place]) >= run_length:
            return None
        return run_length, int(self.lengths[place]), int(self.offsets[place])


def tile_id(tile: Tile) -> int:
    """Number of a tile along the Hilbert curves of all levels, one level after the other (section 4.1)."""
    x, y = tile.column, tile.row
    number: int = (4**tile.zoom - 1) // 3
    side = 2**tile.zoom >> 1
    while side:
        is_right, is_low = bool(x & side), bool(y & side)
        number += side * side * ((3 * is_right) ^ is_low)
        if not is_low:
            if is_right:
                x, y = side - 1 - x, side - 1 - y
            x, y = y, x
        # Within the quarter, as after a turn that may have made a coordinate negative.
        x, y = x & (side - 1), y & (side - 1)
        side >>= 1
    return number


def read_directory(data: bytes) -> Directory:
    """Entries of a directory without compression (section 4.2).

    Raises
    ------
    ValueError
        It is damaged, empty, or not sorted.
    """
    values = read_varints(data)
    n = int(values[0]) if len(values) else 0
    if n < 1 or len(values) != 1 + 4 * n:
        raise ValueError(f"expected 4 numbers for each of {n} entries, found {max(0, len(values) - 1)}")
    steps, run_lengths, lengths, places = values[1:].reshape(4, n)
    tile_ids = np.cumsum(steps, dtype=np.uint64)
    if bool((tile_ids[1:] < tile_ids[:-1]).any()) or not bool(lengths.all()):
        raise ValueError("expected tile ids in order and lengths above 0")
    # 0 stands for "right behind the last one". Where that follows a given offset, lengths add up from there.
    follows = places == 0
    if follows[0]:
        raise ValueError("expected an offset of the first entry")
    behind = np.concatenate([[np.uint64(0)], np.cumsum(lengths, dtype=np.uint64)[:-1]])
    anchor = np.maximum.accumulate(np.where(follows, 0, np.arange(n)))
    offsets = places[anchor] - np.uint64(1) + behind - behind[anchor]
    return Directory(tile_ids, run_lengths, lengths, offsets)


class PmTiles:
    """One open PMTiles file. `image` may be called from any thread; `close` ends its use."""

    def __init__(self, path: Path) -> None:
        """Open a map file.

        Raises
        ------
        InputError
            The file is missing or damaged, no PMTiles file of version 3, or holds tiles that cannot be drawn.
        """
        self._path = path
        self._lock = threading.Lock()
        self._leaves: OrderedDict[int, Directory] = OrderedDict()
        self._stack = ExitStack()
        try:
            self._file = self._stack.enter_context(open_input_file(path, PMTILES_FILE))
            self.info = self._read_header()
        except BaseException:
            self._stack.close()
            raise

    def image(self, tile: Tile) -> bytes | None:
        """Content of a tile; None where the file has none, or none that can be read."""
        if not self.info.min_zoom <= tile.zoom <= self.info.max_zoom:
            return None
        with self._lock:
            try:
                packed = self._packed(tile_id(tile))
            except (ValueError, OSError):
                return None
        most = MAX_VECTOR_BYTES if self.info.is_vector else MAX_TILE_BYTES
        return None if packed is None else _UNPACK[self._tile_compression](packed, most)

    def close(self) -> None:
        """Close the file; asking for tiles afterwards finds none."""
        with self._lock:
            self._stack.close()

    def _read_header(self) -> TileSetInfo:
        head = self._file.read(HEADER.size)
        if not head.startswith(MAGIC):
            raise self._no_map(say("it does not begin as one"))
        if len(head) < HEADER.size:
            raise self._no_map(say("it is cut off"))
        _, version, *numbers = HEADER.unpack(head)
        if version != 3:
            raise InputError.say(
                "expected PMTiles of version 3, found version {}; convert the map with the program pmtiles",
                version,
                place=self._path,
            )
        self._size = self._file.seek(0, 2)
        root, metadata, leaves, tiles = (_Section(numbers[i], numbers[i + 1]) for i in (0, 2, 4, 6))
        internal, tile_compression, tile_type, min_zoom, max_zoom = numbers[12:17]
        west, south, east, north = (value * 1e-7 for value in numbers[17:21])
        self._leaf_section, self._tile_section = leaves, tiles
        self._internal, self._tile_compression = internal, tile_compression
        self._check(tile_type)
        if not min_zoom <= max_zoom <= MAX_ZOOM:
            raise InputError.say(
                "expected zoom levels from 0 to {}, found {} to {}", MAX_ZOOM, min_zoom, max_zoom, place=self._path
            )
        try:
            self._root = self._directory(root, MAX_ROOT_BYTES)
        except ValueError as error:
            raise self._no_map(error) from error
        facts = self._metadata(metadata)
        info = TileSetInfo(
            self._path,
            plain_text(facts.get("name", "")) or self._path.stem,
            FORMATS[TileType(tile_type)],
            min_zoom,
            max_zoom,
            area_of(west, south, east, north),
            plain_text(facts.get("attribution", "")),
        )
        self._check_first_tile(info)
        return info

    def _check(self, tile_type: int) -> None:
        for compression in (self._internal, self._tile_compression):
            if compression not in _UNPACK:
                raise InputError.say(
                    "the map is compressed with {}; expected gzip, Zstandard or none; convert it with the program "
                    "pmtiles",
                    "Brotli" if compression == 3 else repr(compression),
                    place=self._path,
                )
        if tile_type not in FORMATS:
            raise InputError.say(
                "expected tiles in PNG, JPEG, WebP or as vectors (MVT), found type {}; export the map again",
                tile_type,
                place=self._path,
            )

    def _check_first_tile(self, info: TileSetInfo) -> None:
        """Refuse a file whose pictures are not what it says; a file may lack them where it is cut off."""
        entry = int(self._root.run_lengths[0]), int(self._root.lengths[0]), int(self._root.offsets[0])
        try:
            packed = self._follow(int(self._root.tile_ids[0]), entry)
        except ValueError as error:
            raise self._no_map(error) from error
        most = MAX_VECTOR_BYTES if info.is_vector else MAX_TILE_BYTES
        data = None if packed is None else _UNPACK[self._tile_compression](packed, most)
        if data is None or (not info.is_vector and picture_format(data) is None):
            raise InputError.say(
                "expected tiles in PNG, JPEG, WebP or PBF, found something else (the file says {}); export the "
                "map again",
                info.image_format,
                place=self._path,
            )

    def _metadata(self, section: _Section) -> dict[str, str]:
        """Texts of the metadata; nothing where it is damaged, for a map can do without."""
        try:
            content: Any = parse_json(self._unpacked(section, MAX_METADATA_BYTES, MAX_METADATA_BYTES), self._path)
        except (ValueError, InputError):
            return {}
        items = content.items() if isinstance(content, dict) else ()
        return {name: value for name, value in items if isinstance(value, str)}

    def _packed(self, number: int) -> bytes | None:
        """Content of a tile as it lies in the file."""
        entry = self._root.entry(number)
        return None if entry is None else self._follow(number, entry)

    def _follow(self, number: int, entry: tuple[int, int, int]) -> bytes | None:
        for _ in range(MAX_DEPTH):
            run_length, length, offset = entry
            if run_length:
                return self._read(self._within(self._tile_section, offset, length), MAX_TILE_BYTES)
            found = self._leaf(offset, length).entry(number)
            if found is None:
                return None
            entry = found
        raise ValueError(f"expected at most {MAX_DEPTH} directories on the way to a tile")

    def _leaf(self, offset: int, length: int) -> Directory:
        known = self._leaves.get(offset)
        if known is None:
            known = self._directory(self._within(self._leaf_section, offset, length), MAX_LEAF_BYTES)
            self._leaves[offset] = known
            while len(self._leaves) > MAX_LEAVES:
                self._leaves.popitem(last=False)
        self._leaves.move_to_end(offset)
        return known

    def _directory(self, section: _Section, most_packed: int) -> Directory:
        return read_directory(self._unpacked(section, most_packed, MAX_DIRECTORY_BYTES))

    def _unpacked(self, section: _Section, most_packed: int, most: int) -> bytes:
        content = _UNPACK[self._internal](self._read(section, most_packed), most)
        if content is None:
            raise ValueError(f"expected a compressed part of at most {most} bytes")
        return content

    @staticmethod
    def _within(section: _Section, offset: int, length: int) -> _Section:
        if offset + length > section.length:
            raise ValueError(f"expected a place within {section.length} bytes, found {offset} and {length} more")
        return _Section(section.offset + offset, length)

    def _read(self, section: _Section, most: int) -> bytes:
        if section.length > most or section.offset + section.length > self._size:
            raise ValueError(f"expected at most {most} bytes within the file, found {section.length}")
        self._file.seek(section.offset)
        content = self._file.read(section.length)
        if len(content) < section.length:
            raise ValueError("expected a longer file")
        return content

    def _no_map(self, why: object) -> InputError:
        return InputError.say(
            "not a map in PMTiles format, or damaged ({}); choose another file, or export the map again",
            why,
            place=self._path,
        )


def is_pmtiles(path: Path) -> bool:
    """Whether a file is meant as PMTiles, by its name or by how it begins."""
    if path.suffix.lower() == ".pmtiles":
        return True
    try:
        with open_input_file(path, PMTILES_FILE) as file:
            return file.read(len(MAGIC)) == MAGIC
    except InputError:
        return False


MAX_QUERY_S = 2.0
"""Longest that one query may take; with the index that the format asks for it takes under a millisecond."""

MAX_METADATA = 200
"""Rows of metadata that are looked at; the format knows about 15."""

INSTRUCTIONS_PER_LOOK = 10_000
"""SQLite instructions between two looks at the clock, well under a millisecond."""


def open_map_file(path: Path) -> TileSource:
    """Open a map file, PMTiles where its name or its content says so, else MBTiles.

    Raises
    ------
    InputError
        As `MapTiles` and `PmTiles`.
    """
    return PmTiles(path) if is_pmtiles(path) else MapTiles(path)


class MapTiles:
    """One open map file. `image` may be called from any thread; `close` ends its use."""

    def __init__(self, path: Path, clock: Callable[[], float] = time.monotonic) -> None:
        """Open a map file.

        Raises
        ------
        InputError
            The file is missing or damaged, no MBTiles file, holds no tiles, or is too slow to use.
        """
        self._path, self._clock, self._deadline_s = path, clock, math.inf
        self._lock = threading.Lock()
        if not path.is_file():
            raise InputError(say("there is no such file; choose an MBTiles or PMTiles file", place=path))
        # Immutable: no lock and no journal beside the file, which may be on a stick that is write-protected.
        place = f"file:{quote(str(real_path(path)))}?mode=ro&immutable=1"
        self._connection = sqlite3.connect(place, uri=True, check_same_thread=False)
        try:
            self._connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_TILE_BYTES)
            self._connection.set_progress_handler(self._is_late, INSTRUCTIONS_PER_LOOK)
            self._rows("PRAGMA trusted_schema = OFF")
            self.info = self._read_info()
        except BaseException:
            self._connection.close()
            raise

    def image(self, tile: Tile) -> bytes | None:
        """Content of a tile; None where the file has none, or none that can be read."""
        row_from_south = 2**tile.zoom - 1 - tile.row
        try:
            return self._tile_data("zoom_level = ? AND tile_column = ? AND tile_row = ?", (*tile[:2], row_from_south))
        except InputError:
            return None

    def close(self) -> None:
        """Close the file; asking for tiles afterwards finds none."""
        with self._lock:
            self._connection.close()

    def _read_info(self) -> TileSetInfo:
        metadata = self._metadata()
        lowest, highest = (
            self._rows(f"SELECT zoom_level FROM tiles ORDER BY zoom_level {order} LIMIT 1") for order in ("ASC", "DESC")
        )
        if not lowest:
            raise InputError(say("the map has no tiles; export it again with the area of the site", place=self._path))
        levels = lowest[0][0], highest[0][0]
        if not all(isinstance(level, int) and 0 <= level <= MAX_ZOOM for level in levels):
            raise InputError(
                say(
                    "expected zoom levels from 0 to {}, found {} to {}",
                    MAX_ZOOM,
                    repr(levels[0]),
                    repr(levels[1]),
                    place=self._path,
                )
            )
        return TileSetInfo(
            self._path,
            plain_text(metadata.get("name", "")) or self._path.stem,
            self._image_format(metadata.get("format", "")),
            *levels,
            _bounds(metadata.get("bounds", "")),
            plain_text(metadata.get("attribution", "")),
        )

    def _metadata(self) -> dict[str, str]:
        rows = self._rows(f"SELECT name, value FROM metadata LIMIT {MAX_METADATA}")
        return {name: value for name, value in rows if isinstance(name, str) and isinstance(value, str)}

    def _image_format(self, stated: str) -> str:
        data = self._tile_data("1", ())
        if data is not None and (stated.lower() == VECTOR_FORMAT or data.startswith(GZIP)):
            return VECTOR_FORMAT
        found = picture_format(data)
        if found is None:
            raise InputError(
                say(
                    "expected tiles in PNG, JPEG, WebP or PBF, found something else (the file says {}); export the "
                    "map again",
                    repr(stated),
                    place=self._path,
                )
                if stated
                else say(
                    "expected tiles in PNG, JPEG, WebP or PBF, found something else; export the map again",
                    place=self._path,
                )
            )
        return found

    def _tile_data(self, where: str, arguments: tuple[int, ...]) -> bytes | None:
        rows = self._rows(f"SELECT tile_data FROM tiles WHERE {where} LIMIT 1", arguments)
        return rows[0][0] if rows and isinstance(rows[0][0], bytes) else None

    def _rows(self, query: str, arguments: tuple[int, ...] = ()) -> list[tuple[Any, ...]]:
        with self._lock:
            self._deadline_s = self._clock() + MAX_QUERY_S
            try:
                return self._connection.execute(query, arguments).fetchall()
            except sqlite3.OperationalError as error:
                if self._is_late():
                    raise InputError(
                        say(
                            "looking a tile up takes more than {:g} s; the index on tiles is missing or the file is "
                            "damaged; export the map again",
                            MAX_QUERY_S,
                            place=self._path,
                        )
                    ) from error
                raise InputError(self._no_map(error)) from error
            except (sqlite3.Error, UnicodeDecodeError, OverflowError) as error:
                raise InputError(self._no_map(error)) from error

    def _no_map(self, error: Exception) -> str:
        return say(
            "not a map in MBTiles format, or damaged ({}); choose another file, or export the map again",
            error,
            place=self._path,
        )

    def _is_late(self) -> bool:
        return self._clock() > self._deadline_s


def _bounds(text: str) -> tuple[float, float, float, float] | None:
    """Bounds from "west,south,east,north"; None unless they are an area on the globe."""
    try:
        west, south, east, north = (float(part) for part in text.split(","))
    except ValueError:
        return None
    return area_of(west, south, east, north)
