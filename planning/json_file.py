"""JSON and TOML files as typed records: errors that name file and field, and writes that are whole or not at all."""

from __future__ import annotations

import json
import math
import os
import re
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import msgspec.inspect

from planning.errors import InputError

Record = TypeVar("Record")

MAX_FILE_BYTES = 512 * 2**20
"""Larger JSON files are refused before they are read: a site of 100 000 panels is under 50 MB."""


def read_json(path: Path) -> Any:
    """Content of a JSON file.

    Raises
    ------
    InputError
        Missing, unreadable, empty, too large, not UTF-8, not JSON, or holding NaN or Infinity (which JSON does not
        have).
    """
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise InputError(f"{path}: the file has more than {MAX_FILE_BYTES // 2**20} MiB; expected a JSON file")
        text = path.read_text("utf-8-sig")  # editors on Windows put a byte order mark in front
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: expected JSON in UTF-8, found other bytes at offset {error.start}") from error
    if not text.strip():
        raise InputError(f"{path}: not valid JSON, line 1: the file is empty")
    try:
        content = json.loads(text)
        place = _first_not_finite(content, "")
    except json.JSONDecodeError as error:
        raise InputError(f"{path}: not valid JSON, line {error.lineno}, column {error.colno}: {error.msg}") from error
    except RecursionError as error:
        raise InputError(f"{path}: nested too deeply for a file of ours") from error
    except ValueError as error:
        raise InputError(f"{path}: holds a number with too many digits ({error})") from error
    if place is not None:
        raise InputError(f"{path}: {place.lstrip('.')}: expected a finite number, got NaN or Infinity")
    return content


def _first_not_finite(content: Any, place: str) -> str | None:
    """Where the first NaN or Infinity stands; JSON has neither, but Python reads them (and 1e999) all the same."""
    if isinstance(content, float):
        return None if math.isfinite(content) else place
    if isinstance(content, dict):
        parts = ((value, f"{place}.{key}") for key, value in content.items())
    elif isinstance(content, list):
        parts = ((value, f"{place}[{i}]") for i, value in enumerate(content))
    else:
        return None
    return next((found for value, inner in parts if (found := _first_not_finite(value, inner)) is not None), None)


def to_record(content: Any, record: type[Record], path: Path) -> Record:
    """Typed record from plain JSON values; fields the record does not know are ignored.

    Raises
    ------
    InputError
        A field is missing, of the wrong type or refused by the record's own checks; the message names file and field.
    """
    try:
        return msgspec.convert(content, record)
    except msgspec.ValidationError as error:
        raise InputError(f"{path}: {_in_words(str(error), record)}") from error


def expect_format(content: Any, expected: str, path: Path) -> None:
    """Say which file was wanted and which was found, before single fields are looked at.

    Raises
    ------
    InputError
        The content says that it is in another format. Content that does not say passes.
    """
    found = content.get("format", expected) if isinstance(content, dict) else expected
    if found != expected:
        raise InputError(f"{path}: format: expected '{expected}', got {found!r}; is it the right file?")


_WORDS = {
    "array": "list",
    "object": "object",
    "float": "number",
    "int": "whole number",
    "str": "text",
    "null": "nothing",
    "bool": "true/false",
}


def _in_words(message: str, record: type[Any]) -> str:
    """Turn "Expected `float`, got `str` - at `$.a.b`" into "a.b: expected number, got text"."""
    text, _, place = message.partition(" - at `$")
    place = place.rstrip("`").lstrip(".")
    text = re.sub(r"`(\w+(?: \| \w+)*)`", lambda found: _kind(found[1]), text).replace("`", "'")
    text = re.sub(r"^Object missing", "missing", text)
    text = text[:1].lower() + text[1:] if text.startswith("Expected") else text
    wrong = re.match(r"^Invalid enum value (.+)$", text)
    if wrong and (choices := _choices(record, place)):
        text = f"expected {', '.join(choices)}, got {wrong[1]}"
    if not place:
        return text
    return f"{place}.{text}" if re.match(r"\w+(\[\d+\])*: ", text) else f"{place}: {text}"


def _choices(record: type[Any], place: str) -> list[str]:
    """What a word at a place such as "a.b[3]" of a record may be; none where that is not told by its types."""
    kinds = _alternatives(msgspec.inspect.type_info(record))
    for step in re.findall(r"\[[^\]]*\]|\w+", place):
        if step.startswith("["):
            within = [getattr(kind, "item_type", None) or getattr(kind, "value_type", None) for kind in kinds]
        else:
            named = [field for kind in kinds for field in getattr(kind, "fields", ())]
            within = [field.type for field in named if field.encode_name == step]
        kinds = [each for kind in within if kind is not None for each in _alternatives(kind)]
    literals = [value for kind in kinds for value in getattr(kind, "values", ())]
    members = [member.value for kind in kinds if isinstance(kind, msgspec.inspect.EnumType) for member in kind.cls]
    return [str(value) for value in (*literals, *members)]


def _alternatives(kind: msgspec.inspect.Type) -> Sequence[msgspec.inspect.Type]:
    return kind.types if isinstance(kind, msgspec.inspect.UnionType) else (kind,)


def _kind(types: str) -> str:
    """Turn "str | null" into "text or nothing"; a word that is no type is quoted."""
    return " or ".join(_WORDS.get(kind, f"'{kind}'") for kind in types.split(" | "))


def read_toml(path: Path, record: type[Record]) -> Record:
    """Typed record from a TOML file; unknown keys are errors where the record forbids them.

    Raises
    ------
    InputError
        As for `to_record`, and for a file that is not TOML.
    """
    try:
        content = tomllib.loads(path.read_text("utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not valid TOML ({error})") from error
    return to_record(content, record, path)


def check_settings(content: dict[str, Any], record: type[Any], path: Path, place: str = "") -> None:
    """Refuse keys that are no fields of a record.

    Parameters
    ----------
    record
        A dataclass.
    place
        Of the keys in the file, with its dot, as `glass.`.

    Raises
    ------
    InputError
        There is such a key; the message names it and those that are known.
    """
    known = [field.name for field in fields(record)]
    unknown = sorted(set(content) - set(known))
    if unknown:
        raise InputError(f"{path}: {place}{unknown[0]}: no such setting; known are: {', '.join(known)}")


def check_output(path: Path, sources: Iterable[Path] = ()) -> None:
    """Find out before long work that its result could not be written.

    Raises
    ------
    InputError
        There is no such folder, a folder has that name, file or folder is write-protected, or it is one of `sources`.
    """
    _check_place(path)
    folder = path.resolve().parent
    # Files are made anew in their folder; devices and pipes are written into.
    if (path.is_file() or not path.exists()) and not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(
            f"{path}: cannot be written: the folder '{folder}' is write-protected; name a file in another one"
        )
    for source in sources:
        if path.exists() and source.exists() and path.samefile(source):
            raise InputError(f"{path}: would replace {source}, which it is made from; name another file")


def _check_place(path: Path) -> None:
    if not path.parent.is_dir():
        raise InputError(f"{path}: cannot be written: there is no folder '{path.parent}'; make it first")
    if path.is_dir():
        raise InputError(f"{path}: cannot be written: this is a folder; name a file in it")
    if path.exists() and not os.access(path, os.W_OK):
        raise InputError(f"{path}: cannot be written: the file is write-protected; name another one")


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file whole or not at all: to a temporary neighbour first, then renamed over the target.

    A link is followed. What is no regular file (a device, a pipe) is written into, never replaced.

    Raises
    ------
    InputError
        The folder is missing or cannot be written, or the disk is full.
    """
    _check_place(path)
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(content)
        else:
            _replace(path.resolve(), content)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error


def _replace(path: Path, content: bytes) -> None:
    descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
