"""The log book: entered when a flight ends, read back, damaged books, batteries' cycles, and tables."""

import csv
import io
import json
import threading
from contextlib import suppress
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.events import FlightEnded
from groundstation.services.fly.log_book import (
    COLUMNS,
    FORMULA,
    BookEntry,
    battery_uses,
    book_csv,
    book_path,
    enter,
    enter_stated,
    entry_of,
    flight_of_photos,
    read_book,
    stated_entry,
    write_book_csv,
)
from missions.mission.model import GeoPoint
from planning.base.errors import InputError, LinkTimeout
from planning.photos.folder import read_photos
from tests.missions.flight.flights import flown_as_planned, with_durations
from tests.missions.flight.log_writers import log_site
from tests.missions.flight.photo_files import write_photos
from tests.missions.flight.test_photo_folder import plan as two_sorties
from tests.missions.flight.test_photo_folder import site_model as two_sorties_site
from tests.missions.plans import example_plan

ENTRY = BookEntry(1.8e9, 1.8e9 + 600.0, "office", 22.3, 114.2, "DJI M3E", "ArduPilot, tcp", 1, "B1", 0.4, 6, 6, 10.2)
HOME = GeoPoint(22.3372, 114.2636, 62.0)


def test_a_flight_becomes_an_entry():
    plan = with_durations(example_plan())
    record = flown_as_planned(plan)[0]
    ended = FlightEnded(1, None, record, None, None)
    entry = entry_of(ended, plan, log_site(), HOME, 1.8e9, battery="B7", operator="FIN87astrdge12k8")
    assert entry.ended_unix_s == 1.8e9
    assert entry.duration_s == pytest.approx(record.duration_s, abs=0.2)
    assert (entry.site, entry.aircraft, entry.battery, entry.sortie) == ("office", "DJI M3E", "B7", 1)
    assert (entry.n_photos, entry.n_planned, entry.lat_deg) == (6, 6, 22.3372)
    used = float(record.track.battery[0] - record.track.battery[-1])
    assert entry.battery_used == pytest.approx(used, abs=1e-4)
    bad = entry_of(replace(ended, error=LinkTimeout("the link was lost")), plan, log_site(), HOME, 1.8e9)
    assert bad.ended == "the link was lost"
    assert entry_of(replace(ended, record=None), plan, log_site(), HOME, 1.8e9) is None


def test_entries_are_kept_in_order_of_time_in_every_book(tmp_path):
    paths = [book_path(tmp_path / "project" / "flights"), tmp_path / "all" / "log-book.json"]
    later = replace(ENTRY, started_unix_s=1.9e9, ended_unix_s=1.9e9 + 60.0)
    for entry in (later, ENTRY):
        enter(entry, paths)
    assert [read_book(path) for path in paths] == [(ENTRY, later)] * 2
    assert read_book(tmp_path / "none.json") == ()
    # The same book twice, as where a project is the user's own folder, has it once.
    enter(ENTRY, [tmp_path / "one.json", tmp_path / "one.json"])
    assert len(read_book(tmp_path / "one.json")) == 1


def test_many_windows_at_once_lose_no_flight(tmp_path):
    path = tmp_path / "log-book.json"
    threads = [threading.Thread(target=enter, args=(replace(ENTRY, sortie=n), [path])) for n in range(1, 9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(entry.sortie for entry in read_book(path)) == list(range(1, 9))


@pytest.mark.parametrize(
    "content",
    [b"", b"[]", b"{", b'{"format": "reflight-plan/1"}', b'{"format": "reflight-log-book/1", "flights": [{}]}'],
)
def test_a_damaged_book_is_said_and_never_written_over(tmp_path, content):
    path, other = tmp_path / "log-book.json", tmp_path / "other.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"log-book\.json"):
        read_book(path)
    with pytest.raises(InputError, match=r"log-book\.json"):
        enter(ENTRY, [path, other])
    assert path.read_bytes() == content
    assert read_book(other) == (ENTRY,)


plain = st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(max_size=5)
keys = st.sampled_from(["format", "flights", "site", "sortie"])
anything = st.recursive(
    plain, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4), max_leaves=10
)


@given(anything)
def test_any_json_is_read_or_refused_in_words(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("book") / "log-book.json"
    path.write_text(json.dumps(content))
    with suppress(InputError):
        assert isinstance(read_book(path), tuple)


def test_batteries_count_real_flights_and_full_charges():
    entries = [
        ENTRY,
        replace(ENTRY, battery_used=0.85, ended_unix_s=1.8e9 + 1200.0),
        replace(ENTRY, battery_used=None),
        replace(ENTRY, is_simulated=True),
        replace(ENTRY, battery="A2", battery_used=0.5),
        replace(ENTRY, battery=""),
    ]
    first, second = battery_uses(entries)
    assert (first.name, first.n_flights, first.cycles) == ("A2", 1, 0.5)
    assert (second.name, second.n_flights, second.n_unknown) == ("B1", 3, 1)
    assert second.cycles == pytest.approx(1.25)
    assert second.flown_s == pytest.approx(600.0 + 1200.0 + 600.0)
    assert second.last_unix_s == 1.8e9 + 1200.0


texts = st.text(st.characters(exclude_categories=("Cs",), exclude_characters="\0"), max_size=12)


@given(st.lists(st.builds(lambda a, b, c: replace(ENTRY, site=a, ended=b, findings=(c,)), texts, texts, texts)))
def test_tables_hold_every_flight_and_no_formula(entries):
    rows = list(csv.reader(io.StringIO(book_csv(entries), newline="")))
    assert rows[0] == list(COLUMNS)
    assert len(rows) == len(entries) + 1
    assert all(not cell.startswith(FORMULA) or cell[1:2].isdigit() for row in rows for cell in row)
    for row, entry in zip(rows[1:], entries, strict=True):
        assert row[4].removeprefix("'" if entry.site.startswith(FORMULA) else "") == entry.site


def test_a_table_says_date_and_times_of_utc(tmp_path):
    write_book_csv(tmp_path / "book.csv", [replace(ENTRY, started_unix_s=0.0, ended_unix_s=90.0)])
    (row,) = csv.DictReader(io.StringIO((tmp_path / "book.csv").read_bytes().decode("utf-8-sig"), newline=""))
    assert (row["date"], row["start_utc"], row["end_utc"], row["minutes"]) == (
        "1970-01-01",
        "00:00:00",
        "00:01:30",
        "1.5",
    )
    assert (row["battery_used_percent"], row["photos"], row["simulated"]) == ("40.0", "6", "0")


def test_photos_of_two_batteries_are_two_sorties_in_the_order_of_flight(tmp_path):
    plan, model = two_sorties(), two_sorties_site()
    for number, sortie in enumerate((plan.viewpoints[:10], plan.viewpoints[10:])):
        # The second battery is flown first, half an hour earlier.
        write_photos(tmp_path / str(number), model.site, sortie, start_s=1800.0 * (1 - number))
    sorties, findings = flight_of_photos(plan, model, read_photos(tmp_path).photos, "card")
    assert [(each.number, each.n_photos) for each in sorties] == [(2, 10), (1, 10)]
    assert sorties[1].started_unix_s - sorties[0].started_unix_s == pytest.approx(1800.0, abs=30.0)
    for each in sorties:
        assert each.duration_s >= plan.sorties[each.number - 1].duration_s - 0.1
    entries = [stated_entry(each, plan, model.site, findings=findings) for each in sorties]
    enter_stated(entries, [tmp_path / "a.json", tmp_path / "b.json"])
    assert len(read_book(tmp_path / "a.json")) == 2
    with pytest.raises(InputError, match="is in the log book already"):
        enter_stated(entries[1:], [tmp_path / "c.json", tmp_path / "b.json"])
    assert not (tmp_path / "c.json").exists(), "nothing is entered where one book has it"
