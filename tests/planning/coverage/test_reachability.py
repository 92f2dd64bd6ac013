"""Verdicts on what can be reached: sound against brute force, exact where the answer is known."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.coverage.model import CoverageModel, codes_all_around, exact_sections
from planning.coverage.positions import aimed_views, spread_positions
from planning.coverage.reach_kernel import REACHABLE, UNDECIDED, UNREACHABLE
from planning.coverage.reachability import convex_groups, elevation_range_rad, find_reachable
from planning.coverage.sections import NOT_SEEN, SectionGrid, panel_frames
from planning.geo.bvh import line_of_sight
from planning.geo.mesh import box_mesh, extrude
from planning.plan import Camera
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from planning.site.records import Airspace, NoFlyZone, panel_corners
from tests.slow import slow

CAMERA = profile("m3e").camera


def prepare(site_model, occlusion=False, step=30.0, camera=CAMERA, min_distance_m=10.0, **options):
    space = free_space(site_model, min_distance_m)
    frames = panel_frames(panel_corners(site_model.site))
    sight = line_of_sight(space.solids.bvh.corners) if occlusion else None
    return CoverageModel(frames, camera, SectionGrid(step), sight=sight, precision="f64", **options), space


@functools.cache
def whole_scene(name, occlusion):
    """A bundled site with its coverage model, its free space, and what can be reached."""
    model, space = prepare(SCENES[name](), occlusion)
    return model, space, find_reachable(model, space)


def sections_hit(model, space, n_seeds=6, n=3000):
    """Elements that some random allowed position sees (elevation and float64 line of sight included)."""
    low, high = elevation_range_rad(model.camera)
    hit = np.zeros(model.n_elements, bool)
    for seed in range(1000, 1000 + n_seeds):
        points = spread_positions(space, model.frames, n, np.random.default_rng(seed))
        codes = codes_all_around(model, points)
        panel, i = np.nonzero(codes)
        rays = points[i] - model.frames.centroids[panel]
        distance = np.linalg.norm(rays, axis=1)
        elevation = np.arcsin(-rays[:, 2] / distance)
        seen = (elevation >= low) & (elevation <= high)
        if model.sight is not None:
            seen[seen] = space.solids.lines_free(points[i[seen]], model.targets_enu_m[panel[seen]])
        hit[(panel * model.grid.n_sections + codes[panel, i] - 1)[seen]] = True
    return hit


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("scene", "occlusion"), [("office", False), slow("library", False), slow("court", True), ("roof", False)]
)
def test_nothing_proven_unreachable_is_ever_seen_from_an_allowed_place(scene, occlusion):
    model, space, found = whole_scene(scene, occlusion)
    hit = sections_hit(model, space)
    verdicts = found.verdicts.ravel()
    assert not (hit & (verdicts == UNREACHABLE)).any()
    assert hit.sum() > 0.95 * found.n_reachable
    assert found.n_undecided < 0.01 * model.n_elements
    assert found.n_reachable <= found.upper_bound <= model.n_elements


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(("scene", "occlusion"), [("office", False), ("canyon", True), slow("court", True)])
def test_every_witness_covers_its_section_by_the_definition(scene, occlusion):
    model, space, found = whole_scene(scene, occlusion)
    panel, section = np.nonzero(found.verdicts == REACHABLE)
    chosen = np.random.default_rng(0).choice(len(panel), 1500, replace=False)
    panel, section = panel[chosen], section[chosen]
    witnesses = found.witnesses_enu_m[panel, section]
    assert space.is_allowed(witnesses).all()
    views = aimed_views(witnesses, model.frames.centroids[panel], CAMERA)
    seen = exact_sections(model, views)[np.arange(len(panel)), panel]
    np.testing.assert_array_equal(seen, section)


def test_single_panel_in_a_wide_airspace_is_reachable_except_where_gimbal_and_ground_forbid():
    model, space = prepare(SCENES["single-panel"]())
    found = find_reachable(model, space)
    unreachable = np.flatnonzero(found.verdicts[0] == UNREACHABLE)
    # Steeply from below (phi around 270, theta above 60): the centroid is 8.5 m above the airspace floor, and the
    # gimbal with half the picture looks up by 62.9 degrees at most.
    assert unreachable.tolist() == [24 + 8, 24 + 9]
    assert found.n_undecided == 0


def test_gimbal_that_cannot_look_up_proves_all_views_from_below_its_picture_unreachable():
    steep = replace(CAMERA, gimbal_pitch_deg=(-90.0, -60.0))
    model, space = prepare(SCENES["single-panel"](), camera=steep)
    found = find_reachable(model, space)
    hit = sections_hit(model, space)
    assert not (hit & (found.verdicts.ravel() == UNREACHABLE)).any()
    assert found.upper_bound < prepare_bound("single-panel")


def prepare_bound(scene, min_distance_m=10.0):
    model, space = prepare(SCENES[scene](), min_distance_m=min_distance_m)
    return find_reachable(model, space).upper_bound


@pytest.mark.slow
def test_view_distance_limit_and_larger_safety_distance_only_lower_the_bound():
    base = whole_scene("office", False)[2].upper_bound
    near = find_reachable(*prepare(SCENES["office"](), max_distance_m=18.0)).upper_bound
    model, space = prepare(SCENES["office"](), min_distance_m=25.0)
    far = find_reachable(model, space).upper_bound
    assert near < base
    assert far < base


def test_no_fly_zone_in_front_of_the_panel_is_respected_by_witnesses_and_lowers_the_bound():
    scene = SCENES["single-panel"]()
    zone = NoFlyZone("front", ((-50.0, -50.0), (50.0, -50.0), (50.0, -25.0), (-50.0, -25.0)), 0.0, 60.0)
    airspace = replace(scene.site.airspace, no_fly=(zone,))
    site = replace(scene.site, airspace=airspace, home_enu_m=(0.0, -13.0, 0.0))
    model, space = prepare(replace(scene, site=site), min_distance_m=6.0)
    found = find_reachable(model, space)
    witnesses = found.witnesses_enu_m[found.verdicts == REACHABLE]
    assert len(witnesses) > 10
    assert (witnesses[:, 1] > -25.0 + 6.0).all()
    assert found.upper_bound <= prepare_bound("single-panel", min_distance_m=6.0)
    assert not (sections_hit(model, space) & (found.verdicts.ravel() == UNREACHABLE)).any()


def test_panel_behind_a_wall_is_proven_unseen_when_occlusion_counts_and_seen_when_not():
    scene = SCENES["single-panel"]()
    box = box_mesh(np.array([-80.0, -1.0, 0.0]), np.array([80.0, -0.5, 60.0]))
    hidden = replace(scene, building=box, site=replace(scene.site, building_mesh="wall.ply"))
    without = find_reachable(*prepare(hidden, occlusion=False))
    model, space = prepare(hidden, occlusion=True)
    found = find_reachable(model, space)
    assert without.n_reachable > 25
    assert found.n_reachable == 0
    assert found.n_undecided <= 2


def test_stopping_at_once_leaves_everything_undecided_and_the_bound_at_the_total():
    model, space = prepare(SCENES["office"]())
    found = find_reachable(model, space, stop=lambda: True)
    assert (found.verdicts == UNDECIDED).all()
    assert found.upper_bound == model.n_elements


@pytest.mark.slow
def test_more_effort_only_settles_more():
    model, space, whole = whole_scene("office", False)
    bounds = [*(find_reachable(model, space, max_cells=n).upper_bound for n in (1, 100)), whole.upper_bound]
    assert bounds == sorted(bounds, reverse=True)
    assert bounds[0] > bounds[-1]


@pytest.mark.slow
def test_empty_airspace_gives_a_bound_of_zero():
    scene = SCENES["office"]()
    thin = Airspace((-5.0, -16.0, 3.0), (5.0, -12.0, 8.0), 0.0)
    site = replace(scene.site, airspace=thin, home_enu_m=(0.0, -14.0, 0.0))
    model, space = prepare(replace(scene, site=site), min_distance_m=12.5)
    # Panels tower over the box: distance to the nearest panel is at most 16 m everywhere, at least 12 m.
    found = find_reachable(model, space)
    assert not (sections_hit(model, space) & (found.verdicts.ravel() == UNREACHABLE)).any()
    assert 0 < found.upper_bound < 0.5 * model.n_elements


@given(low=st.floats(-90.0, 40.0), span=st.floats(0.0, 60.0), half_w=st.floats(0.1, 1.5), half_h=st.floats(0.1, 1.5))
@settings(max_examples=60)
def test_elevation_range_bounds_every_direction_in_the_picture(low, span, half_w, half_h):
    camera = Camera("c", 2 * half_w, 2 * half_h, 1.0, 100, 100, (low, min(low + span, 90.0)))
    lowest, highest = elevation_range_rad(camera)
    rng = np.random.default_rng(1)
    pitch = np.radians(rng.uniform(*camera.gimbal_pitch_deg, 4000))
    x, y = rng.uniform(-half_w, half_w, 4000), rng.uniform(-half_h, half_h, 4000)
    x[::4], y[::3] = half_w, half_h
    y[1::3] = -half_h
    x[1::4] = 0.0
    elevation = np.arcsin((np.sin(pitch) + y * np.cos(pitch)) / np.sqrt(1 + x**2 + y**2))
    assert lowest - 1e-9 <= elevation.min()
    assert highest + 1e-9 >= elevation.max()
    assert highest - elevation.max() < 0.1
    assert elevation.min() - lowest < 0.1


def test_convex_parts_and_flat_convex_patches_are_one_group_and_concave_ones_are_not():
    box = box_mesh(np.zeros(3), np.ones(3)).corners_enu_m
    assert len(np.unique(convex_groups(box))) == 1
    outline = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 10.0], [10.0, 10.0], [10.0, 30.0], [0.0, 30.0]])
    corner = extrude(outline, 0.0, 20.0).corners_enu_m
    groups = convex_groups(corner)
    # Six walls of two triangles are one group each; top and bottom are L-shaped and stay single triangles.
    sizes = np.sort(np.unique(groups, return_counts=True)[1])
    assert sizes.tolist() == [1] * (len(corner) - 12) + [2] * 6
    assert (NOT_SEEN, len(convex_groups(np.zeros((0, 3, 3))))) == (-1, 0)
