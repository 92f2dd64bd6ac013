"""What the learning of light alone found out about panes, put into the splats on them.

Both models say the same picture then, so that the joint training starts where the other ended: with reflectivity, base
reflectance and colour from elsewhere, the light that was learned would be wrong for them.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from reconstruction.reflections.photo_set import PanelPlanes
from reconstruction.reflections.reflective_panels import ReflectivePanels
from reconstruction.reflections.shading import display_from_linear, reflected_directions
from reconstruction.splatting.harmonic_colour import fitted_harmonics
from reconstruction.splatting.splats import Splats

Array = NDArray[np.float64]

MOST_DIRECTIONS = 96
"""That a pane's colour is fitted to: far more than a degree has harmonics."""

DEGREE = 2
"""Of the harmonics that are fitted: cameras see a pane from one side only, which tells no more."""


@torch.no_grad()
def hand_over(
    panels: ReflectivePanels, splats: Splats, planes: PanelPlanes, origin_enu_m: Array, cameras_enu_m: Array
) -> None:
    """Give the splats on each pane its r and F0, and the colour c that its places have.

    Parameters
    ----------
    cameras_enu_m
        From which the colour is to be right, shape (k, 3).
    """
    numbers = splats.panels.long()
    glass = torch.nonzero(numbers >= 0).squeeze(-1)
    splats.reflectivity_logits[glass] = panels.reflectivity[numbers[glass], 0].to(splats.means)
    splats.f0_logits[glass] = panels.base_reflectance[numbers[glass]].to(splats.means)
    middle = planes.middle_enu_m - origin_enu_m
    points = (splats.means.detach() - torch.from_numpy(middle).to(splats.means)) / planes.half_side_m
    for panel in torch.unique(numbers[glass]).tolist():
        rows = torch.nonzero(numbers == panel).squeeze(-1)
        omega_o = _directions(planes, panel, cameras_enu_m)
        if omega_o is not None:
            splats.sh[rows] = _fitted(panels, points[rows], omega_o, planes, panel)


def _directions(planes: PanelPlanes, panel: int, cameras_enu_m: Array) -> Array | None:
    """Unit directions from cameras that see the pane's front to its middle, shape (j, 3); None where there are none."""
    towards = planes.corners_enu_m[panel].mean(axis=0) - cameras_enu_m
    directions = towards / np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    seen = directions[directions @ planes.normals_enu[panel] < -1e-2]
    chosen = np.unique(np.linspace(0, len(seen) - 1, min(len(seen), MOST_DIRECTIONS)).astype(int))
    return seen[chosen] if len(seen) else None


def _fitted(panels: ReflectivePanels, points: Tensor, omega_o: Array, planes: PanelPlanes, panel: int) -> Tensor:
    """Coefficients, shape (n, 16, 3), of the display colours that places of a pane have from some directions."""
    directions = torch.from_numpy(omega_o).float()
    normal = torch.from_numpy(planes.normals_enu[panel]).float()
    mirrored = reflected_directions(directions, normal)
    n, k = len(points), len(directions)
    colours = panels.diffuse(
        points.repeat_interleave(k, dim=0), mirrored.repeat(n, 1), torch.full((n * k,), panel, dtype=torch.long)
    )
    return fitted_harmonics(directions, display_from_linear(colours).reshape(n, k, 3), DEGREE)
