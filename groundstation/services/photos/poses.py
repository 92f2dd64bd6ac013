"""Poses of photos for all that is done with them: their own, those of a COLMAP model, or refined ones."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin
from planning.photos.folder import is_other_picture, read_photos
from planning.photos.places import Locality, PhotoHeights
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import PosedPhoto
from reconstruction.coarse.inputs import ProvisionalPlace, provisional_place
from reconstruction.coarse.placing import in_own_frame, usual_distance
from reconstruction.colmap.folder import Frame, model_within, read_frame, read_model
from reconstruction.colmap.georeference import (
    ADJUSTED_SIGMA_DEG,
    ADJUSTED_SIGMA_M,
    Similarity,
    georeference,
    in_enu,
    named_below,
    posed_photos,
)
from reconstruction.colmap.pycolmap_run import RefineParameters, load_colmap
from reconstruction.colmap.record import ColmapModel, ColmapPoints
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
from reconstruction.dataset.prepare import DATA_SET
from reconstruction.dataset.records import TRANSFORMS_FILES, VALID, points_ahead, read_transforms
from reconstruction.photos.decode import PICTURE_FILE, picture_size
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
    masks
        That the model names, by absolute paths of photos.
    """

    photos: tuple[PosedPhoto, ...]
    findings: tuple[Finding, ...] = ()
    refined: RefinedOutcome | None = None
    points_enu_m: NDArray[np.float64] | None = None
    masks: Mapping[str, Path] = field(default_factory=dict)


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
        Folder of a COLMAP model, also one that `refine` kept; or nerfstudio's transforms.json.

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
        masked = _masked(posed.photos, folder)
        kept = read_refined(colmap, masked)
        if kept.photos_sha256 == fingerprint(masked):
            return _judged(masked, kept, colmap, was_kept=True)
    model, masks = read_poses(colmap)
    found = _fitted(_of_model(named_below(model, folder), read_frame(colmap), posed, folder), posed.sizes_px)
    return replace(found, masks=masks)


def read_poses(place: Path) -> tuple[ColmapModel, dict[str, Path]]:
    """The model of a COLMAP folder, or of nerfstudio's transforms.json and the folder that has one; masks of images.

    Raises
    ------
    InputError
        It is none of these, or damaged.
    """
    inside = (place / name for name in TRANSFORMS_FILES)
    path = next((each for each in inside if each.is_file()), None) if place.is_dir() else place
    if path is None or (path == place and place.suffix.lower() != ".json"):
        return read_model(place), {}
    model, cloud, masks = read_transforms(path)
    if cloud is None or not cloud.is_file():
        return model, masks
    from reconstruction.splats.surfels import read_points

    xyz, rgb = read_points(cloud)
    n = len(xyz)
    points = ColmapPoints(
        np.arange(1, n + 1), xyz, rgb, np.full(n, -1.0), np.zeros(n + 1, np.int64), np.zeros((0, 2), np.int64)
    )
    return replace(model, points=points), masks


# Masks of photos: black where a pixel does not count.

MASKS = "masks"
"""Folder of masks beside that of the photos, as COLMAP takes them for its features."""


def with_masks(chosen: ChosenPoses, folder: Path) -> ChosenPoses:
    """Photos with their masks, and what is missing of these: `masks_of`."""
    masks, findings = masks_of([photo.name for photo in chosen.photos], folder, chosen.masks)
    photos = tuple(replace(photo, mask=masks.get(photo.name)) for photo in chosen.photos)
    return replace(chosen, photos=photos, findings=(*chosen.findings, *findings))


def masks_of(
    names: Sequence[str], folder: Path, stated: Mapping[str, Path] | None = None
) -> tuple[dict[str, Path], tuple[Finding, ...]]:
    """Masks of photos, by their names: those that are stated, or that lie beside as COLMAP has them; what is missing.

    Parameters
    ----------
    names
        Paths of photos below the folder.
    folder
        Of the photos; the folder of masks is beside it, or in it.
    stated
        By absolute paths of photos.
    """
    beside, masks, stated = _folder_of_masks(folder), dict[str, Path](), {} if stated is None else stated
    for name in names:
        wholes = (str(root / name) for root in (folder.absolute(), folder.resolve()))
        found = next((stated[whole] for whole in wholes if whole in stated), None)
        if found is None and beside is not None:
            places = beside / f"{name}.png", (beside / name).with_suffix(".png")
            found = next((place for place in places if place.is_file()), None)
        if found is not None:
            masks[name] = found
    lost = {name: mask for name, mask in masks.items() if not mask.is_file()}
    without = [name for name in names if name not in masks]
    findings = []
    if len(masks) > len(lost):
        n = len(masks) - len(lost)
        text = say("{} of {} photos have a mask: what it has black does not count", n, len(names))
        findings.append(Finding(Severity.NOTE, "photos-masked", text, "", float(n), None, "photos"))
    if lost:
        first = next(iter(lost.values()))
        text = say("{} masks are not there, the first {}: all pixels of their photos count", len(lost), first)
        findings.append(Finding(Severity.WARNING, "masks-missing", text, "", float(len(lost)), 0.0, "photos"))
    if 0 < len(without) < len(names):
        text = say(
            "{} of {} photos have no mask, the first {}: all their pixels count", len(without), len(names), without[0]
        )
        findings.append(Finding(Severity.NOTE, "photos-unmasked", text, "", float(len(without)), 0.0, "photos"))
    return {name: mask for name, mask in masks.items() if name not in lost}, tuple(findings)


def _folder_of_masks(folder: Path) -> Path | None:
    """Of the photos in a folder; None where there is none.

    In a data set of our own the masks of that name are of facades.
    """
    whole = folder.absolute()
    places = (whole.parent, whole) if whole.name in IMAGES else (whole,)
    for place in places:
        found = place / (VALID if (place / DATA_SET).is_file() else MASKS)
        if found.is_dir():
            return found
    return None


# Photos of which no site is known: a folder with a model of another program.

IMAGES = ("images", "input")
"""Folders of photos, in those of COLMAP, nerfstudio and programs for splats."""

N_AHEAD = 30_000
"""Places that splats start from, where a model has no points."""


def poses_within(folder: Path) -> Path | None:
    """What says the poses of the photos in a folder, where other programs leave it; None where there is nothing.

    It lies in the folder, or beside it where that is called as photos are: nerfstudio's file goes before COLMAP's.
    """
    for place in (folder, folder.absolute().parent) if folder.name in IMAGES else (folder,):
        named = next((place / name for name in TRANSFORMS_FILES if (place / name).is_file()), None)
        found = named or model_within(place)
        if found is not None:
            return found
    return None


@dataclass(frozen=True, slots=True, eq=False)
class PhotosAlone:
    """Photos of a model of another program, in a frame of their own.

    Parameters
    ----------
    chosen
        Photos with poses and points.
    origin
        Of the frame; None where nothing says it.
    enu_from_model
        How the model lies in the frame where only itself says so; None where it has a place, or is in ENU already.
    """

    chosen: ChosenPoses
    origin: Origin | None
    enu_from_model: Similarity | None


def photos_alone(
    folder: Path, colmap: Path | None = None, *, heights: PhotoHeights = "auto", monitor: Monitor = QUIET
) -> PhotosAlone:
    """The photos of a folder as a model has them that lies in it, or is named.

    Where at least three of them say a pose they say where the model is, too, and how large; else its own frame counts.

    Raises
    ------
    InputError
        There is no model, none of its images is there, or one of both is damaged.
    """
    place = poses_within(folder) if colmap is None else colmap
    if place is None:
        read_photos(folder, monitor, posed_elsewhere=True)  # a folder without photos has another fault
        raise InputError.say(
            "holds no COLMAP model (such as sparse/0) and no transforms.json; name it with --colmap, name a site if "
            "the photos say where they were taken, or make a model of them with 'coarse'",
            place=folder,
        )
    model, masks = read_poses(place)
    photos_folder = _folder_of_images(model, folder)
    model = named_below(model, photos_folder)
    read = read_photos(photos_folder, monitor, posed_elsewhere=True)
    frame = read_frame(place) if place.is_dir() else None
    known = provisional_place(read.photos, folder.name)
    here = known or ProvisionalPlace(folder.name, Origin(0.0, 0.0, 0.0))
    posed = pose_photos(read.photos, here, photos_folder, heights=heights, posed_elsewhere=True)
    n_placed = len({photo.name for photo in posed.photos} & {image.name for image in model.images.values()})
    own: Similarity | None = None
    if frame is None and n_placed < LEAST_PLACED:
        own, notes = in_own_frame(model, {name_in(photos_folder, one): one for one in read.photos})
        found = _in_frame(in_enu(model, own), USUAL_FRAME, posed, photos_folder)
        found = replace(found, findings=(*notes, *found.findings))
    else:
        found = _of_model(model, frame, posed, photos_folder)
    found = with_masks(replace(_fitted(found, posed.sizes_px), masks=masks), photos_folder)
    if found.points_enu_m is None:
        found = _with_points_ahead(found)
    origin = None if own is not None or known is None else known.origin
    if frame is not None and frame.origin is not None:
        origin = frame.origin
    about_photos = findings_that_hold(posed, found)
    if own is not None:
        about_photos = (*(one for one in about_photos if one.code != UNPOSED), *_not_in_model(posed, model))
    findings = (*read.findings, *about_photos, *found.findings)
    return PhotosAlone(replace(found, findings=findings), origin, own)


def _not_in_model(posed: PhotoSet, model: ColmapModel) -> list[Finding]:
    names = {image.name for image in model.images.values()}
    left = sorted(posed.sizes_px.keys() - names)
    if not left:
        return []
    n_all = len(names) + len(left)
    text = say("{} of {} photos are not in the model, the first {}; they are left out", len(left), n_all, left[0])
    return [Finding(Severity.NOTE, "photos-not-in-model", text, "", float(len(left)), 0.0, "photos")]


LEAST_PLACED = 3
"""Photos with a pose of their own that a model can be laid into place by."""


def _folder_of_images(model: ColmapModel, folder: Path) -> Path:
    """The folder that the model's images lie in: the one that is named, or that of photos in it.

    Raises
    ------
    InputError
        None of the images is there.
    """
    if not folder.is_dir():
        return folder  # reading it says what is wrong
    names = [image.name for image in model.images.values()]
    folders = [folder / name for name in IMAGES if (folder / name).is_dir()] + [folder]
    counts = [sum(_is_below(one, name) for name in names) for one in folders]
    if not any(counts):
        raise InputError.say(
            "none of the {} images of the model is in this folder, the first '{}'; name the folder that holds the "
            "photos, with the names that they have in the model",
            len(names),
            min(names, default=""),
            place=folder,
        )
    return folders[int(np.argmax(counts))]


def _is_below(folder: Path, name: str) -> bool:
    path = folder / name
    return path.is_file() and path.absolute().is_relative_to(folder.absolute())


def _with_points_ahead(found: ChosenPoses) -> ChosenPoses:
    points = points_ahead(found.photos, usual_distance(found.photos, np.zeros((0, 3))), N_AHEAD)
    text = say(
        "the model has no points: splats start from {} random places before the cameras, which takes longer and may "
        "end in fog; a COLMAP model's points, or a ply_file_path, are a better start",
        len(points),
    )
    note = Finding(Severity.WARNING, "no-points", text, "", 0.0, 1.0, "points")
    return replace(found, points_enu_m=points, findings=(*found.findings, note))


def _of_model(model: ColmapModel, frame: Frame | None, posed: PhotoSet, folder: Path) -> ChosenPoses:
    """Poses of a model: as it has them where it is in the frame of the site, else laid into it."""
    if frame is not None:
        return _in_frame(model, frame, posed, folder)
    if not posed.photos:
        text = say(
            "the photos do not say where they were taken, so the COLMAP model counts as one in the frame of the site"
        )
        found = _in_frame(model, USUAL_FRAME, posed, folder)
        return replace(found, findings=(Finding(Severity.NOTE, "model-as-it-is", text), *found.findings))
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
    photos = tuple(_scaled(photo, sizes_px.get(photo.name) or _size_px(photo.path)) for photo in chosen.photos)
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


def _size_px(path: Path) -> tuple[int, int] | None:
    """Of a picture that says nothing of itself; of one that cannot be read it is said when it is prepared."""
    try:
        return picture_size(read_input_file(path, PICTURE_FILE))
    except InputError:
        return None


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
    missing = [photo for photo in found if not photo.path.is_file()]
    findings: tuple[Finding, ...] = ()
    if missing:
        text = say(
            "{} of {} images of the COLMAP model are not in {}, the first {}; they are left out",
            len(missing),
            len(found),
            folder,
            missing[0].name,
        )
        findings = (Finding(Severity.WARNING, "images-missing", text, "", float(len(missing)), 0.0, "photos"),)
    return ChosenPoses(photos, findings, points_enu_m=model.points.xyz if len(model.points) else None)


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
    where, photos = request.kept_in(folder), _masked(photos, folder)
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


def _masked(photos: Sequence[PosedPhoto], folder: Path) -> tuple[PosedPhoto, ...]:
    """Photos with the masks that lie beside them: features of pixels that do not count would move cameras."""
    masks, _ = masks_of([photo.name for photo in photos], folder)
    return tuple(replace(photo, mask=masks[photo.name]) if photo.name in masks else photo for photo in photos)


def findings_that_hold(posed: PhotoSet, better: ChosenPoses) -> tuple[Finding, ...]:
    """Findings about the photos' own cameras that hold for these poses.

    Lenses of a model, and refined ones, are known, and photos that a COLMAP model has a pose of do not lack one.
    """
    has_pose = {photo.name for photo in better.photos}
    still = [photo for photo in posed.unposed if photo.name not in has_pose]
    findings = posed.findings
    if len(still) < len(posed.unposed):
        others = (finding for finding in findings if finding.code != UNPOSED)
        findings = (*others, *unposed_findings(still, len(posed.photos) + len(posed.unposed)))
    stated = {photo.name: photo.intrinsics for photo in posed.photos}
    is_refined = better.refined is not None and better.refined.n_refined == better.refined.n_photos
    if not is_refined and any(stated.get(photo.name) == photo.intrinsics for photo in better.photos):
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
