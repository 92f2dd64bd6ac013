"""`logbook`: what was flown, by command."""

from dataclasses import replace

import pytest

from groundstation.services.fly.log_book import _unix_s, book_path, enter, read_book
from planning.photos.folder import read_photos
from planning.plan import read_plan
from planning.site.file import read_site
from tests.missions.flight.photo_files import write_photos
from tests.services.fly.test_log_book import ENTRY


def test_flights_are_shown_counted_and_written(reflight, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    empty = reflight("logbook")
    assert "no flights yet; simulated ones: 0" in empty.out
    bad = replace(ENTRY, ended="the link was lost", started_unix_s=1.9e9, ended_unix_s=1.9e9 + 60.0)
    for entry in (ENTRY, bad, replace(ENTRY, is_simulated=True)):
        enter(entry, [book_path()])
    done = reflight("logbook", "-o", tmp_path / "book.csv")
    assert done.out.count("office, DJI M3E, photos: 6 of 6") == 2
    assert "    the link was lost" in done.out
    assert "battery B1: flights: 2, cycles: 0.8" in done.out
    assert len((tmp_path / "book.csv").read_text("utf-8-sig").splitlines()) == 3
    told = reflight("logbook", "--simulated", "--json").json
    assert len(told["flights"]) == 3
    assert told["batteries"][0]["n_flights"] == 2
    assert "ends in .kmz" in reflight("logbook", "-o", tmp_path / "book.kmz").error


def test_a_project_has_a_book_of_its_own(reflight, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    enter(ENTRY, [book_path(tmp_path / "tower" / "flights")])
    assert "office" in reflight("logbook", "--project", tmp_path / "tower").out
    assert "no flights yet" in reflight("logbook").out
    (tmp_path / "tower" / "flights" / "log-book.json").write_text("{")
    assert "log-book.json" in reflight("logbook", "--project", tmp_path / "tower").error
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / "project.json").write_text("{}")
    assert "no flights yet" in reflight("logbook", "--project", tmp_path / "new").out
    for nothing in ("towr", "config"):
        error = reflight("logbook", "--project", tmp_path / nothing).error
        assert "expected the folder of a project" in error, "a slip in the name is not a project without flights"


@pytest.fixture
def own_book(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))


def test_a_flight_by_card_is_entered_once_and_its_battery_counted(reflight, pane, tmp_path, own_book):
    add = ("logbook", "add", pane / "plan.json", "--site", pane / "site.json", "--at", "2026-06-21T10:30+02:00")
    assert "state the take-off with --at" in reflight(*add[:-2]).error
    typed = ("--minutes", "12.5", "--battery", "B1", "--aircraft", "our M3E", "--remarks", "gusts")
    done = reflight(*add, *typed)
    assert done.status == 0
    assert "12.5 min, our M3E, battery B1" in done.out
    (entry,) = read_book(book_path())
    plan = read_plan(pane / "plan.json")
    assert (entry.site, entry.sortie, entry.remarks, entry.is_simulated) == ("single-panel", 1, "gusts", False)
    assert (entry.started_unix_s, entry.duration_s) == (1782030600.0, 750.0)
    assert entry.battery_used == pytest.approx(750.0 / plan.aircraft.endurance_s, abs=1e-3)
    assert (entry.n_photos, entry.n_planned) == (6, 6)
    assert "is in the log book already; nothing was entered" in reflight(*add, *typed).error
    assert len(read_book(book_path())) == 1
    assert "battery B1: flights: 1, cycles: 0." in reflight("logbook", "-o", tmp_path / "book.csv").out
    assert "gusts" in (tmp_path / "book.csv").read_text("utf-8-sig")
    assert "the plan has no sortie 7" in reflight(*add, "--sortie", "7").error
    assert "expected the folder of a project" in reflight(*add, "--project", tmp_path / "none").error
    assert "expected the folder of a project" in reflight("logbook", "--project", tmp_path / "none", *add[1:]).error


def test_a_flight_has_the_times_of_its_photos_and_the_findings_of_its_report(reflight, pane, tmp_path, own_book):
    plan, site = read_plan(pane / "plan.json"), read_site(pane / "site.json").site
    views = {view.id: view for view in plan.viewpoints}
    flown = [views[name] for sortie in plan.sorties for name in sortie.viewpoint_ids]
    write_photos(tmp_path / "photos", site, flown[:2] + flown[3:])
    reported = reflight("report", pane / "plan.json", pane / "site.json", "--photos", tmp_path / "photos")
    assert "logbook add" in reported.err
    done = reflight("logbook", "add", pane / "plan.json", "--site", pane / "site.json", "--photos", tmp_path / "photos")
    assert done.status == 0, done.err
    (entry,) = read_book(book_path())
    times_s = [_unix_s(photo) for photo in read_photos(tmp_path / "photos").photos]
    assert entry.started_unix_s <= min(times_s)
    assert entry.ended_unix_s >= max(times_s)
    assert entry.duration_s == pytest.approx(plan.sorties[0].duration_s, abs=1.0)
    assert entry.n_photos == 5
    assert entry.findings, "a view has no photo"
