"""Pixel sizes: ground sampling distance of every panel in the views that cover it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import NOT_SEEN, PanelFrames
from planning.plan import Camera

Array = NDArray[np.float64]


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
    frames: PanelFrames, camera: Camera, positions_enu_m: Array, sections: NDArray[np.integer]
) -> PanelSampling:
    """Sampling of all panels.

    Parameters
    ----------
    positions_enu_m
        Of the views, shape (n, 3).
    sections
        Section of each panel that each view covers, shape (n, m), `NOT_SEEN` for none.
    """
    view, panel = np.nonzero(sections != NOT_SEEN)
    rays = positions_enu_m[view] - frames.centroids[panel]
    distance = np.linalg.norm(rays, axis=1)
    along = np.einsum("kc,kc->k", rays, frames.normals[panel])
    across_m = distance * camera.pixel_angle_rad
    # Covered means theta < 90 degrees, so the height above the pane is positive, though it may be tiny.
    on_pane_m = across_m * distance / np.maximum(along, np.finfo(np.float64).tiny)
    best_m, worst_m = _extremes(across_m, panel, len(frames))
    best_on_pane_m, worst_on_pane_m = _extremes(on_pane_m, panel, len(frames))
    return PanelSampling(best_m, worst_m, best_on_pane_m, worst_on_pane_m)


def _extremes(values: Array, panel: NDArray[np.int64], n_panels: int) -> tuple[Array, Array]:
    """Least and greatest value of each panel; NaN where it has none."""
    least, greatest = np.full(n_panels, np.nan), np.full(n_panels, np.nan)
    np.fmin.at(least, panel, values)
    np.fmax.at(greatest, panel, values)
    return least, greatest
