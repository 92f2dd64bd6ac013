"""From a photo to its panels: rectify, find the grid, take the cells back into the photo."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.site.importing.facades import facade_name
from reconstruction.panels.rectify.rectification import Rectification
from reconstruction.panels.rectify.vanishing_view import vanishing_view
from reconstruction.panels.rectify.warp import warp
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.fuse import fused
from reconstruction.panels.search.grid import Axes, find_grid
from reconstruction.panels.search.outline import arranged
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, Segmentation
from reconstruction.panels.search.refine import refined_inclined, refined_lines
from reconstruction.panels.search.segments import Grey, find_segments, lengths
from reconstruction.panels.search.straighten import straightening, straightening_of_grid
from reconstruction.panels.search.vanishing import VanishingPoint, vanishing_points
from reconstruction.panels.search.views import CorrectedView, WholePicture, checked_image, grey, scaled_view

Array = NDArray[np.float64]


# Rectified views of a photo whose pose is not known: one for each direction that horizontal lines run in.

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


LEAST_FINER = 1.1
"""Pixels of the finer picture per coarse one from which on a second look gains anything."""


def segment_image(
    image: NDArray[Any],
    rectifications: Sequence[Rectification] | None = None,
    parameters: SegmentationParameters | None = None,
    monitor: Monitor = QUIET,
    name: str = "",
) -> Segmentation:
    """Find the panels of all facades in a photo.

    Parameters
    ----------
    image
        Shape (h, w) or (h, w, 3), 8 bit.
    rectifications
        One view for each facade; None where no pose is known: they are found from vanishing points.
    name
        Of the photo, for the record.

    Raises
    ------
    InputError
        Not such a picture.
    """
    parameters = parameters or SegmentationParameters()
    checked = checked_image(image)
    height, width = checked.shape[:2]
    if rectifications is None:
        monitor.report(say("find vanishing points"), 0, 1)
        views: Sequence[Rectification] = views_without_pose(
            grey(checked), parameters.max_tilt_deg, parameters.long_side_px, parameters.seed
        )
    else:
        views = rectifications
    facades = []
    for number, view in enumerate(views):
        monitor.report(say("find facades"), number, len(views))
        facades.append(segment_view(checked, view, parameters, monitor, facade_name(number)))
    return Segmentation(name, width, height, tuple(facades))


def segment_rectified(
    picture: NDArray[Any], parameters: SegmentationParameters | None = None, monitor: Monitor = QUIET
) -> FacadeGrid:
    """Find the panels of one facade in a picture whose rows and columns run along the grid's lines.

    Raises
    ------
    InputError
        Not a picture of shape (h, w) or (h, w, 3) and 8 bit.
    """
    checked = checked_image(picture)
    view = WholePicture(checked.shape[1], checked.shape[0])
    return segment_view(checked, view, parameters or SegmentationParameters(), monitor, "A")


def segment_view(
    image: NDArray[np.uint8],
    view: Rectification,
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
) -> FacadeGrid:
    """Find the panels of one facade through its rectified view."""
    scale = min(1.0, parameters.long_side_px / max(view.width_px, view.height_px))
    small = scaled_view(view, scale)
    picture, valid = _seen(image, small)
    axes = Axes.of(picture, valid, parameters)
    if parameters.straighten:
        monitor.report("straighten", 0, 1)
        bend = straightening(picture, parameters.max_tilt_deg, parameters.seed)
        bent = _bent(image, small, picture, valid, bend)
        bent_axes = axes if bend is None else Axes.of(bent[1], bent[2], parameters)
        if bent_axes.gathering() > axes.gathering():
            (small, picture, valid), axes = bent, bent_axes
    rows, columns = find_grid(axes, parameters, monitor)
    if parameters.straighten and rows and columns:
        last = straightening_of_grid(axes.down.edges, axes.across.edges, rows, columns)
        if last is not None:
            small, picture, valid = _bent(image, small, picture, valid, last)
            axes = Axes.of(picture, valid, parameters)
            rows, columns = find_grid(axes, parameters, monitor)
    arrangement = arranged(axes, rows, columns, parameters)
    rows, columns = arrangement.rows, arrangement.columns
    finer = min(1.0, parameters.refined_long_side_px / max(view.width_px, view.height_px)) / scale
    if finer > LEAST_FINER and rows and columns:
        small = scaled_view(small, finer)
        rows, columns = refined_lines(image, small, finer, rows, columns, monitor)
    else:
        finer = 1.0
    inclined = refined_inclined(image, small, finer, arrangement.inclined)
    return replace(facade_grid(facade_id, small, rows, columns, inclined), decision=arrangement.decision)


def segment_views(
    images: Sequence[NDArray[np.uint8]],
    views: Sequence[Rectification],
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
) -> tuple[FacadeGrid, ...]:
    """Find the panels of one facade in several photos at once, through views of the same window of it.

    The lines are those of all views together, once for each of them, so that every photo has the corners in its own
    pixels. The views must agree to a pixel of the rectified pictures (`reconstruction.panels.solving.register`); they
    are straightened as one.

    Raises
    ------
    InputError
        There are no views, or they are not of one size.
    """
    scale = min(1.0, parameters.long_side_px / max((max(v.width_px, v.height_px) for v in views), default=1))
    small: list[Rectification] = [scaled_view(view, scale) for view in views]
    axes = _fused_axes(images, small, parameters)
    monitor.report(say("fuse views"), 0, 1)
    rows, columns = find_grid(axes, parameters, monitor)
    if parameters.straighten and rows and columns:
        last = straightening_of_grid(axes.down.edges, axes.across.edges, rows, columns)
        if last is not None:
            small = [CorrectedView(view, last, view.width_px, view.height_px) for view in small]
            rows, columns = find_grid(_fused_axes(images, small, parameters), parameters, monitor)
    return tuple(facade_grid(facade_id, view, rows, columns) for view in small)


def _fused_axes(
    images: Sequence[NDArray[np.uint8]], views: Sequence[Rectification], parameters: SegmentationParameters
) -> Axes:
    seen = [warp(image, view) for image, view in zip(images, views, strict=True)]
    return fused([grey(picture) for picture, _ in seen], [mask for _, mask in seen], parameters)


Seen = tuple[Rectification, NDArray[np.uint8], NDArray[np.bool_] | None]


def _bent(
    image: NDArray[np.uint8],
    view: Rectification,
    picture: NDArray[np.uint8],
    valid: NDArray[np.bool_] | None,
    homography: Array | None,
) -> Seen:
    """The view and its picture through a homography; as they are without one."""
    if homography is None:
        return view, picture, valid
    view = CorrectedView(view, homography, view.width_px, view.height_px)
    return view, *_seen(image, view)


def _seen(image: NDArray[np.uint8], view: Rectification) -> tuple[NDArray[np.uint8], NDArray[np.bool_] | None]:
    """Grey rectified picture and where it shows the photo (None: everywhere)."""
    picture, valid = warp(image, view)
    return grey(picture), None if valid.all() else valid
