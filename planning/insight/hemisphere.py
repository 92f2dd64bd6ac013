"""Shapes of hemisphere sections for drawing: on the unit hemisphere, in ENU, and on a flat disc.

The panel's frame has the axes t, b, n (`planning.coverage.sections`): seen from outside, t points to the right and b
up; where the panel faces the sky, t points east and b north.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import PanelFrames, SectionGrid

Array = NDArray[np.float64]

STEPS_PER_SIDE = 4
"""A side of 30 degrees is drawn as four chords, which leave the arc by 0.2 % of the radius."""


@dataclass(frozen=True, slots=True, eq=False)
class SectionShapes:
    """Every section of one hemisphere, n_sections = s, in the order of section numbers.

    Parameters
    ----------
    ring, sector
        Shape (s,), from 0: rings from the pole to the horizon, sectors from t towards b.
    directions_panel
        Unit vectors to the middle of both angles, shape (s, 3), axes t, b, n.
    outlines_panel
        Unit vectors around each section, counter-clockwise seen from outside, not closed: shape (s, k, 3), axes t, b,
        n. Sections at the pole have one side of no length.
    outlines_disc
        The same points on a flat picture, shape (s, k, 2): x right (t), y up (b), radius theta / 90 degrees, so that
        rings are equally wide and the rim is the panel's plane.
    """

    ring: NDArray[np.int64]
    sector: NDArray[np.int64]
    directions_panel: Array
    outlines_panel: Array
    outlines_disc: Array


def section_shapes(grid: SectionGrid, steps_per_side: int = STEPS_PER_SIDE) -> SectionShapes:
    """Shapes of all sections; outlines have k = 4 `steps_per_side` points."""
    if steps_per_side < 1:
        raise ValueError(f"steps_per_side: expected 1 or more, got {steps_per_side}")
    step_rad = np.radians(grid.step_deg)
    ring, sector = np.divmod(np.arange(grid.n_sections), grid.n_sectors)
    rise = np.arange(steps_per_side) / steps_per_side
    low, high = np.zeros(steps_per_side), np.ones(steps_per_side)
    # Outwards, on along the outer arc, back inwards, and back along the inner arc.
    theta = (ring[:, None] + np.concatenate([rise, high, 1.0 - rise, low])) * step_rad
    phi = (sector[:, None] + np.concatenate([low, rise, high, 1.0 - rise])) * step_rad
    radius = theta / (0.5 * np.pi)
    return SectionShapes(
        ring,
        sector,
        _unit_vectors((ring + 0.5) * step_rad, (sector + 0.5) * step_rad),
        _unit_vectors(theta, phi),
        np.stack([radius * np.cos(phi), radius * np.sin(phi)], axis=-1),
    )


def _unit_vectors(theta_rad: Array, phi_rad: Array) -> Array:
    across = np.sin(theta_rad)
    return np.stack([across * np.cos(phi_rad), across * np.sin(phi_rad), np.cos(theta_rad)], axis=-1)


def in_enu(vectors_panel: Array, frames: PanelFrames, panels: NDArray[np.int64]) -> Array:
    """Vectors of the panel frame, shape (..., 3), in ENU for each panel asked for: shape (len(panels), ..., 3)."""
    enu_from_panel = np.stack([frames.tangents[panels], frames.bitangents[panels], frames.normals[panels]], axis=1)
    turned = vectors_panel.reshape(-1, 3) @ enu_from_panel
    return turned.reshape(len(panels), *vectors_panel.shape)
