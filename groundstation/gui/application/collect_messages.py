"""Templates of all messages, for Qt Linguist: `python -m groundstation.gui.application.collect_messages FILE.py`.

`lupdate` reads calls of Qt's own functions only. This writes the templates of every `say(...)`, `SomeError.say(...)`
and `tell(...)` into a Python file as calls that it does read; `make translations` throws the file away afterwards.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

from planning.base.messages import key_of

ROOT = Path(__file__).resolve().parents[3]
HOUSES = ("planning", "missions", "reconstruction", "groundstation")
CONTEXT = "Sentences"
SPEAKERS = {"planning.base.messages", "planning.base.errors", "groundstation.cli.console"}
"""Modules from which `say`, errors that have it, and `tell` are imported."""


def templates(root: Path = ROOT) -> set[str]:
    """What translators have to know, fields as `{0}`."""
    paths = (path for house in HOUSES for path in (root / house).rglob("*.py"))
    return {template for path in paths for template in templates_of(path)}


def templates_of(path: Path) -> Iterator[str]:
    """The templates of one module."""
    text = path.read_text("utf-8")
    if not any(module in text for module in SPEAKERS):  # parsing all modules takes twice as long
        return
    nodes = list(ast.walk(ast.parse(text)))
    if not any(isinstance(node, ast.ImportFrom) and node.module in SPEAKERS for node in nodes):
        return
    for node in nodes:
        name = getattr(node.func, "attr", getattr(node.func, "id", "")) if isinstance(node, ast.Call) else ""
        if isinstance(node, ast.Call) and name in ("say", "tell") and node.args:
            first = node.args[0]
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                yield key_of(first.value)


def main() -> None:
    """Write them."""
    lines = [f"QT_TRANSLATE_NOOP({CONTEXT!r}, {template!r})" for template in sorted(templates())]
    Path(sys.argv[1]).write_text("\n".join(["from PySide6.QtCore import QT_TRANSLATE_NOOP", *lines, ""]), "utf-8")


if __name__ == "__main__":
    main()
