"""The expected error of a model's pictures, from what its photos show: what a flight is worth, before it is flown.

A model of glass has to learn two things: the rooms and dirt behind and on each pane, and the surroundings that panes
mirror. Both are cut into elements: places on panes by direction of view, cells of the surroundings by direction of
the mirrored ray. The colour of element j is unknown with a variance v_j; photos that show it with a_j pixels, weighted
by the square of the share of light that comes from there, leave of it (Bayes' rule for a mean with normal noise, as
Fisher information of independent colours has it)

    v_j / (1 + a_j / p),

where p pixels halve the variance. Pictures of unseen views show elements with known weights, so the expected mean
square error is the sum over all elements, of several sizes each: coarse ones are learned from few photos, fine ones
need many. Less of that error is what photos are worth: monotone and submodular in the set of photos. Variances and p
were fitted on models of synthetic scenes (`tests.benchmarks`, `image-error`).

It is the trace of the posterior covariance (A-optimal design, K. Chaloner and I. Verdinelli, 1995) of independent
colours; FisherRF (W. Jiang et al., 2024) takes the Hessian of a field's own parameters after a first training.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix

from planning.coverage.mirrored_rays import MirroredRays, Surroundings
from planning.plan import Camera, ViewpointArrays

Array = NDArray[np.float64]

COLUMNS, ROWS = 16, 12
"""Pixels of each view through which rays go."""

FAR_M = 80.0
"""What is mirrored from further away has its place by direction alone."""


@dataclass(frozen=True, slots=True)
class Term:
    """Elements of one size, and how well they are known.

    Parameters
    ----------
    of
        `room`: what is seen through and on the pane, by place on it and direction of view. `surroundings`: what is
        mirrored, by its place. `image`: what is mirrored, by place on the pane and direction, wherever it stands.
        `tilt`: how a pane leans, by the pane.
    variance
        Of the colours of such elements before any photo, sRGB values 0 to 1 squared, times what they add to pictures.
    share
        Of a picture, which halves it.
    places
        Cells along each side of a pane.
    side_m
        Of a cell of the surroundings.
    directions
        Cells along each side of the picture of all directions; 0: direction does not matter.
    """

    of: Literal["room", "surroundings", "image", "tilt"]
    variance: float
    share: float
    places: int = 1
    side_m: float = 0.0
    directions: int = 0


TERMS: tuple[Term, ...] = (
    Term("room", 0.0035, 0.00025, places=5),
    Term("room", 0.0012, 0.00025, directions=8),
    Term("surroundings", 0.032, 0.00025, side_m=8.0),
    Term("surroundings", 0.0058, 0.25, side_m=8.0),
)
FLOOR = 0.0002
"""Fitted by non-negative least squares to errors of models of small sets of photos of the scene `planar`, among
elements of ten sizes; what is left out got no weight. `python -m tests.benchmarks --only image-error` fits anew."""


class Shown(NamedTuple):
    """How much n views show of each element: view i of `items[starts[i]:starts[i + 1]]` so much as `amounts` there.

    `starts` has shape (n + 1,), int64; items are int32, amounts float32, above 0, in what halves the variance.
    """

    starts: NDArray[np.int64]
    items: NDArray[np.int32]
    amounts: NDArray[np.float32]

    @classmethod
    def joined(cls, parts: Sequence[Shown]) -> Shown:
        """All views of several, in order."""
        ends = np.cumsum([0, *(part.starts[-1] for part in parts)])
        starts = [np.zeros(1, np.int64), *(part.starts[1:] + end for part, end in zip(parts, ends, strict=False))]
        items = np.concatenate([np.zeros(0, np.int32), *(part.items for part in parts)])
        amounts = np.concatenate([np.zeros(0, np.float32), *(part.amounts for part in parts)])
        return cls(np.concatenate(starts), items, amounts)


def octahedral_cells(directions: Array, n: int) -> NDArray[np.int64]:
    """Numbers 0 to n^2 - 1 of directions, shape (k, 3), in the square that an octahedron folds out to."""
    plain = directions[:, :2] / np.abs(directions).sum(axis=1, keepdims=True)
    signs = np.where(plain >= 0.0, 1.0, -1.0)
    folded = np.where(directions[:, 2:] < 0.0, (1.0 - np.abs(plain[:, ::-1])) * signs, plain)
    cells = np.clip(np.floor((folded + 1.0) * (0.5 * n)), 0, n - 1).astype(np.int64)
    return np.asarray(cells[:, 0] * n + cells[:, 1])


def element_keys(term: Term, rays: MirroredRays) -> NDArray[np.int64]:
    """Which element of a term each ray shows, as numbers that are equal where it is the same one, shape (k,)."""
    if term.of == "surroundings":
        places = _cells_of_surroundings(rays, term.side_m)
    elif term.of == "tilt":
        places = rays.panels
    else:
        cells = np.floor(rays.across * term.places).astype(np.int64)
        places = (rays.panels * term.places + cells[:, 0]) * term.places + cells[:, 1]
    if term.directions == 0:
        return places
    towards = -rays.incoming_enu if term.of == "room" else rays.mirrored_enu
    return places * term.directions**2 + octahedral_cells(towards, term.directions)


def _cells_of_surroundings(rays: MirroredRays, side_m: float) -> NDArray[np.int64]:
    is_near = rays.distances_m < FAR_M
    places = rays.points_enu_m + np.where(is_near, rays.distances_m, 0.0)[:, None] * rays.mirrored_enu
    # Bodies have round coordinates, and a face must not lie on the border of two cells.
    cells = np.floor(places / side_m + 1e-3).astype(np.int64) + (1 << 14)
    near = (cells[:, 0] << 30) + (cells[:, 1] << 15) + cells[:, 2]
    far = -1 - octahedral_cells(rays.mirrored_enu, max(2, round(2.0 * FAR_M / side_m)))
    return np.asarray(np.where(is_near, near, far))


def _looks(term: Term, rays: MirroredRays) -> Array:
    """Weight of each ray: the square of the share of light that comes from there, times that of how it changes.

    A pane whose normal n leans by s along an edge e mirrors d + 2 s ((d n) e + (d e) n) less what a flat one does, to
    first order: at a distance l the mirrored place moves by 2 s l sqrt((d n)^2 + (d e)^2). For the mean of both edges
    that is s l sqrt(2 (1 + (d n)^2)), and a colour that changes alike everywhere changes by as much. So the Fisher
    information of a tilt is that of colours times l^2 (1 + (d n)^2) / 2, here in parts of `FAR_M`; sky tells nothing.
    """
    if term.of == "room":
        return np.square(1.0 - rays.reflectances)
    if term.of != "tilt":
        return np.square(rays.reflectances)
    # Mirrored less incoming is 2 (d n) n.
    cosine2 = 0.25 * np.square(rays.mirrored_enu - rays.incoming_enu).sum(axis=1)
    lever = np.where(rays.distances_m < FAR_M, rays.distances_m / FAR_M, 0.0)
    return np.asarray(np.square(rays.reflectances * lever) * 0.5 * (1.0 + cosine2))


class ImageErrorModel:
    """What unseen views show, and what that makes of photos.

    Parameters
    ----------
    surroundings, camera
        The panes with what they mirror, and what takes the photos.
    terms
        Elements by kind and size.
    unseen
        Views that a model is to be looked at from, by kind; kinds weigh alike.
    floor
        Mean square error that no photo takes away.
    """

    def __init__(
        self,
        surroundings: Surroundings,
        camera: Camera,
        terms: Sequence[Term],
        unseen: Sequence[ViewpointArrays],
        floor: float = 0.0,
    ) -> None:
        self.surroundings, self.camera, self.terms, self.floor = surroundings, camera, tuple(terms), floor
        kinds = [rays for views in unseen if len(rays := self._rays(views))]
        self.near_share = float(np.mean([np.mean(rays.distances_m < FAR_M) for rays in kinds])) if kinds else 0.0
        """Of what unseen views show mirrored, the part that is nearer than `FAR_M`."""
        self._keys: list[NDArray[np.int64]] = []
        weights: list[Array] = [np.zeros(0)]
        for term in self.terms:
            keys = np.concatenate([np.zeros(0, np.int64), *(element_keys(term, rays) for rays in kinds)])
            looks = np.concatenate([np.zeros(0), *(_looks(term, rays) / (len(rays) * len(kinds)) for rays in kinds)])
            known, number = np.unique(keys, return_inverse=True)
            self._keys.append(known)
            weights.append(np.asarray(term.variance * np.bincount(number, looks, len(known)), np.float64))
        self.weights = np.concatenate(weights)
        self._known = np.ones(len(self.weights))

    @property
    def n_elements(self) -> int:
        """Of all terms."""
        return len(self.weights)

    @property
    def most_error(self) -> float:
        """Expected mean square error without any photo."""
        return self.floor + float(self.weights.sum())

    def after(self, views: ViewpointArrays) -> ImageErrorModel:
        """The same once there are photos from `views`: what further ones leave of what those left.

        v / (1 + s + a) = (v / (1 + s)) / (1 + a / (1 + s)), so that it is a model of the same kind.
        """
        shown = self.shown(views)
        more = 1.0 + np.bincount(shown.items, shown.amounts, self.n_elements)
        found = copy(self)
        found.weights, found._known = self.weights / more, self._known * more
        return found

    def shown(self, views: ViewpointArrays) -> Shown:
        """What photos show of the elements that unseen views show."""
        rays, first = self._rays(views), 0
        parts: list[tuple[NDArray[np.int64], NDArray[np.int64], Array]] = []
        for term, known in zip(self.terms, self._keys, strict=True):
            keys = element_keys(term, rays)
            place = np.minimum(np.searchsorted(known, keys), max(0, len(known) - 1))
            kept = np.flatnonzero(known[place] == keys) if len(known) else np.zeros(0, np.int64)
            items = first + place[kept]
            looks = np.asarray(_looks(term, rays)[kept] / (rays.n_pixels * term.share * self._known[items]), np.float64)
            parts.append((rays.views[kept], items, looks))
            first += len(known)
        rows, columns, amounts = (np.concatenate(column) for column in zip(*parts, strict=True))
        # Rays of one view that show the same element are added up.
        matrix = coo_matrix((amounts, (rows, columns)), shape=(rays.n_views, self.n_elements)).tocsr()
        return Shown(matrix.indptr.astype(np.int64), matrix.indices.astype(np.int32), matrix.data.astype(np.float32))

    def expected_error(self, views: ViewpointArrays) -> float:
        """Mean square error, sRGB values 0 to 1, of pictures of unseen views after photos from `views`."""
        shown = self.shown(views)
        return self.error_of(np.bincount(shown.items, shown.amounts, self.n_elements).astype(np.float64))

    def error_of(self, sums: Array) -> float:
        """The same of what photos show of each element together, shape (n_elements,)."""
        return self.floor + float((self.weights / (1.0 + sums)).sum())

    def errors_by_term(self, sums: Array) -> Array:
        """Parts of that error, without the floor, shape (n_terms,)."""
        ends = np.cumsum([len(keys) for keys in self._keys])[:-1]
        left = self.weights / (1.0 + sums)
        return np.array([float(part.sum()) for part in np.split(left, ends)])

    def _rays(self, views: ViewpointArrays) -> MirroredRays:
        return self.surroundings.rays(views, self.camera, COLUMNS, ROWS)


def decibels(error: float) -> float:
    """PSNR, dB, of a mean square error of values 0 to 1."""
    return float(-10.0 * np.log10(error))
