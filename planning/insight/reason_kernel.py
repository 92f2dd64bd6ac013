"""Which rules forbid the places from which one hemisphere section would be seen; compiled.

The directions of a section times a row of distances are places from which its panel would be covered, were it allowed
to be there. Each place is held against every rule. A rule that is the only one broken somewhere is enough to explain
the section: were it relaxed by the amount found there, that place would be a viewpoint. The place at which it is broken
least is then sought more closely by a pattern search (R. Hooke and T. Jeeves, 1961, with axis steps only).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.coverage.reach_kernel import ANGLE_MARGIN, Bodies, Limits
from planning.geo.bvh import nearest_d2, segment_is_free
from planning.geo.solids import _is_inside

Array = NDArray[np.float64]

N_RULES = 10
GIMBAL_UP, GIMBAL_DOWN, FLOOR, CEILING, SIDES, RANGE, DISTANCE, NO_FLY, GROUND, HIDDEN = range(N_RULES)
"""Numbers of the rules. A place inside a solid breaks DISTANCE by its depth and the whole distance."""

IMMOVABLE = 1e6
"""Added to the amount of rules that are broken together where one of them cannot give: others are better advice."""

NEAREST_M = 0.5
N_DISTANCES = 24
"""Distances tried, evenly in their logarithm, from `NEAREST_M` to beyond the airspace: 28 % apart at 150 m."""

INSET = 1e-3
"""Directions stay this part of a section's width away from its borders, out of reach of rounding."""

REFINING_STEPS = 6
"""Halvings of the pattern search: to 1.6 % of the sampling's spacing."""


class Question(NamedTuple):
    """One section.

    The panel as centroid, normal, tangent, bitangent (shape (12,)), where lines of sight end (3,), lowest and highest
    theta and phi (4,), and the greatest distance tried, metres.
    """

    panel: Array
    target: Array
    bounds: Array
    farthest: float


class World(NamedTuple):
    """What places are held against."""

    limits: Limits
    ground: float
    solids: Bodies
    no_fly: Bodies


@kernel
def broken_rules(
    p: Array, elevation: float, distance: float, target: Array, world: World, most: int, best: Array, amounts: Array
) -> int:
    """Rules that a place p breaks, as bits; -1 where they are more than `most`, or one and no better than known.

    Parameters
    ----------
    elevation
        Of the panel as seen from p, radians.
    best
        Shape (N_RULES,): the least amount known by which each rule is broken alone.
    amounts
        Shape (N_RULES,); set to how much each rule would have to give: degrees, metres, or 0 where it cannot.
    """
    limits = world.limits
    amounts[:] = 0.0
    amounts[GIMBAL_UP] = np.degrees(elevation - (np.arcsin(limits.highest_sine) - ANGLE_MARGIN))
    amounts[GIMBAL_DOWN] = np.degrees(np.arcsin(limits.lowest_sine) + ANGLE_MARGIN - elevation)
    amounts[FLOOR] = limits.low[2] + limits.margin - p[2]
    amounts[CEILING] = p[2] - limits.high[2] + limits.margin
    for axis in range(2):
        outside = max(limits.low[axis] - p[axis], p[axis] - limits.high[axis]) + limits.margin
        amounts[SIDES] = max(amounts[SIDES], outside)
    amounts[RANGE] = distance - limits.max_distance + limits.margin
    mask, n, broken = 0, 0, 0
    for rule in range(RANGE + 1):
        if amounts[rule] > 0.0:
            broken = rule
            if rule == FLOOR and p[2] < world.ground:
                broken = GROUND
                amounts[FLOOR] = 0.0
            mask, n = mask | (1 << broken), n + 1
        else:
            amounts[rule] = 0.0
    if n > most or (n == 1 and amounts[broken] >= best[broken]):
        return -1
    short = limits.need_distance - distance  # at least: the pane itself is no further away
    if short > 0.0 and (n >= most or (n == 0 and short >= best[DISTANCE])):
        return -1
    mask, n = _keep_away(DISTANCE, p, limits.need_distance, world.solids, mask, n, most, best, amounts)
    if n <= most and len(world.no_fly.part) > 0:
        mask, n = _keep_away(NO_FLY, p, limits.need_no_fly, world.no_fly, mask, n, most, best, amounts)
    if n <= most and limits.occlusion and not segment_is_free(world.solids.bvh, target, p):
        mask, n = mask | (1 << HIDDEN), n + 1
    return mask if n <= most else -1


@kernel
def _keep_away(
    rule: int, p: Array, needed: float, bodies: Bodies, mask: int, n: int, most: int, best: Array, amounts: Array
) -> tuple[int, int]:
    """`mask` and `n` with `rule` added where p is nearer than `needed` or inside; n beyond `most` where that ends it.

    The inside test costs more than all others, so it is left out where it can change nothing.
    """
    distance = np.sqrt(nearest_d2(bodies.bvh, p, needed * needed))
    if distance < needed and (n >= most or (n == 0 and needed - distance >= best[rule])):
        return mask, N_RULES + 1
    if _is_inside(bodies.bvh, bodies.part, p, bodies.reach, bodies.rays):
        distance = -np.sqrt(nearest_d2(bodies.bvh, p, np.inf))
    if distance >= needed:
        return mask, n
    amounts[rule] = needed - distance
    if n == 0 and amounts[rule] >= best[rule]:
        return mask, N_RULES + 1
    return mask | (1 << rule), n + 1


@kernel
def _look(place: Array, question: Question, world: World, most: int, best: Array, amounts: Array, p: Array) -> int:
    """`broken_rules` of the place at (theta, phi, distance), each as a part of its range; fills `p`."""
    panel, bounds = question.panel, question.bounds
    theta = bounds[0] + (INSET + (1.0 - 2.0 * INSET) * place[0]) * (bounds[1] - bounds[0])
    phi = bounds[2] + (INSET + (1.0 - 2.0 * INSET) * place[1]) * (bounds[3] - bounds[2])
    distance = NEAREST_M * (question.farthest / NEAREST_M) ** place[2]
    up, right, high = np.cos(theta), np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi)
    vertical = 0.0
    for axis in range(3):
        d = up * panel[3 + axis] + right * panel[6 + axis] + high * panel[9 + axis]
        p[axis] = panel[axis] + distance * d
        vertical = d
    elevation = np.arcsin(min(max(-vertical, -1.0), 1.0))
    return broken_rules(p, elevation, distance, question.target, world, most, best, amounts)


@kernel
def _refine(
    rule: int, spacing: Array, question: Question, world: World, place: Array, amounts: Array, p: Array
) -> None:
    """Move `place`, where `rule` alone is broken, to where it is broken less; updates its `amounts` and `p`."""
    trial, trial_amounts, trial_p, best = np.empty(3), np.empty(N_RULES), np.empty(3), np.zeros(N_RULES)
    best[rule] = amounts[rule]
    step, halvings = 0.5, 0
    while halvings < REFINING_STEPS:
        moved = False
        for axis in range(3):
            for sign in (-1.0, 1.0):
                trial[:] = place
                trial[axis] = min(max(place[axis] + sign * step * spacing[axis], 0.0), 1.0)
                if _look(trial, question, world, 1, best, trial_amounts, trial_p) == 1 << rule:
                    place[:], amounts[:], p[:] = trial, trial_amounts, trial_p
                    best[rule] = amounts[rule]
                    moved = True
        if not moved:
            step *= 0.5
            halvings += 1


@kernel
def explain_section(
    question: Question, world: World, n_angles: int, masks: NDArray[np.int64], amounts: Array, places: Array
) -> int:
    """Why no place covers a section: rows of rules that are broken together, and how many there are.

    Each rule that is the only one broken somewhere gives a row, at the place where it is broken least; where there is
    none, the one row is the place that breaks the fewest rules. 0 rows where some place breaks none.

    Parameters
    ----------
    n_angles
        Directions tried along each angle, 2 or more.
    masks, amounts, places
        Output, shapes (N_RULES,), (N_RULES, N_RULES), (N_RULES, 3): rules broken as bits, by how much, and where.
    """
    spacing = np.array([1.0 / (n_angles - 1), 1.0 / (n_angles - 1), 1.0 / (N_DISTANCES - 1)])
    anything = np.full(N_RULES, np.inf)
    best, best_place = anything.copy(), np.zeros((N_RULES, 3))
    found, p, place = np.empty(N_RULES), np.empty(3), np.empty(3)
    fewest, together, least = N_RULES, 0, np.inf
    for i in range(n_angles):
        for j in range(n_angles):
            for k in range(N_DISTANCES):
                place[0], place[1], place[2] = i * spacing[0], j * spacing[1], k * spacing[2]
                mask = _look(place, question, world, fewest, best, found, p)
                if mask == 0:
                    return 0
                if mask < 0:
                    continue
                n = 0
                for rule in range(N_RULES):
                    n += (mask >> rule) & 1
                total = found.sum() + (IMMOVABLE if n > 1 and mask >> GROUND > 0 else 0.0)
                if n < fewest or (fewest > 1 and total < least):
                    fewest, together, least = n, mask, total
                    masks[0], amounts[0], places[0] = mask, found, p
                if n == 1:
                    rule = int(np.round(np.log2(mask)))
                    if total < best[rule]:
                        best[rule], best_place[rule] = total, place
    if fewest > 1:
        return 1 if together > 0 else 0
    n_rows = 0
    for rule in range(N_RULES):
        if best[rule] < np.inf:
            _look(best_place[rule], question, world, 1, anything, amounts[n_rows], places[n_rows])
            if rule < GROUND:
                _refine(rule, spacing, question, world, best_place[rule], amounts[n_rows], places[n_rows])
            masks[n_rows] = 1 << rule
            n_rows += 1
    return n_rows


@kernel
def explain_sections(
    panels: Array,
    targets: Array,
    farthest: Array,
    panel_of: NDArray[np.int64],
    bounds: Array,
    world: World,
    n_angles: int,
    n_rows: NDArray[np.int64],
    masks: NDArray[np.int64],
    amounts: Array,
    places: Array,
) -> None:
    """`explain_section` for k sections: panel numbers (k,), bounds (k, 4); outputs have k as first axis."""
    for i in range(len(panel_of)):
        j = panel_of[i]
        question = Question(panels[j], targets[j], bounds[i], farthest[j])
        n_rows[i] = explain_section(question, world, n_angles, masks[i], amounts[i], places[i])
