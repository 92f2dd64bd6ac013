"""Rectified views of a photo whose pose is not known: one for each direction that horizontal lines run in."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from reconstruction.rectify.vanishing_view import vanishing_view
from reconstruction.segmentation.record import Rectification
from reconstruction.segmentation.segments import Grey, find_segments, lengths
from reconstruction.segmentation.vanishing import VanishingPoint, vanishing_points
from reconstruction.segmentation.views import WholePicture

Array = NDArray[np.float64]

LEAST_LENGTH_SHARE = 0.02
"""Shortest segment that counts, as a share of the picture's longer side."""

LEAST_SHARE = 0.3
"""A second facade shows at least so much length of horizontal line against the first."""

OUTLIERS = 0.02
"""Share of a facade's segments left out on each side when its region is drawn: reflections and neighbours."""


def views_without_pose(grey: Grey, max_tilt_deg: float, long_side_px: int, seed: int = 0) -> tuple[Rectification, ...]:
    """Views of the facades in a grey photo, shape (h, w), the one with most lines first.

    The photo itself is the view where its lines run along rows and columns to `max_tilt_deg`, or tell nothing.
    """
    height, width = grey.shape
    whole = WholePicture(width, height)
    scale = min(1.0, long_side_px / max(width, height))
    size = max(1, round(width * scale)), max(1, round(height * scale))
    small = np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), np.uint8)
    segments = find_segments(small, "lsd", max(12.0, LEAST_LENGTH_SHARE * max(small.shape)))
    segments *= np.array([width / small.shape[1], height / small.shape[0]] * 2)
    points = vanishing_points(segments, width, height, seed)
    verticals = [point for point in points if point.is_vertical]
    horizontals = [point for point in points if not point.is_vertical]
    if not verticals or not horizontals:
        return (whole,)
    down = verticals[0]
    weight = lengths(segments)
    most = max(float(weight[point.members].sum()) for point in horizontals)
    chosen = [point for point in horizontals if weight[point.members].sum() >= LEAST_SHARE * most]
    if len(chosen) == 1 and _is_straight(chosen[0], down, whole, max_tilt_deg):
        return (whole,)
    views = []
    for point in chosen:
        region = None if len(chosen) == 1 else _region(segments[point.members])
        try:
            views.append(vanishing_view(point.point, down.point, width, height, region_px=region))
        except InfeasibleError:  # seen edge-on: there is no view of it
            continue
    return tuple(views) or (whole,)


def _is_straight(across: VanishingPoint, down: VanishingPoint, whole: WholePicture, max_tilt_deg: float) -> bool:
    """Whether lines to both points run along rows and columns, everywhere in the picture, up to the tilt."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) * [whole.width_px, whole.height_px]
    steep = np.tan(np.radians(max_tilt_deg))
    for axis, found in enumerate((across, down)):
        towards = found.point[:2] - found.point[2] * corners
        if (np.abs(towards[:, 1 - axis]) > steep * np.abs(towards[:, axis])).any():
            return False
    return True


def _region(segments: Array) -> Array:
    """Outline, shape (k, 2), of where a facade's segments lie: the hull of their ends without the outermost ones."""
    middles = 0.5 * (segments[:, :2] + segments[:, 2:])
    low, high = np.quantile(middles, [OUTLIERS, 1.0 - OUTLIERS], axis=0)
    inside = ((middles >= low) & (middles <= high)).all(axis=1)
    ends = segments[inside].reshape(-1, 2)
    return np.asarray(cv2.convexHull(ends.astype(np.float32)), float).reshape(-1, 2)
