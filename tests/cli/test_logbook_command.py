"""`logbook`: what was flown, by command."""

from dataclasses import replace

from groundstation.services.fly.log_book import book_path, enter
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
