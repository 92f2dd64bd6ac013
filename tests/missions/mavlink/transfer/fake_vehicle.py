"""A vehicle's side of the mission protocol, small and written from its description, and air that loses messages.

Time is a number that jumps from event to event; nothing sleeps.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import numpy as np

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.link import Machine
from missions.mavlink.messages import (
    Address,
    Message,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    MissionRequestList,
    Received,
)
from missions.mavlink.transfer.exchange import MissionType, Result, Route

OWN, VEHICLE = Address(255, 190), Address(1, 1)
ROUTE = Route(OWN, VEHICLE)
ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4


def route(mission_type: MissionType) -> Route:
    return Route(OWN, VEHICLE, mission_type)


def waypoint(number: int, z: float = 20.0, mission_type: int = 0) -> MissionItemInt:
    x, y = 223372000 + 100 * number, 1142636000 - 100 * number
    return MissionItemInt(1, 1, number, 3, 16, 0, 1, 2.0, 0.0, 0.0, 0.0, x, y, z + number, mission_type)


def waypoints(n: int, z: float = 20.0, mission_type: int = 0) -> tuple[MissionItemInt, ...]:
    return tuple(waypoint(number, z, mission_type) for number in range(n))


class Vehicle(Protocol):
    """What `Air` needs of a vehicle."""

    @property
    def next_deadline_s(self) -> float: ...

    def receive(self, received: Received) -> list[Message]: ...

    def tick(self, now_s: float) -> list[Message]: ...


@dataclass
class FakeVehicle:
    """Keeps lists of items; ArduPilot-like writes each item at once, PX4-like the whole list at the end."""

    autopilot: Autopilot
    lists: dict[int, list[MissionItemInt]] = field(default_factory=lambda: {0: [], 1: [], 2: []})
    max_items: int = 650
    refuse: Callable[[MissionItemInt], int] = lambda item: Result.ACCEPTED
    change: Callable[[MissionItemInt], MissionItemInt] = lambda item: item
    may_clear: bool = True
    partner: Address | None = None
    mission_type: int = 0
    count: int = 0
    expected: int = 0
    arrived: list[MissionItemInt] = field(default_factory=list)
    asked_s: float = 0.0
    item_s: float = 0.0

    @property
    def is_ardupilot(self) -> bool:
        return self.autopilot is ARDUPILOT

    @property
    def retry_s(self) -> float:
        return 1.0 if self.is_ardupilot else 0.5

    @property
    def give_up_s(self) -> float:
        return 8.0 if self.is_ardupilot else 5.0

    @property
    def next_deadline_s(self) -> float:
        if self.partner is None:
            return math.inf
        return min(self.asked_s + self.retry_s, self.item_s + self.give_up_s)

    def reboot(self) -> None:
        """Forget the transfer, not the items."""
        self.partner = None

    def receive(self, received: Received) -> list[Message]:
        source, now_s = received.source, received.time_s
        match received.message:
            case MissionCount() as message:
                return self.on_count(message, source, now_s)
            case MissionItemInt() as message:
                return self.on_item(message, source, now_s)
            case MissionRequestList(mission_type=kind):
                if self.partner is not None:
                    return [self.ack(Result.DENIED, source, kind)] if self.is_ardupilot else []
                return [MissionCount(source.system, source.component, len(self.lists[kind]), kind)]
            case MissionRequestInt(seq=seq, mission_type=kind):
                if seq >= len(self.lists[kind]):
                    return [self.ack(Result.INVALID_SEQUENCE, source, kind)]
                target = {"target_system": source.system, "target_component": source.component}
                return [replace(self.lists[kind][seq], seq=seq, **target)]
            case MissionClearAll(mission_type=kind):
                if not self.may_clear:
                    return [self.ack(Result.ERROR, source, kind)]
                self.lists[kind] = []
                self.partner = None
                return [self.ack(Result.ACCEPTED, source, kind)]
        return []

    def on_count(self, message: MissionCount, source: Address, now_s: float) -> list[Message]:
        if self.partner not in (None, source):
            return [self.ack(Result.DENIED, source, message.mission_type)]
        if message.count > self.max_items:
            return [self.ack(Result.NO_SPACE, source, message.mission_type)]
        if not self.is_ardupilot and self.partner is not None and self.expected > 0:
            return []
        self.partner, self.mission_type, self.count = source, message.mission_type, message.count
        self.expected, self.arrived, self.item_s = 0, [], now_s
        if self.is_ardupilot:
            del self.lists[self.mission_type][self.count :]
        return [self.ask(now_s)]

    def on_item(self, message: MissionItemInt, source: Address, now_s: float) -> list[Message]:
        if self.partner is None:
            return [self.ack(Result.ERROR, source, message.mission_type)]
        if message.seq != self.expected:
            if not self.is_ardupilot:
                return [self.ask(now_s)]
            return [self.ack(Result.INVALID_SEQUENCE, source, message.mission_type)]
        result = self.refuse(message)
        if result != Result.ACCEPTED:
            self.partner = None
            return [self.ack(result, source, message.mission_type)]
        self.keep(self.change(message))
        self.expected, self.item_s = self.expected + 1, now_s
        if self.expected < self.count:
            return [self.ask(now_s)]
        self.partner = None
        if not self.is_ardupilot:
            self.lists[self.mission_type] = self.arrived
        return [self.ack(Result.ACCEPTED, source, message.mission_type)]

    def keep(self, item: MissionItemInt) -> None:
        if self.is_ardupilot:
            self.lists[self.mission_type][self.expected : self.expected + 1] = [item]
        else:
            self.arrived.append(item)

    def tick(self, now_s: float) -> list[Message]:
        if self.partner is None or now_s < self.next_deadline_s:
            return []
        if now_s >= self.item_s + self.give_up_s:
            partner, self.partner = self.partner, None
            return [self.ack(Result.OPERATION_CANCELLED, partner, self.mission_type)]
        return [self.ask(now_s)]

    def ask(self, now_s: float) -> Message:
        assert self.partner is not None
        self.asked_s = now_s
        kind = MissionRequest if self.is_ardupilot else MissionRequestInt
        return kind(self.partner.system, self.partner.component, self.expected, self.mission_type)

    def ack(self, result: int, to: Address, mission_type: int) -> MissionAck:
        return MissionAck(to.system, to.component, result, mission_type)


Fault = Callable[[bool, Message, int], Sequence[Message]]
"""What becomes of a message: whether it goes up to the vehicle, the message, how many went that way before it."""


@dataclass
class Air:
    """Between a machine and a vehicle: loses, delays, and does to messages what `fault` says."""

    vehicle: Vehicle
    loss: float = 0.0
    delay_s: float = 0.02
    jitter_s: float = 0.0
    seed: int = 0
    fault: Fault = lambda is_up, message, n: [message]
    log: list[tuple[float, bool, Message]] = field(default_factory=list)

    def run(self, machine: Machine[Any], limit_s: float = 3600.0) -> float:
        """Run to the machine's outcome; returns the seconds it took."""
        rng, order = np.random.default_rng(self.seed), itertools.count()
        numbers = {True: itertools.count(), False: itertools.count()}
        flying: list[tuple[float, int, bool, Message]] = []
        now_s = 0.0

        def launch(is_up: bool, messages: Sequence[Message]) -> None:
            for message in messages:
                self.log.append((now_s, is_up, message))
                for each in self.fault(is_up, message, next(numbers[is_up])):
                    if rng.random() >= self.loss:
                        arrival_s = now_s + self.delay_s + self.jitter_s * rng.random()
                        heapq.heappush(flying, (arrival_s, next(order), is_up, each))

        launch(True, machine.start(now_s))
        while machine.outcome is None:
            first_s = flying[0][0] if flying else math.inf
            now_s = max(now_s, min(first_s, machine.next_deadline_s, self.vehicle.next_deadline_s))
            assert now_s < limit_s, "it hangs"
            if first_s <= now_s:
                _, _, is_up, message = heapq.heappop(flying)
                if is_up:
                    launch(False, self.vehicle.receive(Received(message, OWN, now_s)))
                else:
                    launch(True, machine.receive(Received(message, VEHICLE, now_s)))
            launch(False, self.vehicle.tick(now_s))
            if machine.outcome is None:
                launch(True, machine.tick(now_s))
        return now_s

    def sent(self, kind: type[Message]) -> list[Any]:
        """Messages of a kind that the machine sent."""
        return [message for _, is_up, message in self.log if is_up and isinstance(message, kind)]


def lose(is_up: bool, kind: type[Message], *which: int) -> Fault:
    """Lose the messages of a kind with these numbers among their kind."""
    seen = itertools.count()

    def fault(up: bool, message: Message, n: int) -> Sequence[Message]:
        is_lost = up is is_up and isinstance(message, kind) and next(seen) in which
        return [] if is_lost else [message]

    return fault
