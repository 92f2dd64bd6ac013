"""A camera that is led through the air by hand: turned, moved, flown around; with pictures that come in time.

Poses keep their roll, so that a photo's own is where every way begins and ends. Angles are radians; to the right and up
are positive.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Pose, PosedPhoto

# How many pixels a picture may have so that it comes in time, from how long pictures took.
#
# A picture takes some time for each pixel, and some for all that the model is made of, however small it is: of a
# million splats most of it. Fewer pixels do not help there, they only look worse.

OTHER_SIZE = 1.5
"""Times as many pixels as another picture, from which on both tell what a pixel takes."""

ADDED = 0.25
"""Of the time that cannot be avoided, what pixels may add to it where it alone is too long."""


class PicturePace:
    """Learns from pictures of one model."""

    def __init__(self) -> None:
        self._last: tuple[float, float] | None = None
        self._other: tuple[float, float] | None = None

    def took(self, pixels: float, seconds: float) -> None:
        """A picture has come."""
        if self._last is not None and _differ(self._last[0], pixels):
            self._other = self._last
        self._last = float(pixels), max(0.0, float(seconds))

    def pixels_within(self, seconds: float) -> float | None:
        """That come in so many seconds, or, where none do, that add little to what all pictures take; None before any.

        May be infinite, where pictures of all sizes took equally long.
        """
        if self._last is None:
            return None
        fixed, each = self._parts()
        allowed = max(seconds - fixed, ADDED * fixed)
        return allowed / each if each > 0.0 else float("inf")

    def seconds_of(self, pixels: float) -> float:
        """That a picture will take; 0 before any."""
        if self._last is None:
            return 0.0
        fixed, each = self._parts()
        return fixed + each * pixels

    def _parts(self) -> tuple[float, float]:
        """Seconds of any picture, and of each pixel; without another size, all of it is the pixels'."""
        assert self._last is not None
        pixels, seconds = self._last
        if self._other is None or not _differ(self._other[0], pixels):
            return 0.0, seconds / pixels
        each = min(max((seconds - self._other[1]) / (pixels - self._other[0]), 0.0), seconds / pixels)
        return seconds - each * pixels, each


def _differ(one: float, other: float) -> bool:
    return max(one, other) >= OTHER_SIZE * min(one, other)


Array = NDArray[np.float64]

STEEPEST = math.sin(math.radians(89.0))
"""Of the line of sight, upwards or downwards: beyond, turning would swing the picture about."""

UPRIGHT = 1e-9
"""Of the camera's way down, upwards: that is 0 where it looks straight down."""

NEAREST_M, FARTHEST_M = 0.5, 500.0
"""Of what the camera is flown around."""


def turned(camera: PosedPhoto, right_rad: float, up_rad: float) -> PosedPhoto:
    """Look elsewhere, from the same place."""
    pose = camera.pose
    return replace(camera, pose=Pose(pose.position_enu_m, _turned(pose.cam_from_enu, right_rad, up_rad)))


def moved(camera: PosedPhoto, right_m: float, up_m: float, forward_m: float) -> PosedPhoto:
    """Go along the camera's own axes."""
    pose = camera.pose
    step = np.array([right_m, -up_m, forward_m]) @ pose.cam_from_enu
    return replace(camera, pose=Pose(pose.position_enu_m + step, pose.cam_from_enu))


def orbited(camera: PosedPhoto, distance_m: float, right_rad: float, up_rad: float) -> PosedPhoto:
    """Fly around what is `distance_m` in front: to the right, and up; it stays where it is in the picture."""
    pose = camera.pose
    distance = min(max(distance_m, NEAREST_M), FARTHEST_M)
    pivot = pose.position_enu_m + distance * pose.forward_enu
    rotation = _turned(pose.cam_from_enu, -right_rad, -up_rad)
    return replace(camera, pose=Pose(pivot - distance * rotation[2], rotation))


def sized(camera: PosedPhoto, width_px: int, height_px: int) -> PosedPhoto:
    """Without distortion, and its picture as large as fits into so many pixels."""
    lens = camera.intrinsics.straight()
    scale = min(width_px / lens.width_px, height_px / lens.height_px)
    size = max(1, round(scale * lens.width_px)), max(1, round(scale * lens.height_px))
    return replace(camera, intrinsics=lens.scaled(*size))


def _turned(cam_from_enu: Array, right_rad: float, up_rad: float) -> Array:
    """Turned about the vertical, clockwise from above, then about the camera's own axis to the right."""
    c, s = math.cos(right_rad), math.sin(right_rad)
    about_up = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    level = cam_from_enu @ about_up.T
    c, s = math.cos(up_rad), math.sin(up_rad)
    found = np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]) @ level
    is_steeper = abs(found[2, 2]) > max(STEEPEST, abs(level[2, 2]))
    is_upside_down = found[1, 2] > max(UPRIGHT, level[1, 2])
    if is_steeper or is_upside_down:
        found = level
    # Many small turns: rounding must not add up to something that is no rotation.
    left, _, right = np.linalg.svd(found)
    return np.asarray(left @ right)
