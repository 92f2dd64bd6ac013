"""Tampered sites, plans, proofs and missions: what the verifier says of them, and what an exact judge says."""

from __future__ import annotations

import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path
from random import Random

from tests.benchmarks.harness import Benchmark, Context, Row
from tests.planning.proof.attack import same, wrongly_proved
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.tampering import TAMPERINGS, of_kinds, tampered
from tests.planning.proof.verifiers import NODE, by_module, by_node, load

N_QUICK, N_FULL = 2, 14
"""Of each kind."""


def measure(context: Context) -> Iterator[Row]:
    """By kind: what became of the tamperings, and how many claims were wrongly called proved."""
    hut, seen_from = kept_hut()
    module = load()
    found: dict[str, Counter[str]] = defaultdict(Counter)
    n_wrong, n_otherwise = Counter[str](), 0
    n = (N_QUICK if context.is_quick else N_FULL) * len(TAMPERINGS)
    with tempfile.TemporaryDirectory() as name:
        sets, claimed = [], []
        for seed, kind in enumerate(of_kinds(Random(n), n)):
            sets.append(tampered(Random(seed), hut, kind))
            claimed.append(by_module(module, sets[-1], Path(name)))
            verdicts = {claim.verdict for claim in claimed[-1]}
            found[kind][next(each for each in ("false", "not proved", "proved") if each in verdicts)] += 1
            n_wrong[kind] += len(wrongly_proved(sets[-1], claimed[-1], seen_from))
        if NODE is not None:
            n_otherwise = sum(not same(a, b) for a, b in zip(claimed, by_node(sets, Path(name)), strict=True))
    for kind in TAMPERINGS:
        of_kind = found[kind]
        what = (
            f"{of_kind.total()} tamperings: {of_kind['false']} called false, {of_kind['not proved']} not proved, "
            f"{of_kind['proved']} still proved"
        )
        yield Row(kind, what, n_wrong[kind], "wrongly proved")
    yield Row(
        "all kinds", f"{n} tamperings", n_wrong.total(), "wrongly proved", target="none", met=n_wrong.total() == 0
    )
    if NODE is not None:
        what = f"{n} tamperings: the page in Node says otherwise of"
        yield Row("all kinds", what, n_otherwise, "tamperings", target="none", met=n_otherwise == 0)


BENCHMARK = Benchmark(
    "proof-attacks",
    "Tampered proofs",
    "A small site with its plan, proof and missions is tampered with, and sealed again with right checksums. Each "
    "claim that the verifier still calls proved is judged in exact rational numbers over all triangles. A claim that "
    "is proved and false would count as wrongly proved; what stays proved is true, because the change was harmless.",
    measure,
)
