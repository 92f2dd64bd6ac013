"""Prepared sites for the tests of what a plan shows, each made once."""

from __future__ import annotations

import functools

from planning.aircraft.catalogue import profile
from planning.insight.reasons import SectionReasons, section_reasons
from planning.parameters import Constraints, GreedyParameters
from planning.plan import Plan
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
