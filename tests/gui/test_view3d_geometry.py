"""What the 3-D view computes before anything is drawn: projection, orbits, shapes, colours, domes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.gui.view3d.drawables import Drawable, arrows, frusta
from groundstation.gui.view3d.hemispheres import (
    OPEN,
    UNDECIDED,
    UNREACHABLE,
    dome_pattern,
    domes,
    mixed_colours,
    nearest_panels,
    state_colours,
)
from groundstation.gui.view3d.orbit import Orbit, facing, photo_pinhole, shifted_by_drag, turned_by_drag
from groundstation.gui.view3d.overlay import round_length
from groundstation.gui.view3d.paint import NO_VALUE, ColourScale, ValueKind, flat, rgba, shaded
from groundstation.gui.view3d.site_scene import ends_of_sorties
from groundstation.gui.widgets.theme import DARK, LIGHT
from planning.aircraft.catalogue import profiles
from planning.coverage.sections import SectionGrid, in_picture, panel_frames, sections_of
from planning.geo.frames import camera_axes
from planning.plan import ViewpointArrays
from planning.site.bundled import office, roof
from planning.site.records import panel_corners

CAMERA = profiles()["m3e"].camera
angles = st.floats(-180.0, 180.0)
pitches = st.floats(-90.0, 90.0)
places = st.tuples(*[st.floats(-200.0, 200.0)] * 3)
orbits = st.builds(Orbit, places, st.floats(1.0, 1000.0), angles, pitches)


@given(orbits, st.floats(1.0, 1279.0), st.floats(1.0, 719.0), st.floats(0.5, 500.0))
def test_a_point_on_the_ray_through_a_pixel_has_that_pixel(orbit, x, y, depth):
    view = orbit.pinhole(1280, 720)
    pixel, _ = view.project(view.eye_enu_m + depth * view.ray(x, y))
    assert pixel == pytest.approx([x, y], abs=1e-3)


@given(places, angles, pitches, places)
def test_a_photo_holds_a_point_where_the_coverage_model_says_so(eye, heading_deg, pitch_deg, point):
    heading, pitch = math.radians(heading_deg), math.radians(pitch_deg)
    view = photo_pinhole(np.array(eye), heading, pitch, CAMERA, 1000.0)
    views = ViewpointArrays(np.array([eye]), np.array([heading]), np.array([pitch]))
    (x, y), depth = view.project(np.array(point))
    border = min(abs(x), abs(x - 1000.0), abs(y), abs(y - view.height_px)) if depth > 1e-6 else abs(depth)
    if border < 1e-6:
        return
    is_inside = bool(depth > 1e-6 and 0.0 <= x <= 1000.0 and 0.0 <= y <= view.height_px)
    assert is_inside == bool(in_picture(views, np.array([point]), CAMERA)[0, 0])


def test_points_beside_and_behind_the_eye_have_no_pixel():
    view = Orbit(distance_m=10.0).pinhole(100, 100)
    pixels, _ = view.project(view.eye_enu_m + np.array([view.right, -view.forward, np.zeros(3)]))
    assert np.isnan(pixels).all()


def test_east_is_on_the_right_when_looking_north_and_up_is_up():
    view = Orbit(heading_deg=0.0, pitch_deg=0.0, distance_m=50.0).pinhole(200, 100)
    (east, up), _ = view.project(np.array([[5.0, 0.0, 0.0], [0.0, 0.0, 5.0]]))
    assert east[0] > 100.0
    assert up[1] < 50.0


@given(orbits, st.floats(-400.0, 400.0), st.floats(-400.0, 400.0))
def test_turning_keeps_the_focus_and_the_distance(orbit, right, up):
    turned = orbit.turned(right, up)
    assert turned.focus_enu_m == orbit.focus_enu_m
    assert np.linalg.norm(turned.eye_enu_m - np.array(turned.focus_enu_m)) == pytest.approx(orbit.distance_m)
    assert -90.0 <= turned.pitch_deg <= 90.0


def test_a_drag_to_the_right_brings_what_is_in_front_of_the_focus_along():
    orbit = Orbit(pitch_deg=0.0, distance_m=100.0)
    nearer = np.array([0.0, -10.0, 0.0])
    before, _ = orbit.pinhole(800, 600).project(nearer)
    after, _ = turned_by_drag(orbit, 30.0, 0.0).pinhole(800, 600).project(nearer)
    assert after[0] > before[0] + 5.0


@given(orbits, st.floats(-100.0, 100.0), st.floats(-100.0, 100.0))
def test_shifting_moves_the_old_focus_by_the_pixels_of_the_drag(orbit, dx, dy):
    view = orbit.pinhole(1280, 720)
    shifted = shifted_by_drag(orbit, view, dx, dy).pinhole(1280, 720)
    pixel, _ = shifted.project(np.array(orbit.focus_enu_m))
    assert pixel == pytest.approx([640.0 + dx, 360.0 + dy], abs=1e-3)


@given(orbits, st.floats(0.6, 1.8), st.floats(10.0, 1270.0), st.floats(10.0, 710.0))
def test_zooming_at_a_point_keeps_its_pixel(orbit, factor, x, y):
    view = orbit.pinhole(1280, 720)
    anchor = view.eye_enu_m + 0.7 * orbit.distance_m * view.ray(x, y)
    zoomed = orbit.zoomed(factor, anchor)
    pixel, _ = zoomed.pinhole(1280, 720).project(anchor)
    assert pixel == pytest.approx([x, y], abs=1e-2)


@given(orbits, st.lists(places, min_size=1, max_size=20), st.floats(0.5, 3.0))
def test_fitting_brings_all_points_into_the_picture(orbit, points, aspect):
    points = np.array(points)
    view = orbit.fitted(points, aspect).pinhole(600 * aspect, 600)
    pixels, depths = view.project(points)
    assert (depths > 0.0).all()
    assert (pixels >= -0.01).all()
    assert (pixels <= np.array([600 * aspect, 600]) + 0.01).all()


def test_facing_a_roof_looks_straight_down_without_breaking():
    orbit = facing(np.array([0.0, 0.0, 1.0]), np.zeros((1, 3)), 1.0)
    assert orbit.pitch_deg == pytest.approx(-90.0)
    assert np.isfinite(orbit.pinhole(10, 10).up).all()


def test_orbits_that_are_none_are_refused():
    for wrong in ({"distance_m": 0.0}, {"pitch_deg": 91.0}, {"heading_deg": math.nan}):
        with pytest.raises(ValueError, match="expected"):
            Orbit(**wrong)


def test_frusta_open_along_the_line_of_sight():
    views = ViewpointArrays(np.array([[1.0, 2.0, 3.0]]), np.array([0.5]), np.array([-0.3]))
    points, lines = frusta(views, CAMERA, 2.0)
    forward, _, _ = camera_axes(0.5, -0.3)
    assert (points[1:] - points[0]) @ forward == pytest.approx([2.0] * 4)
    assert lines.shape == (8, 2)


@given(st.lists(places, min_size=2, max_size=30))
def test_arrows_point_along_their_legs_and_keep_apart(path):
    path = np.array(path)
    points, triangles = arrows(path, 1.5)
    tips, tails = points[0::5], 0.5 * (points[1::5] + points[2::5])
    assert np.linalg.norm(tips - tails, axis=1) == pytest.approx(1.5)
    assert len(triangles) == 2 * len(tips)
    assert len(tips) <= 1 + np.linalg.norm(np.diff(path, axis=0), axis=1).sum() / 6.0
    assert np.isfinite(points).all()


def test_sorties_that_start_and_land_at_one_place_share_a_label():
    home, away = np.array([0.0, 0.0, 3.0]), np.array([50.0, 0.0, 3.0])
    there_and_back, one_way = np.array([home, away, home]), np.array([home, away])
    places = ends_of_sorties((there_and_back, one_way, np.zeros((0, 3))))
    assert [(starts, landings) for _, starts, landings in places] == [([1, 2], [1]), ([], [2])]


def test_scale_colours_ends_middle_and_missing_values():
    scale = ColourScale("GSD", "mm", 1.0, 3.0)
    colours = scale.colours(np.array([-5.0, 1.0, 3.0, 99.0, np.nan]))
    assert (colours[0] == colours[1]).all()
    assert (colours[2] == colours[3]).all()
    assert (colours[4] == rgba(NO_VALUE)).all()
    turned = ColourScale("GSD", "mm", 1.0, 3.0, ValueKind.LOW_IS_GOOD).colours(np.array([3.0, 1.0]))
    assert (turned == colours[1:3]).all()


@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=50))
def test_scale_gets_brighter_with_the_value(values):
    values = np.sort(values)
    colours = ColourScale("", "", 0.0, 1.0).colours(values)[:, :3] @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(colours) >= -1.5).all()


def test_scale_without_a_range_is_refused():
    with pytest.raises(ValueError, match="low below high"):
        ColourScale("x", "", 1.0, 1.0)


def test_shading_tells_the_sides_of_a_building_and_its_roof_apart():
    normals = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]], float)
    brightness = shaded(flat("#c0c0c0", 5), normals)[:, 0].astype(int)
    assert np.diff(np.sort(brightness)).min() >= 5
    assert brightness.argmax() == 4


def test_drawables_with_colours_of_another_number_are_refused():
    with pytest.raises(ValueError, match="colours"):
        Drawable(np.zeros((3, 3)), np.array([[0, 1, 2]]), flat("#000000", 2))


@pytest.mark.parametrize("step_deg", [30.0, 15.0, 5.0, 90.0])
@pytest.mark.parametrize("scene", [office, roof])
def test_dome_pieces_lie_in_the_sections_whose_colour_they_get(scene, step_deg):
    frames, grid = panel_frames(panel_corners(scene().site)), SectionGrid(step_deg)
    pattern = dome_pattern(grid, 30.0)
    states = np.tile(np.arange(grid.n_sections), (len(frames), 1)) % 4
    chosen = np.array([0, len(frames) - 1])
    (points, cells), colours = domes(frames, chosen, np.array([0.7, 0.7]), pattern, states, LIGHT)
    middles = points[cells].mean(axis=1).reshape(2, -1, 3)
    assert colours.shape == (2 * len(pattern.section), 4)
    for row, panel in enumerate(chosen):
        foot = points[cells[row * len(pattern.section)]]
        one = panel_frames(frames.corners[panel : panel + 1] + 0.05 * frames.normals[panel])
        assert (sections_of(middles[row], one, grid)[:, 0] == pattern.section).all()
        assert np.linalg.norm(foot - one.centroids[0], axis=1) == pytest.approx(0.7)
    assert set(pattern.section) == set(range(grid.n_sections))


@pytest.mark.parametrize("look", [LIGHT, DARK])
def test_states_have_colours_of_their_own(look):
    states = np.array([UNDECIDED, UNREACHABLE, OPEN, 1, 2, 3, 4, 99])
    colours = state_colours(states, look)
    assert len(np.unique(colours[:-1], axis=0)) == 7
    assert (colours[-1] == colours[-2]).all()
    assert (np.diff(colours[3:7, :3].sum(axis=1).astype(int)) < 0).all()


def test_a_panel_mixes_the_colours_of_its_sections_by_solid_angle():
    grid = SectionGrid(30.0)
    states = np.stack([np.full(36, 4), np.full(36, OPEN), np.where(np.arange(36) < 12, 4, OPEN)])
    covered, gap, mixed = mixed_colours(states, grid, LIGHT).astype(float)
    share = 1.0 - math.cos(math.radians(30.0))
    assert mixed == pytest.approx(share * covered + (1.0 - share) * gap, abs=1.0)
    slow = (state_colours(states, LIGHT) * (grid.solid_angles_sr() / (2.0 * math.pi))[None, :, None]).sum(axis=1)
    assert np.abs(mixed_colours(states, grid, LIGHT) - slow).max() <= 1.0


def test_domes_stand_on_the_nearest_panels_that_are_seen_and_face_the_eye():
    site = office()
    frames = panel_frames(panel_corners(site.site))
    view = Orbit((0.0, 0.0, 20.0), 120.0, 0.0, -10.0).pinhole(1280, 720)
    nearest = nearest_panels(frames, view, 10)
    distances = np.linalg.norm(frames.centroids - view.eye_enu_m, axis=1)
    assert set(nearest) == set(np.argsort(distances)[:10])
    behind = Orbit((0.0, 0.0, 20.0), 120.0, 180.0, -10.0).pinhole(1280, 720)
    assert len(nearest_panels(frames, behind, 10)) == 0


@given(st.floats(1e-3, 1e5))
def test_the_scale_bar_is_a_round_length_that_fits(at_most):
    length = round_length(at_most)
    assert at_most / 2.5 - 1e-9 <= length <= at_most * (1.0 + 1e-6)
    digits = f"{length:.0e}"
    assert digits[0] in "125"
