"""Pixel sizes: ground sampling distance of every panel in the views that cover it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.coverage.sections import NOT_SEEN, PanelFrames
from planning.plan import Camera

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SMALLEST = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, slots=True, eq=False)
class PanelSampling:
    """Ground sampling distance at each panel's centroid, metres per pixel, shape (m,); NaN where no view covers it.

    Parameters
    ----------
    best_m, worst_m
        Across the line of sight: distance times the angle of a pixel.
    best_on_pane_m, worst_on_pane_m
        On the pane, in the direction in which it is seen foreshortened: larger by 1 / cos(theta). The best view here
        need not be the best across the line of sight.
    """

    best_m: Array
    worst_m: Array
    best_on_pane_m: Array
    worst_on_pane_m: Array


def panel_sampling(
    frames: PanelFrames,
    camera: Camera,
    positions_enu_m: Array,
    sections: NDArray[np.integer],
    panels: Ints | None = None,
) -> PanelSampling:
    """Sampling of all panels, or of some.

    Parameters
    ----------
    positions_enu_m
        Of the views, shape (n, 3).
    sections
        Section of each panel that each view covers, shape (n, m), `NOT_SEEN` for none.
    panels
        Numbers of the panels wanted, shape (k,): the result has as many. None for all.
    """
    if panels is None:
        panels = np.arange(len(frames))
    found = np.full((4, len(panels)), np.nan)
    _extremes(
        np.ascontiguousarray(positions_enu_m),
        np.ascontiguousarray(sections, np.int16),
        panels,
        frames.centroids,
        frames.normals,
        camera.pixel_angle_rad,
        found,
    )
    return PanelSampling(*found)


@kernel
def _extremes(
    positions_enu_m: Array,
    sections: NDArray[np.int16],
    panels: Ints,
    centroids: Array,
    normals: Array,
    pixel_angle_rad: float,
    found: Array,
) -> None:
    """Least and greatest sampling of each panel, put into `found`, shape (4, k), as `PanelSampling` has them."""
    for view in range(len(positions_enu_m)):
        for place in range(len(panels)):
            panel = panels[place]
            if sections[view, panel] == NOT_SEEN:
                continue
            squared, along = 0.0, 0.0
            for axis in range(3):
                ray = positions_enu_m[view, axis] - centroids[panel, axis]
                squared += ray * ray
                along += ray * normals[panel, axis]
            distance = np.sqrt(squared)
            across_m = distance * pixel_angle_rad
            # Covered means theta < 90 degrees, so the height above the pane is positive, though it may be tiny.
            on_pane_m = across_m * distance / max(along, SMALLEST)
            # Unlike `<`, these take a number rather than the NaN that stands there first.
            found[0, place] = np.fmin(found[0, place], across_m)
            found[1, place] = np.fmax(found[1, place], across_m)
            found[2, place] = np.fmin(found[2, place], on_pane_m)
            found[3, place] = np.fmax(found[3, place], on_pane_m)
