"""COLMAP models as records, exactly as their files have them (colmap.github.io, "Output Format").

COLMAP's world is whatever frame its model is in; its camera axes are ours (x right, y down, z forward), and so are its
pixels (the centre of the first is (0.5, 0.5)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NO_POINT = -1
"""Of an observation that is of no 3-D point."""


@dataclass(frozen=True, slots=True)
class ColmapCamera:
    """A camera: the name of its model, and the model's parameters in COLMAP's order."""

    id: int
    model: str
    width_px: int
    height_px: int
    parameters: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ColmapImage:
    """A registered image.

    Parameters
    ----------
    q_wxyz, t
        Rotation as a unit quaternion and translation: points_cam = R points_world + t.
    points_px
        Shape (n, 2), observations.
    point_ids
        Shape (n,), the 3-D point of each, or `NO_POINT`.
    """

    id: int
    q_wxyz: tuple[float, float, float, float]
    t: tuple[float, float, float]
    camera_id: int
    name: str
    points_px: Array
    point_ids: NDArray[np.int64]

    @property
    def cam_from_world(self) -> Array:
        """Rotation, shape (3, 3)."""
        return rotation_of(self.q_wxyz)

    @property
    def centre_world(self) -> Array:
        """Optical centre, shape (3,)."""
        return np.asarray(-self.cam_from_world.T @ np.array(self.t))


@dataclass(frozen=True, slots=True, eq=False)
class ColmapPoints:
    """3-D points and the observations that they are from.

    Parameters
    ----------
    ids, xyz, rgb, errors_px
        Shapes (n,), (n, 3), (n, 3) and (n,): world coordinates, colours, mean reprojection errors (-1: not known).
    starts, tracks
        Shapes (n + 1,) and (k, 2): the track of point i is `tracks[starts[i]:starts[i + 1]]`, each row an image's id
        and the index of its observation.
    """

    ids: NDArray[np.int64]
    xyz: Array
    rgb: NDArray[np.uint8]
    errors_px: Array
    starts: NDArray[np.int64]
    tracks: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.ids)


NO_POINTS = ColmapPoints(
    np.zeros(0, np.int64),
    np.zeros((0, 3)),
    np.zeros((0, 3), np.uint8),
    np.zeros(0),
    np.zeros(1, np.int64),
    np.zeros((0, 2), np.int64),
)


@dataclass(frozen=True, slots=True, eq=False)
class ColmapModel:
    """A sparse model: cameras and images by id, and points."""

    cameras: dict[int, ColmapCamera]
    images: dict[int, ColmapImage]
    points: ColmapPoints = NO_POINTS


def rotation_of(q_wxyz: tuple[float, float, float, float]) -> Array:
    """Rotation, shape (3, 3), of a quaternion of any length but 0.

    Raises
    ------
    ValueError
        The quaternion is 0 or not finite.
    """
    w, x, y, z = q_wxyz
    norm2 = w * w + x * x + y * y + z * z
    if not (norm2 > 0.0 and np.isfinite(norm2)):
        raise ValueError(f"expected a quaternion that is a rotation, got {q_wxyz}")
    s = 2.0 / norm2
    return np.array(
        [
            [1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)],
        ]
    )


def quaternion_of(rotation: Array) -> tuple[float, float, float, float]:
    """Unit quaternion, w at least 0, of a rotation, shape (3, 3): by its largest component, which is never small."""
    m = rotation
    squares = 1.0 + np.array(
        [
            m[0, 0] + m[1, 1] + m[2, 2],
            m[0, 0] - m[1, 1] - m[2, 2],
            m[1, 1] - m[0, 0] - m[2, 2],
            m[2, 2] - m[0, 0] - m[1, 1],
        ]
    )
    largest = int(np.argmax(squares))
    a, b, c = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    d, e, f = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
    q = np.array(((squares[0], a, b, c), (a, squares[1], d, e), (b, d, squares[2], f), (c, e, f, squares[3]))[largest])
    q = q / np.linalg.norm(q)
    w, x, y, z = (q if q[0] >= 0.0 else -q).tolist()
    return w, x, y, z
