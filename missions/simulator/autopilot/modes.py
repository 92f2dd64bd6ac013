"""Flight modes, arming, and what is flown in each mode.

    on the ground, disarmed -> armed       arm, in a mode that may be armed in, with a position estimate
    armed -> on the ground, disarmed       disarm on the ground, landed, or idle on the ground for too long
    armed -> in the air                    it rises above the ground
    in the air -> on the ground            it touches down

ArduPilot's AUTO waits on the ground for MISSION_START, PX4's mission mode takes off as soon as it is armed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pymavlink.dialects.v20 import common as mavlink

from missions.mavlink.autopilots import Autopilot, mode_numbers
from missions.simulator.autopilot.guidance import Guidance
from missions.simulator.autopilot.manoeuvres import Manoeuvres
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.profiles import Activity, VehicleProfile
from missions.simulator.autopilot.scheduler import MissionState, Scheduler
from missions.simulator.autopilot.steps import Step, StepRunner

LIFTED_M = 0.2
"""Higher above where it stood than this the vehicle is in the air."""

ON_GROUND: int = mavlink.MAV_LANDED_STATE_ON_GROUND
IN_AIR: int = mavlink.MAV_LANDED_STATE_IN_AIR
LANDING: int = mavlink.MAV_LANDED_STATE_LANDING

ARM_IN_AUTO, TAKE_OFF_IN_AUTO = 1, 2
"""Bits of ArduPilot's AUTO_OPTIONS."""


@dataclass(frozen=True, slots=True)
class ModeContext:
    """What the modes act upon.

    Parameters
    ----------
    take_speeds
        Sets the speeds as the parameters have them: what an earlier flight changed is forgotten.
    say
        Takes the vehicle's texts: severity, text.
    """

    autopilot: Autopilot
    profile: VehicleProfile
    guidance: Guidance
    manoeuvres: Manoeuvres
    scheduler: Scheduler
    parameters: ParameterTable
    take_speeds: Callable[[], None]
    say: Callable[[int, str], None]
    arming_refusal: Callable[[], str | None] = lambda: None


class FlightModes:
    """The mode, whether it is armed, and whether it stands on the ground. Orders return why not, None where done."""

    def __init__(self, deck: ModeContext) -> None:
        self._deck = deck
        self.mode = deck.profile.boot_mode
        self.is_armed = False
        self.is_landed = True
        self.is_paused = False
        self.is_warned = False
        """A failsafe has spoken."""
        self._may_take_off = False
        self._runner: StepRunner | None = None
        self._stood_z_m = deck.guidance.here_enu_m[2]
        self._idle_since_s = 0.0
        self._has_flown = False

    # State

    @property
    def number(self) -> int:
        """Custom mode number of the mode."""
        return mode_numbers(self._deck.autopilot)[self.mode]

    @property
    def activity(self) -> Activity:
        """What is done in the mode."""
        return self._deck.profile.modes[self.mode].activity

    @property
    def has_position(self) -> bool:
        """Whether the estimator knows where it is."""
        fix = self._deck.guidance.airframe.fix
        return fix.fix_type >= mavlink.GPS_FIX_TYPE_3D_FIX and self._deck.guidance.now_s >= self._ready_s

    @property
    def is_mission_active(self) -> bool:
        """Whether the mission is being flown, or paused, in its mode."""
        return self.activity is Activity.MISSION and self.is_armed

    @property
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""
        if self.is_landed:
            return ON_GROUND
        is_landing = self._deck.scheduler.lands if self.activity is Activity.MISSION else self._lands
        return LANDING if is_landing else IN_AIR

    @property
    def _lands(self) -> bool:
        return self._runner is not None and self._runner.lands

    @property
    def _ready_s(self) -> float:
        return self._deck.profile.estimator_ready_s

    # Orders

    def set_mode(self, mode: str) -> str | None:
        """Change the mode."""
        deck, activity = self._deck, self._deck.profile.modes[mode].activity
        is_ardupilot = deck.autopilot is Autopilot.ARDUPILOT
        if activity is Activity.MISSION:
            # ArduPilot looks for a take-off only where the motors already run.
            refusal = deck.scheduler.refusal(is_landed=self.is_landed and (self.is_armed or not is_ardupilot))
            if refusal is not None:
                return refusal
        needs_position = activity is not Activity.HOLD or mode in ("GUIDED", "LOITER", "BRAKE")
        if self.is_armed and needs_position and not self.has_position:
            return f"Mode change to {mode} failed: requires position"
        if mode == self.mode:
            return None
        if self.activity is Activity.MISSION:
            deck.scheduler.pause()
        self.mode, self.is_paused = mode, False
        if self.is_armed:
            self._begin()
        return None

    def arm(self, *, is_forced: bool = False) -> str | None:
        """Start the motors."""
        deck = self._deck
        if self.is_armed:
            return None
        if not is_forced:
            if not self.has_position:
                return "Arm: Need Position Estimate"
            options = int(deck.parameters["AUTO_OPTIONS"]) if deck.autopilot is Autopilot.ARDUPILOT else 0
            in_auto = self.activity is Activity.MISSION and bool(options & ARM_IN_AUTO)
            if not (deck.profile.modes[self.mode].armable or in_auto):
                return f"Arm: {self.mode} mode not armable"
            refusal = deck.scheduler.arming_refusal() or deck.arming_refusal()
            if refusal is None and self.activity is Activity.MISSION:
                refusal = deck.scheduler.refusal(is_landed=True)
            if refusal is not None:
                return refusal
        self.is_armed, self._has_flown = True, False
        self._idle_since_s = deck.guidance.now_s
        self._stood_z_m = deck.guidance.here_enu_m[2]
        deck.take_speeds()
        deck.guidance.set_motors(True)
        self._begin()
        return None

    def disarm(self, *, is_forced: bool = False) -> str | None:
        """Stop the motors."""
        if not self.is_armed:
            return None
        if not self.is_landed and not is_forced:
            return "Disarm: vehicle is flying"
        self.is_armed = self._may_take_off = self.is_paused = False
        self._runner = None
        self._deck.scheduler.reset()
        self._deck.guidance.set_motors(False)
        return None

    def start_mission(self) -> str | None:
        """MISSION_START: ArduPilot takes off where it is armed in AUTO, PX4 changes mode and arms by itself."""
        deck = self._deck
        mode = deck.profile.mode_named(Activity.MISSION)
        if deck.autopilot is Autopilot.PX4:
            return self.set_mode(mode) or self.arm()
        if (refusal := self.set_mode(mode)) is not None:
            return refusal
        if not self.is_armed:
            # Accepted all the same: nothing flies.
            return None
        self._may_take_off = True
        if deck.scheduler.state is not MissionState.RUNNING:
            deck.scheduler.start()
        return None

    def take_off(self, above_here_m: float) -> str | None:
        """Climb straight up, to a height above where it stands."""
        if not self.is_armed:
            return "Takeoff: not armed"
        if not (self.is_landed and math.isfinite(above_here_m) and above_here_m > 0.0):
            return "Takeoff: expected to stand on the ground, and a height above it"
        if self.activity is Activity.MISSION:
            return "Takeoff: not in this mode"
        self._may_take_off = True
        self._run(self._deck.manoeuvres.take_off(self._stood_z_m + above_here_m))
        return None

    def go_to(self, goal_enu_m: tuple[float, float, float]) -> str | None:
        """Fly to a place and stay there."""
        if self.is_landed or self.activity is not Activity.HOLD:
            return "Reposition: not flying in a mode that allows it"
        self._runner = None
        self._deck.guidance.fly_to(goal_enu_m)
        return None

    def pause(self, is_paused: bool) -> str | None:
        """Stop on the way, or fly on."""
        deck = self._deck
        if not self.is_mission_active or self.is_landed:
            return "Pause: not flying a mission"
        if is_paused and not self.is_paused:
            deck.scheduler.pause()
            deck.guidance.stop()
        elif not is_paused and self.is_paused:
            deck.scheduler.start()
        self.is_paused = is_paused
        return None

    # Every control step

    def update(self) -> None:
        """Fly on, notice lift-off and landing, disarm where nothing happens."""
        if not self.is_armed:
            return
        deck = self._deck
        if deck.scheduler.state is MissionState.RUNNING and self.activity is Activity.MISSION:
            if deck.scheduler.update():
                self._end_mission()
        elif self._runner is not None and self._runner.update():
            has_landed, self._runner = self._runner.lands, None
            if has_landed:
                self._touch_down()
            elif self.activity is Activity.TAKEOFF:
                self.mode = deck.profile.mode_named(Activity.HOLD)
        if self.is_landed:
            self._on_ground()

    def _begin(self) -> None:
        """Do what the mode is for."""
        deck, activity = self._deck, self.activity
        self._runner = None
        if activity is Activity.MISSION:
            is_ardupilot = deck.autopilot is Autopilot.ARDUPILOT
            waits = is_ardupilot and not int(deck.parameters["AUTO_OPTIONS"]) & TAKE_OFF_IN_AUTO
            if self.is_landed and waits and not self._may_take_off:
                deck.guidance.stop()
            else:
                deck.scheduler.start()
        elif self.is_landed and activity is not Activity.TAKEOFF:
            deck.guidance.stop()
        elif activity is Activity.TAKEOFF:
            self._run(deck.manoeuvres.take_off(self._stood_z_m + deck.parameters["MIS_TAKEOFF_ALT"]))
        elif activity is Activity.RETURN:
            self._run(deck.manoeuvres.go_home())
        elif activity is Activity.LAND:
            self._run(deck.manoeuvres.land())
        else:
            deck.guidance.stop()

    def _run(self, steps: list[Step]) -> None:
        self._runner = StepRunner(steps, self._deck.guidance)

    def _end_mission(self) -> None:
        if self._deck.scheduler.has_landed:
            self._touch_down()
        else:
            # Both hover in the mode until told what to do.
            self._deck.guidance.stop()

    def _touch_down(self) -> None:
        self.is_landed = True
        self._stood_z_m = self._deck.guidance.here_enu_m[2]
        self._idle_since_s = self._deck.guidance.now_s
        self._deck.guidance.stop()
        if self._deck.autopilot is Autopilot.ARDUPILOT:
            self.disarm()

    def _on_ground(self) -> None:
        deck = self._deck
        if deck.guidance.here_enu_m[2] > self._stood_z_m + LIFTED_M:
            self.is_landed, self._has_flown = False, True
            return
        if self._runner is not None or deck.scheduler.state is MissionState.RUNNING:
            self._idle_since_s = deck.guidance.now_s
            return
        if deck.autopilot is Autopilot.ARDUPILOT:
            limit_s = deck.parameters["DISARM_DELAY"]
        else:
            limit_s = deck.parameters["COM_DISARM_LAND" if self._has_flown else "COM_DISARM_PRFLT"]
        if limit_s > 0.0 and deck.guidance.now_s - self._idle_since_s >= limit_s:
            deck.say(mavlink.MAV_SEVERITY_INFO, "Disarming motors")
            self.disarm()
