"""The wall of a made facade: a vertical plane or cylinder with coordinates along it.

Two frames are used. ENU is the site's. The *wall frame* has its origin on the wall, in its middle and at its base: x to
the right as seen from outside, y into the wall, z up. On the wall, s is the length along it from its middle to the
right and h the height above its base, metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Wall:
    """Where a wall stands and how it is bent.

    Parameters
    ----------
    base_enu_m
        Middle of the wall at its base.
    outward_heading_deg
        Of the outward normal in the middle, clockwise from north; -180 faces south.
    curvature_per_m
        1 / radius: positive for a wall that bulges outwards, negative for a hollow one, 0 for a plane.
    """

    base_enu_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    outward_heading_deg: float = 180.0
    curvature_per_m: float = 0.0

    @property
    def wall_from_enu(self) -> Array:
        """Rotation, shape (3, 3), from ENU to the wall frame."""
        heading = math.radians(self.outward_heading_deg)
        sin, cos = math.sin(heading), math.cos(heading)
        return np.array([[-cos, sin, 0.0], [-sin, -cos, 0.0], [0.0, 0.0, 1.0]])

    def to_wall(self, points_enu_m: Array) -> Array:
        """Points, shape (n, 3), ENU to wall frame."""
        return (np.atleast_2d(points_enu_m) - self.base_enu_m) @ self.wall_from_enu.T

    def points_enu_m(self, s_m: Array, h_m: Array) -> Array:
        """Points on the wall, shape (n, 3), from their coordinates along it, each shape (n,)."""
        s, h = np.asarray(s_m, float), np.asarray(h_m, float)
        angle = self.curvature_per_m * s
        # sin(ks)/k and (1 - cos(ks))/k, both good for k = 0.
        x = s * np.sinc(angle / np.pi)
        y = 0.5 * self.curvature_per_m * s**2 * np.sinc(0.5 * angle / np.pi) ** 2
        return np.stack([x, y, h], axis=-1) @ self.wall_from_enu + self.base_enu_m

    def outward_enu(self, s_m: Array) -> Array:
        """Unit outward normals, shape (n, 3), at places along the wall, shape (n,)."""
        angle = self.curvature_per_m * np.asarray(s_m, float)
        normals = np.stack([np.sin(angle), -np.cos(angle), np.zeros_like(angle)], axis=-1)
        return np.asarray(normals @ self.wall_from_enu)


def first_hits(
    origin: Array, x: Array32, y: Array32, z: Array32, curvature_per_m: float
) -> tuple[Array32, Array32, Array32]:
    """Where rays from one point fall on the outside of a wall of any height, everything in the wall frame.

    Parameters
    ----------
    origin
        Shape (3,), outside the wall.
    x, y, z
        Directions, each shape (n,), any length.

    Returns
    -------
    t, s_m, h_m
        Multiples of the direction, place along the wall and height, each shape (n,); NaN where the ray misses.
    """
    k = np.float32(curvature_per_m)
    ox, oy, oz = (np.float32(value) for value in origin)
    # k (x² + y²) = 2 y is the wall: a cylinder that touches the x axis, and for k = 0 the plane itself. The root is
    # written so that it stays exact as k goes to 0.
    a = k * (x * x + y * y)
    b = y - k * (ox * x + oy * y)
    c = k * (ox * ox + oy * oy) - 2 * oy
    with np.errstate(divide="ignore", invalid="ignore"):
        root = c / (b + np.sqrt(b * b - a * c))
        is_hit = (root > 0) & (b > 0)
    t = np.where(is_hit, root, np.nan).astype(np.float32)
    hit_x, hit_y = ox + t * x, oy + t * y
    s = np.arctan2(k * hit_x, 1 - k * hit_y) / k if k else hit_x
    return t, np.asarray(s, np.float32), np.asarray(oz + t * z, np.float32)
