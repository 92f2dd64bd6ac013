from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass, field

import pytest

from missions.mavlink.link import (
    GROUND_HEARTBEAT,
    PEER_KEPT_S,
    VEHICLE,
    ChannelLink,
    Link,
    UdpChannel,
    drive,
    memory_pair,
    open_link,
)
from missions.mavlink.messages import Address, Heartbeat, Message, MissionAck, Received, Statustext
from missions.mavlink.signing import Signer
from missions.mavlink.transfer.exchange import Ending, Route
from missions.mavlink.transfer.verified import Clear, Verified, VerifiedUpload
from planning.base.errors import InputError, LinkError, LinkTimeout, OperationCancelled
from tests.missions.mavlink.transfer.fake_vehicle import ARDUPILOT, OWN, FakeVehicle, waypoints

WAIT_S = 60.0
"""Longest wait for what comes at once; a test that fails takes it."""

HELLO, ANSWER = Heartbeat(6, 8, 0, 0, 4), Heartbeat(2, 3, 81, 4, 4)


def port_of(link: ChannelLink) -> int:
    return int(link.channel.port)  # type: ignore[attr-defined]


def udp_pair(stack: ExitStack) -> tuple[ChannelLink, ChannelLink]:
    vehicle = stack.enter_context(closing(open_link("udp:127.0.0.1:0", VEHICLE)))
    return stack.enter_context(closing(open_link(f"udpout:127.0.0.1:{port_of(vehicle)}"))), vehicle


def tcp_pair(stack: ExitStack) -> tuple[ChannelLink, ChannelLink]:
    vehicle = stack.enter_context(closing(open_link("tcpin:127.0.0.1:0", VEHICLE)))
    return stack.enter_context(closing(open_link(f"tcp:127.0.0.1:{port_of(vehicle)}"))), vehicle


def in_memory(stack: ExitStack) -> tuple[ChannelLink, ChannelLink]:
    ground, vehicle = memory_pair()
    stack.callback(ground.close)
    stack.callback(vehicle.close)
    return ground, vehicle


@pytest.fixture(params=[udp_pair, tcp_pair, in_memory])
def pair(request: pytest.FixtureRequest) -> Iterator[tuple[ChannelLink, ChannelLink]]:
    with ExitStack() as stack:
        yield request.param(stack)


def got(link: Link) -> Message | None:
    received = link.receive(WAIT_S)
    return received and received.message


def test_messages_go_both_ways_with_their_sender_and_time(pair: tuple[ChannelLink, ChannelLink]) -> None:
    ground, vehicle = pair
    before_s = time.perf_counter()
    ground.send(HELLO)
    received = vehicle.receive(WAIT_S)
    assert received is not None
    assert (received.message, received.source) == (HELLO, OWN)
    assert before_s <= received.time_s <= time.perf_counter()
    vehicle.send(ANSWER)
    assert got(ground) == ANSWER


def test_nothing_there_is_none_at_once(pair: tuple[ChannelLink, ChannelLink]) -> None:
    assert pair[0].receive(0.0) is None


def test_a_hundred_messages_keep_their_order(pair: tuple[ChannelLink, ChannelLink]) -> None:
    ground, vehicle = pair
    for number in range(100):
        ground.send(Statustext(6, str(number)))
    texts = [vehicle.receive(WAIT_S) for _ in range(100)]
    assert [each.message for each in texts if each] == [Statustext(6, str(number)) for number in range(100)]


def test_frames_are_shown_as_they_are_sent_and_received(pair: tuple[ChannelLink, ChannelLink]) -> None:
    ground, vehicle = pair
    seen: list[tuple[bytes, bool]] = []
    ground.observe(lambda frame, is_sent, time_s: seen.append((frame, is_sent)))
    ground.send(HELLO)
    got(vehicle)
    vehicle.send(ANSWER)
    got(ground)
    assert [is_sent for _, is_sent in seen] == [True, False]
    assert all(frame[0] == 0xFD for frame, _ in seen)


def test_link_that_was_closed_says_so_and_closes_twice(pair: tuple[ChannelLink, ChannelLink]) -> None:
    ground, _ = pair
    ground.close()
    ground.close()
    with pytest.raises(LinkError):
        ground.receive(WAIT_S)


@pytest.mark.parametrize("kind", [tcp_pair, in_memory])
def test_dead_link_is_an_error_at_once(kind: object) -> None:
    with ExitStack() as stack:
        ground, vehicle = kind(stack)  # type: ignore[operator]
        ground.send(HELLO)
        got(vehicle)
        vehicle.close()
        with pytest.raises(LinkError, match="closed"):  # and no None after WAIT_S
            ground.receive(WAIT_S)


def test_client_that_goes_leaves_the_server_and_the_next_one_is_served() -> None:
    with ExitStack() as stack:
        first, vehicle = tcp_pair(stack)
        first.send(HELLO)
        assert got(vehicle) == HELLO
        second = stack.enter_context(closing(open_link(f"tcp:127.0.0.1:{port_of(vehicle)}", Address(254, 1))))
        second.send(HELLO)
        received = vehicle.receive(WAIT_S)
        assert received is not None
        assert received.source == Address(254, 1)
        vehicle.send(ANSWER)
        assert (got(first), got(second)) == (ANSWER, ANSWER)
        first.close()
        for _ in range(20):
            vehicle.send(ANSWER)
        second.send(HELLO)
        assert got(vehicle) == HELLO
        assert got(second) == ANSWER


def test_two_clients_with_half_frames_do_not_spoil_each_other() -> None:
    with ExitStack() as stack:
        first, vehicle = tcp_pair(stack)
        raw = stack.enter_context(socket.create_connection(("127.0.0.1", port_of(vehicle))))
        raw.sendall(b"\xfd\x09\x00\x00")
        first.send(HELLO)
        assert got(vehicle) == HELLO


def test_udp_answers_only_those_that_speak_mavlink_and_were_heard_of_late() -> None:
    now_s = 0.0
    with closing(UdpChannel(("127.0.0.1", 0), None, lambda: now_s)) as channel, ExitStack() as stack:
        link = ChannelLink(channel, VEHICLE)
        stranger = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        stranger.sendto(b"hello", ("127.0.0.1", channel.port))
        ground = stack.enter_context(closing(open_link(f"udpout:127.0.0.1:{channel.port}")))
        ground.send(HELLO)
        assert got(link) == HELLO
        link.send(ANSWER)
        assert got(ground) == ANSWER
        now_s = PEER_KEPT_S + 1.0
        link.send(ANSWER)
        ground.send(HELLO)
        assert got(link) == HELLO
        link.send(HELLO)
        # The one sent while it was forgotten never comes.
        assert got(ground) == HELLO
        stranger.setblocking(False)
        with pytest.raises(BlockingIOError):
            stranger.recv(100)


def test_udp_survives_that_nobody_listens() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with closing(open_link(f"udpout:127.0.0.1:{port}")) as link:
        for _ in range(5):
            link.send(HELLO)
            assert link.receive(0.01) is None


def test_signed_link_hears_only_signed_messages() -> None:
    key = bytes(range(32))
    with closing(open_link("udp:127.0.0.1:0", VEHICLE, Signer(key))) as vehicle, ExitStack() as stack:
        url = f"udpout:127.0.0.1:{port_of(vehicle)}"
        stack.enter_context(closing(open_link(url, Address(254, 1)))).send(HELLO)
        stack.enter_context(closing(open_link(url, OWN, Signer(key)))).send(ANSWER)
        assert got(vehicle) == ANSWER
        assert vehicle.counts.refused == 1


@pytest.mark.parametrize(
    "url",
    [
        "",
        "udp",
        "udp:",
        "udp:host",
        "udp:host:port",
        "udp::14550",
        "tcp:127.0.0.1:99999",
        "ftp:a:1",
        "serial:",
        "serial:/dev/x:fast",
    ],
)
def test_bad_url_is_refused_with_an_example(url: str) -> None:
    with pytest.raises(InputError, match=r"expected .*such as"):
        open_link(url)


def test_server_that_is_not_there_is_an_error_that_names_it() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(LinkError, match=f"tcp:127.0.0.1:{port} cannot be opened: Connection refused"):
        open_link(f"tcp:127.0.0.1:{port}")


def test_port_that_is_taken_is_an_error() -> None:
    with closing(open_link("udp:127.0.0.1:0")) as link, pytest.raises(LinkError, match="another program has this port"):
        open_link(f"udp:127.0.0.1:{port_of(link)}")


def test_server_that_does_not_answer_is_a_timeout(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*arguments: object) -> socket.socket:
        raise TimeoutError("timed out")

    monkeypatch.setattr(socket, "create_connection", never)
    with pytest.raises(LinkTimeout, match="no answer"):
        open_link("tcp:192.0.2.1:5760")


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo terminals here")
def test_serial_line_carries_messages_and_says_when_it_breaks() -> None:
    pytest.importorskip("serial", reason="pyserial is not installed")
    here, there = os.openpty()
    link = open_link(f"serial:{os.ttyname(there)}:57600")
    ground, _ = memory_pair()
    ground.observe(lambda frame, is_sent, time_s: os.write(here, frame))
    ground.send(ANSWER)
    assert got(link) == ANSWER
    link.send(HELLO)
    assert os.read(here, 300)[0] == 0xFD
    os.close(here)
    os.close(there)
    with pytest.raises(LinkError, match="broke"):
        link.receive(WAIT_S)
    link.close()


def test_serial_line_that_is_not_there_is_an_error() -> None:
    with pytest.raises(LinkError, match="serial"):
        open_link("serial:/dev/there-is-none:57600")


# Driving


@dataclass
class FakeLink:
    """A link to a twin in a time that `receive` lets pass."""

    vehicle: FakeVehicle
    address: Address = OWN
    now_s: float = 0.0
    sent: list[Message] = field(default_factory=list)
    waiting: list[Message] = field(default_factory=list)

    def send(self, message: Message) -> None:
        self.sent.append(message)
        self.waiting += self.vehicle.receive(Received(message, OWN, self.now_s))

    def receive(self, timeout_s: float) -> Received | None:
        if self.waiting:
            self.now_s += 0.001
            return Received(self.waiting.pop(0), VEHICLE, self.now_s)
        self.now_s += timeout_s
        self.waiting += self.vehicle.tick(self.now_s)
        return None

    def close(self) -> None: ...


@dataclass
class Progress:
    limit: int = 10**9
    reports: list[tuple[str, float, float]] = field(default_factory=list)

    def report(self, stage: str, done: float, total: float) -> None:
        self.reports.append((stage, done, total))
        if len(self.reports) > self.limit:
            raise OperationCancelled("cancelled")


ROUTE = Route(OWN, VEHICLE)


def test_drive_runs_to_the_outcome_with_progress_and_shows_all_that_comes() -> None:
    link, progress, seen = FakeLink(FakeVehicle(ARDUPILOT)), Progress(), list[Received]()
    outcome = drive(VerifiedUpload(ROUTE, waypoints(20), ARDUPILOT), link, lambda: link.now_s, progress, seen.append)
    assert isinstance(outcome, Verified)
    assert {stage for stage, _, _ in progress.reports} == {"uploading", "reading back"}
    assert ("uploading", 10, 20) in progress.reports
    assert sum(isinstance(each.message, MissionAck) for each in seen) == 1
    # The last message of a transfer, the acknowledgement of the download, goes out though the outcome is there.
    assert isinstance(link.sent[-1], MissionAck)


def test_drive_sends_a_heartbeat_each_second() -> None:
    link = FakeLink(FakeVehicle(ARDUPILOT))
    link.vehicle.receive = lambda received: []  # type: ignore[method-assign]
    outcome = drive(Clear(ROUTE), link, lambda: link.now_s)
    assert outcome.ending is Ending.SILENT
    assert 14 <= sum(each == GROUND_HEARTBEAT for each in link.sent) <= 16


def test_cancelled_drive_tells_the_vehicle() -> None:
    link = FakeLink(FakeVehicle(ARDUPILOT))
    with pytest.raises(OperationCancelled):
        drive(VerifiedUpload(ROUTE, waypoints(20), ARDUPILOT), link, lambda: link.now_s, Progress(limit=5))
    assert link.sent[-1] == MissionAck(1, 1, 15, 0)


def test_drive_over_a_real_socket_ends_verified(pair: tuple[ChannelLink, ChannelLink]) -> None:
    ground, vehicle_link = pair
    vehicle, is_over = FakeVehicle(ARDUPILOT), threading.Event()

    def serve() -> None:
        while not is_over.is_set():
            received = vehicle_link.receive(0.02)
            for message in vehicle.receive(received) if received else []:
                vehicle_link.send(message)

    server = threading.Thread(target=serve)
    server.start()
    try:
        outcome = drive(VerifiedUpload(ROUTE, waypoints(50), ARDUPILOT), ground, time.perf_counter)
    finally:
        is_over.set()
        server.join()
    assert isinstance(outcome, Verified)
