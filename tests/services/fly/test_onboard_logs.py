"""The vehicle's own logs after a flight: listed, fetched over a real link, and read by the report."""

from __future__ import annotations

import itertools
import threading

import pytest

from groundstation.services.fly.onboard_logs import fetch_logs, keep_logs, list_logs
from groundstation.vehicle.onboard_logs import FetchedLogs, LogFetch, LogListing, OnboardFile, newest
from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions
from missions.flight.logs.read import read_log
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import drive, memory_pair, open_link
from missions.mavlink.messages import Address, FileTransferProtocol, Message, Received
from missions.mavlink.transfer.exchange import Route
from missions.mission.build import missions_from_plan
from missions.simulator.autopilot.file_server import FileServer
from missions.simulator.build import make_airframe
from missions.simulator.server import DirectLink, serve
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import InputError, LinkError, LinkTimeout, OperationCancelled
from tests.missions.simulator.flying import bundled
from tests.missions.simulator.ground import ORIGIN, PointMass
from tests.slow import slow

OWN, VEHICLE = Address(255, 190), Address(1, 1)
ROUTE = Route(OWN, VEHICLE)


@pytest.fixture(scope="module", params=[slow(Autopilot.ARDUPILOT), slow(Autopilot.PX4)])
def flown(request):
    """A vehicle that stands again after a flight of four photos, what was recorded of it live, and its site."""
    model, plan = bundled("roof", 4)
    site = model.site
    (mission,) = missions_from_plan(plan, site.origin, site.home_enu_m)
    airframe, _ = make_airframe(plan, model, plan.sorties[0], seed=3)
    vehicle = SimulatedVehicle(request.param, airframe, site.origin, site.home_enu_m, is_ready=True)
    link = DirectLink(vehicle)
    run = FlightRun(sortie_orders(plan, model, mission), RunOptions(sets_parameters=True), "simulation")
    outcome = conduct(run, link, link.clock)
    assert outcome.succeeded
    vehicle.step(5.0)
    return vehicle, outcome.record, site


@pytest.fixture
def url(flown):
    """The vehicle served over TCP."""
    vehicle, _, _ = flown
    server = open_link("tcpin:127.0.0.1:0", vehicle.address)
    stop = threading.Event()
    thread = threading.Thread(target=serve, args=(vehicle, [server]), kwargs={"stop": stop.is_set}, daemon=True)
    thread.start()
    yield f"tcp:127.0.0.1:{server.channel.port}"
    stop.set()
    thread.join()
    server.close()


def test_the_log_comes_over_a_link_and_tells_what_was_seen_live(flown, url, tmp_path):
    vehicle, live, site = flown
    (log,) = fetch_logs(url, tmp_path)
    assert log.is_checked
    assert log.path.read_bytes() == vehicle.log.files()[log.file.path]
    (record,) = read_log(log.path, site).records
    assert len(record.photos) == len(live.photos) == 4
    for ours, told in zip(live.photos, record.photos, strict=True):
        assert told.position_enu_m == pytest.approx(ours.position_enu_m, abs=0.05)
        assert told.gimbal_pitch_deg == pytest.approx(ours.gimbal_pitch_deg, abs=1.0)
        assert told.heading_deg == pytest.approx(ours.heading_deg, abs=1.0)
    assert record.duration_s == pytest.approx(live.duration_s, abs=2.0)
    # The same once more is there already; another file of the name is left alone.
    assert fetch_logs(url, tmp_path)[0].was_there
    log.path.write_bytes(b"mine")
    again = fetch_logs(url, tmp_path)[0].path
    assert again.stem.endswith("-2")
    assert log.path.read_bytes() == b"mine"


def test_logs_are_listed_and_chosen_by_name(flown, url, tmp_path):
    files = list_logs(url)
    assert [each.path for each in files] == list(flown[0].log.files())
    assert files[0].n_bytes > 10_000
    assert fetch_logs(url, tmp_path, names=[files[0].name])[0].file == files[0]
    with pytest.raises(InputError, match="there is no log 'x' on the vehicle; the newest are"):
        fetch_logs(url, tmp_path, names=["x"])


def test_nobody_who_answers_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr("groundstation.services.fly.onboard_logs.HEARD_S", 0.2)
    with pytest.raises(LinkTimeout, match="no ArduPilot or PX4 is heard"):
        fetch_logs("udp:127.0.0.1:0", tmp_path)


def run(machine, server, most=10_000):
    """Drive a machine against a server without a link."""
    outgoing, now_s = machine.start(0.0), 0.0
    for _ in range(most):
        if machine.outcome is not None:
            return machine.outcome
        now_s += 0.02
        answers = [answer for each in outgoing for answer in server.receive(each, OWN)] + server.tick()
        outgoing = [m for answer in answers for m in machine.receive(Received(answer, VEHICLE, now_s))]
        outgoing += machine.tick(now_s)
    raise AssertionError("it never ended")


def test_px4_keeps_a_folder_a_day_and_its_simulation_another_place():
    for top in ("/fs/microsd/log", "/log"):
        files = {f"{top}/2026-01-0{day}/10_00_00.ulg": bytes(day) for day in (2, 1)} | {f"{top}/sess001/x.txt": b""}
        listed = run(LogListing(ROUTE, Autopilot.PX4), FileServer(lambda files=files: files))
        assert [(each.name, each.n_bytes) for each in listed.files] == [
            ("2026-01-01_10_00_00.ulg", 1),
            ("2026-01-02_10_00_00.ulg", 2),
        ]


def test_a_vehicle_without_logs_or_without_file_transfer_says_so():
    listed = run(LogListing(ROUTE, Autopilot.ARDUPILOT), FileServer(dict))
    assert (listed.files, listed.problem) == ((), "there are no logs on the vehicle")

    class Deaf(FileServer):
        def receive(self, message: FileTransferProtocol, source: Address) -> list[Message]:
            return []

    listed = run(LogListing(ROUTE, Autopilot.ARDUPILOT), Deaf(dict))
    assert "answers neither to file transfer (MAVFTP) nor to the log protocol" in listed.problem


def test_what_came_before_a_log_that_does_not_is_kept(tmp_path):
    files = {"/logs/1.BIN": b"one", "/logs/2.BIN": b"two"}
    wanted = [OnboardFile("/logs/1.BIN", 3), OnboardFile("/logs/3.BIN", 3), OnboardFile("/logs/2.BIN", 3)]
    fetched = run(LogFetch(ROUTE, wanted), FileServer(lambda: files))
    assert [content for _, content, _ in fetched.files] == [b"one"]
    assert fetched.problem == "3.BIN did not come: the vehicle refuses: its file system cannot"
    assert [each.path.name for each in keep_logs(fetched, tmp_path)] == ["1.BIN"]


def test_the_newest_logs_are_those_with_something_in_them():
    files = [OnboardFile(f"/logs/{n}.BIN", n % 3) for n in range(1, 7)]
    assert [each.path for each in newest(files, 2)] == ["/logs/4.BIN", "/logs/5.BIN"]
    assert newest(files, 0) == ()
    assert newest([], 1) == ()


def test_cancelling_tells_the_vehicle(flown):
    vehicle, _, _ = flown
    link = DirectLink(vehicle)

    class Cancels:
        def report(self, _stage, done, _total):
            if done > 5000:
                raise OperationCancelled("cancelled")

    path, content = next(iter(vehicle.log.files().items()))
    wanted = [OnboardFile(path, len(content))]
    with pytest.raises(OperationCancelled):
        drive(LogFetch(ROUTE, wanted), link, link.clock, Cancels())
    assert vehicle._file_server._session is None


def test_a_link_that_breaks_is_said_and_leaves_no_file(tmp_path):
    ground, air = memory_pair()
    air.close()
    with pytest.raises(LinkError, match="the other end closed the link"):
        drive(LogListing(ROUTE, Autopilot.ARDUPILOT), ground, ground.clock)
    assert keep_logs(FetchedLogs(()), tmp_path) == ()
    assert list(tmp_path.iterdir()) == []


def test_the_simulated_vehicle_logs_from_arming_until_the_motors_stopped(flown):
    vehicle, live, _ = flown
    (flight,) = vehicle.log.flights
    times = [sample.time_s for sample in flight.samples]
    assert max(b - a for a, b in itertools.pairwise(times)) < 0.3
    assert times[-1] - times[0] == pytest.approx(live.duration_s + 3.0, abs=3.0)
    assert flight.samples[0].is_armed
    assert not flight.samples[-1].is_armed
    idle = SimulatedVehicle(Autopilot.PX4, PointMass(), ORIGIN)
    idle.step(10.0)
    assert idle.log.files() == {}


@pytest.mark.slow
def test_without_file_transfer_the_log_comes_by_the_log_protocol_and_goes_on_where_it_broke_off(
    flown, url, tmp_path, monkeypatch
):
    vehicle, live, site = flown
    monkeypatch.setattr(vehicle, "has_file_transfer", False)
    whole = next(iter(vehicle.log.files().values()))
    first = 1 if vehicle.autopilot is Autopilot.ARDUPILOT else 0
    (log,) = fetch_logs(url, tmp_path)
    assert log.file.n_bytes == len(whole)
    assert log.path.name.startswith(f"log-{first:05d}-2")
    log.path.unlink()
    part = tmp_path / f"{log.file.name}.{len(whole)}.part"
    part.write_bytes(whole[:9000])
    (log,) = fetch_logs(url, tmp_path)
    assert not log.is_checked
    assert log.path.read_bytes() == whole
    assert not part.exists()
    (record,) = read_log(log.path, site).records
    assert len(record.photos) == len(live.photos)


def test_what_came_of_a_broken_log_is_kept_for_the_next_try(tmp_path):
    file = OnboardFile("log-00007-20261128-100000.BIN", 1000, 7)
    assert keep_logs(FetchedLogs((), "silent", (file, b"abc")), tmp_path) == ()
    part = tmp_path / "log-00007-20261128-100000.BIN.1000.part"
    assert part.read_bytes() == b"abc"
    (kept,) = keep_logs(FetchedLogs(((file, b"abcd", False),)), tmp_path)
    assert kept.path.read_bytes() == b"abcd"
    assert not part.exists()
