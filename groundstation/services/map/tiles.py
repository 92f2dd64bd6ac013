"""Offline map tiles: opens map files, and reads MBTiles (1.3: an SQLite database with tables `metadata` and `tiles`).

Nothing in a file is trusted: queries are read-only and end after `MAX_QUERY_S`, values have a largest size, and a map
that is not what it says is refused when it is opened, with what to do.
"""

from __future__ import annotations

import math
import sqlite3
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import quote

from groundstation.services.map.pmtiles import PmTiles, is_pmtiles
from groundstation.services.map.tile_source import (
    GZIP,
    MAX_TILE_BYTES,
    VECTOR_FORMAT,
    TileSetInfo,
    TileSource,
    area_of,
    picture_format,
    plain_text,
)
from groundstation.services.map.web_mercator import MAX_ZOOM, Tile
from planning.base.errors import InputError
from planning.base.files import real_path
from planning.base.messages import say

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
