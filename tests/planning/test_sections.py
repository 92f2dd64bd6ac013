"""Hemisphere sections against mpmath and worked examples."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.coverage.sections import NOT_SEEN, SectionGrid, in_picture, panel_frames, sections_of, sections_seen
from planning.plan import Camera, ViewpointArrays

SOUTH_WALL = np.array([[[-1.0, 0.0, 9.0], [1.0, 0.0, 9.0], [1.0, 0.0, 11.0], [-1.0, 0.0, 11.0]]])
SKYLIGHT = np.array([[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]])
CAMERA = Camera("test", 17.3, 13.0, 12.29, 5280, 3956, (-90.0, 35.0))
STEPS = (90.0, 45.0, 30.0, 22.5, 15.0, 10.0, 5.0)


def test_frame_of_a_south_facing_wall_is_right_handed_with_tangent_east():
    frames = panel_frames(SOUTH_WALL)
    np.testing.assert_allclose(frames.normals[0], [0.0, -1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(frames.tangents[0], [1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(frames.bitangents[0], [0.0, 0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(frames.centroids[0], [0.0, 0.0, 10.0])


def test_horizontal_panel_takes_east_as_its_tangent():
    frames = panel_frames(SKYLIGHT)
    np.testing.assert_allclose(frames.normals[0], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(frames.tangents[0], [1.0, 0.0, 0.0])
    np.testing.assert_allclose(frames.bitangents[0], [0.0, 1.0, 0.0])


@pytest.mark.parametrize("tilt", [0.0, 1e-9, 9e-7, 1.1e-6, 1e-3])
def test_nearly_horizontal_panels_keep_a_right_handed_unit_frame(tilt):
    corners = SKYLIGHT.copy()
    corners[0, 2:, 2] += 2.0 * tilt
    frames = panel_frames(corners)
    axes = np.stack([frames.tangents[0], frames.bitangents[0], frames.normals[0]])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=2e-6)
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=2e-6)


def test_panel_without_area_is_refused():
    with pytest.raises(ValueError, match="no area"):
        panel_frames(np.zeros((1, 4, 3)))


@pytest.mark.parametrize(
    ("offset", "section"),
    [
        # d = offset / |offset| seen from the centroid of the south wall: theta from the south, phi from the east to up.
        ((0.0, -10.0, 0.0), 0),  # at the pole: theta 0, phi by convention 0
        ((3.0, -10.0, 0.1), 0),  # theta 17, phi 2
        ((-3.0, -10.0, -0.1), 6),  # phi 182
        ((10.0, -10.0, 1.0), 12),  # theta 45, phi 6
        ((0.1, -1.0, 10.0), 26),  # theta 84, phi 89
        ((-0.1, -1.0, -10.0), 24 + 8),  # phi 269
        ((0.1, -1.0, -10.0), 24 + 9),  # phi 271
    ],
)
def test_sections_of_worked_examples(offset, section):
    frames = panel_frames(SOUTH_WALL)
    point = frames.centroids[0] + np.array(offset)
    assert sections_of(point[None], frames, SectionGrid(30.0))[0, 0] == section


def test_points_on_or_behind_the_panel_plane_and_at_its_centroid_are_not_seen():
    frames = panel_frames(SOUTH_WALL)
    points = frames.centroids[0] + np.array([[0.0, 5.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -3.0]])
    assert (sections_of(points, frames, SectionGrid(30.0)) == NOT_SEEN).all()


@given(
    offset=st.tuples(*[st.floats(-50.0, 50.0).filter(lambda x: abs(x) > 1e-3)] * 3),
    tilt=st.floats(-1.2, 1.2),
    turn=st.floats(-3.0, 3.0),
    step=st.sampled_from(STEPS),
)
def test_sections_agree_with_mpmath_away_from_borders(offset, tilt, turn, step):
    across = np.array([math.cos(turn), math.sin(turn), 0.0])
    up = np.array([-math.sin(turn) * math.sin(tilt), math.cos(turn) * math.sin(tilt), math.cos(tilt)])
    corners = np.array([[-across - up, across - up, across + up, -across + up]])
    frames = panel_frames(corners)
    n, t, b = (mpmath.matrix(axis[0].tolist()) for axis in (frames.normals, frames.tangents, frames.bitangents))
    with mpmath.workdps(40):
        d = mpmath.matrix(offset) / mpmath.norm(mpmath.matrix(offset))
        theta = mpmath.degrees(mpmath.acos((d.T * n)[0]))
        phi = mpmath.degrees(mpmath.atan2((d.T * b)[0], (d.T * t)[0])) % 360
        near_border = min(abs(x / step - mpmath.nint(x / step)) for x in (theta, phi)) < 1e-7
        expected = int(mpmath.floor(theta / step) * (360 / step) + mpmath.floor(phi / step)) if theta < 90 else NOT_SEEN
    section = sections_of(frames.centroids + np.array([offset]), frames, SectionGrid(step))[0, 0]
    assert near_border or section == expected


@pytest.mark.parametrize("step", STEPS)
def test_solid_angles_add_up_to_the_hemisphere_and_polar_ring_is_smallest(step):
    grid = SectionGrid(step)
    solid_angles = grid.solid_angles_sr()
    assert solid_angles.sum() == pytest.approx(2.0 * math.pi)
    assert len(solid_angles) == grid.n_sections
    assert solid_angles[0] == solid_angles.min()


def test_ring_at_the_pole_has_about_a_seventh_of_the_ring_at_the_horizon_at_15_degrees():
    solid_angles = SectionGrid(15.0).solid_angles_sr()
    assert solid_angles[-1] / solid_angles[0] == pytest.approx(7.6, abs=0.1)


@pytest.mark.parametrize("step", [0.0, -30.0, 7.0, 60.0, 91.0, 0.5, math.nan, math.inf])
def test_steps_that_do_not_divide_90_are_refused(step):
    with pytest.raises(ValueError, match="section_step_deg"):
        SectionGrid(step)


def test_point_on_the_border_of_the_picture_counts_and_behind_the_camera_does_not():
    views = ViewpointArrays(np.zeros((1, 3)), np.zeros(1), np.zeros(1))  # looks north
    half = CAMERA.half_width
    points = np.array([[0.0, 1.0, 0.0], [half, 1.0, 0.0], [half * (1 + 1e-9), 1.0, 0.0], [0.0, -1.0, 0.0], [0, 0, 0]])
    assert in_picture(views, points, CAMERA)[0].tolist() == [True, True, False, False, False]


def test_whole_panel_and_largest_distance_only_take_views_away():
    rng = np.random.default_rng(0)
    positions = rng.uniform([-20, -30, 0], [20, -2, 25], (300, 3))
    views = ViewpointArrays(positions, rng.uniform(-0.5, 0.5, 300), rng.uniform(-0.5, 0.5, 300))
    frames, grid = panel_frames(SOUTH_WALL), SectionGrid(30.0)
    plain = sections_seen(views, frames, CAMERA, grid)
    for options in ({"whole_panel": True}, {"max_distance_m": 15.0}):
        fewer = sections_seen(views, frames, CAMERA, grid, **options)
        assert 0 < (fewer != NOT_SEEN).sum() < (plain != NOT_SEEN).sum()
        assert (fewer[fewer != NOT_SEEN] == plain[fewer != NOT_SEEN]).all()
