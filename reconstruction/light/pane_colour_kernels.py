"""Colours of panes as photos have them, by deferred shading, forward and backward, compiled, one ray at a time.

As `ReflectivePanels` has them in plain torch. Light and colours are float32, numbers of panes and photos float64.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from reconstruction.light.shading import DARKEST

Array = NDArray[np.float32]
Double = NDArray[np.float64]
Index = NDArray[np.int64]

DIMMEST = 0.1
"""Share of light that is left in a picture's corners at least."""

LIFT, SCALE, POWER, SLOPE = 0.055, 1.055, 1.0 / 2.4, 12.92
"""Of sRGB (IEC 61966-2-1)."""


@kernel
def display_of(light: float) -> tuple[float, float]:
    """Value of sRGB of linear light, and its slope: `display_from_linear`."""
    if light <= 0.0:
        return 0.0, 0.0
    if light <= DARKEST:
        return SLOPE * light, SLOPE
    if light <= 1.0:
        curved = SCALE * light**POWER
        return curved - LIFT, POWER * curved / light
    return 1.0 + SCALE * POWER * (light - 1.0), SCALE * POWER


@kernel
def colours(
    diffuse: Array, light: Array, cosines: Array, panels: Index, factors: Double, off_axis: Double,
    reflectivity: Double, base: Double, corner_loss: float, found: Array, slopes: Array,
) -> None:  # fmt: skip
    """Colours, shape (n, 3), written, and how they change with linear light.

    Parameters
    ----------
    diffuse, light
        c, and what is mirrored, shape (n, 3).
    cosines, panels
        Of the angles of incidence, and the panes' numbers, shape (n,).
    factors
        From linear light on a picture's axis to that which a photo shows, shape (n,).
    off_axis
        Squared distance from the principal point, 1 in a picture's corners, shape (n,).
    reflectivity, base
        R, shape (m,), and F0, shape (m, 3).
    corner_loss
        Share of light lost in a picture's corners.
    """
    for ray in range(len(panels)):
        panel = panels[ray]
        grazing = 1.0 - min(max(cosines[ray], 0.0), 1.0)
        grazing = grazing * grazing * grazing * grazing * grazing
        kept = factors[ray] * max(1.0 - corner_loss * off_axis[ray], DIMMEST)
        mirrored = reflectivity[panel]
        for k in range(3):
            fresnel = base[panel, k] + (1.0 - base[panel, k]) * grazing
            linear = kept * ((1.0 - mirrored) * diffuse[ray, k] + mirrored * fresnel * light[ray, k])
            found[ray, k], slopes[ray, k] = display_of(linear)


@kernel
def colours_back(
    diffuse: Array, light: Array, cosines: Array, panels: Index, factors: Double, off_axis: Double,
    reflectivity: Double, base: Double, corner_loss: float, slopes: Array, by_colours: Array,
    by_diffuse: Array, by_light: Array, by_cosines: Array, by_reflectivity: Double, by_base: Double,
) -> float:  # fmt: skip
    """Gradients by c, light and cosines, written, and by R and F0, added; that by the corner loss is returned."""
    by_corner_loss = 0.0
    for ray in range(len(panels)):
        panel = panels[ray]
        cosine = min(max(cosines[ray], 0.0), 1.0)
        fourth = (1.0 - cosine) * (1.0 - cosine) * (1.0 - cosine) * (1.0 - cosine)
        grazing = fourth * (1.0 - cosine)
        left = 1.0 - corner_loss * off_axis[ray]
        mirrored = reflectivity[panel]
        by_cosine, by_kept = 0.0, 0.0
        for k in range(3):
            fresnel = base[panel, k] + (1.0 - base[panel, k]) * grazing
            by_linear = by_colours[ray, k] * slopes[ray, k] * factors[ray]
            by_kept += by_linear * ((1.0 - mirrored) * diffuse[ray, k] + mirrored * fresnel * light[ray, k])
            by_linear *= max(left, DIMMEST)
            by_diffuse[ray, k] = by_linear * (1.0 - mirrored)
            by_light[ray, k] = by_linear * mirrored * fresnel
            by_reflectivity[panel] += by_linear * (fresnel * light[ray, k] - diffuse[ray, k])
            by_fresnel = by_linear * mirrored * light[ray, k]
            by_base[panel, k] += by_fresnel * (1.0 - grazing)
            by_cosine -= by_fresnel * (1.0 - base[panel, k]) * 5.0 * fourth
        by_cosines[ray] = by_cosine
        if left > DIMMEST:
            by_corner_loss -= by_kept * off_axis[ray]
    return by_corner_loss
