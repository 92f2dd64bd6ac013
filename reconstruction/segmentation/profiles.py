"""Profiles that run through pane after pane along one inclined line, and how sure each is.

A profile has two edges, and both go on in the next pane. So a candidate line is turned until edges lie on it as sharply
as they can, and the pair of parallel edges with most evidence is looked for. Panes along the line are the witnesses, as
for the lines of the grid (`evidence.py`), and the stretch of panes with the largest sum says where the profile begins
and ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.jit import kernel
from reconstruction.segmentation.evidence import FINE, MOST_SEEN
from reconstruction.segmentation.extent import best_stretch
from reconstruction.segmentation.inclined import LEAST_TILT_RAD, Candidate, EdgePoints, tilt_rad
from reconstruction.segmentation.panes import LEAST_NEAR_GRID, LEAST_WITNESSES, Panes, Pieces
from reconstruction.segmentation.record import InclinedLine

Array = NDArray[np.float64]

REACH_PX = 30.0
"""To both sides of a candidate: room for the widest profile and for the clutter beside it."""

SLACK_PX = 4.0
"""More, for edge pixels that come within reach as the line turns."""

SWEEP_RAD = np.radians(0.6)
SWEEP_STEPS = 25
"""Directions tried around a candidate's; steps of 0.05 degrees move the ends of a line of 1000 px by 0.4 px."""

ALIGNED_RAD = np.radians(8.0)
"""Edge pixels on a line have its direction to this; the gradient's own error is a third of it."""

SEEN = (0.45, 0.65, 0.8, MOST_SEEN)
"""Probabilities that a witness sees an edge of the line: profiles differ, and so does the glass behind them."""

LEAST_CLUTTER, MOST_CLUTTER, CLUTTER_MARGIN = 0.1, 0.4, 0.08
"""Probability that a pane shows an edge by chance: at least what the edge of a roof, mirrored in the pane beside it and
displaced by some pixels, makes likely."""

LEAST_PROFILE_PX = 1.5
"""Between the two edges of a profile; blur pushes them further apart than they are."""

STRONGEST = 6
"""Peaks of the histogram across a line that are tried as edges, each with each."""


@dataclass(frozen=True, slots=True)
class Profile:
    """A profile between two distances from the origin, along a stretch of the pieces of its line.

    `gains` is what each piece says for it, shape (pieces, len(SEEN)); `gain` their sum, less its price.
    """

    angle_rad: float
    first_px: float
    last_px: float
    pieces: Pieces
    start: int
    stop: int
    gains: Array
    price: float
    sigma_px: float

    @property
    def from_px(self) -> float:
        """Where it begins along the line."""
        return float(self.pieces.start[self.start])

    @property
    def to_px(self) -> float:
        """Where it ends along the line."""
        return float(self.pieces.stop[self.stop - 1])

    @property
    def gain(self) -> float:
        """Log odds that there is such a profile."""
        total = self.gains[self.start : self.stop].sum(axis=0)
        return float(total.max()) - float(np.log(len(SEEN))) - self.price

    def at(self, along_px: float) -> Array:
        """Point of its middle, shape (2,)."""
        across = np.array([np.cos(self.angle_rad), np.sin(self.angle_rad)])
        return np.asarray(0.5 * (self.first_px + self.last_px) * across + along_px * np.array([-across[1], across[0]]))

    def as_line(self) -> InclinedLine:
        """As the record of a facade has it."""
        a, b = self.at(self.from_px), self.at(self.to_px)
        return InclinedLine(
            (float(a[0]), float(a[1])),
            (float(b[0]), float(b[1])),
            self.last_px - self.first_px,
            self.sigma_px,
            float(1.0 / (1.0 + np.exp(-self.gain))),
        )

    def goes_on(self, index: int) -> bool:
        """Whether a piece of its line lies in the grid."""
        return bool(0 <= index < len(self.pieces.in_grid) and self.pieces.in_grid[index])

    def middle_at(self, angle_rad: float) -> float:
        """Distance from the origin of the line of this direction through the middle of the profile's stretch."""
        across = 0.5 * (self.first_px + self.last_px)
        along = 0.5 * (self.from_px + self.to_px)
        turn = self.angle_rad - angle_rad
        return float(across * np.cos(turn) - along * np.sin(turn))

    def claims(self, points: EdgePoints) -> NDArray[np.bool_]:
        """Edge pixels on it."""
        across, along = in_line(points.places_px, self.angle_rad)
        near = (across > self.first_px - 2.0) & (across < self.last_px + 2.0)
        return np.asarray(near & (along > self.from_px - 3.0) & (along < self.to_px + 3.0))


def profile_at(
    panes: Panes, points: EdgePoints, candidate: Candidate, price: float, least_witnesses: float = LEAST_WITNESSES
) -> Profile | None:
    """The profile at a candidate; None where the evidence is not worth the price."""
    places = points.along(candidate.angle_rad, ALIGNED_RAD)
    across, _ = in_line(places, candidate.angle_rad)
    places = places[np.abs(across - candidate.distance_px) < REACH_PX + SLACK_PX]
    if len(places) < least_witnesses * panes.pane_px:
        return None
    middle = places.mean(axis=0)
    angles = candidate.angle_rad + np.linspace(-SWEEP_RAD, SWEEP_RAD, SWEEP_STEPS)
    # About the middle of the points, so that the window stays where it is as the line turns.
    offset = candidate.distance_px - middle @ (np.cos(candidate.angle_rad), np.sin(candidate.angle_rad))
    best = float(angles[np.argmax(_sharpness(places - middle, angles, offset, REACH_PX, FINE))])
    if tilt_rad(best) < LEAST_TILT_RAD:
        return None
    return _profile(panes, places, best, middle, float(offset), price, least_witnesses)


def _profile(
    panes: Panes, places: Array, angle: float, middle: Array, offset: float, price: float, least_witnesses: float
) -> Profile | None:
    """The pair of edges with most evidence among places on a line of this direction, `offset` from their middle."""
    across, along = in_line(places, angle)
    centre = float(middle @ (np.cos(angle), np.sin(angle))) + offset
    pieces = panes.pieces(angle, centre)
    lengths = pieces.stop - pieces.start
    if (lengths > 0.5 * panes.pane_px).sum() < 1:
        return None
    shares = _shares(across - centre, along, pieces, angle)
    weights = np.minimum(1.0, lengths / (0.5 * panes.pane_px))
    near_grid, least_near = np.where(pieces.near_grid, weights, 0.0), min(least_witnesses, LEAST_NEAR_GRID)
    n_bins = shares.shape[1]
    total = weights @ shares
    clutter = float(np.clip(np.quantile(total / weights.sum(), 0.6) + CLUTTER_MARGIN, LEAST_CLUTTER, MOST_CLUTTER))
    peaks = _peaks(total, n_bins)
    best: Profile | None = None
    for i, first in enumerate(peaks):
        for last in peaks[i + 1 :]:
            if not LEAST_PROFILE_PX * FINE <= last - first <= panes.widest_px * FINE:
                continue
            both = np.stack([_gain(shares[:, [first, last]], seen, clutter).sum(axis=1) for seen in SEEN], axis=1)
            gains = weights[:, None] * both
            for one in gains.T:
                start, stop = best_stretch(one)
                low, high = (centre + (float(index) + 0.5) / FINE - REACH_PX for index in (first, last))
                here = Profile(angle, low, high, pieces, start, stop, gains, price, 0.5)
                is_long = weights[start:stop].sum() >= least_witnesses and near_grid[start:stop].sum() >= least_near
                if is_long and here.gain > (best.gain if best else 0.0):
                    best = here
    if best is None:
        return None
    edges, sigma = _edges(across, along, (best.first_px, best.last_px), (best.from_px, best.to_px))
    return replace(best, first_px=edges[0], last_px=edges[1], sigma_px=sigma)


def in_line(places: Array, angle: float) -> tuple[Array, Array]:
    """Coordinates across and along a line's direction."""
    cos, sin = np.cos(angle), np.sin(angle)
    return places[:, 0] * cos + places[:, 1] * sin, places[:, 1] * cos - places[:, 0] * sin


def _shares(across: Array, along: Array, pieces: Pieces, angle: float) -> Array:
    """Share of each piece with an edge within 0.75 px of each bin, shape (k, bins)."""
    n_bins = round(2.0 * REACH_PX * FINE)
    which = np.searchsorted(pieces.start, along) - 1
    inside = (which >= 0) & (np.abs(across) < REACH_PX)
    inside[inside] &= along[inside] < pieces.stop[which[inside]]
    bins = ((across[inside] + REACH_PX) * FINE).astype(int)
    counts = np.bincount(which[inside] * n_bins + bins, minlength=len(pieces.start) * n_bins).reshape(-1, n_bins)
    padded = np.pad(counts, ((0, 0), (1, 1)))
    near = padded[:, :-2] + padded[:, 1:-1] + padded[:, 2:]
    # An edge has one pixel a row where it is steep, one a column where it is flat.
    expected = (pieces.stop - pieces.start) * max(abs(np.cos(angle)), abs(np.sin(angle)))
    return np.asarray(np.minimum(1.0, near / expected[:, None]))


def _gain(share: Array, seen: float, clutter: float) -> Array:
    """Log odds of an edge from the shares of pieces."""
    return np.asarray(share * np.log(seen / clutter) + (1.0 - share) * np.log((1.0 - seen) / (1.0 - clutter)))


def _peaks(total: Array, n_bins: int) -> NDArray[np.intp]:
    """Bins of the strongest local maxima near the middle, ascending."""
    padded = np.pad(total, 1)
    smooth = 0.25 * padded[:-2] + 0.5 * total + 0.25 * padded[2:]
    peak = np.zeros(n_bins, bool)
    peak[1:-1] = (smooth[1:-1] >= smooth[:-2]) & (smooth[1:-1] > smooth[2:])
    places = np.nonzero(peak)[0]
    strongest = places[np.argsort(-smooth[places], kind="stable")[:STRONGEST]]
    return np.sort(strongest)


def _edges(
    across: Array, along: Array, rough_px: tuple[float, float], span_px: tuple[float, float]
) -> tuple[list[float], float]:
    """Both edges by the median of their pixels, and the standard deviation of their middle."""
    edges, variances = [], []
    on = (along > span_px[0]) & (along < span_px[1])
    for rough in rough_px:
        near = across[on & (np.abs(across - rough) <= 1.0)]
        place = float(np.median(near)) if len(near) else rough
        spread = 1.4826 * float(np.median(np.abs(near - place))) if len(near) else 0.5
        edges.append(place)
        variances.append((1.2533 * max(spread, 0.02)) ** 2 / max(1, len(near)))
    return edges, float(0.5 * np.sqrt(sum(variances)))


@kernel
def _sharpness(places: Array, angles: Array, offset: float, reach: float, fine: int) -> Array:
    """Sum of squares of the histogram across each direction, in bins of 1 / `fine` pixels: largest along the lines."""
    n_bins = int(2.0 * reach * fine)
    found = np.zeros(len(angles))
    for k in range(len(angles)):
        cos, sin = np.cos(angles[k]), np.sin(angles[k])
        counts = np.zeros(n_bins)
        for i in range(len(places)):
            index = int(np.floor((places[i, 0] * cos + places[i, 1] * sin - offset + reach) * fine))
            if 0 <= index < n_bins:
                counts[index] += 1.0
        for index in range(1, n_bins - 1):
            near = counts[index - 1] + counts[index] + counts[index + 1]
            found[k] += near * near
    return found
