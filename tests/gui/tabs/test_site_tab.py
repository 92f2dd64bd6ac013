"""The Site tab in the real window: edits as undo steps, drawing with the mouse, values that are refused, imports."""

import time
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.project.session import Session
from groundstation.services.site.sources import bundled_site
from planning.base.errors import InputError
from planning.base.findings import Severity
from planning.geo.mesh import box_mesh
from planning.site.bundled import write_scene
from planning.site.file import site_sha256
from tests.gui.driving import turn_until
from tests.planning.revision.cases import QUICK


class Window:
    """The window with its Site tab at the front, and hands to work it."""

    def __init__(self, application, scene_name):
        from groundstation.gui.application.context import ApplicationContext
        from groundstation.gui.window.main_window import MainWindow

        self.application, self.runner = application, JobRunner()
        model = None if scene_name is None else bundled_site(scene_name)
        self.context = ApplicationContext(Session(Document(site=model)), self.runner)
        self.messages = []
        self.context.messageShown.connect(self.messages.append)
        self.window = MainWindow(self.context)
        self.window.resize(1280, 720)
        self.window.show()
        self.window.show_tab("site")
        self.tab = self.window.tab("site")
        self.until(lambda: self.window.shared_view.scene() is not None)
        self.scene = self.window.shared_view.scene()
        self.idle()

    @property
    def site(self):
        return self.context.document.site.site

    def until(self, condition):
        turn_until(self.application, condition)

    def idle(self):
        """Wait for edits to be checked and jobs to end."""
        editor, form = self.tab.detail.editor, self.tab.detail.grid_maker
        self.until(lambda: not (editor._timer.isActive() or form._timer.isActive() or self.context.jobs()))

    def click(self, point, scene=None):
        """Click where a point of the site is seen."""
        from PySide6.QtCore import QPoint, Qt
        from PySide6.QtTest import QTest

        scene = scene or self.scene
        canvas = scene.canvas()
        view = scene.orbit().pinhole(canvas.width(), canvas.height())
        (x, y), *_ = view.project(np.array([point], float))[0]
        place = QPoint(round(x), round(y))
        QTest.mouseMove(canvas, place)
        QTest.mouseClick(canvas, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, place)
        self.application.processEvents()

    def undo(self):
        self.context.session.undo()
        self.idle()

    def close(self):
        from PySide6.QtCore import QCoreApplication, QEvent

        self.window.close()
        # As `ProjectController.close` does: with the window go the timers that would still start jobs.
        self.window.deleteLater()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        self.runner.shutdown()


@pytest.fixture
def opened(application):
    windows = []

    def make(scene_name):
        windows.append(Window(application, scene_name))
        return windows[-1]

    yield make
    for window in windows:
        window.close()


@pytest.mark.long
def test_without_a_site_the_tab_says_what_to_do_and_a_bundled_site_fills_it(opened):
    hands = opened(None)
    side = hands.tab.left
    assert side.start.isVisible()
    assert not hands.tab.detail.tools.isVisible()
    actions = side.start.bundled_button.menu().actions()
    next(action for action in actions if action.text().startswith("Roof")).trigger()
    hands.idle()
    assert hands.site.name == "roof"
    assert hands.context.session.undo_label == "Open roof"
    assert not side.start.isVisible()
    assert hands.tab.detail.findings._title.text() == "All checks passed: home, airspace, facades."
    hands.undo()
    assert side.start.isVisible()


@pytest.mark.long
def test_selection_follows_between_tree_view_and_properties(opened):
    from groundstation.gui.site.pages import ObstaclePage, PanelPage

    hands = opened("canyon")
    tree = hands.tab.left.tree
    hands.click((-20.0, -24.0, 20.0))
    assert hands.context.selection == tree.value() == Item(ItemKind.OBSTACLE, "opposite")
    assert isinstance(hands.tab.detail.properties.page(), ObstaclePage)
    panel = Item(ItemKind.PANEL, "A-0199")
    index = tree.model().index_of(panel)
    tree.setCurrentIndex(index)
    assert hands.context.selection == panel
    assert hands.scene._selection == (panel,)
    assert isinstance(hands.tab.detail.properties.page(), PanelPage)


@pytest.mark.slow
def test_zone_and_box_are_drawn_with_the_mouse_each_in_one_step(opened):
    from groundstation.gui.site.site_tools import SiteTool

    hands = opened("office")
    tools = hands.tab.detail.tools
    tools.button(SiteTool.NO_FLY).click()
    assert tools.active() is SiteTool.NO_FLY
    corners = [(-40.0, -40.0, 0.0), (-20.0, -40.0, 0.0), (-20.0, -20.0, 0.0)]
    for corner in [*corners, corners[0]]:
        hands.click(corner)
    assert tools.active() is None
    assert not tools.button(SiteTool.NO_FLY).isChecked()
    (zone,) = hands.site.airspace.no_fly
    np.testing.assert_allclose(zone.polygon_enu_m, np.array(corners)[:, :2], atol=1.0)
    assert hands.context.selection == Item(ItemKind.NO_FLY, zone.id)
    tools.button(SiteTool.BOX).click()
    for point in ((25.0, -30.0, 0.0), (32.0, -22.0, 0.0), (32.0, -22.0, 12.0)):
        hands.click(point)
    (box,) = hands.site.obstacles
    np.testing.assert_allclose(box.box_enu_m, [(25.0, -30.0, 0.0), (32.0, -22.0, 12.0)], atol=1.0)
    hands.idle()
    assert hands.context.document.site.sha256 == site_sha256(hands.site)
    hands.undo()
    assert hands.site.obstacles == ()
    assert len(hands.site.airspace.no_fly) == 1


@pytest.mark.slow
def test_a_rally_point_is_clicked_put_down_and_removed(opened):
    from groundstation.gui.site.site_tools import SiteTool

    hands = opened("office")
    hands.tab.detail.tools.button(SiteTool.RALLY).click()
    hands.click((8.0, -40.0, 0.0))
    hands.idle()
    (point,) = hands.site.rally_points
    np.testing.assert_allclose(point.position_enu_m, (8.0, -40.0, 0.0), atol=1.0)
    assert hands.context.selection == Item(ItemKind.RALLY, point.id)
    page = hands.tab.detail.properties.page()
    page.point_box().boxes()[2].box().setValue(2.0)
    assert hands.site.rally_points[0].position_enu_m[2] == 2.0
    page._put_down()
    assert hands.site.rally_points[0].position_enu_m[2] == 0.0
    hands.tab.left.tree.ask_remove()
    assert hands.site.rally_points == ()
    hands.context.session.undo()
    assert len(hands.site.rally_points) == 1
    hands.idle()


@pytest.mark.slow
def test_home_rally_point_and_zero_are_picked_on_the_map_in_one_step_each(opened, qtbot):
    from PySide6.QtCore import QPoint, Qt

    from groundstation.gui.shared_view import SharedViewPage
    from groundstation.gui.site.site_tools import SiteTool
    from groundstation.services.map.web_mercator import geodetic_from_world, world_from_enu

    hands = opened("office")
    tools, view = hands.tab.detail.tools, hands.window.shared_view
    view.show_page(SharedViewPage.MAP)
    found = view.map_page()
    turn_until(hands.application, found.is_complete)
    before = hands.site

    def click(point_enu_m):
        x, y = found.viewport().screen(world_from_enu(hands.site.origin, [point_enu_m]))[0]
        place = geodetic_from_world(*found.viewport().world(round(x), round(y)))
        qtbot.mouseClick(found, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
        return place

    tools.button(SiteTool.HOME).click()
    assert "Esc cancels" in found.note()
    click((5.0, -35.0, 0.0))
    np.testing.assert_allclose(hands.site.home_enu_m, (5.0, -35.0, before.airspace.ground_z_m), atol=0.5)
    assert tools.active() is None
    tools.button(SiteTool.RALLY).click()
    click((-8.0, -38.0, 0.0))
    np.testing.assert_allclose(hands.site.rally_points[0].position_enu_m[:2], (-8.0, -38.0), atol=0.5)
    tools.button(SiteTool.ORIGIN).click()
    qtbot.keyClick(found, Qt.Key.Key_Escape)
    assert tools.active() is None
    tools.button(SiteTool.ORIGIN).click()
    lat, lon = click((20.0, 10.0, 0.0))
    assert (hands.site.origin.lat_deg, hands.site.origin.lon_deg) == pytest.approx((lat, lon), abs=1e-12)
    assert hands.site.origin.ellipsoid_height_m == pytest.approx(before.origin.ellipsoid_height_m, abs=0.01)
    for _ in range(3):
        hands.undo()
    assert hands.site == before
    hands.idle()


@pytest.mark.slow
def test_home_in_a_bad_place_is_taken_and_told_until_it_is_put_right(opened):
    from groundstation.gui.site.site_tools import SiteTool

    hands = opened("office")
    hands.tab.detail.tools.button(SiteTool.HOME).click()
    hands.click((0.0, -5.0, 0.0))
    hands.idle()
    np.testing.assert_allclose(hands.site.home_enu_m, (0.0, -5.0, 0.0), atol=1.0)
    findings = hands.tab.detail.findings
    assert [(f.severity, f.code) for f in findings.findings()] == [(Severity.ERROR, "home-unusable")]
    hands.context.select(None)
    findings._list.itemClicked.emit(findings._list.item(0))
    assert hands.context.selection == Item(ItemKind.HOME)
    hands.tab.detail.properties.page().point_box().boxes()[1].box().setValue(-45.0)
    hands.idle()
    assert hands.context.session.undo_label == "Move home"
    assert findings.findings() == ()


@pytest.mark.slow
def test_escape_and_a_second_press_put_a_tool_away_and_leave_the_site(opened):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest

    from groundstation.gui.site.site_tools import SiteTool

    hands = opened("roof")
    tools, before = hands.tab.detail.tools, hands.context.document
    tools.button(SiteTool.AIRSPACE).click()
    QTest.keyClick(hands.scene.canvas(), Qt.Key.Key_Escape)
    assert tools.active() is None
    tools.button(SiteTool.HOME).click()
    tools.button(SiteTool.HOME).click()
    assert tools.active() is None
    assert hands.scene.tool() is None
    tools.button(SiteTool.HOME).click()
    hands.window.show_tab("plan")
    assert hands.scene.tool() is None, "another tab gets the view without a tool"
    assert hands.context.document is before


@pytest.mark.long
def test_values_that_cannot_be_are_told_at_the_box_and_not_taken(opened):
    hands = opened("office")
    hands.context.select(Item(ItemKind.AIRSPACE))
    page, before = hands.tab.detail.properties.page(), hands.context.document
    page.extent_box().boxes()[0][2].box().setValue(99.0)
    assert hands.context.document is before
    assert "up: expected the first value below the second, got 99 m and 75 m" in page._error.text()
    assert page.extent_box().value()[0][2] == 99.0, "what was typed stays to be put right"
    page.extent_box().boxes()[1][2].box().setValue(120.0)
    assert page._error.text() == ""
    assert (hands.site.airspace.min_enu_m[2], hands.site.airspace.max_enu_m[2]) == (99.0, 120.0)


@pytest.mark.slow
def test_names_are_changed_in_one_step_and_taken_ones_refused(opened):
    hands = opened("court")
    hands.context.select(Item(ItemKind.FACADE, "A"))
    box = hands.tab.detail.properties.page().name_box()
    box.setText("B")
    box.editingFinished.emit()
    assert "facade 'B' already" in hands.tab.detail.properties.page()._error.text()
    box.setText("West")
    box.editingFinished.emit()
    assert hands.context.selection == Item(ItemKind.FACADE, "West")
    assert hands.site.facades[0].panels[0].id == "West-0000"
    assert hands.context.session.undo_label == "Rename A"


@pytest.mark.slow
def test_last_facade_can_be_removed_from_a_building_only(opened):
    hands = opened("single-panel")
    hands.tab.left.tree.removeRequested.emit(Item(ItemKind.FACADE, "A"))
    assert "needs at least one panel" in hands.messages[-1].text
    assert hands.site.n_panels == 1
    hands = opened("roof")
    hands.tab.left.tree.removeRequested.emit(Item(ItemKind.FACADE, "A"))
    assert hands.site.facades == ()
    hands.context.session.undo()
    assert hands.site.n_panels == 32


@pytest.mark.slow
def test_panel_grid_is_picked_checked_shown_and_added(opened):
    from groundstation.gui.site.site_tools import SiteTool
    from groundstation.gui.view3d.orbit import facing

    hands = opened("office")
    detail = hands.tab.detail
    hands.scene.set_orbit(
        facing(np.array([0.0, 1.0, 0.0]), np.array([[-18.0, 18.0, 0.0], [18.0, 18.0, 43.0]]), 1.0, 20.0, 10.0)
    )
    detail.tools.button(SiteTool.GRID).click()
    form = detail.grid_form
    assert form.isVisible()
    assert not detail.properties.isVisible()
    form._rows.setValue(8)
    form._columns.setValue(6)
    for corner in ((16.0, 18.0, 2.0), (-16.0, 18.0, 2.0), (16.0, 18.0, 40.0)):
        hands.click(corner)
    hands.idle()
    np.testing.assert_allclose(
        form.value().rectangle_enu_m, [(16.0, 18.0, 2.0), (-16.0, 18.0, 2.0), (16.0, 18.0, 40.0)], atol=1.0
    )
    assert form.can_accept()
    assert hands.site.n_panels == 280, "nothing is added yet"
    assert len(hands.scene._site.frames) == 328, "but it is shown"
    form._gap.box().setValue(6.0)
    hands.idle()
    assert form._error.text().startswith("Gap: a gap of 6 m leaves no glass")
    assert not form.can_accept()
    form._gap.box().setValue(0.2)
    hands.idle()
    form._accept.click()
    hands.idle()
    assert [(f.id, len(f.panels)) for f in hands.site.facades] == [("A", 280), ("B", 48)]
    assert hands.context.selection == Item(ItemKind.FACADE, "B")
    assert hands.context.session.undo_label == "Add facade grid B"
    assert detail.properties.isVisible()


@pytest.mark.slow
def test_panel_grid_that_is_given_up_leaves_the_view_as_it_was(opened):
    hands = opened("office")
    maker, form = hands.tab.detail.grid_maker, hands.tab.detail.grid_form
    maker.begin()
    form.set_rectangle(((-18.5, 18.0, 1.0), (-18.5, 0.0, 1.0), (-18.5, 18.0, 41.0)))
    hands.idle()
    assert form.can_accept()
    form._cancel.click()
    assert not form.isVisible()
    assert len(hands.scene._site.frames) == 280
    assert hands.context.session.undo_label == ""


@pytest.mark.slow
def test_delete_removes_what_was_picked_in_the_view(opened):
    hands = opened("canyon")
    hands.click((-20.0, -24.0, 20.0))
    remove = next(action for action in hands.tab.actions() if action.shortcut().toString() == "Del")
    assert remove.isEnabled()
    remove.trigger()
    hands.idle()
    assert hands.site.obstacles == ()
    assert hands.context.selection is None
    remove.trigger()
    assert hands.context.session.undo_label == "Delete opposite"
    hands.window.show_tab("plan")
    assert remove not in hands.window.actions(), "other tabs have their own Delete"


@pytest.mark.long
def test_bad_site_files_are_told_and_leave_the_site(opened, tmp_path):
    hands = opened("roof")
    before = hands.context.document
    broken = tmp_path / "broken.json"
    broken.write_text("{}")
    hands.tab.left.opener.open_site(broken)
    hands.idle()
    assert "missing required field" in hands.messages[-1].text
    assert hands.context.document is before
    hands.tab.left.opener.open_site(write_scene("library", tmp_path))
    hands.idle()
    assert hands.site.name == "library"


@pytest.mark.slow
def test_plans_of_the_site_before_are_put_away_and_undo_brings_them_back(opened):
    from planning.planner import plan_flight
    from planning.request import PlanRequest

    hands = opened("single-panel")
    site = hands.context.document.site
    plan = plan_flight(site, PlanRequest(n_views=2, greedy=QUICK)).plan
    hands.context.change("Plan", Document(site=site).with_plan(PlanEntry("plan-1", "Plan 1", plan)))
    hands.tab.left.opener.open_bundled("roof")
    hands.idle()
    assert hands.context.document.plans == ()
    assert "Undo brings them back" in hands.messages[-1].text
    hands.undo()
    assert len(hands.context.document.plans) == 1


@pytest.mark.long
def test_mesh_obstacle_comes_from_a_file_and_bad_files_are_told(opened, tmp_path):
    hands = opened("office")
    crane = box_mesh(np.array([40.0, -40.0, 0.0]), np.array([44.0, -36.0, 30.0]))
    trimesh.Trimesh(crane.vertices_enu_m, crane.triangles, process=False).export(tmp_path / "crane.stl")
    hands.tab.detail.tools.add_mesh(tmp_path / "crane.stl")
    hands.idle()
    assert [(o.id, o.mesh) for o in hands.site.obstacles] == [("crane", "crane.ply")]
    assert hands.context.selection == Item(ItemKind.OBSTACLE, "crane")
    hands.tab.detail.tools.add_mesh(tmp_path / "none.stl")
    hands.idle()
    assert "no such mesh file" in hands.messages[-1].text
    assert len(hands.site.obstacles) == 1


@pytest.mark.slow
def test_site_is_checked_anew_for_the_distance_of_the_next_plan(opened):
    hands = opened("office")
    document = hands.context.document
    assert hands.tab.detail.findings.findings() == ()
    hands.window.show_tab("plan")
    request = replace(document.request, constraints=replace(document.request.constraints, min_distance_m=60.0))
    hands.context.amend(replace(document, request=request))
    hands.window.show_tab("site")
    hands.idle()
    assert "60 m are required" in hands.tab.detail.findings.findings()[0].message


@pytest.mark.slow
def test_check_that_was_cancelled_does_not_stop_later_ones(opened):
    hands = opened("roof")
    editor = hands.tab.detail.editor
    hands.context.select(Item(ItemKind.HOME))
    box = hands.tab.detail.properties.page().point_box().boxes()[1].box()
    box.setValue(-31.0)
    editor._check()
    for job in hands.context.jobs():
        hands.context.cancel(job)
    hands.idle()
    box.setValue(0.0)
    hands.idle()
    assert [finding.code for finding in hands.tab.detail.findings.findings()] == ["home-unusable"]


@pytest.mark.slow
def test_edits_of_a_large_site_do_not_hold_the_window_up(opened):
    hands = opened("tower")
    hands.context.select(Item(ItemKind.HOME))
    box = hands.tab.detail.properties.page().point_box().boxes()[1].box()
    seconds = []
    for north in (-50.5, -51.0, -51.5, -52.0):
        started = time.thread_time()
        box.setValue(north)
        seconds.append(time.thread_time() - started)
    assert hands.site.home_enu_m[1] == -52.0
    assert min(seconds) < 0.5, seconds


def test_errors_of_checks_are_answers_for_the_form_and_no_failures(application):
    from groundstation.gui.site.grid_form import GridRequest, checked_grid

    office = bundled_site("office")
    far = GridRequest(((0.0, -40.0, 0.0), (10.0, -40.0, 0.0), (0.0, -40.0, 10.0)), 2, 2)
    assert isinstance(checked_grid(office, far), InputError)
    with pytest.raises(ValueError, match="picked"):
        checked_grid(office, GridRequest())
