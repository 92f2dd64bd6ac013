"""Mutants of the verifier are told from it by the probes of its parts, the hut, and tampered huts."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import ModuleType

import pytest

from tests.planning.proof.mutants import Mutant, mutants
from tests.planning.proof.probes import answers
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.tampering import of_kinds, tampered
from tests.planning.proof.verifiers import PLAN, PROOF, PYTHON, SITE, Claim, load, mission_names, write

N_TAMPERED = 120
SECONDS = 5.0
"""Of the processor: a mutant that takes longer hangs, which tells it, too."""

N_PARTS = 8
SHARE_KILLED = 0.65
"""Of all mutants; 0.71 of one in thirty were told. Of the others some change nothing, or limits that no flight comes
near; some want probes that are not there yet: jerk-free ramps, speeds up and down, cones of the gimbal, missions above
the ellipsoid.
"""


class HangsError(Exception):
    """A mutant takes too long."""


@contextmanager
def _alarm() -> Iterator[None]:
    def hangs(_number: int, _frame: object) -> None:
        raise HangsError

    old = signal.signal(signal.SIGVTALRM, hangs)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, old)


def _folders(root: Path) -> list[Path]:
    """The hut and tampered huts, a folder each."""
    hut, _ = kept_hut()
    kinds = enumerate(of_kinds(Random(5), N_TAMPERED))
    found = []
    for k, files in enumerate([dict(hut), *(tampered(Random(seed), hut, kind) for seed, kind in kinds)]):
        folder = root / str(k)
        folder.mkdir()
        write(files, folder)
        found.append(folder)
    return found


def _claims(module: ModuleType, folder: Path) -> list[Claim]:
    missions = [folder / name for name in mission_names({path.name: b"" for path in folder.iterdir()})]
    found = module.verify(folder / SITE, folder / PLAN, folder / PROOF, missions)
    return [Claim(each["id"], each["verdict"], each["text"]) for each in found]


def _is_told(mutant: Mutant, truth: list[str], folders: list[Path], claims: list[list[Claim]]) -> bool:
    """Whether anything tells a mutant from the verifier."""
    module = ModuleType("mutant")
    sys.modules[module.__name__] = module
    try:
        with _alarm():
            exec(mutant.code, module.__dict__)
            if any(repr(answer) != known for answer, known in zip(answers(module), truth, strict=True)):
                return True
            return any(_claims(module, folder) != known for folder, known in zip(folders, claims, strict=True))
    except Exception:  # a mutant that breaks is told by that
        return True


def _survivors(part: int) -> tuple[int, list[str]]:
    """How many mutants a part of them holds, and those that nothing tells."""
    module, source = load(), PYTHON.read_text(encoding="utf-8")
    truth = [repr(answer) for answer in answers(module)]
    lines, found, n = source.splitlines(), [], 0
    with TemporaryDirectory() as name:
        folders = _folders(Path(name))
        claims = [_claims(module, folder) for folder in folders]
        for mutant in islice(mutants(source), part, None, N_PARTS):
            n += 1
            if not _is_told(mutant, truth, folders, claims):
                found.append(f"{mutant.line}: {mutant.change} | {lines[mutant.line - 1].strip()[:100]}")
    return n, found


def test_a_mutant_without_a_check_is_told(tmp_path: Path) -> None:
    module, source = load(), PYTHON.read_text(encoding="utf-8")
    folders = _folders(tmp_path)[:1]
    claims = [_claims(module, folder) for folder in folders]
    truth = [repr(answer) for answer in answers(module)]
    first = next(mutants(source))
    same = Mutant(0, "nothing", compile(source, str(PYTHON), "exec"))
    assert not _is_told(same, truth, folders, claims)
    other = compile(source.replace("has a key twice", "is odd"), "mutant", "exec")
    assert _is_told(first._replace(code=other), truth, folders, claims)


@pytest.mark.slow
def test_most_mutants_of_the_verifier_are_told_from_it() -> None:
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(_survivors, range(N_PARTS)))
    survivors = [line for _, lines in parts for line in lines]
    assert len(survivors) <= (1.0 - SHARE_KILLED) * sum(n for n, _ in parts), "\n".join(survivors)
