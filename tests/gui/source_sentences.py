"""Collects the sentences that the parts without Qt make, as templates: `f"{name} is {x:g} m"` gives "{0} is {1} m"."""

import ast
import itertools
import re
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PARTS = ("planning", "missions", "reconstruction", "groundstation/vehicle", "groundstation/services")

TOPS = {"planning", "missions", "reconstruction", "groundstation"}

WRONG_CALLS = {"ValueError", "TypeError", "KeyError", "RuntimeError", "NotImplementedError"}
"""Their messages are for programmers, except in the records that files are read into."""

RECORDS = {
    *("planning/geo/frames.py", "planning/site/records.py", "planning/plan.py", "planning/request.py"),
    *("planning/parameters.py", "planning/base/parameters.py"),
}

PARAMETERS = {"parameter", "like", "Parameter", "Choice"}
"""Calls that declare a parameter: its label and help have a context of their own."""

STAGES = {"report", "_Report"}
"""Calls that name the stage of a job first; also a stage of one word is shown."""

STATEMENT_LISTS = ("body", "orelse", "finalbody", "handlers", "cases")
"""Fields of the syntax tree that hold statements, or what holds them in turn."""

PLACE = re.compile(r"^(?:\{0\}(?:, line \{1\})?|[a-z]+(?:_[a-z]+)+): ")
FIELD_OF_RECORD = re.compile(r"^[\w.{}\[\]]+: ")
"""What a message begins with where it names its file or field; the window takes it off before it looks for the rest,
for more may stand before it: `plan.json: sorties[3].id: expected a name`.
"""


@cache
def collect():
    """Templates by where they stand: {(path, line): [template, ...]}."""
    found = {}
    for part in PARTS:
        for path in sorted((ROOT / part).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            for line, text in _texts(_tree(path), name in RECORDS):
                found.setdefault((name, line), []).append(text)
    return found


@cache
def files_of_the_window():
    """Files that the window imports, at once or later: what is made elsewhere does not come into it."""
    reached, waiting = set(), sorted((ROOT / "groundstation" / "gui").rglob("*.py"))
    while waiting:
        path = waiting.pop()
        if path not in reached:
            reached.add(path)
            waiting += _imported(_tree(path))
    return {path.relative_to(ROOT).as_posix() for path in reached}


def _imported(tree):
    """Files of this project that a module imports, also within functions."""
    names = set()
    for node in _statements(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    places = [ROOT.joinpath(*name.split(".")) for name in names if name.partition(".")[0] in TOPS]
    return [file for place in places for file in (place.with_suffix(".py"), place / "__init__.py") if file.is_file()]


def _statements(node):
    """All statements below a node: no others import, and most nodes are expressions."""
    for inner in itertools.chain.from_iterable(getattr(node, name, ()) for name in STATEMENT_LISTS):
        yield inner
        yield from _statements(inner)


@cache
def _tree(path):
    return ast.parse(path.read_text("utf-8"))


def template(parts, is_record=False):
    """A template from literal texts and None for each field; fields side by side are one."""
    parts = [part for part, before in zip(parts, [0, *parts], strict=False) if part is not None or before is not None]
    numbers = itertools.count()
    text = "".join(f"{{{next(numbers)}}}" if part is None else part for part in parts)
    place = FIELD_OF_RECORD if is_record else PLACE
    while place.match(text):
        text = renumbered(place.sub("", text))
    return text


def renumbered(text):
    """Fields counted from 0, in order."""
    numbers = itertools.count()
    return re.sub(r"\{\d+\}", lambda _found: f"{{{next(numbers)}}}", text)


def _texts(node, is_record):
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return  # a docstring
    if isinstance(node, ast.Raise) and not is_record and _name(node.exc) in WRONG_CALLS:
        return
    if isinstance(node, ast.Call) and _name(node) in PARAMETERS:
        return
    if isinstance(node, ast.Call) and _name(node) in STAGES and node.args:
        yield from ((node.lineno, template(parts)) for parts in _variants(node.args[0]) if any(parts))
        return
    if isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str)):
        yield from ((node.lineno, text) for text in _templates(node, is_record) if _is_sentence(text))
        inner = [part.value for part in getattr(node, "values", ()) if isinstance(part, ast.FormattedValue)]
        for value in inner:
            if _variants(value) == [[None]]:
                yield from _texts(value, is_record)
        return
    for child in ast.iter_child_nodes(node):
        yield from _texts(child, is_record)


def _templates(node, is_record):
    return [template(parts, is_record) for parts in _variants(node)]


def _variants(node):
    """All ways in which a text can come out, each a list of literal texts and None."""
    if isinstance(node, ast.Constant):
        return [[node.value or ""]] if isinstance(node.value, str) else [[None]]
    if isinstance(node, ast.IfExp):
        return _variants(node.body) + _variants(node.orelse)
    if isinstance(node, ast.FormattedValue):
        return _variants(node.value) if node.format_spec is None and node.conversion == -1 else [[None]]
    if isinstance(node, ast.JoinedStr):
        return [list(itertools.chain(*parts)) for parts in itertools.product(*map(_variants, node.values))]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return [left + right for left in _variants(node.left) for right in _variants(node.right)]
    return [[None]]


SQL = re.compile(
    r"^\s*\(?(INSERT|UPDATE|DELETE|SELECT|WHERE|BEGIN|CREATE|EXISTS|NOT EXISTS|AND)\b|= \?|\bOR \?|lower\(\?\)|IS NULL"
    r"|\b(DESC|JOIN|REFERENCES)\b|^[oe]\.\w+,|^\w+ = (OFF|ON|EXTRA)$|^\(layer, "
)
"""What a database is told."""


def _is_sentence(text):
    return (
        not SQL.search(text)
        and " " in text.strip()
        and re.search(r"[^\W\d_]{2}", re.sub(r"\{\d\}", "", text)) is not None
    )


def _name(node):
    """Name of what a call calls; empty for anything else."""
    called = getattr(node, "func", None)
    return called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
