"""`plan`: what was asked for is planned, printed and written, or refused in the user's words with nothing written."""

import json
import os
import re
import shutil
from pathlib import Path

import pytest

from planning.aircraft.catalogue import profiles
from planning.plan import read_plan

QUICK = ("--time-budget", 1)


def plan_json(reflight, site, out, *options):
    done = reflight("plan", site, "-o", out, "--json", *QUICK, *options)
    assert done.status == 0, done.err
    assert done.err == ""
    return done.json


@pytest.mark.long
def test_json_holds_what_the_contract_promises_and_agrees_with_the_file(reflight, pane, tmp_path):
    out = tmp_path / "plan.json"
    told = plan_json(reflight, pane / "site.json", out, "--views", 9)
    plan = read_plan(out)
    assert told["views"] == len(plan.viewpoints) == 9
    assert told["covered"] == plan.coverage.covered <= told["reachable_upper_bound"] <= told["total"] == 36
    assert told["occlusion"] == plan.constraints.occlusion == "off"
    assert told["method"] == plan.method == "greedy"
    assert told["sorties"] == len(plan.sorties) == 1
    assert told["duration_s"] == pytest.approx(plan.duration_s, abs=0.1)
    assert told["seconds"] > 0.0


@pytest.mark.long
def test_text_tells_the_pilot_the_result_and_the_next_command(reflight, pane, tmp_path):
    site, out = tmp_path / "my site.json", tmp_path / "plän.json"
    shutil.copy(pane / "site.json", site)
    done = reflight("plan", site, "-o", out, "--views", 1, *QUICK)
    assert done.status == 0
    assert f"{out}: 1 view in 1 sortie, " in done.out
    assert "of 36 directions of view (36 for each of 1 panel)" in done.out
    assert "occlusion: off - " in done.out
    assert done.err.splitlines()[-1] == f"next: app.py check '{out}' '{site}'"


@pytest.mark.slow
def test_a_lower_flight_is_asked_for_by_an_option_and_warned_of(reflight, pane, tmp_path):
    out = tmp_path / "plan.json"
    usual = reflight("plan", pane / "site.json", "-o", out, "--views", 9, *QUICK)
    assert re.search(r"lowest flight [56789]\.\d m above the ground, \d+\.\d min below 10 m", usual.out)
    low = reflight("plan", pane / "site.json", "-o", out, "--views", 9, "--min-height", 2.5, *QUICK)
    assert low.status == 0
    assert "flights down to 2.5 m above the ground are allowed, below the usual 5 m" in low.err
    assert reflight("check", out, pane / "site.json").status == 0
    wrong = reflight("plan", pane / "site.json", "-o", out, "--min-height", -1, *QUICK)
    assert (wrong.status, wrong.err.strip()) == (1, "error: --min-height: expected 0 m or more, got -1.0")
    high = reflight("plan", pane / "site.json", "-o", out, "--min-height", 300, *QUICK)
    assert high.status == 1
    assert "flights keep 300 m from it; raise the ceiling, or allow lower flights" in high.err


@pytest.mark.few(2)
@pytest.mark.parametrize("method", ["greedy", "pso", "noto", "orbit"])
def test_every_method_gives_a_plan_that_is_ready_to_fly(reflight, pane, tmp_path, method):
    out = tmp_path / "plan.json"
    told = plan_json(reflight, pane / "site.json", out, "--method", method, "--views", 4)
    assert told["method"] == method
    assert 0 < told["covered"] <= told["views"] <= 4
    assert reflight("check", out, pane / "site.json").status == 0


@pytest.mark.slow
def test_the_three_goals_are_met(reflight, pane, tmp_path):
    site, out = pane / "site.json", tmp_path / "plan.json"
    half = plan_json(reflight, site, out, "--coverage", 0.5, "--time-budget", 600)
    assert 0.5 <= half["covered"] / half["reachable_upper_bound"] < 0.6
    one_battery = plan_json(reflight, site, out, "--batteries", 1, "--objective", "sections")
    assert one_battery["sorties"] == 1
    # Of a battery all time is searched that the budget leaves; a machine with other work finds a little less.
    assert one_battery["covered"] >= 0.8 * one_battery["reachable_upper_bound"]


@pytest.mark.long
def test_every_other_option_reaches_the_plan(reflight, pane, tmp_path):
    out = tmp_path / "plan.json"
    options = ["--profile", "m4e", "--min-distance", 8, "--step", 45, "--occlusion", "on", "--max-distance", 30]
    options += ["--whole-panel", "--reserve", 0.4, "--settle", 1.5, "--speed", 5, "--wind", 3, "--turn-in-flight"]
    options += ["--seed", 7, "--precision", "f64", "--candidates", 500, "--weights", "solid-angle", "--max-gsd", 9]
    options += ["--wanted-gsd", 4, "--objective", "sections"]
    told = plan_json(reflight, pane / "site.json", out, "--views", 4, *options)
    plan = read_plan(out)
    assert (plan.profile, plan.aircraft.name, plan.seed) == ("m4e", "DJI M4E", 7)
    assert (plan.constraints.min_distance_m, plan.constraints.section_step_deg) == (8.0, 45.0)
    assert plan.constraints.whole_panel
    assert plan.constraints.max_distance_m == 30.0
    assert plan.constraints.wanted_gsd_mm == told["wanted_gsd_mm"] == 4.0
    assert told["sharp"] == plan.coverage.sharp < told["covered"]
    assert plan.constraints.occlusion == told["occlusion"] == "on"
    assert plan.effects[0].decided_by == "user"
    rules = plan.rules
    assert (rules.battery_reserve, rules.settle_s, rules.max_speed_m_s, rules.wind_m_s) == (0.4, 1.5, 5.0, 3.0)
    assert rules.turn_in_flight
    assert told["total"] == 16


@pytest.mark.long
def test_a_pixel_size_becomes_the_distance_at_which_the_camera_reaches_it(reflight, pane, tmp_path):
    out = tmp_path / "plan.json"
    plan_json(reflight, pane / "site.json", out, "--views", 2, "--max-gsd", 5)
    plan = read_plan(out)
    assert plan.camera.gsd_m(plan.constraints.max_distance_m) == pytest.approx(0.005)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_views(reflight, pane, tmp_path):
    plans = []
    for name in ("a.json", "b.json"):
        plan_json(reflight, pane / "site.json", tmp_path / name, "--views", 5, "--seed", 3, "--time-budget", 60)
        plans.append(read_plan(tmp_path / name))
    assert plans[0].viewpoints == plans[1].viewpoints


@pytest.mark.slow
def test_locked_viewpoints_of_another_plan_are_kept(reflight, pane, changed, tmp_path):
    site, out = pane / "site.json", tmp_path / "new.json"
    old = changed(pane / "plan.json", "viewpoints", 2, "locked", True)
    told = plan_json(reflight, site, out, "--views", 5, "--seed", 4, "--keep", old)
    kept = [viewpoint for viewpoint in read_plan(out).viewpoints if viewpoint.locked]
    assert kept == [read_plan(old).viewpoints[2]]
    assert told["views"] == 5
    assert reflight("check", out, site).status == 0
    again = plan_json(reflight, site, out, "--coverage", 0.2, "--keep", out)
    assert again["views"] >= 1
    assert [viewpoint for viewpoint in read_plan(out).viewpoints if viewpoint.locked] == kept
    two = changed(old, "viewpoints", 3, "locked", True)
    assert "--views: expected at least the 2 locked ones, got 1" in (
        reflight("plan", site, "-o", out, "--views", 1, "--keep", two).error
    )
    assert "none of the viewpoints is locked" in reflight("plan", site, "-o", out, "--keep", pane / "plan.json").error
    assert "'orbit' cannot keep locked viewpoints" in (
        reflight("plan", site, "-o", out, "--method", "orbit", "--keep", old).error
    )
    beside = changed(old, "viewpoints", 2, "position_enu_m", [0.0, -1.0, 10.0])
    assert "is locked, but cannot be flown: it is" in reflight("plan", site, "-o", out, "--keep", beside).error


@pytest.mark.slow
def test_less_than_was_asked_for_is_said(reflight, pane, tmp_path):
    out = tmp_path / "plan.json"
    done = reflight("plan", pane / "site.json", "-o", out, "--method", "noto", "--coverage", 0.9, *QUICK)
    assert done.status == 0
    assert "% of what is possible at most, 90 % were asked for; the method flies a pattern of its own" in done.err
    done = reflight("plan", pane / "site.json", "-o", out, "--views", 20_000, *QUICK, "--time-budget", 600)
    assert f"{len(read_plan(out).viewpoints)} views instead of the 20000 asked for" in done.err


@pytest.mark.parametrize("command", [["plan"], ["import"]])
def test_profiles_are_listed_where_one_is_asked_for(reflight, command):
    done = reflight(*command, "--profile", "list")
    assert done.status == 0
    assert [line.split()[0] for line in done.out.splitlines()] == list(profiles())
    assert "DJI M3E, 42 min, 15 m/s, wind up to 12 m/s; " in done.out
    assert "gimbal -90 to 35 deg" in done.out


WRONG_VALUES = [
    (["--views", 0], "--views: expected 1 to 20000, got 0"),
    (["--views", -3], "--views: expected 1 to 20000, got -3"),
    (["--coverage", 1.5], "--coverage: expected more than 0 and at most 1, got 1.5"),
    (["--batteries", 0], "--batteries: expected 1 to 100, got 0"),
    (["--min-distance", -10], "--min-distance: expected 0 or more, got -10"),
    (["--min-distance", 500], "home"),
    (["--step", 7], "--step: expected a divisor of 90"),
    (["--max-distance", 5], "--max-distance: expected more than the minimum distance 10"),
    (["--max-gsd", 0.01], "--max-gsd: this camera has pixels of 0.01 mm at 0.04 m"),
    (["--max-gsd", 0], "--max-gsd: expected a positive number"),
    (["--wanted-gsd", -1], "--wanted-gsd: expected 0 mm or more, got -1"),
    (["--time-budget", 0], "--time-budget: expected more than 0 s"),
    (["--reserve", 1], "--reserve: expected 0 to below 1"),
    (["--settle", -1], "--settle: expected 0 or more"),
    (["--speed", 0], "--speed: expected a positive speed"),
    (["--wind", -1], "--wind: expected 0 or more"),
    (["--wind", 30], "DJI M3E may fly in wind below 12 m/s"),
    (["--seed", -1], "--seed: expected 0 to 9223372036854775807, got -1"),
    (["--seed", 2**63], "--seed: expected 0 to 9223372036854775807"),
    (["--candidates", 0], "--candidates: expected 1 to 1000000"),
    (["--profile", "kite"], "there is no aircraft profile 'kite'; known are: ardupilot, m30"),
    (["--method", "pso", "--batteries", 2], "'greedy' can"),
    (["--coverage", 0.5, "--objective", "image-error"], "--objective: a share of what can be covered is planned by"),
    (["--method", "pso", "--coverage", 0.9], "--views N"),
]


@pytest.mark.long
@pytest.mark.parametrize(("options", "message"), WRONG_VALUES)
def test_wrong_values_are_refused_with_the_option_that_was_typed(reflight, pane, tmp_path, options, message):
    assert message in reflight("plan", pane / "site.json", "-o", tmp_path / "p.json", "--json", *options).error
    assert list(tmp_path.iterdir()) == []


def test_a_method_of_a_settings_file_that_there_is_not_is_refused_with_file_and_key(reflight, pane, tmp_path):
    settings = tmp_path / "mine.toml"
    settings.write_text('method = "swarm"\n')
    error = reflight("plan", pane / "site.json", "-o", tmp_path / "p.json", "--settings", settings).error
    assert f"{settings}: method: there is no planning method 'swarm'; known are: greedy, pso, noto, orbit" in error


def test_files_that_are_no_site_are_refused_and_nothing_is_written(reflight, bad_file, tmp_path):
    out = tmp_path / "p.json"
    out.write_text("old")
    assert str(bad_file) in reflight("plan", bad_file, "-o", out).error
    assert out.read_text() == "old"
    assert sorted(tmp_path.iterdir()) == [bad_file, out]


def test_a_plan_instead_of_a_site_is_named_as_such(reflight, pane, tmp_path):
    error = reflight("plan", pane / "plan.json", "-o", tmp_path / "p.json").error
    assert "expected a site file (such as office.site.json), found a plan" in error


@pytest.mark.parametrize(
    ("path_and_value", "message"),
    [
        (("origin", "lat_deg", "north"), "origin.lat_deg: expected number, got text"),
        (("home_enu_m", ...), "missing required field 'home_enu_m'"),
        (("home_enu_m", [0, 0]), "home_enu_m: expected list of length 3, got 2"),
        (("home_enu_m", [0.0, 0.0, float("nan")]), "home_enu_m[2]: expected a finite number"),
        (("building_mesh", "gone.ply"), "building_mesh: "),
        (("building_mesh", ""), "building_mesh: "),
        (("building_mesh", 5), "building_mesh: expected text or nothing, got whole number"),
        (("format", "reflight-site/9"), "expected 'reflight-site/1', got 'reflight-site/9'"),
        (("facades", []), "facades: expected at least one panel"),
    ],
)
def test_wrong_fields_of_a_site_are_named(reflight, pane, changed, tmp_path, path_and_value, message):
    site = changed(pane / "site.json", *path_and_value)
    error = reflight("plan", site, "-o", tmp_path / "p.json").error
    assert str(site) in error
    assert message in error


@pytest.mark.long
def test_fields_that_others_added_and_a_byte_order_mark_do_no_harm(reflight, pane, changed, tmp_path):
    site = changed(pane / "site.json", "weather", {"sky": "clear"})
    site.write_bytes(b"\xef\xbb\xbf" + site.read_bytes())
    assert plan_json(reflight, site, tmp_path / "p.json", "--views", 1)["views"] == 1


@pytest.mark.parametrize(
    ("out", "message"),
    [
        ("no such folder/p.json", "there is no folder"),
        (".", "this is a folder"),
        ("site.json", "would replace"),
        ("link.json", "would replace"),
    ],
)
def test_an_output_that_cannot_be_written_is_refused_before_the_work(
    reflight, pane, tmp_path, monkeypatch, out, message
):
    shutil.copy(pane / "site.json", tmp_path)
    (tmp_path / "link.json").symlink_to("site.json")
    before = (tmp_path / "site.json").read_bytes()
    monkeypatch.setattr("groundstation.services.plan.planning.plan_flight", lambda *_: pytest.fail("it was planned"))
    assert message in reflight("plan", tmp_path / "site.json", "-o", tmp_path / out).error
    assert (tmp_path / "site.json").read_bytes() == before


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="devices of a POSIX system")
def test_a_device_is_written_to_and_not_replaced(reflight, pane):
    assert plan_json(reflight, pane / "site.json", "/dev/null", "--views", 1)["views"] == 1
    assert Path("/dev/null").is_char_device()
    assert "/dev/full: cannot be written (No space left on device)" in (
        reflight("plan", pane / "site.json", "-o", "/dev/full", "--views", 1, *QUICK).error
    )


@pytest.mark.long
def test_a_full_disk_leaves_the_old_plan(reflight, pane, tmp_path, monkeypatch):
    out = tmp_path / "p.json"
    out.write_text("old")
    monkeypatch.setattr("os.fsync", lambda _fd: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    assert "No space left" in reflight("plan", pane / "site.json", "-o", out, "--views", 1, *QUICK).error
    assert out.read_text() == "old"
    assert list(tmp_path.iterdir()) == [out]


@pytest.mark.long
def test_stdout_holds_one_json_object_and_nothing_else_in_a_real_process(process, pane, tmp_path):
    done = process("plan", pane / "site.json", "-o", tmp_path / "p.json", "--views", 2, "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["views"] == 2
    assert done.stderr == ""
