"""What every source of map tiles has: facts about itself and the content of a tile; and bounded decompression."""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from groundstation.services.map.web_mercator import MAX_ZOOM, Tile
from planning.base.errors import GroundStationError

MAX_TILE_BYTES = 4 * 2**20
"""A 512 x 512 PNG in true colour that does not compress has 1 MiB."""

MAX_VECTOR_BYTES = 16 * 2**20
"""Of a vector tile without compression; makers of tiles keep to 0.5 MiB, compressed."""

VECTOR_FORMAT = "pbf"
"""As MBTiles calls Mapbox Vector Tiles."""

RASTER_POINTS, VECTOR_POINTS = 256, 512
"""Width of a tile on screen, at the level that it is for. Vector tiles are made for 512."""

_HEADS = {
    "png": re.compile(rb"\x89PNG\r\n\x1a\n"),
    "jpg": re.compile(rb"\xff\xd8\xff"),
    "webp": re.compile(rb"RIFF.{4}WEBP", re.S),
}
"""How the pictures begin that can be drawn."""

GZIP = b"\x1f\x8b"


@dataclass(frozen=True, slots=True)
class TileSetInfo:
    """What a source of tiles says about itself.

    Parameters
    ----------
    path
        Of the file, or of the folder where tiles of an online source are kept.
    image_format
        `png`, `jpg`, `webp`, or `pbf` for vector tiles.
    bounds_deg
        West, south, east, north; None where the file does not say, or says nonsense.
    min_zoom, max_zoom
        Levels that there are tiles of.
    attribution
        Whose data it is, without markup; must be shown with the map.
    """

    path: Path
    name: str
    image_format: str
    min_zoom: int
    max_zoom: int
    bounds_deg: tuple[float, float, float, float] | None
    attribution: str

    @property
    def is_vector(self) -> bool:
        """Whether tiles are drawn from shapes, sharp at every level."""
        return self.image_format == VECTOR_FORMAT

    @property
    def tile_points(self) -> int:
        """Width of a tile on screen at its own level, points."""
        return VECTOR_POINTS if self.is_vector else RASTER_POINTS

    @property
    def levels(self) -> tuple[int, int]:
        """Levels that pictures are made of: vector tiles are drawn anew for every level below their last."""
        return self.min_zoom, MAX_ZOOM if self.is_vector else self.max_zoom


class TileNotReached(GroundStationError):  # noqa: N818  (the name says what happened)
    """A tile could not be had now, and may be later: the network is gone, or the server is busy."""


class TileSource(Protocol):
    """One open source of tiles. `image` may be called from any thread; `close` ends its use."""

    @property
    def info(self) -> TileSetInfo:
        """What it says about itself."""
        ...

    def image(self, tile: Tile) -> bytes | None:
        """Content of a tile; None where there is none, or none that can be read.

        Raises
        ------
        TileNotReached
            It may be there later.
        """
        ...

    def close(self) -> None:
        """Read nothing more."""
        ...


def picture_format(data: bytes | None) -> str | None:
    """Format of a tile's picture by how it begins; None for what cannot be drawn."""
    return next((name for name, head in _HEADS.items() if head.match(data or b"")), None)


def gunzipped(data: bytes, most: int) -> bytes | None:
    """Content of a gzip stream; None where it is damaged or holds more than `most` bytes."""
    stream = zlib.decompressobj(wbits=31)
    try:
        content = stream.decompress(data, most + 1)
    except zlib.error:
        return None
    return content if stream.eof and len(content) <= most else None


def unzstd(data: bytes, most: int) -> bytes | None:
    """Content of a Zstandard frame, as `gunzipped`."""
    from backports import zstd

    stream = zstd.ZstdDecompressor()
    try:
        content = stream.decompress(data, most + 1)
    except (zstd.ZstdError, MemoryError):
        return None
    return content if stream.eof and len(content) <= most else None


def plain_text(text: str) -> str:
    """A text of a file without markup and control characters, no longer than a line."""
    text = re.sub(r"<[^<>]*>", "", text).replace("&copy;", "©").replace("&amp;", "&")
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())[:200]


def area_of(west: float, south: float, east: float, north: float) -> tuple[float, float, float, float] | None:
    """Bounds; None unless they are an area on the globe."""
    is_area = -180.0 <= west < east <= 180.0 and -90.0 <= south < north <= 90.0
    return (west, south, east, north) if is_area else None
