"""Outlines of sections: where the definition of sections puts them, and as large as they are."""

import numpy as np
import pytest

from planning.coverage.sections import SectionGrid, panel_frames, sections_of
from planning.insight.sections import in_enu, section_shapes
from planning.site.bundled import SCENES
from planning.site.records import panel_corners

STEPS_DEG = [30.0, 15.0, 5.0, 90.0]


@pytest.fixture(params=["office", "roof", "tower"])
def frames(request):
    return panel_frames(panel_corners(SCENES[request.param]().site))


@pytest.mark.parametrize("step_deg", STEPS_DEG)
def test_points_just_inside_an_outline_lie_in_its_section(frames, step_deg):
    grid = SectionGrid(step_deg)
    shapes = section_shapes(grid)
    # A quarter-turn section is no fan around its middle: the points at its pole stay out.
    towards = 1e-4 * (shapes.directions_panel[:, None] - shapes.outlines_panel)
    inside = shapes.outlines_panel + towards
    panels = np.array([0, len(frames) - 1])
    points = in_enu(inside, frames, panels)
    for panel, directions in zip(panels, points, strict=True):
        one = panel_frames(frames.corners[panel : panel + 1])
        found = sections_of((one.centroids + 20.0 * directions.reshape(-1, 3)), one, grid)[:, 0]
        expected = np.repeat(np.arange(grid.n_sections), inside.shape[1])
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("step_deg", STEPS_DEG)
def test_rings_sectors_and_middles_are_those_of_the_definition(step_deg):
    grid = SectionGrid(step_deg)
    shapes = section_shapes(grid)
    for section in (0, 1, grid.n_sectors - 1, grid.n_sections - 1):
        low_theta, high_theta, low_phi, high_phi = grid.bounds_rad(section)
        assert shapes.ring[section] == round(low_theta / np.radians(step_deg))
        assert shapes.sector[section] == round(low_phi / np.radians(step_deg))
        x, y, z = shapes.directions_panel[section]
        assert np.arccos(z) == pytest.approx((low_theta + high_theta) / 2)
        assert np.arctan2(y, x) % (2 * np.pi) == pytest.approx((low_phi + high_phi) / 2)


@pytest.mark.parametrize("step_deg", [30.0, 15.0, 5.0])
def test_outlines_enclose_the_solid_angles_of_their_sections_counter_clockwise(step_deg):
    grid = SectionGrid(step_deg)
    shapes = section_shapes(grid, steps_per_side=24)
    p, middle = shapes.outlines_panel, shapes.directions_panel
    # A fan of spherical triangles around the middle (Van Oosterom and Strackee, 1983); positive when counter-clockwise.
    a, b, c = middle[:, None], p, np.roll(p, -1, axis=1)
    volume = np.einsum("skc,skc->sk", np.cross(b, c), np.broadcast_to(a, b.shape))
    corners = 1.0 + (a * b).sum(-1) + (b * c).sum(-1) + (c * a).sum(-1)
    areas = (2.0 * np.arctan2(volume, corners)).sum(axis=1)
    np.testing.assert_allclose(areas, grid.solid_angles_sr(), rtol=2e-3)


def test_vectors_in_enu_are_turned_by_each_panels_own_axes_and_stay_unit(frames):
    shapes = section_shapes(SectionGrid(30.0))
    panels = np.array([3, 0, 3])
    turned = in_enu(shapes.directions_panel, frames, panels)
    assert turned.shape == (3, 36, 3)
    np.testing.assert_allclose(np.linalg.norm(turned, axis=-1), 1.0)
    np.testing.assert_allclose(turned @ frames.normals[3], np.stack([turned[i] @ frames.normals[3] for i in range(3)]))
    np.testing.assert_allclose(turned[0] @ frames.normals[3], shapes.directions_panel[:, 2], atol=1e-12)
    np.testing.assert_allclose(turned[1] @ frames.tangents[0], shapes.directions_panel[:, 0], atol=1e-12)
    np.testing.assert_array_equal(turned[0], turned[2])
    assert in_enu(shapes.outlines_panel, frames, np.zeros(0, np.int64)).shape == (0, 36, 16, 3)


def test_on_the_disc_a_south_facade_has_east_to_the_right_and_up_above():
    frames = panel_frames(panel_corners(SCENES["office"]().site))
    shapes = section_shapes(SectionGrid(30.0))
    np.testing.assert_allclose(frames.tangents[0], [1.0, 0.0, 0.0], atol=1e-12)
    # The outermost section straight to the right and the one straight up.
    right, up = 2 * 12 + 0, 2 * 12 + 3
    assert shapes.outlines_disc[right, :, 0].min() > 0.5
    assert shapes.outlines_disc[up, :, 1].min() > 0.5
    east = in_enu(shapes.directions_panel[[right, up]], frames, np.array([0]))[0]
    assert east[0, 0] > 0.8
    assert east[1, 2] > 0.8
    assert np.linalg.norm(shapes.outlines_disc, axis=-1).max() == pytest.approx(1.0)


def test_outlines_of_ten_thousand_panels_are_made_for_those_asked_for_only():
    frames = panel_frames(np.repeat(panel_corners(SCENES["single-panel"]().site), 10_000, axis=0))
    shapes = section_shapes(SectionGrid(5.0))
    assert in_enu(shapes.outlines_panel, frames, np.array([9_999])).shape == (1, 1296, 16, 3)


def test_sides_without_steps_are_refused():
    with pytest.raises(ValueError, match="steps_per_side: expected 1 or more, got 0"):
        section_shapes(SectionGrid(30.0), 0)
