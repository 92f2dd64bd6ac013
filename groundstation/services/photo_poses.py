"""Poses of photos for all that is done with them: their own, or those of a COLMAP model of the same photos."""

from __future__ import annotations

from pathlib import Path

from planning.findings import Finding
from reconstruction.cameras import PosedPhoto
from reconstruction.colmap.folder import read_model
from reconstruction.colmap.georeference import georeference, posed_photos
from reconstruction.photos.poses import PhotoSet


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
    better = posed_photos(model, reference.enu_from_model, folder, times)
    return tuple(photo for photo in better if photo.name in times), reference.findings
