"""COLMAP models as records, exactly as their files have them (colmap.github.io, "Output Format").

COLMAP's world is whatever frame its model is in; its camera axes are ours (x right, y down, z forward), and so are its
pixels (the centre of the first is (0.5, 0.5)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.base.cameras import Intrinsics

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


# COLMAP's camera models (colmap.github.io, "Camera Models"): which are understood, and what they are to us.

NUMBERS = {
    "SIMPLE_PINHOLE": 0,
    "PINHOLE": 1,
    "SIMPLE_RADIAL": 2,
    "RADIAL": 3,
    "OPENCV": 4,
    "OPENCV_FISHEYE": 5,
    "FULL_OPENCV": 6,
    "SIMPLE_RADIAL_FISHEYE": 8,
    "RADIAL_FISHEYE": 9,
}
"""Models that are understood, with their numbers in binary files."""

N_PARAMETERS = {
    "SIMPLE_PINHOLE": 3,
    "PINHOLE": 4,
    "SIMPLE_RADIAL": 4,
    "RADIAL": 5,
    "OPENCV": 8,
    "OPENCV_FISHEYE": 8,
    "FULL_OPENCV": 12,
    "SIMPLE_RADIAL_FISHEYE": 4,
    "RADIAL_FISHEYE": 5,
}

FISHEYE = "_FISHEYE"
"""Ending of the names of models with distortion by the angle from the axis."""

OTHERS = {
    7: "FOV",
    10: "THIN_PRISM_FISHEYE",
    11: "RAD_TAN_THIN_PRISM_FISHEYE",
}

NAMES = {number: name for name, number in NUMBERS.items()}

RATIONAL_TOLERANCE_PX = 0.1
"""A rational distortion that Brown's polynomial follows to this everywhere in the picture may be told by it: a tenth
of a pixel is below what panel corners are found to."""

N_RADII = 400
"""Distances from the centre at which a rational distortion is compared."""

BEYOND = 4.0 / 3.0
"""Of the picture's corners, how far out: distortion moves straight points inwards by up to a fifth or so."""


def unsupported_camera_model(camera_id: int, model: str, place: str) -> InputError:
    """The error about a camera model that is not one of `NUMBERS`."""
    return InputError.say(
        "the camera model {} is not supported; expected one of {}; undistort the images with COLMAP "
        "(image_undistorter), which then writes PINHOLE cameras",
        model,
        ", ".join(NUMBERS),
        place=say("{}, camera {}", place, camera_id),
    )


def check_camera(camera: ColmapCamera, place: str) -> None:
    """Raise `InputError` unless a camera is of a known model and whole."""
    if camera.model not in NUMBERS:
        raise unsupported_camera_model(camera.id, camera.model, place)
    expected = N_PARAMETERS[camera.model]
    if len(camera.parameters) != expected or not np.isfinite(camera.parameters).all():
        raise InputError(
            say(
                "expected {} numbers for {}, got {}",
                expected,
                camera.model,
                camera.parameters,
                place=say("{}, camera {}", place, camera.id),
            )
        )
    n_focal = 1 if camera.model.startswith(("SIMPLE", "RADIAL")) else 2
    if camera.width_px < 1 or camera.height_px < 1 or min(camera.parameters[:n_focal]) <= 0.0:
        raise InputError(
            say(
                "expected a picture and a focal length above 0, got {} x {} and {}",
                camera.width_px,
                camera.height_px,
                camera.parameters[:n_focal],
                place=say("{}, camera {}", place, camera.id),
            )
        )


def intrinsics_of(camera: ColmapCamera) -> Intrinsics:
    """Our intrinsics of a camera.

    FULL_OPENCV's rational distortion becomes the polynomial that follows it best.

    Raises
    ------
    InputError
        The model is not understood, or no polynomial follows its distortion to `RATIONAL_TOLERANCE_PX`.
    """
    check_camera(camera, "COLMAP model")
    p = (*camera.parameters, *[0.0] * 12)  # parameters that a model does not have are 0
    width, height, is_fisheye = camera.width_px, camera.height_px, camera.model.endswith(FISHEYE)
    if camera.model.startswith(("SIMPLE", "RADIAL")):  # f, cx, cy and up to two of k
        pinhole = Intrinsics(width, height, p[0], p[0], p[1], p[2])
        if is_fisheye:
            return replace(pinhole, fisheye=(p[3], p[4], 0.0, 0.0))
        return replace(pinhole, distortion=(p[3], p[4], 0.0, 0.0, 0.0))
    if is_fisheye:
        return Intrinsics(width, height, p[0], p[1], p[2], p[3], fisheye=(p[4], p[5], p[6], p[7]))
    distortion = p[4], p[5], p[6], p[7], p[8]
    intrinsics = Intrinsics(width, height, p[0], p[1], p[2], p[3], distortion)
    return _followed(intrinsics, p[9:12], camera.id) if any(p[9:12]) else intrinsics


def camera_of(intrinsics: Intrinsics, camera_id: int) -> ColmapCamera:
    """The simplest of COLMAP's models that holds our intrinsics exactly."""
    i = intrinsics
    pinhole = (i.fx_px, i.fy_px, i.cx_px, i.cy_px)
    if i.is_straight:
        return ColmapCamera(camera_id, "PINHOLE", i.width_px, i.height_px, pinhole)
    if i.fisheye is not None:
        return ColmapCamera(camera_id, "OPENCV_FISHEYE", i.width_px, i.height_px, (*pinhole, *i.fisheye))
    if i.distortion[4] == 0.0:
        return ColmapCamera(camera_id, "OPENCV", i.width_px, i.height_px, (*pinhole, *i.distortion[:4]))
    parameters = (*pinhole, *i.distortion, 0.0, 0.0, 0.0)
    return ColmapCamera(camera_id, "FULL_OPENCV", i.width_px, i.height_px, parameters)


def _followed(start: Intrinsics, denominator: tuple[float, ...], camera_id: int) -> Intrinsics:
    """Brown's k1, k2, k3 that follow (1 + k1 r^2 + ...) / (1 + k4 r^2 + k5 r^4 + k6 r^6) best over the picture."""
    reach_x = max(start.cx_px, start.width_px - start.cx_px) / start.fx_px
    reach_y = max(start.cy_px, start.height_px - start.cy_px) / start.fy_px
    radius = np.linspace(0.0, BEYOND * math.hypot(reach_x, reach_y), N_RADII)
    r2 = radius**2
    k1, k2, p1, p2, k3 = start.distortion
    k4, k5, k6 = denominator
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        wanted = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6))) - 1.0
    off_px, scale = math.inf, float(r2[-1])
    found: Array = np.zeros(3)
    if np.isfinite(wanted).all():
        powers = np.stack([r2 / scale, (r2 / scale) ** 2, (r2 / scale) ** 3], axis=1)
        found = np.asarray(np.linalg.lstsq(powers * radius[:, None], wanted * radius, rcond=None)[0], np.float64)
        off_px = float(np.abs((powers @ found - wanted) * radius).max()) * max(start.fx_px, start.fy_px)
    if not off_px <= RATIONAL_TOLERANCE_PX:
        raise InputError(
            say(
                "COLMAP model: the rational distortion of camera {} is {:.2g} px from the nearest polynomial; "
                "expected at most {:g} px; undistort the images in COLMAP (image_undistorter)",
                camera_id,
                off_px,
                RATIONAL_TOLERANCE_PX,
            )
        )
    a, b, c = (found / (scale, scale**2, scale**3)).tolist()
    return replace(start, distortion=(a, b, p1, p2, c))
