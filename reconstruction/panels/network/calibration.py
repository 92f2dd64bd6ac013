"""How the regressions of `confidence` are fitted: to panes that the network finds in pictures whose panes are known."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.json_file import write_atomically
from reconstruction.panels.network.confidence import (
    FIRST,
    SECOND,
    THIRD,
    Candidates,
    Joined,
    Regression,
    candidates_of,
    first_features,
    second_features,
    third_features,
)
from reconstruction.panels.network.network import PaneNetwork, network
from reconstruction.panels.network.predictions import LONG_SIDES_PX, PhotoPrediction, predict_photo
from reconstruction.panels.network.votes import Picture

Array = NDArray[np.float64]
Index = NDArray[np.uint16]

THERE_IOU = 0.5
"""Intersection over union with a true pane above which a found one is there."""

RIDGE = 1e-3
"""Penalty on weights of features of unit variance."""


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """Pictures that a network looks at to learn how often it is right.

    Parameters
    ----------
    pictures
        With their panes' numbers, shapes (h, w, 3) and (h, w).
    weight
        How much they count together.
    networks
        Picture i is looked at by the (i modulo their number)-th; none: by the network that comes with the program. On
        pictures that it has learned from a network is right too often.
    """

    pictures: Iterable[tuple[Picture, Index]]
    weight: float
    networks: Sequence[PaneNetwork] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _PictureCandidates:
    """Candidates of one picture, what the first regression weighs, and whether they are there."""

    predictions: PhotoPrediction
    candidates: Candidates
    features: Array
    index: Index
    is_there: NDArray[np.bool_]

    def joined(self, first: Regression) -> Joined:
        """Those that the first regression keeps."""
        return self.candidates.joined(first.probability(self.features), self.features)

    def are_there(self, found: Joined) -> NDArray[np.bool_]:
        """Whether panes are, shape (n,)."""
        return are_there([pane.corners_px for pane in found.panes], self.index)


def calibrated(sources: Sequence[Source], tell: Callable[[str], None]) -> tuple[Regression, Regression]:
    """Fit the first two regressions, the second to what the first one keeps."""
    seen, weights = _seen(sources, tell), [source.weight for source in sources]
    first = _fitted([[(one.features, one.is_there) for one in part] for part in seen], weights)
    joined = [[(one.joined(first), one) for one in part] for part in seen]
    second = _fitted(
        [[(second_features(found), one.are_there(found)) for found, one in part] for part in joined], weights
    )
    return first, second


def calibrated_last(
    sources: Sequence[Source], first: Regression, second: Regression, tell: Callable[[str], None]
) -> Regression:
    """Fit the third regression, to what the first one keeps and the second one says of it."""
    joined = [[(one.joined(first), one) for one in part] for part in _seen(sources, tell)]
    return _fitted(
        [
            [
                (third_features(found, second.log_odds(second_features(found)), one.predictions), one.are_there(found))
                for found, one in part
            ]
            for part in joined
        ],
        [source.weight for source in sources],
    )


def _seen(sources: Sequence[Source], tell: Callable[[str], None]) -> list[list[_PictureCandidates]]:
    seen = []
    for number, source in enumerate(sources):
        looking = cycle(source.networks or [network()])
        seen.append([_picture_candidates(*picture, by) for picture, by in zip(source.pictures, looking, strict=False)])
        tell(f"source {number}: {sum(len(one.is_there) for one in seen[-1])} candidates")
    return seen


def _picture_candidates(image: Picture, index: Index, by: PaneNetwork) -> _PictureCandidates:
    predictions = predict_photo(image, LONG_SIDES_PX[-1], by=by)
    candidates = candidates_of(predictions)
    is_there = are_there(list(candidates.quads), index)
    return _PictureCandidates(predictions, candidates, first_features(candidates), index, is_there)


def are_there(quads: Sequence[Array], index: Index) -> NDArray[np.bool_]:
    """Whether each quadrilateral, shape (4, 2), covers a pane of the index image by more than half, shape (n,)."""
    height, width = index.shape
    areas = np.bincount(index.ravel())
    found = np.zeros(len(quads), bool)
    for i, quad in enumerate(quads):
        low = np.floor(np.clip(quad.min(axis=0), 0, [width, height])).astype(int)
        high = np.ceil(np.clip(quad.max(axis=0), 0, [width, height])).astype(int)
        if (high <= low).any():
            continue
        painted = np.zeros(tuple(high[::-1] - low[::-1]), np.uint8)
        cv2.fillPoly(painted, [np.rint((quad - low - 0.5) * 16.0).astype(np.int32)], 1, shift=4)
        joint = np.bincount(index[low[1] : high[1], low[0] : high[0]][painted > 0], minlength=len(areas))
        union = areas + painted.sum() - joint
        found[i] = bool((joint[1:] > THERE_IOU * union[1:]).any())
    return found


def _fitted(parts: Sequence[Sequence[tuple[Array, NDArray[np.bool_]]]], weights: Sequence[float]) -> Regression:
    """Most probable weights, by Newton's method; the panes of each source count as much as it does, together."""
    features = np.concatenate([each for part in parts for each, _ in part])
    is_there = np.concatenate([there for part in parts for _, there in part]).astype(float)
    counts = [sum(len(there) for _, there in part) for part in parts]
    weight = np.concatenate([np.full(n, share / max(n, 1)) for n, share in zip(counts, weights, strict=True)]) / sum(
        weights
    )
    middle, spread = features.mean(axis=0), features.std(axis=0) + 1e-9
    x = np.column_stack([(features - middle) / spread, np.ones(len(features))])
    ridge = RIDGE * np.diag([*np.ones(x.shape[1] - 1), 0.0])
    coefficients = np.zeros(x.shape[1])
    for _ in range(50):
        probability = 1.0 / (1.0 + np.exp(-np.clip(x @ coefficients, -30.0, 30.0)))
        slope = x.T @ (weight * (probability - is_there)) + ridge @ coefficients
        curve = (x * (weight * probability * (1.0 - probability))[:, None]).T @ x + ridge
        step = np.linalg.solve(curve, slope)
        coefficients -= step
        if np.abs(step).max() < 1e-6:
            break
    scaled = coefficients[:-1] / spread
    return Regression(scaled, float(coefficients[-1] - scaled @ middle))


def write_regressions(regressions: tuple[Regression, Regression, Regression], path: Path) -> None:
    """Write them as JSON, weights by the names of features."""
    stored: dict[str, Any] = {
        part: {
            "bias": round(one.bias, 5),
            "weights": {name: round(float(value), 5) for name, value in zip(names, one.weight, strict=True)},
        }
        for part, names, one in zip(("first", "second", "third"), (FIRST, SECOND, THIRD), regressions, strict=True)
    }
    write_atomically(path, (json.dumps(stored, indent=1) + "\n").encode())
