"""COMMAND_LONG, COMMAND_INT and SET_MODE: what the vehicle does, and the acknowledgement that it answers with.

Each handler gets the command as an item (params 1 to 4, x, y, z) and answers with a MAV_RESULT.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot, facts, mode_numbers, px4_custom_mode
from missions.mavlink.messages import Address, CommandAck, CommandInt, CommandLong, Message, SetMode
from missions.simulator.autopilot.instruments import Instruments, Telemetry
from missions.simulator.autopilot.mission_store import DEGREES_E7, WITH_POSITION, StoredItem
from missions.simulator.autopilot.modes import FlightModes
from missions.simulator.autopilot.payload import Actions
from missions.simulator.autopilot.profiles import Activity, VehicleProfile
from missions.simulator.autopilot.scheduler import Scheduler

ACCEPTED: int = mavlink.MAV_RESULT_ACCEPTED
REJECTED: int = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
DENIED: int = mavlink.MAV_RESULT_DENIED
UNSUPPORTED: int = mavlink.MAV_RESULT_UNSUPPORTED
FAILED: int = mavlink.MAV_RESULT_FAILED

FORCE = 21196.0
"""Param 2 of COMPONENT_ARM_DISARM that passes over all checks."""

NO_PLACE = frozenset((0, 2**31 - 1))
"""Latitudes and longitudes that mean "here": of COMMAND_LONG (from NaN), and of COMMAND_INT."""

SET_MODE_ID = 11
"""ArduPilot acknowledges the message SET_MODE as if this were a command."""


def as_item(message: CommandLong | CommandInt) -> StoredItem:
    """A command as an item; what is not finite where a whole number belongs is 0."""
    if isinstance(message, CommandInt):
        x, y, z, frame = message.x, message.y, message.z, message.frame
    else:
        scale = DEGREES_E7 if message.command in WITH_POSITION | {mavlink.MAV_CMD_DO_REPOSITION} else 1.0
        x, y = (_whole(value * scale) for value in (message.param5, message.param6))
        z, frame = message.param7, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
    return StoredItem(
        message.command, frame, message.param1, message.param2, message.param3, message.param4, x, y, z
    )  # fmt: skip


def _whole(value: float) -> int:
    return int(value) if math.isfinite(value) and abs(value) < 2**31 else 0


@dataclass(frozen=True, slots=True)
class Commands:
    """Carries commands out. `say` takes the vehicle's texts: severity, text."""

    autopilot: Autopilot
    profile: VehicleProfile
    modes: FlightModes
    scheduler: Scheduler
    actions: Actions
    instruments: Instruments
    telemetry: Telemetry
    say: Callable[[int, str], None]

    def receive(self, message: CommandLong | CommandInt, source: Address) -> list[Message]:
        """Carry a command out; the answers, the acknowledgement first."""
        item = as_item(message)
        extra: list[Message] = []
        if item.command == mavlink.MAV_CMD_REQUEST_MESSAGE:
            found = self._requested(item)
            extra, result = ([], FAILED) if found is None else ([found], ACCEPTED)
        elif item.command == mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES:
            found = self.instruments.message(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
            extra, result = ([found] if found else []), ACCEPTED
        elif item.command in _HANDLERS:
            result = _HANDLERS[item.command](self, item)
        elif item.command in facts(self.autopilot).commands or item.command == mavlink.MAV_CMD_DO_SET_ROI_NONE:
            result = ACCEPTED if self.actions.do(item) else UNSUPPORTED
        else:
            result = UNSUPPORTED
        ack = CommandAck(item.command, result, target_system=source.system, target_component=source.component)
        return [ack, *extra]

    def _requested(self, item: StoredItem) -> Message | None:
        """The message that REQUEST_MESSAGE names; of photos the one with the index in param 2."""
        if not (math.isfinite(item.param1) and math.isfinite(item.param2)):
            return None
        if int(item.param1) == mavlink.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED:
            return self.instruments.repeated_photo_message(int(item.param2))
        return self.instruments.message(int(item.param1))

    def receive_set_mode(self, message: SetMode, source: Address) -> list[Message]:
        """SET_MODE: ArduPilot acknowledges it, PX4 does not."""
        result = self._change_mode(message.custom_mode)
        if self.autopilot is Autopilot.PX4:
            return []
        return [CommandAck(SET_MODE_ID, result, target_system=source.system, target_component=source.component)]

    def _answer(self, refusal: str | None, result: int) -> int:
        if refusal is None:
            return ACCEPTED
        self.say(mavlink.MAV_SEVERITY_CRITICAL, refusal)
        return result

    def _change_mode(self, number: int) -> int:
        known = mode_numbers(self.autopilot)
        mode = next((name for name in self.profile.modes if known[name] == number), None)
        if mode is None:
            self.say(mavlink.MAV_SEVERITY_WARNING, f"No such mode {number}")
            return DENIED
        return self._answer(self.modes.set_mode(mode), self._refused)

    @property
    def _refused(self) -> int:
        """Answer to a change of mode that does not work out: both autopilots' own."""
        return DENIED if self.autopilot is Autopilot.ARDUPILOT else REJECTED

    def arm_disarm(self, item: StoredItem) -> int:
        """COMPONENT_ARM_DISARM."""
        is_forced = item.param2 == FORCE
        refused = FAILED if self.autopilot is Autopilot.ARDUPILOT else REJECTED
        if item.param1 == 1.0:
            return self._answer(self.modes.arm(is_forced=is_forced), refused)
        if item.param1 == 0.0:
            return self._answer(self.modes.disarm(is_forced=is_forced), refused)
        return UNSUPPORTED

    def do_set_mode(self, item: StoredItem) -> int:
        """DO_SET_MODE: param 2 is ArduPilot's custom mode, or PX4's main mode with the sub mode in param 3."""
        if not (math.isfinite(item.param2) and (math.isfinite(item.param3) or self.autopilot is Autopilot.ARDUPILOT)):
            return DENIED
        number = int(item.param2)
        if self.autopilot is Autopilot.PX4:
            number = px4_custom_mode(number, int(item.param3))
        return self._change_mode(number)

    def mission_start(self, item: StoredItem) -> int:
        """MISSION_START."""
        return self._answer(self.modes.start_mission(), FAILED if self.autopilot is Autopilot.ARDUPILOT else REJECTED)

    def set_mission_current(self, item: StoredItem) -> int:
        """DO_SET_MISSION_CURRENT."""
        is_known = math.isfinite(item.param1) and self.scheduler.set_current(int(item.param1))
        return ACCEPTED if is_known else FAILED

    def pause_continue(self, item: StoredItem) -> int:
        """DO_PAUSE_CONTINUE: 0 stops, 1 flies on; PX4 has its hold mode for that."""
        if self.autopilot is Autopilot.PX4:
            return UNSUPPORTED
        if item.param1 not in (0.0, 1.0):
            return DENIED
        return self._answer(self.modes.pause(item.param1 == 0.0), DENIED)

    def return_home(self, item: StoredItem) -> int:
        """NAV_RETURN_TO_LAUNCH."""
        return self._answer(self.modes.set_mode(self.profile.mode_named(Activity.RETURN)), self._refused)

    def land(self, item: StoredItem) -> int:
        """NAV_LAND: here, whatever place it names."""
        return self._answer(self.modes.set_mode(self.profile.mode_named(Activity.LAND)), self._refused)

    def loiter(self, item: StoredItem) -> int:
        """NAV_LOITER_UNLIM: here."""
        return self._answer(self.modes.set_mode(self.profile.mode_named(Activity.HOLD)), self._refused)

    def take_off(self, item: StoredItem) -> int:
        """NAV_TAKEOFF: ArduPilot in GUIDED, to a height above home; PX4 to an altitude above sea level."""
        if self.autopilot is Autopilot.ARDUPILOT:
            if self.modes.mode != "GUIDED":
                return self._answer("Takeoff: only in GUIDED", FAILED)
            return self._answer(self.modes.take_off(item.z), FAILED)
        stood = self.instruments.place.wire_place(self.actions.guidance.here_enu_m)
        above_m = item.z - stood.altitude_amsl_m if math.isfinite(item.z) else self._default_take_off_m
        hold = self.profile.mode_named(Activity.HOLD)
        return self._answer(self.modes.set_mode(hold) or self.modes.take_off(above_m), REJECTED)

    @property
    def _default_take_off_m(self) -> float:
        return float(self.profile.parameters["MIS_TAKEOFF_ALT"])

    def reposition(self, item: StoredItem) -> int:
        """DO_REPOSITION: fly there and stay; without a place, stop here, which is how PX4 is paused."""
        hold = "GUIDED" if self.autopilot is Autopilot.ARDUPILOT else self.profile.mode_named(Activity.HOLD)
        refusal = self.modes.set_mode(hold)
        if refusal is None and NO_PLACE.isdisjoint((item.x, item.y)):
            here = self.instruments.place.wire_place(self.actions.guidance.here_enu_m)
            z, frame = (item.z, item.frame) if math.isfinite(item.z) else (here.above_home_m, 3)
            refusal = self.modes.go_to(self.instruments.place.enu(item.x, item.y, z, frame))
        return self._answer(refusal, DENIED)

    def set_message_interval(self, item: StoredItem) -> int:
        """SET_MESSAGE_INTERVAL: param 2 in microseconds, -1 stops, 0 is the usual interval."""
        if not (math.isfinite(item.param1) and math.isfinite(item.param2)):
            return DENIED
        is_known = self.telemetry.set_interval(int(item.param1), item.param2 / 1e6)
        return ACCEPTED if is_known else FAILED


_HANDLERS: dict[int, Callable[[Commands, StoredItem], int]] = {
    mavlink.MAV_CMD_COMPONENT_ARM_DISARM: Commands.arm_disarm,
    mavlink.MAV_CMD_DO_SET_MODE: Commands.do_set_mode,
    mavlink.MAV_CMD_MISSION_START: Commands.mission_start,
    mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: Commands.set_mission_current,
    mavlink.MAV_CMD_DO_PAUSE_CONTINUE: Commands.pause_continue,
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: Commands.return_home,
    mavlink.MAV_CMD_NAV_LAND: Commands.land,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM: Commands.loiter,
    mavlink.MAV_CMD_NAV_TAKEOFF: Commands.take_off,
    mavlink.MAV_CMD_DO_REPOSITION: Commands.reposition,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: Commands.set_message_interval,
}
