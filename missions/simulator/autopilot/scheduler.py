"""How the two autopilots go through a mission: what both share.

A scheduler flies one navigation item at a time. What else stands in the mission is done at once when its turn comes;
when that is, is the difference between the two.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.check import LAST_NAV_COMMAND
from missions.simulator.autopilot.guidance import Guidance, Place
from missions.simulator.autopilot.manoeuvres import Manoeuvres
from missions.simulator.autopilot.mission_store import MissionStore, StoredItem
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.payload import Actions
from missions.simulator.autopilot.profiles import VehicleProfile
from missions.simulator.autopilot.steps import StepRunner
from planning.geo.frames import Vec3

TAKEOFFS = (mavlink.MAV_CMD_NAV_TAKEOFF, mavlink.MAV_CMD_NAV_VTOL_TAKEOFF)
FLOWN_TO = (
    mavlink.MAV_CMD_NAV_WAYPOINT,
    mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT,
    mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    mavlink.MAV_CMD_NAV_LOITER_TURNS,
    mavlink.MAV_CMD_NAV_LOITER_TIME,
    mavlink.MAV_CMD_NAV_LOITER_TO_ALT,
)
MAX_ITEMS_IN_A_TICK = 256
"""Items that one control step may begin: a mission of jumps alone would never end otherwise."""


class MissionState(Enum):
    """Whether the mission is being flown.

    READY -> RUNNING   it is started, or resumed
    RUNNING -> READY   the vehicle leaves the mode; the item under way is flown again when it comes back
    RUNNING -> ENDED   the last item is done
    ENDED -> READY     it is set back to its start, or to an item
    """

    READY = auto()
    RUNNING = auto()
    ENDED = auto()


@dataclass(frozen=True, slots=True)
class SchedulerContext:
    """What a scheduler flies with, and whom it tells.

    Parameters
    ----------
    reached
        Takes the number of an item that is done, where the autopilot tells it.
    say
        Takes the vehicle's texts: severity, text.
    is_forbidden
        Whether the fence on board forbids a place.
    """

    store: MissionStore
    guidance: Guidance
    actions: Actions
    manoeuvres: Manoeuvres
    parameters: ParameterTable
    place: Place
    reached: Callable[[int], None]
    say: Callable[[int, str], None]
    is_forbidden: Callable[[Vec3], bool]


class Scheduler(ABC):
    """Goes through the mission on board, as one autopilot does."""

    def __init__(self, context: SchedulerContext, profile: VehicleProfile) -> None:
        self._context, self._profile = context, profile
        self._runner: StepRunner | None = None
        self._jumps: dict[int, int] = {}
        self.state = MissionState.READY
        self.current = 0
        """Item that is being flown, or would be."""
        self.n_dropped = 0
        """Items that were left out because their time was over."""
        self.has_landed = False
        """It ended on the ground."""

    @property
    def lands(self) -> bool:
        """It is touching down, or has."""
        return self._runner is not None and self._runner.lands

    @abstractmethod
    def refusal(self, *, is_landed: bool) -> str | None:
        """Why the mission cannot be flown from here; None where it can."""

    @abstractmethod
    def arming_refusal(self) -> str | None:
        """Why the vehicle must not be armed with this mission on board; None where it may."""

    @abstractmethod
    def start(self) -> None:
        """Begin, or go on."""

    def pause(self) -> None:
        """Leave the mode; the mission stays as it is."""
        if self.state is MissionState.RUNNING:
            self.state = MissionState.READY

    @abstractmethod
    def set_current(self, seq: int) -> bool:
        """Go on with an item; False where there is none."""

    @abstractmethod
    def reset(self) -> None:
        """Back to the start."""

    def update(self) -> bool:
        """Go on, called once for every control step while it runs; True once the mission has ended."""
        for _ in range(MAX_ITEMS_IN_A_TICK):
            if self.state is MissionState.ENDED or self._runner is None:
                return True
            self._run_waiting()
            if not self._runner.update():
                return False
            self.has_landed = self._runner.lands
            self._context.reached(self.current)
            if self.has_landed:
                self.state = MissionState.ENDED
                return True
            self._begin(self.current + 1)
        return False

    @abstractmethod
    def _begin(self, seq: int) -> None:
        """Go to an item, or to the first behind it that is flown to."""

    def _run_waiting(self) -> None:  # noqa: B027  (most do nothing there)
        """Do what waits for its turn beside the item that is being flown."""


def is_navigation(item: StoredItem) -> bool:
    """Whether the mission waits for an item."""
    return item.command <= LAST_NAV_COMMAND and item.command != mavlink.MAV_CMD_NAV_ROI
