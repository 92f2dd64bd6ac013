"""Mutants of the verifier: the same program with one small mistake each, and what tells them from it.

A comparison the other way round or without its equality, another constant, another sign, a check that is left out, a
condition that always or never holds. If no question tells a mutant from the verifier, then something of it is not
tested, or not needed. Questions are the probes of its parts, the hut, borders, and tampered huts; a mutant is asked
those that come through its statement, the quick ones first, up to the first other answer.
"""

from __future__ import annotations

import ast
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from random import Random
from types import CodeType, FrameType, ModuleType
from typing import Any, NamedTuple, cast

from tests.planning.proof import borders, borders_missions, borders_views
from tests.planning.proof.borders import Probe, Section
from tests.planning.proof.probes import answers
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.tampering import of_kinds, tampered
from tests.planning.proof.verifiers import PLAN, PROOF, PYTHON, SITE, Claim, load, mission_names, write

N_TAMPERED = 40

SECTIONS: tuple[Section, ...] = (*borders.SECTIONS, *borders_views.SECTIONS, *borders_missions.SECTIONS)


Place = tuple[ast.AST, str, int | None]
"""A node, its field, and the number in the field's list."""


class Mutant(NamedTuple):
    """A small change of a program.

    Parameters
    ----------
    line, columns
        Where the changed expression stands.
    kind, change
        What is changed, in general and here.
    statement
        Lines of the statement around it; none of what runs when the program is read.
    tree, place, new
        The program, and what is put where in it.
    """

    line: int
    columns: tuple[int, int]
    kind: str
    change: str
    statement: range
    tree: ast.AST
    place: Place
    new: Any

    def code(self) -> CodeType:
        """The changed program. The tree is put right again: copying it would take a hundred times as long."""
        node, name, k = self.place
        new = ast.copy_location(self.new, node) if isinstance(self.new, ast.AST) else self.new
        old = getattr(node, name)
        setattr(node, name, new if k is None else [*old[:k], new, *old[k + 1 :]])
        try:
            return compile(cast(ast.Module, self.tree), "reflight_verify.py", "exec")
        finally:
            setattr(node, name, old)


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


def mutants(source: str) -> list[Mutant]:
    """All mutants of a source, in the order of its lines."""
    tree = ast.parse(source)
    ignored, statements = _texts(tree), _statements(tree)
    found = []
    for node, place in _places(tree):
        if id(node) in ignored or not isinstance(node, (ast.expr, ast.stmt)):
            continue
        statement = min((each for each in statements if node.lineno in each), key=len, default=range(0))
        columns = node.col_offset, node.end_col_offset or 0
        for kind, change, at, new in _changes(node, place):
            found.append(Mutant(node.lineno, columns, kind, change, statement, tree, at, new))
    return sorted(found, key=lambda mutant: mutant[:4])


def _statements(tree: ast.AST) -> list[range]:
    """Lines of all statements in functions; of those that hold others, the head."""
    found = []
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef):
            for node in ast.walk(function):
                if isinstance(node, ast.stmt):
                    body = getattr(node, "body", None)
                    end = max(body[0].lineno, node.lineno + 1) if body else (node.end_lineno or node.lineno) + 1
                    found.append(range(node.lineno, end))
    return found


def _places(tree: ast.AST) -> Iterator[tuple[ast.AST, Place]]:
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            if isinstance(value, ast.AST):
                yield value, (parent, name, None)
            elif isinstance(value, list):
                for k, each in enumerate(value):
                    if isinstance(each, ast.AST):
                        yield each, (parent, name, k)


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
        if isinstance(node, ast.If) and ast.unparse(node.test) == "__name__ == '__main__'":
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


def _changes(node: ast.AST, place: Place) -> Iterator[tuple[str, str, Place, Any]]:
    """Kind and words of each change of a node, where it is made, and what is put there."""
    if isinstance(node, ast.Compare):
        for i, operator in enumerate(node.ops):
            for other in SWAPS.get(type(operator), ()):
                words = f"{'2nd ' * (i > 0)}{type(operator).__name__} -> {other.__name__}"
                yield "comparison", words, (node, "ops", i), other()
    elif isinstance(node, (ast.BoolOp, ast.BinOp)):
        for other in SWAPS.get(type(node.op), ()):
            yield "operator", f"{type(node.op).__name__} -> {other.__name__}", (node, "op", None), other()
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.Not, ast.USub)):
        yield "operator", f"{type(node.op).__name__} removed", place, node.operand
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield "constant", f"{node.value} -> {not node.value}", (node, "value", None), not node.value
    elif isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        for value in sorted({node.value * 2, node.value + 1} - {node.value}):
            yield "constant", f"{node.value} -> {value}", (node, "value", None), value
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in CALLS:
        other_call = CALLS[node.func.id]
        yield "min, max, all, any", f"{node.func.id} -> {other_call}", (node.func, "id", None), other_call
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        yield "check or step left out", f"{ast.unparse(node.value)[:60]} left out", place, ast.Pass()
    elif isinstance(node, ast.IfExp):
        yield "condition", "if: always", place, node.body
        yield "condition", "if: never", place, node.orelse
    elif isinstance(node, ast.If):
        yield "condition", "if: never", (node, "test", None), ast.Constant(False)
        yield "condition", "if: always", (node, "test", None), ast.Constant(True)


AT_THE_SLACK = "at the slack itself, which no input was found to meet to the last bit, either is right"

EQUIVALENT: tuple[tuple[str, str, str], ...] = (
    ("> 0.0 for a, way in edges", "Gt -> GtE", "above an edge both ways give the same distance"),
    ("is_wide = dot(normal, normal) > 1e-6", "Gt -> GtE", "a triangle of no size has no inside"),
    ("max(dot(way, way), 1e-30)", "1e-30 ->", "it only keeps an edge of no length from a division by zero"),
    ("if x > 0.0 else low[0]", "Gt -> GtE", "what is chosen is multiplied by zero"),
    ("if z > 0.0 else low[2]", "Gt -> GtE", "what is chosen is multiplied by zero"),
    ("low[2]) * z <= level", "LtE -> Lt", "a box that is looked into is looked into triangle by triangle"),
    ("low[2]) * z <= level", "if: never", "so are all boxes then, which takes longer and says the same"),
    ("UNKNOWN_M = 1e-3", "1000000000.0 ->", "higher than any flight is high enough"),
    ("default=1e6", "1000000.0 ->", "farther or faster than anything"),
    ('"max_jerk_m_s3": 1e30', "1e+30 ->", "no limit"),
    ("100_000_000", "100000000 ->", "a text that is longer than any mission"),
    ("16_000_000", "16000000 -> 16000001", "nodes have four bytes"),
    ("-slope < 2.0 * bend", "Lt -> LtE", "a parabola that is lowest at an end is as low there"),
    ("-slope < 2.0 * bend", "2nd Lt -> LtE", "a parabola that is lowest at an end is as low there"),
    ("if z > 0.0 else down", "Gt -> GtE", "a level leg climbs nothing"),
    ("90.0 / step - self.rings) < R", "Lt -> LtE", "no step is off by just so much"),
    ("and c - h * s > R", "Gt -> GtE", AT_THE_SLACK),
    ("s1 * u - c1 * v >= E", "GtE -> Gt", AT_THE_SLACK),
    ("if side > E:", "Gt -> GtE", AT_THE_SLACK),
    ("is_wide = length(normal) >= 1e-6", "GtE -> Gt", AT_THE_SLACK),
    ("abs(volume) >= R", "GtE -> Gt", AT_THE_SLACK),
    ("dot(faces[0][1], d) >= E", "GtE -> Gt", AT_THE_SLACK),
    (">= R * length(sub(corner, a)) + E", "GtE -> Gt", AT_THE_SLACK),
    ("dot(m, d) >= R * length(d)", "GtE -> Gt", AT_THE_SLACK),
    ("views[0][2] + 180.0", "Add -> Sub", "half a turn is the same either way"),
    ("not in self.shadows:", "if: always", "a shadow is found again, which takes longer"),
    ("if volume > 0.0 else", "Gt -> GtE", "a triangle that is seen edge on is refused before"),
)
"""Mutants that say the same of everything: a part of their line, the start of their change, and why."""


def is_equivalent(mutant: Mutant, lines: Sequence[str]) -> bool:
    """Whether a mutant is listed as saying the same, by the lines of its program."""
    line = lines[mutant.line - 1]
    return any(part in line and mutant.change.startswith(change) for part, change, _ in EQUIVALENT)


class HangsError(BaseException):
    """A mutant takes too long; no program catches it."""


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Of the processor's time."""

    def hangs(_number: int, _frame: object) -> None:
        raise HangsError

    old = signal.signal(signal.SIGVTALRM, hangs)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, old)


Ask = Callable[[ModuleType], Iterator[Any]]


class Question(NamedTuple):
    """A question to a verifier, its answers, the lines that they come through, and the time of looking for these."""

    name: str
    ask: Ask
    answers: list[str]
    lines: set[int]
    seconds: float


def questions(folder: Path, n_tampered: int = N_TAMPERED, sections: Sequence[Section] = SECTIONS) -> list[Question]:
    """Questions with the verifier's own answers, the quick ones first; the folder is for the files asked about."""

    def claimed(files: Path) -> Ask:
        return lambda of: iter(_claims(of, files))

    def bordered(section: Section) -> Ask:
        return lambda of: section(Probe(of, folders[0]))

    folders, module = _folders(folder, n_tampered), load()
    asks = [("parts", answers), ("hut", claimed(folders[0]))]
    asks += [(each.__name__, bordered(each)) for each in sections]
    asks += [(f"tampered {k}", claimed(each)) for k, each in enumerate(folders[1:], 1)]
    return sorted((_asked(module, name, ask) for name, ask in asks), key=lambda question: question.seconds)


def _folders(root: Path, n_tampered: int) -> list[Path]:
    """The hut and tampered huts, a folder each."""
    found = []
    for k, files in enumerate(_huts(n_tampered)):
        folder = root / str(k)
        folder.mkdir()
        write(files, folder)
        found.append(folder)
    return found


def _huts(n_tampered: int) -> Iterator[dict[str, bytes]]:
    """The hut, the hut with a mission twice, and tampered huts."""
    hut, _ = kept_hut()
    yield dict(hut)
    yield {**hut, "shop-2.kmz": hut["shop-1.kmz"]}
    for seed, kind in enumerate(of_kinds(Random(5), n_tampered)):
        yield tampered(Random(seed), hut, kind)


def _claims(module: ModuleType, folder: Path) -> list[Claim]:
    missions = [folder / name for name in mission_names({path.name: b"" for path in folder.iterdir()})]
    found = module.verify(folder / SITE, folder / PLAN, folder / PROOF, missions)
    return [Claim(each["id"], each["verdict"], each["text"]) for each in found]


def _asked(module: ModuleType, name: str, ask: Ask) -> Question:
    """A question with its answers. Lines that a function has come through once are no longer looked for."""
    lines: set[int] = set()
    missing: dict[CodeType, set[int]] = {}

    def note(frame: FrameType, event: str, _argument: object) -> Any:
        code = frame.f_code
        if code.co_filename != str(PYTHON):
            return None
        if event == "call":
            lines.add(code.co_firstlineno)
            if code not in missing:
                missing[code] = {line for _, _, line in code.co_lines() if line is not None}
            return note if missing[code] else None
        lines.add(frame.f_lineno)
        missing[code].discard(frame.f_lineno)
        return note

    started = time.process_time()
    sys.settrace(note)
    try:
        found = [repr(answer) for answer in ask(module)]
    finally:
        sys.settrace(None)
    return Question(name, ask, found, lines, time.process_time() - started)


def told_by(mutant: Mutant, asked: list[Question]) -> str | None:
    """The question that tells a mutant from the verifier; None if no one does."""
    module = ModuleType("mutant")
    sys.modules[module.__name__] = module
    name = "reading it"
    try:
        with _alarm(2.0):
            exec(mutant.code(), module.__dict__)
        for question in asked:
            if mutant.statement and question.lines.isdisjoint(mutant.statement):
                continue
            name = question.name
            with _alarm(2.0 + 5.0 * question.seconds):
                given = question.ask(module)
                if any(repr(next(given)) != answer for answer in question.answers) or next(given, None) is not None:
                    return name
        return None
    except (Exception, HangsError, SystemExit):  # a mutant that breaks or hangs is told by that
        return name
