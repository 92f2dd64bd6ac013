"""Refined poses as a folder: a COLMAP model in the site's frame, and a file with what such a model cannot hold.

Format `reflight-refined/1`, `refined.json`: which photos with which poses were refined, how, and each covariance.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.findings import Finding, Severity
from planning.base.json_file import expect_format, part_folder, read_json, to_record, write_atomically
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import Similarity, posed_photos, position_covariance
from reconstruction.colmap.pycolmap_run import RefineParameters
from reconstruction.colmap.refine import Refinement
from reconstruction.photos.decode import PICTURE_FILE

# Which refined poses are believed: compared, photo by photo, with what the photos say of themselves.
#
# A photo whose features fit a wrong place of a facade that repeats itself is metres off, and one that few features
# hold
# is known worse than before. Such photos keep their own poses, and the user is told. An error that all cameras'
# angles
# share is a compass's, not the model's, and counts against none.

Array = NDArray[np.float64]

UNSTATED_SIGMA_M = 0.05
"""What receivers' standard deviations leave out: lever arm, and the time of the exposure (10 ms at 5 m/s). Our choice;
with RTK, positions may then differ by 0.2 m."""

MOST_SIGMAS = 4.03
"""Distance in standard deviations of three axes that one in a thousand errors passes (chi-square, 3 degrees)."""

NO_BETTER = 1.0
"""Standard deviations of position and angles both above this part of the photo's own: nothing was gained."""

LEAST_SHARE = 0.5
"""Of the photos in the model that must be believed; else the model as a whole is wrong, and none is."""


@dataclass(frozen=True, slots=True, eq=False)
class JudgedPoses:
    """Poses to go on with.

    Parameters
    ----------
    photos
        All that were given, in their order: refined, or as they were.
    is_refined
        Of each of them.
    moved_m, turned_deg
        By how much those that are refined differ from their own poses.
    findings
        About photos whose refined pose was refused, and about angles that are off in common.
    """

    photos: tuple[PosedPhoto, ...]
    is_refined: tuple[bool, ...]
    moved_m: Array
    turned_deg: Array
    findings: tuple[Finding, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Difference:
    """Refined pose against the photo's own: lengths in the own one's standard deviations, and what they measure."""

    moved_m: float
    turned_deg: float
    position_sigmas: float
    angle_sigmas: float


def judge_poses(stated: Sequence[PosedPhoto], refined: Sequence[PosedPhoto]) -> JudgedPoses:
    """Take over refined poses that are believed.

    Parameters
    ----------
    stated
        Photos with the poses that their metadata give.
    refined
        Of these photos those that found a place in the model.
    """
    found = {photo.name: photo for photo in refined}
    paired = [(photo, found[photo.name]) for photo in stated if photo.name in found]
    common = _common_turn(paired)
    differences = {own.name: _difference(own, other, common) for own, other in paired}
    refused = [_refusal(own, other, differences[own.name]) for own, other in paired]
    findings = [finding for finding in refused if finding is not None]
    keeps_own = {finding.place for finding in findings}
    if paired:
        findings += _common_findings(common, [own for own, _ in paired])
    if len(keeps_own) > (1.0 - LEAST_SHARE) * len(paired):
        text = say(
            "{} of {} refined poses were refused, so none is used: all photos keep their own",
            len(keeps_own),
            len(paired),
        )
        findings.append(Finding(Severity.WARNING, "refinement-refused", text, "", float(len(keeps_own)), 0.0, "photos"))
        keeps_own = set(differences)
    is_refined = tuple(photo.name in found and photo.name not in keeps_own for photo in stated)
    taken = [differences[photo.name] for photo, is_taken in zip(stated, is_refined, strict=True) if is_taken]
    return JudgedPoses(
        tuple(found[photo.name] if taken else photo for photo, taken in zip(stated, is_refined, strict=True)),
        is_refined,
        np.array([difference.moved_m for difference in taken]),
        np.array([difference.turned_deg for difference in taken]),
        tuple(findings),
    )


def _common_turn(paired: Sequence[tuple[PosedPhoto, PosedPhoto]]) -> Array:
    """Rotation vector, ENU, rad, shape (3,), from refined to own orientations: the median of all, axis by axis."""
    turns = [_vector(other.pose.cam_from_enu.T @ own.pose.cam_from_enu) for own, other in paired]
    return np.asarray(np.median(turns, axis=0)) if turns else np.zeros(3)


def _difference(own: PosedPhoto, refined: PosedPhoto, common: Array) -> _Difference:
    moved = refined.pose.position_enu_m - own.pose.position_enu_m
    turned = own.pose.cam_from_enu @ refined.pose.cam_from_enu.T
    left = _vector(own.pose.cam_from_enu @ cv2.Rodrigues(common)[0].T @ refined.pose.cam_from_enu.T)
    return _Difference(
        float(np.linalg.norm(moved)),
        math.degrees(float(np.linalg.norm(_vector(turned)))),
        _in_sigmas(moved, position_covariance(own) + UNSTATED_SIGMA_M**2 * np.eye(3)),
        _in_sigmas(left, _angle_covariance(own)),
    )


def _refusal(own: PosedPhoto, refined: PosedPhoto, difference: _Difference) -> Finding | None:
    """Why a refined pose is not believed; None where it is."""
    known = refined.pose.covariance
    if known is None:
        text = say("nothing fixes where the refined model lies; the photo keeps its own pose")
        return Finding(Severity.WARNING, "refined-pose-loose", text, own.name)
    if difference.position_sigmas > MOST_SIGMAS:
        text = say(
            "its refined position is {:.2f} m from its own, which is {:.1f} standard deviations; the photo "
            "keeps its own pose",
            difference.moved_m,
            difference.position_sigmas,
        )
        return _contradicts(text, own.name, difference.position_sigmas)
    if difference.angle_sigmas > MOST_SIGMAS:
        text = say(
            "its refined angles are {:.1f} degrees from its own, which is {:.1f} standard deviations more "
            "than for the others; the photo keeps its own pose",
            difference.turned_deg,
            difference.angle_sigmas,
        )
        return _contradicts(text, own.name, difference.angle_sigmas)
    position = math.sqrt(float(np.trace(known[:3, :3]) / np.trace(position_covariance(own))))
    angles = math.sqrt(float(np.trace(known[3:, 3:]) / np.trace(_angle_covariance(own))))
    worse = min(position, angles)
    if worse > NO_BETTER:
        text = say("its refined pose is known {:.1f} times worse than its own; the photo keeps its own pose", worse)
        return Finding(Severity.WARNING, "refined-pose-no-better", text, own.name, worse, NO_BETTER)
    return None


def _contradicts(text: str, name: str, sigmas: float) -> Finding:
    return Finding(Severity.WARNING, "refined-pose-contradicts", text, name, sigmas, MOST_SIGMAS)


def _common_findings(common: Array, stated: Sequence[PosedPhoto]) -> list[Finding]:
    """Whether all angles are off by more than they are said to be."""
    in_enu = [photo.pose.cam_from_enu.T @ _angle_covariance(photo) @ photo.pose.cam_from_enu for photo in stated]
    sigmas = _in_sigmas(common, np.median(in_enu, axis=0))
    if sigmas <= MOST_SIGMAS:
        return []
    degrees = math.degrees(float(np.linalg.norm(common)))
    text = say(
        "the angles of all photos are off by {:.1f} degrees in common, so it is the compass or the "
        "gimbal; refined poses are free of it",
        degrees,
    )
    return [Finding(Severity.NOTE, "angles-off-in-common", text, "", sigmas, MOST_SIGMAS)]


def _angle_covariance(photo: PosedPhoto) -> Array:
    """Shape (3, 3), rad^2, camera axes; where nothing is known, any angle is possible."""
    return math.pi**2 * np.eye(3) if photo.pose.covariance is None else np.array(photo.pose.covariance[3:, 3:])


def _in_sigmas(vector: Array, covariance: Array) -> float:
    return math.sqrt(float(vector @ np.linalg.solve(covariance, vector)))


def _vector(rotation: Array) -> Array:
    """Rotation vector, rad, shape (3,)."""
    return np.asarray(cv2.Rodrigues(rotation)[0], np.float64).ravel()


FORMAT = "reflight-refined/1"
FILE = "refined.json"

LENGTH_DECIMALS, TURN_DECIMALS = 4, 7
"""Poses that agree to 0.1 mm and 1e-7 rad are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class StoredRefinement:
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
    """Checksum of photos: their names, sizes and masks, and poses by their metadata, in the site's frame.

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
        masks = [] if photo.mask is None else [hashlib.sha256(read_input_file(photo.mask, PICTURE_FILE)).hexdigest()]
        said = (photo.name, n_bytes, place.tolist(), turn.tolist(), photo.intrinsics, *masks)
        digest.update(repr(said).encode())
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
            model_folder = waiting / "model"
            write_model(model_folder, refinement.model)
            write_atomically(model_folder / FILE, json.dumps(asdict(record), indent=1).encode())
            if folder.exists():
                folder.replace(waiting / "before")
            model_folder.replace(folder)
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


def read_refined(folder: Path, photos: Sequence[PosedPhoto]) -> StoredRefinement:
    """Refined poses as they were written, for the photos at hand.

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
    return StoredRefinement(
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
