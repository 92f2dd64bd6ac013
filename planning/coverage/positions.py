"""Well-spread positions and aims: where viewpoints may be tried."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import PanelFrames
from planning.geo.frames import aim, camera_axes, wrap_heading_rad
from planning.plan import ANGLE_DECIMALS, POSITION_DECIMALS, Camera, ViewpointArrays
from planning.site.free_space import SAFETY_MARGIN_M, FreeSpace

Array = NDArray[np.float64]

BORDER_SHARE = 0.3
"""Chance that a coordinate of a border position lies at the end of the airspace: rare sections are seen from there."""


def spread_positions(space: FreeSpace, frames: PanelFrames, n: int, rng: np.random.Generator) -> Array:
    """Allowed positions, shape (at most n, 3), in random order: few where the airspace is mostly forbidden.

    One third fills the airspace evenly (Sobol), one third lies on its borders, one third fans out from random panels,
    uniform in both angles of the hemisphere and in the logarithm of the distance.
    """
    low, high = space.low_enu_m + 2 * SAFETY_MARGIN_M, space.high_enu_m - 2 * SAFETY_MARGIN_M
    third = -(-n // 3)
    inside = low + sobol(third, rng) * (high - low)
    border = low + sobol(third, rng) * (high - low)
    moved = rng.random((third, 3)) < BORDER_SHARE
    border = np.where(moved, np.where(rng.random((third, 3)) < 0.5, low, high), border)
    panel = rng.integers(0, len(frames), third)
    theta, phi = rng.uniform(0.0, 0.5 * np.pi, third), rng.uniform(0.0, 2.0 * np.pi, third)
    d = hemisphere_direction(frames, panel, theta, phi)
    nearest = max(space.min_distance_m, 0.5)
    farthest = max(2.0 * nearest, float(np.linalg.norm(high - low)))
    distance = nearest * (farthest / nearest) ** rng.random(third)
    fan = frames.centroids[panel] + distance[:, None] * d
    points = np.concatenate([inside, border, fan])
    points = points[rng.permutation(len(points))]
    return points[space.is_allowed(points)][:n]


def hemisphere_direction(frames: PanelFrames, panel: NDArray[np.int64], theta_rad: Array, phi_rad: Array) -> Array:
    """Unit vectors from the centroids outwards at polar angle theta and azimuth phi, shape (k, 3)."""
    across = np.cos(phi_rad)[:, None] * frames.tangents[panel] + np.sin(phi_rad)[:, None] * frames.bitangents[panel]
    return np.cos(theta_rad)[:, None] * frames.normals[panel] + np.sin(theta_rad)[:, None] * across


def aimed_views(positions_enu_m: Array, targets_enu_m: Array, camera: Camera) -> ViewpointArrays:
    """Views from positions towards targets, both shape (n, 3), with the pitch kept inside the gimbal's range."""
    heading, pitch = aim(targets_enu_m - positions_enu_m)
    low, high = np.radians(camera.gimbal_pitch_deg)
    return ViewpointArrays(positions_enu_m, heading, np.clip(pitch, low, high))


def rounded(views: ViewpointArrays, camera: Camera) -> ViewpointArrays:
    """Views as a plan file holds them: decimals, headings in (-180, 180] degrees, pitches within the gimbal's range."""
    low, high = camera.gimbal_pitch_deg
    heading_deg = np.degrees(wrap_heading_rad(views.heading_rad)).round(ANGLE_DECIMALS)
    heading_deg = np.where(heading_deg <= -180.0, 180.0, heading_deg)
    pitch_deg = np.clip(np.degrees(views.pitch_rad).round(ANGLE_DECIMALS), low, high)
    return ViewpointArrays(
        views.positions_enu_m.round(POSITION_DECIMALS), np.radians(heading_deg), np.radians(pitch_deg)
    )


SOBOL_BITS = 30
PRIMITIVE = ((0, 0, ()), (1, 0, (1,)), (2, 1, (1, 3)))
"""Of each axis: degree of its primitive polynomial, the inner coefficients as bits, and the first odd numbers (S. Joe
and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections", 2008)."""


@cache
def sobol_directions() -> NDArray[np.uint32]:
    """Direction numbers, shape (3, `SOBOL_BITS`): what each bit of a point's number turns over in its coordinates."""
    directions = np.zeros((3, SOBOL_BITS), np.uint32)
    for axis, (degree, inner, first) in enumerate(PRIMITIVE):
        numbers = [1] * SOBOL_BITS if degree == 0 else list(first)
        for bit in range(len(numbers), SOBOL_BITS):
            number = numbers[bit - degree] ^ (numbers[bit - degree] << degree)
            for back in range(1, degree):
                number ^= (inner >> (degree - 1 - back) & 1) * (numbers[bit - back] << back)
            numbers.append(number)
        directions[axis] = [number << (SOBOL_BITS - 1 - bit) for bit, number in enumerate(numbers)]
    return directions


def sobol(n: int, rng: np.random.Generator) -> Array:
    """Scrambled Sobol points in the unit cube, shape (n, 3).

    Scrambled by a random triangular matrix over the bits of each axis and a random shift (J. Matousek, "On the
    L2-discrepancy for anchored boxes", 1998). SciPy has the same, in a module that takes a second to load.
    """
    places = np.arange(SOBOL_BITS - 1, -1, -1, dtype=np.uint32)
    # By axis, bit of the number, and bit of the coordinate, from the highest.
    bits = (sobol_directions()[..., None] >> places) & 1
    mixed = np.tril(rng.integers(0, 2, (3, SOBOL_BITS, SOBOL_BITS)), -1) + np.eye(SOBOL_BITS, dtype=np.int64)
    scrambled = (bits @ mixed.transpose(0, 2, 1) & 1) @ (np.int64(1) << places.astype(np.int64))
    points = np.tile(rng.integers(0, 1 << SOBOL_BITS, 3), (n, 1))
    numbers = np.arange(n)[:, None]
    for bit in range(max(0, n - 1).bit_length()):
        points ^= (numbers >> bit & 1) * scrambled[:, bit]
    return points / float(1 << SOBOL_BITS)


def picture_corners(views: ViewpointArrays, camera: Camera, depth_m: float) -> Array:
    """Corners of each view's picture at a depth, shape (n, 4, 3): lower left, lower right, upper right, upper left."""
    forward, right, up = camera_axes(views.heading_rad, views.pitch_rad)
    x = camera.half_width * np.array([-1.0, 1.0, 1.0, -1.0])
    y = camera.half_height * np.array([-1.0, -1.0, 1.0, 1.0])
    rays = forward[:, None] + x[:, None] * right[:, None] + y[:, None] * up[:, None]
    return np.asarray(views.positions_enu_m[:, None] + depth_m * rays)
