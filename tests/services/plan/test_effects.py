"""What the scene calls for is found again only where something changed that it depends on."""

from __future__ import annotations

from dataclasses import replace

import pytest

from groundstation.services.plan.effects import EffectChoice, plan_effects, scene_effects
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


def by_name(plan, site=None) -> dict[str, EffectChoice]:
    found = plan_effects(plan, planned("kiosk").prepared.site_model if site is None else site)
    return {str(choice.decision.effect): choice for choice in found}


def test_what_the_camera_does_is_off_where_photos_are_taken_at_a_hover_with_a_mechanical_shutter() -> None:
    found = by_name(planned("kiosk").plan)
    blur, skew, focus = (found[name].decision for name in ("motion blur", "rolling shutter", "depth of field"))
    assert not blur.on
    assert "at a hover" in blur.reason
    assert not skew.on
    assert (focus.unit, focus.tolerance) == ("px", 0.5)
    assert focus.on == (focus.size > 0.5)
    assert {choice.setting for choice in found.values()} == {None}


@pytest.mark.parametrize(("shutter_s", "on"), [(1 / 16000, False), (1 / 60, True)])
def test_motion_blur_and_skew_are_on_where_they_are_more_than_half_a_pixel(shutter_s: float, on: bool) -> None:
    plan = planned("kiosk").plan
    sortie = plan.sorties[0]
    passing = replace(sortie, in_passing_ids=sortie.viewpoint_ids[1:-1])
    settings = replace(plan.camera_settings, exposure="manual", shutter_s=shutter_s, iso=200, shutter="electronic")
    found = by_name(replace(plan, sorties=(passing, *plan.sorties[1:]), camera_settings=settings))
    blur, skew = found["motion blur"].decision, found["rolling shutter"].decision
    assert blur.on is on
    assert (blur.size > 0.5) is on
    assert skew.on, "30 ms of readout are longer than any shutter time"


@pytest.mark.parametrize(("aperture", "on"), [(2.8, True), (11.0, False)])
def test_depth_of_field_is_on_where_panes_or_mirror_images_show_it(aperture: float, on: bool) -> None:
    plan = planned("kiosk").plan
    near = replace(plan.camera_settings, aperture=aperture, focus="distance", focus_distance_m=12.0)
    assert by_name(replace(plan, camera_settings=near))["depth of field"].decision.on is on
