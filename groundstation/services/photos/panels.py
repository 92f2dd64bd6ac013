"""Use case after the first flight: photos and a coarse model become a site with its panels."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.poses import (
    RefinedOutcome,
    RefineRequest,
    choose_poses,
    described,
    findings_that_hold,
    refined_summary,
)
from groundstation.services.project.input_files import FileKind, kind_of, read_input_site
from groundstation.services.project.project_file import check_not_index
from planning.base.errors import InputError
from planning.base.findings import Finding
from planning.base.json_file import check_output, write_together
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin, Vec3
from planning.geo.mesh import TriangleMesh
from planning.photos.folder import read_photos
from planning.photos.places import Locality, PhotoHeights
from planning.site.file import site_bytes
from planning.site.importing.importer import check_ground, read_source, site_of_facades, write_imported_site
from planning.site.importing.options import ImportOptions
from planning.site.importing.source import SourceModel
from planning.site.records import Facade, Panel, SiteModel
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.panels_file import read_panels_folder
from reconstruction.panels.solving.accuracy import facades_path
from reconstruction.panels.solving.facades_file import facades_bytes
from reconstruction.panels.solving.find import FindParameters, FoundPanels, find_panels
from reconstruction.panels.solving.record import SolvedFacade
from reconstruction.photos.decode import colour_picture
from reconstruction.photos.poses import pose_photos

CORNER_DECIMALS = 4
"""0.1 mm, so that the file reads back as it was."""

STANDING_OUT_M = 5e-4
"""Three times what rounding moves a corner against the line between its neighbours."""


@dataclass(frozen=True, slots=True)
class CoarsePlace:
    """What photos are placed in before there is a site: name, origin, and the ground where the aircraft took off."""

    name: str
    origin: Origin
    home_enu_m: Vec3


@dataclass(frozen=True, slots=True, eq=False)
class PanelSearch:
    """What was found.

    Parameters
    ----------
    model
        The site as it was written.
    photos
        That were given a pose, in the order that `found` counts them.
    notes
        About the coarse model and the new site.
    refined
        What refining the poses has brought, where it was asked for.
    """

    model: SiteModel
    found: FoundPanels
    photos: tuple[PosedPhoto, ...]
    notes: tuple[str, ...]
    findings: tuple[Finding, ...]
    refined: RefinedOutcome | None = None


def find_panel_files(
    folder: Path,
    model: Path,
    out: Path,
    options: ImportOptions | None = None,
    parameters: FindParameters | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    grids: Path | None = None,
    monitor: Monitor = QUIET,
) -> PanelSearch:
    """Find the panels in a folder of photos and write them as a site, with a facades file beside it.

    Parameters
    ----------
    folder
        Photos of the first flight.
    model
        Mesh of the coarse model, any file that `site import` reads, or a site file whose facades are to be replaced.
    out
        Site file to write.
    options
        As for `site import`; not for a site.
    heights
        Which heights of the photos count.
    colmap
        Folder of a COLMAP model with better poses of the same photos.
    refine
        Whether poses are to be refined.
    grids
        Folder of panels files, such as corrected ones, in place of a search of their photos.

    Raises
    ------
    InputError
        The photos, the model, the COLMAP model or a panels file cannot be used, or the site cannot be written.
    InfeasibleError
        No panels were found.
    """
    options = options or ImportOptions()
    check_not_index(out)
    check_output(out, [model])
    known_grids = None if grids is None else read_panels_folder(grids)
    read = read_photos(folder, monitor, posed_elsewhere=colmap is not None)
    site_model = read_input_site(model) if kind_of(model) is FileKind.SITE else None
    without_panels = replace(options, panels_required=False)
    source = None if site_model is not None else read_source(model, without_panels, monitor)
    place, mesh = _place(model, site_model, source, options)
    posed = pose_photos(read.photos, place, folder, heights=heights, posed_elsewhere=colmap is not None)
    better = choose_poses(posed, folder, colmap, refine, monitor)
    photos = better.photos
    metadata = described(folder, read.photos, photos)

    def load(photo: PosedPhoto) -> NDArray[np.uint8]:
        return colour_picture(metadata[photo.name])

    found = find_panels(photos, mesh, load, parameters, monitor, known_grids)
    facades = tuple(site_facade(facade) for facade in found.facades)
    notes: tuple[str, ...] = ()
    other_files = {facades_path(out): facades_bytes(found, photos)}
    if site_model is not None:
        written = _rewritten(site_model, model, out, facades, other_files)
    else:
        assert source is not None
        imported = site_of_facades(model, source, facades, options, source.notes)
        written, notes = write_imported_site(out, imported, model, other_files), imported.notes
    return PanelSearch(
        written,
        found,
        photos,
        notes,
        (*read.findings, *findings_that_hold(posed, better), *better.findings, *found.findings),
        better.refined,
    )


def site_facade(facade: SolvedFacade) -> Facade:
    """As the site has it: panels row by row from the lower left."""
    return Facade(facade.id, tuple(Panel(panel.id, _corners(panel.corners_enu_m)) for panel in facade.panels))


def panel_search_summary(search: PanelSearch) -> dict[str, Any]:
    """For `--json`."""
    facades = search.found.facades
    return {
        "photos": len(search.photos),
        "panels": sum(len(facade.panels) for facade in facades),
        "facades": [
            {
                "id": facade.id,
                "rows": len(facade.rows) - 1,
                "columns": len(facade.columns) - 1,
                "panels": len(facade.panels),
                "photos": len(facade.pose_changes),
                "curvature_per_m": facade.surface.curvature_per_m,
                "corner_sigma_m": _usual_sigma_m(facade),
            }
            for facade in facades
        ],
        "effects": {
            name: [str(curvature), *map(str, search.found.search_decisions.get(name, ()))]
            for name, curvature in search.found.decisions.items()
        },
        "notes": list(search.notes),
        **({} if search.refined is None else {"refined": refined_summary(search.refined)}),
    }


def _usual_sigma_m(facade: SolvedFacade) -> float:
    traces = [np.trace(panel.covariance_m2, axis1=1, axis2=2) for panel in facade.panels]
    return float(np.sqrt(max(0.0, float(np.median(traces)))))


def _corners(corners_enu_m: NDArray[np.float64]) -> tuple[Vec3, Vec3, Vec3, Vec3]:
    """Rounded corners, shape (4, 3); one on the line between its neighbours, as a triangle has, is let stand out.

    Rounding would else turn it inwards, and panels are convex.
    """
    before, following, opposite = (np.roll(corners_enu_m, by, axis=0) for by in (1, -1, 2))
    chords = following - before
    off_m = np.linalg.norm(np.cross(chords, corners_enu_m - before), axis=1) / np.linalg.norm(chords, axis=1)
    outwards = corners_enu_m - opposite
    outwards = outwards / np.linalg.norm(outwards, axis=1, keepdims=True)
    corners_enu_m = corners_enu_m + np.where(off_m < STANDING_OUT_M, STANDING_OUT_M, 0.0)[:, None] * outwards
    a, b, c, d = (
        (round(float(x), CORNER_DECIMALS), round(float(y), CORNER_DECIMALS), round(float(z), CORNER_DECIMALS))
        for x, y, z in corners_enu_m
    )
    return a, b, c, d


def _place(
    path: Path, site_model: SiteModel | None, source: SourceModel | None, options: ImportOptions
) -> tuple[Locality, TriangleMesh]:
    if source is not None:
        check_ground(path, source)
        ground_m = source.placement.ground_z_m
        name = options.name or source.name or path.stem
        return CoarsePlace(name, source.placement.origin, (0.0, 0.0, ground_m)), source.building
    assert site_model is not None
    if not len(site_model.building.triangles):
        raise InputError(
            say("the site has no building mesh, and panels are found on one; name a mesh instead", place=path)
        )
    return site_model.site, site_model.building


def _rewritten(
    model: SiteModel, source: Path, out: Path, facades: tuple[Facade, ...], other_files: Mapping[Path, bytes]
) -> SiteModel:
    """The site with other facades, and files that belong to it; its meshes and geo-zones stay where they are."""

    def moved(name: str) -> str:
        return Path(os.path.relpath(source.parent / name, out.parent)).as_posix()

    def moved_mesh(name: str | None) -> str | None:
        return None if name is None else moved(name)

    sources = {each: replace(each, file=moved(each.file)) for each in model.site.zones}
    site = replace(
        model.site,
        facades=facades,
        building_mesh=moved_mesh(model.site.building_mesh),
        obstacles=tuple(replace(obstacle, mesh=moved_mesh(obstacle.mesh)) for obstacle in model.site.obstacles),
        zones=tuple(sources.values()),
    )
    content = site_bytes(site)
    write_together({out: content, **other_files})
    zones = tuple(replace(each, source=sources.get(each.source, each.source)) for each in model.zones)
    return replace(model, site=site, zones=zones, sha256=hashlib.sha256(content).hexdigest())
