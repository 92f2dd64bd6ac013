"""The file: foreign, damaged, newer and hostile ones are refused in words, and run nothing."""

import contextlib
import os
import shutil
import sqlite3
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.records.book import FILE, RecordBook, make_book
from reconstruction.records.database import (
    APPLICATION_ID,
    STEPS,
    Database,
    create_database,
    migrate,
    statements,
    version_of,
)
from reconstruction.records.entries import Attribute, Defect
from reconstruction.records.queries import (
    attribute_values,
    attributes_by_object,
    inspection_dates,
    open_severities,
    search,
)
from tests.reconstruction.records.cases import NASTY, PANES, contents, new_book


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A closed book with a hundred entries."""
    with new_book(tmp_path_factory.mktemp("sound")) as book, book.changing("content") as changes:
        for number in range(100):
            changes.put(Defect(PANES[number % 3], "crack", 1 + number % 5, "2026-01-01", note=f"{number} {NASTY[0]}"))
    return book.path


@pytest.fixture
def copy(sound, tmp_path):
    """A copy of it that may be broken."""
    return shutil.copy(sound, tmp_path / FILE)


def tampered(path, *sql):
    """Change a file as somebody else's program would."""
    connection = sqlite3.connect(path)
    for statement in sql:
        connection.execute(statement)
    connection.commit()
    connection.close()


def refusal(path, writing=False):
    with pytest.raises(InputError) as caught:
        RecordBook(path, writing, "Chan" if writing else "").close()
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value)


@pytest.mark.parametrize("writing", [False, True])
def test_what_is_no_file_of_ours_is_refused(tmp_path, writing):
    path = tmp_path / FILE
    assert "there are no records yet; make them with 'records FOLDER make --objects SITE'" in refusal(path, writing)
    path.mkdir()
    assert "is a folder" in refusal(path, writing)
    path.rmdir()
    path.write_bytes(b"")
    assert "the file is empty" in refusal(path, writing)
    path.write_bytes(b"PK\x03\x04" + bytes(2000))
    assert "found something else" in refusal(path, writing)
    path.write_bytes(b"SQLite format 3\x00")
    assert "cut off" in refusal(path, writing)
    path.unlink()
    tampered(path, "CREATE TABLE mine (a)")
    assert "of another program" in refusal(path, writing)
    path.unlink()
    os.mkfifo(path)
    assert "a device or a pipe" in refusal(path, writing)


def test_a_file_that_is_cut_off_is_refused(copy):
    content = copy.read_bytes()
    for length in (99, 100, 4096, len(content) // 2, len(content) - 1):
        copy.write_bytes(content[:length])
        assert "cut off" in refusal(copy)


@given(st.data())
def test_a_file_with_wrong_bytes_is_refused_or_read_but_never_crashes(sound, tmp_path_factory, data):
    content = bytearray(sound.read_bytes())
    for _ in range(data.draw(st.integers(1, 30))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.mktemp("bytes") / FILE
    path.write_bytes(content)
    with contextlib.suppress(InputError), RecordBook(path) as book:
        contents(book)
        search(book, "crack")
        book.objects()
        book.check()


@pytest.mark.parametrize(
    ("old", "new"), [(b"CREATE TABLE defects", b"CREATE TABLE \xe2efects"), (b"DROP TABLE", b"DR\xe2\xe2 TABLE")]
)
def test_texts_that_are_no_utf8_are_refused(copy, old, new):
    # The first of these made Python's module raise a UnicodeDecodeError of its own.
    copy.write_bytes(copy.read_bytes().replace(old, new))
    with pytest.raises(InputError, match="damaged"), RecordBook(copy) as book:
        contents(book)


def test_damage_inside_is_found_by_check(copy):
    content = bytearray(copy.read_bytes())
    page = content.index(b"DROP TABLE") // 4096
    content[page * 4096 + 8 : page * 4096 + 64] = bytes(range(56))
    copy.write_bytes(content)
    with RecordBook(copy) as book, pytest.raises(InputError, match="the file is damaged"):
        book.check()


def test_values_that_no_entry_holds_are_refused_with_table_and_row(copy):
    tampered(copy, "UPDATE defects SET severity = 77 WHERE id = 3")
    with RecordBook(copy) as book, pytest.raises(InputError, match="defects: severity: expected a number from 1 to 5"):
        open_severities(book)
    with RecordBook(copy) as book, pytest.raises(InputError, match=r"defects, row 3: severity: expected .* got 77"):
        contents(book)
    tampered(copy, "UPDATE defects SET severity = 1, outline = '[[0,0],[1e999,0],[0,1]]' WHERE id = 3")
    with RecordBook(copy) as book, pytest.raises(InputError, match="defects, row 3: outline: expected a number"):
        contents(book)
    tampered(copy, "UPDATE defects SET outline = '[]', u = 9e999, v = 0.0 WHERE id = 3")
    with RecordBook(copy) as book, pytest.raises(InputError, match="defects, row 3: u, v: expected a number"):
        contents(book)
    tampered(copy, "UPDATE objects SET corners = '[[1,2,3]]' WHERE id = 4")
    with RecordBook(copy) as book, pytest.raises(InputError, match=r"objects, row 4: .*expected four points"):
        book.objects()
    tampered(
        copy,
        "INSERT INTO attributes VALUES (1, 4, '0000000000000000000000', 'a', 9e999, 'number', '')",
        "INSERT INTO inspections VALUES (1, 4, '', 'x', '', '', '', '')",
        "UPDATE objects SET width_m = -9e999",
    )
    for ask in (
        lambda book: attribute_values(book, "a"),
        lambda book: attribute_values(book, "width"),
        inspection_dates,
        attributes_by_object,
    ):
        with RecordBook(copy) as book, pytest.raises(InputError, match="the file is damaged"):
            ask(book)
    tampered(copy, "UPDATE facts SET value = '[91, 0, 0]'")
    with RecordBook(copy) as book, pytest.raises(InputError, match="facts: origin: lat_deg"):
        _ = book.origin


@pytest.mark.parametrize("writing", [False, True])
@pytest.mark.parametrize(
    ("sql", "words"),
    [
        (
            "CREATE TRIGGER evil AFTER INSERT ON defects BEGIN DELETE FROM objects; END",
            "the trigger 'evil', which is none",
        ),
        ("CREATE VIEW evil AS SELECT load_extension('x')", "the view 'evil', which is none"),
        ("CREATE TABLE evil (a, b AS (abs(a)))", "the table 'evil', which is none"),
        ("CREATE INDEX evil ON defects (abs(severity))", "the index 'evil', which is none"),
        ("CREATE VIRTUAL TABLE evil USING fts5(a)", "'evil"),
        ("DROP INDEX defects_by_object", "lacks the index 'defects_by_object'"),
        ("DROP TABLE facts", "lacks the table 'facts'"),
        ("ALTER TABLE defects ADD COLUMN evil TEXT CHECK (length(evil))", "'defects' is not as ours are"),
        ("ALTER TABLE facts RENAME TO search_data2", "'search_data2', which is none"),
    ],
)
def test_tables_triggers_and_views_of_others_are_refused(copy, sql, words, writing):
    before = copy.read_bytes()
    tampered(copy, sql)
    assert words in refusal(copy, writing)
    assert copy.read_bytes() != before


def test_a_view_in_place_of_a_table_is_refused(copy):
    tampered(copy, "DROP TABLE documents", "CREATE VIEW documents AS SELECT 1")
    assert "'documents' is not as ours are" in refusal(copy)


def test_newer_versions_are_refused_before_anything_else(copy):
    content = bytearray(copy.read_bytes())
    for version in (len(STEPS) + 1, 2**31 - 1, -1):
        content[60:64] = struct.pack(">i", version)
        copy.write_bytes(content)
        assert f"have version {version}, this program knows up to {len(STEPS)}" in refusal(copy, True)


def test_a_book_under_somebody_elses_journal_mode_is_brought_back(copy):
    tampered(copy, "PRAGMA journal_mode = WAL")
    with RecordBook(copy, True, "Chan") as book:
        assert book.database.rows("PRAGMA journal_mode")[0][0] == "delete"
        assert len(contents(book)) == 100


def test_read_only_folders_and_files(copy):
    copy.chmod(0o444)
    copy.parent.chmod(0o555)
    try:
        with RecordBook(copy) as book:
            assert len(contents(book)) == 100
        if os.geteuid():
            assert "write-protected" in refusal(copy, True)
    finally:
        copy.parent.chmod(0o755)


def test_odd_names_of_folders_are_no_part_of_the_address(tmp_path):
    for name in ("a b#c?mode=memory", "%41", "ü'; --"):
        (tmp_path / name).mkdir()
        with new_book(tmp_path / name) as book:
            book.put(Attribute(PANES[0], "maker", "x"))
        assert (tmp_path / name / FILE).stat().st_size > 4096
    with pytest.raises(InputError, match="is there already"):
        make_book(tmp_path / "%41" / FILE)
    with pytest.raises(InputError, match="cannot be made"):
        make_book(tmp_path / "missing" / FILE)


LATER = (
    *STEPS,
    "ALTER TABLE documents ADD COLUMN pages INTEGER NOT NULL DEFAULT 1;\n",
    "CREATE TABLE visits (id INTEGER PRIMARY KEY) STRICT;\nCREATE INDEX visits_by_id ON visits (id);\n",
)
"""Steps as a later version could have them."""


@pytest.mark.parametrize("version", range(len(LATER)))
def test_migrations_lead_from_every_older_version_to_the_newest(tmp_path, version):
    path = tmp_path / FILE
    create_database(path, LATER[:version] or STEPS)
    connection = sqlite3.connect(path, isolation_level=None)
    if version == 0:
        connection.executescript(
            "PRAGMA writable_schema = ON; DELETE FROM sqlite_master; PRAGMA user_version = 0; VACUUM"
        )
    else:
        connection.execute("INSERT INTO facts VALUES ('kept', 'yes')")
    connection.close()
    if version:
        with pytest.raises(InputError, match=f"have the older version {version}"):
            Database(path, False, steps=LATER)
    database = Database(path, True, steps=LATER)
    assert database.rows("PRAGMA user_version")[0][0] == len(LATER)
    assert [row[0] for row in database.rows("SELECT value FROM facts")] == ["yes"] * bool(version)
    database.close()
    Database(path, False, steps=LATER).close()


def test_a_migration_that_fails_leaves_the_version_before(copy):
    broken = (*STEPS, "CREATE TABLE a (b) STRICT;\n")
    with pytest.raises(InputError, match="cannot be used"):
        Database(copy, True, steps=broken)
    with RecordBook(copy, True, "Chan") as book:
        assert len(contents(book)) == 100
        assert book.database.rows("PRAGMA user_version")[0][0] == len(STEPS)


def test_steps_are_split_into_whole_statements():
    connection = sqlite3.connect(":memory:", isolation_level=None)
    assert migrate(connection) == len(STEPS)
    assert version_of(connection) == len(STEPS)
    assert connection.execute("PRAGMA application_id").fetchone()[0] == APPLICATION_ID
    assert all(sqlite3.complete_statement(f"{statement};") for step in STEPS for statement in statements(step))
    connection.close()


def test_changes_outside_a_transaction_are_a_mistake_of_the_caller(copy):
    with RecordBook(copy, True, "Chan") as book, pytest.raises(ValueError, match="expected a transaction"):
        book.database.run("DELETE FROM defects")
