"""Wind and gusts: the aircraft is pushed off the place that it holds, leans into the wind and loses ground speed."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from missions.simulator.effects.facts import WindFacts, effect_facts
from missions.simulator.effects.noise import covariance_root
from missions.simulator.scene import FlightScene
from planning.base.effects import Assessment
from planning.base.errors import InfeasibleError
from planning.base.messages import say
from planning.geo.frames import Vec3

Floats = NDArray[np.float64]

FEET_PER_M = 3.28084
GRAVITY_M_S2 = 9.80665

MIN_HEIGHT_M, MAX_HEIGHT_M = 3.0, 304.8
"""The low-altitude model ends at 1000 ft; near the ground its vertical scale, the height, goes to zero."""

COST_PER_STEP_S = 5e-6

CALM_M_S = 1e-9


def gust_sigma_m_s(wind_m_s: float, height_m: float) -> Vec3:
    """1 sigma of the gusts on the two horizontal axes and the vertical one.

    MIL-F-8785C, section 3.7.3.4, low altitude: s_w = 0.1 W20, s_u = s_v = s_w / (0.177 + 0.000823 h)^0.4, h in feet,
    W20 the wind at 20 ft.
    """
    height_ft = FEET_PER_M * min(max(height_m, MIN_HEIGHT_M), MAX_HEIGHT_M)
    vertical = 0.1 * wind_m_s
    level = vertical / (0.177 + 0.000823 * height_ft) ** 0.4
    return level, level, vertical


def gust_scale_m(height_m: float) -> Vec3:
    """Length scale of the gusts, horizontal axes and vertical.

    MIL-F-8785C, section 3.7.3.4: L_w = h, L_u = L_v = h / (0.177 + 0.000823 h)^1.2, all in feet.
    """
    height_ft = FEET_PER_M * min(max(height_m, MIN_HEIGHT_M), MAX_HEIGHT_M)
    level = height_ft / (0.177 + 0.000823 * height_ft) ** 1.2 / FEET_PER_M
    return level, level, height_ft / FEET_PER_M


def highest_airspeed_m_s(facts: WindFacts) -> float:
    """Airspeed at which the drag c v takes all the level thrust of the largest tilt: g tan(tilt) / c."""
    return GRAVITY_M_S2 * math.tan(math.radians(facts.tilt_deg)) / facts.drag_per_s


class GustResponse:
    """A gust on each axis and how the position control answers it: a linear system driven by white noise.

    State (g, x, v, i): gust, offset, its velocity, and the control's integral. With gains P, V, I and the drag c

        g' = -g / T + s sqrt(2 / T) w,   x' = v,   v' = c g - V (P x + v) - I i,   i' = P x + v.

    T = L / W: the scale of the gusts, carried past by the wind. The spectrum is Dryden's longitudinal one on all
    three axes; the lateral ones of MIL-F-8785C have a second-order filter and the same variance.
    """

    def __init__(self, facts: WindFacts, wind_m_s: float, height_m: float) -> None:
        self.sigma_m_s = gust_sigma_m_s(wind_m_s, height_m)
        p, v, i = facts.position_per_s, facts.velocity_per_s, facts.velocity_integral_per_s2
        control = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-v * p, -v, -i], [p, 1.0, 0.0]])
        self.dynamics = np.zeros((3, 4, 4))
        self.noise = np.zeros((3, 4, 4))
        for axis, (sigma, scale_m) in enumerate(zip(self.sigma_m_s, gust_scale_m(height_m), strict=True)):
            time_s = scale_m / wind_m_s
            self.dynamics[axis, 0, 0] = -1.0 / time_s
            self.dynamics[axis, 1, 2] = 1.0
            self.dynamics[axis, 2] = facts.drag_per_s, *control[2]
            self.dynamics[axis, 3, 1:] = control[3]
            self.noise[axis, 0, 0] = 2.0 * sigma**2 / time_s

    def spread(self) -> Floats:
        """Covariance of the state in the long run, shape (3, 4, 4): A C + C A^T + Q = 0."""
        from scipy.linalg import solve_continuous_lyapunov

        solved = [solve_continuous_lyapunov(a, -q) for a, q in zip(self.dynamics, self.noise, strict=True)]
        return np.array(solved)

    def over(self, duration_s: float) -> tuple[Floats, Floats]:
        """Transition over a time, and a root of the covariance that is added; shape (3, 4, 4) each.

        Van Loan (1978, Computing integrals involving the matrix exponential): both stand in the exponential
        of [[-A, Q], [0, A^T]].
        """
        from scipy.linalg import expm

        blocks = np.zeros((3, 8, 8))
        blocks[:, :4, :4], blocks[:, :4, 4:] = -self.dynamics, self.noise
        blocks[:, 4:, 4:] = np.swapaxes(self.dynamics, 1, 2)
        found = np.asarray(expm(blocks * duration_s))
        transition = np.swapaxes(found[:, 4:, 4:], 1, 2)
        covariance = transition @ found[:, :4, 4:]
        covariance = 0.5 * (covariance + np.swapaxes(covariance, 1, 2))
        return transition, np.array([covariance_root(one) for one in covariance])


LONG_STEP_S = 1.0
"""Longer steps are cut: the exponential of Van Loan's matrix holds exp(+t) and would lose its digits."""


class GustyAir:
    """The part of the aircraft: see `missions.simulator.airframe.state.Air`.

    Parameters
    ----------
    wind_enu_m_s
        Mean wind, level.

    Raises
    ------
    InfeasibleError
        The wind is stronger than the aircraft can lean against.
    """

    def __init__(self, wind_enu_m_s: Vec3, height_m: float, facts: WindFacts, rng: np.random.Generator) -> None:
        speed, most = math.hypot(*wind_enu_m_s), highest_airspeed_m_s(facts)
        if not speed < most:
            raise InfeasibleError.say(
                "wind of {:g} m/s carries the aircraft away, which leans {:g} deg at most and so flies {:.1f} "
                "m/s through the air; wait for less wind",
                speed,
                facts.tilt_deg,
                most,
            )
        self._mean, self._airspeed_m_s, self._drag_per_s = wind_enu_m_s, most, facts.drag_per_s
        self._rng = rng
        self._response = GustResponse(facts, max(speed, CALM_M_S), height_m)
        self._state = np.zeros((3, 4))
        self._state[:, 0] = rng.standard_normal(3) * self._response.sigma_m_s
        self._duration_s = -1.0
        self._transition = self._root = np.zeros((3, 4, 4))
        self._read()

    def _read(self) -> None:
        rows = self._state.tolist()
        (mx, my, mz), (gx, gy, gz) = self._mean, (row[0] for row in rows)
        self.wind_enu_m_s: Vec3 = (mx + gx, my + gy, mz + gz)
        self.offset_enu_m: Vec3 = (rows[0][1], rows[1][1], rows[2][1])
        self.offset_velocity_enu_m_s: Vec3 = (rows[0][2], rows[1][2], rows[2][2])

    def ground_speed_m_s(self, course_enu: Vec3, wanted_m_s: float) -> float:
        """Highest s <= wanted with |s u - w| within the airspeed, for the mean wind w and the course u."""
        length = math.hypot(course_enu[0], course_enu[1])
        along = (self._mean[0] * course_enu[0] + self._mean[1] * course_enu[1]) / length
        across2 = self._mean[0] ** 2 + self._mean[1] ** 2 - along * along
        return min(wanted_m_s, along + math.sqrt(self._airspeed_m_s**2 - max(0.0, across2)))

    def drag_enu_m_s2(self, velocity_enu_m_s: Vec3) -> Vec3:
        """Acceleration by the air at a velocity over the ground."""
        (vx, vy, vz), (wx, wy, wz), c = velocity_enu_m_s, self.wind_enu_m_s, self._drag_per_s
        return c * (wx - vx), c * (wy - vy), c * (wz - vz)

    def step(self, duration_s: float, *, flies: bool) -> None:
        """Blow on for a time."""
        n = max(1, math.ceil(duration_s / LONG_STEP_S))
        if duration_s / n != self._duration_s:
            self._duration_s = duration_s / n
            self._transition, self._root = self._response.over(self._duration_s)
        for _ in range(n):
            shock = self._root @ self._rng.standard_normal((3, 4, 1))
            self._state = (self._transition @ self._state[:, :, None] + shock)[:, :, 0]
        if not flies:
            self._state[:, 1:] = 0.0
        self._read()


class Wind:
    """The effect: how far gusts push the aircraft off at the shutter."""

    name = "wind"
    unit = say("m at the shutter")
    tolerance = 0.05
    """A tenth of the 0.5 m by which a photo may be off its viewpoint."""

    def assess(self, scene: FlightScene) -> Assessment:
        """Root mean square of the offset in the long run, all three axes."""
        wind_m_s = scene.conditions.wind_m_s
        if wind_m_s == 0.0:
            return Assessment(0.0, say("no wind is expected"), 0.0)
        spread = GustResponse(effect_facts().wind, wind_m_s, scene.height_m).spread()
        sigma = gust_sigma_m_s(wind_m_s, scene.height_m)[0]
        reason = say("wind of {:g} m/s with gusts of {:.1f} m/s (1 sigma) at {:.0f} m", wind_m_s, sigma, scene.height_m)
        return Assessment(math.sqrt(float(spread[:, 1, 1].sum())), reason, scene.n_steps * COST_PER_STEP_S)
