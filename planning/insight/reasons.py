"""Why sections cannot be covered: the rules that forbid it, by how much, and what is in the way.

That a section is unreachable is proven elsewhere (`planning.coverage.reachability`); why is found by samples. Places
in the section's directions, at distances from half a metre to beyond the airspace, are held against every rule. Proven
of a reason is its place: it breaks the named rules by the named amounts and no other rule, so that relaxing them by
that much makes the section reachable. Sampled is that no other rule, and no smaller amount, would do.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel, n_threads, run_parallel
from planning.base.messages import joined, say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import CoverageModel, exact_sections
from planning.coverage.positions import aimed_views, hemisphere_direction, sobol
from planning.coverage.reach_kernel import (
    ANGLE_MARGIN,
    REACHABLE,
    UNDECIDED,
    UNREACHABLE,
    Bodies,
    Limits,
    terrain_below,
)
from planning.coverage.reachability import reach_bodies, reach_limits
from planning.geo.bvh import nearest_d2, segment_is_free
from planning.geo.frames import Vec3
from planning.geo.solids import _is_inside
from planning.insight.obstructions import (
    Obstruction,
    Obstructions,
    first_obstructions_hit,
    nearest_obstructions,
    obstructions_of,
)
from planning.site.free_space import FreeSpace
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared
from planning.viewpoints.problem import ViewProblem

Array = NDArray[np.float64]


# Which rules forbid the places from which one hemisphere section would be seen; compiled.
#
# The directions of a section times a row of distances are places from which its panel would be covered, were it allowed
# to be there. Each place is held against every rule. A rule that is the only one broken somewhere is enough to explain
# the section: were it relaxed by the amount found there, that place would be a viewpoint. The place at which it is
# broken least is then sought more closely by a pattern search (R. Hooke and T. Jeeves, 1961, with axis steps only).

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
def _broken_rules(
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
    amounts[FLOOR], ground = limits.low[2] + limits.margin - p[2], world.ground
    if limits.terrain.size > 0:
        ground = terrain_below(p, limits)
        amounts[FLOOR] = max(amounts[FLOOR], ground + limits.min_height + limits.margin - p[2])
    amounts[CEILING] = p[2] - limits.high[2] + limits.margin
    for axis in range(2):
        outside = max(limits.low[axis] - p[axis], p[axis] - limits.high[axis]) + limits.margin
        amounts[SIDES] = max(amounts[SIDES], outside)
    amounts[RANGE] = distance - limits.max_distance + limits.margin
    mask, n, broken = 0, 0, 0
    for rule in range(RANGE + 1):
        if amounts[rule] > 0.0:
            broken = rule
            if rule == FLOOR and p[2] < ground:
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
    """`_broken_rules` of the place at (theta, phi, distance), each as a part of its range; fills `p`."""
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
    return _broken_rules(p, elevation, distance, question.target, world, most, best, amounts)


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
def _explain_section(
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
    """`_explain_section` for k sections: panel numbers (k,), bounds (k, 4); outputs have k as first axis."""
    for i in range(len(panel_of)):
        j = panel_of[i]
        question = Question(panels[j], targets[j], bounds[i], farthest[j])
        n_rows[i] = _explain_section(question, world, n_angles, masks[i], amounts[i], places[i])


# Sections that some allowed place covers, but to none of which a way from home was found.

N_PLACES = 256
"""Places tried in a section whose witness cannot be flown to."""


def unflyable_sections(
    problem: ViewProblem, verdicts: NDArray[np.int8], monitor: Monitor = QUIET
) -> tuple[NDArray[np.int64], Array]:
    """Sections whose witness, and whatever else was tried, cannot be flown to, of those that `verdicts` call reachable.

    Parameters
    ----------
    verdicts
        Those of the problem, or of a part of its panels; shape (m, n_sections).

    Returns
    -------
    elements
        Panel * n_sections + section, rising, shape (k,).
    places_enu_m
        Their witnesses, shape (k, 3).
    """
    reachable = np.flatnonzero(verdicts == REACHABLE)
    witnesses = problem.reachability.witnesses_enu_m.reshape(-1, 3)
    doubtful = reachable[~problem.roadmap.connected_to_home(witnesses[reachable])]
    kept = []
    for number, element in enumerate(doubtful):
        monitor.report(say("looking for ways to viewpoints"), number, len(doubtful))
        if not _has_flyable_place(problem, *divmod(int(element), problem.model.grid.n_sections)):
            kept.append(element)
    elements = np.array(kept, np.int64)
    return elements, witnesses[elements]


def _has_flyable_place(problem: ViewProblem, panel: int, section: int) -> bool:
    """Whether one of some places in a section covers it and can be flown to."""
    model, space = problem.model, problem.space
    panels = np.full(N_PLACES, panel)
    low_theta, high_theta, low_phi, high_phi = model.grid.bounds_rad(section)
    part = sobol(N_PLACES, np.random.default_rng(0))
    theta, phi = low_theta + part[:, 0] * (high_theta - low_theta), low_phi + part[:, 1] * (high_phi - low_phi)
    directions = hemisphere_direction(model.frames, panels, theta, phi)
    nearest = max(space.min_distance_m, 0.5)
    farthest = max(2.0 * nearest, float(np.linalg.norm(space.high_enu_m - space.low_enu_m)))
    distance = nearest * (farthest / nearest) ** part[:, 2]
    places = model.frames.centroids[panels] + distance[:, None] * directions
    places = places[problem.flyable(places)]
    views = aimed_views(places, np.broadcast_to(model.frames.centroids[panel], places.shape), model.camera)
    return bool((exact_sections(model, views)[:, panel] == section).any())


SECTIONS_PER_CHUNK = 32
BEYOND = 1.25
"""Distances are tried up to this many times the distance to the far corner of the airspace."""


class Rule(StrEnum):
    """What can forbid all places from which a section would be covered; the first ten in the order of the kernel."""

    GIMBAL_UP = "gimbal-up"
    GIMBAL_DOWN = "gimbal-down"
    FLOOR = "airspace-floor"
    CEILING = "airspace-ceiling"
    SIDES = "airspace-sides"
    RANGE = "max-distance"
    DISTANCE = "min-distance"
    NO_FLY = "no-fly"
    GROUND = "ground"
    HIDDEN = "hidden"
    UNFLYABLE = "unflyable"

    @property
    def unit(self) -> str:
        """Of the amount by which it is broken; empty for rules that hold or do not."""
        if self in (Rule.GROUND, Rule.HIDDEN, Rule.UNFLYABLE):
            return ""
        return "deg" if self in (Rule.GIMBAL_UP, Rule.GIMBAL_DOWN) else "m"


RULES = tuple(Rule)


@dataclass(frozen=True, slots=True)
class BrokenRule:
    """One rule and by how much a place breaks it.

    Parameters
    ----------
    amount
        In the unit of the rule; 0 where it has none.
    obstruction
        What is too close, entered or in the way; None for other rules.
    inside
        The place lies inside `obstruction`: no smaller minimum distance would do.
    """

    rule: Rule
    amount: float
    obstruction: Obstruction | None = None
    inside: bool = False

    def __str__(self) -> str:
        """What is wrong with the place, in the pilot's words."""
        amount, obstruction = f"{self.amount:.3g}", self.obstruction
        if self.rule in (Rule.DISTANCE, Rule.NO_FLY):
            return say("inside {}", obstruction) if self.inside else say("{} m too close to {}", amount, obstruction)
        return {
            Rule.GIMBAL_UP: say("{} degrees above what the camera sees with the gimbal at its limit", amount),
            Rule.GIMBAL_DOWN: say("{} degrees below what the camera sees with the gimbal at its limit", amount),
            Rule.FLOOR: say("{} m below the lowest flight allowed", amount),
            Rule.CEILING: say("{} m above the ceiling of the airspace", amount),
            Rule.SIDES: say("{} m beyond the sides of the airspace", amount),
            Rule.RANGE: say("{} m too far away for the largest distance or pixel size allowed", amount),
            Rule.GROUND: say("below the ground, or where it is not known"),
            Rule.HIDDEN: say("hidden by {}", obstruction),
            Rule.UNFLYABLE: say("no way to it was found from home"),
        }[self.rule]


@dataclass(frozen=True, slots=True)
class Reason:
    """What would make a section reachable: its rules, relaxed together at this place."""

    broken: tuple[BrokenRule, ...]
    place_enu_m: Vec3

    def __str__(self) -> str:
        """The rules, joined."""
        return joined(" and ", (str(rule) for rule in self.broken))


@dataclass(frozen=True, slots=True, eq=False)
class SectionReasons:
    """Reasons of all sections that cannot be covered.

    Parameters
    ----------
    shape
        Panels and sections of the site, (m, s).
    elements
        Element (panel * s + section) of each of q reasons, rising, shape (q,). The reasons of one section are in
        order of how little would have to give (metres and degrees count alike); what cannot give comes last.
    masks
        Rules broken, shape (q,): bit r for `RULES[r]`.
    amounts, obstructions
        By how much, and the number of the thing, shape (q, len(RULES)); 0 and -1 where there is none.
    places_enu_m
        Shape (q, 3).
    all_obstructions
        Names of the things.
    min_distance_m, no_fly_distance_m
        Kept from solids and no-fly volumes, with margin: what breaks the rule by more lies inside.
    """

    shape: tuple[int, int]
    elements: NDArray[np.int64]
    masks: NDArray[np.int64]
    amounts: Array
    obstructions: NDArray[np.int64]
    places_enu_m: Array
    all_obstructions: tuple[Obstruction, ...]
    min_distance_m: float
    no_fly_distance_m: float

    def of(self, panel: int, section: int) -> tuple[Reason, ...]:
        """Reasons of one section, the most helpful first; none where it can be covered."""
        element = panel * self.shape[1] + section
        first, last = np.searchsorted(self.elements, [element, element + 1])
        return tuple(self._reason(row) for row in range(first, last))

    def first_masks(self) -> NDArray[np.int64]:
        """Rules of the first reason of each section, shape (m, s), bit r for `RULES[r]`; 0 for none."""
        masks = np.zeros(self.shape[0] * self.shape[1], np.int64)
        element, first = np.unique(self.elements, return_index=True)
        masks[element] = self.masks[first]
        return masks.reshape(self.shape)

    def counts(self) -> dict[tuple[Rule, ...], int]:
        """Number of sections by the rules of their first reason, the most frequent first."""
        masks = self.first_masks()
        counted = Counter(masks[masks > 0].tolist())
        return {rules_of(mask): count for mask, count in counted.most_common()}

    def _reason(self, row: int) -> Reason:
        x, y, z = (float(value) for value in self.places_enu_m[row])
        return Reason(tuple(self._broken(row, rule) for rule in rules_of(int(self.masks[row]))), (x, y, z))

    def _broken(self, row: int, rule: Rule) -> BrokenRule:
        number = RULES.index(rule)
        amount, obstruction = float(self.amounts[row, number]), int(self.obstructions[row, number])
        kept = {Rule.DISTANCE: self.min_distance_m, Rule.NO_FLY: self.no_fly_distance_m}.get(rule, np.inf)
        return BrokenRule(
            rule, amount, self.all_obstructions[obstruction] if obstruction >= 0 else None, amount >= kept
        )


def rules_of(mask: int) -> tuple[Rule, ...]:
    """Rules whose bits are set."""
    return tuple(rule for number, rule in enumerate(RULES) if mask >> number & 1)


def section_reasons(
    site_model: SiteModel,
    prepared: Prepared,
    panels: NDArray[np.int64] | None = None,
    monitor: Monitor = QUIET,
) -> SectionReasons:
    """Why each section that is proven unreachable, or cannot be flown to, cannot be covered.

    Sections that stay undecided get no reason.

    Parameters
    ----------
    panels
        Numbers of the panels asked about; all where None. One panel takes milliseconds, also with fine sections.
    """
    problem = prepared.problem
    model, space = problem.model, problem.space
    obstructions = obstructions_of(site_model, space)
    shape = problem.reachability.verdicts.shape
    verdicts = np.full(shape, UNDECIDED, np.int8)
    panel_rows = slice(None) if panels is None else panels
    verdicts[panel_rows] = problem.reachability.verdicts[panel_rows]
    unreachable = np.flatnonzero(verdicts == UNREACHABLE)
    elements, masks, amounts, places = _explain(model, space, site_model.site.airspace.ground_z_m, unreachable, monitor)
    cut_off, cut_off_places = unflyable_sections(problem, verdicts, monitor)
    elements, places = np.concatenate([elements, cut_off]), np.concatenate([places, cut_off_places])
    masks = np.concatenate([masks, np.full(len(cut_off), 1 << RULES.index(Rule.UNFLYABLE))])
    amounts = np.pad(amounts, ((0, len(cut_off)), (0, len(RULES) - N_RULES)))
    named = _name_things(model, space, obstructions, elements // shape[1], masks, places)
    limits = reach_limits(model, space)
    immovable = (masks >> GROUND > 0) | (amounts[:, DISTANCE] >= limits.need_distance)
    order = np.lexsort([masks, amounts.sum(axis=1), immovable, elements])
    return SectionReasons(
        (shape[0], shape[1]),
        elements[order],
        masks[order],
        amounts[order],
        named[order],
        places[order],
        obstructions.all,
        limits.need_distance,
        limits.need_no_fly,
    )


def _explain(
    model: CoverageModel, space: FreeSpace, ground_z_m: float, elements: NDArray[np.int64], monitor: Monitor
) -> tuple[NDArray[np.int64], NDArray[np.int64], Array, Array]:
    """Rows of reasons of unreachable elements: element, mask, amounts and place of each."""
    frames, grid = model.frames, model.grid
    panels = np.concatenate([frames.centroids, frames.normals, frames.tangents, frames.bitangents], axis=1)
    targets = model.targets_enu_m
    corners = np.maximum(np.abs(space.low_enu_m - frames.centroids), np.abs(space.high_enu_m - frames.centroids))
    farthest = BEYOND * np.linalg.norm(corners, axis=1) + NEAREST_M
    all_bounds = np.array([grid.bounds_rad(section) for section in range(grid.n_sections)])
    n_angles = max(3, 1 + round(grid.step_deg / 10.0))
    world = World(
        reach_limits(model, space), ground_z_m, reach_bodies(space.solids, False), reach_bodies(space.no_fly, False)
    )
    k, n_rules = len(elements), N_RULES
    n_rows, masks = np.zeros(k, np.int64), np.zeros((k, n_rules), np.int64)
    amounts, places = np.zeros((k, n_rules, n_rules)), np.zeros((k, n_rules, 3))

    def work(start: int, stop: int) -> None:
        panel, section = np.divmod(elements[start:stop], grid.n_sections)
        part = slice(start, stop)
        outputs = n_rows[part], masks[part], amounts[part], places[part]
        explain_sections(panels, targets, farthest, panel, all_bounds[section], world, n_angles, *outputs)

    size = SECTIONS_PER_CHUNK
    for first, last in chunks(k, 4 * n_threads() * size):
        monitor.report(say("finding what stands in the way"), first, k)
        run_parallel(work, [(first + start, first + stop) for start, stop in chunks(last - first, size)])
    filled = np.arange(n_rules) < n_rows[:, None]
    return np.repeat(elements, n_rows), masks[filled], amounts[filled], places[filled]


def _name_things(
    model: CoverageModel,
    space: FreeSpace,
    obstructions: Obstructions,
    panel: NDArray[np.int64],
    masks: NDArray[np.int64],
    places: Array,
) -> NDArray[np.int64]:
    """Number of the thing that each row's rules are about, shape (q, len(RULES)); -1 for none."""
    named = np.full((len(masks), len(RULES)), -1, np.int64)
    near, zone, hidden = (masks >> rule & 1 == 1 for rule in (DISTANCE, NO_FLY, HIDDEN))
    named[near, DISTANCE] = nearest_obstructions(space.solids, obstructions.solid_owner, places[near])
    named[zone, NO_FLY] = nearest_obstructions(space.no_fly, obstructions.no_fly_owner, places[zone])
    targets = model.targets_enu_m[panel[hidden]]
    named[hidden, HIDDEN] = first_obstructions_hit(space.solids, obstructions.solid_owner, targets, places[hidden])
    return named
