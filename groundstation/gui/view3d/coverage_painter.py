"""Draws coverage on hemispheres: domes near the eye, one large dome on the selected panel, one colour on all others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.theme import Colours
from groundstation.gui.view3d.canvas import Canvas
from groundstation.gui.view3d.hemispheres import (
    LARGE_ARC_DEG,
    PATCH_BUDGET,
    SMALL_ARC_DEG,
    DomePattern,
    dome_feet,
    dome_pattern,
    dome_radii_m,
    domes,
    mixed_colours,
    nearest_panels,
)
from groundstation.gui.view3d.layers import Drawable, Layer
from groundstation.gui.view3d.paint import flat
from groundstation.gui.view3d.pinhole import Pinhole
from groundstation.gui.view3d.shapes import outlines
from planning.coverage.sections import PanelFrames, SectionGrid
from planning.insight.hemisphere import in_enu, section_shapes

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
