"""Running a state machine over a link."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar, runtime_checkable

from missions.mavlink.link import Link
from missions.mavlink.messages import Heartbeat, Message, Received
from planning.base.errors import OperationCancelled
from planning.base.progress import QUIET, Clock, Monitor

SHORTEST_WAIT_S = 0.02
"""The control step of a simulated vehicle, whose clock stands still in any shorter wait."""

LONGEST_WAIT_S = 0.25
"""How soon a cancelled drive notices."""

HEARTBEAT_EVERY_S = 1.0
GROUND_HEARTBEAT = Heartbeat(type=6, autopilot=8, base_mode=0, custom_mode=0, system_status=4)
"""MAV_TYPE_GCS, MAV_AUTOPILOT_INVALID, MAV_STATE_ACTIVE: a vehicle that hears none may think the link lost."""

Outcome_co = TypeVar("Outcome_co", covariant=True)


class Machine(Protocol[Outcome_co]):
    """A state machine without input and output; times are of one clock that the caller chooses."""

    @property
    def outcome(self) -> Outcome_co | None:
        """None while it runs."""

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called at the latest."""

    def start(self, now_s: float) -> list[Message]:
        """Messages that begin it."""

    def receive(self, received: Received) -> list[Message]:
        """Messages that answer one; those that are none of its business it ignores."""

    def tick(self, now_s: float) -> list[Message]:
        """Messages that are due."""


@runtime_checkable
class Transfer(Protocol):
    """What a machine with much to send has besides."""

    @property
    def progress(self) -> tuple[str, float, float]:
        """What it does, how much of it is done, and of how much."""

    def cancel(self) -> list[Message]:
        """Messages that tell the other end that it is given up."""


def drive(
    machine: Machine[Outcome_co],
    link: Link,
    clock: Clock,
    monitor: Monitor = QUIET,
    watch: Callable[[Received], None] | None = None,
) -> Outcome_co:
    """Run a machine to its outcome; sends a heartbeat each second besides.

    Parameters
    ----------
    clock
        The link's clock.
    watch
        Sees every message that comes in meanwhile, also those that are none of the machine's business.

    Raises
    ------
    LinkError
        The link broke; what the vehicle made of the messages so far is not known.
    OperationCancelled
        By the monitor; the other end was told.
    """
    transfer = machine if isinstance(machine, Transfer) else None
    outgoing = machine.start(clock())
    heartbeat_s = clock()
    try:
        while (outcome := machine.outcome) is None:
            _send(link, outgoing)
            now_s = clock()
            if now_s >= heartbeat_s:
                link.send(GROUND_HEARTBEAT)
                heartbeat_s = now_s + HEARTBEAT_EVERY_S
            monitor.report(*transfer.progress if transfer else ("waiting", 0.0, 0.0))
            received = link.receive(min(LONGEST_WAIT_S, max(SHORTEST_WAIT_S, machine.next_deadline_s - now_s)))
            outgoing = []
            if received is not None:
                if watch is not None:
                    watch(received)
                outgoing = machine.receive(received)
            if machine.outcome is None and clock() >= machine.next_deadline_s:
                outgoing = [*outgoing, *machine.tick(clock())]
    except OperationCancelled:
        if transfer is not None:
            _send(link, transfer.cancel())
        raise
    _send(link, outgoing)
    return outcome


def _send(link: Link, messages: list[Message]) -> None:
    for message in messages:
        link.send(message)
