"""`demo`: the whole main job on a bundled site."""

import pytest

from groundstation.cli.commands.demo import SCENES as OFFERED
from missions.formats.registry import read_missions
from planning.plan import read_plan
from planning.site.bundled import SCENES


def test_every_bundled_site_is_offered():
    assert sorted(OFFERED) == sorted(SCENES)


@pytest.mark.long
def test_demo_plans_checks_and_exports_and_says_where_things_are(reflight, tmp_path):
    folder = tmp_path / "new folder" / "ä"
    done = reflight("demo", "--scene", "single-panel", "--out", folder)
    assert done.status == 0
    assert "ready to fly" in done.out
    for path in folder.iterdir():
        assert str(path) in done.out
    of_missions = {".kmz", ".plan", ".waypoints", ".kml", ".csv"}
    assert {path.suffix for path in folder.iterdir()} == {".json", ".proof", ".py", ".html"} | of_missions
    assert reflight("check", folder / "single-panel.plan.json", folder / "single-panel.site.json").status == 0


@pytest.mark.slow
def test_json_names_all_files(reflight, tmp_path):
    done = reflight("demo", "--scene", "roof", "--out", tmp_path, "--json")
    assert (done.status, done.err) == (0, "")
    assert done.json["flyable"] is True
    plan = read_plan(tmp_path / "roof.plan.json")
    assert done.json["views"] == len(plan.viewpoints)
    assert done.json["covered"] >= 0.99 * done.json["reachable_upper_bound"]
    photos = {
        path: sum(mission.n_photos for mission in read_missions(tmp_path / path)) for path in done.json["missions"]
    }
    assert set(photos.values()) == {len(plan.viewpoints)}


@pytest.mark.parametrize("name", ["file", "/proc/demo"])
def test_a_folder_that_cannot_be_made_is_refused(reflight, tmp_path, name):
    (tmp_path / "file").write_text("")
    assert "cannot be made" in reflight("demo", "--out", tmp_path / name).error
