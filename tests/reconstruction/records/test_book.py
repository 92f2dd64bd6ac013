"""The book: what is put in comes out, history and undo, objects that vanish, many readers and one writer."""

import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.records.book import FILE, RecordBook
from reconstruction.records.database import searched_texts
from reconstruction.records.entries import KIND_OF, Attribute, Defect, Inspection, Maintenance
from reconstruction.records.queries import attribute_values, history, search
from tests.reconstruction.records.cases import NASTY, ORIGIN, PANES, contents, entries, model, new_book, now, state

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def book(tmp_path):
    with new_book(tmp_path) as opened:
        yield opened


@pytest.mark.slow
@given(st.lists(entries, max_size=8))
def test_entries_come_out_as_they_went_in_and_undo_takes_each_back(tmp_path_factory, found):
    with new_book(tmp_path_factory.mktemp("book")) as book:
        states = [state(book)]
        kept = []
        for entry in found:
            kept.append(book.put(entry))
            states.append(state(book))
        with RecordBook(book.path) as reader:
            # An attribute of the same name replaces the one before.
            last = {(e.global_id, e.name) if isinstance(e, Attribute) else e.key: e for e in kept}
            assert contents(reader) == set(last.values())
        for before, after in zip(reversed(states[:-1]), reversed(states[1:]), strict=True):
            if before != after:
                assert book.undo() is not None
                assert _without_ids(state(book)) == _without_ids(before)
        assert book.undo() is None
        book.check()
        texts = [text for entry in found for _, text in searched_texts(entry, KIND_OF[type(entry)])]
        assert {hit.kind for text in texts for hit in search(book, text)} <= {"object"}, "nothing is left in the index"


def _without_ids(tables):
    """Rows that were taken out and put in again have new numbers."""
    return {table: sorted((row[1:] for row in rows), key=repr) for table, rows in tables.items()}


def test_history_tells_who_when_what_with_old_and_new_values(book):
    crack = book.put(Defect(PANES[0], "crack", 2, "2026-01-01", note=NASTY[0]))
    book.put(replace(crack, severity=4))
    book.remove(replace(crack, severity=4))
    removed, changed, added = history(book, PANES[0], 3)
    assert (added.old, added.new["severity"], added.new["note"]) == (None, 2, NASTY[0])
    assert (changed.old["severity"], changed.new["severity"]) == (2, 4)
    assert removed.new is None
    assert {(c.who, c.at_utc, c.name) for c in (added, changed, removed)} == {
        ("Chan", "2026-03-31T12:00:00.000+00:00", "A-0000")
    }
    n_before = len(history(book))
    book.put(Attribute(PANES[0], "maker", "x"))
    book.put(Attribute(PANES[0], "maker", "x"))
    assert len(history(book)) == n_before + 1, "what changes nothing is no change"


def test_undo_goes_back_step_by_step_and_is_history_itself(book):
    with book.changing("two at once") as changes:
        inspection = changes.put(Inspection(PANES[0], "2026-01-01"))
        changes.put(Defect(PANES[0], "crack", 2, "2026-01-01", inspection=inspection.key))
    with book.changing("both out") as changes:
        for entry in (*book.entries(Defect), *book.entries(Inspection)):
            changes.remove(entry)
    assert book.undo() == "both out"
    assert [e.inspection for e in book.entries(Defect)] == [inspection.key]
    assert book.undo() == "two at once"
    assert contents(book) == set()
    assert book.undo() is None
    assert [change.undoes for change in history(book)[:2]] == [history(book)[-1].number + 1] * 2


def test_nothing_of_a_refused_change_stays(book):
    before = state(book)
    with pytest.raises(InputError, match="no inspection with the key"):
        _put_all(
            book, Attribute(PANES[0], "maker", "x"), Defect(PANES[0], "crack", 2, "2026-01-01", inspection=PANES[1])
        )
    assert state(book) == before
    assert [change.kind for change in history(book)] == ["object"] * 6
    with pytest.raises(InputError, match="the model has no object"):
        book.put(Attribute("0" * 22, "maker", "x"))
    inspection = book.put(Inspection(PANES[0], "2026-01-01"))
    with pytest.raises(InputError, match="belongs to another object"):
        book.put(replace(inspection, global_id=PANES[1]))
    with pytest.raises(InputError, match="no inspection with the key"):
        book.put(Defect(PANES[1], "crack", 2, "2026-01-01", inspection=inspection.key))
    book.put(Defect(PANES[0], "crack", 2, "2026-01-01", inspection=inspection.key))
    with pytest.raises(InputError, match="has 1 defects; take these out first"):
        book.remove(inspection)


def test_objects_that_a_new_model_lacks_keep_their_records(book):
    book.put(Attribute(PANES[2], "maker", "Glas AG"))
    rows = model()
    assert book.set_objects(rows, ORIGIN) == book.set_objects(rows)
    assert len(history(book, limit=1000)) == 7, "the same objects again are no change"
    moved = replace(rows[3], name="A-0100")
    done = book.set_objects([*rows[:3], moved, rows[4]])
    assert (done.n_new, done.n_changed, done.n_absent, done.n_present) == (0, 1, 1, 5)
    assert [row.name for row in book.objects()] == ["tower", "A", "B", "A-0100", "B-0001"]
    assert len(book.objects(with_absent=True)) == 6
    assert book.entries(Attribute, PANES[2])[0].value == "Glas AG"
    assert not book.is_present(PANES[2])
    assert [hit.name for hit in search(book, "0100")] == ["A-0100"]
    assert search(book, "A 0000") == ()
    assert (book.set_objects(rows).n_changed, book.is_present(PANES[2])) == (2, True)
    assert book.origin == ORIGIN


def test_objects_are_found_by_id_and_by_name(book):
    assert book.object(PANES[0]) == book.object("A-0000")
    with pytest.raises(InputError, match="'nothing': there is no such object"):
        book.object("nothing")
    rows = model()
    book.set_objects([*rows[:4], replace(rows[4], name="A-0000"), rows[5]])
    with pytest.raises(InputError, match="have this name; give the GlobalId"):
        book.object("A-0000")


def test_readers_see_whole_changes_while_one_writes(tmp_path):
    with new_book(tmp_path) as book:
        _put_pair(book, 0)
        wrong, stop = [], threading.Event()

        def read():
            with RecordBook(book.path) as reader:
                while not stop.is_set():
                    found = {value.value for value in attribute_values(reader, "count").values()}
                    if len(found) != 1:
                        wrong.append(found)

        readers = [threading.Thread(target=read) for _ in range(2)]
        for reader in readers:
            reader.start()
        for number in range(1, 25):
            _put_pair(book, number)
        stop.set()
        for reader in readers:
            reader.join()
        assert wrong == []
        assert {value.value for value in attribute_values(book, "count").values()} == {24.0}


def _put_all(book, *found):
    with book.changing("together") as changes:
        for entry in found:
            changes.put(entry)


def _put_pair(book, number):
    with book.changing("pair") as changes:
        for pane in PANES[:2]:
            changes.put(Attribute(pane, "count", number, "number"))


def test_two_writers_wait_for_each_other_and_say_so(tmp_path):
    with new_book(tmp_path) as book, RecordBook(book.path, True, "Lee", now, busy_s=0.05) as other:
        with book.changing("long") as changes:
            changes.put(Attribute(PANES[0], "maker", "a"))
            with pytest.raises(InputError, match=r"another program is writing the records; waited 0\.05 s; try again"):
                other.put(Attribute(PANES[0], "maker", "b"))
        other.put(Attribute(PANES[0], "maker", "c"))
        assert book.entries(Attribute)[0].value == "c"


WRITER = """
import sys
from pathlib import Path
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import Inspection
book = RecordBook(Path(sys.argv[1]), True, "Chan")
book.database.rows("PRAGMA cache_size = 5")
book.database.rows("PRAGMA cache_spill = 5")
with book.changing("interrupted") as changes:
    for number in range(300):
        changes.put(Inspection(sys.argv[2], "2026-01-01", note=f"{number} " + "crack " * 300))
    print("written", flush=True)
    sys.stdin.read()
"""


def test_a_killed_writer_leaves_the_old_state_whole(tmp_path):
    with new_book(tmp_path) as book:
        book.put(Attribute(PANES[0], "maker", "old"))
        before = state(book)
    size = book.path.stat().st_size
    command = [sys.executable, "-c", WRITER, str(book.path), PANES[0]]
    writer = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT)
    assert writer.stdout.readline() == b"written\n"
    assert book.path.stat().st_size > size, "pages of the interrupted change are in the file"
    os.kill(writer.pid, signal.SIGKILL)
    writer.communicate()
    assert book.path.with_name(f"{FILE}-journal").exists()
    with RecordBook(book.path) as reader:
        assert state(reader) == before
    assert not book.path.with_name(f"{FILE}-journal").exists()
    with RecordBook(book.path, True, "Lee") as again:
        assert state(again) == before
        again.check()
        assert search(again, "crack") == ()


GROWING = """
import itertools, sys
from pathlib import Path
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import Inspection
with RecordBook(Path(sys.argv[1]), True, "Chan") as book:
    print("open", flush=True)
    for number in itertools.count():
        with book.changing("growing") as changes:
            for line in range(40):
                changes.put(Inspection(sys.argv[2], "2026-01-01", note=f"{number} {line} " + "crack " * 200))
        book.undo()
"""


@pytest.mark.slow
def test_books_opened_beside_a_process_that_writes_all_the_time_are_never_called_damaged(tmp_path):
    with new_book(tmp_path) as book:
        path = book.path
    command = [sys.executable, "-c", GROWING, str(path), PANES[0]]
    writer = subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT)
    try:
        assert writer.stdout.readline() == b"open\n"
        states = set()
        for _ in range(400):
            with RecordBook(path) as reader:
                states.add(len(reader.entries(Inspection)))
        assert states <= {0, 40}, "a change is seen whole or not at all"
        assert writer.poll() is None
    finally:
        writer.kill()
        writer.communicate()


OTHER_WRITER = """
import sys
from pathlib import Path
from planning.base.errors import InputError
from reconstruction.records.book import RecordBook
from reconstruction.records.entries import Attribute
with RecordBook(Path(sys.argv[1]), True, "Lee", busy_s=0.05) as book:
    try:
        book.put(Attribute(sys.argv[2], "maker", "b"))
    except InputError as error:
        print(error)
"""


def test_a_look_at_the_book_leaves_the_locks_of_the_same_process_alone(book):
    # POSIX locks of a process end when it closes any descriptor of the file, SQLite's or not.
    with book.changing("long") as changes:
        changes.put(Attribute(PANES[0], "maker", "a"))
        RecordBook(book.path).close()
        with pytest.raises(InputError, match="there are no records"):
            RecordBook(book.path.with_name("none")).close()
        command = [sys.executable, "-c", OTHER_WRITER, str(book.path), PANES[0]]
        said = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
        assert "another program is writing the records" in said
    assert [entry.value for entry in book.entries(Attribute)] == ["a"]


def test_readers_that_were_open_go_on_when_a_writer_is_killed(tmp_path):
    with new_book(tmp_path) as book:
        book.put(Attribute(PANES[0], "maker", "old"))
    with RecordBook(book.path) as reader:
        before = state(reader)
        command = [sys.executable, "-c", WRITER, str(book.path), PANES[0]]
        writer = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT)
        assert writer.stdout.readline() == b"written\n"
        os.kill(writer.pid, signal.SIGKILL)
        writer.communicate()
        assert book.path.with_name(f"{FILE}-journal").exists()
        with reader.database.snapshot():
            assert state(reader) == before


def test_readers_leave_a_writer_at_work_alone(book):
    book.database.rows("PRAGMA cache_size = 5")
    with book.changing("long") as changes:
        for pane in PANES:
            changes.put(Attribute(pane, "maker", "new " * 2000))
        assert book.path.with_name(f"{FILE}-journal").exists()
        with RecordBook(book.path) as reader:
            assert reader.entries(Attribute) == ()
    assert len(book.entries(Attribute)) == len(PANES)


def test_a_full_disk_changes_nothing(book):
    pages = book.database.rows("PRAGMA page_count")[0][0]
    book.database.rows(f"PRAGMA max_page_count = {pages + 2}")
    before = state(book)
    much = [Maintenance(PANES[0], "2026-01-01", f"{number} washed " * 30) for number in range(500)]
    with pytest.raises(InputError, match="the disk is full; nothing was changed"):
        _put_all(book, *much)
    assert state(book) == before
    book.check()


def test_books_that_are_read_only_and_changes_without_a_name_are_refused(tmp_path):
    with new_book(tmp_path) as book, RecordBook(book.path) as reader:
        with pytest.raises(InputError, match="open for reading only"):
            reader.put(Attribute(PANES[0], "maker", "a"))
        with pytest.raises(InputError, match="who: expected a text"):
            RecordBook(book.path, True, " ")
        with pytest.raises(InputError, match="no inspection with the key"):
            reader.entry(Inspection, PANES[0])
