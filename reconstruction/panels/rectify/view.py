"""Fronto-parallel views of a facade whose surface and camera are known: unrolled by arc length, or flattened."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface

Array = NDArray[np.float64]

BORDER_SAMPLES = 64
"""Points along each side of a picture that are cast onto the surface to find what it shows."""

GRAZING = 0.25
"""Cosine between the line of sight and the normal below which (75 degrees) nothing is rectified: a photo pixel would be
drawn out over four, and the seventh-order polynomial, which is asked to follow, fails by tens of pixels."""

MAX_SIDE_PX = 16384
"""Longest side of a rectified picture: memory stays below a gigabyte, and OpenCV's limit of 32767 is far."""


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceView:
    """What a photo shows of a surface, with metres along the arc and upwards as pixels.

    Parameters
    ----------
    low_st_m, high_st_m
        Window on the surface, shape (2,) each: lower left and upper right corner.
    px_per_m
        Of the rectified picture.
    """

    photo: PosedPhoto
    surface: FacadeSurface
    low_st_m: Array
    high_st_m: Array
    px_per_m: float

    def __post_init__(self) -> None:
        if not (np.isfinite(self.low_st_m).all() and np.isfinite(self.high_st_m).all()):
            raise ValueError("expected a finite window")
        if not (self.high_st_m > self.low_st_m).all() or not self.px_per_m > 0.0:
            raise ValueError("expected a window and a scale larger than zero")

    @property
    def width_px(self) -> int:
        """Of the rectified picture."""
        return max(1, int(np.ceil((self.high_st_m[0] - self.low_st_m[0]) * self.px_per_m)))

    @property
    def height_px(self) -> int:
        """Of the rectified picture."""
        return max(1, int(np.ceil((self.high_st_m[1] - self.low_st_m[1]) * self.px_per_m)))

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo; NaN where the surface turns away."""
        return _photo_pixels(self.photo, self.surface, self.to_surface(points_px))

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture; NaN where their rays miss the surface."""
        return self.from_surface(self.surface.hits(*self.photo.rays(points_px)))

    def to_surface(self, points_px: Array) -> Array:
        """Surface coordinates, metres, shape (n, 2), of points of the rectified picture."""
        points = np.atleast_2d(np.asarray(points_px, float))
        return np.column_stack(
            [self.low_st_m[0] + points[:, 0] / self.px_per_m, self.high_st_m[1] - points[:, 1] / self.px_per_m]
        )

    def from_surface(self, st_m: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), of surface coordinates."""
        st = np.atleast_2d(np.asarray(st_m, float))
        return np.column_stack(
            [(st[:, 0] - self.low_st_m[0]) * self.px_per_m, (self.high_st_m[1] - st[:, 1]) * self.px_per_m]
        )


@dataclass(frozen=True, slots=True, eq=False)
class TangentView:
    """The same window projected at right angles onto the tangent plane at its middle, as in the paper (3.1.1).

    Columns of a curved facade grow narrower towards the sides: s is seen as sin(k s) / k.
    """

    unrolled: SurfaceView

    @property
    def width_px(self) -> int:
        """Of the rectified picture."""
        left, right = self._flattened(np.array([self.unrolled.low_st_m[0], self.unrolled.high_st_m[0]]))
        return max(1, int(np.ceil((right - left) * self.unrolled.px_per_m)))

    @property
    def height_px(self) -> int:
        """Of the rectified picture."""
        return self.unrolled.height_px

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo; NaN beyond the rim of the cylinder."""
        return self.unrolled.to_photo(self.to_unrolled(points_px))

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture; NaN where their rays miss the surface."""
        points = self.unrolled.to_rectified(points_px)
        s = self.unrolled.to_surface(points)[:, 0]
        left = self._flattened(self.unrolled.low_st_m[:1])[0]
        return np.column_stack([(self._flattened(s) - left) * self.unrolled.px_per_m, points[:, 1]])

    def to_unrolled(self, points_px: Array) -> Array:
        """Points of this picture, shape (n, 2), in the one unrolled by arc length."""
        points = np.atleast_2d(np.asarray(points_px, float))
        k, view = self.unrolled.surface.curvature_per_m, self.unrolled
        left = self._flattened(view.low_st_m[:1])[0]
        across = left + points[:, 0] / view.px_per_m
        with np.errstate(invalid="ignore"):
            s = self._middle_s_m + (np.arcsin(k * across) / k if k else across)
        return np.column_stack([(s - view.low_st_m[0]) * view.px_per_m, points[:, 1]])

    @property
    def _middle_s_m(self) -> float:
        return float(0.5 * (self.unrolled.low_st_m[0] + self.unrolled.high_st_m[0]))

    def _flattened(self, s_m: Array) -> Array:
        """Across the tangent plane, metres from its touching point; NaN beyond a quarter turn."""
        s, k = s_m - self._middle_s_m, self.unrolled.surface.curvature_per_m
        return np.where(np.abs(k * s) <= 0.5 * np.pi, s * np.sinc(k * s / np.pi), np.nan)


def surface_view(
    photo: PosedPhoto,
    surface: FacadeSurface,
    low_st_m: Array | None = None,
    high_st_m: Array | None = None,
    scale: float = 1.0,
) -> SurfaceView:
    """View of what a photo shows of a surface.

    Parameters
    ----------
    low_st_m, high_st_m
        The facade's extent on the surface, shape (2,); without it, all that the picture shows.
    scale
        Pixels of the rectified picture per pixel of the photo, where the photo looks most squarely.

    Raises
    ------
    InfeasibleError
        The photo does not show that part of the surface from its front.
    """
    w, h = photo.intrinsics.width_px, photo.intrinsics.height_px
    x, y = np.meshgrid(np.linspace(0.0, w, BORDER_SAMPLES), np.linspace(0.0, h, BORDER_SAMPLES))
    pixels = np.column_stack([x.ravel(), y.ravel()])
    origins, directions = photo.rays(pixels)
    st = surface.hits(origins, directions)
    cosines = -(directions * surface.normals_at(st)).sum(axis=1)
    low = np.full(2, -np.inf) if low_st_m is None else np.asarray(low_st_m, float)
    high = np.full(2, np.inf) if high_st_m is None else np.asarray(high_st_m, float)
    with np.errstate(invalid="ignore"):
        shown = np.isfinite(st).all(axis=1) & (cosines > GRAZING) & (st >= low).all(axis=1) & (st <= high).all(axis=1)
    if shown.sum() < 4:
        raise InfeasibleError(say("the photo does not show this facade from its front", place=photo.name))
    spacing = _spacing(np.where(shown[:, None], st, np.nan).reshape(BORDER_SAMPLES, BORDER_SAMPLES, 2))
    seen_low = np.where(np.isfinite(low), np.maximum(low, st[shown].min(axis=0) - spacing), st[shown].min(axis=0))
    seen_high = np.where(np.isfinite(high), np.minimum(high, st[shown].max(axis=0) + spacing), st[shown].max(axis=0))
    if not (seen_high - seen_low > 0.0).all():
        raise InfeasibleError(say("the photo shows no area of this facade", place=photo.name))
    density = scale * _px_per_m(photo, surface, st[shown])
    largest = float((seen_high - seen_low).max())
    return SurfaceView(photo, surface, seen_low, seen_high, min(density, MAX_SIDE_PX / largest))


def _spacing(st: Array) -> Array:
    """Usual distance on the surface between neighbouring samples, shape (2,), metres."""
    steps = np.concatenate([np.diff(st, axis=0).reshape(-1, 2), np.diff(st, axis=1).reshape(-1, 2)])
    steps = np.abs(steps[np.isfinite(steps).all(axis=1)])
    return np.asarray(np.percentile(steps, 90.0, axis=0), float) if len(steps) else np.zeros(2)


def _px_per_m(photo: PosedPhoto, surface: FacadeSurface, st: Array) -> float:
    """Pixels per metre across the line of sight at the nearest of the points: what the photo resolves at best."""
    distance = np.linalg.norm(surface.to_enu(st) - photo.pose.position_enu_m, axis=1)
    return float(max(photo.intrinsics.fx_px, photo.intrinsics.fy_px) / distance.min())


def _photo_pixels(photo: PosedPhoto, surface: FacadeSurface, st: Array) -> Array:
    points = surface.to_enu(st)
    towards = photo.pose.position_enu_m - points
    with np.errstate(invalid="ignore", divide="ignore"):
        cosines = (towards * surface.normals_at(st)).sum(axis=1) / np.linalg.norm(towards, axis=1)
        facing = cosines > 0.0
    return np.where(facing[:, None], photo.pixels(points), np.nan)
