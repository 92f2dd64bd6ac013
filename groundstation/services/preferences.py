"""Small choices of the pilot that are kept for the next start, each in a TOML file beside the settings."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from planning.base.errors import InputError
from planning.base.json_file import plain_values, read_toml, write_atomically
from planning.base.messages import glue, say

Record = TypeVar("Record")


Tell = Callable[[str], None]


def read_kept(path: Path, first: Record, tell: Tell = lambda _: None) -> Record:
    """What was kept; `first` where nothing was, or the file is damaged, which is told then and put aside."""
    return or_first(path, lambda: read_toml(path, type(first)), first, tell)


def or_first(path: Path, read: Callable[[], Record], first: Record, tell: Tell) -> Record:
    """What a file holds, or `first` where there is none; a damaged one is put aside, so that nothing of it is lost.

    Parameters
    ----------
    tell
        Called with what was wrong and what became of the file.
    """
    try:
        return read()
    except InputError as error:
        if os.path.lexists(path):
            tell(glue(error, "; ", _put_aside(path)))
        return first


def _put_aside(path: Path) -> str:
    """Give a damaged file another name, in place of the last one; returns what was done."""
    aside = path.with_name(f"{path.stem}.damaged{path.suffix}")
    try:
        path.replace(aside)
    except OSError:
        return say("its settings are as at first, and the file stays as it is")
    return say("its settings are as at first again, and the damaged file is kept as '{}'", aside)


def write_kept(path: Path, record: object) -> None:
    """Keep a record; its folder is made where it is missing.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    import tomli_w

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(say("this folder cannot be made ({})", error.strerror or error, place=path.parent)) from error
    write_atomically(path, tomli_w.dumps(plain_values(record)).encode())
