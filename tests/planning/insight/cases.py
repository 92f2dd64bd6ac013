"""Prepared sites for the tests of what a plan shows, each made once."""

from __future__ import annotations

import functools

import numpy as np

from planning.aircraft.catalogue import profile
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.coverage.model import exact_sections
from planning.insight.reasons import SectionReasons, section_reasons
from planning.insight.sections import PlanInsight, assembled, panel_sampling, section_counts
from planning.parameters import Constraints, GreedyParameters
from planning.plan import Plan, viewpoint_arrays
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from tests.planning.plan_cases import kiosk

CAMERA = profile("m3e").camera
NEAR = Constraints(min_distance_m=5.0)


@functools.cache
def scene(name: str) -> SiteModel:
    return kiosk() if name == "kiosk" else SCENES[name]()


@functools.cache
def prepared(name: str, constraints: Constraints = NEAR) -> Prepared:
    return prepare(scene(name), CAMERA, constraints)


@functools.cache
def reasons(name: str, constraints: Constraints = NEAR) -> SectionReasons:
    return section_reasons(scene(name), prepared(name, constraints))


@functools.cache
def plan(name: str, n_views: int = 12) -> Plan:
    few = GreedyParameters(n_candidates=400, improve=False, certify=False)
    return plan_flight(scene(name), PlanRequest(n_views=n_views, constraints=NEAR, greedy=few)).plan


def plan_insight(
    site_model: SiteModel, prepared: Prepared, plan: Plan, reasons: SectionReasons, monitor: Monitor = QUIET
) -> PlanInsight:
    """What a plan covers on a prepared site, seen with the prepared camera under the prepared constraints.

    Parameters
    ----------
    reasons
        Of the same prepared site (`planning.insight.reasons.section_reasons`); they do not depend on the plan.
    """
    model, verdicts = prepared.problem.model, prepared.problem.reachability.verdicts
    if reasons.shape != verdicts.shape:
        raise ValueError(f"reasons: expected those of this site, shape {verdicts.shape}, got {reasons.shape}")
    monitor.report(say("counting what each view covers"), 0, 1)
    views = viewpoint_arrays(plan.viewpoints)
    sections = exact_sections(model, views)
    counts = section_counts(sections, model.grid.n_sections)
    sampling = panel_sampling(model.frames, model.camera, views.positions_enu_m, sections)
    return assembled(site_model, prepared, plan, sections.astype(np.int16), counts, sampling, reasons)
