"""The most probable set of frames among edges that are seen, half seen, missing or false."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from reconstruction.panels.search.evidence import FINE, Evidence
from reconstruction.panels.search.grid import (
    SizeLimits,
    Sizes,
    _best_set,
    _Costs,
    _sums,
    clustered,
    most_probable_frames,
)

Array = NDArray[np.float64]
LENGTH = 900
LIMITS = SizeLimits(10.0, 40.0, 0.5, float(LENGTH))


def evidence_of(edges: Array, support: Array, clutter: float = 0.08, seed: int = 0) -> Evidence:
    """Support as a picture would give it: peaks at edges, texture elsewhere."""
    rng = np.random.default_rng(seed)
    columns = np.clip(rng.normal(clutter, 0.02, LENGTH * FINE), 0.0, 1.0)
    for x, share in zip(edges, support, strict=True):
        for off in (-1, 0, 1):
            columns[int(x * FINE) + off] = max(columns[int(x * FINE) + off], share * (1.0 - 0.1 * abs(off)))
    return Evidence.of(columns)


def grid(panels: list[float], frame: float = 5.0, start: float = 30.0) -> Array:
    """Edges, shape (n + 1, 2), of the frames around panels."""
    first = start + np.concatenate([[0.0], np.cumsum(np.array(panels) + frame)])
    return np.column_stack([first, first + frame])


def found_edges(evidence: Evidence, use_spacing: bool = True, crossed: Array | None = None) -> Array:
    frames = most_probable_frames(evidence, LIMITS, use_spacing, crossed)
    return np.array([[frame.first_px, frame.last_px] for frame in frames]).reshape(-1, 2)


@pytest.mark.parametrize(
    "panels",
    [[60.0] * 10, [80.0, 50.0] * 5, [40.0, 41.0, 90.0, 35.0, 66.0, 120.0, 52.0], [70.0], [60.0, 22.0] * 6],
    ids=["uniform", "alternating", "random", "single panel", "spandrels"],
)
def test_well_seen_grids_are_found_as_they_are(panels: list[float]) -> None:
    edges = grid(panels)
    found = found_edges(evidence_of(edges.ravel(), np.full(edges.size, 0.85)))
    assert found == pytest.approx(edges, abs=1.0)


def test_weak_lines_between_strong_ones_are_kept() -> None:
    edges = grid([60.0] * 10)
    support = np.full(edges.shape, 0.95)
    support[4:7] = 0.45
    assert found_edges(evidence_of(edges.ravel(), support.ravel())) == pytest.approx(edges, abs=1.0)


def test_an_unseen_line_is_inferred_in_a_regular_facade_only() -> None:
    regular = grid([50.0] * 14, start=20.0)
    seen = np.delete(regular, 6, axis=0)
    frames = most_probable_frames(evidence_of(seen.ravel(), np.full(seen.size, 0.9)), LIMITS)
    assert np.array([[f.first_px, f.last_px] for f in frames]) == pytest.approx(regular, abs=1.0)
    assert [index for index, frame in enumerate(frames) if frame.is_inferred] == [6]
    irregular = np.delete(grid([40.0, 66.0, 105.0, 51.0, 83.0, 120.0]), 3, axis=0)
    assert len(found_edges(evidence_of(irregular.ravel(), np.full(irregular.size, 0.9)))) == 6


def test_two_wide_panels_in_a_regular_facade_stay_wide() -> None:
    edges = grid([50.0] * 4 + [105.0] + [50.0] * 3 + [105.0] + [50.0] * 2, start=20.0)
    assert found_edges(evidence_of(edges.ravel(), np.full(edges.size, 0.9))) == pytest.approx(edges, abs=1.0)


def test_false_lines_that_break_the_spacing_are_dropped() -> None:
    edges = grid([60.0] * 11)
    false = np.array([250.0, 254.5, 441.0])
    both = evidence_of(np.append(edges.ravel(), false), np.append(np.full(edges.size, 0.85), [0.42, 0.42, 0.45]))
    assert found_edges(both) == pytest.approx(edges, abs=1.0)


def test_low_rows_are_told_from_wide_frames_by_the_lines_that_cross_them() -> None:
    edges = grid([60.0, 22.0] * 5)
    support = np.full(edges.shape, 0.9)
    support[2, 1] = support[3, 0] = 0.1  # the dark low row between frames 2 and 3 shows no inner edges
    crossed = np.ones(LENGTH)
    for first, last in edges:
        crossed[int(first) : int(last) + 1] = 0.0
    evidence = evidence_of(edges.ravel(), support.ravel())
    assert len(found_edges(evidence, crossed=crossed)) == len(edges)


def test_nothing_is_found_where_there_is_nothing() -> None:
    assert most_probable_frames(evidence_of(np.empty(0), np.empty(0)), LIMITS) == ()
    nothing = Evidence.of(np.zeros(0))
    assert most_probable_frames(nothing, LIMITS) == ()


def test_confidence_is_high_for_seen_and_low_for_doubtful_lines() -> None:
    edges = grid([47.0, 83.0, 61.0, 99.0, 71.0, 55.0])
    support = np.full(edges.shape, 0.9)
    support[3] = 0.33
    frames = most_probable_frames(evidence_of(edges.ravel(), support.ravel()), LIMITS)
    if len(frames) == len(edges):
        assert frames[3].confidence < 0.95
    assert frames[1].confidence > 0.99


def test_sizes_within_a_pixel_are_one_and_single_ones_none() -> None:
    sizes = clustered(np.array([50.0, 50.6, 49.8, 80.0, 80.2, 33.0]), 0.001)
    assert sizes.middles_px.tolist() == pytest.approx([50.0, 80.1])
    assert sizes.counts.tolist() == [3.0, 2.0]


def test_density_of_sizes_integrates_to_one() -> None:
    sizes = Sizes(np.array([50.0, 80.0]), np.array([3.0, 2.0]), 1.0 / 200.0)
    x = np.linspace(0.0, 200.0, 20_001)
    assert np.trapezoid(np.exp(sizes.log_density(x)), x) == pytest.approx(1.0, abs=1e-3)


def walks(n: int) -> list[list[tuple[int, int]]]:
    """Every set of frames on n edges: first and last edge of each frame, at least two frames, in order."""
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    found: list[list[tuple[int, int]]] = []
    for size in range(2, n + 1):
        for choice in itertools.combinations(pairs, size):
            if all(a[1] < b[0] for a, b in itertools.pairwise(choice)):
                found.append(list(choice))
    return found


def weight(walk: list[tuple[int, int]], gains: Array, costs: _Costs) -> float:
    """Logarithm of a set's probability against that of the empty facade, by its definition."""
    total = float(sum(gains[i] for i in {i for pair in walk for i in pair}))
    total += float(sum(costs.frame[i, j] for i, j in walk))
    total += float(sum(costs.still[i, j] for i, j in walk[1:-1]))
    return total + float(sum(costs.panel[a[1], b[0]] for a, b in itertools.pairwise(walk)))


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000))
def test_dynamic_program_equals_trying_every_set(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places = np.sort(rng.uniform(0.0, 120.0, 5))
    gains = rng.normal(4.0, 4.0, 5)
    empty = np.empty(0)
    sizes = Sizes(empty, empty, 0.02), Sizes(empty, empty, 0.05)
    costs = replace(
        _Costs.of(places, Evidence.of(np.zeros(0)), LIMITS, *sizes, None), still=np.triu(rng.normal(0.0, 4.0, (5, 5)))
    )
    weights = {tuple(walk): weight(walk, gains, costs) for walk in walks(5)}
    best = max(weights, key=lambda walk: weights[walk])
    found = _best_set(gains, costs)
    if weights[best] <= 0.0:
        assert found == []
    else:
        assert weight(found, gains, costs) == pytest.approx(weights[best])
    everything = np.logaddexp.reduce([0.0, *weights.values()])
    assert _sums(gains, costs)[2] == pytest.approx(everything)
