"""What a photo is drawn from: building, obstacles, ground, and panels outlined where they are covered."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from groundstation.gui.theme import Colours
from groundstation.gui.view3d.layers import Drawable, Layer
from groundstation.gui.view3d.paint import flat, rgba, shaded
from groundstation.gui.view3d.shapes import outlines, quads
from planning.coverage.sections import PanelFrames

FACES_NEARER, OUTLINES_NEARER, COVERED_NEARER = 0.003, 0.004, 0.005
"""Parts of their distance by which panels, their outlines and those of covered ones come before the wall on which they
lie, 3 cm at 10 m. They are not moved off the wall, as in the 3-D view: at 10 m that would shift corners by pixels."""

COVERED_PX = 2.0
PANEL, PANEL_OUTLINE = "#8fa9bd", "#23415a"

BACKDROP = (Layer.GROUND, Layer.BUILDING, Layer.OBSTACLES, Layer.NO_FLY)


def panel_colours(frames: PanelFrames, covered: NDArray[np.bool_], look: Colours) -> NDArray[np.uint8]:
    """Colours of panels, shape (m, 4): grey-blue, or the colour of what is covered."""
    colours = flat(PANEL, len(frames))
    colours[covered] = rgba(look.covered)
    return shaded(colours, frames.normals)


def panel_faces(frames: PanelFrames, colours: NDArray[np.uint8]) -> Drawable:
    """All panels, with colours of shape (m, 4)."""
    return Drawable(*quads(frames.corners), colours, nearer=FACES_NEARER)


def panel_outlines(frames: PanelFrames) -> Drawable:
    """Thin outlines of all panels."""
    points, cells = outlines(frames.corners)
    return Drawable(points, cells, flat(PANEL_OUTLINE, len(cells)), nearer=OUTLINES_NEARER)


def covered_outlines(frames: PanelFrames, covered: NDArray[np.bool_], look: Colours) -> Drawable:
    """Thick, bright outlines of the covered panels."""
    points, cells = outlines(frames.corners[covered])
    return Drawable(points, cells, flat(look.open, len(cells)), width_px=COVERED_PX, nearer=COVERED_NEARER)
