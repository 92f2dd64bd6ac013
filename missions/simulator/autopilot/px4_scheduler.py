"""How PX4 goes through a mission: one item after the other, in the order of the list.

A waypoint is reached when it is within its radius. Its hold counts from then on; where the nose does not stand as it
says when that is over, PX4 waits for the nose. What has no position is done at once when its turn comes. A mission that
does not pass the feasibility check is not flown. A new mission is taken up in flight, from its start.
"""

from __future__ import annotations

import math

import numpy as np
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
from missions.simulator.autopilot.steps import Reach, Stay, Step, StepRunner, Wait
from planning.geo.frames import Vec3
from planning.motion.px4 import px4_legs_s
from planning.motion.timing import MotionLimits

SHORT_LEG_M = 0.5
"""On legs shorter than this, seen from above, the nose is not turned into the course."""


class Px4Scheduler(Scheduler):
    """Goes through the mission on board as PX4 does."""

    def __init__(self, context: SchedulerContext, profile: VehicleProfile) -> None:
        super().__init__(context, profile)
        self._revision = 0

    def refusal(self, *, is_landed: bool) -> str | None:
        """Why the mission is not feasible."""
        items = self._context.store.items
        if not items:
            return "No valid mission available"
        navigation = [item for item in items if is_navigation(item)]
        if not navigation or (is_landed and navigation[0].command not in TAKEOFFS):
            return "Mission rejected: takeoff missing"
        home = self._context.place.home_enu_m
        for seq, item in enumerate(items):
            if item.command not in FLOWN_TO or not item.has_place:
                continue
            x, y, z = self._context.place.item_enu(item, home)
            if z < home[2] - 1e-3:
                return f"Mission rejected: waypoint {seq} below home"
            if self._context.is_forbidden((x, y, z)):
                return f"Geofence violation for waypoint {seq}"
        first = next((item for item in navigation if item.command in FLOWN_TO and item.has_place), None)
        if first is not None:
            x, y, _ = self._context.place.item_enu(first, home)
            away_m, most_m = math.hypot(x - home[0], y - home[1]), self._context.parameters["MIS_DIST_1WP"]
            if away_m > most_m > 0.0:
                return f"First waypoint too far away: {away_m:.0f}m, {most_m:.0f}m max"
        return None

    def arming_refusal(self) -> str | None:
        """Nothing: what is not feasible is not flown, in its own mode."""
        return None

    def start(self) -> None:
        """Begin, or go on with the item that was under way."""
        if self.state is MissionState.ENDED:
            self.reset()
        self.state = MissionState.RUNNING
        self._revision = self._context.store.revision
        self._begin(self.current)

    def set_current(self, seq: int) -> bool:
        """Go on with an item."""
        if not 0 <= seq < len(self._context.store):
            return False
        self.current, self._runner, self.has_landed = seq, None, False
        if self.state is MissionState.RUNNING:
            self._begin(seq)
        else:
            self.state = MissionState.READY
        return True

    def reset(self) -> None:
        """Back to the start."""
        self.state, self.current, self._runner, self.has_landed = MissionState.READY, 0, None, False
        self._jumps = {}

    def update(self) -> bool:
        """One control step; True once the mission has ended."""
        if self._context.store.revision != self._revision:
            self._take_up_new_mission()
        return super().update()

    def _take_up_new_mission(self) -> None:
        self._revision = self._context.store.revision
        self._jumps = {}
        refusal = self.refusal(is_landed=False)
        if refusal is None:
            self._begin(0)
            return
        self._context.say(mavlink.MAV_SEVERITY_CRITICAL, refusal)
        self._context.guidance.stop()
        self.state, self.current = MissionState.ENDED, 0

    def _begin(self, seq: int) -> None:
        item = self._context.store.item(seq)
        for _ in range(MAX_ITEMS_IN_A_TICK):
            if item is None or item.command != mavlink.MAV_CMD_DO_JUMP:
                break
            seq = self._jump(seq, item)
            item = self._context.store.item(seq)
        if item is None:
            self.state, self._runner = MissionState.ENDED, None
            return
        self.current = seq
        self._runner = StepRunner(self._steps(seq, item), self._context.guidance)

    def _jump(self, seq: int, item: StoredItem) -> int:
        """Item after a DO_JUMP: param 1 where to, param 2 how often."""
        done = self._jumps.get(seq, 0)
        if done >= item.param2 or not 0 <= item.param1 < len(self._context.store):
            return seq + 1
        self._jumps[seq] = done + 1
        return int(item.param1)

    def _steps(self, seq: int, item: StoredItem) -> list[Step]:
        guidance, manoeuvres = self._context.guidance, self._context.manoeuvres
        if not is_navigation(item):
            if item.command == mavlink.MAV_CMD_CONDITION_DELAY:
                return [Wait(item.param1)]
            self._context.actions.do(item)
            return []
        here_enu_m = guidance.here_enu_m
        goal_enu_m = self._context.place.item_enu(item, here_enu_m)
        match item.command:
            case command if command in TAKEOFFS:
                # Already in the air it does not sink to the take-off's height.
                return manoeuvres.take_off(max(goal_enu_m[2], here_enu_m[2]))
            case mavlink.MAV_CMD_NAV_LAND | mavlink.MAV_CMD_NAV_VTOL_LAND:
                return manoeuvres.land(goal_enu_m if item.has_place else None)
            case mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH:
                return manoeuvres.go_home()
            case mavlink.MAV_CMD_NAV_DELAY:
                return [Wait(max(0.0, item.param1))]
            case command if command in FLOWN_TO:
                return self._leg(seq, item, goal_enu_m)
        return []

    def _leg(self, seq: int, item: StoredItem, goal_enu_m: Vec3) -> list[Step]:
        guidance, values = self._context.guidance, self._context.parameters
        heading_rad = self._heading(item, goal_enu_m)
        if heading_rad is not None:
            guidance.face(heading_rad)
        is_waypoint = item.command == mavlink.MAV_CMD_NAV_WAYPOINT
        stay_s = math.inf if item.command == mavlink.MAV_CMD_NAV_LOITER_UNLIM else item.param1
        if item.command == mavlink.MAV_CMD_NAV_LOITER_TO_ALT or not stay_s > 0.0:
            stay_s = 0.0
        radius_m = item.param2 if is_waypoint and item.param2 > 0.0 else values["NAV_ACC_RAD"]
        following = self._context.store.item(seq + 1)
        passes = stay_s == 0.0 and following is not None and following.command in FLOWN_TO
        # Only a heading that the item itself asks for is waited for.
        waited_rad = heading_rad if is_waypoint and math.isfinite(item.param4) else None
        soonest_s = self._leg_s(goal_enu_m, radius_m) if stay_s > 0.0 else 0.0
        reach = Reach(goal_enu_m, radius_m, values["NAV_MC_ALT_RAD"], soonest_s, passes)
        return [reach, Stay(stay_s, waited_rad, values["MIS_YAW_ERR"] * DEG)]

    def _leg_s(self, goal_enu_m: Vec3, radius_m: float) -> float:
        """Time that PX4 takes for a leg from here."""
        guidance, values = self._context.guidance, self._context.parameters
        limits = MotionLimits(
            guidance.horizontal_m_s,
            guidance.ascent_m_s,
            guidance.descent_m_s,
            values["MPC_ACC_HOR"],
            guidance.yaw_rate_rad_s,
            guidance.yaw_rate_rad_s,
            values["MPC_JERK_AUTO"],
        )
        return float(px4_legs_s(np.array([np.subtract(goal_enu_m, guidance.here_enu_m)]), limits, radius_m)[0])

    def _heading(self, item: StoredItem, goal_enu_m: Vec3) -> float | None:
        """Heading on the leg: the item's own, else the course; None leaves it, as looking at a place does."""
        if item.command == mavlink.MAV_CMD_NAV_WAYPOINT and math.isfinite(item.param4):
            return item.param4 * DEG
        guidance = self._context.guidance
        (x, y, _), (gx, gy, _) = guidance.here_enu_m, goal_enu_m
        if guidance.look_at_enu_m is not None or math.hypot(gx - x, gy - y) <= SHORT_LEG_M:
            return None
        return math.atan2(gx - x, gy - y)
