"""The text of a STEP file (ISO 10303-21): instances taken out, exchanged and added; all other bytes stay."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from planning.errors import InputError
from planning.step_file import END

# Texts and comments are passed over whole: semicolons in them end nothing.
_TOKEN = re.compile(rb"'[^']*'|/\*.*?\*/|;", re.DOTALL)
_INSTANCE = re.compile(rb"(?:\s|/\*.*?\*/)*#([0-9]+)\s*=", re.DOTALL)


def edited(content: bytes, lines: Sequence[str], replaced: Mapping[int, str]) -> bytes:
    """Text with new instances at the end of its data.

    Parameters
    ----------
    lines
        New instances.
    replaced
        New text of instances, by their number; "" takes one out.

    Raises
    ------
    InputError
        There is no end of the data, or an instance to be replaced is not there.
    """
    end = content.rfind(b"ENDSEC", 0, content.rfind(END))
    if end < 0:
        raise InputError("the data of the file do not end (ENDSEC is missing)")
    line_end = b"\r\n" if b"\r\n" in content[:2000] else b"\n"
    parts, position = [], 0
    for start, stop, number in _statements(content, end) if replaced else ():
        if number in replaced:
            text = replaced[number].encode("ascii")
            parts += [content[position:start], text]
            position = stop if text else _after_line(content, stop)
    if len(parts) != 2 * len(replaced):
        raise InputError("instances of the file that are to be replaced stand in it in a way that is not understood")
    added = b"".join(line.encode("ascii") + line_end for line in lines)
    return b"".join((*parts, content[position:end], added, content[end:]))


def _after_line(content: bytes, stop: int) -> int:
    """The place after the line end that follows, if one follows at once."""
    for line_end in (b"\r\n", b"\n"):
        if content.startswith(line_end, stop):
            return stop + len(line_end)
    return stop


def _statements(content: bytes, end: int) -> list[tuple[int, int, int]]:
    """Start, end and number of all instances before a place."""
    found, start = [], 0
    for token in _TOKEN.finditer(content, 0, end):
        if token[0] != b";":
            continue
        instance = _INSTANCE.match(content, start, token.end())
        if instance is not None:
            found.append((instance.start(1) - 1, token.end(), int(instance[1])))
        start = token.end()
    return found
