"""Rays of pixels met with the planes of panels, and mirrored by panes that lean a little, compiled, one ray at a time.

As `RayTable.meet` and `GlassLight.mirrored` have them in plain torch, which takes five times as long for a few thousand
rays.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Index = NDArray[np.int64]
Number = np.float32

ONE, TWO, NONE = np.float32(1.0), np.float32(2.0), np.float32(0.0)

SHORTEST = np.float32(1e-12)
"""Of a normal before it is made unit."""


@kernel
def unbent(x: float, y: float, distortion: Array, n_steps: int) -> tuple[float, float]:
    """Place in a straight picture of one in the photo, in focal lengths, by a fixed-point iteration."""
    k1, k2, p1, p2, k3 = distortion
    u, v = x, y
    for _ in range(n_steps):
        r2 = u * u + v * v
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        u, v = (
            (x - 2.0 * p1 * u * v - p2 * (r2 + 2.0 * u * u)) / radial,
            (y - p1 * (r2 + 2.0 * v * v) - 2.0 * p2 * u * v) / radial,
        )
    return u, v


@kernel
def meet(
    photos: Index, places: Array, panels: Index, positions: Array, turns: Array, lenses: Array, distortions: Array,
    corners: Array, normals: Array, n_steps: int, least: float,
    points: Array, directions: Array, cosines: Array, shares: Array, distances: Array,
) -> None:  # fmt: skip
    """Write the fields of `Met`; the other arguments are those of `RayTable.meet`, and fields of the table.

    Parameters
    ----------
    n_steps
        Of the iteration that takes distortion away; 0 where pictures are straight.
    least
        Cosine that distances are worked out with at least.
    """
    for ray in range(len(photos)):
        photo, panel = photos[ray], panels[ray]
        x, y = (
            (places[ray, 0] - lenses[photo, 2]) / lenses[photo, 0],
            (places[ray, 1] - lenses[photo, 3]) / lenses[photo, 1],
        )
        if n_steps > 0:
            x, y = unbent(x, y, distortions[photo], n_steps)
        turn = turns[photo]
        dx = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2]
        dy = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2]
        dz = turn[2, 0] * x + turn[2, 1] * y + turn[2, 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        dx, dy, dz = dx / length, dy / length, dz / length
        ox, oy, oz = positions[photo, 0], positions[photo, 1], positions[photo, 2]
        nx, ny, nz = normals[panel, 0], normals[panel, 1], normals[panel, 2]
        corner = corners[panel]
        cosine = -(dx * nx + dy * ny + dz * nz)
        height = (ox - corner[0, 0]) * nx + (oy - corner[0, 1]) * ny + (oz - corner[0, 2]) * nz
        distance = height / max(cosine, least)
        px, py, pz = ox + distance * dx, oy + distance * dy, oz + distance * dz
        points[ray, 0], points[ray, 1], points[ray, 2] = px, py, pz
        directions[ray, 0], directions[ray, 1], directions[ray, 2] = dx, dy, dz
        cosines[ray], distances[ray] = cosine, distance
        for number in range(2):
            end = corner[1 + 2 * number]
            ex, ey, ez = end[0] - corner[0, 0], end[1] - corner[0, 1], end[2] - corner[0, 2]
            along = ex * (px - corner[0, 0]) + ey * (py - corner[0, 1]) + ez * (pz - corner[0, 2])
            shares[ray, number] = along / max(ex * ex + ey * ey + ez * ez, 1e-20)


@kernel
def leaning(
    panel: int, normals: Single, edges: Single, tilts: Single, bows: Single, a: Number, b: Number
) -> tuple[Number, Number, Number]:
    """Normal of a pane, not yet unit, at a place that is `a` and `b` off its middle, -1 to 1."""
    s, t = tilts[panel, 0] + bows[panel, 0] * a, tilts[panel, 1] + bows[panel, 1] * b
    e, f = edges[panel, 0], edges[panel, 1]
    return (
        normals[panel, 0] + s * e[0] + t * f[0],
        normals[panel, 1] + s * e[1] + t * f[1],
        normals[panel, 2] + s * e[2] + t * f[2],
    )


@kernel
def off_middle(share: float) -> Number:
    """-1 to 1, of a share along an edge, which is 0 to 1 within a pane."""
    return np.float32(2.0 * min(max(share, 0.0), 1.0) - 1.0)


@kernel
def mirror(
    directions: Array, shares: Array, panels: Index, normals: Single, edges: Single, tilts: Single, bows: Single,
    omega_r: Single, cosines: Single,
) -> None:  # fmt: skip
    """Where rays are mirrored to, and cosines of their angles of incidence.

    Parameters
    ----------
    directions, shares
        Of `Met`.
    panels
        Shape (n,).
    normals, edges
        Unit normals, shape (m, 3), and unit vectors along the lower edges and up from them, shape (m, 2, 3).
    tilts, bows
        How far normals lean along the edges, and how much further at their ends, radians, shape (m, 2).
    omega_r, cosines
        Shapes (n, 3) and (n,), written.
    """
    for ray in range(len(panels)):
        a, b = off_middle(shares[ray, 0]), off_middle(shares[ray, 1])
        nx, ny, nz = leaning(panels[ray], normals, edges, tilts, bows, a, b)
        length = max(np.float32(math.sqrt(nx * nx + ny * ny + nz * nz)), SHORTEST)
        nx, ny, nz = nx / length, ny / length, nz / length
        dx, dy, dz = np.float32(directions[ray, 0]), np.float32(directions[ray, 1]), np.float32(directions[ray, 2])
        along = dx * nx + dy * ny + dz * nz
        omega_r[ray, 0], omega_r[ray, 1] = dx - TWO * along * nx, dy - TWO * along * ny
        omega_r[ray, 2] = dz - TWO * along * nz
        cosines[ray] = min(abs(along), ONE)


@kernel
def mirror_back(
    directions: Array, shares: Array, panels: Index, normals: Single, edges: Single, tilts: Single, bows: Single,
    by_omega_r: Single, by_cosines: Single, by_tilts: Array, by_bows: Array,
) -> None:  # fmt: skip
    """Gradients by tilts and bows, added to float64 arrays of shape (m, 2); arguments as those of `mirror`."""
    for ray in range(len(panels)):
        panel = panels[ray]
        a, b = off_middle(shares[ray, 0]), off_middle(shares[ray, 1])
        nx, ny, nz = leaning(panel, normals, edges, tilts, bows, a, b)
        length = max(np.float32(math.sqrt(nx * nx + ny * ny + nz * nz)), SHORTEST)
        nx, ny, nz = nx / length, ny / length, nz / length
        dx, dy, dz = np.float32(directions[ray, 0]), np.float32(directions[ray, 1]), np.float32(directions[ray, 2])
        along = dx * nx + dy * ny + dz * nz
        gx, gy, gz = by_omega_r[ray, 0], by_omega_r[ray, 1], by_omega_r[ray, 2]
        # Of omega_r = d - 2 (d . n) n and |d . n|, by the unit normal, then by the one before it was made unit.
        by_along = -TWO * (gx * nx + gy * ny + gz * nz)
        if abs(along) <= ONE:
            by_along += by_cosines[ray] * (ONE if along > NONE else (-ONE if along < NONE else NONE))
        hx, hy, hz = (
            by_along * dx - TWO * along * gx,
            by_along * dy - TWO * along * gy,
            by_along * dz - TWO * along * gz,
        )
        out = hx * nx + hy * ny + hz * nz
        hx, hy, hz = (hx - out * nx) / length, (hy - out * ny) / length, (hz - out * nz) / length
        e, f = edges[panel, 0], edges[panel, 1]
        s, t = hx * e[0] + hy * e[1] + hz * e[2], hx * f[0] + hy * f[1] + hz * f[2]
        by_tilts[panel, 0] += s
        by_tilts[panel, 1] += t
        by_bows[panel, 0] += s * a
        by_bows[panel, 1] += t * b
