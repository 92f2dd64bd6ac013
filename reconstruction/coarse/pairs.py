"""Which photos are matched with which: near in space, taken one after the other, or alike; not all with all.

Matching costs the square of the number of photos, and nearly all pairs of a flight around a building show nothing in
common. Three things tell which do, and each is enough by itself: GPS, the clock, and what is in the pictures. Likeness
is that of VLAD descriptors (H. Jegou et al., "Aggregating local descriptors into a compact image representation", CVPR
2010): features are told apart by a small vocabulary, learned from the photos themselves, and the residuals from its
words are summed up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reconstruction.colmap.pycolmap_run import Pair

Array = NDArray[np.float64]

N_WORDS = 64
"""Of the vocabulary."""

N_LEARNED = 40_000
"""Features that the vocabulary is learned from."""

N_OF_PHOTO = 2000
"""Features of a photo that its signature is made of: the last, since COLMAP lists fine ones first."""

N_ROUNDS = 8
"""Of k-means; the words need not be the best, only the same for all photos."""


@dataclass(frozen=True, slots=True)
class PairParameters:
    """How many neighbours of each kind a photo is matched with.

    Parameters
    ----------
    all_up_to
        Sets up to so many photos are matched all with all.
    n_near, n_alike, n_next
        Nearest in space, most alike, and taken before and after.
    """

    all_up_to: int = 16
    n_near: int = 8
    n_alike: int = 8
    n_next: int = 2


@dataclass(frozen=True, slots=True, eq=False)
class PairHint:
    """What is known of a photo before it is matched; None where it does not say.

    Parameters
    ----------
    position_enu_m, forward_enu
        Where it was taken and where it looked, shape (3,).
    """

    name: str
    position_enu_m: Array | None = None
    forward_enu: Array | None = None
    taken_at: datetime | None = None


def choose_pairs(
    hints: Sequence[PairHint], likeness: Array | None = None, parameters: PairParameters | None = None
) -> list[Pair]:
    """Pairs to match, each once, the photos of a pair in the order given.

    Parameters
    ----------
    likeness
        Between all photos, shape (n, n); None where it was not looked at.
    """
    parameters = parameters or PairParameters()
    n = len(hints)
    if n <= parameters.all_up_to:
        return [(hints[i].name, hints[j].name) for i in range(n) for j in range(i + 1, n)]
    found = {
        *_nearest(hints, parameters.n_near),
        *_following(hints, parameters.n_next),
        *(() if likeness is None else _most_alike(likeness, parameters.n_alike)),
    }
    return [(hints[i].name, hints[j].name) for i, j in sorted(found)]


def _nearest(hints: Sequence[PairHint], n_near: int) -> set[tuple[int, int]]:
    """Neighbours in space that do not look apart by more than a right angle."""
    placed = [i for i, hint in enumerate(hints) if hint.position_enu_m is not None]
    if len(placed) < 2:
        return set()
    points = np.array([hints[i].position_enu_m for i in placed])
    k = min(len(placed), 3 * n_near + 1)
    _, near = cKDTree(points).query(points, k)
    pairs = set()
    for row, others in enumerate(near.reshape(len(placed), k).tolist()):
        fitting = [other for other in others if other != row and _look_alike(hints[placed[row]], hints[placed[other]])]
        pairs |= {_ordered(placed[row], placed[other]) for other in fitting[:n_near]}
    return pairs


def _look_alike(one: PairHint, other: PairHint) -> bool:
    if one.forward_enu is None or other.forward_enu is None:
        return True
    return float(one.forward_enu @ other.forward_enu) > 0.0


def _following(hints: Sequence[PairHint], n_next: int) -> set[tuple[int, int]]:
    """Neighbours in time."""
    timed = [(hint.taken_at, i) for i, hint in enumerate(hints) if hint.taken_at is not None]
    order = [i for _, i in sorted(timed)]
    return {
        _ordered(order[a], order[b]) for a in range(len(order)) for b in range(a + 1, min(a + 1 + n_next, len(order)))
    }


def _most_alike(likeness: Array, n_alike: int) -> set[tuple[int, int]]:
    scores = likeness.copy()
    np.fill_diagonal(scores, -np.inf)
    order = np.argsort(-scores, axis=1, kind="stable")[:, :n_alike]
    return {_ordered(i, int(j)) for i, row in enumerate(order) for j in row if i != j}


def _ordered(i: int, j: int) -> tuple[int, int]:
    return (i, j) if i < j else (j, i)


def likeness_of(descriptors: Mapping[str, NDArray[np.uint8]], names: Sequence[str], seed: int = 0) -> Array:
    """Cosines between the signatures of photos, shape (n, n); 0 where a photo has no features.

    Parameters
    ----------
    descriptors
        Of the features of each photo, shape (k, 128), by name.
    """
    chosen = [descriptors.get(name, np.zeros((0, 128), np.uint8))[-N_OF_PHOTO:].astype(np.float32) for name in names]
    together = np.concatenate(chosen) if chosen else np.zeros((0, 128), np.float32)
    if len(together) < N_WORDS:
        return np.zeros((len(names), len(names)))
    words = _vocabulary(together, seed)
    signatures = np.stack([_signature(features, words) for features in chosen])
    return np.asarray(signatures @ signatures.T, np.float64)


def _vocabulary(features: NDArray[np.float32], seed: int) -> NDArray[np.float32]:
    """Words, shape (`N_WORDS`, d), by k-means."""
    sample = features[np.random.default_rng(seed).permutation(len(features))[:N_LEARNED]]
    cv2.setRNGSeed(seed)
    rounds = (cv2.TERM_CRITERIA_MAX_ITER, N_ROUNDS, 0.0)
    _, _, words = cv2.kmeans(sample, N_WORDS, np.empty(0), rounds, 1, cv2.KMEANS_RANDOM_CENTERS)
    return np.asarray(words, np.float32)


def _nearest_word(features: NDArray[np.float32], words: NDArray[np.float32]) -> NDArray[np.int64]:
    return np.asarray(np.argmin((words**2).sum(axis=1) - 2.0 * features @ words.T, axis=1), np.int64)


def _signature(features: NDArray[np.float32], words: NDArray[np.float32]) -> NDArray[np.float32]:
    """Residuals from the nearest words, summed up by word, each word's normed and all together."""
    sums = np.zeros_like(words)
    if len(features):
        word = _nearest_word(features, words)
        np.add.at(sums, word, features - words[word])
    sums /= np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-9)
    whole = sums.ravel()
    return np.asarray(whole / max(float(np.linalg.norm(whole)), 1e-9), np.float32)
