"""Photos out of focus: a lens sees each thing from all over its pupil, and brings its views together at one depth.

A thin lens focused at s is a heap of pinholes all over its pupil, each with its picture shifted so that what lies at s
falls on the same pixel (Potmesil and Chakravarty, 1981; Cook, Porter and Carpenter, 1984). A pinhole moved by x along
the picture's axis shifts what lies at depth d by f x / d, and its principal point goes the other way by f x / s; over a
pupil of diameter A that leaves the circle of confusion f A |1 / d - 1 / s|. Mirror images are in focus where they lie,
behind the pane, since each pinhole sends its rays by itself.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto

if TYPE_CHECKING:
    from reconstruction.scenes.photos.renderer import RenderedPhoto

Array = NDArray[np.float64]

MM_PER_M = 1000.0

LEAST_PLACES, MOST_PLACES = 4, 32
"""Of a pupil. Each costs a picture."""

GOLDEN_RAD = math.pi * (3.0 - math.sqrt(5.0))


@dataclass(frozen=True, slots=True)
class ThinLens:
    """A pupil and a focus.

    Parameters
    ----------
    pupil_mm
        Diameter of the entrance pupil: focal length over f-number.
    focus_m
        Depth that is sharp; may be infinite.
    """

    pupil_mm: float
    focus_m: float = math.inf

    def circle_px(self, depth_m: Array, focal_px: Array | float) -> Array:
        """Diameter of the circle of confusion at depths along the optical axis, which may be infinite."""
        away = 1.0 / np.asarray(depth_m, np.float64) - 1.0 / self.focus_m
        return np.asarray(self.pupil_mm / MM_PER_M * focal_px * np.abs(away))


def n_places(circle_px: float) -> int:
    """Places of the pupil that a circle of confusion needs, so that they lie a pixel apart in the picture."""
    return int(np.clip(math.ceil(math.pi / 4.0 * circle_px**2), LEAST_PLACES, MOST_PLACES))


def pupil_places(n: int) -> Array:
    """Places evenly over a disc of diameter 1, shape (n, 2), their mean in its middle (H. Vogel, 1979)."""
    number = np.arange(n)
    radius, angle = 0.5 * np.sqrt((number + 0.5) / n), GOLDEN_RAD * number
    places = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return np.asarray(places - places.mean(axis=0))


def pinholes(photo: PosedPhoto, lens: ThinLens, n: int) -> Iterator[PosedPhoto]:
    """The photo from places of the pupil, its picture shifted so that what is in focus stays where it is."""
    intrinsics = photo.intrinsics
    right, down = photo.pose.cam_from_enu[:2]
    for x, y in lens.pupil_mm / MM_PER_M * pupil_places(n):
        shifted = replace(
            intrinsics,
            cx_px=intrinsics.cx_px + intrinsics.fx_px * x / lens.focus_m,
            cy_px=intrinsics.cy_px + intrinsics.fy_px * y / lens.focus_m,
        )
        position = photo.pose.position_enu_m + x * right + y * down
        yield replace(photo, intrinsics=shifted, pose=replace(photo.pose, position_enu_m=position))


def out_of_focus(photo: PosedPhoto, lens: ThinLens, take: Callable[[PosedPhoto], RenderedPhoto]) -> RenderedPhoto:
    """A photo by a lens: the mean light of its pinholes, and what is true of pixels from the middle of the pupil.

    Parameters
    ----------
    take
        Takes a photo without a pupil.
    """
    middle = take(photo)
    # What glass mirrors may lie as far as the sky.
    farthest = [math.inf] if middle.is_glass.any() else []
    depths_m = np.append(middle.depth_m.astype(np.float64), farthest)
    n = n_places(float(lens.circle_px(depths_m, photo.intrinsics.fx_px).max(initial=0.0)))
    light = [np.zeros(middle.linear.shape, np.float64) for _ in range(3)]
    for pinhole in pinholes(photo, lens, n):
        one = take(pinhole)
        for total, part in zip(light, (one.linear, one.diffuse, one.reflection), strict=True):
            total += part
    linear, diffuse, reflection = (np.asarray(total / n, np.float32) for total in light)
    return replace(middle, linear=linear, diffuse=diffuse, reflection=reflection)
