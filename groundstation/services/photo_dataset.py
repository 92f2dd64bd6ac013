"""Use case after the second flight: its photos and the site's panels become the data set that is reconstructed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from groundstation.services.given_files import read_given_site
from groundstation.services.photo_poses import RefineWish, better_poses, still_true
from planning.findings import Finding
from planning.photo_files.folder import read_photos
from planning.photo_files.places import PhotoHeights
from planning.progress import QUIET, Monitor
from reconstruction.dataset.prepare import PreparedData, PrepareParameters, prepare
from reconstruction.photos.poses import pose_photos


def prepare_files(
    folder: Path,
    site: Path,
    out: Path,
    parameters: PrepareParameters | None = None,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineWish | None = None,
    monitor: Monitor = QUIET,
) -> tuple[PreparedData, tuple[Finding, ...]]:
    """Write the data set of a folder of photos; the second value are findings about all of them.

    Raises
    ------
    InputError
        Photos, site or COLMAP model cannot be used, poses cannot be refined, or the data set cannot be written.
    """
    model = read_given_site(site)
    read = read_photos(folder, monitor)
    posed = pose_photos(read.photos, model.site, folder, heights=heights)
    better = better_poses(posed, folder, colmap, refine, monitor)
    prepared = prepare(better.photos, model, out, parameters, monitor)
    return prepared, (*read.findings, *still_true(posed.findings, better), *better.findings, *prepared.findings)


def prepared_summary(prepared: PreparedData) -> dict[str, Any]:
    """For `--json`."""
    return {
        "dataset": str(prepared.folder),
        "photos": len(prepared.photos),
        "effects": {decision.effect: str(decision) for decision in prepared.decisions},
    }
