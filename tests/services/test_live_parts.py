"""The pure parts of a live flight: what may be asked for, how the link is, whose photo it is, the last choice."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.events import LinkState, Request, ViewState
from groundstation.services.fly.fleet import LiveCoverage, matching_view
from groundstation.services.fly.options import (
    ConnectionChoice,
    FlightSettings,
    LinkKind,
    read_choice,
    read_flight_settings,
)
from groundstation.services.fly.readouts import allowed_requests, battery_left_s, link_state
from groundstation.services.settings import write_preferences
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import Timed, VehicleState
from missions.flight.matching import DEFAULT_GATES
from missions.flight.record import TakenPhoto
from missions.mavlink.autopilots import Autopilot
from planning.base.errors import InputError
from planning.coverage.evaluate import coverage_counts
from tests.services.live_cases import planned, sortie

phases = st.sampled_from([None, *Phase])
HEARD = VehicleState(autopilot=Autopilot.PX4, heartbeat=Timed(1, 100.0), armed=Timed(False, 100.0))


def state(*, is_armed, mode="AUTO.LOITER"):
    return replace(HEARD, armed=Timed(is_armed, 100.0), mode=Timed(mode, 100.0))


@given(phases, st.booleans(), st.booleans(), st.sampled_from(["AUTO.LOITER", "AUTO.MISSION"]))
def test_return_and_land_are_allowed_but_where_the_vehicle_surely_stands(phase, is_armed, is_ready, mode):
    for link in (LinkState.ALIVE, LinkState.LOST):
        may = allowed_requests(link, phase, state(is_armed=is_armed, mode=mode), is_ready=is_ready)
        stands = link is LinkState.ALIVE and not is_armed and phase not in (Phase.STARTING, Phase.FLYING)
        assert may & {Request.RETURN, Request.LAND} == (set() if stands else {Request.RETURN, Request.LAND})
        assert Request.DISCONNECT in may


@given(phases, st.booleans(), st.booleans(), st.sampled_from([*LinkState]))
def test_nothing_starts_or_is_uploaded_but_on_the_ground_with_a_live_link(phase, is_armed, is_ready, link):
    may = allowed_requests(link, phase, state(is_armed=is_armed), is_ready=is_ready)
    if may & {Request.START, Request.UPLOAD}:
        assert link is LinkState.ALIVE
        assert not is_armed
    assert (Request.START in may) == (link is LinkState.ALIVE and phase is Phase.READY and is_ready and not is_armed)


def test_a_mission_is_paused_where_it_is_flown_and_resumed_where_it_is_not():
    flying = allowed_requests(LinkState.ALIVE, Phase.FLYING, state(is_armed=True, mode="AUTO.MISSION"), is_ready=False)
    hovering = allowed_requests(LinkState.ALIVE, Phase.FLYING, state(is_armed=True), is_ready=False)
    assert Request.PAUSE in flying - hovering
    assert Request.RESUME in hovering - flying


@pytest.mark.parametrize(
    ("known", "now_s", "is_open", "found"),
    [
        (VehicleState(), 100.0, False, LinkState.OPENING),
        (VehicleState(), 100.0, True, LinkState.SILENT),
        (HEARD, 102.9, True, LinkState.ALIVE),
        (HEARD, 103.1, True, LinkState.LOST),
        (HEARD, 100.0, False, LinkState.LOST),
    ],
)
def test_a_link_is_lost_after_three_seconds_without_a_heartbeat_or_once_it_broke(known, now_s, is_open, found):
    assert link_state(known, now_s, is_open=is_open) is found


def test_time_left_is_never_negative():
    assert battery_left_s(1.0, 0.25, 2520.0) == pytest.approx(1890.0)
    assert battery_left_s(0.1, 0.25, 2520.0) == 0.0


def photo(view, number=1, shift_m=0.0, **changes):
    x, y, z = view.position_enu_m
    taken = TakenPhoto(number, float(number), (x + shift_m, y, z), view.heading_deg, view.gimbal_pitch_deg)
    return replace(taken, **changes)


def test_coverage_counted_photo_by_photo_is_that_of_the_whole_plan():
    model, plan = planned()
    case, ids = sortie().case, sortie().viewpoint_ids
    growing = LiveCoverage(case)
    growing.add_sortie(ids)
    by_id = {view.id: view for view in plan.viewpoints}
    new = [growing.add(photo(by_id[view_id], n), ids).n_new for n, view_id in enumerate(ids)]
    assert sum(new) == growing.covered == growing.covered_planned == plan.coverage.covered
    assert (growing.counts() == coverage_counts(case.model, plan.viewpoints)).all()
    assert growing.counts().shape[0] == model.site.n_panels


def test_a_photo_belongs_to_the_view_that_fits_it_best_and_to_none_that_is_far():
    views = planned()[1].viewpoints
    for view in views:
        assert matching_view(photo(view, shift_m=0.3), views, DEFAULT_GATES) is view
    away = photo(views[0], shift_m=500.0)
    assert matching_view(away, views, DEFAULT_GATES) is None


def test_a_photo_without_angles_looks_where_its_view_does_and_without_a_view_shows_nothing():
    views, ids = planned()[1].viewpoints, sortie().viewpoint_ids
    growing = LiveCoverage(sortie().case)
    bare = photo(views[0], heading_deg=None, gimbal_pitch_deg=None)
    assert growing.add(bare, ids).n_new > 0
    lost = replace(photo(views[1], shift_m=500.0), heading_deg=None, gimbal_pitch_deg=None)
    counted = growing.add(lost, ids)
    assert (counted.view, counted.n_new) == (None, 0)


def test_errors_of_a_photo_are_taken_less_planned():
    view, ids = planned()[1].viewpoints[0], sortie().viewpoint_ids
    turned = photo(view, shift_m=0.4, heading_deg=math.remainder(view.heading_deg + 2.0, 360.0))
    counted = LiveCoverage(sortie().case).add(turned, ids)
    assert counted.heading_error_deg == pytest.approx(2.0)
    assert counted.position_error_m == pytest.approx(0.4)


def test_views_are_taken_off_missing_next_and_to_come():
    plan, ids = planned()[1], sortie().viewpoint_ids
    by_id = {view.id: view for view in plan.viewpoints}
    growing = LiveCoverage(sortie().case)
    growing.add(photo(by_id[ids[0]]), ids)
    growing.add(photo(by_id[ids[1]], 2, shift_m=0.9), ids)
    states = [found for _, found in growing.states(ids, [ids[2]])]
    assert states[:4] == [ViewState.TAKEN, ViewState.OFF, ViewState.MISSING, ViewState.NEXT]
    assert set(states[4:]) == {ViewState.TO_COME}


def test_the_last_choice_comes_back_and_a_damaged_file_gives_the_first_one(tmp_path):
    path = tmp_path / "deep" / "connection.toml"
    choice = ConnectionChoice(LinkKind.SERIAL, "/dev/ttyACM0:115200", Autopilot.PX4, 10.0)
    assert read_choice(path) == ConnectionChoice()
    write_preferences(path, choice)
    assert read_choice(path) == choice
    assert choice.url == "serial:/dev/ttyACM0:115200"
    path.write_text("kind = 'pigeon'")
    assert read_choice(path) == ConnectionChoice()


def test_whether_rtk_is_needed_comes_back_and_leave_to_set_parameters_does_not(tmp_path):
    path = tmp_path / "flight.toml"
    assert read_flight_settings(path) == FlightSettings()
    write_preferences(path, FlightSettings(needs_rtk=True))
    assert read_flight_settings(path) == FlightSettings(needs_rtk=True)
    path.write_text("needs_rtk = 'perhaps'")
    assert read_flight_settings(path) == FlightSettings()


def test_what_cannot_be_kept_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        write_preferences(tmp_path / "file" / "flight.toml", FlightSettings())
