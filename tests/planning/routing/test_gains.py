"""Worth of sets of stops, against counting it anew."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.routing.insertion import CoverageGain
from tests.planning.routing_cases import Prizes, cover_gain


def counted(sees: np.ndarray, weights: np.ndarray, chosen: set[int]) -> float:
    """Worth of a set by its definition."""
    return float(weights @ sees[sorted(chosen)].any(axis=0))


@given(
    n=st.integers(1, 8),
    m=st.integers(0, 12),
    seed=st.integers(0, 1000),
    steps=st.lists(st.integers(0, 7), max_size=20),
)
def test_coverage_agrees_with_counting_after_every_change(n: int, m: int, seed: int, steps: list[int]) -> None:
    rng = np.random.default_rng(seed)
    sees, weights = rng.random((n, m)) < 0.4, rng.random(m)
    gain = cover_gain(sees, weights)
    chosen: set[int] = set()
    for step in steps:
        candidate = step % n
        if candidate in chosen:
            chosen.remove(candidate)
            gain.remove(candidate)
        else:
            chosen.add(candidate)
            gain.add(candidate)
        value = counted(sees, weights, chosen)
        assert gain.value == pytest.approx(value, abs=1e-12)
        for other in set(range(n)) - chosen:
            added = counted(sees, weights, chosen | {other}) - value
            assert gain.marginals()[other] == pytest.approx(added, abs=1e-12)


@given(seed=st.integers(0, 100))
@settings(max_examples=20)
def test_what_a_candidate_adds_never_grows_with_the_set(seed: int) -> None:
    rng = np.random.default_rng(seed)
    gain = cover_gain(rng.random((12, 30)) < 0.3, rng.random(30))
    before = gain.marginals().copy()
    for candidate in rng.permutation(12)[:6]:
        gain.add(int(candidate))
        assert (gain.marginals() <= before + 1e-12).all()
        assert (gain.marginals() >= -1e-12).all()
        before = gain.marginals().copy()


@pytest.mark.slow
def test_rounding_does_not_build_up_over_many_changes() -> None:
    rng = np.random.default_rng(0)
    weights = rng.random(50) * 10.0 ** rng.integers(-8, 8, 50)
    gain = cover_gain(rng.random((20, 50)) < 0.5, weights)
    fresh = gain.marginals().copy()
    for _ in range(20_000):
        candidate = int(rng.integers(20))
        gain.add(candidate)
        gain.remove(candidate)
    assert gain.value == 0.0
    np.testing.assert_allclose(gain.marginals(), fresh, rtol=1e-12)


def test_prizes_add_up() -> None:
    gain: CoverageGain = Prizes(np.array([1.0, 2.0, 4.0]))
    gain.add(0)
    gain.add(2)
    assert gain.value == 5.0
    gain.remove(0)
    assert gain.value == 4.0
    assert gain.marginals().tolist() == [1.0, 2.0, 4.0]


@pytest.mark.parametrize("prizes", [np.array([1.0, -1.0]), np.array([np.nan]), np.ones((2, 2))])
def test_prizes_that_are_none_are_refused(prizes: np.ndarray) -> None:
    with pytest.raises(ValueError, match="prizes"):
        Prizes(prizes)
