"""What a sortie has on board: geofence, rally points, mission; put there, read back, and doubted.

    not uploaded -> equal       uploaded and read back (`upload`)
    equal -> not known          something may have changed it (`reason_to_reread`): a restart, silence,
                                another ground station
    not known -> equal, other   read again (`BoardReread`): before take-off as soon as the vehicle is heard, at Start in
                                any case, in flight beside the mission

A vehicle is never started on what was true some time ago: whoever else is on the link may have written since. Part of
the steps in `steps.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from groundstation.vehicle.preflight import OnBoard
from groundstation.vehicle.state import VehicleState, is_restarted
from missions.mavlink import messages
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Message, MissionItemInt, Received
from missions.mavlink.transfer.exchange import Download, DownloadOutcome, Ending, MissionType, Result, Route
from missions.mavlink.transfer.wire_items import compare
from planning.base.messages import say

RESTARTED = say("the vehicle was restarted")
SILENT = say("the vehicle was not heard for a while")
CHANGED = say("the vehicle says that it holds something else now")
WRITTEN = say("another ground station has written to the vehicle")
UNREAD = say("it could not be read")
"""Why what is on board is not known any more."""

READ_PAUSE_S = 5.0
"""Until a list that could not be read is asked for again."""

WRITING = (
    messages.MissionCount,
    messages.MissionItemInt,
    messages.MissionItem,
    messages.MissionClearAll,
    messages.MissionWritePartialList,
)
"""What ground stations change the lists of a vehicle with."""


@dataclass(frozen=True, slots=True)
class BoardList:
    """A list that was put on the vehicle, and its name in messages."""

    what: str
    route: Route
    messages: tuple[MissionItemInt, ...]


@dataclass(frozen=True, slots=True)
class ListRead:
    """A list that was read again.

    Parameters
    ----------
    is_equal
        Whether it is what was uploaded; None where it could not be read.
    text
        The same in words.
    """

    board_list: BoardList
    is_equal: bool | None
    text: str


class BoardReread:
    """Reads lists one after the other and compares each with what was uploaded; a machine of `FlightRun`.

    READING i -> READING i + 1   the list came, or could not be read
            -> ended             it was the last: `outcome` holds one `ListRead` for each
    """

    def __init__(self, lists: Sequence[BoardList], autopilot: Autopilot) -> None:
        self._waiting, self._autopilot = list(lists), autopilot
        self._read: list[ListRead] = []
        self._download: Download | None = None
        self.outcome: tuple[ListRead, ...] | None = None

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""
        return float("inf") if self._download is None else self._download.next_deadline_s

    @property
    def progress(self) -> tuple[str, float, float]:
        """Of the list that is being read."""
        return (say("reading back"), 0.0, 0.0) if self._download is None else self._download.progress

    def start(self, now_s: float) -> list[Message]:
        """Ask for the first list."""
        if not self._waiting:
            self.outcome, self._download = tuple(self._read), None
            return []
        self._download = Download(self._waiting[0].route)
        return self._download.start(now_s)

    def receive(self, received: Received) -> list[Message]:
        """Take an item."""
        if self._download is None:
            return []
        return [*self._download.receive(received), *self._go_on(received.time_s)]

    def tick(self, now_s: float) -> list[Message]:
        """Ask again, or give a list up."""
        if self._download is None:
            return []
        return [*self._download.tick(now_s), *self._go_on(now_s)]

    def _go_on(self, now_s: float) -> list[Message]:
        assert self._download is not None
        read = self._download.outcome
        if read is None:
            return []
        self._read.append(_compared(self._waiting.pop(0), read, self._autopilot))
        return self.start(now_s)


def _compared(board_list: BoardList, read: DownloadOutcome, autopilot: Autopilot) -> ListRead:
    what = board_list.what
    if read.ending is not Ending.DONE:
        return ListRead(board_list, None, say("the {} on board could not be read again ({})", what, read.ending.value))
    differences = compare(board_list.messages, read.items, autopilot, board_list.route.mission_type)
    if differences:
        return ListRead(board_list, False, say("the vehicle has another {} now: {}", what, differences[0]))
    return ListRead(board_list, True, say("the {} on board is the one that was uploaded", what))


# What may have changed it


def reason_to_reread(before: VehicleState, after: VehicleState, received: Received, *, is_transferring: bool) -> str:
    """Why what is on board may be something else after a message than before it; empty where nothing says so.

    Parameters
    ----------
    before, after
        The vehicle's state without and with the message.
    is_transferring
        A transfer of our own is on its way: the vehicle's questions and acknowledgements are for us then.
    """
    message, vehicle = received.message, after.address
    if vehicle is None:
        return ""
    if isinstance(message, WRITING) and received.source.system != vehicle.system:
        return WRITTEN if message.target_system in (0, vehicle.system) else ""
    if received.source.system != vehicle.system:
        return ""
    if is_restarted(before, after):
        return RESTARTED
    if is_transferring:
        return ""
    if isinstance(message, messages.MissionChanged):
        return CHANGED
    if isinstance(message, messages.MissionRequestInt | messages.MissionRequest):
        return WRITTEN
    if isinstance(message, messages.MissionAck):
        # The end of a download is acknowledged by the ground station, that of an upload or of clearing by the vehicle.
        return WRITTEN if message.type == Result.ACCEPTED else ""
    if isinstance(message, messages.MissionCurrent) and before.mission is not None and after.mission is not None:
        known = before.mission.value.lists
        return CHANGED if known is not None and known != after.mission.value.lists else ""
    return ""


def with_lists_unknown(on_board: OnBoard, reason: str) -> OnBoard:
    """Nothing of what was equal is known any more."""
    equal = [kind for kind in MissionType if on_board.of(kind)]
    for kind in equal:
        on_board = on_board.known(kind, None)
    return replace(on_board, reason_to_reread=reason) if equal or on_board.reason_to_reread else on_board
