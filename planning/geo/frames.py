"""Local frame, headings and camera axes.

The local frame is ENU: x east, y north, z up, metres. Heading is clockwise from true north; gimbal pitch is 0 at the
horizon, negative downwards. At heading h and pitch p the camera axes are

    forward = (cos p sin h, cos p cos h, sin p),   right = (cos h, -sin h, 0),   up = right x forward.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planning.base.messages import say

Vec3 = tuple[float, float, float]
"""One point or vector of the local ENU frame, metres."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Angles:
    """Of the airframe or of the camera: heading clockwise from north in (-pi, pi], pitch nose or lens up."""

    heading_rad: float
    pitch_rad: float
    roll_rad: float


@dataclass(frozen=True, slots=True)
class Origin:
    """Where the local frame's origin lies: WGS 84 geodetic, height above the ellipsoid."""

    lat_deg: float
    lon_deg: float
    ellipsoid_height_m: float

    def __post_init__(self) -> None:
        if not -90.0 <= self.lat_deg <= 90.0:
            raise ValueError(say("expected -90 to 90, got {}", self.lat_deg, place="lat_deg"))
        if not -180.0 <= self.lon_deg <= 180.0:
            raise ValueError(say("expected -180 to 180, got {}", self.lon_deg, place="lon_deg"))
        if not -1000.0 <= self.ellipsoid_height_m <= 10_000.0:
            raise ValueError(
                say("expected -1000 to 10000, got {}", self.ellipsoid_height_m, place="ellipsoid_height_m")
            )


def wrap_heading_rad(heading_rad: Array) -> Array:
    """Same headings, shape as given, in (-pi, pi]."""
    wrapped = np.remainder(heading_rad, 2.0 * math.pi)
    return np.where(wrapped > math.pi, wrapped - 2.0 * math.pi, wrapped)


def wrap_heading_deg(heading_deg: float) -> float:
    """Same heading in (-180, 180] degrees."""
    wrapped = math.fmod(heading_deg, 360.0)
    if wrapped > 180.0:
        return wrapped - 360.0
    return wrapped + 360.0 if wrapped <= -180.0 else wrapped


def heading_difference_rad(from_rad: ArrayLike, to_rad: ArrayLike) -> Array:
    """Shortest signed turn from one heading to another, broadcast shape, in (-pi, pi]."""
    return wrap_heading_rad(np.asarray(to_rad, float) - np.asarray(from_rad, float))


def camera_axes(heading_rad: ArrayLike, pitch_rad: ArrayLike) -> tuple[Array, Array, Array]:
    """Forward, right and up unit vectors, each shape (..., 3), ENU."""
    heading, pitch = np.broadcast_arrays(np.asarray(heading_rad, float), np.asarray(pitch_rad, float))
    sin_h, cos_h, sin_p, cos_p = np.sin(heading), np.cos(heading), np.sin(pitch), np.cos(pitch)
    forward = np.stack([cos_p * sin_h, cos_p * cos_h, sin_p], axis=-1)
    right = np.stack([cos_h, -sin_h, np.zeros_like(sin_h)], axis=-1)
    up = np.stack([-sin_p * sin_h, -sin_p * cos_h, cos_p], axis=-1)
    return forward, right, up


def aim(direction: ArrayLike) -> tuple[Array, Array]:
    """Heading and pitch that look along `direction`.

    Parameters
    ----------
    direction
        Shape (..., 3), ENU, any length but zero.

    Returns
    -------
    heading_rad, pitch_rad
        Shape (...). Straight up or down leaves the heading open; it is then 0.
    """
    d = np.asarray(direction, float)
    horizontal = np.hypot(d[..., 0], d[..., 1])
    return np.arctan2(d[..., 0], d[..., 1]), np.arctan2(d[..., 2], horizontal)
