"""Clouds of points on a made building of two wings on level ground, with glass that shows nothing."""

from __future__ import annotations

from functools import cache

import numpy as np

from reconstruction.coarse.cloud import Cloud

TALL = ((-12.0, -6.0), (8.0, 6.0), 15.0)
LOW = ((8.0, -6.0), (18.0, 2.0), 6.0)
"""Low and high corner in the plan, and the height."""

SIGMA_M = 0.02


def cameras(n: int = 24, radius_m: float = 40.0) -> np.ndarray:
    angles = 2.0 * np.pi * np.arange(n) / n
    heights = np.where(np.arange(n) % 2 == 0, 12.0, 28.0)
    return np.column_stack([radius_m * np.cos(angles), radius_m * np.sin(angles), heights])


def _rectangle(rng, a, b, low, high, spacing):
    """Points on an upright rectangle over the line from a to b."""
    a, b = np.array(a), np.array(b)
    n = int(np.linalg.norm(b - a) * (high - low) / spacing**2)
    along, up = rng.random((2, n))
    return np.column_stack([a + along[:, None] * (b - a), low + up * (high - low)])


def _block(rng, low, high, top, spacing):
    (x, y), (u, v) = low, high
    corners = [(x, y), (u, y), (u, v), (x, v)]
    sides = [_rectangle(rng, corners[i], corners[(i + 1) % 4], 0.0, top, spacing) for i in range(4)]
    n = int((u - x) * (v - y) / spacing**2)
    roof = np.column_stack([x + rng.random(n) * (u - x), y + rng.random(n) * (v - y), np.full(n, top)])
    return [*sides, roof]


@cache
def made_cloud(
    seed: int = 0, glass_m: float = 0.0, mirrored: int = 0, spacing: float = 0.35, blocks: tuple = (TALL, LOW)
) -> Cloud:
    """Points of both wings, or other blocks, and the ground.

    Parameters
    ----------
    glass_m
        Width of a pane in the middle of the south wall of the tall wing, on which nothing is seen.
    mirrored
        Number of points seen in it, behind the wall.
    """
    rng = np.random.default_rng(seed)
    parts = [part for block in blocks for part in _block(rng, *block, spacing)]
    n = int(60.0 * 60.0 / (3.0 * spacing) ** 2)
    ground = np.column_stack([rng.uniform(-30.0, 30.0, (n, 2)), np.zeros(n)])
    inside = [((ground[:, :2] > low) & (ground[:, :2] < high)).all(axis=1) for low, high, _ in blocks]
    points = np.concatenate([*parts, ground[~np.any(inside, axis=0)]])
    pane = (np.abs(points[:, 0] + 2.0) < glass_m / 2.0) & (np.abs(points[:, 1] + 6.0) < 0.01) & (points[:, 2] > 1.0)
    points = points[~(pane & (points[:, 2] < 14.0))]
    # Inside of the joint between the wings nothing is seen.
    joint = (np.abs(points[:, 0] - 8.0) < 0.01) & (points[:, 2] < LOW[2]) & (points[:, 1] < 2.0)
    points = points[~joint] if LOW in blocks else points
    points = points + rng.normal(0.0, SIGMA_M, points.shape)
    centres = cameras()
    rows, seen = [], []
    for row, point in enumerate(points):
        near = [k for k in np.argsort(np.linalg.norm(centres - point, axis=1)) if _is_open(centres[k], point, blocks)]
        if len(near) >= 3:
            rows.append(row)
            seen.append(near[:4])
    points = points[rows]
    if mirrored:
        ghosts = np.column_stack(
            [
                rng.uniform(-2.0 - glass_m / 2.0, -2.0 + glass_m / 2.0, mirrored),
                rng.uniform(2.0, 5.0, mirrored) - 6.0 + 2.0,
                rng.uniform(2.0, 13.0, mirrored),
            ]
        )
        south = [k for k in range(len(centres)) if centres[k, 1] < -20.0]
        points = np.concatenate([points, ghosts])
        seen += [south[:4]] * mirrored
    counts = np.array([len(each) for each in seen])
    starts = np.concatenate([[0], np.cumsum(counts)])
    watching = np.concatenate([np.array(each) for each in seen])
    towards = np.array([(centres[each] - point).mean(axis=0) for each, point in zip(seen, points, strict=True)])
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    sigmas = np.full(len(points), SIGMA_M)
    rgb = np.zeros((len(points), 3), np.uint8)
    return Cloud(points, rgb, sigmas, towards, counts, starts, watching, centres)


def _is_open(camera, point, blocks) -> bool:
    """Whether no block stands between a camera and a point on its skin."""
    for low, high, top in blocks:
        box_low, box_high = np.array([*low, -1.0]) + 0.15, np.array([*high, top]) - 0.15
        way = point - camera
        with np.errstate(divide="ignore", invalid="ignore"):
            a, b = (box_low - camera) / way, (box_high - camera) / way
        enters, leaves = np.minimum(a, b).max(), np.maximum(a, b).min()
        if enters < min(leaves, 0.999):
            return False
    return True
