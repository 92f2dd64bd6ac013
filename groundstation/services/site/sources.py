"""Use cases that bring a site into the document: a site file, a bundled site, or an import that is looked at first."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from groundstation.services.project.document import Document
from groundstation.services.project.input_files import read_input_site
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Vec3
from planning.geo.mesh import MAX_COORDINATE_M
from planning.site.bundled import SCENES
from planning.site.file import site_sha256
from planning.site.importing.importer import CITYGML_SUFFIXES, CITYJSON_SUFFIXES, assemble, read_source
from planning.site.importing.options import ImportOptions, PanelGrid
from planning.site.importing.polygons import quad_areas
from planning.site.importing.source import SourceModel
from planning.site.records import Airspace, Site, SiteModel, panel_corners
from reconstruction.panels.solving.accuracy import FoundFacades


@dataclass(frozen=True, slots=True, eq=False)
class ImportPreview:
    """What an import would bring, before anything is decided.

    Parameters
    ----------
    source
        What was read.
    model
        The site it would become, with its checksum, perhaps without panels; None where it cannot become one yet.
    problem
        Why not; empty where it can.
    notes
        What was decided, changed or left out.
    """

    path: Path
    options: ImportOptions
    source: SourceModel
    model: SiteModel | None
    problem: str
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FacadeSummary:
    """A facade in numbers."""

    id: str
    n_panels: int
    area_m2: float


@dataclass(frozen=True, slots=True)
class SiteSummary:
    """A site in numbers: the extent of building and panels to the east, to the north and upwards, and its glass."""

    size_m: Vec3
    n_triangles: int
    facades: tuple[FacadeSummary, ...]

    @property
    def n_panels(self) -> int:
        """Panels on all facades."""
        return sum(facade.n_panels for facade in self.facades)

    @property
    def area_m2(self) -> float:
        """Area of all panels."""
        return sum(facade.area_m2 for facade in self.facades)


def bundled_site(name: str) -> SiteModel:
    """One of the sites that come with the program.

    Raises
    ------
    InputError
        There is none of that name.
    """
    if name not in SCENES:
        raise InputError(say("there is no bundled site '{}'; known are: {}", name, ", ".join(sorted(SCENES))))
    model = SCENES[name]()
    return replace(model, sha256=site_sha256(model.site))


def open_site(path: Path, monitor: Monitor = QUIET) -> SiteModel:
    """The site in a file, with its meshes.

    Raises
    ------
    InputError
        As `groundstation.services.project.input_files.read_input_site`: a building model is told from a site file.
    """
    monitor.report(say("reading the site"), 0, 0)
    return read_input_site(path)


def preview_import(path: Path, options: ImportOptions, monitor: Monitor = QUIET) -> ImportPreview:
    """Import into memory, to be looked at; where no panels are known yet, a note says so.

    Raises
    ------
    InputError
        The file cannot be read with these options, or nobody says where it is.
    """
    options = replace(options, panels_required=False)
    source = read_source(path, options, monitor)
    try:
        imported = assemble(path, source, options, monitor)
    except InputError as error:
        return ImportPreview(path, options, source, None, str(error), source.notes)
    model = replace(imported.model, sha256=site_sha256(imported.model.site))
    return ImportPreview(path, options, source, model, "", imported.notes)


def holds_many_buildings(path: Path) -> bool:
    """Whether the format has room for more than one building."""
    return path.suffix.lower() in (*CITYGML_SUFFIXES, *CITYJSON_SUFFIXES)


def grid_in_file(
    preview: ImportPreview, rectangle_enu_m: tuple[Vec3, Vec3, Vec3], n_rows: int, n_columns: int, gap_m: float
) -> PanelGrid:
    """Panel grid for the import options, from a rectangle that was picked in the preview.

    Parameters
    ----------
    rectangle_enu_m
        Lower left, lower right and upper left corner as seen from outside, in the preview's local frame.
    """
    a, b, c = (
        (round(x, 6), round(y, 6), round(z, 6))
        for x, y, z in preview.source.placement.file_coordinates(np.array(rectangle_enu_m)).tolist()
    )
    return PanelGrid((a, b, c), n_rows, n_columns, gap_m)


def site_summary(model: SiteModel) -> SiteSummary:
    """A site in numbers."""
    corners = panel_corners(model.site)
    points = np.concatenate([corners.reshape(-1, 3), model.building.vertices_enu_m])
    areas = np.split(quad_areas(corners), np.cumsum([len(facade.panels) for facade in model.site.facades]))[:-1]
    east, north, up = np.ptp(points, axis=0).tolist() if len(points) else (0.0, 0.0, 0.0)
    return SiteSummary(
        (east, north, up),
        len(model.building.triangles),
        tuple(
            FacadeSummary(facade.id, len(facade.panels), float(area.sum()))
            for facade, area in zip(model.site.facades, areas, strict=True)
        ),
    )


def with_new_site(document: Document, model: SiteModel, facades: FoundFacades | None = None) -> Document:
    """The document with another site, and without the plans, which were made for the one before.

    Parameters
    ----------
    facades
        How good its panels are, where they were found in photos.
    """
    return Document(site=model, request=document.request, found_facades=facades)


def shown_site(preview: ImportPreview) -> SiteModel | None:
    """A site to draw: the one the import brings, or the bare building where it cannot become one yet.

    None for buildings far too large, as when millimetres are read as metres.
    """
    if preview.model is not None:
        return preview.model
    source = preview.source
    points = source.building.corners_enu_m.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = preview.options.airspace_margin_m
    if max(np.abs(low).max(), np.abs(high).max()) + margin > MAX_COORDINATE_M:
        return None
    x = 0.5 * float(low[0] + high[0])
    x0, y0, z0 = (low - margin).tolist()
    x1, y1, z1 = (high + margin).tolist()
    site = Site(
        name=preview.path.stem,
        origin=source.placement.origin,
        facades=(),
        airspace=Airspace((x0, y0, z0 + margin), (x1, y1, z1), source.placement.ground_z_m),
        home_enu_m=(x, y0 + 0.5 * margin, source.placement.ground_z_m),
        building_mesh="building.ply",
    )
    return SiteModel(site, source.building)
