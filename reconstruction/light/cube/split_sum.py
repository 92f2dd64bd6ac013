"""The part of rough mirroring that depends on the surface alone: how much of the light around a lobe comes back.

Split sum (B. Karis, Real shading in Unreal Engine 4, SIGGRAPH 2013 course): light that a GGX surface mirrors is about
the light that its lobe sees (`cube_map`), times the integral of its reflectance, which is F0 A + B with A and B by
roughness and angle.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.functional import grid_sample

Array = NDArray[np.float64]

SIZE = 64
"""Rows (roughness) and columns (cosine) of the table, 0 and 1 included: linear in between it is off by 5e-3 at most for
angles up to 87.5 degrees, by 0.013 at 88.5, and by up to 0.1 at 89.5."""

SAMPLES = 1024
"""Half vectors of an integral, evenly spread: 7e-4 at most from 16 times as many."""

GRAZING = 1e-4
"""Cosine that stands for 0, where the integrals have a limit and their terms do not."""


@lru_cache(maxsize=1)
def split_sum_table() -> Array:
    """A and B of roughness 0 to 1 and cosine 0 to 1, shape (SIZE, SIZE, 2)."""
    roughness = np.linspace(0.0, 1.0, SIZE)
    columns = [split_sum(roughness, cosine, SAMPLES) for cosine in np.linspace(0.0, 1.0, SIZE)]
    return np.stack(columns, axis=1)


def split_sum(roughness: Array, cosine: float, n_samples: int) -> Array:
    """A and B, shape (m, 2), of roughness, shape (m,), at one cosine between normal and direction to the camera.

    GGX with alpha = roughness^2, Schlick's form of Smith's shadowing with k = alpha / 2, Schlick's Fresnel term.
    """
    cosine = max(cosine, GRAZING)
    turns, drawn = hammersley(n_samples)
    alpha = roughness[:, None] ** 2
    # Half vectors as likely as normals, but for 1 - xi = t^2 in place of xi: near the horizon, where each counts a
    # hundredfold, they are closer together, and count less.
    stretched = np.sqrt(1.0 + (alpha**2 - 1.0) * (1.0 - drawn**2))
    up = drawn / stretched
    aside = np.sqrt(np.maximum(1.0 - up * up, 0.0)) * np.cos(2.0 * np.pi * turns)
    half = np.maximum(aside * np.sqrt(1.0 - cosine * cosine) + up * cosine, 0.0)
    light, k = np.maximum(2.0 * half * up - cosine, 0.0), 0.5 * alpha
    lit = light > 0.0
    shadowing = light / np.where(lit, light * (1.0 - k) + k, 1.0) / (cosine * (1.0 - k) + k)
    weight = np.where(lit, shadowing * half * 2.0 * stretched, 0.0)
    fresnel = (1.0 - np.minimum(half, 1.0)) ** 5
    return np.stack([(weight * (1.0 - fresnel)).mean(axis=1), (weight * fresnel).mean(axis=1)], axis=-1)


def hammersley(n: int) -> tuple[Array, Array]:
    """Evenly spread points of the unit square: i / n, and i with its binary digits mirrored behind the point.

    Both half a step on, so that none is 0.
    """
    number, mirrored, digit = np.arange(n), np.zeros(n), 0.5
    while number.any():
        mirrored += digit * (number & 1)
        number, digit = number >> 1, 0.5 * digit
    return (np.arange(n) + 0.5) / n, mirrored + 0.5 / n


def reflectance(f0: Tensor, roughness: Tensor, cosines: Tensor) -> Tensor:
    """Share of the light around a lobe that comes back, F0 A + B, shape (n, c), by a linear lookup with gradients.

    Parameters
    ----------
    f0
        Reflectance at normal incidence, shape (n, c), 0 to 1.
    roughness, cosines
        Shape (n,), 0 to 1, clamped; cosines between normal and the direction to the camera.
    """
    places = torch.stack([2.0 * cosines - 1.0, 2.0 * roughness - 1.0], dim=-1)
    table = _table_like(f0.device, f0.dtype)
    found = grid_sample(table, places[None, None], mode="bilinear", padding_mode="border", align_corners=True)
    scale, bias = found[0, :, 0].unbind(dim=0)
    return f0 * scale[:, None] + bias[:, None]


@lru_cache(maxsize=4)
def _table_like(device: torch.device, dtype: torch.dtype) -> Tensor:
    """Shape (1, 2, SIZE, SIZE)."""
    return torch.from_numpy(split_sum_table()).permute(2, 0, 1)[None].to(device, dtype).contiguous()
