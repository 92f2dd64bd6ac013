"""What effects look at: one sortie of a plan on its site, and the conditions it is flown in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from missions.simulator.conditions import Conditions
from planning.geo.bvh import build_bvh, nearest_d2
from planning.motion.timing import photo_stop_s
from planning.parameters import FlightRules
from planning.plan import Aircraft, Camera, Plan, Sortie, viewpoint_arrays
from planning.site.records import SiteModel, panel_corners, panel_triangles, require_panels

Floats = NDArray[np.float64]

STEP_S = 0.02
"""Step for which the cost of effects is stated."""


@dataclass(frozen=True, slots=True, eq=False)
class FlightScene:
    """One flight, as far as effects ask.

    Parameters
    ----------
    duration_s, length_m
        Of the flight, as planned.
    views_enu_m, pitch_rad
        Shape (n, 3) and (n,): where photos are taken, and how the camera is pitched, in order.
    glass_distance_m
        Shape (n,), from each view to the nearest pane.
    """

    camera: Camera
    aircraft: Aircraft
    rules: FlightRules
    conditions: Conditions
    site_model: SiteModel
    duration_s: float
    length_m: float
    views_enu_m: Floats
    pitch_rad: Floats
    glass_distance_m: Floats

    @property
    def height_m(self) -> float:
        """Mean height of the views above the ground; 10 m without views."""
        if len(self.views_enu_m) == 0:
            return 10.0
        return max(1.0, float(self.views_enu_m[:, 2].mean()) - self.site_model.site.airspace.ground_z_m)

    @property
    def gsd_m(self) -> float:
        """Of the closest pane in any view, metres per pixel."""
        closest_m = float(self.glass_distance_m.min()) if len(self.glass_distance_m) else 10.0
        return self.camera.gsd_m(max(closest_m, 0.1))

    @property
    def cruise_m_s(self) -> float:
        """Mean speed between photos."""
        flying_s = self.duration_s - len(self.views_enu_m) * photo_stop_s(self.aircraft, self.rules)
        return min(self.aircraft.max_speed_m_s, self.length_m / max(flying_s, 1.0))

    @property
    def hover_share(self) -> float:
        """Share of the flight that is hovered for photos."""
        hovered_s = len(self.views_enu_m) * photo_stop_s(self.aircraft, self.rules)
        return min(1.0, hovered_s / self.duration_s) if self.duration_s > 0.0 else 0.0

    @property
    def n_steps(self) -> float:
        """Steps of the simulation, for stating costs."""
        return self.duration_s / STEP_S


def flight_scene(
    plan: Plan, site_model: SiteModel, conditions: Conditions, sortie: Sortie | None = None
) -> FlightScene:
    """Scene of one sortie, or of all of a plan.

    Raises
    ------
    InputError
        The site has no panels, so that there is no glass to photograph.
    """
    require_panels(site_model.site)
    wanted = set(sortie.viewpoint_ids) if sortie is not None else None
    views = viewpoint_arrays(tuple(v for v in plan.viewpoints if wanted is None or v.id in wanted))
    if sortie is not None and sortie.viewpoint_ids:
        order = {viewpoint_id: i for i, viewpoint_id in enumerate(sortie.viewpoint_ids)}
        by_id = {v.id: v for v in plan.viewpoints}
        views = viewpoint_arrays(tuple(by_id[viewpoint_id] for viewpoint_id in order))
    flown = plan.sorties if sortie is None else (sortie,)
    glass = build_bvh(panel_triangles(panel_corners(site_model.site)))
    distance_m = np.sqrt([nearest_d2(glass, position, math.inf) for position in views.positions_enu_m])
    return FlightScene(
        camera=plan.camera,
        aircraft=plan.aircraft,
        rules=plan.rules,
        conditions=conditions.with_shutter(plan.camera_settings.shutter_s),
        site_model=site_model,
        duration_s=sum(one.duration_s for one in flown),
        length_m=sum(one.length_m for one in flown),
        views_enu_m=views.positions_enu_m,
        pitch_rad=views.pitch_rad,
        glass_distance_m=np.asarray(distance_m, np.float64).reshape(-1),
    )
