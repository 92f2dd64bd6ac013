"""Cameras of photos: intrinsics with Brown's distortion or of a fisheye, poses with covariance, projection and rays.

Pixel coordinates are continuous, x to the right and y down: a picture covers [0, width] x [0, height], and the centre
of its first pixel is (0.5, 0.5), as in COLMAP. OpenCV counts from that centre instead: its coordinates are ours minus
0.5.
Camera axes are x right, y down, z forward.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import camera_axes, wrap_heading_deg
from planning.plan import Camera, Viewpoint

Array = NDArray[np.float64]

LOCKED = 1e-6
"""Horizontal part of a line of sight below which heading and roll turn the picture alike; roll is 0 then."""

UNDISTORT_STEPS = 50
UNDISTORT_TOLERANCE = 1e-12
"""Of the fixed-point iteration that takes Brown's distortion away, normalised image units."""

WIDENED = 1.5
"""How far outside the picture Brown's polynomial is still used, of half the picture."""

STRAIGHT = (0.0, 0.0, 0.0, 0.0, 0.0)

STRAIGHT_HALF_DEG = 55.0
"""From the optical axis along rows and columns, up to where a fisheye's picture is made straight: a pixel of the photo
fills four and a half there, and ever more farther out, without showing more."""

FISHEYE_STEPS, FISHEYE_ANGLES = 5, 2048
"""Of Newton's iteration that takes a fisheye's distortion away, and angles that it starts from: each step doubles the
right digits, and neighbouring angles are 0.0015 rad apart."""


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """A camera with Brown's distortion (D. C. Brown, 1971) in OpenCV's order, or a fisheye's.

    Parameters
    ----------
    fx_px, fy_px, cx_px, cy_px
        Focal lengths and principal point in the continuous pixel coordinates of this module.
    distortion
        k1, k2, p1, p2, k3; all 0 for a picture that is straight, and of a fisheye.
    fisheye
        k1, k2, k3, k4 of a fisheye (J. Kannala and S. S. Brandt, 2006, Eq. 6, in OpenCV's form): what is seen at the
        angle theta from the axis lies theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) focal lengths from
        the principal point. None for other lenses.
    """

    width_px: int
    height_px: int
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    distortion: tuple[float, float, float, float, float] = STRAIGHT
    fisheye: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        if self.width_px < 1 or self.height_px < 1:
            raise ValueError(f"expected a picture of at least one pixel, got {self.width_px} x {self.height_px}")
        if not all(math.isfinite(f) and f > 0.0 for f in (self.fx_px, self.fy_px)):
            raise ValueError(f"fx_px, fy_px: expected positive focal lengths, got {self.fx_px}, {self.fy_px}")
        if not all(map(math.isfinite, (self.cx_px, self.cy_px, *self.distortion, *(self.fisheye or ())))):
            raise ValueError("cx_px, cy_px, distortion, fisheye: expected finite numbers")
        if self.fisheye is not None and self.distortion != STRAIGHT:
            raise ValueError("distortion: expected 0 of a fisheye, which has numbers of its own")

    @classmethod
    def of(cls, camera: Camera) -> Intrinsics:
        """Of a planned camera: straight, principal point in the middle."""
        width, height = camera.image_width_px, camera.image_height_px
        f = camera.focal_length_mm
        return cls(
            width,
            height,
            f * width / camera.sensor_width_mm,
            f * height / camera.sensor_height_mm,
            width / 2,
            height / 2,
        )

    @property
    def is_straight(self) -> bool:
        """Whether straight lines are straight in the picture."""
        return self.fisheye is None and self.distortion == STRAIGHT

    @property
    def _reach_x(self) -> float:
        return max(self.cx_px, self.width_px - self.cx_px) / self.fx_px

    @property
    def _reach_y(self) -> float:
        return max(self.cy_px, self.height_px - self.cy_px) / self.fy_px

    @property
    def matrix(self) -> Array:
        """K, shape (3, 3), for the continuous pixel coordinates."""
        return np.array([[self.fx_px, 0.0, self.cx_px], [0.0, self.fy_px, self.cy_px], [0.0, 0.0, 1.0]])

    def scaled(self, width_px: int, height_px: int) -> Intrinsics:
        """Of the same picture resized to `width_px` x `height_px`."""
        x, y = width_px / self.width_px, height_px / self.height_px
        return replace(
            self,
            width_px=width_px,
            height_px=height_px,
            fx_px=self.fx_px * x,
            fy_px=self.fy_px * y,
            cx_px=self.cx_px * x,
            cy_px=self.cy_px * y,
        )

    def straight(self) -> Intrinsics:
        """Of the picture after its distortion was taken away.

        A fisheye's has the same scale in the middle, and reaches to each side as far as the photo does, at most
        `STRAIGHT_HALF_DEG` from the axis.
        """
        if self.fisheye is None:
            return replace(self, distortion=STRAIGHT)
        across, down = (self.cx_px, self.width_px - self.cx_px), (self.cy_px, self.height_px - self.cy_px)
        extents = [*((extent, self.fx_px) for extent in across), *((extent, self.fy_px) for extent in down)]
        most = math.radians(STRAIGHT_HALF_DEG)
        angles = self._fisheye_angles(np.array([abs(extent) / focal for extent, focal in extents]))
        left, right, top, bottom = (
            math.copysign(focal * math.tan(min(angle, most)), extent)
            for angle, (extent, focal) in zip(angles.tolist(), extents, strict=True)
        )
        width, height = max(1, round(left + right)), max(1, round(top + bottom))
        return Intrinsics(width, height, self.fx_px, self.fy_px, left, top)

    def pixels(self, points_cam: Array) -> Array:
        """Project points, shape (n, 3), in camera axes to pixels, shape (n, 2); NaN for points not in front.

        NaN, too, for points outside the field of view widened by half where the picture is distorted: the polynomial
        was fitted inside, and folds points back into the picture from far outside. A fisheye sees points behind the
        camera's plane, too, up to where its polynomial folds.
        """
        points = np.atleast_2d(np.asarray(points_cam, float))
        if self.fisheye is not None:
            return self._fisheye_pixels(points)
        z = points[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y = points[:, 0] / z, points[:, 1] / z
            is_in_front = z > 0.0
            if not self.is_straight:
                is_in_front &= (np.abs(x) <= WIDENED * self._reach_x) & (np.abs(y) <= WIDENED * self._reach_y)
        x, y = np.where(is_in_front, x, np.nan), np.where(is_in_front, y, np.nan)
        if not self.is_straight:
            x, y = self._distorted(x, y)
        return np.column_stack([self.fx_px * x + self.cx_px, self.fy_px * y + self.cy_px])

    def is_seen(self, points_cam: Array) -> NDArray[np.bool_]:
        """Whether points, shape (n, 3), lie in front of the camera and inside the picture, shape (n,)."""
        pixels = self.pixels(points_cam)
        with np.errstate(invalid="ignore"):
            return np.asarray(((pixels >= 0.0) & (pixels <= (self.width_px, self.height_px))).all(axis=1))

    def rays(self, pixels: Array) -> Array:
        """Directions, shape (n, 3), camera axes, that fall on pixels, shape (n, 2).

        They have z = 1; those of a fisheye, which may look backwards, have the length 1, and pixels farther out than
        its polynomial reaches show what is seen where it ends.
        """
        points = np.atleast_2d(np.asarray(pixels, float))
        x, y = (points[:, 0] - self.cx_px) / self.fx_px, (points[:, 1] - self.cy_px) / self.fy_px
        if self.fisheye is not None:
            radius = np.hypot(x, y)
            angles = self._fisheye_angles(radius)
            across = np.divide(np.sin(angles), radius, out=np.ones_like(radius), where=radius > 0.0)
            return np.column_stack([x * across, y * across, np.cos(angles)])
        if not self.is_straight and len(points):  # OpenCV gives nothing back for no points
            criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, UNDISTORT_STEPS, UNDISTORT_TOLERANCE)
            seen = np.column_stack([x, y]).reshape(-1, 1, 2)
            straight = np.asarray(
                cv2.undistortPoints(seen, np.eye(3), np.array(self.distortion), criteria=criteria), float
            )
            x, y = straight[:, 0, 0], straight[:, 0, 1]
        return np.column_stack([x, y, np.ones_like(x)])

    def _distorted(self, x: Array, y: Array) -> tuple[Array, Array]:
        k1, k2, p1, p2, k3 = self.distortion
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        return (
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        )

    def _fisheye_pixels(self, points_cam: Array) -> Array:
        x, y, z = points_cam.T
        across = np.hypot(x, y)
        angles = np.arctan2(across, z)
        radii = np.where(angles < self.fisheye_reach_rad, self._fisheye_radii(angles)[0], np.nan)
        # Along the axis, where there is no direction across, both are 0.
        share = np.divide(radii, across, out=np.where(z > 0.0, 0.0, np.nan), where=across > 0.0)
        return np.column_stack([self.fx_px * share * x + self.cx_px, self.fy_px * share * y + self.cy_px])

    @property
    def fisheye_reach_rad(self) -> float:
        """Angle from the axis up to which a fisheye's polynomial grows; pi where it does not fold."""
        angles = np.linspace(0.0, math.pi, FISHEYE_ANGLES)
        falls = np.flatnonzero(self._fisheye_radii(angles)[1] <= 0.0)
        return float(angles[max(0, falls[0] - 1)]) if len(falls) else math.pi

    def _fisheye_radii(self, angles: Array) -> tuple[Array, Array]:
        """Distances from the principal point, in focal lengths, of what is seen at angles, and their derivatives."""
        k1, k2, k3, k4 = self.fisheye or (0.0, 0.0, 0.0, 0.0)
        t2 = angles * angles
        radii = angles * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
        return radii, 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))

    def _fisheye_angles(self, radii: Array) -> Array:
        """The inverse, up to where the polynomial folds."""
        reach = self.fisheye_reach_rad
        table = np.linspace(0.0, reach, FISHEYE_ANGLES)
        known = self._fisheye_radii(table)[0]
        radii = np.minimum(radii, known[-1])
        angles = np.interp(radii, known, table)
        for _ in range(FISHEYE_STEPS):
            found, slopes = self._fisheye_radii(angles)
            angles = np.clip(angles - (found - radii) / np.maximum(slopes, 1e-6), 0.0, reach)
        return np.asarray(angles)


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Where a camera is and how it is turned.

    Parameters
    ----------
    position_enu_m
        Optical centre, shape (3,), local frame.
    cam_from_enu
        Rotation, shape (3, 3): points_cam = cam_from_enu @ (points_enu - position).
    covariance
        Shape (6, 6) or None where nothing is known: of the position (m, ENU) and of a small rotation vector (rad) in
        camera axes, applied on the left: exp(w) cam_from_enu.
    """

    position_enu_m: Array
    cam_from_enu: Array
    covariance: Array | None = None

    def __post_init__(self) -> None:
        if self.position_enu_m.shape != (3,) or self.cam_from_enu.shape != (3, 3):
            raise ValueError(
                f"expected a position of shape (3,) and a rotation of shape (3, 3), got {self.position_enu_m.shape} "
                f"and {self.cam_from_enu.shape}"
            )
        if not np.allclose(self.cam_from_enu @ self.cam_from_enu.T, np.eye(3), atol=1e-6):
            raise ValueError("cam_from_enu: expected a rotation")
        if self.covariance is not None and self.covariance.shape != (6, 6):
            raise ValueError(f"covariance: expected shape (6, 6), got {self.covariance.shape}")

    @classmethod
    def looking(
        cls,
        position_enu_m: Array,
        heading_deg: float,
        pitch_deg: float,
        roll_deg: float = 0.0,
        covariance: Array | None = None,
    ) -> Pose:
        """Camera at a heading (clockwise from north) and pitch (0 level, positive up); roll turns it clockwise."""
        rotation = cam_from_enu(heading_deg, pitch_deg, roll_deg)
        return cls(np.asarray(position_enu_m, float), rotation, covariance)

    @classmethod
    def of(cls, view: Viewpoint) -> Pose:
        """Of a planned viewpoint."""
        return cls.looking(np.array(view.position_enu_m), view.heading_deg, view.gimbal_pitch_deg)

    @property
    def forward_enu(self) -> Array:
        """Unit vector along the optical axis, shape (3,)."""
        return np.array(self.cam_from_enu[2])

    @property
    def angles_deg(self) -> tuple[float, float, float]:
        """Heading (clockwise from north, in (-180, 180]), pitch (0 level, -90 straight down) and roll of `looking`.

        The roll is within 90 degrees: a gimbal that swung through the vertical has a pitch below -90. Straight up or
        down the roll is 0, and the heading that of the picture's upper edge.
        """
        right, down, forward = self.cam_from_enu
        level = math.hypot(forward[0], forward[1])
        if level < LOCKED:
            heading, pitch, roll = math.atan2(-right[1], right[0]), math.copysign(math.pi / 2.0, forward[2]), 0.0
        else:
            heading, pitch = math.atan2(forward[0], forward[1]), math.atan2(forward[2], level)
            # The right vector against the level one, (cos h, -sin h, 0), in the plane of the picture.
            roll = math.atan2(-right[2], -down[2])
        if abs(roll) > math.pi / 2.0:
            heading, roll = heading + math.pi, roll - math.copysign(math.pi, roll)
            pitch = math.copysign(math.pi, pitch) - pitch
        return wrap_heading_deg(math.degrees(heading)), math.degrees(pitch), math.degrees(roll)

    @property
    def heading_deg(self) -> float:
        """Clockwise from north, in (-180, 180]; where the camera looks straight up or down, that of its upper edge."""
        return self.angles_deg[0]

    @property
    def pitch_deg(self) -> float:
        """0 level, -90 straight down; beyond it where the gimbal swung through the vertical."""
        return self.angles_deg[1]

    def points_cam(self, points_enu_m: Array) -> Array:
        """Points, shape (n, 3), in camera axes."""
        # Sums by column: for three numbers a row, a library's product takes ten times as long.
        x, y, z = (np.atleast_2d(points_enu_m) - self.position_enu_m).T
        found = np.empty((len(x), 3))
        for axis, (a, b, c) in enumerate(self.cam_from_enu):
            found[:, axis] = a * x + b * y + c * z
        return found

    def directions_enu(self, rays_cam: Array) -> Array:
        """Directions, shape (n, 3), camera axes to ENU; the length stays."""
        return np.asarray(rays_cam @ self.cam_from_enu)


def cam_from_enu(heading_deg: float, pitch_deg: float, roll_deg: float = 0.0) -> Array:
    """Rotation, shape (3, 3), of a camera; with roll, the camera is turned clockwise as seen from behind it."""
    forward, right, up = camera_axes(math.radians(heading_deg), math.radians(pitch_deg))
    level = np.stack([right, -up, forward])
    c, s = math.cos(math.radians(roll_deg)), math.sin(math.radians(roll_deg))
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ level


@dataclass(frozen=True, slots=True, eq=False)
class PosedPhoto:
    """A photo with its camera.

    Parameters
    ----------
    name
        Unique in its set: the path below the folder of photos, with slashes.
    mask
        File of a grey picture that is black where the photo does not count; None where all of it does.
    """

    name: str
    path: Path
    intrinsics: Intrinsics
    pose: Pose
    taken_at: datetime | None = None
    mask: Path | None = None

    def pixels(self, points_enu_m: Array) -> Array:
        """Project points, shape (n, 3), to pixels, shape (n, 2); NaN for points not in front (Eq. 1 of the paper)."""
        return self.intrinsics.pixels(self.pose.points_cam(points_enu_m))

    def sees(self, points_enu_m: Array) -> NDArray[np.bool_]:
        """Whether points, shape (n, 3), fall inside the picture, nothing being in the way, shape (n,)."""
        return self.intrinsics.is_seen(self.pose.points_cam(points_enu_m))

    def rays(self, pixels: Array) -> tuple[Array, Array]:
        """Origins and unit directions, each shape (n, 3), ENU, of the rays through pixels, shape (n, 2)."""
        directions = self.pose.directions_enu(self.intrinsics.rays(pixels))
        directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
        return np.broadcast_to(self.pose.position_enu_m, directions.shape), directions
