"""Import a site: read the file, find the panels, group and name them, add what a flight needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import joined, say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Vec3
from planning.geo.mesh import MESH_SUFFIXES, closed_parts
from planning.site.importing.facades import facade_name, group_facades
from planning.site.importing.options import UNITS_M, ImportOptions
from planning.site.importing.panel_grid import grid_panels
from planning.site.importing.panes import panes_outdoors
from planning.site.importing.polygons import quad_areas
from planning.site.importing.source import HOW_TO_GET_PANELS, SourceModel
from planning.site.importing.surroundings import surroundings
from planning.site.records import Facade, Obstacle, Panel, Site, SiteModel

Array = NDArray[np.float64]

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
        are none, or a wish cannot be met; the message says what to do.
    """
    return assemble(path, read_source(path, options, monitor), options, monitor)


def assemble(path: Path, source: SourceModel, options: ImportOptions, monitor: Monitor = QUIET) -> ImportedSite:
    """Site from what a reader found in the file `path`.

    Raises
    ------
    InputError
        Panels are required and there are none, the building is far too large, the ground is not clear, or a wish
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
            raise InputError(f"{path}: {found}; {HOW_TO_GET_PANELS}")
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
        raise InputError(say("expected a file ending in {}, got '{}'", ", ".join(SUFFIXES), suffix, place=path))
    if not path.exists():
        raise InputError(say("there is no such file", place=path))
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
        raise InputError(f"{path}: {source.question}")


def _check_extent(path: Path, source: SourceModel, options: ImportOptions) -> None:
    size_m = _size_m(source)
    if max(size_m) > MAX_BUILDING_M:
        east, north, up = _sides(size_m)
        raise InputError(
            say(
                "the building would be {:m} x {:m} x {} m, at most {:g} km are expected; {}",
                east,
                north,
                up,
                MAX_BUILDING_M / 1000.0,
                _advice_on_units(path, size_m, options),
                place=path,
            )
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
