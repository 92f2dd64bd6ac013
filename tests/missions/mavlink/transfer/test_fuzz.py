"""Broken frames and nonsense through codec and state machines: no crash, no hang, no success that is none."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missions.mavlink.link import Machine
from missions.mavlink.messages import (
    Message,
    MissionAck,
    MissionCount,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    Received,
)
from missions.mavlink.transfer.exchange import Download, Ending
from missions.mavlink.transfer.verified import Clear, NotVerified, Upload, Verified, VerifiedUpload
from missions.mavlink.transfer.wire_items import compare
from missions.mavlink.wire import Decoder, Encoder
from tests.missions.mavlink.test_wire import messages_of
from tests.missions.mavlink.transfer.fake_vehicle import (
    ARDUPILOT,
    OWN,
    PX4,
    ROUTE,
    VEHICLE,
    Air,
    FakeVehicle,
    waypoints,
)


@dataclass
class Mangler:
    """Turns messages to frames, breaks some, and reads what comes out; counts the frames that it broke."""

    rng: np.random.Generator
    share: float
    n_broken: int = 0
    longest_s: float = 0.0
    encoders: dict[bool, Encoder] = field(default_factory=lambda: {True: Encoder(OWN), False: Encoder(VEHICLE)})
    decoders: dict[bool, Decoder] = field(default_factory=lambda: {True: Decoder(), False: Decoder()})

    def __call__(self, is_up: bool, message: Message, n: int) -> Sequence[Message]:
        frame = self.encoders[is_up].encode(message)
        if self.rng.random() < self.share:
            self.n_broken += 1
            frame = self.broken(bytearray(frame))
        started_s = time.thread_time()
        found = self.decoders[is_up].feed(frame, 0.0)
        self.longest_s = max(self.longest_s, time.thread_time() - started_s)
        return [each.received.message for each in found if each.received is not None]

    def broken(self, frame: bytearray) -> bytes:
        """One of the ways in which bytes go wrong: turned bits, lost, added, cut, twice, all noise."""
        rng, way = self.rng, self.rng.integers(6)
        at = int(rng.integers(len(frame)))
        if way == 0:
            for place in rng.integers(len(frame), size=rng.integers(1, 9)):
                frame[place] ^= 1 << int(rng.integers(8))
        elif way == 1:
            del frame[at : at + int(rng.integers(1, 9))]
        elif way == 2:
            frame[at:at] = rng.bytes(int(rng.integers(1, 40)))
        elif way == 3:
            del frame[at:]
        elif way == 4:
            frame = frame * 2
        else:
            frame = bytearray(rng.choice([0x00, 0xFD, 0xFE, 0xFF], size=int(rng.integers(1, 300))).astype(np.uint8))
        return bytes(frame)


def mangled(n_frames: int) -> None:
    """Uploads over a line that breaks frames, until that many were broken."""
    n_broken, n_verified = 0, 0
    for seed in itertools.count():
        rng = np.random.default_rng(seed)
        autopilot = (ARDUPILOT, PX4)[seed % 2]
        vehicle = FakeVehicle(autopilot, {0: list(waypoints(30, z=50.0)), 1: [], 2: []})
        mangler = Mangler(rng, share=float(rng.choice([0.1, 0.3, 0.6])))
        machine = VerifiedUpload(ROUTE, waypoints(40), autopilot)
        Air(vehicle, fault=mangler).run(machine)
        if isinstance(machine.outcome, Verified):
            n_verified += 1
            assert compare(waypoints(40), tuple(vehicle.lists[0]), autopilot) == ()
        else:
            assert isinstance(machine.outcome, NotVerified)
        assert mangler.longest_s < 10.0
        n_broken += mangler.n_broken
        if n_broken >= n_frames:
            break
    assert n_verified > 0


@pytest.mark.slow
def test_five_thousand_broken_frames_end_equal_or_clearly_not() -> None:
    mangled(5_000)


@pytest.mark.slow
def test_hundred_thousand_broken_frames_end_equal_or_clearly_not() -> None:
    mangled(100_000)


@given(noise=st.lists(st.binary(max_size=400), max_size=20), is_whole=st.booleans())
def test_decoder_takes_any_bytes_and_keeps_little_of_them(noise: list[bytes], is_whole: bool) -> None:
    decoder = Decoder()
    for each in noise:
        decoder.feed(each, 0.0, is_whole)
        assert len(decoder._buffer) < 300
    if is_whole:
        assert not decoder._buffer


NONSENSE = st.one_of(*map(messages_of, (MissionAck, MissionCount, MissionItemInt, MissionRequest, MissionRequestInt)))


def aimed(message: Message, rng: np.random.Generator) -> Message:
    """The same, for us, about a list and an item that there are."""
    values: dict[str, Any] = {each.name: getattr(message, each.name) for each in fields(message)}
    small = {"target_system": 255, "target_component": 190, "mission_type": 0}
    small |= {name: int(rng.integers(6)) for name in ("seq", "count")}
    values |= {name: value for name, value in small.items() if name in values}
    if isinstance(message, MissionAck):
        values["type"] = int(rng.choice([0, 0, 0, 1, 4, 13, 13, 14, 15]))
    return type(message)(**values)


def machines() -> list[Machine[Any]]:
    return [
        Upload(ROUTE, waypoints(4)),
        Download(ROUTE),
        Clear(ROUTE),
        VerifiedUpload(ROUTE, waypoints(4), ARDUPILOT),
        VerifiedUpload(ROUTE, (), PX4),
    ]


@given(messages=st.lists(NONSENSE, max_size=60), seed=st.integers(0, 2**32 - 1))
def test_machines_take_any_messages_and_end_in_bounded_time(messages: list[Message], seed: int) -> None:
    rng = np.random.default_rng(seed)
    for machine in machines():
        now_s, n_sent = 0.0, len(machine.start(0.0))
        for message in messages:
            now_s += float(rng.exponential(0.3))
            n_sent += len(machine.receive(Received(aimed(message, rng), VEHICLE, now_s)))
            n_sent += len(machine.tick(now_s))
        while machine.outcome is None:
            now_s = max(now_s, machine.next_deadline_s)
            assert now_s < 600.0
            n_sent += len(machine.tick(now_s))
        # No answer may set off more than itself: at most two messages for each that came, and the repeats.
        assert n_sent < 2 * len(messages) + 300


@given(messages=st.lists(NONSENSE, max_size=60), seed=st.integers(0, 2**32 - 1))
def test_nonsense_that_lists_no_equal_items_is_never_taken_for_verified(messages: list[Message], seed: int) -> None:
    rng = np.random.default_rng(seed)
    machine = VerifiedUpload(ROUTE, waypoints(4), PX4)
    machine.start(0.0)
    now_s = 0.0
    came: list[MissionItemInt] = []
    for message in messages:
        now_s += float(rng.exponential(0.3))
        told = aimed(message, rng)
        came += [told] if isinstance(told, MissionItemInt) else []
        machine.receive(Received(told, VEHICLE, now_s))
        machine.tick(now_s)
    if isinstance(machine.outcome, Verified):
        assert all(any(compare((one,), (item,), PX4) == () for item in came) for one in waypoints(4))


@given(messages=st.lists(NONSENSE, max_size=60), seed=st.integers(0, 2**32 - 1))
def test_upload_is_done_only_when_an_acknowledgement_came_after_the_last_item(
    messages: list[Message], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    upload = Upload(ROUTE, waypoints(4))
    upload.start(0.0)
    was_last_sent = was_accepted = False
    for number, message in enumerate(messages):
        told = aimed(message, rng)
        was_accepted |= was_last_sent and isinstance(told, MissionAck) and told.type == 0
        answers = upload.receive(Received(told, VEHICLE, float(number)))
        answers += upload.tick(float(number))
        was_last_sent |= any(isinstance(each, MissionItemInt) and each.seq == 3 for each in answers)
        if upload.outcome is not None and upload.outcome.ending is Ending.DONE:
            assert was_accepted
