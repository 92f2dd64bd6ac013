"""One attack: a tampering, what the verifiers say, and what is true."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random

from tests.planning.proof.claims import Case, judged
from tests.planning.proof.exact import Point
from tests.planning.proof.tampering import tampered
from tests.planning.proof.verifiers import Claim

Verifier = Callable[[Mapping[str, bytes]], list[Claim]]

Places = Sequence[tuple[int, Point]]
"""Element and position that might be seen from."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one tampering.

    Parameters
    ----------
    wrong
        Claims that were called proved and are false: what must never be.
    worst
        `false` where the verifier calls a claim that, else `not proved`, or `proved` where it still proves everything.
    """

    kind: str
    files: dict[str, bytes]
    claims: list[Claim]
    wrong: list[Claim]

    @property
    def worst(self) -> str:
        verdicts = {claim.verdict for claim in self.claims}
        return next(each for each in ("false", "not proved", "proved") if each in verdicts)


def attack(seed: int, kind: str, files: Mapping[str, bytes], places: Places, verifier: Verifier) -> Outcome:
    """Tamper, verify and judge; the judge looks at what is called proved."""
    changed = tampered(Random(seed), files, kind)
    claims = verifier(changed)
    return Outcome(kind, changed, claims, wrongly_proved(changed, claims, places))


def wrongly_proved(files: Mapping[str, bytes], claims: Sequence[Claim], places: Places) -> list[Claim]:
    """Claims that are called proved and are false."""
    case = Case(files, places)
    return [claim for claim in claims if claim.verdict == "proved" and judged(case, claim.id) is False]


def same(a: Sequence[Claim], b: Sequence[Claim]) -> bool:
    """Whether two verifiers say the same, errors of their languages aside."""
    return [claim[:2] for claim in a] == [claim[:2] for claim in b]


def kept(outcome: Outcome, folder: Path) -> Path:
    """The files of an outcome in a folder, to look at."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in outcome.files.items():
        (folder / name).write_bytes(content)
    return folder
