"""What the steps of a sortie run on: messages in and out, the vehicle's state, pilot's orders and doubts, beside them.

Losing the link ends nothing: it is shown, and the aircraft goes on by itself.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Generator
from dataclasses import replace
from typing import Any, Protocol

from groundstation.vehicle.commands import CommandCall, CommandOutcome, set_mode_command
from groundstation.vehicle.orders import SortieOrders
from groundstation.vehicle.preflight import OnBoard, PreflightCheck, preflight_checks
from groundstation.vehicle.recorder import Recorder
from groundstation.vehicle.setup import ParameterChange
from groundstation.vehicle.sortie.board import (
    READ_PAUSE_S,
    SILENT,
    UNREAD,
    BoardList,
    BoardReread,
    ListRead,
    reason_to_reread,
    with_lists_unknown,
)
from groundstation.vehicle.sortie.run_records import ORDER_MODES, Phase, PilotOrder, RunOptions, RunOutcome, RunView
from groundstation.vehicle.state import VehicleState
from groundstation.vehicle.telemetry import LocalFrame, updated_state
from groundstation.vehicle.watch import OtherAircraft, Watch, WatchRules, watched
from missions.flight.record import FlightEvent
from missions.mavlink.link import GROUND_HEARTBEAT, GROUND_STATION, HEARTBEAT_EVERY_S
from missions.mavlink.messages import (
    Address,
    CameraCaptureStatus,
    CameraFeedback,
    CameraImageCaptured,
    CommandLong,
    Message,
    Received,
)
from missions.mavlink.transfer.exchange import Download, MissionType
from missions.mavlink.transfer.verified import VerifiedUpload
from planning.base.errors import GroundStationError
from planning.base.messages import say

# Asks a camera for the reports of its photos that the radio lost, and how many photos it has counted.
#
# MAVLink's camera protocol: CAMERA_IMAGE_CAPTURED may be asked for again by its index, which counts from 0, and
# CAMERA_CAPTURE_STATUS says how many photos there are. ArduPilot tells of photos with CAMERA_FEEDBACK, which cannot
# be asked for again, but says how many there are; an autopilot that does neither does not answer, and nothing comes
# of it.

MAV_CMD_REQUEST_MESSAGE = 512
CAPTURE_STATUS, IMAGE_CAPTURED = 262, 263

ASK_EVERY_S = 1.0
N_ASKS = 8
MAX_AT_ONCE = 5
"""Reports asked for at a time: what lost them is often a thin link."""

MAX_GAP = 500
"""A larger one is a camera that began to count anew, and no gap."""

ALL_COMPONENTS = 0


class CameraReports:
    """Notes which photos were told of, and asks for the others until each was asked for `N_ASKS` times.

    Attributes
    ----------
    count
        What the camera said last; None before it said anything.
    """

    def __init__(self) -> None:
        self.count: int | None = None
        self._camera: Address | None = None
        self._last: int | None = None
        self._feeds_back = False
        self._missing: dict[int, int] = {}
        self._n_count_asks: int | None = None
        self._asked_s = -math.inf

    @property
    def is_settled(self) -> bool:
        """Whether there is nothing more to ask or to wait for."""
        return not self._missing and self._n_count_asks is None

    def ask_count(self) -> None:
        """Find out how many photos there are."""
        self._n_count_asks = 0

    def receive(self, received: Received) -> None:
        """Take a message of the vehicle or of its camera."""
        message = received.message
        if isinstance(message, CameraImageCaptured):
            self._camera = received.source
            self._told(message.image_index)
        elif isinstance(message, CameraFeedback):
            self._feeds_back = True
            self._missing.clear()
        elif isinstance(message, CameraCaptureStatus) and message.image_count >= 0:
            self._camera = received.source
            self._n_count_asks = None
            self._expect(message.image_count)
            self.count = message.image_count

    def tick(self, now_s: float, system: int) -> list[Message]:
        """Ask for what is missing, where it is time to."""
        if self.is_settled or now_s < self._asked_s + ASK_EVERY_S:
            return []
        self._asked_s = now_s
        # The last question was given its time for an answer, too.
        self._missing = {index: n_asks for index, n_asks in self._missing.items() if n_asks < N_ASKS}
        messages: list[Message] = []
        if self._n_count_asks is not None:
            self._n_count_asks = self._n_count_asks + 1 if self._n_count_asks < N_ASKS else None
            messages += [self._request(system, CAPTURE_STATUS)] if self._n_count_asks is not None else []
        for index in sorted(self._missing)[:MAX_AT_ONCE]:
            messages.append(self._request(system, IMAGE_CAPTURED, index))
            self._missing[index] += 1
        return messages

    def _told(self, index: int) -> None:
        self._missing.pop(index, None)
        if self._last is None or index > self._last:
            self._expect(index)
            self._last = index

    def _expect(self, end: int) -> None:
        """All photos before this one must have been told of: from the last one on, or from the count before."""
        start = self.count if self._last is None else self._last + 1
        if start is not None and 0 < end - start <= MAX_GAP and not self._feeds_back:
            for index in range(start, end):
                self._missing.setdefault(index, 0)

    def _request(self, system: int, message_id: int, index: int = 0) -> CommandLong:
        component = ALL_COMPONENTS if self._camera is None else self._camera.component
        return CommandLong(system, component, MAV_CMD_REQUEST_MESSAGE, float(message_id), float(index))


WATCH_EVERY_S = 0.5
LONGEST_WAIT_S = 0.25


class Exchange(Protocol):
    """A machine that a run lets work: a command, a parameter, a transfer."""

    @property
    def outcome(self) -> Any:
        """None while it runs."""

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called."""

    def start(self, now_s: float) -> list[Message]:
        """Messages that begin it."""

    def receive(self, received: Received) -> list[Message]:
        """Messages that answer one."""

    def tick(self, now_s: float) -> list[Message]:
        """Messages that are due."""


Steps = Generator["Exchange | None", Any, None]
"""Yields a machine to be run and gets its outcome, or None to be called again after the next event."""


class SortieRun:
    """A sortie being flown; give it what is received and the time, and send what it returns.

    What is done, step by step, is told by `steps`: see `flight_run.FlightRun`.

    Attributes
    ----------
    others
        Other aircraft in the air, told by whoever hears them.
    """

    def __init__(
        self, orders: SortieOrders, options: RunOptions, link_name: str, own: Address = GROUND_STATION
    ) -> None:
        self.orders, self.options, self.own = orders, options, own
        self.link_name = link_name
        self.state = VehicleState()
        self.phase = Phase.CONNECTING
        self.watch = Watch()
        self.others: tuple[OtherAircraft, ...] = ()
        self.on_board = OnBoard()
        self.lists: tuple[BoardList, ...] = ()
        self.now_s = self._started_s = 0.0
        self.outcome: RunOutcome | None = None
        self.answers: tuple[CommandOutcome, ...] = ()
        self.notes: tuple[FlightEvent, ...] = ()
        self.recorder: Recorder | None = None
        self.camera_reports = CameraReports()
        self.may_start = options.starts_itself
        self.was_ordered_away = False
        self.asked_s = -math.inf
        self.is_simulation = self.has_told_unknown = False
        self.unknown_names: frozenset[str] = frozenset()
        self.agreed: tuple[ParameterChange, ...] = ()
        self._frame = LocalFrame.of_home(orders.site.origin, orders.home_enu_m)
        self._steps: Steps | None = None
        self._machine: Exchange | None = None
        self._orders: deque[PilotOrder] = deque()
        self._order_call: CommandCall | None = None
        self._aside: BoardReread | None = None
        self._outbox: list[Message] = []
        self._heartbeat_s = self._watch_s = self._reread_s = -math.inf
        self._had_link = False
        self._checks: tuple[PreflightCheck, ...] = ()

    def steps(self) -> Steps:
        """All that the sortie does, one machine after the other."""
        raise NotImplementedError

    # For whoever drives it

    @property
    def next_deadline_s(self) -> float:
        """When `tick` wants to be called at the latest."""
        machines = (self._machine, self._order_call, self._aside)
        deadlines = [each.next_deadline_s for each in machines if each is not None and each.outcome is None]
        return min([self._heartbeat_s + HEARTBEAT_EVERY_S, self.now_s + LONGEST_WAIT_S, *deadlines])

    def start(self, now_s: float) -> list[Message]:
        """Begin."""
        self.now_s = self._started_s = now_s
        self._steps = self.steps()
        return self._advance()

    def receive(self, received: Received) -> list[Message]:
        """Take a message."""
        self.now_s = received.time_s
        before = self.state
        self.state = updated_state(before, received, self._frame)
        if self.state is not before and self.recorder is not None:
            self.recorder.take(received)
        self._doubt(reason_to_reread(before, self.state, received, is_transferring=self._is_transferring))
        for machine in (self._machine, self._order_call, self._aside):
            if machine is not None and machine.outcome is None:
                self._outbox += machine.receive(received)
        if self.state is not before:
            self.camera_reports.receive(received)
        return self._advance()

    def tick(self, now_s: float) -> list[Message]:
        """Let time pass."""
        self.now_s = now_s
        for machine in (self._machine, self._order_call, self._aside):
            if machine is not None and machine.outcome is None and now_s >= machine.next_deadline_s:
                self._outbox += machine.tick(now_s)
        return self._advance()

    def order(self, order: PilotOrder) -> None:
        """Queue an order of the pilot; it goes out with the next `receive` or `tick`.

        Raises
        ------
        ValueError
            There is no vehicle yet.
        """
        if self.state.autopilot is None:
            raise ValueError("no vehicle was heard yet, so none can take orders")
        self._orders.append(order)

    def begin(self) -> None:
        """The pilot says: take off."""
        self.may_start = True

    def set_parameters(self, changes: tuple[ParameterChange, ...]) -> None:
        """The pilot agrees that these parameters are set before take-off."""
        self.agreed = changes

    def view(self) -> RunView:
        """The run as it stands."""
        return RunView(
            self.now_s,
            self.phase,
            self.state,
            self.checks(),
            self.watch,
            self.on_board,
            getattr(self._machine, "progress", (self.phase.value, 0.0, 0.0)),
            self.answers,
            self.notes,
            self.state.is_link_alive(self.now_s),
        )

    # For the steps

    def checks(self) -> tuple[PreflightCheck, ...]:
        """The pre-flight list: now, and once it was started as it was then."""
        if self.phase not in (Phase.STARTING, Phase.FLYING, Phase.ENDED):
            options = self.options
            self._checks = preflight_checks(
                self.state,
                self.orders,
                self.on_board,
                self.now_s,
                needs_rtk=options.needs_rtk,
                overrules=options.overrules,
            )
        return self._checks

    def note(self, code: str, text: str) -> None:
        """Note something, in seconds since the run began, and in the record too where one is made."""
        self.notes = (*self.notes, FlightEvent(self.now_s - self._started_s, code, text))
        if self.recorder is not None:
            self.recorder.note(code, text)

    def forget_progress(self) -> None:
        """What the vehicle next says of its lists is what it says of those that were just read."""
        mission = self.state.mission
        if mission is not None:
            self.state = replace(self.state, mission=replace(mission, value=replace(mission.value, lists=None)))

    # Inside

    def _advance(self) -> list[Message]:
        if self.outcome is None:
            self._watch_link()
            self._watch_board()
            self._watch_flight()
            self._pass_orders_on()
            self._step()
        if self.state.address is not None:
            self._outbox += self.camera_reports.tick(self.now_s, self.state.address.system)
        if self.now_s >= self._heartbeat_s + HEARTBEAT_EVERY_S:
            self._heartbeat_s = self.now_s
            self._outbox.append(GROUND_HEARTBEAT)
        sent, self._outbox = self._outbox, []
        return sent

    def _step(self) -> None:
        """Let the steps go on as far as they can."""
        assert self._steps is not None
        try:
            while self.outcome is None:
                outcome = None
                if self._machine is not None:
                    outcome = self._machine.outcome
                    if outcome is None:
                        return
                    self._machine = None
                wanted = self._steps.send(None if outcome is None else outcome)
                if wanted is None:
                    return
                self._machine = wanted
                self._outbox += wanted.start(self.now_s)
        except StopIteration:
            self._end(None)
        except GroundStationError as error:
            self._end(error)

    def _end(self, error: GroundStationError | None) -> None:
        self.phase, self._machine = Phase.ENDED, None
        if error is not None:
            self.note("failed", str(error))
        record = None if self.recorder is None else self.recorder.record(self.orders.site, self.orders.number)
        self.outcome = RunOutcome(error, record, self.notes)

    def _watch_link(self) -> None:
        has_link = self.state.is_link_alive(self.now_s)
        if has_link != self._had_link and self.recorder is not None:
            if has_link:
                self.note("link-found", say("the vehicle is heard again"))
            else:
                self.note("link-lost", say("no heartbeat; the aircraft goes on by itself"))
        if has_link and not self._had_link:
            self._doubt(SILENT)
        self._had_link = has_link

    @property
    def _is_transferring(self) -> bool:
        return isinstance(self._machine or self._aside, VerifiedUpload | Download | BoardReread)

    def _doubt(self, reason: str) -> None:
        """Something may have changed what is on board."""
        on_board = with_lists_unknown(self.on_board, reason) if reason else self.on_board
        if on_board is not self.on_board and on_board.reason_to_reread != self.on_board.reason_to_reread:
            self.note("board-doubted", say("what is on board is not known any more: {}", reason))
        self.on_board = on_board

    def note_reads(self, reads: tuple[ListRead, ...]) -> None:
        """Note what was read again; the next change of the vehicle's own numbers is one from now on."""
        for read in reads:
            kind = read.board_list.route.mission_type
            self.note("mission-reread" if kind is MissionType.MISSION else "list-reread", read.text)
            self.on_board = self.on_board.known(kind, read.is_equal)
        if any(read.is_equal is None for read in reads) and not self.on_board.reason_to_reread:
            self.on_board = replace(self.on_board, reason_to_reread=UNREAD)
        self.forget_progress()

    def _watch_board(self) -> None:
        """In flight, read again beside the mission; before take-off the steps do."""
        if self._aside is not None and self._aside.outcome is not None:
            reads, self._aside = self._aside.outcome, None
            self.note_reads(reads)
        is_due = (
            self.phase is Phase.FLYING
            and self.on_board.reason_to_reread
            and self.now_s >= self._reread_s + READ_PAUSE_S
        )
        if self._aside is None and is_due and self._had_link and self.state.autopilot is not None:
            self._reread_s = self.now_s
            self.on_board = replace(self.on_board, reason_to_reread="")
            self._aside = BoardReread(self.lists, self.state.autopilot)
            self._outbox += self._aside.start(self.now_s)

    def _watch_flight(self) -> None:
        autopilot = self.state.autopilot
        if self.phase is not Phase.FLYING or autopilot is None or self.now_s < self._watch_s + WATCH_EVERY_S:
            return
        self._watch_s = self.now_s
        before = self.watch.codes()
        around = self.orders.surroundings[autopilot]
        has_other = self.on_board.mission is False
        rules = WatchRules(self.options.needs_rtk, has_other_mission=has_other, others=self.others)
        self.watch = watched(self.watch, self.state, around, self.now_s, rules)
        for warning in self.watch.warnings:
            if warning.code not in before:
                self.note(f"warning-{warning.code}", warning.text)

    def _pass_orders_on(self) -> None:
        call = self._order_call
        if call is not None and call.outcome is not None:
            self.answers = (*self.answers, call.outcome)
            self.note("order", call.outcome.text)
            self._order_call = None
        # Acknowledgements do not say which of two changes of mode they are for: one after the other.
        is_busy = self._order_call is not None or isinstance(self._machine, CommandCall)
        if is_busy or not self._orders or self.state.autopilot is None or self.state.address is None:
            return
        order = self._orders.popleft()
        self.was_ordered_away = order is not PilotOrder.RESUME
        mode = ORDER_MODES[order][self.state.autopilot]
        target = self.state.address
        command = set_mode_command(self.state.autopilot, mode, target.system, target.component)
        self._order_call = CommandCall(order.value, command, self.own)
        self._outbox += self._order_call.start(self.now_s)
