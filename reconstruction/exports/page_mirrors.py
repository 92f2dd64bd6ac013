"""Panes of a web page as mirrors: what its shaders need to render the model's Eq. 19, besides splats and panes.

That is the radiance grid as half floats, how panes lean and are bowed, and what splats on panes are made of: their own
colour c, R and F0. A browser without WebGPU leaves all of it aside and shows colours with mirrored light baked in.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.light.radiance_grid import DENSITY_SCALE, FAR_TIMES, OPAQUE, RadianceGrid, edged
from reconstruction.splats.ply import ODD
from reconstruction.training.model.joint_model import SceneModel

Array = NDArray[np.float32]

LARGEST_HALF = 65_504.0


@dataclass(frozen=True, slots=True, eq=False)
class PaneMirrors:
    """What panes mirror, and what splats on them are made of.

    Parameters
    ----------
    numbers
        As `Light` in `mirrors.wgsl` has them; metres in the model's frame, all else rescaled.
    rays
        Through each pixel, along each side of it.
    tilts, bows
        Of the model's panels, radians, shape (m, 2).
    cells
        Density and square roots of light, shape (nz, ny, nx, 4), float16.
    skips
        Cells that a ray may leap, shape (nz - 1, ny - 1, nx - 1), uint8.
    far
        Square roots of light by direction with a rim of one pixel, shape (side + 2, side + 2, 4), float16.
    sh, reflectivity, f0
        Of all splats, in the model's order: coefficients as `Ellipsoids` has them, shape (n, 16, 3), R, shape (n,), and
        F0, shape (n, 3).
    """

    numbers: dict[str, float | list[float]]
    rays: int
    tilts: Array
    bows: Array
    cells: NDArray[np.float16]
    skips: NDArray[np.uint8]
    far: NDArray[np.float16]
    sh: Array
    reflectivity: Array
    f0: Array

    def described(self, panels: Sequence[int]) -> dict[str, Any]:
        """For the page, as JSON has it; `panels` are the model's numbers of the page's panes."""
        return {
            "numbers": self.numbers,
            "rays": self.rays,
            "counts": list(self.cells.shape[2::-1]),
            "tilts": _told(self.tilts[list(panels)]),
            "bows": _told(self.bows[list(panels)]),
        }

    def blocks(self) -> tuple[bytes, bytes, bytes]:
        """`cells`, `skips` and `far`, little-endian."""
        return self.cells.astype("<f2").tobytes(), self.skips.tobytes(), self.far.astype("<f2").tobytes()


@torch.no_grad()
def mirrors_of(model: SceneModel) -> PaneMirrors | None:
    """Of a model whose panels' planes mirror a radiance grid; None of others, whose light the page cannot march."""
    if model.light is None or model.geometry != "panels" or not isinstance(model.light.light, RadianceGrid):
        return None
    glass, grid = model.light, model.light.light
    n_panels = len(model.corners_m)
    bows = np.zeros((n_panels, 2), np.float32) if glass.bows is None else glass.bows.cpu().numpy()
    box = grid.box
    x, y, z, over_x, over_y, over_z, outer, cell = grid.numbers.tolist()
    numbers: dict[str, float | list[float]] = {
        "middle": (model.planes.middle_enu_m - model.origin_enu_m).tolist(),
        "half_side": model.planes.half_side_m,
        "inner": [x, y, z],
        "cell": cell,
        "over": [over_x, over_y, over_z],
        "outer": outer,
        "turn": [math.cos(box.heading_rad), math.sin(box.heading_rad)],
        "reach": box.reach,
        "unit": grid.unit,
        "far_side": len(grid.far),
        "far_times": FAR_TIMES,
        "density_scale": DENSITY_SCALE,
        "opaque": OPAQUE,
    }
    splats = model.splats
    return PaneMirrors(
        numbers,
        math.isqrt(glass.rays),
        glass.true_tilts().cpu().numpy(),
        bows,
        _halves(grid.cells),
        grid.skips,
        _halves(torch.nn.functional.pad(edged(grid.far), (0, 1))),
        splats.sh.cpu().numpy() * ODD[:, None],
        torch.sigmoid(splats.reflectivity_logits).cpu().numpy(),
        torch.sigmoid(splats.f0_logits).cpu().numpy(),
    )


def _halves(values: torch.Tensor) -> NDArray[np.float16]:
    return values.clamp(-LARGEST_HALF, LARGEST_HALF).cpu().numpy().astype(np.float16)


def _told(values: Array) -> list[list[float]]:
    return [[round(float(value), 8) for value in row] for row in values]
