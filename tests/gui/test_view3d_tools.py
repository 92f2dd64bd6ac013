"""The tools of the 3-D view, state by state: pointers and keys in, plain values out."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.gui.view3d.drawing_tools import BoxState, BoxTool, PolygonTool, RectangleState, RectangleTool
from groundstation.gui.view3d.orbit import Orbit
from groundstation.gui.view3d.picking import PickIndex
from groundstation.gui.view3d.site_scene import site_scene
from groundstation.gui.view3d.tools import DragState, Hint, HomeTool, Key, Pointer, PointTool, ViewpointTool
from groundstation.gui.widgets.theme import LIGHT
from planning.geo.frames import camera_axes
from planning.site.bundled import library, office

VIEW = Orbit((0.0, 0.0, 20.0), 180.0, 20.0, -25.0).pinhole(1280, 720)


@pytest.fixture(scope="module")
def index():
    return PickIndex(site_scene(office(), LIGHT))


@pytest.fixture(scope="module")
def at(index):
    """A pointer at a point of the scene, as the view makes it."""

    def pointer(point, shift=False, view=VIEW, index=index):
        (x, y), _ = view.project(np.array(point, float))
        ray = view.ray(x, y)
        return Pointer(view, x, y, ray, index.surface(view.eye_enu_m, ray), index.ground(view.eye_enu_m, ray), shift)

    return pointer


SKY = Pointer(VIEW, 5.0, 5.0, VIEW.ray(5.0, -2000.0))


def test_point_tool_ends_with_the_surface_under_the_click(at):
    tool = PointTool()
    assert tool.hint is Hint.CLICK_POINT
    picked = tool.click(at((0.05, -0.05, 20.0)))
    assert picked.point_enu_m == pytest.approx((0.05, -0.05, 20.0), abs=0.1)
    assert picked.normal == pytest.approx((0.0, -1.0, 0.0), abs=1e-9)
    assert picked.item_id.startswith("A-")


def test_point_tool_takes_the_ground_and_says_when_nothing_is_there(at):
    tool = PointTool()
    assert tool.click(SKY) is None
    assert tool.hint is Hint.NOTHING_THERE
    assert tool.click(at((-40.0, -40.0, 0.0))).point_enu_m == pytest.approx((-40.0, -40.0, 0.0), abs=1e-3)


def test_home_tool_stands_on_ground_and_roof_but_not_on_a_wall(at):
    assert HomeTool().click(at((30.0, -30.0, 0.0))).point_enu_m == pytest.approx((30.0, -30.0, 0.0), abs=1e-3)
    roof = HomeTool().click(at((0.0, 9.0, 43.0)))
    assert roof.point_enu_m == pytest.approx((0.0, 9.0, 43.0), abs=1e-3)
    wall = HomeTool().click(at((0.0, -0.05, 20.0)))
    assert wall.point_enu_m[2] == 0.0


def test_rectangle_tool_gives_three_corners_of_a_rectangle_on_the_wall(at):
    tool = RectangleTool(3, 4)
    assert tool.hint is Hint.CLICK_LOWER_LEFT
    assert tool.click(at((-10.0, -0.05, 5.0))) is None
    assert tool.state is RectangleState.LOWER_RIGHT
    assert tool.click(at((10.0, -0.05, 5.3))) is None
    assert tool.state is RectangleState.UPPER_LEFT
    tool.move(at((-8.0, -0.05, 25.0)))
    assert len(tool.preview.lines) == 5 + 4
    assert tool.preview.lengths_m == pytest.approx((20.0, 20.0), abs=0.1)
    done = tool.click(at((-8.0, -0.05, 25.0)))
    low, right, up = (np.array(c) for c in (done.lower_left_enu_m, done.lower_right_enu_m, done.upper_left_enu_m))
    assert low == pytest.approx([-10.0, -0.05, 5.0], abs=1e-3)
    assert right == pytest.approx([10.0, -0.05, 5.0], abs=1e-2), "an edge that is nearly level is made level"
    assert up == pytest.approx([-10.0, -0.05, 25.0], abs=1e-2)
    assert (right - low) @ (up - low) == pytest.approx(0.0, abs=1e-2)


def test_rectangle_tool_keeps_a_slope_with_shift_and_a_steep_one_anyway(at):
    for end, shift, rise in (((10.0, -0.05, 5.4), True, 0.4), ((10.0, -0.05, 15.0), False, 10.0)):
        tool = RectangleTool()
        tool.click(at((-10.0, -0.05, 5.0)))
        tool.click(at(end, shift))
        tool.move(at((-10.0, -0.05, 25.0)))
        value = tool.value
        assert value.lower_right_enu_m[2] - value.lower_left_enu_m[2] == pytest.approx(rise, abs=0.05)
        edges = np.array([value.lower_right_enu_m, value.upper_left_enu_m]) - value.lower_left_enu_m
        assert edges[0] @ edges[1] == pytest.approx(0.0, abs=0.05)


def test_rectangle_tool_goes_on_beside_the_wall_and_back_with_backspace(at):
    tool = RectangleTool()
    assert tool.click(SKY) is None
    assert (tool.state, tool.hint) == (RectangleState.LOWER_LEFT, Hint.NOTHING_THERE)
    tool.click(at((-10.0, -0.05, 5.0)))
    tool.click(at((-10.0, -0.05, 5.0)))
    assert tool.state is RectangleState.LOWER_RIGHT, "an edge without length is no edge"
    tool.click(at((40.0, 0.0, 5.0)))
    assert tool.state is RectangleState.UPPER_LEFT
    tool.press_key(Key.BACK, False)
    assert tool.state is RectangleState.LOWER_RIGHT
    tool.press_key(Key.BACK, False)
    assert tool.state is RectangleState.LOWER_LEFT
    tool.press_key(Key.BACK, False)
    assert tool.state is RectangleState.LOWER_LEFT


def test_rectangle_on_a_curved_facade_lies_in_the_plane_of_its_first_click():
    index = PickIndex(site_scene(library(), LIGHT))
    view = Orbit((0.0, -30.0, 12.0), 80.0, 0.0, -5.0).pinhole(1280, 720)

    def pointer(x, y):
        ray = view.ray(x, y)
        return Pointer(view, x, y, ray, index.surface(view.eye_enu_m, ray), None)

    tool = RectangleTool()
    tool.click(pointer(600.0, 420.0))
    normal = tool._normal
    tool.click(pointer(760.0, 420.0))
    tool.move(pointer(600.0, 250.0))
    value = tool.value
    edges = np.array([value.lower_right_enu_m, value.upper_left_enu_m]) - value.lower_left_enu_m
    assert edges @ normal == pytest.approx([0.0, 0.0], abs=1e-2)
    assert np.cross(edges[0], edges[1]) @ normal > 0.0, "seen from outside"


def test_rectangle_without_rows_is_refused():
    with pytest.raises(ValueError, match="at least one row"):
        RectangleTool(0, 3)


GROUND = ((-30.0, -60.0), (30.0, -60.0), (30.0, -20.0), (-30.0, -20.0))


def test_polygon_tool_ends_with_enter_or_at_its_first_corner(at):
    for ending in ("enter", "first corner"):
        tool = PolygonTool()
        for x, y in GROUND:
            assert tool.click(at((x, y, 0.0))) is None
        assert tool.hint is Hint.CLICK_MORE_CORNERS
        done = tool.press_key(Key.CONFIRM, False) if ending == "enter" else tool.click(at((*GROUND[0], 0.0)))
        assert np.array(done.corners_enu_m) == pytest.approx(np.array(GROUND), abs=1e-3)


def test_polygon_tool_refuses_a_side_that_crosses_another(at):
    tool = PolygonTool()
    for x, y in (GROUND[0], GROUND[1], GROUND[2]):
        tool.click(at((x, y, 0.0)))
    tool.move(at((0.0, -65.0, 0.0)))
    assert tool.preview.is_refused
    assert tool.hint is Hint.POLYGON_CROSSES
    tool.click(at((0.0, -65.0, 0.0)))
    assert len(tool.value.corners_enu_m) == 3


def test_polygon_tool_refuses_a_last_side_that_crosses_and_goes_on(at):
    tool = PolygonTool()
    for corner in ((-30.0, -60.0), (30.0, -60.0), (-30.0, -20.0), (30.0, -20.0)):
        tool.click(at((*corner, 0.0)))
    assert tool.press_key(Key.CONFIRM, False) is None
    assert tool.hint is Hint.POLYGON_CROSSES
    tool.press_key(Key.BACK, False)
    assert len(tool.press_key(Key.CONFIRM, False).corners_enu_m) == 3


def test_polygon_of_two_corners_does_not_end(at):
    tool = PolygonTool()
    tool.click(at((0.0, -40.0, 0.0)))
    tool.click(at((0.0, -40.0, 0.0)))
    tool.click(at((10.0, -40.0, 0.0)))
    assert tool.press_key(Key.CONFIRM, False) is None
    assert tool.click(SKY) is None
    assert tool.hint is Hint.NOTHING_THERE


def test_box_tool_takes_two_corners_and_a_height(at):
    tool = BoxTool()
    tool.click(at((30.0, -20.0, 0.0)))
    assert tool.state is BoxState.OPPOSITE
    tool.click(at((20.0, -40.0, 0.0)))
    assert tool.state is BoxState.HEIGHT
    assert tool.click(at((20.0, -40.0, 0.0))) is None, "a box without height is none"
    tool.move(at((20.0, -40.0, 12.0)))
    assert len(tool.preview.lines) == 6
    done = tool.click(at((20.0, -40.0, 12.0)))
    assert done.min_enu_m == pytest.approx((20.0, -40.0, 0.0), abs=1e-3)
    assert done.max_enu_m == pytest.approx((30.0, -20.0, 12.0), abs=1e-2)


def test_box_tool_goes_back_and_refuses_a_base_without_area(at):
    tool = BoxTool()
    assert tool.click(SKY) is None
    assert tool.hint is Hint.NOTHING_THERE
    tool.click(at((30.0, -20.0, 0.0)))
    tool.click(at((30.0, -40.0, 0.0)))
    assert tool.state is BoxState.OPPOSITE
    tool.click(at((20.0, -40.0, 0.0)))
    for state in (BoxState.OPPOSITE, BoxState.CORNER, BoxState.CORNER):
        tool.press_key(Key.BACK, False)
        assert tool.state is state


def straight_down(view_point):
    return Orbit(view_point, 50.0, 0.0, -90.0).pinhole(1000, 1000)


@pytest.mark.parametrize("focus", [(0.0, 0.0, 0.0), (40.0, -30.0, 0.0)])
def test_a_box_drawn_from_straight_above_gets_the_height_that_the_pointer_moves_up(focus):
    view = straight_down(focus)
    tool = BoxTool()

    def pointer(x, y):
        ray = view.ray(x, y)
        return Pointer(view, x, y, ray, None, view.eye_enu_m - view.eye_enu_m[2] / ray[2] * ray)

    tool.click(pointer(400.0, 400.0))
    tool.click(pointer(500.0, 500.0))
    tool.move(pointer(500.0, 500.0))
    assert tool.value is None
    tool.move(pointer(500.0, 520.0))
    assert tool.value is None, "there is nothing below the ground"
    tool.move(pointer(520.0, 300.0))
    metres_per_px = (tool.value.max_enu_m[0] - tool.value.min_enu_m[0]) / 100.0
    assert tool.value.max_enu_m[2] == pytest.approx(200.0 * metres_per_px)


POSITION = (5.0, -20.0, 15.0)
poses = st.tuples(st.floats(-math.pi, math.pi), st.floats(-1.5, 0.6))


def pointer_at_px(x, y, shift=False):
    return Pointer(VIEW, x, y, VIEW.ray(x, y), shift=shift)


@given(poses, st.floats(-80.0, 80.0), st.floats(-80.0, 80.0))
def test_a_dragged_viewpoint_stays_under_the_pointer(pose, dx, dy):
    tool = ViewpointTool("v1", POSITION, *pose)
    (x, y), depth = VIEW.project(np.array(POSITION))
    assert tool.grabs(pointer_at_px(x, y))
    assert tool.state is DragState.HELD
    tool.move(pointer_at_px(x + dx, y + dy))
    moved = tool.release(pointer_at_px(x + dx, y + dy))
    pixel, after = VIEW.project(np.array(moved.position_enu_m))
    assert pixel == pytest.approx([x + dx, y + dy], abs=0.05)
    assert after == pytest.approx(float(depth), abs=1e-3)
    assert tool.state is DragState.IDLE


@given(poses, st.floats(-80.0, 80.0), st.floats(-80.0, 80.0))
def test_with_shift_it_moves_along_its_line_of_sight_and_nowhere_else(pose, dx, dy):
    tool = ViewpointTool("v1", POSITION, *pose)
    (x, y), _ = VIEW.project(np.array(POSITION))
    tool.grabs(pointer_at_px(x, y))
    moved = tool.release(pointer_at_px(x + dx, y + dy, shift=True))
    way = np.array(moved.position_enu_m) - POSITION
    forward, _, _ = camera_axes(*pose)
    assert np.linalg.norm(np.cross(way, forward)) < 1e-3
    assert np.isfinite(way).all()


def test_drags_that_start_elsewhere_are_not_the_tools():
    tool = ViewpointTool("v1", POSITION, 0.0, 0.0)
    (x, y), _ = VIEW.project(np.array(POSITION))
    assert not tool.grabs(pointer_at_px(x + 40.0, y))
    tool.move(pointer_at_px(x + 90.0, y))
    assert tool.value.position_enu_m == POSITION


@pytest.mark.parametrize(
    ("key", "axis", "sign"),
    [
        (Key.RIGHT, 1, 1),
        (Key.LEFT, 1, -1),
        (Key.UP, 2, 1),
        (Key.DOWN, 2, -1),
        (Key.NEARER, 0, 1),
        (Key.FARTHER, 0, -1),
    ],
)
def test_keys_move_a_viewpoint_by_a_metre_and_finely_by_a_tenth(key, axis, sign):
    tool = ViewpointTool("v1", POSITION, 0.4, -0.2)
    way = np.array(tool.press_key(key, False).position_enu_m) - POSITION
    assert way == pytest.approx(sign * camera_axes(0.4, -0.2)[axis], abs=1e-3)
    fine = np.array(tool.press_key(key, True).position_enu_m) - POSITION - way
    assert fine == pytest.approx(0.1 * sign * camera_axes(0.4, -0.2)[axis], abs=1e-3)
    assert tool.press_key(Key.CONFIRM, False) is None


def test_a_drag_that_is_cancelled_leaves_the_viewpoint_where_it_was():
    tool = ViewpointTool("v1", POSITION, 0.0, 0.0)
    (x, y), _ = VIEW.project(np.array(POSITION))
    tool.grabs(pointer_at_px(x, y))
    tool.move(pointer_at_px(x + 50.0, y))
    assert tool.press_key(Key.UP, False) is None, "not while it is held"
    tool.cancel()
    assert tool.value.position_enu_m == POSITION
