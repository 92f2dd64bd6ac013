"""Measuring the edges of a grid's lines again in a finer picture, in strips along the lines only."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import run_parallel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.panels.rectify.rectification import Rectification
from reconstruction.panels.rectify.warp import warp
from reconstruction.panels.search.edges import measured_edge, vertical_edges
from reconstruction.panels.search.frame_edges import MOST_BIAS_PX, regressed_width, unbiased_edges
from reconstruction.panels.search.record import GridLine, InclinedLine
from reconstruction.panels.search.views import CorrectedView, grey

Array = NDArray[np.float64]
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

    Their widths shrink by what the glass beside them tells (`frame_edges.py`), the median over all of them.
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
