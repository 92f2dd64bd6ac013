"""Prepared scenes, shared by benchmarks."""

from __future__ import annotations

import functools

import numpy as np

from planning.aircraft.catalogue import profile
from planning.base.progress import QUIET, Stop, Trace, never
from planning.coverage.model import exact_coverage
from planning.parameters import Constraints
from planning.plan import ViewpointArrays
from planning.site.bundled import SCENES
from planning.viewpoints.prepare import Prepared, prepare
from planning.viewpoints.problem import Goal, Optimiser, ViewProblem

PLANAR_VIEWS, CURVED_VIEWS = 560, 600
"""The paper's numbers of views for its planar and its curved case (4.2.1); office and library stand for them."""


@functools.cache
def prepared(scene: str, occlusion: str = "auto", step_deg: float = 30.0) -> Prepared:
    """A bundled scene, ready for optimisation."""
    constraints = Constraints(section_step_deg=step_deg, occlusion=occlusion)
    return prepare(SCENES[scene](), profile("m3e").camera, constraints)


def covered(problem: ViewProblem, views: ViewpointArrays) -> int:
    """Sections covered, by the definition in float64."""
    return int(np.count_nonzero(exact_coverage(problem.model, views)))


def choose(
    method: Optimiser, problem: ViewProblem, n_views: int, seed: int, stop: Stop = never
) -> tuple[ViewpointArrays, Trace]:
    """Views of a method, and its coverage against time."""
    trace = Trace()
    found = method(problem, Goal(n_views=n_views), seed=seed, stop=stop, trace=trace, monitor=QUIET)
    return found.views, trace
