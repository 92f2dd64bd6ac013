"""Cubes of texels from fine to coarse, and lookups in them: linear between texels and between levels, without seams."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse
from torch import Tensor
from torch.autograd.function import once_differentiable

from planning.base.jit import chunks, inline, kernel, run_chunks, run_parallel

Floats = NDArray[np.float32]
Integers = NDArray[np.int64]


# Cubes of texels around the origin: where texels are, how faces adjoin, and averages from fine to coarse.
#
# Face 2 k looks along axis k (x, y, z), face 2 k + 1 against it. With axis k the major one of a direction d,
# u = d[k + 1] / |d[k]| and v = d[k + 2] / |d[k]|, axes counted round: -1 to 1 on the face. Texels come face by face,
# row
# by row (v), column by column (u); all faces are laid out alike, so turning or mirroring the axes only renumbers
# texels.

Array = NDArray[np.float64]

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


# A fixed sparse matrix as a step of a model: compiled for float32 in main memory, plain torch elsewhere.

Indices = NDArray[np.int32]

ENTRIES_AT_ONCE = 262_144
"""Weights of one call of the kernel: about a millisecond."""


class LinearMap:
    """A matrix that is multiplied with columns of numbers, and its gradient; the matrix itself has none.

    The same bits for any number of threads: each row is added up in its order.

    Parameters
    ----------
    matrix
        Shape (m, n).
    """

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._matrix = matrix
        self.there, self.back = _Rows(matrix), _Rows(sparse.csr_array(matrix.T))
        self._placed: dict[tuple[torch.device, torch.dtype], tuple[Tensor, Tensor, Tensor]] = {}

    @property
    def shape(self) -> tuple[int, int]:
        """Rows m and columns n."""
        return self._matrix.shape

    def __call__(self, values: Tensor) -> Tensor:
        """Shape (m, c) of values of shape (n, c)."""
        if values.device.type == "cpu" and values.dtype == torch.float32:
            return cast(Tensor, _Multiplied.apply(values, self))  # type: ignore[no-untyped-call]
        rows, columns, weights = self._entries_like(values)
        out = torch.zeros((self.shape[0], values.shape[1]), dtype=values.dtype, device=values.device)
        return out.index_add(0, rows, weights[:, None] * values[columns])

    def _entries_like(self, values: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Rows, columns and weights, each shape (k,), on the device of the values and in their precision."""
        key = (values.device, values.dtype)
        if key not in self._placed:
            entries = self._matrix.tocoo()
            rows, columns = (torch.from_numpy(np.asarray(each, np.int64)).to(values.device) for each in entries.coords)
            weights = torch.from_numpy(np.asarray(entries.data, np.float64)).to(values.device, values.dtype)
            self._placed[key] = (rows, columns, weights)
        return self._placed[key]


class _Rows:
    """Compressed rows in the types that the kernel takes."""

    def __init__(self, matrix: sparse.csr_array) -> None:
        self.starts = np.asarray(matrix.indptr, np.int64)
        self.columns = np.asarray(matrix.indices, np.int32)
        self.weights = np.asarray(matrix.data, np.float32)
        n_rows = len(self.starts) - 1
        per_row = max(1, len(self.columns) // max(1, n_rows))
        self._ranges = chunks(n_rows, max(1, ENTRIES_AT_ONCE // per_row))

    def times(self, values: Floats) -> Floats:
        out = np.empty((len(self.starts) - 1, values.shape[1]), np.float32)
        work = _times_three if values.shape[1] == 3 else _times
        run_chunks(lambda a, b: work(self.starts, self.columns, self.weights, values, a, b, out), self._ranges)
        return out


@kernel
def _times_three(
    starts: Any, columns: Indices, weights: Floats, values: Floats, first: int, last: int, out: Floats
) -> None:
    for i in range(first, last):
        red = green = blue = np.float32(0.0)
        for k in range(starts[i], starts[i + 1]):
            weight, j = weights[k], columns[k]
            red += weight * values[j, 0]
            green += weight * values[j, 1]
            blue += weight * values[j, 2]
        out[i, 0], out[i, 1], out[i, 2] = red, green, blue


@kernel
def _times(starts: Any, columns: Indices, weights: Floats, values: Floats, first: int, last: int, out: Floats) -> None:
    n_channels = values.shape[1]
    for i in range(first, last):
        out[i] = np.float32(0.0)
        for k in range(starts[i], starts[i + 1]):
            weight, j = weights[k], columns[k]
            for c in range(n_channels):
                out[i, c] += weight * values[j, c]


class _Multiplied(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, values: Tensor, linear: LinearMap) -> Tensor:
        ctx.linear = linear
        return torch.from_numpy(linear.there.times(np.asarray(values.detach().contiguous().numpy())))

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Any) -> tuple[Tensor, None]:
        gradient = np.asarray(gradients[0].detach().contiguous().numpy())
        return torch.from_numpy(ctx.linear.back.times(gradient)), None


# Lookups in cubes of texels and the way back, compiled, float32 in main memory.
#
# Cubes are padded (`padding`), so that a lookup's four texels lie in one face, and come finest first, one
# below the other. The formulas are those of `looked_up_reference`. Gradients of texels are added up ray by ray in
# up to four parts, whose number depends on sizes alone: the same bits for any number of threads.

SHORTEST, LONGEST = 1e-20, 1e20
"""Ends of the largest part of a direction; beyond, and where it is no number, it is none: the middle of a face."""

RAYS_AT_ONCE = 4096
"""Of one call of a kernel: less than a millisecond, so that threads end together."""

MOST_PARTS, RAYS_PER_TEXEL = 4, 0.25
"""Parts of the rays whose gradients are kept apart; fewer where clearing texels would take longer than the rays."""

ZERO, HALF, ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
LEAST, MOST = np.float32(SHORTEST), np.float32(LONGEST)


@inline
def _place(directions: Any, i: Any) -> Any:
    """Face, u and v, and one over the major part; 0 for the last where there is no direction."""
    x, y, z = directions[i, 0], directions[i, 1], directions[i, 2]
    ax, ay, az = abs(x), abs(y), abs(z)
    axis, major, across, up = 2, z, x, y
    if ax >= ay and ax >= az:
        axis, major, across, up = 0, x, y, z
    elif ay >= az:
        axis, major, across, up = 1, y, z, x
    face = 2 * axis + (1 if major < ZERO else 0)
    u, v, scale = ZERO, ZERO, ZERO
    # What is no number fails every comparison: it must not become the number of a texel.
    if LEAST < abs(major) <= MOST and abs(across) <= MOST and abs(up) <= MOST:
        scale = ONE / abs(major)
        u, v = across * scale, up * scale
    return face, u, v, scale


@inline
def _level(levels: Any, i: Any, n_levels: Any) -> Any:
    """The finer one of two levels, and the share of the coarser one."""
    level = min(levels[i], np.float32(n_levels - 1)) if levels[i] > ZERO else ZERO
    fine = min(max(int(level), 0), max(n_levels - 2, 0))
    return fine, level - np.float32(fine)


@inline
def _corner(face: Any, u: Any, v: Any, side: Any, offset: Any) -> Any:
    """The first of four texels, and shares of the next column and row."""
    x, y = HALF * (u + ONE) * np.float32(side) + HALF, HALF * (v + ONE) * np.float32(side) + HALF
    column, row = min(max(int(x), 0), side), min(max(int(y), 0), side)
    wide = side + 2
    return offset + (face * wide + row) * wide + column, x - np.float32(column), y - np.float32(row)


@kernel
def _look_up(
    directions: Floats, levels: Floats, texels: Floats, sides: Integers, offsets: Integers, start: int, stop: int,
    out: Floats,
) -> None:  # fmt: skip
    n_levels, n_channels = len(sides), texels.shape[1]
    for i in range(start, stop):
        face, u, v, _ = _place(directions, i)
        fine, coarser = _level(levels, i, n_levels)
        for c in range(n_channels):
            out[i, c] = ZERO
        for k in range(min(2, n_levels)):
            weight = coarser if k == 1 else ONE - coarser
            if weight == ZERO:
                continue
            side = sides[fine + k]
            here, a, b = _corner(face, u, v, side, offsets[fine + k])
            below = here + side + 2
            w00, w01 = weight * (ONE - a) * (ONE - b), weight * a * (ONE - b)
            w10, w11 = weight * (ONE - a) * b, weight * a * b
            for c in range(n_channels):
                out[i, c] += (w00 * texels[here, c] + w01 * texels[here + 1, c]) + (
                    w10 * texels[below, c] + w11 * texels[below + 1, c]
                )


@kernel
def _give_back(
    directions: Floats, levels: Floats, gradient: Floats, sides: Integers, offsets: Integers, start: int, stop: int,
    of_texels: Floats,
) -> None:  # fmt: skip
    """Add the gradients of what was looked up to those of the texels."""
    n_levels, n_channels = len(sides), gradient.shape[1]
    for i in range(start, stop):
        face, u, v, _ = _place(directions, i)
        fine, coarser = _level(levels, i, n_levels)
        for k in range(min(2, n_levels)):
            weight = coarser if k == 1 else ONE - coarser
            if weight == ZERO:
                continue
            side = sides[fine + k]
            here, a, b = _corner(face, u, v, side, offsets[fine + k])
            below = here + side + 2
            w00, w01 = weight * (ONE - a) * (ONE - b), weight * a * (ONE - b)
            w10, w11 = weight * (ONE - a) * b, weight * a * b
            for c in range(n_channels):
                slope = gradient[i, c]
                of_texels[here, c] += w00 * slope
                of_texels[here + 1, c] += w01 * slope
                of_texels[below, c] += w10 * slope
                of_texels[below + 1, c] += w11 * slope


@kernel
def _turn_back(
    directions: Floats, levels: Floats, texels: Floats, gradient: Floats, sides: Integers, offsets: Integers,
    start: int, stop: int, of_directions: Floats, of_levels: Floats,
) -> None:  # fmt: skip
    """Gradients of directions and levels; beyond the ends of the levels there is none."""
    n_levels, n_channels = len(sides), texels.shape[1]
    for i in range(start, stop):
        face, u, v, scale = _place(directions, i)
        fine, coarser = _level(levels, i, n_levels)
        of_u, of_v, of_level = ZERO, ZERO, ZERO
        for k in range(min(2, n_levels)):
            weight = coarser if k == 1 else ONE - coarser
            side = sides[fine + k]
            here, a, b = _corner(face, u, v, side, offsets[fine + k])
            below = here + side + 2
            along, down, value = ZERO, ZERO, ZERO
            for c in range(n_channels):
                t00, t01, t10, t11 = texels[here, c], texels[here + 1, c], texels[below, c], texels[below + 1, c]
                right, lower_right = t01 - t00, t11 - t10
                along += gradient[i, c] * (right + b * (lower_right - right))
                down += gradient[i, c] * ((t10 - t00) + a * (lower_right - right))
                upper, lower = t00 + a * right, t10 + a * lower_right
                value += gradient[i, c] * (upper + b * (lower - upper))
            of_u += weight * along * (HALF * np.float32(side))
            of_v += weight * down * (HALF * np.float32(side))
            of_level += value if k == 1 else -value
        axis = face // 2
        sign = -scale if face % 2 == 1 else scale
        of_directions[i, axis] = -sign * (u * of_u + v * of_v)
        of_directions[i, (axis + 1) % 3] = scale * of_u
        of_directions[i, (axis + 2) % 3] = scale * of_v
        is_within = n_levels > 1 and ZERO <= levels[i] <= np.float32(n_levels - 1)
        of_levels[i] = of_level if is_within else ZERO


def looked_up(directions: Tensor, levels: Tensor, texels: Tensor, sides: Integers, offsets: Integers) -> Tensor:
    """See `cube_lookup.looked_up_reference`; all tensors float32 in main memory."""
    return cast(Tensor, _LookedUp.apply(directions, levels, texels, sides, offsets))  # type: ignore[no-untyped-call]


class _LookedUp(torch.autograd.Function):
    """Directions, levels and texels to what they show."""

    @staticmethod
    def forward(
        ctx: Any, directions: Tensor, levels: Tensor, texels: Tensor, sides: Integers, offsets: Integers
    ) -> Tensor:
        ctx.save_for_backward(directions, levels, texels)
        ctx.sides, ctx.offsets = sides, offsets
        rays, of_rays, table = _array(directions), _array(levels), _array(texels)
        out = np.empty((len(rays), table.shape[1]), np.float32)
        run_chunks(
            lambda a, b: _look_up(rays, of_rays, table, sides, offsets, a, b, out), chunks(len(rays), RAYS_AT_ONCE)
        )
        return torch.from_numpy(out)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Any) -> Any:
        directions, levels, texels = ctx.saved_tensors
        sides, offsets = ctx.sides, ctx.offsets
        rays, of_rays, table, gradient = _array(directions), _array(levels), _array(texels), _array(gradients[0])
        of_texels = of_directions = of_levels = None
        if ctx.needs_input_grad[2]:
            n_parts = int(min(max(len(rays) * RAYS_PER_TEXEL / len(table) * MOST_PARTS, 1), MOST_PARTS))
            ranges = chunks(len(rays), max(1, -(-len(rays) // n_parts)))
            parts = [np.zeros(table.shape, np.float32) for _ in ranges] or [np.zeros(table.shape, np.float32)]
            run_parallel(
                lambda a, b, part: _give_back(rays, of_rays, gradient, sides, offsets, a, b, part),
                [(a, b, part) for (a, b), part in zip(ranges, parts, strict=False)],
            )
            for part in parts[1:]:
                parts[0] += part
            of_texels = torch.from_numpy(parts[0])
        if ctx.needs_input_grad[0] or ctx.needs_input_grad[1]:
            turned, moved = np.empty(rays.shape, np.float32), np.empty(len(rays), np.float32)
            run_chunks(
                lambda a, b: _turn_back(rays, of_rays, table, gradient, sides, offsets, a, b, turned, moved),
                chunks(len(rays), RAYS_AT_ONCE),
            )
            of_directions, of_levels = torch.from_numpy(turned), torch.from_numpy(moved)
        return of_directions, of_levels, of_texels, None, None


def _array(tensor: Tensor) -> Floats:
    return np.asarray(tensor.detach().contiguous().numpy())


class Levels:
    """Where padded cubes lie one below the other, finest first, and how lookups go into them.

    Parameters
    ----------
    sides
        Texels along an edge of each.
    """

    def __init__(self, sides: tuple[int, ...]) -> None:
        sizes = [FACES * (side + 2) ** 2 for side in sides]
        self.sides = np.asarray(sides, np.int64)
        self.offsets = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int64)
        self.n_texels = sum(sizes)

    def __len__(self) -> int:
        return len(self.sides)

    def look_up(self, directions: Tensor, levels: Tensor, texels: Tensor) -> Tensor:
        """What cubes show, shape (n, c).

        Compiled for float32 in main memory, else by `looked_up_reference`.

        Parameters
        ----------
        directions
            Shape (n, 3), of any length; the middle of a face stands for those of no length, with no gradient.
        levels
            0 for the finest to `len(self) - 1`, shape (n,); clamped.
        texels
            All cubes with their borders, shape (n_texels, c).
        """
        tensors = (directions, levels, texels)
        if all(each.device.type == "cpu" and each.dtype == torch.float32 for each in tensors):
            return looked_up(directions, levels, texels, self.sides, self.offsets)
        return looked_up_reference(directions, levels, texels, self)


def looked_up_reference(directions: Tensor, levels: Tensor, texels: Tensor, where: Levels) -> Tensor:
    """What `Levels.look_up` says, in plain torch, of any precision on any device."""
    axes = directions.detach().abs().argmax(dim=-1, keepdim=True)
    major, across, up = (directions.gather(-1, (axes + shift) % 3).squeeze(-1) for shift in range(3))
    has_direction = (major.abs() > SHORTEST) & (major.abs() <= LONGEST)
    length = torch.where(has_direction, major.abs(), torch.ones_like(major))
    u, v = (torch.where(has_direction, value / length, torch.zeros_like(value)) for value in (across, up))
    faces = 2 * axes.squeeze(-1) + (major.detach() < 0.0)
    level = levels.clamp(0.0, float(len(where) - 1))
    fine = level.detach().floor().long().clamp(0, max(len(where) - 2, 0))
    coarser = (level - fine)[:, None]
    found = _on_level(faces, u, v, fine, texels, where) * (1.0 - coarser)
    if len(where) == 1:
        return found
    return found + _on_level(faces, u, v, fine + 1, texels, where) * coarser


def _on_level(faces: Tensor, u: Tensor, v: Tensor, level: Tensor, texels: Tensor, where: Levels) -> Tensor:
    """Linear between four texels, shape (n, c)."""
    side = torch.from_numpy(where.sides).to(texels.device)[level]
    x, y = 0.5 * (u + 1.0) * side + 0.5, 0.5 * (v + 1.0) * side + 0.5
    column, row = (place.detach().floor().long().clamp(min=0).minimum(side) for place in (x, y))
    a, b = (x - column)[:, None], (y - row)[:, None]
    wide = side + 2
    here = torch.from_numpy(where.offsets).to(texels.device)[level] + (faces * wide + row) * wide + column
    upper = torch.lerp(texels[here], texels[here + 1], a)
    lower = torch.lerp(texels[here + wide], texels[here + wide + 1], a)
    return torch.lerp(upper, lower, b)


def averaged(side: int, last: int) -> LinearMap:
    """All levels of averages from `side` down to `last`, with their borders, from the finest one's texels."""
    parts = [padding(each) @ averages(side, each) for each in sides_from(side, last)]
    return LinearMap(sparse.csr_array(sparse.vstack(parts, format="csr")))
