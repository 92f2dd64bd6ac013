"""What lies below flights: the terrain where a site has one that its flights call for, else the level ground.

Heights above the ground are those of whole legs. Above level ground they are differences; above terrain they come from
its bounds, so that no height that the source states is nearer, and where nothing is known nothing is clear.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, decide
from planning.base.messages import say
from planning.geo.height_field import HeightField
from planning.site.terrain import Surfaces, Terrain, surfaces

if TYPE_CHECKING:
    from planning.site.records import Airspace, Site

Array = NDArray[np.float64]

LEGS_LOOKED_AT, LEG_S = 1_000_000, 1e-6
"""For the stated cost: legs that planning some hundred panels looks at, and what the terrain adds to one."""


class Relief:
    """The effect: how far the terrain below the airspace departs from its level ground, in metres.

    Barometers wander by a metre or two in a flight; a tenth of the least height usually kept is below that.
    """

    name = "terrain"
    unit = "m"
    tolerance = 0.5

    def assess(self, scene: Site) -> Assessment:
        """The largest departure of the bounds; all up to the ceiling where a part below the airspace is not known."""
        if scene.terrain is None:
            return Assessment(0.0, say("the site has no terrain"), 0.0)
        return _departure(scene.terrain, scene.airspace)


@lru_cache(maxsize=8)
def _departure(terrain: Terrain, airspace: Airspace) -> Assessment:
    found = surfaces(terrain)
    ends = airspace.min_enu_m, airspace.max_enu_m
    upper, lower = (field.part_m(*map(np.array, ends)) for field in (found.upper, found.lower))
    cost_s = LEGS_LOOKED_AT * LEG_S
    if np.isnan(upper).any():
        height_m = ends[1][2] - airspace.ground_z_m
        return Assessment(height_m, say("the terrain has no heights for a part below the airspace"), cost_s)
    size = float(max(upper.max() - airspace.ground_z_m, airspace.ground_z_m - lower.min()))
    reason = say("the terrain below the airspace departs from its level ground by up to {:.2f} m", size)
    return Assessment(size, reason, cost_s)


def decide_terrain(site: Site) -> Decision:
    """Whether flights on a site are held to its terrain, and why; `off` without terrain."""
    return decide(Relief(), site, "off" if site.terrain is None else site.terrain.use)


def terrain_text(decision: Decision) -> str:
    """What heights above the ground count from, and why, from the decision on a site's terrain."""
    if decision.on:
        return say("heights above the ground count from the terrain: {}", decision.reason)
    if decision.decided_by == "scene":
        return say("heights above the ground count from level ground: {}", decision.reason)
    return say(
        "the terrain of the site is not used, as you asked, though {}; heights count from level ground",
        decision.reason,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """The ground below a site's flights.

    Parameters
    ----------
    level_z_m
        Of the level ground, ENU z.
    terrain
        None where the ground counts as level.
    """

    level_z_m: float
    terrain: Surfaces | None = None

    def heights_m(self, points_enu_m: Array) -> Array:
        """Height of the ground itself, ENU z, below points of shape (n, 2) or (n, 3); NaN where it is not known."""
        if self.terrain is None:
            return np.full(len(points_enu_m), self.level_z_m)
        return self.terrain.ground.heights_m(points_enu_m)

    def upper_m(self, points_enu_m: Array) -> Array:
        """Upper bound of the ground at points, likewise."""
        return self.heights_m(points_enu_m) if self.terrain is None else self.terrain.upper.heights_m(points_enu_m)

    def least_m(self, a_enu_m: Array, b_enu_m: Array) -> Array:
        """Least height above the ground along legs, ends of shape (n, 3); minus infinity where it is not known."""
        if self.terrain is None:
            return np.minimum(a_enu_m[:, 2], b_enu_m[:, 2]) - self.level_z_m
        return self.terrain.upper.leg_heights_m(a_enu_m, b_enu_m)[0]

    def is_kept(self, a_enu_m: Array, b_enu_m: Array, height_m: float) -> NDArray[np.bool_]:
        """Whether `least_m` is at least a height."""
        if self.terrain is None:
            return self.least_m(a_enu_m, b_enu_m) >= height_m
        return self.terrain.upper.legs_keep(a_enu_m, b_enu_m, height_m)

    def greatest_m(self, a_enu_m: Array, b_enu_m: Array) -> Array:
        """Greatest height above the ground along legs, ends of shape (n, 3); infinity where it is not known."""
        if self.terrain is None:
            return np.maximum(a_enu_m[:, 2], b_enu_m[:, 2]) - self.level_z_m
        return self.terrain.lower.leg_heights_m(a_enu_m, b_enu_m)[1]

    def range_m(self, low_enu_m: Array, high_enu_m: Array) -> tuple[float, float]:
        """Lowest and highest upper bound below a box, as far as it is known; the level ground where nothing is."""
        if self.terrain is None:
            return self.level_z_m, self.level_z_m
        upper = self.terrain.upper.part_m(low_enu_m, high_enu_m)
        known = upper[np.isfinite(upper)]
        return (float(known.min()), float(known.max())) if len(known) else (self.level_z_m, self.level_z_m)


def ground_of(site: Site) -> Ground:
    """The ground that flights on a site are held to."""
    is_held = site.terrain is not None and decide_terrain(site).on
    return Ground(site.airspace.ground_z_m, surfaces(site.terrain) if is_held and site.terrain else None)


def drawn_terrain(site: Site) -> HeightField | None:
    """The terrain that things are put on and that views show; None where a site has none, or none in use."""
    return None if site.terrain is None or site.terrain.use == "off" else surfaces(site.terrain).ground


def height_at(site: Site, east_m: float, north_m: float) -> float:
    """Height of the ground at a place, ENU z, for what is put on it: the terrain's where known, else the level one."""
    terrain = drawn_terrain(site)
    if terrain is None:
        return site.airspace.ground_z_m
    found = float(terrain.heights_m(np.array([[east_m, north_m]]))[0])
    return site.airspace.ground_z_m if np.isnan(found) else found
