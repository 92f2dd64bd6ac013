"""Cubes of texels from fine to coarse, and lookups in them: linear between texels and between levels, without seams."""

from __future__ import annotations

import numpy as np
import torch
from scipy import sparse
from torch import Tensor

from reconstruction.light.cube.faces import FACES, averages, padding, sides_from
from reconstruction.light.cube.linear_map import LinearMap
from reconstruction.light.cube.lookup_kernels import LONGEST, SHORTEST, looked_up


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

        Compiled for float32 in main memory, else by `looked_up_twin`.

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
        return looked_up_twin(directions, levels, texels, self)


def looked_up_twin(directions: Tensor, levels: Tensor, texels: Tensor, where: Levels) -> Tensor:
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
