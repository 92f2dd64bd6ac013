"""Use case after the second flight: its photos and the site's panels become the data set that is reconstructed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.photos.intake import PhotoIntake
from groundstation.services.photos.poses import (
    ChosenPoses,
    RefinedOutcome,
    RefineRequest,
    photos_alone,
    photos_with_poses,
    poses_within,
    refined_summary,
    with_masks,
)
from groundstation.services.project.input_files import read_input_site
from planning.base.errors import InputError
from planning.base.findings import Finding
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin
from planning.geo.mesh import MAX_COORDINATE_M, empty_mesh
from planning.photos.places import PhotoHeights
from planning.site.records import Airspace, Site, SiteModel
from reconstruction.dataset.prepare import PreparedData, PrepareParameters, prepare


@dataclass(frozen=True, slots=True, eq=False)
class PreparedFiles:
    """A data set that was written.

    Parameters
    ----------
    findings
        About the photos, their poses and the data set.
    refined
        What refining the poses brought; None where they were not refined.
    """

    data: PreparedData
    findings: tuple[Finding, ...]
    refined: RefinedOutcome | None


def prepare_files(
    folder: Path,
    site: Path | None,
    out: Path,
    parameters: PrepareParameters | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    monitor: Monitor = QUIET,
) -> PreparedFiles:
    """Write the data set of a folder of photos.

    Parameters
    ----------
    site
        None for plain splats in the frame of a model of another program, which lies in the folder or is named.

    Raises
    ------
    InputError
        Photos, site or COLMAP model cannot be used, poses cannot be refined, or the data set cannot be written.
    """
    if site is not None and poses_within(site) is not None and not (site / "site.json").is_file():
        raise InputError(say("is a folder with a model of poses, and no site; name it with --colmap", place=site))
    if site is None:
        if refine is not None:
            raise InputError(say("poses are refined in the frame of a site; name it, or leave --refine out"))
        alone = photos_alone(folder, colmap, heights=heights, monitor=monitor)
        chosen = alone.chosen
        plain = _bare_site(folder.resolve().name, alone.origin, chosen)
        prepared = prepare(chosen.photos, plain, out, parameters, monitor, chosen.points_enu_m, alone.enu_from_model)
        return PreparedFiles(prepared, (*chosen.findings, *prepared.findings), None)
    model = read_input_site(site)
    better = photos_with_poses(folder, model.site, heights=heights, colmap=colmap, refine=refine, monitor=monitor)
    better = with_masks(better, folder)
    prepared = prepare(better.photos, model, out, parameters, monitor, better.points_enu_m)
    return PreparedFiles(prepared, (*better.findings, *prepared.findings), better.refined)


AROUND_PERCENT, AROUND_M = 1.0, 1.0
"""Of points that may be mismatches, on each side of the bounds of a place without a site; and around those."""


def _bare_site(name: str, origin: Origin | None, chosen: ChosenPoses) -> SiteModel:
    """A place with nothing on it that holds photos and points."""
    places = np.array([photo.pose.position_enu_m for photo in chosen.photos])
    if chosen.points_enu_m is not None:
        bounds = np.percentile(chosen.points_enu_m, (AROUND_PERCENT, 100.0 - AROUND_PERCENT), axis=0)
        places = np.concatenate([places, bounds])
    low = np.clip(places.min(axis=0) - AROUND_M, -MAX_COORDINATE_M, MAX_COORDINATE_M - AROUND_M)
    high = np.clip(places.max(axis=0) + AROUND_M, low + AROUND_M, MAX_COORDINATE_M)
    (x, y, z), (east, north, up) = low.tolist(), high.tolist()
    air = Airspace((x, y, z), (east, north, up), z)
    known = Origin(0.0, 0.0, 0.0) if origin is None else origin
    site = Site(name, known, (), air, (x, y, z), place_from="" if origin else "unknown", is_bare=True)
    return SiteModel(site, empty_mesh())


def prepare_read(intake: PhotoIntake, model: SiteModel, out: Path, monitor: Monitor = QUIET) -> PreparedData:
    """Write the data set of photos that were read already, with the poses that they have by now.

    Raises
    ------
    InputError
        There are no photos with a pose, none can be read, or the data set cannot be written.
    """
    chosen = with_masks(replace(intake.better, photos=intake.photos, findings=()), intake.folder)
    prepared = prepare(chosen.photos, model, out, monitor=monitor, cloud=chosen.points_enu_m)
    return replace(prepared, findings=(*chosen.findings, *prepared.findings))


def prepared_summary(prepared: PreparedFiles) -> dict[str, Any]:
    """For `--json`."""
    data = prepared.data
    return {
        "dataset": str(data.folder),
        "photos": len(data.photos),
        "effects": {decision.effect: str(decision) for decision in data.decisions},
        **({} if prepared.refined is None else {"refined": refined_summary(prepared.refined)}),
    }
