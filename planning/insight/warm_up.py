"""Compile the kernels of this package once, on the smallest site."""

from __future__ import annotations

import numpy as np

from planning.aircraft.catalogue import profile
from planning.insight.clearance import route_clearance
from planning.insight.reasons import section_reasons
from planning.insight.sampling import panel_sampling
from planning.insight.things import first_things_hit, things_of
from planning.parameters import DEFAULT_PROFILE, Constraints
from planning.plan import Sortie
from planning.site.bundled import SCENES
from planning.viewpoints.prepare import prepare


def compile_kernels() -> None:
    """Run every kernel of this package on a site with unreachable sections."""
    model = SCENES["single-panel"]()
    prepared = prepare(model, profile(DEFAULT_PROFILE).camera, Constraints())
    section_reasons(model, prepared)
    frames, camera = prepared.problem.model.frames, prepared.problem.model.camera
    panel_sampling(frames, camera, frames.centroids + frames.normals, np.zeros((len(frames), len(frames)), np.int16))
    space = prepared.problem.space
    things = things_of(model, space)
    route_clearance(Sortie((), ((0.0, -20.0, 5.0), (5.0, -20.0, 5.0)), 5.0, 5.0), space, things)
    first_things_hit(space.solids, things.solid_owner, space.home_enu_m[None], space.column_top_enu_m[None])
