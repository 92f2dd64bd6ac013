"""What the camera makes of light: vignetting, exposure, the sensor's noise, and grey levels as in a JPEG."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks
from reconstruction.scenes.parameters import NOISE, SUN_GLARE, VIGNETTING
from reconstruction.scenes.photos.renderer import RenderedPhoto

Array = NDArray[np.float64]


# Light that a lens scatters: a veil over the picture and a bloom around what is brighter than white.

Picture = NDArray[np.float32]

SCATTERED = 0.02
"""Share of light that does not go where it should: good camera lenses have a veiling glare index (ISO 9358) of 1 to 3
%."""

NARROWEST, N_OCTAVES = 1.0 / 1024.0, 9
"""Standard deviation of the narrowest part, of the picture's diagonal; each of the others is twice as wide."""

LEAST_SIGMA_PX = 2.0
"""In a halved copy of the picture: a narrower part is blurred in a larger one."""


def bloomed(light: Array) -> Array:
    """The picture, shape (h, w, 3), with what is above 1 partly scattered over it; its sum stays.

    The spread is a sum of Gaussians of equal shares, each twice as wide as the one before: it falls with the square of
    the distance, as light scattered by polished and by dusty lenses does (E. Fest, Stray Light Analysis and Control,
    SPIE 2013, section 4: bidirectional scatter falls with the angle to a power around 2). Light that would leave the
    picture is turned back at its edges, as that of suns just outside comes in.
    """
    if not (light > 1.0).any():
        return light
    picture = np.empty_like(light)
    # Colour by colour, which takes a third of the memory.
    for colour in range(light.shape[2]):
        picture[..., colour] = _bloomed(light[..., colour])
    return picture


def _bloomed(light: Array) -> Array:
    excess = np.maximum(light - 1.0, 0.0)
    wanted = float(excess.sum())
    if wanted == 0.0:
        return light
    spread = _spread(excess.astype(np.float32))
    share = SCATTERED * wanted / float(spread.sum(dtype=np.float64))
    return np.asarray(light - SCATTERED * excess + share * spread)


def _spread(picture: Picture) -> Picture:
    """The sum of the Gaussians, each in a copy of the picture that is as small as shows no less."""
    height, width = picture.shape
    sigmas_px = NARROWEST * math.hypot(height, width) * 2.0 ** np.arange(N_OCTAVES)
    levels = np.maximum(np.floor(np.log2(sigmas_px / LEAST_SIGMA_PX)), 0).astype(int)
    copies = [picture]
    for _ in range(levels[-1]):
        above = copies[-1].shape
        size = ((above[1] + 1) // 2, (above[0] + 1) // 2)
        copies.append(np.asarray(cv2.resize(copies[-1], size, interpolation=cv2.INTER_AREA), np.float32))
    whole: Picture = np.zeros_like(copies[-1])
    for level in range(levels[-1], -1, -1):
        copy = copies[level]
        whole = np.asarray(cv2.resize(whole, copy.shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)
        for sigma_px in sigmas_px[levels == level] * copy.shape[1] / width:
            whole += cv2.GaussianBlur(copy, (0, 0), sigma_px, borderType=cv2.BORDER_REFLECT)
    return whole


MIDDLE_GREY = 0.18
"""What exposure meters bring a picture's mean to (ISO 2720), of the light that is white."""

LEAST_E = 0.01
"""Of electrons and gains: with less, a white pixel is all noise."""

ROWS_AT_ONCE = 256
"""Bounds the memory of developing: 32 MB for each step at 5280 columns."""

DARKEST = 1e-6
"""Mean light below which a picture is not brightened any more."""

METER_STEPS, METER_TOLERANCE = 100, 1e-4
"""Of the iteration that finds an exposure, which gets closer from below, and where it ends."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """How far a camera is from an ideal one.

    Parameters
    ----------
    corner_loss
        Share of the light that the lens loses in the corners; from the middle it grows with the square of the distance.
        0.25 is what remains of wide lenses after the camera's own correction.
    full_well_e
        Electrons of a white pixel: 20 000 is usual for pixels of 3.3 um, as in cameras with a sensor of 17 x 13 mm and
        20 megapixels.
    read_noise_e
        Standard deviation, electrons.
    gain
        1 at base sensitivity; with twice that, half the light makes a pixel white.
    """

    corner_loss: float = 0.25
    full_well_e: float = 20_000.0
    read_noise_e: float = 3.0
    gain: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.corner_loss < 1.0:
            raise ValueError(f"corner_loss: expected 0 to below 1, got {self.corner_loss}")
        for name in ("full_well_e", "gain", "read_noise_e"):
            value, least = getattr(self, name), 0.0 if name == "read_noise_e" else LEAST_E
            if not (math.isfinite(value) and value >= least):
                raise ValueError(f"{name}: expected at least {least:g}, got {value}")

    @property
    def white_e(self) -> float:
        """Electrons that make a pixel white."""
        return self.full_well_e / self.gain

    def noise(self, light: Array) -> Array:
        """Standard deviation of light, 1 being white: shot noise and reading noise."""
        electrons = np.maximum(light, 0.0) * self.white_e
        return np.asarray(np.sqrt(electrons + self.read_noise_e**2) / self.white_e)


USUAL_SENSOR = Sensor()


def metered_exposure(photograph: RenderedPhoto) -> float:
    """Factor that brings the mean light of a photograph to middle grey.

    A meter is a sensor, too: what is brighter than white counts as white, so that the sun makes no picture black.
    """
    exposure = MIDDLE_GREY / max(float(photograph.linear.mean(dtype=np.float64)), DARKEST)
    for _ in range(METER_STEPS):
        mean = float(np.minimum(photograph.linear, 1.0 / exposure).mean(dtype=np.float64))
        brighter = MIDDLE_GREY / max(mean, DARKEST)
        if brighter <= exposure * (1.0 + METER_TOLERANCE):
            break
        exposure = brighter
    return exposure


def vignette(height_px: int, width_px: int, corner_loss: float) -> Array:
    """Share of light that reaches each pixel, shape (h, w): 1 in the middle, 1 - `corner_loss` in the corners."""
    y = (np.arange(height_px) + 0.5) / height_px * 2.0 - 1.0
    x = (np.arange(width_px) + 0.5) / width_px * 2.0 - 1.0
    square = (y[:, None] * height_px) ** 2 + (x * width_px) ** 2
    return np.asarray(1.0 - corner_loss * square / (height_px**2 + width_px**2))


def grey_levels(light: Array) -> Array:
    """Light, 1 being white, as sRGB's grey levels, 0 to 255, not rounded (IEC 61966-2-1)."""
    light = np.clip(light, 0.0, 1.0)
    curved = 1.055 * np.power(np.maximum(light, 0.0031308), 1.0 / 2.4) - 0.055
    return np.asarray(255.0 * np.where(light <= 0.0031308, 12.92 * light, curved))


def developed(
    photograph: RenderedPhoto, exposure: float | None = None, sensor: Sensor = USUAL_SENSOR
) -> NDArray[np.uint8]:
    """The photograph as a camera writes it: blue, green, red, shape (h, w, 3).

    It gets those effects of the camera that it was taken with.

    Parameters
    ----------
    exposure
        Factor that makes light of 1 / exposure white; metered where it is None.
    """
    factor = metered_exposure(photograph) if exposure is None else exposure
    if not (math.isfinite(factor) and factor > 0.0):
        raise ValueError(f"exposure: expected more than 0, got {factor}")
    height, width = photograph.panel.shape
    glare = bloomed(photograph.linear * np.float64(factor)) if SUN_GLARE in photograph.in_camera else None
    falloff = vignette(height, width, sensor.corner_loss) if VIGNETTING in photograph.in_camera else None
    picture = np.empty((height, width, 3), np.uint8)
    rng = np.random.default_rng(photograph.seed)
    for start, stop in chunks(height, ROWS_AT_ONCE):
        light = photograph.linear[start:stop] * np.float64(factor) if glare is None else glare[start:stop]
        if falloff is not None:
            light = light * falloff[start:stop, :, None]
        if NOISE in photograph.in_camera:
            # Shot noise of so many electrons is normal to all intents.
            light = light + sensor.noise(light) * rng.standard_normal(light.shape)
        picture[start:stop] = np.rint(grey_levels(light))[..., ::-1]
    return picture
