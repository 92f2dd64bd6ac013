"""Cubes of texels around the origin: where texels are, how faces adjoin, and averages from fine to coarse.

Face 2 k looks along axis k (x, y, z), face 2 k + 1 against it. With axis k the major one of a direction d,
u = d[k + 1] / |d[k]| and v = d[k + 2] / |d[k]|, axes counted round: -1 to 1 on the face. Texels come face by face, row
by row (v), column by column (u); all faces are laid out alike, so turning or mirroring the axes only renumbers texels.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FACES = 6


def sides_from(side: int, last: int = 1) -> tuple[int, ...]:
    """Sides of a picture and its halves down to `last`.

    Raises
    ------
    ValueError
        `side` is no power of 2, or below `last`.
    """
    if side < last or side & (side - 1):
        raise ValueError(f"side: expected a power of 2 from {last} on, got {side}")
    return tuple(side >> k for k in range((side // last).bit_length()))


def directions_on(faces: Integers, u: Array, v: Array) -> Array:
    """Directions, shape (..., 3), not of unit length, of places u and v on faces, all of the same shape."""
    axes, signs = faces // 2, 1.0 - 2.0 * (faces % 2)
    found = np.empty((*np.broadcast(faces, u, v).shape, 3))
    for shift, values in enumerate((signs, u, v)):
        axis = (axes + shift) % 3
        np.put_along_axis(found, np.broadcast_to(axis, found.shape[:-1])[..., None],
                          np.broadcast_to(values, found.shape[:-1])[..., None], axis=-1)  # fmt: skip
    return found


def texels_of(directions: Array, side: int) -> Integers:
    """Numbers of the texels that directions, shape (..., 3), of any length but zero, fall on."""
    axes = np.abs(directions).argmax(axis=-1)
    major, across, up = (
        np.take_along_axis(directions, ((axes + shift) % 3)[..., None], axis=-1)[..., 0] for shift in range(3)
    )
    faces = 2 * axes + (major < 0.0)
    column, row = (
        np.clip(((value / np.abs(major) + 1.0) * 0.5 * side).astype(np.int64), 0, side - 1) for value in (across, up)
    )
    return np.asarray((faces * side + row) * side + column, np.int64)


def middles(side: int) -> Array:
    """Coordinate u (and v) of the middles of a row's texels, shape (side,)."""
    return (2.0 * np.arange(side) + 1.0) / side - 1.0


@lru_cache(maxsize=16)
def texel_directions(side: int) -> Array:
    """Unit directions of all texels, shape (6 side^2, 3)."""
    faces, v, u = np.meshgrid(np.arange(FACES), middles(side), middles(side), indexing="ij")
    found = directions_on(faces.ravel(), u.ravel(), v.ravel())
    return np.asarray(found / np.linalg.norm(found, axis=-1, keepdims=True))


@lru_cache(maxsize=16)
def solid_angles(side: int) -> Array:
    """Of all texels, steradian, shape (6 side^2,); they add up to 4 pi."""
    edges = np.linspace(-1.0, 1.0, side + 1)
    x, y = np.meshgrid(edges, edges)
    corners = np.arctan2(x * y, np.sqrt(x * x + y * y + 1.0))
    return np.tile(np.diff(np.diff(corners, axis=0), axis=1).ravel(), FACES)


def averages(side: int, coarse: int) -> sparse.csr_array:
    """Of all texels that a coarser one covers, by solid angle, shape (6 coarse^2, 6 side^2)."""
    ratio = side // coarse
    fine = np.arange(FACES * side * side).reshape(FACES, coarse, ratio, coarse, ratio)
    columns = fine.transpose(0, 1, 3, 2, 4).reshape(-1, ratio * ratio)
    weights = solid_angles(side)[columns]
    weights /= weights.sum(axis=1, keepdims=True)
    starts = np.arange(0, columns.size + 1, ratio * ratio)
    return sparse.csr_array((weights.ravel(), columns.ravel(), starts), (len(columns), FACES * side * side))


def padding(side: int) -> sparse.csr_array:
    """Pictures with a border one texel wide of what adjoins them, shape (6 (side + 2)^2, 6 side^2).

    Where three faces meet there is no fourth texel: the mean of the three stands for it. Linear lookups between texels
    then agree along every edge and in every corner, from whichever face they come.
    """
    wide = side + 2
    along = np.arange(-1, side + 1)
    faces, rows, columns = (part.ravel() for part in np.meshgrid(np.arange(FACES), along, along, indexing="ij"))
    past_u, past_v = (columns < 0) | (columns >= side), (rows < 0) | (rows >= side)
    is_corner = past_u & past_v
    inner_rows, inner_columns = np.clip(rows, 0, side - 1), np.clip(columns, 0, side - 1)
    own = (faces * side + inner_rows) * side + inner_columns
    beside = texels_of(_beyond(faces, inner_columns, inner_rows, columns, side, 1), side)
    below = texels_of(_beyond(faces, inner_columns, inner_rows, rows, side, 2), side)
    numbers = np.arange(FACES * wide * wide)
    plain = np.where(past_u, beside, np.where(past_v, below, own))
    entries = [(numbers[~is_corner], plain[~is_corner], 1.0)]
    entries += [(numbers[is_corner], each[is_corner], 1.0 / 3.0) for each in (own, beside, below)]
    values = np.concatenate([np.full(len(row), weight) for row, _, weight in entries])
    where = (np.concatenate([row for row, _, _ in entries]), np.concatenate([column for _, column, _ in entries]))
    return sparse.csr_array((values, where), (len(numbers), FACES * side * side))


def _beyond(faces: Integers, columns: Integers, rows: Integers, past: Integers, side: int, shift: int) -> Array:
    """Directions of the texels that adjoin border texels across the edge that `past` lies over.

    Parameters
    ----------
    past
        Column (`shift` 1) or row (`shift` 2), -1 or `side` where it counts.
    """
    centre = middles(side)
    found = directions_on(faces, centre[columns], centre[rows])
    axes = faces // 2
    np.put_along_axis(found, ((axes + shift) % 3)[:, None], np.where(past < 0, -1.0, 1.0)[:, None], axis=1)
    inwards = (1.0 - 2.0 * (faces % 2)) * (1.0 - 1.0 / side)
    np.put_along_axis(found, axes[:, None], inwards[:, None], axis=1)
    return found
