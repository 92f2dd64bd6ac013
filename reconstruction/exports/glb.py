"""Binary glTF files (.glb): JSON, and numbers laid out before they are written, in blocks.

Format: glTF 2.0, section 4.4. Numbers are little-endian.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.exports.whole_files import whole_file

FLOAT, UINT8, UINT16, UINT32 = 5126, 5121, 5123, 5125
"""Types of accessors."""

TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
"""Of accessors, by the numbers in one item."""

VERTICES, INDICES = 34962, 34963
"""What views of the buffer are for."""

ALIGNMENT = 8
"""Of views, bytes: columns of a property table may have items of 8 bytes."""

LARGEST_BYTES = 2**32 - 1
"""A .glb says its length in 32 bits."""

HEADER_BYTES = 28
"""Of the file and its two chunks."""

Put = Callable[[int, NDArray[Any]], None]
"""Writes numbers from a byte of the buffer on."""

_DTYPES = {FLOAT: "<f4", UINT16: "<u2", UINT32: "<u4"}


class GlbBuffer:
    """The numbers of a file: where each lies, and who writes them when it is time."""

    def __init__(self) -> None:
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []
        self.n_bytes = 0
        self._fills: list[Callable[[Put], None]] = []

    def view(self, n_bytes: int, target: int | None = None) -> int:
        """Room for bytes; returns the view's number."""
        offset = -(-self.n_bytes // ALIGNMENT) * ALIGNMENT
        self.views.append({"buffer": 0, "byteOffset": offset, "byteLength": n_bytes})
        if target is not None:
            self.views[-1]["target"] = target
        self.n_bytes = offset + n_bytes
        return len(self.views) - 1

    def add(self, content: bytes) -> int:
        """A view of given bytes; there must be one at least."""
        number = self.view(len(content))
        offset, numbers = self.views[number]["byteOffset"], np.frombuffer(content, np.uint8)
        self._fills.append(lambda put: put(offset, numbers))
        return number

    def accessor(self, n: int, width: int, kind: int, target: int = VERTICES, **more: Any) -> int:
        """Room for n items of `width` numbers each; returns the accessor's number.

        Parameters
        ----------
        more
            Of the accessor: `min`, `max`, `normalized`.
        """
        view = self.view(n * width * np.dtype(_DTYPES[kind]).itemsize, target)
        self.accessors.append({"bufferView": view, "componentType": kind, "count": n, "type": TYPES[width], **more})
        return len(self.accessors) - 1

    def unfilled(self, n: int, width: int, kind: int, **more: Any) -> int:
        """An accessor of numbers that an extension gives; returns its number."""
        self.accessors.append({"componentType": kind, "count": n, "type": TYPES[width], **more})
        return len(self.accessors) - 1

    def fill(self, write: Callable[[Put], None]) -> None:
        """Have numbers written later, by a function that may put them in any order."""
        self._fills.append(write)

    def table(self, values: NDArray[Any], kind: int, target: int = VERTICES, **more: Any) -> int:
        """An accessor of few numbers, shape (n,) or (n, width); returns its number."""
        number = self.accessor(len(values), 1 if values.ndim == 1 else values.shape[1], kind, target, **more)
        self.fill(lambda put: put(self.offset(number), values.astype(_DTYPES[kind])))
        return number

    def offset(self, accessor: int) -> int:
        """Of an accessor's first byte."""
        view: int = self.accessors[accessor]["bufferView"]
        return self.views[view]["byteOffset"]

    def write(self, stream: BinaryIO, start: int) -> None:
        """Write all, from byte `start` of a file on; what is between views is zero."""

        def put(offset: int, numbers: NDArray[Any]) -> None:
            stream.seek(start + offset)
            stream.write(np.ascontiguousarray(numbers).data)

        for fill in self._fills:
            fill(put)


def limits_of(values: NDArray[np.float32]) -> dict[str, Any]:
    """Of an accessor of positions: the least and the largest of its numbers."""
    return {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}


def write_glb(path: Path, content: Mapping[str, Any], buffer: GlbBuffer) -> None:
    """Write a file, whole or not at all.

    Parameters
    ----------
    content
        Of the JSON, less what the buffer knows.

    Raises
    ------
    InputError
        It is too large for a .glb, or cannot be written.
    """
    n_bytes = -(-buffer.n_bytes // ALIGNMENT) * ALIGNMENT
    parts: dict[str, Any] = dict(content)
    if n_bytes:
        parts |= {"buffers": [{"byteLength": n_bytes}], "bufferViews": buffer.views}
    if buffer.accessors:
        parts["accessors"] = buffer.accessors
    text = json.dumps(parts, separators=(",", ":"), allow_nan=False).encode()
    # Numbers begin at a multiple of 8 bytes of the file, too.
    text += b" " * (-(len(text) + HEADER_BYTES) % ALIGNMENT)
    total = HEADER_BYTES + len(text) + n_bytes if n_bytes else HEADER_BYTES - 8 + len(text)
    if total > LARGEST_BYTES:
        raise InputError(
            say(
                "would have {:.1f} GB, and a .glb has less than 4.3; choose a lower degree of harmonics, fewer "
                "facades, or 3D Tiles, which are many files",
                total / 1000000000.0,
                place=path,
            )
        )
    with whole_file(path) as temporary, temporary.open("wb") as stream:
        stream.truncate(total)
        stream.write(struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<I4s", len(text), b"JSON") + text)
        if n_bytes:
            stream.write(struct.pack("<I4s", n_bytes, b"BIN\0"))
            buffer.write(stream, HEADER_BYTES + len(text))
