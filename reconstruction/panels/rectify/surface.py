"""The surface that a facade's panels stand on: a plane, or a cylinder of any curvature, as one stable formula.

A cylinder is described by a point on it and its curvature instead of its axis and radius. A plane is then nothing
special (curvature 0), and a facade that is nearly flat has a small curvature instead of a radius that runs away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALL_ANGLE_RAD = 1e-4
"""Below it the arc tangent is taken as its series, whose next term is 1e-17 of the result."""


@dataclass(frozen=True, slots=True, eq=False)
class FacadeSurface:
    """A plane or cylinder with metres on it: s to the right as seen from outside, along the arc, and t upwards.

    Parameters
    ----------
    anchor_enu_m
        The point s = t = 0, shape (3,).
    right_enu, up_enu
        Unit vectors of s and t at the anchor, shape (3,); the outward normal is right x up. A cylinder's axis is
        parallel to `up_enu`.
    curvature_per_m
        1 / radius: positive where the facade bulges outwards, negative where it is hollow, 0 for a plane.
    """

    anchor_enu_m: Array
    right_enu: Array
    up_enu: Array
    curvature_per_m: float = 0.0

    def __post_init__(self) -> None:
        for name in ("anchor_enu_m", "right_enu", "up_enu"):
            if getattr(self, name).shape != (3,):
                raise ValueError(f"{name}: expected shape (3,), got {getattr(self, name).shape}")
        right, up = self.right_enu, self.up_enu
        if not max(abs(right @ right - 1.0), abs(up @ up - 1.0), abs(right @ up)) < 1e-6:
            raise ValueError("right_enu, up_enu: expected unit vectors at a right angle")
        if not np.isfinite(self.curvature_per_m):
            raise ValueError(f"curvature_per_m: expected a finite number, got {self.curvature_per_m}")

    @property
    def normal_enu(self) -> Array:
        """Outward unit normal at the anchor, shape (3,)."""
        (a, b, c), (u, v, w) = self.right_enu, self.up_enu
        return np.array([b * w - c * v, c * u - a * w, a * v - b * u])

    @property
    def is_flat(self) -> bool:
        """Whether it is a plane."""
        return self.curvature_per_m == 0.0

    def flat(self) -> FacadeSurface:
        """The tangent plane at the anchor."""
        return replace(self, curvature_per_m=0.0)

    def moved(self, s_m: float, t_m: float) -> FacadeSurface:
        """The same surface with its anchor at (s, t); coordinates on it shift by that much."""
        here = np.array([[s_m, t_m]])
        return replace(self, anchor_enu_m=self.to_enu(here)[0], right_enu=self.right_at(here)[0])

    def to_enu(self, st_m: Array) -> Array:
        """Points on the surface, shape (n, 3), at surface coordinates, shape (n, 2)."""
        st = np.atleast_2d(np.asarray(st_m, float))
        s, k = st[:, 0], self.curvature_per_m
        across = s * np.sinc(k * s / np.pi)
        sag = 0.5 * k * (s * np.sinc(0.5 * k * s / np.pi)) ** 2
        return (
            self.anchor_enu_m
            + across[:, None] * self.right_enu
            + st[:, 1, None] * self.up_enu
            - sag[:, None] * self.normal_enu
        )

    def to_surface(self, points_enu_m: Array) -> Array:
        """Coordinates, shape (n, 2), of the nearest points on the surface to points, shape (n, 3).

        s of a cylinder lies within half its circumference to either side. NaN on the axis, where all are nearest.
        """
        x, y, z = self._local(points_enu_m)
        k = self.curvature_per_m
        a, b = k * x, 1.0 + k * z
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = a / b
            near = (b > 0.0) & (np.abs(ratio) < SMALL_ANGLE_RAD)
            series = x / b * (1.0 - ratio * ratio / 3.0)
            arc = np.arctan2(a, b) / k if k else series
        s = np.where(near, series, arc)
        return np.column_stack([np.where((a == 0.0) & (b == 0.0), np.nan, s), y])

    def height_m(self, points_enu_m: Array) -> Array:
        """Signed distance of points, shape (n, 3), outwards positive, shape (n,)."""
        x, _, z = self._local(points_enu_m)
        m = self.curvature_per_m * (x * x + z * z) + 2.0 * z
        return m / (np.sqrt(np.maximum(0.0, 1.0 + self.curvature_per_m * m)) + 1.0)

    def right_at(self, st_m: Array) -> Array:
        """Unit tangents along s, shape (n, 3)."""
        angle = self.curvature_per_m * np.atleast_2d(np.asarray(st_m, float))[:, 0]
        return np.cos(angle)[:, None] * self.right_enu - np.sin(angle)[:, None] * self.normal_enu

    def normals_at(self, st_m: Array) -> Array:
        """Outward unit normals, shape (n, 3)."""
        angle = self.curvature_per_m * np.atleast_2d(np.asarray(st_m, float))[:, 0]
        return np.cos(angle)[:, None] * self.normal_enu + np.sin(angle)[:, None] * self.right_enu

    def hits(self, origins_enu_m: Array, directions_enu: Array) -> Array:
        """Where rays from outside first enter the surface, as surface coordinates, shape (n, 2); NaN where they miss.

        Parameters
        ----------
        origins_enu_m, directions_enu
            Shape (n, 3) each; directions of any length. Rays that start behind the surface miss.
        """
        distance = self.distances(origins_enu_m, directions_enu)
        return self.to_surface(origins_enu_m + distance[:, None] * directions_enu)

    def distances(self, origins_enu_m: Array, directions_enu: Array) -> Array:
        """Distances along rays to where they first enter the surface, in lengths of their directions, shape (n,).

        The surface is where k (x^2 + z^2) + 2 z = 0 in the anchor's frame; a ray makes that a quadratic equation
        a l^2 + 2 b l + c = 0, of which the root is wanted where the left side turns from positive to negative. It is
        written so that nothing cancels, however flat the surface is.
        """
        x, _, z = self._local(origins_enu_m)
        directions = np.atleast_2d(np.asarray(directions_enu, float))
        u, w = directions @ self.right_enu, directions @ self.normal_enu
        k = self.curvature_per_m
        a = k * (u * u + w * w)
        b = k * (x * u + z * w) + w
        c = k * (x * x + z * z) + 2.0 * z
        with np.errstate(divide="ignore", invalid="ignore"):
            root = np.sqrt(b * b - a * c)
            distance = np.where(b <= 0.0, c / (root - b), -(b + root) / a)
        return np.where((c > 0.0) & (distance > 0.0) & np.isfinite(distance), distance, np.nan)

    def _local(self, points_enu_m: Array) -> tuple[Array, Array, Array]:
        offset = np.atleast_2d(np.asarray(points_enu_m, float)) - self.anchor_enu_m
        return offset @ self.right_enu, offset @ self.up_enu, offset @ self.normal_enu
