"""RTK corrections from a caster on this machine to the simulated vehicle, and casters that fail."""

import queue
import socket
import threading
import time

import pytest

from groundstation.services.fly.corrections import (
    FAR_M,
    Corrections,
    CorrectionsStatus,
    corrections_check,
)
from groundstation.services.fly.events import FlightChanged
from groundstation.services.fly.flight import LiveFlight
from groundstation.vehicle.preflight import Verdict
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Address, GpsRawInt, Received
from missions.mavlink.ntrip import Caster
from missions.mission.model import GeoPoint
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import LinkError
from tests.missions.mavlink.test_rtk import EXAMPLE, EXAMPLE_ECEF_M, framed
from tests.missions.simulator.ground import ORIGIN, PointMass
from tests.services.live_cases import Follower, simulation, sortie

PLACE = GeoPoint(22.3372, 114.2636, 62.0)
GROUND = Address(255, 190)


class ScriptedCaster:
    """A caster that answers one connection after the other with what its script says."""

    def __init__(self, *answers):
        self.server = socket.create_server(("127.0.0.1", 0))
        self.asked, self.answers = queue.SimpleQueue(), list(answers)
        self.port = self.server.getsockname()[1]
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self):
        for answer in self.answers:
            try:
                connection, _ = self.server.accept()
            except OSError:
                return
            with connection:
                connection.settimeout(5.0)
                asked = b""
                while b"\r\n\r\n" not in asked:
                    asked += connection.recv(4096)
                self.asked.put(asked)
                for piece in answer:
                    connection.sendall(piece)
        self.server.close()

    def close(self):
        self.server.close()


@pytest.fixture
def corrections():
    made = []

    def begin(*answers, user="me", **options):
        caster = ScriptedCaster(*answers)
        found = Corrections(Caster("127.0.0.1", caster.port, "VRS", user), "pass", PLACE, **options)
        made.append((caster, found))
        found.start()
        return caster, found

    yield begin
    for caster, found in made:
        found.close()
        caster.close()
        found._thread.join(5.0)
        assert not found._thread.is_alive()


def until(condition):
    end = time.monotonic() + 10.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_corrections_go_from_the_caster_to_the_vehicles_receiver(corrections):
    long = framed(bytes([0x43, 0x50]) + bytes(398))
    caster, found = corrections([b"ICY 200 OK\r\n\r\n", EXAMPLE, b"noise", long])
    until(lambda: found.status().n_broken or found.status().types == (1005, 1077))
    status = found.status()
    assert status.types == (1005, 1077)
    assert status.bytes_per_s == pytest.approx((len(EXAMPLE) + len(long)) / 10.0)
    asked = caster.asked.get()
    assert b"Authorization: Basic bWU6cGFzcw==" in asked
    assert b"Ntrip-GGA: $GPGGA," in asked
    vehicle = SimulatedVehicle(Autopilot.ARDUPILOT, PointMass(), ORIGIN, is_ready=True)
    vehicle.corrections.needs = True
    assert [m.fix_type for m in vehicle.step(1.5) if isinstance(m, GpsRawInt)][-1] == 3
    for message in found.tick(0.0):
        vehicle.receive(Received(message, GROUND, 0.0))
    assert [frame.data for frame in vehicle.corrections.frames] == [EXAMPLE, long]
    assert [m.fix_type for m in vehicle.step(1.5) if isinstance(m, GpsRawInt)][-1] == 5
    assert found.tick(0.0) == []


def test_the_list_before_take_off_says_how_they_come(corrections):
    _, found = corrections([b"ICY 200 OK\r\n", EXAMPLE])
    until(lambda: found.status().age_s is not None)
    check = corrections_check(found.status())
    # The standard's example station stands in America.
    assert (check.verdict, check.value > FAR_M) == (Verdict.WARN, True)
    assert "messages 1005; their base stands" in check.text
    near = CorrectionsStatus("h", 1.0, 500.0, (1005,), 1500.0)
    assert corrections_check(near).verdict is Verdict.OK
    assert corrections_check(near).text == "500 bytes/s, messages 1005; their base stands 1.5 km away"
    unknown = corrections_check(CorrectionsStatus("h", 1.0, 500.0, (1077,)))
    assert (unknown.verdict, "is not known" in unknown.text) == (Verdict.OK, True)
    for status, text in (
        (CorrectionsStatus("h"), "none from h yet"),
        (CorrectionsStatus("h", 9.0, 0.0), "the last is 9 s old, from h"),
        (CorrectionsStatus("h", problem="it does not answer"), "none from h: it does not answer"),
    ):
        assert (corrections_check(status).verdict, corrections_check(status).text) == (Verdict.WARN, text)
    assert len(EXAMPLE_ECEF_M) == 3


def test_a_connection_that_breaks_is_made_again(corrections, monkeypatch):
    monkeypatch.setattr("groundstation.services.fly.corrections.FIRST_PAUSE_S", 0.01)
    caster, found = corrections(
        [b"HTTP/1.1 503 Busy\r\n\r\n"], [b"ICY 200 OK\r\n", EXAMPLE], [b"ICY 200 OK\r\n", EXAMPLE]
    )
    until(lambda: caster.asked.qsize() == 3)
    until(lambda: found.status().age_s is not None)


def test_what_cannot_become_well_is_said_and_not_tried_again(corrections):
    caster, found = corrections([b"HTTP/1.1 401 Unauthorized\r\n\r\n"], [b"ICY 200 OK\r\n", EXAMPLE])
    until(lambda: not found._thread.is_alive())
    assert found.status().problem == "it refuses user and password"
    assert caster.asked.qsize() == 1


def test_a_caster_that_lists_its_mountpoints_and_hangs_up_is_understood(corrections):
    caster, found = corrections([b"SOURCETABLE 200 OK\r\nSTR;NEAR;x;RTCM 3\r\nSTR;FAR;x\r\n"], [])
    until(lambda: not found._thread.is_alive())
    assert found.status().problem == "it knows no mountpoint of this name; it has NEAR, FAR"
    assert caster.asked.qsize() == 1


def test_a_caster_that_is_not_there_is_said_and_tried_with_longer_pauses(monkeypatch):
    tries, pauses = [], []

    def refused(_host, _port):
        tries.append(1)
        raise OSError(111, "Connection refused")

    found = Corrections(Caster("h", 1, "M"), "", PLACE, connect=refused)

    def wait(pause_s):
        pauses.append(pause_s)
        if len(pauses) == 8:
            found._ending.set()

    monkeypatch.setattr(found._ending, "wait", wait)
    found._keep_up()
    assert found.status().problem == "it cannot be reached (Connection refused)"
    assert pauses == [2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0, 60.0]


class Silent:
    """A connection that takes everything and never answers, or answers with what is no RTCM."""

    def __init__(self, clock, answer=b""):
        self.clock, self.answer, self.closed, self.written = clock, [answer], False, []

    def read(self, timeout_s):
        self.clock.now_s += timeout_s
        from missions.mavlink.link import Chunk

        return Chunk("tcp", self.answer.pop()) if self.answer and self.answer[0] else None

    def write(self, data):
        self.written.append(data)

    def note_peer(self, origin):
        pass

    def close(self):
        self.closed = True


class Clock:
    now_s = 0.0

    def __call__(self):
        return self.now_s


@pytest.mark.parametrize(
    ("answer", "why", "n_told"),
    [(b"", "it does not answer", 1), (b"ICY 200 OK\r\n<html>", "it is connected and sends nothing that is RTCM", 2)],
)
def test_silence_ends_a_connection_and_the_place_is_told_again_and_again(answer, why, n_told):
    clock = Clock()
    silent = Silent(clock, answer)
    found = Corrections(Caster("h", 1, "M"), "", PLACE, clock=clock, connect=lambda _host, _port: silent)
    assert found._connected() is False
    assert found.status().problem == why
    assert silent.closed
    assert 15.0 <= clock.now_s < 16.0
    assert len(silent.written) == n_told


def test_a_stream_of_noise_is_given_up_long_before_it_ends():
    clock = Clock()
    noisy = Silent(clock)
    noisy.answer = [b"\xd3\x03\xff" * 200 for _ in range(300)] + [b"ICY 200 OK\r\n"]
    found = Corrections(Caster("h", 1, "M"), "", PLACE, clock=clock, connect=lambda _host, _port: noisy)
    assert found._connected() is False
    assert found.status().problem == "it is connected and sends nothing that is RTCM"
    assert len(noisy.answer) > 250


def test_a_link_that_breaks_while_it_is_read_is_said():
    class Breaking(Silent):
        def read(self, timeout_s):
            raise LinkError("the caster closed the link")

    found = Corrections(Caster("h", 1, "M"), "", PLACE, connect=lambda _host, _port: Breaking(Clock()))
    assert found._connected() is False
    assert found.status().problem == "the caster closed the link"


def test_corrections_that_nobody_takes_make_room_for_new_ones():
    found = Corrections(Caster("h", 1, "M"), "", PLACE)
    from missions.mavlink.rtk import RtcmFrame

    for number in range(500):
        found._take([RtcmFrame(framed(number.to_bytes(2, "big")))], 0.0, 0)
    sent = found.tick(0.0)
    assert len(sent) == 200
    assert bytes(sent[-1].data[3:5]) == (499).to_bytes(2, "big")
    found._take([RtcmFrame(framed(bytes(1000)))], 0.0, 0)
    assert found.tick(0.0) == []
    assert found.status().n_too_long == 1


@pytest.mark.slow
def test_a_live_flight_has_them_on_its_link_and_in_its_list(corrections, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    _, found = corrections([b"ICY 200 OK\r\n", EXAMPLE])
    follower = Follower()
    live = LiveFlight(sortie(), simulation(), follower, tmp_path, corrections=found)
    live.start()
    try:
        follower.until(lambda event: "corrections" in codes(event))
        vehicle = live._wire.opened.simulated
        follower.until(lambda _event: bool(vehicle.corrections.frames))
        assert vehicle.corrections.frames[0].data == EXAMPLE
    finally:
        follower.let_go()
        assert live.close()
    assert found._ending.is_set()


def codes(event):
    return {check.code for check in event.view.checks} if isinstance(event, FlightChanged) else set()
