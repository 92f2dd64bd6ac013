"""A data set folder whose glass mirrors something known, worked out by reflecting the camera and not the rays."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.colmap.folder import write_model
from reconstruction.colmap.georeference import model_of

Array = NDArray[np.float64]
Light = Callable[[Array, Array], Array]
"""Mirrored light, shape (n, 3), of places and directions, each shape (n, 3)."""

LENS = Intrinsics(40, 30, 36.0, 36.0, 20.0, 15.0)
DIFFUSE, REFLECTIVITY, F0 = 0.1, 0.8, 0.4
BOARD_M = 5.0
"""From the glass to what is near."""


def corners_of(columns: int = 3, rows: int = 2, gap_m: float = 0.1) -> Array:
    """Panels of 2 m x 2 m in the plane y = 0 that look south."""
    panels = []
    for row in range(rows):
        for column in range(columns):
            x, z = 2.0 * column - columns, 2.0 * row + 1.0
            a, b, c, d = x + gap_m / 2, x + 2.0 - gap_m / 2, z + gap_m / 2, z + 2.0 - gap_m / 2
            panels.append([(a, 0, c), (b, 0, c), (b, 0, d), (a, 0, d)])
    return np.array(panels, float)


def far(places: Array, omega_r: Array) -> Array:
    """Light that depends on direction alone."""
    x, z = omega_r[:, 0], omega_r[:, 2]
    return 0.5 + 0.4 * np.column_stack([np.sin(7 * x), np.cos(6 * z), np.sin(5 * (x + z))])


def near(places: Array, omega_r: Array) -> Array:
    """Light of a board parallel to the glass: stripes, 3 to 4 m wide, that show parallax."""
    hits = places - (BOARD_M + places[:, 1:2]) / omega_r[:, 1:2] * omega_r
    x, z = hits[:, 0], hits[:, 2]
    return 0.5 + 0.4 * np.column_stack([np.sin(2 * x), np.cos(1.8 * z), np.sin(1.6 * (x + z))])


def cameras(folder: Path, n: int, seed: int = 0, lens: Intrinsics = LENS) -> tuple[PosedPhoto, ...]:
    """Photos from 5 to 8 m in front of the panels, each aimed at a place on them."""
    rng = np.random.default_rng(seed)
    photos = []
    for number in range(n):
        position = np.array([rng.uniform(-4, 4), -rng.uniform(5, 8), rng.uniform(1, 6)])
        towards = np.array([rng.uniform(-2, 2), 0.0, rng.uniform(2, 4)]) - position
        heading = float(np.degrees(np.arctan2(towards[0], towards[1])))
        pitch = float(np.degrees(np.arctan2(towards[2], np.hypot(*towards[:2]))))
        name = f"p{number:02d}.png"
        photos.append(PosedPhoto(name, folder / "images" / name, lens, Pose.looking(position, heading, pitch)))
    return tuple(photos)


def write_folder(
    folder: Path, light: Light, n: int = 8, seed: int = 0, lens: Intrinsics = LENS, exposure: float = 1.0
) -> tuple[PosedPhoto, ...]:
    """Write a folder as `prepare` does, of as much as reflections are learned from."""
    photos, corners = cameras(folder, n, seed, lens), corners_of()
    for name in ("images", "panels"):
        (folder / name).mkdir(parents=True)
    for photo in photos:
        index = panel_numbers(photo, corners)
        cv2.imwrite(str(folder / "panels" / f"{photo.name}.png"), index)
        cv2.imwrite(str(photo.path), picture(photo, index > 0, light, exposure)[..., ::-1])
    write_model(folder / "sparse" / "0", model_of(photos))
    panels = [
        {"index": k, "id": f"A-{k}", "facade": "A", "corners_enu_m": c.tolist()} for k, c in enumerate(corners, 1)
    ]
    (folder / "dataset.json").write_text(json.dumps({"format": "reflight-dataset/1", "panels": panels}))
    if exposure != 1.0:
        (folder / "scene.json").write_text(json.dumps({"exposure": exposure}))
    return photos


def picture(photo: PosedPhoto, is_glass: NDArray[np.bool_], light: Light, exposure: float) -> NDArray[np.uint8]:
    """Colours of glass pixels, one ray each; grey elsewhere."""
    rows, columns = np.nonzero(is_glass)
    origins, directions = photo.rays(np.column_stack([columns, rows]) + 0.5)
    places = origins - origins[:, 1:2] / directions[:, 1:2] * directions
    mirrored_camera = photo.pose.position_enu_m * (1.0, -1.0, 1.0)
    omega_r = places - mirrored_camera
    omega_r /= np.linalg.norm(omega_r, axis=1, keepdims=True)
    fresnel = F0 + (1.0 - F0) * (1.0 - directions[:, 1:2]) ** 5
    linear = exposure * ((1.0 - REFLECTIVITY) * DIFFUSE + REFLECTIVITY * fresnel * light(places, omega_r))
    shown = np.full((*is_glass.shape, 3), 128, np.uint8)
    display = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    shown[rows, columns] = np.rint(255.0 * display)
    return shown


def mirror_directions(photo: PosedPhoto, places: Sequence[Array] | Array) -> Array:
    """From the camera's mirror image through places on the glass, unit, shape (n, 3)."""
    away = np.asarray(places) - photo.pose.position_enu_m * (1.0, -1.0, 1.0)
    return np.asarray(away / np.linalg.norm(away, axis=1, keepdims=True))


def panel_numbers(photo: PosedPhoto, corners: Array) -> NDArray[np.uint16]:
    """By where the ray through each pixel's middle meets the plane, from 1; 0 for no panel."""
    lens = photo.intrinsics
    y, x = np.mgrid[: lens.height_px, : lens.width_px] + 0.5
    origins, directions = photo.rays(np.column_stack([x.ravel(), y.ravel()]))
    places = origins - origins[:, 1:2] / directions[:, 1:2] * directions
    index = np.zeros(len(places), np.uint16)
    for number, panel in enumerate(corners, 1):
        low, high = panel[:, [0, 2]].min(axis=0), panel[:, [0, 2]].max(axis=0)
        inside = ((places[:, [0, 2]] > low) & (places[:, [0, 2]] < high)).all(axis=1)
        index[inside & (directions[:, 1] > 0.0)] = number
    return index.reshape(lens.height_px, lens.width_px)
