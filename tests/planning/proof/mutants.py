"""Mutants of the verifier: the same program with one small mistake each.

A comparison the other way round or without its equality, another constant, another sign, a check that is left out, a
condition that always or never holds. If no test tells a mutant from the verifier, then something of it is not tested,
or not needed.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from types import CodeType
from typing import Any, NamedTuple


class Mutant(NamedTuple):
    """A changed program, and what was changed where."""

    line: int
    change: str
    code: CodeType


SWAPS: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div,),
    ast.Div: (ast.Mult,),
}

CALLS = {"min": "max", "max": "min", "all": "any", "any": "all"}

Place = tuple[ast.AST, str, int | None]
"""A node, its field, and the number in the field's list."""


def mutants(source: str) -> Iterator[Mutant]:
    """All mutants of a source, in the order of its lines.

    One tree is changed, compiled and put right again: copying it would take a hundred times as long.
    """
    tree = ast.parse(source)
    ignored = _texts(tree)
    found = [
        (node.lineno, node.col_offset, change, edits)  # type: ignore[attr-defined]
        for node, place in _places(tree)
        if id(node) not in ignored and hasattr(node, "lineno")
        for change, edits in _changes(node, place)
    ]
    for line, _, change, (place, new) in sorted(found, key=lambda each: each[:3]):
        old = _get(place)
        _set(place, ast.copy_location(new, place[0]) if isinstance(new, ast.AST) else new)
        yield Mutant(line, change, compile(tree, "reflight_verify.py", "exec"))
        _set(place, old)


def _places(tree: ast.AST) -> Iterator[tuple[ast.AST, Place]]:
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if isinstance(value, ast.AST):
                yield value, (parent, name, None)
            elif isinstance(value, list):
                for k, each in enumerate(value):
                    if isinstance(each, ast.AST):
                        yield each, (parent, name, k)


def _get(place: Place) -> Any:
    node, name, k = place
    value = getattr(node, name)
    return value if k is None else value[k]


def _set(place: Place, new: Any) -> None:
    node, name, k = place
    if k is None:
        setattr(node, name, new)
    else:
        getattr(node, name)[k] = new


def _texts(tree: ast.AST) -> set[int]:
    """Annotations, docstrings, and the program around `verify`: what a mutant of them does is not a verdict."""
    found: set[int] = set()
    for node in ast.walk(tree):
        parts: list[ast.AST | None] = []
        if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Module)) and ast.get_docstring(node):
            parts.append(node.body[0])
        if isinstance(node, ast.FunctionDef):
            arguments = node.args.args + node.args.kwonlyargs
            parts += [node.returns, *(argument.annotation for argument in arguments)]
            if node.name == "main":
                parts.append(node)
        if isinstance(node, ast.AnnAssign):
            parts.append(node.annotation)
        if isinstance(node, ast.JoinedStr):
            parts.append(node)
        if isinstance(node, ast.keyword) and node.arg == "strict":  # of zip: lists of this program's own, equally long
            parts.append(node)
        for part in parts:
            if part is not None:
                found.update(id(each) for each in ast.walk(part))
    return found


def _changes(node: ast.AST, place: Place) -> Iterator[tuple[str, tuple[Place, Any]]]:
    if isinstance(node, ast.Compare):
        for i, operator in enumerate(node.ops):
            for other in SWAPS.get(type(operator), ()):
                yield f"{type(operator).__name__} -> {other.__name__}", ((node, "ops", i), other())
    elif isinstance(node, (ast.BoolOp, ast.BinOp)):
        for other in SWAPS.get(type(node.op), ()):
            yield f"{type(node.op).__name__} -> {other.__name__}", ((node, "op", None), other())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub)):
        yield f"{type(node.op).__name__} removed", (place, node.operand)
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield f"{node.value} -> {not node.value}", ((node, "value", None), not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        for value in sorted({node.value * 2, node.value + 1} - {node.value}):
            yield f"{node.value} -> {value}", ((node, "value", None), value)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS:
        yield f"{node.func.id} -> {CALLS[node.func.id]}", ((node.func, "id", None), CALLS[node.func.id])
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        yield f"{ast.unparse(node.value)[:60]} left out", (place, ast.Pass())
    elif isinstance(node, ast.IfExp):
        yield "if: always", (place, node.body)
        yield "if: never", (place, node.orelse)
    elif isinstance(node, ast.If):
        yield "if: never", ((node, "test", None), ast.Constant(False))
        yield "if: always", ((node, "test", None), ast.Constant(True))
