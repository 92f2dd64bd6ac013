"""What the picture says about an edge of the grid at each place along one direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

from reconstruction.panels.search.stillness import Stillness

Array = NDArray[np.float64]


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
