"""Resumed sorties: wherever the first part ended, both parts together take every photo once, and nothing is lost."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from unittest import mock

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink

from missions.formats.options import ExportOptions
from missions.formats.registry import encode
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import MissionItem, mission_items
from missions.mission.export_choices import FileFormat, HeightReference
from missions.mission.model import Mission
from missions.mission.resume import Resumed, resume_sortie
from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError, MissionError
from planning.base.findings import Severity
from planning.checks import check_plan
from planning.parameters import FlightRules
from planning.plan import Plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.records import NoFlyZone, SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import NEAR, QUICK
from tests.planning.test_planner import assert_keeps_the_contract
from tests.slow import slow

CAMERA_ITEMS = (mavlink.MAV_CMD_DO_DIGICAM_CONTROL, mavlink.MAV_CMD_IMAGE_START_CAPTURE)
GIMBAL_ITEMS = (mavlink.MAV_CMD_DO_MOUNT_CONTROL, mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW)


@functools.cache
def site() -> SiteModel:
    return kiosk()


@functools.cache
def prepared() -> Prepared:
    return prepare(site(), profile("m3e").camera, NEAR, max_cells=50)


@functools.cache
def planned() -> Plan:
    """Two sorties, in the order in which an undisturbed search leaves them."""
    request = PlanRequest(
        n_views=20, constraints=NEAR, greedy=QUICK, rules=FlightRules(battery_reserve=0.92), time_budget_s=600.0
    )
    with mock.patch("planning.planner.LONGEST_ROUTING_S", 600.0):
        plan = plan_flight(site(), request, prepared=prepared()).plan
    assert len(plan.sorties) > 1
    return plan


def rest_after(n_taken: int, number: int = 1) -> Resumed:
    taken = planned().sorties[number - 1].viewpoint_ids[:n_taken]
    return resume_sortie(planned(), site(), number, taken, prepared=prepared())


def photo_ids(mission: Mission) -> list[str]:
    return [photo.viewpoint_id for waypoint in mission.waypoints for photo in waypoint.photos]


@pytest.mark.slow
@pytest.mark.parametrize("number", [slow(1), 2])
def test_flown_and_resumed_views_are_all_views_once_and_the_rest_passes_every_check(number: int) -> None:
    sortie = planned().sorties[number - 1]
    before = {view.id: view for view in planned().viewpoints}
    for n_taken in range(len(sortie.viewpoint_ids)):
        rest = rest_after(n_taken, number)
        assert (*sortie.viewpoint_ids[:n_taken], *photo_ids(rest.mission)) == sortie.viewpoint_ids
        assert [view.id for view in rest.plan.viewpoints] == list(sortie.viewpoint_ids[n_taken:])
        assert all(view == before[view.id] for view in rest.plan.viewpoints)
        assert_keeps_the_contract(site(), rest.plan, spacing_m=1.0)
        assert not [f for f in check_plan(rest.plan, site()) if f.severity is Severity.ERROR]
        assert rest.plan.sorties[0].duration_s <= sortie.duration_s + 10.0


@pytest.mark.slow
@settings(max_examples=12)
@given(data=st.data())
def test_views_skipped_in_the_middle_are_flown_and_those_done_are_not(data: st.DataObject) -> None:
    ids = planned().sorties[0].viewpoint_ids
    taken = data.draw(st.sets(st.sampled_from(ids), max_size=len(ids) - 1))
    rest = resume_sortie(planned(), site(), 1, taken | {planned().sorties[1].viewpoint_ids[0]}, prepared=prepared())
    assert photo_ids(rest.mission) == [identifier for identifier in ids if identifier not in taken]
    assert_keeps_the_contract(site(), rest.plan, spacing_m=1.0)


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("autopilot", list(Autopilot))
@pytest.mark.parametrize("n_taken", [0, 1, 4, 8])
def test_every_mavlink_item_around_a_photo_is_kept(autopilot: Autopilot, n_taken: int) -> None:
    """Against the items of the same views in the mission of the whole sortie; only holds and legs may differ."""
    rest = rest_after(n_taken).mission
    items = mission_items(rest, autopilot, HeightReference.ABOVE_TAKEOFF)
    whole = mission_items(rest_after(0).mission, autopilot, HeightReference.ABOVE_TAKEOFF)
    commands = [item.command for item in items]
    assert commands[0] == mavlink.MAV_CMD_NAV_TAKEOFF
    assert commands[1] == mavlink.MAV_CMD_DO_CHANGE_SPEED
    assert commands[-1] == mavlink.MAV_CMD_NAV_LAND
    assert items[1].params[1] == rest.speed_m_s
    assert [item.viewpoint_id for item in items if item.command in CAMERA_ITEMS] == photo_ids(rest)
    first_photo = next(i for i, item in enumerate(items) if item.command in CAMERA_ITEMS)
    assert any(item.command in GIMBAL_ITEMS for item in items[:first_photo])
    for identifier in photo_ids(rest):
        assert around(items, identifier) == around(whole, identifier)


def around(items: tuple[MissionItem, ...], viewpoint_id: str) -> list[tuple[int, tuple[float, ...]]]:
    """Commands of a view from aiming to waiting, with what they aim at."""
    at = next(i for i, item in enumerate(items) if item.viewpoint_id == viewpoint_id)
    first = max(i for i in range(at) if items[i].command in GIMBAL_ITEMS)
    kept = []
    for item in items[first : at + 2]:
        params = item.params[1:] if item.command == mavlink.MAV_CMD_NAV_WAYPOINT else item.params
        if item.command == mavlink.MAV_CMD_IMAGE_START_CAPTURE:
            params = (*params[:3], 0.0, *params[4:])  # the photo's number in its mission
        kept.append((item.command, tuple(0.0 if math.isnan(value) else value for value in params)))
    return kept


@pytest.mark.long
@pytest.mark.few(3)
@pytest.mark.parametrize("file_format", [FileFormat.DJI_KMZ, FileFormat.MAVLINK_PLAN, FileFormat.MAVLINK_WPL])
@pytest.mark.parametrize("autopilot", list(Autopilot))
def test_the_rest_passes_the_checks_of_every_format(file_format: FileFormat, autopilot: Autopilot) -> None:
    for n_taken in (0, 3, len(planned().sorties[0].viewpoint_ids) - 1):
        plan = rest_after(n_taken).plan
        options = ExportOptions(autopilot=autopilot, site=site(), clock=lambda: 1.7e9)
        encoded = encode(plan, plan.origin, plan.home_enu_m, file_format, options)
        assert len(encoded.contents) == 1
        assert not [finding for finding in encoded.findings if finding.severity is Severity.ERROR]


def test_the_rest_of_one_view_goes_there_and_back() -> None:
    rest = rest_after(len(planned().sorties[0].viewpoint_ids) - 1)
    assert len(rest.plan.viewpoints) == 1
    assert rest.plan.sorties[0].path_enu_m[0] == rest.plan.sorties[0].path_enu_m[-1] == site().site.home_enu_m


def test_the_mission_says_which_sortie_it_is_the_rest_of() -> None:
    mission = rest_after(1, number=2).mission
    assert (mission.number, mission.name) == (2, "kiosk-2-rest")


def test_a_photo_of_another_sortie_does_not_count() -> None:
    rest = resume_sortie(planned(), site(), 1, planned().sorties[1].viewpoint_ids, prepared=prepared())
    assert photo_ids(rest.mission) == list(planned().sorties[0].viewpoint_ids)


def test_without_a_prepared_site_the_same_rest_comes_out() -> None:
    taken = planned().sorties[0].viewpoint_ids[:3]
    alone = resume_sortie(planned(), site(), 1, taken)
    assert [view.id for view in alone.plan.viewpoints] == photo_ids(rest_after(3).mission)
    assert alone.plan.sorties == rest_after(3).plan.sorties
    assert alone.plan.coverage.covered == rest_after(3).plan.coverage.covered


def test_locked_views_can_be_done_and_stay_locked() -> None:
    locked = replace(planned(), viewpoints=tuple(replace(view, locked=True) for view in planned().viewpoints))
    rest = resume_sortie(locked, site(), 1, locked.sorties[0].viewpoint_ids[:2], prepared=prepared())
    assert all(view.locked for view in rest.plan.viewpoints)


def test_nothing_left_and_no_such_sortie_are_refused() -> None:
    with pytest.raises(MissionError, match=r"sortie 1 is complete: all \d+ views have a photo"):
        rest_after(len(planned().sorties[0].viewpoint_ids))
    with pytest.raises(ValueError, match="expected a sortie from 1 to"):
        resume_sortie(planned(), site(), 0, (), prepared=prepared())


def test_a_view_that_is_forbidden_now_is_named_and_a_top_up_advised() -> None:
    ids = planned().sorties[0].viewpoint_ids
    x, y, z = next(view for view in planned().viewpoints if view.id == ids[-1]).position_enu_m
    zone = NoFlyZone("event", ((x - 1, y - 1), (x + 1, y - 1), (x + 1, y + 1), (x - 1, y + 1)), z - 1.0, z + 1.0)
    airspace = site().site.airspace
    now = replace(site(), site=replace(site().site, airspace=replace(airspace, no_fly=(*airspace.no_fly, zone))))
    with pytest.raises(MissionError, match="cannot be flown as it was planned") as refused:
        resume_sortie(planned(), now, 1, ids[:1])
    assert "plan a top-up instead" in str(refused.value)


def test_a_home_that_cannot_be_used_any_more_is_refused() -> None:
    airspace = site().site.airspace
    zone = NoFlyZone("home", ((-5.0, -35.0), (5.0, -35.0), (5.0, -25.0), (-5.0, -25.0)), 0.0, 50.0)
    now = replace(site(), site=replace(site().site, airspace=replace(airspace, no_fly=(zone,))))
    with pytest.raises(InfeasibleError, match="cannot be resumed on the site as it is now: home_enu_m"):
        resume_sortie(planned(), now, 1, ())
