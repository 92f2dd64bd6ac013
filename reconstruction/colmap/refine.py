"""Refining camera poses: features are matched and all rays adjusted together, held by the photos' own positions.

The work is COLMAP's (J. Schoenberger and J.-M. Frahm, "Structure-from-Motion Revisited", CVPR 2016), where pycolmap is
installed. The steps: SIFT features; matches between neighbours; an incremental model in a frame of its own; that model
laid into the site by a robust similarity; a bundle adjustment with the photos' positions and their covariances as
observations; and the model laid into the site again, by positions and angles.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.colmap.accuracy import pose_covariances
from reconstruction.colmap.block_inverse import TooLargeError
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import Georeference, georeference, in_enu, posed_photos
from reconstruction.colmap.pycolmap_run import (
    DEFAULT_PARAMETERS,
    LEAST_PHOTOS,
    ColmapRun,
    RefineParameters,
    load_colmap,
)
from reconstruction.colmap.record import ColmapModel
from reconstruction.colmap.similarity import Similarity


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """Refined cameras.

    Parameters
    ----------
    photos
        Those that found a place in the model, in the order given; with covariance, unless nothing fixes the model.
    model
        In the site's frame.
    georeference
        How the adjusted model met the photos' positions and angles.
    reprojection_px
        Mean distance of the image points from where the model has them, pixels of the full photos.
    left_out
        Names of photos that found no place.
    """

    photos: tuple[PosedPhoto, ...]
    model: ColmapModel
    georeference: Georeference
    reprojection_px: float
    left_out: tuple[str, ...]
    findings: tuple[Finding, ...]


def refine_poses(
    photos: Sequence[PosedPhoto],
    folder: Path,
    parameters: RefineParameters = DEFAULT_PARAMETERS,
    monitor: Monitor = QUIET,
) -> Refinement:
    """Refine the poses and lenses of photos.

    Photos with the same intrinsics share a camera, whose focal length and distortion are refined; a distortion with a
    third radial term is a calibration, and stays.

    Parameters
    ----------
    folder
        What the photos' names are paths below.

    Raises
    ------
    InputError
        There are too few photos, or pycolmap is not installed.
    ReconstructionError
        The photos do not fit together.
    """
    if len(photos) < LEAST_PHOTOS:
        raise InputError(
            say("refining cameras needs at least {} photos with a pose, got {}", LEAST_PHOTOS, len(photos))
        )
    colmap = load_colmap()
    with tempfile.TemporaryDirectory(prefix="reflight-colmap-") as name:
        work = ColmapRun(colmap, Path(name), folder, photos, parameters, monitor)
        fixed_cameras = work.find_features()
        work.match()
        free = work.map(fixed_cameras)
        laid = georeference(_as_model(free, Path(name) / "free"), photos, parameters.seed)
        _transform(colmap, free, laid.enu_from_model)
        if not laid.on_a_line:
            work.adjust(free, fixed_cameras)
        model = _as_model(free, Path(name) / "adjusted")
        error_px = float(free.compute_mean_reprojection_error())
    # The adjustment knows positions alone; the last word on where the model lies is that of positions and angles.
    laid = georeference(model, photos, parameters.seed)
    model = in_enu(model, laid.enu_from_model)
    covariances, unsure = _covariances(model, laid, photos, monitor)
    times = {photo.name: photo.taken_at for photo in photos}
    found = {photo.name: photo for photo in posed_photos(model, Similarity.identity(), folder, times)}
    refined = tuple(
        replace(
            found[photo.name],
            path=photo.path,
            pose=replace(found[photo.name].pose, covariance=covariances.get(photo.name)),
        )
        for photo in photos
        if photo.name in found
    )
    left_out = tuple(photo.name for photo in photos if photo.name not in found)
    findings = (*laid.findings, *unsure, *_left_out(left_out, len(photos)))
    return Refinement(refined, model, laid, error_px, left_out, findings)


def _covariances(
    model: ColmapModel, laid: Georeference, photos: Sequence[PosedPhoto], monitor: Monitor
) -> tuple[dict[str, NDArray[np.float64]], list[Finding]]:
    """Of every image, by name; all alike where computing them would take too much memory."""
    try:
        return pose_covariances(model, {photo.name: photo for photo in photos}, monitor), []
    except TooLargeError:
        text = say(
            "the photos are linked with each other too closely for the accuracy of each pose to be computed; "
            "all count as equally good"
        )
        covariances = {image.name: laid.usual_covariance for image in model.images.values()}
        return covariances, [Finding(Severity.NOTE, "accuracy-estimated", text)]


def _as_model(reconstruction: Any, folder: Path) -> ColmapModel:
    folder.mkdir()
    reconstruction.write_binary(folder)
    return read_model(folder)


def _transform(colmap: Any, reconstruction: Any, similarity: Similarity) -> None:
    turned = colmap.Sim3d(similarity.scale, colmap.Rotation3d(similarity.rotation), similarity.translation)
    reconstruction.transform(turned)


def _left_out(names: Sequence[str], n_all: int) -> list[Finding]:
    if not names:
        return []
    text = say(
        "{} of {} photos found no place in the model, the first {}; they keep their own poses",
        len(names),
        n_all,
        names[0],
    )
    return [Finding(Severity.WARNING, "photos-not-refined", text, "", float(len(names)), 0.0, "photos")]
