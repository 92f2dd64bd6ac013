"""The camera of a 3-D view: where it looks from, how it is moved, and points to pixels and back.

The camera is described by angles and not by an up vector, so that straight down is a view like any other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import Vec3, aim, camera_axes, wrap_heading_deg
from planning.plan import Camera

Array = NDArray[np.float64]


# From points in space to pixels and back: a pinhole camera on a picture of a given size.
#
# Pixels are counted from the upper left corner of the picture, x to the right and y down, with (0, 0) at the corner
# itself and not in the middle of the first pixel. With v the vector from the eye to a point,
#
#     x = width / 2 (1 + right . v / (half_width forward . v)),
#     y = height / 2 (1 - up . v / (half_height forward . v)).

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


VIEW_ANGLE_DEG = 30.0
"""Vertical angle of view: narrow enough that parallel edges of a tower still look parallel."""

NEAREST_M, FARTHEST_M = 0.5, 20_000.0
"""Limits of the distance to the focus: below, the eye is inside the glass; above, float32 depths are coarse."""

FIT_MARGIN = 1.12
"""Room left around what is brought into view."""


@dataclass(frozen=True, slots=True)
class Orbit:
    """A camera at `distance_m` from its focus, looking at it along a heading and a pitch (degrees, ENU)."""

    focus_enu_m: Vec3 = (0.0, 0.0, 0.0)
    distance_m: float = 200.0
    heading_deg: float = 0.0
    pitch_deg: float = -25.0

    def __post_init__(self) -> None:
        values = (*self.focus_enu_m, self.distance_m, self.heading_deg, self.pitch_deg)
        if not all(math.isfinite(value) for value in values):
            raise ValueError(f"expected finite numbers, got {values}")
        if not NEAREST_M <= self.distance_m <= FARTHEST_M:
            raise ValueError(f"distance_m: expected {NEAREST_M} to {FARTHEST_M}, got {self.distance_m}")
        if not -90.0 <= self.pitch_deg <= 90.0:
            raise ValueError(f"pitch_deg: expected -90 to 90, got {self.pitch_deg}")

    @property
    def eye_enu_m(self) -> Array:
        """Place of the camera, shape (3,)."""
        forward, _, _ = camera_axes(math.radians(self.heading_deg), math.radians(self.pitch_deg))
        return np.asarray(np.array(self.focus_enu_m) - self.distance_m * forward)

    def pinhole(self, width_px: float, height_px: float) -> Pinhole:
        """Projection onto a picture of this size."""
        half_height = math.tan(math.radians(0.5 * VIEW_ANGLE_DEG))
        half = (half_height * width_px / height_px, half_height)
        heading, pitch = math.radians(self.heading_deg), math.radians(self.pitch_deg)
        return pinhole_at(self.eye_enu_m, heading, pitch, half, (width_px, height_px))

    def turned(self, right_deg: float, up_deg: float) -> Orbit:
        """Orbited around the focus: the eye moves right and up."""
        return replace(
            self,
            heading_deg=wrap_heading_deg(self.heading_deg - right_deg),
            pitch_deg=min(90.0, max(-90.0, self.pitch_deg - up_deg)),
        )

    def shifted(self, right_m: float, up_m: float) -> Orbit:
        """Eye and focus moved together in the plane of the picture."""
        _, right, up = camera_axes(math.radians(self.heading_deg), math.radians(self.pitch_deg))
        return self.towards_point(np.array(self.focus_enu_m) + right_m * right + up_m * up)

    def towards_point(self, focus_enu_m: Array) -> Orbit:
        """Same direction and distance, another focus, shape (3,)."""
        x, y, z = (float(value) for value in focus_enu_m)
        return replace(self, focus_enu_m=(x, y, z))

    def zoomed(self, factor: float, anchor_enu_m: Array | None = None) -> Orbit:
        """Nearer by a factor above 1, farther below; a point given as anchor, shape (3,), keeps its pixel."""
        distance = min(FARTHEST_M, max(NEAREST_M, self.distance_m / factor))
        near = replace(self, distance_m=distance)
        if anchor_enu_m is None:
            return near
        kept = distance / self.distance_m
        return near.towards_point(anchor_enu_m + kept * (np.array(self.focus_enu_m) - anchor_enu_m))

    def fitted(self, points_enu_m: Array, aspect: float) -> Orbit:
        """Same direction, moved so that all points, shape (n, 3), are in a picture of width / height `aspect`."""
        if len(points_enu_m) == 0:
            return self
        forward, right, up = camera_axes(math.radians(self.heading_deg), math.radians(self.pitch_deg))
        low, high = points_enu_m.min(axis=0), points_enu_m.max(axis=0)
        centre = 0.5 * (low + high)
        half_height = math.tan(math.radians(0.5 * VIEW_ANGLE_DEG)) / FIT_MARGIN
        v = points_enu_m - centre
        # Distance at which each point comes to the picture's border; the farthest of them shows all.
        across = np.abs(v @ right) / (half_height * aspect) - v @ forward
        along = np.abs(v @ up) / half_height - v @ forward
        distance = max(float(across.max()), float(along.max()), 4.0)
        return replace(self.towards_point(centre), distance_m=min(FARTHEST_M, distance))


def facing(normal: Array, points_enu_m: Array, aspect: float, aside_deg: float = 0.0, above_deg: float = 0.0) -> Orbit:
    """View onto a surface from its front.

    Parameters
    ----------
    normal
        Shape (3,), outward, any length; zero looks north.
    points_enu_m
        What has to be in view, shape (n, 3).
    aside_deg, above_deg
        How far the eye stands to the right of the normal, and above it.
    """
    length = float(np.linalg.norm(normal))
    heading, pitch = aim(-normal) if length > 0.0 else (np.float64(0.0), np.float64(0.0))
    pitch_deg = math.degrees(float(pitch)) - above_deg
    turned = Orbit(
        heading_deg=wrap_heading_deg(math.degrees(float(heading)) - aside_deg),
        pitch_deg=min(90.0, max(-90.0, pitch_deg)),
    )
    return turned.fitted(points_enu_m, aspect)


DEG_PER_PX = 0.35
"""A drag across a 1000 px wide view turns it once around."""


def turned_by_drag(orbit: Orbit, dx_px: float, dy_px: float) -> Orbit:
    """Turned as if the scene were taken hold of: dragging right brings its left side forward."""
    return orbit.turned(-DEG_PER_PX * dx_px, DEG_PER_PX * dy_px)


def shifted_by_drag(orbit: Orbit, view: Pinhole, dx_px: float, dy_px: float) -> Orbit:
    """Shifted so that the focus follows the pointer."""
    scale = view.metres_per_px(orbit.distance_m)
    return orbit.shifted(-scale * dx_px, scale * dy_px)
