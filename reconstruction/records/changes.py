"""The one place that changes rows: each change goes into its table, the search index and the history, or nowhere."""

from __future__ import annotations

import itertools
import json
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import msgspec

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.records.database import Database, as_json, entry_of, joined, searched_texts, selected, values_of
from reconstruction.records.entries import (
    KIND_OF,
    Attribute,
    Defect,
    Entry,
    Inspection,
    Kind,
    global_id_of,
    new_global_id,
)
from reconstruction.records.objects import ObjectRow

# Words of users for the search index: nothing in them can be taken for its query language.

KIND_BITS, FIELD_BITS = 4, 4
"""Of a text's number in the index, below the row's: which kind of entry, which of its fields."""

OBJECT_CODE = 0
"""Kind of the names of objects."""

MAX_QUERY = 500
"""Characters of a query that are looked at."""

MAX_QUERY_WORDS = 16

MAX_SPELLED = 3
"""Double s of a word that may stand for ß in the texts, from the first on."""

# Scripts without blanks between words: every character is a word, and what is searched a phrase of them.
_WITHOUT_BLANKS = re.compile("([\u0e00-\u0eff\u3040-\u30ff\u3400-\u4dbf\u4e00-\u9fff\uac00-\ud7af\uf900-\ufaff])")
_WORD = re.compile(r"[^\W_]+")
_DOUBLE_S = re.compile("ss|ß", re.IGNORECASE)


def indexed_text(text: str) -> str:
    """Text as the index takes it."""
    text = text.replace("_", " ")
    return text if text.isascii() else _WITHOUT_BLANKS.sub(r" \1 ", text)


def query_of(text: str) -> str | None:
    """Query for texts that hold all words, the last letters of each left open; None without a word.

    Only letters and digits of the user's get into it, each run of them in quotes.
    """
    found = []
    text = unicodedata.normalize("NFC", text[:MAX_QUERY].replace("_", " "))
    for word in _WORD.findall(text)[:MAX_QUERY_WORDS]:
        spelled = [f'"{" ".join(indexed_text(each).split())}"*' for each in _spellings(word)]
        found.append(f"({' OR '.join(spelled)})" if len(spelled) > 1 else spelled[0])
    return " AND ".join(found) or None


def _spellings(word: str) -> list[str]:
    """A word as texts may have it: the index knows letters without case and accents, but not that ß is a double s.

    A single s at the end may be the half of one that is being typed.
    """
    first, *others = _DOUBLE_S.split(word)
    choices = [("ss", "ß")] * len(others[:MAX_SPELLED]) + [("ss",)] * len(others[MAX_SPELLED:])
    found = [first + "".join(map("".join, zip(each, others, strict=True))) for each in itertools.product(*choices)]
    return found + [f"{each[:-1]}ß" for each in found if each.endswith(("s", "S")) and not each.endswith("ss")]


class Changes:
    """Changes made together, inside a transaction of the database; nothing is in the history before the first.

    Parameters
    ----------
    at_utc, who, what
        For the history.
    undoes
        Number of the changes that these take back.
    """

    def __init__(self, database: Database, at_utc: str, who: str, what: str, undoes: int | None = None) -> None:
        self._database = database
        self._head = (at_utc, who, what, undoes)
        self._number: int | None = None
        self._objects: dict[str, int] = {}
        self.n_changed = 0

    def put(self, entry: Entry) -> Any:
        """Add an entry, or replace the one with its key; an attribute replaces the one of its name.

        Returns
        -------
        entry
            As it is in the book now, with its key.

        Raises
        ------
        InputError
            There is no such object or inspection, or the key belongs to another object's entry.
        """
        kind = KIND_OF[type(entry)]
        object_id = self._object_id(entry.global_id)
        row_id, before = self._before(entry, kind)
        if before is not None and before.global_id != entry.global_id:
            raise InputError(
                say("key: the {} {} belongs to another object, {}", kind.name, entry.key, before.global_id)
            )
        if not entry.key:
            entry = replace(entry, key=_new_key(entry) if before is None else before.key)
        if entry == before and as_json(entry) == as_json(before):
            return entry
        self._check_inspection(entry)
        values = values_of(entry, kind)
        if before is None:
            marks = ", ".join("?" * (len(values) + 1))
            sql = f"INSERT INTO {kind.table} (object_id, {', '.join(kind.columns)}) VALUES ({marks})"
            row_id = self._database.run(sql, (object_id, *values))
        else:
            sets = ", ".join(f"{column} = ?" for column in kind.columns)
            self._database.run(f"UPDATE {kind.table} SET {sets} WHERE id = ?", (*values, row_id))
        self._index(kind, row_id, before, entry)
        self._record(object_id, kind.name, row_id, None if before is None else as_json(before), as_json(entry))
        return entry

    def remove(self, entry: Entry) -> None:
        """Take an entry out, by its key.

        Raises
        ------
        InputError
            There is none with this key, or defects belong to the inspection.
        """
        kind = KIND_OF[type(entry)]
        row_id, before = self._before(entry, kind)
        if before is None:
            raise InputError(say("there is no {} with the key '{}'", kind.name, entry.key))
        if isinstance(before, Inspection):
            found = self._database.rows("SELECT count(*) FROM defects WHERE inspection = ?", (before.key,))[0][0]
            if found:
                raise InputError(say("the inspection of {} has {} defects; take these out first", before.date, found))
        self._database.run(f"DELETE FROM {kind.table} WHERE id = ?", (row_id,))
        self._index(kind, row_id, before, None)
        self._record(self._object_id(before.global_id), kind.name, row_id, as_json(before), None)

    def put_object(self, row: ObjectRow, known_id: int | None = None, was_present: bool = True) -> None:
        """Add an object, or bring the known one up to date; its parent is in the book already."""
        parent = None if row.parent is None else self._object_id(row.parent)
        corners = None if row.corners_enu_m is None else json.dumps(row.corners_enu_m)
        values = (row.layer, parent, row.name, corners, row.width_m, row.height_m)
        old = None
        if known_id is None:
            columns = "(layer, parent_id, name, corners, width_m, height_m, global_id, is_present)"
            sql = f"INSERT INTO objects {columns} VALUES (?, ?, ?, ?, ?, ?, ?, 1)"
            object_id = self._database.run(sql, (*values, row.global_id))
        else:
            object_id = known_id
            name = str(self._database.rows("SELECT name FROM objects WHERE id = ?", (known_id,))[0][0])
            old = json.dumps({"name": name, "is_present": was_present})
            self._delete_text(OBJECT_CODE, known_id, 0, name)
            sets = "layer = ?, parent_id = ?, name = ?, corners = ?, width_m = ?, height_m = ?, is_present = 1"
            self._database.run(f"UPDATE objects SET {sets} WHERE id = ?", (*values, known_id))
        self._objects[row.global_id] = object_id
        self._insert_text(OBJECT_CODE, object_id, 0, row.name)
        new = json.dumps({"name": row.name, "is_present": True})
        self._record(object_id, "object", object_id, old, new)

    def set_absent(self, object_id: int, global_id: str) -> None:
        """Mark an object that a new model lacks."""
        self._database.run("UPDATE objects SET is_present = 0 WHERE id = ?", (object_id,))
        name = str(self._database.rows("SELECT name FROM objects WHERE global_id = ?", (global_id,))[0][0])
        states = (json.dumps({"name": name, "is_present": present}) for present in (True, False))
        self._record(object_id, "object", object_id, *states)

    def set_fact(self, name: str, value: str) -> None:
        """Keep a fact about the book itself."""
        self._database.run("INSERT OR REPLACE INTO facts (name, value) VALUES (?, ?)", (name, value))

    def _object_id(self, global_id: str) -> int:
        if global_id not in self._objects:
            rows = self._database.rows("SELECT id FROM objects WHERE global_id = ?", (global_id,))
            if not rows:
                raise InputError(say("the model has no object {}", global_id, place="global_id"))
            self._objects[global_id] = int(rows[0][0])
        return self._objects[global_id]

    def _before(self, entry: Entry, kind: Kind) -> tuple[int, Entry | None]:
        """Row that an entry replaces."""
        wheres: list[tuple[str, Sequence[Any]]] = [("e.key = ?", (entry.key,))] if entry.key else []
        if isinstance(entry, Attribute):
            wheres.append(("o.global_id = ? AND e.name = ?", (entry.global_id, entry.name)))
        found: dict[int, Any] = {}
        for where, values in wheres:
            rows = self._database.rows(f"SELECT {selected(kind)} FROM {joined(kind)} WHERE {where}", values)
            found |= {int(row[0]): row for row in rows}
        if len(found) > 1:
            raise InputError(
                say("the object has an attribute '{}' with another key", getattr(entry, "name", ""), place=entry.key)
            )
        return next(((i, entry_of(row, kind, self._database)) for i, row in found.items()), (0, None))

    def _check_inspection(self, entry: Entry) -> None:
        if not isinstance(entry, Defect) or not entry.inspection:
            return
        sql = "SELECT o.global_id FROM inspections e JOIN objects o ON o.id = e.object_id WHERE e.key = ?"
        rows = self._database.rows(sql, (entry.inspection,))
        if not rows or rows[0][0] != entry.global_id:
            raise InputError(say("inspection: the object has no inspection with the key {}", entry.inspection))

    def _index(self, kind: Kind, row_id: int, before: Entry | None, after: Entry | None) -> None:
        old = [] if before is None else searched_texts(before, kind)
        new = [] if after is None else searched_texts(after, kind)
        for index, text in old:
            if (index, text) not in new:
                self._delete_text(kind.code, row_id, index, text)
        for index, text in new:
            if (index, text) not in old:
                self._insert_text(kind.code, row_id, index, text)

    def _insert_text(self, code: int, row_id: int, index: int, text: str) -> None:
        sql = "INSERT INTO search (rowid, text) VALUES (?, ?)"
        self._database.run(sql, (_place(code, row_id, index), indexed_text(text)))

    def _delete_text(self, code: int, row_id: int, index: int, text: str) -> None:
        # An index without content must be told what it forgets.
        sql = "INSERT INTO search (search, rowid, text) VALUES ('delete', ?, ?)"
        self._database.run(sql, (_place(code, row_id, index), indexed_text(text)))

    def _record(self, object_id: int, kind: str, row_id: int, old: str | None, new: str | None) -> None:
        if self._number is None:
            sql = "INSERT INTO change_sets (at_utc, who, what, undoes) VALUES (?, ?, ?, ?)"
            self._number = self._database.run(sql, self._head)
        sql = "INSERT INTO changes (change_set, object_id, kind, row_id, old, new) VALUES (?, ?, ?, ?, ?, ?)"
        self._database.run(sql, (self._number, object_id, kind, row_id, old, new))
        self.n_changed += 1


def _new_key(entry: Entry) -> str:
    """Key of an entry without one; of an attribute it follows from the object and the name, which it has once."""
    return global_id_of(entry.global_id, entry.name) if isinstance(entry, Attribute) else new_global_id()


def _place(code: int, row_id: int, index: int) -> int:
    """Number of a text in the search index."""
    return (row_id << (KIND_BITS + FIELD_BITS)) | (code << FIELD_BITS) | index


def decoded(entry: str) -> Any:
    """Content of a history entry; None where it is no JSON."""
    try:
        return msgspec.json.decode(entry)
    except (msgspec.DecodeError, RecursionError):
        return None
