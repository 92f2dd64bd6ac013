"""One attack: a tampering, what the verifiers say, and what is true."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random

from tests.planning.proof.claims import Case, judged
from tests.planning.proof.exact import Point
from tests.planning.proof.tampering import tampered
from tests.planning.proof.verifiers import Claim, mission_names

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


LEGS, VIEWS, FLIGHT = ("sorties", "constraints"), ("camera", "constraints", "coverage"), ("origin", "home_enu_m")

SPEAKS_OF: dict[str, tuple[tuple[str, ...] | None, tuple[str, ...]]] = {
    "distance": (None, LEGS),
    "no-fly": (None, ("sorties",)),
    "return": (None, LEGS),
    "battery": ((), ("sorties", "viewpoints", "aircraft", "rules")),
    "coverage": (None, ("viewpoints", *VIEWS)),
    "reachable": (None, VIEWS),
    "mission": (FLIGHT, ("sorties", "viewpoints", "aircraft", "camera", *FLIGHT)),
    "missions": (FLIGHT, ("sorties", "viewpoints", "aircraft", "camera", *FLIGHT)),
}
"""Parts of the site, None for all of it with its meshes, and of the plan: of the claims that take long to judge."""

OF_PROOF = ("return_height_m", "return_kept_m", "level_within_m")


class Judge:
    """A judge that remembers: most tamperings leave most of what a claim speaks of as it was."""

    def __init__(self, places: Places) -> None:
        self.places = places
        self._known: dict[tuple[object, ...], bool | None] = {}

    def wrongly_proved(self, files: Mapping[str, bytes], claims: Sequence[Claim]) -> list[Claim]:
        """As the function of that name."""
        case = Case(files, self.places)
        return [claim for claim in claims if claim.verdict == "proved" and self._judged(case, claim.id) is False]

    def _judged(self, case: Case, claim: str) -> bool | None:
        key = _spoken_of(case, claim)
        if key is None:
            return judged(case, claim)
        if key not in self._known:
            self._known[key] = judged(case, claim)
        return self._known[key]


def _spoken_of(case: Case, claim: str) -> tuple[object, ...] | None:
    """Everything that the truth of a claim depends on; None where it is soon judged, or what it is cannot be read."""
    name = claim.partition(" ")[0]
    if name not in SPEAKS_OF:
        return None
    of_site, of_plan = SPEAKS_OF[name]
    missions = mission_names(case.files)
    read = missions if claim == "missions" else [each for each in missions if claim == f"mission {each}"]
    if of_site is None:
        read = [each for each in case.files if each not in ("plan.json", "plan.proof", *missions)]
    try:
        parts = [case.site.get(part) for part in of_site or ()] + [case.plan.get(part) for part in of_plan]
        parts += [case.json("plan.proof").get(name) for name in OF_PROOF]
    except Exception:  # a damaged file breaks readers in ways without number
        return None
    return claim, json.dumps(parts), *((each, case.files[each]) for each in read)


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
