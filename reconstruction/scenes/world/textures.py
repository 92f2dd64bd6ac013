"""Pictures of surfaces, linear reflectance 0 to 1, made by a random generator."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.scenes.record import Rgb, Texture

Picture = NDArray[np.float32]

WINDOWS_PX_PER_M = 20.0
"""5 cm: what a photo of 1600 pixels across shows of a building 60 m away."""

N_BAYS, N_STOREYS = 8, 6
"""Of a building's windows until they repeat."""

SPECKLE_PX = 256
"""Side of a picture of grain."""


def grain(rng: np.random.Generator, colour: Rgb, contrast: float, px_per_m: float) -> Texture:
    """Stone, asphalt, render or leaves: fine grain over patches four octaves large, around a colour."""
    value = smooth_noise(rng, SPECKLE_PX, ((8, 0.35), (32, 0.25), (128, 0.25), (SPECKLE_PX, 0.15)))
    shade = 1.0 + contrast * (value[..., None] - 0.5) * 4.0
    return Texture(_reflectance(np.array(colour) * shade), px_per_m)


def smooth_noise(rng: np.random.Generator, side_px: int, octaves: tuple[tuple[int, float], ...]) -> Picture:
    """Noise that repeats without a seam, shape (side_px, side_px), 0 to the sum of the weights.

    Parameters
    ----------
    octaves
        Values along a side, which divide `side_px`, and their weight.
    """
    value = np.zeros((side_px, side_px), np.float32)
    for cells, weight in octaves:
        wrapped = np.pad(rng.random((cells, cells), np.float32), 2, mode="wrap")
        scale = side_px // cells
        large = cv2.resize(wrapped, None, fx=scale, fy=scale, interpolation=cv2.INTER_LINEAR)
        value += np.float32(weight) * large[2 * scale :][:side_px, 2 * scale :][:, :side_px]
    return value


def paving(rng: np.random.Generator, colour: Rgb, slab_m: float = 0.6) -> Texture:
    """Slabs of slightly different greys with dark joints; ten by ten until they repeat."""
    n, side = 10, 24
    picture = np.repeat(np.repeat(rng.uniform(0.8, 1.15, (n, n)), side, axis=0), side, axis=1)
    joint = np.arange(n * side) % side == 0
    picture[joint] *= 0.55
    picture[:, joint] *= 0.55
    picture *= rng.uniform(0.93, 1.07, picture.shape)
    return Texture(_reflectance(picture[..., None] * np.array(colour)), side / slab_m)


def windows(
    rng: np.random.Generator, wall: Rgb, bay_m: float, storey_m: float, opening: tuple[float, float]
) -> Texture:
    """Outer wall of a building with rows of windows.

    Parameters
    ----------
    wall
        Its colour; windows are dark, some with bright blinds.
    opening
        Width and height of the windows as shares of bay and storey.
    """
    bay, storey = round(bay_m * WINDOWS_PX_PER_M), round(storey_m * WINDOWS_PX_PER_M)
    picture = np.empty((N_STOREYS * storey, N_BAYS * bay, 3), np.float32)
    picture[:] = np.array(wall) * rng.uniform(0.95, 1.05, (*picture.shape[:2], 1))
    width, height = round(opening[0] * bay), round(opening[1] * storey)
    left, top = (bay - width) // 2, (storey - height) // 2
    for row in range(N_STOREYS):
        # The line of a floor slab.
        picture[row * storey : row * storey + 3] *= 0.7
        for column in range(N_BAYS):
            y, x = row * storey + top, column * bay + left
            picture[y - 2 : y + height + 2, x - 2 : x + width + 2] *= 0.75
            picture[y : y + height, x : x + width] = np.array([0.05, 0.07, 0.09]) * rng.uniform(0.5, 2.0)
            if rng.random() < 0.4:
                drawn = round(height * rng.uniform(0.2, 1.0))
                picture[y : y + drawn, x : x + width] = np.array([0.75, 0.72, 0.65]) * rng.uniform(0.7, 1.1)
            picture[y : y + height, x + width // 2 - 1 : x + width // 2 + 1] = np.array(wall) * 0.6
    return Texture(_reflectance(picture), WINDOWS_PX_PER_M)


def _reflectance(picture: NDArray[np.floating]) -> Picture:
    return np.asarray(np.clip(picture, 0.0, 1.0), np.float32)
