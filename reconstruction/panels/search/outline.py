"""The inclined edge of a facade: on which side of it there are panels, and the lines that it leaves room for.

Beyond the edge of a gable no line of the grid goes on. And its upper rows, and its outer columns, are so short that the
search for the grid, which asks for lines that most of the others cross, ends before them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, decide
from planning.base.jit import kernel
from planning.base.messages import say
from reconstruction.panels.search.cells import (
    LEAST_NEAR_GRID,
    LEAST_TILT_RAD,
    LEAST_WITNESSES,
    Candidate,
    EdgePoints,
    Panes,
    Pieces,
    candidates,
    cuts_of,
    inclined_points,
    tilt_rad,
)
from reconstruction.panels.search.evidence import FINE, MOST_SEEN, best_stretch, seen_along
from reconstruction.panels.search.grid import Axes, Axis, find_lines
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import GridLine, InclinedLine

Array = NDArray[np.float64]


# Profiles that run through pane after pane along one inclined line, and how sure each is.
#
# A profile has two edges, and both go on in the next pane. So a candidate line is turned until edges lie on it as
# sharply
# as they can, and the pair of parallel edges with most evidence is looked for. Panes along the line are the
# witnesses, as
# for the lines of the grid (`evidence.py`), and the stretch of panes with the largest sum says where the profile
# begins
# and ends.

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


# Inclined lines of a facade: profiles that run straight through pane after pane, beside the lines of its grid.
#
# Neither the edge of a mirrored roof (one edge, displaced from pane to pane, because no two panes are quite parallel)
# nor
# that of a shadow (one edge) looks like a profile (`profiles.py`). A new direction costs more than one that the
# facade
# has already, mirrored or not. Lines of one direction are often equally spaced, which lets short ones be expected;
# and
# they do not end in the middle of a pane.

NEW_LINE, NEW_DIRECTION = 6.0, 6.0
"""Prices, nats: dozens of candidates are looked at, and a line's place and ends are free; a direction costs as much.
Among 32 synthetic facades without inclined lines the best false one gains 6.6."""

LEAST_ON_REQUEST = 0.5
"""Of the edge pixels that are asked for else, where the user asks for inclined lines."""

SECONDS_EACH = 0.003
"""Of one core, for a candidate in a picture of 1600 px."""

SAME_DIRECTION_RAD = np.radians(1.5)

LEAST_FAMILY = 3
"""Lines of one direction from which their spacing is taken."""

EXPECTED_LINE, LEAST_EXPECTED, EXPECTED_WITHIN_PX = 1.0, 0.6, 3.0
"""Price, fewest panes, and tolerance of a line that equal spacing lets expect: only whether it is there is free."""

LEAST_STEP_PX = 20.0
"""Lines closer than this are profiles of two panes that touch."""

BETWEEN = 0.3
"""Of the spacing, from known lines to where another may be expected."""

NODE_PX = 8.0
"""From the crossing of a column and a row to the end of the last piece of a line that runs through it."""

LEAST_LEFT = 2.0
"""Log odds that a line must keep when the panes that do not show it are counted, too."""


@dataclass(frozen=True, slots=True)
class InclinedEdges:
    """The effect: it is on where so many edge pixels lie on one inclined line that they may be those of a profile."""

    tolerance: float
    name: str = say("inclined lines")
    unit: str = say("edge pixels on one line")

    def assess(self, scene: tuple[Candidate, ...]) -> Assessment:
        """From the candidates, the strongest first."""
        if not scene:
            return Assessment(0.0, say("no inclined line has edges enough for a profile through three panes"), 0.0)
        reason = say("{} inclined lines have edges enough for a profile through three panes", len(scene))
        return Assessment(float(scene[0].votes), reason, SECONDS_EACH * len(scene))


def inclined_lines(
    axes: Axes, rows: tuple[GridLine, ...], columns: tuple[GridLine, ...], parameters: SegmentationParameters
) -> tuple[tuple[InclinedLine, ...], Decision | None]:
    """Inclined profiles of the facade whose grid was found, the surest first, and whether any were looked for.

    None of both where there is no grid.
    """
    if len(rows) < 2 or len(columns) < 2:
        return (), None
    height, width = axes.down.edges.is_edge.shape
    panes = Panes.of(rows, columns, (width, height), parameters)
    effect = InclinedEdges(panes.least_votes)
    if parameters.inclined == "off":
        return (), decide(effect, (), "off")
    points = inclined_points(axes, rows, columns, (0, 0, width, height))
    least = panes.least_votes * (LEAST_ON_REQUEST if parameters.inclined == "on" else 1.0)
    tried = candidates(points, least)
    decision = decide(effect, tried, parameters.inclined)
    found: list[Profile] = []
    for candidate in tried if decision.on else ():
        price = NEW_LINE + (0.0 if _is_known(candidate.angle_rad, found) else NEW_DIRECTION)
        line = profile_at(panes, points, candidate, price)
        if line is not None:
            found.append(line)
            points = points.without(line.claims(points))
    found += expected_lines(panes, points, found)
    return tuple(line.as_line() for line in completed(panes, found)), decision


def _is_known(angle_rad: float, found: list[Profile]) -> bool:
    """Whether the facade has this direction, or its mirror image, already."""
    return any(
        abs((angle_rad - known + 0.5 * np.pi) % np.pi - 0.5 * np.pi) < SAME_DIRECTION_RAD
        for line in found
        for known in (line.angle_rad, -line.angle_rad)
    )


def expected_lines(panes: Panes, points: EdgePoints, found: list[Profile]) -> list[Profile]:
    """Lines where equal spacing lets them be expected, however short: those in the corners of a diagrid."""
    more: list[Profile] = []
    for family in _families(found):
        angle = float(np.mean([line.angle_rad for line in family]))
        middles = np.sort([line.middle_at(angle) for line in family])
        step = _common_step(np.diff(middles))
        if step is None:
            continue
        low, high = panes.span_at(angle)
        steps = np.arange(np.ceil((low - middles[0]) / step), np.floor((high - middles[0]) / step) + 1.0)
        for place in (middles[0] + steps * step).tolist():
            if np.abs(middles - place).min() < BETWEEN * step:
                continue
            line = profile_at(panes, points, Candidate(angle, place, 0), EXPECTED_LINE, LEAST_EXPECTED)
            if line is not None and abs(line.middle_at(angle) - place) <= EXPECTED_WITHIN_PX:
                more.append(line)
    return more


def completed(panes: Panes, found: list[Profile]) -> list[Profile]:
    """Lines drawn out to where profiles end: at a node, at another's end, or at the border of the grid.

    No more than as far again as they are seen, and as long as little speaks against it. Where most lines of a direction
    end at the border, all of them do, at the price of lines that are expected.
    """
    to_border = [line for family in _families(found) if _share_at_border(family) > 0.5 for line in family]
    done = []
    for line in found:
        only_border = any(line is one for one in to_border)
        ends = [other.at(place) for other in found if other is not line for place in (other.from_px, other.to_px)]
        if only_border:
            line = replace(line, price=min(line.price, EXPECTED_LINE))
        for step in (-1, 1):
            drawn_out = _drawn_out(panes, line, step, ends, only_border)
            is_short = drawn_out.stop - drawn_out.start <= 2 * (line.stop - line.start)
            if is_short and drawn_out.gain > LEAST_LEFT:
                line = drawn_out
        done.append(line)
    return done


def _share_at_border(family: list[Profile]) -> float:
    return float(np.mean([not line.goes_on(index) for line in family for index in (line.start - 1, line.stop)]))


def _drawn_out(panes: Panes, line: Profile, step: int, ends: list[Array], only_border: bool) -> Profile:
    start, stop = line.start, line.stop
    while line.goes_on(start - 1 if step < 0 else stop):
        end = line.at(float(line.pieces.start[start] if step < 0 else line.pieces.stop[stop - 1]))
        meets = any(float(np.linalg.norm(end - other)) <= 2.0 * NODE_PX for other in ends)
        if not only_border and (meets or panes.is_node(end, NODE_PX)):
            break
        start, stop = (start - 1, stop) if step < 0 else (start, stop + 1)
    return replace(line, start=start, stop=stop)


def _families(found: list[Profile]) -> list[list[Profile]]:
    """Lines of one direction, three at least."""
    families: list[list[Profile]] = []
    for line in found:
        for family in families:
            if abs(line.angle_rad - family[0].angle_rad) < SAME_DIRECTION_RAD:
                family.append(line)
                break
        else:
            families.append([line])
    return [family for family in families if len(family) >= LEAST_FAMILY]


def _common_step(gaps: Array) -> float | None:
    """The spacing of which most gaps are multiples, to `EXPECTED_WITHIN_PX`; None where they have none."""
    step = float(np.min(gaps))
    multiples = np.maximum(1.0, np.round(gaps / max(step, 1.0)))
    step = float(np.median(gaps / multiples))
    off = np.abs(gaps - multiples * step)
    return step if step >= LEAST_STEP_PX and (off <= EXPECTED_WITHIN_PX).mean() > 0.5 else None


Lines = tuple[GridLine, ...]

LEAST_SHARE = 0.4
"""Of what is seen of the grid's lines on one side of an inclined one, that the other side must show to hold panels,
too: as for the grid's own borders (`extent.py`)."""

LEAST_USUAL = 0.5
"""Of what is usually seen of the grid's lines, that the side with panels shows."""

MARGIN_PX = 4.0
"""Off the profile, where its own edges would be taken for those of the lines that meet it."""

LEAST_PIECES = 2
"""Of grid lines on each side, to tell."""

LEAST_ROOM = 0.15
"""Of the usual row: what remains above the last one and is lower holds no panels."""

MOST_OF_POINT = 0.3
"""Of the facade's width, that may reach as far as its point: where more does, a line of the grid ends it."""

MOST_NEW = 12
"""Rounds of looking for rows in the part of the width that reaches higher than those found."""


@dataclass(frozen=True, slots=True)
class Arrangement:
    """Lines of the grid, with those that an inclined edge leaves room for, and all inclined lines.

    `decision` says why inclined lines were looked for, or not; None where there is no grid.
    """

    rows: Lines
    columns: Lines
    inclined: tuple[InclinedLine, ...]
    decision: Decision | None


def arranged(axes: Axes, rows: Lines, columns: Lines, parameters: SegmentationParameters) -> Arrangement:
    """What inclined lines there are beside those of a grid, and what they make of it."""
    found, decision = inclined_lines(axes, rows, columns, parameters)
    if not found:
        return Arrangement(rows, columns, (), decision)
    sides = _Sides(axes, rows, columns)
    found = tuple(replace(line, open_side=sides.open_side(line)) for line in found)
    found = _within(found)
    for is_after in (False, True):
        rows = _with_lines_beyond(axes.across, rows, columns, _transposed(found), parameters, is_after)
        columns = _with_lines_beyond(axes.down, columns, rows, found, parameters, is_after)
    return Arrangement(rows, columns, found, decision)


def _within(inclined: tuple[InclinedLine, ...]) -> tuple[InclinedLine, ...]:
    """Lines that do not lie beyond the facade's edge, as the far side of a wall beside it does."""
    cuts = cuts_of(inclined)
    return tuple(
        line
        for line, cut in zip(inclined, cuts, strict=True)
        if not any(other.closes(0.5 * (cut.first + cut.last)) for other in cuts if other is not cut)
    )


class _Sides:
    """What is seen of the grid's lines beside inclined ones."""

    def __init__(self, axes: Axes, rows: Lines, columns: Lines) -> None:
        self._directions = [
            (columns, [_seen(axes.down, line) for line in columns], _step(rows), 0),
            (rows, [_seen(axes.across, line) for line in rows], _step(columns), 1),
        ]
        spans = [slice(int(lines[0].position_px), int(lines[-1].position_px)) for lines in (rows, columns)]
        shares = [
            picture[span].mean()
            for (_, pictures, _, _), span in zip(self._directions, spans, strict=True)
            for picture in pictures
        ]
        self._usual = float(np.median(shares))

    def open_side(self, line: InclinedLine) -> int:
        """As in `InclinedLine`."""
        seen: dict[int, list[float]] = {1: [], -1: []}
        (cut,) = cuts_of([line])
        along = cut.last - cut.first
        for lines, pictures, step_px, across in self._directions:
            if abs(along[across]) < 1e-9:
                continue
            slant = float(np.hypot(*along) / abs(along[across]))
            margin = cut.half_width * slant + MARGIN_PX
            for grid_line, picture in zip(lines, pictures, strict=True):
                share = (grid_line.position_px - cut.first[across]) / along[across]
                place = cut.first[1 - across] + share * along[1 - across]
                for ahead in (-1.0, 1.0):
                    ends = np.sort([place + ahead * margin, place + ahead * (margin + 0.8 * step_px)])
                    if not (0.0 <= share <= 1.0 and ends[0] >= 0.0 and ends[1] <= len(picture)):
                        continue
                    point = np.zeros(2)
                    point[across], point[1 - across] = grid_line.position_px, ends.mean()
                    side = 1 if float(cut.signed(point[None])[0]) > 0.0 else -1
                    seen[side].append(float(picture[int(ends[0]) : int(ends[1]) + 1].mean()))
        if min(map(len, seen.values())) < LEAST_PIECES:
            return 0
        right, left = (float(np.mean(seen[side])) for side in (1, -1))
        if max(right, left) < LEAST_USUAL * self._usual or min(right, left) >= LEAST_SHARE * max(right, left):
            return 0
        return 1 if right > left else -1


def _seen(axis: Axis, line: GridLine) -> NDArray[np.bool_]:
    """Whether an edge of a line along the columns of an axis is seen in each of its rows."""
    return np.asarray(seen_along(axis.edges.is_edge, line).any(axis=0))


def _with_lines_beyond(
    axis: Axis,
    lines: Lines,
    crossing: Lines,
    inclined: Sequence[InclinedLine],
    parameters: SegmentationParameters,
    is_after: bool,
) -> Lines:
    """Lines with those beyond the first (the last, where `is_after`) that lie within the facade's inclined edge.

    Everything as the axis has it: its lines run along its columns, and points are (across them, along them).
    """
    along = np.arange(crossing[0].position_px, crossing[-1].position_px)
    sign = 1.0 if is_after else -1.0
    edge = _edge(along, inclined, sign)
    if edge is None:
        return lines
    usual, limit = _step(lines), float((sign * edge).max())
    for _ in range(MOST_NEW):
        outermost = lines[-1 if is_after else 0].position_px
        reaches = sign * (edge - outermost) > 0.5 * usual
        if reaches.sum() < _step(crossing):
            break
        strip = float(along[reaches].min()), float(along[reaches].max())
        found = find_lines(axis, strip, parameters)
        new = tuple(
            one for one in found if 0.3 * usual < sign * (one.position_px - outermost) < limit - sign * outermost
        )
        if not new:
            break
        lines = (*lines, *new) if is_after else (*new, *lines)
    outermost = lines[-1 if is_after else 0].position_px
    is_point = float((sign * edge > limit - LEAST_ROOM * usual).mean()) < MOST_OF_POINT
    if is_point and limit - sign * outermost > LEAST_ROOM * usual:
        # A little further out than the inclined edges were followed: it is they that cut the cells below it.
        tip = GridLine(sign * (limit + LEAST_ROOM * usual), 0.0, 1.0, 1.0, is_inferred=True)
        lines = (*lines, tip) if is_after else (tip, *lines)
    return lines


def _edge(along: Array, inclined: Sequence[InclinedLine], sign: float) -> Array | None:
    """How far the facade reaches across an axis at each place along it, by its inclined edges on one side.

    Beyond their ends, and between two of them, it goes on straight. None where there are no such edges.
    """
    places, reaches = [], []
    for line, cut in zip(inclined, cuts_of(inclined), strict=True):
        run = abs(cut.last[1] - cut.first[1])
        inwards = 0.5 * (cut.first + cut.last) - np.array([sign, 0.0])
        if line.open_side and run >= 1.0 and line.open_side * float(cut.signed(inwards[None])[0]) > 0.0:
            places += [float(cut.first[1]), float(cut.last[1])]
            reaches += [float(cut.first[0]), float(cut.last[0])]
    if not places:
        return None
    order = np.argsort(places, kind="stable")
    return np.asarray(np.interp(along, np.array(places)[order], np.array(reaches)[order]))


def _transposed(inclined: Sequence[InclinedLine]) -> list[InclinedLine]:
    """As the transposed picture shows them."""
    return [
        replace(line, first_px=line.first_px[::-1], last_px=line.last_px[::-1], open_side=-line.open_side)
        for line in inclined
    ]


def _step(lines: Lines) -> float:
    return float(np.median(np.diff([line.position_px for line in lines])))
