"""Fly-aways: aircraft that leave their path at full speed, are stopped by the pilot, and where they come down.

Each begins at a random place of the plan's paths, at full speed through the air in a random direction, level or
climbing (one that descends comes down nearer), in the stated wind from a random side. Then one of three things happens:

- the pilot brakes one reaction time after it has left the flight geography; it must come to rest inside the contingency
  volume,
- the pilot switches the motors off at that moment, or
- nothing stops it until it leaves the contingency volume, where its motors go off.

What falls has no drag, or as much as it can have. All this is flown by the simulator's airframe.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from missions.simulator.airframe.multirotor import GRAVITY_M_S2, Multirotor
from missions.simulator.airframe.state import ExactReceiver, Fix, Parts, RateGimbal, SteadyPack, Target
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Vec3
from planning.insight.ground_risk import GroundRisk
from planning.motion.timing import MotionLimits
from planning.plan import Plan

if TYPE_CHECKING:
    from shapely import Polygon

Floats = NDArray[np.float64]


class Ending(Enum):
    """How a fly-away ends."""

    BRAKED = "braked"
    SWITCHED_OFF = "switched off"
    AT_THE_BORDER = "at the border"


@dataclass(frozen=True, slots=True, eq=False)
class FlyAways:
    """What n fly-aways came to.

    Parameters
    ----------
    endings
        How each ended.
    starts_enu_m, ends_enu_m
        Where it left its path, and where it came to rest, in the air or on the ground; shape (n, 3).
    margins_m
        How far inside what has to hold it it ended: its middle in the contingency volume where it was braked, the
        aircraft as wide as it is in the ground-risk buffer where it fell; negative outside. Shape (n,).
    reach_m
        How far it fell over the ground, from where the motors went off; 0 where it was braked. Shape (n,).
    """

    endings: tuple[Ending, ...]
    starts_enu_m: Floats
    ends_enu_m: Floats
    margins_m: Floats
    reach_m: Floats

    @property
    def share_inside(self) -> float:
        """Of all; 1 where every one stayed inside."""
        return float(np.mean(self.margins_m >= 0.0)) if len(self.margins_m) else 1.0


class SteadyAir:
    """Wind that blows evenly and that the speeds asked for already hold: see `airframe.state.Air`."""

    offset_enu_m: Vec3 = (0.0, 0.0, 0.0)
    offset_velocity_enu_m_s: Vec3 = (0.0, 0.0, 0.0)

    def __init__(self, wind_enu_m_s: Vec3) -> None:
        self.wind_enu_m_s = wind_enu_m_s

    def ground_speed_m_s(self, course_enu: Vec3, wanted_m_s: float) -> float:
        """As wanted."""
        return wanted_m_s

    def drag_enu_m_s2(self, velocity_enu_m_s: Vec3) -> Vec3:
        """None that would tilt it."""
        return 0.0, 0.0, 0.0

    def step(self, duration_s: float, *, flies: bool) -> None:
        """Nothing changes."""


def simulate_fly_aways(
    plan: Plan, risk: GroundRisk, n: int, seed: int = 0, monitor: Monitor = QUIET, buffer: Polygon | None = None
) -> FlyAways:
    """Let an aircraft fly away n times.

    Parameters
    ----------
    buffer
        The area that has to hold what falls; None: that of `risk`.
    """
    import shapely

    rng = np.random.default_rng(seed)
    starts = _starts(plan, n, rng)
    buffer = risk.buffer if buffer is None else buffer
    endings, ends, reach = [], np.empty((n, 3)), np.zeros(n)
    for i in range(n):
        monitor.report(say("fly-aways"), i, n)
        ending = list(Ending)[i % len(Ending)]
        flight = _Flight(risk, starts[i], rng)
        ends[i], reach[i] = flight.fly(ending)
        endings.append(ending)
    points = shapely.points(ends[:, :2])
    half_m = 0.5 * risk.value_of("CD")
    margins = np.empty(n)
    for area, is_braked in ((risk.contingency, True), (buffer, False)):
        own = np.array([(ending is Ending.BRAKED) is is_braked for ending in endings], bool)
        away = shapely.distance(points[own], shapely.boundary(area))
        inside_m = np.where(shapely.covers(area, points[own]), away, -away)
        below_m = risk.ground_z_m + risk.contingency_top_m - ends[own, 2]
        margins[own] = np.minimum(inside_m, below_m) if is_braked else inside_m - half_m
    return FlyAways(tuple(endings), starts, ends, margins, reach)


def _starts(plan: Plan, n: int, rng: np.random.Generator) -> Floats:
    """Places on the paths, as likely as a metre of path is; shape (n, 3)."""
    legs = []
    for sortie in plan.sorties:
        path = np.array(sortie.path_enu_m, np.float64).reshape(-1, 3)
        legs += [np.stack([path[:-1], path[1:]], axis=1)] if len(path) > 1 else [np.stack([path, path], axis=1)]
    ends = np.concatenate(legs)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    share = lengths / lengths.sum() if lengths.sum() > 0.0 else np.full(len(lengths), 1.0 / len(lengths))
    leg = ends[rng.choice(len(ends), n, p=share)]
    along = rng.random((n, 1))
    return np.asarray(leg[:, 0] + along * (leg[:, 1] - leg[:, 0]))


TERRAIN_STEP_S = 0.1
"""Between two looks at the terrain below what falls: it goes on by some 3 m, and evenly."""


class _Flight:
    """One fly-away: draws its course and wind, and flies."""

    def __init__(self, risk: GroundRisk, start_enu_m: Floats, rng: np.random.Generator) -> None:
        value = risk.value_of
        self._risk, self._start = risk, start_enu_m
        course, wind = rng.uniform(-math.pi, math.pi, 2)
        if rng.random() < 0.5:
            course = wind
        climb = rng.uniform(0.0, value("c"))
        speed, wind_m_s = value("v"), value("w")
        self._wind: Vec3 = (wind_m_s * math.cos(wind), wind_m_s * math.sin(wind), 0.0)
        self._velocity: Vec3 = (
            speed * math.cos(course) + self._wind[0],
            speed * math.sin(course) + self._wind[1],
            float(climb),
        )
        drag_per_m = value("k") if rng.random() < 0.5 else 0.0
        level_m_s = math.hypot(*self._velocity[:2])
        parts = Parts(RateGimbal(1.0), SteadyPack(1.0, 1.0, 1e9), ExactReceiver(Fix(3, 12, 1.0, 1.0)))
        parts = Parts(parts.gimbal, parts.pack, parts.receiver, air=SteadyAir(self._wind), fall_drag_per_m=drag_per_m)
        # Tilt brakes the level speed, thrust the climb; the airframe's limit is for both together.
        tilted_m_s2, speed_m_s = GRAVITY_M_S2 * math.tan(math.radians(value("θ"))), math.hypot(*self._velocity)
        brake_m_s2 = min(tilted_m_s2 * speed_m_s / max(level_m_s, 1e-3), tilted_m_s2 + GRAVITY_M_S2)
        self._limits = MotionLimits(
            max(level_m_s, 1e-3), max(abs(climb), 1e-3), max(abs(climb), 1e-3), brake_m_s2, 1.0, 1.0
        )
        x, y, z = (float(each) for each in start_enu_m)
        self._airframe = Multirotor(
            self._limits, (0.0, 0.0), (x, y, z), parts,
            velocity_enu_m_s=self._velocity, ground_z_m=risk.ground_z_m,
        )  # fmt: skip

    def fly(self, ending: Ending) -> tuple[Vec3, float]:
        """Where it ends, and how far it fell over the ground."""
        risk = self._risk
        leaves_s = self._leaves_s(risk.geography, risk.geography_top_m)
        border_s = self._leaves_s(risk.contingency, risk.contingency_top_m)
        acts_s = leaves_s + risk.value_of("t_R")
        self._go(border_s if ending is Ending.AT_THE_BORDER else min(acts_s, border_s))
        here = self._airframe.truth.position_enu_m
        if ending is Ending.BRAKED:
            stops_s = math.hypot(*self._velocity) / self._limits.acceleration_m_s2
            self._airframe.step(stops_s, self._target(here))
            return self._airframe.truth.position_enu_m, 0.0
        off = self._target(here, motors_on=False)
        place = self._fallen(off)
        return place, math.hypot(place[0] - here[0], place[1] - here[1])

    def _fallen(self, off: Target) -> Vec3:
        """Where it comes down: on the terrain where that is known, else on the lowest ground."""
        truth, ground = self._airframe.truth, self._risk.ground
        step_s = 1.0 if ground.terrain is None else TERRAIN_STEP_S
        before, above_m = truth.position_enu_m, math.inf
        while self._airframe.truth.velocity_enu_m_s != (0.0, 0.0, 0.0):
            self._airframe.step(step_s, off)
            here = self._airframe.truth.position_enu_m
            if ground.terrain is not None:
                now_m = here[2] - float(ground.terrain.lower.heights_m(np.array([here]))[0])
                if now_m <= 0.0:
                    share = above_m / (above_m - now_m) if math.isfinite(above_m) else 0.0
                    x, y, z = (a + share * (b - a) for a, b in zip(before, here, strict=True))
                    return x, y, z
                above_m = now_m if math.isfinite(now_m) else math.inf
            before = here
        return self._airframe.truth.position_enu_m

    def _go(self, duration_s: float) -> None:
        """On along the course at full speed."""
        far = duration_s + 1e3
        x, y, z = (p + far * v for p, v in zip(self._start.tolist(), self._velocity, strict=True))
        self._airframe.step(duration_s, self._target((x, y, z)))

    def _target(self, place: Vec3, *, motors_on: bool = True) -> Target:
        limits = self._limits
        speeds = limits.horizontal_m_s, limits.ascent_m_s, limits.descent_m_s
        return Target(place, *speeds, 0.0, 0.0, 0.0, motors_on=motors_on)

    def _leaves_s(self, area: Polygon, top_m: float) -> float:
        """When it is out of an area or above its top, at the latest."""
        import shapely

        x, y, z = self._start.tolist()
        vx, vy, vz = self._velocity
        above_m = self._risk.ground_z_m + top_m - z
        level_m_s = math.hypot(vx, vy)
        found = max(0.0, above_m) / vz if vz > 0.0 else math.inf
        if level_m_s > 0.0:
            low, high = np.array(area.bounds).reshape(2, 2)
            far_s = 2.0 * float(np.linalg.norm(high - low)) / level_m_s
            ray = shapely.linestrings([(x, y), (x + far_s * vx, y + far_s * vy)])
            crossing = shapely.intersection(ray, shapely.boundary(area))
            if not shapely.is_empty(crossing):
                found = min(found, shapely.distance(shapely.points(x, y), crossing) / level_m_s)
        return float(found)
