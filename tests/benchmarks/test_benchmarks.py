"""The machinery of the benchmarks: results are kept, pages are written, failures are told and hide nothing."""

from __future__ import annotations

import ast
import importlib
import math
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from planning.plan import ViewpointArrays
from planning.routing.sorties import SortieProblem, sortie_durations_s
from tests.benchmarks import flight_worth, model_sizes, next_battery
from tests.benchmarks.__main__ import main, run_all
from tests.benchmarks.catalogue import BENCHMARKS
from tests.benchmarks.fresh_process import run_command
from tests.benchmarks.harness import Benchmark, Context, Row, Skipped, machine
from tests.benchmarks.mission_files import largest_errors
from tests.benchmarks.plan_routing import nearest_sorties
from tests.benchmarks.report import number_text, recorded_rows
from tests.benchmarks.speed_profiles import ring_flight


def tiny(context):
    (context.folder / "tiny.png").write_bytes(b"picture")
    yield Row("site", "time", 1234.5678, "s", 2.0, "the other", "under 2000 s", True, 3)
    yield Row("site", "words", "plenty")


def broken(context):
    yield Row("site", "before the failure", 1.0)
    raise RuntimeError("no luck")


def absent(context):
    raise Skipped("its data are absent")
    yield


TINY = Benchmark("tiny", "Tiny", "About tiny.", tiny)
BROKEN = Benchmark("broken", "Broken", "About broken.", broken)
ABSENT = Benchmark("absent", "Absent", "About absent.", absent)
KNOWN = (TINY, BROKEN, ABSENT)


def test_page_has_rows_targets_pictures_machine_and_what_failed(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert run_all([TINY], tmp_path, True, KNOWN) == 0
    assert run_all([BROKEN, ABSENT], tmp_path, False, KNOWN) == 1
    page = (tmp_path / "benchmarks.md").read_text()
    assert "| site | time | 1235 s | 2 x the other | 3 |" in page
    assert "| [tiny](#tiny) | site | time | 1235 s (2 x the other) | under 2000 s | met |" in page
    assert "| site | words | plenty |  | 1 |" in page
    assert "![Tiny](benchmarks/tiny.png)" in page
    assert "python -m tests.benchmarks --only tiny --quick" in page
    assert "before the failure" in page
    assert "- broken failed: RuntimeError: no luck" in page
    assert "- absent skipped: its data are absent" in page
    assert machine() in page
    assert "failed: broken" in capsys.readouterr().out


def test_measuring_a_part_anew_keeps_the_others(tmp_path: Path) -> None:
    run_all([TINY, ABSENT], tmp_path, False, KNOWN)
    first = (tmp_path / "benchmarks.md").read_text()
    run_all([Benchmark("absent", "Absent", "About absent.", tiny)], tmp_path, False, KNOWN)
    second = (tmp_path / "benchmarks.md").read_text()
    assert "skipped" in first
    assert "skipped" not in second
    assert (tmp_path / "benchmarks" / "tiny.csv").read_text().count("\n") == 3


def test_what_is_added_stands_beside_what_is_recorded_which_is_not_measured_again(tmp_path: Path) -> None:
    told = []

    def growing(context):
        told.append(context.recorded)
        yield from context.recorded
        yield Row("site", f"seed {len(context.recorded)}", 1.5, "dB", None, "beside", "at least 1 dB", True, 2)
        yield Row("site", f"word {len(context.recorded)}", "plenty")

    benchmark = Benchmark("tiny", "Tiny", "About tiny.", growing)
    run_all([benchmark], tmp_path, False, (benchmark,))
    run_all([benchmark], tmp_path, False, (benchmark,), add=True)
    assert [row.what for row in told[1]] == ["seed 0", "word 0"]
    assert told[1][0] == Row("site", "seed 0", 1.5, "dB", None, "beside", "at least 1 dB", True, 2)
    page = (tmp_path / "benchmarks.md").read_text()
    assert all(f"| site | {what} |" in page for what in ("seed 0", "word 0", "seed 2", "word 2"))
    for is_quick, add in ((False, False), (True, True)):  # anew, and other circumstances than those recorded
        run_all([benchmark], tmp_path, is_quick, (benchmark,), add=add)
        assert told[-1] == ()


def test_seeds_of_the_next_battery_that_are_recorded_are_not_flown_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def case_of(name, is_quick):
        raise AssertionError(f"{name} is flown again")

    monkeypatch.setattr(next_battery, "case_of", case_of)
    recorded = recorded_rows("next-battery", Path("docs/benchmarks"), is_quick=False)
    of_planar = [row for row in recorded if row.scene == "planar"]
    assert list(next_battery.measure_scene("planar", recorded, is_quick=False)) == of_planar
    n_of_first = next_battery.N_SEEDS["planar"]
    monkeypatch.setitem(next_battery.N_SEEDS, "planar", n_of_first + 1)
    rows = next_battery.measure_scene("planar", recorded, is_quick=False)
    with pytest.raises(AssertionError, match="planar is flown again"):
        list(rows)


def test_pages_of_scenes_that_are_recorded_are_not_measured_again(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[str] = []

    def page_of(name: str, _is_quick: bool) -> Iterator[Row]:
        made.append(name)
        yield Row(name, "page", 30.0, "dB")

    monkeypatch.setattr(model_sizes, "_page_of", page_of)
    of_planar = recorded_rows("model-size", Path("docs/benchmarks"), is_quick=False)
    of_planar = tuple(row for row in of_planar if row.scene not in model_sizes.FURTHER_SCENES)
    recorded = (*of_planar, Row("curved", "page", 29.0, "dB"))
    rows = list(model_sizes.measure(Context(False, Path("docs/benchmarks"), recorded)))
    assert rows[: len(recorded)] == list(recorded)
    assert made == [row.scene for row in rows[len(recorded) :]] == ["court", "concrete"]


def test_flights_whose_worth_is_recorded_are_not_flown_again(monkeypatch: pytest.MonkeyPatch) -> None:
    flown = []

    def worth_tradeoff(request, *_, **__):
        flown.append((request.scene, request.width_px))
        return SimpleNamespace(found=[])

    monkeypatch.setattr(flight_worth, "worth_tradeoff", worth_tradeoff)
    recorded = recorded_rows("worth", Path("docs/benchmarks"), is_quick=False)
    kept = [row for row in recorded if not row.what.startswith("256 px: ")]
    assert list(flight_worth.measure(Context(False, Path("docs/benchmarks"), tuple(kept)))) == kept
    assert ("planar", 256) in flown
    told = {name for name in flight_worth.FURTHER if any(row.what.startswith(f"{name}: ") for row in kept)}
    assert len(flown) == len(flight_worth.FURTHER) - len(told), "only what is not recorded"


@pytest.mark.long
def test_a_real_benchmark_runs_quickly_end_to_end(tmp_path: Path) -> None:
    assert main(["--quick", "--only", "certificates", "--out", str(tmp_path)]) == 0
    page = (tmp_path / "benchmarks.md").read_text()
    ratios = [float(r) for r in re.findall(r"greedy[^|]*\|[^|]*\| ([\d.]+) x the optimum", page)]
    bounds = [float(r) for r in re.findall(r"bound[^|]*\|[^|]*\| ([\d.]+) x the optimum", page)]
    assert ratios
    assert bounds
    assert all(1.0 - 1.0 / math.e <= ratio <= 1.0 for ratio in ratios)
    assert min(bounds) >= 1.0


def test_names_are_unique_and_unknown_ones_are_refused(capsys: pytest.CaptureFixture) -> None:
    assert len({benchmark.name for benchmark in BENCHMARKS}) == len(BENCHMARKS)
    with pytest.raises(SystemExit):
        main(["--only", "nothing"])
    assert "kernel" in capsys.readouterr().err


def test_what_benchmarks_call_of_modules_is_there() -> None:
    """A benchmark that nobody ran for a while called a function that had moved."""
    missing = []
    for path in Path("tests/benchmarks").glob("*.py"):
        module = importlib.import_module(f"tests.benchmarks.{path.stem}")
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                named = getattr(module, node.value.id, None)
                if isinstance(named, ModuleType) and not hasattr(named, node.attr):
                    missing.append(f"{path.name}:{node.lineno}: {node.value.id}.{node.attr}")
    assert missing == []


@pytest.mark.benchmark
@pytest.mark.parametrize("benchmark", BENCHMARKS, ids=lambda benchmark: benchmark.name)
def test_every_benchmark_runs_quickly(benchmark: Benchmark, tmp_path: Path) -> None:
    assert run_all([benchmark], tmp_path, True) == 0


@pytest.mark.slow
def test_commands_are_measured_and_their_errors_told() -> None:
    with pytest.raises(RuntimeError, match=r"error: .*nowhere\.json"):
        run_command(["check", "nowhere.json", "nowhere.json"])


def test_nearest_neighbour_sorties_visit_all_stops_within_the_budget() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(0.0, 100.0, (31, 2))
    travel_s = np.linalg.norm(points[:, None] - points[None], axis=2)
    problem = SortieProblem(travel_s, np.full(30, 5.0), 400.0, np.ones(30), math.inf)
    sorties = nearest_sorties(problem)
    assert sorted(stop for sortie in sorties for stop in sortie) == list(range(30))
    assert max(sortie_durations_s(problem, sorties)) <= 400.0
    assert sorties[0][0] == np.argmin(travel_s[0, 1:])


def test_round_trip_errors_do_not_depend_on_the_order_of_views() -> None:
    rng = np.random.default_rng(0)
    sent = ViewpointArrays(rng.uniform(0.0, 50.0, (20, 3)), rng.uniform(-3.1, 3.1, 20), rng.uniform(-1.0, 0.5, 20))
    order = rng.permutation(20)
    back = ViewpointArrays(
        sent.positions_enu_m[order] + [0.003, 0.0, 0.0], sent.heading_rad[order] + 2.0 * np.pi, sent.pitch_rad[order]
    )
    metres, degrees = largest_errors(sent, back)
    assert metres == pytest.approx(0.003)
    assert degrees == pytest.approx(0.0, abs=1e-9)
    assert math.isinf(largest_errors(sent, ViewpointArrays(*(column[:19] for column in sent)))[0])


def test_flight_around_a_building_stops_only_for_photos() -> None:
    path = ring_flight(2, 5)
    n_legs = len(path.is_stop) - 1
    assert path.is_stop.sum() == 2 + len(range(5, n_legs, 5))
    np.testing.assert_allclose(np.linalg.norm(path.deltas_enu_m, axis=1), 8.0, rtol=0.02)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (9292.0, "9292"), (10080.0, "10 080"), (12345.678, "12 350"), (0.012345, "0.01235"), (99.99, "99.99")],
)
def test_numbers_have_four_digits(value: float, text: str) -> None:
    assert number_text(value) == text
