"""Take-off, return and landing as each autopilot flies them, made of steps."""

from __future__ import annotations

from dataclasses import dataclass

from missions.mavlink.autopilots import Autopilot
from missions.simulator.autopilot.guidance import Guidance
from missions.simulator.autopilot.parameters import ParameterTable
from missions.simulator.autopilot.place import Place
from missions.simulator.autopilot.returning import Returning
from missions.simulator.autopilot.steps import Sink, Step, TouchDown, Wait, climb, climb_at_least, fly_level
from planning.geo.frames import Vec3

CM = 0.01


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
