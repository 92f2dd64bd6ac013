"""PLY files of points, read and written in blocks: memory does not grow with the file, and no header is trusted.

Only what point clouds and splats need: binary, little-endian, one element `vertex` without lists, first in the file.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_given, real_path
from planning.base.json_file import part_file
from planning.base.messages import say

SPLATS_FILE = FileLimit("a PLY file", 65536 * MIB)
"""Read in blocks, so that its length costs no memory."""

MAX_HEADER_BYTES = 64 * 1024
"""A header of splats has about 2 kB."""

MAX_COLUMNS = 512

MAX_ROWS = 200_000_000
"""More than any graphics card holds."""

AT_ONCE = 65_536
"""Rows of a block: 18 MB of splats."""

TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "<i2"),
    **dict.fromkeys(("ushort", "uint16"), "<u2"),
    **dict.fromkeys(("int", "int32"), "<i4"),
    **dict.fromkeys(("uint", "uint32"), "<u4"),
    **dict.fromkeys(("float", "float32"), "<f4"),
    **dict.fromkeys(("double", "float64"), "<f8"),
}

NAMES = {"<f4": "float", "u1": "uchar", "<i4": "int"}
"""Of the types that are written."""

BINARY = "binary_little_endian"


@dataclass(frozen=True, slots=True)
class PlyHeader:
    """What a file says about its vertices.

    Parameters
    ----------
    n_rows
        The file is long enough for them.
    columns
        Names and NumPy types, in the file's order.
    comments
        Without the word `comment`.
    start
        Offset of the first row.
    """

    n_rows: int
    columns: tuple[tuple[str, str], ...]
    comments: tuple[str, ...]
    start: int

    @property
    def row_type(self) -> np.dtype[Any]:
        """Of one row."""
        return np.dtype(list(self.columns))

    @property
    def names(self) -> frozenset[str]:
        """Of the columns."""
        return frozenset(name for name, _ in self.columns)


def read_header(path: Path) -> PlyHeader:
    """Header of a PLY file, checked against the file's length.

    Raises
    ------
    InputError
        The file is missing, is no PLY file, is damaged or cut off, or is of a kind that is not read.
    """
    with open_given(path, SPLATS_FILE) as stream:
        lines = _header_lines(stream, path)
        return _parsed(lines, stream.tell(), os.fstat(stream.fileno()).st_size, path)


def read_blocks(path: Path, header: PlyHeader, at_once: int = AT_ONCE) -> Iterator[NDArray[Any]]:
    """Rows in blocks, structured arrays with the columns of the header; all of them have their full length.

    Raises
    ------
    InputError
        The file cannot be read, or got shorter meanwhile.
    """
    row = header.row_type
    with open_given(path, SPLATS_FILE) as stream:
        stream.seek(header.start)
        for first in range(0, header.n_rows, at_once):
            block = np.fromfile(stream, row, min(at_once, header.n_rows - first))
            if len(block) < min(at_once, header.n_rows - first):
                raise InputError(f"{path}: ends after {first + len(block)} of its {header.n_rows} points")
            yield block


def write_blocks(path: Path, n_rows: int, row: np.dtype[Any], comments: Sequence[str], blocks: Iterable[Any]) -> None:
    """Write a file, whole or not at all.

    Parameters
    ----------
    row
        Type of a row, with columns of float32, int32 and uint8.
    blocks
        Structured arrays of that type, `n_rows` rows in all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    lines = ["ply", f"format {BINARY} 1.0", *(f"comment {comment}" for comment in comments), f"element vertex {n_rows}"]
    lines += [f"property {NAMES[row[name].str.replace('|', '')]} {name}" for name in row.names or ()]
    header = ("\n".join([*lines, "end_header"]) + "\n").encode("ascii", "replace")
    try:
        with part_file(real_path(path)) as part:
            n_written = 0
            with part.open("wb") as stream:
                stream.write(header)
                for block in blocks:
                    stream.write(np.ascontiguousarray(block, row).tobytes())
                    n_written += len(block)
            if n_written != n_rows:
                raise ValueError(f"blocks: expected {n_rows} rows in all, got {n_written}")
    except OSError as error:
        raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error


def _header_lines(stream: BinaryIO, path: Path) -> list[str]:
    if stream.readline(16).strip() != b"ply":
        raise InputError(f"{path}: is no PLY file (it does not start with 'ply')")
    lines: list[str] = []
    while stream.tell() < MAX_HEADER_BYTES:
        line = stream.readline(MAX_HEADER_BYTES)
        if not line.endswith(b"\n"):
            break
        text = line.decode("utf-8", "replace").strip()
        if text == "end_header":
            return lines
        lines.append(text)
    raise InputError(f"{path}: its header does not end within {MAX_HEADER_BYTES} bytes; the file is damaged")


def _parsed(lines: list[str], start: int, size: int, path: Path) -> PlyHeader:
    columns: list[tuple[str, str]] = []
    comments: list[str] = []
    elements: list[tuple[str, int]] = []
    kind = ""
    for number, line in enumerate(lines, 2):
        words = line.split()
        match words:
            case [] | ["obj_info", *_]:
                pass
            case ["comment", *_]:
                comments.append(line[len("comment") :].strip())
            case ["format", found, "1.0"]:
                kind = found
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 19:
                elements.append((name, int(count)))
            case ["property", type_name, name] if type_name in TYPES and elements:
                if len(elements) == 1:
                    columns.append((name, TYPES[type_name]))
            case ["property", "list", _, _, _] if len(elements) > 1:
                pass  # of faces, which come after the vertices and are not read
            case _:
                raise InputError(f"{path}: line {number} of its header is not understood: '{line[:80]}'")
    if kind != BINARY:
        raise InputError(f"{path}: expected a PLY file of format {BINARY}, found '{kind or 'none'}'; save it as that")
    if not elements or elements[0][0] != "vertex":
        raise InputError(f"{path}: its first element is '{elements[0][0] if elements else 'none'}', not 'vertex'")
    _check_columns([name for name, _ in columns], path)
    header = PlyHeader(elements[0][1], tuple(columns), tuple(comments), start)
    needed = header.n_rows * header.row_type.itemsize
    if header.n_rows > MAX_ROWS:
        raise InputError(f"{path}: says that it has {header.n_rows} points; at most {MAX_ROWS} are read")
    if size - start < needed:
        raise InputError(
            f"{path}: says that it has {header.n_rows} points, {needed} bytes, and {size - start} bytes follow its "
            "header; the file is cut off or damaged"
        )
    return header


def _check_columns(names: list[str], path: Path) -> None:
    if not names or len(names) > MAX_COLUMNS:
        raise InputError(f"{path}: its points have {len(names)} properties; expected 1 to {MAX_COLUMNS}")
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise InputError(f"{path}: its points have the property '{double[:40]}' twice")
