"""Map tiles from a server that the user names, off until the user agrees: polite, bounded, and kept on disk.

Nothing is asked for before `OnlineMap.is_on`. One connection is used, no faster than `MIN_STEP_S` apart, with a
name in User-Agent, as the servers of OpenStreetMap ask for (operations.osmfoundation.org/policies/tiles). Answers are
bounded in size and time, redirections are not followed, and what is no picture is not kept.
"""

from __future__ import annotations

import contextlib
import hashlib
import http.client
import os
import re
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from groundstation import __version__
from groundstation.services.map.tile_source import (
    GZIP,
    MAX_TILE_BYTES,
    VECTOR_FORMAT,
    TileNotReached,
    TileSetInfo,
    gunzipped,
    picture_format,
    plain_text,
)
from groundstation.services.map.web_mercator import MAX_ZOOM, Tile
from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, make_folder, read_input_file
from planning.base.json_file import write_atomically
from planning.base.messages import say

EXAMPLE_URL = "https://tile.example.org/{z}/{x}/{y}.png"

OSM_URL = "https://tile.openstreetmap.org/{z}/{x}/{y}.png"
OSM_ATTRIBUTION = "© OpenStreetMap contributors, ODbL"
OSM_POLICY = "https://operations.osmfoundation.org/policies/tiles/"
"""The usual choice: standard tiles of OpenStreetMap, levels 0 to 19; this module keeps to their policy."""

USER_AGENT = f"Reflight/{__version__} (ground station; map view)"

MIN_STEP_S = 0.1
"""Between two requests: ten tiles a second fill a window in 3 s, and are what a person who pans makes a browser ask."""

MAX_WAIT_S = 10.0
"""For a connection, and for each piece of an answer."""

MAX_ANSWER_S = 20.0
"""For all of an answer."""

DEFAULT_AGE_S, LEAST_AGE_S, MOST_AGE_S = 7 * 86_400.0, 3_600.0, 30 * 86_400.0
"""How long a tile counts as new: where the server does not say, and bounds of what it says. OpenStreetMap's policy asks
for seven days."""

KEPT_TILE = FileLimit(say("a map tile"), MAX_TILE_BYTES)

FILL = 0.8
"""Of the room for tiles, what is left full when the oldest are thrown away."""

_BRACES = re.compile(r"\{[^{}]*\}")


@dataclass(frozen=True, slots=True)
class OnlineMap:
    """An online source as the user set it up.

    Parameters
    ----------
    url
        Address of a tile with {z}, {x} and {y}, or {-y} where rows are counted from the south.
    attribution
        Whose data it is, and under which licence; shown on the map.
    max_zoom
        Deepest level that the server has.
    cache_mb
        Room on the disk for tiles, MB.
    is_on
        Whether tiles may be asked for.
    """

    url: str = ""
    attribution: str = ""
    max_zoom: int = 19
    cache_mb: int = 200
    is_on: bool = False

    def check(self) -> None:
        """Refuse an address that cannot be used, or a source without its licence.

        Raises
        ------
        InputError
            As said.
        """
        parts = urlsplit(self.url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise InputError.say(
                "expected an address such as https://tile.example.org/{}, found '{}'", "{z}/{x}/{y}.png", self.url[:200]
            )
        if parts.username is not None or any(ord(c) <= 32 or ord(c) > 126 for c in self.url):
            raise InputError.say("the address holds a password, a space or a letter that addresses do not have")
        fields = _BRACES.findall(self.url)
        rows = fields.count("{y}") + fields.count("{-y}")
        if fields.count("{z}") != 1 or fields.count("{x}") != 1 or rows != 1 or len(fields) != 3 or "{" in parts.netloc:
            raise InputError.say(
                "expected {} once each behind the server's name, found '{}'", "{z}, {x}, {y}", self.url[:200]
            )
        if not plain_text(self.attribution):
            raise InputError.say(
                "the licence is missing; enter the words that the map's owner asks for, such as © OpenStreetMap "
                "contributors"
            )
        if not 0 <= self.max_zoom <= MAX_ZOOM:
            raise InputError.say("expected a deepest level from 0 to {}, found {}", MAX_ZOOM, self.max_zoom)

    @property
    def server(self) -> str:
        """Name of the server."""
        return urlsplit(self.url).hostname or ""

    def address(self, tile: Tile) -> str:
        """Address of a tile."""
        found = {"z": tile.zoom, "x": tile.column, "y": tile.row, "-y": 2**tile.zoom - 1 - tile.row}
        return _BRACES.sub(lambda match: str(found[match.group()[1:-1]]), self.url)


class TileCache:
    """Tiles on disk, the oldest thrown away where there is no room. A file's time is when its tile becomes old."""

    def __init__(self, folder: Path, most_bytes: int, clock: Callable[[], float] = time.time) -> None:
        self.folder, self._most_bytes, self._clock = folder, most_bytes, clock
        self._n_bytes: int | None = None

    def get(self, tile: Tile) -> tuple[bytes, bool] | None:
        """Content of a tile and whether it is still new; None where it is not kept. Empty for a tile that is none."""
        path = self._path(tile)
        try:
            content = read_input_file(path, KEPT_TILE)
            return content, path.stat().st_mtime > self._clock()
        except (InputError, OSError):
            return None

    def put(self, tile: Tile, content: bytes, age_s: float) -> None:
        """Keep a tile for so long; where the disk is full it is not kept."""
        path = self._path(tile)
        with contextlib.suppress(InputError, OSError):
            make_folder(path.parent)
            before = path.stat().st_size if path.exists() else 0
            write_atomically(path, content)
            until = self._clock() + age_s
            os.utime(path, (until, until))
            self._n_bytes = self.n_bytes() + len(content) - before
            if self._n_bytes > self._most_bytes:
                self._shrink()

    def n_bytes(self) -> int:
        """What the tiles take on the disk."""
        if self._n_bytes is None:
            self._n_bytes = sum(size for _, size, _ in self._files())
        return self._n_bytes

    def _path(self, tile: Tile) -> Path:
        return self.folder / str(tile.zoom) / str(tile.column) / f"{tile.row}.tile"

    def _files(self) -> list[tuple[float, int, Path]]:
        found = []
        for path in self.folder.rglob("*.tile"):
            with contextlib.suppress(OSError):
                status = path.stat()
                found.append((status.st_mtime, status.st_size, path))
        return found

    def _shrink(self) -> None:
        """Throw the oldest away."""
        files = sorted(self._files())
        left = sum(size for _, size, _ in files)
        for _, size, path in files:
            if left <= FILL * self._most_bytes:
                break
            with contextlib.suppress(OSError):
                path.unlink()
                left -= size
        self._n_bytes = left


def cache_folder(parent: Path, url: str) -> Path:
    """Where tiles of an address are kept, apart from those of others."""
    return parent / hashlib.sha256(url.encode()).hexdigest()[:16]


class OnlineTiles:
    """Tiles of an online source. `image` may be called from any thread; `close` ends a request that is on its way."""

    def __init__(
        self,
        online: OnlineMap,
        caches: Path,
        clock: Callable[[], float] = time.time,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Open an online source; nothing is asked for yet.

        Parameters
        ----------
        caches
            Folder of the tiles of all sources.

        Raises
        ------
        InputError
            The source is not set up, or the user has not agreed.
        """
        online.check()
        if not online.is_on:
            raise InputError.say("the online map is off")
        self._online, self._clock, self._sleep = online, clock, sleep
        folder = cache_folder(caches, online.url)
        self._cache = TileCache(folder, online.cache_mb * MIB, clock)
        is_vector = urlsplit(online.url).path.lower().endswith((".pbf", ".mvt"))
        self.info = TileSetInfo(
            folder,
            online.server,
            VECTOR_FORMAT if is_vector else "png",
            0,
            online.max_zoom,
            None,
            plain_text(online.attribution),
        )
        self._lock = threading.Lock()
        self._connection: http.client.HTTPConnection | None = None
        self._socket: socket.socket | None = None
        self._asked_s = -MIN_STEP_S
        self._is_closed = False
        self.n_requests = 0

    def image(self, tile: Tile) -> bytes | None:
        """Content of a tile, from the disk while it is new there; None where there is none.

        Raises
        ------
        TileNotReached
            The server cannot be reached, refuses, or sends something else than a tile, and none is kept.
        """
        if not 0 <= tile.zoom <= self._online.max_zoom or self._is_closed:
            return None
        kept = self._cache.get(tile)
        if kept is not None and kept[1]:
            return kept[0] or None
        with self._lock:
            try:
                content, age_s = self._asked(tile)
            except TileNotReached:
                # An old tile is better than none: in the field there is often no network.
                if kept is not None:
                    return kept[0] or None
                raise
        self._cache.put(tile, content, age_s)
        return content or None

    def close(self) -> None:
        """Ask for nothing more."""
        self._is_closed = True
        self._hang_up()

    def _asked(self, tile: Tile) -> tuple[bytes, float]:
        """Content of a tile, empty where the server has none, and for how long it is new."""
        # Bounds hold where the computer's clock is set meanwhile, too.
        wait_s = min(self._asked_s + MIN_STEP_S - self._clock(), MIN_STEP_S)
        if wait_s > 0.0:
            self._sleep(wait_s)
        self._asked_s = self._clock()
        try:
            status, head, body = self._fetched(self._online.address(tile))
        except TileNotReached:
            raise
        except TimeoutError as error:
            raise TileNotReached.say("the map server {} does not answer", self._online.server) from error
        except (OSError, http.client.HTTPException, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise TileNotReached.say("the map server {} cannot be reached ({})", self._online.server, reason) from error
        if status in (204, 404, 410):
            return b"", LEAST_AGE_S
        if status != 200:
            raise self._refused(status)
        return self._checked(body, head), _age_s(head.get("Cache-Control", ""))

    def _refused(self, status: int) -> TileNotReached:
        if status in (301, 302, 303, 307, 308):
            return TileNotReached.say(
                "the map server {} sends elsewhere; enter the address that it sends to", self._online.server
            )
        if status in (401, 403):
            return TileNotReached.say(
                "the map server {} does not let Reflight in (answer {}); look at its terms of use",
                self._online.server,
                status,
            )
        return TileNotReached.say("the map server {} is busy or broken (answer {})", self._online.server, status)

    def _checked(self, body: bytes, head: http.client.HTTPMessage) -> bytes:
        """A body that is a tile."""
        if self.info.is_vector:
            unpacked = body
            if body.startswith(GZIP):
                unpacked = gunzipped(body, 4 * MAX_TILE_BYTES) or b""
            if not body or unpacked[:1] == b"\x1a":
                return body
        elif picture_format(body) is not None:
            return body
        raise TileNotReached.say(
            "the map server {} sent something else than a map tile ({}); look at the address",
            self._online.server,
            plain_text(head.get("Content-Type", ""))[:40] or say("no type"),
        )

    def _fetched(self, address: str) -> tuple[int, http.client.HTTPMessage, bytes]:
        """Status, head and body of an answer; a connection that the server has closed meanwhile is made once more."""
        is_reused = self._connection is not None
        try:
            return self._exchange(address)
        except (http.client.RemoteDisconnected, ConnectionResetError, BrokenPipeError):
            self._hang_up()
            if not is_reused or self._is_closed:
                raise
            return self._exchange(address)
        except BaseException:
            self._hang_up()
            raise

    def _exchange(self, address: str) -> tuple[int, http.client.HTTPMessage, bytes]:
        parts = urlsplit(address)
        connection = self._connection
        if connection is None:
            kind = http.client.HTTPSConnection if parts.scheme == "https" else http.client.HTTPConnection
            connection = self._connection = kind(parts.hostname or "", parts.port, timeout=MAX_WAIT_S)
        # Whoever sends a byte every few seconds would never be late for any piece.
        is_late = threading.Event()

        def give_up() -> None:
            is_late.set()
            self._shut()

        guard = threading.Timer(MAX_ANSWER_S, give_up)
        guard.daemon = True
        guard.start()
        try:
            self.n_requests += 1
            target = parts.path + (f"?{parts.query}" if parts.query else "")
            connection.request("GET", target, headers={"User-Agent": USER_AGENT, "Accept-Encoding": "gzip"})
            # The connection forgets its socket where the server says that it will close it.
            self._socket = connection.sock
            with connection.getresponse() as answer:
                if answer.status != 200:
                    self._hang_up()
                    return answer.status, answer.headers, b""
                body = answer.read(MAX_TILE_BYTES + 1)
                if len(body) > MAX_TILE_BYTES:
                    raise TileNotReached.say(
                        "the map server {} sent more than {} MiB for a tile", self._online.server, MAX_TILE_BYTES // MIB
                    )
                if answer.length:
                    raise http.client.IncompleteRead(body, answer.length)
                head = answer.headers
            if is_late.is_set():
                raise TimeoutError
            if head.get("Content-Encoding", "").lower() == "gzip" and not self.info.is_vector:
                body = gunzipped(body, MAX_TILE_BYTES) or b""
            return 200, head, body
        finally:
            guard.cancel()

    def _hang_up(self) -> None:
        connection, self._connection = self._connection, None
        self._shut()
        self._socket = None
        if connection is not None:
            connection.close()

    def _shut(self) -> None:
        """Wake whoever waits for an answer."""
        found = self._socket
        if found is not None:
            with contextlib.suppress(OSError):
                found.shutdown(socket.SHUT_RDWR)


def _age_s(cache_control: str) -> float:
    """For how long a tile is new, from what the server says, within bounds."""
    found = re.search(r"max-age\s*=\s*(\d{1,10})", cache_control.lower())
    age_s = float(found.group(1)) if found else DEFAULT_AGE_S
    return min(max(age_s, LEAST_AGE_S), MOST_AGE_S)
