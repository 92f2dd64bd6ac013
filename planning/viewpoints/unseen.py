"""Views that a model will be looked at from, other than its photos: what flights are judged by, and planned for.

Random oblique ones from before the panels, those even over the sections of their hemispheres, as the paper counts them
(Eq. 10), and those of an inspector who walks along the facades.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import Monitor, Stop, Trace
from planning.coverage.positions import aimed_views, hemisphere_direction, rounded
from planning.coverage.reach_kernel import REACHABLE
from planning.plan import ViewpointArrays
from planning.site.records import SiteModel
from planning.viewpoints.problem import Goal, ViewProblem, ViewSet, concatenate, nothing_to_see, take

Array = NDArray[np.float64]

MOST_OBLIQUE_DEG, FARTHEST = 85.0, 3.0
"""Of random views: largest angle from a panel's normal, and largest distance in minimum distances."""

EYE_M, WALK_M, ASIDE_M, BESIDE_M = 1.7, (5.0, 20.0), 8.0, 0.8
"""A walker's height of eyes, distances from the facade, way to either side of the panel looked at, and what a walker
keeps from everything solid."""

N_TRIES = 40
"""Draws of as many views as are wanted until those that are possible have to do."""


def random_views(problem: ViewProblem, n: int, rng: np.random.Generator) -> ViewpointArrays:
    """Flyable views of random panels: even in both angles of the hemisphere and in the logarithm of the distance.

    Fewer than `n`, or none, where hardly any place is allowed.
    """
    model = problem.model
    nearest = max(problem.space.min_distance_m, 0.5)

    def draw(k: int) -> ViewpointArrays:
        panel = rng.integers(0, len(model.frames), k)
        theta, phi = rng.uniform(0.0, np.radians(MOST_OBLIQUE_DEG), k), rng.uniform(0.0, 2.0 * np.pi, k)
        distance = nearest * FARTHEST ** rng.random(k)
        away = distance[:, None] * hemisphere_direction(model.frames, panel, theta, phi)
        positions = model.frames.centroids[panel] + away
        kept = problem.flyable(positions)
        return rounded(aimed_views(positions[kept], model.frames.centroids[panel[kept]], model.camera), model.camera)

    return _drawn(draw, n)


N_RANDOM = 120
"""Views of the method `random` where the goal does not say."""


def random_oblique(
    problem: ViewProblem, goal: Goal, *, seed: int, stop: Stop, trace: Trace, monitor: Monitor
) -> ViewSet:
    """The method `random`: places drawn by lot, what every other method has to be better than.

    Raises
    ------
    InfeasibleError
        No place that was drawn is allowed.
    """
    monitor.report(say("trying viewpoints"), 0, 1)
    n = N_RANDOM if goal.n_views is None else goal.n_views
    views = random_views(problem, n, np.random.default_rng([seed, 1]))
    if len(views.heading_rad) == 0:
        raise nothing_to_see()
    trace.record(problem.model.covered_count(views))
    return ViewSet(views)


def walk_views(problem: ViewProblem, site_model: SiteModel, n: int, rng: np.random.Generator) -> ViewpointArrays:
    """Views at the height of eyes from before the facades, each of a panel with nothing between; no drone is there.

    Fewer than `n`, or none, where there is hardly any place on the ground before a panel.
    """
    model, solids = problem.model, problem.space.solids

    def draw(k: int) -> ViewpointArrays:
        panel = rng.integers(0, len(model.frames), k)
        targets, normals = model.frames.centroids[panel], model.frames.normals[panel]
        offset = rng.uniform(*WALK_M, k)[:, None] * normals
        positions = targets + offset + rng.uniform(-ASIDE_M, ASIDE_M, k)[:, None] * model.frames.tangents[panel]
        positions[:, 2] = site_model.site.airspace.ground_z_m + EYE_M
        kept = np.einsum("nk,nk->n", positions - targets, normals) > 0.0
        kept &= solids.clearance_m(positions, 2.0 * BESIDE_M) > BESIDE_M
        kept[kept] = solids.lines_free(positions[kept], model.targets_enu_m[panel[kept]])
        return aimed_views(positions[kept], targets[kept], model.camera)

    return _drawn(draw, n)


def even_views(problem: ViewProblem, n: int, rng: np.random.Generator) -> ViewpointArrays:
    """Views of at most `n` hemisphere sections, drawn from all that can be reached, each aimed at its panel."""
    model, reachability = problem.model, problem.reachability
    reachable = np.flatnonzero(reachability.verdicts.reshape(-1) == REACHABLE)
    drawn = rng.choice(reachable, min(n, len(reachable)), replace=False)
    positions = reachability.witnesses_enu_m.reshape(-1, 3)[drawn]
    return aimed_views(positions, model.frames.centroids[drawn // model.grid.n_sections], model.camera)


def _drawn(draw: Callable[[int], ViewpointArrays], n: int) -> ViewpointArrays:
    parts: list[ViewpointArrays] = []
    for _ in range(N_TRIES):
        parts.append(draw(2 * n))
        if sum(len(part.heading_rad) for part in parts) >= n:
            break
    views = concatenate(parts)
    return take(views, np.arange(min(n, len(views.heading_rad))))
