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

from groundstation.gui.view3d.canvas import Canvas
from groundstation.gui.view3d.drawables import PANEL_OFFSET_M, Drawable, Layer, Shape, outlines
from groundstation.gui.view3d.orbit import Pinhole
from groundstation.gui.view3d.paint import flat, rgba, shaded
from groundstation.gui.widgets.theme import Colours
from planning.coverage.sections import PanelFrames, SectionGrid
from planning.insight.sections import in_enu, section_shapes

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


# Draws coverage on hemispheres: domes near the eye, one large dome on the selected panel, one colour on all others.

LARGE_DOME_M = 2.5
"""Radius of the selected panel's dome: its sections are then some 20 px wide when the panel is looked at."""


BORDER_STEPS = 4
BORDER_RADIUS = 1.01
"""Borders of sections stand out this much, or the flat pieces of the dome would hide them."""


class CoveragePainter:
    """Keeps the states of all sections and draws of them what can be drawn smoothly."""

    def __init__(self, canvas: Canvas) -> None:
        self._canvas = canvas
        self._frames: PanelFrames | None = None
        self._grid: SectionGrid | None = None
        self._states: NDArray[np.int64] | None = None
        self._pattern: DomePattern | None = None
        self._drawn: tuple[bytes, int | None, Colours] | None = None

    @property
    def is_on(self) -> bool:
        """Whether there is coverage to paint."""
        return self._states is not None

    def set_frames(self, frames: PanelFrames | None) -> None:
        """Panels that carry the hemispheres."""
        self._frames, self._drawn = frames, None

    def set_states(self, grid: SectionGrid | None, states: NDArray[np.int64] | None) -> None:
        """States of all sections, shape (m, n_sections), or none.

        Raises
        ------
        ValueError
            There is not one state for each section of each panel.
        """
        if grid is None or states is None:
            self._grid, self._states, self._pattern = None, None, None
        else:
            wanted = (0 if self._frames is None else len(self._frames), grid.n_sections)
            if states.shape != wanted:
                raise ValueError(f"states: expected shape {wanted} (panels, sections), got {states.shape}")
            if self._grid != grid:
                self._pattern = dome_pattern(grid, SMALL_ARC_DEG)
            self._grid, self._states = grid, states
        self._drawn = None

    def panel_colours(self, look: Colours) -> NDArray[np.uint8] | None:
        """One colour per panel, shape (m, 4); None while there is no coverage."""
        return None if self._grid is None or self._states is None else mixed_colours(self._states, self._grid, look)

    def paint(self, view: Pinhole, selected: int | None, look: Colours) -> None:
        """Draw the domes for a view; `selected` is the panel that gets the large one."""
        if self._frames is None or self._states is None or self._pattern is None:
            self._canvas.draw(Layer.HEMISPHERES, ())
            self._drawn = None
            return
        n_domes = max(1, PATCH_BUDGET // len(self._pattern.section))
        panels = nearest_panels(self._frames, view, n_domes)
        radii = dome_radii_m(self._frames)
        large_m = 0.0 if selected is None else max(LARGE_DOME_M, float(radii[selected]))
        if selected is not None:
            # Those that the large dome would cut through.
            apart_m = np.linalg.norm(self._frames.centroids[panels] - self._frames.centroids[selected], axis=1)
            panels = panels[apart_m > large_m + radii[panels]]
        key = (panels.tobytes(), selected, look)
        if key == self._drawn:
            return
        self._drawn = key
        parts = []
        if len(panels):
            shape, colours = domes(self._frames, panels, radii[panels], self._pattern, self._states, look)
            parts.append(Drawable(*shape, colours))
        if selected is not None:
            parts.extend(self._large_dome(selected, large_m, look))
        self._canvas.draw(Layer.HEMISPHERES, parts)

    def _large_dome(self, panel: int, radius_m: float, look: Colours) -> tuple[Drawable, ...]:
        """Dome of one panel, with the borders of its sections."""
        if self._frames is None or self._grid is None or self._states is None:
            return ()
        pattern, one = dome_pattern(self._grid, LARGE_ARC_DEG), np.array([panel])
        shape, colours = domes(self._frames, one, np.array([radius_m]), pattern, self._states, look)
        directions = in_enu(section_shapes(self._grid, BORDER_STEPS).outlines_panel, self._frames, one)[0]
        borders = dome_feet(self._frames, one) + BORDER_RADIUS * radius_m * directions
        points, cells = outlines(borders)
        return Drawable(*shape, colours), Drawable(points, cells, flat(look.text, len(cells)), width_px=1.5)
