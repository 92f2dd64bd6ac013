"""Which panel is at a place in a picture: the nearest one that the ray through it meets, and what may stand before it.

A panel is met on either side: somebody who flies around a model may look at it from inside.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.layers import draw_panels

Array = NDArray[np.float64]

LEAST_COSINE = 1e-6
"""Between a ray and a panel's plane: less is a panel seen from its edge."""

BEFORE_M, BEFORE_SHARE = 0.5, 0.03
"""By how much a picture's depth must be less than a panel's for something to stand before it: the depth of a model is a
mean over what shines through."""


@dataclass(frozen=True, slots=True, eq=False)
class Quads:
    """m panels, made ready for rays.

    Parameters
    ----------
    corners_enu_m
        Shape (m, 4, 3), convex.
    """

    corners_enu_m: Array
    normals: Array
    inwards: Array
    offsets: Array

    @classmethod
    def of(cls, corners_enu_m: Array) -> Quads:
        """Planes of the panels, and of their edges."""
        corners = np.asarray(corners_enu_m, float).reshape(-1, 4, 3)
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        edges = np.roll(corners, -1, axis=1) - corners
        inwards = np.cross(normals[:, None], edges)
        return cls(corners, normals, inwards, np.einsum("mkj,mkj->mk", inwards, corners))

    def first_hits(self, origin_enu_m: Array, directions: Array) -> tuple[NDArray[np.int64], Array]:
        """Panels that rays meet first.

        Parameters
        ----------
        origin_enu_m
            Shape (3,).
        directions
            Unit, shape (n, 3).

        Returns
        -------
        numbers, distances_m
            Shape (n,); -1 and infinity where none is met.
        """
        n = len(directions)
        nearest, numbers = np.full(n, np.inf), np.full(n, -1, np.int64)
        if not len(self.normals):
            return numbers, nearest
        heights = np.einsum("mj,mj->m", self.normals, self.corners_enu_m.mean(axis=1) - origin_enu_m)
        slopes = directions @ self.normals.T
        with np.errstate(divide="ignore", invalid="ignore"):
            distances = np.where(np.abs(slopes) > LEAST_COSINE, heights / slopes, np.inf)
        rows, panels = np.nonzero((distances > 0.0) & np.isfinite(distances))
        along = distances[rows, panels]
        places = origin_enu_m + along[:, None] * directions[rows]
        inside = (np.einsum("ikj,ij->ik", self.inwards[panels], places) >= self.offsets[panels]).all(axis=1)
        rows, panels, along = rows[inside], panels[inside], along[inside]
        # The last of equal rows stays, so the nearest goes last.
        order = np.argsort(-along, kind="stable")
        nearest[rows[order]], numbers[rows[order]] = along[order], panels[order]
        return numbers, nearest


def rays_of(camera: PosedPhoto, places_px: Array) -> Array:
    """Unit directions, ENU, of the rays through places in a straight picture, shape (n, 3).

    Parameters
    ----------
    places_px
        Continuous pixel coordinates, shape (n, 2): (0.5, 0.5) is the middle of the first pixel.
    """
    lens = camera.intrinsics
    rays = np.column_stack(
        [
            (places_px[:, 0] - lens.cx_px) / lens.fx_px,
            (places_px[:, 1] - lens.cy_px) / lens.fy_px,
            np.ones(len(places_px)),
        ]
    )
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    return np.asarray(rays @ camera.pose.cam_from_enu)


def picked(quads: Quads, camera: PosedPhoto, places_px: Array, depths_m: Array | None = None) -> NDArray[np.int64]:
    """Numbers of the panels at places of a picture, shape (n,); -1 for none.

    Parameters
    ----------
    places_px
        Shape (n, 2).
    depths_m
        Of the picture there, along the optical axis, shape (n,): what is well before a panel hides it. None: nothing
        does.
    """
    rays = rays_of(camera, np.asarray(places_px, float))
    numbers, distances = quads.first_hits(camera.pose.position_enu_m, rays)
    if depths_m is None:
        return numbers
    return np.where(_is_before(depths_m, distances * (rays @ camera.pose.forward_enu)), -1, numbers)


def panel_map(quads: Quads, camera: PosedPhoto, depths_m: NDArray[np.float32]) -> NDArray[np.int32]:
    """Numbers of the panels at all pixels of a picture, shape (h, w); -1 for none.

    The same as `picked` of all pixels' middles, but for those on panels' edges, in a fraction of the time.

    Parameters
    ----------
    depths_m
        Of the picture, along the optical axis, shape (h, w); infinite where nothing is.
    """
    drawn = draw_panels(camera, quads.corners_enu_m)
    return np.where(_is_before(depths_m, drawn.depth_m), -1, drawn.index.astype(np.int32) - 1)


def _is_before(depths_m: NDArray[Any], panels_m: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether what a picture shows stands before the panels there."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.isfinite(depths_m) & (depths_m < panels_m * (1.0 - BEFORE_SHARE) - BEFORE_M))
