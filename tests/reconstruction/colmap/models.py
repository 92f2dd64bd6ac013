"""Synthetic COLMAP models: a facade of points, photographed along an arc, in the site's frame."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.colmap.record import ColmapImage, ColmapModel, ColmapPoints, camera_of, quaternion_of

LENS = Intrinsics(2000, 1500, 1500.0, 1500.0, 1000.0, 750.0, (-0.05, 0.01, 0.0, 0.0, 0.0))


def photos(n=12, seed=0, rows=3, sigma_m=0.02) -> list[PosedPhoto]:
    """Photos in rows at different heights, looking at the facade y = 0 from about 12 m."""
    rng = np.random.default_rng(seed)
    found = []
    for index in range(n):
        column, row = divmod(index, rows)
        position = np.array([-6.0 + 12.0 * column / max(1, n // rows - 1), -12.0, 3.0 + 3.0 * row]) + rng.normal(
            0, 0.5, 3
        )
        pose = Pose.looking(
            position, float(rng.normal(-2.0 * position[0], 5.0)), float(rng.normal(-5.0, 3.0)), 0.0, covariance(sigma_m)
        )
        found.append(PosedPhoto(f"{index:03d}.jpg", Path(f"{index:03d}.jpg"), LENS, pose))
    return found


def covariance(sigma_m: float, sigma_deg: float = 1.0) -> np.ndarray:
    return np.diag([sigma_m**2] * 3 + [np.radians(sigma_deg) ** 2] * 3)


def model(
    posed: list[PosedPhoto], n_points=150, seed=0, sigma_px=0.0, low=(-9.0, -0.3, 0.0), high=(9.0, 0.6, 12.0)
) -> ColmapModel:
    """What the photos see of random points, near the facade or in another box, with noise."""
    rng = np.random.default_rng(seed)
    xyz = rng.uniform(low, high, (n_points, 3))
    images, tracks = {}, [[] for _ in range(n_points)]
    for number, photo in enumerate(posed, 1):
        seen = np.flatnonzero(photo.sees(xyz))
        for position, point in enumerate(seen.tolist()):
            tracks[point].append((number, position))
        rotation = photo.pose.cam_from_enu
        pixels = photo.pixels(xyz[seen]) + rng.normal(0.0, sigma_px, (len(seen), 2))
        t = tuple((-rotation @ photo.pose.position_enu_m).tolist())
        images[number] = ColmapImage(number, quaternion_of(rotation), t, 1, photo.name, pixels, seen + 1)
    lengths = [len(track) for track in tracks]
    points = ColmapPoints(
        np.arange(1, n_points + 1), xyz, np.zeros((n_points, 3), np.uint8), np.zeros(n_points),
        np.concatenate([[0], np.cumsum(lengths)]),
        np.array([entry for track in tracks for entry in track], np.int64).reshape(-1, 2),
    )  # fmt: skip
    return ColmapModel({1: camera_of(posed[0].intrinsics, 1)}, images, points)


def turned(posed: PosedPhoto, position_m: np.ndarray, angle_rad: np.ndarray) -> PosedPhoto:
    """The photo with errors of position (ENU) and of angle (rotation vector, camera axes)."""
    rotation = cv2.Rodrigues(np.asarray(angle_rad, float))[0] @ posed.pose.cam_from_enu
    pose = Pose(posed.pose.position_enu_m + position_m, rotation, posed.pose.covariance)
    return PosedPhoto(posed.name, posed.path, posed.intrinsics, pose)
