"""Which panel a splat belongs to where nothing told it before: the one whose pixels it shows in most.

Eq. 17 blends numbers of panels, which between panels 3 and 7 gives 5. Here weights are added up for each panel, over
all pixels of all photos, and the heaviest one wins.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import cKDTree
from torch import Tensor

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.dataset.layers import unit_normals
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import NO_PANEL, Splats

AT_ONCE = 32
"""Panels whose weights are told in one rendering."""

LEAST_WEIGHT = 1e-3
"""Pixels' worth of weight below which a splat does not show in a panel's pixels."""

ON_PANE_M = 0.3
"""Off its panel's plane, a splat is still glass: further ones are what stands in front of it, or the room behind."""


def assign_panels(
    splats: Splats,
    panels_in_views: Iterable[tuple[View, NDArray[np.integer[Any]]]],
    corners_m: NDArray[np.float64],
    settings: RasterSettings | None = None,
    monitor: Monitor = QUIET,
) -> Tensor:
    """Panels of splats, shape (n,), int32; `NO_PANEL` where most of a splat shows where no panel is.

    Splats that show in no photo keep the panel that they have. What `rasterise` blends is linear in the features, so
    their gradient, given a 1 in all pixels of a panel, is each splat's weight there.

    Parameters
    ----------
    panels_in_views
        Views, and the panel of each of their pixels, from 0, or -1, shape (h, w).
    corners_m
        Of the panels in the model's frame, shape (m, 4, 3).
    """
    n, n_panels = len(splats), len(corners_m)
    total = sparse.csr_array((n, n_panels + 1))
    for done, (view, panels) in enumerate(panels_in_views):
        monitor.report(say("telling panels of splats"), done, 0)
        if panels.shape != (view.height_px, view.width_px):
            raise ValueError(f"panels: expected shape {(view.height_px, view.width_px)}, got {panels.shape}")
        if panels.max(initial=-1) >= n_panels:
            raise ValueError(f"panels: expected numbers below {n_panels}, got {panels.max()}")
        total = total + _weights(splats, view, np.asarray(panels), n_panels, settings or RasterSettings())
    heaviest = np.asarray(total.argmax(axis=1)).ravel() if n else np.zeros(0, np.int64)
    is_seen = np.asarray(total.sum(axis=1)).ravel() > 0.0
    # Column 0 is that of no panel.
    found = np.where(is_seen, heaviest - 1, splats.panels.cpu().numpy())
    found = np.where(_is_on_pane(splats, found, corners_m), found, NO_PANEL)
    return torch.from_numpy(found.astype(np.int32)).to(splats.panels)


def panels_by_place(means_m: NDArray[np.float32], corners_m: NDArray[np.float64]) -> NDArray[np.int32]:
    """Panels on which splats lie, shape (n,); `NO_PANEL` where they lie on none, the nearest plane where on several.

    For splats of which no photo tells, and that were never told of panels. A frame before a pane is taken for it.

    Parameters
    ----------
    means_m
        Shape (n, 3), in the frame of the corners.
    corners_m
        Of convex panels, one way around, shape (m, 4, 3).
    """
    found, nearest_m = np.full(len(means_m), NO_PANEL, np.int32), np.full(len(means_m), ON_PANE_M)
    if not len(means_m) or not len(corners_m):
        return found
    middles, normals = corners_m.mean(axis=1), unit_normals(corners_m)
    reach_m = np.linalg.norm(corners_m - middles[:, None], axis=2).max(axis=1) + ON_PANE_M
    near = cKDTree(means_m).query_ball_point(middles, reach_m)
    for number, (rows, corners, normal) in enumerate(zip(near, corners_m, normals, strict=True)):
        rows = np.array(rows, int)
        from_corners = means_m[rows, None].astype(float) - corners
        off_m = np.abs(from_corners[:, 0] @ normal)
        inwards = np.cross(normal, np.roll(corners, -1, axis=0) - corners)
        lies = ((from_corners * inwards).sum(axis=2) >= 0.0).all(axis=1) & (off_m <= nearest_m[rows])
        found[rows[lies]], nearest_m[rows[lies]] = number, off_m[lies]
    return found


def _weights(
    splats: Splats, view: View, panels: NDArray[np.integer[Any]], n_panels: int, settings: RasterSettings
) -> Any:
    """Of splats in pixels of each panel, sparse, shape (n, 1 + n_panels); column 0 is that of no panel."""
    numbers = np.unique(panels)
    rows, columns, weights = [], [], []
    for start in range(0, len(numbers), AT_ONCE):
        part = numbers[start : start + AT_ONCE]
        features = torch.zeros(len(splats), len(part), device=splats.means.device, requires_grad=True)
        with torch.no_grad():
            means, quats, scales, opacities = splats.means, splats.quats, splats.scales, splats.opacities
        picture = rasterise(means.detach(), quats.detach(), scales, opacities, features, view, settings=settings)
        is_panel = torch.from_numpy(panels[..., None] == part).to(picture.features)
        (gradient,) = torch.autograd.grad(picture.features, features, is_panel)
        row, column = torch.nonzero(gradient > LEAST_WEIGHT, as_tuple=True)
        rows.append(row.cpu().numpy())
        columns.append(part[column.cpu().numpy()] + 1)
        weights.append(gradient[row, column].cpu().numpy())
    entries = (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns)))
    return sparse.csr_array(entries, shape=(len(splats), 1 + n_panels))


def _is_on_pane(splats: Splats, panels: NDArray[np.int64], corners_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    on_pane = np.zeros(len(panels), bool)
    glass = np.flatnonzero(panels >= 0)
    if len(glass):
        means = splats.means.detach().cpu().numpy()[glass].astype(float)
        corners = corners_m[panels[glass]]
        off = ((means - corners[:, 0]) * unit_normals(corners)).sum(axis=1)
        on_pane[glass] = np.abs(off) <= ON_PANE_M
    return on_pane
