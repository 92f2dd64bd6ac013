"""`report`: what it prints, writes, and refuses, from logs and from photos."""

import pytest

from groundstation.services.fly.flying import report_files
from groundstation.vehicle.duration import items_duration_s
from groundstation.vehicle.orders import sortie_orders
from missions.flight.flight_file import read_flight
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from planning.plan import read_plan
from planning.site.file import read_site
from tests.cli.conftest import BAD_CONTENTS
from tests.missions.flight.flights import flown_as_planned
from tests.missions.flight.log_writers import dataflash, dataflash_text, tlog, ulog
from tests.missions.flight.photo_files import Device, write_photos
from tests.planning.photos.photo_writer import save

LOGS = {"flight.tlog": tlog, "flight.BIN": dataflash, "flight.log": dataflash_text, "flight.ulg": ulog}


@pytest.fixture
def report(reflight, pane):
    """Report on a flight of the pane's plan."""

    def run(*arguments):
        return reflight("report", pane / "plan.json", pane / "site.json", *arguments)

    return run


@pytest.fixture
def photos(pane, tmp_path):
    """A folder with a photo of each view of the pane's plan but the third."""
    plan, site = read_plan(pane / "plan.json"), read_site(pane / "site.json").site
    views = {view.id: view for view in plan.viewpoints}
    flown = [views[name] for sortie in plan.sorties for name in sortie.viewpoint_ids]
    write_photos(tmp_path / "photos", site, flown[:2] + flown[3:], Device(position_m=0.1, takeoff_error_m=3.0))
    return tmp_path / "photos"


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("name", LOGS)
def test_every_kind_of_log_gives_the_report_and_the_flight(report, pane, tmp_path, name):
    plan, site = read_plan(pane / "plan.json"), read_site(pane / "site.json").site
    log = save(tmp_path / name, LOGS[name](flown_as_planned(plan), site))
    done = report("--log", log, "-o", tmp_path / "f.json")
    assert done.status == 0, done.err
    assert "photos: 6 of 6 views" in done.out
    flight = read_flight(tmp_path / "f.json")
    assert flight.report.summary.n_taken == 6
    assert flight.report.summary.least_distance_m > 9.0
    assert flight.site_sha256 == read_site(pane / "site.json").sha256


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "autopilot"),
    [("f.tlog", Autopilot.ARDUPILOT), ("f.BIN", Autopilot.ARDUPILOT), ("f.ulg", Autopilot.PX4)],
)
def test_the_duration_is_compared_with_that_of_the_autopilots_items(report, pane, tmp_path, name, autopilot):
    plan, model = read_plan(pane / "plan.json"), read_site(pane / "site.json")
    log = save(tmp_path / name, LOGS[name.replace("f.", "flight.")](flown_as_planned(plan), model.site))
    (sortie,) = report("--log", log, "--json").json["sorties"]
    (mission,) = missions_from_plan(plan, model.site.origin, model.site.home_enu_m)
    expected_s = items_duration_s(sortie_orders(plan, model, mission), autopilot)
    assert sortie["duration_predicted_s"] == pytest.approx(expected_s, abs=0.1)
    own_s = plan.sorties[0].duration_s - plan.rules.takeoff_landing_s
    assert expected_s > own_s + 1.0


def test_the_duration_of_a_dji_flight_is_compared_with_the_plans_own(report, pane, photos):
    plan = read_plan(pane / "plan.json")
    own_s = plan.sorties[0].duration_s - plan.rules.takeoff_landing_s
    (sortie,) = report("--photos", photos, "--json").json["sorties"]
    assert sortie["duration_predicted_s"] == pytest.approx(own_s, abs=0.1)


@pytest.mark.slow
def test_several_logs_are_one_flight(report, pane, tmp_path):
    plan, site = read_plan(pane / "plan.json"), read_site(pane / "site.json").site
    log = save(tmp_path / "f.tlog", tlog(flown_as_planned(plan), site))
    content = report("--log", log, "--log", log, "--json").json
    assert len(content["sorties"]) == 2
    assert (content["n_taken"], content["n_photos"]) == (6, 12)


def test_photos_give_the_same_report(report, photos, tmp_path):
    done = report("--photos", photos, "-o", tmp_path / "f.json")
    assert done.status == 0
    assert "photos: 5 of 6 views" in done.out
    assert "photos of DJI M3E" in done.out
    assert "RTK was fixed in all photos" in done.err
    assert "3.0 m higher" in done.err
    assert "next: app.py topup" in done.err
    photo = read_flight(tmp_path / "f.json").sorties[0].photos[0]
    assert (photo.source, photo.exposure_s) == ("photo-file", 0.001)
    assert photo.file.startswith("DJI_20240501")


def test_json_is_one_object_with_the_report_and_what_is_to_say_of_the_files(report, photos):
    content = report("--photos", photos, "--json").json
    assert (content["n_taken"], content["n_views"], content["flight"]) == (5, 6, None)
    assert content["covered"] <= content["covered_planned"]
    assert {finding["code"] for finding in content["source_findings"]} == {"height-reference", "height-disagreement"}
    assert {"views", "sorties", "findings", "seconds", "covered", "total"} <= set(content)


def test_heights_can_be_counted_the_other_way(report, photos, tmp_path):
    heights_m = []
    for choice in ("auto", "absolute", "takeoff"):
        report("--photos", photos, "--heights", choice, "-o", tmp_path / f"{choice}.json")
        (record,) = read_flight(tmp_path / f"{choice}.json").sorties
        heights_m.append([photo.position_enu_m[2] for photo in record.photos])
    auto, absolute, above = heights_m
    assert auto == absolute
    assert [b - a for a, b in zip(auto, above, strict=True)] == pytest.approx([3.0] * 5, abs=0.002)


def test_nothing_is_written_without_being_asked_for(report, photos, tmp_path):
    before = set(tmp_path.rglob("*"))
    assert report("--photos", photos).status == 0
    assert set(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("content", BAD_CONTENTS.values(), ids=BAD_CONTENTS)
def test_what_is_no_log_is_refused(report, tmp_path, content):
    path = save(tmp_path / "bad.tlog", content)
    assert str(path) in report("--log", path, "-o", tmp_path / "f.json").error
    assert not (tmp_path / "f.json").exists()


def test_what_is_no_folder_of_photos_is_refused(report, tmp_path, pane):
    assert "found nothing" in report("--photos", tmp_path / "none").error
    assert "holds no .jpg photo" in report("--photos", tmp_path).error
    assert "found a file" in report("--photos", pane / "plan.json").error


def test_files_in_the_wrong_place_are_refused(reflight, report, pane, photos, changed):
    swapped = reflight("report", pane / "site.json", pane / "plan.json", "--photos", photos)
    assert "expected a plan file" in swapped.error
    assert "would replace" in report("--photos", photos, "-o", pane / "plan.json").error
    elsewhere = changed(pane / "site.json", "origin", "lat_deg", 1.0)
    moved = reflight("report", pane / "plan.json", elsewhere, "--photos", photos)
    assert "is not the one of the plan" in moved.error


def test_photos_of_another_place_are_refused(reflight, pane, photos, changed):
    site, plan = (changed(pane / name, "origin", "lat_deg", 1.0) for name in ("site.json", "plan.json"))
    assert "km from the site" in reflight("report", plan, site, "--photos", photos).error


def test_logs_or_photos_must_be_named_and_not_both(report, photos, pane):
    assert report().status == 2
    assert report("--log", "x", "--photos", photos).status == 2
    with pytest.raises(ValueError, match="either logs or photos"):
        report_files(pane / "plan.json", pane / "site.json")


@pytest.mark.slow
def test_real_logs_of_elsewhere_are_refused_with_the_distance(report, shared_data):
    for name in ("uavlogviewer_vtol.tlog", "dronekit_la_log171.bin", "sample_px4_events.ulg"):
        assert "km from the site" in report("--log", shared_data / "logs" / name).error
    assert "km from the site" in report("--photos", shared_data / "dji" / "photos").error
