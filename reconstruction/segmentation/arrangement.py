"""Inclined lines of a facade: profiles that run straight through pane after pane, beside the lines of its grid.

Neither the edge of a mirrored roof (one edge, displaced from pane to pane, because no two panes are quite parallel) nor
that of a shadow (one edge) looks like a profile (`profiles.py`). A new direction costs more than one that the facade
has already, mirrored or not. Lines of one direction are often equally spaced, which lets short ones be expected; and
they do not end in the middle of a pane.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.effects import Assessment, Decision, decide
from reconstruction.segmentation.grid import Axes
from reconstruction.segmentation.inclined import Candidate, EdgePoints, candidates, inclined_points
from reconstruction.segmentation.panes import Panes
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.profiles import Profile, profile_at
from reconstruction.segmentation.record import GridLine, InclinedLine

Array = NDArray[np.float64]

NEW_LINE, NEW_DIRECTION = 6.0, 6.0
"""Prices, nats: dozens of candidates are looked at, and a line's place and ends are free; a direction costs as much.
Among 32 made facades without inclined lines the best false one gains 6.6."""

LEAST_WHERE_ASKED = 0.5
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
    name: str = "inclined lines"
    unit: str = "edge pixels on one line"

    def assess(self, scene: tuple[Candidate, ...]) -> Assessment:
        """From the candidates, the strongest first."""
        if not scene:
            return Assessment(0.0, "no inclined line has edges enough for a profile through three panes", 0.0)
        reason = f"{len(scene)} inclined lines have edges enough for a profile through three panes"
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
    least = panes.least_votes * (LEAST_WHERE_ASKED if parameters.inclined == "on" else 1.0)
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
