"""How probably panes are there: by what all sizes of a photo say of each, and by what stands beside it.

Three logistic regressions are fitted to real and synthetic photos (`calibration`). The first weighs what the places
say, in the size in which the pane was found and in the others: of candidates that cover one another the most probable
one stays, its corners the mean of those that name the same pane. The second weighs the neighbours as well: panes of a
facade have equals beside, above and below them. The third weighs what speaks against a pane: an opening without glass
looks like one where it is seen small; two casements look like one window, and one like two, so that candidates in its
place are as probable; and where glass goes on beyond it, it is a part of something. It gives a probability: of panes
found with 0.9, nine in ten are there.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import resources
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.panels.network.predictions import FoundPanes, PhotoPrediction, SizePrediction
from reconstruction.panels.network.votes import STRIDE, Pane, inside, seen_area, signed_areas, weighted_median

Array = NDArray[np.float64]

COEFFICIENTS = "confidence.json"

LEAST_BELIEVED = 0.5
"""Confidence from which a pane is reported: on real photos up to a fifth of these are not there, but on ECP's."""

LEAST_CANDIDATE = 0.12
"""Probability by the first regression from which a pane is looked at together with its neighbours."""

SAME = 0.45
"""Intersection over union from which on two panes are the same one."""

MEASURES = 0.6
"""And from which on the one helps to measure the other's corners,"""

LEAST_MEASURES = 0.3
"""if it is at least so probable, as a share of the other."""

OVERLAP = 0.3
"""Of two panes that share more of the smaller one's area one is wrong."""

ALIKE = 0.12
"""Panes whose corners lie so far from one another, moved to one middle, as a share of their side, are hardly alike."""

BESIDE = 8.0
"""Panes within so many of a pane's sides are its neighbours."""

INTO, OUT_PX = (0.75, 0.45, 0.15), 4.0
"""Where places inside a pane are asked, as shares of the way to its outline, and how far outside it, in a look."""

LARGER = 1.4, 12.0
"""A pane is looked at again where it is seen so many times as large as where it was found, from and up to."""

DOUBTED = 0.65
"""Probability of the places on it, there, below which it is doubted. Chosen with all photos of glass, offices and
windows in walls (CMP) in view."""

RIVAL = 0.5
"""Candidates that cover a pane and whose intersection over union with it is smaller are another pane in its place."""

GROWN = 0.05
"""A pane takes in what lies beside it by so much of the way from its middle: frames."""

IN_WALLS, WALL = 1.6, 0.3
"""What log odds lose where panes are windows in walls, unlike most that confidences were fitted to; the probability of
places just outside of a photo's panes below which walls are beside them: on glass 0.28 and more, in walls up to 0.26.

Chosen by every second photo of CMP, which asks for more, and by offices not learned from, which ask for less."""

FIRST = (
    "share", "scatter", "log side", "log aspect", "seen", "inside", "around", "agrees", "agreeing", "in larger",
    "smaller in it", "skew", "sigma",
)  # fmt: skip
"""What the first regression weighs; `first_features` says what they are."""

SECOND = (
    "log odds", "alike", "alike in row", "alike in column", "log size", "odd size", "neighbours",
    *(FIRST[i] for i in (0, 1, 3, 4, 5, 6, 7, 8, 9, 10)),
)  # fmt: skip
"""What the second one weighs: log odds of the first, neighbours, and again what that saw."""

THIRD = ("log odds", "doubt", "rival", "beyond")
"""What the third one weighs: log odds of the second; see `third_features`."""

SEEN_AGAIN = [FIRST.index(name) for name in SECOND[7:]]


@dataclass(frozen=True, slots=True, eq=False)
class Regression:
    """A logistic regression: weight of each feature, and the log odds where all are 0."""

    weight: Array
    bias: float

    def log_odds(self, features: Array) -> Array:
        """Of panes with these features, shape (n, k)."""
        return np.asarray(features @ self.weight + self.bias)

    def probability(self, features: Array) -> Array:
        """Of panes with these features, shape (n, k)."""
        return _probability(self.log_odds(features))


def _probability(log_odds: Array) -> Array:
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(log_odds, -30.0, 30.0))))


@cache
def regressions() -> tuple[Regression, Regression, Regression]:
    """The three that come with the program."""
    stored: dict[str, Any] = json.loads((resources.files(__package__) / "data" / COEFFICIENTS).read_text("utf-8"))
    first, second, third = (
        Regression(np.array([stored[part]["weights"][name] for name in names]), float(stored[part]["bias"]))
        for part, names in (("first", FIRST), ("second", SECOND), ("third", THIRD))
    )
    return first, second, third


def find_panes(predictions: PhotoPrediction, monitor: Monitor = QUIET) -> FoundPanes:
    """Panes of a photo, the most probable first, whatever little probability they have."""
    monitor.report(say("look for panes"), len(predictions.by_size), len(predictions.by_size))
    candidates = candidates_of(predictions)
    first, second, third = regressions()
    features = first_features(candidates)
    joined = candidates.joined(first.probability(features), features)
    odds = second.log_odds(second_features(joined))
    odds = third.log_odds(third_features(joined, odds, predictions)) - IN_WALLS * share_of_wall(joined)
    probabilities = _probability(odds)
    order = np.argsort(-probabilities)
    panes = tuple(replace(joined.panes[i], confidence=float(probabilities[i])) for i in order)
    return FoundPanes(panes, predictions)


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Panes of all sizes of a photo.

    Parameters
    ----------
    predictions
        The one that each was found in.
    quads
        Their corners, shape (n, 4, 2).
    shared
        Areas that they share, shape (n, n), px²; 0 on the diagonal.
    areas
        Their areas, shape (n,).
    """

    panes: Sequence[Pane]
    predictions: Sequence[SizePrediction]
    quads: Array = field(init=False)
    shared: Array = field(init=False)
    areas: Array = field(init=False)

    def __post_init__(self) -> None:
        quads = np.array([pane.corners_px for pane in self.panes], float).reshape(-1, 4, 2)
        object.__setattr__(self, "quads", quads)
        object.__setattr__(self, "shared", _shared(quads))
        object.__setattr__(self, "areas", np.maximum(signed_areas(quads), 1e-6))

    @property
    def iou(self) -> Array:
        """Intersections over union, shape (n, n), 0 on the diagonal."""
        return np.asarray(self.shared / (self.areas[:, None] + self.areas[None] - self.shared))

    def joined(self, probability: Array, features: Array) -> Joined:
        """Of those that cover one another the most probable, measured by all that name the same pane."""
        iou = self.iou
        conflicts = (iou > SAME) | (self.shared > OVERLAP * np.minimum(self.areas[:, None], self.areas[None]))
        chosen: list[int] = []
        for i in np.argsort(-probability):
            if probability[i] < LEAST_CANDIDATE:
                break
            if not conflicts[i, chosen].any():
                chosen.append(int(i))
        sigma = np.array([pane.sigma_px for pane in self.panes])
        panes = []
        for i in chosen:
            same = np.nonzero((iou[i] > MEASURES) & (probability > LEAST_MEASURES * probability[i]))[0]
            same = np.append(same, i)
            weight = (probability[same] / sigma[same]) ** 2
            corners = np.einsum("n,nij->ij", weight / weight.sum(), self.quads[same])
            panes.append(replace(self.panes[i], corners_px=corners))
        others = np.where(conflicts & (iou < RIVAL), probability, 0.0)
        rivals = others[chosen].max(axis=1, initial=0.0)
        return Joined(panes, probability[chosen], features[chosen], [self.predictions[i] for i in chosen], rivals)


@dataclass(frozen=True, slots=True, eq=False)
class Joined:
    """Panes that do not cover one another.

    Parameters
    ----------
    probability, features
        What the first regression gives each, shape (n,), and what it weighed, (n, 13).
    predictions
        The one that each was found in.
    rivals
        Probability of the most probable candidate that is another pane in its place, shape (n,).
    """

    panes: Sequence[Pane]
    probability: Array
    features: Array
    predictions: Sequence[SizePrediction]
    rivals: Array


def candidates_of(predictions: PhotoPrediction) -> Candidates:
    """All panes that places of any size agree on."""
    every = [(pane, look) for look in predictions.by_size.values() for pane in look.panes()]
    return Candidates([pane for pane, _ in every], [look for _, look in every])


def _shared(quads: Array) -> Array:
    """Areas that convex quadrilaterals share, shape (n, n), 0 on the diagonal."""
    single = quads.astype(np.float32)
    shared = np.zeros((len(quads), len(quads)))
    for i, j in _near(quads):
        shared[i, j] = shared[j, i] = cv2.intersectConvexConvex(single[i], single[j])[0]
    return shared


def _near(quads: Array) -> NDArray[np.intp]:
    """Pairs whose bounding boxes touch, shape (m, 2)."""
    low, high = quads.min(axis=1), quads.max(axis=1)
    touch = np.triu((low[:, None] < high[None]).all(axis=2) & (high[:, None] > low[None]).all(axis=2), 1)
    return np.argwhere(touch)


# What the regressions weigh.


def first_features(candidates: Candidates) -> Array:
    """Of each candidate, shape (n, 13), as `FIRST` names them.

    Share, scatter and sigma are the pane's; side (in its look), aspect and skew its shape's; seen is the share of it
    within the photo; inside and around are probabilities of places. Agrees and agreeing compare with panes of other
    sizes: the surest that is nearly the same, and all of them. Then the surest much larger pane that it lies on, and
    the smaller ones on it.
    """
    n = len(candidates.panes)
    if n == 0:
        return np.zeros((0, len(FIRST)))
    quads, areas, shared = candidates.quads, candidates.areas, candidates.shared
    sides = np.linalg.norm(np.roll(quads, -1, axis=1) - quads, axis=2)
    wide, high = (
        np.maximum(0.5 * (sides[:, 0] + sides[:, 2]), 1e-3),
        np.maximum(0.5 * (sides[:, 1] + sides[:, 3]), 1e-3),
    )
    skew = np.abs(sides[:, 0] - sides[:, 2]) / wide + np.abs(sides[:, 1] - sides[:, 3]) / high
    share, scatter, sigma = (
        np.array([getattr(pane, name) for pane in candidates.panes]) for name in ("share", "scatter", "sigma_px")
    )
    trust = share * np.exp(-4.0 * scatter)
    scale = np.array([look.scale for look in candidates.predictions])
    elsewhere = candidates.iou * (scale[:, None] != scale[None])
    covered = shared / areas[None]  # share of j that lies on i
    on_larger = (areas[None] > 2.0 * areas[:, None]) & (shared > 0.6 * areas[:, None])
    smaller = (2.0 * areas[None] < areas[:, None]) & (covered > 0.6)
    seen = [
        seen_area(quad * look.scale, look.size_px) / (area * look.scale**2)
        for quad, look, area in zip(quads, candidates.predictions, areas, strict=True)
    ]
    within, around = _places(candidates)
    return np.column_stack(
        [
            share,
            scatter,
            np.log(np.sqrt(areas) * scale),
            np.log(wide / high),
            seen,
            within,
            around,
            (elsewhere * trust).max(axis=1),
            ((elsewhere > 0.5) * trust).sum(axis=1),
            (on_larger * trust).max(axis=1),
            np.minimum((smaller * trust * areas[None] / areas[:, None]).sum(axis=1), 2.0),
            np.minimum(skew, 2.0),
            sigma / np.sqrt(areas),
        ]
    )


def _places(candidates: Candidates) -> tuple[Array, Array]:
    """Mean probability of places inside and just outside of each candidate, in its look; 0.5 where none is seen."""
    within, around = np.full(len(candidates.panes), 0.5), np.full(len(candidates.panes), 0.5)
    for i, (quad, look) in enumerate(zip(candidates.quads, candidates.predictions, strict=True)):
        within[i] = _inside(quad, look)
        around[i] = _mean_at(look.probability, _just_outside(quad, look))
    return within, around


ALONG = np.linspace(0.0, 1.0, 8)[:-1]
"""Where a side is sampled, as shares of it."""


def _outline(quad: Array, look: SizePrediction) -> tuple[Array, Array]:
    """The middle of a quadrilateral in a look's places, shape (2,), and the way from there to its outline, (28, 2)."""
    corners = quad * look.scale / STRIDE
    towards = np.roll(corners, -1, axis=0) - corners
    middle = corners.mean(axis=0)
    return middle, (corners[:, None] + ALONG[:, None] * towards[:, None]).reshape(-1, 2) - middle


def _just_outside(quad: Array, look: SizePrediction) -> Array:
    """Points around a quadrilateral in a look's places, shape (28, 2)."""
    middle, outline = _outline(quad, look)
    distance = np.maximum(np.linalg.norm(outline, axis=1, keepdims=True), 1e-6)
    return np.asarray(middle + outline * (1.0 + OUT_PX / STRIDE / distance))


def _inside(quad: Array, look: SizePrediction) -> float:
    """Mean probability of places inside a quadrilateral in a look; 0.5 where it shows too few."""
    middle, outline = _outline(quad, look)
    return _mean_at(look.probability, np.concatenate([middle + share * outline for share in INTO]))


def seen_larger(joined: Joined, predictions: PhotoPrediction) -> Array:
    """Mean probability of places on each pane where it is seen larger than where it was found, shape (n,); else 1."""
    least, most = LARGER
    seen = np.ones(len(joined.panes))
    for i, (pane, own) in enumerate(zip(joined.panes, joined.predictions, strict=True)):
        looks = [each for each in predictions.by_size.values() if least < each.scale / own.scale < most]
        if looks:
            seen[i] = np.mean([_inside(pane.corners_px, look) for look in looks])
    return seen


@kernel
def _mean_at(values: NDArray[np.float32], points: Array) -> float:
    """Mean of the values, shape (h, w), at those points (x, y), shape (n, 2), that lie within; 0.5 for fewer than 3."""
    total, n = 0.0, 0
    for i in range(len(points)):
        x, y = points[i]
        if 0.0 <= x < values.shape[1] and 0.0 <= y < values.shape[0]:
            total += values[int(y), int(x)]
            n += 1
    return total / n if n >= 3 else 0.5


def second_features(joined: Joined) -> Array:
    """Of each pane, shape (n, 17), as `SECOND` names them.

    Neighbours count by their probability: all that are alike, those in the same row, and in the same column, as the
    pane's own sides run. Then the log of its size over the usual one of the photo, that without its sign, and how
    probable its neighbours are.
    """
    n = len(joined.panes)
    if n == 0:
        return np.zeros((0, len(SECOND)))
    probability = joined.probability
    quads = np.array([pane.corners_px for pane in joined.panes])
    side = np.sqrt(np.maximum(signed_areas(quads), 1.0))
    middles = quads.mean(axis=1)
    shapes = quads - middles[:, None]
    level, upright = (
        quads[:, 1] - quads[:, 0] + quads[:, 2] - quads[:, 3],
        quads[:, 0] - quads[:, 3] + quads[:, 1] - quads[:, 2],
    )
    wide, high = (0.5 * np.linalg.norm(each, axis=1) for each in (level, upright))
    apart = middles[None] - middles[:, None]
    distance = np.abs(apart).max(axis=2) / side[:, None]
    near = distance < BESIDE
    unlike = np.abs(shapes[None] - shapes[:, None]).mean(axis=(2, 3)) / (ALIKE * side[:, None])
    alike = np.exp(-(unlike**2)) * probability * near
    np.fill_diagonal(alike, 0.0)
    allowed = 0.2 + 0.03 * distance
    in_row = np.abs(_cross(level, apart)) / (2.0 * wide * high)[:, None] < allowed
    in_column = np.abs(_cross(upright, apart)) / (2.0 * wide * high)[:, None] < allowed
    size = np.log(side) - np.log(weighted_median(side, probability * side))
    odds = np.log(np.maximum(probability, 1e-6) / np.maximum(1.0 - probability, 1e-6))
    return np.column_stack(
        [
            odds,
            *(np.log1p((alike * chosen).sum(axis=1)) for chosen in (near, in_row, in_column)),
            size,
            np.abs(size),
            (near * probability).sum(axis=1) / near.sum(axis=1),
            joined.features[:, SEEN_AGAIN],
        ]
    )


def _cross(along: Array, apart: Array) -> Array:
    """Cross products of directions, shape (n, 2), with where others lie from there, shape (n, n, 2)."""
    return np.asarray(along[:, None, 0] * apart[..., 1] - along[:, None, 1] * apart[..., 0])


def third_features(joined: Joined, log_odds: Array, predictions: PhotoPrediction) -> Array:
    """Of each pane, shape (n, 4), as `THIRD` names them.

    Parameters
    ----------
    log_odds
        By the second regression, shape (n,).
    """
    doubt = np.maximum(0.0, DOUBTED - seen_larger(joined, predictions))
    return np.column_stack([log_odds, doubt, joined.rivals, glass_beyond(joined)])


def share_of_wall(joined: Joined) -> float:
    """How far the panes of a photo stand in a wall, 0 to 1: 0 where glass is beside glass."""
    if not len(joined.panes):
        return 0.0
    around = joined.features[:, FIRST.index("around")]
    return float(np.maximum(0.0, 1.0 - np.average(around, weights=joined.probability**2) / WALL))


def glass_beyond(joined: Joined) -> Array:
    """Mean probability of places just outside each pane that no other pane explains, shape (n,); 0 where none is seen.

    A place on another pane counts by how improbable that one is.
    """
    quads = np.array([pane.corners_px for pane in joined.panes]).reshape(-1, 4, 2)
    middles = quads.mean(axis=1, keepdims=True)
    grown = middles + (1.0 + GROWN) * (quads - middles)
    low, high = grown.min(axis=1), grown.max(axis=1)
    beyond = np.zeros(len(quads))
    for i, (quad, look) in enumerate(zip(quads, joined.predictions, strict=True)):
        places = _just_outside(quad, look)
        seen = (places >= 0.0).all(axis=1) & (places < look.probability.shape[::-1]).all(axis=1)
        if not seen.any():
            continue
        column, row = places[seen].astype(int).T
        points = places[seen] * STRIDE / look.scale
        free = np.ones(len(points))
        touching = (low < points.max(axis=0)).all(axis=1) & (high > points.min(axis=0)).all(axis=1)
        for k in np.flatnonzero(touching):
            if k != i:
                free[inside(grown[k], points)] *= 1.0 - joined.probability[k]
        beyond[i] = float((look.probability[row, column] * free).mean())
    return beyond
