"""Choosing stops: the best where trying everything can tell, published best scores, and limits kept."""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import OperationCancelled
from planning.base.progress import Trace
from planning.routing.insertion import CoverageGain
from planning.routing.orienteering import Selection, solve_orienteering
from tests.planning.routing_cases import (
    Cancelling,
    Counting,
    Prizes,
    cover_gain,
    distances,
    fewest_by_force,
    random_distances,
)


def worth(gain: CoverageGain, stops: list[int]) -> float:
    """Worth of some stops, by putting them in and taking them out again."""
    for stop in stops:
        gain.add(stop)
    value = gain.value
    for stop in stops:
        gain.remove(stop)
    return value


def check(selection: Selection, travel_s: np.ndarray, service_s: np.ndarray, budget_s: float, n_sorties: int) -> None:
    stops = list(itertools.chain(*selection.sorties))
    assert len(stops) == len(set(stops))
    assert len(selection.sorties) <= n_sorties
    assert all(selection.sorties)
    for sortie, duration_s in zip(selection.sorties, selection.durations_s, strict=True):
        legs = itertools.pairwise([0, *(stop + 1 for stop in sortie), 0])
        flown_s = sum(travel_s[a, b] for a, b in legs) + sum(service_s[list(sortie)])
        assert duration_s == pytest.approx(flown_s)
        assert flown_s <= budget_s * (1.0 + 2e-9)
    assert selection.value <= selection.bound


@pytest.mark.slow
@given(
    n=st.integers(1, 6),
    seed=st.integers(0, 1000),
    budget=st.integers(5, 40),
    n_sorties=st.integers(1, 2),
    overlaps=st.booleans(),
)
@settings(max_examples=50)
def test_few_stops_are_chosen_as_trying_everything_does(
    n: int, seed: int, budget: int, n_sorties: int, overlaps: bool
) -> None:
    rng = np.random.default_rng(seed)
    travel_s = np.round(distances(rng.random((n + 1, 2)) * 10.0))
    service_s = rng.integers(0, 4, n).astype(float)

    def new_gain() -> CoverageGain:
        draw = np.random.default_rng(seed)
        if overlaps:
            return cover_gain(draw.random((n, 10)) < 0.4, draw.integers(1, 5, 10).astype(float))
        return Prizes(draw.integers(0, 9, n).astype(float))

    best = 0.0
    for stops in itertools.chain.from_iterable(itertools.combinations(range(n), k) for k in range(n + 1)):
        places = [0, *(stop + 1 for stop in stops)]
        flown = fewest_by_force(travel_s[np.ix_(places, places)], service_s[list(stops)], float(budget), n)
        if flown is not None and flown[0] <= n_sorties:
            best = max(best, worth(new_gain(), list(stops)))
    gain = new_gain()
    selection = solve_orienteering(travel_s, service_s, float(budget), n_sorties, gain, max_rounds=300)
    check(selection, travel_s, service_s, float(budget), n_sorties)
    assert selection.value == best
    assert selection.bound >= best
    assert gain.value == selection.value == worth(new_gain(), list(itertools.chain(*selection.sorties)))


def tsiligirides(path: Path) -> tuple[float, np.ndarray, np.ndarray]:
    """Budget, times and prizes; start and end are different points (see OP_format.txt)."""
    lines = [line.split() for line in path.read_text().splitlines() if line.strip()]
    table = np.array(lines[1:], float)
    between = distances(table[:, :2])
    travel = np.zeros((len(table) - 1, len(table) - 1))
    travel[1:, 1:] = between[2:, 2:]
    travel[0, 1:], travel[1:, 0] = between[0, 2:], between[2:, 1]
    return float(lines[0][0]), travel, table[2:, 2]


def scores(folder: Path, files: list[Path], max_rounds: int | None) -> list[tuple[float, float]]:
    """Score reached and best known score of each file."""
    with (folder / "best_known.csv").open() as file:
        best = {row["file"]: float(row["best_score"]) for row in csv.DictReader(file)}
    found = []
    for path in files:
        budget, travel, prizes = tsiligirides(path)
        service = np.zeros(len(prizes))
        selection = solve_orienteering(travel, service, budget, 1, Prizes(prizes), max_rounds=max_rounds)
        check(selection, travel, service, budget, 1)
        assert selection.bound >= best[path.name]
        found.append((selection.value, best[path.name]))
    return found


@pytest.mark.slow
def test_published_best_scores_are_reached_on_most_instances(shared_data: Path) -> None:
    folder = shared_data / "routing" / "orienteering"
    found = scores(folder, sorted(folder.glob("*/*.txt"))[::5], max_rounds=400)
    assert len(found) >= 9
    assert all(value <= best for value, best in found)
    assert sum(value == best for value, best in found) >= 0.8 * len(found)
    assert sum(value / best for value, best in found) >= 0.99 * len(found)


@pytest.mark.slow
def test_published_best_scores_are_reached_on_nearly_all_instances(shared_data: Path) -> None:
    folder = shared_data / "routing" / "orienteering"
    found = scores(folder, sorted(folder.glob("*/*.txt")), max_rounds=None)
    assert sum(value == best for value, best in found) >= 0.95 * len(found)


def coverage_case(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    points = np.concatenate([[[40.0, 40.0, 0.0]], rng.random((n, 3)) * [80.0, 20.0, 30.0] + [0.0, 12.0, 2.0]])
    travel_s = 2.0 + distances(points) / 5.0
    np.fill_diagonal(travel_s, 0.0)
    sections = rng.random((500, 2)) * [80.0, 30.0]
    sees = np.abs(points[1:, None, [0, 2]] - sections).max(axis=2) < 6.0
    return travel_s, sees & (rng.random(sees.shape) < 0.5)


@pytest.mark.slow
def test_overlapping_worth_is_searched_beyond_the_greedy_choice() -> None:
    travel_s, sees = coverage_case(120)
    service_s = np.full(120, 3.0)
    trace = Trace()
    selection = solve_orienteering(travel_s, service_s, 120.0, 2, cover_gain(sees), max_rounds=300, trace=trace)
    check(selection, travel_s, service_s, 120.0, 2)
    assert selection.value == sees[list(itertools.chain(*selection.sorties))].any(axis=0).sum()
    values = [point.value for point in trace.points]
    assert values == sorted(values)
    assert values[-1] == selection.value
    assert values[-1] > 1.03 * values[0]


def test_everything_is_visited_where_the_budget_allows() -> None:
    travel_s, sees = coverage_case(30)
    selection = solve_orienteering(travel_s, np.zeros(30), 1e5, 1, cover_gain(sees), max_rounds=100)
    assert selection.value == selection.bound == sees.any(axis=0).sum()


def test_start_and_end_may_be_different_places() -> None:
    # On a line from 0 to 10: only stops on the way fit.
    at = np.array([2.0, 5.0, 8.0, -3.0, 13.0])
    travel = np.zeros((6, 6))
    travel[0, 1:], travel[1:, 0] = np.abs(at), np.abs(10.0 - at)
    travel[1:, 1:] = np.abs(at[:, None] - at)
    selection = solve_orienteering(travel, np.zeros(5), 10.0, 1, Prizes(np.array([1.0, 1.0, 1.0, 9.0, 9.0])))
    assert selection.sorties == ((0, 1, 2),)
    assert selection.durations_s == (10.0,)


def test_nothing_within_reach_gives_no_sortie() -> None:
    selection = solve_orienteering(random_distances(5) + 100.0, np.zeros(4), 50.0, 2, Prizes(np.ones(4)))
    assert selection == Selection((), (), 0.0, 0.0)
    assert solve_orienteering(np.zeros((1, 1)), np.zeros(0), 50.0, 1, Prizes(np.zeros(0))).sorties == ()


def test_worthless_stops_are_left_out() -> None:
    selection = solve_orienteering(random_distances(5), np.zeros(4), 1e4, 1, Prizes(np.array([0.0, 3.0, 0.0, 1.0])))
    assert sorted(*selection.sorties) == [1, 3]


def test_no_sortie_has_more_stops_than_allowed() -> None:
    travel_s = random_distances(21)
    selection = solve_orienteering(
        travel_s, np.zeros(20), 1e4, 2, Prizes(np.arange(20.0)), max_stops=3, max_rounds=1000
    )
    assert [len(sortie) for sortie in selection.sorties] == [3, 3]
    assert selection.value == selection.bound == sum(range(14, 20))


def test_stops_at_one_place_do_not_divide_by_zero() -> None:
    selection = solve_orienteering(np.zeros((9, 9)), np.full(8, 2.0), 10.0, 1, Prizes(np.arange(8.0)), max_rounds=200)
    assert selection.value == 7 + 6 + 5 + 4 + 3
    everything = solve_orienteering(np.zeros((9, 9)), np.zeros(8), 10.0, 1, Prizes(np.arange(1.0, 9.0)))
    assert everything.value == 36.0


def test_the_same_seed_and_rounds_give_the_same_selection() -> None:
    travel_s, sees = coverage_case(60)
    runs = [
        solve_orienteering(travel_s, np.full(60, 3.0), 100.0, 2, cover_gain(sees), seed=seed, max_rounds=50)
        for seed in (1, 1, 2)
    ]
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


class LookedAt(Prizes):
    """Worth that counts how often it is asked for, in all and once `late` says so."""

    def __init__(self, prizes: np.ndarray, late: Callable[[], bool]) -> None:
        super().__init__(prizes)
        self.late, self.n, self.n_late = late, 0, 0

    def marginals(self) -> np.ndarray:
        self.n += 1
        self.n_late += self.late()
        return super().marginals()


@pytest.mark.long
@pytest.mark.parametrize("n_asked", [300, 500, 1000])
def test_a_round_is_broken_off_and_leaves_what_was_best_before(n_asked: int) -> None:
    """Every stop that is put in is one question whether to end: some 90 at first, and as many in long rounds."""
    travel_s, service_s, prizes = random_distances(101, 0), np.full(100, 3.0), np.arange(1.0, 101.0)
    stop = Counting(n_asked)
    gain = LookedAt(prizes, lambda: stop.left < 0)
    selection = solve_orienteering(travel_s, service_s, 400.0, 2, gain, stop=stop)
    check(selection, travel_s, service_s, 400.0, 2)
    assert gain.n > n_asked / 3
    assert gain.n_late <= 2, "one for the bound, and one that was about to be asked for"
    assert selection.value == sum(prizes[stop] for sortie in selection.sorties for stop in sortie)
    first = solve_orienteering(travel_s, service_s, 400.0, 2, Prizes(prizes), max_rounds=0)
    assert first.value <= selection.value + 1e-9


def test_the_first_stops_are_put_in_however_late_it_is_with_few_looks_at_their_worth() -> None:
    travel_s, sees = coverage_case(100)
    gain = cover_gain(sees)
    looks: list[int] = []
    marginals = gain.marginals

    def counted() -> np.ndarray:
        looks.append(1)
        return marginals()

    gain.marginals = counted  # type: ignore[method-assign]
    late = solve_orienteering(travel_s, np.full(100, 3.0), 150.0, 3, gain, stop=lambda: True)
    n_stops = sum(map(len, late.sorties))
    check(late, travel_s, np.full(100, 3.0), 150.0, 3)
    assert n_stops > 40
    assert len(looks) < 0.8 * n_stops
    first = solve_orienteering(travel_s, np.full(100, 3.0), 150.0, 3, cover_gain(sees), max_rounds=0)
    assert late.value >= 0.9 * first.value


def test_stopping_returns_the_best_so_far_and_cancelling_does_not() -> None:
    travel_s, sees = coverage_case(60)
    service_s = np.full(60, 3.0)
    values = [
        solve_orienteering(travel_s, service_s, 100.0, 1, cover_gain(sees), stop=Counting(n)).value
        for n in (0, 20, 200)
    ]
    assert values == sorted(values)
    assert values[0] > 0.0
    with pytest.raises(OperationCancelled):
        solve_orienteering(travel_s, service_s, 100.0, 1, cover_gain(sees), monitor=Cancelling(5, OperationCancelled))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"budget_s": math.inf}, "budget_s: expected a positive number"),
        ({"budget_s": -1.0}, "budget_s: expected a positive number"),
        ({"n_sorties": 0}, "n_sorties: expected 1 or more"),
        ({"service_s": np.array([1.0, math.nan])}, "service_s: expected 2 finite numbers"),
        ({"travel_s": np.full((3, 3), math.nan)}, "is NaN"),
    ],
)
def test_wrong_arguments_are_refused(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {
        "travel_s": np.ones((3, 3)),
        "service_s": np.ones(2),
        "budget_s": 10.0,
        "n_sorties": 1,
        "gain": Prizes(np.ones(2)),
    }
    with pytest.raises(ValueError, match=message):
        solve_orienteering(**{**arguments, **change})  # type: ignore[arg-type]
