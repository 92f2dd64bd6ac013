"""Refining camera poses: features are matched and all rays adjusted together, held by the photos' own positions.

The work is COLMAP's (J. Schoenberger and J.-M. Frahm, "Structure-from-Motion Revisited", CVPR 2016), where pycolmap is
installed. The steps: SIFT features; matches between neighbours; an incremental model in a frame of its own; that model
laid into the site by a robust similarity; a bundle adjustment with the photos' positions and their covariances as
observations; and the model laid into the site again, by positions and angles.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.csgraph import reverse_cuthill_mckee

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.georeference import (
    Georeference,
    Similarity,
    angle_information,
    are_on_a_line,
    georeference,
    in_enu,
    posed_photos,
    position_covariance,
)
from reconstruction.colmap.pycolmap_run import (
    DEFAULT_PARAMETERS,
    LEAST_PHOTOS,
    ColmapRun,
    RefineParameters,
    StartPhoto,
    about_lens,
    as_model,
    do_not_fit,
    load_colmap,
    transform,
)
from reconstruction.colmap.receivers import Receiver, placed_by_receivers
from reconstruction.colmap.record import ColmapImage, ColmapModel, intrinsics_of

Array = NDArray[np.float64]


# Diagonal blocks of the inverse of a sparse normal matrix, without the rest of the inverse.
#
# Blocks are ordered so that each is linked to near ones only (E. Cuthill and J. McKee, 1969), and cut into segments
# of
# which each is linked to the next alone: a block tridiagonal matrix. Its inverse's diagonal follows from an
# elimination
# forwards and a recursion backwards (K. Takahashi, J. Fagan and M. Chin, 1973). A few unknowns that everything is
# linked
# to, such as focal lengths, stand in a border of their own.

MAX_SEGMENT = 6000
"""Unknowns of a segment: about five dense matrices of this size are held at a time, 1.4 GB, and inverting takes some
20 s on two cores."""


class TooLargeError(Exception):
    """Everything is linked to everything: a segment has more than `MAX_SEGMENT` unknowns, as many as `args` says."""


def inverse_blocks(normal: sparse.csr_array, size: int, n_blocks: int, monitor: Monitor = QUIET) -> Array:
    """Diagonal blocks of the inverse, shape (n_blocks, size, size).

    Parameters
    ----------
    normal
        Symmetric and positive definite; its first `size * n_blocks` unknowns are the blocks', the others the border.

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is not positive definite: something is fixed by nothing.
    TooLargeError
        A segment would be too large.
    """
    order, ends = _segments(_links(normal, size, n_blocks))
    lengths = [size * (end - start) for start, end in pairwise([0, *ends])]
    if max(lengths) > MAX_SEGMENT:
        raise TooLargeError(max(lengths))
    unknowns = (size * order[:, None] + np.arange(size)).ravel()
    n = size * n_blocks
    inner = normal[:n, :n][unknowns][:, unknowns].tocsr()
    cuts = [slice(size * start, size * end) for start, end in pairwise([0, *ends])]
    border = normal[:n, n:].toarray()[unknowns]
    factors, forward = _eliminated(inner, cuts, border, monitor)
    solved, blocks = np.empty_like(border), np.empty((n_blocks, size, size))
    later: tuple[slice, Array] | None = None
    for cut, factor in zip(reversed(cuts), reversed(factors), strict=True):
        monitor.report(say("inverting normal equations"), n - cut.stop, n)
        inverse = cho_solve(factor, np.eye(cut.stop - cut.start))
        if later is None:
            solved[cut] = cho_solve(factor, forward[cut])
        else:
            following, below = later
            link = inner[cut, following].toarray()
            solved[cut] = cho_solve(factor, forward[cut] - link @ solved[following])
            carried = cho_solve(factor, link)
            inverse = inverse + carried @ below @ carried.T
        for number in range(cut.start // size, cut.stop // size):
            at = size * number - cut.start
            blocks[order[number]] = inverse[at : at + size, at : at + size]
        later = cut, inverse
    if border.shape[1]:
        left = normal[n:, n:].toarray() - border.T @ solved
        spread = cho_solve(cho_factor(0.5 * (left + left.T)), solved.T).T
        each = np.empty((n_blocks, size, border.shape[1]))
        each_spread = np.empty_like(each)
        each[order], each_spread[order] = solved.reshape(each.shape), spread.reshape(each.shape)
        blocks += each_spread @ each.transpose(0, 2, 1)
    return np.asarray(0.5 * (blocks + blocks.transpose(0, 2, 1)), np.float64)


def _links(normal: sparse.csr_array, size: int, n_blocks: int) -> sparse.csr_array:
    """Which blocks are linked, shape (n_blocks, n_blocks)."""
    inner = normal[: size * n_blocks, : size * n_blocks].tocoo()
    shape = (n_blocks, n_blocks)
    return sparse.csr_array((np.ones(inner.nnz, np.int8), (inner.row // size, inner.col // size)), shape=shape)


def _segments(links: sparse.csr_array) -> tuple[NDArray[np.int64], list[int]]:
    """Order of the blocks, and where in it each segment ends: as far as the blocks before it reach."""
    order = np.asarray(reverse_cuthill_mckee(links, symmetric_mode=True), np.int64)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    pairs = links.tocoo()
    reach = np.arange(len(order))
    np.maximum.at(reach, place[pairs.row], place[pairs.col])
    ends, end = [], 1
    while True:
        ends.append(end)
        if end == len(order):
            return order, ends
        start = ends[-2] if len(ends) > 1 else 0
        end = max(end + 1, int(reach[start:end].max()) + 1)


def _eliminated(
    inner: sparse.csr_array, cuts: list[slice], border: Array, monitor: Monitor
) -> tuple[list[tuple[Array, bool]], Array]:
    """Cholesky factors of the segments with all before them eliminated, and the border after the same steps."""
    factors: list[tuple[Array, bool]] = []
    forward = border.copy()
    before: slice | None = None
    for cut in cuts:
        monitor.report(say("inverting normal equations"), cut.start, inner.shape[0])
        own = inner[cut, cut].toarray()
        if before is not None:
            link = inner[before, cut].toarray()
            carried = cho_solve(factors[-1], link)
            own = own - link.T @ carried
            forward[cut] -= carried.T @ forward[before]
        factors.append(cho_factor(0.5 * (own + own.T)))
        before = cut
    return factors, forward


STAGE = say("estimating accuracy")

CHUNK = 200_000
"""Image points whose part of the normal matrix is computed at a time: some 200 MB."""

LEAST_SIGMA_PX = 0.5
"""Image points are taken to be no better: their errors go together where the lens model is not perfect."""

STEP = 1e-6
"""Of the derivatives of the projection, in parts of a point's depth."""

LEAST_STIFFNESS = 1e-9
"""Of a point's normal matrix, smallest against largest eigenvalue: points on parallel rays have no depth."""


def pose_covariances(
    model: ColmapModel, measured: Mapping[str, PosedPhoto], monitor: Monitor = QUIET
) -> dict[str, Array]:
    """Covariances of the poses of a model in the site's frame, shape (6, 6) each, by image name.

    Parameters
    ----------
    measured
        The photo of each image as its metadata have it, by name.

    Returns
    -------
    covariances
        Empty where what was measured does not fix them.

    Raises
    ------
    TooLargeError
        More than a thousand photos are linked with each other so closely that the work would not fit into memory.
    """
    images = list(model.images.values())
    if not images:
        return {}
    monitor.report(STAGE, 0, 0)
    lenses = {camera_id: intrinsics_of(camera) for camera_id, camera in model.cameras.items()}
    row_of = {point: row for row, point in enumerate(model.points.ids.tolist())}
    observed = []
    for number, image in enumerate(images):
        observed.append(_Observed.of(image, lenses[image.camera_id], model, row_of))
        monitor.report(STAGE, number, len(images))
    normal = _normal(model, images, observed, monitor) + _stated(images, measured, len(model.cameras))
    try:
        blocks = inverse_blocks(sparse.csr_array(normal), 6, len(images), monitor)
    except np.linalg.LinAlgError:  # what is not fixed by anything must not come out as known
        return {}
    return {image.name: block for image, block in zip(images, blocks, strict=True)}


class _Observed:
    """Derivatives of one image's k observations of points: shapes (k, 2, 7), (k, 2, 3), rows of points (k,)."""

    def __init__(self, pose: Array, point: Array, rows: NDArray[np.int64], errors_px: Array) -> None:
        self.pose, self.point, self.rows, self.errors_px = pose, point, rows, errors_px

    @classmethod
    def of(cls, image: ColmapImage, lens: Intrinsics, model: ColmapModel, row_of: Mapping[int, int]) -> _Observed:
        """Of the observations whose point is in the model and in front of the camera."""
        rows = np.array([row_of.get(point, -1) for point in image.point_ids.tolist()], np.int64)
        rotation = image.cam_from_world
        points_cam = model.points.xyz[rows] @ rotation.T + image.t if len(rows) else np.zeros((0, 3))
        pixels = lens.pixels(points_cam) if len(rows) else np.zeros((0, 2))
        kept = (rows >= 0) & np.isfinite(pixels).all(axis=1)
        rows, points_cam, pixels = rows[kept], points_cam[kept], pixels[kept]
        step = STEP * points_cam[:, 2:]
        slopes = np.stack(
            [
                (lens.pixels(points_cam + step * axis) - lens.pixels(points_cam - step * axis)) / (2.0 * step)
                for axis in np.eye(3)
            ],
            axis=2,
        ) if len(rows) else np.zeros((0, 2, 3))  # fmt: skip
        # A rotation w on the left moves points_cam by w x points_cam; the centre moves them by -R, the point by R.
        turned = np.cross(np.eye(3)[None], points_cam[:, None, :]).transpose(0, 2, 1)
        focal = pixels - (lens.cx_px, lens.cy_px)
        pose = np.concatenate([-slopes @ rotation, slopes @ turned, focal[:, :, None]], axis=2)
        return cls(pose, slopes @ rotation, rows, pixels - image.points_px[kept])


def _rms_px(observed: Sequence[_Observed]) -> float:
    """Root mean square error of the image points along one axis, by the median, pixels."""
    lengths = np.concatenate([np.linalg.norm(seen.errors_px, axis=1) for seen in observed])
    return float(np.median(lengths)) / math.sqrt(2.0 * math.log(2.0)) if len(lengths) else 0.0


def _normal(
    model: ColmapModel, images: Sequence[ColmapImage], observed: Sequence[_Observed], monitor: Monitor
) -> sparse.csr_array:
    """Normal matrix of poses, six unknowns each, then of lenses, without the points (Schur complement)."""
    cameras = {camera_id: index for index, camera_id in enumerate(model.cameras)}
    n = 6 * len(images) + len(cameras)
    sigma_px = max(LEAST_SIGMA_PX, _rms_px(observed))
    own = np.stack(
        [
            np.concatenate([6 * i + np.arange(6), [6 * len(images) + cameras[image.camera_id]]])
            for i, image in enumerate(images)
        ]
    )
    squares = np.stack([np.einsum("kia,kib->ab", seen.pose, seen.pose) for seen in observed]) / sigma_px**2
    width = own.shape[1]
    total = sparse.csr_array(
        (squares.ravel(), (np.repeat(own, width, axis=1).ravel(), np.tile(own, (1, width)).ravel())), shape=(n, n)
    )
    rows = np.concatenate([seen.rows for seen in observed])
    order = np.argsort(rows, kind="stable")
    of_image = np.repeat(np.arange(len(images)), [len(seen.rows) for seen in observed])[order]
    rows = rows[order]
    poses = np.concatenate([seen.pose for seen in observed])[order] / sigma_px
    points = np.concatenate([seen.point for seen in observed])[order] / sigma_px
    roots = _roots(points, rows, len(model.points))
    for part in _parts(rows):
        monitor.report(STAGE, part.start, len(rows))
        total = total - _explained(poses[part], points[part], own[of_image[part]], rows[part], roots, n)
    return total


def _roots(points: Array, rows: NDArray[np.int64], n_points: int) -> Array:
    """Square roots of the inverses of the points' normal matrices, shape (n_points, 3, 3).

    A point without a depth says nothing about it: its pseudo-inverse leaves that direction out.
    """
    squares = np.einsum("kia,kib->kab", points, points).reshape(-1, 9)
    stiffness = np.stack([np.bincount(rows, squares[:, i], n_points) for i in range(9)], axis=1).reshape(-1, 3, 3)
    values, vectors = np.linalg.eigh(stiffness)
    good = values > LEAST_STIFFNESS * np.maximum(values[:, 2:], 1e-300)
    return np.asarray(vectors * np.sqrt(np.where(good, 1.0 / np.where(good, values, 1.0), 0.0))[:, None, :])


def _parts(rows: NDArray[np.int64]) -> Iterator[slice]:
    """Some `CHUNK` image points at a time, all of a point's together; `rows` are sorted."""
    start = 0
    while start < len(rows):
        last = rows[min(start + CHUNK, len(rows)) - 1]
        stop = int(np.searchsorted(rows, last, side="right"))
        yield slice(start, stop)
        start = stop


def _explained(
    poses: Array, points: Array, columns: NDArray[np.int64], rows: NDArray[np.int64], roots: Array, n: int
) -> sparse.csr_array:
    """What moving the points takes from the normal matrix, shape (n, n)."""
    cross = np.einsum("kia,kib->kab", poses, np.einsum("kia,kab->kib", points, roots[rows]))
    width = columns.shape[1]
    local = 3 * (rows - rows[0])
    row_index = np.repeat(columns.ravel(), 3)
    column_index = np.tile(local[:, None] + np.arange(3), (1, width)).ravel()
    shape = (n, int(local[-1]) + 3)
    b = sparse.csr_array((cross.ravel(), (row_index, column_index)), shape=shape)
    return sparse.csr_array(b @ b.T)


def _stated(images: Sequence[ColmapImage], measured: Mapping[str, PosedPhoto], n_lenses: int) -> sparse.csr_array:
    """Information of the photos' own positions and angles, as the normal matrix has its unknowns."""
    blocks: list[Array] = []
    for image in images:
        photo = measured[image.name]
        position = np.asarray(np.linalg.inv(position_covariance(photo)), np.float64)
        blocks += [position, angle_information(photo, len(images))]
    return sparse.csr_array(sparse.block_diag([*blocks, *[np.zeros((1, 1))] * n_lenses], format="csr"))


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
    third radial term is a calibration, and stays unless the photos say otherwise (`FoundLens`).

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
        started = [StartPhoto.of(photo) for photo in photos]
        work = ColmapRun(colmap, Path(name), folder, started, parameters, monitor)
        fixed_cameras = work.find_features()
        work.match()
        free = work.map(fixed_cameras)
        if free is not None:
            laid = georeference(as_model(free, Path(name) / "free"), photos, parameters.seed)
            transform(colmap, free, laid.enu_from_model)
            if not laid.on_a_line:
                work.adjust(free, fixed_cameras)
        free = _with_others(work, free, photos, fixed_cameras, Path(name))
        if free is None:
            raise do_not_fit(len(photos))
        lens: tuple[Finding, ...] = ()
        if fixed_cameras and not are_on_a_line(np.array([photo.pose.position_enu_m for photo in photos])):
            free, decision = work.choose_lenses(free, fixed_cameras, Path(name) / "lenses")
            lens = (about_lens(decision),)
        model = as_model(free, Path(name) / "adjusted")
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
    findings = (*laid.findings, *lens, *unsure, *_left_out(left_out, len(photos)))
    return Refinement(refined, model, laid, error_px, left_out, findings)


def _with_others(
    work: ColmapRun, free: Any | None, photos: Sequence[PosedPhoto], fixed_cameras: set[int], scratch: Path
) -> Any | None:
    """The model, if any, with the photos that matches put nowhere, or elsewhere than they say."""
    receivers = {
        photo.name: Receiver(photo.pose.position_enu_m, photo.pose.cam_from_enu, photo.pose.covariance)
        for photo in photos
    }
    if free is None:
        return placed_by_receivers(work, ColmapModel(work.cameras(), {}), receivers, (), fixed_cameras, scratch)
    model = as_model(free, scratch / "placed")
    laid = georeference(model, photos, work.parameters.seed)
    if laid.on_a_line:
        return free
    used = {name for name, is_inlier in zip(laid.names, laid.is_inlier.tolist(), strict=True) if is_inlier}
    model = in_enu(model, laid.enu_from_model)
    added = placed_by_receivers(work, model, receivers, used, fixed_cameras, scratch)
    return free if added is None else added


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
