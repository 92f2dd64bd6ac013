"""Which photos are matched: few of all pairs, and never two that have nothing to do with each other."""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np
import pytest

from reconstruction.coarse.pairs import PairHint, PairParameters, choose_pairs, likeness_of


def ring(n, *, placed=True, timed=True):
    angles = 2.0 * np.pi * np.arange(n) / n
    places = np.column_stack([30.0 * np.cos(angles), 30.0 * np.sin(angles), np.full(n, 15.0)])
    start = datetime(2026, 6, 1, 10)
    return [
        PairHint(
            f"{i:03d}.jpg",
            places[i] if placed else None,
            -places[i] / np.linalg.norm(places[i]) if placed else None,
            start + timedelta(seconds=3 * i) if timed else None,
        )
        for i in range(n)
    ]


def test_few_photos_are_matched_all_with_all():
    assert len(choose_pairs(ring(10))) == 45


def test_neighbours_in_space_and_time_are_pairs_and_opposite_sides_are_not():
    hints = ring(60)
    pairs = set(choose_pairs(hints))
    assert len(pairs) < 0.3 * 60 * 59 / 2
    assert all((f"{i:03d}.jpg", f"{i + 1:03d}.jpg") in pairs for i in range(59))
    assert ("000.jpg", "030.jpg") not in pairs
    assert ("000.jpg", "059.jpg") in pairs


def test_likeness_alone_finds_the_neighbours():
    n = 40
    angles = 2.0 * np.pi * np.arange(n) / n
    likeness = np.cos(angles[:, None] - angles[None, :])
    pairs = set(choose_pairs(ring(n, placed=False, timed=False), likeness, PairParameters(all_up_to=5, n_alike=4)))
    assert all((f"{i:03d}.jpg", f"{i + 1:03d}.jpg") in pairs for i in range(n - 1))
    assert len(pairs) <= 4 * n


def test_photos_of_one_place_are_alike_by_their_features():
    rng = np.random.default_rng(0)
    places = rng.integers(0, 255, (4, 300, 128)).astype(np.uint8)
    descriptors = {}
    for place, features in enumerate(places):
        for shot in range(3):
            off = np.clip(features + rng.normal(0.0, 6.0, features.shape), 0, 255).astype(np.uint8)
            descriptors[f"{place}-{shot}"] = off[rng.permutation(300)[:250]]
    names = sorted(descriptors)
    likeness = likeness_of(descriptors, [*names, "none"])
    np.fill_diagonal(likeness, -1.0)
    for row, name in enumerate(names):
        best = np.argsort(-likeness[row])[:2]
        assert {names[k][0] for k in best} == {name[0]}
    assert likeness[-1, :-1] == pytest.approx(0.0)


def test_likeness_is_that_of_the_last_features_which_are_the_largest():
    """COLMAP lists fine ones first, and grass is the same everywhere."""
    rng = np.random.default_rng(0)
    fine, large = rng.integers(0, 255, (2, 2, 2000, 128)).astype(np.uint8)
    descriptors = {f"{i}{j}": np.concatenate([fine[i], large[j]]) for i in range(2) for j in range(2)}
    likeness = likeness_of(descriptors, ["00", "01", "10", "11"])
    assert likeness[0, 2] > 0.99
    assert likeness[0, 1] < 0.9
