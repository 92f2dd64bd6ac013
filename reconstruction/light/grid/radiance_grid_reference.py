"""Marching rays through a grid of density and light in plain torch: readable, and for graphics cards.

Every ray visits all of its places, whether anything is there or not, so it takes more time and memory than the kernels.
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn.functional import grid_sample

DENSITY_SCALE, OPAQUE = 10.0, 1e-3
"""As of the kernels."""


def march(
    origins: Tensor, directions: Tensor, starts: Tensor, cells: Tensor, skips: Tensor, far: Tensor, box: Tensor,
    times: Tensor, steps: Tensor, unit: float,
) -> tuple[Tensor, Tensor]:  # fmt: skip
    """Light, shape (n, 3), and share of it that comes from far away, shape (n,); arguments as those of the kernel."""
    visited = times + starts[:, None] * steps
    places = origins[:, None, :] + visited[..., None] * directions[:, None, :]
    inside = (places - box[:3]) * box[3:6]
    sizes = torch.tensor(cells.shape[2::-1], dtype=cells.dtype, device=cells.device)
    corners = (contracted(inside, box[6]) / (1.0 + box[6]) * 0.5 + 0.5) * (sizes - 1.0)
    values = interpolated(cells, corners)
    raw = DENSITY_SCALE * values[..., 0]
    base = torch.minimum(corners.detach().long(), sizes.long() - 2).unbind(dim=-1)
    is_there = (skips[base[2], base[1], base[0]] == 0) & (raw > -1.0)
    density = torch.where(is_there, ramp(raw) * unit * steps, torch.zeros_like(raw))
    passed = torch.cumsum(density, dim=1)
    reached = torch.cat([torch.ones_like(passed[:, :1]), torch.exp(-passed[:, :-1])], dim=1)
    # The place at which a ray becomes opaque still counts, all further ones do not.
    shares = torch.where(reached >= OPAQUE, reached * -torch.expm1(-density), torch.zeros_like(density))
    left = 1.0 - shares.sum(dim=1)
    near = (shares[..., None] * values[..., 1:].square()).sum(dim=1)
    return near + left[:, None] * far_light(far, directions), left


def ramp(raw: Tensor) -> Tensor:
    """0 up to -1, raw from 1 on, a parabola in between."""
    return torch.where(raw >= 1.0, raw, (0.5 * (raw + 1.0)).clamp(min=0.0, max=1.0).square())


def contracted(values: Tensor, outer: Tensor | float) -> Tensor:
    """-1 to 1 stays; what is beyond, up to infinity, goes on to 1 + `outer` on either side."""
    size = values.abs().clamp(min=1.0)
    return torch.where(values.abs() <= 1.0, values, values.sign() * (1.0 + outer * (1.0 - 1.0 / size)))


def interpolated(cells: Tensor, corners: Tensor) -> Tensor:
    """Linear between vertices, shape (n, s, 4), at places (n, s, 3) counted in cells along x, y and z."""
    sizes = torch.tensor(cells.shape[2::-1], dtype=corners.dtype, device=corners.device)
    places = (corners / (sizes - 1.0) * 2.0 - 1.0)[None, :, :, None, :]
    found = grid_sample(
        cells.permute(3, 0, 1, 2)[None], places, mode="bilinear", padding_mode="border", align_corners=True
    )
    return found[0, :, :, :, 0].permute(1, 2, 0)


def unfolded(directions: Tensor) -> Tensor:
    """Places, -1 to 1, shape (n, 2), of directions in a square picture of all of them: an octahedron folded out."""
    plain = directions[:, :2] / directions.abs().sum(dim=1, keepdim=True)
    signs = torch.where(plain >= 0.0, 1.0, -1.0).to(plain.dtype)
    return torch.where(directions[:, 2:] < 0.0, (1.0 - plain.abs().flip(1)) * signs, plain)


def far_light(far: Tensor, directions: Tensor) -> Tensor:
    """Light from far away, shape (n, 3), linear between pixels of square roots of light, over edges too."""
    side = len(far)
    places = (unfolded(directions) + 1.0) * (0.5 * side) - 0.5
    first = torch.floor(places.detach())
    a, b = (places - first).unbind(dim=1)
    column, row = first.long().unbind(dim=1)
    flat = far.reshape(-1, 3)
    root = (
        ((1.0 - a) * (1.0 - b))[:, None] * flat[wrapped(column, row, side)]
        + (a * (1.0 - b))[:, None] * flat[wrapped(column + 1, row, side)]
        + ((1.0 - a) * b)[:, None] * flat[wrapped(column, row + 1, side)]
        + (a * b)[:, None] * flat[wrapped(column + 1, row + 1, side)]
    )
    return root.square()


def wrapped(columns: Tensor, rows: Tensor, side: int) -> Tensor:
    """Numbers of pixels, also of those one step over an edge: each edge meets itself, turned about."""
    is_off = (columns < 0) | (columns >= side)
    columns, rows = columns.clamp(0, side - 1), torch.where(is_off, side - 1 - rows, rows)
    is_off = (rows < 0) | (rows >= side)
    rows, columns = rows.clamp(0, side - 1), torch.where(is_off, side - 1 - columns, columns)
    return rows * side + columns


def roughness(cells: Tensor, amounts: Tensor, corners: Tensor) -> Tensor:
    """Huber's function of neighbours' differences, straight from `corners` on, times a factor for each channel."""
    total = torch.zeros((), dtype=cells.dtype, device=cells.device)
    for axis in range(3):
        size = cells.diff(dim=axis).abs()
        bent = torch.where(size < corners, 0.5 * size.square() / corners, size - 0.5 * corners)
        total = total + (amounts * bent).sum()
    return total
