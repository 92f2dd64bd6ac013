"""Ways to damage a file: bits and pieces, numbers and names, shapes of JSON and TOML, archives, and what is no file.

All are drawn from a generator with a seed, so that a case can be made again.
"""

from __future__ import annotations

import io
import json
import os
import random
import re
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import tomli_w

Mutation = Callable[[bytes, random.Random], bytes]

NUMBERS = (
    "0", "-1", "1e308", "-1e308", "1e999", "NaN", "Infinity", "-0.0", "1e-320", "255", "65536", "2147483648",
    "4294967295", "18446744073709551616", "9" * 400, "9" * 5000, "", "x", "0x10", "1,5", '"1"', "null", "[]", "١",
)  # fmt: skip
WORDS = (
    "",
    "\\ud800",
    "\\u0000",
    "../../../etc/passwd",
    "/dev/zero",
    "A" * 70_000,
    "é",
    "<",
    "nan",
    "\x00",
    "\x7f",
    "{0}",
)

VALUES: tuple[Any, ...] = (
    None, True, -1, 0, 1e308, -1e-320, 2**31, 2**63, 2**64, 10**400, "", "x", "\ud800", "\x00", "/dev/zero", "../..",
    "y" * 100_000, [], {}, [[]], [None], {"a": 1}, [0] * 1000, [1e308] * 3, float("nan"), float("inf"),
)  # fmt: skip
"""That take the place of values in JSON and TOML."""

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_][\w.-]*")


def bits(content: bytes, rng: random.Random) -> bytes:
    """Some bits turned over."""
    found = bytearray(content)
    for _ in range(rng.choice((1, 3, 20, 200)) if found else 0):
        found[rng.randrange(len(found))] ^= 1 << rng.randrange(8)
    return bytes(found)


def first_bytes(content: bytes, rng: random.Random) -> bytes:
    """As `bits`, among the first, where headers are."""
    end = min(len(content), rng.choice((16, 64, 512)))
    return bits(content[:end], rng) + content[end:]


def cut(content: bytes, rng: random.Random) -> bytes:
    """Only the beginning."""
    return content[: rng.randrange(len(content) + 1)] if rng.random() < 0.9 else b""


def lost(content: bytes, rng: random.Random) -> bytes:
    """A piece is missing."""
    start = rng.randrange(len(content) + 1)
    return content[:start] + content[start + rng.choice((1, 2, 16, 1000, 100_000)) :]


def doubled(content: bytes, rng: random.Random) -> bytes:
    """A piece stands twice, or many times."""
    start = rng.randrange(len(content) + 1)
    piece = content[start : start + rng.choice((1, 16, 300, 5000))]
    return (
        content[:start]
        + piece * rng.choice((2, 2, 50, max(1, min(2000, 4_000_000 // max(1, len(piece))))))
        + content[start:]
    )


def filled(content: bytes, rng: random.Random) -> bytes:
    """A piece has other bytes."""
    start, n = rng.randrange(len(content) + 1), rng.choice((1, 4, 8, 64, 4096))
    piece = rng.choice((b"\0" * n, b"\xff" * n, rng.randbytes(n), b"\x7f" * n, b" " * n, b"\n" * n))
    return content[:start] + piece + content[start + n * (rng.random() < 0.7) :]


def integers(content: bytes, rng: random.Random) -> bytes:
    """A number of four or eight bytes is one of those that nobody expects."""
    n = rng.choice((2, 4, 8))
    if len(content) < n:
        return content
    start = rng.randrange(len(content) - n + 1) if rng.random() < 0.5 else rng.randrange(min(len(content) - n + 1, 256))
    value = rng.choice((0, 1, 2 ** (8 * n) - 1, 2 ** (8 * n - 1), 2 ** (8 * n - 1) - 1, 0x7F800000, 0x7FC00000, 10**6))
    return content[:start] + (value % 2 ** (8 * n)).to_bytes(n, rng.choice(("little", "big"))) + content[start + n :]


def numbers(content: bytes, rng: random.Random) -> bytes:
    """Numbers in a text are others."""
    return _replaced(content, NUMBER, [number.encode() for number in NUMBERS], rng)


def words(content: bytes, rng: random.Random) -> bytes:
    """Words in a text are others."""
    return _replaced(content, WORD, [word.encode() for word in WORDS], rng)


def _replaced(content: bytes, pattern: re.Pattern[bytes], choices: list[bytes], rng: random.Random) -> bytes:
    found = list(pattern.finditer(content, 0, 2_000_000))
    for place in sorted(rng.sample(found, min(len(found), rng.choice((1, 1, 3)))), key=lambda each: -each.start()):
        content = content[: place.start()] + rng.choice(choices) + content[place.end() :]
    return content


def nested(content: bytes, rng: random.Random) -> bytes:
    """Brackets, elements or keys without end."""
    start = rng.randrange(len(content) + 1)
    n = rng.choice((200, 900, 100_000))
    piece = rng.choice(
        (
            b"[" * n,
            b'{"a":' * n,
            b"[" * n + b"]" * n,
            b"<a>" * n,
            b"<a>" * n + b"</a>" * n,
            b"a." * n + b"a=1",
            b"(" * n,
        )
    )
    return rng.choice((content[:start] + piece + content[start:], piece))


def values_json(content: bytes, rng: random.Random) -> bytes:
    """A value in JSON is of another kind, size or depth."""
    try:
        plain = json.loads(content)
    except ValueError:
        return numbers(content, rng)
    return json.dumps(_changed(plain, rng)).encode()


def values_toml(content: bytes, rng: random.Random) -> bytes:
    """A value in TOML is of another kind, size or depth."""
    try:
        return tomli_w.dumps(_changed(tomllib.loads(content.decode()), rng)).encode()
    except (ValueError, TypeError, AttributeError, RecursionError):
        return b"a." * 100_000 + b"a=1\n" + content


def _changed(plain: Any, rng: random.Random) -> Any:
    """The value with one place in it changed."""
    places: list[tuple[Any, Any]] = []
    level = [plain]
    while level:
        value = level.pop()
        keys = list(value) if isinstance(value, dict) else list(range(len(value))) if isinstance(value, list) else []
        places += [(value, key) for key in keys]
        level += [value[key] for key in keys]
        if len(places) > 20_000:
            break
    if not places or rng.random() < 0.02:
        return rng.choice(VALUES)
    # As likely at the top as below, where most places are.
    holder, key = places[int(len(places) * rng.random() ** 3)]
    match rng.choice(("value", "value", "value", "out", "more", "deep", "wrap")):
        case "value":
            holder[key] = rng.choice(VALUES)
        case "out":
            del holder[key]
        case "more" if isinstance(holder, list):
            holder[key:key] = [holder[key]] * rng.choice((1, 500))
        case "more":
            holder[f"{key}x"] = holder[key]
        case "deep":
            for _ in range(rng.choice((5, 90, 400))):
                holder[key] = [holder[key]]
        case "wrap":
            holder[key] = {"a": holder[key]}
    return plain


def members(content: bytes, rng: random.Random) -> bytes:
    """A file in an archive is damaged, named otherwise, doubled or very large."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            files = [(name, archive.read(name)) for name in archive.namelist()]
    except zipfile.BadZipFile:
        return bits(content, rng)
    at = rng.randrange(len(files))
    name, inside = files[at]
    match rng.choice(("inside", "inside", "inside", "name", "twice", "bomb", "many")):
        case "inside":
            files[at] = name, rng.choice((*BYTES, values_json, numbers, words, nested))(inside, rng)
        case "name":
            files[at] = rng.choice(("/etc/x", "../x", name.upper(), "a" * 60_000, "x")), inside
        case "twice":
            files.append((f"x{name}", inside))
        case "bomb":
            files[at] = name, inside[:100] + b" " * 100_000_000
        case "many":
            files += [(f"{number}", b"") for number in range(20_000)]
    written = io.BytesIO()
    with zipfile.ZipFile(written, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, inside in files:
            archive.writestr(name, inside)
    return written.getvalue()


def header_json(content: bytes, rng: random.Random) -> bytes:
    """The description in a safetensors or GLB file is changed, and its length with it."""
    at = 20 if content[:4] == b"glTF" else 8
    length = int.from_bytes(content[12:16] if at == 20 else content[:8], "little")
    changed = rng.choice((values_json, values_json, numbers, nested))(content[at : at + length], rng)
    changed += b" " * (-len(changed) % 4)
    if at == 8:
        return len(changed).to_bytes(8, "little") + changed + content[8 + length :]
    rest = content[20 + length :]
    size = (20 + len(changed) + len(rest)).to_bytes(4, "little")
    return content[:8] + size + len(changed).to_bytes(4, "little") + b"JSON" + changed + rest


BYTES: tuple[Mutation, ...] = (bits, first_bytes, cut, lost, doubled, filled, integers)
TEXTS: tuple[Mutation, ...] = (numbers, numbers, words, nested)

BY_KIND: dict[str, tuple[Mutation, ...]] = {
    "binary": BYTES,
    "text": (*BYTES, *TEXTS, *TEXTS),
    "json": (*BYTES, *TEXTS, *(values_json,) * 12),
    "toml": (*BYTES, *TEXTS, *(values_toml,) * 8),
    "zip": (*BYTES, *(members,) * 8),
    "header": (*BYTES, *(header_json,) * 8),
}


def no_file(path: Path, rng: random.Random, others: list[Path]) -> str:
    """Put in the place of a file what is none, or another one; returns what."""
    content = path.read_bytes()
    path.unlink()
    kind = rng.choice(("zero", "random", "pipe", "folder", "loop", "nowhere", "huge", "tail", "other", "full"))
    match kind:
        case "zero" | "random" | "full":
            path.symlink_to({"zero": "/dev/zero", "random": "/dev/urandom", "full": "/dev/full"}[kind])
        case "pipe":
            os.mkfifo(path)
        case "folder":
            path.mkdir()
        case "loop":
            path.symlink_to(path.name)
        case "nowhere":
            path.symlink_to("nowhere")
        case "huge" | "tail":
            # A file with a hole takes no room on the disk.
            path.write_bytes(content if kind == "tail" else b"")
            with path.open("r+b") as file:
                file.truncate(40 * 2**30)
        case "other":
            path.write_bytes(rng.choice(others).read_bytes())
    return kind
