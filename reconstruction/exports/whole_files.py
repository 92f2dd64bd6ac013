"""Files that are there whole or not at all, however they are written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from planning.errors import InputError
from planning.json_file import check_output


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
    target = path.resolve()
    if target.exists() and not target.is_file():
        raise InputError(f"{path}: cannot be written: it is no file; name one")
    temporary: Path | None = None
    try:
        descriptor, name = tempfile.mkstemp(prefix=f".{target.stem[:40]}.", suffix=target.suffix, dir=target.parent)
        temporary = Path(name)
        os.close(descriptor)
        yield temporary
        with temporary.open("rb+") as stream:
            os.fsync(stream.fileno())
        temporary.chmod(0o644)
        temporary.replace(target)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
