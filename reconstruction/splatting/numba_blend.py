"""Blending the splats of each square of the picture, front to back, compiled.

A splat's part of a square is a run of whole rows of it, which lie one after the other in memory. Each step is one loop
over a run without branches, which the compiler turns into vector instructions; that most of a run's pixels may not be
touched costs less than asking each.

Pixels are counted in unsigned integers, and arrays handed over whole with the run's ends: a slice takes longer to make
than a short run to do, and Python's negative indices keep loops over signed ones from being vectorised.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel
from reconstruction.splatting.numba_projection import (
    DEPTH,
    HIGHEST,
    J_XU,
    J_XV,
    J_YU,
    J_YV,
    LOWEST,
    N_GEOMETRY,
    OPACITY,
    E,
    F,
)
from reconstruction.splatting.numba_tiles import lanes_kernel
from reconstruction.splatting.raster import RasterSettings

Array32 = NDArray[np.float32]
Index = NDArray[np.int64]

MIN_ALPHA, MAX_ALPHA, MIN_TRANSMITTANCE, LOW_PASS2 = range(4)
"""Entries of `limits_of`; the last is the low-pass filter's 1 / sigma^2."""

DX, DY = N_GEOMETRY, N_GEOMETRY + 1
"""Columns of a splat's geometry beyond those of the projection: from its middle to the middle of a first pixel."""

ZERO, ONE = np.float32(0.0), np.float32(1.0)

MAX_EXPONENT = np.float32(19.4)
EXP_SCALE = np.float32(-0.5 / 8.0 / math.log(2.0))
C0, C1, C2, C3, C4, C5, C6, C7 = np.array(
    [1.0, 0.69314695, 0.24022399, 0.05549338, 0.0095951691, 0.0013060346, 0.00013542949, 8.2214978e-06], np.float32
)
"""Of 2^t for t from -1.75 to 0: the polynomial with the least squares of relative errors, 4e-9 at most."""


def limits_of(settings: RasterSettings) -> Array32:
    """What kernels need of the settings."""
    s = settings
    return np.array([s.min_alpha, s.max_alpha, s.min_transmittance, 1.0 / s.low_pass_px**2], np.float32)


@kernel
def exp_half(q: Any) -> Any:
    """exp(-q / 2) for 0 <= q <= 19.4, to 1e-6: the eighth power of a polynomial."""
    t = min(q, MAX_EXPONENT) * EXP_SCALE
    p = C0 + t * (C1 + t * (C2 + t * (C3 + t * (C4 + t * (C5 + t * (C6 + t * C7))))))
    p = p * p
    p = p * p
    return p * p


@lanes_kernel
def draw_splat(
    geometry: Array32,
    k: int,
    limits: Array32,
    x: Array32,
    y: Array32,
    first: int,
    last: int,
    shift: int,
    alpha: Array32,
    depth: Array32,
) -> float:
    """Alpha and depth of a splat for the pixels from `first` to `last`, and how many it touches.

    Parameters
    ----------
    geometry, k
        What `gather` makes, and the row of the splat.
    x, y
        Columns and rows of the pixels within their square.
    shift
        Alpha of pixel i goes to `alpha[i + shift]`.
    """
    dx, dy = geometry[k, DX], geometry[k, DY]
    j_xu, j_xv, j_yu, j_yv = geometry[k, J_XU], geometry[k, J_XV], geometry[k, J_YU], geometry[k, J_YV]
    e, f, middle, opacity = geometry[k, E], geometry[k, F], geometry[k, DEPTH], geometry[k, OPACITY]
    lowest, highest = geometry[k, LOWEST], geometry[k, HIGHEST]
    least, most, low_pass2 = limits[MIN_ALPHA], limits[MAX_ALPHA], limits[LOW_PASS2]
    hits = ZERO
    for i in range(first, last):
        xx, yy = x[i] + dx, y[i] + dy
        n_u, n_v, t = xx * j_yv - yy * j_xv, yy * j_xu - xx * j_yu, xx * e + yy * f
        within = min(max(t, lowest), highest)
        over_d = ONE / (ONE + within)
        disc, low = (n_u * n_u + n_v * n_v) * over_d * over_d, (xx * xx + yy * yy) * low_pass2
        q = disc if (t == within) & (disc <= low) else low
        a = min(opacity * exp_half(q), most)
        a = a if a >= least else ZERO
        alpha[i + shift], depth[i] = a, middle * over_d
        hits += ONE if a > ZERO else ZERO
    return float(hits)


@lanes_kernel
def _weigh(
    first: int,
    last: int,
    least: float,
    alpha: Array32,
    depth: Array32,
    weight: Array32,
    through: Array32,
    depth_sum: Array32,
) -> float:
    """Weights of a splat, and what shines through after it; closed pixels take nothing. Sum of the weights."""
    total = ZERO
    for i in range(first, last):
        a = alpha[i] if through[i] >= least else ZERO
        w = through[i] * a
        weight[i] = w
        depth_sum[i] += w * depth[i]
        through[i] = through[i] * (ONE - a)
        total += w
    return float(total)


@lanes_kernel
def _add_features(first: int, last: int, weight: Array32, features: Array32, k: int, sums: Array32) -> None:
    """Add the features of splat `k` to the sums, shape (c, n_pixels)."""
    for c in range(features.shape[1]):
        feature = features[k, c]
        for i in range(first, last):
            sums[c, i] += weight[i] * feature


@lanes_kernel
def _vote(first: int, last: int, weight: Array32, votes: Array32, label: int) -> None:
    """Add a splat's weights to those of its label, shape (n_labels, n_pixels)."""
    for i in range(first, last):
        votes[label, i] += weight[i]


@lanes_kernel
def is_closed(through: Array32, least: float) -> bool:
    """Whether no pixel of a square takes any more splats."""
    n_open = ZERO
    for i in range(len(through)):
        n_open += ONE if through[i] >= least else ZERO
    return bool(n_open == ZERO)


@kernel
def pixel_numbers(size: int) -> tuple[Array32, Array32]:
    """Columns and rows of a square's pixels."""
    x, y = np.empty(size * size, np.float32), np.empty(size * size, np.float32)
    for p in range(size * size):
        x[p], y[p] = p % size, p // size
    return x, y


@kernel
def _distinct(labels: NDArray[np.int32], splats: NDArray[np.int32]) -> NDArray[np.int32]:
    """Labels of some splats, each once."""
    found, n = np.empty(len(splats), np.int32), 0
    for i in splats:
        is_new = True
        for k in range(n):
            if found[k] == labels[i]:
                is_new = False
        if is_new:
            found[n] = labels[i]
            n += 1
    return found[:n]


@kernel
def _heaviest(known: NDArray[np.int32], votes: Array32, pixel: int) -> int:
    best, found = ZERO, np.int32(-1)
    for k in range(len(known)):
        vote = votes[k, pixel]
        if vote > best or (vote == best and vote > ZERO and known[k] < found):
            best, found = vote, known[k]
    return int(found)


@kernel
def open_pixels(through: Array32, size: int, n_columns: int, n_rows: int) -> None:
    """Let everything through the first columns and rows of a square, and nothing through what is outside."""
    for p in range(len(through)):
        through[p] = ONE if p % size < n_columns and p // size < n_rows else ZERO


NO_SHIFT: Any = np.uint64(0)

ROWS_AT_ONCE = 2
"""Runs are whole multiples of so many rows: vector loops leave nothing over to do pixel by pixel."""


@kernel
def gather(
    geometry: Array32,
    centres: NDArray[np.float64],
    boxes: NDArray[np.int32],
    features: Array32,
    splats: NDArray[np.int32],
    start: int,
    stop: int,
    x0: int,
    y0: int,
    size: int,
) -> tuple[Array32, Array32, NDArray[np.uint64]]:
    """The splats `start` to `stop` of a square, one after the other in memory: faster than to fetch each in turn.

    Returns
    -------
    geometry, features
        Shapes (m, 11) and (m, c).
    runs
        First pixel of each one's run in the square that begins at pixel `x0`, `y0`, and the one behind its last.
    """
    m = stop - start
    g, f, runs = (
        np.empty((m, DY + 1), np.float32),
        np.empty((m, features.shape[1]), np.float32),
        np.empty((m, 2), np.uint64),
    )
    for k in range(m):
        i = splats[start + k]
        for c in range(N_GEOMETRY):
            g[k, c] = geometry[i, c]
        g[k, DX], g[k, DY] = x0 + 0.5 - centres[i, 0], y0 + 0.5 - centres[i, 1]
        for c in range(features.shape[1]):
            f[k, c] = features[i, c]
        top, bottom = max(boxes[i, 2] - y0, 0), min(boxes[i, 3] - y0, size)
        runs[k, 0] = top // ROWS_AT_ONCE * ROWS_AT_ONCE * size
        runs[k, 1] = -(-bottom // ROWS_AT_ONCE) * ROWS_AT_ONCE * size
    return g, f, runs


CLOSED_EVERY = 16
"""Splats between two looks at whether a square still takes any."""


@kernel
def blend_tiles(
    geometry: Array32,
    centres: NDArray[np.float64],
    boxes: NDArray[np.int32],
    features: Array32,
    starts: Index,
    splats: NDArray[np.int32],
    limits: Array32,
    size: int,
    n_columns: int,
    labels: NDArray[np.int32],
    first: int,
    last: int,
    picture: Array32,
    alphas: Array32,
    depths: Array32,
    heaviest: NDArray[np.int32],
    slot_weights: Array32,
) -> None:
    """Blend squares `first` to `last` into the last five arrays; `slot_weights` has a place for each of `splats`.

    Parameters
    ----------
    labels
        Shape (n,), or (0,) where `heaviest` is not wanted.
    """
    n_channels, n = features.shape[1], size * size
    height, width = alphas.shape
    x, y = pixel_numbers(size)
    alpha, depth, weight = np.empty(n, np.float32), np.empty(n, np.float32), np.empty(n, np.float32)
    through, depth_sum, sums = np.empty(n, np.float32), np.empty(n, np.float32), np.empty((n_channels, n), np.float32)
    for tile in range(first, last):
        x0, y0 = (tile % n_columns) * size, (tile // n_columns) * size
        sums[:] = ZERO
        depth_sum[:] = ZERO
        open_pixels(through, size, width - x0, height - y0)
        start, stop = starts[tile], starts[tile + 1]
        slot_weights[start:stop] = ZERO
        has_labels = len(labels) > 0
        known = _distinct(labels, splats[start:stop]) if has_labels else labels
        votes = np.zeros((len(known), n), np.float32)
        g, f, runs = gather(geometry, centres, boxes, features, splats, start, stop, x0, y0, size)
        for k in range(stop - start):
            if k % CLOSED_EVERY == CLOSED_EVERY - 1 and is_closed(through, limits[MIN_TRANSMITTANCE]):
                break
            a, b = runs[k, 0], runs[k, 1]
            if draw_splat(g, k, limits, x, y, a, b, NO_SHIFT, alpha, depth) == ZERO:
                continue
            least = limits[MIN_TRANSMITTANCE]
            slot_weights[start + k] = _weigh(a, b, least, alpha, depth, weight, through, depth_sum)
            _add_features(a, b, weight, f, k, sums)
            for label in range(len(known) if has_labels else 0):
                if known[label] == labels[splats[start + k]]:
                    _vote(a, b, weight, votes, label)
        for row in range(min(size, height - y0)):
            for column in range(min(size, width - x0)):
                p = row * size + column
                alphas[y0 + row, x0 + column] = ONE - through[p]
                depths[y0 + row, x0 + column] = depth_sum[p]
                for c in range(picture.shape[2]):
                    picture[y0 + row, x0 + column, c] = sums[c, p]
                if has_labels:
                    heaviest[y0 + row, x0 + column] = _heaviest(known, votes, p)
