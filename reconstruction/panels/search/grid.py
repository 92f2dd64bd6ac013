"""The grid of one facade in its rectified view: lines of both directions and how far they reach."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.panels.search.edges import (
    EdgeMap,
    coverage_of_edges,
    edge_histogram,
    edges_of_segments,
    find_segments,
    measured_edge,
    regressed_width,
    unbiased_edges,
    vertical_edges,
)
from reconstruction.panels.search.evidence import (
    APART_PX,
    FINE,
    Evidence,
    Stillness,
    best_stretch,
    crossed_by,
    crossing_support,
    spread_in_bands,
    support_of,
    supported_cells,
)
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import GridLine

Array = NDArray[np.float64]


# How alike the rows or columns of a picture are (Eqs. 3 and 4), as one matrix product.
#
# A row is the vector of its pixels; SSIM of two rows needs their means, variances and covariance only, and the
# covariances of all pairs are the product of the centred rows with their transpose. Everything is computed in blocks
# of
# rows, so that the whole matrix (16 million entries for 3956 rows) need not be held.

C1 = (0.01 * 255.0) ** 2
C2 = (0.03 * 255.0) ** 2
"""Constants of SSIM for 8 bit (Wang et al., 2004); they keep rows of one colour (no variance) finite."""

Floats = NDArray[np.floating[Any]]


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Rows of a picture, ready to be compared.

    Parameters
    ----------
    centred
        Shape (n, m): pixels less the mean of their row, divided by sqrt(m), so that products are covariances.
    means, variances
        Shape (n,).
    """

    centred: Floats
    means: Floats
    variances: Floats

    @classmethod
    def of(cls, picture: NDArray[Any], n_samples: int = 0, precision: type[np.floating[Any]] = np.float32) -> Rows:
        """Take the rows of a grey picture, shape (n, k), of values from 0 to 255.

        With `n_samples` > 0 that many pixels stand for a row: means of equal parts, so that no pixel is left out.
        Means are taken in float64 whatever the precision: cancellation between large equal values starts there.

        Raises
        ------
        ValueError
            Not a picture of at least one pixel, or values that are not finite.
        """
        if picture.ndim != 2 or picture.size == 0:
            raise ValueError(f"picture: expected shape (n, k) with n, k > 0, got {picture.shape}")
        values = picture.astype(np.float64)
        if not np.isfinite(values).all():
            raise ValueError("picture: expected finite values")
        if 0 < n_samples < values.shape[1]:
            borders = np.linspace(0, values.shape[1], n_samples + 1).astype(int)
            values = np.add.reduceat(values, borders[:-1], axis=1) / np.diff(borders)
        means = values.mean(axis=1)
        centred = values - means[:, None]
        variances = np.mean(centred * centred, axis=1)
        scaled = centred / np.sqrt(values.shape[1])
        return cls(scaled.astype(precision), means.astype(precision), variances.astype(precision))

    def similarity(self, start: int, stop: int) -> Floats:
        """SSIM of the rows from `start` to `stop` with all rows, shape (stop - start, n), from -1 to 1."""
        covariance = self.centred[start:stop] @ self.centred.T
        mu, var = self.means[start:stop, None], self.variances[start:stop, None]
        light = (2.0 * mu * self.means + C1) / (mu * mu + self.means * self.means + C1)
        ssim = light * (2.0 * covariance + C2) / (var + self.variances + C2)
        return np.asarray(np.clip(ssim, -1.0, 1.0, out=ssim))


# Lines that look alike share their evidence: prior times similarity, summed (Eqs. 5 to 8).


BLOCK = 512
"""Rows compared at once: 10 MB for pictures of 5280 columns."""


def normalised_intensity(intensity: Array) -> Array:
    """NorHLI or NorVLI, shape (n,) (Eq. 7); a histogram without any line stays 0."""
    top = float(intensity.max(initial=0.0))
    return np.asarray(intensity / top) if top > 0.0 else np.zeros_like(intensity)


def softmax(similarities: NDArray[Any], beta: float) -> NDArray[Any]:
    """NorHSIM, shape (m, n) (Eq. 8); the largest value of each row is subtracted first, so that nothing overflows."""
    powers = np.exp(beta * (similarities - similarities.max(axis=1, keepdims=True)))
    return np.asarray(powers / powers.sum(axis=1, keepdims=True))


def posterior(rows: Rows, intensity: Array, beta: float, monitor: Monitor = QUIET) -> Array:
    """HPosterior or VPosterior, shape (n,), from 0 to 1 (Eqs. 5 and 6).

    Parameters
    ----------
    intensity
        HLI or VLI, shape (n,): length of detected line per row, not negative.

    Raises
    ------
    ValueError
        The histogram has another length than there are rows.
    """
    n = len(rows.means)
    if intensity.shape != (n,):
        raise ValueError(f"intensity: expected shape ({n},), got {intensity.shape}")
    prior = normalised_intensity(intensity)
    result = np.empty(n)
    for start, stop in chunks(n, BLOCK):
        monitor.report(say("compare rows"), start, n)
        result[start:stop] = softmax(rows.similarity(start, stop), beta) @ prior
    return result


# Which edges belong to the grid: the most probable set of frames, given evidence for edges and repeating spacings.
#
# Walking across a facade, panels and frame profiles alternate. A set of edges says where each begins and ends; its
# probability is that of the evidence (how much of each edge was seen) times that of the sizes. Sizes follow a Chinese
# restaurant process: a size is new, at a price, or one of those already on the facade, the cheaper the more often it
# occurs. So a regular facade is told by few sizes, alternating or grouped ones by a few more, and a random one by
# none;
# no number of sizes has to be chosen. Missing lines pay for themselves where two usual sizes replace an odd one.
# The best set is found by dynamic programming, the confidence of each edge by the sums over all sets (forward-
# backward).

SIZE_SIGMA_PX = 0.8
"""Of one and the same size measured twice: both edges' errors."""

CONCENTRATION = 1.0
"""Of the Chinese restaurant process: weight of a new size against one sighting of a known one."""

MOST_CROSSED = 0.4
"""Of the usual support of crossing lines, that may be seen within a profile."""

INSIDE_PX = 2.5
LEAST_INSIDE_PX = 3
"""Of a profile where crossing lines are looked for: off its edges by the blur, and long enough to tell."""

CAUTION = (0.0, 6.0)
"""Cost of each edge in the first round, nats; the better end result of both is taken. Reflections of another facade
bring false lines with sizes of their own, which are counted unless only sure lines are at first."""

BORDER_PX = 6.0
"""Between the edges that may end a facade, of a profile and of what is beside it."""

ROUNDS = 4
"""Of finding the set and counting its sizes again; real facades settle after two."""


@dataclass(frozen=True, slots=True)
class SizeLimits:
    """Shortest panel, widest frame, and the length of the picture, pixels; widest frame as a share of usual panels."""

    min_panel_px: float
    max_frame_px: float
    max_frame_share: float
    length_px: float


@dataclass(frozen=True, slots=True)
class Frame:
    """A profile from edge to edge (the same place twice for a joint without width), and its confidence, 0 to 1.

    `is_inferred` where neither edge was seen: the spacing asks for it.
    """

    first_px: float
    last_px: float
    confidence: float
    is_inferred: bool


@dataclass(frozen=True, slots=True, eq=False)
class Sizes:
    """Sizes seen so far, each shape (k,): middles (px) and how often; new ones have density `broad` per pixel."""

    middles_px: Array
    counts: Array
    broad: float

    def log_density(self, sizes_px: Array) -> Array:
        """Log of the density of each size, any shape."""
        total = float(self.counts.sum()) + CONCENTRATION
        density = np.full(np.shape(sizes_px), CONCENTRATION / total * self.broad)
        scale = 1.0 / (SIZE_SIGMA_PX * np.sqrt(2.0 * np.pi))
        for middle, count in zip(self.middles_px, self.counts, strict=True):
            off = (sizes_px - middle) / SIZE_SIGMA_PX
            density += count / total * scale * np.exp(-0.5 * np.minimum(off * off, 1400.0))
        return np.asarray(np.log(density))


def _mean_between(values: Array, places_px: Array) -> Array:
    """Mean of values over what lies inside each two places, shape (n, n), 0 where that is too short to tell."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    first = np.clip(np.ceil(places_px + INSIDE_PX), 0, values.size).astype(int)
    last = np.clip(np.floor(places_px - INSIDE_PX), 0, values.size).astype(int)
    length = last[None, :] - first[:, None]
    return np.where(
        length >= LEAST_INSIDE_PX, (sums[last][None, :] - sums[first][:, None]) / np.maximum(length, 1), 0.0
    )


def clustered(sizes_px: Array, broad: float) -> Sizes:
    """Sizes that occur at least twice, those within three standard deviations of a neighbour taken together."""
    ordered = np.sort(sizes_px)
    if ordered.size == 0:
        return Sizes(np.empty(0), np.empty(0), broad)
    groups = np.split(ordered, np.nonzero(np.diff(ordered) > 3.0 * SIZE_SIGMA_PX)[0] + 1)
    kept = [group for group in groups if group.size >= 2]
    return Sizes(np.array([np.median(group) for group in kept]), np.array([float(g.size) for g in kept]), broad)


def most_probable_frames(
    evidence: Evidence, limits: SizeLimits, use_spacing: bool = True, crossed: Array | None = None
) -> tuple[Frame, ...]:
    """Find the most probable set of frames, from first to last.

    Parameters
    ----------
    use_spacing
        Count sizes and expect them again; without it all sizes are equally probable.
    crossed
        Shape (length,): how much of the other direction's lines is seen at each place, as a multiple of the usual. They
        end at a profile and go on through a low row of panels, however dark: that tells the two apart.

    Returns
    -------
    tuple
        At least two, or none where nothing is more probable than an empty facade.
    """
    if not use_spacing:
        fixed = _Costs.of(evidence.places_px, evidence, limits, *_no_sizes(limits), crossed)
        gains = evidence.gains(evidence.places_px)
        return _as_frames(_best_set(gains, fixed), evidence.places_px, gains, fixed)
    results = [_settled(evidence, limits, crossed, caution) for caution in CAUTION]
    return max(results, key=lambda result: result[0])[1]


def _no_sizes(limits: SizeLimits) -> tuple[Sizes, Sizes]:
    """Of panels and of frames, before any was seen."""
    nothing = np.empty(0)
    return Sizes(nothing, nothing, 1.0 / limits.length_px), Sizes(nothing, nothing, 1.0 / limits.max_frame_px)


def _settled(
    evidence: Evidence, limits: SizeLimits, crossed: Array | None, caution: float
) -> tuple[float, tuple[Frame, ...]]:
    """The set that counting its own sizes does not change any more, and the logarithm of its probability.

    In the first round every edge costs `caution`: with much of it only sure lines tell the sizes.
    """
    panels, widths = _no_sizes(limits)
    places, best = evidence.places_px, np.empty((0, 2))
    for done in range(ROUNDS):
        gains = evidence.gains(places) - (caution if done == 0 else 0.0)
        costs = _Costs.of(places, evidence, limits, panels, widths, crossed)
        pairs = _best_set(gains, costs)
        if not pairs:
            return 0.0, ()
        found = places[np.array(pairs)]
        if done > 0 and np.array_equal(found, best):
            break
        best = found
        sizes, thick = best[1:, 0] - best[:-1, 1], best[:, 1] - best[:, 0]
        panels, widths = clustered(sizes, panels.broad), clustered(thick[thick > 0.0], widths.broad)
        widest = limits.max_frame_share * float(np.median(sizes))
        limits = replace(limits, max_frame_px=min(limits.max_frame_px, widest))
        places = _with_expected(evidence.places_px, best, panels, widths, limits.length_px)
    gains = evidence.gains(places)
    pairs = _best_set(gains, costs := _Costs.of(places, evidence, limits, panels, widths, crossed))
    if not pairs:
        return 0.0, ()
    best = places[np.array(pairs)]
    edges = np.unique(np.array(pairs))
    sizes, thick = best[1:, 0] - best[:-1, 1], best[:, 1] - best[:, 0]
    still = float(costs.still[tuple(np.array(pairs[1:-1], int).reshape(-1, 2).T)].sum())
    score = still + float(gains[edges].sum()) + _log_sequence(sizes, panels.broad) + _log_sequence(thick, widths.broad)
    return score, _as_frames(pairs, places, gains, costs)


def _log_sequence(sizes_px: Array, broad: float) -> float:
    """Log of the density of sizes one after the other: each is new, or like those before it."""
    total = 0.0
    for index, size in enumerate(sizes_px):
        before = sizes_px[:index]
        total += float(Sizes(before, np.ones(index), broad).log_density(np.array([size]))[0])
    return total


def _with_expected(places: Array, frames: Array, panels: Sizes, widths: Sizes, length_px: float) -> Array:
    """Places and those where known sizes let an edge be expected: across a profile, and across a panel."""
    near = [places + sign * width for width in widths.middles_px for sign in (-1.0, 1.0)]
    for size in panels.middles_px:
        for width in (0.0, *widths.middles_px):
            near += [frames[:, 1] + size + width, frames[:, 0] - size - width]
    expected = np.sort(np.concatenate([*near, np.empty(0)]))
    expected = expected[(expected >= 0.0) & (expected <= length_px)]
    if expected.size == 0 or places.size == 0:
        return places
    after = np.clip(np.searchsorted(places, expected), 1, places.size - 1) if places.size > 1 else np.zeros(1, int)
    distance = np.minimum(np.abs(expected - places[after]), np.abs(expected - places[after - 1]))
    expected = expected[distance > SIZE_SIGMA_PX]
    if expected.size:
        expected = expected[np.concatenate([[True], np.diff(expected) > 0.5 * SIZE_SIGMA_PX])]
    return np.sort(np.concatenate([places, expected]))


@dataclass(frozen=True, slots=True, eq=False)
class _Costs:
    """Between each two candidates, shape (n, n), upper triangle: log densities of sizes, and gains of stillness.

    The diagonal of `frame` is that of a joint without width. Only profiles with glass on both sides gain by `still`.
    """

    panel: Array
    frame: Array
    still: Array

    @classmethod
    def of(
        cls,
        places_px: Array,
        evidence: Evidence,
        limits: SizeLimits,
        panels: Sizes,
        widths: Sizes,
        crossed: Array | None,
    ) -> _Costs:
        gap = places_px[None, :] - places_px[:, None]
        panel = np.where(gap >= limits.min_panel_px, panels.log_density(gap), -np.inf)
        frame = np.where((gap >= APART_PX) & (gap <= limits.max_frame_px), widths.log_density(gap), -np.inf)
        if crossed is not None:
            frame = np.where(_mean_between(crossed, places_px) > MOST_CROSSED, -np.inf, frame)
        np.fill_diagonal(frame, widths.log_density(np.zeros(1))[0])
        still = np.zeros_like(gap)
        first, last = np.nonzero(np.isfinite(frame))
        still[first, last] = evidence.profile_gains(places_px[first], places_px[last])
        return cls(panel, frame, still)

    def mirrored(self) -> _Costs:
        """Of the same walk from the other end."""
        return _Costs(*(costs[::-1, ::-1].T for costs in (self.panel, self.frame, self.still)))


def _best_set(gains: Array, costs: _Costs) -> list[tuple[int, int]]:
    """Frames (first, last) of the best set by Viterbi's recursion; empty where no set beats the empty facade.

    `closed[j]`: best walk whose last panel ends at edge j; `first[j]`: one of a first frame only, a panel may begin at
    j; `opened[j]`: a panel may begin at j after others; `ended[j]`: the last frame ends at j.
    """
    n = gains.size
    first, first_from = np.empty(n), np.empty(n, int)
    closed, closed_from = np.full(n, -np.inf), np.full(n, -1)
    opened, opened_from = np.full(n, -np.inf), np.full(n, -1)
    ended, ended_from = np.full(n, -np.inf), np.full(n, -1)
    for j in range(n):
        first[j], first_from[j] = _best(_framed(gains, costs, gains, j))
        if j == 0:
            continue
        closed[j], closed_from[j] = _best(np.maximum(first[:j], opened[:j]) + costs.panel[:j, j] + gains[j])
        last = _framed(gains, costs, closed, j)
        ended[j], ended_from[j] = _best(last)
        opened[j], opened_from[j] = _best(last + costs.still[: j + 1, j])
    j = int(np.argmax(ended)) if n else -1
    if n == 0 or not ended[j] > 0.0:
        return []
    frames = [(int(ended_from[j]), j)]
    while True:
        j = int(closed_from[frames[-1][0]])
        if first[j] >= opened[j]:
            return [(int(first_from[j]), j), *reversed(frames)]
        frames.append((int(opened_from[j]), j))


def _framed(gains: Array, costs: _Costs, before: Array, j: int) -> Array:
    """Of walks up to each edge with a frame from there to edge j, shape (j + 1,); the last one is a joint at j."""
    return np.append(costs.frame[:j, j] + before[:j] + gains[j], before[j] + costs.frame[j, j])


def _best(walks: Array) -> tuple[float, int]:
    at = int(np.argmax(walks))
    return float(walks[at]), at


def _sums(gains: Array, costs: _Costs) -> tuple[Array, Array, float]:
    """As `_best_set`, with sums over all walks in place of the best: log of `closed`, of `first` + `opened`, of all."""
    n = gains.size
    closed, first, opened, ended = (np.full(n, -np.inf) for _ in range(4))
    for j in range(n):
        first[j] = np.logaddexp.reduce(_framed(gains, costs, gains, j))
        if j == 0:
            continue
        closed[j] = gains[j] + np.logaddexp.reduce(np.logaddexp(first[:j], opened[:j]) + costs.panel[:j, j])
        last = _framed(gains, costs, closed, j)
        ended[j] = np.logaddexp.reduce(last)
        opened[j] = np.logaddexp.reduce(last + costs.still[: j + 1, j])
    everything = np.logaddexp(0.0, np.logaddexp.reduce(ended, initial=-np.inf))
    return closed, np.logaddexp(first, opened), float(everything)


def _edge_probabilities(gains: Array, costs: _Costs) -> tuple[Array, Array]:
    """Probabilities that a panel ends, and that one begins, at each place."""
    closed, begun, everything = _sums(gains, costs)
    mirror_closed, mirror_begun, _ = _sums(gains[::-1], costs.mirrored())
    ends = np.exp(np.minimum(closed + mirror_begun[::-1] - gains - everything, 0.0))
    begins = np.exp(np.minimum(begun + mirror_closed[::-1] - gains - everything, 0.0))
    return ends, begins


def _within(reach_px: float, places: Array, probabilities: Array, at: int) -> float:
    """Probability of any of the places within reach of one."""
    near = np.abs(places - places[at]) <= reach_px
    return min(float(probabilities[near].sum()), 1.0)


def _as_frames(pairs: list[tuple[int, int]], places: Array, gains: Array, costs: _Costs) -> tuple[Frame, ...]:
    """Frames with their confidence: the lesser of its two edges', of the inner one at either end of the facade.

    There a profile, what it covers and the wall have edges side by side: that one of them ends the facade may be sure,
    and which of them not.
    """
    if not pairs:
        return ()
    ends, begins = _edge_probabilities(gains, costs)
    beside = 2.0 * SIZE_SIGMA_PX
    sure = [min(_within(beside, places, ends, first), _within(beside, places, begins, last)) for first, last in pairs]
    sure[0] = _within(BORDER_PX, places, begins, pairs[0][1])
    sure[-1] = _within(BORDER_PX, places, ends, pairs[-1][0])
    return tuple(
        Frame(float(places[i]), float(places[j]), p, bool(max(gains[i], gains[j]) + costs.still[i, j] <= 0.0))
        for (i, j), p in zip(pairs, sure, strict=True)
    )


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
        monitor.report(say("find lines"), done, EXTENT_ROUNDS)
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
        keep_columns = supported_cells(crossing_support(across.edges.is_edge, _inner(rows), columns))
        keep_rows = supported_cells(crossing_support(down.edges.is_edge, _inner(columns), rows))
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
