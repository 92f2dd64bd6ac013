"""What a frame tells by mirroring nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.base.progress import QUIET
from reconstruction.metrics.metrics import PhotoScores
from reconstruction.metrics.run import own_method, score_answer
from reconstruction.metrics.sets import scored
from reconstruction.panels.search.evidence import (
    ENOUGH,
    N_BANDS,
    OF_A_WITNESS,
    UNSEEN,
    Evidence,
    Stillness,
    spread_in_bands,
)
from reconstruction.scenes.facades.cases import random_case
from reconstruction.scenes.facades.render import render_facade
from tests.slow import slow

Array = NDArray[np.float64]
WIDTH = 200
FIRST, LAST = np.array([100.0]), np.array([104.0])


def picture(glass: float, profile: float, seed: int = 0) -> NDArray[np.float32]:
    """Brightness that changes every 20 rows: by `glass` in columns of glass, by `profile` in a profile of 4 px."""
    rng = np.random.default_rng(seed)
    values = rng.normal(0.0, 1.0, (60, WIDTH))
    spread = np.full(WIDTH, glass)
    spread[100:104] = profile
    grey = 120.0 + np.repeat(values * spread, 20, axis=0) + rng.normal(0.0, 1.0, (1200, WIDTH))
    return grey.astype(np.float32)


def per_witness(grey: NDArray[np.float32], first: Array = FIRST, last: Array = LAST) -> float:
    return float(Stillness.of(spread_in_bands(grey)).per_witness(first, last)[0])


def test_a_still_profile_in_lively_glass_gains_and_a_lively_one_loses() -> None:
    assert per_witness(picture(glass=25.0, profile=0.0)) == OF_A_WITNESS[1]
    assert per_witness(picture(glass=6.0, profile=25.0)) == OF_A_WITNESS[0]
    assert abs(per_witness(picture(glass=25.0, profile=25.0))) < 0.1


def test_even_glass_tells_nothing() -> None:
    assert abs(per_witness(picture(glass=0.0, profile=0.0))) < 0.02
    constant = np.full((300, WIDTH), 77.0, np.float32)
    assert per_witness(constant) == 0.0


@given(glass=st.floats(0.0, 60.0), profile=st.floats(0.0, 60.0), gain=st.floats(0.5, 2.0))
@settings(max_examples=20)
def test_gains_are_bounded_and_follow_the_liveliness(glass: float, profile: float, gain: float) -> None:
    value = per_witness(picture(glass, profile))
    assert OF_A_WITNESS[0] <= value <= OF_A_WITNESS[1]
    assert per_witness(picture(glass, profile * gain)) <= value + 1e-9 or gain < 1.0


def test_the_edge_of_the_picture_and_a_joint_without_width_are_no_trouble() -> None:
    still = Stillness.of(spread_in_bands(picture(25.0, 0.0)))
    places = np.array([0.0, 0.3, 102.0, WIDTH - 0.1, WIDTH])
    assert np.isfinite(still.per_witness(places, places)).all()
    few = Stillness.of(spread_in_bands(picture(25.0, 0.0)[:3]))
    assert np.isfinite(few.per_witness(FIRST, LAST)).all()


def test_spread_equals_the_standard_deviation_of_each_band() -> None:
    grey = picture(30.0, 3.0)
    bands = np.array([band.std(axis=0) for band in np.split(grey.astype(np.float64), N_BANDS)])
    assert spread_in_bands(grey) == pytest.approx(bands, rel=1e-4, abs=1e-3)
    brighter = spread_in_bands(grey + np.float32(1e4))  # squares of 1e8 in single precision would leave nothing
    assert brighter == pytest.approx(bands, rel=1e-2, abs=1e-2)


def test_stillness_makes_up_for_unseen_edges_and_adds_nothing_to_seen_ones() -> None:
    support = np.full(2 * WIDTH, 0.02)
    weak, strong = support.copy(), support.copy()
    for x in (100.0, 104.0):
        weak[int(2 * x)], strong[int(2 * x)] = 0.25, 0.95
    still = Stillness.of(spread_in_bands(picture(25.0, 0.0)))
    for values, expected in ((weak, (5.0, ENOUGH - 2 * UNSEEN)), (strong, (0.0, 0.0))):
        evidence = Evidence.of(values, n_panes=8, stillness=still)
        first, last = evidence.places_px[[0, -1]]
        gained = float(evidence.profile_gains(np.array([first]), np.array([last]))[0])
        assert expected[0] <= gained <= expected[1]
    evidence = Evidence.of(weak, n_panes=8, stillness=still)
    assert evidence.profile_gains(FIRST + 0.4, LAST + 0.4)[0] == 0.0, "an edge that is only expected"
    assert replace(evidence, stillness=None).profile_gains(FIRST, LAST)[0] == 0.0


def scores(shape: str, seed: int) -> PhotoScores:
    photo = scored(render_facade(random_case("curved" if shape == "curved" else "planar", seed)))
    return score_answer(photo, own_method()(photo, QUIET))


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "seed"), [slow("curved", 32), ("planar", 56)])
def test_dark_frames_before_a_mirrored_grid_are_found(shape: str, seed: int) -> None:
    """Columns drowned in the mirrored grid; rows, since its bars were taken for lines that have to be straightened."""
    found = scores(shape, seed)
    assert (found.n_missed, found.n_false) == (0, 0)
    assert found.individual_miou is not None
    assert found.individual_miou > 0.95
