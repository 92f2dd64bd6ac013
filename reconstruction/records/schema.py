"""The tables, version by version, and the check that a database has these and nothing of anybody else's."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from functools import cache

from planning.base.errors import InputError
from planning.base.messages import say

APPLICATION_ID = 0x52464C52
"""`RFLR` in a SQLite file's header: records of ours."""

_OF_OBJECT = "id INTEGER PRIMARY KEY, object_id INTEGER NOT NULL REFERENCES objects(id), key TEXT NOT NULL UNIQUE"

_VERSION_1 = f"""
CREATE TABLE facts (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
CREATE TABLE objects (
  id INTEGER PRIMARY KEY, global_id TEXT NOT NULL UNIQUE, layer TEXT NOT NULL,
  parent_id INTEGER REFERENCES objects(id), name TEXT NOT NULL, corners TEXT, width_m REAL, height_m REAL,
  is_present INTEGER NOT NULL) STRICT;
CREATE TABLE attributes (
  {_OF_OBJECT}, name TEXT NOT NULL, value ANY NOT NULL, type TEXT NOT NULL, unit TEXT NOT NULL,
  UNIQUE (object_id, name)) STRICT;
CREATE TABLE inspections (
  {_OF_OBJECT}, date TEXT NOT NULL, inspector TEXT NOT NULL, method TEXT NOT NULL, result TEXT NOT NULL,
  note TEXT NOT NULL) STRICT;
CREATE TABLE defects (
  {_OF_OBJECT}, kind TEXT NOT NULL, severity INTEGER NOT NULL, found_on TEXT NOT NULL, u REAL, v REAL,
  outline TEXT NOT NULL, picture TEXT NOT NULL, status TEXT NOT NULL, repaired_on TEXT, note TEXT NOT NULL,
  inspection TEXT REFERENCES inspections(key) DEFERRABLE INITIALLY DEFERRED) STRICT;
CREATE TABLE maintenance (
  {_OF_OBJECT}, date TEXT NOT NULL, work TEXT NOT NULL, done_by TEXT NOT NULL, cost REAL, currency TEXT NOT NULL,
  next_due TEXT, note TEXT NOT NULL) STRICT;
CREATE TABLE documents (
  {_OF_OBJECT}, title TEXT NOT NULL, place TEXT NOT NULL, kind TEXT NOT NULL, sha256 TEXT NOT NULL) STRICT;
CREATE TABLE change_sets (
  id INTEGER PRIMARY KEY AUTOINCREMENT, at_utc TEXT NOT NULL, who TEXT NOT NULL, what TEXT NOT NULL,
  undoes INTEGER UNIQUE REFERENCES change_sets(id)) STRICT;
CREATE TABLE changes (
  id INTEGER PRIMARY KEY AUTOINCREMENT, change_set INTEGER NOT NULL REFERENCES change_sets(id),
  object_id INTEGER NOT NULL REFERENCES objects(id), kind TEXT NOT NULL, row_id INTEGER NOT NULL,
  old TEXT, new TEXT) STRICT;
CREATE INDEX objects_by_name ON objects (name);
CREATE INDEX objects_by_parent ON objects (parent_id);
CREATE INDEX attributes_by_name ON attributes (name, object_id, value, type, unit);
CREATE INDEX inspections_by_object ON inspections (object_id, date DESC);
CREATE INDEX defects_by_object ON defects (object_id, status, severity DESC, found_on);
CREATE INDEX defects_by_inspection ON defects (inspection);
CREATE INDEX maintenance_by_object ON maintenance (object_id, date);
CREATE INDEX documents_by_object ON documents (object_id);
CREATE INDEX changes_by_object ON changes (object_id);
CREATE INDEX changes_by_set ON changes (change_set);
CREATE VIRTUAL TABLE search USING fts5(text, content='', tokenize='unicode61 remove_diacritics 2');
"""

STEPS: tuple[str, ...] = (_VERSION_1,)
"""SQL that brings a database from version i to i + 1."""

_SHADOWS = frozenset(f"search_{part}" for part in ("data", "idx", "docsize", "config"))
"""Tables that SQLite makes for the search index, in words that may differ from version to version of it."""

_NOT_OURS = ("sqlite_stat", "sqlite_sequence", "sqlite_autoindex")


def migrate(connection: sqlite3.Connection, steps: Sequence[str] = STEPS) -> int:
    """Bring a database to the newest version, each step whole or not at all; returns how many there were.

    Raises
    ------
    InputError
        It is of a newer version.
    """
    found = version_of(connection)
    check_version(found, len(steps))
    for version in range(found, len(steps)):
        # Each statement by itself: executescript would end the transaction.
        connection.execute("BEGIN IMMEDIATE")
        try:
            for statement in statements(steps[version]):
                connection.execute(statement)
            connection.execute(f"PRAGMA user_version = {version + 1}")
            connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            connection.execute("COMMIT")
        except BaseException:
            if connection.in_transaction:
                connection.execute("ROLLBACK")
            raise
    return len(steps) - found


def version_of(connection: sqlite3.Connection) -> int:
    """Version of a database's tables."""
    return int(connection.execute("PRAGMA user_version").fetchone()[0])


def check_version(found: int, known: int) -> None:
    """Refuse a newer version, and one that never was.

    Raises
    ------
    InputError
        As said.
    """
    if not 0 <= found <= known:
        raise InputError(
            say(
                "the records have version {}, this program knows up to {}; open them with a newer program", found, known
            )
        )


def statements(script: str) -> list[str]:
    """Statements of a script; semicolons stand at line ends only."""
    return [statement.strip() for statement in script.split(";\n") if statement.strip()]


def check_schema(connection: sqlite3.Connection, steps: Sequence[str] = STEPS) -> None:
    """Refuse a database that has other tables, or triggers, views and checks, which could run their maker's code.

    Raises
    ------
    InputError
        Something was added, changed or is missing; the message names it.
    """
    found, expected = _schema(connection), _expected(tuple(steps[: version_of(connection)]))
    for name, (kind, _) in found.items():
        if name not in expected:
            raise InputError(
                say("holds the {} '{}', which is none of ours; such a file is not opened", kind, name[:60])
            )
    for name, definition in expected.items():
        if name not in found:
            raise InputError(say("lacks the {} '{}'; the file is damaged or no file of ours", definition[0], name))
        if found[name] != definition:
            raise InputError(say("its {} '{}' is not as ours are; such a file is not opened", found[name][0], name))


@cache
def _expected(steps: tuple[str, ...]) -> dict[str, tuple[str, str]]:
    """What a database of ours consists of."""
    connection = sqlite3.connect(":memory:", isolation_level=None)
    try:
        migrate(connection, steps)
        return _schema(connection)
    finally:
        connection.close()


def _schema(connection: sqlite3.Connection) -> dict[str, tuple[str, str]]:
    rows = connection.execute("SELECT type, name, tbl_name, coalesce(sql, '') FROM sqlite_master")
    schema = {}
    for kind, name, table, sql in rows:
        if str(name).startswith(_NOT_OURS) and kind in ("table", "index"):
            continue  # SQLite's own; nobody else can make these
        is_shadow = kind == "table" and name in _SHADOWS
        schema[str(name)] = (str(kind), "" if is_shadow else f"{table}: {sql}")
    return schema
