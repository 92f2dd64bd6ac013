"""What no file holds and every flight needs, airspace and take-off place: by default, or as the user says."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Vec3
from planning.site.importing.ground import Terrain
from planning.site.importing.options import ImportOptions
from planning.site.records import Airspace, check_point

Array = NDArray[np.float64]

FLOOR_M = 2.0
"""Default height of the airspace's floor above ground."""

HEADROOM_M = 30.0
"""Default height of the airspace's ceiling above the building's highest point."""

HOME_CLEARANCE_M = 15.0
"""Least horizontal distance of the default home from everything: 10 m to keep in flight, and 5 m of reserve."""

LEAST_CLEARANCE_M = 3.0
"""Nearer to a wall nothing can take off."""

STANDING_OUT_M = 1.5
"""Height above the open ground from which something is in the way of a take-off."""

HOME_STEP_M = 2.0
N_BEARINGS = 36


NO_HOME = say(
    "there is no place for home inside the airspace that is at least {:g} m from every wall; widen "
    "it with --airspace-margin, or name a place with --home E,N,U",
    LEAST_CLEARANCE_M,
)


class Surroundings(NamedTuple):
    """Airspace and home, with what was decided about them."""

    airspace: Airspace
    home_enu_m: Vec3
    notes: tuple[str, ...]


def surroundings(
    panels: Array,
    building: Array,
    neighbours: Array,
    ground_z_m: float,
    options: ImportOptions,
    terrain: Terrain | None = None,
) -> Surroundings:
    """Airspace around the building, and a home in front of its first facade, or beside it where there is none yet.

    Parameters
    ----------
    panels
        Corners of the panels of the largest facade, shape (m, 4, 3).
    building
        Points of the building and of all panels, shape (n, 3).
    neighbours
        Triangles of what else stands near by, shape (t, 3, 3).
    terrain
        Open ground that is part of the building's mesh: home may stand on it.

    Raises
    ------
    InputError
        The wishes leave no airspace, or no place for home in it.
    """
    low, high = building.min(axis=0), building.max(axis=0)
    margin = options.airspace_margin_m
    floor = ground_z_m + FLOOR_M if options.floor_m is None else options.floor_m
    ceiling = float(high[2]) + HEADROOM_M if options.ceiling_m is None else options.ceiling_m
    try:
        airspace = Airspace(
            (_rounded(low[0] - margin), _rounded(low[1] - margin), _rounded(floor)),
            (_rounded(high[0] + margin), _rounded(high[1] + margin), _rounded(ceiling)),
            _rounded(ground_z_m),
            min_height_above_ground_m=options.min_height_m,
        )
    except ValueError as error:
        raise InputError(say("--airspace-margin, --floor and --ceiling leave no airspace: {}", error)) from error
    notes = [
        say(
            "airspace: {:g} m around the building, from {:g} to {:g} m (--airspace-margin, --floor, "
            "--ceiling); no-fly zones and obstacles on site are yours to add",
            margin,
            airspace.min_enu_m[2],
            airspace.max_enu_m[2],
        )
    ]
    if options.home_enu_m is not None:
        try:
            check_point(options.home_enu_m, "--home")
        except ValueError as error:
            raise InputError(str(error)) from error
        return Surroundings(airspace, options.home_enu_m, tuple(notes))
    home, clearance_m = _home(panels, _standing_out(building, terrain), neighbours, airspace)
    here_m = None if terrain is None else terrain.around(home[0], home[1])
    if here_m is not None:
        home = (home[0], home[1], _rounded(here_m))
    notes.append(
        say(
            "home: {:gm}, {:gm}, {:g} m, on the ground in front of the largest facade, {:.0f} m from the "
            "nearest wall (--home)",
            home[0],
            home[1],
            home[2],
            clearance_m,
        )
        if len(panels)
        else say(
            "home: {:gm}, {:gm}, {:g} m, on the ground beside the building, {:.0f} m from the nearest wall (--home)",
            home[0],
            home[1],
            home[2],
            clearance_m,
        )
    )
    if clearance_m < HOME_CLEARANCE_M:
        notes.append(
            say(
                "no place inside the airspace is {:g} m from every wall, so home is tight: choose one with "
                "--home, or widen --airspace-margin",
                HOME_CLEARANCE_M,
            )
        )
    return Surroundings(airspace, home, tuple(notes))


def _standing_out(points: Array, terrain: Terrain | None) -> Array:
    """Points above the open ground, shape (n, 3) to (m, 3): what an aircraft has to keep clear of at take-off."""
    if terrain is None:
        return points
    ground_m = terrain.at(points)
    stands_out = points[np.isnan(ground_m) | (points[:, 2] > ground_m + STANDING_OUT_M)]
    return stands_out if len(stands_out) else points


def _rounded(value: float) -> float:
    return round(float(value), 3) + 0.0  # 0 and never -0


def _home(panels: Array, building: Array, neighbours: Array, airspace: Airspace) -> tuple[Vec3, float]:
    """The clear place most nearly straight in front of the facade, and its clearance; else the clearest place.

    Without a facade, straight in front is south of the building's middle.
    """
    import shapely

    middle = 0.5 * (building.min(axis=0) + building.max(axis=0)) if len(panels) == 0 else panels.mean(axis=(0, 1))
    outwards = np.cross(panels[:, 2] - panels[:, 0], panels[:, 3] - panels[:, 1]).sum(axis=0)[:2]
    ahead = float(np.arctan2(outwards[1], outwards[0])) if np.linalg.norm(outwards) > 1e-6 else -0.5 * np.pi
    low, high = np.array(airspace.min_enu_m[:2]) + 1.0, np.array(airspace.max_enu_m[:2]) - 1.0
    # Straight ahead first, then further and further to the sides; along each bearing outwards.
    turns = sorted(range(N_BEARINGS), key=lambda k: min(k, N_BEARINGS - k))
    bearings = ahead + 2.0 * np.pi * np.array(turns) / N_BEARINGS
    steps = np.arange(HOME_CLEARANCE_M, float(np.linalg.norm(high - low)), HOME_STEP_M)
    rays = np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)[:, None] * steps[None, :, None]
    places = (middle[:2] + rays).reshape(-1, 2)
    places = places[np.all((places > low) & (places < high), axis=1)]
    if len(places) == 0:
        raise InputError(NO_HOME)
    points = shapely.points(places)
    # Outside the building's convex hull: not in a court, where the climb would be narrow.
    clearance = shapely.distance(points, shapely.convex_hull(shapely.MultiPoint(building[:, :2])))
    if len(neighbours):
        tree = shapely.STRtree(shapely.convex_hull(shapely.multipoints(neighbours[:, :, :2])))
        nearest = tree.query_nearest(points, all_matches=False)[1]
        clearance = np.minimum(clearance, shapely.distance(points, tree.geometries[nearest]))
    is_clear = clearance >= HOME_CLEARANCE_M
    best = int(np.argmax(is_clear)) if is_clear.any() else int(np.argmax(clearance))
    if clearance[best] < LEAST_CLEARANCE_M:
        raise InputError(NO_HOME)
    x, y = places[best]
    return (_rounded(x), _rounded(y), airspace.ground_z_m), float(clearance[best])
