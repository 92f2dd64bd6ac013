"""Mutants of the verifier are told from it: a few here, all of them by the benchmark `proof-mutants`."""

from __future__ import annotations

import pytest

from tests.planning.proof.mutants import EQUIVALENT, SECTIONS, Question, is_equivalent, mutants, questions, told_by
from tests.planning.proof.verifiers import PYTHON

EVERY = 20
"""One mutant in so many of reading and geometry is tried here."""

QUICK = ("_of_panes", "_of_terrain", "_of_limits", "_of_folders")
"""Sections that take a fraction of a second each."""

SHARE_TOLD = 0.9
"""Of the mutants that are tried."""

SOURCE = PYTHON.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> list[Question]:
    sections = [each for each in SECTIONS if each.__name__ in QUICK]
    assert len(sections) == len(QUICK)
    return questions(tmp_path_factory.mktemp("huts"), 10, sections)


@pytest.mark.long
def test_mutants_of_reading_and_geometry_are_told_from_the_verifier(asked: list[Question]) -> None:
    lines = SOURCE.splitlines()
    parts = [each for each in mutants(SOURCE) if each.line < lines.index("class Case:")]
    tried = [each for each in parts[::EVERY] if not is_equivalent(each, lines)]
    survivors = [(each.line, each.change) for each in tried if told_by(each, asked) is None]
    assert len(survivors) <= (1.0 - SHARE_TOLD) * len(tried), survivors


@pytest.mark.long
def test_a_program_without_a_change_is_not_told(asked: list[Question]) -> None:
    changed = next(each for each in mutants(SOURCE) if each.change == "Lt -> LtE" and told_by(each, asked) is not None)
    node, name, k = changed.place
    assert told_by(changed._replace(new=getattr(node, name)[k]), asked) is None


@pytest.mark.long
def test_other_words_of_a_refusal_are_told(asked: list[Question]) -> None:
    other = mutants(SOURCE.replace("has a key twice", "is odd"))[0]
    node, name, k = other.place
    kept = getattr(node, name) if k is None else getattr(node, name)[k]
    assert told_by(other._replace(new=kept), asked) is not None


@pytest.mark.long
def test_each_mutant_that_is_called_equivalent_exists() -> None:
    lines, found = SOURCE.splitlines(), mutants(SOURCE)
    for part, change, _ in EQUIVALENT:
        assert any(part in lines[each.line - 1] and each.change.startswith(change) for each in found), (part, change)
