"""A COLMAP model in the frame of the site: fitted to where its photos were taken, and turned into posed photos."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.colmap.record import ColmapCamera, ColmapImage, ColmapModel, camera_of, intrinsics_of, quaternion_of

Array = NDArray[np.float64]


# The similarity between two sets of points: scale, rotation and translation, by least squares and against outliers.
#
# Solved in closed form (S. Umeyama, "Least-squares estimation of transformation parameters between two point
# patterns",
# IEEE PAMI 13(4), 1991, Eqs. 39 to 43), with weights. Points on one line leave the turn about that line open.

COLLINEAR = 0.02
"""Points that spread across their line by less than this part of their length along it fix no turn about it: errors of
2 % of the length would turn the model by one radian."""

N_SAMPLES = 500
"""Samples of three points; with half of all points wrong, one in eight is good, and 500 miss it once in 10^29."""

ROBUST_SIGMAS = 3.0
"""Residuals beyond are outliers."""

MAX_ROUNDS = 20

MAD_TO_SIGMA = 1.0 / 1.538
"""Median length of a 3-D error is 1.538 standard deviations of one of its axes (chi distribution, 3 degrees)."""


@dataclass(frozen=True, slots=True, eq=False)
class Similarity:
    """points_b = scale * rotation @ points_a + translation; rotation shape (3, 3), translation shape (3,)."""

    scale: float
    rotation: Array
    translation: Array

    @classmethod
    def identity(cls) -> Similarity:
        """Which leaves all points where they are."""
        return cls(1.0, np.eye(3), np.zeros(3))

    def __call__(self, points: Array) -> Array:
        """Points, shape (n, 3), in the other frame."""
        return np.asarray(self.scale * points @ self.rotation.T + self.translation)

    def inverse(self) -> Similarity:
        """The way back."""
        turn = self.rotation.T
        return Similarity(1.0 / self.scale, turn, -(turn @ self.translation) / self.scale)


def spread(points: Array) -> Array:
    """Standard deviations along the three principal axes, falling, shape (3,); 0 for fewer than two points."""
    if len(points) < 2:
        return np.zeros(3)
    values = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return np.asarray(np.pad(values, (0, 3 - len(values))) / math.sqrt(len(points)))


def are_on_a_line(points: Array) -> bool:
    """Whether points, shape (n, 3), lie on one line as far as a similarity is concerned, or in one place."""
    widths = spread(points)
    return bool(widths[1] <= COLLINEAR * widths[0])


def fit(a: Array, b: Array, weights: Array | None = None, rotation: Array | None = None) -> Similarity:
    """The similarity that takes points a to points b, each shape (n, 3), with the least sum of weighted squares.

    Parameters
    ----------
    weights
        Shape (n,); all alike without.
    rotation
        Shape (3, 3), where it is known from elsewhere.

    Raises
    ------
    ValueError
        Shapes differ, or all points a are in one place.
    """
    if a.shape != b.shape or a.ndim != 2 or a.shape[1] != 3:
        raise ValueError(f"expected two arrays of one shape (n, 3), got {a.shape} and {b.shape}")
    w = np.ones(len(a)) if weights is None else weights
    w = w / w.sum()
    mean_a, mean_b = w @ a, w @ b
    from_a, from_b = a - mean_a, b - mean_b
    variance = float(w @ (from_a**2).sum(axis=1))
    if not variance > 0.0:
        raise ValueError("all points are in one place, so that they have no scale")
    covariance = (w[:, None] * from_b).T @ from_a
    if rotation is None:
        u, _, vt = np.linalg.svd(covariance)
        signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
        rotation = (u * signs) @ vt
    # The trace is that of D S in Eq. 42, for any rotation.
    scale = float(np.einsum("ij,ij->", rotation, covariance)) / variance
    return Similarity(scale, rotation, mean_b - scale * (rotation @ mean_a))


def fit_robustly(
    a: Array, b: Array, sigmas: Array, rotation: Array | None = None, seed: int = 0
) -> tuple[Similarity, NDArray[np.bool_]]:
    """As `fit`, with outliers among the pairs.

    Samples of three pairs, or two where the rotation is known; the sample with the least median of residuals in their
    standard deviations; then least squares over all pairs within `ROBUST_SIGMAS`, until these stay the same. Standard
    deviations are scaled up where the residuals of the better half are larger than they allow.

    Parameters
    ----------
    sigmas
        Shape (n,): standard deviation of each b along each axis.

    Returns
    -------
    similarity, is_inlier
        The second of shape (n,).
    """
    rng = np.random.default_rng(seed)
    n, size = len(a), 3 if rotation is None else 2
    best, least = fit(a, b, sigmas**-2.0, rotation), math.inf
    for _ in range(N_SAMPLES if n > size else 1):
        chosen = rng.choice(n, size, replace=False) if n > size else np.arange(n)
        if spread(a[chosen])[size - 2] <= COLLINEAR * spread(a)[0]:
            continue
        found = fit(a[chosen], b[chosen], None, rotation)
        median = float(np.median(_lengths(found, a, b) / sigmas))
        if found.scale > 0.0 and median < least:
            best, least = found, median
    inlier = np.ones(n, np.bool_)
    for _ in range(MAX_ROUNDS):
        residuals = _lengths(best, a, b) / sigmas
        unit = max(1.0, float(np.median(residuals)) * MAD_TO_SIGMA)
        now = residuals <= ROBUST_SIGMAS * math.sqrt(3.0) * unit
        if now.sum() < size or (now == inlier).all():
            break
        inlier = now
        best = fit(a[inlier], b[inlier], sigmas[inlier] ** -2.0, rotation)
    return best, inlier


def _lengths(similarity: Similarity, a: Array, b: Array) -> Array:
    return np.asarray(np.linalg.norm(similarity(a) - b, axis=1))


DEFAULT_SIGMA_M = 1.5
"""Of photos whose pose has no covariance: a receiver without corrections."""

N_STEPS = 6
"""Of Gauss and Newton; from a good start the third changes nothing any more."""

OUTLIER_SIGMAS = 3.0
"""Angles further off than this lose their weight."""

ADJUSTED_SIGMA_M = 0.02
ADJUSTED_SIGMA_DEG = 0.1
"""The best that a bundle adjustment's poses are taken for where nobody computed how good they are, position and angles:
a tenth of a degree is a pixel or two at the focal lengths of drones, which no adjustment leaves."""

LEAST_SIGMA_M = 0.005
"""Positions are taken to be no better than this: RTK's own standard deviations leave out lever arm and timing."""


@dataclass(frozen=True, slots=True, eq=False)
class Georeference:
    """How a model lies in the site.

    Parameters
    ----------
    enu_from_model
        Similarity from the model's world to the site's frame.
    names
        Images that were compared, n of them.
    residuals_m
        Shape (n, 3): by how much the model's centres miss the photos' positions, ENU.
    angles_deg
        Shape (n,): between the model's and the photos' orientations.
    is_inlier
        Shape (n,): whether the position was used.
    on_a_line
        Whether the positions lie on one line, so that the rotation is that of the cameras' own angles.
    """

    enu_from_model: Similarity
    names: tuple[str, ...]
    residuals_m: Array
    angles_deg: Array
    is_inlier: NDArray[np.bool_]
    on_a_line: bool
    findings: tuple[Finding, ...]

    @property
    def rms_m(self) -> float:
        """Root mean square distance of the positions that were used."""
        return float(np.sqrt(np.mean((self.residuals_m[self.is_inlier] ** 2).sum(axis=1))))

    @property
    def usual_covariance(self) -> Array:
        """Of every pose, shape (6, 6): as well as the model lies in the site, and no better than adjustments are."""
        residuals = self.residuals_m[self.is_inlier]
        spread_m = float(np.sqrt((residuals**2).mean())) if len(residuals) else 0.0
        position_m = max(ADJUSTED_SIGMA_M, spread_m / math.sqrt(max(1, len(residuals))))
        return np.diag([position_m**2] * 3 + [math.radians(ADJUSTED_SIGMA_DEG) ** 2] * 3)


def georeference(model: ColmapModel, photos: Sequence[PosedPhoto], seed: int = 0) -> Georeference:
    """Fit a model to its photos, found by name: robustly to their positions, then to positions and angles together.

    Angles decide where positions hardly do: on one line, or where receivers are as bad as the flight is wide.

    Raises
    ------
    InputError
        Fewer than three images of the model are among the photos, or all were taken in one place.
    """
    by_name = {photo.name: photo for photo in photos}
    images = [image for image in model.images.values() if image.name in by_name]
    paired = [by_name[image.name] for image in images]
    if len(images) < 3:
        raise InputError(
            say(
                "COLMAP model: {} of its {} images are among the {} photos with a pose; expected at least 3; are "
                "the names in the model the paths below the folder of photos?",
                len(images),
                len(model.images),
                len(photos),
            )
        )
    centres = np.stack([image.centre_world for image in images])
    positions = np.stack([photo.pose.position_enu_m for photo in paired])
    if np.ptp(positions, axis=0).max() == 0.0 or np.ptp(centres, axis=0).max() == 0.0:
        raise InputError(
            say("COLMAP model: all photos were taken in one place, so that the model gets no scale from them")
        )
    findings, rotation = [], None
    on_a_line = are_on_a_line(positions) or are_on_a_line(centres)
    if on_a_line:
        rotation = _mean_rotation(images, paired)
        text = say(
            "the photos were taken along one line: the turn of the model about it is that of the cameras' angles"
        )
        findings.append(Finding(Severity.WARNING, "model-on-a-line", text))
    similarity, is_inlier = fit_robustly(centres, positions, _sigmas_m(paired), rotation, seed)
    if not similarity.scale > 0.0:
        raise InputError(
            say("COLMAP model: the photos' positions contradict the model; are they photos of this model?")
        )
    for _ in range(N_STEPS):
        similarity = _step(similarity, images, paired, is_inlier)
    n_out = int((~is_inlier).sum())
    if n_out:
        text = say("the positions of {} of {} photos contradict the model and were not used", n_out, len(images))
        findings.append(Finding(Severity.WARNING, "positions-contradict", text, "", float(n_out), 0.0, "photos"))
    residuals = similarity(centres) - positions
    angles = np.array([_angle_deg(similarity, *pair) for pair in zip(images, paired, strict=True)])
    names = tuple(image.name for image in images)
    return Georeference(similarity, names, residuals, angles, is_inlier, on_a_line, tuple(findings))


def named_below(model: ColmapModel, folder: Path) -> ColmapModel:
    """The model with its images' names as paths below the folder of photos, also where it has them from the root.

    Raises
    ------
    InputError
        An image lies outside the folder: nothing is read or written by such a name.
    """
    images = {image.id: replace(image, name=_below(image.name, folder)) for image in model.images.values()}
    return replace(model, images=images)


def _below(name: str, folder: Path) -> str:
    path = Path(name)
    if path.is_absolute():
        roots = (folder.absolute(), folder.resolve())
        path = next((path.relative_to(root) for root in roots if path.is_relative_to(root)), path)
    if path.is_absolute() or ".." in path.parts or path == Path():
        raise InputError.say(
            "the image '{}' of the COLMAP model does not lie below the folder of photos, {}; name the folder that "
            "holds all photos of the model",
            name,
            folder,
        )
    return path.as_posix()


def posed_photos(
    model: ColmapModel,
    enu_from_model: Similarity,
    folder: Path,
    taken_at: Mapping[str, datetime | None] | None = None,
) -> tuple[PosedPhoto, ...]:
    """Photos of a model with their cameras in the site's frame, without covariance, in the order of their names.

    Raises
    ------
    InputError
        A camera cannot be told in our intrinsics, or an image lies outside the folder.
    """
    model = named_below(model, folder)
    lenses = {camera.id: intrinsics_of(camera) for camera in model.cameras.values()}
    times = taken_at or {}
    images = sorted(model.images.values(), key=lambda image: image.name)
    return tuple(
        PosedPhoto(
            image.name,
            folder / image.name,
            lenses[image.camera_id],
            Pose(enu_from_model(image.centre_world[None])[0], image.cam_from_world @ enu_from_model.rotation.T),
            times.get(image.name),
        )
        for image in images
    )


def model_of(photos: Sequence[PosedPhoto]) -> ColmapModel:
    """A model of cameras and images in the site's frame, without points: what trainers of splats and COLMAP start from.

    Photos of the same intrinsics share a camera.
    """
    cameras: dict[ColmapCamera, int] = {}
    images = {}
    nothing_seen = np.zeros((0, 2)), np.zeros(0, np.int64)
    for image_id, photo in enumerate(photos, 1):
        camera_id = cameras.setdefault(camera_of(photo.intrinsics, 0), len(cameras) + 1)
        rotation = photo.pose.cam_from_enu
        east, north, up = (-rotation @ photo.pose.position_enu_m).tolist()
        images[image_id] = ColmapImage(
            image_id, quaternion_of(rotation), (east, north, up), camera_id, photo.name, *nothing_seen
        )
    return ColmapModel({number: replace(camera, id=number) for camera, number in cameras.items()}, images)


def in_enu(model: ColmapModel, enu_from_model: Similarity) -> ColmapModel:
    """The model with its images and points in the site's frame."""
    images = {}
    for image in model.images.values():
        rotation = image.cam_from_world @ enu_from_model.rotation.T
        x, y, z = (-rotation @ enu_from_model(image.centre_world[None])[0]).tolist()
        images[image.id] = replace(image, q_wxyz=quaternion_of(rotation), t=(x, y, z))
    points = replace(model.points, xyz=enu_from_model(model.points.xyz))
    return ColmapModel(model.cameras, images, points)


def position_covariance(photo: PosedPhoto) -> Array:
    """Covariance of a photo's position, shape (3, 3), m^2."""
    if photo.pose.covariance is None:
        return DEFAULT_SIGMA_M**2 * np.eye(3)
    return np.array(photo.pose.covariance[:3, :3])


def angle_information(photo: PosedPhoto, n_photos: int) -> Array:
    """Inverse covariance of a photo's angles, shape (3, 3), camera axes, as one of `n_photos`; 0 where none is known.

    A compass and a gimbal are wrong in all photos alike: all photos together tell no more than one.
    """
    if photo.pose.covariance is None:
        return np.zeros((3, 3))
    return np.asarray(np.linalg.inv(photo.pose.covariance[3:, 3:]) / n_photos, np.float64)


def _step(
    similarity: Similarity, images: Sequence[ColmapImage], photos: Sequence[PosedPhoto], is_inlier: NDArray[np.bool_]
) -> Similarity:
    """One step of Gauss and Newton in rotation vector (ENU, on the left), log scale and translation."""
    turned = np.stack([similarity.scale * similarity.rotation @ image.centre_world for image in images])
    middle = turned[is_inlier].mean(axis=0)
    normal, gradient = np.zeros((7, 7)), np.zeros(7)
    for image, photo, arm, is_used in zip(images, photos, turned - middle, is_inlier.tolist(), strict=True):
        if is_used:
            x, y, z = arm.tolist()
            jacobian = np.array([[0.0, z, -y, x, 1, 0, 0], [-z, 0.0, x, y, 0, 1, 0], [y, -x, 0.0, z, 0, 0, 1]])
            residual = arm + middle + similarity.translation - photo.pose.position_enu_m
            weighted = jacobian.T @ np.linalg.inv(position_covariance(photo) + LEAST_SIGMA_M**2 * np.eye(3))
            normal += weighted @ jacobian
            gradient += weighted @ residual
        predicted = image.cam_from_world @ similarity.rotation.T
        off, _ = cv2.Rodrigues(predicted @ photo.pose.cam_from_enu.T)
        off_rad = np.asarray(off, np.float64).ravel()
        information = angle_information(photo, len(photos))
        distance2 = len(photos) * float(off_rad @ information @ off_rad)
        weighted = -predicted.T @ information / (1.0 + distance2 / OUTLIER_SIGMAS**2)
        normal[:3, :3] += -weighted @ predicted
        gradient[:3] += weighted @ off_rad
    step = -np.linalg.lstsq(normal, gradient, rcond=None)[0]
    turn = np.asarray(cv2.Rodrigues(step[:3])[0], np.float64)
    growth = math.exp(step[3])
    translation = similarity.translation + middle - growth * (turn @ middle) + step[4:]
    return Similarity(similarity.scale * growth, turn @ similarity.rotation, translation)


def _sigmas_m(photos: Sequence[PosedPhoto]) -> Array:
    """Standard deviation of each position along an axis, on average, shape (n,)."""
    sigmas = [math.sqrt(float(np.trace(position_covariance(photo))) / 3.0) for photo in photos]
    return np.maximum(sigmas, LEAST_SIGMA_M)


def _mean_rotation(images: Sequence[ColmapImage], photos: Sequence[PosedPhoto]) -> Array:
    """Rotation, shape (3, 3), from the model to the site by the cameras' orientations.

    The rotation nearest to the sum of those of single photos (chordal mean).
    """
    total = np.zeros((3, 3))
    for image, photo in zip(images, photos, strict=True):
        total += photo.pose.cam_from_enu.T @ image.cam_from_world
    u, _, vt = np.linalg.svd(total)
    return np.asarray((u * [1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))]) @ vt)


def _angle_deg(similarity: Similarity, image: ColmapImage, photo: PosedPhoto) -> float:
    return angle_between_deg(image.cam_from_world @ similarity.rotation.T, photo.pose.cam_from_enu)


def angle_between_deg(one: Array, other: Array) -> float:
    """Angle, degrees, of the rotation between two rotations, shape (3, 3) each; exact for small ones, too."""
    apart = one @ other.T
    sine = math.hypot(apart[2, 1] - apart[1, 2], apart[0, 2] - apart[2, 0], apart[1, 0] - apart[0, 1])
    return math.degrees(math.atan2(sine, float(np.trace(apart)) - 1.0))
