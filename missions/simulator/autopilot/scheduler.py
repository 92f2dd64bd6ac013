"""How the two autopilots go through a mission: what both share.

A scheduler flies one navigation item at a time. What else stands in the mission is done at once when its turn comes;
when that is, is the difference between the two.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.check import LAST_NAV_COMMAND
from missions.simulator.autopilot.guidance import Guidance, Place
from missions.simulator.autopilot.manoeuvres import Manoeuvres
from missions.simulator.autopilot.mission_store import MissionStore, StoredItem
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.payload import Actions
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


class Scheduler(Protocol):
    """Goes through the mission on board."""

    state: MissionState
    current: int
    """Item that is being flown, or would be."""
    n_dropped: int
    """Items that were left out because their time was over."""
    has_landed: bool
    """It ended on the ground."""

    @property
    def lands(self) -> bool:
        """It is touching down, or has."""

    def refusal(self, *, is_landed: bool) -> str | None:
        """Why the mission cannot be flown from here; None where it can."""

    def arming_refusal(self) -> str | None:
        """Why the vehicle must not be armed with this mission on board; None where it may."""

    def start(self) -> None:
        """Begin, or go on."""

    def pause(self) -> None:
        """Leave it as it is."""

    def set_current(self, seq: int) -> bool:
        """Go on with an item; False where there is none."""

    def reset(self) -> None:
        """Back to the start."""

    def update(self) -> bool:
        """Go on, called once for every control step while it runs; True once the mission has ended."""


def is_navigation(item: StoredItem) -> bool:
    """Whether the mission waits for an item."""
    return item.command <= LAST_NAV_COMMAND and item.command != mavlink.MAV_CMD_NAV_ROI
