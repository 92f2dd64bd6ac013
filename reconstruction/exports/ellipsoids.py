"""Gaussians as other programs know them: ellipsoids with an opacity and a colour by direction.

No other program mirrors light in panels. What a panel shows has to be baked into its Gaussians' colours before
(`reconstruction.exports.baked`), or their own diffuse colour is all that is seen.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reconstruction.objects.gs_scene import GsComponent, GsGaussian
from reconstruction.splats.ply import ODD

Array = NDArray[np.float32]

THICKNESS_M = 1e-6
"""Third size of a disc where there must be one, as 2DGS recommends."""

NO_PANEL = -1


@dataclass(frozen=True, slots=True, eq=False)
class Ellipsoids:
    """n of them.

    Parameters
    ----------
    means_m
        ENU less the scene's `origin_enu_m`, shape (n, 3).
    quats
        w, x, y, z: unit, w >= 0, shape (n, 4). The columns of the rotation are the axes that `scales_m` measures.
    scales_m
        Standard deviations, shape (n, 3); the third is `THICKNESS_M` of discs.
    opacities
        0 to 1, shape (n,).
    sh
        Coefficients of display colours (sRGB values less 0.5), shape (n, 16, 3): those of real harmonics with the phase
        (-1)^m, as 3DGS files have them. Colour = 0.5 + sum of coefficient times harmonic of the direction from the
        camera to the mean.
    panels
        Number of the panel that each lies on, int32, shape (n,); -1 for none.
    """

    means_m: Array
    quats: Array
    scales_m: Array
    opacities: Array
    sh: Array
    panels: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.panels)

    def chosen(self, rows: NDArray[np.int64] | NDArray[np.bool_] | slice) -> Ellipsoids:
        """Some of them."""
        return Ellipsoids(
            self.means_m[rows],
            self.quats[rows],
            self.scales_m[rows],
            self.opacities[rows],
            self.sh[rows],
            self.panels[rows],
        )


def ellipsoids_of(component: GsComponent) -> Ellipsoids:
    """Those of a component, in the order of its rows."""
    panels = np.full(len(component.gaussians), NO_PANEL, np.int32)
    for element in component.elements:
        panels[element.start : element.stop] = element.panel
    return _ellipsoids(component.gaussians, panels)


def ellipsoids_of_all(components: Iterable[GsComponent]) -> Ellipsoids:
    """Those of components, one after the other."""
    parts = [ellipsoids_of(component) for component in components]
    return Ellipsoids(
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("means_m", "quats", "scales_m", "opacities", "sh", "panels")
        )
    )


def _ellipsoids(gaussians: GsGaussian, panels: NDArray[np.int32]) -> Ellipsoids:
    values = gaussians.values
    scales = np.exp(values["log_scales"])
    if scales.shape[1] == 2:
        scales = np.column_stack([scales, np.full(len(scales), THICKNESS_M, np.float32)])
    return Ellipsoids(
        values["means"],
        unit_quaternions(values["quats"]),
        scales.astype(np.float32, copy=False),
        _sigmoid(values["opacity_logits"]),
        values["sh"] * ODD[:, None],
        panels,
    )


def unit_quaternions(quats: Array) -> Array:
    """Unit, with w >= 0, shape (n, 4); those as good as zero turn nothing."""
    # Squares of float32 would overflow or vanish where the length itself is good.
    found = quats.astype(np.float64)
    length = np.linalg.norm(found, axis=1, keepdims=True)
    is_turned = length > 1e-6
    found = np.where(is_turned, found / np.where(is_turned, length, 1.0), (1.0, 0.0, 0.0, 0.0))
    return np.where(found[:, :1] < 0.0, -found, found).astype(np.float32)


def _sigmoid(logits: Array) -> Array:
    small = np.exp(-np.abs(logits))
    return np.asarray(np.where(logits >= 0.0, 1.0, small) / (1.0 + small), np.float32)
