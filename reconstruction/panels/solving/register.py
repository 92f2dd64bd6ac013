"""Photos of one facade brought onto one another, closer than their poses know.

What is brought together are the edges that run along the grid's lines, summed up along these lines cell by cell. Frames
run straight through a cell, mirror images break from pane to pane, so that the frames decide. Pictures laid on one
another as they are (phase correlation, enhanced correlation of gradients) follow the mirror image instead, which is
brighter and moves otherwise: they ended 3 to 53 px off where the poses were off by 4 to 22.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import SurfaceView, warp
from reconstruction.panels.search.edges import vertical_edges
from reconstruction.panels.search.views import CorrectedView, grey
from reconstruction.panels.solving.adjustment import UNKNOWN_POSE, moved_pose

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

CELLS = 6
"""Cells along each side of the window: a line turned by half a degree stays within 1.5 px in a sixth of 1000."""

BLURS_PX = (2.0, 1.0)
"""Standard deviations that the sums of edges are blurred by, first to find the place and then to measure it. Wider
ones would let mirror images in, which scatter by some pixels."""

MOST_REACH_PX = 120
"""Poses are searched so far at most: beyond it another panel is nearer."""

LEAST_REACH_PX = 6
"""Poses are searched so far at least: their covariances are sometimes better than they."""

LEFT_PX = (3.0, 1.5)
"""What is left after the pose was changed, at the edges of the picture, one standard deviation; found in two looks."""

N_DRAWS = 8192
"""Of poses in the first round, and an eighth of it in the others: some of them lie within 2 px where poses are off by
20."""

N_ROUNDS = 12
SHRINK = 0.6
"""Every round draws poses around the best so far, from a distribution so many times as wide as the last one."""

PRIOR_WEIGHT = 1.0 / 20.0
"""Correlation that half a squared standard deviation of the pose is worth: photos that lie right have 0.35 to 0.6. With
a third of it more photos ended on mirrored lines, with two and a half times as much more stayed where they were."""

STEPS = np.array([0.01] * 3 + [2e-4] * 3)
"""Of differences by the numbers of a pose, m and rad: they move the picture by a fraction of a pixel."""

LEAST_VARIANCE = 1e-12
"""m2 and rad2, added to what poses state: a covariance of zero has no inverse."""


@dataclass(frozen=True, slots=True, eq=False)
class Registered:
    """A photo on the first one.

    Parameters
    ----------
    view
        Of the same window as the first photo's.
    moved_px
        How far it was moved in the rectified picture, on average.
    agreement
        Mean correlation of its sums of edges with the first photo's, -1 to 1.
    """

    view: Rectification
    moved_px: float
    agreement: float


def registered(images: Sequence[Image], views: Sequence[SurfaceView], seed: int = 0) -> tuple[Registered, ...]:
    """All photos on the first, which stays where it is.

    A change of the pose takes out what is large; a homography of the rectified picture what is left, because the first
    photo's own pose and the surface are not quite right either.

    Parameters
    ----------
    images
        The photos, of the size that their intrinsics say.
    views
        Of the same window of one surface, one for each photo.
    """
    first = _sums(images[0], views[0])
    prior = _covariance(views[0].photo)
    found = [Registered(views[0], 0.0, 1.0)]
    for image, view in zip(images[1:], views[1:], strict=True):
        found.append(_onto(first, image, view, prior + _covariance(view.photo), np.random.default_rng(seed)))
    return tuple(found)


def _covariance(photo: PosedPhoto) -> Array:
    stated = UNKNOWN_POSE if photo.pose.covariance is None else photo.pose.covariance
    return np.asarray(stated + LEAST_VARIANCE * np.eye(6), float)


def _onto(first: _Sums, image: Image, view: SurfaceView, prior: Array, rng: np.random.Generator) -> Registered:
    design = _pose_design(view)
    change, agreement = _best_change(first, _sums(image, view), design, prior, rng)
    moved: Rectification = _moved(view, change)
    for sigma_px in LEFT_PX:
        design = _homography_design(view)
        change, agreement = _best_change(first, _sums(image, moved), design, sigma_px**2 * np.eye(8), rng)
        moved = CorrectedView(moved, _homography(change, view), view.width_px, view.height_px)
    points = _middles(view)
    off = np.linalg.norm(view.to_rectified(moved.to_photo(points)) - points, axis=1)
    return Registered(moved, float(np.nan_to_num(off).mean()), agreement)


def _best_change(
    first: _Sums, own: _Sums, design: Array, prior: Array, rng: np.random.Generator
) -> tuple[Array, float]:
    """The most probable change, shape (k,), and the correlation that it brings, of draws that close in on the best."""
    usual_px = float(np.sqrt(np.einsum("cai,ij,caj->ca", design, prior, design).mean()))
    reach = int(np.clip(3.0 * usual_px, LEAST_REACH_PX, MOST_REACH_PX))
    correlograms = [_correlograms(first, own, reach, blur) for blur in BLURS_PX]
    factor, information = np.linalg.cholesky(prior), np.linalg.inv(prior)
    best = np.zeros(len(prior))
    for turn in range(N_ROUNDS):
        n = N_DRAWS if turn == 0 else N_DRAWS // 8
        draws = np.vstack([best, best + SHRINK**turn * rng.standard_normal((n, len(prior))) @ factor.T])
        cost = 0.5 * PRIOR_WEIGHT * np.einsum("ni,ij,nj->n", draws, information, draws)
        gain = _correlation(correlograms[len(BLURS_PX) * turn // N_ROUNDS], design, draws) - cost
        best = draws[int(gain.argmax())]
    return best, float(_correlation(correlograms[-1], design, best[None])[0])


def _moved(view: SurfaceView, change: Array) -> SurfaceView:
    return replace(view, photo=replace(view.photo, pose=moved_pose(view.photo.pose, change)))


@dataclass(frozen=True, slots=True, eq=False)
class _Sums:
    """Edges of a rectified picture, summed up along the grid's lines within `CELLS` bands.

    `across` is of vertical edges, shape (CELLS, w), `down` of horizontal ones, shape (CELLS, h).
    """

    across: Array
    down: Array


def _sums(image: Image, view: Rectification) -> _Sums:
    picture, valid = warp(image, view)
    plain = grey(picture).astype(np.float32)
    vertical = vertical_edges(plain, valid).is_edge
    level = vertical_edges(np.ascontiguousarray(plain.T), valid.T.copy()).is_edge
    return _Sums(_banded(vertical), _banded(level))


def _banded(is_edge: NDArray[np.bool_]) -> Array:
    borders = np.linspace(0, is_edge.shape[0], CELLS + 1).astype(int)
    return np.stack([is_edge[a:b].sum(axis=0) for a, b in pairwise(borders)]).astype(float)


def _middles(view: Rectification) -> Array:
    """Middles of the cells, shape (CELLS**2, 2), bands of rows first."""
    x, y = ((np.arange(CELLS) + 0.5) / CELLS * side for side in (view.width_px, view.height_px))
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def _pose_design(view: SurfaceView) -> Array:
    """Movement of the middle of every cell by the six numbers of a pose, shape (CELLS**2, 2, 6)."""
    points = _middles(view)
    design = np.zeros((len(points), 2, 6))
    for i, step in enumerate(np.diag(STEPS)):
        ahead, behind = (view.to_rectified(_moved(view, sign * step).to_photo(points)) for sign in (1.0, -1.0))
        design[:, :, i] = (ahead - behind) / (2.0 * STEPS[i])
    return np.nan_to_num(design)


def _homography_design(view: Rectification) -> Array:
    """The same by the eight numbers of `_homography`, in pixels at the picture's edges, shape (CELLS**2, 2, 8)."""
    half = 0.5 * np.array([view.width_px, view.height_px])
    x, y = ((_middles(view) - half) / half).T
    zero, one = np.zeros_like(x), np.ones_like(x)
    lower, wider = half[1] / half[0], half[0] / half[1]
    columns = (
        [one, x, y, zero, zero, zero, x * x, wider * x * y],
        [zero, zero, zero, one, x, y, lower * x * y, y * y],
    )
    return np.stack([np.stack(axis, axis=1) for axis in columns], axis=1)


def _homography(change: Array, view: Rectification) -> Array:
    """The homography, shape (3, 3), that moves as `_homography_design` says, up to its squares."""
    half = 0.5 * np.array([view.width_px, view.height_px])
    (a, b, c, d, e, f), (g, h) = change[:6], -change[6:]
    inner = np.array(
        [
            [1.0 + b / half[0], c / half[0], a / half[0]],
            [e / half[1], 1.0 + f / half[1], d / half[1]],
            [g / half[0], h / half[1], 1.0],
        ]
    )
    normal = np.array([[1.0 / half[0], 0.0, -1.0], [0.0, 1.0 / half[1], -1.0], [0.0, 0.0, 1.0]])
    return np.asarray(np.linalg.inv(normal) @ inner @ normal, float)


def _correlograms(first: _Sums, own: _Sums, reach: int, blur_px: float) -> tuple[Array, Array]:
    """Correlation of every cell with its neighbourhood in the other picture, shape (CELLS**2, 2 reach + 1) each.

    Cells of both are in the order of `_middles`.
    """
    across = _of_bands(first.across, own.across, reach, blur_px)
    down = _of_bands(first.down, own.down, reach, blur_px)
    return across.reshape(CELLS * CELLS, -1), down.transpose(1, 0, 2).reshape(CELLS * CELLS, -1)


def _of_bands(first: Array, own: Array, reach: int, blur_px: float) -> Array:
    """Shape (bands, cells along a band, 2 reach + 1)."""
    smooth_first, smooth_own = (
        np.asarray(cv2.GaussianBlur(sums, (0, 0), sigmaX=blur_px, sigmaY=1e-3)) for sums in (first, own)
    )
    padded = np.pad(smooth_own, ((0, 0), (reach, reach)))
    borders = np.linspace(0, first.shape[1], CELLS + 1).astype(int)
    found = np.zeros((len(first), CELLS, 2 * reach + 1))
    for cell, (a, b) in enumerate(pairwise(borders)):
        template = smooth_first[:, a:b] - smooth_first[:, a:b].mean(axis=1, keepdims=True)
        windows = np.lib.stride_tricks.sliding_window_view(padded[:, a : b + 2 * reach], b - a, axis=1)
        centred = windows - windows.mean(axis=2, keepdims=True)
        norms = np.linalg.norm(centred, axis=2) * np.linalg.norm(template, axis=1)[:, None]
        products = np.einsum("bdx,bx->bd", centred, template)
        found[:, cell] = np.where(norms > 1e-9, products / np.maximum(norms, 1e-9), 0.0)
    return found


def _correlation(correlograms: tuple[Array, Array], design: Array, changes: Array) -> Array:
    """Mean over all cells and both directions, for changes of shape (n, 6), shape (n,)."""
    total = np.zeros(len(changes))
    for axis, of_cells in enumerate(correlograms):
        reach = of_cells.shape[1] // 2
        places = changes @ design[:, axis].T + reach
        inside = (places >= 0.0) & (places <= 2.0 * reach)
        low = np.clip(places.astype(int), 0, 2 * reach - 1)
        share = places - low
        cell = np.arange(len(of_cells))
        values = (1.0 - share) * of_cells[cell, low] + share * of_cells[cell, low + 1]
        total += np.where(inside, values, 0.0).mean(axis=1)
    return 0.5 * total
