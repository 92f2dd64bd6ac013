"""Edges along the columns of a picture: where they are to a fraction of a pixel, and how much of a column has one.

Everything here speaks of vertical edges; for horizontal ones pass the transposed picture. Positions are continuous
pixels: the middle of the first column is 0.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.float32]


# Where a frame profile really begins and ends, from how the picture across it follows the glass beside it.
#
# The steepest places of a blurred picture lie outside of a profile only two or three pixels wide, by up to a pixel:
# two
# opposite edges push each other apart. What does not move under blur is the sum of a row of pixels across the
# profile.
# For a profile of one colour F from a to b, in a window from -T to T around it, with glass of brightness L before it
# and
# R behind it,
#
#     sum = (a + T) L + F (b - a) + (T - b) R.
#
# L and R differ from row to row, because glass mirrors something else everywhere, while a, b and F (b - a) stay: the
# slopes of a linear regression over the rows are the lengths of glass inside the window, whatever F and the blur are.

MARGIN_PX = 2.5
"""Glass on both sides inside the window: the blur of a photo (1 px) fades within it."""

BESIDE_PX = 2
"""Width of the strips of glass that L and R are taken from."""

PRIOR_SIGMA_PX = 0.6
"""Of the edges as the gradient shows them; decides where glass is too even for the regression."""

ROUNDS = 5
OUTLIER = 4.7
"""Residuals beyond so many standard deviations have no weight (Tukey's biweight)."""

SAME_WIDTH_PX = 0.8
LEAST_ALIKE = 3
"""Profiles of one width, to this tolerance, that tell their common bias."""

MOST_BIAS_PX = 2.0
"""Two edges push each other apart by twice the blur at most, and the blur of photos is about a pixel."""

LEAST_ROWS = 12

BLOCK_ROWS = 40
"""Rows that are compared with one another only: less than a panel's height, more than a few reflected edges."""


def unbiased_edges(edges_px: Array, regressed_px: Array) -> Array:
    """Edges of profiles, shape (n, 2), without the bias of their blur.

    One profile's regression is good to half a pixel, its gradients to a tenth but with a bias that all profiles of its
    width share. So the bias is the median over those, and every profile keeps its own middle.

    Parameters
    ----------
    edges_px
        Shape (n, 2): start and end of each profile as its gradients show them.
    regressed_px
        Shape (n,): widths from `regressed_width`, NaN where not known.
    """
    widths = edges_px[:, 1] - edges_px[:, 0]
    bias = widths - regressed_px
    known = np.isfinite(bias) & (widths > 0.0)
    corrected = edges_px.copy()
    for index in np.nonzero(widths > 0.0)[0]:
        alike = known & (np.abs(widths - widths[index]) <= SAME_WIDTH_PX)
        if alike.sum() >= LEAST_ALIKE:
            shrink = float(np.clip(np.median(bias[alike]), 0.0, min(MOST_BIAS_PX, widths[index]))) / 2.0
            corrected[index] += [shrink, -shrink]
    return corrected


def regressed_width(picture: Picture, first_px: float, last_px: float, rows: slice) -> float:
    """Width of the vertical profile near `first_px` to `last_px`, NaN where the picture does not tell."""
    start, stop = round(first_px - MARGIN_PX), round(last_px + MARGIN_PX)
    if start - BESIDE_PX < 0 or stop + BESIDE_PX > picture.shape[1]:
        return float("nan")
    strip = picture[rows, start - BESIDE_PX : stop + BESIDE_PX].astype(np.float64)
    if strip.shape[0] < LEAST_ROWS:
        return float("nan")
    left, right = strip[:, :BESIDE_PX].mean(axis=1), strip[:, -BESIDE_PX:].mean(axis=1)
    sums = strip[:, BESIDE_PX:-BESIDE_PX].sum(axis=1)
    values = _less_block_means(np.column_stack([left, right, sums]))
    glass = _robust_slopes(values[:, :2], values[:, 2], np.array([first_px - start, stop - last_px]))
    return float(stop - start - glass.sum())


def _less_block_means(values: Array) -> Array:
    """Columns less the mean of their block of rows: F differs where a shadow falls, but hardly within a block."""
    borders = np.arange(0, values.shape[0], BLOCK_ROWS)
    counts = np.diff(np.append(borders, values.shape[0]))
    means = np.add.reduceat(values, borders, axis=0) / counts[:, None]
    return np.asarray(values - np.repeat(means, counts, axis=0))


def _robust_slopes(design: Array, values: Array, prior: Array) -> Array:
    """Slopes, shape (2,), by iteratively reweighted least squares with a prior that decides where glass is even."""
    weights = np.ones_like(values)
    found = prior
    for _ in range(ROUNDS):
        residuals = values - design @ found
        spread = max(1.4826 * float(np.median(np.abs(residuals))), 0.5)
        off = residuals / (OUTLIER * spread)
        weights = np.where(np.abs(off) < 1.0, (1.0 - off * off) ** 2, 0.0) + 1e-9
        weighted = (design * weights[:, None]).T / spread**2
        pull = np.eye(2) / PRIOR_SIGMA_PX**2
        found = np.asarray(np.linalg.solve(weighted @ design + pull, weighted @ values + pull @ prior), float)
    return found


# Line segments in a picture, from any of several detectors, all in continuous pixel coordinates.

Grey = NDArray[np.uint8]
SegmentDetector = Literal["hough", "lsd", "edlines", "fld"]

CANNY_SHARES = (0.75, 0.92)
"""Quantiles of the gradient that Canny takes for its two thresholds: one pixel in ten of a facade is on an edge."""

LEAST_CANNY = (12.0, 30.0)
"""Floors of the two (Sobel units, 8 per grey level), so that noise on an even picture makes no edges."""

HOUGH_VOTES_SHARE = 0.6
"""Votes a line needs in the Hough transform, as a share of the least length."""

MAX_GAP_PX = 5


def find_segments(grey: Grey, detector: SegmentDetector, min_length_px: float) -> Array:
    """Line segments of a grey 8-bit picture, shape (n, 4): x and y of both ends, ordered as the detector gives them.

    Raises
    ------
    ValueError
        Not a grey 8-bit picture, or no such detector.
    """
    if grey.ndim != 2 or grey.dtype != np.uint8:
        raise ValueError(f"grey: expected a picture of shape (h, w) and type uint8, got {grey.shape}, {grey.dtype}")
    if min(grey.shape) < 3:
        return np.empty((0, 4))
    if detector not in _DETECTORS:
        raise ValueError(f"detector: expected one of {', '.join(_DETECTORS)}, got {detector}")
    found = _DETECTORS[detector](np.ascontiguousarray(grey), min_length_px)
    segments = np.empty((0, 4)) if found is None else np.asarray(found, float).reshape(-1, 4) + 0.5
    return np.asarray(segments[lengths(segments) >= min_length_px])


def lengths(segments: Array) -> Array:
    """Of segments, shape (n, 4), in pixels."""
    return np.hypot(segments[:, 2] - segments[:, 0], segments[:, 3] - segments[:, 1])


def canny_edges(grey: Grey) -> Grey:
    """Canny's edges with thresholds from the picture's own gradients, shape (h, w), 0 or 255."""
    dx = np.asarray(cv2.Sobel(grey, cv2.CV_16S, 1, 0))
    dy = np.asarray(cv2.Sobel(grey, cv2.CV_16S, 0, 1))
    sizes = np.abs(dx[::4, ::4].astype(np.int32)) + np.abs(dy[::4, ::4])
    low, high = (max(floor, float(q)) for floor, q in zip(LEAST_CANNY, np.quantile(sizes, CANNY_SHARES), strict=True))
    return np.asarray(cv2.Canny(dx, dy, low, high), np.uint8)


def _hough(grey: Grey, min_length_px: float) -> Any:
    smooth = np.asarray(cv2.GaussianBlur(grey, (0, 0), 1.0), np.uint8)
    votes = max(10, round(HOUGH_VOTES_SHARE * min_length_px))
    return cv2.HoughLinesP(
        canny_edges(smooth), 1.0, np.pi / 360.0, votes, minLineLength=min_length_px, maxLineGap=MAX_GAP_PX
    )


def _lsd(grey: Grey, min_length_px: float) -> Any:
    return cv2.createLineSegmentDetector(cv2.LSD_REFINE_STD).detect(grey)[0]


def _edlines(grey: Grey, min_length_px: float) -> Any:
    drawing = cv2.ximgproc.createEdgeDrawing()
    settings = cv2.ximgproc.EdgeDrawing.Params()
    settings.MinLineLength = max(5, round(min_length_px))
    drawing.setParams(settings)
    drawing.detectEdges(grey)
    return drawing.detectLines()


def _fld(grey: Grey, min_length_px: float) -> Any:
    low, high = 20.0, 50.0
    return cv2.ximgproc.createFastLineDetector(max(5, round(min_length_px)), 1.414, low, high, 3, True).detect(grey)


_DETECTORS = {"hough": _hough, "lsd": _lsd, "edlines": _edlines, "fld": _fld}


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
