"""Proofs of plans and the verifier: what planning writes is proved, and each claim breaks with what it rests on."""

from __future__ import annotations

import ast
import copy
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from groundstation.services.mission.export import export_plan
from groundstation.services.mission.proof import PAGE, VERIFIER, verified
from groundstation.services.plan.planning import plan_site
from planning.geo.height_field import HeightField
from planning.geo.mesh import write_mesh
from planning.parameters import Constraints, GreedyParameters
from planning.proof.make import proof_of, proof_path
from planning.proof.reflight_verify import CLAIMS, Case, Mission, Solids, flies, judged
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site, write_site
from planning.site.terrain import terrain_of
from tests.planning.plan_cases import kiosk

Change = Callable[[dict[str, Any]], None]

FEW = PlanRequest(
    n_views=12,
    time_budget_s=600.0,
    constraints=Constraints(section_step_deg=45.0),
    greedy=GreedyParameters(n_candidates=200, improve=False, objective="sections"),
)


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a planned site that has a building, an obstacle, a no-fly volume and occlusion."""
    folder = tmp_path_factory.mktemp("kiosk")
    model = kiosk()
    write_mesh(folder / "kiosk.ply", model.building)
    write_site(folder / "kiosk.site.json", model.site)
    plan_site(folder / "kiosk.site.json", FEW, folder / "kiosk.plan.json")
    export_plan(folder / "kiosk.plan.json", "dji-kmz", folder / "kiosk.kmz")
    export_plan(folder / "kiosk.plan.json", "mavlink-wpl", folder / "kiosk.waypoints")
    export_plan(folder / "kiosk.plan.json", "mavlink-plan", folder / "kiosk.plan")
    return folder


def verdicts(folder: Path, *missions: str) -> dict[str, str]:
    """Verdicts of all claims, by their names."""
    files = folder / "kiosk.site.json", folder / "kiosk.plan.json", folder / "kiosk.plan.proof"
    return {claim.id: claim.verdict for claim in verified(*files, [folder / name for name in missions])}


def verdict(folder: Path, claim: str) -> str:
    """Verdict of one claim alone, which takes less time than all of them."""
    names = ("kiosk.site.json", "kiosk.plan.json", "kiosk.plan.proof")
    contents = [(folder / name).read_bytes() for name in names]
    return judged(lambda: dict(CLAIMS)[claim](Case(folder, contents)))[0]


def test_all_claims_on_a_planned_flight_are_proved(planned: Path) -> None:
    found = verdicts(planned, "kiosk.kmz", "kiosk.waypoints", "kiosk.plan")
    assert set(found.values()) == {"proved"}, found
    assert list(found)[:12] == [
        *("files", "sorties", "gimbal", "airspace", "distance", "no-fly", "zones", "return", "battery", "apart"),
        *("coverage", "reachable"),
    ]


def test_a_proof_is_made_without_the_tree_that_only_checking_needs(
    planned: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes longer than all the rest on the mesh of an IFC office."""
    site, plan = planned / "kiosk.site.json", planned / "kiosk.plan.json"
    written = (planned / "kiosk.plan.proof").read_bytes()

    def refused(*_: Any) -> None:
        raise AssertionError("a tree was built")

    monkeypatch.setattr(Solids, "_boxes", refused)
    model = read_site(site)
    made = proof_of(site, plan, plan.read_bytes(), model, known=json.loads(written))
    assert json.loads(made)["legs"] == json.loads(written)["legs"]
    with pytest.raises(AssertionError, match="a tree was built"):
        _ = Case(planned, [site.read_bytes(), plan.read_bytes(), made]).solids.tree


def test_the_verifier_runs_alone_from_the_folder_of_a_mission(planned: Path, tmp_path: Path) -> None:
    export_plan(planned / "kiosk.plan.json", "dji-kmz", tmp_path / "flight.kmz")
    assert (tmp_path / PAGE.name).read_bytes() == PAGE.read_bytes()
    alone = [sys.executable, "-I", "-S", str(tmp_path / VERIFIER.name), str(tmp_path), "--json"]
    done = subprocess.run(alone, capture_output=True, text=True, check=False)
    claims = json.loads(done.stdout)["claims"]
    assert done.returncode == 0, claims
    assert [claim["id"] for claim in claims][-2:] == ["mission flight.kmz", "missions"]


def moved(plan: dict[str, Any]) -> None:
    plan["viewpoints"][0]["position_enu_m"][0] += 0.5


def nearer(plan: dict[str, Any]) -> None:
    """A corner of the path right before the facade."""
    plan["sorties"][0]["path_enu_m"].insert(2, [0.0, -3.0, 5.0])


def too_high(plan: dict[str, Any]) -> None:
    plan["sorties"][0]["path_enu_m"].insert(2, [0.0, -30.0, 41.0])


def into_the_zone(plan: dict[str, Any]) -> None:
    plan["sorties"][0]["path_enu_m"].insert(2, [-25.0, -30.0, 20.0])


def turned(plan: dict[str, Any]) -> None:
    for viewpoint in plan["viewpoints"]:
        viewpoint["heading_deg"] = 90.0


def tilted(plan: dict[str, Any]) -> None:
    plan["viewpoints"][0]["gimbal_pitch_deg"] = 80.0


def hurried(plan: dict[str, Any]) -> None:
    plan["aircraft"]["endurance_s"] = 100.0


def together(plan: dict[str, Any]) -> None:
    plan["rules"]["at_once"] = 2


def more_covered(plan: dict[str, Any]) -> None:
    plan["coverage"]["covered"] += 1


def covered_below_zero(plan: dict[str, Any]) -> None:
    plan["coverage"]["covered"] = -1


def less_reachable(plan: dict[str, Any]) -> None:
    plan["coverage"]["reachable_upper_bound"] -= 1


@pytest.mark.parametrize(
    ("change", "broken"),
    [
        (moved, "sorties"),
        (nearer, "distance"),
        (too_high, "airspace"),
        (into_the_zone, "no-fly"),
        (turned, "coverage"),
        (tilted, "gimbal"),
        (hurried, "battery"),
        (together, "apart"),
        (more_covered, "coverage"),
        (covered_below_zero, "coverage"),
        (less_reachable, "reachable"),
    ],
)
def test_a_changed_plan_is_told_by_the_claim_that_broke(
    planned: Path, tmp_path: Path, change: Change, broken: str
) -> None:
    folder = with_changed(planned, tmp_path, "kiosk.plan.json", change)
    assert verdict(folder, broken) != "proved"
    assert verdict(folder, "files") == "false"


def taller(site: dict[str, Any]) -> None:
    site["obstacles"][0]["box_enu_m"] = [[-6.0, -25.0, 0.0], [6.0, -24.0, 11.0]]


def without_no_fly_check(proof: dict[str, Any]) -> None:
    proof["no_fly"] = []


def with_longer_directions(proof: dict[str, Any]) -> None:
    proof["directions"] = [[2.0 * x for x in each] for each in proof["directions"]]


def with_others_boxes(proof: dict[str, Any]) -> None:
    elements = [element for element, _ in proof["boxes"]]
    proof["boxes"] = [
        [element, text] for element, (_, text) in zip(elements, proof["boxes"][1:] + proof["boxes"][:1], strict=True)
    ]


def with_a_low_return(proof: dict[str, Any]) -> None:
    proof["return_height_m"] = 2.0


def with_other_views(proof: dict[str, Any]) -> None:
    proof["seen"] = [view if view < 0 else 0 for view in proof["seen"]]


@pytest.mark.parametrize(
    ("change", "broken"),
    [
        (without_no_fly_check, "no-fly"),
        (with_others_boxes, "reachable"),
        (with_a_low_return, "return"),
        (with_other_views, "coverage"),
        (with_longer_directions, "distance"),
    ],
)
def test_a_wrong_proof_proves_nothing(planned: Path, tmp_path: Path, change: Change, broken: str) -> None:
    assert verdict(with_changed(planned, tmp_path, "kiosk.plan.proof", change), broken) == "not proved"


def test_a_site_that_grew_is_not_kept_away_from(planned: Path, tmp_path: Path) -> None:
    folder = with_changed(planned, tmp_path, "kiosk.site.json", taller)
    assert (verdict(folder, "files"), verdict(folder, "distance")) == ("false", "false")


def test_files_of_geo_zones_leave_only_the_zones_open(planned: Path, tmp_path: Path) -> None:
    folder = with_changed(planned, tmp_path, "kiosk.site.json", lambda site: site.update(zones=[{"file": "uas.json"}]))
    assert [verdict(folder, claim) for claim in ("zones", "no-fly", "distance")] == ["not proved", "proved", "proved"]


@pytest.mark.parametrize("name", ["kiosk.site.json", "kiosk.plan.json", "kiosk.plan.proof"])
@pytest.mark.parametrize("content", [b"", b"{}", b"[1, 2", b'{"format": NaN}', b"\xff\xfe", b"[" * 100_000])
def test_files_that_cannot_be_read_prove_nothing(planned: Path, tmp_path: Path, name: str, content: bytes) -> None:
    folder = shutil.copytree(planned, tmp_path / "damaged")
    (folder / name).write_bytes(content)
    assert set(verdicts(folder, "kiosk.kmz").values()) == {"not proved"}


def test_a_mesh_that_is_missing_or_damaged_proves_nothing(planned: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(planned, tmp_path / "damaged")
    mesh = (folder / "kiosk.ply").read_bytes()
    (folder / "kiosk.ply").write_bytes(mesh[:-1])
    assert set(verdicts(folder).values()) == {"not proved"}
    (folder / "kiosk.ply").unlink()
    assert set(verdicts(folder).values()) == {"not proved"}


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("\t16\t1\t", "\t16\t0\t", "not proved"),
        ("\t3\t16\t", "\t10\t16\t", "not proved"),
        ("22.33", "22.34", "false"),
        ("\t203\t0\t0\t0\t0\t1", "\t203\t0\t0\t0\t0\t0", "not proved"),
    ],
)
def test_a_changed_mission_does_not_fly_the_plan(
    planned: Path, tmp_path: Path, old: str, new: str, expected: str
) -> None:
    folder = shutil.copytree(planned, tmp_path / "changed")
    text = (folder / "kiosk.waypoints").read_text()
    assert old in text
    (folder / "kiosk.waypoints").write_text(text.replace(old, new))
    case = Case(folder, [(folder / f"kiosk.{name}").read_bytes() for name in ("site.json", "plan.json", "plan.proof")])
    mission = (folder / "kiosk.waypoints").read_bytes()
    assert judged(lambda: str(flies(case, Mission(mission, ".waypoints"))))[0] == expected


def with_changed(planned: Path, tmp_path: Path, name: str, change: Change) -> Path:
    folder = shutil.copytree(planned, tmp_path / "changed")
    content = json.loads((folder / name).read_text())
    before = copy.deepcopy(content)
    change(content)
    assert content != before
    (folder / name).write_text(json.dumps(content))
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["office", "library", "court", "canyon", "roof", "single-panel"])
def test_plans_on_bundled_sites_are_proved(tmp_path: Path, scene: str) -> None:
    site, plan = write_scene(scene, tmp_path), tmp_path / f"{scene}.plan.json"
    plan_site(site, PlanRequest(time_budget_s=60.0), plan)
    found = verified(site, plan, proof_path(plan))
    assert {claim.verdict for claim in found} == {"proved"}, found


def planned_above(folder: Path, rise: float) -> dict[str, str]:
    """Verdicts on the kiosk on ground that rises to the north, with waves of 0.3 m."""
    x, y = np.meshgrid(np.arange(-60.0, 61.0, 2.0), np.arange(-60.0, 61.0, 2.0))
    z = rise * y + 0.3 * np.sin(x / 3.0) * np.cos(y / 4.0)
    ground = terrain_of(HeightField(-60.0, -60.0, 2.0, z), z + 0.05, z - 0.05, accuracy_m=0.1)
    model = kiosk(terrain=ground, home_enu_m=(0.0, -30.0, 0.5 - 30.0 * rise))
    write_mesh(folder / "kiosk.ply", model.building)
    write_site(folder / "kiosk.site.json", model.site)
    plan_site(folder / "kiosk.site.json", FEW, folder / "kiosk.plan.json")
    return verdicts(folder)


@pytest.mark.slow
def test_a_plan_above_terrain_that_is_left_out_as_level_is_proved(tmp_path: Path) -> None:
    found = planned_above(tmp_path, rise=0.0)
    assert set(found.values()) == {"proved"}, found
    stated = json.loads((tmp_path / "kiosk.plan.proof").read_text())["level_within_m"]
    assert stated == pytest.approx(0.45, abs=0.01)
    from_terrain = with_changed(
        tmp_path, tmp_path / "held", "kiosk.plan.proof", lambda proof: proof.pop("level_within_m")
    )
    assert verdict(from_terrain, "airspace") == "false"


@pytest.mark.slow
def test_a_plan_on_a_slope_is_proved(tmp_path: Path) -> None:
    found = planned_above(tmp_path, rise=0.2)
    assert set(found.values()) == {"proved"}, found
    steeper = with_changed(
        tmp_path, tmp_path / "steeper", "kiosk.site.json", lambda site: site["terrain"].update(accuracy_m=9.0)
    )
    assert verdict(steeper, "airspace") == "false"


MOST_LINES, MOST_COLUMNS = 858, 120
"""Of the verifier: what can be read in an hour or two. docs/concepts/proof.md states the number."""


@pytest.mark.lint
def test_the_verifier_grows_no_longer() -> None:
    lines = VERIFIER.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= MOST_LINES
    assert max(map(len, lines)) <= MOST_COLUMNS


@pytest.mark.lint
def test_the_verifier_imports_the_standard_library_alone() -> None:
    tree = ast.parse(VERIFIER.read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported <= set(sys.stdlib_module_names)
