"""Everything far away as one picture around: sky with clouds, a hazy skyline, and the ground down to the nadir."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.scenes.record import Sky
from reconstruction.scenes.world.textures import smooth_noise

Picture = NDArray[np.float32]

HEIGHT_PX = 1024
"""0.18 degrees a pixel."""

TILE_PX = 512

CLOUD = np.array([0.93, 0.93, 0.94], np.float32)
GROUND = np.array([0.22, 0.23, 0.19], np.float32)
"""Mean light of streets and parks in the sun."""


def panorama(rng: np.random.Generator, sky: Sky, clouds: float, skyline_deg: float) -> Picture:
    """Picture as `Sky.panorama` has it, shape (HEIGHT_PX, 2 HEIGHT_PX, 3), 0 to 1.

    Parameters
    ----------
    clouds
        Share of the sky that they cover.
    skyline_deg
        Elevation of the highest building.
    """
    elevation = np.radians(90.0 - (np.arange(HEIGHT_PX) + 0.5) * (180.0 / HEIGHT_PX))
    heading = np.radians((np.arange(2 * HEIGHT_PX) + 0.5) * (180.0 / HEIGHT_PX))
    picture = np.empty((HEIGHT_PX, 2 * HEIGHT_PX, 3), np.float32)
    half = HEIGHT_PX // 2
    horizon, zenith = np.array(sky.horizon, np.float32), np.array(sky.zenith, np.float32)
    rise = np.sin(elevation[:half]).astype(np.float32)
    picture[:half] = (horizon + rise[:, None] * (zenith - horizon))[:, None]
    # Clouds lie on a level plane, which the horizon is 0.12 heights short of reaching.
    cover = _on_plane(_noise(rng, (4, 8, 16, 32, 64)), elevation[:half], heading, 0.12, 60.0)
    threshold = np.quantile(cover[: half // 2], 1.0 - clouds) if 0.0 < clouds < 1.0 else 1.0 - clouds
    share = np.clip(4.0 * (cover - np.float32(threshold)) + 0.5, 0.0, 1.0) if clouds > 0.0 else np.zeros_like(cover)
    share *= np.clip(rise / 0.12, 0.0, 1.0)[:, None]
    picture[:half] += share[..., None] * (CLOUD - picture[:half])
    ground = GROUND * _on_plane(_blocks(rng), elevation[half:], heading, 0.02, 60.0)[..., None]
    haze = np.exp(np.sin(elevation[half:]) * 12.0).astype(np.float32)[:, None, None]
    picture[half:] = ground + 0.6 * haze * (horizon - ground)
    if skyline_deg > 0.0:
        _paint_skyline(rng, picture, sky, skyline_deg)
    return np.clip(picture, 0.0, 1.0)


def _noise(rng: np.random.Generator, sizes: tuple[int, ...]) -> Picture:
    """Octaves of smooth noise, the finer the fainter, stretched to 0 to 1."""
    value = smooth_noise(rng, TILE_PX, tuple((size, 1.0 / size) for size in sizes))
    return np.asarray((value - value.min()) / (value.max() - value.min()), np.float32)


def _blocks(rng: np.random.Generator) -> Picture:
    """A town from above: roofs lighter and darker, with streets between them; around 1, and without a seam."""
    side = 16
    n = TILE_PX // side
    value = np.repeat(np.repeat(rng.uniform(0.5, 1.6, (n, n)), side, axis=0), side, axis=1).astype(np.float32)
    street = np.arange(TILE_PX) % side < 3
    value[street], value[:, street] = 0.6, 0.6
    return np.asarray(value * (0.8 + 0.4 * _noise(rng, (16, 64, 256))), np.float32)


def _on_plane(
    tile: Picture, elevation: NDArray[np.float64], heading: NDArray[np.float64], least: float, px: float
) -> Picture:
    """What lies on a level plane above or below, `px` pixels of the tile to its height."""
    away = px / (np.tan(np.abs(elevation)) + least)
    x = (away[:, None] * np.sin(heading)).astype(np.float32)
    y = (away[:, None] * np.cos(heading)).astype(np.float32)
    return np.asarray(cv2.remap(tile, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP), np.float32)


def _paint_skyline(rng: np.random.Generator, picture: Picture, sky: Sky, highest_deg: float) -> None:
    """Two rows of buildings, the further one hazier and higher."""
    horizon, scale = HEIGHT_PX // 2, HEIGHT_PX / 180.0
    haze_colour = np.array(sky.horizon)
    for haze, part in ((0.6, 1.0), (0.3, 0.6)):
        x = 0
        while x < picture.shape[1]:
            width = max(2, round(rng.uniform(1.0, 5.0) * scale))
            height = round(highest_deg * part * rng.uniform(0.25, 1.0) * scale)
            # Walls that face us are lit where the sun stands behind us.
            towards_sun = np.cos(np.radians((x + width / 2) / scale - sky.sun_heading_deg - 180.0))
            sun = np.sin(np.radians(max(0.0, 90.0 - sky.sun_elevation_deg))) * (sky.sun_elevation_deg > 0.0)
            light = 0.35 + np.array(sky.sun) * sun * max(0.0, float(towards_sun))
            shade = rng.uniform(0.25, 0.8) * rng.uniform(0.9, 1.0, 3) * light
            block = np.broadcast_to(shade, (height + 2, width, 3)).copy()
            window = rng.random((height + 2, width)) < 0.45
            window[::3] = False
            window[:, ::3] = False
            block[window] *= rng.uniform(0.3, 0.7)
            block += haze * (haze_colour - block)
            right = min(x + width, picture.shape[1])
            picture[horizon - height : horizon + 2, x:right] = block[:, : right - x]
            x += width + round(rng.choice([0.0, 0.0, rng.uniform(0.5, 3.0)]) * scale)
