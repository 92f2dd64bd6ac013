"""Panels drawn into photos that were not searched: where they must be, by the photo's own pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from groundstation.services.photos.found_panels import PanelDraft
from planning.geo.bvh import OCCLUSION_OFFSET_M, LineOfSight
from planning.site.records import Site, panel_corners
from reconstruction.base.cameras import PosedPhoto

Array = NDArray[np.float64]

BENT_PIECES = 6
"""Of an edge that a lens bends: a panel half as wide as the picture is then right to half a pixel (k1 = -0.11)."""


def panel_outlines(
    photo: PosedPhoto, panels_enu_m: Sequence[Array], sight: LineOfSight | None = None
) -> tuple[Array, ...]:
    """Outlines of the panels that a photo shows, shape (k, 2) each, in its pixels.

    Panels are left out that turn their back, lie outside the picture or reach behind the camera, and those whose middle
    something hides.

    Parameters
    ----------
    panels_enu_m
        Corners of each panel, shape (k, 3), counter-clockwise as seen from outside.
    sight
        Tells what is hidden; None where the scene hides nothing.
    """
    outlines: list[Array] = []
    for n_corners in sorted({len(corners) for corners in panels_enu_m}):
        alike = np.array([corners for corners in panels_enu_m if len(corners) == n_corners])
        outlines += _outlines(photo, alike, sight)
    return tuple(outlines)


def _outlines(photo: PosedPhoto, corners_enu_m: Array, sight: LineOfSight | None) -> list[Array]:
    """Of panels with as many corners, shape (m, k, 3)."""
    following = np.roll(corners_enu_m, -1, axis=1)
    middles = corners_enu_m.mean(axis=1)
    normals = np.cross(corners_enu_m - middles[:, None], following - middles[:, None]).sum(axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shown = np.flatnonzero(((photo.pose.position_enu_m - middles) * normals).sum(axis=1) > 0.0)
    pixels = _projected(photo, corners_enu_m[shown])
    size = np.array([photo.intrinsics.width_px, photo.intrinsics.height_px])
    with np.errstate(invalid="ignore"):
        is_in = (pixels.max(axis=1) > 0.0).all(axis=1) & (pixels.min(axis=1) < size).all(axis=1)
    shown, pixels = shown[is_in], pixels[is_in]
    if sight is not None and len(shown):
        places = np.broadcast_to(photo.pose.position_enu_m, (len(shown), 3))
        is_free = sight(places, middles[shown] + OCCLUSION_OFFSET_M * normals[shown])
        shown, pixels = shown[is_free], pixels[is_free]
    if not photo.intrinsics.is_straight:
        shares = np.linspace(0.0, 1.0, BENT_PIECES, endpoint=False)[:, None]
        starts, ends = corners_enu_m[shown][:, :, None], following[shown][:, :, None]
        pixels = _projected(photo, (starts + shares * (ends - starts)).reshape(len(shown), -1, 3))
    return list(pixels)


def _projected(photo: PosedPhoto, points_enu_m: Array) -> Array:
    """Pixels, shape (m, k, 2), of points, shape (m, k, 3)."""
    return photo.pixels(points_enu_m.reshape(-1, 3)).reshape(*points_enu_m.shape[:2], 2)


def known_panels(draft: PanelDraft | None, site: Site, photo: PosedPhoto) -> tuple[Array, ...]:
    """Corners, shape (k, 3), of panels that are known but were not looked for in a photo: the draft's, else the site's.

    Facades with a grid in the photo are left out: that shows them as they were found.
    """
    if draft is None:
        return tuple(panel_corners(site))
    searched = {place.facade for place in draft.places() if draft.photos[place.photo].path == photo.path}
    facades = (facade for facade in draft.found.facades if facade.id not in searched)
    panels = (panel for facade in facades for panel in facade.panels)
    return tuple(panel.corners_enu_m if panel.outline_enu_m is None else panel.outline_enu_m for panel in panels)
