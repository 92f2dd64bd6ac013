"""JSON and TOML files as typed records: errors that name file and field, and writes that are whole or not at all."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import sys
import tempfile
import tomllib
import types
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, fields, is_dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NoReturn, TypeVar, get_args, get_type_hints

import msgspec
import msgspec.inspect

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_json_size, read_input_file, real_path
from planning.base.messages import Message, about, joined, plain, say, without_place

if sys.platform != "win32":
    import fcntl

Record = TypeVar("Record")

JSON_FILE = FileLimit(say("a JSON file"), 512 * MIB)
"""A site of 100 000 panels is under 50 MB."""

LARGEST_INTEGER = 2**64
"""Whole numbers beyond are none of ours, and no float that is close enough."""

_TOO_DEEP = say("nested too deeply: lists in lists without end; copy it again or make it anew")

MAX_DEPTH = 100
"""Levels of lists and objects; GeoJSON and CityJSON, the deepest that are read, have under 12."""

TOML_FILE = FileLimit(say("a TOML file"), MIB)
"""Settings have some kilobytes, with the layout of ten window sizes under 100."""

MAX_KEY_PARTS = 16
"""Of a dotted TOML key: `tomllib` keeps all of its beginnings, which 200 kB of `a.a.a` made 21 GB of."""

_KEY_PART = r"""(?>[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_KEY_PART}(?>[ \t]*+\.[ \t]*+{_KEY_PART}){{{MAX_KEY_PARTS},}}")


def read_json(path: Path, limit: FileLimit = JSON_FILE, *, names_files: bool = False) -> Any:
    """Content of a JSON file; see `parse_json`.

    Raises
    ------
    InputError
        Missing, unreadable, no regular file, too large, or as `parse_json`.
    """
    return parse_json(read_input_file(path, limit), path, names_files=names_files)


def parse_json(written: bytes, path: Path, *, names_files: bool = False) -> Any:
    """Content of a JSON text.

    Parameters
    ----------
    path
        Where it is from, for messages.
    names_files
        Texts in it may be names of files that are no UTF-8, which Python has as halves of characters (PEP 383).

    Raises
    ------
    InputError
        Empty, not UTF-8, not JSON, nested too deeply, of more values than there is memory for, or holding NaN, Infinity
        or half of a character, which JSON does not have.
    """
    check_json_size(written, path)
    try:
        text = written.decode("utf-8-sig")  # editors on Windows put a byte order mark in front
    except UnicodeDecodeError as error:
        raise InputError.say(
            "expected JSON in UTF-8, found other bytes at offset {}", error.start, place=path
        ) from error
    if not text.strip():
        raise InputError.say("not valid JSON, line 1: the file is empty", place=path)
    try:
        content = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError.say(
            "not valid JSON, line {}, column {}: {}", error.lineno, error.colno, error.msg, place=path
        ) from error
    except RecursionError as error:
        raise InputError(about(path, _TOO_DEEP)) from error
    except ValueError as error:
        raise InputError.say("holds a number with too many digits ({})", error, place=path) from error
    _check_values(content, path, names_files)
    return content


def _check_values(content: Any, path: Path, names_files: bool, *, is_toml: bool = False) -> None:
    """Refuse what JSON does not have and Python reads all the same: NaN, 1e999, half a character, endless depth."""
    level: list[Any] = [content]
    for _ in range(MAX_DEPTH):
        deeper: list[Any] = []
        for value in level:
            kind = type(value)
            if kind is list:
                deeper += value
            elif kind is dict:
                deeper += value.values()
                deeper += value
            elif (
                (kind is float and not (is_toml or math.isfinite(value)))
                or (kind is int and not -LARGEST_INTEGER <= value <= LARGEST_INTEGER)
                or (kind is str and not (names_files or value.isascii() or _is_text(value)))
            ):
                _refuse_value(content, value, path)
        if not deeper:
            return
        level = deeper
    raise InputError(about(path, _TOO_DEEP))


def _is_text(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _refuse_value(content: Any, wrong: Any, path: Path) -> NoReturn:
    place = (_place_of(content, wrong, "") or "").lstrip(".").encode("ascii", "backslashreplace").decode()
    if isinstance(wrong, int):
        raise InputError.say(
            "expected a number of at most 20 digits, found one of {}", len(str(wrong)), place=f"{path}: {place}"
        )
    if isinstance(wrong, float):
        raise InputError.say("expected a finite number, got NaN or Infinity", place=f"{path}: {place}")
    raise InputError.say("expected text, found half of a character (a surrogate by itself)", place=f"{path}: {place}")


def _place_of(content: Any, wrong: Any, place: str) -> str | None:
    """Where this very value stands, or the key that it is."""
    if content is wrong:
        return place
    if isinstance(content, dict):
        if any(key is wrong for key in content):
            return f"{place}.{wrong}"
        parts = ((value, f"{place}.{key}") for key, value in content.items())
    elif isinstance(content, list):
        parts = ((value, f"{place}[{i}]") for i, value in enumerate(content))
    else:
        return None
    return next((found for value, inner in parts if (found := _place_of(value, wrong, inner)) is not None), None)


def plain_values(record: Any) -> Any:
    """A record as plain JSON values; messages are texts in a file."""
    return msgspec.to_builtins(record, enc_hook=_as_text)


def encoded(record: Any) -> bytes:
    """A record as JSON without blanks; see `plain_values`."""
    return msgspec.json.encode(record, enc_hook=_as_text)


def _as_text(value: Any) -> str:
    if isinstance(value, Message):
        return plain(value)
    raise TypeError(f"expected something that JSON has, got {type(value).__name__}")


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
        raise InputError(about(path, _in_words(error, record))) from error
    except UnicodeEncodeError as error:
        raise InputError.say("a text in it holds half of a character (a surrogate by itself)", place=path) from error


def expect_format(content: Any, expected: str, path: Path) -> None:
    """Say which file was wanted and which was found, before single fields are looked at.

    Raises
    ------
    InputError
        The content says that it is in another format. Content that does not say passes.
    """
    found = content.get("format", expected) if isinstance(content, dict) else expected
    if found != expected:
        raise InputError(wrong_format(expected, found, path))


def wrong_format(expected: object, found: Any, path: Path) -> Message:
    """What is said of a file that names another format, or none."""
    named = repr(found) if isinstance(found, str) else say("none")
    return say("format: expected '{}', got {}; is it the right file?", expected, named, place=path)


_WORDS = {
    "array": "list",
    "object": "object",
    "float": "number",
    "int": "whole number",
    "str": "text",
    "null": "nothing",
    "bool": "true/false",
}


_REFUSALS = (
    (re.compile(r"missing required field '(.+)'"), "missing required field '{}'"),
    (re.compile(r"object contains unknown field '(.+)'"), "object contains unknown field '{}'"),
    (re.compile(r"expected (.+) of length (.+), got (.+)"), "expected {} of length {}, got {}"),
    (re.compile(r"expected (.+), got (.+)"), "expected {}, got {}"),
    (re.compile(r"invalid enum value (.+)", re.IGNORECASE), "invalid enum value {}"),
)
"""What msgspec says, in our words, as messages."""


def _in_words(error: Exception, record: type[Any]) -> str:
    """Turn "Expected `float`, got `str` - at `$.a.b`" into "a.b: expected number, got text"."""
    text, _, place = str(error).partition(" - at `$")
    place = place.rstrip("`").lstrip(".")
    if isinstance(error.__cause__, ValueError) and isinstance(own_message := str(error.__cause__), Message):
        # A check of the record's own.
        is_field = re.fullmatch(r"\w+(\[\d+\])*", own_message.place) is not None
        if not place:
            return own_message
        return (
            about(f"{place}.{own_message.place}", without_place(own_message, own_message.place))
            if is_field
            else about(place, own_message)
        )
    text = re.sub(r"`(\w+(?: \| \w+)*)`", lambda found: _kind(found[1]), text).replace("`", "'")
    text = re.sub(r"^Object missing", "missing", text)
    text = text[:1].lower() + text[1:] if text.startswith("Expected") else text
    wrong = re.match(r"^Invalid enum value (.+)$", text)
    if wrong and (choices := _choices(record, place)):
        text = say("expected {}, got {}", ", ".join(choices), wrong[1])
    if place and re.match(r"\w+(\[\d+\])*: ", text):
        return f"{place}.{text}"
    for pattern, template in _REFUSALS:
        if not isinstance(text, Message) and (found := pattern.fullmatch(text)):
            text = say(template, *found.groups())
    return about(place, text) if place else text


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
    return joined(" or ", (_WORDS.get(kind, f"'{kind}'") for kind in types.split(" | ")))


def read_toml(path: Path, record: type[Record]) -> Record:
    """Typed record from a TOML file; unknown keys are errors where the record forbids them.

    Raises
    ------
    InputError
        As for `to_record`, and for a file that is not TOML, no regular file or too large.
    """
    return to_record(parse_toml(read_input_file(path, TOML_FILE), path), record, path)


def parse_toml(written: bytes, path: Path) -> dict[str, Any]:
    """Content of a TOML text.

    Parameters
    ----------
    path
        Where it is from, for messages.

    Raises
    ------
    InputError
        It is not TOML, or has keys of too many parts or lists in lists without end.
    """
    try:
        text = written.decode("utf-8")
        long_key = _LONG_KEY.search(text)
        if long_key is not None:
            line = text.count("\n", 0, long_key.start()) + 1
            raise InputError.say(
                "line {}: a key has more than {} parts; none of ours has", line, MAX_KEY_PARTS, place=path
            )
        content = tomllib.loads(text)
        _check_values(content, path, False, is_toml=True)
        return content
    except ValueError as error:  # TOMLDecodeError, UnicodeDecodeError, and numbers with thousands of digits
        raise InputError.say("not valid TOML ({})", error, place=path) from error
    except RecursionError as error:
        raise InputError(about(path, _TOO_DEEP)) from error


def check_settings(content: Mapping[str, Any], record: type[Any], path: Path, place: str = "") -> None:
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
        raise InputError.say("no such setting; known are: {}", ", ".join(known), place=f"{path}: {place}{unknown[0]}")


def settings_over(base: Record, content: Mapping[str, Any], path: Path) -> Record:
    """A record of parameters, changed by what a settings file says; tables of it are records within.

    Raises
    ------
    InputError
        A key is no parameter, or a value is of the wrong type or out of range; the message names file and key.
    """
    _check_keys(content, type(base), path, "")
    try:
        return to_record(_merged(asdict(base), content), type(base), path)  # type: ignore[call-overload]
    except ValueError as error:
        raise InputError(about(path, error)) from error


def _check_keys(content: Mapping[str, Any], record: type[Any], path: Path, place: str) -> None:
    check_settings(content, record, path, place)
    hints = get_type_hints(record)
    for key, value in content.items():
        inner = _record_in(hints[key])
        if inner is not None and isinstance(value, dict):
            _check_keys(value, inner, path, f"{place}{key}.")


def _record_in(hint: Any) -> type[Any] | None:
    """The dataclass that a field is, or may be."""
    options = get_args(hint) if isinstance(hint, types.UnionType) else (hint,)
    return next((option for option in options if is_dataclass(option) and isinstance(option, type)), None)


def _merged(base: dict[str, Any], content: Mapping[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in content.items():
        both = isinstance(value, dict) and isinstance(base.get(key), dict)
        merged[key] = _merged(base[key], value) if both else value
    return merged


def check_output(path: Path, sources: Iterable[Path] = ()) -> None:
    """Find out before long work that its result could not be written.

    Raises
    ------
    InputError
        There is no such folder, a folder has that name, file or folder is write-protected, or it is one of `sources`.
    """
    _check_place(path)
    folder = real_path(path).parent
    # Files are made anew in their folder; devices and pipes are written into.
    if not is_device(path) and not os.access(folder, os.W_OK | os.X_OK):
        raise InputError.say(
            "cannot be written: the folder '{}' is write-protected; name a file in another one", folder, place=path
        )
    for source in sources:
        if path.exists() and source.exists() and path.samefile(source):
            raise InputError.say("would replace {}, which it is made from; name another file", source, place=path)


def is_device(path: Path) -> bool:
    """Whether what is written there goes to a device or a pipe, which keeps no file that others could stand beside."""
    return path.exists() and not path.is_file()


def _check_place(path: Path) -> None:
    if not path.parent.is_dir():
        raise InputError.say("cannot be written: there is no folder '{}'; make it first", path.parent, place=path)
    if path.is_dir():
        raise InputError.say("cannot be written: this is a folder; name a file in it", place=path)
    if path.exists() and not os.access(path, os.W_OK):
        raise InputError.say("cannot be written: the file is write-protected; name another one", place=path)


def write_atomically(path: Path, content: bytes, *, is_lasting: bool = True) -> None:
    """Write a file whole or not at all: to a temporary neighbour first, then renamed over the target.

    A link is followed. What is no regular file (a device, a pipe) is written into, never replaced.

    Parameters
    ----------
    is_lasting
        Wait until the disk has it, so that it is there after the power fails.

    Raises
    ------
    InputError
        The folder is missing or cannot be written, or the disk is full.
    """
    _check_place(path)
    try:
        if is_device(path):
            path.write_bytes(content)
            return
        with part_file(real_path(path), is_lasting=is_lasting) as part:
            part.write_bytes(content)
    except OSError as error:
        raise InputError.say("cannot be written ({})", error.strerror or error, place=path) from error


def write_together(files: Mapping[Path, bytes]) -> None:
    """Write files that belong together, all of them or none; new ones never stand beside old ones, see `part_files`.

    Raises
    ------
    InputError
        One of them cannot be written; all are as they were then.
    """
    targets = [real_path(path) for path in files]
    for path in files:
        _check_place(path)
    if any(map(is_device, targets)):
        for path, content in files.items():
            write_atomically(path, content)
        return
    try:
        with part_files(targets) as parts:
            for part, content in zip(parts, files.values(), strict=True):
                part.write_bytes(content)
    except OSError as error:
        raise InputError.say("cannot be written ({})", error.strerror or error, place=next(iter(files))) from error


@contextmanager
def part_files(targets: Sequence[Path]) -> Iterator[list[Path]]:
    """New files beside `targets`, which belong together: they take their places together, as in `part_file`.

    The first of them holds the others together (a description, a first sortie). It has a whole file at every moment.
    The others have an old one, then none, then a new one: whenever this process ends, no new one is beside an old one.

    Raises
    ------
    OSError
        As `part_file`; all are as they were then.
    """
    with ExitStack() as stack:
        parts = [stack.enter_context(new_file_beside(target)) for target in targets]
        yield parts
        for part in parts:
            _sync(part)
        for target in targets[1:]:
            target.unlink(missing_ok=True)
        for part, target in zip(parts, targets, strict=True):
            part.replace(target)


@contextmanager
def part_file(target: Path, mode: int = 0o644, *, is_lasting: bool = True) -> Iterator[Path]:
    """A new file beside `target`, of the same ending, which takes its place once all is written.

    Where the work fails it is removed, and what was there before stays. Where the process ends, the next one that
    writes into the folder removes it: it is locked as long as somebody writes it.

    Raises
    ------
    OSError
        It cannot be made, or not take the place.
    """
    with new_file_beside(target, mode) as part:
        yield part
        if is_lasting:
            _sync(part)
        part.replace(target)


@contextmanager
def new_file_beside(target: Path, mode: int = 0o644) -> Iterator[Path]:
    """A new file beside `target` that is removed in the end, unless it has another name then."""
    _clear_parts(target.parent)

    def new() -> Path:
        handle, name = tempfile.mkstemp(f".part{target.suffix}", f".{target.stem[:40]}.", target.parent)
        os.close(handle)
        return Path(name)

    part, descriptor = _made_and_locked(new)
    try:
        part.chmod(mode)
        yield part
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        if descriptor is not None:
            os.close(descriptor)


@contextmanager
def part_folder(parent: Path, stem: str) -> Iterator[Path]:
    """A new folder for files in the making, removed in the end as `part_file` removes its file; moved away, it stays.

    Raises
    ------
    OSError
        It cannot be made.
    """
    _clear_parts(parent)
    folder, descriptor = _made_and_locked(lambda: Path(tempfile.mkdtemp(".part", f".{stem[:40]}.", parent)))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if descriptor is not None:
            os.close(descriptor)


def _made_and_locked(new: Callable[[], Path]) -> tuple[Path, int | None]:
    """What `new` makes, and its lock: None where there are none, and others leave it alone then, too.

    Until it is locked, another process may take it for one that was left: it has that one, and the next is made here.
    """
    while True:
        part = new()
        try:
            descriptor = _locked(part)
        except (FileNotFoundError, BlockingIOError):
            continue
        except OSError:
            return part, None
        if descriptor is None or (part.exists() and os.path.samestat(os.fstat(descriptor), part.stat())):
            return part, descriptor
        os.close(descriptor)


def _locked(path: Path) -> int | None:
    """A lock on a file or folder in the making, by a descriptor of it; None on Windows, where what is open stays.

    Raises
    ------
    OSError
        Somebody has it, or this file system has no locks.
    """
    if sys.platform == "win32":
        return None
    descriptor = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)  # NFS locks only what may be written
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def _sync(part: Path) -> None:
    with part.open("rb+") as file:
        os.fsync(file.fileno())


@lru_cache(maxsize=1000)
def _clear_parts(folder: Path) -> None:
    """Remove what processes left that ended while they wrote into a folder; looked at once by each process."""
    for part in folder.glob(".*.????????.part*"):
        with suppress(OSError):
            if part.is_symlink() or not (part.is_file() or part.is_dir()):
                continue
            descriptor = _locked(part)
            try:
                if part.is_dir():
                    shutil.rmtree(part)
                else:
                    part.unlink()
            finally:
                if descriptor is not None:
                    os.close(descriptor)
