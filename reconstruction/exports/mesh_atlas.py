"""Many small pictures on few large ones: shelves from the highest to the lowest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Place:
    """Where a picture lies: its upper left pixel on a page."""

    page: int
    x_px: int
    y_px: int


@dataclass(frozen=True, slots=True)
class Atlas:
    """Places in the order of the pictures, and the sizes of the pages, width and height."""

    places: tuple[Place, ...]
    pages: tuple[tuple[int, int], ...]


def pack(sizes: Sequence[tuple[int, int]], page_px: int) -> Atlas:
    """Place pictures of given widths and heights on square pages of a side, cut to what is used of them.

    Raises
    ------
    ValueError
        A picture is larger than a page.
    """
    if any(max(size) > page_px or min(size) < 1 for size in sizes):
        raise ValueError(f"sizes: expected 1 to {page_px} pixels each way")
    places: list[Place | None] = [None] * len(sizes)
    used: list[tuple[int, int]] = []
    page, x, y, shelf = -1, 0, page_px, 0
    for number in sorted(range(len(sizes)), key=lambda number: (-sizes[number][1], -sizes[number][0], number)):
        width, height = sizes[number]
        if page >= 0 and x + width > page_px:
            x, y, shelf = 0, y + shelf, height
        if y + height > page_px:
            page, x, y, shelf = page + 1, 0, 0, height
            used.append((0, 0))
        places[number] = Place(page, x, y)
        used[page] = (max(used[page][0], x + width), max(used[page][1], y + height))
        x += width
    return Atlas(tuple(place for place in places if place is not None), tuple(used))
