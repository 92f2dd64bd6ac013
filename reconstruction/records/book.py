"""The book of records of one building: opened for reading or writing, every change in one place, with its history."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any

from planning.base.errors import InputError
from planning.base.messages import say
from planning.geo.frames import Origin
from reconstruction.records.changes import Changes
from reconstruction.records.database import (
    BUSY_S,
    OBJECT_COLUMNS,
    OBJECTS,
    Database,
    create_database,
    entry_of,
    from_json,
    joined,
    object_of,
    selected,
)
from reconstruction.records.entries import KIND_NAMED, KIND_OF, Entry
from reconstruction.records.limits import check_text
from reconstruction.records.objects import ObjectRow, check_objects

FILE = "records.sqlite"

Now = Callable[[], datetime]


def utc_now() -> datetime:
    """Time of a change."""
    return datetime.now(UTC)


@dataclass(frozen=True, slots=True)
class ObjectsSet:
    """What a model's objects changed in a book: how many are new, differ, are gone, and are in it now."""

    n_new: int
    n_changed: int
    n_absent: int
    n_present: int


class RecordBook:
    """Records of one building, open; use it as a context manager.

    Parameters
    ----------
    path
        Of the file, as `make_book` made it.
    writing
        Open for changes.
    who
        Name that changes are recorded under; needed for writing.
    now
        Clock of the history.

    Raises
    ------
    InputError
        There is no such book, it is damaged, newer or none of ours, or `who` is missing.
    """

    def __init__(
        self, path: Path, writing: bool = False, who: str = "", now: Now = utc_now, busy_s: float = BUSY_S
    ) -> None:
        if writing:
            check_text(who, "who", required=True)
        self.path, self._who, self._now = path, who, now
        self.database = Database(path, writing, busy_s)

    def __enter__(self) -> RecordBook:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self.database.close()

    def check(self) -> None:
        """Look at every page, index and reference of the file, which takes longer than opening it.

        Raises
        ------
        InputError
            Something in it is damaged.
        """
        self.database.check()

    @property
    def files(self) -> Path:
        """Folder of pictures and documents, beside the book; may be missing."""
        return self.path.with_name(f"{self.path.stem}-files")

    # Objects

    def set_objects(self, rows: Iterable[ObjectRow], origin: Origin | None = None) -> ObjectsSet:
        """Take the objects of a model; those that it lacks keep their records and are marked absent.

        Parameters
        ----------
        origin
            Of the ENU frame; None leaves the one that is known.

        Raises
        ------
        InputError
            They contradict one another, or the file cannot be written.
        """
        wanted = check_objects(rows)
        n_new = n_changed = n_absent = 0
        with self._changing("objects of the model") as changes:
            known = {row[1]: row for row in self._object_rows()}
            for row in wanted:
                before = known.pop(row.global_id, None)
                if before is None:
                    changes.put_object(row)
                    n_new += 1
                elif not before[6] or object_of(before, self.database) != row:
                    changes.put_object(row, before[0], bool(before[6]))
                    n_changed += 1
            for before in known.values():
                if before[6]:
                    changes.set_absent(before[0], before[1])
                    n_absent += 1
            if origin is not None:
                changes.set_fact("origin", json.dumps([origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m]))
        return ObjectsSet(n_new, n_changed, n_absent, len(wanted))

    def objects(self, with_absent: bool = False) -> tuple[ObjectRow, ...]:
        """Objects of the model, in the order in which they came; on request also those that it lacks by now."""
        return tuple(object_of(row, self.database) for row in self._object_rows() if with_absent or row[6])

    def is_present(self, global_id: str) -> bool:
        """Whether the model has an object."""
        return bool(self.database.rows("SELECT 1 FROM objects WHERE global_id = ? AND is_present", (global_id,)))

    def object(self, name: str) -> ObjectRow:
        """Object by GlobalId, or by name: of several of that name the one that the model has.

        Raises
        ------
        InputError
            There is none, or several are in the model.
        """
        sql = f"SELECT {OBJECT_COLUMNS} FROM {OBJECTS} WHERE o.global_id = ?"
        rows = self.database.rows(sql, (name,))
        if not rows:
            sql = f"SELECT {OBJECT_COLUMNS} FROM {OBJECTS} WHERE o.name = ? ORDER BY o.is_present DESC LIMIT 3"
            rows = self.database.rows(sql, (name,))
            if len(rows) > 1 and rows[1][6]:
                raise InputError(
                    say("'{}': {} and {} have this name; give the GlobalId", name[:60], rows[0][1], rows[1][1])
                )
        if not rows:
            raise InputError(say("'{}': there is no such object; give its name or its GlobalId", name[:60]))
        return object_of(rows[0], self.database)

    @property
    def origin(self) -> Origin | None:
        """Where the ENU frame's origin lies, where it is known.

        Raises
        ------
        InputError
            The file holds an impossible one.
        """
        rows = self.database.rows("SELECT value FROM facts WHERE name = 'origin'")
        try:
            return Origin(*json.loads(rows[0][0])) if rows else None
        except (ValueError, TypeError, RecursionError) as error:
            raise InputError(say("facts: origin: {}; the file is damaged", error, place=self.path)) from error

    def _object_rows(self) -> list[Any]:
        return self.database.rows(f"SELECT {OBJECT_COLUMNS} FROM {OBJECTS} ORDER BY o.id")

    # Entries

    def entries(self, record: type[Entry], global_id: str | None = None) -> tuple[Any, ...]:
        """Entries of a class, of one object or of all, in the order in which they were made."""
        kind = KIND_OF[record]
        where, values = ("", ()) if global_id is None else ("WHERE o.global_id = ?", (global_id,))
        rows = self.database.rows(f"SELECT {selected(kind)} FROM {joined(kind)} {where} ORDER BY e.id", values)
        return tuple(entry_of(row, kind, self.database) for row in rows)

    def entry(self, record: type[Entry], key: str) -> Any:
        """Entry by its key.

        Raises
        ------
        InputError
            There is none.
        """
        kind = KIND_OF[record]
        rows = self.database.rows(f"SELECT {selected(kind)} FROM {joined(kind)} WHERE e.key = ?", (key,))
        if not rows:
            raise InputError(say("there is no {} with the key '{}'", kind.name, key[:40]))
        return entry_of(rows[0], kind, self.database)

    @contextmanager
    def changing(self, what: str) -> Iterator[Changes]:
        """Several changes that are made, and undone, together; `what` says what for.

        Raises
        ------
        InputError
            One of them is refused (then none is made), or the file cannot be written.
        """
        with self._changing(what) as changes:
            yield changes

    def put(self, entry: Entry) -> Any:
        """Add an entry, or replace the one with its key (attributes: of its name); returns it with its key."""
        with self._changing(f"{KIND_OF[type(entry)].name} put") as changes:
            return changes.put(entry)

    def remove(self, entry: Entry) -> None:
        """Take an entry out; the history keeps it."""
        with self._changing(f"{KIND_OF[type(entry)].name} removed") as changes:
            changes.remove(entry)

    def undo(self) -> str | None:
        """Take back the last changes of records that still hold, all that were made together.

        Returns
        -------
        what
            Was taken back; None where there is nothing.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        last = (
            "SELECT max(s.id) FROM change_sets s JOIN changes c ON c.change_set = s.id WHERE s.undoes IS NULL AND "
            "c.kind != 'object' AND NOT EXISTS (SELECT 1 FROM change_sets u WHERE u.undoes = s.id)"
        )
        with self.database.transaction():
            number = self.database.rows(last)[0][0]
            if number is None:
                return None
            what = str(self.database.rows("SELECT what FROM change_sets WHERE id = ?", (number,))[0][0])
            changes = self._new_changes(f"undone: {what}"[:200], number)
            sql = "SELECT kind, old, new FROM changes WHERE change_set = ? AND kind != 'object' ORDER BY id DESC"
            for name, old, new in self.database.rows(sql, (number,)):
                kind = KIND_NAMED[name]
                if old is None:
                    changes.remove(from_json(new, kind, self.database))
                else:
                    changes.put(from_json(old, kind, self.database))
            return what

    @contextmanager
    def _changing(self, what: str) -> Iterator[Changes]:
        with self.database.transaction():
            yield self._new_changes(what)

    def _new_changes(self, what: str, undoes: int | None = None) -> Changes:
        check_text(what, "what")
        return Changes(
            self.database, self._now().astimezone(UTC).isoformat(timespec="milliseconds"), self._who, what, undoes
        )


def make_book(path: Path) -> None:
    """Make a book without objects.

    Raises
    ------
    InputError
        There is something of that name, or it cannot be made.
    """
    create_database(path)
