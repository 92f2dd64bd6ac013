"""Which rectification a facade calls for: none but a plane's, or a cylinder's; unrolled, or flattened as in the paper.

Two effects, each with its size in pixels of the rectified picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.fit import SurfaceFit
from reconstruction.panels.rectify.polynomial import polynomial_view
from reconstruction.panels.rectify.rectification import Rectification
from reconstruction.panels.rectify.view import SurfaceView, TangentView, surface_view

Array = NDArray[np.float64]

ViewKind = Literal["auto", "exact", "tangent", "polynomial"]
"""How a photo is rectified; `auto` leaves it to the scene."""

VIEW_KINDS: tuple[ViewKind, ...] = get_args(ViewKind)

BENT_LINE_PX = 0.5
"""Tolerance of both effects: lines are found to about half a pixel."""

SIGNIFICANT = 5.0
"""Standard deviations from which on a fitted curvature is believed. The points of a mesh are not independent of each
other, so that the usual three are reached by flat walls, too."""

GRID = 25
COST_S_PER_MEGAPIXEL = 0.02
"""Extra time for a curved map, which is not a homography: measured on a 20-megapixel photo."""


@dataclass(frozen=True, slots=True, eq=False)
class FittedFacade:
    """A photo and the two surfaces fitted to the part of the coarse model that it shows.

    `low_st_m` and `high_st_m` are the facade's extent on the cylinder, shape (2,).
    """

    photo: PosedPhoto
    plane: SurfaceFit
    cylinder: SurfaceFit
    low_st_m: Array
    high_st_m: Array


@dataclass(frozen=True, slots=True)
class Curvature:
    """Take the facade for a cylinder: otherwise its straight rows or columns would be bent in the rectified view."""

    name: str = "facade curvature"
    unit: str = "px"
    tolerance: float = BENT_LINE_PX

    def assess(self, scene: FittedFacade) -> Assessment:
        """How far lines of the grid would be off a straight row or column if the facade were taken for a plane."""
        megapixels = scene.photo.intrinsics.width_px * scene.photo.intrinsics.height_px / 1e6
        cost_s = COST_S_PER_MEGAPIXEL * megapixels
        significance = scene.cylinder.curvature_significance
        if significance < SIGNIFICANT:
            return Assessment(0.0, f"its curvature is {significance:.1f} standard deviations, which is noise", cost_s)
        size = bent_by_px(scene)
        radius = 1.0 / abs(scene.cylinder.surface.curvature_per_m)
        return Assessment(size, f"a radius of {radius:.1f} m bends lines of the grid by up to {size:.1f} px", cost_s)


@dataclass(frozen=True, slots=True)
class Unrolling:
    """Unroll by arc length instead of flattening onto the tangent plane, which squeezes the outer columns."""

    name: str = "unrolling by arc length"
    unit: str = "px"
    tolerance: float = BENT_LINE_PX

    def assess(self, scene: SurfaceView) -> Assessment:
        """How far the outermost column of the tangent plane is from where arc length puts it."""
        half_width_m = float(0.5 * (scene.high_st_m[0] - scene.low_st_m[0]))
        angle = abs(scene.surface.curvature_per_m) * half_width_m
        squeezed_m = half_width_m * (1.0 - float(np.sinc(min(angle, 0.5 * np.pi) / np.pi)))
        size = squeezed_m * scene.px_per_m
        return Assessment(size, f"the window spans {np.degrees(2.0 * angle):.1f} degrees of the cylinder", 0.0)


def decide_view(views: Sequence[SurfaceView], kind: ViewKind = "auto") -> Decision:
    """Whether photos of a facade are unrolled by arc length: the decision of the photo that it changes most."""
    wish: EffectSetting = "auto" if kind == "auto" else "on" if kind == "exact" else "off"
    return max((decide(Unrolling(), view, wish) for view in views), key=lambda found: found.size)


def drawn_view(view: SurfaceView, kind: ViewKind, unrolling: Decision) -> Rectification:
    """The view that a photo is rectified by.

    Raises
    ------
    InfeasibleError
        A polynomial is asked for, and too little of the view is seen in the photo.
    """
    if unrolling.on or (view.surface.is_flat and kind != "polynomial"):
        return view
    flattened = TangentView(view)
    return polynomial_view(flattened) if kind == "polynomial" else flattened


def bent_by_px(scene: FittedFacade) -> float:
    """Largest distance of a grid line from the straight row or column that fits it best in the plane's view, pixels.

    0 where the photo does not show the facade.
    """
    plane_view = surface_view(scene.photo, scene.plane.surface)
    s = np.linspace(scene.low_st_m[0], scene.high_st_m[0], GRID)
    t = np.linspace(scene.low_st_m[1], scene.high_st_m[1], GRID)
    st = np.stack(np.meshgrid(s, t), axis=-1)
    points = scene.cylinder.surface.to_enu(st.reshape(-1, 2))
    hits = scene.plane.surface.hits(*scene.photo.rays(scene.photo.pixels(points)))
    seen = scene.photo.sees(points) & np.isfinite(hits).all(axis=1)
    places = np.where(seen[:, None], hits, np.nan).reshape(GRID, GRID, 2) * plane_view.px_per_m
    columns = _off_straight(places[..., 0].T)
    rows = _off_straight(places[..., 1])
    return max(columns, rows)


def _off_straight(lines: Array) -> float:
    """Half the range of each line's coordinate, the largest of all lines; NaN are left out."""
    seen = lines[np.isfinite(lines).sum(axis=1) >= 2]
    return float((0.5 * (np.nanmax(seen, axis=1) - np.nanmin(seen, axis=1))).max()) if len(seen) else 0.0
