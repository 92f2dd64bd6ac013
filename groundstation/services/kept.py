"""Small choices of the pilot that are kept for the next start, each in a TOML file beside the settings."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

import msgspec

from planning.errors import InputError
from planning.json_file import read_toml, write_atomically

Record = TypeVar("Record")


def read_kept(path: Path, first: Record) -> Record:
    """What was kept; `first` where nothing was, or it cannot be read any more."""
    try:
        return read_toml(path, type(first))
    except InputError:
        return first


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
        raise InputError(f"{path.parent}: this folder cannot be made ({error.strerror or error})") from error
    write_atomically(path, tomli_w.dumps(msgspec.to_builtins(record)).encode())
