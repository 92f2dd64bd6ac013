"""How ArduCopter goes through a mission.

All items between the navigation items n and n + 1 run when n is done, *while n + 1 is flown*, the first of them even
before that begins. A CONDITION item holds up those behind it. When n + 1 is done, what is left of them is dropped
without a word. Beginning a waypoint turns the nose as WP_YAW_BEHAVIOR says, unless the vehicle looks at a region of
interest; a CONDITION_YAW that is still turning turns it back.
"""

from __future__ import annotations

import math
from collections import deque

from pymavlink.dialects.v20 import common as mavlink

from missions.simulator.autopilot.guidance import DEG
from missions.simulator.autopilot.mission_store import StoredItem
from missions.simulator.autopilot.profiles import VehicleProfile
from missions.simulator.autopilot.scheduler import (
    FLOWN_TO,
    MAX_ITEMS_IN_A_TICK,
    TAKEOFFS,
    MissionState,
    Scheduler,
    SchedulerContext,
    is_navigation,
)
from missions.simulator.autopilot.steps import FlyTo, Step, StepRunner, Wait
from planning.geo.frames import Vec3

FIRST = 1
"""Item 0 is home."""

MAX_JUMPS = 100
"""DO_JUMP items whose repetitions are counted, with enough memory; further ones are passed over."""

TURNED_RAD = 2.0 * DEG
"""CONDITION_YAW is met this near to its heading."""

SHORT_LEG_M = 0.5
"""On legs shorter than this, seen from above, the nose is not turned into the course."""

STRAIGHT_RAD = 30.0 * DEG
"""At smaller turns a waypoint without hold is flown through without braking."""

LATE_S = 1.3
"""A waypoint with a hold counts as reached this long after the aircraft is there: the target that it follows begins
gently, waits for it, and must come to its own end. 4.7.0-dev took 0.46 to 1.15 s longer than the fastest way."""

ABOVE_TERRAIN = 10
"""Frame in which such items are kept."""

CONDITIONS = (
    mavlink.MAV_CMD_CONDITION_DELAY,
    mavlink.MAV_CMD_CONDITION_DISTANCE,
    mavlink.MAV_CMD_CONDITION_YAW,
)
UNSUPPORTED_IN_FLIGHT = frozenset((30, 83, 84, 85, 94))
"""Stored like any other, and then passed over by a copter."""


class ArduPilotScheduler(Scheduler):
    """Goes through the mission on board as ArduCopter does."""

    def __init__(self, context: SchedulerContext, profile: VehicleProfile) -> None:
        super().__init__(context, profile)
        self._waiting: deque[int] = deque()
        self._condition: tuple[int, StoredItem, float] | None = None
        self._condition_heading_rad = 0.0
        self._next_start = FIRST

    def refusal(self, *, is_landed: bool) -> str | None:
        """Why AUTO is refused."""
        if len(self._context.store) <= FIRST:
            return "Auto: No mission"
        if is_landed and not self._starts_with_take_off():
            return "Auto: Missing Takeoff Cmd"
        return None

    def arming_refusal(self) -> str | None:
        """Heights above terrain need data that this vehicle never gets."""
        above_terrain = any(item.frame == ABOVE_TERRAIN for item in self._context.store.items)
        return "Arm: waiting for terrain data" if above_terrain else None

    def start(self) -> None:
        """Begin; or fly the item that was under way again, with the items that still waited for their turn."""
        if self.state is MissionState.ENDED:
            self.reset()
        self.state = MissionState.RUNNING
        item = self._context.store.item(self.current) if self.current else None
        if item is None:
            self._begin(self._next_start)
        else:
            self._begin_navigation(self.current, item)

    def set_current(self, seq: int) -> bool:
        """Go on with an item: what stands before it is not done, a camera's angles among it."""
        if not FIRST <= seq < len(self._context.store):
            return False
        self._forget()
        self._next_start = seq
        if self.state is MissionState.RUNNING:
            self._begin(seq)
        else:
            self.state = MissionState.READY
        return True

    def reset(self) -> None:
        """Back to the start, as at every disarming."""
        self._forget()
        self.state, self._next_start = MissionState.READY, FIRST
        self._jumps = {}

    # Items

    def _forget(self) -> None:
        self.current, self._runner = 0, None
        self._waiting.clear()
        self._condition = None
        self.has_landed = False

    def _starts_with_take_off(self) -> bool:
        seq = self._next_start
        while (item := self._context.store.item(seq)) is not None:
            if is_navigation(item):
                return item.command in TAKEOFFS
            seq += 1
        return False

    def _begin(self, seq: int) -> None:
        """Go to the first navigation item at or behind `seq`; what stands between is done on the way."""
        self.n_dropped += len(self._waiting)
        self._waiting.clear()
        self._condition = None
        for _ in range(MAX_ITEMS_IN_A_TICK):
            item = self._context.store.item(seq)
            if item is None:
                break
            if item.command == mavlink.MAV_CMD_DO_JUMP:
                seq = self._jump(seq, item)
            elif is_navigation(item):
                self.current = seq
                self._run_first()
                self._begin_navigation(seq, item)
                return
            else:
                self._waiting.append(seq)
                seq += 1
        # Nothing left to fly: what stood behind the last navigation item is never done, but for its first.
        self._run_first()
        self.n_dropped += len(self._waiting)
        self._forget()
        self.state = MissionState.ENDED

    def _jump(self, seq: int, item: StoredItem) -> int:
        """Item after a DO_JUMP: param 1 where to, param 2 how often, -1 for ever."""
        done, often = self._jumps.get(seq, 0), int(item.param2)
        is_counted = seq in self._jumps or len(self._jumps) < MAX_JUMPS
        target = int(item.param1)
        if not is_counted or not FIRST <= target < len(self._context.store) or (often >= 0 and done >= often):
            return seq + 1
        self._jumps[seq] = done + 1
        return target

    def _run_first(self) -> None:
        if self._waiting:
            self._start_waiting(self._waiting.popleft())

    def _run_waiting(self) -> None:
        while True:
            if self._condition is not None:
                if not self._is_met(*self._condition):
                    return
                self._context.reached(self._condition[0])
                self._condition = None
            if not self._waiting:
                return
            self._start_waiting(self._waiting.popleft())

    def _start_waiting(self, seq: int) -> None:
        item = self._context.store.item(seq)
        if item is None:
            return
        if item.command in CONDITIONS:
            self._condition = (seq, item, self._context.guidance.now_s)
            if item.command == mavlink.MAV_CMD_CONDITION_YAW:
                self._start_yaw(item)
            return
        self._context.actions.do(item)
        if item.command in self._profile.reports_reached:
            self._context.reached(seq)

    # Conditions

    def _start_yaw(self, item: StoredItem) -> None:
        angle_deg, _, direction, is_relative = item.params
        nose_rad = self._context.guidance.airframe.estimate.heading_rad
        turn_rad = math.copysign(angle_deg * DEG, -1.0 if direction < 0.0 else 1.0)
        if not math.isfinite(turn_rad):
            turn_rad = angle_deg = 0.0
        self._condition_heading_rad = nose_rad + turn_rad if is_relative == 1.0 else angle_deg * DEG
        self._context.actions.gimbal.look_at(None)
        self._keep_turning(item)

    def _keep_turning(self, item: StoredItem) -> None:
        rate_rad_s = item.param2 * DEG if item.param2 > 0.0 else None
        self._context.guidance.face(self._condition_heading_rad, rate_rad_s)

    def _is_met(self, seq: int, item: StoredItem, started_s: float) -> bool:
        guidance = self._context.guidance
        if item.command == mavlink.MAV_CMD_CONDITION_DELAY:
            return guidance.now_s - started_s >= item.param1
        if item.command == mavlink.MAV_CMD_CONDITION_DISTANCE:
            (x, y, _), (gx, gy, _) = guidance.here_enu_m, guidance.goal_enu_m
            return math.hypot(gx - x, gy - y) <= item.param1
        if guidance.heading_rad != self._condition_heading_rad:
            self._keep_turning(item)
        return guidance.turn_left_rad(self._condition_heading_rad) <= TURNED_RAD

    # Navigation

    def _begin_navigation(self, seq: int, item: StoredItem) -> None:
        self.has_landed = False
        self._runner = StepRunner(self._steps(seq, item), self._context.guidance)

    def _steps(self, seq: int, item: StoredItem) -> list[Step]:
        guidance, manoeuvres = self._context.guidance, self._context.manoeuvres
        if item.command in UNSUPPORTED_IN_FLIGHT:
            self._context.say(mavlink.MAV_SEVERITY_WARNING, f"Skipping invalid cmd #{item.command}")
            return []
        goal_enu_m = self._context.place.item_enu(item, guidance.here_enu_m)
        match item.command:
            case mavlink.MAV_CMD_NAV_TAKEOFF:
                return manoeuvres.take_off(goal_enu_m[2])
            case mavlink.MAV_CMD_NAV_LAND:
                return manoeuvres.land(goal_enu_m if item.has_place else None)
            case mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
                return manoeuvres.go_home()
            case mavlink.MAV_CMD_NAV_DELAY:
                return [Wait(item.param1)]
            case command if command in FLOWN_TO:
                self._turn_into(goal_enu_m)
                return self._leg(seq, item, goal_enu_m)
        return []

    def _leg(self, seq: int, item: StoredItem, goal_enu_m: Vec3) -> list[Step]:
        stay_s = item.param1
        if item.command == mavlink.MAV_CMD_NAV_LOITER_UNLIM:
            stay_s = math.inf
        elif item.command == mavlink.MAV_CMD_NAV_LOITER_TURNS:
            # Circles are flown as a stop of the same length at their centre.
            stay_s = item.param1 * 2.0 * math.pi * abs(item.param3) / self._context.guidance.horizontal_m_s
        elif item.command == mavlink.MAV_CMD_NAV_LOITER_TO_ALT:
            stay_s = 0.0
        next_enu_m = self._next_place(seq, goal_enu_m)
        if stay_s == 0.0 and next_enu_m is not None:
            straight = self._is_straight_on(goal_enu_m, next_enu_m)
            leave_m = min(self._profile.pass_m, 0.5 * math.dist(self._context.guidance.here_enu_m, goal_enu_m))
            return [FlyTo(goal_enu_m, leave_m=leave_m, passes=straight)]
        return [FlyTo(goal_enu_m), Wait(LATE_S + stay_s)]

    def _next_place(self, seq: int, here_enu_m: Vec3) -> Vec3 | None:
        """Where the leg after this one leads, where it follows without a stop."""
        while (item := self._context.store.item(seq := seq + 1)) is not None:
            if item.command == mavlink.MAV_CMD_DO_JUMP:
                return None
            if is_navigation(item):
                return self._context.place.item_enu(item, here_enu_m) if item.command in FLOWN_TO else None
        return None

    def _is_straight_on(self, goal_enu_m: Vec3, next_enu_m: Vec3) -> bool:
        here_enu_m = self._context.guidance.here_enu_m
        before = [b - a for a, b in zip(here_enu_m, goal_enu_m, strict=True)]
        after = [b - a for a, b in zip(goal_enu_m, next_enu_m, strict=True)]
        lengths = math.hypot(*before) * math.hypot(*after)
        along = sum(a * b for a, b in zip(before, after, strict=True))
        return lengths > 0.0 and along >= lengths * math.cos(STRAIGHT_RAD)

    def _turn_into(self, goal_enu_m: Vec3) -> None:
        guidance = self._context.guidance
        if guidance.look_at_enu_m is not None:
            return
        (x, y, _), (gx, gy, _) = guidance.here_enu_m, goal_enu_m
        if self._context.parameters["WP_YAW_BEHAVIOR"] == 0:
            guidance.face(guidance.airframe.estimate.heading_rad)
        elif math.hypot(gx - x, gy - y) > SHORT_LEG_M:
            guidance.face(math.atan2(gx - x, gy - y))
