"""`check`: every rule with its measured value, and status 1 where one is broken."""

import shutil

import pytest

from planning.site.bundled import write_scene


def test_a_good_plan_is_ready_to_fly_and_the_next_command_is_told(reflight, pane):
    done = reflight("check", pane / "plan.json", pane / "site.json")
    assert done.status == 0
    # Six views are far from all that could be covered of the pane, and that is said, too.
    unknown = "zones, sun, batteries' temperature"
    assert done.out.splitlines()[-1] == f"ready to fly, but read 1 warning above; not looked at: {unknown}"
    dated = reflight("check", pane / "plan.json", pane / "site.json", "--at", "2026-06-21T10:30", "--temperature", 20)
    assert dated.out.splitlines()[-1].endswith("; not looked at: zones")
    assert "warning  coverage-far: " in done.out
    assert "smallest distance at a viewpoint" in done.out
    assert done.err.startswith("next: app.py export ")
    assert done.err.rstrip("\n").endswith(
        "--format dji-kmz -o " + str(pane / "plan.json").removesuffix(".json") + ".kmz"
    )


def test_json_lists_all_findings_with_values(reflight, pane):
    done = reflight("check", pane / "plan.json", pane / "site.json", "--json")
    assert (done.status, done.err) == (0, "")
    assert done.json["flyable"] is True
    by_code = {finding["code"]: finding for finding in done.json["findings"]}
    assert by_code["distance"]["value"] >= by_code["distance"]["limit"] == 10.0
    assert {finding["severity"] for finding in done.json["findings"]} == {"ok", "note", "warning"}
    assert done.json["readiness"] == "with-warnings"
    assert {finding["code"] for finding in done.json["findings"] if finding["severity"] == "note"} == {
        *("sun", "cold", "glass-sensing", "zones", "terrain")
    }


def test_the_day_of_the_flight_is_looked_at(reflight, pane):
    day = ("--at", "2026-06-21T04:30+00:00", "--temperature", -25)
    by_code = {
        f["code"]: f for f in reflight("check", pane / "plan.json", pane / "site.json", *day, "--json").json["findings"]
    }
    assert {code for code in by_code if code.startswith("sun")}
    assert by_code["cold"]["severity"] in ("ok", "warning")
    assert "-25 degrees" in by_code["cold"]["message"]


@pytest.mark.parametrize(
    ("option", "text"),
    [
        (("--at", "noon"), "--at: expected a time such as 2026-06-21T10:30, got 'noon'"),
        (("--at", "2026-06-21"), "--at: expected a time such as"),
        (("--at", "2026-13-21T10:30"), "--at: expected a time such as"),
        (("--at", "0001-01-01T00:00"), "--at: expected a time such as"),
        (("--temperature", 300), "--temperature: expected -60 to 60, got 300"),
    ],
)
@pytest.mark.parametrize("command", ["check", "brief"])
def test_days_that_are_none_are_refused(reflight, pane, tmp_path, command, option, text):
    out = ["-o", tmp_path / "b.html"] if command == "brief" else []
    assert text in reflight(command, pane / "plan.json", pane / "site.json", *out, *option).error
    assert not (tmp_path / "b.html").exists()


def test_a_broken_rule_is_an_error_with_place_and_status_1(reflight, pane, changed):
    plan = changed(pane / "plan.json", "viewpoints", 2, "position_enu_m", [0.0, -3.0, 10.0])
    done = reflight("check", plan, pane / "site.json")
    assert done.status == 1
    assert "  ERROR  distance [v0002]: smallest distance at a viewpoint (negative: inside a solid): 3 m" in done.out
    assert done.out.splitlines()[-1] == "not ready to fly: see the errors above"
    assert done.err == ""
    done = reflight("check", plan, pane / "site.json", "--json")
    assert done.status == 1
    assert done.json["flyable"] is False


def test_a_plan_for_another_site_is_not_ready_to_fly(reflight, pane, tmp_path):
    other = write_scene("office", tmp_path)
    done = reflight("check", pane / "plan.json", other)
    assert done.status == 1
    assert "not ready to fly" in done.out


def test_a_plan_without_views_is_not_ready_to_fly(reflight, pane, changed):
    plan = changed(changed(pane / "plan.json", "sorties", []), "viewpoints", [])
    done = reflight("check", plan, pane / "site.json")
    assert done.status == 1
    assert "the plan has no sorties" in done.out


def test_files_that_are_no_plan_are_refused(reflight, pane, bad_file):
    assert str(bad_file) in reflight("check", bad_file, pane / "site.json").error
    assert str(bad_file) in reflight("check", pane / "plan.json", bad_file).error


def test_plan_and_site_in_the_wrong_order_are_noticed(reflight, pane):
    error = reflight("check", pane / "site.json", pane / "plan.json").error
    assert "expected a plan file (such as office.plan.json), found a site" in error


@pytest.mark.parametrize(
    ("path_and_value", "message"),
    [
        (("camera", ...), "missing required field 'camera'"),
        (("camera", "focal_length_mm", -1), "focal_length_mm: expected a positive number, got -1"),
        (("viewpoints", 0, "heading_deg", "north"), "viewpoints[0].heading_deg: expected number, got text"),
        (("viewpoints", 0, "heading_deg", float("inf")), "viewpoints[0].heading_deg: expected a finite number"),
        (("viewpoints", 1, "id", "v0000"), "expected unique ids, 'v0000' occurs twice"),
        (("sorties", 0, "viewpoint_ids", ["v9"]), "sorties[0].viewpoint_ids: there is no viewpoint 'v9'"),
        (("coverage", "covered", 10**9), "covered <= reachable_upper_bound <= total"),
        (("constraints", "min_distance_m", -1), "min_distance_m: expected 0 or more, got -1"),
        (("format", "reflight-plan/2"), "expected 'reflight-plan/1', got 'reflight-plan/2'"),
    ],
)
def test_wrong_fields_of_a_plan_are_named(reflight, pane, changed, path_and_value, message):
    plan = changed(pane / "plan.json", *path_and_value)
    error = reflight("check", plan, pane / "site.json").error
    assert str(plan) in error
    assert message in error


def test_a_mesh_that_was_left_behind_is_named_with_what_to_do(reflight, pane, tmp_path):
    folder = tmp_path / "stick"
    folder.mkdir()
    site = shutil.copy(write_scene("roof", tmp_path), folder)
    error = reflight("check", pane / "plan.json", site).error
    assert f"{site}: building_mesh: {folder / 'roof.ply'}: there is no such mesh file" in error
    assert "the folder of the site file" in error
