"""Driving a state machine over a link, and reading back what a vehicle holds."""

from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar, runtime_checkable

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import _CIRCLES, _POLYGONS, Fence, FenceCircle, FencePolygon
from missions.mavlink.items import MissionItem
from missions.mavlink.link import GROUND_HEARTBEAT, HEARTBEAT_EVERY_S, Link
from missions.mavlink.messages import Message, MissionItemInt, Received
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import _item, has_home
from planning.base.errors import MissionError, OperationCancelled
from planning.base.progress import QUIET, Clock, Monitor

SHORTEST_WAIT_S = 0.02
"""The control step of a simulated vehicle, whose clock stands still in any shorter wait."""


LONGEST_WAIT_S = 0.25
"""How soon a cancelled drive notices."""


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


def fences_of(items: Sequence[MissionItem]) -> tuple[Fence, ...]:
    """Fences of items that were read back; a return point is none, and is left out.

    Raises
    ------
    MissionError
        A polygon is not complete, or an item is no part of a fence.
    """
    fences: list[Fence] = []
    corners: list[tuple[float, float]] = []
    for number, item in enumerate(items, 1):
        lat_deg, lon_deg = item.params[4:6]
        if item.command in _POLYGONS:
            corners.append((lat_deg, lon_deg))
            if len(corners) == item.params[0]:
                fences.append(FencePolygon(tuple(corners), _POLYGONS[item.command]))
                corners = []
                continue
            following = items[number] if number < len(items) else None
            if following is None or (following.command, following.params[0]) != (item.command, item.params[0]):
                raise MissionError(
                    f"fence item {number}: its polygon has {len(corners)} corners; expected {item.params[0]:g}"
                )
        elif item.command in _CIRCLES:
            fences.append(FenceCircle(lat_deg, lon_deg, item.params[0], _CIRCLES[item.command]))
        elif item.command != mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT:
            raise MissionError(f"fence item {number}: the command {item.command} is no part of a fence")
    return tuple(fences)


def from_wire(
    messages: Sequence[MissionItemInt], autopilot: Autopilot, mission_type: MissionType = MissionType.MISSION
) -> tuple[MissionItem, ...]:
    """Items of messages that were read back, without home."""
    flown = messages[1:] if has_home(autopilot, mission_type) else messages
    return tuple(_item(message) for message in flown)
