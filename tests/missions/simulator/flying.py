"""Flies sorties of small plans with an airframe alone, without an autopilot: what the tests of effects measure on."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from missions.simulator.airframe.multirotor import Multirotor
from missions.simulator.airframe.state import Pose, Target
from planning.aircraft.catalogue import profile
from planning.motion.timing import sortie_flight_path, stopping_duration_s
from planning.parameters import Constraints, FlightRules, GreedyParameters
from planning.plan import Coverage, Plan, Sortie, Viewpoint
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.records import SiteModel

GLASS_M = 11.0


@cache
def bundled(name: str, n_views: int = 10, settle_s: float = 2.0, profile_id: str = "m3e") -> tuple[SiteModel, Plan]:
    """A bundled site and a plan of views 11 m from panels of its first facade, up and down in turn."""
    model, chosen = SCENES[name](), profile(profile_id)
    facade = model.site.facades[0]
    rules, home = FlightRules(settle_s=settle_s), model.site.home_enu_m
    views = []
    for i, panel in enumerate(facade.panels[:: max(1, len(facade.panels) // n_views)][:n_views]):
        corners = np.array(panel.corners_enu_m)
        normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
        x, y, z = (corners.mean(axis=0) + GLASS_M * normal / np.linalg.norm(normal)).tolist()
        heading_deg = math.degrees(math.atan2(-normal[0], -normal[1]))
        views.append(Viewpoint(f"v{i:04d}", (x, y, max(z, 5.0)), heading_deg, (-25.0, 15.0)[i % 2]))
    top = (home[0], home[1], 40.0)
    path = (home, top, *(view.position_enu_m for view in views), top, home)
    length_m = sum(math.dist(a, b) for a, b in itertools.pairwise(path))
    sortie = Sortie(tuple(view.id for view in views), path, length_m, 0.0)
    flown = sortie_flight_path(sortie, {view.id: view for view in views}, chosen.aircraft, rules)
    assert flown is not None
    duration_s = stopping_duration_s(flown[0], chosen.aircraft, rules)
    plan = Plan(
        site=name,
        site_sha256="",
        method="greedy",
        seed=0,
        camera=chosen.camera,
        aircraft=chosen.aircraft,
        constraints=Constraints(),
        viewpoints=tuple(views),
        sorties=(replace(sortie, duration_s=duration_s),),
        coverage=Coverage(0, 0, 0),
        origin=model.site.origin,
        home_enu_m=home,
        rules=rules,
    )
    return model, plan


@cache
def planned(name: str, n_views: int) -> tuple[SiteModel, Plan]:
    """A bundled site with a plan as the program makes it."""
    model = SCENES[name]()
    few = GreedyParameters(n_candidates=400, improve=False, certify=False)
    return model, plan_flight(model, PlanRequest(n_views=n_views, greedy=few, time_budget_s=5.0)).plan


@dataclass(frozen=True)
class Shot:
    """A photo: its view, where the camera truly was, and for how long the shutter was open."""

    view: Viewpoint
    pose: Pose
    exposure_s: float

    @property
    def error_m(self) -> float:
        return math.dist(self.pose.position_enu_m, self.view.position_enu_m)

    @property
    def pitch_error_deg(self) -> float:
        return abs(math.degrees(self.pose.gimbal_pitch_rad) - self.view.gimbal_pitch_deg)


def fly(airframe: Multirotor, plan: Plan, sortie: Sortie, step_s: float = 0.1) -> tuple[list[Shot], float]:
    """Fly a sortie as its duration is computed: stop everywhere, turn at rest, settle, photo; shots and seconds.

    A photo is taken when the turns could be done and the settling time is over, whatever the camera does then.
    """
    by_id = {view.id: view for view in plan.viewpoints}
    planned = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules)
    assert planned is not None
    path, photo_vertices = planned
    view_of = dict(zip(photo_vertices.tolist(), (by_id[i] for i in sortie.viewpoint_ids), strict=True))
    aircraft, shots, flown_s = plan.aircraft, [], 0.0
    heading_rad = pitch_rad = 0.0
    yaw_rate = math.radians(aircraft.max_yaw_rate_deg_s)

    def target(position: tuple[float, float, float]) -> Target:
        return Target(
            position,
            aircraft.max_speed_m_s,
            aircraft.max_ascent_m_s,
            aircraft.max_descent_m_s,
            heading_rad,
            yaw_rate,
            pitch_rad,
        )

    for vertex, row in enumerate(path.vertices_enu_m.tolist()):
        goal = target((row[0], row[1], row[2]))
        # The believed place also holds what gusts do: arrived is where the wind alone could keep it off.
        near_m = 0.01 if airframe.wind_enu_m_s == (0.0, 0.0, 0.0) else 1.0
        for _ in range(100_000):
            if math.dist(airframe.estimate.position_enu_m, goal.position_enu_m) <= near_m:
                break
            airframe.step(step_s, goal)
            flown_s += step_s
        else:
            raise AssertionError(f"vertex {vertex} was never reached")
        if vertex in view_of:
            view = view_of[vertex]
            heading_rad, pitch_rad = math.radians(view.heading_deg), math.radians(view.gimbal_pitch_deg)
            # Steps of one length: the wind's are prepared for it.
            settled = math.ceil((float(path.hover_s[vertex]) - plan.rules.photo_s) / step_s - 1e-9)
            whole = settled + math.ceil(plan.rules.photo_s / step_s - 1e-9)
            for n in range(whole):
                if n == settled:
                    shots.append(Shot(view, *airframe.shutter()))
                airframe.step(step_s, target(goal.position_enu_m))
                flown_s += step_s
    return shots, flown_s


def rms(values: list[float]) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
