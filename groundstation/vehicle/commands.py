"""A command to the vehicle and its acknowledgement, as a state machine without any link; and flight modes by name.

    WAITING -> WAITING    no answer in time: sent again, with the next confirmation number
            -> WORKING    the vehicle says that it is IN_PROGRESS
    WORKING -> WORKING    it says so again
    WAITING -> ended      accepted, refused, or no answer to any of the attempts
    WORKING -> ended      accepted, refused, or not heard of again

Acknowledgements of other commands, from other systems, and for other ground stations are passed over.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from functools import cache
from pathlib import Path

from groundstation.vehicle.repeated_request import RepeatedRequest
from missions.mavlink.autopilots import Autopilot, mode_numbers, px4_main_and_sub
from missions.mavlink.messages import Address, CommandAck, CommandInt, CommandLong, Message, Received
from planning.base.json_file import read_toml
from planning.base.messages import say

# Flight modes by name, and the sensors of which autopilots tell how they are: `data/vehicle.toml`.

DATA_PATH = Path(__file__).parent / "data" / "vehicle.toml"

MAV_CMD_DO_SET_MODE = 176
CUSTOM_MODE_ENABLED = 1.0
"""MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, param 1 of DO_SET_MODE."""

MISSION_MODE = {Autopilot.ARDUPILOT: "AUTO", Autopilot.PX4: "AUTO.MISSION"}
PAUSE_MODE = {Autopilot.ARDUPILOT: "BRAKE", Autopilot.PX4: "AUTO.LOITER"}
"""Stops on the spot. ArduPilot's LOITER would obey the throttle stick, and sink where that is at its bottom."""

RETURN_MODE = {Autopilot.ARDUPILOT: "RTL", Autopilot.PX4: "AUTO.RTL"}
LAND_MODE = {Autopilot.ARDUPILOT: "LAND", Autopilot.PX4: "AUTO.LAND"}


@dataclass(frozen=True, slots=True)
class VehicleNumbers:
    """What the data file holds; it explains the fields."""

    sensors: dict[str, int]


@cache
def numbers() -> VehicleNumbers:
    """Sensor bits by name."""
    return read_toml(DATA_PATH, VehicleNumbers)


def set_mode_command(autopilot: Autopilot, name: str, system: int, component: int) -> CommandLong:
    """Command that changes the mode.

    Raises
    ------
    ValueError
        The autopilot has no mode of that name.
    """
    known = mode_numbers(autopilot)
    if name not in known:
        raise ValueError(f"{autopilot.value} has no mode '{name}'; it has {', '.join(known)}")
    mode, sub = (known[name], 0) if autopilot is Autopilot.ARDUPILOT else px4_main_and_sub(known[name])
    return CommandLong(system, component, MAV_CMD_DO_SET_MODE, CUSTOM_MODE_ENABLED, float(mode), float(sub))


def sensor_problems(enabled: int, healthy: int) -> tuple[str, ...]:
    """Names of the sensors that are enabled but not healthy, from the bits of SYS_STATUS."""
    ill = enabled & ~healthy
    return tuple(name for name, bit in numbers().sensors.items() if ill >> bit & 1)


ATTEMPT_S = 1.5
"""Wait for an acknowledgement before the command is sent again; the MAVLink guide's default timeout."""

N_ATTEMPTS = 6
"""The first and five more, the guide's number of retries."""

PROGRESS_S = 10.0
"""Wait after IN_PROGRESS; vehicles repeat it at 1 Hz or more often."""


class Answer(Enum):
    """How a command ended."""

    ACCEPTED = "accepted"
    REFUSED = "refused"
    NO_ANSWER = "no answer"


RESULTS = {
    1: say("not now"),
    2: "denied",
    3: say("not supported"),
    4: "failed",
    6: "cancelled",
    7: say("only as COMMAND_LONG"),
    8: say("only as COMMAND_INT"),
    9: say("frame not supported"),
}
"""MAV_RESULT in words."""

MAV_RESULT_ACCEPTED, MAV_RESULT_TEMPORARILY_REJECTED, MAV_RESULT_IN_PROGRESS = 0, 1, 5


@dataclass(frozen=True, slots=True)
class CommandOutcome:
    """How a command ended; `result` is the MAV_RESULT, None without an answer."""

    answer: Answer
    result: int | None
    text: str

    @property
    def is_accepted(self) -> bool:
        """Whether the vehicle does it."""
        return self.answer is Answer.ACCEPTED


class CommandCall(RepeatedRequest):
    """One command on its way.

    Parameters
    ----------
    what
        The command in the pilot's words, for messages: "arming".
    own
        Address of the ground station, to which the acknowledgement goes.
    n_attempts
        How often it is sent at most; once where doing it twice would do harm.
    """

    def __init__(
        self, what: str, command: CommandLong | CommandInt, own: Address, n_attempts: int = N_ATTEMPTS
    ) -> None:
        super().__init__(n_attempts, ATTEMPT_S)
        self.what, self._command, self._own = what, command, own
        self.outcome: CommandOutcome | None = None
        self.progress_percent: int | None = None

    def receive(self, received: Received) -> list[Message]:
        """Take a message; nothing is ever sent in answer."""
        ack, target = received.message, self._command
        if self.outcome is not None or not isinstance(ack, CommandAck) or ack.command != target.command:
            return []
        from_it = received.source.system == target.target_system and (
            target.target_component in (0, received.source.component)
        )
        if not from_it or ack.target_system not in (0, self._own.system):
            return []
        if ack.target_system != 0 and ack.target_component not in (0, self._own.component):
            return []
        if ack.result == MAV_RESULT_IN_PROGRESS:
            self.progress_percent = ack.progress if ack.progress <= 100 else None
            self._deadline_s = received.time_s + PROGRESS_S
            self._n_sent = self._n_attempts  # it is being done: sending it again could do it twice
        elif ack.result == MAV_RESULT_ACCEPTED:
            self.outcome = CommandOutcome(Answer.ACCEPTED, ack.result, say("done", place=self.what))
        else:
            word = RESULTS.get(ack.result, say("result {}", ack.result))
            self.outcome = CommandOutcome(
                Answer.REFUSED, ack.result, say("the vehicle refused {} ({})", self.what, word)
            )
        return []

    def _messages(self) -> list[Message]:
        command = self._command
        return [replace(command, confirmation=self._n_sent) if isinstance(command, CommandLong) else command]

    def _give_up(self) -> None:
        self.outcome = CommandOutcome(Answer.NO_ANSWER, None, say("the vehicle did not answer to {}", self.what))
