"""Reasons of unreachable sections: true at their place, enough to make the section reachable, and not far too much."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import OperationCancelled
from planning.coverage.positions import hemisphere_direction
from planning.coverage.reach_kernel import REACHABLE, UNREACHABLE
from planning.coverage.reachability import elevation_range_rad, find_reachable
from planning.coverage.sections import sections_of
from planning.insight.obstructions import Obstruction
from planning.insight.reasons import BrokenRule, Rule, section_reasons
from planning.parameters import Constraints
from planning.site.bundled import SCENES
from planning.site.free_space import SAFETY_MARGIN_M
from planning.site.importing.importer import import_site
from planning.site.importing.options import ImportOptions
from planning.site.records import Airspace, NoFlyZone, Obstacle, box_geometry
from planning.viewpoints.prepare import coverage_model, prepare
from tests.planning.insight.cases import CAMERA, NEAR, prepared, reasons, scene
from tests.planning.plan_cases import distances, inside_zone, lines_free, solid_triangles
from tests.slow import slow

TOLERANCE_M = 0.01
"""Margins of 2 mm, and of 1e-5 rad over some hundred metres."""


def broken_by_contract(model, site, panel, places):
    """Rules that places, shape (n, 3), break, put independently: a dictionary of rule to shape (n,) amounts."""
    space, frames = site.problem.space, site.problem.model.frames
    low, high = np.array(space.low_enu_m), np.array(space.high_enu_m)
    rays = frames.centroids[panel] - places
    elevation = np.degrees(np.arctan2(rays[:, 2], np.hypot(rays[:, 0], rays[:, 1])))
    lowest, highest = np.degrees(elevation_range_rad(CAMERA))
    triangles = solid_triangles(model)
    below = np.where(places[:, 2] < low[2], low[2] - places[:, 2], 0.0)
    in_ground = places[:, 2] < model.site.airspace.ground_z_m
    inside = site.problem.space.solids.clearance_m(places, 1.0) < 0.0
    clearance = np.where(inside, -1.0, 1.0) * distances(places, triangles)
    target = np.broadcast_to(frames.centroids[panel] + 0.15 * frames.normals[panel], places.shape)
    hidden = ~lines_free(target, places, triangles) & (site.constraints.occlusion == "on")
    furthest = site.constraints.max_distance_m or np.inf
    amounts = {
        Rule.GIMBAL_UP: elevation - highest,
        Rule.GIMBAL_DOWN: lowest - elevation,
        Rule.FLOOR: np.where(in_ground, 0.0, below),
        Rule.GROUND: np.where(in_ground, below, 0.0),
        Rule.CEILING: places[:, 2] - high[2],
        Rule.SIDES: np.maximum(low - places, places - high)[:, :2].max(axis=1),
        Rule.RANGE: np.linalg.norm(rays, axis=1) - furthest,
        Rule.DISTANCE: site.constraints.min_distance_m - clearance,
        Rule.HIDDEN: hidden.astype(float),
    }
    zones = np.zeros(len(places))
    for zone in model.site.airspace.no_fly:
        gap = distances(places, zone.prism().corners_enu_m)
        gap = np.where(inside_zone(places, zone), -gap, gap)
        zones = np.maximum(zones, space.no_fly_distance_m - gap)
    amounts[Rule.NO_FLY] = zones
    return amounts


def check_place(model, site, panel, section, reason):
    """The place of a reason lies in its section and breaks its rules, by their amounts, and no other."""
    place = np.array([reason.place_enu_m])
    frames = site.problem.model.frames
    assert sections_of(place, frames, site.problem.model.grid)[0, panel] == section
    amounts = broken_by_contract(model, site, panel, place)
    named = {broken.rule: broken for broken in reason.broken}
    for rule, (amount,) in amounts.items():
        if rule not in named:
            assert amount <= TOLERANCE_M, (rule, amount, reason)
        elif rule.unit:
            assert amount == pytest.approx(named[rule].amount, abs=TOLERANCE_M), (rule, reason)
        else:
            assert amount > 0.0, (rule, reason)


def unreachable(site):
    return list(zip(*np.nonzero(site.problem.reachability.verdicts == UNREACHABLE), strict=True))


FAR = Constraints(10.0)
CLOSE = Constraints(5.0, occlusion="on", max_distance_m=14.0)


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(("name", "constraints"), [("kiosk", NEAR), ("kiosk", CLOSE), ("single-panel", FAR)])
def test_every_reason_is_true_at_its_place(name, constraints):
    site = prepared(name, constraints)
    found = reasons(name, constraints)
    asked = unreachable(site)
    assert len(asked) > 0
    for panel, section in asked[::3]:
        reasons_here = found.of(panel, section)
        assert reasons_here
        for reason in reasons_here:
            check_place(scene(name), site, panel, section, reason)


def test_sections_that_can_be_covered_have_no_reason_and_all_that_cannot_have_one():
    site = prepared("kiosk")
    found = reasons("kiosk")
    has_reason = found.first_masks() > 0
    np.testing.assert_array_equal(has_reason, site.problem.reachability.verdicts == UNREACHABLE)
    assert sum(found.counts().values()) == has_reason.sum()
    panel, section = np.argwhere(site.problem.reachability.verdicts == REACHABLE)[0]
    assert found.of(panel, section) == ()


@pytest.mark.parametrize("name", ["kiosk", slow("canyon"), slow("court")])
def test_random_places_find_no_rule_that_would_give_for_much_less(name):
    site = prepared(name)
    model, found = scene(name), reasons(name)
    rng = np.random.default_rng(0)
    asked = unreachable(site)
    chosen = rng.choice(len(asked), 4, replace=False)
    for panel, section in (asked[i] for i in chosen):
        alone = {r.broken[0].rule: r.broken[0].amount for r in found.of(panel, section) if len(r.broken) == 1}
        bounds = site.problem.model.grid.bounds_rad(section)
        theta, phi = rng.uniform(*bounds[:2], 600), rng.uniform(*bounds[2:], 600)
        frames = site.problem.model.frames
        directions = hemisphere_direction(frames, np.full(600, panel), theta, phi)
        places = frames.centroids[panel] + (0.5 * 300.0 ** rng.random(600))[:, None] * directions
        amounts = broken_by_contract(model, site, panel, places)
        broken = np.stack([amounts[rule] > 0.0 for rule in amounts])
        n_broken = broken.sum(axis=0)
        assert (n_broken > 0).all(), "a place that breaks no rule would be a viewpoint of a section proven unreachable"
        for row, rule in enumerate(amounts):
            least = amounts[rule][broken[row] & (n_broken == 1)].min(initial=np.inf)
            if rule.unit and least < np.inf:
                assert alone.get(rule, np.inf) <= 1.1 * least + 0.05, (panel, section, rule)


def relaxed(model, constraints, reason):
    """The site or the constraints changed by what a reason with one rule says, and a centimetre."""
    (broken,) = reason.broken
    low, high = np.array(model.site.airspace.min_enu_m), np.array(model.site.airspace.max_enu_m)
    more = broken.amount + TOLERANCE_M
    if broken.rule is Rule.FLOOR:
        lowest_z_m = max(low[2], model.site.airspace.ground_z_m + model.site.airspace.lowest_height_m()) - more
        low[2] = min(low[2], lowest_z_m)
        constraints = replace(constraints, min_height_above_ground_m=max(0.0, lowest_z_m))
    elif broken.rule is Rule.CEILING:
        high[2] += more
    elif broken.rule is Rule.SIDES:
        low[:2] -= more
        high[:2] += more
    elif broken.rule is Rule.DISTANCE and not broken.inside:
        constraints = replace(constraints, min_distance_m=constraints.min_distance_m - more)
    elif broken.rule is Rule.RANGE:
        constraints = replace(constraints, max_distance_m=constraints.max_distance_m + more)
    else:
        return None
    airspace = replace(model.site.airspace, min_enu_m=tuple(low), max_enu_m=tuple(high))
    return replace(model, site=replace(model.site, airspace=airspace)), constraints


@pytest.mark.slow
@settings(max_examples=8)
@given(data=st.data())
def test_relaxing_a_rule_by_what_its_reason_says_makes_the_section_reachable(data):
    box = st.tuples(st.floats(-30, 20), st.floats(-35, -8), st.floats(1, 14), st.floats(1, 8), st.floats(2, 20))
    x, y, width, depth, height = data.draw(box)
    obstacle = Obstacle("box", box_enu_m=((x, y, 0.0), (x + width, y + depth, height)))
    floor, ceiling = data.draw(st.tuples(st.floats(1.0, 9.0), st.floats(14.0, 40.0)))
    airspace = Airspace((-40.0, -45.0, floor), (40.0, 12.0, ceiling), 0.0)
    bare = SCENES["single-panel"]()
    site = replace(bare.site, airspace=airspace, obstacles=(obstacle,), home_enu_m=(38.0, -44.0, 0.0))
    model = replace(bare, site=site, obstacles=(box_geometry(obstacle),))
    constraints = Constraints(3.0, occlusion="on", max_distance_m=data.draw(st.sampled_from([None, 12.0])))
    before = prepare(model, CAMERA, constraints)
    found = section_reasons(model, before)
    for panel, section in unreachable(before):
        for reason in found.of(panel, section):
            check_place(model, before, panel, section, reason)
            change = relaxed(model, constraints, reason) if len(reason.broken) == 1 else None
            if change is None:
                continue
            problem = prepare(change[0], CAMERA, change[1]).problem
            assert problem.reachability.verdicts[panel, section] != UNREACHABLE, reason
            assert problem.space.is_allowed(np.array([reason.place_enu_m])).all(), reason


def test_a_lower_floor_than_the_reason_asks_for_is_needed_and_enough():
    site, found = prepared("single-panel", FAR), reasons("single-panel", FAR)
    floors = {
        (panel, section): reason.broken[0].amount
        for panel, section in unreachable(site)
        for reason in found.of(panel, section)
        if [b.rule for b in reason.broken] == [Rule.FLOOR]
    }
    assert floors
    low = site.problem.space.low_enu_m
    for (panel, section), amount in floors.items():
        for share, expected in ((0.8, False), (1.1, True)):
            space = replace(site.problem.space, low_enu_m=low - [0.0, 0.0, share * amount])
            verdicts = find_reachable(site.problem.model, space).verdicts
            assert (verdicts[panel, section] == REACHABLE) == expected, (share, amount)


@pytest.mark.slow
def test_no_fly_volumes_are_named():
    zone = NoFlyZone("east", ((0.5, -50.0), (50.0, -50.0), (50.0, 20.0), (0.5, 20.0)), 0.0, 60.0)
    bare = SCENES["single-panel"]()
    airspace = replace(bare.site.airspace, no_fly=(zone,))
    model = replace(bare, site=replace(bare.site, airspace=airspace, home_enu_m=(-5.0, -20.0, 0.0)))
    site = prepare(model, CAMERA, Constraints(4.0))
    found = section_reasons(model, site)
    broken = [b for key in unreachable(site) for r in found.of(*key) for b in r.broken if b.rule is Rule.NO_FLY]
    assert {(b.obstruction, b.inside) for b in broken} == {(Obstruction("no-fly", "east"), True)}
    for key in unreachable(site):
        for reason in found.of(*key):
            check_place(model, site, *key, reason)


def test_a_wall_in_front_of_the_panel_is_named_as_what_hides_it():
    bare = SCENES["single-panel"]()
    wall = Obstacle("wall", box_enu_m=((-80.0, -1.0, 0.0), (80.0, -0.5, 60.0)))
    site = replace(bare.site, obstacles=(wall,))
    model = replace(bare, site=site, obstacles=(box_geometry(wall),))
    constraints = Constraints(5.0, occlusion="on")
    # The panel is hidden from everywhere, so the site cannot be prepared as a whole.
    open_site = prepare(model, CAMERA, replace(constraints, occlusion="off"))
    hidden = coverage_model(model, open_site.problem.space, CAMERA, constraints)
    problem = replace(open_site.problem, model=hidden, reachability=find_reachable(hidden, open_site.problem.space))
    found = section_reasons(model, replace(open_site, problem=problem, constraints=constraints))
    seen = found.of(0, 0)
    assert [str(r) for r in seen if r.broken[0].rule is Rule.HIDDEN] == ["hidden by obstacle 'wall'"]
    assert Obstruction("obstacle", "wall") in {b.obstruction for r in seen for b in r.broken}


def test_a_gimbal_that_cannot_look_up_is_named_with_the_angle_that_is_missing():
    level = replace(CAMERA, gimbal_pitch_deg=(-90.0, -20.0))
    model = scene("single-panel")
    site = prepare(model, level, NEAR)
    found = section_reasons(model, site)
    # Theta 30 to 60, phi 240 to 270: the panel is seen upwards by asin(sin 30 sin 60) = 25.66 degrees or more.
    section = 12 + 8
    (broken,) = next(r.broken for r in found.of(0, section) if [b.rule for b in r.broken] == [Rule.GIMBAL_UP])
    reach = np.degrees(elevation_range_rad(level)[1])
    assert broken.amount == pytest.approx(25.66 - reach, abs=0.1)
    for more, expected in ((0.1, True), (-0.3, False)):
        wider = replace(level, gimbal_pitch_deg=(-90.0, -20.0 + broken.amount + more))
        after = find_reachable(replace(site.problem.model, camera=wider), site.problem.space)
        assert (after.verdicts[0, section] == REACHABLE) == expected


@pytest.mark.slow
def test_a_panel_in_a_sealed_court_is_out_of_reach_of_the_aircraft():
    # Four walls as high as the airspace around a pane 30 m away from each; home stands outside.
    walls = [((-32, -62), (32, -60)), ((-32, 2), (32, 4)), ((-34, -62), (-32, 4)), ((32, -62), (34, 4))]
    obstacles = tuple(
        Obstacle(f"wall {i}", box_enu_m=((float(x0), float(y0), 0.0), (float(x1), float(y1), 60.0)))
        for i, ((x0, y0), (x1, y1)) in enumerate(walls)
    )
    bare = SCENES["single-panel"]()
    airspace = Airspace((-60.0, -90.0, 2.0), (60.0, 40.0, 50.0), 0.0)
    site = replace(bare.site, obstacles=obstacles, airspace=airspace, home_enu_m=(50.0, -80.0, 0.0))
    model = replace(bare, site=site, obstacles=tuple(box_geometry(obstacle) for obstacle in obstacles))
    near = Constraints(5.0, occlusion="off", max_distance_m=40.0)
    sealed = prepare(model, CAMERA, near)
    found = section_reasons(model, sealed)
    straight = found.of(0, 0)
    assert [str(reason) for reason in straight][-1] == "no way to it was found from home"
    assert sealed.problem.reachability.verdicts[0, 0] == REACHABLE
    gate = replace(site, home_enu_m=(0.0, -30.0, 0.0))
    inside = prepare(replace(model, site=gate), CAMERA, near)
    assert section_reasons(replace(model, site=gate), inside).of(0, 0) == ()


def test_sections_that_no_single_rule_explains_name_the_rules_that_would_have_to_give_together():
    fine = Constraints(10.0, section_step_deg=15.0)
    site, found = prepared("single-panel", fine), reasons("single-panel", fine)
    # Theta 75 to 90, phi 255 to 285: from straight below, too steep for the gimbal; and 10 m below the pane is under
    # the floor, so that one would have to fly lower or come nearer, too.
    for section in (5 * 24 + 17, 5 * 24 + 18):
        (reason,) = found.of(0, section)
        assert reason.broken[0].rule is Rule.GIMBAL_UP
        assert reason.broken[1].rule in (Rule.FLOOR, Rule.DISTANCE)
        assert len(reason.broken) == 2
        assert " and " in str(reason)
        check_place(scene("single-panel"), site, 0, section, reason)
    assert sum(count for rules, count in found.counts().items() if len(rules) == 2) == 2


def test_reasons_are_in_order_of_how_little_would_have_to_give_and_what_cannot_give_is_last():
    found = reasons("kiosk")
    for panel, section in unreachable(prepared("kiosk")):
        key = [
            (any(not b.rule.unit or b.inside for b in reason.broken), sum(b.amount for b in reason.broken))
            for reason in found.of(panel, section)
        ]
        assert key == sorted(key)


def test_fine_sections_are_explained_as_well():
    constraints = Constraints(5.0, section_step_deg=5.0)
    site = prepared("single-panel", constraints)
    found = reasons("single-panel", constraints)
    asked = unreachable(site)
    assert len(asked) > 20
    for panel, section in asked[::5]:
        for reason in found.of(panel, section):
            check_place(scene("single-panel"), site, panel, section, reason)


def test_reasons_of_some_panels_are_those_of_all():
    site, every = prepared("kiosk"), reasons("kiosk")
    some = section_reasons(scene("kiosk"), site, np.array([2, 11]))
    masks = every.first_masks()
    masks[np.setdiff1d(np.arange(15), [2, 11])] = 0
    np.testing.assert_array_equal(some.first_masks(), masks)
    for section in range(36):
        assert some.of(11, section) == every.of(11, section)


@pytest.mark.slow
def test_reasons_on_a_real_building_are_true_at_their_places(shared_data):
    path = shared_data / "buildings" / "ingolstadt_lod3" / "4018133.xml"
    model = import_site(path, ImportOptions()).model
    site = prepare(model, CAMERA, Constraints(8.0))
    found = section_reasons(model, site)
    asked = unreachable(site)
    assert len(asked) > 50
    assert (found.first_masks() > 0).sum() >= len(asked)
    for panel, section in asked[::25]:
        for reason in found.of(panel, section):
            check_place(model, site, panel, section, reason)


def test_texts_say_what_is_wrong_by_how_much_and_with_what():
    crane = Obstruction("obstacle", "crane")
    texts = {
        BrokenRule(Rule.FLOOR, 1.234): "1.23 m below the lowest flight allowed",
        BrokenRule(Rule.GIMBAL_UP, 12.04): "12 degrees above what the camera sees with the gimbal at its limit",
        BrokenRule(Rule.DISTANCE, 0.5, crane): "0.5 m too close to obstacle 'crane'",
        BrokenRule(Rule.DISTANCE, 12.0, Obstruction("building"), inside=True): "inside the building",
        BrokenRule(Rule.NO_FLY, 2.0, Obstruction("no-fly", "road")): "2 m too close to no-fly volume 'road'",
        BrokenRule(Rule.HIDDEN, 0.0, Obstruction("panel", "A-1")): "hidden by panel 'A-1'",
    }
    for broken, text in texts.items():
        assert str(broken) == text
    assert len({str(BrokenRule(rule, 1.0, crane)) for rule in Rule}) == len(Rule) - 1


def test_kept_distances_hold_the_margin_of_viewpoints():
    assert reasons("kiosk").min_distance_m == pytest.approx(5.0 + SAFETY_MARGIN_M)


def test_cancelling_ends_the_search():
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled

    with pytest.raises(OperationCancelled):
        section_reasons(scene("kiosk"), prepared("kiosk"), monitor=Cancelling())
