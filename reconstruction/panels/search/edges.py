"""Edges along the columns of a picture: where they are to a fraction of a pixel, and how much of a column has one.

Everything here speaks of vertical edges; for horizontal ones pass the transposed picture. Positions are continuous
pixels: the middle of the first column is 0.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

# How strong the noise of a picture is.

SAMPLES = 400_000
"""Values looked at; the estimate is good to 0.2 %."""


def noise_of(values: NDArray[Any]) -> float:
    """Standard deviation of the noise of a gradient picture, from its quieter half.

    Noise alone would put the lower quartile of the absolute values at 0.3186 standard deviations. Texture and edges
    push the quartile up much less than the median (D. Donoho's estimator takes that), and facades are full of them.
    """
    flat = np.abs(values).ravel()
    step = max(1, flat.size // SAMPLES)
    return float(np.quantile(flat[::step], 0.25)) / 0.3186 if flat.size else 0.0


Array = NDArray[np.float64]
Picture = NDArray[np.float32]

BLUR_PX = 0.8
"""Standard deviation of the Gaussian before differences are taken: the least that suppresses pixel noise; thin frames
(2 px) keep two edges."""

ALONG_PX = 2.0
"""The same along the edge: faint edges rise above the noise, lines a degree off their axis stay sharp."""

LEAST_THERE = 0.5
"""Of the steepness of an edge, that a place shows by itself, without what is smoothed in along the edge: lines that end
at a profile must not run on into it."""

LEAST_STEP = 1.2
"""Grey levels per pixel below which nothing is an edge, whatever the noise: 8-bit rounding makes steps of 1."""

NOISE_FACTOR = 3.0
"""Edges are steeper than so many standard deviations of the gradient's noise."""


@dataclass(frozen=True, slots=True, eq=False)
class EdgeMap:
    """Vertical edges of a picture, pixel by pixel.

    Parameters
    ----------
    is_edge
        Shape (h, w): the gradient across is the strongest of its neighbours in the row, and steep.
    offset_px
        Shape (h, w): from the pixel's middle to the edge, -0.5 to 0.5; 0 where there is none.
    """

    is_edge: NDArray[np.bool_]
    offset_px: Picture


def vertical_edges(grey: Picture, valid: NDArray[np.bool_] | None = None) -> EdgeMap:
    """Find vertical edges in a grey picture, shape (h, w); edges touching pixels that are not `valid` are none."""
    height, width = grey.shape
    if width < 3:
        return EdgeMap(np.zeros((height, width), bool), np.zeros((height, width), np.float32))
    smooth = np.asarray(cv2.GaussianBlur(grey, (0, 0), BLUR_PX, sigmaY=ALONG_PX, borderType=cv2.BORDER_REPLICATE))
    across = np.asarray(cv2.Sobel(smooth, cv2.CV_32F, 1, 0, ksize=3, scale=0.125, borderType=cv2.BORDER_REPLICATE))
    along = np.asarray(cv2.Sobel(smooth, cv2.CV_32F, 0, 1, ksize=3, scale=0.125, borderType=cv2.BORDER_REPLICATE))
    plain = np.asarray(cv2.GaussianBlur(grey, (0, 0), BLUR_PX, borderType=cv2.BORDER_REPLICATE))
    there = np.asarray(cv2.Sobel(plain, cv2.CV_32F, 1, 0, ksize=3, scale=0.125, borderType=cv2.BORDER_REPLICATE))
    size = np.abs(across)
    threshold = max(LEAST_STEP, NOISE_FACTOR * noise_of(across))
    left, middle, right = size[:, :-2], size[:, 1:-1], size[:, 2:]
    found = (middle > threshold) & (middle >= left) & (middle > right) & (middle > np.abs(along[:, 1:-1]))
    found &= np.abs(there[:, 1:-1]) > LEAST_THERE * threshold
    is_edge = np.zeros((height, width), bool)
    is_edge[:, 1:-1] = found
    if valid is not None:
        is_edge &= np.asarray(cv2.erode(valid.astype(np.uint8), np.ones((5, 5), np.uint8), borderValue=1)) > 0
    offset = np.zeros((height, width), np.float32)
    bend = left - 2.0 * middle + right
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = 0.5 * (left - right) / bend
    offset[:, 1:-1] = np.where(is_edge[:, 1:-1] & (bend < 0.0), np.clip(vertex, -0.5, 0.5), 0.0)
    return EdgeMap(is_edge, offset)


def edges_of_segments(segments: Array, width_px: int, height_px: int, max_tilt_deg: float) -> EdgeMap:
    """The same from line segments, shape (n, 4), of any detector: those within `max_tilt_deg` of the columns."""
    dx, dy = segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1]
    steep = segments[np.abs(dx) <= np.tan(np.radians(max_tilt_deg)) * np.abs(dy)]
    upper = np.where((steep[:, 1] <= steep[:, 3])[:, None], steep, steep[:, [2, 3, 0, 1]])
    first, last = np.ceil(upper[:, 1] - 0.5).astype(int), np.floor(upper[:, 3] - 0.5).astype(int)
    counts = np.maximum(last - first + 1, 0)
    which = np.repeat(np.arange(len(upper)), counts)
    row = first[which] + np.arange(which.size) - np.repeat(np.cumsum(counts) - counts, counts)
    x0, y0, x1, y1 = upper[which].T
    x = x0 + (row + 0.5 - y0) * (x1 - x0) / np.maximum(y1 - y0, 1e-9)
    inside = (row >= 0) & (row < height_px) & (x >= 0.0) & (x < width_px)
    row, x = row[inside], x[inside]
    is_edge = np.zeros((height_px, width_px), bool)
    offset = np.zeros((height_px, width_px), np.float32)
    is_edge[row, x.astype(int)] = True
    offset[row, x.astype(int)] = x - np.floor(x) - 0.5
    return EdgeMap(is_edge, offset)


def coverage_of_edges(edges: EdgeMap, n_bands: int, reach_px: int = 1) -> Array:
    """Share of the rows of each band that has an edge within `reach_px` of a column, shape (n_bands, w)."""
    near = edges.is_edge
    if reach_px > 0:
        near = np.asarray(cv2.dilate(near.astype(np.uint8), np.ones((1, 2 * reach_px + 1), np.uint8))) > 0
    return band_means(near, n_bands)


def edge_histogram(edges: EdgeMap, rows: slice, per_px: int) -> Array:
    """Share of the rows with an edge in each bin of 1 / `per_px` pixels, shape (per_px * w,)."""
    is_edge = edges.is_edge[rows]
    width = is_edge.shape[1]
    row, column = np.nonzero(is_edge)
    places = column + 0.5 + edges.offset_px[rows][row, column]
    bins = np.clip((places * per_px).astype(int), 0, width * per_px - 1)
    return np.asarray(np.bincount(bins, minlength=width * per_px) / max(1, is_edge.shape[0]))


def band_means(values: NDArray[np.bool_] | Picture, n_bands: int) -> Array:
    """Means of `n_bands` bands of rows of nearly equal height, shape (n_bands, w); fewer bands where rows are few."""
    height = values.shape[0]
    borders = np.linspace(0, height, min(n_bands, height) + 1).astype(int)
    sums = np.add.reduceat(values, borders[:-1], axis=0, dtype=np.float64)
    return np.asarray(sums / np.diff(borders)[:, None])


def measured_edge(edges: EdgeMap, position_px: float, rows: slice, reach_px: float = 2.0) -> tuple[float, float, int]:
    """Where a vertical edge near a position really is: median along the rows, its standard deviation, and how many.

    The median ignores what reflections add in some rows; a mean would follow them. NaN, NaN, 0 where no row has an
    edge within `reach_px`.
    """
    low = max(0, int(np.floor(position_px - reach_px)))
    high = min(edges.is_edge.shape[1], int(np.ceil(position_px + reach_px)) + 1)
    if low >= high:
        return float("nan"), float("nan"), 0
    row, column = np.nonzero(edges.is_edge[rows, low:high])
    places = column + low + 0.5 + edges.offset_px[rows, low:high][row, column]
    places = places[np.abs(places - position_px) <= reach_px]
    if places.size == 0:
        return float("nan"), float("nan"), 0
    middle = float(np.median(places))
    spread = 1.4826 * float(np.median(np.abs(places - middle)))
    return middle, 1.2533 * max(spread, 0.02) / float(np.sqrt(places.size)), int(places.size)
