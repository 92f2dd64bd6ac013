"""What the picture says about an edge of the grid at each place along one direction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reconstruction.panels.search.record import GridLine

Array = NDArray[np.float64]


# How far a grid reaches: the stretch its lines are seen along, and border cells that its other lines do not enter.

LEAST_SHARE = 0.4
"""Of the usual support of crossing lines, that the cells of a border must show. Walls and skies beside a facade show
under 0.2, the weakest border columns of glass 0.6."""

USUAL_QUANTILE = 0.75
"""Of the cells' support that is taken as usual: where half of the cells are not the facade, the median is theirs."""

NEAR_PX = 1.5
"""From a line's edge to a pixel that supports it."""


def best_stretch(values: Array) -> tuple[int, int]:
    """Start and stop of the consecutive values with the largest sum; everything where none is positive."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    stop = int(np.argmax(sums - np.minimum.accumulate(sums)))
    start = int(np.argmin(sums[: stop + 1]))
    return (start, stop) if stop > start else (0, values.size)


def crossing_support(is_edge: NDArray[np.bool_], lines: tuple[GridLine, ...], crossing: tuple[GridLine, ...]) -> Array:
    """Share of each piece of a line that has an edge.

    Parameters
    ----------
    is_edge
        Shape (h, w): edges along the direction of `lines`, the columns of this picture.
    lines
        Along the columns of the picture.
    crossing
        The other direction's: pieces of lines lie between them.

    Returns
    -------
    Array
        Shape (len(lines), len(crossing) - 1), the better edge of each line counting.
    """
    height = is_edge.shape[0]
    support = np.zeros((len(lines), max(0, len(crossing) - 1)))
    for i, line in enumerate(lines):
        for seen in seen_along(is_edge, line):
            sums = np.concatenate([[0.0], np.cumsum(seen)])
            for j, (a, b) in enumerate(pairwise(crossing)):
                start = int(np.clip(a.position_px + a.width_px / 2 + 2.0, 0, height))
                stop = int(np.clip(b.position_px - b.width_px / 2 - 2.0, 0, height))
                if stop > start:
                    support[i, j] = max(support[i, j], (sums[stop] - sums[start]) / (stop - start))
    return support


def seen_along(is_edge: NDArray[np.bool_], line: GridLine) -> NDArray[np.bool_]:
    """Whether either edge of a line along the columns is seen in each row, shape (2, h)."""
    height, width = is_edge.shape
    seen = np.zeros((2, height), bool)
    for side, sign in enumerate((-0.5, 0.5)):
        x = line.position_px + sign * line.width_px
        low, high = max(0, round(x - NEAR_PX - 0.5)), min(width, round(x + NEAR_PX + 0.5))
        if low < high:
            seen[side] = is_edge[:, low:high].any(axis=1)
    return seen


def crossed_by(
    is_edge: NDArray[np.bool_], lines: tuple[GridLine, ...], between_px: tuple[float, float]
) -> Array | None:
    """How much of the inner lines along the columns is seen in each row, as a multiple of the usual, shape (h,).

    None where there are no inner lines, or nothing of them is seen.
    """
    if len(lines) < 3:
        return None
    seen = np.mean([seen_along(is_edge, line).any(axis=0) for line in lines[1:-1]], axis=0)
    usual = float(np.median(seen[int(between_px[0]) : int(between_px[1]) + 1]))
    return np.asarray(seen / usual) if usual > 0.0 else None


def supported_cells(support: Array) -> slice:
    """Cells between crossing lines that lie on the facade: the stretch of cells with most support.

    Parameters
    ----------
    support
        Of inner lines, shape (n_lines, n_cells), from `crossing_support`; without any line nothing is cut.
    """
    n_lines, n_cells = support.shape
    if n_lines == 0 or n_cells < 2:
        return slice(0, n_cells)
    seen = support.mean(axis=0)
    return slice(*best_stretch(seen - LEAST_SHARE * float(np.quantile(seen, USUAL_QUANTILE))))


# Frames by their stillness: what glass mirrors changes along a line, a frame keeps its brightness.
#
# A dark profile before dark glass that mirrors a bright grid shows hardly an edge in most panes, but nothing of the
# grid
# either. Within a band of rows as long as a pane the brightness of a column of glass spreads by s_g, that of a
# profile by
# s_f. Were the profile glass, its brightness would be drawn from a normal distribution of spread s_g; the logarithm
# of
# the likelihood ratio is, for each independent value,
#
#     log(s_g / s_f) + (s_f^2 / s_g^2 - 1) / 2,
#
# and near none where the glass beside is itself as still as noise.

Picture = NDArray[np.float32]

N_BANDS = 12
"""Bands of a picture: as long as a pane, in which glass mirrors several things; in shorter ones it is still, too."""

STRIP_PX = (2.5, 9.0)
"""Glass beside a profile, from its edges: beyond the blur, and not yet the next profile."""

NOISE_GREY = 2.0
"""Spread below which nothing can be told: of pixels' noise and 8 bit."""

VALUES = 2.0
"""Independent values of brightness in a pane's length."""

MOST_OF_A_VALUE, OF_A_WITNESS = 1.5, (-0.4, 1.0)
"""Nats: most for a value, least and most for a pane. Between the edges of made profiles the sum over the panes is below
-0.2 once in fifty times, above 4.5 in three of four; between other edges below -1 every second time, above 1 once in
ten."""


@dataclass(frozen=True, slots=True, eq=False)
class Stillness:
    """Spread of brightness along the columns of a picture.

    Parameters
    ----------
    sums
        Shape (n_bands, w + 1): cumulative over the columns, of the spread within each band of rows, grey levels.
    """

    sums: Array

    @classmethod
    def of(cls, spread: Array) -> Stillness:
        """From the spread of each column in each band, shape (n_bands, w)."""
        return cls(np.pad(np.cumsum(spread, axis=1), ((0, 0), (1, 0))))

    def per_witness(self, first_px: Array, last_px: Array) -> Array:
        """Gain of a profile between each two edges, each shape (n,); shape (n,), nats for each pane along it."""
        thin = np.maximum(0.6 - 0.5 * (last_px - first_px), 0.0)
        frame = self._mean(first_px - thin + 0.4, last_px + thin - 0.4)
        glass = np.minimum(
            self._mean(first_px - STRIP_PX[1], first_px - STRIP_PX[0]),
            self._mean(last_px + STRIP_PX[0], last_px + STRIP_PX[1]),
        )
        ratio = np.hypot(frame, NOISE_GREY) / np.hypot(glass, NOISE_GREY)
        strength = np.abs(np.log(ratio)) + 0.5 * (np.minimum(ratio, 1.0 / ratio) ** 2 - 1.0)
        signed = np.minimum(strength, MOST_OF_A_VALUE) * np.sign(1.0 - ratio)
        return np.asarray(np.clip(VALUES * signed.mean(axis=0), *OF_A_WITNESS))

    def _mean(self, start_px: Array, stop_px: Array) -> Array:
        """Mean spread between places, shape (n_bands, n); of the nearest column where they are beyond the picture."""
        width = self.sums.shape[1] - 1
        start = np.clip(np.floor(start_px), 0, width - 1).astype(int)
        stop = np.clip(np.ceil(stop_px), start + 1, width).astype(int)
        return np.asarray((self.sums[:, stop] - self.sums[:, start]) / (stop - start))


def spread_in_bands(picture: Picture, n_bands: int = N_BANDS) -> Array:
    """Standard deviation of each column within bands of rows, shape (n_bands, w); fewer bands where rows are few."""
    height = picture.shape[0]
    borders = np.linspace(0, height, min(n_bands, height) + 1).astype(int)
    counts = np.diff(borders)[:, None]
    centred = picture - picture.mean(dtype=np.float64).astype(np.float32)
    means = np.add.reduceat(centred, borders[:-1], axis=0, dtype=np.float64) / counts
    squares = np.add.reduceat(centred * centred, borders[:-1], axis=0, dtype=np.float64) / counts
    return np.sqrt(np.maximum(squares - means**2, 0.0))


# Peaks of a histogram over the rows or columns of a picture.


def local_maxima(values: Array, prominence: float, distance_px: float = 1.0) -> tuple[Array, Array]:
    """Positions in continuous pixels (to a fraction, by a parabola) and heights of the local maxima, each shape (k,).

    Parameters
    ----------
    values
        Shape (n,), finite; entry i belongs to the pixel whose middle is i + 0.5.
    prominence
        What a maximum must rise above the higher of the two saddles around it.
    distance_px
        Least distance of two maxima; the higher one stays.
    """
    # Here, not on top: with it comes all of scipy's statistics, a second that a window without photos can do without.
    from scipy.signal import find_peaks

    padded = np.concatenate([[-np.inf], values, [-np.inf]])  # the ends may be maxima, too
    padded[[0, -1]] = values.min(initial=0.0) - 1.0
    index, _ = find_peaks(padded, prominence=prominence, distance=max(1.0, distance_px))
    index = index - 1
    return index + 0.5 + _vertex(values, index), np.asarray(values[index], float)


def _vertex(values: Array, index: NDArray[np.intp]) -> Array:
    """Vertex of the parabola through each maximum and its neighbours, -0.5 to 0.5 from its middle."""
    inner = (index > 0) & (index < values.size - 1)
    i = index[inner]
    left, middle, right = values[i - 1], values[i], values[i + 1]
    bend = left - 2.0 * middle + right
    vertex = np.zeros(index.size)
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex[inner] = np.where(bend < 0.0, np.clip(0.5 * (left - right) / bend, -0.5, 0.5), 0.0)
    return vertex


LEAST_SUPPORT = 0.12
"""Share of a column with edges below which it is no candidate; texture alone reaches about 0.1."""

PROMINENCE = 0.03
"""A candidate's support rises above its surroundings by so much."""

WITNESSES = (4.0, 12.0)
"""Fewest and most independent witnesses along a line. A mirror image may run along a whole pane, so every pane beside
the line is one; more than a dozen are not independent either, because a reflected tower spans many panes."""

UNSEEN = -3.0
"""Least gain of an edge, nats: a profile of the colour of the glass beside it is unseen once in twenty cases. Two
unseen edges then cost less than one odd size on a facade with a dozen equal ones."""

LEAST_SEEN, MOST_SEEN = 0.35, 0.97
"""Probabilities that a witness sees an edge of the grid, on curtain walls."""

N_SEEN = 16
"""Probabilities in between over which the likelihood is averaged."""

CLUTTER_MARGIN = 0.25
"""Clutter piles up more in some columns than in the usual one: by so much, as a share of `least_seen`."""

ENOUGH = 12.0
"""Nats of both edges of a profile together from which on its stillness does not count."""

FINE = 2
"""Bins per pixel of the histogram that candidates are the peaks of: the edges of thin profiles are 2 to 3 px apart."""


APART_PX = 2.0
"""Two edges in one row are at least so far apart: what blurs the picture makes one of nearer ones."""


def support_of(histogram: Array) -> Array:
    """Support from a histogram of edges in bins of 1 / FINE pixels, shape (FINE * w,).

    Narrow, so that a mirror image that is displaced from pane to pane does not add up; edges of the grid scatter by a
    quarter of a pixel.
    """
    padded = np.pad(histogram, 1)
    return np.asarray(np.minimum(padded[:-2] + padded[1:-1] + padded[2:], 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Log-odds that a frame begins or ends at a place.

    Panes along a line are witnesses. They see clutter with a probability that the usual column tells, and an edge of
    the grid with one that differs from line to line, because a dark profile before dark glass is hardly seen: any from
    `least_seen` to `MOST_SEEN` is as probable as the others.

    Parameters
    ----------
    support
        Shape (FINE * w,): share of the rows with an edge within 0.75 px of each bin, 0 to 1.
    places_px
        Shape (n,), ascending: local maxima, where an edge may be.
    clutter
        Probability that a witness sees an edge where the grid has none.
    witnesses
        Independent observations along a line.
    least_seen
        Probability with which a witness sees the worst edge of the grid.
    stillness
        Of what lies between edges, where it is to count.
    """

    support: Array
    places_px: Array
    clutter: float
    witnesses: float
    least_seen: float
    stillness: Stillness | None = None

    @classmethod
    def of(
        cls,
        support: Array,
        n_panes: int | None = None,
        least_seen: float = LEAST_SEEN,
        stillness: Stillness | None = None,
    ) -> Evidence:
        """From the support of bins of 1 / FINE pixels.

        Parameters
        ----------
        n_panes
            Along a line, where it is known.
        least_seen
            Probability with which a witness sees the worst edge of the grid.
        stillness
            Of what lies between edges, where it is to count.
        """
        witnesses = WITNESSES[1] if n_panes is None else float(np.clip(1.5 * n_panes, *WITNESSES))
        if support.size == 0:
            return cls(support, np.empty(0), 0.05, witnesses, least_seen, stillness)
        padded = np.pad(support, 1)
        positions, _ = local_maxima(0.25 * padded[:-2] + 0.5 * support + 0.25 * padded[2:], PROMINENCE)
        found = _at(support, positions / FINE)
        keep = found >= LEAST_SUPPORT
        clutter = float(np.clip(np.quantile(support, 0.6) + CLUTTER_MARGIN * least_seen, 0.03, 0.4))
        return cls(support, positions[keep] / FINE, clutter, witnesses, least_seen, stillness)

    def gains(self, places_px: Array) -> Array:
        """Gain of an edge at each place, shape (n,), nats; at least `UNSEEN`.

        A place beside a maximum shows no edge of its own: the support there is that of the maximum.
        """
        share = np.where(self._is_beside(places_px), 0.0, _at(self.support, places_px))
        given_clutter = share * np.log(self.clutter) + (1.0 - share) * np.log(1.0 - self.clutter)
        seen = np.linspace(self.least_seen, MOST_SEEN, N_SEEN)
        given_edge = share[:, None] * np.log(seen) + (1.0 - share[:, None]) * np.log(1.0 - seen)
        likelihoods = self.witnesses * (given_edge - given_clutter[:, None])
        gain = np.logaddexp.reduce(likelihoods, axis=1) - np.log(N_SEEN)
        return np.asarray(np.maximum(gain, UNSEEN))

    def profile_gains(self, first_px: Array, last_px: Array) -> Array:
        """Gain of a profile between each two edges for being still, each shape (n,); shape (n,), nats.

        It makes up for edges that are badly seen, up to `ENOUGH` with theirs: where they are well seen it tells nothing
        new, and a wall beside the glass is still, too. A loss where more is mirrored between the edges than beside
        them. None where an edge is only expected: there is something still between mirrored windows as well.
        """
        gains = np.zeros(first_px.shape)
        seen = np.isin(first_px, self.places_px) & np.isin(last_px, self.places_px)
        if self.stillness is not None and seen.any():
            first, last = first_px[seen], last_px[seen]
            still = self.witnesses * self.stillness.per_witness(first, last)
            wanted = np.maximum(ENOUGH - self.gains(first) - self.gains(last), 0.0)
            gains[seen] = np.minimum(still, wanted)
        return gains

    def _is_beside(self, places_px: Array) -> NDArray[np.bool_]:
        if self.places_px.size == 0:
            return np.zeros(places_px.shape, bool)
        after = np.clip(np.searchsorted(self.places_px, places_px), 0, self.places_px.size - 1)
        before = np.maximum(after - 1, 0)
        near = np.minimum(np.abs(self.places_px[after] - places_px), np.abs(self.places_px[before] - places_px))
        return np.asarray((near > 0.0) & (near < APART_PX))


def _at(support: Array, places_px: Array) -> Array:
    return np.asarray(support[np.clip((places_px * FINE).astype(int), 0, support.size - 1)])
