"""A plan flown through the whole chain: MAVLink, simulated autopilot, airframe, record, report."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import linprog

from groundstation.services.fly.flying import FlightRequest, check_site, fly_files, fly_plan
from groundstation.vehicle.sortie.run_records import Phase
from groundstation.vehicle.state import LINK_LOST_S, Landed
from missions.flight.flight_file import read_flight
from missions.flight.outcome import Reason
from missions.flight.report import report_flight
from missions.mavlink.autopilots import Autopilot
from missions.simulator.build import EFFECTS
from missions.simulator.conditions import Conditions
from planning.base.errors import (
    InfeasibleError,
    InputError,
    LinkRejected,
    LinkTimeout,
    MissionError,
    OperationCancelled,
)
from planning.base.findings import Severity
from planning.motion.timing import sortie_flight_path
from planning.parameters import FlightRules
from planning.plan import read_plan, write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.at_once import TIMING_S, TIMING_SHARE, sortie_leg_times
from planning.site.bundled import court, office, single_panel, write_scene
from planning.site.file import read_site
from tests.planning.revision.cases import QUICK
from tests.slow import slow

BOTH = pytest.mark.parametrize("autopilot", list(Autopilot))
POSITION_M, HEADING_DEG, PITCH_DEG, COVERED, DURATION = 0.5, 3.0, 2.0, 0.97, 0.10
"""What a flight must keep: at the shutter, of the planned coverage, and between predicted and flown duration."""


@pytest.fixture(scope="module")
def model():
    return office()


@pytest.fixture(scope="module")
def plan(model):
    return plan_flight(model, PlanRequest(n_views=8, greedy=QUICK)).plan


@cache
def self_built(profile):
    """A plan over the office for an aircraft of that name."""
    return plan_flight(office(), PlanRequest(n_views=6, greedy=QUICK, profile_id=profile)).plan


@pytest.fixture(scope="module")
def small():
    """A pane and a flight of four photos."""
    site = single_panel()
    return site, plan_flight(site, PlanRequest(n_views=4, greedy=QUICK)).plan


def assert_kept(flown, plan):
    report = flown.flight.report
    assert [view.reason for view in report.views] == [Reason.TAKEN] * len(plan.viewpoints)
    assert report.summary.n_photos == len(plan.viewpoints)
    assert max(view.position_error_m for view in report.views) < POSITION_M
    assert max(abs(view.heading_error_deg) for view in report.views) < HEADING_DEG
    assert max(abs(view.gimbal_pitch_error_deg) for view in report.views) < PITCH_DEG
    assert report.summary.covered >= COVERED * plan.coverage.covered
    for sortie in report.sorties:
        assert sortie.duration_flown_s == pytest.approx(sortie.duration_predicted_s, rel=DURATION)


@pytest.mark.slow
@BOTH
def test_the_office_is_flown_as_planned(model, plan, autopilot):
    flown = fly_plan(plan, model, FlightRequest(autopilot=autopilot))
    assert_kept(flown, plan)
    assert {photo.source for photo in flown.flight.sorties[0].photos} == {"simulation"}
    assert not [f for f in flown.flight.report.findings if f.severity == "error"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("autopilot", "profile"),
    [
        slow(Autopilot.ARDUPILOT, "ardupilot"),
        (Autopilot.ARDUPILOT, "px4"),
        slow(Autopilot.PX4, "ardupilot"),
        slow(Autopilot.PX4, "px4"),
    ],
)
def test_the_office_is_flown_as_planned_by_self_built_aircraft(model, autopilot, profile):
    plan = self_built(profile)
    assert_kept(fly_plan(plan, model, FlightRequest(autopilot=autopilot)), plan)


@pytest.mark.slow
@BOTH
def test_the_whole_office_is_flown_as_planned_in_several_sorties(model, autopilot):
    plan = plan_flight(model, PlanRequest(n_views=560, time_budget_s=10.0)).plan
    flown = fly_plan(plan, model, FlightRequest(autopilot=autopilot))
    assert len(flown.sorties) > 1
    assert_kept(flown, plan)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("autopilot", "profile", "wind_m_s"),
    [
        (Autopilot.ARDUPILOT, "m3e", 0.0),
        slow(Autopilot.ARDUPILOT, "m3e", 6.0),
        (Autopilot.PX4, "m3e", 0.0),
        slow(Autopilot.PX4, "px4", 0.0),
    ],
)
def test_two_aircraft_in_the_air_at_once_keep_apart_and_to_the_times_that_planning_allows(autopilot, profile, wind_m_s):
    site = court()
    rules = FlightRules(at_once=2, apart_m=12.0, wind_m_s=wind_m_s)
    request = PlanRequest(n_views=60, rules=rules, profile_id=profile, time_budget_s=30.0)
    plan = plan_flight(site, request).plan
    assert {sortie.aircraft for sortie in plan.sorties} == {1, 2}
    flight = fly_plan(plan, site, FlightRequest(autopilot=autopilot, conditions=Conditions(wind_m_s=wind_m_s))).flight
    (found,) = (finding for finding in flight.report.findings if finding.code == "aircraft-apart")
    assert found.severity is Severity.OK
    assert 12.0 <= found.value < 60.0
    wider = replace(plan, rules=replace(rules, apart_m=found.value + 0.1))
    (short,) = (f for f in report_flight(wider, site, flight.sorties).findings if f.code == "aircraft-apart")
    assert (short.severity, short.value) == (Severity.ERROR, found.value)
    for late in plan.sorties:  # one as early as it may be, the other as late
        sorties = tuple(replace(s, start_s=s.start_s + 2.0 * TIMING_S * (s is late)) for s in plan.sorties)
        report = report_flight(replace(plan, sorties=sorties), site, flight.sorties)
        assert all(found.severity is Severity.OK for found in report.findings if found.code == "aircraft-apart")
    assert most_astray(plan, flight) < 0.67
    if profile == "m3e":
        assert most_astray(plan, flight, n_paces=1) > 1.5, "with the planned times alone nothing would hold"


def most_astray(plan, flight, n_paces=None):
    """How far photos are from their planned times at the best mixture of paces, in parts of what planning allows."""
    taken_s, at_paces_s = [], []
    for record, sortie in zip(flight.sorties, plan.sorties, strict=True):
        _, vertices = sortie_flight_path(sortie, {v.id: v for v in plan.viewpoints}, plan.aircraft, plan.rules)
        left_s = sortie_leg_times(plan, sortie).until_s[:n_paces, vertices - 1]
        at_paces_s.append(left_s - plan.rules.takeoff_landing_s - plan.rules.photo_s)
        taken_s += [photo.time_s for photo in record.photos]
    paces, taken = np.concatenate(at_paces_s, axis=1), np.array(taken_s)
    n, slack = len(paces), TIMING_S + TIMING_SHARE * taken
    above = np.vstack([np.column_stack([paces.T, -slack]), np.column_stack([-paces.T, -slack])])
    best = linprog(
        np.eye(n + 1)[n], above, np.concatenate([taken, -taken]), np.array([[1.0] * n + [0.0]]), [1.0], (0.0, None)
    )
    return best.x[n]


@pytest.mark.slow
@BOTH
def test_the_same_seed_gives_the_same_flight_and_another_one_another(small, autopilot):
    site, plan = small
    wish = FlightRequest(autopilot=autopilot, conditions=Conditions(wind_m_s=5.0, fix="single"), seed=3)
    first, again, other = (fly_plan(plan, site, w).flight.sorties[0] for w in (wish, wish, replace(wish, seed=4)))
    assert first.photos == again.photos
    assert (first.track.position_enu_m == again.track.position_enu_m).all()
    assert first.photos != other.photos


def errors_m(flown):
    return [view.position_error_m for view in flown.flight.report.views if view.position_error_m is not None]


@pytest.mark.slow
def test_effects_are_off_in_good_conditions_and_turning_one_on_changes_less_than_its_tolerance(small):
    site, plan = small
    calm = fly_plan(plan, site, FlightRequest())
    states = {decision.effect: decision.on for decision in calm.sorties[0].effects}
    assert set(states) == {effect.name for effect in EFFECTS}
    assert not states["GNSS noise"]
    noisy = fly_plan(plan, site, FlightRequest(effects={"GNSS noise": "on"}))
    (decision,) = [d for d in noisy.sorties[0].effects if d.effect == "GNSS noise"]
    assert (decision.on, decision.decided_by) == (True, "user")
    rms = [math.sqrt(sum(e**2 for e in errors_m(flown)) / len(errors_m(flown))) for flown in (calm, noisy)]
    assert abs(rms[1] - rms[0]) < decision.tolerance


@pytest.mark.slow
def test_effects_are_on_where_conditions_call_for_them_and_turning_one_off_changes_more(small):
    site, plan = small
    wish = FlightRequest(conditions=Conditions(fix="single"))
    bad = fly_plan(plan, site, wish)
    (decision,) = [d for d in bad.sorties[0].effects if d.effect == "GNSS noise"]
    assert (decision.on, decision.decided_by) == (True, "scene")
    off = dict.fromkeys((effect.name for effect in EFFECTS), "off")
    good = fly_plan(plan, site, replace(wish, effects=off))
    assert max(errors_m(bad)) - max(errors_m(good)) > decision.tolerance


@pytest.mark.slow
def test_a_radio_that_loses_messages_delays_and_loses_nothing_else(small):
    site, plan = small
    lossy = fly_plan(plan, site, FlightRequest(conditions=Conditions(message_loss=0.2), seed=1))
    assert len(lossy.flight.sorties[0].photos) == len(plan.viewpoints)


@pytest.mark.long
def test_an_outage_in_flight_is_shown_and_survived(small):
    site, plan = small
    outage = (30.0, 30.0 + 3.0 * LINK_LOST_S)
    shown = []
    wish = FlightRequest(conditions=Conditions(outages_s=(outage,)))
    flown = fly_plan(plan, site, wish, show=shown.append)
    # Counted from take-off, not from power-up, which is more than 40 s earlier.
    up_s = min(view.time_s for view in shown if view.state.landed and view.state.landed.value is not Landed.ON_GROUND)
    dead_s = [view.time_s - up_s for view in shown if view.phase is Phase.FLYING and not view.is_link_alive]
    assert outage[0] < min(dead_s) < outage[0] + LINK_LOST_S + 1.0
    assert outage[1] - 1.0 < max(dead_s) < outage[1] + 2.0
    assert len(flown.flight.sorties[0].photos) == len(plan.viewpoints)
    assert {"link-lost", "link-found"} <= {note.code for note in flown.sorties[0].notes}


@pytest.mark.slow
def test_a_flight_is_written_whole(tmp_path):
    site_path = write_scene("single-panel", tmp_path)
    plan_path, out = tmp_path / "p.plan.json", tmp_path / "f.flight.json"
    write_plan(plan_path, plan_flight(read_site(site_path), PlanRequest(n_views=3, greedy=QUICK)).plan)
    flown = fly_files(plan_path, site_path, out, FlightRequest())
    again = read_flight(out)
    assert again.sorties[0].photos == flown.flight.sorties[0].photos
    assert again.report.summary == flown.flight.report.summary
    assert len(read_plan(plan_path).viewpoints) == 3


def test_a_plan_of_another_site_is_refused(small):
    site, plan = small
    moved = replace(site, site=replace(site.site, origin=replace(site.site.origin, lat_deg=10.0)))
    with pytest.raises(InputError, match="a changed site 'single-panel'"):
        check_site(plan, moved)
    with pytest.raises(InputError, match="another site 'office'"):
        fly_plan(replace(plan, site_sha256="ab"), replace(office(), sha256="cd"), FlightRequest())


def test_what_cannot_be_flown_says_why_and_writes_nothing(small, tmp_path):
    site, plan = small
    with pytest.raises(InfeasibleError, match="wind"):
        fly_plan(plan, site, FlightRequest(conditions=Conditions(wind_m_s=40.0)))
    with pytest.raises(InputError, match="no effect 'rain'"):
        fly_plan(plan, site, FlightRequest(effects={"rain": "on"}))
    with pytest.raises(MissionError, match="no sorties"):
        fly_plan(replace(plan, sorties=()), site, FlightRequest())
    tired = replace(plan, aircraft=replace(plan.aircraft, endurance_s=60.0))
    with pytest.raises((MissionError, LinkRejected), match="battery"):
        fly_plan(tired, site, FlightRequest())


@pytest.mark.slow
def test_sorties_flown_at_a_link_are_kept_when_a_later_one_fails(tmp_path, monkeypatch):
    from groundstation.services.fly import flying

    site_path = write_scene("single-panel", tmp_path)
    model = read_site(site_path)
    plan = plan_flight(model, PlanRequest(n_views=4, greedy=QUICK)).plan
    (own,) = plan.sorties
    plan = replace(plan, sorties=(own, replace(own, viewpoint_ids=())))
    plan_path, out = tmp_path / "p.plan.json", tmp_path / "f.flight.json"
    write_plan(plan_path, plan)
    simulated = FlightRequest()

    def at_link(case, orders):
        if orders.number == 2:
            raise LinkRejected("sortie 2: the battery holds 40%")
        return flying._Case._simulate(replace(case, request=simulated), orders)

    monkeypatch.setattr(flying._Case, "_fly_link", at_link)
    asked = []
    with pytest.raises(LinkRejected, match=r"battery holds 40%; what was flown before is in .*f\.flight\.json"):
        fly_files(plan_path, site_path, out, FlightRequest(link="tcp:here:1"), between=asked.append)
    assert asked == [2]
    assert len(read_flight(out).sorties) == 1


@pytest.mark.slow
def test_what_a_vehicle_at_a_link_flew_before_it_vanished_is_kept(tmp_path, monkeypatch):
    from groundstation.services.fly import flying

    site_path = write_scene("single-panel", tmp_path)
    plan = plan_flight(read_site(site_path), PlanRequest(n_views=4, greedy=QUICK)).plan
    plan_path, out = tmp_path / "p.plan.json", tmp_path / "f.flight.json"
    write_plan(plan_path, plan)

    def vanishing(case, orders):
        outcome, record, sortie = flying._Case._simulate(replace(case, request=FlightRequest()), orders)
        error = LinkTimeout("the vehicle was not heard for 300 s in flight")
        return replace(outcome, error=error), replace(record, photos=record.photos[:2], duration_s=None), sortie

    monkeypatch.setattr(flying._Case, "_fly_link", vanishing)
    with pytest.raises(LinkTimeout, match=r"not heard for 300 s.*flown before is in .*f\.flight\.json"):
        fly_files(plan_path, site_path, out, FlightRequest(link="tcp:here:1"))
    (record,) = read_flight(out).sorties
    assert len(record.photos) == 2


@pytest.mark.slow
def test_a_cancelled_flight_is_cancelled(small):
    site, plan = small

    class Cancelling:
        def report(self, stage, done, total):
            if stage == "photos":
                raise OperationCancelled("by the test")

    with pytest.raises(OperationCancelled):
        fly_plan(plan, site, FlightRequest(), monitor=Cancelling())
