"""What the kinds of glass in a scene do to light at its panes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reconstruction.scenes.optics import pane_light
from reconstruction.scenes.record import Scene

Array = NDArray[np.float64]
Index = NDArray[np.int64]

STEEPEST_SHIFT = 0.02
"""Cosine below which the image in the second sheet is displaced no further; its share of the light vanishes there."""


class PaneGlass:
    """Glass of the panes of a scene.

    Parameters
    ----------
    fresnel
        Whether reflectance depends on the angle; otherwise it is that at normal incidence.
    doubling
        Whether the second sheet's image is displaced.
    """

    def __init__(self, scene: Scene, fresnel: bool, doubling: bool) -> None:
        self._kinds, self._glasses, self._fresnel = scene.panes.glass, scene.glasses, fresnel
        gaps = np.array([glass.gap_m if glass.sheets == 2 else 0.0 for glass in scene.glasses])
        self._gaps_m = doubling * gaps[scene.panes.glass]

    def shares(self, which: Index, cosines: Array) -> tuple[Array, Array, Array, Array]:
        """Reflected by the first sheet, by what is behind it, let through (each shape (n, 3)), and dirt, (n, 1)."""
        first, behind, through = (np.zeros((len(which), 3)) for _ in range(3))
        dirt = np.zeros((len(which), 1))
        kinds = self._kinds[which]
        for number, glass in enumerate(self._glasses):
            rows = kinds == number
            angle = cosines[rows] if self._fresnel else np.ones(1)
            first[rows], behind[rows], through[rows] = pane_light(angle, glass)
            dirt[rows] = glass.dirt
        return first, behind, through, dirt

    def second_image_shift(self, which: Index, directions: Array, flat: Array) -> Array | None:
        """How far light reflected by the second sheet leaves beside the first's, shape (n, 3), in the pane's plane.

        None where no image is displaced.
        """
        gap = self._gaps_m[which]
        if not gap.any():
            return None
        falling = np.einsum("nk,nk->n", directions, flat)
        along = directions - falling[:, None] * flat
        return np.asarray(2.0 * (gap / np.maximum(-falling, STEEPEST_SHIFT))[:, None] * along)
