"""Fronto-parallel views of a facade whose surface and camera are known: unrolled by arc length, or flattened."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import FacadeSurface, Rectification

Array = NDArray[np.float64]


# Fronto-parallel view of a plane from its two vanishing points, for photos without a pose.
#
# With a focal length the view shows true proportions. Without one it is found from the vanishing points, which belong
# to
# directions at a right angle; where they are too far away for that, a usual lens is assumed and proportions are only
# roughly true, which the search for grid lines does not need.

USUAL_FOCAL = 0.8
"""Focal length over the picture's longer side, of a lens of 28 mm on 36 mm, the usual of cameras on drones."""

FOCAL_RANGE = (0.3, 10.0)
"""Believable focal lengths found from vanishing points, of the longer side."""

MOST_STRETCHED = 4.0
"""Enlargement, as a length, of the farthest part of a facade against its middle: beyond it there is nothing to see."""

EDGE_ON = 0.02
"""Depth of the region's middle, of its deepest part, below which the plane is seen from its edge."""

VANISHING_MAX_SIDE_PX = 8192


@dataclass(frozen=True, slots=True, eq=False)
class VanishingView:
    """A homography between photo and rectified picture.

    Parameters
    ----------
    rectified_from_photo
        Shape (3, 3), for continuous pixel coordinates; positive third coordinate where the plane is in front.
    focal_px
        That was used; 0 with `is_metric` False means proportions are assumed.
    """

    width_px: int
    height_px: int
    rectified_from_photo: Array
    focal_px: float
    is_metric: bool

    def to_rectified(self, points_px: Array) -> Array:
        """Points of the photo, shape (n, 2), in the rectified picture; NaN beyond the plane's horizon."""
        return _mapped(self.rectified_from_photo, points_px)

    def to_photo(self, points_px: Array) -> Array:
        """Points of the rectified picture, shape (n, 2), in the photo; NaN behind the camera."""
        return _mapped(np.asarray(np.linalg.inv(self.rectified_from_photo), float), points_px)


def vanishing_view(
    horizontal: Array,
    vertical: Array,
    width_px: int,
    height_px: int,
    focal_px: float | None = None,
    region_px: Array | None = None,
    scale: float = 1.0,
) -> VanishingView:
    """View in which lines through either vanishing point run along rows and columns.

    Parameters
    ----------
    horizontal, vertical
        Vanishing points, homogeneous, shape (3,), in continuous pixel coordinates; at infinity the last number is 0.
    width_px, height_px
        Of the photo, whose principal point is taken to be its middle.
    focal_px
        If it is known.
    region_px
        Outline of the facade in the photo, shape (n, 2); without it the whole photo.
    scale
        Rectified pixels per photo pixel in the middle of the region.

    Raises
    ------
    InfeasibleError
        The two vanishing points are the same, or the region lies on the plane's horizon.
    """
    middle = np.array([0.5 * width_px, 0.5 * height_px])
    longer = float(max(width_px, height_px))
    h, v = _normalised(horizontal, middle, longer), _normalised(vertical, middle, longer)
    found = None if focal_px is None else focal_px / longer
    is_metric = found is not None
    if found is None:
        found, is_metric = _focal(h, v)
    right, down = _directions(h, v, found)
    rotation = np.stack([right, down, np.cross(right, down)])
    k = np.array([[found * longer, 0.0, middle[0]], [0.0, found * longer, middle[1]], [0.0, 0.0, 1.0]])
    homography = rotation @ np.linalg.inv(k)
    region = _whole(width_px, height_px) if region_px is None else np.asarray(region_px, float)
    return _windowed(homography, region, found * longer, is_metric, scale)


def _normalised(point: Array, middle: Array, longer: float) -> Array:
    """Homogeneous point in units of the longer side around the middle, unit length."""
    p = np.asarray(point, float)
    if p.shape != (3,) or not np.isfinite(p).all() or not np.abs(p).max() > 0.0:
        raise ValueError("expected a homogeneous point of shape (3,), finite and not all zero")
    p = p / np.abs(p).max()
    moved = np.array([(p[0] - middle[0] * p[2]) / longer, (p[1] - middle[1] * p[2]) / longer, p[2]])
    return np.asarray(moved / np.linalg.norm(moved), float)


def _focal(h: Array, v: Array) -> tuple[float, bool]:
    """Focal length over the longer side from f^2 = -(h . v) for finite points at right angles, or the usual one."""
    weight = h[2] * v[2]
    squared = -(h[0] * v[0] + h[1] * v[1]) / weight if abs(weight) > 1e-9 else math.inf
    if FOCAL_RANGE[0] ** 2 < squared < FOCAL_RANGE[1] ** 2:
        return math.sqrt(squared), True
    return USUAL_FOCAL, False


def _directions(h: Array, v: Array, focal: float) -> tuple[Array, Array]:
    """Unit directions right and down, exactly at right angles, that are nearest to those of the vanishing points."""
    lens = np.array([1.0 / focal, 1.0 / focal, 1.0])
    right, down = h * lens, v * lens
    right, down = right / np.linalg.norm(right), down / np.linalg.norm(down)
    right = right if right[0] >= 0.0 else -right
    down = down if down[1] >= 0.0 else -down
    if np.linalg.norm(np.cross(right, down)) < 0.1:
        raise InfeasibleError(
            say("the two vanishing points are nearly the same: this is not a plane seen from its front")
        )
    plus, minus = right + down, right - down
    plus, minus = plus / np.linalg.norm(plus), minus / np.linalg.norm(minus)
    return (plus + minus) / math.sqrt(2.0), (plus - minus) / math.sqrt(2.0)


def _whole(width_px: int, height_px: int) -> Array:
    x = np.array([0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0, 0.0, 0.5]) * width_px
    y = np.array([0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.5]) * height_px
    return np.column_stack([x, y])


def _windowed(homography: Array, region: Array, focal_px: float, is_metric: bool, scale: float) -> VanishingView:
    """Shift and scale so that the region fills the picture; what is stretched too far is left out."""
    middle = region.mean(axis=0)
    depths = region @ homography[2, :2] + homography[2, 2]
    depth = float(middle @ homography[2, :2] + homography[2, 2])
    if depth <= EDGE_ON * float(np.abs(depths).max()):
        raise InfeasibleError(
            say("the facade's horizon runs through its middle: it is seen edge-on, or the lines are wrong")
        )
    usable = _clipped(homography, region, depth / MOST_STRETCHED)
    points = _mapped(homography, usable)
    low, high = points.min(axis=0), points.max(axis=0)
    across = math.sqrt(abs(float(np.linalg.det(homography))) / depth**3)
    density = min(scale / across, VANISHING_MAX_SIDE_PX / float((high - low).max()))
    shift = np.array([[density, 0.0, -density * low[0]], [0.0, density, -density * low[1]], [0.0, 0.0, 1.0]])
    width, height = (max(1, math.ceil(side)) for side in (high - low) * density)
    return VanishingView(width, height, shift @ homography, focal_px, is_metric)


def _clipped(homography: Array, region: Array, least_depth: float) -> Array:
    """Outline of the region's part at least that deep (Sutherland and Hodgman's clipping at one line)."""
    depth = region @ homography[2, :2] + homography[2, 2]
    kept = []
    for index in range(len(region)):
        other = (index + 1) % len(region)
        if depth[index] >= least_depth:
            kept.append(region[index])
        if (depth[index] >= least_depth) != (depth[other] >= least_depth):
            share = (least_depth - depth[index]) / (depth[other] - depth[index])
            kept.append(region[index] + share * (region[other] - region[index]))
    return np.array(kept)


def _mapped(homography: Array, points_px: Array) -> Array:
    points = np.atleast_2d(np.asarray(points_px, float))
    mapped = points @ homography[:, :2].T + homography[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(mapped[:, 2:] > 0.0, mapped[:, :2] / mapped[:, 2:], np.nan)


# The rectified picture itself: a photo seen through a map, as exactly as asked and no slower than that.

Image = NDArray[np.uint8]

FIRST_STEP_PX = 32
"""Spacing of the first grid on which a map is computed; between its points it is interpolated."""

TOLERANCE_PX = 0.05
"""Largest error of the interpolated map, pixels of the photo: a twentieth of what the finest feature spans."""

COARSER = 1.5
"""Photo pixels per rectified pixel from which on the photo is averaged first, so that nothing aliases."""


def warp(image: Image, view: Rectification, tolerance_px: float = TOLERANCE_PX) -> tuple[Image, NDArray[np.bool_]]:
    """Rectified picture of a photo, and where it shows something.

    Parameters
    ----------
    image
        Shape (h, w) or (h, w, 3): the photo, of the size that the view's coordinates are for.
    tolerance_px
        0 computes the map at every pixel.

    Returns
    -------
    tuple
        The picture, shape (view.height_px, view.width_px) or with 3 channels, and a mask of its pixels that lie inside
        the photo.
    """
    places = photo_places(view, tolerance_px)
    height, width = image.shape[:2]
    with np.errstate(invalid="ignore"):
        inside = (places >= 0.0).all(axis=2) & (places[..., 0] <= width) & (places[..., 1] <= height)
    shrink = _photo_px_per_rectified(places, inside)
    if shrink > COARSER:
        size = max(1, round(width / shrink)), max(1, round(height / shrink))
        image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
        places = np.asarray(places * (np.array(size) / np.array([width, height])), np.float32)
    places = np.where(inside[..., None], places - np.float32(0.5), np.float32(-10.0))
    x, y = np.ascontiguousarray(places[..., 0]), np.ascontiguousarray(places[..., 1])
    picture = np.asarray(cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.uint8)
    picture[~inside] = 0
    return picture, inside


def photo_places(view: Rectification, tolerance_px: float = TOLERANCE_PX) -> NDArray[np.float32]:
    """Photo coordinates of the centres of all rectified pixels, shape (h, w, 2), NaN where there are none."""
    step = FIRST_STEP_PX if tolerance_px > 0.0 else 1
    while step > 1:
        places = _interpolated(view, step)
        if _error_px(view, places, step) <= tolerance_px:
            return _completed(view, places)
        step //= 4
    x, y = np.meshgrid(np.arange(view.width_px) + 0.5, np.arange(view.height_px) + 0.5)
    exact = view.to_photo(np.column_stack([x.ravel(), y.ravel()]))
    return np.asarray(exact.reshape(view.height_px, view.width_px, 2), np.float32)


def _interpolated(view: Rectification, step: int) -> NDArray[np.float32]:
    """Map on the centres of blocks of `step` pixels and one block around, enlarged."""
    nx, ny = -(-view.width_px // step), -(-view.height_px // step)
    x, y = np.meshgrid((np.arange(-1, nx + 1) + 0.5) * step, (np.arange(-1, ny + 1) + 0.5) * step)
    nodes = view.to_photo(np.column_stack([x.ravel(), y.ravel()])).reshape(ny + 2, nx + 2, 2).astype(np.float32)
    large = cv2.resize(nodes, ((nx + 2) * step, (ny + 2) * step), interpolation=cv2.INTER_LINEAR)
    return np.asarray(large[step : step + view.height_px, step : step + view.width_px], np.float32)


def _error_px(view: Rectification, places: NDArray[np.float32], step: int) -> float:
    """Largest error at the corners between blocks, where interpolation is worst; NaN there are not counted."""
    rows, columns = np.arange(step, view.height_px, step), np.arange(step, view.width_px, step)
    if not len(rows) or not len(columns):
        return 0.0 if step == 1 else float("inf")
    x, y = np.meshgrid(columns, rows)
    exact = view.to_photo(np.column_stack([x.ravel() + 0.5, y.ravel() + 0.5]))
    off = np.abs(places[y.ravel(), x.ravel()] - exact).max(axis=1)
    off = off[np.isfinite(off)]
    return float(off.max()) if len(off) else 0.0


def _completed(view: Rectification, places: NDArray[np.float32]) -> NDArray[np.float32]:
    """Pixels whose block touches the rim of the map, computed one by one."""
    row, column = np.nonzero(~np.isfinite(places).all(axis=2))
    if len(row):
        places[row, column] = view.to_photo(np.column_stack([column + 0.5, row + 0.5]))
    return places


def _photo_px_per_rectified(places: NDArray[np.float32], inside: NDArray[np.bool_]) -> float:
    """Smallest usual spacing in the photo of neighbouring rectified pixels, along rows and columns."""
    across = np.linalg.norm(places[::16, 1:, :] - places[::16, :-1, :], axis=2)[inside[::16, 1:] & inside[::16, :-1]]
    down = np.linalg.norm(places[1:, ::16, :] - places[:-1, ::16, :], axis=2)[inside[1:, ::16] & inside[:-1, ::16]]
    spacings = [float(np.nanmedian(part)) for part in (across, down) if len(part)]
    return min(spacings, default=1.0)


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
