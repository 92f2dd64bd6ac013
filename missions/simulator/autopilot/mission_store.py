"""The vehicle's side of the mission protocol: what is on board, and how it gets there and back.

One `MissionStore` for each kind (mission, fence, rally points). Its states, and what leads from one to the next:

    IDLE -> RECEIVING   MISSION_COUNT of more than 0 items
    RECEIVING -> IDLE   the last item came, an item was refused, or none came for `give_up_s`

What the two autopilots do differently stands in `StoreRules`. ArduPilot writes each item where it belongs as it comes,
so that a broken upload leaves a mix of the old mission and the new; PX4 keeps the old one until the last item is there.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum, auto

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.messages import (
    Address,
    Message,
    MissionAck,
    MissionClearAll,
    MissionCount,
    MissionItem,
    MissionItemInt,
    MissionRequest,
    MissionRequestInt,
    MissionRequestList,
    Received,
)
from missions.simulator.autopilot.profiles import vehicle_profile

# A mission item as a vehicle keeps it: what it takes of what was sent, and what it therefore answers on read-back.
#
# ArduPilot keeps each command in a record of its own shape: holds as whole seconds, heights in centimetres, some
# numbers as whole ones, others not at all. PX4 keeps floats, but takes commands without a position only in frame 2.

MISSION, FENCE, RALLY, ALL_TYPES = 0, 1, 2, 255
"""MAV_MISSION_TYPE."""

DEGREES_E7 = 1e7
MAX_HEIGHT_M = 83_000.0
"""ArduPilot's LOCATION_ALT_MAX_M: higher ones do not fit its record; 40 000 m are accepted."""

WITH_POSITION = frozenset((16, 17, 18, 19, 21, 22, 30, 31, 80, 82, 84, 85, 94, 179, 189, 195, 201, 4501))
"""Commands whose x, y and z are a position, also those where it may be left out."""

FENCE_COMMANDS = frozenset((5000, 5001, 5002, 5003, 5004))
RALLY_COMMANDS = frozenset((5100,))
NAN_ALLOWED = {16: (3,), 21: (3,), 22: (3,), 84: (2, 3), 85: (2, 3)}
"""Indices of params that ArduPilot lets be NaN."""

SAME_FRAME = {0: 0, 2: 0, 3: 3, 5: 0, 6: 3, 10: 10, 11: 10}
"""ArduPilot's frames on read-back."""

POSITION_FREE = frozenset((115, 178, 205, 206, 1000, 2000, 2001, 93, 112, 114, 177))
"""Commands of which ArduPilot keeps none of x, y and z; of the gimbal's 1000 it keeps x and z."""


class Refused(Exception):  # noqa: N818  (it is an answer, not a failure)
    """The vehicle does not take an item; `result` is the MAV_MISSION_RESULT that it answers."""

    def __init__(self, result: int) -> None:
        super().__init__(f"MAV_MISSION_RESULT {result}")
        self.result = result


@dataclass(frozen=True, slots=True)
class StoredItem:
    """One item in the vehicle's memory; fields as in MISSION_ITEM_INT."""

    command: int
    frame: int
    param1: float
    param2: float
    param3: float
    param4: float
    x: int
    y: int
    z: float
    autocontinue: int = 1

    @property
    def params(self) -> tuple[float, float, float, float]:
        """Params 1 to 4."""
        return self.param1, self.param2, self.param3, self.param4

    @property
    def has_place(self) -> bool:
        """Whether it names a place; latitude and longitude 0 mean "here"."""
        return self.command in WITH_POSITION and (self.x, self.y) != (0, 0)


def stored(message: MissionItemInt, autopilot: Autopilot) -> StoredItem:
    """What a vehicle keeps of an item.

    Raises
    ------
    Refused
        It does not take the item.
    """
    item = StoredItem(
        message.command,
        message.frame,
        float32(message.param1),
        float32(message.param2),
        float32(message.param3),
        float32(message.param4),
        message.x,
        message.y,
        float32(message.z),
        message.autocontinue,
    )
    if message.mission_type != MISSION:
        return _stored_place(item, FENCE_COMMANDS if message.mission_type == FENCE else RALLY_COMMANDS)
    return _stored_by_ardupilot(item) if autopilot is Autopilot.ARDUPILOT else _stored_by_px4(item)


def _from_float_item(message: MissionItem) -> MissionItemInt:
    """The deprecated MISSION_ITEM as a MISSION_ITEM_INT; its float32 degrees are up to a metre off.

    Raises
    ------
    Refused
        A coordinate is not finite, or not on the globe.
    """
    is_place = message.command in WITH_POSITION | FENCE_COMMANDS | RALLY_COMMANDS
    scale = DEGREES_E7 if is_place else 1.0
    whole = []
    for value, limit, result in (
        (message.x, 90.0, mavlink.MAV_MISSION_INVALID_PARAM5_X),
        (message.y, 180.0, mavlink.MAV_MISSION_INVALID_PARAM6_Y),
    ):
        value = 0.0 if math.isnan(value) and not is_place else value
        if not math.isfinite(value) or abs(value) > (limit if is_place else 2**31 - 1):
            raise Refused(result)
        whole.append(int(float32(value) * scale))
    fields = {name: getattr(message, name) for name in MissionItem.__dataclass_fields__ if name not in ("x", "y")}
    return MissionItemInt(**fields, x=whole[0], y=whole[1])


def to_wire(item: StoredItem, seq: int, is_current: bool, mission_type: int) -> MissionItemInt:
    """The item as the vehicle sends it; the addressee is filled in by whoever sends it."""
    return MissionItemInt(
        0, 0, seq, item.frame, item.command, int(is_current), item.autocontinue, *item.params, item.x, item.y, item.z,
        mission_type,
    )  # fmt: skip


def _to_float_wire(item: MissionItemInt) -> MissionItem:
    """The same item in the deprecated message."""
    is_place = item.command in WITH_POSITION | FENCE_COMMANDS | RALLY_COMMANDS
    scale = 1.0 / DEGREES_E7 if is_place else 1.0
    fields = {name: getattr(item, name) for name in MissionItemInt.__dataclass_fields__ if name not in ("x", "y")}
    return MissionItem(**fields, x=float32(item.x * scale), y=float32(item.y * scale))


def _stored_by_ardupilot(item: StoredItem) -> StoredItem:
    known = facts(Autopilot.ARDUPILOT)
    if item.command not in known.commands:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
    for index, value in enumerate(item.params):
        if math.isnan(value) and index not in NAN_ALLOWED.get(item.command, ()):
            raise Refused(mavlink.MAV_MISSION_INVALID_PARAM1 + index)
    if not math.isfinite(item.z):
        raise Refused(mavlink.MAV_MISSION_INVALID_PARAM7)
    keeps = vehicle_profile(Autopilot.ARDUPILOT).keeps.get(str(item.command), "ffff")
    p1, p2, p3, p4 = (_KEEP[letter](value) for letter, value in zip(keeps, item.params, strict=True))
    kept = replace(item, param1=p1, param2=p2, param3=p3, param4=p4, autocontinue=1)
    if item.command in WITH_POSITION:
        if item.frame not in known.position_frames:
            raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
        _check_on_globe(item)
        if abs(item.z) >= MAX_HEIGHT_M:
            raise Refused(mavlink.MAV_MISSION_INVALID_PARAM7)
        # A whole number of centimetres, cut off, not rounded.
        height_m = float32(int(float32(item.z * 100.0)) / 100.0)
        return replace(kept, frame=SAME_FRAME[item.frame], z=height_m)
    kept = replace(kept, frame=0)
    if item.command == mavlink.MAV_CMD_DO_DIGICAM_CONTROL:
        return replace(kept, x=item.x & 0xFF, y=item.y & 0xFF, z=0.0)
    if item.command == mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
        return replace(kept, y=0, z=float(int(item.z)))
    return replace(kept, x=0, y=0, z=0.0) if item.command in POSITION_FREE else kept


def _stored_by_px4(item: StoredItem) -> StoredItem:
    known = facts(Autopilot.PX4)
    if item.frame in (10, 11):
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    may_have_place = item.command in WITH_POSITION
    needs_place = may_have_place and item.command not in (179, 189, 195, 201)
    if item.command not in known.commands:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame == mavlink.MAV_FRAME_MISSION:
        if needs_place:
            raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
        return item
    if item.frame not in known.position_frames or not may_have_place:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    # On read-back PX4 names the frames of the integer message.
    return replace(item, frame=5 if item.frame in (0, 5) else 6)


def _stored_place(item: StoredItem, commands: frozenset[int]) -> StoredItem:
    """Corners of a fence and rally points, the same for both autopilots."""
    if item.command not in commands:
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED)
    if item.frame not in (0, 3, 5, 6):
        raise Refused(mavlink.MAV_MISSION_UNSUPPORTED_FRAME)
    _check_on_globe(item)
    return replace(item, frame=0 if item.frame in (0, 5) else 3)


def _check_on_globe(item: StoredItem) -> None:
    if abs(item.x) > 90.0 * DEGREES_E7:
        raise Refused(mavlink.MAV_MISSION_INVALID_PARAM5_X)
    if abs(item.y) > 180.0 * DEGREES_E7:
        raise Refused(mavlink.MAV_MISSION_INVALID_PARAM6_Y)


def float32(value: float) -> float:
    """What a number is after it went over the wire."""
    try:
        return float(struct.unpack("<f", struct.pack("<f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)


def _whole(value: float) -> float:
    return float(math.trunc(value)) if math.isfinite(value) else 0.0


_KEEP: dict[str, Callable[[float], float]] = {
    "f": lambda value: value,
    "i": _whole,
    "u": lambda value: min(max(_whole(value), 0.0), 65535.0),
    "s": lambda value: -1.0 if value < 0.0 else 1.0,
    "-": lambda value: 0.0,
}


TransferMessage = (
    MissionCount
    | MissionItemInt
    | MissionItem
    | MissionRequestList
    | MissionRequestInt
    | MissionRequest
    | MissionClearAll
    | MissionAck
)


class StoreState(Enum):
    """Whether an upload is going on; the module lists the transitions."""

    IDLE = auto()
    RECEIVING = auto()


@dataclass(frozen=True, slots=True)
class StoreRules:
    """How an autopilot takes uploads of one kind.

    Parameters
    ----------
    is_atomic
        What is on board changes with the last item, not with each.
    has_home
        Item 0 is the vehicle's home: what is sent for it is not kept.
    asks_with_int
        MISSION_REQUEST_INT instead of MISSION_REQUEST.
    answers_wrong_seq
        An item out of turn is answered with INVALID_SEQUENCE (and the upload goes on) instead of not at all.
    busy_result
        For another sender while an upload is going on.
    """

    max_items: int
    retry_s: float
    give_up_s: float
    is_atomic: bool
    has_home: bool
    asks_with_int: bool
    answers_wrong_seq: bool
    busy_result: int


def store_rules(autopilot: Autopilot, mission_type: int) -> StoreRules:
    """Rules of an autopilot for a MAV_MISSION_TYPE."""
    profile, is_ardupilot = vehicle_profile(autopilot), autopilot is Autopilot.ARDUPILOT
    limits = {FENCE: profile.max_fence_items, RALLY: profile.max_rally_items}
    return StoreRules(
        max_items=limits.get(mission_type, facts(autopilot).max_items),
        retry_s=profile.retry_s,
        give_up_s=profile.give_up_s,
        # ArduPilot checks a fence as a whole before it replaces the old one.
        is_atomic=not is_ardupilot or mission_type == FENCE,
        has_home=is_ardupilot and mission_type == MISSION,
        asks_with_int=not is_ardupilot,
        answers_wrong_seq=is_ardupilot,
        busy_result=mavlink.MAV_MISSION_DENIED if is_ardupilot else mavlink.MAV_MISSION_ERROR,
    )


class MissionStore:
    """Items of one kind on board, and the transfer that is going on.

    Parameters
    ----------
    home
        The vehicle's home as an item, for item 0.
    may_clear
        Whether the items may be cleared now; ArduPilot does not while it flies them.
    say
        Takes the vehicle's texts: severity (MAV_SEVERITY), text.
    """

    def __init__(
        self,
        autopilot: Autopilot,
        mission_type: int,
        home: Callable[[], StoredItem],
        may_clear: Callable[[], bool],
        say: Callable[[int, str], None],
    ) -> None:
        self.rules = store_rules(autopilot, mission_type)
        self.state = StoreState.IDLE
        self.revision = 0
        """Counts every change of what is on board."""
        self._autopilot = autopilot
        self._mission_type = mission_type
        self._home, self._may_clear, self._say = home, may_clear, say
        self._items: list[StoredItem] = []
        self._incoming: list[StoredItem] = []
        self._partner = Address(0, 0)
        self._expected = self._count = 0
        self._asked_s = self._last_item_s = 0.0

    # What is on board

    @property
    def items(self) -> tuple[StoredItem, ...]:
        """What is on board; with ArduPilot's missions the first is home."""
        return (self._home(), *self._items[1:]) if self.rules.has_home and self._items else tuple(self._items)

    def item(self, seq: int) -> StoredItem | None:
        """One item, None behind the last."""
        if seq == 0 and self.rules.has_home and self._items:
            return self._home()
        return self._items[seq] if 0 <= seq < len(self._items) else None

    def __len__(self) -> int:
        return len(self._items)

    # Protocol

    def receive(self, message: TransferMessage, source: Address, now_s: float) -> list[Message]:
        """Answers to a message of the mission protocol."""
        match message:
            case MissionCount():
                return self._on_count(message.count, source, now_s)
            case MissionItemInt() | MissionItem():
                return self._on_item(message, source, now_s)
            case MissionRequestList():
                if self.state is StoreState.RECEIVING:
                    return [self._ack(self.rules.busy_result, source)]
                return [MissionCount(source.system, source.component, len(self._items), self._mission_type)]
            case MissionRequestInt() | MissionRequest():
                return [self._on_request(message, source)]
            case MissionClearAll():
                return [self._on_clear(source)]
            case MissionAck():
                if message.type == mavlink.MAV_MISSION_OPERATION_CANCELLED and source == self._partner:
                    self.state = StoreState.IDLE
                return []

    def tick(self, now_s: float) -> list[Message]:
        """What time brings: an item asked for again, or the upload given up."""
        if self.state is StoreState.IDLE:
            return []
        if now_s - self._last_item_s > self.rules.give_up_s:
            self.state = StoreState.IDLE
            self._say(mavlink.MAV_SEVERITY_WARNING, "Mission upload timeout")
            return [self._ack(mavlink.MAV_MISSION_OPERATION_CANCELLED, self._partner)]
        if now_s - self._asked_s > self.rules.retry_s:
            return [self._ask(now_s)]
        return []

    def _on_count(self, count: int, source: Address, now_s: float) -> list[Message]:
        if self.state is StoreState.RECEIVING and source != self._partner:
            return [self._ack(self.rules.busy_result, source)]
        if count > self.rules.max_items:
            if self.rules.has_home:
                self._say(mavlink.MAV_SEVERITY_WARNING, f"Only {self.rules.max_items} items are supported")
            return [self._ack(mavlink.MAV_MISSION_NO_SPACE, source)]
        if not self.rules.is_atomic:
            del self._items[count:]
            self.revision += 1
        if count == 0:
            self._items = []
            self.revision += 1
            self.state = StoreState.IDLE
            return [self._ack(mavlink.MAV_MISSION_ACCEPTED, source)]
        self.state = StoreState.RECEIVING
        self._partner, self._count, self._expected, self._incoming = source, count, 0, []
        self._last_item_s = now_s
        return [self._ask(now_s)]

    def _on_item(self, message: MissionItemInt | MissionItem, source: Address, now_s: float) -> list[Message]:
        if self.state is StoreState.IDLE:
            # A repeated last item, or one nobody asked for.
            return [self._ack(mavlink.MAV_MISSION_ERROR, source)] if self.rules.answers_wrong_seq else []
        if source != self._partner:
            return [self._ack(self.rules.busy_result, source)]
        if message.seq != self._expected:
            return [self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE, source)] if self.rules.answers_wrong_seq else []
        try:
            item = stored(_from_float_item(message) if isinstance(message, MissionItem) else message, self._autopilot)
        except Refused as refused:
            self.state = StoreState.IDLE
            return [self._ack(refused.result, source)]
        self._keep(item)
        self._expected += 1
        self._last_item_s = now_s
        if self._expected < self._count:
            return [self._ask(now_s)]
        self._complete()
        return [self._ack(mavlink.MAV_MISSION_ACCEPTED, source)]

    def _keep(self, item: StoredItem) -> None:
        if self.rules.is_atomic:
            self._incoming.append(item)
            return
        if self._expected < len(self._items):
            self._items[self._expected] = item
        else:
            self._items.append(item)
        self.revision += 1

    def _complete(self) -> None:
        self.state = StoreState.IDLE
        if self.rules.is_atomic:
            self._items = self._incoming
            self.revision += 1
        if self.rules.has_home:
            self._say(mavlink.MAV_SEVERITY_INFO, "Flight plan received")

    def _on_request(self, message: MissionRequestInt | MissionRequest, source: Address) -> Message:
        item = self.item(message.seq)
        if item is None:
            return self._ack(mavlink.MAV_MISSION_INVALID_SEQUENCE, source)
        sent = to_wire(item, message.seq, False, self._mission_type)
        sent = replace(sent, target_system=source.system, target_component=source.component)
        # ArduPilot, and MAVLink's own words, answer the deprecated request with the deprecated item.
        return _to_float_wire(sent) if isinstance(message, MissionRequest) else sent

    def _on_clear(self, source: Address) -> Message:
        if self.state is StoreState.RECEIVING:
            return self._ack(self.rules.busy_result, source)
        if not self._may_clear():
            return self._ack(mavlink.MAV_MISSION_ERROR, source)
        self._items = []
        self.revision += 1
        return self._ack(mavlink.MAV_MISSION_ACCEPTED, source)

    def _ask(self, now_s: float) -> Message:
        self._asked_s = now_s
        kind = MissionRequestInt if self.rules.asks_with_int else MissionRequest
        return kind(self._partner.system, self._partner.component, self._expected, self._mission_type)

    def _ack(self, result: int, to: Address) -> Message:
        return MissionAck(to.system, to.component, result, self._mission_type)


class MissionStores:
    """The three stores of a vehicle, by mission type."""

    def __init__(
        self,
        autopilot: Autopilot,
        home: Callable[[], StoredItem],
        may_clear: Callable[[], bool],
        say: Callable[[int, str], None],
    ) -> None:
        self.mission = MissionStore(autopilot, MISSION, home, may_clear, say)
        self.fence = MissionStore(autopilot, FENCE, home, lambda: True, say)
        self.rally = MissionStore(autopilot, RALLY, home, lambda: True, say)
        self._by_type = {MISSION: self.mission, FENCE: self.fence, RALLY: self.rally}

    @property
    def is_receiving(self) -> bool:
        """Whether an upload is going on."""
        return any(store.state is StoreState.RECEIVING for store in self._by_type.values())

    def receive(self, received: Received, now_s: float) -> list[Message]:
        """Answers to a message of the mission protocol."""
        message, source = received.message, received.source
        if not isinstance(message, TransferMessage):
            raise TypeError(f"expected a message of the mission protocol, got {type(message).__name__}")
        if isinstance(message, MissionClearAll) and message.mission_type == ALL_TYPES:
            answers = [store.receive(message, source, now_s) for store in self._by_type.values()]
            results = [ack.type for (ack,) in answers if isinstance(ack, MissionAck)]
            # One answer for all: the first that did not work, in their order.
            worst = next((result for result in results if result != mavlink.MAV_MISSION_ACCEPTED), results[0])
            return [MissionAck(source.system, source.component, worst, ALL_TYPES)]
        store = self._by_type.get(message.mission_type)
        if store is None:
            unsupported = mavlink.MAV_MISSION_UNSUPPORTED
            return [MissionAck(source.system, source.component, unsupported, message.mission_type)]
        return store.receive(message, source, now_s)

    def tick(self, now_s: float) -> list[Message]:
        """What time brings."""
        return [message for store in self._by_type.values() for message in store.tick(now_s)]
