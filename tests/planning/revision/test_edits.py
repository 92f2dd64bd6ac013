"""Single edits: what they do to viewpoints, route and figures, what findings they leave, and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.coverage.evaluate import coverage
from planning.coverage.sections import in_picture
from planning.motion.timing import sortie_flight_path, stopping_duration_s
from planning.parameters import FlightRules
from planning.plan import Plan, Sortie, Viewpoint, plan_to_json, viewpoint_arrays
from planning.revision.edits import Revision, add, aim_at, delete, lock, move, next_id, revise, unlock, with_other_stops
from planning.routing.roadmap import build_roadmap
from planning.site.free_space import free_space
from planning.viewpoints.prepare import prepare
from tests.planning.revision.cases import NEAR, assert_is_as_from_scratch, errors, planned
from tests.planning.routing.test_legs import room

HOME = (0.0, -30.0, 0.0)


def first(revision: Revision) -> Viewpoint:
    return revision.plan.viewpoints[0]


def total_s(revision: Revision) -> float:
    return revision.plan.duration_s


@pytest.mark.slow
def test_a_moved_viewpoint_is_where_it_should_be_and_everything_else_where_it_was() -> None:
    before = planned("kiosk")
    after = move(before, "v0003", (5.00004, -14.0, 9.0), 400.0, -20.00049)
    assert after.viewpoint("v0003") == Viewpoint("v0003", (5.0, -14.0, 9.0), 40.0, -20.0)
    assert [v for v in after.plan.viewpoints if v.id != "v0003"] == [
        v for v in before.plan.viewpoints if v.id != "v0003"
    ]
    assert [v.id for v in after.plan.viewpoints] == [v.id for v in before.plan.viewpoints]
    assert [sortie.viewpoint_ids for sortie in after.plan.sorties] == [s.viewpoint_ids for s in before.plan.sorties]
    assert (5.0, -14.0, 9.0) in after.plan.sorties[0].path_enu_m
    assert not errors(after)
    assert after.counts.sum() != before.counts.sum()


@pytest.mark.slow
def test_legs_elsewhere_are_not_drawn_anew() -> None:
    before = planned("kiosk")
    ids = before.plan.sorties[0].viewpoint_ids
    after = move(before, ids[3], (5.0, -14.0, 9.0))
    old, new = before.plan.sorties[0].path_enu_m, after.plan.sorties[0].path_enu_m
    until = old.index(before.viewpoint(ids[2]).position_enu_m)
    assert new[: until + 1] == old[: until + 1]
    rest = len(old) - old.index(before.viewpoint(ids[4]).position_enu_m)
    assert new[-rest:] == old[-rest:]
    turned = move(before, ids[3], heading_deg=7.0)
    assert turned.plan.sorties[0].path_enu_m == old
    assert turned.plan.sorties[0].duration_s != before.plan.sorties[0].duration_s


@pytest.mark.long
def test_a_viewpoint_behind_the_building_is_flown_around_it() -> None:
    after = move(planned("kiosk"), "v0003", (0.0, 16.0, 6.0), 180.0, 0.0)
    assert not errors(after)
    assert len(after.plan.sorties[0].path_enu_m) > len(planned("kiosk").plan.sorties[0].path_enu_m)
    assert min(after.leg_clearances_m(after.plan.sorties[0])) >= 5.0


@pytest.mark.parametrize(
    ("position", "code", "named"),
    [
        ((0.0, -2.0, 5.0), "distance", "v0003"),
        ((0.0, 4.0, 4.0), "distance", "v0003"),
        ((0.0, -20.0, 60.0), "airspace", "v0003"),
        ((0.0, -20.0, 1.0), "airspace", "v0003"),
        ((900.0, -20.0, 20.0), "airspace", "v0003"),
        ((-30.0, 0.0, 12.0), "no-fly", "sortie 1, leg"),
    ],
)
def test_a_forbidden_place_is_taken_and_named_as_an_error_and_its_legs_are_straight(
    position: tuple[float, float, float], code: str, named: str
) -> None:
    after = move(planned("kiosk"), "v0003", position)
    assert after.viewpoint("v0003").position_enu_m == position
    found = [f for f in after.findings if f.severity is Severity.ERROR and f.code == code]
    assert any(f.place.startswith(named) for f in found)
    path = after.plan.sorties[0].path_enu_m
    ids = after.plan.sorties[0].viewpoint_ids
    at, here = path.index(position), ids.index("v0003")
    for neighbour, step in ((here - 1, -1), (here + 1, 1)):
        assert path[at + step] == after.viewpoint(ids[neighbour]).position_enu_m
    back = move(after, "v0003", planned("kiosk").viewpoint("v0003").position_enu_m)
    assert not errors(back)
    assert_is_as_from_scratch(after)


def test_a_place_without_any_way_to_it_is_told_as_a_leg_that_comes_too_close() -> None:
    site = room()
    space = free_space(site, 5.0)
    assert space.is_allowed(np.array([[35.0, 35.0, 16.0]])).all()
    assert not build_roadmap(space).connected_to_home(np.array([[35.0, 35.0, 16.0]])).any()
    ready = prepare(site, planned("kiosk").plan.camera, NEAR, max_positions=512, max_cells=10)
    plan = replace(
        planned("kiosk").plan, site="block", constraints=ready.constraints, viewpoints=(), sorties=(), site_sha256=""
    )
    one = add(revise(plan, ready), (0.0, -25.0, 15.0), 0.0, 0.0)
    assert not errors(one)
    hall = add(one, (35.0, 35.0, 16.0), 0.0, 0.0)
    assert errors(hall)["leg-distance"].value == 0.0
    assert_is_as_from_scratch(hall)


def test_headings_are_wrapped_and_pitches_beyond_the_gimbal_are_an_error() -> None:
    start = planned("kiosk")
    for heading, wrapped in [
        (180.0, 180.0),
        (-180.0, 180.0),
        (540.0, 180.0),
        (-179.9999, 180.0),
        (360.0, 0.0),
        (1e6, -80.0),
    ]:
        assert move(start, "v0001", heading_deg=heading).viewpoint("v0001").heading_deg == wrapped
    for pitch, is_error in [(35.0, False), (35.0004, False), (35.001, True), (-90.0, False), (-90.001, True)]:
        turned = move(start, "v0001", gimbal_pitch_deg=pitch)
        assert ("gimbal" in errors(turned)) is is_error
        if is_error:
            assert errors(turned)["gimbal"].place == "v0001"


@pytest.mark.parametrize(
    "changes",
    [
        {"position_enu_m": (math.nan, 0.0, 0.0)},
        {"position_enu_m": (1e9, 0.0, 0.0)},
        {"heading_deg": math.inf},
        {"heading_deg": math.nan},
        {"gimbal_pitch_deg": 91.0},
        {"gimbal_pitch_deg": math.nan},
    ],
)
def test_poses_that_are_none_are_refused(changes: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"position_enu_m|heading_deg|gimbal_pitch_deg"):
        move(planned("kiosk"), "v0001", **changes)  # type: ignore[arg-type]


def test_unknown_names_are_refused() -> None:
    start = planned("kiosk")
    for edit in (lambda: move(start, "x"), lambda: delete(start, ["v0001", "x"]), lambda: lock(start, ["x"])):
        with pytest.raises(ValueError, match="there is no viewpoint 'x'"):
            edit()
    with pytest.raises(ValueError, match="there is no panel 'x'"):
        aim_at(start, (0.0, -20.0, 5.0), "x")


def test_locked_viewpoints_stay_until_they_are_unlocked() -> None:
    start = planned("kiosk")
    locked = lock(start, ["v0001", "v0002"])
    assert [v.id for v in locked.plan.viewpoints if v.locked] == ["v0001", "v0002"]
    assert locked.findings == start.findings
    assert locked.plan.sorties == start.plan.sorties
    with pytest.raises(InputError, match="'v0001' is locked and stays as it is; unlock it before it is moved"):
        move(locked, "v0001", heading_deg=3.0)
    with pytest.raises(InputError, match=r"'v0002' is locked .* deleted"):
        delete(locked, ["v0000", "v0002"])
    assert not errors(delete(locked, ["v0000"]))
    again = unlock(locked, ["v0001", "v0002"])
    assert again.plan == start.plan
    assert "'locked':" not in str(plan_to_json(again.plan))
    assert str(plan_to_json(locked.plan)).count("'locked': True") == 2


def test_photos_at_one_place_and_photos_taken_twice() -> None:
    start = planned("kiosk")
    anchor = start.viewpoint("v0001")
    together = move(start, "v0004", anchor.position_enu_m)
    assert not errors(together)
    twice = move(together, "v0004", heading_deg=anchor.heading_deg, gimbal_pitch_deg=anchor.gimbal_pitch_deg)
    found = next(f for f in twice.findings if f.code == "duplicates")
    assert (found.severity, found.value) == (Severity.WARNING, 1.0)
    one_left = delete(twice, ["v0001"])
    assert not errors(one_left)
    assert one_left.plan.sorties[0].path_enu_m.count(anchor.position_enu_m) == 1
    same_counts = delete(start, ["v0004"])
    np.testing.assert_array_equal(one_left.counts, same_counts.counts)


@pytest.mark.slow
def test_deleting_the_last_of_a_sortie_takes_the_sortie_and_deleting_all_leaves_a_plan_without_any() -> None:
    start = planned("short sorties")
    assert len(start.plan.sorties) == 2
    fewer = delete(start, start.plan.sorties[0].viewpoint_ids)
    assert fewer.plan.sorties == start.plan.sorties[1:]
    assert not errors(fewer)
    empty = delete(start, [v.id for v in start.plan.viewpoints])
    assert (empty.plan.viewpoints, empty.plan.sorties, empty.plan.coverage.covered) == ((), (), 0)
    assert {"sorties", "coverage"} == set(errors(empty))
    again = add(empty, first(start).position_enu_m, first(start).heading_deg, first(start).gimbal_pitch_deg)
    assert not errors(again)
    assert again.plan.sorties[0].path_enu_m[0] == again.plan.sorties[0].path_enu_m[-1] == HOME
    assert_is_as_from_scratch(again)


def test_coverage_gains_what_only_the_new_view_sees_and_loses_what_only_the_old_one_saw() -> None:
    start = planned("kiosk")
    for viewpoint in start.plan.viewpoints:
        seen = start.elements_of_pose(viewpoint)
        alone = int((start.counts.reshape(-1)[seen] == 1).sum())
        without = delete(start, [viewpoint.id])
        assert start.plan.coverage.covered - without.plan.coverage.covered == alone
        back = add(without, viewpoint.position_enu_m, viewpoint.heading_deg, viewpoint.gimbal_pitch_deg)
        np.testing.assert_array_equal(back.counts, start.counts)
        assert back.plan.coverage == start.plan.coverage


def test_new_viewpoints_are_named_after_the_highest_number() -> None:
    plan = planned("kiosk").plan
    assert next_id(plan) == "v0007"
    odd = replace(
        plan, viewpoints=(*plan.viewpoints, replace(plan.viewpoints[0], id="v12x"), Viewpoint("v0041", HOME, 0.0, 0.0))
    )
    assert next_id(odd) == "v0042"
    assert next_id(replace(plan, viewpoints=(), sorties=())) == "v0000"


def inserted_everywhere_s(start: Revision, new: Viewpoint) -> list[float]:
    """What a new viewpoint adds to the duration at each place of each sortie; slow and simple."""
    found = []
    before = {v.id: v for v in start.plan.viewpoints}
    after = {**before, new.id: new}
    for sortie in start.plan.sorties:
        for place in range(len(sortie.viewpoint_ids) + 1):
            ids = (*sortie.viewpoint_ids[:place], new.id, *sortie.viewpoint_ids[place:])
            drawn = with_other_stops(sortie, before, ids, after, start.paths)
            timed = sortie_flight_path(drawn, after, start.plan.aircraft, start.plan.rules)
            assert timed is not None
            found.append(stopping_duration_s(timed[0], start.plan.aircraft, start.plan.rules) - sortie.duration_s)
    return found


@pytest.mark.slow
@settings(max_examples=12)
@given(
    st.tuples(st.floats(-15.0, 15.0), st.floats(-25.0, -12.0), st.floats(5.0, 25.0)),
    st.floats(-180.0, 180.0),
    st.floats(-60.0, 20.0),
)
def test_a_new_viewpoint_goes_where_it_adds_least_time(
    position: tuple[float, float, float], heading: float, pitch: float
) -> None:
    start = planned("kiosk")
    after = add(start, position, heading, pitch)
    assert after.plan.viewpoints[:-1] == start.plan.viewpoints
    new = after.plan.viewpoints[-1]
    added_s = total_s(after) - total_s(start)
    best_s = min(inserted_everywhere_s(start, new))
    assert best_s - 0.02 <= added_s <= best_s + 0.02


@pytest.mark.slow
def test_a_new_viewpoint_goes_into_a_sortie_with_room_or_gets_one_of_its_own() -> None:
    start = planned("short sorties")
    usable_s = start.plan.aircraft.endurance_s * (1.0 - start.plan.rules.battery_reserve)
    revision, n_new = start, 0
    for _ in range(30):
        n_before = len(revision.plan.sorties)
        revision = add(revision, (0.0, -12.0, 12.0), 10.0 * n_new, 0.0)
        n_new += len(revision.plan.sorties) - n_before
        assert max(sortie.duration_s for sortie in revision.plan.sorties) <= usable_s + 0.01
        assert not errors(revision)
    assert 1 <= n_new <= 4


def test_the_aircraft_s_waypoint_limit_is_kept_where_a_viewpoint_is_added() -> None:
    start = planned("kiosk")
    n_waypoints = len(start.plan.sorties[0].path_enu_m) - 2
    full = revise(replace(start.plan, aircraft=replace(start.plan.aircraft, max_waypoints=n_waypoints)), start.prepared)
    after = add(full, (0.0, -12.0, 12.0), 0.0, 0.0)
    assert len(after.plan.sorties) == 2
    assert not errors(after)


@pytest.mark.parametrize("position", [(0.0, 4.0, 4.0), (0.0, -20.0, 90.0), (-30.0, 0.0, 12.0)])
def test_a_viewpoint_added_at_a_forbidden_place_is_reported(position: tuple[float, float, float]) -> None:
    after = add(planned("kiosk"), position, 0.0, 0.0)
    assert after.plan.viewpoints[-1].position_enu_m == position
    assert errors(after)
    assert_is_as_from_scratch(after)


def test_aiming_puts_the_panel_into_the_middle_of_the_picture_as_far_as_the_gimbal_turns() -> None:
    start = planned("kiosk")
    model = start.case.model
    for number, panel in enumerate(start.prepared.site_model.site.panels):
        position = (3.0, -15.0, 11.0)
        heading, pitch = aim_at(start, position, panel.id)
        aimed = viewpoint_arrays((Viewpoint("v", position, heading, pitch),))
        narrow = replace(model.camera, sensor_width_mm=0.01, sensor_height_mm=0.01)
        assert in_picture(aimed, model.frames.centroids[number : number + 1], narrow).all()
    below = model.frames.centroids[0] - [0.0, 0.5, 20.0]
    assert aim_at(start, tuple(below.tolist()), "A-0000")[1] == 35.0
    assert aim_at(start, tuple(model.frames.centroids[0].tolist()), "A-0000") == (0.0, 0.0)


def imported() -> Plan:
    """As other programs leave them: shared vertices, headings up to 360, a path that does not start at home."""
    plan = planned("kiosk").plan
    a, b, c = (0.0, -12.0, 12.0), (8.0, -14.0, 10.0), (12.0, -20.0, 50.0)
    viewpoints = (
        Viewpoint("left", a, 350.0, -10.0),
        Viewpoint("right", a, 10.0, -10.0),
        Viewpoint("east", b, 330.0, -10.0),
        Viewpoint("outside", c, 330.0, -40.0),
    )
    path = ((0.0, -28.0, 4.0), a, b, (15.0, -20.0, 20.0), c)
    sortie = Sortie(("left", "right", "east", "outside"), path, 1.0, 2.0)
    problem = planned("kiosk").prepared.problem
    covered = replace(coverage(problem.model, viewpoints, problem.reachability), covered=36)
    return replace(plan, viewpoints=viewpoints, sorties=(sortie,), method="imported", coverage=covered)


def test_plans_of_other_programs_are_edited_where_they_are_and_keep_the_rest() -> None:
    start = revise(imported(), planned("kiosk").prepared)
    assert start.plan == imported()
    assert {"heading", "airspace", "path"} <= set(errors(start))
    turned = move(start, "right", heading_deg=20.0)
    path = imported().sorties[0].path_enu_m
    assert turned.plan.sorties[0].path_enu_m == path
    fewer = delete(start, ["left"])
    assert fewer.plan.sorties[0].path_enu_m[-4:] == path[1:]
    assert fewer.plan.sorties[0].path_enu_m[0] == HOME
    inside = move(fewer, "outside", (12.0, -20.0, 20.0), 330.0)
    east = move(move(inside, "east", heading_deg=330.0), "right", heading_deg=10.0)
    assert not errors(east)
    for revision in (start, turned, fewer, inside, east):
        assert_is_as_from_scratch(revision)


def test_what_other_programs_state_finer_than_our_files_is_not_rounded_by_turning_or_locking_it() -> None:
    plan = imported()
    fine = replace(plan.viewpoints[2], position_enu_m=(8.00001234, -14.0, 10.0), heading_deg=333.123456)
    path = [fine.position_enu_m if p == (8.0, -14.0, 10.0) else p for p in plan.sorties[0].path_enu_m]
    plan = replace(
        plan,
        viewpoints=(*plan.viewpoints[:2], fine, plan.viewpoints[3]),
        sorties=(replace(plan.sorties[0], path_enu_m=tuple(path)),),
    )
    start = revise(plan, planned("kiosk").prepared)
    turned = move(start, "east", fine.position_enu_m, None, -12.0)
    assert turned.viewpoint("east") == replace(fine, gimbal_pitch_deg=-12.0)
    wrapped = move(start, "east", fine.position_enu_m, fine.heading_deg, -10.0)
    assert wrapped.viewpoint("east") == replace(fine, heading_deg=333.123456 - 360.0)
    np.testing.assert_array_equal(wrapped.counts, start.counts)
    assert turned.plan.sorties[0].path_enu_m == plan.sorties[0].path_enu_m
    neighbour = move(start, "right", (1.0, -13.0, 12.0))
    assert fine.position_enu_m in neighbour.plan.sorties[0].path_enu_m
    assert_is_as_from_scratch(neighbour)


def test_a_sortie_whose_path_misses_a_viewpoint_is_drawn_anew_when_one_of_its_viewpoints_is_edited() -> None:
    plan = imported()
    broken = replace(plan, sorties=(replace(plan.sorties[0], path_enu_m=(HOME, (0.0, -30.0, 9.0), HOME)),))
    start = revise(broken, planned("kiosk").prepared)
    assert "path" in errors(start)
    repaired_file = move(start, "outside", (12.0, -20.0, 20.0), 330.0)
    assert "path" not in errors(repaired_file)
    assert "leg-distance" not in errors(repaired_file)
    added = add(start, (0.0, -20.0, 12.0), 0.0, 0.0)
    assert "path" not in errors(added)
    assert_is_as_from_scratch(added)


def test_viewpoints_in_no_sortie_or_in_two_are_moved_and_deleted_wherever_they_are() -> None:
    plan = imported()
    loose = replace(plan, sorties=(replace(plan.sorties[0], viewpoint_ids=("left", "right", "east")),))
    start = revise(loose, planned("kiosk").prepared)
    moved = move(start, "outside", (12.0, -20.0, 20.0))
    assert moved.plan.sorties == start.plan.sorties
    assert "sorties" not in errors(delete(start, ["outside"]))
    twice = replace(plan, sorties=(plan.sorties[0], replace(plan.sorties[0], viewpoint_ids=("east",))))
    gone = delete(revise(twice, planned("kiosk").prepared), ["east"])
    assert [sortie.viewpoint_ids for sortie in gone.plan.sorties] == [("left", "right", "outside")]
    assert_is_as_from_scratch(gone)


def test_plans_are_edited_in_wind_that_allows_no_flight() -> None:
    start = planned("kiosk")
    windy = revise(replace(start.plan, rules=FlightRules(wind_m_s=20.0)), start.prepared)
    assert set(errors(windy)) == {"wind"}
    moved = move(windy, "v0003", (5.0, -14.0, 9.0))
    added = add(moved, (0.0, -12.0, 12.0), 0.0, 0.0)
    fewer = delete(added, ["v0000", "v0001"])
    for revision in (moved, added, fewer):
        assert set(errors(revision)) == {"wind"}
        assert_is_as_from_scratch(revision)
    assert len(added.plan.sorties) == len(start.plan.sorties)
