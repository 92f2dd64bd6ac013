"""The 3-D view as a user has it: real widgets on a virtual screen, real mouse events, pictures looked at by number."""

import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QCoreApplication, QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest

from groundstation.gui.view3d import scene_picture
from groundstation.gui.view3d.drawables import Drawable, Layer
from groundstation.gui.view3d.orbit import Orbit
from groundstation.gui.view3d.paint import ColourScale, flat
from groundstation.gui.widgets.theme import DARK, FACADES, LIGHT, Theme, apply_theme
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem
from planning.coverage.sections import SectionGrid
from planning.geo.frames import camera_axes, wrap_heading_deg
from planning.plan import Viewpoint
from planning.site.bundled import canyon, office, roof, tower
from planning.site.importing.importer import import_site
from planning.site.importing.options import ImportOptions
from tests.benchmarks.view3d import large_plan
from tests.gui.driving import turn_until

SIZE = (900, 600)


@pytest.fixture
def view(application):
    from groundstation.gui.view3d.scene_view import SceneView

    view = SceneView()
    # Pictures are compared pixel by pixel, at rest and on the way.
    view.canvas().smooths_at_rest = False
    view.resize(*SIZE)
    view.show()
    QTest.qWaitForWindowExposed(view)
    QTest.qWait(50)
    yield view
    view.close_view()
    view.deleteLater()
    settle(application)


@pytest.fixture
def plan():
    return large_plan(60)


def settle(application):
    for _ in range(4):
        application.processEvents()


def rest(application, view):
    """As after 200 ms without a movement."""
    view._navigator.rested.emit()
    settle(application)


def picture(application, view):
    settle(application)
    return view.canvas().picture().astype(int)


def differs(a, b):
    return int(np.count_nonzero(np.abs(a - b).max(axis=2) > 12))


def pixel_of(view, point):
    (x, y), _ = view._navigator.pinhole().project(np.array(point, float))
    return QPoint(round(x), round(y))


def hover(view, place):
    """Sent to the widget itself: QTest drops a move to where it believes the pointer to be already."""
    no_button, no_key = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
    globally = QPointF(view.canvas().mapToGlobal(place))
    move = QMouseEvent(QEvent.Type.MouseMove, QPointF(place), globally, no_button, no_button, no_key)
    QCoreApplication.sendEvent(view.canvas(), move)
    view._gestures._hover_now()


def drag(view, start, end, button=Qt.MouseButton.LeftButton, modifier=Qt.KeyboardModifier.NoModifier):
    canvas = view.canvas()
    QTest.mousePress(canvas, button, modifier, start)
    for share in (0.3, 0.6, 1.0):
        step = start + QPoint(round(share * (end - start).x()), round(share * (end - start).y()))
        QTest.mouseMove(canvas, step)
    QTest.mouseRelease(canvas, button, modifier, end)


@pytest.mark.slow
def test_many_changes_are_painted_once_and_none_while_hidden(application, view, plan):
    model = tower()
    settle(application)
    before = view.canvas().n_painted
    view.set_site(model)
    view.set_plan(plan)
    view.set_selection([Item(ItemKind.PANEL, "A-0000")])
    view.look_at_all()
    assert view.canvas().n_painted == before
    settle(application)
    assert before < view.canvas().n_painted <= before + 2, "once, and once more with what stands when it rests"
    view.hide()
    settle(application)
    before = view.canvas().n_painted
    view.set_plan(None)
    view.turn_by_hand(5.0, 0.0)
    settle(application)
    assert view.canvas().n_painted == before


def test_panels_have_the_colour_of_their_facade_where_the_projection_says(application, view):
    from groundstation.gui.view3d.paint import flat, shaded
    from groundstation.gui.view3d.site_scene import glass_colours

    model = office()
    view.set_site(model)
    shown = picture(application, view)
    site = view._site
    wanted = shaded(glass_colours(site.frames, site.facade), site.frames.normals)[:, :3]
    pixels, _ = view._navigator.pinhole().project(site.frames.centroids)
    for (x, y), colour in zip(pixels[::17], wanted[::17].astype(int), strict=True):
        assert np.abs(shown[int(y), int(x)] - colour).max() <= 3
    plain = shaded(flat(FACADES[0], 1), site.frames.normals[:1])[0, :3].astype(int)
    assert np.abs(wanted - plain).max() < 30


def test_values_colour_panels_and_missing_ones_are_grey(application, view):
    from groundstation.gui.view3d.paint import NO_VALUE, ColourScale, rgba, shaded

    view.set_site(office())
    values = np.full(280, np.nan)
    values[140:] = 1.0
    scale = ColourScale("Share", "", 0.0, 1.0)
    view.set_panel_values(scale, values)
    shown = picture(application, view)
    pixels, _ = view._navigator.pinhole().project(view._site.frames.centroids)
    normal = view._site.frames.normals[:1]
    for panel, colour in ((30, rgba(NO_VALUE)), (200, scale.colours(np.ones(1))[0])):
        x, y = pixels[panel].astype(int)
        assert np.abs(shown[y, x] - shaded(colour[None], normal)[0, :3]).max() <= 3
    plain = picture(application, view)
    view.set_panel_values(None)
    assert differs(plain, picture(application, view)) > 1000
    with pytest.raises(ValueError, match="each of 280 panels"):
        view.set_panel_values(scale, values[:5])


@pytest.mark.slow
def test_hemispheres_are_painted_and_taken_away(application, view):
    view.set_site(office())
    plain = picture(application, view)
    states = np.zeros((280, 36), np.int64)
    states[:, ::2] = 2
    view.paint_hemispheres(SectionGrid(30.0), states)
    painted = picture(application, view)
    assert differs(plain, painted) > 3000
    view.set_selection([Item(ItemKind.PANEL, "A-0150")])
    assert differs(painted, picture(application, view)) > 300, "the selected panel's large dome is not drawn"
    view.set_selection(())
    view.paint_hemispheres(None)
    assert differs(plain, picture(application, view)) < 50
    with pytest.raises(ValueError, match=r"expected shape \(280, 36\)"):
        view.paint_hemispheres(SectionGrid(30.0), states[:, :3])


@pytest.mark.slow
def test_layers_are_hidden_and_shown(application, view, plan):
    from groundstation.gui.view3d.drawables import Layer

    view.set_site(canyon())
    view.set_plan(plan)
    view.look_at_all()
    full = picture(application, view)
    for layer in (Layer.PANELS, Layer.BUILDING, Layer.OBSTACLES, Layer.VIEWPOINTS, Layer.ROUTES, Layer.HOME):
        view.set_layer_visible(layer, False)
        assert not view.is_layer_visible(layer)
        assert differs(full, picture(application, view)) > 20, layer
        view.set_layer_visible(layer, True)
    assert differs(full, picture(application, view)) == 0


def test_hovering_and_clicking_name_the_panel_under_the_pointer(application, view):
    view.set_site(office())
    rest(application, view)
    view._pick_index()
    hovered, picked = [], []
    view.hovered.connect(hovered.append)
    view.picked.connect(lambda item, modifiers: picked.append((item, modifiers)))
    place = pixel_of(view, view._site.frames.centroids[123])
    hover(view, place)
    assert hovered == [Item(ItemKind.PANEL, "A-0123")]
    assert view._overlay._tip.text == "Panel A-0123"
    QTest.mouseClick(view.canvas(), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier, place)
    assert picked == [(Item(ItemKind.PANEL, "A-0123"), Qt.KeyboardModifier.ShiftModifier)]
    QTest.mouseClick(view.canvas(), Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, QPoint(3, 3))
    assert picked[-1][0] is None
    application.sendEvent(view.canvas(), QEvent(QEvent.Type.Leave))
    assert hovered[-1] is None


@pytest.mark.slow
def test_selection_and_hover_are_marked_in_the_picture(application, view, plan):
    view.set_site(office())
    view.set_plan(plan)
    plain = picture(application, view)
    for item in (
        Item(ItemKind.PANEL, "A-0123"),
        Item(ItemKind.FACADE, "A"),
        Item(ItemKind.BUILDING),
        Item(ItemKind.HOME),
        Item(ItemKind.AIRSPACE),
        Item(ItemKind.SORTIE, "1"),
        Item(ItemKind.LEG, "1/3"),
        Item(ItemKind.VIEWPOINT, "v0010"),
    ):
        view.set_selection([item])
        view.look_at(item)
        marked = picture(application, view)
        view.set_selection(())
        assert differs(marked, picture(application, view)) > 15, item
        view.look_at_all()
    view.set_hover(Item(ItemKind.PANEL, "A-0123"))
    assert differs(plain, picture(application, view)) > 5


def test_items_that_are_not_there_are_no_trouble(application, view):
    view.set_site(roof())
    before = view.orbit()
    for item in (Item(ItemKind.PANEL, "nothing"), Item(ItemKind.LEG, "7/x"), Item(ItemKind.VIEWPOINT, "v9")):
        view.set_selection([item])
        view.look_at(item)
    assert view.orbit() == before
    view.set_site(None)
    view.set_selection([Item(ItemKind.HOME)])
    view.look_at_all()
    assert view.pick_at(10.0, 10.0) is None
    settle(application)


def test_dragging_turns_shifts_and_zooms_and_others_can_follow(application, view):
    view.set_site(office())
    heard = []
    view.orbitChanged.connect(heard.append)
    start, before = QPoint(300, 300), view.orbit()
    drag(view, start, QPoint(400, 300))
    turned = view.orbit()
    assert turned.heading_deg == pytest.approx(before.heading_deg + 35.0, abs=1.0)
    assert turned.focus_enu_m == before.focus_enu_m
    drag(view, start, QPoint(360, 340), Qt.MouseButton.RightButton)
    assert view.orbit().focus_enu_m != turned.focus_enu_m
    assert view.orbit().heading_deg == turned.heading_deg
    anchor = view._site.frames.centroids[140]
    place = pixel_of(view, anchor)
    wheel = QWheelEvent(
        QPointF(place),
        QPointF(view.canvas().mapToGlobal(place)),
        QPoint(),
        QPoint(0, 240),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    distance = view.orbit().distance_m
    application.sendEvent(view.canvas(), wheel)
    assert view.orbit().distance_m == pytest.approx(distance / 1.15**2)
    assert (pixel_of(view, anchor) - place).manhattanLength() <= 2
    assert heard[-1] == view.orbit()
    n_heard = len(heard)
    view.set_orbit(before)
    assert (view.orbit(), len(heard)) == (before, n_heard)


@pytest.mark.slow
def test_two_fingers_shift_and_zoom(application, view):
    view.set_site(office())
    before = view.orbit()
    device = QTest.createTouchDevice()
    canvas = view.canvas()
    QTest.touchEvent(canvas, device).press(0, QPoint(300, 300), canvas).press(1, QPoint(500, 300), canvas).commit()
    QTest.touchEvent(canvas, device).move(0, QPoint(250, 300), canvas).move(1, QPoint(550, 300), canvas).commit()
    QTest.touchEvent(canvas, device).release(0, QPoint(250, 300), canvas).release(1, QPoint(550, 300), canvas).commit()
    assert view.orbit().distance_m == pytest.approx(before.distance_m * 200.0 / 300.0, rel=0.02)
    QTest.touchEvent(canvas, device).press(0, QPoint(300, 300), canvas).commit()
    QTest.touchEvent(canvas, device).move(0, QPoint(340, 300), canvas).commit()
    QTest.touchEvent(canvas, device).release(0, QPoint(340, 300), canvas).commit()
    assert view.orbit().heading_deg != before.heading_deg


def test_keys_turn_zoom_and_show_everything(application, view):
    view.set_site(office())
    view.canvas().setFocus()
    start = view.orbit()
    QTest.keyClick(view.canvas(), Qt.Key.Key_Right)
    QTest.keyClick(view.canvas(), Qt.Key.Key_Up)
    assert view.orbit().heading_deg != start.heading_deg
    assert view.orbit().pitch_deg < start.pitch_deg
    QTest.keyClick(view.canvas(), Qt.Key.Key_Plus)
    assert view.orbit().distance_m < start.distance_m
    QTest.keyClick(view.canvas(), Qt.Key.Key_F)
    assert view.orbit() == start


def test_keys_that_mean_something_to_vtk_mean_nothing_here(application, view):
    view.set_site(office())
    before = picture(application, view)
    for key in "wqesrpc3":
        QTest.keyClick(view.canvas(), key)
    assert differs(before, picture(application, view)) == 0
    assert view.isVisible()


@pytest.mark.slow
def test_domes_follow_the_view_once_it_is_at_rest(application, view):
    view.set_site(tower())
    view.paint_hemispheres(SectionGrid(30.0), np.tile(np.arange(36) % 5, (3640, 1)))
    view.look_at(Item(ItemKind.PANEL, "C-0400"))
    view._navigator.stop()  # a busy machine takes longer for the next picture than the view to come to rest
    on_the_way = picture(application, view)
    rest(application, view)
    assert differs(on_the_way, picture(application, view)) > 1000


def test_standard_views_look_from_where_they_say(application, view):
    from groundstation.gui.view3d.scene_view import StandardView

    view.set_site(office())
    view.look_from(StandardView.TOP)
    assert view.orbit().pitch_deg == -90.0
    view.look_from(StandardView.FRONT)
    assert view.orbit().heading_deg == pytest.approx(0.0, abs=1e-6), "the facade looks south, so the view looks north"
    view.look_from(StandardView.HOME)
    assert view.orbit().eye_enu_m[1] < -45.0


def test_an_item_is_looked_at_from_before_what_stands_in_the_way(application, view):
    view.set_site(canyon())
    item = Item(ItemKind.PANEL, "A-0005")
    view.look_at(item)
    (x, y), _ = view._navigator.pinhole().project(view._site.frames.centroids[5])
    assert view.pick_at(x, y).item == item


def inside(view, points_enu_m):
    pixels, depths = view._navigator.pinhole().project(np.asarray(points_enu_m))
    return bool((depths > 0.0).all() and (pixels >= 0.0).all() and (pixels <= [view.width(), view.height()]).all())


@pytest.mark.few(1)
@pytest.mark.parametrize(("heading_deg", "pitch_deg"), [(0.0, 0.0), (25.0, 10.0), (-40.0, -20.0)])
def test_a_viewpoint_is_looked_at_together_with_what_it_photographs(application, view, plan, heading_deg, pitch_deg):
    view.set_site(office())
    panel = view._site.frames.centroids[view._site.panel_index["A-0123"]]
    forward, _, _ = camera_axes(math.radians(heading_deg), math.radians(pitch_deg))
    eye = panel - 18.0 * forward
    aimed = Viewpoint("v0010", tuple(eye.tolist()), heading_deg, pitch_deg)
    view.set_plan(replace(plan, viewpoints=(*plan.viewpoints[:10], aimed, *plan.viewpoints[11:])))
    view.look_at(Item(ItemKind.VIEWPOINT, "v0010"))
    assert inside(view, [eye, panel])
    assert view.orbit().distance_m < 120.0, "and not from so far that neither can be made out"


def test_a_leg_is_looked_at_together_with_the_panel_it_passes(application, view, plan):
    view.set_site(office())
    view.set_plan(plan)
    ends = np.array(plan.sorties[0].path_enu_m[4:6])
    nearest = np.linalg.norm(view._site.frames.centroids - ends.mean(axis=0), axis=1).argmin()
    view.look_at(Item(ItemKind.LEG, "1/5"))
    assert inside(view, ends)
    assert inside(view, view._site.frames.centroids[[nearest]])


def test_the_view_turns_only_to_see_the_front_of_what_is_looked_at(application, view, plan):
    view.set_site(office())
    view.set_plan(plan)
    viewpoint = plan.viewpoints[10]
    item = Item(ItemKind.VIEWPOINT, viewpoint.id)
    for aside_deg, stays in ((40.0, True), (-40.0, True), (170.0, False)):
        before = Orbit(heading_deg=wrap_heading_deg(viewpoint.heading_deg + aside_deg), pitch_deg=-15.0)
        view.set_orbit(before)
        view.look_at(item)
        assert (view.orbit().heading_deg == before.heading_deg) == stays, aside_deg


def test_a_viewpoint_that_looks_up_is_not_looked_at_from_below(application, view, plan):
    view.set_site(office())
    up = replace(plan.viewpoints[10], gimbal_pitch_deg=30.0)
    view.set_plan(replace(plan, viewpoints=(*plan.viewpoints[:10], up, *plan.viewpoints[11:])))
    view.set_orbit(Orbit(heading_deg=wrap_heading_deg(up.heading_deg + 180.0)))
    view.look_at(Item(ItemKind.VIEWPOINT, up.id))
    assert view.orbit().pitch_deg < 0.0


def test_a_plan_without_a_site_can_be_looked_at(application, view, plan):
    view.set_plan(plan)
    for item in (Item(ItemKind.VIEWPOINT, "v0010"), Item(ItemKind.LEG, "1/5")):
        view.look_at(item)
        settle(application)
    assert inside(view, plan.sorties[0].path_enu_m[4:6])


@pytest.mark.slow
def test_dots_behind_a_wall_are_hidden_by_it_also_once_lines_are_shifted(application, view, plan):
    view.set_site(office())
    scale = ColourScale("Clearance", "m", 10.0, 30.0)
    view.set_plan(plan)
    view.set_route_values(scale, [np.full(len(sortie.path_enu_m), 20.0) for sortie in plan.sorties])
    # From within the scene: the nearest depth drawn is then small, and a step of the depth buffer a long way.
    view.set_orbit(Orbit((0.0, 0.0, 10.0), 45.0, 0.0, -5.0))
    for layer in (Layer.ROUTES, Layer.LABELS, Layer.VIEWPOINTS):
        view.set_layer_visible(layer, False)
    plain = picture(application, view)
    model = view._site.model
    low, high = model.building.vertices_enu_m.min(axis=0), model.building.vertices_enu_m.max(axis=0)
    behind = np.array([[0.5 * (low[0] + high[0]), high[1] + 2.0, 0.5 * (low[2] + high[2])]])
    view.canvas().draw("dots", [Drawable(behind, np.array([[0]]), flat("#ff00ff", 1), width_px=12.0)])
    assert differs(plain, picture(application, view)) == 0
    view.set_layer_visible(Layer.BUILDING, False)
    view.set_layer_visible(Layer.PANELS, False)
    assert differs(plain, picture(application, view)) > 50


def lines(places, colour="#ff00ff", width_px=6.0):
    cells = np.array([[number, number + 1] for number in range(0, len(places), 2)])
    return Drawable(np.array(places, float), cells, flat(colour, len(cells)), width_px=width_px)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "after",
    [
        lines([(0, 0, 4), (9, 0, 4), (0, 0, 9), (9, 0, 1)]),
        lines([(0, 0, 0), (9, 0, 0), (0, 0, 9), (9, 0, 9)], "#00aa00"),
        lines([(0, 0, 0), (9, 0, 0), (0, 0, 9), (9, 0, 9)], width_px=2.0),
        lines([(0, 0, 0), (9, 0, 9)]),
        lines([(0, 0, 0), (900, 0, 0), (0, -300, 9), (9, 0, 9)]),
    ],
    ids=["moved", "recoloured", "thinner", "fewer", "far"],
)
def test_what_replaces_a_drawing_looks_as_if_nothing_was_there(application, view, after):
    before = lines([(0, 0, 0), (9, 0, 0), (0, 0, 9), (9, 0, 9)])
    view.set_orbit(Orbit((4.0, 0.0, 4.0), 30.0, 10.0, -10.0))
    empty = picture(application, view)
    view.canvas().draw("lines", [after])
    fresh = picture(application, view)
    view.canvas().draw("lines", [])
    assert differs(empty, picture(application, view)) == 0
    view.canvas().draw("lines", [before])
    assert differs(fresh, picture(application, view)) > 50
    view.canvas().draw("lines", [after])
    assert differs(fresh, picture(application, view)) == 0
    view.canvas().draw("lines", [])
    assert differs(empty, picture(application, view)) == 0


def test_an_edit_gives_vtk_nothing_new_to_draw(application, view, plan):
    view.set_plan(plan)
    view.look_at_all()
    settle(application)
    actors = set(view.canvas().renderer.actors)
    first = plan.viewpoints[0]
    east, north, up = first.position_enu_m
    edited = replace(plan, viewpoints=(replace(first, position_enu_m=(east, north, up + 5.0)), *plan.viewpoints[1:]))
    before = picture(application, view)
    view.set_plan(edited)
    assert differs(before, picture(application, view)) > 5
    assert set(view.canvas().renderer.actors) == actors


@pytest.mark.slow
def test_after_edits_the_picture_is_that_of_a_view_in_which_nothing_was_drawn_before(application, view, plan):
    view.set_site(office())
    view.set_plan(plan)
    view.look_at_all()
    rng = np.random.default_rng(3)
    for step in range(8):
        views = list(plan.viewpoints)
        number = int(rng.integers(len(views)))
        x, y, z = views[number].position_enu_m
        views[number] = replace(
            views[number],
            position_enu_m=(x + float(rng.normal(0.0, 4.0)), y - float(rng.uniform(0.0, 6.0)), z),
            heading_deg=float(rng.uniform(-60.0, 60.0)),
        )
        chosen = views[number].id
        plan = replace(plan, viewpoints=tuple(views))
        view.set_plan(plan, frozenset({chosen} if step % 2 else ()))
        view.set_selection([Item(ItemKind.VIEWPOINT, chosen)])
    edited, canvas = picture(application, view), view.canvas()
    for name in tuple(canvas._drawn):
        canvas.draw(name, ())
    view._draw_site()
    view._draw_plan()
    assert differs(edited, picture(application, view)) == 0


def test_a_rectangle_is_drawn_with_three_clicks(application, view):
    from groundstation.gui.view3d.drawing_tools import PickedRectangle, RectangleTool

    view.set_site(office())
    rest(application, view)
    moved, finished, ended = [], [], []
    view.toolMoved.connect(moved.append)
    view.toolFinished.connect(finished.append)
    view.toolEnded.connect(lambda: ended.append(True))
    plain = picture(application, view)
    view.start_tool(RectangleTool(4, 5))
    canvas = view.canvas()
    for point in ((-12.0, -0.05, 4.0), (12.0, -0.05, 4.0)):
        QTest.mouseClick(canvas, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, pixel_of(view, point))
    hover(view, pixel_of(view, (-12.0, -0.05, 30.0)))
    view._tools._tell_moved()
    assert isinstance(moved[-1], PickedRectangle)
    assert differs(plain, picture(application, view)) > 500, "the grid is not shown"
    assert "Click the upper edge" in view._overlay._hint
    place = pixel_of(view, (-12.0, -0.05, 30.0))
    QTest.mouseClick(canvas, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, place)
    (done,) = finished
    assert done.lower_left_enu_m == pytest.approx((-12.0, -0.05, 4.0), abs=0.3)
    assert done.upper_left_enu_m == pytest.approx((-12.0, -0.05, 30.0), abs=0.4)
    assert (ended, view.tool()) == ([True], None)
    assert differs(plain, picture(application, view)) == 0


def test_escape_puts_a_tool_away_and_a_drag_turns_the_view_meanwhile(application, view):
    from groundstation.gui.view3d.drawing_tools import PolygonTool

    view.set_site(office())
    rest(application, view)
    finished, ended, picked = [], [], []
    view.toolFinished.connect(finished.append)
    view.toolEnded.connect(lambda: ended.append(True))
    view.picked.connect(lambda item, _modifiers: picked.append(item))
    view.start_tool(PolygonTool())
    canvas = view.canvas()
    QTest.mouseClick(canvas, Qt.MouseButton.LeftButton, pos=pixel_of(view, (10.0, -40.0, 0.0)))
    before = view.orbit()
    drag(view, QPoint(300, 300), QPoint(350, 300))
    assert view.orbit() != before
    QTest.keyClick(canvas, Qt.Key.Key_Escape)
    assert (view.tool(), finished, ended, picked) == (None, [], [True], [])


def test_a_double_click_ends_a_polygon(application, view):
    from groundstation.gui.view3d.drawing_tools import PolygonTool

    view.set_site(office())
    rest(application, view)
    finished = []
    view.toolFinished.connect(finished.append)
    view.start_tool(PolygonTool())
    corners = ((-20.0, -50.0), (20.0, -50.0), (20.0, -25.0))
    for corner in corners:
        QTest.mouseClick(view.canvas(), Qt.MouseButton.LeftButton, pos=pixel_of(view, (*corner, 0.0)))
    QTest.mouseDClick(view.canvas(), Qt.MouseButton.LeftButton, pos=pixel_of(view, (20.0, -25.0, 0.0)))
    (done,) = finished
    assert np.array(done.corners_enu_m) == pytest.approx(np.array(corners), abs=0.4)


def test_a_viewpoint_is_dragged_and_the_drag_taken_back_with_escape(application, view, plan):
    from groundstation.gui.view3d.tools import ViewpointTool

    view.set_site(office())
    view.set_plan(plan)
    view.look_at_all()
    rest(application, view)
    at = plan.viewpoints[5].position_enu_m
    finished, moved = [], []
    view.toolFinished.connect(finished.append)
    view.toolMoved.connect(moved.append)
    view.start_tool(ViewpointTool("v0005", at, 0.3, 0.0))
    start = pixel_of(view, at)
    before = view.orbit()
    drag(view, start, start + QPoint(40, -10))
    (done,) = finished
    assert view.orbit() == before
    assert (pixel_of(view, done.position_enu_m) - start - QPoint(40, -10)).manhattanLength() <= 2
    QTest.keyClick(view.canvas(), Qt.Key.Key_PageUp, Qt.KeyboardModifier.ShiftModifier)
    way = np.array(finished[1].position_enu_m) - np.array(finished[0].position_enu_m)
    assert np.linalg.norm(way) == pytest.approx(0.1, abs=1e-3)
    place = pixel_of(view, finished[1].position_enu_m)
    QTest.mousePress(view.canvas(), Qt.MouseButton.LeftButton, pos=place)
    QTest.mouseMove(view.canvas(), place + QPoint(60, 0))
    QTest.keyClick(view.canvas(), Qt.Key.Key_Escape)
    assert moved[-1] == finished[1]
    QTest.mouseRelease(view.canvas(), Qt.MouseButton.LeftButton, pos=place + QPoint(60, 0))
    assert len(finished) == 2
    QTest.keyClick(view.canvas(), Qt.Key.Key_Escape)
    assert view.tool() is None


@pytest.mark.slow
def test_texts_are_readable_and_the_ground_changes_with_the_theme(application, view):
    from groundstation.gui.view3d.paint import rgba, sky_colour

    try:
        seen = {}
        for theme, look in ((Theme.LIGHT, LIGHT), (Theme.DARK, DARK)):
            apply_theme(application, theme)
            view.set_site(canyon())
            settle(application)
            background = view.canvas().picture()[5, 5]
            sky = sky_colour(look.scene, look.is_dark)
            wanted = 0.5 * (rgba(look.scene)[:3].astype(float) + rgba(sky)[:3])
            assert np.abs(background.astype(int) - wanted).max() <= 2
            seen[theme] = view.screenshot().astype(int)
        assert differs(seen[Theme.LIGHT], seen[Theme.DARK]) > 0.3 * SIZE[0] * SIZE[1]
    finally:
        apply_theme(application, Theme.LIGHT)
        application.setStyleSheet("")


@pytest.mark.slow
def test_the_scale_follows_the_units(application, view):
    view.set_site(office())
    metric = view.screenshot().astype(int)
    view.set_units(UnitSystem.IMPERIAL)
    imperial = view.screenshot().astype(int)
    corner = (slice(-60, None), slice(0, 250))
    assert differs(metric[corner], imperial[corner]) > 20
    assert differs(metric[:-80], imperial[:-80]) == 0


def test_a_moved_site_keeps_the_camera_and_its_values_where_wanted(application, view):
    from groundstation.gui.view3d.paint import ColourScale

    model = office()
    view.set_site(model)
    view.set_panel_values(ColourScale("x", "", 0.0, 1.0), np.linspace(0.0, 1.0, 280))
    view.turn_by_hand(20.0, 3.0)
    orbit = view.orbit()
    view.set_site(replace(model, site=replace(model.site, home_enu_m=(5.0, -40.0, 0.0))), keep_camera=True)
    assert view.orbit() == orbit
    assert view._panel_values is not None
    view.set_site(roof())
    assert view._panel_values is None
    settle(application)


@pytest.mark.slow
def test_what_comes_after_the_view_was_closed_draws_nothing_and_raises_nothing(application, plan):
    from groundstation.gui.view3d.scene_view import SceneView

    view = SceneView()
    view.show()
    view.set_site(office())
    settle(application)
    view.close_view()
    view.set_site(canyon())
    view.set_plan(plan)
    view.paint_hemispheres(SectionGrid(30.0), np.zeros((200, 36), np.int64))
    view.look_at(Item(ItemKind.HOME))
    view.turn_by_hand(5.0, 0.0)
    apply_theme(application, Theme.LIGHT)
    application.setStyleSheet("")
    assert view.pick_at(10.0, 10.0) is None
    view.close_view()
    view.deleteLater()
    settle(application)


@pytest.mark.slow
def test_a_real_building_is_drawn_and_every_panel_in_sight_can_be_picked(application, view, shared_data):
    path = shared_data / "buildings" / "ingolstadt_lod3" / "4018270.xml"
    model = import_site(path, ImportOptions()).model
    view.set_site(model)
    view._pick_index()
    shown = picture(application, view)
    assert (shown.std(axis=(0, 1)) > 5).all()
    view.look_at(Item(ItemKind.FACADE, model.site.facades[0].id))
    found = set()
    pixels, _ = view._navigator.pinhole().project(view._site.frames.centroids)
    for x, y in pixels[np.isfinite(pixels).all(axis=1)]:
        hit = view.pick_at(float(x), float(y))
        if hit is not None and hit.item.kind is ItemKind.PANEL:
            found.add(hit.item.id)
    own = {panel.id for panel in model.site.facades[0].panels}
    assert len(found & own) >= 0.5 * len(own)


def all_in_picture(view):
    pixels, _ = view._navigator.pinhole().project(view._plan.views.positions_enu_m)
    size = view.canvas().width(), view.canvas().height()
    return bool(((pixels >= 0.0) & (pixels <= size)).all())


def test_viewpoints_that_are_cut_off_are_brought_in_from_where_the_view_stands(application, view, plan):
    view.set_site(office())
    settle(application)
    view.set_orbit(view.orbit().zoomed(2.0).turned(20.0, 0.0))
    view.set_plan(plan)
    before = view.orbit()
    assert not all_in_picture(view)
    view.bring_in_viewpoints()
    assert all_in_picture(view)
    assert (view.orbit().heading_deg, view.orbit().pitch_deg) == (before.heading_deg, before.pitch_deg)


@pytest.mark.slow
def test_a_view_that_shows_all_viewpoints_stays_as_it_is(application, view, plan):
    view.set_site(office())
    view.set_plan(plan)
    settle(application)
    view.look_at_all()
    view.set_orbit(view.orbit().zoomed(0.5))
    before = view.orbit()
    view.bring_in_viewpoints()
    assert view.orbit() == before
    view.set_plan(None)
    view.bring_in_viewpoints()
    assert view.orbit() == before


def test_the_view_is_not_taken_out_of_the_users_hand(application, view, plan):
    from groundstation.gui.view3d.navigator import Drag
    from groundstation.gui.view3d.tools import HomeTool

    view.set_site(office())
    settle(application)
    view.set_orbit(view.orbit().zoomed(3.0))
    view.set_plan(plan)
    before = view.orbit()
    view._start_drag(QPointF(100.0, 100.0), Drag.TURN, Qt.KeyboardModifier.NoModifier)
    view.bring_in_viewpoints()
    assert view.orbit() == before, "while it is dragged"
    view._end_drag(QPointF(100.0, 100.0), Qt.KeyboardModifier.NoModifier)
    view.start_tool(HomeTool())
    view.bring_in_viewpoints()
    assert view.orbit() == before, "while a tool is in use"
    view.cancel_tool()
    view.bring_in_viewpoints()
    assert view.orbit() != before


def test_surroundings_are_drawn_with_their_pictures_only_while_their_layer_is_shown(application, view):
    from groundstation.services.scenes.surfaces import Part, Surface

    wanted = []
    view.surroundingsWanted.connect(wanted.append)
    model = office()
    view.set_site(model)
    assert not wanted, "nobody looks at them where a processor draws"
    view.set_layer_visible(Layer.SURROUNDINGS, True)
    assert wanted == [model]
    view.set_layer_visible(Layer.SURROUNDINGS, False)
    before = picture(application, view)
    # A wall before the facade, its lower half green and its upper half red.
    stripes = np.zeros((8, 8, 3), np.uint8)
    stripes[:4, :, 0] = stripes[4:, :, 1] = 255
    left, right, top = (-15.0, -5.0, 0.0), (15.0, -5.0, 0.0), 40.0
    a, b, c, d = left, right, (*right[:2], top), (*left[:2], top)
    uv = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]], np.float32)
    white = np.full((2, 3), 255, np.uint8)
    view.set_surfaces([Surface(Part.SURROUNDINGS, np.array([[a, b, c], [a, c, d]]), white, uv, stripes)])
    view.set_layer_visible(Layer.SURROUNDINGS, True)
    shown = picture(application, view)
    is_red = (shown[..., 0] > 120) & (shown[..., 1] < 60) & (shown[..., 2] < 60)
    is_green = (shown[..., 1] > 120) & (shown[..., 0] < 60) & (shown[..., 2] < 60)
    assert min(is_red.sum(), is_green.sum()) > 5000
    assert np.argwhere(is_red)[:, 0].mean() < np.argwhere(is_green)[:, 0].mean(), "the first row is uppermost"
    view.set_layer_visible(Layer.SURROUNDINGS, False)
    np.testing.assert_array_equal(picture(application, view), before)
    view.set_site(canyon())
    assert wanted == [model]


@pytest.mark.parametrize("uv", [np.zeros((1, 3, 2), np.float32), np.zeros((2, 4, 2), np.float32)])
def test_a_picture_needs_a_place_for_each_corner(uv):
    from groundstation.gui.view3d.drawables import Picture

    points, cells = np.zeros((4, 3)), np.array([[0, 1, 2], [0, 2, 3]])
    with pytest.raises(ValueError, match="uv: expected shape"):
        Drawable(points, cells, flat("#ffffff", 2), picture=Picture(np.zeros((2, 2, 3), np.uint8), uv))


def test_photos_on_panels_are_asked_for_when_there_are_some_and_lie_before_the_panels(application, view):
    from groundstation.services.scenes.surfaces import Part, Surface

    wanted = []
    view.photosWanted.connect(lambda: wanted.append(True))
    view.set_site(office())
    assert not wanted, "there are no photos yet"
    view.offer_photos(True)
    assert wanted == [True]
    corners = view._site.frames.corners
    triangles = corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)
    red = np.tile(np.array([[220, 0, 0]], np.uint8), (len(triangles), 1))
    view.set_panel_photos([Surface(Part.PANES, triangles, red)])
    view.look_at_all()
    shown = picture(application, view)
    assert ((shown[..., 0] > 100) & (shown[..., 1:] < 30).all(axis=2)).sum() > 10_000
    view.set_panel_values(ColourScale("GSD", "mm", 0.0, 1.0), np.zeros(len(corners)))
    shown = picture(application, view)
    assert ((shown[..., 0] > 100) & (shown[..., 1:] < 30).all(axis=2)).sum() == 0, "values are not hidden by photos"
    view.set_panel_values(None)
    view.offer_photos(False)
    shown = picture(application, view)
    assert ((shown[..., 0] > 100) & (shown[..., 1:] < 30).all(axis=2)).sum() == 0


def test_first_frames_have_few_layers_and_pictures_that_are_taken_all(application, view):
    view.set_site(roof())
    canvas = view.canvas()
    application.processEvents()
    n_first = canvas._n_layers
    assert n_first < len(canvas._drawn)
    whole = canvas.picture().astype(int)
    turns = 0
    while canvas._n_layers < len(canvas._drawn) and turns < 100:
        application.processEvents()
        turns += 1
    assert differs(whole, picture(application, view)) == 0


@pytest.mark.parametrize("is_slow", [False, True])
def test_textured_layers_are_drawn_in_motion_only_where_frames_were_measured_to_be_fast(application, view, is_slow):
    from groundstation.services.scenes.surfaces import Part, Surface

    view.set_site(office())
    red = np.array([[220, 0, 0]], np.uint8)
    triangle = np.array([[(-15.0, -5.0, 0.0), (15.0, -5.0, 0.0), (0.0, -5.0, 40.0)]])
    view.set_surfaces([Surface(Part.SURROUNDINGS, triangle, red)])
    view.set_layer_visible(Layer.SURROUNDINGS, True)
    picture(application, view)
    view._begin(True)
    canvas = view.canvas()
    for took_s in (9.0, *[0.2 if is_slow else 0.01] * 5):
        canvas._note_frame(took_s)
    assert canvas.moving_frame_s == (0.2 if is_slow else 0.01), "the first frame, which compiles, does not count"
    view.turn_by_hand(3.0, 0.0)
    assert (Layer.SURROUNDINGS in canvas._hidden) == is_slow
    view._layers_button.click()
    (row,) = (row for row in view._panel.list.value() if row.key == Layer.SURROUNDINGS.value)
    assert row.note.startswith("drawn at rest only: a frame takes 200 ms" if is_slow else "drawn always: a frame")
    turn_until(application, lambda: not view._is_moving)
    assert Layer.SURROUNDINGS not in canvas._hidden
    # A flight leaves the view no rest.
    view.set_watched(True)
    assert (Layer.SURROUNDINGS in canvas._hidden) == is_slow
    view._begin(True)
    assert Layer.SURROUNDINGS in canvas._hidden, "nobody knows yet how long frames take"
    view.set_watched(False)
    assert Layer.SURROUNDINGS not in canvas._hidden
    view.set_watched(True)
    view._begin(False)
    assert Layer.SURROUNDINGS not in canvas._hidden, "a graphics card draws them always"
    view.set_watched(False)


def test_what_a_widget_of_a_graphics_card_draws_a_processor_shows_as_a_picture(application, monkeypatch):
    from groundstation.gui.view3d import canvas as canvas_module
    from groundstation.gui.view3d.scene_view import SceneView

    drawn, shown = [], []
    for is_software in (True, False):
        monkeypatch.setattr(canvas_module, "is_drawn_by_processor", lambda value=is_software: value)
        view = SceneView()
        view.canvas().smooths_at_rest = False
        view.resize(*SIZE)
        view.show()
        QTest.qWaitForWindowExposed(view)
        view.set_site(office())
        turn_until(application, lambda view=view: view.canvas().n_painted > 1)
        view.canvas().renderer.SetUseFXAA(False)
        view.canvas().set_background_colour("#204060")
        drawn.append(picture(application, view))
        assert drawn[-1].shape[:2] == (view.canvas().height(), view.canvas().width())
        view.resize(SIZE[0] - 100, SIZE[1] - 50)
        settle(application)
        shown.append(view.screenshot().astype(int))
        assert view.canvas().childAt(50, 50) is None, "the mouse is the canvas's own"
        # What lies over it has changed alone: no frame for that.
        painted = view.canvas().n_painted
        view.canvas().update()
        application.processEvents()
        assert (view.canvas().n_painted == painted) or not is_software
        view.close_view()
        view.deleteLater()
        settle(application)
    assert differs(*drawn) == 0
    assert differs(*shown) < 1e-3 * shown[0][..., 0].size
    assert drawn[0].std() > 10.0, "something is seen"


def test_edges_are_smoothed_at_rest_and_never_while_a_flight_moves_in_the_view(application, view):
    view.set_site(office())
    canvas = view.canvas()
    canvas.smooths_at_rest = True
    turn_until(application, lambda: canvas._is_software and canvas.renderer.GetUseFXAA())
    view.set_watched(True)
    assert not canvas.renderer.GetUseFXAA()
    view.turn_by_hand(3.0, 0.0)
    turn_until(application, lambda: not view._is_moving)
    assert not canvas.renderer.GetUseFXAA(), "it rests for no moment"
    view.set_watched(False)
    turn_until(application, canvas.renderer.GetUseFXAA)


def test_frames_of_a_turn_are_measured_where_a_processor_draws(application, view):
    view.set_site(office())
    picture(application, view)
    view._begin(True)
    for _ in range(12):
        painted = view.canvas().n_painted
        view.turn_by_hand(3.0, 0.0)
        turn_until(application, lambda painted=painted: view.canvas().n_painted > painted)
    assert 0.0 < view.canvas().moving_frame_s < 10.0


def test_the_aircraft_of_the_slider_is_the_one_of_a_flight_and_turns_with_its_heading(view, plan):
    view.set_site(office())
    view.set_plan(plan)
    place = np.array(plan.viewpoints[0].position_enu_m)
    found = []
    for heading in (0.0, 1.0):
        view.set_flown(scene_picture.FlownPose(0, place, heading, -0.2))
        drawn = view._flown_drawables()
        assert len(drawn) == 5, "pyramid, propellers, arms and body with the nose, rims, sight of the camera"
        found.append(np.concatenate([each.points_enu_m for each in drawn[1:]]))
    assert not np.allclose(found[0], found[1])


def test_routes_viewpoints_and_pyramids_fade_beside_their_sorties(view, plan):
    view.set_site(office())
    view.set_plan(plan)
    view._layers_button.click()
    rows = {row.key: row for row in view._panel.list.value()}
    for layer in (Layer.ROUTES, Layer.VIEWPOINTS, Layer.FRUSTA):
        assert rows[layer.value].can_fade
        view._panel.list.boxes(layer.value)[1].setValue(50)
    view.set_sortie(1, True, 0.5)
    opacities = view.canvas()._opacities
    assert opacities[Layer.ROUTES, 0] == opacities[Layer.VIEWPOINTS, 0] == 0.25
    assert opacities[Layer.FRUSTA] == 0.5
