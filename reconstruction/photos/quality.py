"""Which photos are no use: blurred, badly exposed, taken twice, or broken; each with its number and its limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.jit import inline, kernel, n_threads
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.photos.decode import LARGE_PIXELS, Scale, grey_picture

# Compiled part of the sharpness measure: edge pixels of two smoothed pictures, and how blurred each is.

MARGIN = 4
"""Pixels at the borders that are left out, where smoothing knows no neighbours."""

CLIPPED = 3
"""Pixels around a clipped one where a slope says nothing."""

EDGE_DARK, EDGE_BRIGHT = 2, 253
"""Grey levels up to and from which a pixel is clipped."""

TANGENT = math.tan(math.pi / 8.0)

NO_STEP = 1e-3
"""Part by which the slope of a step must shrink at least; where it does not, the edge is as soft as can be told."""


@inline
def _slope2(smooth: Any, y: int, x: int) -> Any:
    """Square of the slope."""
    dx, dy = 0.5 * (smooth[y, x + 1] - smooth[y, x - 1]), 0.5 * (smooth[y + 1, x] - smooth[y - 1, x])
    return dx * dx + dy * dy


@kernel
def edge_blurs(
    grey: NDArray[np.uint8],
    narrow: NDArray[np.float32],
    wide: NDArray[np.float32],
    variances: tuple[float, float, float],
    least_slope: float,
    sigma: NDArray[np.float32],
    angle: NDArray[np.float32],
) -> int:
    """Fill `sigma` (px) and `angle` (rad) with the blur and the direction of the slope of edge pixels; their number.

    Parameters
    ----------
    grey, narrow, wide
        The picture, shape (h, w), and the same after the two Gaussians.
    variances
        Of both Gaussians, and of the central difference.
    """
    height, width = grey.shape
    n = 0
    for y in range(MARGIN, height - MARGIN):
        for x in range(MARGIN, width - MARGIN):
            dx, dy = 0.5 * (narrow[y, x + 1] - narrow[y, x - 1]), 0.5 * (narrow[y + 1, x] - narrow[y - 1, x])
            slope2 = dx * dx + dy * dy
            if slope2 < least_slope * least_slope:
                continue
            # The crest of the slope along its own direction, to the nearest of four.
            if abs(dy) <= TANGENT * abs(dx):
                step_x, step_y = 1, 0
            elif abs(dx) <= TANGENT * abs(dy):
                step_x, step_y = 0, 1
            elif dx * dy > 0.0:
                step_x, step_y = 1, 1
            else:
                step_x, step_y = 1, -1
            if slope2 <= _slope2(narrow, y - step_y, x - step_x) or slope2 < _slope2(narrow, y + step_y, x + step_x):
                continue
            is_clipped = False
            for v in range(y - CLIPPED, y + CLIPPED + 1):
                for u in range(x - CLIPPED, x + CLIPPED + 1):
                    is_clipped |= grey[v, u] <= EDGE_DARK or grey[v, u] >= EDGE_BRIGHT
            if is_clipped:
                continue
            ratio2 = max(slope2 / max(_slope2(wide, y, x), 1e-12), 1.0 + NO_STEP)
            found2 = (variances[1] - ratio2 * variances[0]) / (ratio2 - 1.0) - variances[2]
            sigma[n], angle[n] = math.sqrt(max(found2, 0.0)), math.atan2(dy, dx)
            n += 1
    return n


# How blurred a picture is, in pixels: the width of its sharpest edges, in each direction.
#
# A step edge blurred by sigma and then by a Gaussian of s has a slope proportional to 1 / sqrt(sigma^2 + s^2) at its
# middle, whatever its contrast. The ratio R of the slopes for two values of s gives the edge's own blur,
#
#     sigma^2 = (s2^2 - R^2 s1^2) / (R^2 - 1) - 1/3
#
# (after S. Zhuo and T. Sim, "Defocus map estimation from a single image", Pattern Recognition 44, 2011, Eq. 7, where
# s1 = 0; the third is what the central difference smooths, a box of two pixels). So the measure has a unit and does
# not
# depend on how much there is to see, unlike the variance of a Laplacian.
#
# Edges along a movement stay sharp: the measure is taken per direction, and the worst direction counts. A movement
# makes
# ramps, not Gaussian edges: on plain steps, movements of more than 5 px measure as more than their sigma.

NARROW, WIDE = 1.0, 2.0
"""s1 and s2, pixels: the first keeps noise down, the second is to differ well from it."""

N_DIRECTIONS = 4
"""Of edges: across 0, 45, 90 and 135 degrees."""

LEAST_EDGES = 60
"""Edge pixels that a direction must have to be judged: the median of so many is good to a sixth of their spread."""

QUANTILE = 0.5
"""Of the edges' blur in one direction: fine lines, which seem sharper than steps, and shadows, which are softer, even
out. On eleven real photos blurred by 2 px it gave 1.4 to 1.9, while the variance of their Laplacian differed 40-fold.
"""

DIFFERENCE = 1.0 / 3.0
"""Variance of the box that a central difference averages over, square pixels."""

LEAST_SLOPE = 4.0
"""Grey levels per pixel, after the narrow Gaussian; a step of 10 levels has that. Noise of 3 levels (high ISO) leaves
slopes of 0.6."""

N_TILES, TILE_PX = 4, 256
"""A grid of 4 x 4 tiles stands for a large picture: one megapixel of it, with thousands of edges."""

MOTION_TO_SIGMA = 1.0 / math.sqrt(12.0)
"""Standard deviation of a line's own length: blur by a movement as a sigma."""


@dataclass(frozen=True, slots=True)
class Sharpness:
    """Blur of a picture.

    Parameters
    ----------
    sigma_px
        Of the worst direction that has edges; None where there are too few edges to tell.
    direction_deg
        Across the edges it was measured on, from the picture's x axis towards y, in [0, 180).
    n_edges
        Edge pixels in all directions.
    """

    sigma_px: float | None
    direction_deg: float | None
    n_edges: int


def sharpness(grey: NDArray[np.uint8]) -> Sharpness:
    """Blur of a grey picture, shape (h, w)."""
    sigmas, angles = [], []
    for tile in _tiles(grey):
        sigma, angle = _edges(tile)
        sigmas.append(sigma)
        angles.append(angle)
    sigma, angle = np.concatenate(sigmas), np.concatenate(angles)
    bins = np.floor(np.remainder(angle / math.pi * N_DIRECTIONS + 0.5, N_DIRECTIONS)).astype(np.int64) % N_DIRECTIONS
    worst: tuple[float, int] | None = None
    for index in range(N_DIRECTIONS):
        own = sigma[bins == index]
        if len(own) >= LEAST_EDGES:
            found = float(np.quantile(own, QUANTILE))
            worst = (found, index) if worst is None or found > worst[0] else worst
    if worst is None:
        return Sharpness(None, None, len(sigma))
    return Sharpness(worst[0], worst[1] * 180.0 / N_DIRECTIONS, len(sigma))


def _tiles(grey: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    """The picture, or a grid of tiles spread over it where it is larger than these."""
    height, width = grey.shape
    if height * width <= (N_TILES * TILE_PX) ** 2:
        return [grey]
    tops = np.linspace(0, max(0, height - TILE_PX), N_TILES).astype(int).tolist()
    lefts = np.linspace(0, max(0, width - TILE_PX), N_TILES).astype(int).tolist()
    return [grey[y : y + TILE_PX, x : x + TILE_PX] for y in tops for x in lefts]


def _edges(tile: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Blur (px) and direction of the slope (rad) of edge pixels, each shape (n,)."""
    sigma, angle = np.empty(tile.size, np.float32), np.empty(tile.size, np.float32)
    if min(tile.shape) <= 2 * MARGIN:
        return sigma[:0], angle[:0]
    picture = tile.astype(np.float32)
    narrow, wide = (np.asarray(cv2.GaussianBlur(picture, (0, 0), s), np.float32) for s in (NARROW, WIDE))
    variances = NARROW**2, WIDE**2, DIFFERENCE
    n = edge_blurs(np.ascontiguousarray(tile), narrow, wide, variances, LEAST_SLOPE, sigma, angle)
    return sigma[:n].copy(), angle[:n].copy()


# Photos that are nearly the same: a fingerprint of the picture, and pairs that agree in it and in their poses.

Array = NDArray[np.float64]

SIDE_PX = 32
"""Size of the picture that the fingerprint is made of."""

KEPT = 8
"""Lowest frequencies along each side: 64 bits."""

LEAST_CONTRAST = 2.0
"""Standard deviation of the small picture, grey levels; below there is nothing to make a fingerprint of."""

NEAR_BITS = 10
"""Fingerprints of one view under small movements differ by fewer bits; those of unrelated pictures by 32 on average,
and by 10 or fewer once in 10^8 (binomial distribution)."""

SAME_BITS = 4
"""Where nothing is known of the poses: facades repeat themselves, and neighbouring views may look alike."""

NEAR_M, NEAR_DEG = 0.5, 2.0
"""Photos from places and in directions closer than this show reflections the same way: at 10 m distance, 0.5 m turn the
line of sight by 3 degrees, a tenth of a section."""

CHUNK = 512


def fingerprint(grey: NDArray[np.uint8]) -> int | None:
    """64 bits that stay nearly the same when a picture is scaled, brightened or moved a little; None without contrast.

    Signs of the lowest frequencies against their median (C. Zauner, "Implementation and benchmarking of perceptual
    image hash functions", 2010, section 3.2.1).
    """
    small = cv2.resize(grey, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA).astype(np.float32)
    if float(small.std()) < LEAST_CONTRAST:
        return None
    low = np.asarray(cv2.dct(small))[:KEPT, :KEPT].ravel()
    bits = low > np.median(low[1:])
    return int.from_bytes(np.packbits(bits).tobytes(), "big")


def like_pairs(fingerprints: list[int | None], poses: list[Pose] | None = None) -> list[tuple[int, int]]:
    """Pairs (i, j), i < j, of photos that show the same.

    With poses, from nearly the same place in nearly the same direction, and alike; without, all but equal.
    """
    known = np.array([index for index, print_ in enumerate(fingerprints) if print_ is not None], np.int64)
    prints = np.array([print_ for print_ in fingerprints if print_ is not None], np.uint64)
    pairs = _alike(prints, SAME_BITS) if poses is None else _near(prints, [poses[i] for i in known.tolist()])
    return [(int(known[i]), int(known[j])) for i, j in pairs]


def _near(prints: NDArray[np.uint64], poses: list[Pose]) -> list[tuple[int, int]]:
    from scipy.spatial import KDTree

    if len(poses) < 2:
        return []
    places = np.stack([pose.position_enu_m for pose in poses])
    rotations = np.stack([pose.cam_from_enu for pose in poses])
    pairs = KDTree(places).query_pairs(NEAR_M, output_type="ndarray")
    first, second = pairs[:, 0], pairs[:, 1]
    traces = np.einsum("kij,kij->k", rotations[first], rotations[second])
    is_near = traces >= 1.0 + 2.0 * np.cos(np.radians(NEAR_DEG))
    is_alike = np.bitwise_count(prints[first] ^ prints[second]) <= NEAR_BITS
    return [(int(i), int(j)) for i, j in sorted(map(tuple, pairs[is_near & is_alike].tolist()))]


def _alike(prints: NDArray[np.uint64], n_bits: int) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for start in range(0, len(prints), CHUNK):
        part = prints[start : start + CHUNK]
        near = np.bitwise_count(part[:, None] ^ prints[None, start:]) <= n_bits
        i, j = np.nonzero(np.triu(near, 1))
        found += zip((start + i).tolist(), (start + j).tolist(), strict=True)
    return found


REDUCED_SIGMA_PX = 0.4
"""What sharp photos measure at most when they are decoded at 1/2 to 1/8; less blur than that cannot be told there."""

DARK, BRIGHT = 3, 252
"""Grey levels up to and from which a pixel says nothing any more."""

WAITING_PER_THREAD = 4
"""Photos handed out ahead; only those at work are in memory."""


@dataclass(frozen=True, slots=True)
class QualityLimits:
    """From where on a photo is found wanting.

    Parameters
    ----------
    sigma_px
        Of blur. Sharp photos measure 0 to 0.8; at 1.5 a line one pixel wide is smeared over three and a half.
    clipped
        Part of the picture that is black, or white. The sky takes that much in good photos now and then; panels are
        small parts of a picture.
    scale
        At which photos are decoded. docs/concepts/photos.md has the verdicts that change with it.
    """

    sigma_px: float = 1.5
    clipped: float = 0.25
    scale: Scale = 1

    def __post_init__(self) -> None:
        if not self.sigma_px > 0.0 or not 0.0 < self.clipped <= 1.0 or self.scale not in (1, 2, 4, 8):
            raise ValueError(f"expected sigma_px above 0, clipped up to 1 and scale 1, 2, 4 or 8, got {self}")


DEFAULT_LIMITS = QualityLimits()


@dataclass(frozen=True, slots=True)
class PhotoQuality:
    """What was measured on one photo, in pixels of the full picture.

    Parameters
    ----------
    sigma_px
        Blur as measured; None where there are too few edges.
    motion_sigma_px
        Blur as speed, exposure time and distance predict it; None where one of them is not known.
    dark, bright
        Parts of the picture that are black, and white.
    fingerprint
        See `likeness`; None where there is no contrast.
    """

    sigma_px: float | None
    motion_sigma_px: float | None
    n_edges: int
    dark: float
    bright: float
    fingerprint: int | None

    @property
    def blur_px(self) -> float | None:
        """The measured blur, or where there is nothing to measure, the predicted one."""
        return self.motion_sigma_px if self.sigma_px is None else self.sigma_px


@dataclass(frozen=True, slots=True, eq=False)
class QualityReport:
    """Quality of photos in their order; None for those that could not be decoded.

    `alike` holds pairs of indices of photos that show the same.
    """

    photos: tuple[PhotoQuality | None, ...]
    alike: tuple[tuple[int, int], ...]
    findings: tuple[Finding, ...]


def check_quality(
    photos: Sequence[PhotoMetadata],
    posed: Sequence[PosedPhoto] | None = None,
    distances_m: Sequence[float | None] | None = None,
    limits: QualityLimits = DEFAULT_LIMITS,
    monitor: Monitor = QUIET,
) -> QualityReport:
    """Measure photos on all cores; what is wrong with one is a finding and never stops the others.

    Parameters
    ----------
    posed
        Of the same photos, where their poses are known.
    distances_m
        From each camera to what it shows; where absent, the range finder's.
    """
    n = len(photos)
    if (posed is not None and len(posed) != n) or (distances_m is not None and len(distances_m) != n):
        raise ValueError(f"expected poses and distances of all {n} photos")

    def measure(index: int) -> PhotoQuality | Finding:
        distance_m = None if distances_m is None else distances_m[index]
        try:
            camera = None if posed is None else posed[index]
            return photo_quality(photos[index], camera, distance_m, limits.scale)
        except InputError as error:
            return Finding(Severity.WARNING, "photo-unreadable", str(error), _name(photos[index]))

    found = _measured(photos, measure, monitor)
    kept = [result if isinstance(result, PhotoQuality) else None for result in found]
    findings = [result for result in found if isinstance(result, Finding)]
    alike = like_pairs(
        [None if result is None else result.fingerprint for result in kept],
        None if posed is None else [photo.pose for photo in posed],
    )
    for photo, result in zip(photos, kept, strict=True):
        if result is not None:
            findings += _findings(_name(photo), result, limits)
    for first, second in alike:
        text = say("shows the same as {}: from the same place, in the same direction", _name(photos[first]))
        if posed is None:
            text = say("looks like {}; nothing says where they were taken", _name(photos[first]))
        findings.append(Finding(Severity.NOTE, "photo-alike", text, _name(photos[second])))
    return QualityReport(tuple(kept), tuple(alike), tuple(findings))


def photo_quality(
    photo: PhotoMetadata, posed: PosedPhoto | None = None, distance_m: float | None = None, scale: Scale = 1
) -> PhotoQuality:
    """Measure one photo.

    Raises
    ------
    InputError
        It cannot be decoded.
    """
    grey = grey_picture(photo, scale)
    found = sharpness(grey)
    levels = cv2.calcHist([grey], [0], None, [256], [0.0, 256.0]).ravel() / grey.size
    distance_m = photo.range_m if distance_m is None else distance_m
    return PhotoQuality(
        sigma_px=_full_sigma_px(found, scale),
        motion_sigma_px=None if posed is None else motion_sigma_px(photo, posed, distance_m),
        n_edges=found.n_edges,
        dark=float(levels[: DARK + 1].sum()),
        bright=float(levels[BRIGHT:].sum()),
        fingerprint=fingerprint(grey),
    )


def motion_sigma_px(photo: PhotoMetadata, posed: PosedPhoto, distance_m: float | None) -> float | None:
    """Blur by the aircraft's movement across the line of sight while the shutter was open; None where not known.

    Whether DJI's vertical speed counts up or down is not told: the larger of both results is taken.
    """
    speeds = photo.speed_north_m_s, photo.speed_east_m_s, photo.speed_vertical_m_s
    if photo.exposure_s is None or not distance_m or any(speed is None for speed in speeds):
        return None
    north, east, vertical = (float(speed or 0.0) for speed in speeds)
    forward = posed.pose.forward_enu
    across = []
    for up in (vertical, -vertical):
        velocity = np.array([east, north, up])
        across.append(float(np.linalg.norm(velocity - (velocity @ forward) * forward)))
    return max(across) * photo.exposure_s / distance_m * posed.intrinsics.fx_px * MOTION_TO_SIGMA


def _full_sigma_px(found: Sharpness, scale: Scale) -> float | None:
    """Blur in pixels of the full picture."""
    if found.sigma_px is None or scale == 1:
        return found.sigma_px
    return scale * math.sqrt(max(0.0, found.sigma_px**2 - REDUCED_SIGMA_PX**2))


def _measured(
    photos: Sequence[PhotoMetadata], measure: Callable[[int], PhotoQuality | Finding], monitor: Monitor
) -> list[PhotoQuality | Finding]:
    """Results in order. Large pictures come last and one at a time, so that memory stays bounded."""
    results: dict[int, PhotoQuality | Finding] = {}
    large = [i for i, photo in enumerate(photos) if photo.width_px * photo.height_px > LARGE_PIXELS]
    is_large = set(large)
    todo = iter([i for i in range(len(photos)) if i not in is_large])
    threads = n_threads()
    monitor.report(say("checking photos"), 0, len(photos))
    with ThreadPoolExecutor(threads) as pool:
        running: dict[Future[PhotoQuality | Finding], int] = {}
        try:
            while True:
                for index in todo:
                    running[pool.submit(measure, index)] = index
                    if len(running) >= threads * WAITING_PER_THREAD:
                        break
                if not running:
                    break
                for done in wait(running, return_when=FIRST_COMPLETED).done:
                    results[running.pop(done)] = done.result()
                monitor.report(say("checking photos"), len(results), len(photos))
        except BaseException:
            for future in running:
                future.cancel()
            raise
    for index in large:
        results[index] = measure(index)
        monitor.report(say("checking photos"), len(results), len(photos))
    return [results[index] for index in range(len(photos))]


def _findings(name: str, quality: PhotoQuality, limits: QualityLimits) -> list[Finding]:
    findings = []
    blur = quality.blur_px
    if blur is not None and blur > limits.sigma_px:
        why = say("measured on its edges")
        if quality.sigma_px is None:
            why = say("by speed, exposure and distance; there are too few edges to measure it")
        text = say("is blurred by {:.1f} px ({}), more than {:g} px; take it again, slower", blur, why, limits.sigma_px)
        findings.append(Finding(Severity.WARNING, "photo-blurred", text, name, blur, limits.sigma_px, "px"))
    for what, part, code, advice in (
        ("black", quality.dark, "photo-dark", "longer"),
        ("white", quality.bright, "photo-bright", "shorter"),
    ):
        if part > limits.clipped:
            text = say(
                "{:.0f} % of the picture are {}, more than {:.0f} %; expose {}",
                100.0 * part,
                what,
                100.0 * limits.clipped,
                advice,
            )
            findings.append(Finding(Severity.WARNING, code, text, name, part, limits.clipped))
    if quality.sigma_px is None and max(quality.dark, quality.bright) <= limits.clipped:
        text = say("shows too few edges ({}) to tell whether it is sharp", quality.n_edges)
        findings.append(Finding(Severity.NOTE, "photo-without-edges", text, name, float(quality.n_edges)))
    return findings


def _name(photo: PhotoMetadata) -> str:
    return str(photo.path)
