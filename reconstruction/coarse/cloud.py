"""The sparse points of a model: how well each is known, which are believed, which planes they lie on, and what is up.

What is known of a point is what its rays say (normal matrix of the rays' distances, weighted by focal length and
reprojection error). Planes are those that most of the thinned points lie near (RANSAC, M. Fischler and R. Bolles,
1981); samples are neighbours, so that small planes among many are found, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from planning.photos.record import PhotoMetadata
from reconstruction.colmap.record import ColmapModel, intrinsics_of

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEAST_PX = 0.5
"""Image points are taken to be no better."""

LEAST_VIEWS = 3
"""Photos that see a point which is believed: pairs match what is not the same thing."""

MOST_SIGMA = 0.05
"""Standard deviation of a believed point, in parts of its distance from the nearest camera."""

LONELY = 4.0
"""Points are left out whose neighbours are so many times as far as is usual."""

N_NEAR = 8

N_SAMPLES = 400
"""Of each plane; with a tenth of the points on it and neighbours sampled, one in five is good."""

N_NEIGHBOURS = 30
"""Among which the other two points of a sample are."""


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Believed points of a model.

    Parameters
    ----------
    points, rgb
        Shapes (n, 3), any frame, and (n, 3).
    sigmas
        Standard deviation along the axis that is known worst, shape (n,), in the unit of the points.
    towards
        Mean unit direction to the cameras that see a point, shape (n, 3).
    n_views
        Shape (n,).
    starts, cameras
        The cameras that see point i are `cameras[starts[i]:starts[i + 1]]`, rows of `centres`.
    centres
        Of all cameras, shape (m, 3).
    """

    points: Array
    rgb: NDArray[np.uint8]
    sigmas: Array
    towards: Array
    n_views: NDArray[np.int64]
    starts: NDArray[np.int64]
    cameras: NDArray[np.int64]
    centres: Array

    def __len__(self) -> int:
        return len(self.points)

    def of(self, kept: Mask) -> Cloud:
        """Some of the points."""
        counts = np.diff(self.starts)
        cameras = self.cameras[np.repeat(kept, counts)]
        starts = np.concatenate([[0], np.cumsum(counts[kept])]).astype(np.int64)
        return replace(
            self,
            points=self.points[kept],
            rgb=self.rgb[kept],
            sigmas=self.sigmas[kept],
            towards=self.towards[kept],
            n_views=self.n_views[kept],
            starts=starts,
            cameras=cameras,
        )


def cloud_of(model: ColmapModel) -> Cloud:
    """All points of a model that are seen by registered images."""
    images = list(model.images.values())
    row_of = {image.id: row for row, image in enumerate(images)}
    centres = np.array([image.centre_world for image in images]).reshape(-1, 3)
    focal = np.array([intrinsics_of(model.cameras[image.camera_id]).fx_px for image in images])
    points, counts = model.points, np.diff(model.points.starts)
    cameras = np.array([row_of[image] for image in points.tracks[:, 0].tolist()], np.int64)
    of_point = np.repeat(np.arange(len(points)), counts)
    rays = centres[cameras] - points.xyz[of_point]
    distance = np.maximum(np.linalg.norm(rays, axis=1), 1e-12)
    rays = rays / distance[:, None]
    error_px = np.maximum(points.errors_px, LEAST_PX)[of_point]
    weight = (focal[cameras] / (distance * error_px)) ** 2
    normal = np.zeros((len(points), 3, 3))
    np.add.at(normal, of_point, weight[:, None, None] * (np.eye(3) - rays[:, :, None] * rays[:, None, :]))
    least = np.maximum(np.linalg.eigvalsh(normal)[:, 0], 1e-300) if len(points) else np.zeros(0)
    towards = np.zeros((len(points), 3))
    np.add.at(towards, of_point, rays)
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-12)
    return Cloud(
        points.xyz, points.rgb, 1.0 / np.sqrt(least), towards, counts, points.starts.astype(np.int64), cameras, centres
    )


def believed(cloud: Cloud) -> Cloud:
    """Without points that few photos see, whose depth is not known, or that nothing is near."""
    if not len(cloud):
        return cloud
    first = np.minimum(cloud.starts[:-1], max(0, len(cloud.cameras) - 1))
    distance = np.linalg.norm(cloud.centres[cloud.cameras[first]] - cloud.points, axis=1)
    kept = cloud.sigmas <= MOST_SIGMA * distance
    seen = kept & (cloud.n_views >= LEAST_VIEWS)
    found = cloud.of(seen if seen.sum() >= 200 else kept)
    if len(found) <= N_NEAR:
        return found
    gaps = np.asarray(cKDTree(found.points).query(found.points, N_NEAR + 1)[0])[:, -1]
    return found.of(gaps <= LONELY * np.median(gaps))


def thinned(points: Array, cell: float) -> NDArray[np.int64]:
    """Rows of points, one in each cubic cell that has any, shape (m,)."""
    cells = np.floor((points - points.min(axis=0)) / cell).astype(np.int64) if len(points) else np.zeros((0, 3), int)
    return np.asarray(np.unique(cells, axis=0, return_index=True)[1], np.int64)


def extent_of(points: Array) -> float:
    """Size of a cloud: half of its points are within this of its middle, four times over."""
    return 4.0 * float(np.median(np.linalg.norm(points - np.median(points, axis=0), axis=1)))


WIDEST_GAP_RAD, WIDEST_OPEN_RAD = np.radians(100.0), np.radians(240.0)
"""Between two cameras of a ring, seen from its middle; the second where all look at the middle of a part of a ring.
Cameras that leave more open stand before something."""

LOOKS_AT_MIDDLE = 0.15
"""Of the usual distance to the middle: how far from it cameras of a part of a ring look, at most, most of them."""

INWARDS = np.cos(np.radians(40.0))
"""Cameras look at the middle of their ring at least so nearly, most of them."""

BESIDE_RING = 0.85
"""Of the ring's size, within which the building is: aircraft keep their distance."""


def in_ring(points: Array, centres: Array, forwards: Array) -> Mask:
    """Which points stand inside a ring of cameras, or a third of one, that look inwards; all where there is none.

    Parameters
    ----------
    points, centres
        Shapes (n, 3) and (m, 3), z up.
    forwards
        Unit directions in which the cameras look, shape (m, 3).
    """
    everything = np.ones(len(points), bool)
    level = forwards[:, :2] / np.maximum(np.linalg.norm(forwards[:, :2], axis=1, keepdims=True), 1e-9)
    across = np.eye(2) - level[:, :, None] * level[:, None, :]
    # Straight down there is no direction.
    across[np.linalg.norm(forwards[:, :2], axis=1) < 0.2] = 0.0
    normal = across.sum(axis=0)
    if len(centres) < 6 or np.linalg.cond(normal) > 30.0:
        return everything
    middle = np.linalg.solve(normal, np.einsum("mij,mj->i", across, centres[:, :2]))
    out = centres[:, :2] - middle
    away = np.maximum(np.linalg.norm(out, axis=1), 1e-9)
    bearings = np.sort(np.arctan2(out[:, 1], out[:, 0]))
    gaps = np.diff(np.append(bearings, bearings[0] + 2.0 * np.pi))
    is_inwards = -(level * out).sum(axis=1) / away > INWARDS
    beside = np.abs(level[:, 0] * out[:, 1] - level[:, 1] * out[:, 0])
    looks_there = np.median(beside) < LOOKS_AT_MIDDLE * np.median(away)
    if gaps.max() > (WIDEST_OPEN_RAD if looks_there else WIDEST_GAP_RAD) or is_inwards.mean() < 0.7:
        return everything
    # How far the ring reaches in each direction, between its cameras.
    order = np.argsort(np.arctan2(out[:, 1], out[:, 0]))
    offsets = points[:, :2] - middle
    reach = np.interp(np.arctan2(offsets[:, 1], offsets[:, 0]), bearings, away[order], period=2.0 * np.pi)
    return np.asarray(np.linalg.norm(offsets, axis=1) < BESIDE_RING * reach)


@dataclass(frozen=True, slots=True, eq=False)
class FoundPlane:
    """A plane, normal . p = offset, the normal towards the cameras.

    Parameters
    ----------
    rows
        Of the points on it.
    sigma_rad
        How well the normal is known.
    """

    normal: Array
    offset: float
    rows: NDArray[np.int64]
    sigma_rad: float


def find_planes(
    points: Array, towards: Array, tolerance: float, n_most: int, least: int, seed: int = 0
) -> list[FoundPlane]:
    """Planes that most points lie on, one after the other, each with the points that those before have left.

    Parameters
    ----------
    points
        Shape (n, 3), best thinned.
    towards
        Unit directions to the cameras, shape (n, 3).
    tolerance
        Distance from a plane up to which a point is on it.
    n_most, least
        Number of planes, and points of the smallest.
    """
    rng = np.random.default_rng(seed)
    left = np.arange(len(points))
    found: list[FoundPlane] = []
    while len(found) < n_most and len(left) >= max(3, least):
        rows = left[_best_plane(points[left], tolerance, rng)]
        if len(rows) < max(3, least):
            break
        for _ in range(3):
            normal, offset, thickness, width = _fitted(points[rows])
            rows = left[np.abs(points[left] @ normal - offset) <= tolerance]
        if float((towards[rows] @ normal).sum()) < 0.0:
            normal, offset = -normal, -offset
        sigma = max(thickness, 0.2 * tolerance) / max(width, 1e-12) / np.sqrt(len(rows))
        found.append(FoundPlane(normal, offset, rows, float(sigma)))
        left = np.setdiff1d(left, rows, assume_unique=True)
    return found


def _best_plane(points: Array, tolerance: float, rng: np.random.Generator) -> Mask:
    k = min(N_NEIGHBOURS, len(points))
    firsts = rng.integers(0, len(points), N_SAMPLES)
    near = np.asarray(cKDTree(points).query(points[firsts], k)[1]).reshape(N_SAMPLES, k)
    picks = near[np.arange(N_SAMPLES)[:, None], rng.integers(1, k, (N_SAMPLES, 2))] if k > 1 else near[:, [0, 0]]
    a, b, c = points[firsts], points[picks[:, 0]], points[picks[:, 1]]
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    good = lengths > 1e-9 * max(1e-300, float(np.median(lengths)))
    normals = normals[good] / lengths[good, None]
    offsets = (normals * a[good]).sum(axis=1)
    most, best = -1, np.zeros(len(points), bool)
    for normal, offset in zip(normals, offsets, strict=True):
        on = np.abs(points @ normal - offset) <= tolerance
        n_on = int(on.sum())
        if n_on > most:
            most, best = n_on, on
    return best


def _fitted(points: Array) -> tuple[Array, float, float, float]:
    """Normal, offset, standard deviation across the plane, and along it where that is smaller."""
    middle = points.mean(axis=0)
    _, values, axes = np.linalg.svd(points - middle, full_matrices=False)
    values = values / np.sqrt(max(1, len(points)))
    return axes[2], float(axes[2] @ middle), float(values[2]), float(values[1])


# What is up: from the cameras, which people and gimbals hold level, and from walls and floors.

ROLL_RAD = np.radians(2.0)
"""By how much cameras are rolled, one like another."""

PITCH_RAD = np.radians(30.0)
"""By how much they look up and down: next to nothing is known of that."""

MEDIAN_OF_SIGMA = 0.6745
"""Median of the amount of an error, in standard deviations."""

SWINGS = 2.0
"""Times the usual roll, from which on cameras are taken to hang from something that swings."""

LOOKS_DOWN = 0.5
"""Weight of where cameras look beside that of their pictures' down axes: they look down rather than up, but people who
stand before a house look up, by less than 60 degrees."""

NEARLY_RAD, MOST_NEARLY_RAD, NEARLY_SIGMAS = np.radians(15.0), np.radians(35.0), 4.0
"""Planes so far off the vertical or the horizontal are neither walls nor floors; first more, where up is less known."""

PLANE_RAD = np.radians(0.3)
"""Walls are plumb, and floors level, to this at best; ground is left out of account where there are walls."""

FLOOR_RAD = np.radians(3.0)
"""Ground falls by as much."""


@dataclass(frozen=True, slots=True, eq=False)
class Up:
    """Unit vector that points up, and its standard deviation about each level axis."""

    direction: Array
    sigma_rad: float
    n_walls: int = 0


TURNED = {3: (-1.0, 0.0, 0.0, -1.0), 6: (0.0, -1.0, 1.0, 0.0), 8: (0.0, 1.0, -1.0, 0.0)}
"""By EXIF's orientation: the upright picture's right and down axes in the stored picture's, x and y each."""


def upright_axes(photo: PhotoMetadata | None) -> tuple[Array, Array]:
    """Right and down of the upright picture, camera axes, shape (3,) each; None: it is stored upright."""
    a, b, c, d = TURNED.get((None if photo is None else photo.orientation) or 1, (1.0, 0.0, 0.0, 1.0))
    return np.array([a, b, 0.0]), np.array([c, d, 0.0])


def up_of_cameras(rights: Array, downs: Array) -> Up:
    """Up as cameras tell it that nobody rolled.

    Parameters
    ----------
    rights, downs
        Directions of the upright pictures' axes, shape (n, 3) each.
    """
    spread = rights.T @ rights / ROLL_RAD**2 + (np.eye(3) * len(downs) - downs.T @ downs) / PITCH_RAD**2
    direction = np.linalg.eigh(spread)[1][:, 0]
    # Upright pictures say which end is up, and so do photos that look down: those from above say nothing else of it.
    down = downs.sum(axis=0) + LOOKS_DOWN * np.cross(rights, downs).sum(axis=0)
    direction = direction if float(down @ direction) <= 0.0 else -direction
    values = np.sort(np.linalg.eigvalsh(rights.T @ rights))
    # Cameras that all look the same way tell a tilt about their own right axis by their pitch alone.
    sigma = ROLL_RAD / np.sqrt(max(values[1], ROLL_RAD**2 / PITCH_RAD**2 * len(downs) * 0.1, 1e-9))
    # Below a kite or a balloon cameras swing, one like another: their number makes the mean no better.
    swing = float(np.median(np.abs(np.arcsin(np.clip(rights @ direction, -1.0, 1.0))))) / MEDIAN_OF_SIGMA
    sigma = sigma if swing <= SWINGS * ROLL_RAD else max(sigma, swing)
    return Up(np.asarray(direction), float(np.clip(sigma, np.radians(0.5), PITCH_RAD)))


def up_of_planes(start: Up, planes: Sequence[FoundPlane]) -> Up:
    """Up by walls that are plumb and floors that are level, near where cameras say it is."""
    up, sigma, n_walls = start.direction, start.sigma_rad, 0
    first = float(np.clip(NEARLY_SIGMAS * start.sigma_rad, NEARLY_RAD, MOST_NEARLY_RAD))
    for nearly in np.sin([first, 0.5 * NEARLY_RAD, 0.5 * NEARLY_RAD]):
        normal = np.eye(3) / start.sigma_rad**2
        pull = start.direction / start.sigma_rad**2
        n_walls = 0
        for plane in planes:
            across = float(plane.normal @ up)
            if abs(across) < nearly:
                weight = 1.0 / (PLANE_RAD**2 + plane.sigma_rad**2)
                normal = normal + weight * np.outer(plane.normal, plane.normal)
                n_walls += 1
            elif np.sqrt(max(0.0, 1.0 - across**2)) < nearly:
                weight = 1.0 / (FLOOR_RAD**2 + plane.sigma_rad**2)
                normal = normal + weight * np.eye(3)
                pull = pull + weight * np.sign(across) * plane.normal
        solved = np.asarray(np.linalg.solve(normal, pull), np.float64)
        up = solved / np.linalg.norm(solved)
        level = np.eye(3) - np.outer(up, up)
        stiffness = np.linalg.eigvalsh(level @ normal @ level)[1]
        sigma = float(1.0 / np.sqrt(max(stiffness, 1e-9)))
    return Up(np.asarray(up), sigma, n_walls)


def turn_upright(up: Array) -> Array:
    """The smallest rotation, shape (3, 3), that takes a direction to z."""
    axis = np.cross(up, [0.0, 0.0, 1.0])
    sine, cosine = float(np.linalg.norm(axis)), float(up[2])
    if sine < 1e-12:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    k = axis / sine
    cross = np.array([[0.0, -k[2], k[1]], [k[2], 0.0, -k[0]], [-k[1], k[0], 0.0]])
    return np.asarray(np.eye(3) + sine * cross + (1.0 - cosine) * cross @ cross)
