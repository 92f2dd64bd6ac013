"""Refining poses with pycolmap: time and errors against the scale of the photos."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.colmap.georeference import angle_between_deg, fit
from reconstruction.colmap.record import NO_POINTS, ColmapImage, ColmapModel, camera_of, quaternion_of
from reconstruction.colmap.refine import RefineParameters, pose_covariances, refine_poses
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped, timer
from tests.reconstruction.colmap.models import covariance
from tests.reconstruction.colmap.test_refine import SIGMA_DEG, SIGMA_M, start

WALLS = ((10, 20), (16, 50), (20, 150))
"""Rows and columns of photos of made walls."""

AWAY_M, STEP_M = 12.0, (4.0, 3.0)
"""Distance to the wall and between photos: their footprints, 17 x 13 m, overlap by 76 %."""

POINTS_PER_M2, SHARE_SEEN = 12.0, 0.35
"""Points on the wall, and which part of those in its picture a photo has a feature of."""


def measure(context: Context) -> Iterator[Row]:
    """How good poses are of made walls of any size, and refining the real photos of Lund."""
    for rows, columns in WALLS[: 1 if context.is_quick else None]:
        yield from _accuracy(rows, columns)
    yield from _lund(context)


def _accuracy(rows: int, columns: int) -> Iterator[Row]:
    photos = _wall_photos(rows, columns)
    model = _wall_model(photos)
    n_seen = sum(len(image.point_ids) for image in model.images.values())
    with timer() as seconds:
        found = pose_covariances(model, {photo.name: photo for photo in photos})
    usual_m = float(np.median([np.sqrt(np.trace(known[:3, :3])) for known in found.values()]))
    scene = f"made wall, {len(photos)} photos, {n_seen} image points"
    yield Row(scene, "time for the covariances of all poses", seconds(), "s")
    yield Row(scene, "standard deviation of a position, in the middle", 1e3 * usual_m, "mm")


def _wall_photos(rows: int, columns: int) -> list[PosedPhoto]:
    rng = np.random.default_rng(0)
    lens = Intrinsics(5280, 3956, 3751.0, 3751.0, 2640.0, 1978.0)
    found = []
    for column, row in np.ndindex(columns, rows):
        position = np.array([column * STEP_M[0], -AWAY_M, 3.0 + row * STEP_M[1]]) + rng.normal(0.0, 0.3, 3)
        pose = Pose.looking(position, rng.normal(0.0, 5.0), rng.normal(0.0, 3.0), 0.0, covariance(0.02, 1.0))
        name = f"{len(found):05d}.jpg"
        found.append(PosedPhoto(name, Path(name), lens, pose))
    return found


def _wall_model(photos: list[PosedPhoto]) -> ColmapModel:
    """What the photos see of points near the wall, with noise of half a pixel; tracks are not needed."""
    rng = np.random.default_rng(1)
    places = np.array([photo.pose.position_enu_m for photo in photos])
    margin = np.array([9.0, 0.0, 6.0])
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    n = int(POINTS_PER_M2 * (high[0] - low[0]) * (high[2] - low[2]))
    xyz = rng.uniform((low[0], -0.3, low[2]), (high[0], 0.6, high[2]), (n, 3))
    xyz = xyz[np.argsort(xyz[:, 0])]
    images = {}
    for number, photo in enumerate(photos, 1):
        near = np.searchsorted(xyz[:, 0], photo.pose.position_enu_m[0] + np.array([-25.0, 25.0]))
        seen = near[0] + np.flatnonzero(photo.sees(xyz[near[0] : near[1]]))
        seen = seen[rng.random(len(seen)) < SHARE_SEEN]
        rotation = photo.pose.cam_from_enu
        x, y, z = (-rotation @ photo.pose.position_enu_m).tolist()
        pixels = photo.pixels(xyz[seen]) + rng.normal(0.0, 0.5, (len(seen), 2))
        images[number] = ColmapImage(number, quaternion_of(rotation), (x, y, z), 1, photo.name, pixels, seen + 1)
    points = replace(
        NO_POINTS, ids=np.arange(1, n + 1), xyz=xyz, rgb=np.zeros((n, 3), np.uint8), errors_px=np.zeros(n),
        starts=np.zeros(n + 1, np.int64),
    )  # fmt: skip
    return ColmapModel({1: camera_of(photos[0].intrinsics, 1)}, images, points)


def _lund(context: Context) -> Iterator[Row]:
    """The 12 photos of Lund, 1296 x 1936 pixels; one unit of the reference model counts as a metre."""
    try:
        import pycolmap  # noqa: F401  (only whether it is there)
    except ImportError:
        raise Skipped("pycolmap is not installed (pip install .[colmap])") from None
    folder = context.data("multiview/lund_door")
    given, truth = start(folder, 12)
    before_deg = [
        angle_between_deg(a.pose.cam_from_enu, b.pose.cam_from_enu) for a, b in zip(given, truth, strict=True)
    ]
    scene = f"12 photos, positions to {100 * SIGMA_M:g} cm, angles to {SIGMA_DEG:g} degrees"
    yield Row(scene, "angle to the reference before", float(np.mean(before_deg)), "degrees")
    for size in (400,) if context.is_quick else (400, 600, 1000, 1936):
        with timer() as seconds:
            found = refine_poses(given, folder, RefineParameters(max_image_size_px=size))
        pairs = list(zip(found.photos, truth, strict=True))
        ours, theirs = (
            np.array([photo.pose.position_enu_m for photo in column]) for column in zip(*pairs, strict=True)
        )
        aligned_m = np.linalg.norm(fit(ours, theirs)(ours) - theirs, axis=1)
        turns = [b.pose.cam_from_enu.T @ a.pose.cam_from_enu for a, b in pairs]
        among_deg = [angle_between_deg(turn, turns[len(turns) // 2]) for turn in turns]
        angles_deg = [angle_between_deg(a.pose.cam_from_enu, b.pose.cam_from_enu) for a, b in pairs]
        what = f"longer side {size} px"
        yield Row(scene, f"{what}: time", seconds(), "s")
        yield Row(scene, f"{what}: positions aligned to the reference, mean", 1e3 * float(aligned_m.mean()), "mm")
        yield Row(scene, f"{what}: positions aligned to the reference, worst", 1e3 * float(aligned_m.max()), "mm")
        yield Row(scene, f"{what}: angles among each other, worst", max(among_deg), "degrees")
        yield Row(
            scene,
            f"{what}: angle to the reference",
            float(np.mean(angles_deg)),
            "degrees",
            float(np.mean(angles_deg) / np.mean(before_deg)),
            "before",
        )
        points = f"{len(found.model.points)} points"
        yield Row(scene, f"{what}: image points off by", found.reprojection_px, "px", against=points)


BENCHMARK = Benchmark(
    "refined-poses",
    "Poses refined with pycolmap",
    "Positions and angles of the photos' own metadata, with known errors, against those after features were matched "
    "and all rays adjusted. The photos stand almost on one line, so that their positions hardly fix the turn about it; "
    "the angles of the photos do. Before it: what it takes to say how good the poses of large sets are, on made walls.",
    measure,
)
