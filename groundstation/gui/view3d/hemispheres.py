"""Coverage on the hemispheres of panels: small domes whose sections are coloured by their state.

Ten thousand panels of 36 sections are 360 000 patches, more than can be turned smoothly without a graphics card. So
domes stand on the panels nearest to the eye, as many as a budget of patches allows; every other panel is painted with
the one colour that its sections mix to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.theme import Colours
from groundstation.gui.view3d.paint import rgba, shaded
from groundstation.gui.view3d.pinhole import Pinhole
from groundstation.gui.view3d.shapes import PANEL_OFFSET_M, Shape
from planning.coverage.sections import PanelFrames, SectionGrid
from planning.insight.hemisphere import in_enu, section_shapes

Array = NDArray[np.float64]
States = NDArray[np.int64]

OPEN, UNREACHABLE, UNDECIDED = 0, -1, -2
"""States of a section that no view covers; a positive state is the number of views that cover it."""

DEEPEST = 4
"""Sections covered more often look alike: the eye does not tell more steps of one hue apart."""

PATCH_BUDGET = 24_000
"""Patches drawn as domes: 660 panels of 36 sections. Measured on 2 cores without a graphics card, 1280 x 720: a frame
of 36 ms takes 3 ms longer for every 10 000 of them."""

DOME_SHARE = 0.42
"""Radius of a dome as a part of its panel's shorter side: domes of neighbours do not touch."""

SMALL_ARC_DEG, LARGE_ARC_DEG = 30.0, 7.5
"""Patches are split so that no piece of their outline spans more: at the size of a panel 30 degrees look round enough,
on the selected panel they look like a tent."""


@dataclass(frozen=True, slots=True, eq=False)
class DomePattern:
    """Pieces of all sections of one hemisphere, in the frame of a panel (t, b, n).

    Parameters
    ----------
    corners_panel
        Unit vectors, shape (k, 4, 3).
    section
        Shape (k,): the section that each piece belongs to.
    """

    corners_panel: Array
    section: NDArray[np.int64]


def dome_pattern(grid: SectionGrid, arc_deg: float) -> DomePattern:
    """Pieces of a grid's sections, none wider than `arc_deg`; at the pole two corners of a piece meet."""
    n_pieces = math.ceil(grid.step_deg / arc_deg)
    pieces = section_shapes(SectionGrid(grid.step_deg / n_pieces), 1)
    section = pieces.ring // n_pieces * grid.n_sectors + pieces.sector // n_pieces
    return DomePattern(pieces.outlines_panel, section)


def state_colours(states: States, colours: Colours) -> NDArray[np.uint8]:
    """Colours of states, shape (..., 4): covered sections are the darker the more views cover them."""
    named = {OPEN: colours.open, UNREACHABLE: colours.unreachable, UNDECIDED: colours.undecided}
    table = np.empty((DEEPEST + 3, 4), np.uint8)
    for state, name in named.items():
        table[state - UNDECIDED] = rgba(name)
    covered = rgba(colours.covered).astype(np.float64)
    white = np.full(4, 255.0)
    for depth in range(1, DEEPEST + 1):
        lighter = 0.45 * (DEEPEST - depth) / (DEEPEST - 1)
        table[depth - UNDECIDED] = np.rint((1.0 - lighter) * covered + lighter * white).astype(np.uint8)
    return np.asarray(table[np.clip(states, UNDECIDED, DEEPEST) - UNDECIDED])


def mixed_colours(states: States, grid: SectionGrid, colours: Colours) -> NDArray[np.uint8]:
    """One colour per panel, shape (m, 4): its sections' colours, mixed by solid angle; states have shape (m, s)."""
    weights = grid.solid_angles_sr() / (2.0 * math.pi)
    # Mixed by counting states: an array of all colours would take 12 MB for 10 000 panels.
    clipped = np.clip(states, UNDECIDED, DEEPEST)
    kinds = np.arange(UNDECIDED, DEEPEST + 1)
    share = np.stack([(clipped == kind) @ weights for kind in kinds], axis=1)
    return np.asarray(np.rint(share @ state_colours(kinds, colours)).clip(0, 255).astype(np.uint8))


def dome_radii_m(frames: PanelFrames) -> Array:
    """Radius of each panel's dome, shape (m,)."""
    edges = np.linalg.norm(np.roll(frames.corners, -1, axis=1) - frames.corners, axis=2)
    return np.asarray(DOME_SHARE * edges.min(axis=1))


def nearest_panels(frames: PanelFrames, view: Pinhole, n: int) -> NDArray[np.int64]:
    """The n panels nearest to the eye among those in the picture that face it, in rising order of their index."""
    rays = view.eye_enu_m - frames.centroids
    pixels, _ = view.project(frames.centroids)
    is_seen = ((pixels >= 0.0) & (pixels <= [view.width_px, view.height_px])).all(axis=1)
    facing = np.flatnonzero(is_seen & (np.einsum("ij,ij->i", rays, frames.normals) > 0.0))
    if len(facing) > n:
        squared = np.einsum("ij,ij->i", rays[facing], rays[facing])
        facing = facing[np.argpartition(squared, n)[:n]]
    return np.sort(facing)


def dome_feet(frames: PanelFrames, panels: NDArray[np.int64]) -> Array:
    """Middles of the panels' domes, shape (n, 3)."""
    return np.asarray(frames.centroids[panels] + PANEL_OFFSET_M * frames.normals[panels])


def domes(
    frames: PanelFrames, panels: NDArray[np.int64], radii_m: Array, pattern: DomePattern, states: States, look: Colours
) -> tuple[Shape, NDArray[np.uint8]]:
    """Domes of some panels as quadrilaterals with shaded colours, shape (n k, 4).

    Parameters
    ----------
    panels
        Indices of panels, shape (n,).
    radii_m
        Shape (n,).
    states
        Of all panels, shape (m, s).
    """
    directions = in_enu(pattern.corners_panel, frames, panels)
    points = dome_feet(frames, panels)[:, None, None] + radii_m[:, None, None, None] * directions
    normals = directions.mean(axis=2).reshape(-1, 3)
    colours = state_colours(states[panels][:, pattern.section].reshape(-1), look)
    points = points.reshape(-1, 3)
    return (points, np.arange(len(points)).reshape(-1, 4)), shaded(colours, normals)
