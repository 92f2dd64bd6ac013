"""Refined poses as a folder: a COLMAP model in the site's frame, and a file with what such a model cannot hold.

Format `reflight-refined/1`, `refined.json`: which photos with which poses were refined, how, and each covariance.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.findings import Finding
from planning.base.json_file import expect_format, part_folder, read_json, to_record, write_atomically
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import posed_photos
from reconstruction.colmap.pycolmap_run import RefineParameters
from reconstruction.colmap.refine import Refinement
from reconstruction.colmap.similarity import Similarity

FORMAT = "reflight-refined/1"
FILE = "refined.json"

LENGTH_DECIMALS, TURN_DECIMALS = 4, 7
"""Poses that agree to 0.1 mm and 1e-7 rad are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class KeptRefinement:
    """What a folder holds.

    Parameters
    ----------
    photos_sha256
        `fingerprint` of the photos that were refined.
    photos
        Those that found a place in the model; with covariance, where the model is fixed.
    reprojection_px, left_out, findings
        As of the `Refinement`.
    """

    photos_sha256: str
    parameters: RefineParameters
    photos: tuple[PosedPhoto, ...]
    reprojection_px: float
    left_out: tuple[str, ...]
    findings: tuple[Finding, ...]


@dataclass(frozen=True, slots=True)
class _Photo:
    name: str
    covariance: list[list[float]] | None


@dataclass(frozen=True, slots=True)
class _Record:
    format: str
    photos_sha256: str
    parameters: RefineParameters
    reprojection_px: float
    photos: list[_Photo]
    left_out: list[str]
    findings: list[Finding]


def fingerprint(photos: Sequence[PosedPhoto]) -> str:
    """Checksum of photos: their names, sizes and poses as their metadata give them, in the site's frame.

    Raises
    ------
    InputError
        A photo cannot be read any more.
    """
    digest = hashlib.sha256()
    for photo in sorted(photos, key=lambda one: one.name):
        try:
            n_bytes = photo.path.stat().st_size
        except OSError as error:
            raise InputError(say("cannot be read any more ({})", error.strerror or error, place=photo.path)) from error
        place = np.round(photo.pose.position_enu_m, LENGTH_DECIMALS) + 0.0  # no negative zero
        turn = np.round(photo.pose.cam_from_enu, TURN_DECIMALS) + 0.0
        digest.update(repr((photo.name, n_bytes, place.tolist(), turn.tolist(), photo.intrinsics)).encode())
    return digest.hexdigest()


def is_refined_folder(folder: Path) -> bool:
    """Whether a folder was written by `write_refined`."""
    return (folder / FILE).is_file()


def write_refined(
    folder: Path, refinement: Refinement, photos: Sequence[PosedPhoto], parameters: RefineParameters
) -> None:
    """Write a refinement; another one in the same folder is replaced, once this one is whole.

    Parameters
    ----------
    photos
        As they were given to be refined.

    Raises
    ------
    InputError
        The folder holds something else, or cannot be written.
    """
    check_refined_folder(folder)
    record = _Record(
        FORMAT,
        fingerprint(photos),
        parameters,
        refinement.reprojection_px,
        [_Photo(photo.name, _listed(photo.pose.covariance)) for photo in refinement.photos],
        list(refinement.left_out),
        list(refinement.findings),
    )
    try:
        with part_folder(folder.parent, folder.name) as waiting:
            made = waiting / "model"
            write_model(made, refinement.model)
            write_atomically(made / FILE, json.dumps(asdict(record), indent=1).encode())
            if folder.exists():
                folder.replace(waiting / "before")
            made.replace(folder)
    except OSError as error:
        raise InputError(
            say("cannot be written ({}); name another folder", error.strerror or error, place=folder)
        ) from error


def check_refined_folder(folder: Path) -> None:
    """Find out before long work that its result could not be written.

    Raises
    ------
    InputError
        The folder holds something else, or there is no folder that it could be made in.
    """
    if not folder.parent.is_dir():
        raise InputError(say("expected a folder to write into, found none", place=folder.parent))
    if not os.access(folder.parent, os.W_OK):
        raise InputError(say("is write-protected; name another folder for refined poses", place=folder.parent))
    if folder.exists() and not is_refined_folder(folder) and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(say("holds something other than refined poses; name another folder", place=folder))


def read_refined(folder: Path, photos: Sequence[PosedPhoto]) -> KeptRefinement:
    """Refined poses as they were written, for the photos in hand.

    Parameters
    ----------
    photos
        Give the times and places of the files.

    Raises
    ------
    InputError
        A file is missing or damaged.
    """
    path = folder / FILE
    content = read_json(path, names_files=True)
    expect_format(content, FORMAT, path)
    record: _Record = to_record(content, _Record, path)
    by_name = {photo.name: photo for photo in photos}
    covariances = {photo.name: _array(photo, path) for photo in record.photos}
    model = read_model(folder)
    found = posed_photos(model, Similarity.identity(), folder)
    if {photo.name for photo in found} != set(covariances):
        raise InputError(say("names other photos than the model beside it", place=path))
    refined = tuple(
        replace(
            photo,
            path=by_name[photo.name].path,
            taken_at=by_name[photo.name].taken_at,
            pose=replace(photo.pose, covariance=covariances[photo.name]),
        )
        for photo in found
        if photo.name in by_name
    )
    return KeptRefinement(
        record.photos_sha256,
        record.parameters,
        refined,
        record.reprojection_px,
        tuple(record.left_out),
        tuple(record.findings),
    )


def _listed(covariance: NDArray[np.float64] | None) -> list[list[float]] | None:
    return None if covariance is None else covariance.tolist()


def _array(photo: _Photo, path: Path) -> NDArray[np.float64] | None:
    if photo.covariance is None:
        return None
    sizes = {len(row) for row in photo.covariance}
    if len(photo.covariance) != 6 or sizes != {6}:
        raise InputError(say("photo '{}': expected a covariance of 6 rows of 6 numbers", photo.name, place=path))
    found = np.array(photo.covariance, np.float64)
    if np.linalg.eigvalsh(0.5 * (found + found.T)).min() <= 0.0:
        raise InputError(say("photo '{}': expected a covariance, got a matrix that is none", photo.name, place=path))
    return found
