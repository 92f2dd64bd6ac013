"""Take-off, return and landing as each autopilot flies them, made of steps."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from missions.mavlink.autopilots import Autopilot
from missions.simulator.autopilot.guidance import Guidance, Place
from missions.simulator.autopilot.mission_store import MissionStore
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.steps import Sink, Step, TouchDown, Wait, climb, climb_at_least, fly_level
from planning.geo.frames import Vec3

CM = 0.01


# Where the vehicle returns to, and how high: home, or the nearest of its rally points, by its parameters.
#
# ArduPilot (AP_Rally, and `compute_return_target` of Copter's RTL): the nearest rally point, seen from above, of those
# that the fence allows; none where it is farther than RALLY_LIMIT_KM; home instead where that is nearer and
# RALLY_INCL_HOME says so. It climbs to RTL_ALT, or the rally point's height where that is more, but close to its
# destination no higher than RTL_CONE_SLOPE times the way that is left. PX4 (parameter reference): RTL_TYPE 0 and 3 take
# the nearest of home and rally points, 1 and 5 rally points where there are any, 2 and 4 none; RTL_RETURN_ALT counts
# from the destination. Landings of missions and ways back along them are not simulated.

NEAREST, RALLY_FIRST = (0, 3), (1, 5)
"""Values of RTL_TYPE."""


@dataclass(frozen=True, slots=True)
class ReturnGoal:
    """Where to land (on the ground), and the height to climb to first where the vehicle is lower; ENU, metres."""

    place_enu_m: Vec3
    height_z_m: float


@dataclass(frozen=True, slots=True)
class Returning:
    """Chooses, from the parameters and rally points as they stand.

    Parameters
    ----------
    is_forbidden
        Whether the fence forbids a place.
    """

    autopilot: Autopilot
    parameters: ParameterTable
    place: Place
    rally: MissionStore
    is_forbidden: Callable[[Vec3], bool]

    def goal(self, here_enu_m: Vec3) -> ReturnGoal:
        """Where a vehicle here returns to."""
        points = [self.place.enu(item.x, item.y, item.z, item.frame) for item in self.rally.items]
        home = self.place.home_enu_m
        if self.autopilot is Autopilot.ARDUPILOT:
            return self._ardupilot(here_enu_m, home, points)
        kind = int(self.parameters["RTL_TYPE"])
        places = [home, *points] if kind in NEAREST else points if kind in RALLY_FIRST and points else [home]
        chosen = min(places, key=lambda point: _away_m(here_enu_m, point))
        return ReturnGoal(chosen, chosen[2] + self.parameters["RTL_RETURN_ALT"])

    def _ardupilot(self, here: Vec3, home: Vec3, points: list[Vec3]) -> ReturnGoal:
        values, chosen = self.parameters, home
        allowed = [point for point in points if not self.is_forbidden(point)]
        if allowed:
            nearest = min(allowed, key=lambda point: _away_m(here, point))
            limit_m = 1000.0 * values["RALLY_LIMIT_KM"]
            is_near = limit_m <= 0.0 or _away_m(here, nearest) <= limit_m
            if is_near and (not values["RALLY_INCL_HOME"] or _away_m(here, nearest) < _away_m(here, home)):
                chosen = nearest
        height_z_m = max(home[2] + values["RTL_ALT"] * CM, chosen[2])
        slope = values["RTL_CONE_SLOPE"]
        if slope > 0.0:
            height_z_m = min(height_z_m, home[2] + slope * _away_m(here, chosen))
        return ReturnGoal(chosen, height_z_m)


def _away_m(here: Vec3, there: Vec3) -> float:
    """Distance seen from above."""
    return math.dist(here[:2], there[:2])


@dataclass(frozen=True, slots=True)
class Manoeuvres:
    """Builds the steps from the parameters as they stand."""

    autopilot: Autopilot
    parameters: ParameterTable
    place: Place
    guidance: Guidance
    returning: Returning

    def take_off(self, top_z_m: float) -> list[Step]:
        """Climb straight up."""
        return [climb(top_z_m)]

    def land(self, at_enu_m: Vec3 | None = None) -> list[Step]:
        """Land here, or fly level to above a place first."""
        values, ground_z_m = self.parameters, self.place.home_enu_m[2]
        if self.autopilot is Autopilot.ARDUPILOT:
            fast_m_s, slow_m_s = self.guidance.descent_m_s, values["LAND_SPEED"] * CM
            slow_from_m = values["LAND_ALT_LOW"] * CM
        else:
            fast_m_s, slow_m_s = values["MPC_Z_V_AUTO_DN"], values["MPC_LAND_SPEED"]
            slow_from_m = values["MPC_LAND_ALT2"]
        there: list[Step] = [] if at_enu_m is None else [fly_level(at_enu_m)]
        return [*there, Sink(ground_z_m + slow_from_m, fast_m_s), TouchDown(ground_z_m, slow_m_s)]

    def go_home(self) -> list[Step]:
        """Climb to the return height, fly home or to a rally point, land."""
        values, goal = self.parameters, self.returning.goal(self.guidance.here_enu_m)
        if self.autopilot is Autopilot.ARDUPILOT:
            wait: list[Step] = [Wait(values["RTL_LOIT_TIME"] / 1000.0)]
        else:
            lower_z_m = goal.place_enu_m[2] + values["RTL_DESCEND_ALT"]
            wait = [climb(lower_z_m), Wait(max(0.0, values["RTL_LAND_DELAY"]))]
        return [climb_at_least(goal.height_z_m), fly_level(goal.place_enu_m), *wait, *self.land()]
