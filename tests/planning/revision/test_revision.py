"""A revision after any edits is what measuring and checking its plan from scratch gives; what it came from stays."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.checks import case as measures
from planning.checks.case import legs_of
from planning.coverage.evaluate import sights
from planning.coverage.positions import aimed_views, spread_positions
from planning.motion.speed_profile import fastest_profile
from planning.motion.timing import flight_path, motion_limits, stopping_times_s
from planning.parameters import FlightRules
from planning.plan import Plan, viewpoint_arrays
from planning.revision.edits import Revision, delete, lock, move, revise
from planning.routing.rally import SAMPLE_M
from tests.planning.revision.cases import SETTINGS, Edit, assert_is_as_from_scratch, edits, planned, prepared
from tests.slow import slow

OURS = ("sorties", "path", "length", "duration", "coverage")
"""Rules about what the plan says of itself: an edit leaves them kept."""


def assert_states_the_truth(revision: Revision) -> None:
    kept = {found.code: found for found in revision.findings if found.code in OURS and found.severity != "ok"}
    nothing_covered = {"coverage"} if not revision.counts.any() else set()
    nothing_flown = {"sorties"} if not revision.plan.viewpoints else set()
    assert set(kept) == nothing_covered | nothing_flown


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [slow(name) if name in ("canyon", "short sorties") else name for name in sorted(SETTINGS)]
)
def test_any_edits_leave_what_a_revision_from_scratch_gives(name: str) -> None:
    @settings(max_examples=15)
    @given(st.lists(edits(), min_size=1, max_size=5))
    def edited(steps: list[Edit]) -> None:
        revision = planned(name)
        for step in steps:
            before, plan = revision, revision.plan
            revision = step(before)
            assert before.plan is plan
            assert_states_the_truth(revision)
        assert_is_as_from_scratch(revision)
        assert_is_as_from_scratch(planned(name))

    edited()


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_going_to_any_other_plan_gives_what_taking_it_in_hand_anew_gives(name: str) -> None:
    start = planned(name)
    one = move(start, start.plan.viewpoints[2].id, (5.0, -14.0, 9.0))
    other = delete(start, [start.plan.viewpoints[0].id])
    back = revise(start.plan, start.prepared, other)
    assert back.findings == start.findings
    across = revise(one.plan, start.prepared, other)
    assert across.findings == one.findings == revise(one.plan, start.prepared).findings
    np.testing.assert_array_equal(across.counts, one.counts)
    assert across.plan is one.plan


@pytest.mark.parametrize("turn", [{"heading_deg": 25.0}, {"gimbal_pitch_deg": -35.0}])
def test_a_turn_by_one_angle_alone_is_seen(turn: dict[str, float]) -> None:
    start, durations_s = planned("kiosk"), set()
    for viewpoint in start.plan.viewpoints:
        after = move(start, viewpoint.id, **turn)
        assert_is_as_from_scratch(after)
        # Heading and gimbal turn at a time: the shorter of both turns takes no time of its own.
        durations_s.add(after.plan.sorties[0].duration_s)
    assert len(durations_s) > len(start.plan.viewpoints) // 2
    assert any(move(start, v.id, **turn).counts.sum() != start.counts.sum() for v in start.plan.viewpoints)


def test_only_what_changed_is_measured_again(monkeypatch: pytest.MonkeyPatch) -> None:
    start = planned("kiosk")
    asked: dict[str, int] = {"views": 0, "glass": 0, "legs": 0, "ways home": 0}

    def counting(model, viewpoints):  # type: ignore[no-untyped-def]
        asked["views"] += len(viewpoints)
        return sights(model, viewpoints)

    glass_m = measures._glass_m

    def counting_glass(model, by_pose, seen, poses):  # type: ignore[no-untyped-def]
        asked["glass"] += len(poses)
        return glass_m(model, by_pose, seen, poses)

    segments = type(start.case.space.solids).segment_distances_m

    def counting_legs(solids, a, b, *upper):  # type: ignore[no-untyped-def]
        if solids is start.case.space.solids:
            asked["ways home" if upper else "legs"] += len(a)
        return segments(solids, a, b, *upper)

    monkeypatch.setattr(measures, "sights", counting)
    monkeypatch.setattr(measures, "_glass_m", counting_glass)
    monkeypatch.setattr(type(start.case.space.solids), "segment_distances_m", counting_legs)
    chosen = max(start.plan.viewpoints, key=lambda viewpoint: viewpoint.position_enu_m[2])  # seen from all others
    x, y, z = chosen.position_enu_m
    moved = move(start, chosen.id, (x, y, z - 0.5))
    assert asked["views"] == asked["glass"] == 1
    assert 2 <= asked["legs"] <= 8
    legs = {leg for sortie in moved.plan.sorties for leg in legs_of(sortie)} - set(start.case.measures.return_routes)
    n_places = sum(1 + max(1, math.ceil(math.dist(*leg) / SAMPLE_M)) for leg in legs)
    assert asked["ways home"] == 3 * n_places
    others = [viewpoint for viewpoint in start.plan.viewpoints if viewpoint is not chosen]
    for viewpoint in others:
        assert moved.elements_of_pose(viewpoint) is start.elements_of_pose(viewpoint)
    asked.update(dict.fromkeys(asked, 0))
    lock(moved, [chosen.id])
    revise(start.plan, start.prepared, start)
    assert not any(asked.values())


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("name", sorted(SETTINGS))
def test_what_a_view_sees_does_not_depend_on_the_views_asked_for_with_it(name: str) -> None:
    model, space = prepared(name).problem.model, prepared(name).problem.space
    rng = np.random.default_rng(5)
    places = spread_positions(space, model.frames, 200, rng)
    views = aimed_views(places, model.frames.centroids[rng.integers(0, len(model.frames), len(places))], model.camera)
    viewpoints = [
        replace(
            planned(name).plan.viewpoints[0], position_enu_m=tuple(place), heading_deg=heading, gimbal_pitch_deg=pitch
        )
        for place, heading, pitch in zip(places.tolist(), np.degrees(views[1]), np.degrees(views[2]), strict=True)
    ]
    together = sights(model, viewpoints)
    assert len(viewpoint_arrays(tuple(viewpoints)).heading_rad) > 100
    for viewpoint, sight in zip(viewpoints, together, strict=True):
        (alone,) = sights(model, [viewpoint])
        np.testing.assert_array_equal(alone.elements, sight.elements)
        assert (alone.nearest_m, alone.furthest_m) == (sight.nearest_m, sight.furthest_m)


def test_a_site_prepared_for_something_else_is_refused() -> None:
    start = planned("kiosk")
    other_camera = replace(start.plan, camera=replace(start.plan.camera, focal_length_mm=24.0))
    with pytest.raises(ValueError, match="is for the camera"):
        revise(other_camera, start.prepared)
    for changes in ({"min_distance_m": 6.0}, {"occlusion": "off"}):
        other = replace(start.plan, constraints=replace(start.plan.constraints, **changes))  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="is for Constraints"):
            revise(other, start.prepared)
    auto = replace(start.plan, constraints=replace(start.plan.constraints, occlusion="auto"))
    assert revise(auto, start.prepared).findings == start.findings


def test_a_plan_with_another_aircraft_is_measured_anew() -> None:
    start = planned("kiosk")
    slow: Plan = replace(start.plan, rules=FlightRules(max_speed_m_s=1.0))
    assert revise(slow, start.prepared, start).findings == revise(slow, start.prepared).findings
    assert revise(slow, start.prepared, start).findings != start.findings


@pytest.mark.long
def test_corner_stretches_are_all_that_differs_between_stopping_and_flying_through() -> None:
    plan = planned("canyon").plan
    limits = motion_limits(plan.aircraft, plan.rules)
    rng = np.random.default_rng(0)
    path = np.cumsum(rng.normal(size=(40, 3)) * 8.0, axis=0)
    photos = np.array([3, 4, 5, 9, 20, 21, 33])
    views = viewpoint_arrays(plan.viewpoints[: len(photos)])
    whole = flight_path(
        path, photos, views.heading_rad, views.pitch_rad, plan.aircraft, plan.rules, stop_at_corners=False
    )
    part = measures.corner_stretches(whole)
    assert len(part.is_stop) == 1 + 39 - 3, "three legs run from stop to stop"

    def saving_s(flown):  # type: ignore[no-untyped-def]
        stopping_s = stopping_times_s(flown, limits)[-1] + flown.hover_s[-1]
        return stopping_s - fastest_profile(flown, limits, solver="sweep").duration_s

    assert saving_s(part) == pytest.approx(saving_s(whole), abs=1e-9)
    assert saving_s(part) > 5.0
