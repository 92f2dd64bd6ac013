"""Poses of photos for all that is done with them: their own, or those of a COLMAP model of the same photos."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.findings import Finding
from reconstruction.cameras import PosedPhoto
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import Georeference, georeference, posed_photos
from reconstruction.photos.poses import PhotoSet

LEAST_SIGMA_M = 0.02
ADJUSTED_SIGMA_DEG = 0.1
"""Standard deviations of poses after a bundle adjustment, position and angles: a tenth of a degree is a pixel or two at
the focal lengths of drones, which no adjustment leaves."""


def better_poses(
    posed: PhotoSet, colmap: Path | None, folder: Path
) -> tuple[tuple[PosedPhoto, ...], tuple[Finding, ...]]:
    """The photos' own poses, or where a COLMAP model is named its poses, brought into the site's frame by those.

    Photos that are not in the model are left out.

    Raises
    ------
    InputError
        The model cannot be read, or does not fit the photos.
    """
    if colmap is None:
        return posed.photos, ()
    model = read_model(colmap)
    reference = georeference(model, posed.photos)
    times = {photo.name: photo.taken_at for photo in posed.photos}
    covariance = _covariance(reference)
    better = posed_photos(model, reference.enu_from_model, folder, times)
    known = (photo for photo in better if photo.name in times)
    return tuple(replace(photo, pose=replace(photo.pose, covariance=covariance)) for photo in known), reference.findings


def _covariance(reference: Georeference) -> NDArray[np.float64]:
    """Of every pose: as good as the model lies in the site, and no better than bundle adjustments usually are."""
    residuals = reference.residuals_m[reference.is_inlier]
    spread_m = float(np.sqrt((residuals**2).mean())) if len(residuals) else 0.0
    position_m = max(LEAST_SIGMA_M, spread_m / np.sqrt(max(1, len(residuals))))
    return np.diag([position_m**2] * 3 + [np.radians(ADJUSTED_SIGMA_DEG) ** 2] * 3)
