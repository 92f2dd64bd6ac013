"""Ways to the vehicle: in the same process, over memory, UDP and TCP, at a multiple of real time."""

from __future__ import annotations

import itertools
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from missions.mavlink.link import Link, memory_pair, open_link
from missions.mavlink.messages import (
    Address,
    CommandAck,
    CommandLong,
    Heartbeat,
    Message,
    MissionAck,
    MissionCount,
    MissionRequest,
    SystemTime,
)
from missions.mavlink.wire import Decoder
from missions.simulator.server import (
    DEAF_S,
    LEAD_S,
    MAX_FLOWN_S,
    MAX_STEP_S,
    CommonTime,
    DirectLink,
    FlownClock,
    serve,
)
from missions.simulator.vehicle import SimulatedVehicle
from planning.base.errors import LinkError
from planning.base.progress import StopRequest
from tests.missions.simulator.ground import ARDUPILOT, ORIGIN, PX4, PointMass, item


def make_vehicle(autopilot=ARDUPILOT, **kwargs) -> SimulatedVehicle:
    return SimulatedVehicle(autopilot, PointMass(), ORIGIN, is_ready=True, **kwargs)


@contextmanager
def served(vehicle: SimulatedVehicle, links: list[Link], speedup: float = 20.0) -> Iterator[None]:
    stop = StopRequest()
    thread = threading.Thread(target=serve, args=(vehicle, links, speedup, stop))
    thread.start()
    try:
        yield
    finally:
        stop.request()
        thread.join()
        for link in links:
            link.close()


def wait(link: Link, kind: type[Message], timeout_s: float = 60.0) -> Message:
    end_s = time.perf_counter() + timeout_s
    while time.perf_counter() < end_s:
        received = link.receive(0.2)
        if received is not None and isinstance(received.message, kind):
            return received.message
    raise AssertionError(f"no {kind.__name__}")


def free_port(kind: socket.SocketKind) -> int:
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def test_direct_link_knows_simulated_time_only() -> None:
    link = DirectLink(make_vehicle())
    started_s, start_s = time.perf_counter(), link.clock()
    while link.clock() < start_s + 300.0:
        link.receive(10.0)
    assert time.perf_counter() - started_s < 150.0, "not half of what it would be in real time"
    received = link.receive(5.0)
    assert received.time_s == link.clock()
    assert received.source == Address(1, 1)


def test_direct_link_returns_nothing_after_its_timeout() -> None:
    link = DirectLink(make_vehicle())
    for message_id in (0, 1, 2, 24, 30, 32, 33, 42, 74, 147, 242, 245, 285, 193, 168):
        link.send(CommandLong(1, 1, 511, message_id, -1))
    while link.receive(0.0) is not None:
        pass
    start_s = link.clock()
    assert link.receive(3.0) is None
    assert link.clock() - start_s == pytest.approx(3.0, abs=0.011)


def test_direct_link_shows_frames_to_observers() -> None:
    link, frames = DirectLink(make_vehicle()), []
    link.observe(lambda frame, is_sent, time_s: frames.append((frame, is_sent, time_s)))
    link.send(CommandLong(1, 1, 512, 148))
    link.receive(1.0)
    decoded = [Decoder().feed(frame, time_s, True)[0].received for frame, _, time_s in frames]
    assert [is_sent for _, is_sent, _ in frames[:2]] == [True, False]
    assert (decoded[0].source, decoded[1].source) == (Address(255, 190), Address(1, 1))
    assert isinstance(decoded[1].message, CommandAck)


def test_closed_direct_link_says_so() -> None:
    link = DirectLink(make_vehicle())
    link.close()
    with pytest.raises(LinkError):
        link.send(CommandLong(1, 1, 400, 1))
    with pytest.raises(LinkError):
        link.receive(1.0)


@pytest.mark.parametrize("speedup", [0.0, -1.0, 51.0, float("nan")])
def test_speedups_out_of_range_are_wrong_calls(speedup: float) -> None:
    with pytest.raises(ValueError, match="speedup"):
        serve(make_vehicle(), [], speedup)


class ScriptedClock:
    """A clock that goes on by 10 ms with every look."""

    def __init__(self) -> None:
        self.times = itertools.count()

    def __call__(self) -> float:
        return next(self.times) * 0.01


class Silent:
    """A link without anybody at the other end."""

    address = Address(1, 1)

    def __init__(self, n_reads: int) -> None:
        self.sent: list[Message] = []
        self.left = n_reads

    def send(self, message: Message) -> None:
        self.sent.append(message)

    def receive(self, timeout_s: float) -> None:
        self.left -= 1
        if self.left < 0:
            raise LinkError("over")

    def close(self) -> None:
        pass


@pytest.mark.parametrize("speedup", [1.0, 50.0])
def test_simulated_time_goes_speedup_times_as_fast_as_the_clock(speedup: float) -> None:
    vehicle = make_vehicle()
    start_s = vehicle.now_s
    serve(vehicle, [Silent(200)], speedup, clock=ScriptedClock())
    assert vehicle.now_s - start_s == pytest.approx(201 * 0.01 * speedup, rel=0.02)


def test_simulated_time_waits_for_a_ground_station_that_is_busy_and_not_for_one_that_is_away() -> None:
    vehicle, n_reads = make_vehicle(), 500 + round(DEAF_S / 0.01)
    start_s, flown_s = vehicle.now_s, []

    def is_heard() -> bool:
        flown_s.append(vehicle.now_s - start_s)
        return len(flown_s) < 10 or 100 < len(flown_s) < 200

    serve(vehicle, [Silent(n_reads)], 20.0, clock=ScriptedClock(), is_heard=is_heard)
    assert flown_s[9] == pytest.approx(9 * 0.2, abs=0.03)
    assert flown_s[9] == flown_s[100], "busy for 0.9 s"
    assert flown_s[101] - flown_s[100] == pytest.approx(MAX_FLOWN_S, abs=0.03)
    assert flown_s[199] == flown_s[198 + round(DEAF_S / 0.01)], "it has 30 s"
    assert flown_s[-1] - flown_s[199] == pytest.approx(0.2 * (500 - 199), abs=1.0)


def test_the_time_of_a_ground_station_goes_on_with_the_vehicle_and_not_with_the_clock() -> None:
    """A machine that is busy for 1000 s, or a ground station that is for 100 looks, must not run time-outs down."""
    vehicle, flown, times, looks = make_vehicle(), FlownClock(7.0), itertools.count(), itertools.count()
    start_s = vehicle.now_s

    def clock() -> float:
        n = next(times)
        return 0.01 * n + (1000.0 if n > 50 else 0.0)

    serve(vehicle, [Silent(299)], 20.0, clock=clock, is_heard=lambda: not 100 < next(looks) <= 200, flown=flown)
    assert flown() - 7.0 == pytest.approx(0.01 * 199 + 2 * MAX_STEP_S, abs=0.021)
    assert vehicle.now_s - start_s == pytest.approx(20.0 * 0.01 * 198 + 2 * MAX_FLOWN_S, abs=0.5)


def test_clock_that_jumps_does_not_make_the_vehicle_jump() -> None:
    vehicle, times = make_vehicle(), iter([0.0, 1000.0, 1000.01])
    serve(vehicle, [Silent(1)], clock=lambda: next(times))
    assert vehicle.now_s - 42.0 == pytest.approx(0.11, abs=0.021)


def test_time_is_not_sped_up_during_an_upload() -> None:
    vehicle = make_vehicle()
    direct = DirectLink(vehicle)
    direct.send(MissionCount(1, 1, 3))
    start_s = vehicle.now_s
    serve(vehicle, [Silent(100)], 50.0, clock=ScriptedClock())
    assert vehicle.now_s - start_s == pytest.approx(1.01, abs=0.03)
    assert vehicle.is_transferring


def test_serving_ends_with_the_last_link() -> None:
    short, long = Silent(5), Silent(20)
    serve(make_vehicle(), [short, long], 50.0, clock=ScriptedClock())
    assert len(long.sent) > len(short.sent) > 0


def test_memory_udp_and_tcp_clients_are_served_at_once() -> None:
    ground, aboard = memory_pair()
    tcp_port, udp_port = free_port(socket.SOCK_STREAM), free_port(socket.SOCK_DGRAM)
    vehicle = make_vehicle(PX4)
    links = [
        aboard,
        open_link(f"tcpin:127.0.0.1:{tcp_port}", vehicle.address),
        open_link(f"udp:127.0.0.1:{udp_port}", vehicle.address),
    ]
    with served(vehicle, links):
        clients = [
            ground,
            open_link(f"tcp:127.0.0.1:{tcp_port}"),
            open_link(f"tcp:127.0.0.1:{tcp_port}", Address(254, 1)),
            open_link(f"udpout:127.0.0.1:{udp_port}"),
        ]
        for client in clients:
            client.send(Heartbeat(6, 8, 0, 0, 4))
            assert wait(client, Heartbeat).autopilot == 12
            client.send(CommandLong(1, 1, 512, 2))
            assert wait(client, CommandAck).result == 0
            wait(client, SystemTime)
        for client in clients:
            client.close()


def test_mission_is_uploaded_over_tcp_and_a_client_that_leaves_disturbs_nobody() -> None:
    port = free_port(socket.SOCK_STREAM)
    vehicle = make_vehicle()
    with served(vehicle, [open_link(f"tcpin:127.0.0.1:{port}", vehicle.address)], speedup=50.0):
        gone = open_link(f"tcp:127.0.0.1:{port}")
        wait(gone, Heartbeat)
        gone.close()
        stays = open_link(f"tcp:127.0.0.1:{port}")
        stays.send(MissionCount(1, 1, 2))
        for seq, each in enumerate((item(16), item(93, 1))):
            assert wait(stays, MissionRequest).seq == seq
            stays.send(replace(each, seq=seq))
        assert wait(stays, MissionAck).type == 0
        stays.close()
    assert len(vehicle.stores.mission) == 2


def test_vehicles_that_are_simulated_at_once_wait_for_each_other():
    common, one, other = CommonTime(), FlownClock(5.0), FlownClock(900.0)
    common.join(one)
    one.advance(60.0)
    assert common.may_fly(one), "nobody to wait for"
    common.join(other)
    one.advance(0.9 * LEAD_S)
    assert common.may_fly(one)
    one.advance(LEAD_S)
    assert not common.may_fly(one)
    assert common.may_fly(other), "the one behind always may"
    other.advance(LEAD_S)
    assert common.may_fly(one)
    one.advance(30.0)
    common.leave(other)
    assert common.may_fly(one)


def test_time_in_common_lets_threads_fly_equally_long():
    """Each is held up by another thread that takes the processor, and none gets ahead."""
    common, clocks = CommonTime(), [FlownClock(), FlownClock(7.0), FlownClock(3.0)]
    starts = [clock() for clock in clocks]
    for clock in clocks:
        common.join(clock)
    rng = np.random.default_rng(0)
    for turn in rng.choice(3, 4000, p=(0.8, 0.15, 0.05)):
        if common.may_fly(clocks[turn]):
            clocks[turn].advance(float(rng.uniform(0.0, MAX_STEP_S)))
    flown = [clock() - start for clock, start in zip(clocks, starts, strict=True)]
    assert max(flown) - min(flown) <= LEAD_S + MAX_STEP_S
    assert min(flown) > 1.0
