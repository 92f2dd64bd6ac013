"""STEP files (ISO 10303-21), as IFC models are: whether one is whole, what in it is broken, which names are none."""

from __future__ import annotations

import os
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import NamedTuple

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_input_file, read_input_file
from planning.base.messages import say

IFC_FILE = FileLimit(say("an IFC file"), 4096 * MIB, say("export the facade alone"))

TAIL_BYTES = 4096
"""The end mark stands in the last few; some programs write a comment after it."""

START, END = b"ISO-10303-21", b"END-ISO-10303-21"
DATA, END_OF_SECTION = b"DATA;", b"ENDSEC;"

_TEXT = re.compile(rb"'(?:[^']|'')*'|/\*.*?\*/", re.DOTALL)
_TEXT_IN_LINE = re.compile(rb"'(?:[^'\r\n]|'')*'|/\*[^\r\n]*?\*/")
_INSTANCE = re.compile(rb"\s*#\d+\s*=\s*(?:[A-Za-z]\w*\s*)?\([^']*\)\s*")
_NUMBER = re.compile(rb"\s*#(\d+)")
_BEYOND = re.compile(rb"\d\.?\d*E\+?(?:\d{4,}|[4-9]\d\d|3[1-9]\d|309)")


def check_ends(path: Path) -> None:
    """Refuse what is no STEP file or is cut off: IfcOpenShell reads what is left of it without a word.

    Raises
    ------
    InputError
        As said.
    """
    with open_input_file(path, IFC_FILE) as file:
        head = file.read(64)
        file.seek(max(0, file.seek(0, os.SEEK_END) - TAIL_BYTES))
        tail = file.read(TAIL_BYTES)
    if not head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(START):
        raise InputError.say("expected an IFC file (STEP text that begins with ISO-10303-21)", place=path)
    if END not in tail:
        raise InputError.say("the file is cut off (END-ISO-10303-21 is missing); copy or export it again", place=path)


class RepairedFile(NamedTuple):
    """Content of a file without its broken instances, and their numbers."""

    content: bytes
    broken: tuple[str, ...]


def repaired_file(path: Path) -> RepairedFile | None:
    """Content of a file whose instances are not all whole; None where they are.

    IfcOpenShell takes what it can of a broken line and, where a text does not end, of all lines up to the next quote,
    without a word. Here an instance is broken alone: one without its number, name or brackets, with a text that does
    not end in its line, or with a number beyond all numbers.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    content = read_input_file(path, IFC_FILE)
    start, end = content.find(DATA), content.rfind(END_OF_SECTION)
    if not 0 <= start < end:
        return None
    start += len(DATA)
    # Lines may break anywhere, also in a text; only where that makes no sense, texts are taken to end in their line.
    if not _broken(content[start:end], _TEXT):
        return None
    broken = _broken(content[start:end], _TEXT_IN_LINE)
    if not broken:
        return None
    kept, place, numbers = [content[:start]], start, []
    for first, last in broken:
        kept.append(content[place : start + first])
        number = _NUMBER.match(content[start + first : start + last])
        numbers.append(f"#{number[1].decode()}" if number else "")
        place = start + last
    return RepairedFile(b"".join([*kept, content[place:]]), tuple(numbers))


def _broken(data: bytes, text: re.Pattern[bytes]) -> list[tuple[int, int]]:
    """Where the instances that are not whole begin and end, their semicolon included."""
    blank = text.sub(lambda found: b" " * len(found[0]), data)
    found, place = [], 0
    for instance in blank.split(b";"):
        last = place + len(instance) + 1
        is_whole = instance.count(b"(") == instance.count(b")") and _INSTANCE.fullmatch(instance) is not None
        if instance.strip() and (not is_whole or _BEYOND.search(instance)):
            found.append((place, min(last, len(data))))
        place = last
    return found


@cache
def _placeholders() -> tuple[frozenset[str], frozenset[str]]:
    """Names that are none, and those that are none with a number either."""
    content = tomllib.loads((Path(__file__).parent / "data" / "no_names.toml").read_text("utf-8"))
    return frozenset(content["names"]), frozenset(content["counted"])


def real_name(*names: object) -> str:
    """The first of several names that somebody has given, without blanks around it; empty where there is none.

    Programs fill in placeholders ("Unnamed", "$", "Default", "Project Number"), also with marks or a number behind.
    """
    placeholders, counted = _placeholders()
    for name in names:
        text = " ".join(str(name or "").split())
        plain = text.replace("_", " ").strip(" .,:;#<>()[]{}*$?!'\"/\\|+~=-").casefold()
        if plain not in placeholders and plain.rstrip("0123456789 #.:-") not in counted:
            return text
    return ""
