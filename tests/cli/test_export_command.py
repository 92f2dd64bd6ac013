"""`export`: every format for every aircraft, one file a sortie, checked files or none."""

import json
import os
import shutil
from concurrent.futures import ThreadPoolExecutor

import pytest

from groundstation.services.plan.planning import plan_site
from missions.dji.check import check_dji
from missions.dji.wpml import parts_of_kmz
from missions.formats.registry import read_missions
from planning.aircraft.catalogue import profiles
from planning.base.findings import is_flyable
from planning.parameters import FlightRules
from planning.plan import read_plan
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from tests.planning.revision.cases import QUICK

ENDINGS = {
    "dji-kmz": ".kmz",
    "mavlink-plan": ".plan",
    "mavlink-wpl": ".waypoints",
    "kml": ".kml",
    "csv": ".csv",
}


@pytest.fixture(scope="module")
def sorties(tmp_path_factory):
    """Folder with a plan of several sorties: a large reserve makes the battery small."""
    folder = tmp_path_factory.mktemp("sorties")
    site = write_scene("roof", folder).rename(folder / "site.json")
    request = PlanRequest(n_views=24, rules=FlightRules(battery_reserve=0.93), greedy=QUICK)
    assert len(plan_site(site, request, folder / "plan.json").plan.sorties) > 1
    return folder


@pytest.fixture(scope="module")
def plans_by_profile(tmp_path_factory):
    folder = tmp_path_factory.mktemp("profiles")
    site = write_scene("single-panel", folder)
    for profile_id in profiles():
        plan_site(site, PlanRequest(n_views=3, greedy=QUICK, profile_id=profile_id), folder / f"{profile_id}.json")
    return folder


@pytest.mark.long
@pytest.mark.skipif(os.name == "nt", reason="pipes of a POSIX system")
def test_missions_and_plans_go_into_pipes_with_nothing_beside_them(reflight, pane, tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with ThreadPoolExecutor(1) as pool:
        read = pool.submit(pipe.read_bytes)
        done = reflight(
            "export", pane / "plan.json", "--site", pane / "site.json", "--format", "mavlink-plan", "-o", pipe
        )
        assert done.status == 0
        assert json.loads(read.result())["fileType"] == "Plan"
        read = pool.submit(pipe.read_bytes)
        assert reflight("plan", pane / "site.json", "-o", pipe, "--views", 1, "--candidates", 50).status == 0
        assert len(json.loads(read.result())["viewpoints"]) == 1
    assert list(tmp_path.iterdir()) == [pipe]


@pytest.mark.few(13)
@pytest.mark.parametrize("file_format", sorted(ENDINGS))
@pytest.mark.parametrize("profile_id", sorted(profiles()))
def test_every_profile_exports_to_every_format_or_is_refused_with_a_reason(
    reflight, plans_by_profile, tmp_path, profile_id, file_format
):
    plan, out = plans_by_profile / f"{profile_id}.json", tmp_path / f"m{ENDINGS[file_format]}"
    done = reflight("export", plan, "--format", file_format, "-o", out)
    if file_format == "dji-kmz" and profile_id in ("ardupilot", "px4"):
        assert "DJI" in done.error
        assert not out.exists()
        return
    assert (done.status, done.out) == (0, f"{out}\n")
    assert sum(mission.n_photos for mission in read_missions(out)) == 3


@pytest.mark.long
@pytest.mark.parametrize("file_format", sorted(ENDINGS))
def test_each_sortie_gets_a_file_and_all_photos_are_in_them(reflight, sorties, tmp_path, file_format):
    plan = read_plan(sorties / "plan.json")
    done = reflight(
        "export", sorties / "plan.json", "--format", file_format, "-o", tmp_path / f"m{ENDINGS[file_format]}", "--json"
    )
    assert done.status == 0
    files = [tmp_path / name for name in done.json["files"]]
    assert sorted(files) == sorted(path for path in tmp_path.iterdir() if path.suffix == ENDINGS[file_format])
    assert len(files) == (1 if file_format in ("kml", "csv") else len(plan.sorties))
    assert sum(m.n_photos for file in files for m in read_missions(file)) == len(plan.viewpoints)
    assert done.json["format"] == file_format
    assert done.json["heights"] == "above-takeoff"


def test_kmz_passes_the_checks_of_its_format_without_an_error(reflight, sorties, tmp_path):
    out = tmp_path / "m.kmz"
    assert reflight("export", sorties / "plan.json", "--format", "dji-kmz", "-o", out).status == 0
    assert is_flyable(check_dji(parts_of_kmz(out.read_bytes())))


@pytest.mark.parametrize(
    ("file_format", "heights", "autopilot"),
    [
        ("dji-kmz", "amsl", "px4"),
        ("dji-kmz", "ellipsoid", "ardupilot"),
        ("mavlink-plan", "amsl", "px4"),
        ("mavlink-wpl", "amsl", "ardupilot"),
    ],
)
def test_heights_and_autopilot_can_be_chosen(reflight, pane, tmp_path, file_format, heights, autopilot):
    out = tmp_path / f"m{ENDINGS[file_format]}"
    options = ["--heights", heights, "--autopilot", autopilot, "--link-loss", "go-home", "--return-height", 45]
    assert reflight("export", pane / "plan.json", "--format", file_format, "-o", out, *options).status == 0
    assert read_missions(out)[0].n_photos == 6


@pytest.mark.parametrize(
    ("file_format", "options", "left_out"),
    [
        ("kml", ["--heights", "amsl", "--site", "SITE"], ["--heights"]),
        ("dji-kmz", ["--autopilot", "px4", "--link-loss", "go-home"], ["--autopilot"]),
        ("mavlink-wpl", ["--return-height", 45, "--link-loss", "go-home"], ["--link-loss", "--return-height"]),
        ("csv", ["--preset", "small", "--components", "A"], ["--preset", "--components"]),
    ],
)
def test_options_that_a_format_has_no_use_for_are_named(reflight, pane, tmp_path, file_format, options, left_out):
    options = [pane / "site.json" if option == "SITE" else option for option in options]
    out = tmp_path / f"m{ENDINGS[file_format]}"
    done = reflight("export", pane / "plan.json", "--format", file_format, "-o", out, *options)
    assert done.status == 0
    told = [line for line in done.err.splitlines() if "has no use for it" in line]
    assert told == [f"warning: {each} is left out: the format {file_format} has no use for it" for each in left_out]


def test_a_plan_faster_than_dji_s_format_is_flown_slower_which_is_said(reflight, pane, changed, tmp_path):
    plan = changed(changed(pane / "plan.json", "aircraft", "max_speed_m_s", 20.0), "site_sha256", "")
    done = reflight("export", plan, "--format", "dji-kmz", "-o", tmp_path / "m.kmz", "--json")
    (finding,) = (finding for finding in done.json["findings"] if finding["code"] == "speed-limited")
    assert (finding["value"], finding["limit"]) == (20.0, 15.0)
    done = reflight("export", pane / "plan.json", "--format", "dji-kmz", "-o", tmp_path / "m.kmz", "--json")
    assert "speed-limited" not in {finding["code"] for finding in done.json["findings"]}


def test_mavlink_has_no_heights_above_the_ellipsoid(reflight, pane, tmp_path):
    error = reflight(
        "export", pane / "plan.json", "--format", "mavlink-plan", "-o", tmp_path / "m.plan", "--heights", "ellipsoid"
    ).error
    assert "expected above-takeoff or amsl" in error


@pytest.mark.parametrize("height", [0, -5, 5, 1501])
def test_return_heights_out_of_range_are_refused_and_nothing_written(reflight, pane, tmp_path, height):
    error = reflight(
        "export", pane / "plan.json", "--format", "dji-kmz", "-o", tmp_path / "m.kmz", "--return-height", height
    ).error
    assert f"expected 20 to 1500 m above take-off, got {height} m" in error
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_other_programs_do_not_look_for_is_told(reflight, pane, tmp_path):
    done = reflight("export", pane / "plan.json", "--format", "dji-kmz", "-o", tmp_path / "m.zip")
    assert done.status == 0
    first = done.err.splitlines()[0]
    assert first == "warning: m.zip: other programs look for dji-kmz files with names that end in .kmz"


@pytest.mark.parametrize(("file_format", "name"), [("dji-kmz", "m.kml"), ("csv", "m.xlsx"), ("mavlink-plan", "m.kmz")])
def test_a_name_of_another_kind_of_file_is_refused(reflight, pane, tmp_path, file_format, name):
    error = reflight("export", pane / "plan.json", "--format", file_format, "-o", tmp_path / name).error
    assert f"not written: the name ends in .{name[2:]}, and what would be in the file is ." in error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("out", "message"),
    [
        ("plan.json", "would replace"),
        ("site.json", "would replace"),
        (".", "this is a folder"),
        ("no/m.kmz", "no folder"),
    ],
)
def test_an_export_never_replaces_what_it_is_made_from(reflight, pane, tmp_path, out, message):
    for name in ("plan.json", "site.json"):
        shutil.copy(pane / name, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    error = reflight("export", tmp_path / "plan.json", "--format", "csv", "-o", tmp_path / out).error
    assert message in error
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_file_of_a_later_sortie_never_replaces_the_plan(reflight, sorties, tmp_path):
    plan = tmp_path / "m-2.bin"
    shutil.copy(sorties / "plan.json", plan)
    before = plan.read_bytes()
    assert "would replace" in reflight("export", plan, "--format", "dji-kmz", "-o", tmp_path / "m.bin").error
    assert plan.read_bytes() == before
    assert list(tmp_path.iterdir()) == [plan]


def test_the_site_beside_the_plan_is_found_among_other_files(reflight, sorties, tmp_path):
    for path in sorties.iterdir():
        shutil.copy(path, tmp_path)
    (tmp_path / "a.json").mkdir()
    (tmp_path / "b.json").symlink_to("nowhere")
    (tmp_path / "c.json").write_bytes(b"\xff")
    done = reflight("export", tmp_path / "plan.json", "--format", "dji-kmz", "-o", tmp_path / "m.kmz")
    assert done.status == 0
    assert done.err.startswith("note: before any photo the aircraft stops"), "it knows what stands where"
    alone = tmp_path / "alone"
    alone.mkdir()
    shutil.copy(sorties / "plan.json", alone)
    done = reflight("export", alone / "plan.json", "--format", "dji-kmz", "-o", tmp_path / "m.kmz")
    assert done.status == 0
    assert done.err.startswith("warning: the return height clears the path only, because the site was not given")


def test_another_site_is_refused_and_a_changed_one_is_told(reflight, pane, changed, tmp_path):
    def export_with(site):
        return reflight("export", pane / "plan.json", "--site", site, "--format", "csv", "-o", tmp_path / "m.csv")

    error = export_with(changed(pane / "site.json", "origin", "lat_deg", 10.0)).error
    assert "the origin of 'single-panel' is not the one of the plan" in error
    done = export_with(changed(pane / "site.json", "weather", "fine"))
    assert done.status == 0
    assert "the site file of 'single-panel' has changed since this plan was made" in done.err


def test_a_plan_that_breaks_a_rule_is_exported_with_a_warning(reflight, pane, tmp_path):
    content = json.loads((pane / "plan.json").read_text())
    content["aircraft"]["endurance_s"] = 100
    plan = tmp_path / "plan.json"
    plan.write_text(json.dumps(content))
    done = reflight(
        "export", plan, "--site", pane / "site.json", "--format", "dji-kmz", "-o", tmp_path / "m.kmz", "--json"
    )
    assert done.status == 0
    (finding,) = (finding for finding in done.json["findings"] if finding["code"] == "not-ready")
    assert finding["severity"] == "warning"
    assert "duration with the battery reserve kept" in finding["message"]
    done = reflight("export", plan, "--site", pane / "site.json", "--format", "kml", "-o", tmp_path / "m.kml")
    assert done.status == 0
    assert "warning: NOT ready to fly: sortie 1: duration with the battery reserve kept" in done.err


def test_a_plan_without_sorties_is_refused(reflight, pane, changed, tmp_path):
    plan = changed(changed(pane / "plan.json", "sorties", []), "viewpoints", [])
    error = reflight("export", plan, "--format", "dji-kmz", "-o", tmp_path / "m.kmz").error
    assert "sorties" in error
    assert not (tmp_path / "m.kmz").exists()


def test_files_that_are_no_plan_are_refused(reflight, bad_file, tmp_path):
    assert str(bad_file) in reflight("export", bad_file, "--format", "kml", "-o", tmp_path / "m.kml").error
    assert list(tmp_path.iterdir()) == [bad_file]
