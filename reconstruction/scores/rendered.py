"""Rendered photos of scenes as photos to score: what they show of each facade is known from pose and site."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from planning.site import Facade
from reconstruction.cameras import PosedPhoto
from reconstruction.rectify.fit import fit_cylinder, fit_plane
from reconstruction.rectify.surface import FacadeSurface
from reconstruction.rectify.view import SurfaceView, surface_view
from reconstruction.scores.sets import EXTENT_MARGIN_M, ScoredPhoto

Array = NDArray[np.float64]

FLAT_M = 0.005
"""Panels whose points keep this close to a plane stand on it; facets of a curved facade do not."""

ALONG = np.linspace(0.0, 1.0, 3)
"""Where points are taken along a panel's sides, so that one panel alone makes a surface as well."""

Wall = tuple[FacadeSurface, Array, Array]
"""A facade's surface and its extent on it, from low to high, each shape (2,), metres."""


def walls(facades: Sequence[Facade]) -> tuple[Wall, ...]:
    """Planes or cylinders that the panels of facades stand on, as far as `EXTENT_MARGIN_M` around them.

    Facades whose panels make no surface are left out.
    """
    found = []
    for facade in facades:
        with suppress(InfeasibleError):
            found.append(_wall(facade))
    return tuple(found)


def _wall(facade: Facade) -> Wall:
    corners = np.array([panel.corners_enu_m for panel in facade.panels], float)
    u, v = np.meshgrid(ALONG, ALONG)
    weights = np.stack([(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v], axis=-1).reshape(-1, 4)
    points = np.einsum("wk,mkx->mwx", weights, corners).reshape(-1, 3)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]).sum(axis=0)
    outside = points.mean(axis=0) + 100.0 * normal / np.linalg.norm(normal)
    surface = fit_plane(points, outside).surface
    if np.abs(surface.height_m(points)).max() > FLAT_M:
        surface = fit_cylinder(points, outside).surface
    st = surface.to_surface(points)
    return surface, st.min(axis=0) - EXTENT_MARGIN_M, st.max(axis=0) + EXTENT_MARGIN_M


def rendered_photo(
    photo: PosedPhoto, image: NDArray[np.uint8], panel: NDArray[np.uint16], walls_seen: Sequence[Wall]
) -> ScoredPhoto:
    """A rendered photo with its truth.

    Parameters
    ----------
    image
        Shape (h, w, 3): blue, green, red.
    panel
        Shape (h, w): 1 + number of the panel that each pixel shows, 0 for none.
    walls_seen
        Of the site; those that the photo does not show from their front are passed over.
    """
    views: list[SurfaceView] = []
    for surface, low, high in walls_seen:
        with suppress(InfeasibleError):
            views.append(surface_view(photo, surface, low, high))
    return ScoredPhoto(photo.name, image, panel, views=tuple(views))
