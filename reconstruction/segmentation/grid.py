"""The grid of one facade in its rectified view: lines of both directions and how far they reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.progress import QUIET, Monitor
from reconstruction.segmentation.edges import (
    EdgeMap,
    coverage_of_edges,
    edge_histogram,
    edges_of_segments,
    measured_edge,
    vertical_edges,
)
from reconstruction.segmentation.evidence import FINE, Evidence, support_of
from reconstruction.segmentation.extent import best_stretch, crossed_by, crossing_support, kept_cells
from reconstruction.segmentation.frame_edges import regressed_width, unbiased_edges
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.posterior import posterior
from reconstruction.segmentation.record import GridLine
from reconstruction.segmentation.segments import find_segments
from reconstruction.segmentation.similarity import Rows
from reconstruction.segmentation.spacing import Frame, SizeLimits, most_probable_frames
from reconstruction.segmentation.stillness import Stillness, spread_in_bands

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

REACH_PX = 1.2
"""Around a candidate, in which its edge is measured: the other edge of a thin profile is 2 px away."""

LINE_TILT_DEG = 2.0
"""Segments tilted by more are not of the grid: the view is straightened, and a segment of 20 px is good to a degree."""

MOST_WIDER = 2.5
"""The first and last profile may be so many times as wide as the usual one, as where two elements meet."""

PARTS = (2, 3, 4)
"""Into how many parts, overlapping by half, an extent is divided where nothing is found in the whole of it."""

LEAST_IN_PART = 5
"""Lines that a part must show to be believed: a part sees fewer panes, and reflections more easily look like lines."""

EXTENT_ROUNDS = 4
"""Of looking for columns within the found height and rows within the found width."""


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """What is known of one direction: vertical edges of the picture, or of its transpose.

    Parameters
    ----------
    edges
        Of the picture seen along this direction, shape (h, w).
    coverage
        Shape (n_bands, w): share of a band's rows with an edge within a pixel of a column.
    spread
        Shape (n_bands, w): standard deviation of the brightness of a band's rows, column by column.
    picture
        Shape (h, w).
    """

    edges: EdgeMap
    coverage: Array
    spread: Array
    picture: Picture

    @classmethod
    def of(cls, picture: Picture, edges: EdgeMap, n_bands: int) -> Axis:
        """Of a grey picture, shape (h, w), and its vertical edges."""
        return cls(edges, coverage_of_edges(edges, n_bands), spread_in_bands(picture), picture)


@dataclass(frozen=True, slots=True)
class Axes:
    """A picture seen down its columns, and across: transposed."""

    down: Axis
    across: Axis

    @classmethod
    def of(
        cls, picture: NDArray[np.uint8], valid: NDArray[np.bool_] | None, parameters: SegmentationParameters
    ) -> Axes:
        """Of a grey picture, shape (h, w), of which only `valid` pixels show something."""
        grey = picture.astype(np.float32)
        turned, turned_valid = np.ascontiguousarray(grey.T), None if valid is None else valid.T.copy()
        if parameters.detector == "gradient":
            down, across = vertical_edges(grey, valid), vertical_edges(turned, turned_valid)
        else:
            height, width = picture.shape
            segments = find_segments(picture, parameters.detector, parameters.min_segment_px)
            down = edges_of_segments(segments, width, height, LINE_TILT_DEG)
            across = edges_of_segments(segments[:, [1, 0, 3, 2]], height, width, LINE_TILT_DEG)
        return cls(Axis.of(grey, down, parameters.n_bands), Axis.of(turned, across, parameters.n_bands))

    def gathering(self) -> float:
        """How much edges gather on lines of the picture: the sum of squares of their histograms.

        It is largest where the grid stands straight; what is mirrored is displaced from pane to pane however one turns.
        """
        return sum(
            float((support_of(edge_histogram(axis.edges, slice(None), FINE)) ** 2).sum())
            for axis in (self.down, self.across)
        )


def find_grid(
    axes: Axes, parameters: SegmentationParameters, monitor: Monitor = QUIET
) -> tuple[tuple[GridLine, ...], tuple[GridLine, ...]]:
    """Horizontal and vertical lines of a picture; empty where there is no grid."""
    down, across = axes.down, axes.across
    height, width = down.edges.is_edge.shape
    y_extent, x_extent = (0.0, float(height)), (0.0, float(width))
    columns: tuple[GridLine, ...] = ()
    rows: tuple[GridLine, ...] = ()
    for done in range(EXTENT_ROUNDS if parameters.find_extent else 1):
        monitor.report("find lines", done, EXTENT_ROUNDS)
        before = y_extent, x_extent
        columns = search(down, y_extent, parameters, crossed_by(across.edges.is_edge, rows, x_extent), _n_panes(rows))
        if len(rows) < 2 and len(columns) > 1 and parameters.find_extent:
            x_extent = columns[0].position_px, columns[-1].position_px
        rows = search(
            across, x_extent, parameters, crossed_by(down.edges.is_edge, columns, y_extent), _n_panes(columns)
        )
        if len(columns) > 1:
            y_extent = supported_extent(down, columns)
        if len(rows) > 1:
            x_extent = supported_extent(across, rows)
        if before == (y_extent, x_extent):
            break
    if len(rows) < 2 or len(columns) < 2:
        return (), ()
    return trimmed(down, across, rows, columns) if parameters.find_extent else (rows, columns)


def trimmed(
    down: Axis, across: Axis, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...]
) -> tuple[tuple[GridLine, ...], tuple[GridLine, ...]]:
    """Rows and columns without the border cells that inner lines of the other direction do not enter."""
    while True:
        keep_columns = kept_cells(crossing_support(across.edges.is_edge, _inner(rows), columns))
        keep_rows = kept_cells(crossing_support(down.edges.is_edge, _inner(columns), rows))
        fewer_columns = columns[keep_columns.start : keep_columns.stop + 1]
        fewer_rows = rows[keep_rows.start : keep_rows.stop + 1]
        if (len(fewer_rows), len(fewer_columns)) == (len(rows), len(columns)):
            return rows, columns
        rows, columns = fewer_rows, fewer_columns


def _n_panes(lines: tuple[GridLine, ...]) -> int | None:
    return len(lines) - 1 if len(lines) > 1 else None


def _inner(lines: tuple[GridLine, ...]) -> tuple[GridLine, ...]:
    """Lines with panels on both sides; all of them where there are too few, though the outer ones may be of a wall."""
    return lines[1:-1] if len(lines) > 3 else lines


def search(
    axis: Axis,
    extent_px: tuple[float, float],
    parameters: SegmentationParameters,
    crossed: Array | None = None,
    n_panes: int | None = None,
) -> tuple[GridLine, ...]:
    """As `find_lines`, and where that finds next to nothing, in parts of the extent: the facade may be one of them.

    Lines that fill a third of a picture full of other buildings drown in the whole of it.
    """
    lines = find_lines(axis, extent_px, parameters, crossed, n_panes)
    if len(lines) > 2 or not parameters.find_extent:
        return lines
    start, length = extent_px[0], extent_px[1] - extent_px[0]
    for n_parts in PARTS:
        step = 0.5 * length / n_parts
        parts = [(start + i * step, start + (i + 2) * step) for i in range(2 * n_parts - 1)]
        best = max((find_lines(axis, part, parameters, crossed, n_panes) for part in parts), key=len)
        if len(best) >= LEAST_IN_PART:
            return best
    return lines


def find_lines(
    axis: Axis,
    extent_px: tuple[float, float],
    parameters: SegmentationParameters,
    crossed: Array | None = None,
    n_panes: int | None = None,
) -> tuple[GridLine, ...]:
    """Lines along the columns of an axis, from what its rows between `extent_px` show.

    `crossed` is how much of the other direction's lines is seen in each column, as a multiple of the usual, and
    `n_panes` how many panes they divide a line into; None while they are not known.
    """
    rows = slice(int(extent_px[0]), max(int(extent_px[0]) + 1, int(extent_px[1])))
    support = support_of(edge_histogram(axis.edges, rows, FINE))
    if parameters.use_posterior:
        prior = support.reshape(-1, FINE).max(axis=1)
        alike = posterior(Rows.of(axis.picture[rows].T, parameters.n_samples), prior, parameters.beta)
        support = np.maximum(support, np.repeat(alike * prior.max(initial=0.0), FINE))
    stillness = Stillness.of(axis.spread[_bands(axis, rows)]) if parameters.use_stillness else None
    evidence = Evidence.of(support, n_panes, parameters.least_seen, stillness)
    limits = SizeLimits(
        parameters.min_panel_px, parameters.max_frame_px, parameters.max_frame_share, float(axis.picture.shape[1])
    )
    return _measured_lines(axis, most_probable_frames(evidence, limits, parameters.use_spacing, crossed), rows)


def _bands(axis: Axis, rows: slice) -> slice:
    """Bands whose middles lie within the rows; the nearest one where there is none."""
    per_row = len(axis.spread) / axis.picture.shape[0]
    start = min(int(rows.start * per_row + 0.5), len(axis.spread) - 1)
    return slice(start, max(start + 1, int(rows.stop * per_row + 0.5)))


def _measured_lines(axis: Axis, frames: tuple[Frame, ...], rows: slice) -> tuple[GridLine, ...]:
    """Frames measured by their gradients, and their widths corrected by what the glass beside them tells."""
    ends = np.array([[frame.first_px, frame.last_px] for frame in frames]).reshape(-1, 2)
    places = np.array([_measured(axis.edges, x, rows) for x in ends.ravel()]).reshape(-1, 2, 2)
    edges, sigmas = places[:, :, 0], np.hypot(places[:, 0, 1], places[:, 1, 1]) / 2.0
    regressed = np.array([regressed_width(axis.picture, first, last, rows) for first, last in edges])
    edges = without_wall(unbiased_edges(edges, regressed))
    return tuple(
        GridLine(
            float((first + last) / 2.0),
            float(max(0.0, last - first)),
            float(sigma),
            frame.confidence,
            frame.is_inferred,
        )
        for (first, last), sigma, frame in zip(edges, sigmas, frames, strict=True)
    )


def without_wall(edges_px: Array) -> Array:
    """Edges of profiles, shape (n, 2), of which the first and last are no wider than the others are.

    Beyond the last profile there is often a wall, and its far side is easier seen than where the profile meets it.
    """
    if len(edges_px) < 4:
        return edges_px
    usual = float(np.median(edges_px[1:-1, 1] - edges_px[1:-1, 0]))
    trimmed = edges_px.copy()
    if trimmed[0, 1] - trimmed[0, 0] > MOST_WIDER * max(usual, 1.0):
        trimmed[0, 0] = trimmed[0, 1] - usual
    if trimmed[-1, 1] - trimmed[-1, 0] > MOST_WIDER * max(usual, 1.0):
        trimmed[-1, 1] = trimmed[-1, 0] + usual
    return trimmed


def _measured(edges: EdgeMap, position_px: float, rows: slice) -> tuple[float, float]:
    place, sigma, n = measured_edge(edges, position_px, rows, REACH_PX)
    return (place, sigma) if n else (position_px, 1.0)


def supported_extent(axis: Axis, lines: tuple[GridLine, ...]) -> tuple[float, float]:
    """Rows between which the lines of an axis are seen: the stretch that gathers most support above the middle."""
    places = np.array([[line.position_px - line.width_px / 2, line.position_px + line.width_px / 2] for line in lines])
    index = np.clip(places.ravel().astype(int), 0, axis.coverage.shape[1] - 1)
    seen = axis.coverage[:, index].mean(axis=1)
    middle = 0.5 * (float(np.quantile(seen, 0.9)) + float(np.median(axis.coverage)))
    start, stop = best_stretch(seen - middle)
    height = axis.edges.is_edge.shape[0]
    return start / seen.size * height, stop / seen.size * height
