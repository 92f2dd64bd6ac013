"""How well a model's poses are known: the inverse of the bundle adjustment's normal equations, points eliminated.

Unknowns are, for every photo, its position and a small rotation as in `reconstruction.cameras.Pose`; for every camera
its focal length; for every point its place. Observations are the image points, and the photos' measured positions and
angles, which fix where the model lies. COLMAP's own covariances leave the latter out or hold them in another scale.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from planning.progress import QUIET, Monitor
from reconstruction.cameras import Intrinsics, PosedPhoto
from reconstruction.colmap.camera_models import intrinsics_of
from reconstruction.colmap.georeference import angle_information, position_covariance
from reconstruction.colmap.record import ColmapImage, ColmapModel

Array = NDArray[np.float64]

MAX_PHOTOS = 800
"""The reduced normal matrix is inverted whole: 4800 unknowns take 0.4 GB and about 10 s."""

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
        Empty where there are more than `MAX_PHOTOS` images, or what was measured does not fix them.
    """
    images = list(model.images.values())
    if len(images) > MAX_PHOTOS or not images:
        return {}
    monitor.report("estimating accuracy", 0, 0)
    cameras = {camera_id: index for index, camera_id in enumerate(model.cameras)}
    lenses = {camera_id: intrinsics_of(camera) for camera_id, camera in model.cameras.items()}
    row_of = {point: row for row, point in enumerate(model.points.ids.tolist())}
    n_unknowns = 6 * len(images) + len(cameras)
    observed = [_Observed.of(image, lenses[image.camera_id], model, row_of) for image in images]
    sigma_px = max(LEAST_SIGMA_PX, _rms_px(observed))
    blocks, columns, point_blocks, point_rows = [], [], [], []
    for index, (image, seen) in enumerate(zip(images, observed, strict=True)):
        own = np.concatenate([6 * index + np.arange(6), [6 * len(images) + cameras[image.camera_id]]])
        blocks.append(seen.pose / sigma_px)
        columns.append(np.tile(own, (len(seen.pose), 1)))
        point_blocks.append(seen.point / sigma_px)
        point_rows.append(seen.rows)
    normal = _reduced(
        np.concatenate(blocks), np.concatenate(columns), np.concatenate(point_blocks), np.concatenate(point_rows),
        n_unknowns, len(model.points),
    )  # fmt: skip
    for index, image in enumerate(images):
        photo, at = measured[image.name], 6 * index
        normal[at : at + 3, at : at + 3] += np.linalg.inv(position_covariance(photo))
        normal[at + 3 : at + 6, at + 3 : at + 6] += angle_information(photo, len(images))
    try:
        np.linalg.cholesky(normal)  # what is not fixed by anything must not come out as known
    except np.linalg.LinAlgError:
        return {}
    monitor.report("estimating accuracy", 0, 0)
    whole = np.asarray(np.linalg.inv(normal), np.float64)
    return {image.name: whole[6 * i : 6 * i + 6, 6 * i : 6 * i + 6].copy() for i, image in enumerate(images)}


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


def _rms_px(observed: list[_Observed]) -> float:
    """Root mean square error of the image points along one axis, by the median, pixels."""
    lengths = np.concatenate([np.linalg.norm(seen.errors_px, axis=1) for seen in observed])
    return float(np.median(lengths)) / math.sqrt(2.0 * math.log(2.0)) if len(lengths) else 0.0


def _reduced(
    blocks: Array, columns: NDArray[np.int64], point_blocks: Array, rows: NDArray[np.int64], n: int, n_points: int
) -> Array:
    """Normal matrix of poses and lenses, shape (n, n), without the points (Schur complement)."""
    order = np.argsort(rows, kind="stable")
    squares = np.einsum("kia,kib->kab", point_blocks, point_blocks).reshape(-1, 9)
    stiffness = np.stack([np.bincount(rows, squares[:, i], n_points) for i in range(9)], axis=1).reshape(-1, 3, 3)
    values, vectors = np.linalg.eigh(stiffness)
    good = values > LEAST_STIFFNESS * np.maximum(values[:, 2:], 1e-300)
    # A point without a depth says nothing about it: its pseudo-inverse leaves that direction out.
    roots = vectors * np.sqrt(np.where(good, 1.0 / np.where(good, values, 1.0), 0.0))[:, None, :]
    cross = np.einsum("kia,kib->kab", blocks, np.einsum("kia,kab->kib", point_blocks, roots[rows]))[order]
    width = columns.shape[1]
    row_index = np.repeat(columns[order].ravel(), 3)
    column_index = (3 * rows[order][:, None, None] + np.arange(3)[None, None, :] + np.zeros((1, width, 1), int)).ravel()
    b = sparse.csr_array((cross.ravel(), (row_index, column_index)), shape=(n, 3 * n_points))
    own = np.einsum("kia,kib->kab", blocks, blocks)
    a_rows = np.repeat(columns[:, :, None], width, axis=2).ravel()
    a_columns = np.repeat(columns[:, None, :], width, axis=1).ravel()
    a = sparse.csr_array((own.ravel(), (a_rows, a_columns)), shape=(n, n))
    return np.asarray((a - b @ b.T).toarray(), np.float64)
