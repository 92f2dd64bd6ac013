"""Dense depth along the normals of walls: what photos agree on where points are too few.

Plain walls and panes give few points, and sides without any are guessed. But photos show them: a patch of a wall is
looked up in the photos that see it best, at each of many distances before and behind the side that was found or
guessed. Where the distance is right, all photos show the same (plane sweep: D. Gallup et al., Real-time plane-sweeping
stereo with multiple sweeping directions, CVPR 2007). One patch may err; a side is believed where many of its patches
have the same distance, and only these become points. Cost: patches x distances x photos x samples, compiled.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.jit import chunks, kernel, run_parallel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import PosedPhoto
from reconstruction.coarse.buildings import Buildings, Face
from reconstruction.coarse.cloud import Cloud

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

PICTURE_PX = 1000
"""Longer side of photos, about."""

N_SAMPLES = 9
"""Along each side of a patch."""

PATCH = 1.3
"""Sides of patches, in their distances."""

MOST_PATCHES, LEAST_PATCH_M, MOST_PATCH_M = 1500, 0.6, 3.0

N_VIEWS, LEAST_FACING = 5, 0.35
"""Photos of a patch, and the cosine of the angle between its normal and the ray to each."""

REACH, MOST_REACH_M, NEAR_M = 0.35, 10.0, 0.5
"""How far guessed sides are moved, in parts of the building's width, and at most; and sides that were seen."""

MOST_DISTANCES = 201

ALIKE = 0.6
"""Median correlation of pairs of photos, from which on a patch is believed."""

LEAST_CONTRAST = 0.5
"""Grey levels, standard deviation in a blurred patch: less is not in the picture. Bare concrete has 1 or 2; noise has
as much, but not the same in two photos."""

LEAST_AGREEING, AGREEING_SHARE, CLEARER = 8, 0.2, 1.8
"""Patches of a side that agree on a distance: number, share of those that photos see, and times the next distance."""

WITHIN_STEPS = 3
"""Distances by which patches that agree may differ: on plain walls each errs by more than a step."""

SIGMA_STEPS = 0.5
"""Standard deviation of a point at least, in steps."""

SECONDS_PER_LOOK = 5e-8
"""Of one core, for a sample in a photo at a distance, with its share of reading the photo."""


@dataclass(frozen=True, slots=True)
class DenseDepth:
    """Whether walls are looked for in photos where points are too few."""

    tolerance: float = 10.0
    name = say("dense depth")
    unit = say("% of the walls")

    def assess(self, buildings: Buildings) -> Assessment:
        """The share of walls on which there is no point."""
        area = sum(face.area_m2 for face in buildings.faces)
        if area <= 0.0:
            return Assessment(0.0, say("no wall was found"), 0.0)
        seen = sum(face.area_m2 * face.seen_share for face in buildings.faces)
        share = 100.0 * (1.0 - seen / area)
        patches = min(MOST_PATCHES, area / LEAST_PATCH_M**2)
        looks = patches * MOST_DISTANCES * N_VIEWS * N_SAMPLES**2
        return Assessment(share, say("{:.0f} % of the walls have no points", share), looks * SECONDS_PER_LOOK)


@kernel
def _likeness(
    pictures: Picture,
    starts: NDArray[np.int64],
    sizes: NDArray[np.int64],
    projections: Array,
    views: NDArray[np.int64],
    middles: Array,
    along: Array,
    normal: Array,
    spacing: float,
    distances: Array,
    found: Array,
) -> None:
    """Median correlation of the photos of each patch at each distance; NaN where fewer than two show it.

    Parameters
    ----------
    pictures, starts, sizes
        All pixels in a row, where each picture begins, and its width and height.
    projections
        Pixels from ENU, shape (n, 3, 4).
    views
        Rows of photos of each patch, shape (k, v); -1 for none.
    middles
        Shape (k, 3).
    along
        Level unit vector in the wall; the other is z.
    found
        Written to, shape (k, d).
    """
    n_views, n_samples = views.shape[1], N_SAMPLES * N_SAMPLES
    values = np.empty((n_views, n_samples))
    pairs = np.empty(n_views * (n_views - 1) // 2)
    half = 0.5 * (N_SAMPLES - 1)
    for k in range(len(middles)):
        for d in range(len(distances)):
            x0, y0, z0 = middles[k] + distances[d] * normal
            n_good = 0
            for v in range(n_views):
                row = views[k, v]
                if row < 0:
                    break
                p = projections[row]
                width, height, start = sizes[row, 0], sizes[row, 1], starts[row]
                total, squares, is_in = 0.0, 0.0, True
                for s in range(n_samples):
                    a, b = (s % N_SAMPLES - half) * spacing, (s // N_SAMPLES - half) * spacing
                    x, y, z = x0 + a * along[0], y0 + a * along[1], z0 + b
                    w = p[2, 0] * x + p[2, 1] * y + p[2, 2] * z + p[2, 3]
                    if w <= 0.0:
                        is_in = False
                        break
                    u = (p[0, 0] * x + p[0, 1] * y + p[0, 2] * z + p[0, 3]) / w - 0.5
                    t = (p[1, 0] * x + p[1, 1] * y + p[1, 2] * z + p[1, 3]) / w - 0.5
                    if not (0.0 <= u < width - 1.0 and 0.0 <= t < height - 1.0):
                        is_in = False
                        break
                    column, line = int(u), int(t)
                    at = start + line * width + column
                    u, t = u - column, t - line
                    upper = (1.0 - u) * pictures[at] + u * pictures[at + 1]
                    lower = (1.0 - u) * pictures[at + width] + u * pictures[at + width + 1]
                    value = (1.0 - t) * upper + t * lower
                    values[n_good, s] = value
                    total += value
                    squares += value * value
                mean = total / n_samples
                variance = squares / n_samples - mean * mean
                if not is_in or variance < LEAST_CONTRAST * LEAST_CONTRAST:
                    continue
                scale = 1.0 / math.sqrt(variance * n_samples)
                for s in range(n_samples):
                    values[n_good, s] = (values[n_good, s] - mean) * scale
                n_good += 1
            n_pairs = 0
            for i in range(n_good):
                for j in range(i):
                    product = 0.0
                    for s in range(n_samples):
                        product += values[i, s] * values[j, s]
                    pairs[n_pairs] = product
                    n_pairs += 1
            found[k, d] = np.median(pairs[:n_pairs]) if n_pairs else np.nan


def swept(
    photos: Sequence[PosedPhoto],
    picture: Callable[[PosedPhoto], NDArray[np.uint8]],
    buildings: Buildings,
    cloud: Cloud,
    step_m: float,
    monitor: Monitor = QUIET,
) -> Cloud:
    """Points of walls that photos agree on, with the cameras that see them.

    Parameters
    ----------
    photos
        In the frame of the buildings, z up, metres; those of the cloud's cameras, in their order.
    picture
        Of a photo, grey, of any size.
    step_m
        Between distances that are tried.

    Raises
    ------
    ValueError
        The photos were not taken where the cloud's cameras are.
    """
    places = np.array([photo.pose.position_enu_m for photo in photos]).reshape(-1, 3)
    if places.shape != cloud.centres.shape or not np.allclose(places, cloud.centres, atol=1e-3):
        raise ValueError("photos: expected those of the cloud's cameras, in their order")
    faces = [face for face in buildings.faces if face.area_m2 > 4.0 * LEAST_PATCH_M**2]
    area = sum(face.area_m2 for face in faces)
    patch_m = float(np.clip(math.sqrt(area / MOST_PATCHES), LEAST_PATCH_M, MOST_PATCH_M))
    spacing = PATCH * patch_m / (N_SAMPLES - 1)
    caster = RayCaster(buildings.mesh)
    watched = [Patches.of(face, patch_m, photos, caster) for face in faces]
    looking = np.unique(np.concatenate([one.views.ravel() for one in watched])) if watched else np.zeros(0, np.int64)
    looking = looking[looking >= 0]
    if not len(looking):
        return cloud.of(np.zeros(len(cloud), bool))
    gsd_px = [one.metres_per_px(photos) for one in watched]
    shown = ShownPhotos.of(photos, looking.tolist(), picture, spacing, float(np.nanmedian(gsd_px)), monitor)
    width = _width_m(buildings.mesh)
    parts: list[tuple[Array, NDArray[np.int64], Array]] = []
    for done, (face, one) in enumerate(zip(faces, watched, strict=True)):
        monitor.report(say("looking for walls"), done, len(faces))
        reach = NEAR_M if face.wall is not None else min(MOST_REACH_M, max(NEAR_M, REACH * width))
        step = max(step_m, 2.0 * reach / (MOST_DISTANCES - 1))
        n_steps = round(reach / step)
        distances = step * np.arange(-n_steps, n_steps + 1, dtype=np.float64)
        likeness = shown.likeness(one, spacing, distances)
        rows, at = _agreed(likeness, distances, max(1, round(WITHIN_STEPS * step_m / step)))
        if face.wall is not None:
            rows, at = _within_edges(shown, one, rows, at, spacing, distances)
        if len(rows) >= LEAST_AGREEING:
            at, sigma = _straightened(one.middles[rows] @ one.along, at)
            middles = one.middles[rows] + at[:, None] * one.normal
            points = (middles[:, None] + one.outline(patch_m)).reshape(-1, 3)
            views = np.repeat(one.views[rows], 4, axis=0)
            parts.append((points, views, np.full(len(points), max(sigma, SIGMA_STEPS * step))))
    return _as_cloud(cloud, parts)


def joined(one: Cloud, other: Cloud) -> Cloud:
    """Points of both clouds, which have the same cameras."""
    return replace(
        one,
        points=np.concatenate([one.points, other.points]),
        rgb=np.concatenate([one.rgb, other.rgb]),
        sigmas=np.concatenate([one.sigmas, other.sigmas]),
        towards=np.concatenate([one.towards, other.towards]),
        n_views=np.concatenate([one.n_views, other.n_views]),
        starts=np.concatenate([one.starts, one.starts[-1] + other.starts[1:]]),
        cameras=np.concatenate([one.cameras, other.cameras]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Patches of a side, and the photos that see each: rows, shape (k, v), -1 for none."""

    normal: Array
    along: Array
    middles: Array
    views: NDArray[np.int64]

    @classmethod
    def of(cls, face: Face, patch_m: float, photos: Sequence[PosedPhoto], caster: RayCaster) -> Patches:
        """Of a side: the photos that see most of each, and that nothing of the mesh hides it from."""
        start, end = (np.array([*end, 0.0]) for end in face.ends_m)
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        normal = np.array([along[1], -along[0], 0.0])
        n_along, n_up = max(1, int(length / patch_m)), max(1, int((face.top_m - face.bottom_m) / patch_m))
        a = (np.arange(n_along) + 0.5) * length / n_along
        z = face.bottom_m + (np.arange(n_up) + 0.5) * (face.top_m - face.bottom_m) / n_up
        a, z = (part.ravel() for part in np.meshgrid(a, z))
        middles = start + a[:, None] * along + z[:, None] * [0.0, 0.0, 1.0]
        views = np.full((len(middles), N_VIEWS), -1, np.int64)
        best = np.full((len(middles), N_VIEWS), 0.0)
        for row, photo in enumerate(photos):
            rays = photo.pose.position_enu_m - middles
            far = np.linalg.norm(rays, axis=1)
            facing = rays @ normal / np.maximum(far, 1e-9)
            good = (facing > LEAST_FACING) & photo.sees(middles)
            if good.any():
                hits = caster.cast(middles[good] + 0.05 * normal, rays[good])
                good[good] = ~(hits.distance_m < 1.0)
            worth = np.where(good, facing / np.maximum(far, 1e-9), 0.0)
            worst = np.argmin(best, axis=1)
            better = worth > best[np.arange(len(best)), worst]
            best[better, worst[better]] = worth[better]
            views[better, worst[better]] = row
        order = np.argsort(-best, axis=1, kind="stable")
        return cls(normal, along, middles, np.take_along_axis(views, order, axis=1))

    def outline(self, patch_m: float) -> Array:
        """Points on the upper and the lower edge of what a patch stands for, from its middle, shape (4, 3)."""
        up = np.array([0.0, 0.0, 1.0])
        return patch_m * np.array([0.25 * a * self.along + 0.5 * b * up for a in (-1.0, 1.0) for b in (-1.0, 1.0)])

    def metres_per_px(self, photos: Sequence[PosedPhoto]) -> float:
        """Of the photos as they are reduced, at the patches; NaN where no photo sees one."""
        seen = np.flatnonzero(self.views[:, 0] >= 0)
        found = []
        for row in seen[:: max(1, len(seen) // 20)].tolist():
            photo = photos[int(self.views[row, 0])]
            far = float(np.linalg.norm(photo.pose.position_enu_m - self.middles[row]))
            longer = max(photo.intrinsics.width_px, photo.intrinsics.height_px)
            found.append(far / (photo.intrinsics.fx_px * PICTURE_PX / longer))
        return float(np.median(found)) if found else math.nan


@dataclass(frozen=True, slots=True, eq=False)
class ShownPhotos:
    """Pictures without distortion, reduced, one after the other; photos that see no patch have none."""

    pictures: Picture
    starts: NDArray[np.int64]
    sizes: NDArray[np.int64]
    projections: Array

    @classmethod
    def of(
        cls,
        photos: Sequence[PosedPhoto],
        rows: Sequence[int],
        picture: Callable[[PosedPhoto], NDArray[np.uint8]],
        spacing_m: float,
        metres_per_px: float,
        monitor: Monitor = QUIET,
    ) -> ShownPhotos:
        """Blurred by as much as samples are apart."""
        blur_px = float(np.clip(0.5 * spacing_m / metres_per_px, 0.7, 6.0))
        parts, starts = [], np.zeros(len(photos), np.int64)
        sizes, projections = np.zeros((len(photos), 2), np.int64), np.zeros((len(photos), 3, 4))
        n = 0
        for done, row in enumerate(rows):
            monitor.report(say("looking at photos"), done, len(rows))
            photo = photos[row]
            lens = photo.intrinsics
            scale = min(1.0, PICTURE_PX / max(lens.width_px, lens.height_px))
            width, height = round(scale * lens.width_px), round(scale * lens.height_px)
            shown = cv2.resize(picture(photo), (width, height), interpolation=cv2.INTER_AREA)
            lens = lens.scaled(width, height)
            if not lens.is_straight:
                shown = cv2.undistort(shown, _of_opencv(lens.matrix), np.array(lens.distortion))
            shown = cv2.GaussianBlur(shown.astype(np.float32), (0, 0), blur_px)
            turn = photo.pose.cam_from_enu
            shift = -turn @ photo.pose.position_enu_m
            projections[row] = lens.matrix @ np.column_stack([turn, shift])
            starts[row], sizes[row] = n, (width, height)
            parts.append(shown.ravel())
            n += width * height
        return cls(np.concatenate(parts), starts, sizes, projections)

    def likeness(self, watched: Patches, spacing_m: float, distances: Array) -> Array:
        """Of the patches at the distances, shape (k, d)."""
        found = np.full((len(watched.middles), len(distances)), np.nan)

        def work(start: int, stop: int) -> None:
            _likeness(
                self.pictures,
                self.starts,
                self.sizes,
                self.projections,
                watched.views[start:stop],
                watched.middles[start:stop],
                watched.along,
                watched.normal,
                spacing_m,
                distances,
                found[start:stop],
            )

        run_parallel(work, chunks(len(found), 32))
        return found


def _of_opencv(matrix: Array) -> Array:
    """With the middle of the first pixel at 0."""
    moved = matrix.copy()
    moved[:2, 2] -= 0.5
    return moved


def _agreed(likeness: Array, distances: Array, within: int) -> tuple[NDArray[np.int64], Array]:
    """Rows of patches that agree on a distance up to so many steps, and the distance of each."""
    seen = np.flatnonzero(np.isfinite(likeness).sum(axis=1) > 0.5 * len(distances))
    none = np.zeros(0, np.int64), np.zeros(0)
    if len(seen) < LEAST_AGREEING:
        return none
    curves = np.nan_to_num(likeness[seen], nan=-1.0)
    best = np.argmax(curves, axis=1)
    is_good = (curves[np.arange(len(seen)), best] >= ALIKE) & (best > 0) & (best < len(distances) - 1)
    rows, best = seen[is_good], best[is_good]
    counts = np.convolve(np.bincount(best, minlength=len(distances)), np.ones(2 * within + 1, int), "full")
    counts = counts[within : within + len(distances)]
    mode = int(np.argmax(counts))
    elsewhere = counts[np.abs(np.arange(len(distances)) - mode) > 3 * within]
    least = max(LEAST_AGREEING, AGREEING_SHARE * len(seen), CLEARER * (elsewhere.max() if len(elsewhere) else 0))
    if counts[mode] < least:
        return none
    near = np.abs(best - mode) <= within
    return rows[near], distances[best[near]]


def _within_edges(
    shown: ShownPhotos, patches: Patches, rows: NDArray[np.int64], at: Array, spacing_m: float, distances: Array
) -> tuple[NDArray[np.int64], Array]:
    """Patches whose middle is on the wall: moved by a quarter to either side they agree, too.

    A patch that looks half beyond a corner agrees on the half that does not, and would make the wall longer. Guessed
    sides have the corners of their neighbours.
    """
    if not len(rows):
        return rows, at
    near = distances[(distances >= at.min() - 1e-9) & (distances <= at.max() + 1e-9)]
    quarter_m = 0.25 * spacing_m * (N_SAMPLES - 1)
    inside = np.ones(len(rows), bool)
    for moved in (quarter_m * patches.along, -quarter_m * patches.along):
        others = replace(patches, middles=patches.middles[rows] + moved, views=patches.views[rows])
        likeness = np.nan_to_num(shown.likeness(others, spacing_m, near), nan=-1.0)
        inside &= likeness.max(axis=1) >= ALIKE
    return rows[inside], at[inside]


def _straightened(along: Array, at: Array) -> tuple[Array, float]:
    """Distances on the straight line that they lie near, and its standard deviation in their middle."""
    system = np.column_stack([np.ones(len(at)), along - along.mean()])
    weights = np.ones(len(at))
    line = np.zeros(2)
    for _ in range(5):
        root = np.sqrt(weights)
        line = np.linalg.lstsq(root[:, None] * system, root * at, rcond=None)[0]
        off = at - system @ line
        spread = max(1e-6, float(np.median(np.abs(off))))
        weights = 1.0 / (1.0 + (off / (2.0 * spread)) ** 2)
    return system @ line, spread / math.sqrt(len(at))


def _width_m(mesh: TriangleMesh) -> float:
    return float(np.ptp(mesh.vertices_enu_m[:, :2], axis=0).min()) if len(mesh.triangles) else 0.0


def _as_cloud(cloud: Cloud, parts: Sequence[tuple[Array, NDArray[np.int64], Array]]) -> Cloud:
    if not parts:
        return cloud.of(np.zeros(len(cloud), bool))
    points = np.concatenate([part[0] for part in parts])
    views = np.concatenate([part[1] for part in parts])
    is_there = views >= 0
    counts = is_there.sum(axis=1)
    rays = cloud.centres[np.maximum(views, 0)] - points[:, None]
    rays /= np.maximum(np.linalg.norm(rays, axis=2, keepdims=True), 1e-9)
    towards = (rays * is_there[..., None]).sum(axis=1)
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    return Cloud(
        points,
        np.full((len(points), 3), 128, np.uint8),
        np.concatenate([part[2] for part in parts]),
        towards,
        counts.astype(np.int64),
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        views[is_there],
        cloud.centres,
    )
