"""From a rectified view to panels by lines: find the grid, measure it finer, take its cells back into the photo."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError, InputError
from planning.base.jit import run_parallel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import vanishing_view, warp
from reconstruction.panels.search.cells import facade_grid
from reconstruction.panels.search.edges import (
    MOST_BIAS_PX,
    EdgeMap,
    Grey,
    find_segments,
    lengths,
    measured_edge,
    regressed_width,
    unbiased_edges,
    vertical_edges,
)
from reconstruction.panels.search.grid import Axes, Axis, find_grid
from reconstruction.panels.search.outline import arranged
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, GridLine, InclinedLine
from reconstruction.panels.search.vanishing import (
    VanishingPoint,
    straightening,
    straightening_of_grid,
    vanishing_points,
)
from reconstruction.panels.search.views import CorrectedView, WholePicture, grey, scaled_view

Array = NDArray[np.float64]


# Several views of one facade searched as one: reflections differ from view to view, frames do not.
#
# Every row of the edges is taken from another view in turn, of those that show the place. Support along a line is a
# share
# of its rows, so that a frame, which all views have in the same place, keeps its support, and a mirror image, which
# lies
# elsewhere in each, is left with the share of one view. The median of the pictures themselves does less: where mirror
# images of several views cross, it makes edges that no view has, and faint frames do not come out any clearer
# (docs/concepts/segmentation.md has the figures).

Mask = NDArray[np.bool_]

LEAST_OVERLAP = 400
"""Pixels in common that the brightness of two views can be compared by."""

USUAL_RANGE = (0.4, 2.5)
"""Gains outside this are no exposure: the views show different things, and brightness is left alone."""


def fused(pictures: Sequence[Grey], valid: Sequence[Mask], parameters: SegmentationParameters) -> Axes:
    """Edges of several views as of one picture.

    Parameters
    ----------
    pictures
        Grey rectified views of one size, shape (h, w), of the same window of the facade.
    valid
        Where each shows something, shape (h, w).

    Raises
    ------
    InputError
        No views, or views of different sizes.
    """
    if not pictures:
        raise InputError(say("fusing views: expected at least one rectified view, found none"))
    shapes = {picture.shape for picture in pictures} | {mask.shape for mask in valid}
    if len(shapes) > 1 or len(valid) != len(pictures):
        raise InputError(
            say(
                "fusing views: expected rectified views of one size with a mask each, found sizes {}; rectify "
                "them all onto the same window of the facade",
                sorted(shapes),
            )
        )
    first, first_mask = pictures[0], valid[0]
    views = [
        Axes.of(_levelled(picture, mask, first, first_mask), mask, parameters)
        for picture, mask in zip(pictures, valid, strict=True)
    ]
    shown, turned = np.stack(valid), np.stack([mask.T for mask in valid])
    down = _in_turn([view.down for view in views], shown, parameters.n_bands)
    return Axes(down, _in_turn([view.across for view in views], turned, parameters.n_bands))


def _in_turn(axes: Sequence[Axis], shown: Mask, n_bands: int) -> Axis:
    """One axis whose rows are of all axes in turn; `shown` is where each of them shows something, shape (n, h, w)."""
    so_far = shown.cumsum(axis=0, dtype=np.uint8)
    turn = np.arange(shown.shape[1])[:, None] % np.maximum(so_far[-1], 1)
    which = (so_far > turn).argmax(axis=0)[None]

    is_edge, offset_px, picture = (
        np.take_along_axis(np.stack(layers), which, axis=0)[0]
        for layers in (
            [axis.edges.is_edge for axis in axes],
            [axis.edges.offset_px for axis in axes],
            [axis.picture for axis in axes],
        )
    )
    return Axis.of(picture, EdgeMap(is_edge, offset_px), n_bands)


def _levelled(picture: Grey, mask: Mask, first: Grey, first_mask: Mask) -> Grey:
    """A view with the quartiles of the first one, over what both show: exposures differ."""
    both = mask & first_mask
    if both.sum() < LEAST_OVERLAP:
        return picture
    a, b = np.quantile(picture[both], [0.25, 0.5, 0.75]), np.quantile(first[both], [0.25, 0.5, 0.75])
    gain = float((b[2] - b[0]) / (a[2] - a[0])) if a[2] > a[0] else 1.0
    if not USUAL_RANGE[0] <= gain <= USUAL_RANGE[1]:
        return picture
    levelled = gain * (picture.astype(np.float32) - a[1]) + b[1]
    return np.asarray(np.clip(np.rint(levelled), 0, 255), np.uint8)


# Measuring the edges of a grid's lines again in a finer picture, in strips along the lines only.

BESIDE_PX = 10


# Measuring the edges of inclined profiles again, each in a picture of its own in which it stands upright.

"""Of the strip on both sides of the profile."""

INCLINED_REACH = 1.5
"""Around a coarse edge, in pixels of the coarse picture, in which the finer one is looked for."""

HALVES = 2
"""Of a line, measured each for itself: together they give its place and its direction."""

LEAST_LENGTH_PX = 24
"""Shorter lines stay as they are."""


def refined_inclined(
    image: NDArray[np.uint8], view: Rectification, scale: float, inclined: tuple[InclinedLine, ...]
) -> tuple[InclinedLine, ...]:
    """Inclined lines of a coarse picture, measured in a view with `scale` times as many pixels along each side.

    Their widths shrink by what the glass beside them tells (`edges.py`), the median over all of them.
    """
    measured = run_parallel(_measured_inclined, [(image, view, scale, line) for line in inclined])
    known = [bias for _, bias in measured if np.isfinite(bias)]
    bias = float(np.clip(np.median(known), 0.0, MOST_BIAS_PX)) if known else 0.0
    return tuple(
        InclinedLine(
            line.first_px, line.last_px, max(0.0, line.width_px - bias), line.sigma_px, line.confidence, line.open_side
        )
        for line, _ in measured
    )


def _measured_inclined(
    image: NDArray[np.uint8], view: Rectification, scale: float, line: InclinedLine
) -> tuple[InclinedLine, float]:
    """The line with its edges measured, and by how much its width is too large (NaN where nothing tells)."""
    first, last = scale * np.array(line.first_px), scale * np.array(line.last_px)
    length = float(np.linalg.norm(last - first))
    coarse = InclinedLine(
        _pair(first), _pair(last), scale * line.width_px, scale * line.sigma_px, line.confidence, line.open_side
    )
    if length < LEAST_LENGTH_PX:
        return coarse, float("nan")
    along = (last - first) / length
    across = np.array([along[1], -along[0]])
    half = int(np.ceil(0.5 * scale * line.width_px)) + BESIDE_PX
    corner = first - half * across
    strip_from = np.array([[across[0], along[0], corner[0]], [across[1], along[1], corner[1]], [0.0, 0.0, 1.0]])
    picture, valid = warp(image, CorrectedView(view, strip_from, 2 * half, int(length)))
    strip = grey(picture).astype(np.float32)
    edges = vertical_edges(strip, None if valid.all() else valid)
    rough = half + 0.5 * scale * line.width_px * np.array([-1.0, 1.0])
    borders = np.linspace(0, strip.shape[0], HALVES + 1).astype(int)
    parts = [slice(a, b) for a, b in pairwise(borders)]
    found = np.array([[measured_edge(edges, x, rows, INCLINED_REACH * scale) for x in rough] for rows in parts])
    if (found[:, :, 2] < 3).any():
        return coarse, float("nan")
    middles, widths = found[:, :, 0].mean(axis=1) - half, found[:, 1, 0] - found[:, 0, 0]
    width = float(widths.mean())
    at_first, at_last = 1.5 * middles[0] - 0.5 * middles[1], 1.5 * middles[1] - 0.5 * middles[0]
    sigma = float(np.sqrt((found[:, :, 1] ** 2).sum())) / (2.0 * HALVES)
    place = half + float(middles.mean())
    regressed = regressed_width(strip, place - 0.5 * width, place + 0.5 * width, slice(0, strip.shape[0]))
    return InclinedLine(
        _pair(first + at_first * across),
        _pair(last + at_last * across),
        width,
        sigma,
        line.confidence,
        line.open_side,
    ), width - regressed


def _pair(point: Array) -> tuple[float, float]:
    return float(point[0]), float(point[1])


"""Of a strip on both sides of a profile: enough for the glass beside it and the filters' reach."""

REACH = 1.2
"""Around a coarse edge, in pixels of the coarse picture, in which the finer one is looked for."""


def refined_lines(
    image: NDArray[np.uint8],
    view: Rectification,
    scale: float,
    rows: tuple[GridLine, ...],
    columns: tuple[GridLine, ...],
    monitor: Monitor = QUIET,
) -> tuple[tuple[GridLine, ...], tuple[GridLine, ...]]:
    """Lines of a coarse picture, measured in a view with `scale` times as many pixels along each side."""
    monitor.report(say("refine lines"), 0, 2)
    x_span, y_span = _span(columns, scale), _span(rows, scale)
    finer_columns = _measured(image, view, scale, columns, y_span, is_row=False)
    monitor.report(say("refine lines"), 1, 2)
    return _measured(image, view, scale, rows, x_span, is_row=True), finer_columns


def _span(lines: tuple[GridLine, ...], scale: float) -> tuple[int, int]:
    return int(lines[0].position_px * scale), int(np.ceil(lines[-1].position_px * scale))


def _measured(
    image: NDArray[np.uint8],
    view: Rectification,
    scale: float,
    lines: tuple[GridLine, ...],
    span: tuple[int, int],
    is_row: bool,
) -> tuple[GridLine, ...]:
    found = run_parallel(_measured_in_strip, [(image, view, scale, line, span, is_row) for line in lines])
    edges = unbiased_edges(np.array([ends for ends, _, _ in found]), np.array([width for _, _, width in found]))
    return tuple(
        GridLine(float(ends.mean()), float(np.ptp(ends)), sigma, line.confidence, line.is_inferred)
        for ends, (_, sigma, _), line in zip(edges, found, lines, strict=True)
    )


def _measured_in_strip(
    image: NDArray[np.uint8], view: Rectification, scale: float, line: GridLine, span: tuple[int, int], is_row: bool
) -> tuple[Array, float, float]:
    """Both edges of a line, the standard deviation of its middle, and its width by regression, finer pixels."""
    coarse = scale * (line.position_px + 0.5 * line.width_px * np.array([-1.0, 1.0]))
    start = int(np.floor(coarse[0])) - BESIDE_PX
    width, length = int(np.ceil(coarse[1])) + BESIDE_PX - start, max(1, span[1] - span[0])
    corner = (span[0], start) if is_row else (start, span[0])
    size = (length, width) if is_row else (width, length)
    shift = np.array([[1.0, 0.0, corner[0]], [0.0, 1.0, corner[1]], [0.0, 0.0, 1.0]])
    picture, valid = warp(image, CorrectedView(view, shift, *size))
    strip = grey(picture).astype(np.float32)
    if is_row:
        strip, valid = np.ascontiguousarray(strip.T), np.ascontiguousarray(valid.T)
    edges = vertical_edges(strip, None if valid.all() else valid)
    everywhere = slice(0, strip.shape[0])
    measured = [measured_edge(edges, x - start, everywhere, REACH * scale) for x in coarse]
    ends = np.array([place + start if n else x for (place, _, n), x in zip(measured, coarse, strict=True)])
    ends.sort()
    sigmas = [sigma if n else scale * line.sigma_px for _, sigma, n in measured]
    regressed = regressed_width(strip, ends[0] - start, ends[1] - start, everywhere)
    return ends, float(np.hypot(sigmas[0], sigmas[1])) / 2.0, regressed


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


def grid_by_lines(
    image: NDArray[np.uint8],
    view: Rectification,
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
) -> FacadeGrid:
    """Find the panels of one facade through its rectified view, by the lines of its profiles alone."""
    scale = min(1.0, parameters.long_side_px / max(view.width_px, view.height_px))
    small = scaled_view(view, scale)
    picture, valid = _seen(image, small)
    axes = Axes.of(picture, valid, parameters)
    if parameters.straighten:
        monitor.report(say("straighten"), 0, 1)
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
