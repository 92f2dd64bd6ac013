"""A SQLite file of ours, opened with care: what is foreign, damaged or newer is refused in words, and runs no code.

One rollback journal, no write-ahead log: the log needs memory that all readers share, which network drives do not have,
and a folder that can be written even for reading. Readers wait only while a writer copies its pages into the file.
"""

from __future__ import annotations

import os
import sqlite3
import struct
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from planning.errors import InputError
from reconstruction.records.schema import APPLICATION_ID, STEPS, check_schema, check_version, migrate, version_of

BUSY_S = 5.0
"""How long one waits for another's writing; the largest import took a second."""

FAILURES = (sqlite3.Error, UnicodeError, OverflowError)
"""What a damaged file makes Python's module raise: it decodes messages and texts as UTF-8."""

HEADER = b"SQLite format 3\x00"
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
        _check_file(path, len(steps), writing)
        with self._in_words():
            if not writing:
                _take_back(path, busy_s)
            self._connection = _connected(path, "rw" if writing else "ro", busy_s)
            try:
                self._prepare(steps)
            except BaseException as error:
                self._connection.close()
                if isinstance(error, InputError):
                    raise InputError(f"{path}: {error}") from error
                raise

    def _prepare(self, steps: Sequence[str]) -> None:
        check_version(version_of(self._connection), len(steps))
        check_schema(self._connection, steps)
        if not self.writing:
            if version_of(self._connection) < len(steps):
                raise InputError(
                    f"the records have the older version {version_of(self._connection)}; opening them for "
                    "writing, as 'records FOLDER make' does, brings them up to date"
                )
            return
        # Somebody's tool may have switched it; see the module's text.
        self._connection.execute("PRAGMA journal_mode = DELETE")
        migrate(self._connection, steps)

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
        with self._lock:
            try:
                return self._connection.execute(sql, values).fetchall()
            except FAILURES as error:
                raise _refusal(self.path, error, self._busy_s) from error

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
            raise InputError(f"{self.path}: the records are open for reading only")
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
                raise InputError(f"{self.path}: the file is damaged ({'; '.join(found)[:300]}); take a copy of it back")
            strays = self._connection.execute("PRAGMA foreign_key_check").fetchall()
            if strays:
                raise InputError(f"{self.path}: {len(strays)} rows refer to rows that are not there; take a copy back")

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
        raise InputError(f"{path}: is there already; nothing is written over it")
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
        raise InputError(f"{path}: cannot be made ({error.strerror or error}); name another folder") from error
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


def _take_back(path: Path, busy_s: float) -> None:
    """Take back what an interrupted writer left, which those who only read cannot; a writer at work is left alone."""
    has_journal = path.with_name(f"{path.name}-journal").exists()
    if has_journal and os.access(path, os.W_OK) and os.access(path.parent, os.W_OK):
        connection = _connected(path, "rw", busy_s)
        try:
            connection.execute("PRAGMA user_version").fetchall()
        finally:
            connection.close()


def _check_file(path: Path, known: int, writing: bool) -> None:
    """Refuse by the header alone what is no file of ours: SQLite never sees it."""
    try:
        if path.is_dir():
            raise InputError(f"{path}: is a folder; expected a file with records")
        if not path.exists():
            raise InputError(f"{path}: there are no records yet; make them with 'records FOLDER make --objects SITE'")
        if not path.is_file():
            raise InputError(f"{path}: expected a file with records, found a device or a pipe")
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(100)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if not size:
        raise InputError(f"{path}: the file is empty; take a copy of it back")
    if not head.startswith(HEADER[:size]) or (len(head) == 100 and not head.startswith(HEADER)):
        raise InputError(f"{path}: expected records (a SQLite file), found something else")
    if len(head) < 100 or size > MAX_FILE_BYTES:
        raise InputError(f"{path}: the file is cut off or too large; take a copy of it back")
    page, changed, pages, valid, version, application = _header(head)
    if application != APPLICATION_ID:
        raise InputError(f"{path}: is a SQLite file of another program, not records of ours")
    try:
        check_version(version, known)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    # A journal beside it belongs to a write that was interrupted: SQLite takes it back, lengths and all.
    if changed == valid and size < page * pages and not path.with_name(f"{path.name}-journal").exists():
        raise InputError(f"{path}: the file is cut off ({size} of {page * pages} bytes); take a copy of it back")
    if writing and not os.access(path, os.W_OK):
        raise InputError(f"{path}: the file is write-protected")


def _header(head: bytes) -> tuple[int, int, int, int, int, int]:
    """Page size, change counter, pages, counter that the pages hold for, user version and application id."""
    (page,) = struct.unpack_from(">H", head, 16)
    changed, pages = struct.unpack_from(">II", head, 24)
    version, application, valid = (struct.unpack_from(">i", head, at)[0] for at in (60, 68, 92))
    return (65536 if page == 1 else page), changed, pages, valid, version, application


def _refusal(path: Path, error: Exception, busy_s: float) -> InputError:
    name = getattr(error, "sqlite_errorname", "") or ""
    words = {
        "SQLITE_BUSY": f"another program is writing the records; waited {busy_s:g} s; try again",
        "SQLITE_LOCKED": f"another program is writing the records; waited {busy_s:g} s; try again",
        "SQLITE_FULL": "the disk is full; nothing was changed",
        "SQLITE_READONLY": "the file or its folder is write-protected, or a write was interrupted here; make the "
        "folder writable and open it for writing",
        "SQLITE_CANTOPEN": "cannot be opened; is its folder there, and may it be written?",
        "SQLITE_CORRUPT": "the file is damaged; take a copy of it back",
        "SQLITE_NOTADB": "expected records (a SQLite file), found something else",
        "SQLITE_IOERR": "the disk does not answer as it should; nothing was changed",
        "SQLITE_TOOBIG": "a value is too large",
    }
    known = next((text for start, text in words.items() if name.startswith(start)), None)
    return InputError(f"{path}: {known or f'is damaged or cannot be used ({error})'}")
