"""Views chosen for the least expected error: gains, bounds, single against double, and what a site calls for."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from unittest import mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.base.progress import QUIET
from planning.coverage.image_error import FAR_M, ImageErrorModel, Term, _looks, decibels
from planning.coverage.mirrored_rays import MirroredRays, Surroundings, pane_reflectance
from planning.coverage.sections import panel_frames
from planning.parameters import DEFAULT_SHARE, Constraints, GreedyParameters
from planning.plan import ViewpointArrays, plan_of, plan_to_json
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.routing.flights import Flight
from planning.site.bundled import SCENES
from planning.site.records import panel_corners
from planning.viewpoints.budget import best_flights
from planning.viewpoints.candidates import candidate_pool, spread_candidates
from planning.viewpoints.least_error import (
    DEVIATION_DB,
    FAR_DB,
    FAR_DEVIATION_DB,
    NO_GAIN,
    ErrorGain,
    ErrorState,
    add_or_remove,
    choose_for_least_error,
    error_state,
    error_taken,
    expected_psnr_db,
    fill_gains,
    flight_worth,
    gain_of,
    image_error_model,
    least_error,
)
from planning.viewpoints.prepare import Prepared, prepare
from planning.viewpoints.problem import take
from planning.viewpoints.spacing import SpacingRule
from planning.viewpoints.unseen import random_views, walk_views
from reconstruction.scenes.light.pane_surfaces import pane_light
from reconstruction.scenes.record import Glass
from tests.planning.plan_cases import StopAfter

TILT = Term("tilt", 0.01, 0.0025)


@cache
def prepared(name: str = "single-panel") -> Prepared:
    """A bundled site, ready."""
    return prepare(SCENES[name](), profile("m3e").camera, Constraints())


@cache
def model(name: str = "single-panel") -> ImageErrorModel:
    """Its expected error."""
    ready = prepared(name)
    return image_error_model(ready.problem, ready.site_model)[0]


@cache
def candidates(name: str = "single-panel", n: int = 300) -> ViewpointArrays:
    """Views to choose from."""
    return spread_candidates(prepared(name).problem, n, np.random.default_rng(1))


@st.composite
def made_states(draw: st.DrawFn) -> ErrorState:
    """A few candidates that show a few elements, much or next to nothing of them."""
    n, m = draw(st.integers(1, 8)), draw(st.integers(1, 12))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rows = [np.sort(rng.choice(m, rng.integers(0, m + 1), replace=False)) for _ in range(n)]
    items = np.concatenate([np.zeros(0, np.int64), *rows]).astype(np.int32)
    amounts = (10.0 ** rng.uniform(-6.0, 6.0, len(items))).astype(np.float32)
    starts = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int64)
    weights = 10.0 ** rng.uniform(-8.0, 2.0, m)
    nowhere = np.zeros((n, 3))
    state = ErrorState(starts, items, amounts, weights, np.zeros(m), np.zeros(n), nowhere, np.zeros((0, 3)), 0.0)
    fill_gains(state, state.bounds)
    return state


def value_of(state: ErrorState, chosen: set[int]) -> float:
    """f of a set by its definition, in double precision."""
    sums = np.zeros(len(state.weights))
    for each in chosen:
        part = slice(state.starts[each], state.starts[each + 1])
        sums[state.items[part]] += state.amounts[part].astype(float)
    return float((state.weights * sums / (1.0 + sums)).sum())


@given(made_states(), st.randoms(use_true_random=False))
def test_what_views_take_away_is_monotone_and_submodular(state, random):
    n = len(state.bounds)
    larger = {each for each in range(n) if random.random() < 0.6}
    smaller = {each for each in larger if random.random() < 0.5}
    scale = float(state.weights.sum())
    for candidate in set(range(n)) - larger:
        less, more = (value_of(state, chosen | {candidate}) - value_of(state, chosen) for chosen in (larger, smaller))
        assert less >= -1e-12 * scale
        assert more >= less - 1e-12 * scale


@given(made_states(), st.lists(st.integers(0, 7), max_size=6))
def test_gains_and_values_are_those_of_the_definition(state, steps):
    chosen: set[int] = set()
    scale = float(state.weights.sum())
    for step in steps:
        candidate = step % len(state.bounds)
        if candidate in chosen:
            add_or_remove(state, candidate, -1.0)
            chosen.remove(candidate)
        else:
            gain = gain_of(state, candidate)
            assert gain == pytest.approx(
                value_of(state, chosen | {candidate}) - value_of(state, chosen), rel=1e-6, abs=1e-9 * scale
            )
            add_or_remove(state, candidate, 1.0)
            chosen.add(candidate)
        assert error_taken(state) == pytest.approx(value_of(state, chosen), rel=1e-6, abs=1e-9 * scale)


@given(made_states(), st.integers(1, 5))
def test_lazy_greedy_chooses_what_looking_at_all_gains_each_time_does(state, n_wanted):
    expected: list[int] = []
    for _ in range(min(n_wanted, len(state.bounds))):
        gains = [
            -1.0 if each in expected else value_of(state, {*expected, each}) - value_of(state, set(expected))
            for each in range(len(state.bounds))
        ]
        if max(gains) <= 1e-9 * float(state.weights.sum()):
            break
        expected.append(int(np.argmax(gains)))
    chosen = choose_for_least_error(state, n_wanted, QUIET)[: len(expected)]
    scale = float(state.weights.sum())
    # Where gains are equal but for rounding, others may be chosen that take away as much.
    assert value_of(state, set(chosen.tolist())) == pytest.approx(
        value_of(state, set(expected)), rel=1e-5, abs=1e-8 * scale
    )


@given(made_states(), st.integers(1, 8))
def test_a_choice_that_is_stopped_is_one_among_the_largest_gains_at_first(state, n_wanted):
    at_first = state.bounds.copy()
    with mock.patch.multiple("planning.viewpoints.least_error", LEAST_LATE=1, LATE_EACH=1):
        chosen = choose_for_least_error(state, n_wanted, QUIET, StopAfter(0))
    assert len(set(chosen.tolist())) == len(chosen) <= n_wanted
    if len(chosen):
        assert at_first[chosen[0]] == pytest.approx(at_first.max())
    # No fewer are chosen than of all, of which some gain nothing beside others.
    least = NO_GAIN * float(state.weights.sum())
    gains = np.zeros(len(at_first))
    fill_gains(state, gains)
    others = np.setdiff1d(np.arange(len(at_first)), chosen)
    assert len(chosen) == n_wanted or (gains[others] <= least).all()
    assert error_taken(state) == pytest.approx(value_of(state, set(chosen.tolist())), rel=1e-6)


@pytest.mark.slow
def test_a_choice_that_is_stopped_at_once_is_nearly_as_good_as_one_with_time_enough():
    views, error = candidates("court", 3000), model("court")
    left_db = []
    for stop in (StopAfter(0), StopAfter(1000)):
        state = error_state(error, views)
        choose_for_least_error(state, 40, QUIET, stop)
        left_db.append(decibels(error.error_of(state.sums)))
    assert left_db[1] - 0.5 < left_db[0] <= left_db[1]


def test_a_choice_that_is_stopped_later_is_no_worse_and_one_with_time_enough_is_the_same(monkeypatch):
    for name, value in (("SLICE", 4), ("LEAST_LATE", 20), ("LATE_EACH", 1)):
        monkeypatch.setattr(f"planning.viewpoints.least_error.{name}", value)
    views, error, n_wanted = candidates(), model(), 20
    whole = choose_for_least_error(error_state(error, views), n_wanted, QUIET)
    left = []
    for n_asked in range(6):
        state = error_state(error, views)
        chosen = choose_for_least_error(state, n_wanted, QUIET, StopAfter(n_asked))
        assert len(set(chosen.tolist())) == n_wanted
        assert np.array_equal(chosen[: 4 * n_asked], whole[: 4 * n_asked])
        left.append(error.error_of(state.sums))
    assert max(left) == left[0] > left[-1] == min(left)
    assert np.array_equal(chosen, whole)


@pytest.mark.parametrize(("n_asked", "n_least", "n_blocks"), [(0, 0, 1), (2, 0, 3), (0, 25, 3), (1000, 0, None)])
def test_candidates_not_looked_at_in_time_are_left_out_and_the_others_are_as_ever(
    n_asked, n_least, n_blocks, monkeypatch
):
    monkeypatch.setattr("planning.viewpoints.least_error.VIEWS_PER_BLOCK", 10)
    views, error = candidates(), model()
    whole = error_state(error, views)
    some = error_state(error, views, stop=StopAfter(n_asked), n_least=n_least)
    n = len(whole.bounds) if n_blocks is None else 10 * n_blocks
    assert len(some.bounds) == n
    n_items = whole.starts[n]
    assert np.array_equal(some.starts, whole.starts[: n + 1])
    assert np.array_equal(some.items, whole.items[:n_items])
    assert np.array_equal(some.amounts, whole.amounts[:n_items])
    assert np.array_equal(some.bounds, whole.bounds[:n])


def test_greedy_is_within_its_own_bound_and_far_above_drawn_views():
    views, error = candidates(), model()
    state = error_state(error, views)
    chosen = choose_for_least_error(state, 10, QUIET)
    left = error.expected_error(take(views, chosen))
    assert left == pytest.approx(error.most_error - error_taken(state), rel=1e-6)
    fresh = error_state(error, views)
    assert error.floor <= max(least_error(fresh, error, 10), least_error(state, error, 10)) <= left
    rng = np.random.default_rng(0)
    drawn = [
        error.expected_error(take(views, rng.choice(len(views.heading_rad), 10, replace=False))) for _ in range(30)
    ]
    assert left < min(drawn)


@given(made_states(), st.integers(1, 3))
def test_no_choice_of_any_candidates_leaves_less_than_the_bound(state, n_wanted):
    everything = float(state.weights.sum())
    bounded = SimpleNamespace(most_error=everything, floor=0.0)
    at_first = least_error(state, bounded, n_wanted)
    choose_for_least_error(state, n_wanted, QUIET)
    bound = max(at_first, least_error(state, bounded, n_wanted))
    for chosen in itertools.combinations(range(len(state.bounds)), min(n_wanted, len(state.bounds))):
        assert everything - value_of(state, set(chosen)) >= bound - 1e-6 * everything


@pytest.mark.long
def test_a_plan_takes_no_photo_twice_and_as_many_as_were_asked_for():
    pool = candidate_pool(prepared().problem, 0, 300)
    assert len(np.unique(np.column_stack(pool.views), axis=0)) == len(pool.views.heading_rad)
    request = PlanRequest(n_views=40, greedy=GreedyParameters(n_candidates=300), time_budget_s=10.0)
    planned = plan_flight(prepared().site_model, request, prepared=prepared())
    assert len(planned.plan.viewpoints) == 40
    assert planned.plan.worth is not None
    assert planned.most_psnr_db is not None
    assert planned.plan.worth.batteries[-1].psnr_db <= planned.most_psnr_db + 1e-6
    by_share = plan_flight(prepared().site_model, PlanRequest(share=0.5, time_budget_s=5.0), prepared=prepared())
    assert by_share.most_psnr_db is None
    assert by_share.plan.worth is not None


def test_the_flight_goes_without_which_least_is_lost_by_what_views_were_chosen_for():
    views, error = take(candidates(), np.arange(6)), model()
    path = np.zeros((2, 3))
    flights = tuple(Flight(np.array(each), path, np.zeros(0, np.int64), 0.0) for each in ((0, 1), (2, 3), (4, 5)))
    kept = best_flights(prepared().problem.model, views, flights, 2, error=error)
    left = [
        error.expected_error(take(views, np.concatenate([f.views for f in flights if f is not gone])))
        for gone in flights
    ]
    assert flights[int(np.argmin(left))] not in kept


def test_more_photos_never_leave_more_error_and_none_leave_all_of_it():
    views, error = candidates(), model()
    errors = [error.expected_error(take(views, np.arange(n))) for n in (0, 1, 5, 50, 300)]
    assert errors[0] == pytest.approx(error.most_error)
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] > error.floor
    assert decibels(0.01) == pytest.approx(20.0)


@given(st.integers(0, 2**32 - 1))
def test_a_tilt_moves_what_is_mirrored_as_its_information_says(seed):
    """By turning the normal of a pane a little and mirroring anew; the mean of both its edges."""
    rng = np.random.default_rng(seed)
    normal, along = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
    edges, s = (along, np.cross(normal, along)), 1e-5
    incoming = rng.normal(size=3)
    incoming *= -np.sign(incoming @ normal) / np.linalg.norm(incoming)

    def mirrored(n):
        n = n / np.linalg.norm(n)
        return incoming - 2.0 * (incoming @ n) * n

    moved = [np.linalg.norm(mirrored(normal + s * edge) - mirrored(normal)) / s for edge in edges]
    here = mirrored(normal)
    rays = MirroredRays(
        1,
        1,
        *(np.zeros(1, np.int64),) * 2,
        np.zeros((1, 2)),
        np.zeros((1, 3)),
        np.ones(1),
        *(incoming[None], here[None], np.array([FAR_M / 4.0])),
    )
    assert _looks(TILT, rays)[0] == pytest.approx(np.mean(np.square(moved)) / 4.0 / 16.0, rel=1e-3, abs=1e-9)
    assert _looks(TILT, replace(rays, distances_m=np.array([np.inf])))[0] == 0.0, "sky tells nothing"


@pytest.mark.parametrize("name", ["single-panel", pytest.param("court", marks=pytest.mark.slow)])
@given(seed=st.integers(0, 2**32 - 1))
def test_with_tilts_of_panes_less_error_is_monotone_and_submodular_too(name, seed):
    (leaning, amounts), rng = with_tilts(name), np.random.default_rng(seed)
    larger = rng.permutation(len(amounts))[: rng.integers(2, 12)]
    smaller, more = larger[: len(larger) // 2], amounts[rng.integers(len(amounts))]
    few, many = (amounts[chosen].sum(axis=0) for chosen in (smaller, larger))
    least, less = (leaning.error_of(sums) - leaning.error_of(sums + more) for sums in (many, few))
    assert less >= least - 1e-15
    assert least >= 0.0
    assert leaning.error_of(many) <= leaning.error_of(few) <= leaning.most_error + 1e-15


@cache
def with_tilts(name):
    """Tilts alone, and what each of some views tells of them."""
    site, views = prepared(name).site_model, candidates(name, 40)
    surroundings = Surroundings(site, panel_frames(panel_corners(site.site)))
    leaning = ImageErrorModel(surroundings, profile("m3e").camera, (TILT,), [views])
    assert 0 < leaning.n_elements <= site.site.n_panels
    shown, amounts = leaning.shown(views), np.zeros((40, leaning.n_elements))
    np.add.at(amounts, (np.repeat(np.arange(40), np.diff(shown.starts)), shown.items), shown.amounts)
    return leaning, amounts


def test_amounts_in_single_precision_are_those_in_double():
    views, error = candidates(), model()
    shown = error.shown(views)
    sums = np.bincount(shown.items, shown.amounts.astype(np.float64), error.n_elements)
    rays = error.surroundings.rays(views, error.camera, 16, 12)
    looks = np.square(1.0 - rays.reflectances).sum() / (rays.n_pixels * error.terms[0].share)
    of_first = error.weights[: len(np.unique(rays.panels)) * error.terms[0].places ** 2]
    assert len(of_first)
    # Of the first term, every ray of a pane that unseen views show counts once.
    n_first = len(error._keys[0])
    assert sums[:n_first].sum() == pytest.approx(looks, rel=1e-5)


def test_views_stand_apart_and_locked_ones_are_not_shown_again():
    views, error = candidates(), model()
    everywhere = SpacingRule(views.positions_enu_m, np.zeros((0, 3)), 5.0)
    chosen = choose_for_least_error(error_state(error, views, spacing=everywhere), 12, QUIET)
    places = views.positions_enu_m[chosen]
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    assert apart[~np.eye(len(chosen), dtype=bool)].min() >= 5.0
    locked = take(views, chosen[:4])
    state = error_state(error, views, locked)
    assert error.most_error - error_taken(state) == pytest.approx(error.expected_error(locked), rel=1e-6)


def test_the_gain_of_the_routing_falls_and_rises_with_the_set():
    gain = ErrorGain(error_state(model(), candidates()))
    first = gain.marginals().copy()
    gain.add(0)
    with_it = gain.marginals().copy()
    assert (with_it <= first + 1e-15).all()
    gain.remove(0)
    assert gain.value == pytest.approx(0.0, abs=1e-12)
    assert np.allclose(gain.marginals(), first, rtol=1e-5, atol=1e-12)


def test_panes_mirror_as_two_sheets_of_glass_do():
    # 1 - (1 - r)^2 / (1 - r^2), twice, with r = ((n - 1) / (n + 1))^2 at normal incidence.
    r = (0.52 / 2.52) ** 2
    clear = Glass(index=1.52, tint=(1.0, 1.0, 1.0), sheets=2)
    assert pane_reflectance(np.array([1.0]))[0] == pytest.approx(4.0 * r / (1.0 + 3.0 * r))
    cosines = np.linspace(0.02, 1.0, 50)
    found = pane_reflectance(cosines)
    first, behind, _ = pane_light(cosines, clear)
    assert np.allclose(found[:, None], first + behind, rtol=1e-9)
    assert (np.diff(found) <= 1e-12).all()
    assert found[0] > 0.9


@pytest.mark.long
@pytest.mark.parametrize(("site", "is_on"), [("single-panel", True), ("roof", False)])
def test_places_of_what_is_mirrored_count_where_panes_mirror_something_near(site, is_on):
    found, decision = image_error_model(prepared(site).problem, prepared(site).site_model)
    assert decision.on == is_on
    assert (decision.size > decision.tolerance) == is_on
    other, by_user = image_error_model(prepared(site).problem, prepared(site).site_model, "off" if is_on else "on")
    assert (by_user.on, by_user.decided_by) == (not is_on, "user")
    # Directions have other elements than places; where there are no places, they are the same.
    assert (other.n_elements != found.n_elements) == is_on


def test_a_pane_that_mirrors_sky_alone_calls_for_no_places():
    site = SCENES["single-panel"]()
    frames = panel_frames(panel_corners(site.site))
    far = Surroundings(site, frames, is_near=False)
    rays = far.rays(candidates(), profile("m3e").camera, 16, 12)
    assert len(rays)
    assert np.isinf(rays.distances_m).all()
    near = Surroundings(site, frames).rays(candidates(), profile("m3e").camera, 16, 12)
    assert np.isfinite(near.distances_m).any()
    assert np.allclose(np.linalg.norm(near.mirrored_enu, axis=1), 1.0)
    normals = frames.normals[near.panels]
    assert np.allclose(
        np.einsum("nk,nk->n", near.mirrored_enu, normals), -np.einsum("nk,nk->n", near.incoming_enu, normals)
    )


def test_walkers_stand_on_the_ground_before_the_facade_and_see_their_panel():
    ready = prepared()
    views = walk_views(ready.problem, ready.site_model, 20, np.random.default_rng(0))
    assert len(views.heading_rad) == 20
    ground = ready.site_model.site.airspace.ground_z_m
    assert np.allclose(views.positions_enu_m[:, 2], ground + 1.7)
    assert (ready.problem.space.solids.clearance_m(views.positions_enu_m) > 0.8).all()
    drawn = random_views(ready.problem, 20, np.random.default_rng(0))
    assert ready.problem.flyable(drawn.positions_enu_m).all()


@pytest.mark.long
def test_a_plan_says_what_it_is_worth_and_a_changed_one_does_not(tmp_path):
    request = PlanRequest(n_views=12, greedy=GreedyParameters(n_candidates=300, certify=False), time_budget_s=10.0)
    planned = plan_flight(prepared().site_model, request, prepared=prepared())
    worth = planned.plan.present_worth
    assert worth is not None
    assert [battery.n_photos for battery in worth.batteries] == [12]
    assert worth.gain_db > 0.0
    assert "another battery would bring" in worth.text
    read = plan_of(json.dumps(plan_to_json(planned.plan)).encode(), tmp_path / "plan.json")
    assert read.present_worth == worth
    first, *others = read.viewpoints
    away = replace(first, heading_deg=(first.heading_deg + 180.0) % 360.0)
    assert replace(read, viewpoints=(away, *others)).present_worth is None
    assert replace(read, viewpoints=tuple(reversed(read.viewpoints))).present_worth == worth
    sortie = planned.plan.sorties[0]
    fewer = replace(planned.plan, sorties=(replace(sortie, viewpoint_ids=sortie.viewpoint_ids[1:]),))
    assert fewer.present_worth is None
    by_sections = plan_flight(
        prepared().site_model,
        replace(request, greedy=replace(request.greedy, objective="sections")),
        prepared=prepared(),
    )
    assert by_sections.plan.coverage.covered >= planned.plan.coverage.covered
    other = flight_worth(prepared().problem, model(), by_sections.plan)
    assert other is not None
    assert other.batteries[-1].psnr_db < worth.batteries[-1].psnr_db


@pytest.mark.long
def test_good_enough_takes_fewer_batteries_the_more_each_has_to_bring():
    request = PlanRequest(greedy=GreedyParameters(n_candidates=300, certify=False), time_budget_s=3.0)
    sorties = [
        len(plan_flight(prepared().site_model, replace(request, least_gain_db=gain), prepared=prepared()).plan.sorties)
        for gain in (50.0, 0.05)
    ]
    assert sorties[0] == 1
    assert sorties == sorted(sorties)


def test_without_a_goal_the_objective_says_when_it_is_enough():
    model, paper = PlanRequest(), PlanRequest(greedy=GreedyParameters(objective="sections"))
    assert (model.is_as_many_as_sections, model.wanted_share, model.is_for_least_error) == (True, None, True)
    assert (paper.is_as_many_as_sections, paper.wanted_share, paper.is_for_least_error) == (False, DEFAULT_SHARE, False)
    assert not PlanRequest(share=0.5).is_for_least_error
    for other in (replace(model, n_views=9), replace(model, n_batteries=1), replace(model, method="orbit")):
        assert (other.is_as_many_as_sections, other.wanted_share) == (False, None)


@pytest.mark.long
@pytest.mark.parametrize("name", ["single-panel", "roof"])
def test_without_a_goal_there_are_about_as_many_views_as_sections_need_and_the_model_gains_by_them(name):
    few = GreedyParameters(n_candidates=1000, certify=False)
    model = plan_flight(SCENES[name](), PlanRequest(greedy=few, time_budget_s=20.0)).plan
    paper = plan_flight(SCENES[name](), PlanRequest(greedy=replace(few, objective="sections"), time_budget_s=20.0)).plan
    assert 0.7 * len(paper.viewpoints) <= len(model.viewpoints) <= 1.5 * len(paper.viewpoints)
    assert paper.coverage.covered >= model.coverage.covered
    assert model.worth.batteries[-1].psnr_db > paper.worth.batteries[-1].psnr_db


@pytest.mark.parametrize("name", ["single-panel", pytest.param("court", marks=pytest.mark.slow)])
def test_a_model_after_photos_tells_of_further_ones_what_the_model_of_all_tells(name):
    views = candidates(name)
    photos, more = take(views, np.arange(20)), take(views, np.arange(20, 60))
    after = model(name).after(photos)
    assert after.most_error == pytest.approx(model(name).expected_error(photos), rel=1e-9)
    assert after.expected_error(more) == pytest.approx(model(name).expected_error(take(views, np.arange(60))), rel=1e-5)
    # Choosing after photos is choosing beside locked views.
    beside = choose_for_least_error(error_state(model(name), views, photos), 5, QUIET)
    assert np.array_equal(choose_for_least_error(error_state(after, views), 5, QUIET), beside)
    # A second look back is another flight still: the order of flights does not matter.
    both = after.after(more)
    assert both.most_error == pytest.approx(model(name).after(more).after(photos).most_error, rel=1e-5)


@pytest.mark.long
def test_photos_that_are_there_count_in_the_worth_of_a_plan():
    request = PlanRequest(n_views=6, time_budget_s=30.0)
    site_model, ready = SCENES["single-panel"](), prepared()
    photos = take(candidates(), np.arange(40))
    first = plan_flight(site_model, request, prepared=ready).plan.worth
    second = plan_flight(site_model, request, prepared=ready, photos=photos).plan.worth
    assert second.batteries[0].psnr_db > first.batteries[0].psnr_db
    assert second.gain_db < first.gain_db


@pytest.mark.long
@pytest.mark.parametrize(("name", "deviation_db"), [("canyon", DEVIATION_DB), ("roof", FAR_DEVIATION_DB)])
def test_what_is_expected_errs_more_where_panes_mirror_little_that_is_near(name, deviation_db):
    request = PlanRequest(n_views=6, greedy=GreedyParameters(n_candidates=300, certify=False), time_budget_s=10.0)
    worth = plan_flight(SCENES[name](), request).plan.worth
    assert worth is not None
    assert worth.deviation_db == deviation_db


def test_the_less_near_is_mirrored_the_better_models_are_expected_to_be():
    shares = np.linspace(0.0, 1.0, 101)
    found = np.array([expected_psnr_db(0.001, float(share)) for share in shares])
    assert (np.diff(found) <= 0.0).all()
    assert np.abs(np.diff(found)).max() < 0.2
    assert found[0] - found[-1] == pytest.approx(FAR_DB)
    # What a flight gains is told alike everywhere.
    gain = expected_psnr_db(0.001, 0.1) - expected_psnr_db(0.002, 0.1)
    assert gain == pytest.approx(expected_psnr_db(0.001, 0.9) - expected_psnr_db(0.002, 0.9))
