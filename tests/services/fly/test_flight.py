"""A live flight: requests, events, what is kept, and every way in which the link misbehaves."""

import socket
import time
from dataclasses import replace

import pytest

from groundstation.services.fly.connection import Simulation, VehicleAt
from groundstation.services.fly.events import (
    Answered,
    FlightChanged,
    FlightEnded,
    LinkChanged,
    LinkState,
    LogFetched,
    LogProblem,
    PhotoCounted,
    Request,
    ViewState,
)
from groundstation.services.fly.flight import LiveFlight
from groundstation.services.fly.flying import report_of_log
from groundstation.services.fly.log_book import book_path, read_book
from groundstation.services.fly.options import FlightSettings
from groundstation.services.fly.sortie import prepare_sortie
from groundstation.vehicle.duration import items_duration_s
from groundstation.vehicle.preflight import Verdict
from groundstation.vehicle.sortie.run_records import Phase
from missions.flight.flight_file import read_flight
from missions.flight.logs.read import read_log
from missions.flight.outcome import Reason
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import MissionAck
from missions.simulator.conditions import Conditions
from planning.base.errors import MissionError
from tests.missions.mavlink.test_camera_definition import GUIDE
from tests.services.live_cases import SPEED_UP, Follower, Reopening, planned, simulation, sortie
from tests.slow import slow
from tests.vehicle.test_camera import MANUAL, OTHER, obedient


@pytest.fixture
def flight(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    flights = []

    def begin(connection=None, folder=None, orders=None, **options):
        follower = Follower()
        connection = connection or simulation()
        flight = LiveFlight(orders or sortie(), connection, follower, folder or tmp_path / "flights", **options)
        flights.append((flight, follower, connection))
        flight.start()
        return flight, follower

    yield begin
    for flight, follower, connection in flights:
        follower.let_go()
        assert flight.close()
        if isinstance(connection, Reopening):
            connection.end()


def fly(flight, follower):
    """Upload and start."""
    follower.until_may(Request.UPLOAD)
    flight.request(Request.UPLOAD)
    follower.until_may(Request.START)
    flight.request(Request.START)


@pytest.mark.long
@pytest.mark.parametrize("autopilot", [slow(Autopilot.ARDUPILOT), Autopilot.PX4])
def test_a_sortie_is_flown_from_connecting_to_the_report(flight, tmp_path, autopilot):
    live, follower = flight(simulation(autopilot=autopilot))
    fly(live, follower)
    ended = follower.until_ended()
    assert ended.error is None
    photos = follower.of(PhotoCounted)
    assert [photo.view_id for photo in photos] == list(sortie().viewpoint_ids)
    assert all(photo.position_error_m < 0.5 for photo in photos)
    covered = [photo.covered for photo in photos]
    assert covered == sorted(covered)
    assert covered[-1] >= 0.97 * photos[-1].covered_planned
    assert sorted(photo.seconds for photo in photos)[len(photos) // 2] < 0.05
    assert all(view.reason is Reason.TAKEN for view in ended.report.views)
    answered = [(event.request, event.is_accepted) for event in follower.of(Answered)]
    assert answered == [(Request.UPLOAD, True), (Request.START, True)]
    kept = read_flight(ended.path)
    assert len(kept.sorties[0].photos) == len(photos)
    assert kept.report.summary.n_taken == len(photos)
    (log,) = (tmp_path / "flights").glob("*.tlog")
    (logged,) = read_log(log, planned()[0].site).records
    assert len(logged.photos) == len(photos)


@pytest.mark.slow
def test_the_report_compares_with_how_long_the_items_take(flight):
    live, follower = flight()
    fly(live, follower)
    (outcome,) = follower.until_ended().report.sorties
    expected_s = items_duration_s(sortie().orders, Autopilot.ARDUPILOT)
    assert outcome.duration_predicted_s == pytest.approx(expected_s)
    assert outcome.duration_flown_s == pytest.approx(expected_s, rel=0.1)


@pytest.mark.parametrize(("speed_up", "delay_s"), [(1.0, 10.0), (5.0, 50.0), (40.0, 127.0)])
def test_a_faster_vehicle_waits_longer_for_the_order_after_arming(speed_up, delay_s):
    """At most what ArduPilot takes: ten of its seconds are a quarter of one at forty times real time."""
    model, plan = planned()
    opened = Simulation(plan, model, speed_up=speed_up).open(sortie().orders, time.perf_counter, lambda *_frame: None)
    assert opened.simulated.parameters["DISARM_DELAY"] == delay_s
    opened.link.close()


@pytest.mark.slow
def test_views_come_at_most_ten_times_a_second(flight):
    live, follower = flight()
    fly(live, follower)
    follower.until(lambda event: isinstance(event, PhotoCounted))
    n_before = len(follower.events)
    follower.until(lambda event: isinstance(event, PhotoCounted) and event.number >= 4)
    told_s, events = follower.told_s[n_before:], follower.events[n_before:]
    n_views = sum(isinstance(event, FlightChanged) for event in events)
    # Told by the flight's own thread, which may be held up between two looks at its clock.
    assert n_views <= 10.0 * (told_s[-1] - told_s[0]) + 12
    assert n_views > 0


@pytest.mark.long
def test_pause_resume_and_return_are_acknowledged(flight):
    live, follower = flight()
    fly(live, follower)
    for request, then in ((Request.PAUSE, Request.RESUME), (Request.RESUME, Request.PAUSE)):
        follower.until_may(request)
        live.request(request)
        answer = follower.until(lambda event, request=request: isinstance(event, Answered) and event.request is request)
        assert answer.is_accepted
        follower.until_may(then)
    live.request(Request.RETURN)
    answer = follower.until(lambda event: isinstance(event, Answered) and event.request is Request.RETURN)
    assert answer.is_accepted
    ended = follower.until_ended()
    assert any(view.reason is not Reason.TAKEN for view in ended.report.views)
    assert not follower.view.state.is_armed, "with the report, it is known to have landed"
    # The vehicle stays connected, and may be given a mission again.
    follower.until_may(Request.UPLOAD)


def test_what_cannot_be_done_now_is_refused_in_words(flight):
    live, follower = flight()
    follower.until_may(Request.UPLOAD)
    live.request(Request.START)
    answer = follower.until(lambda event: isinstance(event, Answered))
    assert not answer.is_accepted
    assert "pre-flight list" in answer.text


def test_start_is_refused_while_the_list_is_not_well(flight):
    """A wind above the aircraft's limit stands on the list; its lulls, which come, are no reason to wait for."""
    live, follower = flight(simulation(conditions=Conditions(wind_m_s=18.0), effects={"wind": "on"}))
    follower.until_may(Request.UPLOAD)
    live.request(Request.UPLOAD)
    follower.until(lambda event: isinstance(event, Answered) and event.request is Request.UPLOAD)

    def blows(event):
        checks = event.view.checks if isinstance(event, FlightChanged) else ()
        return any(check.code == "wind" and check.verdict is Verdict.BAD for check in checks)

    follower.until(blows)
    assert follower.view.phase is Phase.CHECKING
    assert Request.START not in follower.view.may


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("carrier-pigeon:roof:1", "expected KIND:HOST:PORT"),
        ("tcp:127.0.0.1:1", "cannot be opened"),
    ],
)
def test_an_address_that_leads_nowhere_is_told_at_once(flight, url, words):
    _, follower = flight(VehicleAt(url))
    closed = follower.until_closed()
    assert words in closed.text


def test_a_port_in_use_is_told_at_once(flight):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        _, follower = flight(VehicleAt(f"udp:127.0.0.1:{other.getsockname()[1]}"))
        assert "cannot be opened" in follower.until_closed().text


@pytest.mark.slow
def test_a_link_that_breaks_in_flight_is_opened_again_and_the_sortie_goes_on(flight):
    radio = Reopening()
    live, follower = flight(radio)
    fly(live, follower)
    follower.until(lambda event: isinstance(event, PhotoCounted))
    radio.cut.is_unplugged.set()
    lost = follower.until(lambda event: isinstance(event, LinkChanged) and event.link is LinkState.LOST)
    assert "unplugged" in lost.text
    follower.until(lambda event: isinstance(event, FlightChanged) and event.view.link is LinkState.LOST)
    assert {Request.RETURN, Request.LAND} <= follower.view.may
    radio.cut.is_unplugged.clear()
    follower.until(lambda event: isinstance(event, LinkChanged) and event.link is LinkState.ALIVE)
    assert follower.until_ended().error is None


@pytest.mark.slow
def test_silence_is_shown_and_survived(flight):
    """The radio loses everything for a while; what was photographed meanwhile is in the record all the same."""
    radio = Reopening()
    live, follower = flight(radio)
    fly(live, follower)
    follower.until(lambda event: isinstance(event, PhotoCounted))
    radio.cut.is_jammed.set()
    follower.until(lambda event: isinstance(event, LinkChanged) and event.link is LinkState.LOST)
    radio.cut.is_jammed.clear()
    follower.until(lambda event: isinstance(event, LinkChanged) and event.link is LinkState.ALIVE)
    ended = follower.until_ended()
    assert ended.record is not None
    assert len(ended.record.photos) == len(sortie().viewpoint_ids)


@pytest.mark.slow
def test_disconnecting_in_flight_keeps_what_was_flown(flight):
    live, follower = flight()
    fly(live, follower)
    follower.until(lambda event: isinstance(event, PhotoCounted) and event.number >= 2)
    assert live.is_in_flight
    follower.let_go()
    assert live.close()
    follower.until_closed()
    (ended,) = follower.of(FlightEnded)
    assert "goes on by itself" in str(ended.error)
    assert len(ended.record.photos) >= 2
    assert read_flight(ended.path).sorties


@pytest.mark.slow
def test_a_folder_that_cannot_be_written_is_told_and_replaced(flight, tmp_path):
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where the folder should be")
    live, follower = flight(folder=blocked)
    problem = follower.until(lambda event: isinstance(event, LogProblem))
    assert "blocked" in problem.text
    fly(live, follower)
    ended = follower.until_ended()
    assert ended.path.parent == tmp_path / "config" / "data" / "flights"
    assert list(ended.path.parent.glob("*.tlog"))


class Refusing(Simulation):
    """A vehicle that says no to every mission."""

    def open(self, orders, clock, observe):
        opened = super().open(orders, clock, observe)
        return replace(opened, link=RefusingLink(opened.link))


class RefusingLink:
    def __init__(self, link):
        self._link, self.address = link, link.address

    def send(self, message):
        self._link.send(message)

    def receive(self, timeout_s):
        received = self._link.receive(timeout_s)
        if received is not None and type(received.message).__name__.startswith("MissionRequest"):
            message = received.message
            ack = MissionAck(message.target_system, message.target_component, 4, message.mission_type)
            return replace(received, message=ack)
        return received

    def close(self):
        self._link.close()


@pytest.mark.long
def test_a_mission_that_the_vehicle_refuses_is_never_called_on_board(flight):
    model, plan = planned()
    live, follower = flight(Refusing(plan, model, speed_up=SPEED_UP))
    follower.until_may(Request.UPLOAD)
    live.request(Request.UPLOAD)
    answer = follower.until(lambda event: isinstance(event, Answered))
    assert not answer.is_accepted
    assert "not on the vehicle" in answer.text
    follower.until_may(Request.UPLOAD)
    assert Request.START not in follower.view.may
    assert follower.view.on_board.mission is None


@pytest.mark.long
def test_a_camera_over_a_link_is_set_by_the_definition_file_that_the_pilot_named(flight, tmp_path):
    model, plan = planned()
    plan = obedient(plan, MANUAL)

    def told_of_camera(definition):
        connection = Simulation(plan, model, speed_up=SPEED_UP, is_simulated=False)
        settings = FlightSettings(camera_definition=str(definition) if definition else "")
        live, follower = flight(connection, settings=settings, orders=prepare_sortie(plan, model, 1))
        follower.until_may(Request.UPLOAD)
        live.request(Request.UPLOAD)
        follower.until(lambda event: isinstance(event, FlightChanged) and event.view.on_board.camera is not None)
        problems = [event.text for event in follower.of(LogProblem)]
        check = follower.view.on_board.camera
        follower.let_go()
        live.close()
        return check.text, problems

    (tmp_path / "guide.xml").write_bytes(GUIDE)
    (tmp_path / "other.xml").write_bytes(OTHER)
    text, problems = told_of_camera(tmp_path / "guide.xml")
    # The guide's example has a shutter time and a mode, and neither ISO, aperture nor white balance.
    assert text.startswith("the camera is set, and read back: manual exposure, 1/500 s; the camera does not take this")
    assert problems == []
    text, _ = told_of_camera(tmp_path / "other.xml")
    assert "no camera answers by the camera protocol" in text, "this camera has no parameter of these names"
    text, problems = told_of_camera(tmp_path / "gone.xml")
    assert text.startswith("the camera is set, and read back: manual exposure, 1/500 s, f/5.6, ISO 200")
    assert "the camera is asked for its own definition: " in problems[0]


@pytest.mark.slow
def test_photos_of_an_earlier_battery_count_on(flight):
    live, follower = flight()
    fly(live, follower)
    follower.until(lambda event: isinstance(event, PhotoCounted) and event.number >= 2)
    live.request(Request.RETURN)
    first = follower.until_ended()
    follower.let_go()
    live.close()
    again, follower = flight(flown=(first.record,))
    follower.until_may(Request.UPLOAD)
    done = [state for _, state in follower.view.view_states if state in (ViewState.TAKEN, ViewState.OFF)]
    assert len(done) == len(first.record.photos)
    follower.let_go()
    assert again.close()


def test_a_plan_that_breaks_a_rule_is_not_prepared_for_flight():
    model, plan = planned()
    wider = replace(plan.constraints, min_distance_m=80.0)
    with pytest.raises(MissionError, match="pre-flight rules, such as: smallest distance"):
        prepare_sortie(replace(plan, constraints=wider), model, 1)


@pytest.mark.long
def test_the_vehicles_own_log_is_fetched_after_the_landing_and_reported(flight, tmp_path):
    live, follower = flight()
    fly(live, follower)
    follower.until(lambda event: isinstance(event, PhotoCounted))
    live.request(Request.LOG)
    refused = follower.until(lambda event: isinstance(event, Answered) and event.request is Request.LOG)
    assert (refused.is_accepted, "on the ground only" in refused.text) == (False, True)
    ended = follower.until_ended()
    follower.until_may(Request.LOG)
    live.request(Request.LOG)
    follower.until(lambda event: isinstance(event, FlightChanged) and event.view.fetching is not None)
    fetched = follower.until(lambda event: isinstance(event, LogFetched))
    assert fetched.is_checked
    assert fetched.path.parent == tmp_path / "flights"
    record, report, out = report_of_log(sortie().case, fetched.path)
    assert [view.view_id for view in report.views if view.reason is Reason.TAKEN] == list(sortie().viewpoint_ids)
    assert len(record.photos) == len(ended.record.photos)
    assert read_flight(out).report.summary.n_taken == len(record.photos)


@pytest.mark.slow
def test_fetching_the_log_can_be_stopped_and_begun_again(flight):
    live, follower = flight()
    fly(live, follower)
    follower.until_ended()
    follower.until_may(Request.LOG)
    live.request(Request.LOG)
    live.request(Request.LOG)
    stopped = follower.until(lambda event: isinstance(event, Answered) and event.request is Request.LOG)
    assert "stopped" in stopped.text
    live.request(Request.LOG)
    assert follower.until(lambda event: isinstance(event, LogFetched)).is_checked


@pytest.mark.slow
def test_a_flight_is_entered_in_the_books_with_its_battery(flight, tmp_path):
    live, follower = flight(settings=FlightSettings(battery="B3", operator="FIN87astrdge12k8"))
    fly(live, follower)
    follower.until_ended()
    follower.until_may(Request.UPLOAD)
    for path in (book_path(tmp_path / "flights"), book_path()):
        (entry,) = read_book(path)
        assert (entry.battery, entry.operator, entry.is_simulated, entry.sortie) == ("B3", "FIN87astrdge12k8", True, 1)
        assert (entry.n_photos, entry.n_planned, entry.ended) == (6, 6, "")
        assert 0.0 < entry.battery_used < 0.5
