"""Files of tensors (safetensors): looked at before their bytes are read, for a header tells how long a whole one is."""

from __future__ import annotations

import os
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, open_input_file
from planning.base.json_file import parse_json
from planning.base.messages import say

TENSORS_FILE = FileLimit(say("a safetensors file"), 16384 * MIB)
"""Splats, light and the optimiser's moments of twenty million splats."""

MAX_HEADER_BYTES = 64 * MIB
"""Checkpoints hold their state in it, some hundred kilobytes."""


def tensor_bytes(path: Path, advice: str = say("get the file again")) -> bytes:
    """Content of a file of tensors, of the length that its header says.

    Parameters
    ----------
    advice
        What to do about one that is damaged.

    Raises
    ------
    InputError
        It is missing, no such file, damaged or cut off.
    """
    with open_input_file(path, TENSORS_FILE) as file:
        size = os.fstat(file.fileno()).st_size
        start = file.read(8)
        length = int.from_bytes(start, "little")
        if len(start) < 8 or length > min(MAX_HEADER_BYTES, size - 8):
            raise InputError(say("is no safetensors file, or damaged (its header has no end); {}", advice, place=path))
        header = file.read(length)
        wanted = 8 + length + _end_of(parse_json(header, path))
        if wanted != size:
            raise InputError(say("is cut off or damaged ({} of {} bytes); {}", size, wanted, advice, place=path))
        return b"".join((start, header, file.read(wanted - 8 - length)))


def _end_of(header: object) -> int:
    """Where the last tensor ends; 0 where a header tells of none, or not as it should."""
    if not isinstance(header, dict):
        return 0
    ends = (entry.get("data_offsets") for name, entry in header.items() if isinstance(entry, dict))
    return max((end[1] for end in ends if isinstance(end, list) and len(end) == 2 and type(end[1]) is int), default=0)
