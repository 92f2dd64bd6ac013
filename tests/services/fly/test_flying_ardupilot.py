"""A real ArduCopter, in its own simulation, flies our missions: what must hold, with numbers.

Runs where REFLIGHT_SITL_ARDUPILOT names its binary, or the link of one that stands at home of the site `single-panel`
with a battery for four short flights.
"""

import time
from collections import deque
from contextlib import closing
from dataclasses import dataclass, field, replace

import pytest

from groundstation.services.fly.flying import FlightRequest, fly_link, fly_plan
from groundstation.vehicle.duration import items_duration_s
from groundstation.vehicle.orders import fence_messages, sortie_orders
from groundstation.vehicle.sortie.run_records import Phase, PilotOrder, RunOptions
from missions.flight.logs.read import read_log
from missions.flight.matching import match_flight
from missions.flight.outcome import Reason
from missions.flight.report import report_flight
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import rally_items
from missions.mavlink.link import GROUND_STATION, VEHICLE, drive, open_link
from missions.mavlink.transfer.exchange import MissionType, Route
from missions.mavlink.transfer.verified import Verified, VerifiedUpload
from missions.mavlink.transfer.wire_items import to_wire
from missions.mission.build import missions_from_plan
from missions.mission.resume import resume_sortie
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import single_panel
from tests.services.real_autopilots import real_vehicle, variable

ARDUPILOT = Autopilot.ARDUPILOT
POSITION_M, HEADING_DEG, PITCH_DEG, COVERAGE, DURATION = 0.5, 3.0, 2.0, 0.97, 0.1
N_VIEWS = 8
SETS = RunOptions(autopilot=ARDUPILOT, sets_parameters=True)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def planned():
    model = single_panel()
    plan = plan_flight(model, PlanRequest(n_views=N_VIEWS, time_budget_s=2.0, profile_id="ardupilot")).plan
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    return model, plan, sortie_orders(plan, model, mission)


@pytest.fixture
def url(planned):
    with real_vehicle(ARDUPILOT, planned[2].home) as url:
        if url is None:
            pytest.skip(f"no ArduCopter to fly: {variable(ARDUPILOT)} names neither its binary nor its link")
        yield url


def check(report):
    """All photos, each as it was planned."""
    assert report.summary.n_taken == report.summary.n_photos == N_VIEWS
    assert max(view.position_error_m for view in report.views) < POSITION_M
    assert max(abs(view.heading_error_deg) for view in report.views) < HEADING_DEG
    assert max(abs(view.gimbal_pitch_error_deg) for view in report.views) < PITCH_DEG
    assert report.summary.covered >= COVERAGE * report.summary.covered_planned


@dataclass
class Pilot:
    """Gives each order once so many photos were taken; the next one no sooner than 5 s of the vehicle's time later."""

    orders: deque = field(default_factory=deque)
    run: object = None
    ordered_s: float = 0.0

    def started(self, run):
        self.run = run

    def show(self, view):
        if not self.orders or view.phase is not Phase.FLYING:
            return
        n_photos, order = self.orders[0]
        now_s = view.state.boot_time_s
        if len(view.state.photos) >= n_photos and now_s >= self.ordered_s + 5.0:
            self.orders.popleft()
            self.ordered_s = now_s
            self.run.order(order)


def flown(orders, url, folder, pilot):
    _, outcome, log = fly_link(orders, url, SETS, folder, pilot.show, pilot.started)
    assert outcome.error is None
    assert not pilot.orders
    return outcome, log


def test_a_plan_is_flown_as_it_was_planned_and_timed(planned, url, tmp_path):
    model, plan, orders = planned
    wish = FlightRequest(link=url, autopilot=ARDUPILOT, sets_parameters=True, log_folder=tmp_path)
    done = fly_plan(plan, model, wish)
    check(done.flight.report)
    (sortie,), (outcome,) = done.sorties, done.flight.report.sorties
    assert outcome.duration_flown_s == pytest.approx(items_duration_s(orders, ARDUPILOT), rel=DURATION)
    told = [note.text for note in sortie.notes if note.code == "uploaded"]
    assert told[-1] == f"mission: {len(orders.items[ARDUPILOT]) + 1} items, read back and equal"
    (logged,) = read_log(sortie.log, model.site).records
    again = report_flight(plan, model, [logged])
    check(again)
    assert again.sorties[0].duration_flown_s == pytest.approx(outcome.duration_flown_s, abs=1.0)


def test_pausing_and_resuming_loses_and_doubles_no_photo(planned, url, tmp_path):
    model, plan, orders = planned
    pause, resume = PilotOrder.PAUSE, PilotOrder.RESUME
    pilot = Pilot(deque([(1, pause), (1, resume), (4, pause), (4, resume), (5, pause), (5, resume)]))
    outcome, _ = flown(orders, url, tmp_path, pilot)
    check(report_flight(plan, model, [outcome.record]))
    answers = [note.text for note in outcome.notes if note.code == "order"]
    assert answers == ["pausing: done", "resuming the mission: done"] * 3


def test_after_a_return_the_rest_is_flown_and_no_photo_is_lost(planned, url, tmp_path):
    model, plan, orders = planned
    first, _ = flown(orders, url, tmp_path, Pilot(deque([(3, PilotOrder.RETURN)])))
    records = [first.record]
    matched = match_flight(plan, records).views
    taken = [view.view_id for view in matched if view.reason is Reason.TAKEN]
    assert 3 <= len(taken) < N_VIEWS
    rest = resume_sortie(plan, model, 1, taken)
    second, _ = flown(sortie_orders(rest.plan, model, rest.mission), url, tmp_path, Pilot())
    check(report_flight(plan, model, [*records, replace(second.record, sortie=1)]))


def test_landing_on_the_spot_is_obeyed(planned, url, tmp_path):
    model, _, orders = planned
    outcome, _ = flown(orders, url, tmp_path, Pilot(deque([(1, PilotOrder.LAND)])))
    assert outcome.record.photos
    first, last = outcome.record.photos[0].position_enu_m, outcome.record.track.position_enu_m[-1]
    assert last[:2] == pytest.approx(first[:2], abs=25.0)
    assert last[2] == pytest.approx(model.site.home_enu_m[2], abs=0.5)


def test_missions_fences_and_rally_points_come_back_equal_and_can_be_cleared(planned, url):
    _, _, orders = planned
    home, e7 = orders.home, 1e-5
    corners = tuple((home.lat_deg + e7 * a, home.lon_deg + e7 * b) for a, b in ((9, 9), (9, 30), (30, 30), (30, 9)))
    points = [replace(home, height_ellipsoid_m=home.height_ellipsoid_m + 15.7)]
    lists = {
        MissionType.MISSION: to_wire(orders.items[ARDUPILOT], ARDUPILOT),
        MissionType.FENCE: fence_messages((corners, corners[:3]), ARDUPILOT),
        MissionType.RALLY: to_wire(rally_items(points, home), ARDUPILOT, MissionType.RALLY),
    }
    with closing(open_link(url)) as link:
        for kind, items in lists.items():
            route = Route(GROUND_STATION, VEHICLE, kind)
            assert isinstance(drive(VerifiedUpload(route, items, ARDUPILOT), link, time.perf_counter), Verified)
            cleared = drive(VerifiedUpload(route, (), ARDUPILOT), link, time.perf_counter)
            assert isinstance(cleared, Verified)
