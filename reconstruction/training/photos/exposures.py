"""How brightly each photo was exposed: gains that points tell, learned beside the model, or fitted to scored views.

Points tell, too, which photos show something else than the place where they were said to be taken.

A model and the gains of all its photos can grow against each other without any picture changing, and splats then take
on a cast that the gains take away again. So the mean of the logarithms stays what it was at the start, by a projection
after each step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.messages import first_few, say
from planning.base.progress import QUIET, Monitor
from planning.geo.mesh import TriangleMesh
from planning.geo.ray_casting import RayCaster
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.prepare import mask_of
from reconstruction.light.photo_set import PhotoSet
from reconstruction.splats.surfels import SAME_SURFACE_M, panel_proximity

Array = NDArray[np.float64]

HeldOutGain = Literal["none", "fitted"]
"""Exposure of a view that was not learned from: what is known of it and nothing else, the fair score and the default;
or fitted to the photo that is scored, which shows what is left where exposure alone was wrong."""

DARKEST, BRIGHTEST = 4.0 / 255.0, 250.0 / 255.0
"""sRGB values of photos that tell a gain: darker ones are noise, and brighter ones are clipped."""

LEAST_VALUES = 100
"""That a gain is fitted to."""


class Exposures(nn.Module):
    """Factors on the linear light of each photo.

    Parameters
    ----------
    known
        Gains to start from, more than 0: what the folder tells, else 1. One for each photo, or, shape (n, 3), one for
        each of its red, green and blue, which takes up white balance, too.
    """

    def __init__(self, known: Sequence[float] | Array) -> None:
        super().__init__()
        gains = torch.as_tensor(np.array(known, float))
        gains = gains[:, None] if gains.ndim == 1 else gains
        if gains.ndim != 2 or gains.shape[1] not in (1, 3):
            raise ValueError(f"known: expected shape (n,) or (n, 3), got {[*gains.shape]}")
        if not len(gains) or not bool((torch.isfinite(gains) & (gains > 0.0)).all()):
            raise ValueError("known: expected a gain above 0 for each of at least one photo")
        logarithms = gains.log()
        self.log_gains = nn.Parameter(logarithms.float())
        self.log_mean: Tensor
        self.register_buffer("log_mean", logarithms.mean(dim=0))

    def forward(self, number: int) -> Tensor:
        """Gain of a photo, shape (1,) or (3,)."""
        return self.log_gains[number].exp()

    @torch.no_grad()
    def project(self) -> None:
        """Give the logarithms their first mean back; to be called after each step."""
        drift = self.log_gains.mean(dim=0, dtype=torch.float64) - self.log_mean
        self.log_gains.sub_(drift.to(self.log_gains))


@torch.no_grad()
def fitted_gain(light: Tensor, truth: Tensor, display: Tensor, channels: Literal[1, 3] = 1) -> Tensor:
    """Gain that brings rendered light closest to a photo's, by least squares in linear light; shape (1,) or (3,).

    The closed form g = sum(f t) / sum(f f) over values f of the rendering and t of the photo, of those that are neither
    clipped nor next to black in the photo. 1 where fewer than `LEAST_VALUES` are left, or nothing was rendered.

    Parameters
    ----------
    light, truth
        Linear light as rendered, and of the photo, shape (n, 3).
    display
        The photo's sRGB values, 0 to 1, shape (n, 3).
    """
    if light.shape != truth.shape or light.shape != display.shape or light.ndim != 2 or light.shape[1] != 3:
        raise ValueError(f"expected three of shape (n, 3), got {[*light.shape]}, {[*truth.shape]}, {[*display.shape]}")
    is_usable = (display > DARKEST) & (display < BRIGHTEST) & torch.isfinite(light)
    found = torch.where(is_usable, light, 0.0).double()
    products, squares, counts = found * truth.double(), found * found, is_usable.double()
    sums = torch.stack([part.sum(dim=0) for part in (products, squares, counts)])
    if channels == 1:
        sums = sums.sum(dim=1, keepdim=True)
    gain = sums[0] / sums[1].clamp(min=1e-12)
    is_told = (sums[2] >= LEAST_VALUES) & (sums[1] > 1e-12) & (gain > 0.0)
    return torch.where(is_told, gain, 1.0).to(light)


# What points that several photos show tell about exposures, before anything is learned.
#
# The logarithm of what a photo shows of a point is that of its light plus that of the photo's gain. Medians over
# points and photos in turn find both, whatever a part of the points is: hidden, glossy, or moved.

N_GAIN_POINTS = 20_000
"""Points, evenly chosen, or up to twice as many."""

SMALL_PX = 320
"""Longer side of the photos that are looked at: points need not be more exact than this."""

LOOKED_AT = 16
"""Photos, evenly chosen, that tell whether all are to be looked at."""

WHOLE = 0.999
"""Share of a small pixel that counts by the photo's mask: less is a mixture with black."""

LEAST_POINTS = 20
"""That tell a photo's gain: fewer say nothing, and it is 1."""

NEARER_M = 0.5
"""That a surface may be before a point which it does not hide: coarse models are off by as much."""

CELLS, FRONT = 8, 1.2
"""Where no mesh hides points: cells along a photo's longer side, and times as far as the nearest point of a cell up to
which others in it count."""

ROUNDS = 12
"""Of medians in turn: gains have come to rest by then."""

BLOCK = 32
"""Neighbouring points of one half, so that what disturbs some of them is not in both halves."""


LEAST_COMPARED, SEEN_BY = 300, 4
"""Points that tell whether a photo shows something else, each seen by so many photos."""

EVEN, UNLIKE, MOST_OUTLIERS = 0.15, 0.2, 0.25
"""Mean difference of logarithms of light that a photo may have from points in any case, and correlation below which it
shows something else: of 107 rendered and 17 real photos none had less than 0.45 on as many points, poses off by 2
pixels and passers-by included; views inside other buildings had up to 0.17. Where it is more than that share of all
photos, rather the points are wrong."""


@dataclass(frozen=True, slots=True, eq=False)
class PointGains:
    """What points tell.

    Parameters
    ----------
    gains
        Factors on the linear light of each photo, red, green and blue, shape (n, 3), beyond those that were known; the
        mean of their logarithms is 0. As far as two halves of the points disagree, they are nearer to 1.
    spread
        Standard deviation over photos of the logarithms: what both halves agree on, as far as points then look alike.
    n_told
        Photos that enough points are seen in, and that show them.
    outliers
        Numbers of photos that show something else; their gains are 1.
    """

    gains: Array
    spread: float
    n_told: int
    outliers: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class OwnExposures:
    """Give each photo a gain and a white balance of its own."""

    name: str = say("exposure of each photo")
    unit: str = say("spread of the gains' logarithms")
    tolerance: float = 0.1

    def assess(self, scene: PointGains) -> Assessment:
        """How much gains differ from photo to photo."""
        if scene.n_told < 2:
            return Assessment(0.0, say("too few points are seen in several photos"), 0.0)
        return Assessment(
            scene.spread,
            say("the same points are brighter or darker by {:.0f} % in other photos", 100.0 * scene.spread),
            0.0,
        )


SHOWN_NAMES = 5
"""Of photos, in a reason."""


@dataclass(frozen=True, slots=True)
class OutlierPhotos:
    """Leave photos out that do not show what the others show of the same points."""

    name: str = say("photos of something else")
    unit: str = say("share of the photos")
    tolerance: float = 0.0

    def assess(self, scene: tuple[tuple[str, ...], int]) -> Assessment:
        """By names of such photos, and the number of all that were looked at."""
        names, n_photos = scene
        if not names:
            return Assessment(0.0, say("all photos that were looked at show the same points"), 0.0)
        shown = first_few(names, SHOWN_NAMES)
        reason = say("where {} of {} photos were taken, the others saw something else: {}", len(names), n_photos, shown)
        return Assessment(len(names) / n_photos, reason, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class ToldByPoints:
    """Gains of photos beyond those that the folder tells, shape (n, 3), 1 where that is off; photos to leave out."""

    gains: Array
    outliers: tuple[int, ...]
    own_exposures: Decision
    outlier_photos: Decision


def told_by_points(
    source: PhotoSet,
    photos: Sequence[PosedPhoto],
    points_enu_m: Array,
    mesh: TriangleMesh,
    own_exposures: EffectSetting = "auto",
    outlier_photos: EffectSetting = "auto",
    monitor: Monitor = QUIET,
) -> ToldByPoints:
    """Exposures of photos and photos of something else, as points tell them, and the decisions.

    Parameters
    ----------
    points_enu_m
        On surfaces, shape (k, 3).
    mesh
        That hides points.

    Raises
    ------
    InputError
        A photo is missing or damaged.
    OperationCancelled
        From `monitor`.
    """
    ones = np.ones((len(photos), 3))
    found, looked_at = PointGains(ones, 0.0, 0), photos
    if (own_exposures, outlier_photos) != ("off", "off"):
        looked_at = photos[:: -(-len(photos) // LOOKED_AT)]
        found = gains_from_points(source, looked_at, points_enu_m, mesh, monitor)
    has_outliers = bool(found.outliers) and outlier_photos != "off"
    if len(looked_at) < len(photos) and (has_outliers or decide(OwnExposures(), found, own_exposures).on):
        looked_at = photos
        found = gains_from_points(source, photos, points_enu_m, mesh, monitor)
    names = tuple(looked_at[number].name for number in found.outliers)
    exposed = decide(OwnExposures(), found, own_exposures)
    left_out = decide(OutlierPhotos(), (names, len(looked_at)), outlier_photos)
    return ToldByPoints(
        found.gains if exposed.on else ones,
        found.outliers if left_out.on else (),
        exposed,
        left_out,
    )


def gains_from_points(
    source: PhotoSet,
    photos: Sequence[PosedPhoto],
    points_enu_m: Array,
    mesh: TriangleMesh,
    monitor: Monitor = QUIET,
) -> PointGains:
    """Gains that points tell which are on no panel, for glass shows something else to each photo.

    Raises
    ------
    InputError
        A photo is missing or damaged.
    OperationCancelled
        From `monitor`.
    """
    on_glass = panel_proximity(points_enu_m, source.panels.corners_enu_m, SAME_SURFACE_M, 0.0).panels >= 0
    points = points_enu_m[~on_glass]
    points = _in_blocks(points[:: max(1, len(points) // N_GAIN_POINTS)])
    caster = RayCaster(mesh) if len(mesh.triangles) else None
    seen = np.full((len(photos), len(points), 3), np.nan)
    for number, photo in enumerate(photos):
        monitor.report(say("comparing exposures"), number, len(photos))
        seen[number] = _logarithms(source, photo, points, caster)
    seen = seen[:, (~np.isnan(seen[..., 0])).sum(axis=0) >= 2]
    is_told = (~np.isnan(seen[..., 0])).sum(axis=1) >= 2 * LEAST_POINTS
    outliers = _outliers(seen, is_told)
    is_told[list(outliers)] = False
    gains, n_told = np.zeros((len(photos), 3)), int(is_told.sum())
    if n_told < 2:
        return PointGains(np.ones((len(photos), 3)), 0.0, 0)
    is_first = np.arange(seen.shape[1]) // BLOCK % 2 == 0
    one, other = (_gains(seen[is_told][:, half]) for half in (is_first, ~is_first))
    agreed = float((one * other).mean())
    off = float(np.square(one - other).mean()) / 4.0
    if agreed > 0.0:
        gains[is_told] = 0.5 * (one + other) * agreed / (agreed + off)
    spread = math.sqrt(max(agreed, 0.0) * _explained(seen[is_told], gains[is_told]))
    return PointGains(np.exp(gains), spread, n_told, outliers)


def _explained(seen: Array, gains: Array) -> float:
    """Share of what photos differ by, squared and in the middle, that gains take away, 0 to 1; `seen` as in `_gains`.

    Frames that are a pixel wide, and points beside where poses say, look brighter or darker in whole photos, too, but
    not by one factor.
    """
    # Photos that tell too little were left out since: what only they show is shown by none of these.
    seen = seen[:, (~np.isnan(seen[..., 0])).sum(axis=0) >= 2]
    if not seen.size:
        return 0.0
    before, after = (
        float(np.nanmedian(np.abs(light - np.nanmedian(light, axis=0)))) for light in (seen, seen - gains[:, None])
    )
    return max(0.0, 1.0 - (after / before) ** 2) if before > 0.0 else 0.0


def _outliers(seen: Array, is_told: NDArray[np.bool_]) -> tuple[int, ...]:
    """Photos, of those with enough points, that show something else; `seen` as in `_gains`."""
    kept = np.flatnonzero(is_told)
    found: list[int] = []
    while len(kept) > SEEN_BY:
        light = seen[kept] - _gains(seen[kept])[:, None]
        points = np.flatnonzero((~np.isnan(light[..., 0])).sum(axis=0) >= SEEN_BY)
        if not len(points):
            break
        of_points = np.nanmedian(light[:, points], axis=0)
        is_outlier = np.array([_is_unlike(seen[number, points], of_points) for number in kept])
        if not is_outlier.any():
            break
        found += kept[is_outlier].tolist()
        kept = kept[~is_outlier]
    return tuple(sorted(found)) if len(found) <= MOST_OUTLIERS * is_told.sum() else ()


def _is_unlike(shown: Array, light: Array) -> bool:
    """Whether a photo does not show the light of points, logarithms of shape (k, 3), NaN where it shows none of one.

    It does not where the two do not go together, and where no light at all explains the photo better than theirs; an
    even wall, where there is nothing to tell by, passes.
    """
    is_seen = ~np.isnan(shown[:, 0])
    if is_seen.sum() < LEAST_COMPARED:
        return False
    shown, light = (part[is_seen] - np.median(part[is_seen], axis=0) for part in (shown, light))
    left = np.abs(shown - light).mean()
    if left <= np.abs(shown).mean():
        return False
    products = ((shown - shown.mean(axis=0)) * (light - light.mean(axis=0))).mean(axis=0)
    scales = shown.std(axis=0) * light.std(axis=0)
    return bool(left > EVEN and (products <= UNLIKE * scales).all())


def _in_blocks(points_enu_m: Array) -> Array:
    """Points in the order of their longest direction."""
    if len(points_enu_m) < 2:
        return points_enu_m
    off = points_enu_m - points_enu_m.mean(axis=0)
    return np.asarray(points_enu_m[np.argsort(off @ np.linalg.eigh(off.T @ off)[1][:, -1], kind="stable")])


def _logarithms(source: PhotoSet, photo: PosedPhoto, points_enu_m: Array, caster: RayCaster | None) -> Array:
    """Of linear light that a photo shows of points, less its known gain's, shape (k, 3); NaN where it shows none."""
    found = np.full((len(points_enu_m), 3), np.nan)
    rows = np.flatnonzero(photo.sees(points_enu_m))
    if caster is not None and len(rows):
        towards = points_enu_m[rows] - photo.pose.position_enu_m
        distances = np.maximum(np.linalg.norm(towards, axis=1), 1e-9)
        origins = np.broadcast_to(photo.pose.position_enu_m, towards.shape)
        rows = rows[caster.cast(origins, towards / distances[:, None]).distance_m >= distances - NEARER_M]
    if not len(rows):
        return found
    lens = photo.intrinsics
    share = min(1.0, SMALL_PX / max(lens.width_px, lens.height_px))
    size = (max(1, round(share * lens.width_px)), max(1, round(share * lens.height_px)))
    display = cv2.resize(source.picture(photo), size, interpolation=cv2.INTER_AREA) / 255.0
    pixels = photo.pixels(points_enu_m[rows])
    x = np.clip((pixels[:, 0] * size[0] / lens.width_px).astype(np.int64), 0, size[0] - 1)
    y = np.clip((pixels[:, 1] * size[1] / lens.height_px).astype(np.int64), 0, size[1] - 1)
    if caster is None:
        distances = np.linalg.norm(points_enu_m[rows] - photo.pose.position_enu_m, axis=1)
        across, down = CELLS * x // max(size), CELLS * y // max(size)
        is_first = _is_in_front(across + CELLS * down, distances)
        rows, pixels, x, y = rows[is_first], pixels[is_first], x[is_first], y[is_first]
    values = display[y, x]
    is_told = ((values > DARKEST) & (values < BRIGHTEST)).all(axis=1)
    if photo.mask is not None:
        is_told &= cv2.resize(mask_of(photo).astype(np.float32), size, interpolation=cv2.INTER_AREA)[y, x] > WHOLE
    if source.has_panels:
        panels = source.panel_numbers(photo)
        across, down = pixels[:, 0].astype(np.int64), pixels[:, 1].astype(np.int64)
        is_told &= panels[np.clip(down, 0, lens.height_px - 1), np.clip(across, 0, lens.width_px - 1)] < 0
    linear = np.where(values > 0.04045, ((values + 0.055) / 1.055) ** 2.4, values / 12.92)
    known = source.own_exposures.get(photo.name, 1.0)
    found[rows[is_told]] = np.log(linear[is_told] / known)
    return found


def _is_in_front(cells: NDArray[np.int64], distances_m: Array) -> NDArray[np.bool_]:
    """Which points are about as near as the nearest in their cell of a photo: others may be hidden."""
    _, cells = np.unique(cells, return_inverse=True)
    nearest = np.full(cells.max() + 1, np.inf)
    np.minimum.at(nearest, cells, distances_m)
    return np.asarray(distances_m <= FRONT * nearest[cells] + NEARER_M)


def _gains(seen: Array) -> Array:
    """Logarithms of gains, shape (n, 3), of those of what was seen, shape (n, k, 3); their mean is 0."""
    gains = np.zeros((len(seen), 3))
    is_seen = ~np.isnan(seen[..., 0])
    columns = is_seen.sum(axis=0) >= 2
    seen, is_seen = seen[:, columns], is_seen[:, columns]
    rows = is_seen.sum(axis=1) >= LEAST_POINTS // 2
    if rows.sum() < 2:
        return gains
    for _ in range(ROUNDS):
        points = np.nanmedian(seen - gains[:, None], axis=0)
        gains[rows] = np.nanmedian(seen[rows] - points, axis=1)
        gains[rows] -= gains[rows].mean(axis=0)
    return gains
