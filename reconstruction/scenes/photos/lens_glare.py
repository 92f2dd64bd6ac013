"""Light that a lens scatters: a veil over the picture and a bloom around what is brighter than white."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
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
