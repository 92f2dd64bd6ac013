"""Measuring the edges of a grid's lines again in a finer picture, in strips along the lines only."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.jit import run_parallel
from planning.progress import QUIET, Monitor
from reconstruction.rectify.warp import warp
from reconstruction.segmentation.edges import measured_edge, vertical_edges
from reconstruction.segmentation.frame_edges import regressed_width, unbiased_edges
from reconstruction.segmentation.pictures import grey
from reconstruction.segmentation.record import GridLine, Rectification
from reconstruction.segmentation.views import CorrectedView

Array = NDArray[np.float64]

BESIDE_PX = 10
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
    monitor.report("refine lines", 0, 2)
    x_span, y_span = _span(columns, scale), _span(rows, scale)
    finer_columns = _measured(image, view, scale, columns, y_span, is_row=False)
    monitor.report("refine lines", 1, 2)
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
