"""Checkpoints: all that a training is, in one file that is whole or not there, so that it goes on bit by bit.

One safetensors file holds the tensors, and in its header as JSON all other state. Nothing in it is ever executed:
files of strangers may be read.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor

from planning.base.errors import InputError
from planning.base.files import check_json_size
from planning.base.json_file import write_atomically
from planning.base.messages import say
from reconstruction.base.tensor_files import tensor_bytes

FORMAT = "reflight-checkpoint/1"

RECORD = "record"
"""Key of the JSON text in the header."""

DEEPEST = 40
"""Nesting of state; a training's is under 10."""


def flatten(state: Any, tensors: dict[str, Tensor], place: str = "") -> Any:
    """State with each tensor replaced by a reference, and put into `tensors` under its place.

    Dictionaries with keys of text or whole numbers, lists, tuples (which come back as lists), numbers, text and None
    are kept as they are.

    Raises
    ------
    TypeError
        Something else is in it.
    """
    if isinstance(state, Tensor):
        tensors[place] = state.detach().cpu().contiguous().clone()
        return {"$tensor": place}
    if isinstance(state, dict):
        keys = list(state)
        if not all(type(key) in (str, int) for key in keys):
            raise TypeError(f"{place}: expected keys of text or whole numbers")
        return {"$items": [[key, flatten(state[key], tensors, f"{place}/{key}")] for key in keys]}
    if isinstance(state, list | tuple):
        return [flatten(value, tensors, f"{place}/{number}") for number, value in enumerate(state)]
    if state is None or isinstance(state, bool | int | float | str):
        return state
    raise TypeError(f"{place}: expected tensors, numbers, text, lists and dictionaries, got {type(state).__name__}")


def unflatten(content: Any, tensors: dict[str, Tensor], depth: int = 0) -> Any:
    """State that `flatten` took apart.

    Raises
    ------
    ValueError
        The content is not of its form.
    """
    if depth > DEEPEST:
        raise ValueError("nested too deeply")
    if isinstance(content, list):
        return [unflatten(value, tensors, depth + 1) for value in content]
    if isinstance(content, dict):
        if set(content) == {"$tensor"} and isinstance(content["$tensor"], str):
            if content["$tensor"] not in tensors:
                raise ValueError(f"there is no tensor '{content['$tensor']}'")
            return tensors[content["$tensor"]]
        items = content.get("$items")
        if set(content) != {"$items"} or not isinstance(items, list):
            raise ValueError("expected a reference to a tensor or items")
        if not all(isinstance(item, list) and len(item) == 2 and type(item[0]) in (str, int) for item in items):
            raise ValueError("expected pairs of key and value")
        return {key: unflatten(value, tensors, depth + 1) for key, value in items}
    return content


def write_checkpoint(path: Path, state: dict[str, Any]) -> None:
    """Write state whole or not at all; what was there before stays until then.

    Raises
    ------
    InputError
        It cannot be written.
    """
    tensors: dict[str, Tensor] = {}
    record = {"format": FORMAT, "state": flatten(state, tensors)}
    write_atomically(path, save(tensors, metadata={RECORD: json.dumps(record, allow_nan=True)}))


def read_checkpoint(path: Path) -> dict[str, Any]:
    """State that `write_checkpoint` wrote, bit by bit.

    Raises
    ------
    InputError
        The file is missing, damaged, or none of ours.
    """
    content = tensor_bytes(path, say("begin the training anew"))
    try:
        tensors = load(content)
        text = _header_text(content)
        check_json_size(text.encode(), path)
        record = json.loads(text)
        if not isinstance(record, dict) or record.get("format") != FORMAT:
            raise ValueError(f"expected '{FORMAT}'")
        state = unflatten(record["state"], tensors)
    except (SafetensorError, KeyError, ValueError, TypeError, RecursionError) as error:
        raise InputError(
            say("is no checkpoint, or damaged ({}); begin the training anew", error, place=path)
        ) from error
    if not isinstance(state, dict):
        raise InputError(say("is no checkpoint; begin the training anew", place=path))
    return state


def _header_text(content: bytes) -> str:
    """The text that stands in the header, whose length is the file's first eight bytes."""
    length = int.from_bytes(content[:8], "little")
    text = json.loads(content[8 : 8 + length])["__metadata__"][RECORD]
    if not isinstance(text, str):
        raise ValueError("expected text")
    return text
