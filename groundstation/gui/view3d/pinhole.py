"""From points in space to pixels and back: a pinhole camera on a picture of a given size.

Pixels are counted from the upper left corner of the picture, x to the right and y down, with (0, 0) at the corner
itself and not in the middle of the first pixel. With v the vector from the eye to a point,

    x = width / 2 (1 + right . v / (half_width forward . v)),   y = height / 2 (1 - up . v / (half_height forward . v)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import camera_axes
from planning.plan import Camera

Array = NDArray[np.float64]

NEAREST_DEPTH_M = 1e-6
"""Points less deep are beside or behind the eye and have no pixel."""


@dataclass(frozen=True, slots=True, eq=False)
class Pinhole:
    """Eye, axes and picture.

    Parameters
    ----------
    eye_enu_m, forward, right, up
        Shape (3,); the axes are orthonormal, ENU.
    half_width, half_height
        Tangents of half the angles of view.
    width_px, height_px
        Size of the picture.
    """

    eye_enu_m: Array
    forward: Array
    right: Array
    up: Array
    half_width: float
    half_height: float
    width_px: float
    height_px: float

    def project(self, points_enu_m: Array) -> tuple[Array, Array]:
        """Pixels, shape (..., 2), and depths along the line of sight, metres, shape (...), of points (..., 3).

        Pixels of points that are not in front of the eye are NaN.
        """
        v = np.asarray(points_enu_m, np.float64) - self.eye_enu_m
        depth = v @ self.forward
        scale = np.where(depth > NEAREST_DEPTH_M, 1.0 / np.maximum(depth, NEAREST_DEPTH_M), np.nan)
        x = 0.5 * self.width_px * (1.0 + (v @ self.right) * scale / self.half_width)
        y = 0.5 * self.height_px * (1.0 - (v @ self.up) * scale / self.half_height)
        return np.stack([x, y], axis=-1), depth

    def ray(self, x_px: float, y_px: float) -> Array:
        """Unit vector from the eye through a pixel, shape (3,), ENU."""
        across = (2.0 * x_px / self.width_px - 1.0) * self.half_width
        along = (1.0 - 2.0 * y_px / self.height_px) * self.half_height
        direction = self.forward + across * self.right + along * self.up
        return np.asarray(direction / np.linalg.norm(direction))

    def metres_per_px(self, depth_m: float) -> float:
        """How far a point at a depth moves across the line of sight for one pixel."""
        return 2.0 * self.half_height * depth_m / self.height_px


def pinhole_at(
    eye_enu_m: Array,
    heading_rad: float,
    pitch_rad: float,
    half_tangents: tuple[float, float],
    size_px: tuple[float, float],
) -> Pinhole:
    """Pinhole of an eye that looks along a heading and a pitch, roll 0."""
    forward, right, up = camera_axes(heading_rad, pitch_rad)
    return Pinhole(np.asarray(eye_enu_m, np.float64), forward, right, up, *half_tangents, *size_px)


def photo_pinhole(eye_enu_m: Array, heading_rad: float, pitch_rad: float, camera: Camera, width_px: float) -> Pinhole:
    """Pinhole of a photo, shown `width_px` wide in the aspect ratio of the sensor."""
    half = (camera.half_width, camera.half_height)
    return pinhole_at(eye_enu_m, heading_rad, pitch_rad, half, (width_px, width_px * half[1] / half[0]))
