"""After the warm-up at set-up, planning compiles nothing more: no kernel is written to the cache by a fresh process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from planning.base.progress import COMPILING
from planning.site.bundled import write_scene

REPOSITORY = Path(__file__).resolve().parents[2]

pytestmark = [pytest.mark.slow, pytest.mark.timeout(7200)]
"""All kernels are compiled anew, some two minutes of processor time each time: on a busy machine ten times as long."""

PLANS = """
from planning.checks import check_plan
from planning.parameters import Constraints, FlightRules
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.parameters import GreedyParameters
from planning.site.bundled import SCENES

fine, coarse = Constraints(section_step_deg=15.0), Constraints(whole_panel=True, max_distance_m=40.0)
by_area = GreedyParameters(solid_angle_weights=True)
cases = [
    ("office", {"n_views": 40}), ("tower", {}), ("court", {}), ("court", {"constraints": fine}),
    ("office", {"precision": "f64"}), ("library", {"precision": "f64", "constraints": fine}),
    ("office", {"n_batteries": 2}), ("office", {"n_batteries": 1, "greedy": by_area}),
    ("canyon", {"n_views": 300, "constraints": coarse}), ("roof", {"method": "pso", "n_views": 20}),
    ("library", {"method": "noto"}), ("office", {"method": "orbit", "constraints": fine}),
    ("court", {"rules": FlightRules(turn_in_flight=True, battery_reserve=0.8)}), ("single-panel", {}),
]
for scene, wanted in cases:
    model = SCENES[scene]()
    check_plan(plan_flight(model, PlanRequest(time_budget_s=5.0, **wanted)).plan, model)
"""


def run(*arguments: str, cache: Path) -> dict[Path, int]:
    """Run Python in a fresh process; files of compiled kernels afterwards, with the time of their last change."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(cache)}
    subprocess.run([sys.executable, *arguments], cwd=REPOSITORY, env=environment, check=True)
    return {path: path.stat().st_mtime_ns for path in cache.rglob("*") if path.suffix in (".nbi", ".nbc")}


def test_nothing_is_left_to_compile_after_the_warm_up(tmp_path: Path) -> None:
    warm = run("-m", "planning.warm_up", cache=tmp_path)
    assert len(warm) > 100
    assert run("-c", PLANS, cache=tmp_path) == warm


def test_the_first_plan_of_an_installation_compiles_before_its_time_budget_begins(tmp_path: Path) -> None:
    site = write_scene("office", tmp_path)
    command = [
        sys.executable,
        "app.py",
        "plan",
        str(site),
        "-o",
        str(tmp_path / "p.json"),
        "--time-budget",
        "5",
        "--json",
    ]
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    codes, told = [], []
    for _ in range(2):
        done = subprocess.run(command, cwd=REPOSITORY, env=environment, check=True, capture_output=True, text=True)
        told.append(done.stderr.count(COMPILING))
        codes.append([finding["code"] for finding in json.loads(done.stdout)["findings"]])
    assert "compiled" in codes[0]
    assert "compiled" not in codes[1]
    assert told == [1, 0], "off a terminal, too, it is said why nothing comes for a while"
