"""Tampered files: nothing is called proved that an exact judge calls false, and no verifier falls over."""

from __future__ import annotations

import json
import os
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from random import Random

import pytest

from tests.benchmarks.proofs import attacked
from tests.planning.proof.attack import Judge, same, wrongly_proved
from tests.planning.proof.scenes import files, kept_hut, places
from tests.planning.proof.tampering import TAMPERINGS, of_kinds, sealed, tampered
from tests.planning.proof.verifiers import Claim, QtScript, by_module, by_program, load


@pytest.mark.long
def test_nothing_of_a_few_tampered_huts_is_wrongly_proved(tmp_path: Path) -> None:
    hut, seen_from = kept_hut()
    module, verdicts = load(), Counter[str]()
    for k, kind in enumerate(of_kinds(Random(0), len(TAMPERINGS))):
        changed = tampered(Random(k), hut, kind)
        claims = by_module(module, changed, tmp_path)
        assert wrongly_proved(changed, claims, seen_from) == [], kind
        verdicts.update({claim.verdict for claim in claims})
    assert set(verdicts) == {"proved", "false", "not proved"}


@pytest.mark.long
def test_the_page_says_the_same_of_tampered_huts(tmp_path: Path) -> None:
    hut, _ = kept_hut()
    module, script = load(), QtScript()
    for k, kind in enumerate(of_kinds(Random(1), 12)):
        changed = tampered(Random(k), hut, kind)
        assert same(by_module(module, changed, tmp_path), script(changed)), (kind, k)


def test_a_judge_that_remembers_judges_as_one_that_does_not() -> None:
    hut, seen_from = kept_hut()
    judge = Judge(seen_from)
    stated = [Claim(name, "proved", "") for name in ("coverage", "distance", "mission shop-1.kmz", "missions")]
    for k, kind in enumerate(["plan: angles changed", "mission: a waypoint moved", "site: a corner moved"] * 2):
        changed = tampered(Random(k), hut, kind)
        assert judge.wrongly_proved(changed, stated) == wrongly_proved(changed, stated, seen_from), (k, kind)


@pytest.mark.slow
def test_nothing_of_a_thousand_tampered_huts_is_wrongly_proved() -> None:
    # The benchmark `proof-attacks` goes through ten thousand.
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(attacked, [range(start, start + 100) for start in range(20_000, 21_000, 100)]))
    assert sum(part.wrong.total() for part in parts) == 0
    assert sum(part.otherwise for part in parts) == 0


@pytest.mark.slow
def test_nothing_of_tampered_shops_is_wrongly_proved(tmp_path: Path) -> None:
    shop, seen_from = files(), places()
    module, script = load(), QtScript()
    assert {claim.verdict for claim in by_module(module, shop, tmp_path)} == {"proved"}
    for k, kind in enumerate(of_kinds(Random(2), 2 * len(TAMPERINGS))):
        changed = tampered(Random(k), shop, kind)
        claims = by_module(module, changed, tmp_path)
        assert wrongly_proved(changed, claims, seen_from) == [], (kind, k)
        assert same(claims, script(changed)), (kind, k)


@pytest.mark.parametrize("kind", ["damaged bytes", "odd values", "mission: archives damaged or doubled"])
def test_the_program_says_of_damaged_files_what_it_says_of_others(kind: str, tmp_path: Path) -> None:
    status, claims, errors = by_program(tampered(Random(3), kept_hut()[0], kind), tmp_path)
    assert errors == ""
    assert status == (1 if any(claim.verdict == "false" for claim in claims) else 3)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("site.json", b'"building_mesh"', b'"building_mesh "'),
        ("site.json", b'"obstacles"', b'"obstacle"'),
        ("site.json", b'"no_fly"', b'"nofly"'),
        ("plan.json", b'"max_distance_m"', b'"max_distance"'),
    ],
)
def test_a_misspelled_field_proves_nothing(name: str, old: bytes, new: bytes, tmp_path: Path) -> None:
    hut, _ = kept_hut()
    assert old in hut[name]
    changed = sealed({**hut, name: hut[name].replace(old, new)})
    assert {claim.verdict for claim in by_module(load(), changed, tmp_path)} == {"not proved"}
    assert {claim.verdict for claim in QtScript()(changed)} == {"not proved"}


def test_a_building_that_the_site_no_longer_names_is_missed(tmp_path: Path) -> None:
    # Found by ten thousand tamperings: the files fit again, and the proof still names the building's mesh.
    hut, _ = kept_hut()
    changed = sealed(
        {**hut, "site.json": hut["site.json"].replace(b'"building_mesh": "shop.ply"', b'"building_mesh": null')}
    )
    claims = by_module(load(), changed, tmp_path)
    assert {claim.id: claim.verdict for claim in claims}["files"] == "false"
    assert same(claims, QtScript()(changed))


@pytest.mark.parametrize("n_kept", [0, 1])
def test_a_way_to_the_outside_that_is_cut_off_proves_nothing(n_kept: int, tmp_path: Path) -> None:
    hut, _ = kept_hut()
    proof = json.loads(hut["plan.proof"])
    proof["outside"] = proof["outside"][:n_kept]
    changed = {**hut, "plan.proof": json.dumps(proof).encode()}
    claims = by_module(load(), changed, tmp_path)
    assert {claim.id: claim.verdict for claim in claims}["distance"] == "not proved"
    assert same(claims, QtScript()(changed))


def test_missions_of_a_plan_that_flies_an_unknown_view_are_false_in_both(tmp_path: Path) -> None:
    hut, _ = kept_hut()
    changed = sealed({**hut, "plan.json": hut["plan.json"].replace(b'["v0000"', b'["v9999"')})
    claims = by_module(load(), changed, tmp_path)
    assert {claim.verdict for claim in claims if claim.id.startswith("mission ")} == {"false"}
    assert same(claims, QtScript()(changed))
