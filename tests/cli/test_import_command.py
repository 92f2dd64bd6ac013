"""`import`: missions of ours and of other programs become plans with their coverage, or are refused in words."""

import json
import shutil
import zipfile

import numpy as np
import pytest

from missions.formats.registry import read_missions
from planning.plan import read_plan
from planning.site.file import read_site

ENDINGS = {"dji-kmz": ".kmz", "mavlink-plan": ".plan", "mavlink-wpl": ".waypoints", "kml": ".kml", "csv": ".csv"}

GOOD = {
    "djisdk_psdk_m3e_waypoint_v3_test.kmz": 2,
    "djisdk_msdk_m30_waypointsample.kmz": 0,
    "geoyee_m3t_waypoint.kmz": 16,
    "geoyee_m3d_curtainwall_slope_mapping2d.kmz": 46,
    "tum_m4td_fh2_waypoint_rotateyaw_photo": 1,
    "traitlab_m3e_pilot2_Waypoint2_rtk": 2,
    "mavsdk_qgroundcontrol_sample.plan": 1,
    "mavsdk_mission_planner_sample.txt": 0,
    "px4_multicopter_mission_geofence_avoid.plan": 0,
    "qgc_test_MissionPlanner.waypoints": 0,
}
"""Photos of the missions of other programs that must open."""

REFUSED = {
    "NEG_tum_flat_root_no_wpmz_dir.kmz": "expected both in its folder wpmz",
    "mavsdk_qgroundcontrol_sample_wrong_mission_version.plan": "mission.version is 7; expected 2",
    "traitlab_m3t_edited_75wp": "not on the globe",
    "mavsdk_qgroundcontrol_sample_with_digicam_control.plan": "no waypoint",
    "INDEX.md": "no mission file that is known",
}


@pytest.mark.few(2)
@pytest.mark.parametrize("file_format", sorted(ENDINGS))
def test_what_was_exported_comes_back_with_its_views_and_coverage(reflight, pane, tmp_path, file_format):
    mission, out = tmp_path / f"m{ENDINGS[file_format]}", tmp_path / "back.json"
    assert reflight("export", pane / "plan.json", "--format", file_format, "-o", mission).status == 0
    done = reflight("import", mission, "--site", pane / "site.json", "-o", out, "--json")
    assert (done.status, done.err) == (0, "")
    plan, back = read_plan(pane / "plan.json"), read_plan(out)
    assert done.json["views"] == len(plan.viewpoints)
    assert done.json["sorties"] == 1
    assert done.json["covered"] == plan.coverage.covered == back.coverage.covered
    assert done.json["total"] == plan.coverage.total
    assert done.json["occlusion"] == plan.constraints.occlusion
    assert back.method == "imported"
    assert reflight("check", out, pane / "site.json").status == 0


def test_text_tells_the_result_and_the_next_command(reflight, pane, tmp_path):
    mission, out = tmp_path / "m.kmz", tmp_path / "back.json"
    reflight("export", pane / "plan.json", "--format", "dji-kmz", "-o", mission)
    done = reflight("import", mission, "--site", pane / "site.json", "-o", out)
    assert f"{out}: 6 views in 1 sortie cover 6 of 36 sections; no flight can cover more than " in done.out
    assert done.err.splitlines()[-1] == f"next: app.py check {out} {pane / 'site.json'}"


@pytest.mark.long
@pytest.mark.few(4)
@pytest.mark.parametrize("name", sorted(GOOD))
def test_missions_of_other_programs_open_at_their_own_place(reflight, pane, changed, shared_data, tmp_path, name):
    file = shared_data / "missions" / name
    first = read_missions(file)[0].waypoints[0]
    site = changed(pane / "site.json", "origin", {"lat_deg": first.lat_deg, "lon_deg": first.lon_deg})
    content = json.loads(site.read_text())
    content["origin"]["ellipsoid_height_m"] = first.height_ellipsoid_m or 20.0
    site.write_text(json.dumps(content))
    done = reflight("import", file, "--site", site, "-o", tmp_path / "p.json", "--json")
    assert done.status == 0, done.err
    assert done.json["views"] == GOOD[name] == len(read_plan(tmp_path / "p.json").viewpoints)
    assert all(finding["severity"] != "error" for finding in done.json["findings"])


@pytest.mark.parametrize("name", sorted(GOOD))
def test_missions_of_another_place_are_refused(reflight, pane, shared_data, tmp_path, name):
    error = reflight(
        "import", shared_data / "missions" / name, "--site", pane / "site.json", "-o", tmp_path / "p"
    ).error
    assert "is it the right site?" in error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("name", "message"), sorted(REFUSED.items()))
def test_damaged_missions_are_refused_with_a_reason(reflight, pane, shared_data, tmp_path, name, message):
    error = reflight(
        "import", shared_data / "missions" / name, "--site", pane / "site.json", "-o", tmp_path / "p"
    ).error
    assert message in error
    assert list(tmp_path.iterdir()) == []


def test_photos_plans_and_sites_are_no_missions(reflight, pane, shared_data, tmp_path):
    out = tmp_path / "p.json"
    photo = next((shared_data / "dji" / "photos").iterdir())
    assert "found a photo" in reflight("import", photo, "--site", pane / "site.json", "-o", out).error
    error = reflight("import", pane / "plan.json", "--site", pane / "site.json", "-o", out).error
    assert "found a plan; it needs no import" in error
    assert (
        "found a site; it goes behind --site"
        in reflight("import", pane / "site.json", "--site", pane / "site.json", "-o", out).error
    )


def test_files_that_are_no_mission_or_no_site_are_refused(reflight, pane, bad_file, tmp_path):
    out = tmp_path / "p.json"
    assert str(bad_file) in reflight("import", bad_file, "--site", pane / "site.json", "-o", out).error
    mission = tmp_path / "m.csv"
    reflight("export", pane / "plan.json", "--format", "csv", "-o", mission)
    assert str(bad_file) in reflight("import", mission, "--site", bad_file, "-o", out).error
    assert not out.exists()


@pytest.mark.parametrize(
    ("out", "message"), [("m.csv", "would replace"), ("site.json", "would replace"), ("no/p.json", "no folder")]
)
def test_an_import_never_replaces_what_it_reads(reflight, pane, tmp_path, out, message):
    mission, site = tmp_path / "m.csv", tmp_path / "site.json"
    shutil.copy(pane / "site.json", site)
    reflight("export", pane / "plan.json", "--format", "csv", "-o", mission)
    before = mission.read_bytes(), site.read_bytes()
    assert message in reflight("import", mission, "--site", site, "-o", tmp_path / out).error
    assert (mission.read_bytes(), site.read_bytes()) == before


def test_a_file_that_is_named_twice_is_refused(reflight, pane, tmp_path):
    mission = tmp_path / "m.csv"
    reflight("export", pane / "plan.json", "--format", "csv", "-o", mission)
    error = reflight("import", mission, mission, "--site", pane / "site.json", "-o", tmp_path / "p.json").error
    assert "named twice" in error


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--step", 7], "--step: expected a divisor of 90"),
        (["--min-distance", -1], "--min-distance: expected 0 or more"),
        (["--profile", "kite"], "there is no aircraft profile 'kite'"),
    ],
)
def test_wrong_values_are_refused_with_the_option_that_was_typed(reflight, pane, tmp_path, options, message):
    mission = tmp_path / "m.csv"
    reflight("export", pane / "plan.json", "--format", "csv", "-o", mission)
    done = reflight("import", mission, "--site", pane / "site.json", "-o", tmp_path / "p.json", *options)
    assert message in done.error
    assert not (tmp_path / "p.json").exists()


# --- without a site, and strictly ---


@pytest.mark.parametrize("name", sorted(GOOD))
def test_without_a_site_a_mission_gets_a_bare_one_beside_the_plan(reflight, shared_data, tmp_path, name):
    out = tmp_path / "flown.plan.json"
    done = reflight("import", shared_data / "missions" / name, "-o", out, "--json")
    assert done.status == 0, done.err
    assert done.json["views"] == GOOD[name]
    assert done.json["site"] == str(tmp_path / "flown.site.json")
    assert done.json["total"] == 0
    site, plan = read_site(tmp_path / "flown.site.json"), read_plan(out)
    assert site.site.is_bare
    assert plan.site_sha256 == site.sha256
    low, high = np.array(site.site.airspace.min_enu_m), np.array(site.site.airspace.max_enu_m)
    path = np.array([point for sortie in plan.sorties for point in sortie.path_enu_m])
    assert ((path[:, :2] > low[:2]) & (path[:, :2] < high[:2])).all()
    assert (path[:, 2] < high[2]).all()
    again = reflight("import", shared_data / "missions" / name, "--site", tmp_path / "flown.site.json", "-o", out)
    assert again.status == 0, again.err
    assert "the site has no panels that they could cover" in again.out


def test_a_bare_site_takes_the_place_of_another_bare_one_only(reflight, pane, tmp_path):
    mission, out = tmp_path / "m.csv", tmp_path / "m.plan.json"
    reflight("export", pane / "plan.json", "--format", "csv", "-o", mission)
    for _ in range(2):
        assert reflight("import", mission, "-o", out).status == 0
    out.unlink()
    shutil.copy(pane / "site.json", tmp_path / "m.site.json")
    before = (tmp_path / "m.site.json").read_bytes()
    error = reflight("import", mission, "-o", out).error
    assert "name it with --site" in error
    assert (tmp_path / "m.site.json").read_bytes() == before
    assert not out.exists()


def test_missions_far_from_the_site_say_how_to_look_at_them(reflight, pane, shared_data, tmp_path):
    file = shared_data / "missions" / "geoyee_m3t_waypoint.kmz"
    error = reflight("import", file, "--site", pane / "site.json", "-o", tmp_path / "p.json").error
    assert "Imported without one, the mission gets a bare site of its own" in error


def test_strict_refuses_what_an_aircraft_would_refuse(reflight, shared_data, tmp_path):
    path = tmp_path / "m.kmz"
    with (
        zipfile.ZipFile(shared_data / "missions" / "geoyee_m3t_waypoint.kmz") as real,
        zipfile.ZipFile(path, "w") as bad,
    ):
        for name in real.namelist():
            bad.writestr(name, real.read(name).replace(b"<wpml:waypointSpeed>10", b"<wpml:waypointSpeed>99"))
    out = tmp_path / "p.json"
    done = reflight("import", path, "-o", out, "--json")
    assert done.status == 0, done.err
    assert any("the vehicle would refuse it: the speed" in finding["message"] for finding in done.json["findings"])
    out.unlink()
    assert "aircraft would refuse this mission" in reflight("import", path, "-o", out, "--strict").error
    assert not out.exists()


def test_a_take_off_that_cannot_be_is_told_with_what_follows(reflight, tmp_path):
    lines = ["0\t1\t0\t16\t0\t0\t0\t0\t-35.0\t149.0\t584\t1"]
    lines += [f"{n}\t0\t3\t16\t0\t0\t0\t0\t47.{n}\t8.0\t30\t1" for n in (1, 2)]
    mission = tmp_path / "m.waypoints"
    mission.write_text("\n".join(["QGC WPL 110", *lines]).replace("47.1", "47.001").replace("47.2", "47.002"))
    told = reflight("import", mission, "-o", tmp_path / "m.plan.json").err
    assert "its file says that it takes off 16" in told
    assert "km from its first waypoint, which cannot be; home is below that waypoint" in told
    assert "does not say where it takes off" not in told
