"""Sections that some allowed place covers, but to none of which a way from home was found."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import exact_sections
from planning.optimise.problem import ViewProblem
from planning.positions import aimed_views, hemisphere_direction, sobol
from planning.progress import QUIET, Monitor
from planning.reach_kernel import REACHABLE

Array = NDArray[np.float64]

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
        monitor.report("looking for ways to viewpoints", number, len(doubtful))
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
