"""Starts of sorties by the sun: stairs against slow counts, orders against all orders."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.geo.sun import is_within
from planning.insight.sun_times import (
    START_STEP_S,
    WATCH_S,
    SortieSun,
    flight_times,
    flown_from,
    sorties_in_sun,
)
from planning.insight.sunlight import BLINDING_RAD, EYE_M, SunDay, SunSite, sun_day
from planning.parameters import Constraints
from planning.plan import Coverage, Plan, Sortie
from tests.planning.insight.sun_cases import CAMERA, aimed, day_of, wall

MODEL = wall(n=3, size_m=6.0)
DAY = sun_day(SunSite(MODEL), day_of(MODEL))
(UP,) = DAY.track.up


def sortie_of(bad, taken_s, duration_s=600.0, number=1):
    """A sortie whose photos, taken at seconds, have bad spans."""
    spans = tuple(np.array(each, float).reshape(-1, 2) for each in bad)
    none = tuple(np.zeros((0, 2)) for _ in spans)
    ids = tuple(f"s{number}-{n}" for n in range(len(spans)))
    return SortieSun((number,), duration_s, ids, np.array(taken_s, float), spans, none, np.zeros(0), ())


bad_spans = st.lists(
    st.tuples(st.integers(int(UP[0]), int(UP[1])), st.integers(60, 20_000)).map(lambda s: [[s[0], s[0] + s[1]]]),
    min_size=1,
    max_size=4,
)


@given(bad_spans, st.integers(0, 2**32 - 1))
def test_a_stair_is_what_counting_at_each_start_gives(bad, seed):
    rng = np.random.default_rng(seed)
    sortie = sortie_of(bad, rng.uniform(0.0, 600.0, len(bad)))
    steps, losses = sortie.stair(np.array([UP]))
    assert steps[0, 0] == UP[0]
    assert steps[-1, 1] == UP[1]
    np.testing.assert_array_equal(steps[1:, 0], steps[:-1, 1])
    for start in rng.uniform(*UP, 20):
        slow = sum(spans[0][0] <= start + at <= spans[0][1] for spans, at in zip(bad, sortie.taken_s, strict=True))
        step = np.flatnonzero((steps[:, 0] <= start) & (start <= steps[:, 1]))
        assert slow in losses[step]


@given(st.lists(bad_spans, min_size=1, max_size=3))
def test_chosen_starts_lose_no_less_than_the_bound_and_fly_one_after_the_other(parts):
    sorties = [sortie_of(bad, np.linspace(30.0, 570.0, len(bad)), number=n + 1) for n, bad in enumerate(parts)]
    found = flight_times(sorties, DAY, pause_s=300.0)
    assert all(times.start_s is not None for times in found.sorties)
    assert found.loss >= found.bound - 1e-9
    starts = sorted(times.start_s for times in found.sorties)
    assert all(later - sooner >= 900.0 for sooner, later in itertools.pairwise(starts))
    for times in found.sorties:
        assert UP[0] <= times.start_s <= UP[1] - 600.0
        assert times.loss == times.sortie.losses(np.array([times.start_s]))[0]
        ((first, last),) = times.window
        inside = np.linspace(first + 0.1, last - 0.1, 20)
        assert first <= times.start_s <= last
        assert (times.sortie.losses(inside) <= times.loss + 1e-9).all()
        for first, last in times.best:
            assert times.sortie.losses(np.array([0.5 * (first + last)]))[0] == pytest.approx(times.least)


@settings(max_examples=4)
@given(st.integers(0, 2**32 - 1))
def test_where_sorties_compete_no_order_on_the_grid_loses_less(seed):
    rng = np.random.default_rng(seed)
    within = np.array([[43_200.0, 43_200.0 + 5400.0]])
    sorties = []
    for number in range(1, 4):
        first = 43_200.0 + rng.uniform(0.0, 5400.0, 6)
        bad = [[[t, t + rng.uniform(300.0, 3000.0)]] for t in first]
        sorties.append(sortie_of(bad, rng.uniform(0.0, 600.0, 6), number=number))
    found = flight_times(sorties, DAY, within, pause_s=240.0)
    slots = np.arange(43_200.0, 43_200.0 + 4801.0, START_STEP_S)
    losses = [sortie.losses(slots) for sortie in sorties]
    n = math.ceil(840.0 / START_STEP_S)
    best = min(
        sum(losses[which][slot] for which, slot in zip(order, picked, strict=True))
        for order in itertools.permutations(range(3))
        for picked in itertools.combinations(range(len(slots)), 3)
        if picked[1] - picked[0] >= n and picked[2] - picked[1] >= n
    )
    # Between equals the one that bears a delay is taken; that counts less than a photo.
    assert found.loss <= best + 1.0
    assert found.loss >= found.bound - 1e-9


def test_a_sortie_that_has_no_room_in_the_day_is_said_so():
    sorties = [sortie_of([[[0.0, 1.0]]], [10.0], duration_s=3000.0, number=n) for n in (1, 2)]
    found = flight_times(sorties, DAY, np.array([[40_000.0, 44_000.0]]))
    assert [times.start_s is None for times in found.sorties] == [False, True]
    assert not found.is_best
    dark = wall(80.0)
    night = sun_day(SunSite(dark), day_of(dark, "2026-12-21"))
    assert [times.start_s for times in flight_times(sorties, night).sorties] == [None, None]


def test_of_equal_starts_the_one_is_taken_that_bears_delay():
    free = (UP[0] + 20_000.0, UP[0] + 26_000.0)
    brief = (UP[0] + 2000.0, UP[0] + 2400.0)
    bad = [[UP[0], brief[0]], [brief[1], free[0]], [free[1], UP[1]]]
    (times,) = flight_times([sortie_of([bad], [0.0])], DAY).sorties
    assert free[0] + 800.0 < times.start_s < free[1] - 800.0
    assert times.loss == 0.0


# Of plans


def hovering(model, place, views=()):
    """A plan whose aircraft goes to a place and back, with photos there."""
    home = model.site.home_enu_m
    top = (home[0], home[1], 12.0)
    path = (home, top, tuple(map(float, place)), top, home)
    sortie = Sortie(tuple(view.id for view in views), path, 100.0, 240.0)
    return Plan(
        *("wall", "", "by-hand", 0, CAMERA, profile("m3e").aircraft, Constraints(), tuple(views), (sortie,)),
        Coverage(0, 0, 0),
        home_enu_m=home,
    )


def test_a_pilot_is_blinded_while_the_aircraft_is_before_the_sun_and_not_else():
    track = day_of(MODEL)
    site = SunSite(MODEL)
    eye = np.array(MODEL.site.home_enu_m) + np.array([0.0, 0.0, EYE_M])
    at = UP[0] + 3.0 * 3600.0
    place = eye + 60.0 * track.directions_enu(at)
    view = aimed("v0", place, -place)
    plan = hovering(MODEL, place, (view,))
    day = sun_day(site, track, plan.viewpoints, CAMERA)
    (sortie,) = sorties_in_sun(site, day, plan)
    there = float(sortie.taken_s[0])
    assert sortie.spoiled(np.array([at - there])).blinded_s[0] >= WATCH_S
    assert sortie.spoiled(np.array([at + 3.0 * 3600.0])).blinded_s[0] == 0.0
    # The cone is 20 degrees wide: the sun crosses it within 80 minutes or so.
    hovers = int(np.argmin(np.abs(sortie.watched_s - there)))
    ((first, last),) = sortie.blinded[hovers]
    sun = [track.directions_enu(t) for t in (first, last)]
    moment = np.interp(sortie.watched_s[hovers], [0.0, there], [0.0, 1.0])
    if moment > 0.98:
        angles = [math.acos(min(1.0, s @ (place - eye) / np.linalg.norm(place - eye))) for s in sun]
        assert angles == pytest.approx([BLINDING_RAD, BLINDING_RAD], abs=0.05)


def test_photos_of_a_flight_are_judged_when_they_are_taken_and_sorties_follow_each_other():
    track, site = day_of(MODEL), SunSite(MODEL)
    view = aimed("v0", (0.0, -20.0, 10.0), (0.0, 1.0, 0.0))
    twice = replace(view, id="v1")
    plan = hovering(MODEL, view.position_enu_m, (view,))
    second = replace(plan.sorties[0], viewpoint_ids=("v1",))
    plan = replace(plan, viewpoints=(view, twice), sorties=(plan.sorties[0], second))
    day = sun_day(site, track, plan.viewpoints, CAMERA)
    sorties = sorties_in_sun(site, day, plan)
    at = float(sorties[0].taken_s[0])
    assert 0.0 < at < 240.0
    shown = np.array([[UP[0] + 7200.0, UP[0] + 7260.0]])
    views = {name: replace(each, mirrored=shown) for name, each in day.views.items()}
    shown_day = SunDay(track, day.facades, views, day.shadows, day.tilts)
    for start, expected in ((7230.0 - at, ("v0",)), (7230.0 - at - 540.0, ("v1",)), (6000.0 - at, ())):
        found = flown_from(sorties, shown_day, UP[0] + start, pause_s=300.0)
        assert found.mirrored == expected
        assert found.landed_in_light
    assert not flown_from(sorties, day, UP[1] - 60.0).landed_in_light


def test_aircraft_that_fly_at_once_start_together():
    track, site = day_of(MODEL), SunSite(MODEL)
    view = aimed("v0", (0.0, -20.0, 10.0), (0.0, 1.0, 0.0))
    plan = hovering(MODEL, view.position_enu_m, (view, replace(view, id="v1")))
    sortie = plan.sorties[0]
    both = tuple(
        replace(sortie, viewpoint_ids=(name,), start_s=start, aircraft=n)
        for name, start, n in (("v0", 0.0, 1), ("v1", 100.0, 2))
    )
    plan = replace(plan, sorties=both)
    day = sun_day(site, track, plan.viewpoints, CAMERA)
    (found,) = sorties_in_sun(site, day, plan)
    assert found.numbers == (1, 2)
    assert found.duration_s == 340.0
    assert found.taken_s[1] - found.taken_s[0] == pytest.approx(100.0)
    (times,) = flight_times((found,), day).sorties
    assert is_within(track.up, times.start_s)


def test_photos_of_a_plan_without_sorties_are_taken_as_it_starts():
    view = aimed("v0", (0.0, -20.0, 10.0), (0.0, 1.0, 0.0))
    plan = replace(hovering(MODEL, view.position_enu_m, (view,)), sorties=())
    site = SunSite(MODEL)
    day = sun_day(site, day_of(MODEL), plan.viewpoints, CAMERA)
    (found,) = sorties_in_sun(site, day, plan)
    assert (found.numbers, found.taken_s.tolist()) == ((), [0.0])
