"""From the place that a finding names to the thing in the window that it means."""

from __future__ import annotations

import re
from collections.abc import Iterator

from groundstation.services.project.document import Document, Item, ItemKind, exists
from planning.site.zones.keep_out import near_zones

_NAMED = {
    "home": ItemKind.HOME,
    "take-off": ItemKind.HOME,
    "airspace": ItemKind.AIRSPACE,
    "building": ItemKind.BUILDING,
}

_KIND_NAMES = frozenset(kind.value for kind in ItemKind)

_BY_ID = (
    ItemKind.VIEWPOINT,
    ItemKind.PANEL,
    ItemKind.FACADE,
    ItemKind.OBSTACLE,
    ItemKind.NO_FLY,
    ItemKind.RALLY,
)
"""Kinds that a bare identifier may mean, in this order: findings name viewpoints and panels far more often."""


def item_of_place(place: str, document: Document) -> Item | None:
    """The thing that the place of a finding means in a document; None where it names nothing there.

    Places go from large to small ("sortie 2, leg 5", "sortie 1, v0012", "no-fly/road"). The smallest part that the
    document has is taken, so that a place inside a mission file still leads to its sortie. Viewpoints, sorties and legs
    are those of the current plan.
    """
    known = next((item for item in _meanings(place.strip()) if exists(document, item)), None)
    return _zone_of_place(place.strip(), document) if known is None else known


def _zone_of_place(place: str, document: Document) -> Item | None:
    """The geo-zone of this identifier, or the file of zones of this name."""
    if document.site is None:
        return None
    if any(source.file == place for source in document.site.site.zones):
        return Item(ItemKind.ZONE_FILE, place)
    return next(
        (Item(ItemKind.ZONE, near.key) for near in near_zones(document.site) if near.local.zone.id == place), None
    )


def _meanings(place: str) -> Iterator[Item]:
    """Everything that a place may mean, the most precise first."""
    leg = re.search(r"\bsortie (\d+), leg (\d+)\b", place)
    if leg is not None:
        yield Item(ItemKind.LEG, f"{leg[1]}/{leg[2]}")
    kind_name, slash, identifier = place.partition("/")
    if slash and kind_name in _KIND_NAMES:
        yield Item(ItemKind(kind_name), identifier)
    parts = [part.strip() for part in place.split(",")]
    # Identifiers may hold a comma: the whole comes first.
    for name in (place, *reversed(parts)):
        sortie = re.fullmatch(r"sortie (\d+)", name)
        if sortie is not None:
            yield Item(ItemKind.SORTIE, sortie[1])
        if name in _NAMED:
            yield Item(_NAMED[name])
        for kind in _BY_ID:
            yield Item(kind, name)
