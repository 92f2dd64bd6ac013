"""How aircraft return by themselves: the height, and the ways to home or to rally points, where they can be landed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import Vec3
from planning.geo.solids import Solids
from planning.site.free_space import SAFETY_MARGIN_M, FreeSpace
from planning.site.ground import height_at
from planning.site.records import RallyPoint, SiteModel

Array = NDArray[np.float64]

BELOW_GROUND_M = 0.01
"""Heights drawn by hand are rounded to 1 mm."""

CLEARANCE_M = 10.0
"""How far above the highest point of a site aircraft return, where the airspace leaves room for it."""

RETURN_TOLERANCE_M = 0.5
"""How much nearer than the minimum distance a return may come before it is spoken of: it is flown once, and slowly."""

SAMPLE_M = 2.0
"""Distance between the places of a path from which a return is looked at."""


def rally_findings(model: SiteModel, space: FreeSpace) -> Iterator[Finding]:
    """What keeps aircraft from landing at the rally points of a site; nothing where there are none.

    Each is held to what holds for home: inside the airspace seen from above, outside solids and no-fly volumes, and a
    column above it, up to the airspace, that keeps the minimum distance.
    """
    n_wrong = 0
    for point in model.site.rally_points:
        found = list(_findings(point, model, space))
        n_wrong += bool(found)
        yield from found
    if model.site.rally_points and not n_wrong:
        n_points = len(model.site.rally_points)
        yield Finding(Severity.OK, "rally-point", say("aircraft can land at the rally points ({})", n_points))


def _findings(point: RallyPoint, model: SiteModel, space: FreeSpace) -> Iterator[Finding]:
    place = f"rally/{point.id}"

    def error(text: str, value: float | None = None, limit: float | None = None) -> Finding:
        unit = "" if value is None else "m"
        return Finding(
            Severity.ERROR, "rally-point", say("rally point '{}' {}", point.id, text), place, value, limit, unit
        )

    foot = np.array(point.position_enu_m)
    top = space.column_top_above(foot)
    if not space.has_airspace_above(foot):
        yield error(say("is not below or inside the airspace; move it, or widen the airspace"))
        return
    # As with home: on the ground it lies on the bottom face of the building it is in.
    places = foot + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]])
    if (space.solids.clearance_m(places, 1.0) < 0).any():
        yield error(say("lies inside a building or obstacle; move it outside"))
        return
    if len(space.no_fly.part) and (
        (space.no_fly.clearance_m(places, 1.0) < 0).any()
        or space.no_fly.segment_distances_m(foot[None], top[None], 1.0)[0] <= 2.0 * SAFETY_MARGIN_M
    ):
        yield error(say("lies in a no-fly volume, or below one; move it outside"))
        return
    limit_m = space.min_distance_m
    gap_m = float(space.solids.segment_distances_m(foot[None], top[None], 10.0 * limit_m + 10.0)[0])
    if gap_m < limit_m:
        text = say(
            "has a landing column that comes within {:.2f} m of the building or an obstacle, {:g} m are "
            "required; move it away",
            gap_m,
            limit_m,
        )
        yield error(text, gap_m, limit_m)
    ground_m = height_at(model.site, float(foot[0]), float(foot[1]))
    if foot[2] < ground_m - BELOW_GROUND_M:
        yield Finding(
            Severity.WARNING,
            "rally-point",
            say(
                "rally point '{}' lies at {:g} m, below the ground at {:g} m; put it on the ground",
                point.id,
                foot[2],
                ground_m,
            ),
            place,
            float(foot[2]),
            ground_m,
            "m",
        )


@dataclass(frozen=True, slots=True)
class ReturnRoute:
    """How near aircraft come to things when they return from anywhere on a path.

    Parameters
    ----------
    gap_m
        Smallest distance to panels, building and obstacles; 0 where a way meets one. Up to the distance asked for.
    crosses_no_fly
        Whether a way enters a no-fly volume.
    n_elsewhere
        Of the places looked at, those from which the aircraft returns to another destination than the first.
    n_places
        Places looked at.
    above_ground_m
        Least height above the ground on the level parts of the ways; minus infinity where the ground is not known.
    """

    gap_m: float
    crosses_no_fly: bool
    n_elsewhere: int
    n_places: int
    above_ground_m: float


def return_route(
    space: FreeSpace,
    path_enu_m: Array,
    destinations_enu_m: tuple[Vec3, ...],
    height_z_m: float,
    cone_slope: float = 0.0,
    upper_m: float = 100.0,
) -> ReturnRoute:
    """Ways of return from anywhere on a path: straight up, level to the nearest destination, straight down.

    Parameters
    ----------
    path_enu_m
        Shape (k, 3).
    destinations_enu_m
        At least one; home first. The nearest seen from above counts.
    height_z_m
        Height to which the aircraft climbs first where it is lower.
    cone_slope
        Close to its destination it climbs no higher than so many times the way that is left; 0: always to the height.
    upper_m
        Distances beyond are not told apart.

    Raises
    ------
    ValueError
        There is no destination.
    """
    return _return_ways(space, [path_enu_m], destinations_enu_m, height_z_m, cone_slope, upper_m)[0]


def return_routes(space: FreeSpace, paths_enu_m: Sequence[Array]) -> list[ReturnRoute]:
    """Ways of return to home from anywhere on each path, shape (k, 3), at `return_height`."""
    if not paths_enu_m:
        return []
    x, y, z = space.home_enu_m.tolist()
    upper_m = 2.0 * space.min_distance_m + CLEARANCE_M
    return _return_ways(space, paths_enu_m, ((x, y, z),), return_height(space).z_m, 0.0, upper_m)


def _return_ways(
    space: FreeSpace,
    paths_enu_m: Sequence[Array],
    destinations_enu_m: tuple[Vec3, ...],
    height_z_m: float,
    cone_slope: float,
    upper_m: float,
) -> list[ReturnRoute]:
    if not destinations_enu_m:
        raise ValueError("destinations_enu_m: expected home at least, got none")
    places = [_places(path) for path in paths_enu_m]
    n_places = np.array([len(each) for each in places])
    firsts = np.concatenate([[0], np.cumsum(n_places)[:-1]])
    start, ends = np.concatenate(places), np.array(destinations_enu_m, np.float64)
    away_m = np.linalg.norm(start[:, None, :2] - ends[None, :, :2], axis=2)
    nearest = away_m.argmin(axis=1)
    end = ends[nearest]
    wanted = np.full(len(start), height_z_m)
    if cone_slope > 0.0:
        wanted = np.minimum(wanted, end[:, 2] + cone_slope * away_m.min(axis=1))
    level = np.maximum(start[:, 2], wanted)
    above, over = np.c_[start[:, :2], level], np.c_[end[:, :2], level]
    a, b = np.concatenate([start, above, over]), np.concatenate([above, over, end])

    def nearest_m(solids: Solids, furthest_m: float) -> Array:
        of_places = solids.segment_distances_m(a, b, furthest_m).reshape(3, -1).min(axis=0)
        return np.asarray(np.minimum.reduceat(of_places, firsts))

    gaps_m = nearest_m(space.solids, upper_m)
    crosses = np.zeros(len(places), np.bool_)
    if len(space.no_fly.part):
        crosses = nearest_m(space.no_fly, 1.0) <= 0.0
    above_ground_m = np.minimum.reduceat(space.ground.least_m(above, over), firsts)
    n_elsewhere = np.add.reduceat(nearest > 0, firsts, dtype=np.int64)
    found = zip(
        gaps_m.tolist(),
        crosses.tolist(),
        n_elsewhere.tolist(),
        n_places.tolist(),
        above_ground_m.tolist(),
        strict=True,
    )
    return [ReturnRoute(*each) for each in found]


def _places(path_enu_m: Array) -> Array:
    """Vertices of a path and places between them, at most `SAMPLE_M` apart."""
    pieces = [path_enu_m[:1]]
    for first, last in itertools.pairwise(path_enu_m):
        n_steps = max(1, math.ceil(float(np.linalg.norm(last - first)) / SAMPLE_M))
        pieces.append(first + np.linspace(0.0, 1.0, n_steps + 1)[1:, None] * (last - first))
    return np.concatenate(pieces)


def clear_height_z_m(space: FreeSpace, distance_m: float) -> float:
    """Height at which level flight keeps a distance from everything on a site, its ground and home, whatever it is."""
    _, ground_z_m = space.ground.range_m(space.low_enu_m, space.high_enu_m)
    highest_z_m = max(float(space.home_enu_m[2]), ground_z_m)
    return float(space.solids.bvh.corners[:, :, 2].max(initial=highest_z_m)) + distance_m


@dataclass(frozen=True, slots=True)
class ReturnHeight:
    """How high aircraft climb before they return.

    Parameters
    ----------
    z_m, above_home_m
        In the site's frame, and above home: what autopilots are told.
    wanted_above_home_m
        What would clear everything on the site by `CLEARANCE_M`, or by the minimum distance where that is more.
    ceiling_above_home_m
        Where the airspace ends.
    """

    z_m: float
    above_home_m: float
    wanted_above_home_m: float
    ceiling_above_home_m: float


def return_height(space: FreeSpace) -> ReturnHeight:
    """The height at which aircraft return to home: above everything, but never above the airspace.

    An aircraft that is higher already returns where it is, on all autopilots; so a path may be higher than this.
    """
    home_z_m, ceiling_z_m = float(space.home_enu_m[2]), float(space.high_enu_m[2])
    wanted_m = clear_height_z_m(space, max(CLEARANCE_M, space.min_distance_m)) - home_z_m
    height_m = float(math.ceil(round(wanted_m, 6)))
    ceiling_m = ceiling_z_m - home_z_m
    if height_m > ceiling_m:
        height_m = math.floor(round(10.0 * ceiling_m, 6)) / 10.0
    return ReturnHeight(home_z_m + height_m, height_m, wanted_m, ceiling_m)
