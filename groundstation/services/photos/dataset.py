"""Use case after the second flight: its photos and the site's panels become the data set that is reconstructed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from groundstation.services.photos.intake import PhotoIntake
from groundstation.services.photos.poses import (
    RefinedOutcome,
    RefineRequest,
    photos_with_poses,
    refined_summary,
)
from groundstation.services.project.input_files import read_input_site
from planning.base.findings import Finding
from planning.base.progress import QUIET, Monitor
from planning.photos.places import PhotoHeights
from planning.site.records import SiteModel
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
    site: Path,
    out: Path,
    parameters: PrepareParameters | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    monitor: Monitor = QUIET,
) -> PreparedFiles:
    """Write the data set of a folder of photos.

    Raises
    ------
    InputError
        Photos, site or COLMAP model cannot be used, poses cannot be refined, or the data set cannot be written.
    """
    model = read_input_site(site)
    better = photos_with_poses(folder, model.site, heights=heights, colmap=colmap, refine=refine, monitor=monitor)
    prepared = prepare(better.photos, model, out, parameters, monitor, better.points_enu_m)
    return PreparedFiles(prepared, (*better.findings, *prepared.findings), better.refined)


def prepare_read(intake: PhotoIntake, model: SiteModel, out: Path, monitor: Monitor = QUIET) -> PreparedData:
    """Write the data set of photos that were read already, with the poses that they have by now.

    Raises
    ------
    InputError
        There are no photos with a pose, none can be read, or the data set cannot be written.
    """
    return prepare(intake.photos, model, out, monitor=monitor, cloud=intake.better.points_enu_m)


def prepared_summary(prepared: PreparedFiles) -> dict[str, Any]:
    """For `--json`."""
    data = prepared.data
    return {
        "dataset": str(data.folder),
        "photos": len(data.photos),
        "effects": {decision.effect: str(decision) for decision in data.decisions},
        **({} if prepared.refined is None else {"refined": refined_summary(prepared.refined)}),
    }
