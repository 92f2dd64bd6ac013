"""COLMAP's camera models (colmap.github.io, "Camera Models"): which are understood, and what they are to us."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from planning.base.errors import InputError
from reconstruction.base.cameras import Intrinsics
from reconstruction.colmap.record import Array, ColmapCamera

NUMBERS = {
    "SIMPLE_PINHOLE": 0,
    "PINHOLE": 1,
    "SIMPLE_RADIAL": 2,
    "RADIAL": 3,
    "OPENCV": 4,
    "FULL_OPENCV": 6,
}
"""Models that are understood, with their numbers in binary files."""

N_PARAMETERS = {"SIMPLE_PINHOLE": 3, "PINHOLE": 4, "SIMPLE_RADIAL": 4, "RADIAL": 5, "OPENCV": 8, "FULL_OPENCV": 12}

OTHERS = {
    5: "OPENCV_FISHEYE",
    7: "FOV",
    8: "SIMPLE_RADIAL_FISHEYE",
    9: "RADIAL_FISHEYE",
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


def refuse(camera_id: int, model: str, place: str) -> InputError:
    """The error about a camera model that is not understood."""
    return InputError(
        f"{place}: camera {camera_id} has the model {model}; expected one of {', '.join(NUMBERS)}; undistort the "
        "images in COLMAP (image_undistorter), which gives PINHOLE cameras"
    )


def check_camera(camera: ColmapCamera, place: str) -> None:
    """Raise `InputError` unless a camera is of a known model and whole."""
    if camera.model not in NUMBERS:
        raise refuse(camera.id, camera.model, place)
    expected = N_PARAMETERS[camera.model]
    if len(camera.parameters) != expected or not np.isfinite(camera.parameters).all():
        raise InputError(
            f"{place}: camera {camera.id}: expected {expected} numbers for {camera.model}, got {camera.parameters}"
        )
    n_focal = 1 if camera.model.startswith(("SIMPLE", "RADIAL")) else 2
    if camera.width_px < 1 or camera.height_px < 1 or min(camera.parameters[:n_focal]) <= 0.0:
        raise InputError(
            f"{place}: camera {camera.id}: expected a picture and a focal length above 0, got {camera.width_px} x "
            f"{camera.height_px} and {camera.parameters[:n_focal]}"
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
    width, height = camera.width_px, camera.height_px
    if camera.model.startswith(("SIMPLE", "RADIAL")):  # f, cx, cy and up to two of k
        return Intrinsics(width, height, p[0], p[0], p[1], p[2], (p[3], p[4], 0.0, 0.0, 0.0))
    distortion = p[4], p[5], p[6], p[7], p[8]
    intrinsics = Intrinsics(width, height, p[0], p[1], p[2], p[3], distortion)
    return _followed(intrinsics, p[9:12], camera.id) if any(p[9:12]) else intrinsics


def camera_of(intrinsics: Intrinsics, camera_id: int) -> ColmapCamera:
    """The simplest of COLMAP's models that holds our intrinsics exactly."""
    i = intrinsics
    pinhole = (i.fx_px, i.fy_px, i.cx_px, i.cy_px)
    if i.is_straight:
        return ColmapCamera(camera_id, "PINHOLE", i.width_px, i.height_px, pinhole)
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
            f"COLMAP model: the rational distortion of camera {camera_id} is {off_px:.2g} px from the nearest "
            f"polynomial; expected at most {RATIONAL_TOLERANCE_PX:g} px; undistort the images in COLMAP "
            "(image_undistorter)"
        )
    a, b, c = (found / (scale, scale**2, scale**3)).tolist()
    return replace(start, distortion=(a, b, p1, p2, c))
