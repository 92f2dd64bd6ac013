"""Fronto-parallel view of a plane from its two vanishing points, for photos without a pose.

With a focal length the view shows true proportions. Without one it is found from the vanishing points, which belong to
directions at a right angle; where they are too far away for that, a usual lens is assumed and proportions are only
roughly true, which the search for grid lines does not need.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError

Array = NDArray[np.float64]

USUAL_FOCAL = 0.8
"""Focal length over the picture's longer side, of a lens of 28 mm on 36 mm, the usual of cameras on drones."""

FOCAL_RANGE = (0.3, 10.0)
"""Believable focal lengths found from vanishing points, of the longer side."""

MOST_STRETCHED = 4.0
"""Enlargement, as a length, of the farthest part of a facade against its middle: beyond it there is nothing to see."""

EDGE_ON = 0.02
"""Depth of the region's middle, of its deepest part, below which the plane is seen from its edge."""

MAX_SIDE_PX = 8192


@dataclass(frozen=True, slots=True, eq=False)
class VanishingView:
    """A homography between photo and rectified picture.

    Parameters
    ----------
    rectified_from_photo
        Shape (3, 3), for continuous pixel coordinates; positive third coordinate where the plane is in front.
    focal_px
        That was used; 0 with `is_metric` False means proportions are assumed.
    """

    width_px: int
    height_px: int
    rectified_from_photo: Array
    focal_px: float
    is_metric: bool

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture; NaN beyond the plane's horizon."""
        return _mapped(self.rectified_from_photo, points_px)

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo; NaN behind the camera."""
        return _mapped(np.asarray(np.linalg.inv(self.rectified_from_photo), float), points_px)


def vanishing_view(
    horizontal: Array,
    vertical: Array,
    width_px: int,
    height_px: int,
    focal_px: float | None = None,
    region_px: Array | None = None,
    scale: float = 1.0,
) -> VanishingView:
    """View in which lines through either vanishing point run along rows and columns.

    Parameters
    ----------
    horizontal, vertical
        Vanishing points, homogeneous, shape (3,), in continuous pixel coordinates; at infinity the last number is 0.
    width_px, height_px
        Of the photo, whose principal point is taken to be its middle.
    focal_px
        If it is known.
    region_px
        Outline of the facade in the photo, shape (n, 2); without it the whole photo.
    scale
        Rectified pixels per photo pixel in the middle of the region.

    Raises
    ------
    InfeasibleError
        The two vanishing points are the same, or the region lies on the plane's horizon.
    """
    middle = np.array([0.5 * width_px, 0.5 * height_px])
    longer = float(max(width_px, height_px))
    h, v = _normalised(horizontal, middle, longer), _normalised(vertical, middle, longer)
    found = None if focal_px is None else focal_px / longer
    is_metric = found is not None
    if found is None:
        found, is_metric = _focal(h, v)
    right, down = _directions(h, v, found)
    rotation = np.stack([right, down, np.cross(right, down)])
    k = np.array([[found * longer, 0.0, middle[0]], [0.0, found * longer, middle[1]], [0.0, 0.0, 1.0]])
    homography = rotation @ np.linalg.inv(k)
    region = _whole(width_px, height_px) if region_px is None else np.asarray(region_px, float)
    return _windowed(homography, region, found * longer, is_metric, scale)


def _normalised(point: Array, middle: Array, longer: float) -> Array:
    """Homogeneous point in units of the longer side around the middle, unit length."""
    p = np.asarray(point, float)
    if p.shape != (3,) or not np.isfinite(p).all() or not np.abs(p).max() > 0.0:
        raise ValueError("expected a homogeneous point of shape (3,), finite and not all zero")
    p = p / np.abs(p).max()
    moved = np.array([(p[0] - middle[0] * p[2]) / longer, (p[1] - middle[1] * p[2]) / longer, p[2]])
    return np.asarray(moved / np.linalg.norm(moved), float)


def _focal(h: Array, v: Array) -> tuple[float, bool]:
    """Focal length over the longer side from f^2 = -(h . v) for finite points at right angles, or the usual one."""
    weight = h[2] * v[2]
    squared = -(h[0] * v[0] + h[1] * v[1]) / weight if abs(weight) > 1e-9 else math.inf
    if FOCAL_RANGE[0] ** 2 < squared < FOCAL_RANGE[1] ** 2:
        return math.sqrt(squared), True
    return USUAL_FOCAL, False


def _directions(h: Array, v: Array, focal: float) -> tuple[Array, Array]:
    """Unit directions right and down, exactly at right angles, that are nearest to those of the vanishing points."""
    lens = np.array([1.0 / focal, 1.0 / focal, 1.0])
    right, down = h * lens, v * lens
    right, down = right / np.linalg.norm(right), down / np.linalg.norm(down)
    right = right if right[0] >= 0.0 else -right
    down = down if down[1] >= 0.0 else -down
    if np.linalg.norm(np.cross(right, down)) < 0.1:
        raise InfeasibleError("the two vanishing points are nearly the same: this is not a plane seen from its front")
    plus, minus = right + down, right - down
    plus, minus = plus / np.linalg.norm(plus), minus / np.linalg.norm(minus)
    return (plus + minus) / math.sqrt(2.0), (plus - minus) / math.sqrt(2.0)


def _whole(width_px: int, height_px: int) -> Array:
    x = np.array([0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.5]) * width_px
    y = np.array([0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.5]) * height_px
    return np.column_stack([x, y])


def _windowed(homography: Array, region: Array, focal_px: float, is_metric: bool, scale: float) -> VanishingView:
    """Shift and scale so that the region fills the picture; what is stretched too far is left out."""
    middle = region.mean(axis=0)
    depths = region @ homography[2, :2] + homography[2, 2]
    depth = float(middle @ homography[2, :2] + homography[2, 2])
    if depth <= EDGE_ON * float(np.abs(depths).max()):
        raise InfeasibleError(
            "the facade's horizon runs through its middle: it is seen edge-on, or the lines are wrong"
        )
    usable = _clipped(homography, region, depth / MOST_STRETCHED)
    points = _mapped(homography, usable)
    low, high = points.min(axis=0), points.max(axis=0)
    across = math.sqrt(abs(float(np.linalg.det(homography))) / depth**3)
    density = min(scale / across, MAX_SIDE_PX / float((high - low).max()))
    shift = np.array([[density, 0.0, -density * low[0]], [0.0, density, -density * low[1]], [0.0, 0.0, 1.0]])
    width, height = (max(1, math.ceil(side)) for side in (high - low) * density)
    return VanishingView(width, height, shift @ homography, focal_px, is_metric)


def _clipped(homography: Array, region: Array, least_depth: float) -> Array:
    """Outline of the region's part at least that deep (Sutherland and Hodgman's clipping at one line)."""
    depth = region @ homography[2, :2] + homography[2, 2]
    kept = []
    for index in range(len(region)):
        other = (index + 1) % len(region)
        if depth[index] >= least_depth:
            kept.append(region[index])
        if (depth[index] >= least_depth) != (depth[other] >= least_depth):
            share = (least_depth - depth[index]) / (depth[other] - depth[index])
            kept.append(region[index] + share * (region[other] - region[index]))
    return np.array(kept)


def _mapped(homography: Array, points_px: Array) -> Array:
    points = np.atleast_2d(np.asarray(points_px, float))
    mapped = points @ homography[:, :2].T + homography[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(mapped[:, 2:] > 0.0, mapped[:, :2] / mapped[:, 2:], np.nan)
