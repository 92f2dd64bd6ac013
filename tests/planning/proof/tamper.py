"""What tamperings are made of: their registry, changes of JSON files, odd values, and amounts next to nothing."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

from tests.planning.proof.claims import Files

Tampering = Callable[[Random, dict[str, bytes]], None]

TAMPERINGS: dict[str, Tampering] = {}
"""By kind; each changes the files in place."""

JSON_FILES = ("site.json", "plan.json", "plan.proof")


def kind(name: str) -> Callable[[Tampering], Tampering]:
    """Register a kind of tampering."""

    def register(tampering: Tampering) -> Tampering:
        TAMPERINGS[name] = tampering
        return tampering

    return register


def tampered(random: Random, files: Files, name: str) -> dict[str, bytes]:
    """Files after a tampering of a kind, mostly with hashes that fit again."""
    changed = dict(files)
    TAMPERINGS[name](random, changed)
    return sealed(changed) if random.random() < 0.9 else changed


def sealed(files: Files) -> dict[str, bytes]:
    """The same files with all hashes right, as far as they can be read."""
    changed = dict(files)
    try:
        digest = hashlib.sha256(changed["site.json"]).hexdigest()
        # Texts are replaced, not rewritten: what is odd about a file must stay odd.
        plan = re.sub(
            rb'"site_sha256": *"[0-9a-f]*"', b'"site_sha256": "' + digest.encode() + b'"', changed["plan.json"]
        )
        changed["plan.json"] = plan
        proof = json.loads(changed["plan.proof"])
        proof["site"]["sha256"] = digest
        proof["plan"]["sha256"] = hashlib.sha256(plan).hexdigest()
        for entry in proof["meshes"]:
            if entry["name"] in changed:
                entry["sha256"] = hashlib.sha256(changed[entry["name"]]).hexdigest()
        changed["plan.proof"] = dumped(proof)
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    return changed


def dumped(content: Any) -> bytes:
    """JSON as Python writes it, NaN and Infinity included."""
    return json.dumps(content).encode()


def amount(random: Random) -> float:
    """A length from a nanometre to 10 m, of either sign, m."""
    return float(random.choice((-1, 1)) * 10.0 ** random.uniform(-9.0, 1.0))


def next_to_nothing(random: Random) -> float:
    """A relative or absolute change that rounding could hide."""
    return float(random.choice((-1, 1)) * 10.0 ** random.uniform(-16.0, -5.0))


ODD: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -math.inf,
    1e308,
    -1e308,
    1e-308,
    5e-324,
    1e16,
    -1.0,
    0,
    -0.0,
    10**400,
    2**53 + 1,
    True,
    False,
    None,
    "",
    "1",
    "NaN",
    [],
    {},
    [[[]]],
    "\ud800",
    "__proto__",
    "constructor",
)


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all values in a JSON file."""
    if path:
        yield path
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield from places(child, (*path, key))


def parent_of(content: Any, path: tuple[Any, ...]) -> Any:
    for key in path[:-1]:
        content = content[key]
    return content


def somewhere(random: Random, content: Any) -> tuple[Any, ...]:
    """A path that is as likely to be near the top as deep down."""
    value, path = content, ()
    while isinstance(value, (dict, list)) and value:
        key = random.choice(list(value) if isinstance(value, dict) else range(len(value)))
        path, value = (*path, key), value[key]
        if random.random() < 0.15:
            break
    return path


def edit(files: dict[str, bytes], name: str, change: Callable[[Any], None]) -> None:
    content = json.loads(files[name])
    change(content)
    files[name] = dumped(content)
