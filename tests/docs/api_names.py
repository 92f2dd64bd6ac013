"""docs/reference/api-names.md: every public name, with the first sentence of its docstring, by where it is made."""

from __future__ import annotations

import inspect
import re
from typing import Any

HEADER = """# Names of the Python API

Written by `make docs` (`python -m tests.docs`) from the docstrings; do not edit by hand. All of these are imported
from `groundstation.api`, which the page on the [Python API](api.md) shows at work.
"""

ROOMS = {
    "planning": "Sites, plans, and what all share",
    "missions": "Missions and flights",
    "reconstruction": "Photos, data sets, and models",
    "groundstation": "What commands do",
}


def page() -> str:
    """Text of the page."""
    from groundstation import api

    parts = [HEADER]
    for house, title in ROOMS.items():
        rows = [
            f"| `{name}` | {_sentence(getattr(api, name))} |"
            for name in api.__all__
            if _house(getattr(api, name)) == house
        ]
        if rows:
            parts.append("\n".join([f"## {title}\n", "| name | what it is |", "| --- | --- |", *rows]) + "\n")
    return "\n".join(parts)


def _house(value: Any) -> str:
    house = str(getattr(value, "__module__", None) or "groundstation").split(".", 1)[0]
    return house if house in ROOMS else "groundstation"


def _sentence(value: Any) -> str:
    text = inspect.getdoc(value) if inspect.isclass(value) or inspect.isroutine(value) else ""
    first = re.split(r"\n\s*\n", text or "")[0]
    return " ".join(first.split()).replace("|", "\\|")
