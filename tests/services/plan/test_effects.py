"""What the scene calls for is found again only where something changed that it depends on."""

from __future__ import annotations

from dataclasses import replace

import pytest

from groundstation.services.plan.effects import plan_effects, scene_effects
from planning.parameters import Constraints
from planning.request import PlanRequest
from planning.site.bundled import canyon, roof
from tests.planning.revision.cases import planned


def test_what_stands_in_front_of_panels_is_on_where_something_does_and_off_where_nothing_does() -> None:
    (opposite,) = scene_effects(canyon(), PlanRequest()).choices
    (free,) = scene_effects(roof(), PlanRequest()).choices
    assert opposite.decision.on
    assert not free.decision.on
    assert (opposite.setting, opposite.decision.decided_by) == ("auto", "scene")


@pytest.mark.parametrize("wish", ["on", "off"])
def test_a_wish_overrules_the_decision_and_not_what_was_measured(wish: str) -> None:
    site = canyon()
    (found,) = scene_effects(site, PlanRequest()).choices
    (asked,) = scene_effects(site, PlanRequest(constraints=Constraints(occlusion=wish))).choices
    assert asked.decision.on == (wish == "on")
    assert asked.decision.size == found.decision.size


def test_effects_hold_until_site_distance_wish_or_seed_change() -> None:
    site, request = roof(), PlanRequest()
    found = scene_effects(site, request)
    for same in (request, replace(request, n_views=9), replace(request, time_budget_s=3.0)):
        assert found.hold_for(site, same)
    for other in (
        replace(request, constraints=Constraints(min_distance_m=4.0)),
        replace(request, constraints=Constraints(occlusion="on")),
        replace(request, seed=7),
    ):
        assert not found.hold_for(site, other)
    assert not found.hold_for(roof(), request)


def test_a_plan_adds_what_its_check_looks_at_and_the_user_cannot_overrule() -> None:
    found = plan_effects(planned("kiosk").plan)
    assert found
    assert {choice.setting for choice in found} == {None}
