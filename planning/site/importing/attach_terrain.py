"""Terrain and what stands on it, attached to a site: the ground below flights, trees and neighbours as obstacles.

Home and rally points that stood on level ground are put on the terrain: all heights above take-off count from home.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Vec3
from planning.geo.height_field import HeightField
from planning.geo.mesh import TriangleMesh, box_mesh, join
from planning.geo.solids import Solids
from planning.site.file import site_sha256
from planning.site.importing.elevation import SRTM, HeightOptions
from planning.site.importing.terrain import Area, Sampled, sample_heights
from planning.site.records import Obstacle, Site, SiteModel, panel_corners, panel_triangles
from planning.site.terrain import surfaces, terrain_of

Array = NDArray[np.float64]

MARGIN_M = 30.0
"""Around the airspace: what is attached holds when its sides are moved a little."""

ON_GROUND_M = 0.01
"""Home and rally points this close to the level ground stand on it."""

APART_M = 2.0
"""Worth a word if the terrain and the site differ by more where home stands."""

SURFACE, SURFACE_UNKNOWN = "surface", "surface-unknown"
"""Obstacles that a surface model makes: what stands on the ground, and where it says nothing."""

MAX_BOXES = 12_000
"""Of one obstacle; more are made fewer by coarser steps of height."""

SURVEYED_M, SURVEYED_SPACING_M = 0.6, 5.0
"""Of surveys from the air, whose posts are so near: the error below plants that the USGS Lidar Base Specification
allows its coarsest quality level (QL3) at 19 of 20 places. What has posts further apart may be a product like SRTM."""

RIM_M = 3.0
"""At most so far beside a building, holes in the ground are taken to be its own."""

BELOW_M = 1.0
"""How far obstacles reach below the lowest ground near them."""


@dataclass(frozen=True, slots=True)
class TerrainRequest:
    """What to attach.

    Parameters
    ----------
    ground
        Files or folders with heights of the ground.
    surface
        The same with roofs and trees.
    step_m
        Of the grids; None: as fine as the files.
    accuracy_m
        How far the ground may lie off the files' heights; None: what is known of their product, else
        `unknown_accuracy_m`.
    shift_m
        Added to all heights; `home`: what brings the terrain to home.
    taller_than_m
        What rises so far above the ground is an obstacle.
    """

    ground: tuple[Path, ...]
    surface: tuple[Path, ...] = ()
    options: HeightOptions = field(default_factory=HeightOptions)
    step_m: float | None = None
    accuracy_m: float | None = None
    shift_m: float | Literal["home"] = 0.0
    taller_than_m: float = 2.0
    use: EffectSetting = "auto"

    def __post_init__(self) -> None:
        for name, value in (("step_m", self.step_m), ("taller_than_m", self.taller_than_m)):
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise ValueError(say("expected more than 0 m, got {}", value, place=name))


@dataclass(frozen=True, slots=True, eq=False)
class Attached:
    """A site with terrain.

    Parameters
    ----------
    meshes
        Files of obstacles that are not there yet, by name.
    home_moved_m
        How far home was raised to stand on the terrain.
    n_boxes, n_unknown_boxes
        Of the obstacles that the surface makes.
    """

    model: SiteModel
    notes: tuple[str, ...]
    ground: Sampled
    surface: Sampled | None
    meshes: dict[str, TriangleMesh]
    home_moved_m: float
    n_boxes: int
    n_unknown_boxes: int


def attach_terrain(model: SiteModel, request: TerrainRequest, stem: str, monitor: Monitor = QUIET) -> Attached:
    """Attach terrain to a site, in place of any that it has.

    Parameters
    ----------
    stem
        Of the names of mesh files.

    Raises
    ------
    InputError
        A file is damaged, says too little, or covers nothing of the airspace.
    """
    model = without_terrain(model)
    area = _area(model.site)
    ground = sample_heights(model.site.origin, area, request.ground, request.options, request.step_m, monitor)
    surface = None
    if request.surface:
        surface = sample_heights(model.site.origin, area, request.surface, request.options, request.step_m, monitor)
    shift_m, notes = _shift(model.site, ground.field, request.shift_m)
    ground = _shifted(ground, shift_m)
    surface = None if surface is None else _shifted(surface, shift_m)
    filled, more = _filled(model, ground, surface)
    notes += [*more, *_notes(filled, surface, request)]
    accuracy_m = _accuracy_m(ground) if request.accuracy_m is None else request.accuracy_m
    terrain = terrain_of(
        filled.field,
        filled.upper_m,
        filled.lower_m,
        accuracy_m=accuracy_m,
        use=request.use,
        sources=(*ground.sources(), *(() if surface is None else surface.sources())),
    )
    site, home_moved_m = _on_terrain(replace(model.site, terrain=terrain))
    notes += _home_notes(site, home_moved_m)
    attached, counts = replace(model, site=site), (0, 0)
    meshes: dict[str, TriangleMesh] = {}
    if surface is not None:
        monitor.report(say("finding what stands on the ground"), 0, 1)
        attached, meshes, counts = _with_obstacles(attached, surface, request.taller_than_m, stem)
    attached = replace(attached, sha256=site_sha256(attached.site))
    return Attached(attached, tuple(notes), filled, surface, meshes, home_moved_m, *counts)


def unknown_accuracy_m(post_spacing_m: float) -> float:
    """How far the ground may lie off heights of which nobody says where they are from."""
    return SURVEYED_M if post_spacing_m <= SURVEYED_SPACING_M else SRTM.accuracy_m


def _accuracy_m(ground: Sampled) -> float:
    spacing_m = ground.post_spacing_m
    return max(
        unknown_accuracy_m(spacing_m) if raster.product is None else raster.product.accuracy_m
        for raster in ground.rasters
    )


def without_terrain(model: SiteModel) -> SiteModel:
    """A site without its terrain and the obstacles that came with it."""
    kept = [
        (obstacle, mesh)
        for obstacle, mesh in zip(model.site.obstacles, model.obstacles, strict=True)
        if obstacle.id not in (SURFACE, SURFACE_UNKNOWN)
    ]
    site = replace(model.site, terrain=None, obstacles=tuple(obstacle for obstacle, _ in kept))
    return replace(model, site=site, obstacles=tuple(mesh for _, mesh in kept), sha256=site_sha256(site))


def _area(site: Site) -> Area:
    """Airspace, home and rally points from above."""
    places = [site.airspace.min_enu_m, site.airspace.max_enu_m, site.home_enu_m]
    places += [point.position_enu_m for point in site.rally_points]
    xy = np.array(places)[:, :2]
    return Area(xy.min(axis=0) - MARGIN_M, xy.max(axis=0) + MARGIN_M, site.airspace.ground_z_m)


def _shift(site: Site, ground: HeightField, wanted: float | Literal["home"]) -> tuple[float, list[str]]:
    if wanted != "home":
        return wanted, []
    there = float(ground.heights_m(np.array([site.home_enu_m]))[0])
    if math.isnan(there):
        raise InputError.say("the terrain cannot be brought to home: it has no heights there; give the shift in metres")
    shift_m = site.home_enu_m[2] - there
    return shift_m, [say("the terrain was shifted by {:+.2f} m, so that home stands on it", shift_m)]


def _shifted(sampled: Sampled, shift_m: float) -> Sampled:
    moved = replace(sampled.field, z_m=sampled.field.z_m + shift_m)
    upper_m, lower_m, tops_m = (grid + shift_m for grid in (sampled.upper_m, sampled.lower_m, sampled.tops_m))
    return replace(sampled, field=moved, upper_m=upper_m, lower_m=lower_m, tops_m=tops_m)


def _filled(model: SiteModel, ground: Sampled, surface: Sampled | None) -> tuple[Sampled, list[str]]:
    """The ground with what is known otherwise: below the building from beside it, elsewhere from the surface.

    Where only the surface is known, the ground lies no higher than that.
    """
    z, upper, lower = (grid.copy() for grid in (ground.field.z_m, ground.upper_m, ground.lower_m))
    notes: list[str] = []
    if np.isnan(z).any() and not np.isnan(z).all():
        missing, below_building = np.isnan(z), np.zeros(z.shape, np.bool_)
        rim_m = min(1.5 * ground.post_spacing_m, RIM_M)
        below_building[missing] = _is_below(model.building, ground.field.nodes_xy_m()[missing], rim_m)
        if below_building.any():
            nearest = distance_transform_edt(missing, return_distances=False, return_indices=True)
            for grid in (z, upper, lower):
                grid[below_building] = grid[tuple(nearest[:, below_building])]
            notes.append(say("below the building the files have no heights; those beside it were taken"))
    if np.isnan(z).any() and surface is not None:
        missing = np.isnan(z)
        xy = ground.field.nodes_xy_m()[missing]
        above = replace(surface.field, z_m=surface.upper_m).heights_m(xy)
        z[missing] = upper[missing] = above
        lower[missing] = np.where(np.isfinite(above), np.minimum(above, np.nanmin(ground.lower_m)), np.nan)
        if np.isfinite(above).any():
            notes.append(say("where the ground is not known, the surface counts as ground"))
    return replace(ground, field=replace(ground.field, z_m=z), upper_m=upper, lower_m=lower), notes


def _is_below(building: TriangleMesh, xy: Array, rim_m: float) -> NDArray[np.bool_]:
    """Whether the vertical through points, shape (n, 2), meets a building or passes it closer than a distance."""
    if not len(building.triangles):
        return np.zeros(len(xy), np.bool_)
    low, high = building.vertices_enu_m[:, 2].min() - 1.0, building.vertices_enu_m[:, 2].max() + 1.0
    a, b = np.c_[xy, np.full(len(xy), low)], np.c_[xy, np.full(len(xy), high)]
    return Solids.of(building.corners_enu_m).segment_distances_m(a, b, 2.0 * rim_m) <= rim_m


def _on_terrain(site: Site) -> tuple[Site, float]:
    """The site with home and rally points on the terrain that stood on level ground, and how far home rose."""
    assert site.terrain is not None
    ground, level_z_m = surfaces(site.terrain).ground, site.airspace.ground_z_m

    def lifted(place: Vec3) -> Vec3:
        there = float(ground.heights_m(np.array([place]))[0])
        on_level = abs(place[2] - level_z_m) <= ON_GROUND_M
        return (place[0], place[1], round(there, 3) + 0.0) if on_level and math.isfinite(there) else place

    home = lifted(site.home_enu_m)
    rally = tuple(replace(point, position_enu_m=lifted(point.position_enu_m)) for point in site.rally_points)
    return replace(site, home_enu_m=home, rally_points=rally), home[2] - site.home_enu_m[2]


def _home_notes(site: Site, moved_m: float) -> list[str]:
    assert site.terrain is not None
    there = float(surfaces(site.terrain).ground.heights_m(np.array([site.home_enu_m]))[0])
    if math.isnan(there):
        return [say("where home stands the files have no heights: no flight can be planned until home is moved")]
    if abs(moved_m) > ON_GROUND_M:
        found: list[str] = [say("home was put on the terrain, {:+.2f} m from where it was", moved_m)]
        if abs(moved_m) > APART_M:
            text = say(
                "terrain and site differ by {:.1f} m at home: where the ground is level there, one of them is wrong; "
                "'--shift home' brings the terrain to the site",
                abs(moved_m),
            )
            found.append(text)
        return found
    off_m = site.home_enu_m[2] - there
    if abs(off_m) > APART_M:
        return [say("home lies {:.1f} m above the terrain; move it where that is not meant", off_m)]
    return []


def _notes(ground: Sampled, surface: Sampled | None, request: TerrainRequest) -> list[str]:
    notes = list(dict.fromkeys((*ground.notes(), *(() if surface is None else surface.notes()))))
    product = next((raster.product for raster in ground.rasters if raster.product is not None), None)
    if product is not None and request.accuracy_m is None:
        text = say(
            "{} is good to {:g} m at nine of ten places: so much more is kept above the ground; another value can be "
            "given with --accuracy",
            product.name,
            product.accuracy_m,
        )
        notes.append(text)
    if request.accuracy_m is None and any(raster.product is None for raster in ground.rasters):
        text = say(
            "the files do not say how good their heights are: {:g} m more are kept above the ground, as for {}; "
            "another value can be given with --accuracy",
            unknown_accuracy_m(ground.post_spacing_m),
            say("surveys from the air (USGS)")
            if ground.post_spacing_m <= SURVEYED_SPACING_M
            else say("global products with posts so far apart (SRTM)"),
        )
        notes.append(text)
    if product is not None and product.shows_surface:
        text = say("{} has roofs and trees in it, smoothed: they count as ground, not as obstacles", product.name)
        notes.append(text)
    for sampled, what in ((ground, say("the ground")), (surface, say("the surface"))):
        if sampled is not None and sampled.unknown_share > 0.0:
            text = say(
                "{} is not known on {:.1f} % of the area: no flight is planned there",
                what,
                100.0 * sampled.unknown_share,
            )
            notes.append(text)
    return notes


# What stands on the ground.


def _with_obstacles(
    model: SiteModel, surface: Sampled, taller_than_m: float, stem: str
) -> tuple[SiteModel, dict[str, TriangleMesh], tuple[int, int]]:
    """The site with what its surface shows above the ground, and what it does not show, as obstacles."""
    site = model.site
    assert site.terrain is not None
    found = surfaces(site.terrain)
    nodes = surface.field.nodes_xy_m()
    flat = nodes.reshape(-1, 2)
    ground, lower = (field.heights_m(flat).reshape(nodes.shape[:2]) for field in (found.ground, found.lower))
    top, known = surface.tops_m, ~np.isnan(surface.tops_m)
    # Where the ground is not known the surface stands for it, so nothing rises above it there.
    height = replace(surface.field, z_m=surface.field.z_m - ground).cells_m(np.fmax)
    rises = np.nan_to_num(height, nan=0.0) > taller_than_m
    lowest = float(np.nanmin(lower)) if np.isfinite(lower).any() else site.airspace.ground_z_m
    foot = np.nan_to_num(replace(surface.field, z_m=lower).cells_m(np.fmin), nan=lowest) - BELOW_M
    middles = 0.5 * (nodes[:-1, :-1] + nodes[1:, 1:])
    stands = known & rises
    stands[stands] = ~_is_modelled(model, np.c_[middles[stands], top[stands]], surface.field.step_m)
    low, high = np.array(site.airspace.min_enu_m), np.array(site.airspace.max_enu_m)
    half = 0.5 * surface.field.step_m
    inside = ((middles + half >= low[:2]) & (middles - half <= high[:2])).all(axis=2)
    unknown = ~known & inside
    boxes = _boxes(surface.field, stands, foot, top)
    ceilings = np.full(foot.shape, max(high[2], float(np.nanmax(top, initial=high[2]))))
    unknown_boxes = _boxes(surface.field, unknown, np.full(foot.shape, lowest - BELOW_M), ceilings)
    obstacles, meshes, files = list(site.obstacles), list(model.obstacles), {}
    for name, parts in ((SURFACE, boxes), (SURFACE_UNKNOWN, unknown_boxes)):
        if parts:
            file, mesh = f"{stem}.{name}.ply", join([box_mesh(a, b) for a, b in parts])
            obstacles.append(Obstacle(name, mesh=file))
            meshes.append(mesh)
            files[file] = mesh
    site = replace(site, obstacles=tuple(obstacles))
    attached = replace(model, site=site, obstacles=tuple(meshes), sha256="")
    return attached, files, (len(boxes), len(unknown_boxes))


def _is_modelled(model: SiteModel, tops_enu_m: Array, step_m: float) -> NDArray[np.bool_]:
    """Whether the tops of columns, shape (n, 3), are those of what the site has as a solid already.

    A pixel on the edge of a roof shows a height between roof and ground, up to a pixel and a half away from the wall.
    """
    known = join([model.building, *model.obstacles]).corners_enu_m
    solids = Solids.of(np.concatenate([known, panel_triangles(panel_corners(model.site))]))
    near_m = 1.5 * step_m + 1.0
    return solids.clearance_m(tops_enu_m, 2.0 * near_m) <= near_m


def _boxes(grid: HeightField, cells: NDArray[np.bool_], foot: Array, top: Array) -> list[tuple[Array, Array]]:
    """Boxes that enclose the columns of some cells: neighbours of like height in one box, as high as the highest."""
    if not cells.any():
        return []
    for quantum_m in (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 1000.0):
        level = np.where(cells, np.ceil(np.nan_to_num(top) / quantum_m), np.nan)
        found = _rectangles(level)
        if len(found) <= MAX_BOXES:
            break
    else:
        raise InputError.say(
            "the surface makes more than {} separate obstacles; give a longer --resolution, or a greater --taller-than",
            MAX_BOXES,
        )
    boxes = []
    for first_row, last_row, first_column, last_column in found:
        part = np.s_[first_row:last_row, first_column:last_column]
        corner = np.array([grid.west_m, grid.south_m])
        low_xy = corner + grid.step_m * np.array([first_column, first_row])
        high_xy = corner + grid.step_m * np.array([last_column, last_row])
        bottom, highest = float(foot[part].min()), float(top[part].max())
        boxes.append((np.array([*low_xy, bottom]), np.array([*high_xy, max(highest, bottom + 0.1)])))
    return boxes


def _rectangles(level: Array) -> list[tuple[int, int, int, int]]:
    """Rectangles of equal values, NaN left out: runs of each row, joined with the same runs of the rows above.

    First and last rows and columns, ends excluded.
    """
    n_rows, n_columns = level.shape
    found: list[tuple[int, int, int, int]] = []
    growing: dict[tuple[int, int, float], int] = {}
    for row in range(n_rows + 1):
        runs: Sequence[tuple[int, int, float]] = []
        if row < n_rows:
            values = level[row]
            changes = np.flatnonzero(~(values[1:] == values[:-1])) + 1
            starts = np.concatenate([[0], changes])
            ends = np.concatenate([changes, [n_columns]])
            runs = [
                (int(start), int(end), float(values[start]))
                for start, end in zip(starts, ends, strict=True)
                if not np.isnan(values[start])
            ]
        present = set(runs)
        for run in [run for run in growing if run not in present]:
            found.append((growing.pop(run), row, run[0], run[1]))
        for run in runs:
            growing.setdefault(run, row)
    return found
