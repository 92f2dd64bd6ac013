"""Hemisphere sections of panels, defined in plain float64 NumPy: the readable twin of the fast kernel.

A panel with centroid c and unit outward normal n carries a unit hemisphere. For an optical centre o,

    d = (o - c) / |o - c|,   theta = acos(d . n),   phi = atan2(d . b, d . t) in [0, 2 pi),

with t = unit(z_up x n) (east where n is vertical) and b = n x t. With steps of `step_deg` in both angles the section is
floor(theta / step) * (360 / step) + floor(phi / step) (Liang et al., RefGlass-GS, 3.2: 30 degrees, 36 sections). Equal
angles are not equal areas: `SectionGrid.solid_angles_sr` gives the true size of each section.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import camera_axes
from planning.parameters import check_section_step
from planning.plan import Camera, ViewpointArrays

Array = NDArray[np.float64]

VERTICAL_NORMAL = 1e-6
"""Below this horizontal length of its unit normal a panel is horizontal, and t is east (the contract's value)."""

NOT_SEEN = -1


@dataclass(frozen=True, slots=True, eq=False)
class PanelFrames:
    """Panels as arrays, ENU metres.

    Centroids, unit normals and the tangents t and b have shape (m, 3), corners (m, 4, 3).
    """

    centroids: Array
    normals: Array
    tangents: Array
    bitangents: Array
    corners: Array

    def __len__(self) -> int:
        return len(self.centroids)


def panel_frames(corners_enu_m: Array) -> PanelFrames:
    """Frames of panels from their corners, shape (m, 4, 3).

    Raises
    ------
    ValueError
        A panel has no area, hence no normal.
    """
    area_vectors = 0.5 * np.cross(corners_enu_m[:, 2] - corners_enu_m[:, 0], corners_enu_m[:, 3] - corners_enu_m[:, 1])
    areas = np.linalg.norm(area_vectors, axis=1)
    if (areas <= 0).any() or not np.isfinite(areas).all():
        raise ValueError(f"panel {int(np.argmin(areas))} has no area")
    normals = area_vectors / areas[:, None]
    horizontal = np.hypot(normals[:, 0], normals[:, 1])
    tangents = np.zeros_like(normals)
    tangents[:, 0] = 1.0
    upright = horizontal >= VERTICAL_NORMAL
    tangents[upright] = (
        np.stack([-normals[:, 1], normals[:, 0], np.zeros(len(normals))], axis=1)[upright] / horizontal[upright, None]
    )
    return PanelFrames(corners_enu_m.mean(axis=1), normals, tangents, np.cross(normals, tangents), corners_enu_m)


@dataclass(frozen=True, slots=True)
class SectionGrid:
    """Rings of polar angle times sectors of azimuth, both `step_deg` wide."""

    step_deg: float

    def __post_init__(self) -> None:
        check_section_step(self.step_deg)

    @property
    def n_rings(self) -> int:
        """Rings from the pole to the horizon."""
        return round(90.0 / self.step_deg)

    @property
    def n_sectors(self) -> int:
        """Sectors around the normal."""
        return 4 * self.n_rings

    @property
    def n_sections(self) -> int:
        """Sections of one panel."""
        return self.n_rings * self.n_sectors

    def solid_angles_sr(self) -> Array:
        """Solid angle of each section, shape (n_sections,); they add up to 2 pi."""
        edges = np.cos(np.radians(self.step_deg * np.arange(self.n_rings + 1)))
        rings = (edges[:-1] - edges[1:]) * 2.0 * math.pi / self.n_sectors
        return np.repeat(rings, self.n_sectors)

    def bounds_rad(self, section: int) -> tuple[float, float, float, float]:
        """Lowest and highest theta, lowest and highest phi of a section, radians."""
        ring, sector = divmod(section, self.n_sectors)
        step = math.radians(self.step_deg)
        return ring * step, (ring + 1) * step, sector * step, (sector + 1) * step


def sections_of(points_enu_m: Array, panels: PanelFrames, grid: SectionGrid) -> NDArray[np.int64]:
    """Section of each panel's hemisphere in which each point lies, whatever a camera there looks at.

    Parameters
    ----------
    points_enu_m
        Shape (n, 3).

    Returns
    -------
    section
        Shape (n, m); `NOT_SEEN` where the point lies on or behind the panel's plane, or at its centroid.
    """
    n, m = len(points_enu_m), len(panels)
    point, panel = np.repeat(np.arange(n), m), np.tile(np.arange(m), n)
    return _section_of(points_enu_m[point], panels, panel, grid).reshape(n, m)


def _section_of(
    points_enu_m: Array, panels: PanelFrames, of: NDArray[np.int64], grid: SectionGrid
) -> NDArray[np.int64]:
    """Section of the hemisphere of panel `of[i]` in which point i lies, shape (k,)."""
    rays = points_enu_m - panels.centroids[of]
    distance = np.linalg.norm(rays, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        d = rays / distance[:, None]
    along, across, upwards = (
        np.einsum("ik,ik->i", d, axes[of]) for axes in (panels.normals, panels.tangents, panels.bitangents)
    )
    theta = np.degrees(np.arccos(np.clip(along, -1.0, 1.0)))
    phi = np.degrees(np.arctan2(upwards, across))
    phi = np.where(phi < 0.0, phi + 360.0, phi)
    in_front = (distance > 0.0) & (theta < 90.0)
    with np.errstate(invalid="ignore"):
        ring = np.floor(np.where(in_front, theta, 0.0) / grid.step_deg).astype(np.int64)
        sector = np.floor(np.where(in_front, phi, 0.0) / grid.step_deg).astype(np.int64)
    sector = np.where(sector >= grid.n_sectors, 0, sector)
    return np.where(in_front, np.minimum(ring, grid.n_rings - 1) * grid.n_sectors + sector, NOT_SEEN)


def in_picture(views: ViewpointArrays, points_enu_m: Array, camera: Camera) -> NDArray[np.bool_]:
    """Whether each view's picture holds each point: shape (n, ...) for points of shape (..., 3).

    A point is inside the rectangular field of view when |right . v| <= w f and |up . v| <= h f with v from the camera
    to the point, f = forward . v > 0 and w, h the tangents of the half angles.
    """
    forward, right, up = camera_axes(views.heading_rad, views.pitch_rad)
    flat = points_enu_m.reshape(-1, 3)
    v = flat[None, :, :] - views.positions_enu_m[:, None, :]
    depth = np.einsum("nmk,nk->nm", v, forward)
    inside: NDArray[np.bool_] = (
        (depth > 0.0)
        & (np.abs(np.einsum("nmk,nk->nm", v, right)) <= camera.half_width * depth)
        & (np.abs(np.einsum("nmk,nk->nm", v, up)) <= camera.half_height * depth)
    )
    return inside.reshape(len(views.positions_enu_m), *points_enu_m.shape[:-1])


def sections_seen(
    views: ViewpointArrays,
    panels: PanelFrames,
    camera: Camera,
    grid: SectionGrid,
    whole_panel: bool = False,
    max_distance_m: float | None = None,
) -> NDArray[np.int64]:
    """Section of each panel that each view covers, without occlusion: shape (n, m), `NOT_SEEN` where it covers none."""
    seen = in_picture(views, panels.centroids, camera)
    if whole_panel:
        seen &= in_picture(views, panels.corners, camera).all(axis=2)
    if max_distance_m is not None:
        distance = np.linalg.norm(views.positions_enu_m[:, None, :] - panels.centroids[None, :, :], axis=2)
        seen &= distance <= max_distance_m
    view, panel = np.nonzero(seen)
    section = np.full(seen.shape, NOT_SEEN, np.int64)
    section[view, panel] = _section_of(views.positions_enu_m[view], panels, panel, grid)
    return section
