"""Whether a file is a whole STEP file (ISO 10303-21), as IFC models are."""

from __future__ import annotations

from pathlib import Path

from planning.errors import InputError

MAX_FILE_BYTES = 4 * 2**30

TAIL_BYTES = 4096
"""The end mark stands in the last few; some programs write a comment after it."""

START, END = b"ISO-10303-21", b"END-ISO-10303-21"


def check_ends(path: Path) -> None:
    """Refuse what is no STEP file or is cut off: IfcOpenShell reads what is left of it without a word.

    Raises
    ------
    InputError
        As said.
    """
    try:
        if not path.is_file():
            raise InputError(f"{path}: there is no such file")
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(64)
            file.seek(max(0, size - TAIL_BYTES))
            tail = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if size > MAX_FILE_BYTES:
        raise InputError(f"{path}: the file has more than {MAX_FILE_BYTES // 2**30} GiB; export the facade alone")
    if not head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(START):
        raise InputError(f"{path}: expected an IFC file (STEP text that begins with ISO-10303-21)")
    if END not in tail:
        raise InputError(f"{path}: the file is cut off (END-ISO-10303-21 is missing); copy or export it again")
