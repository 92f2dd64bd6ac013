"""Where an aircraft may be: the airspace box, minus what lies too close to panels, mesh, obstacles or no-fly zones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.site.ground import Ground, ground_of
from planning.site.records import Airspace, SiteModel, panel_corners, panel_triangles
from planning.site.zones.keep_out import near_zones, no_fly_volumes
from planning.site.zones.local import prisms
from planning.site.zones.records import RESTRICTIONS

Array = NDArray[np.float64]

SAFETY_MARGIN_M = 0.002
"""Kept on top of every distance where viewpoints are chosen."""

LEG_MARGIN_M = 0.001
"""Kept on top of every distance by legs, and by viewpoints once their coordinates are rounded to 0.1 mm: less than
where they are chosen, so that rounding grounds none, and enough for readers in float32 to find the distance kept."""

TAKEOFF_CLIMB_M = 2.0
"""Aircraft climb at least this far before they fly sideways, wherever the airspace begins."""


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """The allowed positions and straight legs of one site for one minimum distance.

    Parameters
    ----------
    low_enu_m, high_enu_m
        The airspace box, as far as it lies above the lowest height that flights keep, shape (3,).
    solids
        Panels, building and obstacles.
    no_fly
        No-fly volumes, those of geo-zones that count included.
    min_distance_m
        To be kept from `solids` everywhere.
    no_fly_distance_m
        To be kept from `no_fly`: the minimum distance, or less where home itself stands closer.
    home_enu_m
        Take-off and landing, shape (3,).
    ground
        What lies below.
    min_height_m
        To be kept above the terrain, where there is one; above level ground `low_enu_m` keeps it.
    """

    low_enu_m: Array
    high_enu_m: Array
    solids: Solids
    no_fly: Solids
    min_distance_m: float
    no_fly_distance_m: float
    home_enu_m: Array
    ground: Ground
    min_height_m: float | None = None

    @property
    def column_top_enu_m(self) -> Array:
        """Where sideways flight may begin: in the airspace, `TAKEOFF_CLIMB_M` or more above home; shape (3,)."""
        return self.column_top_above(self.home_enu_m)

    def column_top_above(self, foot_enu_m: Array) -> Array:
        """Where sideways flight may begin above a place to take off from or land at, both shape (3,)."""
        lowest = max(foot_enu_m[2] + TAKEOFF_CLIMB_M, self.low_enu_m[2] + SAFETY_MARGIN_M)
        if self._keeps_terrain:
            above = self.ground.upper_m(np.asarray(foot_enu_m)[None])[0] + self.min_height_m + SAFETY_MARGIN_M
            lowest = max(lowest, above) if np.isfinite(above) else np.inf  # where nothing is known, nothing is clear
        return np.array([*foot_enu_m[:2], lowest])

    def has_airspace_above(self, foot_enu_m: Array) -> bool:
        """Whether the airspace lies above a place to take off from or land at, shape (3,); its borders belong to it."""
        foot = np.asarray(foot_enu_m)
        inside = (foot[:2] >= self.low_enu_m[:2]).all() and (foot[:2] <= self.high_enu_m[:2]).all()
        return bool(inside and self.column_top_above(foot)[2] < self.high_enu_m[2])

    def is_allowed(self, points_enu_m: Array, margin_m: float = SAFETY_MARGIN_M) -> NDArray[np.bool_]:
        """Whether viewpoints may lie at points of shape (n, 3)."""
        points = np.asarray(points_enu_m, np.float64).reshape(-1, 3)
        low, high = self.low_enu_m + margin_m, self.high_enu_m - margin_m
        allowed = np.asarray(np.all((points >= low) & (points <= high), axis=1))
        allowed[allowed] = self.keeps_distances(points[allowed], margin_m)
        return allowed

    def keeps_distances(self, points_enu_m: Array, margin_m: float = SAFETY_MARGIN_M) -> NDArray[np.bool_]:
        """Whether points, shape (n, 3), keep every distance, wherever the airspace ends."""
        points = np.asarray(points_enu_m, np.float64)
        kept = self._keeps_height(points, points, margin_m)
        for solids, distance in self._kept_distances(margin_m):
            to_check = np.flatnonzero(kept)
            kept[to_check] = solids.clearance_m(points[to_check], 2.0 * distance) >= distance
        return kept

    def legs_clear(self, a_enu_m: Array, b_enu_m: Array) -> NDArray[np.bool_]:
        """Whether straight legs between allowed points, shape (n, 3), keep every distance on their whole length."""
        clear = self._keeps_height(a_enu_m, b_enu_m, LEG_MARGIN_M)
        for solids, distance in self._kept_distances(LEG_MARGIN_M):
            to_check = np.flatnonzero(clear)
            clear[to_check] = solids.segments_clear(a_enu_m[to_check], b_enu_m[to_check], distance)
        return clear

    @property
    def _keeps_terrain(self) -> bool:
        return self.min_height_m is not None and self.ground.terrain is not None

    def _keeps_height(self, a_enu_m: Array, b_enu_m: Array, margin_m: float) -> NDArray[np.bool_]:
        """Whether straight legs, ends of shape (n, 3), keep the least height above terrain; True above level ground."""
        if self.min_height_m is None or self.ground.terrain is None:
            return np.ones(len(a_enu_m), np.bool_)
        return self.ground.is_kept(a_enu_m, b_enu_m, self.min_height_m + margin_m)

    def _kept_distances(self, margin_m: float) -> tuple[tuple[Solids, float], ...]:
        kept: tuple[tuple[Solids, float], ...] = ((self.solids, self.min_distance_m + margin_m),)
        if len(self.no_fly.part):
            kept += ((self.no_fly, self.no_fly_distance_m + margin_m),)
        return kept


def unchecked_space(model: SiteModel, min_distance_m: float) -> FreeSpace:
    """Space of a site as it is, whether or not its home can be used, in the whole airspace: for measuring plans."""
    site = model.site
    low, high, home = (np.array(p) for p in (site.airspace.min_enu_m, site.airspace.max_enu_m, site.home_enu_m))
    return FreeSpace(low, high, *_bodies(model), min_distance_m, min_distance_m, home, ground_of(site))


@lru_cache(maxsize=2)  # what plans a flight, proves it and checks it asks for those of one site each time
def _bodies(model: SiteModel) -> tuple[Solids, Solids]:
    """What stands on a site, and its no-fly volumes."""
    meshes = join([model.building, *model.obstacles])
    stands = Solids.of(np.concatenate([panel_triangles(panel_corners(model.site)), meshes.corners_enu_m]))
    return stands, Solids.of(join([zone.prism() for zone in no_fly_volumes(model)]).corners_enu_m)


def free_space(model: SiteModel, min_distance_m: float, min_height_m: float | None = None) -> FreeSpace:
    """Allowed space of a site from whose home one can take off.

    Parameters
    ----------
    min_height_m
        Lowest height above the ground outside the column above home; None: the site's, or else the usual.

    Raises
    ------
    InfeasibleError
        Home, or the column above it, is outside the airspace, too close to something, inside a solid or in a no-fly
        volume; the message gives the measured distance, or names the geo-zone.
    """
    _check_zones(model)
    space = above_lowest_height(unchecked_space(model, min_distance_m), model.site.airspace, min_height_m)
    _check_home(space)
    home, top = space.home_enu_m[None], space.column_top_enu_m[None]
    from_column = float(space.no_fly.segment_distances_m(home, top, 2.0 * min_distance_m + 1.0)[0])
    kept = min(min_distance_m, max(0.0, from_column - 2.0 * SAFETY_MARGIN_M))
    return replace(space, no_fly_distance_m=kept)


def above_lowest_height(space: FreeSpace, airspace: Airspace, min_height_m: float | None = None) -> FreeSpace:
    """The part of a space that lies above the lowest height of flights; `min_height_m` is as in `free_space`.

    Raises
    ------
    InfeasibleError
        The airspace ends below it.
    """
    height_m = airspace.lowest_height_m(min_height_m)
    ground_z_m, _ = space.ground.range_m(space.low_enu_m, space.high_enu_m)
    lowest_z_m = ground_z_m + height_m
    if lowest_z_m >= space.high_enu_m[2]:
        raise InfeasibleError.say(
            "airspace: its ceiling lies {:g} m above the ground, and flights keep {:g} m from it; raise the "
            "ceiling, or allow lower flights",
            space.high_enu_m[2] - ground_z_m,
            height_m,
        )
    low = np.maximum(space.low_enu_m, [-np.inf, -np.inf, lowest_z_m])
    return replace(space, low_enu_m=low, min_height_m=height_m)


def _check_zones(model: SiteModel) -> None:
    """Refuse a home in a geo-zone by its name, since the pilot may have what it asks for."""
    if not model.site.zones:
        return
    import shapely

    x, y, z = model.site.home_enu_m
    for near in near_zones(model):
        if near.is_kept and any(
            prism.floor_m <= z + TAKEOFF_CLIMB_M
            and z <= prism.ceiling_m
            and shapely.Polygon(prism.polygon_enu_m).covers(shapely.Point(x, y))
            for prism in prisms(near.local, model.site.airspace)
        ):
            zone = near.local.zone
            raise InfeasibleError.say(
                "home {:m} lies inside the geo-zone '{}' ({}); move it outside, or state your authorisation (--permit)",
                _text(np.array([x, y, z])),
                zone.name,
                RESTRICTIONS[zone.restriction],
                place="home_enu_m",
            )


def _check_home(space: FreeSpace) -> None:
    home, top = space.home_enu_m, space.column_top_enu_m
    if np.isinf(top[2]):
        raise InfeasibleError.say(
            "home {:m} stands where the terrain has no heights; move home, or attach terrain that covers it",
            _text(home),
            place="home_enu_m",
        )
    if not space.has_airspace_above(home):
        raise InfeasibleError.say(
            "home {:m} is not below or inside the airspace box {:m} to {:m}; move home or widen the airspace",
            _text(home),
            _text(space.low_enu_m),
            _text(space.high_enu_m),
            place="home_enu_m",
        )
    # A home on the ground lies on the bottom face of the building it is in; a hand's breadth above it does not.
    places = home + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]])
    if (space.solids.clearance_m(places, 1.0) < 0).any():
        raise InfeasibleError.say(
            "home {:m} lies inside a building or obstacle; move it outside", _text(home), place="home_enu_m"
        )
    if (space.no_fly.clearance_m(places, 1.0) < 0).any():
        raise InfeasibleError.say(
            "home {:m} lies inside a no-fly volume; move it outside", _text(home), place="home_enu_m"
        )
    distance = space.solids.segment_distances_m(home[None], top[None], 10.0 * space.min_distance_m + 10.0)[0]
    if distance < space.min_distance_m + SAFETY_MARGIN_M:
        raise InfeasibleError.say(
            "the take-off column above home {:m} comes within {:.2f} m of the building or an obstacle, {:g} "
            "m are required; move home away",
            _text(home),
            distance,
            space.min_distance_m,
            place="home_enu_m",
        )
    if space.no_fly.segment_distances_m(home[None], top[None], 1.0)[0] <= 2.0 * SAFETY_MARGIN_M:
        raise InfeasibleError.say(
            "the take-off column above home {:m} crosses a no-fly volume", _text(home), place="home_enu_m"
        )


def _text(point: Array) -> str:
    return "(" + ", ".join(f"{value:g}" for value in point) + ")"
