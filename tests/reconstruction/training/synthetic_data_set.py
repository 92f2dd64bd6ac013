"""A data set folder with all layers that `prepare` writes for photos, of glass that mirrors something known."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np

from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.dataset.layers import normals_to_16_bit
from tests.reconstruction.light.synthetic_folder import LENS, Light, far, write_folder


def write_data_set(
    folder: Path, n: int = 6, lens: Intrinsics = LENS, normal_step: int = 2, seed: int = 0, light: Light = far
) -> tuple[PosedPhoto, ...]:
    """Panels in the plane y = 0, looking south; the facade is all of the photo's lower half and the panels."""
    photos = write_folder(folder, light, n, seed, lens)
    for layer in ("masks", "normals"):
        (folder / layer).mkdir()
    for photo in photos:
        panels = cv2.imread(str(folder / "panels" / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
        mask = (panels > 0) | (np.arange(len(panels)) >= len(panels) // 2)[:, None]
        cv2.imwrite(str(folder / "masks" / f"{photo.name}.png"), mask.astype(np.uint8) * 255)
        middle = (normal_step // 2, normal_step // 2)
        seen = panels[middle[0] :: normal_step, middle[1] :: normal_step] > 0
        height, width = -(-lens.height_px // normal_step), -(-lens.width_px // normal_step)
        normals = np.zeros((height, width, 3), np.float32)
        normals[: seen.shape[0], : seen.shape[1]][seen] = (0.0, -1.0, 0.0)
        cv2.imwrite(str(folder / "normals" / f"{photo.name}.png"), normals_to_16_bit(normals)[..., ::-1])
    path = folder / "dataset.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"normal_step": normal_step}))
    return photos
