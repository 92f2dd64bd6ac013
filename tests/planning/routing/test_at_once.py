"""Sorties in the air at once: they keep apart whoever is early or late, and land earlier than one after the other."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.findings import Severity, is_flyable
from planning.checks import check_plan
from planning.insight.flight_profile import sortie_profile
from planning.parameters import FlightRules
from planning.plan import Plan, Sortie, read_plan, write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.edits import delete, revise
from planning.routing.at_once import (
    CHANGE_S,
    TIMING_S,
    TIMING_SHARE,
    LegTimes,
    Ways,
    earliest_starts,
    flown_at_once,
    forbidden_s,
    landed_s,
    leg_distances_m,
)
from planning.site.bundled import SCENES
from planning.site.records import SiteModel
from planning.viewpoints.prepare import prepare
from tests.planning.revision.cases import QUICK

RULES = FlightRules(at_once=2, apart_m=12.0)


@cache
def flown() -> tuple[SiteModel, Plan]:
    """Two aircraft before two facades."""
    site_model = SCENES["court"]()
    return site_model, plan_flight(
        site_model, PlanRequest(n_views=60, rules=RULES, greedy=QUICK, time_budget_s=10.0)
    ).plan


@pytest.mark.long
def test_aircraft_keep_apart_whoever_is_early_or_late():
    """By the closed form of the motion, which starts were not found by."""
    _, plan = flown()
    rng = np.random.default_rng(0)
    assert {sortie.aircraft for sortie in plan.sorties} == {1, 2}
    for one, other in itertools.combinations(plan.sorties, 2):
        if one.aircraft == other.aircraft:
            continue
        for _ in range(60):
            places = []
            for sortie in (one, other):
                profile = sortie_profile(plan, sortie)
                # Its own clock, fast or slow, and early or late.
                rate, late = rng.uniform(1.0 - TIMING_SHARE, 1.0 + TIMING_SHARE), rng.uniform(-TIMING_S, TIMING_S)
                ground_s = rng.uniform(0.0, plan.rules.takeoff_landing_s)
                t = np.arange(0.0, plan.landed_s + 60.0, 0.5)
                own = (t - sortie.start_s - late) / rate - ground_s
                there = profile.at(own).positions_enu_m
                is_flying = (own > 0.0) & (own < profile.duration_s)
                places.append(np.where(is_flying[:, None], there, np.nan))
            gaps = np.linalg.norm(places[0] - places[1], axis=1)
            assert not (gaps < plan.rules.apart_m).any()


@pytest.mark.long
def test_two_aircraft_land_earlier_than_one_and_the_check_says_how_near_they_come(tmp_path):
    site_model, plan = flown()
    findings = check_plan(plan, site_model)
    assert is_flyable(findings)
    (found,) = [finding for finding in findings if finding.code == "at-once"]
    assert found.severity is Severity.OK
    assert found.value >= RULES.apart_m
    assert plan.landed_s < 0.9 * plan.duration_s
    write_plan(tmp_path / "plan.json", plan)
    assert read_plan(tmp_path / "plan.json") == plan


def changed(plan: Plan, number: int, **changes: object) -> Plan:
    sorties = list(plan.sorties)
    sorties[number] = replace(sorties[number], **changes)
    return replace(plan, sorties=tuple(sorties))


@pytest.mark.long
def test_starts_that_were_changed_or_lost_are_errors():
    site_model, plan = flown()
    together = changed(changed(plan, 0, start_s=0.0), 1, start_s=0.0)
    lost = changed(plan, 0, start_s=None, aircraft=None)
    same = changed(changed(plan, 0, start_s=0.0, aircraft=1), 1, start_s=10.0, aircraft=1)
    for wrong, text in ((together, "at the same time"), (lost, "no starts any more"), (same, "need one aircraft")):
        found = [finding for finding in check_plan(wrong, site_model) if finding.code == "at-once"]
        assert any(finding.severity is Severity.ERROR and text in finding.message for finding in found)
    assert not [f for f in check_plan(flown_at_once(lost), site_model) if f.severity is Severity.ERROR]


def test_a_plan_of_one_aircraft_says_nothing_of_starts(tmp_path):
    _, plan = flown()
    alone = flown_at_once(replace(plan, rules=replace(plan.rules, at_once=1)))
    write_plan(tmp_path / "plan.json", alone)
    sorties = json.loads((tmp_path / "plan.json").read_text())["sorties"]
    assert all("start_s" not in sortie and "aircraft" not in sortie for sortie in sorties)
    assert alone.landed_s is None
    with pytest.raises(ValueError, match="a start with its aircraft"):
        Sortie((), (), 0.0, 0.0, start_s=3.0)


def straight(x: float, seconds: float) -> LegTimes:
    """One leg along north, at x."""
    ends = np.array([[x, 0.0, 0.0]]), np.array([[x, 50.0, 0.0]])
    return LegTimes(*ends, np.zeros((1, 1)), np.array([[seconds]]))


@given(
    st.lists(st.tuples(st.integers(0, 4), st.integers(30, 600)), min_size=1, max_size=5),
    st.integers(1, 3),
)
@settings(max_examples=60, deadline=None)
def test_starts_keep_every_pair_apart_and_every_aircraft_busy_with_one_sortie(shapes, n_aircraft):
    ways = [Ways((float(seconds), float(seconds)), (straight(8.0 * lane, seconds),) * 2) for lane, seconds in shapes]
    starts = earliest_starts(ways, n_aircraft, 10.0)
    for (a, one), (b, other) in itertools.combinations(enumerate(starts), 2):
        if one.aircraft == other.aircraft:
            early, late = sorted(((one.start_s, shapes[a][1]), (other.start_s, shapes[b][1])))
            assert late[0] >= early[0] + early[1] + CHANGE_S
            continue
        first, second = ways[a].legs[0], ways[b].legs[0]
        for low, high in forbidden_s(leg_distances_m(first, second) < 10.0, first, second):
            assert not low < other.start_s - one.start_s < high
    alone = sum(seconds for _, seconds in shapes) + CHANGE_S * (len(shapes) - 1)
    assert landed_s(ways, starts) <= alone + len(shapes)


@st.composite
def flights(draw):
    """Legs between random corners in a box, flown at constant speed after a stop at each, at three paces."""
    seed, n_legs = draw(st.integers(0, 2**32 - 1)), draw(st.integers(1, 6))
    rng = np.random.default_rng(seed)
    corners = rng.uniform((0.0, 0.0, 5.0), (60.0, 40.0, 25.0), (n_legs + 1, 3))
    corners[0] = corners[-1] = rng.choice(((0.0, 0.0, 5.0), (40.0, 0.0, 5.0)))
    lengths_m = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    took_s = (lengths_m / rng.uniform(1.0, 6.0) + 0.1) * rng.uniform(1.0, 2.0, (3, n_legs))
    stop_s = rng.uniform(3.0, 8.0, (3, n_legs))
    until_s = np.cumsum(took_s + stop_s, axis=1)
    return LegTimes(corners[:-1], corners[1:], until_s - took_s - stop_s, until_s), took_s


def dense(legs: LegTimes, took_s, weights, own_s):
    """Where an aircraft is at times of its own, shape (n, 3), and on which leg; NaN and -1 on the ground."""
    from_s, until_s, took_s = (weights @ each for each in (legs.from_s, legs.until_s, took_s))
    leg = np.searchsorted(until_s, own_s, side="right").clip(0, len(took_s) - 1)
    share = np.clip((own_s - from_s[leg]) / took_s[leg], 0.0, 1.0)[..., None]
    places = (1.0 - share) * legs.starts_enu_m[leg] + share * legs.ends_enu_m[leg]
    flies = (own_s >= 0.0) & (own_s <= until_s[-1])
    return np.where(flies[..., None], places, np.nan), np.where(flies, leg, -1)


LATE_S = np.linspace(-TIMING_S, TIMING_S, 13)
RATES = np.array(list(itertools.product((1.0 - TIMING_SHARE, 1.0 + TIMING_SHARE), repeat=2)))
LATES_S, RATES = np.repeat(LATE_S, len(RATES))[:, None], np.tile(RATES, (len(LATE_S), 1))[:, :, None]
"""One early while the other is late, from one extreme to the other, each fast or slow."""


@pytest.mark.long
@given(flights(), flights(), st.floats(4.0, 25.0), st.integers(0, 2**32 - 1))
@settings(deadline=None)
def test_starts_judged_apart_are_so_by_brute_force_and_those_forbidden_are_for_a_reason(one, other, apart_m, seed):
    """A second judge: both are sampled densely in time, early or late, fast or slow."""
    (first, first_took_s), (second, second_took_s) = one, other
    is_near = leg_distances_m(first, second) < apart_m
    spans, rng = forbidden_s(is_near, first, second), np.random.default_rng(seed)
    ends = spans.ravel() if spans.size else np.zeros(1)
    # Just outside of what is forbidden, and a little inside.
    beyond, within = np.add(spans, (-0.01, 0.01)), np.add(spans, (2.0, -2.0))
    picked = rng.choice(np.concatenate([beyond, within, [[0.0, 0.0]]]).ravel(), 3)
    longest_s = float(first.until_s.max() + second.until_s.max() + 4.0 * TIMING_S)
    t = np.arange(-2.0 * TIMING_S, 1.1 * first.until_s.max() + 2.0 * TIMING_S, 0.5)
    weights = [*np.eye(3), rng.dirichlet(np.ones(3))]
    here = [dense(first, first_took_s, each, (t - LATES_S) / RATES[:, 0]) for each in weights]
    for gap_s in (*rng.uniform(-longest_s, longest_s, 2), *picked):
        there = [dense(second, second_took_s, each, (t - gap_s + LATES_S) / RATES[:, 1]) for each in weights]
        both = list(zip(here, there, strict=True))
        if not any(low < gap_s < high for low, high in spans):
            assert not any((np.linalg.norm(a - b, axis=-1) < apart_m).any() for (a, _), (b, _) in both)
        elif np.abs(ends - gap_s).min() > 1.0 and len(spans):
            mixed = rng.dirichlet(np.ones(3), 200)
            reasons = [(is_near[leg, beside] & (leg >= 0) & (beside >= 0)).any() for (_, leg), (_, beside) in both]
            assert any(reasons) or any(meet(first, second, is_near, gap_s, each) for each in mixed)


def meet(first: LegTimes, second: LegTimes, is_near, gap_s: float, weights) -> bool:
    """Whether near legs may be flown at the same time at a mixture of paces."""
    low = (weights @ first.earliest_s)[:, None] - (weights @ second.latest_s)[None, :]
    high = (weights @ first.latest_s)[:, None] - (weights @ second.earliest_s)[None, :]
    return bool((is_near & (low < gap_s) & (gap_s < high)).any())


def test_a_sortie_whose_path_is_none_is_an_error_of_its_own():
    site_model, plan = flown()
    found = check_plan(changed(plan, 0, path_enu_m=()), site_model)
    assert not is_flyable(found)


@pytest.mark.slow
def test_an_edited_plan_has_starts_again():
    site_model, plan = flown()
    prepared = prepare(site_model, plan.camera, plan.constraints)
    edited = delete(revise(plan, prepared), [plan.viewpoints[0].id])
    assert edited.plan.landed_s is not None
    assert is_flyable(edited.findings)
