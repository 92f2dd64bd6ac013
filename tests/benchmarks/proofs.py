"""Proofs of plans: their size, what they take to make and to check, and whether both verifiers prove them whole.

Then tampered sites, plans, proofs and missions: what the verifier says of them, and what an exact judge says. And
mutants of the verifier: whether anything tells them from it.
"""

from __future__ import annotations

import gc
import os
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Literal, NamedTuple

from groundstation.services.mission.proof import write_plan_proof
from groundstation.services.plan.planning import plan_document_site
from planning.plan import write_plan
from planning.request import PlanRequest
from planning.site.bundled import SCENES, write_scene
from planning.site.file import read_site, write_site
from planning.site.importing.attach_terrain import TerrainRequest, attach_terrain
from planning.site.importing.elevation import HeightOptions
from tests.benchmarks.fresh_process import run_command
from tests.benchmarks.harness import Benchmark, Context, Row, timer
from tests.benchmarks.terrain import write_hill
from tests.planning.proof.attack import Judge, same, wrongly_proved
from tests.planning.proof.mutants import is_equivalent, mutants, questions, told_by
from tests.planning.proof.scenes import kept_hut
from tests.planning.proof.tampering import TAMPERINGS, of_kinds, tampered
from tests.planning.proof.verifiers import NODE, PLAN, PYTHON, SITE, by_module, by_node, by_program, load

MOST_VIEWS = 560
"""Views of a plan: two for each panel, but no more."""

PLANNING = "of planning"

WANTED = {
    ("proof", "MB"): 5.0,
    ("made in", PLANNING): 0.1,
    ("verifier", "s"): 60.0,
    ("claims not proved", "claims"): 0.0,
    ("the page says otherwise of", "claims"): 0.0,
}
"""At most, of the proof of 560 views on 280 panels; by what is measured and its unit."""

HOUSES = ("bim/office_a.ifc", "bim/curtain_wall_small.ifc")
CITY = "buildings/ingolstadt_lod3/{}.xml"
CITY_HOUSES = ("4018106", "4018115")


def measure(context: Context) -> Iterator[Row]:
    """By site: size and time of the proof, times of the verifiers, and what they say; then the worst of them all."""
    worst: dict[tuple[str, str], float] = {}
    with tempfile.TemporaryDirectory() as name, _no_garbage_of_others():
        for scene, site in _sites(context, Path(name)):
            for row in _of_site(scene, site):
                yield row
                value = row.ratio if row.against == PLANNING else float(row.value)
                kind = row.what if row.unit != "MB" else "proof", row.against or row.unit
                worst[kind] = max(worst.get(kind, 0.0), value or 0.0)
    for (what, unit), value in worst.items():
        if (what, unit) in WANTED:
            most = WANTED[what, unit]
            yield Row("the worst of all", what, value, unit, target=f"at most {most:g}", met=value <= most)


@contextmanager
def _no_garbage_of_others() -> Iterator[None]:
    """What all benchmarks import, a pilot has not: searches through it took a third of a proof's time."""
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


def _sites(context: Context, root: Path) -> Iterator[tuple[str, Path]]:
    """Names and files of sites, each in a folder of its own."""
    for number, scene in enumerate(("single-panel", "roof") if context.is_quick else SCENES):
        folder = root / str(number)
        folder.mkdir()
        yield scene, write_scene(scene, folder).rename(folder / SITE)
    if context.is_quick:
        return
    (root / "hill").mkdir()
    model = read_site(write_scene("office", root / "hill"))
    wanted = TerrainRequest(
        (write_hill(root),), options=HeightOptions(vertical="ellipsoid"), step_m=1.0, accuracy_m=0.0
    )
    write_site(root / "hill" / SITE, attach_terrain(model, wanted, "hill").model.site)
    yield "office on a hill", root / "hill" / SITE
    for house in (*HOUSES, *map(CITY.format, CITY_HOUSES)):
        folder = root / Path(house).stem
        folder.mkdir()
        run_command(["site", "import", context.data(house), "-o", folder / SITE])
        yield Path(house).name, folder / SITE


def _of_site(scene: str, site: Path) -> Iterator[Row]:
    model = read_site(site)
    request = PlanRequest(n_views=min(2 * len(model.site.panels), MOST_VIEWS))
    with timer() as planning_s:
        planned = plan_document_site(model, request)
    write_plan(site.with_name(PLAN), planned.plan)
    with timer() as proving_s:
        proof = write_plan_proof(site.with_name(PLAN), site, model, planned.prepared.problem.reachability)
    what = f"{len(planned.plan.viewpoints)} views, {len(model.site.panels)} panels: proof"
    yield Row(scene, what, proof.stat().st_size / 1e6, "MB")
    yield Row(scene, "made in", proving_s(), "s", proving_s() / planning_s(), PLANNING)
    files = {path.name: path.read_bytes() for path in site.parent.iterdir()}
    with tempfile.TemporaryDirectory() as name:
        with timer() as python_s:
            _, claims, _ = by_program(files, Path(name))
        yield Row(scene, "verifier", python_s(), "s")
        yield Row(scene, "claims not proved", sum(each.verdict != "proved" for each in claims), "claims")
        if NODE is not None:
            with timer() as page_s:
                (page,) = by_node([files], Path(name))
            yield Row(scene, "its page in Node", page_s(), "s", page_s() / python_s(), "the verifier")
            otherwise = sum(a != b for a, b in zip(claims, page, strict=True))
            yield Row(scene, "the page says otherwise of", otherwise, "claims")


BENCHMARK = Benchmark(
    "proofs",
    "Proofs of plans",
    "Plans as they are made by default, with two views for each panel, 560 at most; their proofs; and what both "
    "verifiers say of them, each in a process of its own.",
    measure,
)


N_QUICK, N_FULL = 2, 295
"""Of each kind."""

CHUNK = 20
"""Times all kinds that one process takes on."""

ANEW = 20
"""One in so many is judged whole, without what is remembered of others, and shown to the page."""


class Attacked(NamedTuple):
    """What became of some tamperings.

    Parameters
    ----------
    verdicts
        By kind and worst verdict.
    wrong
        Claims wrongly called proved, by kind.
    otherwise
        How many the page says otherwise of.
    """

    verdicts: Counter[tuple[str, str]]
    wrong: Counter[str]
    n_shown: int
    otherwise: int


def attacked(seeds: range) -> Attacked:
    """Tamper with the hut once per seed, all kinds in turn, and judge what is called proved."""
    hut, seen_from = kept_hut()
    module, judge = load(), Judge(seen_from)
    found = Attacked(Counter(), Counter(), 0, 0)
    shown, otherwise = [], 0
    with tempfile.TemporaryDirectory() as name:
        for seed, kind in zip(seeds, of_kinds(Random(seeds.start), len(seeds)), strict=True):
            files = tampered(Random(seed), hut, kind)
            claims = by_module(module, files, Path(name))
            verdicts = {claim.verdict for claim in claims}
            found.verdicts[kind, next(each for each in ("false", "not proved", "proved") if each in verdicts)] += 1
            wrong = judge.wrongly_proved(files, claims)
            if seed % ANEW == 0:
                assert wrong == wrongly_proved(files, claims, seen_from), (kind, seed)
                shown.append((files, claims))
            found.wrong[kind] += len(wrong)
        if NODE is not None and shown:
            pages = by_node([files for files, _ in shown], Path(name))
            otherwise = sum(not same(claims, page) for (_, claims), page in zip(shown, pages, strict=True))
    return found._replace(n_shown=len(shown), otherwise=otherwise)


def measure_attacks(context: Context) -> Iterator[Row]:
    """By kind: what became of the tamperings, and how many claims were wrongly called proved."""
    of_each = N_QUICK if context.is_quick else N_FULL
    n, step = of_each * len(TAMPERINGS), CHUNK * len(TAMPERINGS)
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(attacked, [range(start, min(start + step, n)) for start in range(0, n, step)]))
    verdicts, wrong = sum((part.verdicts for part in parts), Counter()), sum((part.wrong for part in parts), Counter())
    for kind in TAMPERINGS:
        counts = [verdicts[kind, each] for each in ("false", "not proved", "proved")]
        what = f"{sum(counts)} tamperings: {counts[0]} called false, {counts[1]} not proved, {counts[2]} still proved"
        yield Row(kind, what, wrong[kind], "wrongly proved")
    yield Row("all kinds", f"{n} tamperings", wrong.total(), "wrongly proved", target="none", met=wrong.total() == 0)
    if NODE is not None:
        shown, otherwise = sum(part.n_shown for part in parts), sum(part.otherwise for part in parts)
        what = f"{shown} tamperings: the page in Node says otherwise of"
        yield Row("all kinds", what, otherwise, "tamperings", target="none", met=otherwise == 0)


ATTACKS_BENCHMARK = Benchmark(
    "proof-attacks",
    "Tampered proofs",
    "A small site with its plan, proof and missions is tampered with, and sealed again with right checksums. Each "
    "claim that the verifier still calls proved is judged in exact rational numbers over all triangles. A claim that "
    "is proved and false would count as wrongly proved; what stays proved is true, because the change was harmless.",
    measure_attacks,
)


EVERY_QUICK = 170
"""One mutant in so many, where it must be quick."""

ALL = "all kinds"

Fate = Literal["told", "the same", "not told"]


def fates(part: int, n_parts: int, every: int) -> list[tuple[str, Fate, str]]:
    """Of a part of the mutants: their kinds, what became of each, and where it is and what it changes."""
    source = PYTHON.read_text(encoding="utf-8")
    lines, found = source.splitlines(), list[tuple[str, Fate, str]]()
    with tempfile.TemporaryDirectory() as name:
        asked = questions(Path(name))
        for mutant in mutants(source)[::every][part::n_parts]:
            is_same = is_equivalent(mutant, lines)
            fate: Fate = "the same" if is_same else "not told" if told_by(mutant, asked) is None else "told"
            found.append((mutant.kind, fate, f"line {mutant.line}: {mutant.change}"))
    return found


def measure_mutants(context: Context) -> Iterator[Row]:
    """By kind of change: how many mutants nothing tells from the verifier, and each of them."""
    n, every = os.cpu_count() or 1, EVERY_QUICK if context.is_quick else 1
    with ProcessPoolExecutor(n) as pool:
        found = [each for part in pool.map(fates, range(n), [n] * n, [every] * n) for each in part]
    for kind in (*dict.fromkeys(kind for kind, _, _ in found), ALL):
        counts = Counter(fate for of, fate, _ in found if kind in (of, ALL))
        what = f"{counts.total()} mutants: {counts['told']} told, {counts['the same']} that cannot be"
        row = Row(kind, what, counts["not told"], "not told")
        yield replace(row, target="none", met=row.value == 0) if kind == ALL else row
    for kind, fate, where in found:
        if fate == "not told":
            yield Row(kind, where, 1, "not told")


MUTANTS_BENCHMARK = Benchmark(
    "proof-mutants",
    "Mutants of the verifier",
    "The verifier with one small mistake: another comparison, constant or sign, a check left out, a condition that "
    "always or never holds. Each mutant is asked what the verifier is: what its parts say, at which number each claim "
    "is lost, and what it says of tampered files. Those that cannot be told are listed with their reasons in "
    "`tests/planning/proof/mutants.py`.",
    measure_mutants,
)
