"""Import a site: read the file, find the panels, group and name them, add what a flight needs."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import write_together
from planning.base.messages import about, glue, joined, say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Vec3
from planning.geo.mesh import MESH_SUFFIXES, closed_parts, join, ply_bytes
from planning.site.file import site_bytes
from planning.site.importing.facades import facade_name, group_facades
from planning.site.importing.ground import Terrain
from planning.site.importing.options import UNITS_M, ImportOptions
from planning.site.importing.panel_grid import grid_panels
from planning.site.importing.panes import panes_outdoors
from planning.site.importing.polygons import quad_areas
from planning.site.importing.source import HOW_TO_GET_PANELS, SourceModel
from planning.site.records import Airspace, Facade, Obstacle, Panel, Site, SiteModel, check_point

Array = NDArray[np.float64]


# What no file holds and every flight needs, airspace and take-off place: by default, or as the user says.

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
        The options leave no airspace, or no place for home in it.
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
        raise InputError.say("--airspace-margin, --floor and --ceiling leave no airspace: {}", error) from error
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


IFC_SUFFIXES = (".ifc",)
CITYGML_SUFFIXES = (".gml", ".xml", ".citygml")
CITYJSON_SUFFIXES = (".json", ".cityjson")
SUFFIXES = (*IFC_SUFFIXES, *CITYGML_SUFFIXES, *CITYJSON_SUFFIXES, *MESH_SUFFIXES)

MAX_BUILDING_M = 5_000.0
"""The longest buildings (airports, factories) have under 2 km."""

WIDE_M = 2_000.0
HIGH_M = 600.0
LEAST_BUILDING_M = 3.0
"""What is larger or smaller is told: few buildings are, and many files whose unit is not what was read."""

LEAST_SIDE_M = 5.0
"""Longest side of a building for which a unit is proposed."""


@dataclass(frozen=True, slots=True, eq=False)
class ImportedSite:
    """A site made from a file, and what the user should know about how it was made."""

    model: SiteModel
    notes: tuple[str, ...]


def import_site(path: Path, options: ImportOptions, monitor: Monitor = QUIET) -> ImportedSite:
    """Site from an IFC, CityGML, CityJSON or mesh file.

    Raises
    ------
    InputError
        The file is missing, of another kind or broken, its place on earth is not known, panels are required and there
        are none, or an option cannot be met; the message says what to do.
    """
    return assemble(path, read_source(path, options, monitor), options, monitor)


def assemble(path: Path, source: SourceModel, options: ImportOptions, monitor: Monitor = QUIET) -> ImportedSite:
    """Site from what a reader found in the file `path`.

    Raises
    ------
    InputError
        Panels are required and there are none, the building is far too large, the ground is not clear, or an option
        cannot be met.
    """
    _check_extent(path, source, options)
    check_ground(path, source)
    panes = panes_outdoors(source, monitor)
    grids = [grid_panels(grid, source, options.grid_tolerance_m) for grid in options.panel_grids]
    corners = np.concatenate([panes.corners, *(grid.corners for grid in grids)])
    if len(corners) == 0:
        n = len(source.windows)
        found = say("no window of {} is a pane that faces the open", n) if n else say("there are no windows")
        if options.panels_required:
            raise InputError(about(path, glue(found, "; ", HOW_TO_GET_PANELS)))
        bare = say(
            "{}, so the site has no panels yet: find them in photos ('panels' or the Photos tab), or draw "
            "them on the building (the Site tab, or --panel-grid)",
            found,
        )
        return site_of_facades(path, source, (), options, (*source.notes, *panes.notes, bare, *_solid_notes(source)))
    ids = [*panes.source_ids, *[None] * (len(corners) - len(panes.corners))]
    monitor.report(say("grouping facades"), 0, 1)
    groups = group_facades(corners)
    facades = tuple(_facade(facade_name(k), corners[group], [ids[i] for i in group]) for k, group in enumerate(groups))
    grid_notes = [note for grid in grids for note in grid.notes]
    notes = (*source.notes, *panes.notes, *grid_notes, _facade_note(corners, groups), *_solid_notes(source))
    return site_of_facades(path, source, facades, options, notes)


def site_of_facades(
    path: Path, source: SourceModel, facades: tuple[Facade, ...], options: ImportOptions, notes: tuple[str, ...] = ()
) -> ImportedSite:
    """Site of a source model with facades, the largest first, or without: adds airspace, home and meshes.

    Parameters
    ----------
    path
        Of the source, for its name.
    """
    notes = (*_size_notes(path, source, options), *notes)
    by_facade = [np.array([panel.corners_enu_m for panel in facade.panels], float) for facade in facades]
    points = [corners.reshape(-1, 3) for corners in (source.building.corners_enu_m, *by_facade)]
    around = surroundings(
        by_facade[0] if by_facade else np.zeros((0, 4, 3)),
        np.concatenate(points),
        source.neighbours.corners_enu_m,
        source.placement.ground_z_m,
        options,
        source.terrain,
    )
    has_neighbours = len(source.neighbours.triangles) > 0
    site = Site(
        name=options.name or source.name or path.stem,
        origin=source.placement.origin,
        facades=facades,
        airspace=around.airspace,
        home_enu_m=around.home_enu_m,
        building_mesh="building.ply" if len(source.building.triangles) else None,
        obstacles=(Obstacle("neighbours", mesh="neighbours.ply"),) if has_neighbours else (),
        place_from=getattr(source.placement.georeference, "place_from", ""),
    )
    model = SiteModel(site, source.building, (source.neighbours,) if has_neighbours else ())
    return ImportedSite(model, (*notes, *around.notes))


def read_source(path: Path, options: ImportOptions, monitor: Monitor = QUIET) -> SourceModel:
    """Content of a file, whatever its format: what `assemble` makes a site of.

    Raises
    ------
    InputError
        As `import_site`.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise InputError.say(
            "expected a file ending in {}, got '{}'; open it in the program that made it, and save it as one of these",
            ", ".join(SUFFIXES),
            suffix,
            place=path,
        )
    if not path.exists():
        raise InputError.say("there is no such file", place=path)
    if options.building is not None and suffix not in (*CITYGML_SUFFIXES, *CITYJSON_SUFFIXES):
        raise InputError.say(
            "has no building '{}' to choose: only CityGML and CityJSON files are read as several buildings",
            options.building,
            place=path,
        )
    if suffix in IFC_SUFFIXES:
        from planning.site.importing.ifc_file import read_ifc

        return read_ifc(path, options, monitor)
    if suffix in CITYGML_SUFFIXES:
        from planning.site.importing.citygml_file import read_citygml

        return read_citygml(path, options, monitor)
    if suffix in CITYJSON_SUFFIXES:
        from planning.site.importing.cityjson_file import read_cityjson

        return read_cityjson(path, options, monitor)
    from planning.site.importing.mesh_file import read_mesh_source

    return read_mesh_source(path, options, monitor)


def check_ground(path: Path, source: SourceModel) -> None:
    """Ask where the file leaves open which height is the ground.

    Raises
    ------
    InputError
        It does; the message names the answers.
    """
    if source.question:
        raise InputError(about(path, source.question))


def _check_extent(path: Path, source: SourceModel, options: ImportOptions) -> None:
    size_m = _size_m(source)
    if max(size_m) > MAX_BUILDING_M:
        east, north, up = _sides(size_m)
        raise InputError.say(
            "the building would be {:m} x {:m} x {} m, at most {:g} km are expected; {}",
            east,
            north,
            up,
            MAX_BUILDING_M / 1000.0,
            _advice_on_units(path, size_m, options),
            place=path,
        )


def _size_notes(path: Path, source: SourceModel, options: ImportOptions) -> tuple[str, ...]:
    """A warning where the size is none of a building's."""
    size_m = _size_m(source)
    if max(size_m) == 0.0:
        return ()
    is_small, is_large = max(size_m) < LEAST_BUILDING_M, max(size_m[:2]) > WIDE_M or size_m[2] > HIGH_M
    if not (is_small or is_large):
        return ()
    east, north, up = _sides(size_m)
    return (
        (
            say(
                "the model is {:m} x {:m} x {} m, implausibly small for a building: {}",
                east,
                north,
                up,
                _advice_on_units(path, size_m, options),
            )
            if is_small
            else say(
                "the model is {:m} x {:m} x {} m, implausibly large for a building: {}",
                east,
                north,
                up,
                _advice_on_units(path, size_m, options),
            )
        ),
    )


def _size_m(source: SourceModel) -> tuple[float, float, float]:
    points = source.building.corners_enu_m.reshape(-1, 3)
    if len(points) == 0:
        return 0.0, 0.0, 0.0
    east, north, up = np.ptp(points, axis=0).tolist()
    return east, north, up


def _sides(size_m: tuple[float, float, float]) -> tuple[str, str, str]:
    east, north, up = (f"{side:.3g}" if side < 100.0 else f"{side:.0f}" for side in size_m)
    return east, north, up


def _advice_on_units(path: Path, size_m: tuple[float, float, float], options: ImportOptions) -> str:
    """Units in which the building would have a plausible size, as far as the user has the choice."""
    if path.suffix.lower() not in MESH_SUFFIXES or options.crs is not None:
        return say("the unit or the scale that the file states is wrong; put it right in the program that wrote it")
    fitting = []
    for unit, length_m in UNITS_M.items():
        factor = length_m / UNITS_M[options.unit]
        other_m = (size_m[0] * factor, size_m[1] * factor, size_m[2] * factor)
        if unit not in (options.unit, "us-ft") and LEAST_SIDE_M <= max(other_m) <= WIDE_M and other_m[2] <= HIGH_M:
            east, north, up = _sides(other_m)
            fitting.append(say("--units {} makes it {:m} x {:m} x {} m (factor {:g})", unit, east, north, up, factor))
    if fitting:
        return say("if its unit is not what was read, {}", joined(" and ", fitting))
    return say("no unit makes it plausible, so it is no model of true size; scale it in the program that wrote it")


def _facade(name: str, corners: Array, source_ids: list[str | None]) -> Facade:
    return Facade(
        name,
        tuple(
            Panel(f"{name}-{number:04d}", _vertices(quad), source_id)
            for number, (quad, source_id) in enumerate(zip(corners, source_ids, strict=True))
        ),
    )


def _vertices(quad: Array) -> tuple[Vec3, Vec3, Vec3, Vec3]:
    """Corners rounded to 0.1 mm, so that the file reads back as it was."""
    a, b, c, d = ((round(float(x), 4), round(float(y), 4), round(float(z), 4)) for x, y, z in quad)
    return a, b, c, d


def _facade_note(corners: Array, groups: list[NDArray[np.int64]]) -> str:
    largest, n_single = quad_areas(corners[groups[0]]), sum(len(group) == 1 for group in groups)
    note = say(
        "facades, by plane or smoothly curved surface: {}, the one with most glass first (A: {} panels, {:.0f} m2)",
        len(groups),
        len(groups[0]),
        largest.sum(),
    )
    return note + (say("; with one panel only: {}", n_single) if n_single else "")


def _solid_notes(source: SourceModel) -> tuple[str, ...]:
    """How much of the building is open skin, whose inside is not known to be solid."""
    corners = source.building.corners_enu_m
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    if areas.sum() == 0.0:
        return ()
    open_share = float(areas[closed_parts(corners) < 0].sum() / areas.sum())
    if open_share < 0.005:
        return ()
    return (
        say(
            "{:.0f} % of the building's surface does not close (gaps and overlaps in the model): the "
            "distance to it is kept all the same, but the space behind it does not count as solid",
            100.0 * open_share,
        ),
    )


# An imported site to files: the site file and its meshes beside it, none half-written, none over the source.


def write_imported_site(
    path: Path, imported: ImportedSite, source: Path, other_files: Mapping[Path, bytes] | None = None
) -> SiteModel:
    """Write the site file and, beside it, its meshes; returns the model as it was written.

    Meshes are named after the site file; none is ever written over the file that was imported.

    Parameters
    ----------
    other_files
        Content of further files that belong to the site.

    Raises
    ------
    InputError
        The folder is missing or cannot be written, or the site would replace the file it was imported from.
    """
    if path.exists() and path.samefile(source):
        raise InputError.say(
            "the site would be written over the file it is imported from; name another file", place=path
        )
    model = imported.model
    site = model.site
    meshes: dict[Path, bytes] = {}
    if site.building_mesh is not None:
        name = _free_name(path, ".ply", "-building.ply", source)
        meshes[path.with_name(name)] = ply_bytes(model.building)
        site = replace(site, building_mesh=name)
    if site.obstacles:
        name = _free_name(path, "-neighbours.ply", "-other-buildings.ply", source)
        meshes[path.with_name(name)] = ply_bytes(join(list(model.obstacles)))
        site = replace(site, obstacles=(replace(site.obstacles[0], mesh=name),))
    content = site_bytes(site)
    write_together({path: content, **meshes, **(other_files or {})})
    return replace(model, site=site, sha256=hashlib.sha256(content).hexdigest())


def _free_name(path: Path, ending: str, other_ending: str, source: Path) -> str:
    """Name of a mesh beside the site file, with the other ending where the first is the imported file's own."""
    name = path.stem + ending
    target = path.with_name(name)
    return path.stem + other_ending if target.exists() and target.samefile(source) else name
