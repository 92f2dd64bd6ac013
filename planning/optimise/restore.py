"""Views for what was lost when close ones were put at one place."""

from __future__ import annotations

import numpy as np

from planning.optimise.problem import ViewProblem, concatenate, take
from planning.plan import ViewpointArrays
from planning.plan_records import as_written
from planning.positions import aimed_views
from planning.routing.legs import MIN_SPACING_M


def with_lost_restored(problem: ViewProblem, before: ViewpointArrays, after: ViewpointArrays) -> ViewpointArrays:
    """The views `after`, and behind them further ones for the sections that only the views `before` cover.

    Each further view stands at the witness of a lost section, and at least as far from all others as autopilots want;
    sections whose witness is closer stay lost. `after` itself where none is added.
    """
    model = problem.model
    lost = np.flatnonzero(model.covered(before) & ~model.covered(after))
    places = problem.reachability.witnesses_enu_m.reshape(-1, 3)[lost]
    is_known = np.isfinite(places).all(axis=1)
    panels = lost[is_known] // model.grid.n_sections
    views = aimed_views(places[is_known], model.frames.centroids[panels], model.camera)
    views = as_written(problem, views)
    missing = set(lost.tolist())
    for index in range(len(views.heading_rad)):
        view = take(views, np.array([index]))
        away_m = np.linalg.norm(after.positions_enu_m - view.positions_enu_m, axis=1).min(initial=np.inf)
        shown = missing.intersection(model.elements(view).items.tolist())
        if shown and away_m >= MIN_SPACING_M:
            after = concatenate([after, view])
            missing -= shown
    return after
