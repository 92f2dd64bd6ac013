"""A SQLite file of ours, opened with care: what is foreign, damaged or newer is refused in words, and runs no code.

One rollback journal, no write-ahead log: the log needs memory that all readers share, which network drives do not have,
and a folder that can be written even for reading. Readers wait only while a writer copies its pages into the file.
"""

from __future__ import annotations

import json
import os
import sqlite3
import stat
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from planning.base.errors import InputError
from planning.base.json_file import encoded, to_record
from planning.base.messages import about, glue, say
from reconstruction.records.entries import Attribute, Defect, Entry, Kind
from reconstruction.records.objects import ObjectRow

# The tables, version by version, and the check that a database has these and nothing of anybody else's.

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


BUSY_S = 5.0
"""How long one waits for another's writing; the largest import took a second."""

FAILURES = (sqlite3.Error, UnicodeError, OverflowError)
"""What a damaged file makes Python's module raise: it decodes messages and texts as UTF-8."""

MAX_FILE_BYTES = 64 * 2**30


class Database:
    """An open file; safe from several threads, one statement at a time.

    Parameters
    ----------
    writing
        Open for changes as well, and bring an older version up to date.
    busy_s
        How long to wait for others.

    Raises
    ------
    InputError
        There is no such file, or it is none of ours, damaged, newer, or not to be opened.
    """

    def __init__(self, path: Path, writing: bool = False, busy_s: float = BUSY_S, steps: Sequence[str] = STEPS) -> None:
        self.path, self.writing, self._busy_s = path, writing, busy_s
        self._lock = threading.RLock()
        _check_place(path, writing)
        with self._in_words():
            try:
                self._connection = self._opened(steps)
            except sqlite3.OperationalError as error:
                if not _was_interrupted(error):
                    raise
                _take_back(path, busy_s)
                self._connection = self._opened(steps)

    def _opened(self, steps: Sequence[str]) -> sqlite3.Connection:
        connection = _connected(self.path, "rw" if self.writing else "ro", self._busy_s)
        try:
            _check_content(connection, self.path, steps, self.writing)
            if self.writing:
                # Somebody's tool may have switched it; see the module's text.
                connection.execute("PRAGMA journal_mode = DELETE")
                migrate(connection, steps)
        except BaseException as error:
            connection.close()
            if isinstance(error, InputError):
                raise InputError(about(self.path, error)) from error
            raise
        return connection

    def close(self) -> None:
        """Close the file; what was not committed is gone."""
        with self._lock:
            self._connection.close()

    def rows(self, sql: str, values: Sequence[Any] = ()) -> list[Any]:
        """Rows of a query.

        Raises
        ------
        InputError
            The file is damaged, or somebody wrote for too long.
        """
        with self._lock, self._in_words():
            try:
                return self._connection.execute(sql, values).fetchall()
            except sqlite3.OperationalError as error:
                if self.writing or not _was_interrupted(error):
                    raise
                # A writer was killed since this file was opened. No row of this transaction was read before: while one
                # reads, nobody writes.
                _take_back(self.path, self._busy_s)
                return self._connection.execute(sql, values).fetchall()

    def run(self, sql: str, values: Sequence[Any] = ()) -> int:
        """Run one statement that changes something, within `transaction`; returns the id of a row it put in.

        Raises
        ------
        InputError
            As `rows`; the disk is full, or the file is write-protected.
        """
        with self._lock:
            if not self._connection.in_transaction:
                raise ValueError("expected a transaction around every change")
            try:
                return int(self._connection.execute(sql, values).lastrowid or 0)
            except FAILURES as error:
                raise _refusal(self.path, error, self._busy_s) from error

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """All changes inside, or none; others cannot write meanwhile.

        Raises
        ------
        InputError
            As `run`; the file is open for reading only.
        """
        if not self.writing:
            raise InputError(say("the records are open for reading only", place=self.path))
        with self._lock, self._in_words():
            self._connection.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._connection.execute("COMMIT")
            except BaseException:
                if self._connection.in_transaction:
                    self._connection.execute("ROLLBACK")
                raise

    @contextmanager
    def snapshot(self) -> Iterator[None]:
        """All queries inside see one state of the file."""
        with self._lock, self._in_words():
            is_outermost = not self._connection.in_transaction
            if is_outermost:
                self._connection.execute("BEGIN")
            try:
                yield
            finally:
                if is_outermost:
                    self._connection.execute("COMMIT")

    def check(self) -> None:
        """Look at every page, index and reference of the file.

        Raises
        ------
        InputError
            Something in it is damaged.
        """
        with self._lock, self._in_words():
            found = [str(row[0]) for row in self._connection.execute("PRAGMA integrity_check(5)")]
            if found != ["ok"]:
                raise InputError(
                    say("the file is damaged ({}); take a copy of it back", "; ".join(found)[:300], place=self.path)
                )
            strays = self._connection.execute("PRAGMA foreign_key_check").fetchall()
            if strays:
                raise InputError(
                    say("{} rows refer to rows that are not there; take a copy back", len(strays), place=self.path)
                )

    @contextmanager
    def _in_words(self) -> Iterator[None]:
        try:
            yield
        except FAILURES as error:
            raise _refusal(self.path, error, self._busy_s) from error


def create_database(path: Path, steps: Sequence[str] = STEPS) -> None:
    """Make an empty file of ours, whole or not at all.

    Raises
    ------
    InputError
        Something has that name, or it cannot be made.
    """
    if os.path.lexists(path):
        raise InputError(say("is there already; nothing is written over it", place=path))
    temporary: Path | None = None
    try:
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        os.close(descriptor)
        temporary = Path(name)
        connection = _connected(temporary, "rw", BUSY_S)
        try:
            migrate(connection, steps)
        finally:
            connection.close()
        temporary.chmod(0o644)
        temporary.rename(path)
    except FAILURES as error:
        raise _refusal(path, error, BUSY_S) from error
    except OSError as error:
        raise InputError(
            say("cannot be made ({}); name another folder", error.strerror or error, place=path)
        ) from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def _connected(path: Path, mode: str, busy_s: float) -> sqlite3.Connection:
    connection = sqlite3.connect(
        f"{path.absolute().as_uri()}?mode={mode}", busy_s, isolation_level=None, check_same_thread=False, uri=True
    )
    # Before anything of the file is read: what stands in it is not to be trusted, and no other file is opened for it.
    for pragma in ("trusted_schema = OFF", "cell_size_check = ON", "foreign_keys = ON", "synchronous = EXTRA"):
        connection.execute(f"PRAGMA {pragma}")
    # Pages of a large change stay in memory until all is done: written before, they would keep readers out.
    connection.execute("PRAGMA cache_spill = OFF")
    connection.setlimit(sqlite3.SQLITE_LIMIT_ATTACHED, 0)
    return connection


def _was_interrupted(error: sqlite3.Error) -> bool:
    """Whether a read failed over what a killed writer left, which those who only read cannot take back."""
    return getattr(error, "sqlite_errorname", "") in ("SQLITE_READONLY_ROLLBACK", "SQLITE_READONLY_RECOVERY")


def _take_back(path: Path, busy_s: float) -> None:
    """Take back what an interrupted writer left; a writer at work is waited for."""
    connection = _connected(path, "rw", busy_s)
    try:
        connection.execute("PRAGMA user_version").fetchall()
    finally:
        connection.close()


def _check_place(path: Path, writing: bool) -> None:
    """Refuse what is no regular file.

    It is not opened for that, here or anywhere else but by SQLite: what one reads without SQLite's lock may be half of
    a change, and to close a file ends all locks that the same process has on it.
    """
    try:
        status = path.stat()
    except FileNotFoundError:
        raise InputError(
            say("there are no records yet; make them with 'records FOLDER make --objects SITE'", place=path)
        ) from None
    except (OSError, ValueError) as error:
        raise InputError(say("cannot be read ({})", getattr(error, "strerror", None) or error, place=path)) from error
    if stat.S_ISDIR(status.st_mode):
        raise InputError(say("is a folder; expected a file with records", place=path))
    if not stat.S_ISREG(status.st_mode):
        raise InputError(say("expected a file with records, found a device or a pipe", place=path))
    if not status.st_size:
        raise InputError(say("the file is empty; take a copy of it back", place=path))
    if status.st_size > MAX_FILE_BYTES:
        raise InputError(
            say("the file has more than {} GiB; take a copy of it back", MAX_FILE_BYTES // 2**30, place=path)
        )
    if writing and not os.access(path, os.W_OK):
        raise InputError(say("the file is write-protected", place=path))


def _check_content(connection: sqlite3.Connection, path: Path, steps: Sequence[str], writing: bool) -> None:
    """Refuse what is none of ours, newer or cut off, all of it looked at in one state of the file.

    Raises
    ------
    InputError
        As said, without the file's name.
    sqlite3.Error
        SQLite finds it damaged.
    """
    connection.execute("BEGIN")
    try:
        application = connection.execute("PRAGMA application_id").fetchone()[0]
        if application != APPLICATION_ID:
            raise InputError(say("is a SQLite file of another program, not records of ours"))
        version = version_of(connection)
        check_version(version, len(steps))
        check_schema(connection, steps)
        if not writing and version < len(steps):
            raise InputError(
                say(
                    "the records have the older version {}; opening them for writing, as 'records FOLDER make' does, "
                    "brings them up to date",
                    version,
                )
            )
        n_pages, page_bytes = (
            connection.execute(f"PRAGMA {name}").fetchone()[0] for name in ("page_count", "page_size")
        )
        # SQLite misses whole pages, not a last one that is cut off. Pages of a write-ahead log are in the log.
        size, wanted = path.stat().st_size, n_pages * page_bytes
        if size < wanted and connection.execute("PRAGMA journal_mode").fetchone()[0] != "wal":
            raise InputError(say("the file is cut off ({} of {} bytes); take a copy of it back", size, wanted))
    finally:
        connection.execute("ROLLBACK")


def _refusal(path: Path, error: Exception, busy_s: float) -> InputError:
    name = getattr(error, "sqlite_errorname", "") or ""
    words = {
        "SQLITE_BUSY": say("another program is writing the records; waited {:g} s; try again", busy_s),
        "SQLITE_LOCKED": say("another program is writing the records; waited {:g} s; try again", busy_s),
        "SQLITE_FULL": say("the disk is full; nothing was changed"),
        "SQLITE_READONLY": say(
            "the file or its folder is write-protected, or a write was interrupted here; make the folder "
            "writable and open it for writing"
        ),
        "SQLITE_CANTOPEN": say("cannot be opened; is its folder there, and may it be written?"),
        "SQLITE_CORRUPT": say("the file is damaged or cut off; take a copy of it back"),
        "SQLITE_NOTADB": say("expected records (a SQLite file), found something else or a file that is cut off"),
        "SQLITE_IOERR": say("the disk does not answer as it should; nothing was changed"),
        "SQLITE_TOOBIG": say("a value is too large"),
    }
    known = next((text for start, text in words.items() if name.startswith(start)), None)
    return InputError(glue(path, ": ", known or say("is damaged or cannot be used ({})", error)))


# Entries as rows of their tables, as JSON in the history, and back; nothing is believed that comes from a file.

OBJECT_COLUMNS = "o.id, o.global_id, o.layer, p.global_id, o.name, o.corners, o.is_present"
OBJECTS = "objects o LEFT JOIN objects p ON p.id = o.parent_id"


def selected(kind: Kind) -> str:
    """Columns of a query for entries, with the object as `o` and the entry as `e`: what `entry_of` takes."""
    return "e.id, o.global_id, " + ", ".join(f"e.{column}" for column in kind.columns)


def joined(kind: Kind) -> str:
    """Tables of such a query."""
    return f"{kind.table} e JOIN objects o ON o.id = e.object_id"


def values_of(entry: Entry, kind: Kind) -> list[Any]:
    """Values of an entry's columns."""
    return [_stored(entry, column) for column in kind.columns]


def _stored(entry: Entry, column: str) -> Any:
    value = getattr(entry, column)
    if column == "outline":
        return json.dumps(value)
    if column == "inspection":
        return value or None
    if isinstance(entry, Attribute) and column == "value":
        return float(value) if entry.type == "number" else int(value) if isinstance(value, bool) else value
    return value


def entry_of(row: Any, kind: Kind, book: Database) -> Entry:
    """Entry of a row of `selected` columns.

    Raises
    ------
    InputError
        The row holds what no entry may hold.
    """
    content = dict(zip(("global_id", *kind.columns), row[1:], strict=True))
    if kind.record is Attribute and content["type"] == "yes/no" and content["value"] in (0, 1):
        content["value"] = bool(content["value"])
    try:
        if kind.record is Defect:
            content["outline"] = tuple(tuple(place) for place in json.loads(content["outline"]))
            content["inspection"] = content["inspection"] or ""
        return kind.record(**content)
    except (InputError, ValueError, TypeError, RecursionError) as error:
        raise InputError(
            say("{}, row {}: {}; the file is damaged", kind.table, row[0], error, place=book.path)
        ) from error


def object_of(row: Any, book: Database) -> ObjectRow:
    """Object of a row of `OBJECT_COLUMNS`.

    Raises
    ------
    InputError
        The row holds what no object may hold.
    """
    try:
        corners = None if row[5] is None else msgspec.json.decode(row[5], type=tuple[tuple[float, float, float], ...])
        return ObjectRow(row[1], row[2], row[3], row[4], corners)  # type: ignore[arg-type]  # it checks them
    except (InputError, ValueError, TypeError, RecursionError) as error:
        raise InputError(say("objects, row {}: {}; the file is damaged", row[0], error, place=book.path)) from error


def as_json(entry: Entry) -> str:
    """An entry in the history."""
    return encoded(entry).decode()


def from_json(text: str, kind: Kind, book: Database) -> Entry:
    """An entry from the history.

    Raises
    ------
    InputError
        It holds what no entry may hold.
    """
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(say("changes: holds no {}; the file is damaged", kind.name, place=book.path)) from error
    return to_record(content, kind.record, book.path)


def searched_texts(entry: Entry, kind: Kind) -> list[tuple[int, str]]:
    """Texts of an entry that are searched, with the numbers of their fields."""
    found = [(index, getattr(entry, field)) for index, field in enumerate(kind.texts)]
    return [(index, text) for index, text in found if isinstance(text, str) and text]
