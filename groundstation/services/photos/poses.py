"""Poses of photos for all that is done with them: their own, those of a COLMAP model, or refined ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.photos.folder import is_other_picture, read_photos
from planning.photos.places import Locality, PhotoHeights
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import PosedPhoto
from reconstruction.colmap.folder import Frame, read_frame, read_model
from reconstruction.colmap.georeference import (
    ADJUSTED_SIGMA_DEG,
    ADJUSTED_SIGMA_M,
    Similarity,
    georeference,
    named_below,
    posed_photos,
)
from reconstruction.colmap.pycolmap_run import RefineParameters, load_colmap
from reconstruction.colmap.record import ColmapModel
from reconstruction.colmap.refine import refine_poses
from reconstruction.colmap.refined_folder import (
    StoredRefinement,
    check_refined_folder,
    fingerprint,
    is_refined_folder,
    judge_poses,
    read_refined,
    write_refined,
)
from reconstruction.photos.poses import UNPOSED, PhotoSet, name_in, pose_photos, unposed_findings

LENS_UNKNOWN = "lens-distortion-unknown"
"""Code of the finding that advises to refine cameras."""

USUAL_FRAME = Frame(position_sigma_m=ADJUSTED_SIGMA_M, angle_sigma_deg=ADJUSTED_SIGMA_DEG)
"""Of models that say nothing of their frame, where photos do not say it either."""

REFINED_SUFFIX = ".refined"
"""Of the folder beside that of the photos."""


@dataclass(frozen=True, slots=True)
class RefineRequest:
    """That poses are to be refined.

    Parameters
    ----------
    folder
        Where refined poses are kept; None for beside the photos. What is there is taken if it is of the same photos.
    max_image_size_px
        What photos are reduced to; None for the usual, and for whatever was kept.
    find_lens
        Whether lenses are found against what the photos state; None for the usual, and for whatever was kept.
    """

    folder: Path | None = None
    max_image_size_px: int | None = None
    find_lens: EffectSetting | None = None

    def __post_init__(self) -> None:
        if self.max_image_size_px is not None and self.max_image_size_px < 1:
            raise ValueError(f"max_image_size_px: expected at least 1, got {self.max_image_size_px}")

    def kept_in(self, photos: Path) -> Path:
        """Folder of refined poses, for a folder of photos.

        Raises
        ------
        InputError
            The photos are the root of a drive, which nothing can lie beside.
        """
        if self.folder is not None:
            return self.folder
        whole = photos.absolute()
        if not whole.name:
            raise InputError(
                say("is a whole drive, and refined poses cannot lie beside it; copy the photos first", place=photos)
            )
        return whole.with_name(whole.name + REFINED_SUFFIX)


@dataclass(frozen=True, slots=True)
class RefinedOutcome:
    """What a refinement has brought.

    Parameters
    ----------
    folder
        Where it is kept.
    n_refined, n_photos
        Photos with refined poses, and all.
    moved_m, turned_deg
        By how much they differ from their own poses: in the middle, and at most.
    reprojection_px
        Mean distance of image points from where the model has them.
    not_joined
        Names of photos that found no place in the model.
    was_kept
        Whether it had been computed before.
    """

    folder: Path
    n_refined: int
    n_photos: int
    moved_m: tuple[float, float]
    turned_deg: tuple[float, float]
    reprojection_px: float
    not_joined: tuple[str, ...]
    was_kept: bool


@dataclass(frozen=True, slots=True, eq=False)
class ChosenPoses:
    """Photos to go on with.

    Parameters
    ----------
    refined
        None where nothing was refined.
    points_enu_m
        Of the COLMAP model that the poses are of, shape (n, 3); None where they are of none.
    """

    photos: tuple[PosedPhoto, ...]
    findings: tuple[Finding, ...] = ()
    refined: RefinedOutcome | None = None
    points_enu_m: NDArray[np.float64] | None = None


def photos_with_poses(
    folder: Path,
    site: Locality,
    *,
    heights: PhotoHeights = "auto",
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    monitor: Monitor = QUIET,
) -> ChosenPoses:
    """The photos of a folder with the best poses asked for, and all findings about both.

    Raises
    ------
    InputError, ReconstructionError
        As `choose_poses`, or photos cannot be used.
    """
    read = read_photos(folder, monitor, posed_elsewhere=colmap is not None)
    posed = pose_photos(read.photos, site, folder, heights=heights, posed_elsewhere=colmap is not None)
    better = choose_poses(posed, folder, colmap, refine, monitor)
    findings = (*read.findings, *findings_that_hold(posed, better), *better.findings)
    return replace(better, findings=findings)


def choose_poses(
    posed: PhotoSet,
    folder: Path,
    colmap: Path | None = None,
    refine: RefineRequest | None = None,
    monitor: Monitor = QUIET,
) -> ChosenPoses:
    """The photos' own poses, or better ones where they are asked for.

    A COLMAP model is brought into the site's frame by the photos' own poses; photos that are not in it are left out,
    and photos that say nothing of themselves have its poses. Its cameras are scaled to photos that were reduced.
    Refined poses are judged photo by photo, and photos without a refined pose that is believed keep their own.

    Parameters
    ----------
    folder
        Of the photos.
    colmap
        Folder of a COLMAP model, also one that `refine` kept.

    Raises
    ------
    InputError
        The model cannot be read, does not fit the photos, or cannot be kept; or pycolmap is not installed.
    ReconstructionError
        The photos do not fit together.
    """
    if refine is not None:
        return refined_poses(posed.photos, folder, refine, monitor)
    if colmap is None:
        return ChosenPoses(posed.photos)
    if is_refined_folder(colmap):
        kept = read_refined(colmap, posed.photos)
        if kept.photos_sha256 == fingerprint(posed.photos):
            return _judged(posed.photos, kept, colmap, was_kept=True)
    model = named_below(read_model(colmap), folder)
    return _fitted(_of_model(model, read_frame(colmap), posed, folder), posed.sizes_px)


def _of_model(model: ColmapModel, frame: Frame | None, posed: PhotoSet, folder: Path) -> ChosenPoses:
    """Poses of a model: as it has them where it is in the frame of the site, else laid into it."""
    if frame is not None:
        return _in_frame(model, frame, posed, folder)
    if not posed.photos:
        text = say(
            "the photos do not say where they were taken, so the COLMAP model counts as one in the frame of the site"
        )
        found = _in_frame(model, USUAL_FRAME, posed, folder)
        return replace(found, findings=(Finding(Severity.NOTE, "model-as-it-is", text),))
    reference = georeference(model, posed.photos)
    times = {photo.name: photo.taken_at for photo in posed.photos}
    better = posed_photos(model, reference.enu_from_model, folder, times)
    wanted = times.keys() | {photo.name for photo in posed.unposed}
    # A model may hold pictures that say nothing of themselves beside photos that do.
    known = (
        photo for photo in better if photo.name in wanted or (is_other_picture(photo.path) and photo.path.is_file())
    )
    photos = tuple(replace(photo, pose=replace(photo.pose, covariance=reference.usual_covariance)) for photo in known)
    points = reference.enu_from_model(model.points.xyz) if len(model.points) else None
    return ChosenPoses(photos, reference.findings, points_enu_m=points)


def _fitted(chosen: ChosenPoses, sizes_px: Mapping[str, tuple[int, int]]) -> ChosenPoses:
    """Poses of a model with its cameras scaled to photos that are smaller or larger than those it was made of."""
    photos = tuple(_scaled(photo, sizes_px.get(photo.name)) for photo in chosen.photos)
    n = sum(one is not other for one, other in zip(photos, chosen.photos, strict=True))
    if not n:
        return chosen
    text = say(
        "{} of {} photos have another size than in the COLMAP model, by one factor in width and height; its cameras "
        "were scaled to them",
        n,
        len(photos),
    )
    note = Finding(Severity.NOTE, "cameras-scaled", text, "", float(n), None, "photos")
    return replace(chosen, photos=photos, findings=(*chosen.findings, note))


def _scaled(photo: PosedPhoto, size_px: tuple[int, int] | None) -> PosedPhoto:
    lens = photo.intrinsics
    if size_px is None or size_px == (lens.width_px, lens.height_px):
        return photo
    width_px, height_px = size_px
    off_px = abs(height_px - lens.height_px * width_px / lens.width_px)
    return replace(photo, intrinsics=lens.scaled(width_px, height_px)) if off_px <= 1.0 else photo


def described(folder: Path, read: Sequence[PhotoMetadata], photos: Sequence[PosedPhoto]) -> dict[str, PhotoMetadata]:
    """By name, what photos say of themselves; of those that say nothing, as large as their camera."""
    said = {name_in(folder, photo): photo for photo in read}
    others = (photo for photo in photos if photo.name not in said)
    return said | {
        photo.name: PhotoMetadata(photo.path, photo.intrinsics.width_px, photo.intrinsics.height_px) for photo in others
    }


def _in_frame(model: ColmapModel, frame: Frame, posed: PhotoSet, folder: Path) -> ChosenPoses:
    """Photos of a model that is in the frame of the site already, as far as their files are there."""
    times = {photo.name: photo.taken_at for photo in posed.photos}
    covariance = np.diag([frame.position_sigma_m**2] * 3 + [math.radians(frame.angle_sigma_deg) ** 2] * 3)
    found = posed_photos(model, Similarity.identity(), folder, times)
    photos = tuple(
        replace(photo, pose=replace(photo.pose, covariance=covariance)) for photo in found if photo.path.is_file()
    )
    if not photos:
        raise InputError(
            say(
                "none of the {} images of the COLMAP model is a photo in {}; are the names in the model the paths "
                "below the folder of photos?",
                len(found),
                folder,
            )
        )
    return ChosenPoses(photos, points_enu_m=model.points.xyz if len(model.points) else None)


def refined_poses(
    photos: Sequence[PosedPhoto], folder: Path, request: RefineRequest, monitor: Monitor = QUIET
) -> ChosenPoses:
    """Poses refined with COLMAP, or those that were kept of the same photos.

    Parameters
    ----------
    photos
        With their own poses.
    folder
        What the photos' names are paths below.

    Raises
    ------
    InputError
        There are too few photos, pycolmap is not installed, or the result cannot be kept.
    ReconstructionError
        The photos do not fit together.
    """
    where = request.kept_in(folder)
    kept = _stored_refinement(where, photos, request)
    if kept is not None:
        return _judged(photos, kept, where, was_kept=True)
    load_colmap()  # what is missing is said before anything is compared
    check_refined_folder(where)
    parameters = RefineParameters()
    if request.max_image_size_px is not None:
        parameters = replace(parameters, max_image_size_px=request.max_image_size_px)
    if request.find_lens is not None:
        parameters = replace(parameters, find_lens=request.find_lens)
    refinement = refine_poses(photos, folder, parameters, monitor)
    write_refined(where, refinement, photos, parameters)
    return _judged(photos, read_refined(where, photos), where, was_kept=False)


def findings_that_hold(posed: PhotoSet, better: ChosenPoses) -> tuple[Finding, ...]:
    """Findings about the photos' own cameras that hold for these poses.

    Refined lenses are known, and photos that a COLMAP model has a pose of do not lack one.
    """
    has_pose = {photo.name for photo in better.photos}
    still = [photo for photo in posed.unposed if photo.name not in has_pose]
    findings = posed.findings
    if len(still) < len(posed.unposed):
        others = (finding for finding in findings if finding.code != UNPOSED)
        findings = (*others, *unposed_findings(still, len(posed.photos) + len(posed.unposed)))
    if better.refined is None or better.refined.n_refined < better.refined.n_photos:
        return findings
    return tuple(finding for finding in findings if finding.code != LENS_UNKNOWN)


def refined_summary(outcome: RefinedOutcome) -> dict[str, Any]:
    """For `--json`."""
    return {
        "folder": str(outcome.folder),
        "photos": outcome.n_refined,
        "of": outcome.n_photos,
        "moved_m_median": outcome.moved_m[0],
        "moved_m_largest": outcome.moved_m[1],
        "turned_deg_median": outcome.turned_deg[0],
        "turned_deg_largest": outcome.turned_deg[1],
        "reprojection_px": outcome.reprojection_px,
        "not_joined": list(outcome.not_joined),
        "was_kept": outcome.was_kept,
    }


def _stored_refinement(where: Path, photos: Sequence[PosedPhoto], request: RefineRequest) -> StoredRefinement | None:
    """What was computed before of the same photos, as it is asked for."""
    if not is_refined_folder(where):
        return None
    try:
        kept = read_refined(where, photos)
    except InputError as error:
        raise InputError(say("{}; remove the folder {} to have the poses refined again", error, where)) from error
    is_same = kept.photos_sha256 == fingerprint(photos)
    is_same &= request.max_image_size_px in (None, kept.parameters.max_image_size_px)
    return kept if is_same and request.find_lens in (None, kept.parameters.find_lens) else None


def _judged(photos: Sequence[PosedPhoto], kept: StoredRefinement, where: Path, *, was_kept: bool) -> ChosenPoses:
    judged = judge_poses(photos, kept.photos)
    outcome = RefinedOutcome(
        where,
        sum(judged.is_refined),
        len(photos),
        _middle_and_most(judged.moved_m),
        _middle_and_most(judged.turned_deg),
        kept.reprojection_px,
        kept.left_out,
        was_kept,
    )
    return ChosenPoses(judged.photos, (_outcome_finding(outcome), *kept.findings, *judged.findings), outcome)


def _outcome_finding(outcome: RefinedOutcome) -> Finding:
    if not outcome.n_refined:
        text = say("none of the {} photos has a refined pose; all keep their own", outcome.n_photos)
        return Finding(Severity.WARNING, "poses-refined", text, "", 0.0, None, "photos")
    (usual_m, most_m), (usual_deg, most_deg) = outcome.moved_m, outcome.turned_deg
    text = say(
        "{} of {} photos have refined poses and lenses, moved by {:.3f} m and turned by {:.2f} degrees "
        "in the middle, by {:.3f} m and {:.2f} degrees at most; image points are off by {:.2f} px",
        outcome.n_refined,
        outcome.n_photos,
        usual_m,
        usual_deg,
        most_m,
        most_deg,
        outcome.reprojection_px,
    )
    return Finding(Severity.NOTE, "poses-refined", text, "", float(outcome.n_refined), None, "photos")


def _middle_and_most(values: np.ndarray) -> tuple[float, float]:
    return (float(np.median(values)), float(values.max())) if len(values) else (0.0, 0.0)
