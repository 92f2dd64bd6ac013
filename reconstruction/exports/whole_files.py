"""Files that are there whole or not at all, however they are written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import real_path
from planning.base.json_file import check_output, part_file
from planning.base.messages import say


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A new file beside `path`, of the same ending, which takes its place once all is written.

    A link is followed. Where the work fails nothing is left, and a file that was there stays.

    Raises
    ------
    InputError
        It cannot be written, or is no file.
    """
    check_output(path)
    target = real_path(path)
    if target.exists() and not target.is_file():
        raise InputError(say("cannot be written: it is no file; name one", place=path))
    try:
        with part_file(target) as part:
            yield part
    except OSError as error:
        raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error
