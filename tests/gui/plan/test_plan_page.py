"""The Plan tab as a pilot uses it: what is shown belongs to what is open, and nothing jumps or works needlessly."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.gui.plan.plan_page import PanelPaint, RoutePaint
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.gui.driving import turn_until, turn_until_idle
from tests.gui.window.test_main_window import QUICK, controller, opened, planned

__all__ = ["controller"]

LOOK = "Look at the scene"


@pytest.fixture(scope="module")
def roof():
    """A document with a plan that was made before."""
    model = SCENES["roof"]()
    return Document(model, (PlanEntry("plan-1", "First", plan_flight(model, QUICK).plan),), "plan-1")


@pytest.fixture
def page(application, controller, roof):
    controller.context.session.open(roof, None)
    controller.window.show_tab("plan")
    page = controller.window.tab("plan")
    page.controller.set_request(QUICK)
    turn_until_idle(application, controller)
    return page


@pytest.fixture
def page_of_new_plan(application, controller):
    """The page after its own planning."""
    opened(application, controller, "roof")
    return planned(application, controller, QUICK)


def first_views(controller, n=1):
    return controller.context.document.current.plan.viewpoints[:n]


def moved(viewpoint, east_m):
    x, y, z = viewpoint.position_enu_m
    return replace(viewpoint, position_enu_m=(x + east_m, y, z))


@pytest.mark.slow
def test_edits_and_undo_leave_the_page_that_is_read_in_front(application, controller, page):
    (viewpoint,) = first_views(controller)
    controller.context.select(Item(ItemKind.VIEWPOINT, viewpoint.id))
    page.right.setCurrentWidget(page.effects_area)
    page.controller.set_viewpoint(moved(viewpoint, 0.5))
    assert page.right.currentWidget() is page.effects_area
    controller.context.session.undo()
    assert page.right.currentWidget() is page.effects_area


@pytest.mark.slow
def test_undo_of_the_first_plan_leaves_nothing_of_it(application, controller, page_of_new_plan):
    page = page_of_new_plan
    panel = controller.context.document.site.site.panels[3].id
    controller.context.select(Item(ItemKind.PANEL, panel))
    assert "sections covered" in page.panel.text()
    assert "The search found" in page.chart.text()
    controller.context.session.undo()
    turn_until_idle(application, controller)
    assert "search found" not in page.chart.text()
    assert "sections" not in page.panel.text()
    assert page.lists.waypoints.model().rowCount() == 0
    controller.context.session.redo()
    turn_until_idle(application, controller)
    assert f"Panel {panel}" in page.panel.text()
    assert page.lists.waypoints.model().rowCount() > 8


@pytest.mark.slow
def test_what_a_plan_is_worth_stands_beside_it_and_is_measured_anew_after_an_edit(
    application, controller, page_of_new_plan
):
    page, plan = page_of_new_plan, controller.context.document.current.plan
    last = plan.worth.batteries[-1]
    assert f"{last.psnr_db:.1f} dB" in page.verdict()
    lines = page.worth.lines()
    assert (lines[0].x[-1], lines[0].y[-1]) == (last.minutes, last.psnr_db)
    assert [line.y[0] - last.psnr_db for line in lines[-2:]] == pytest.approx(
        [plan.worth.deviation_db, -plan.worth.deviation_db]
    )
    away, gone = first_views(controller, 2)
    page.controller.set_viewpoint(replace(away, heading_deg=away.heading_deg + 180.0))
    page.controller.delete_viewpoint(gone.id)
    assert page.worth.lines() == ()
    assert "dB" not in page.verdict()
    turn_until(application, lambda: page.worth.lines() != ())
    assert page.worth.lines()[0].y[-1] < last.psnr_db
    assert page.worth.lines()[0].x[-1] == pytest.approx(controller.context.document.current.plan.duration_s / 60.0)
    assert f"{page.worth.lines()[0].y[-1]:.1f} dB" in page.verdict()
    for _ in range(2):
        controller.context.session.undo()
    assert page.worth.lines()[0].y[-1] == last.psnr_db


@pytest.mark.slow
def test_a_plan_for_the_model_ends_on_its_worth_and_one_for_sections_on_their_curve(application, controller):
    opened(application, controller, "roof")
    for goal, shown in (({"n_views": 8}, "worth"), ({"share": 0.5}, "chart")):
        asked = replace(QUICK, n_views=None, share=None)
        page = planned(application, controller, replace(asked, **goal))
        assert page.right.currentWidget() is getattr(page, shown)
        assert ("see “Worth”" in page.chart.text()) == (shown == "worth")


@pytest.mark.slow
def test_a_panel_of_the_site_before_is_not_taken_for_one_of_the_next(application, controller, page):
    controller.context.select(Item(ItemKind.PANEL, controller.context.document.site.site.panels[3].id))
    opened(application, controller, "office")
    planned(application, controller, replace(QUICK, n_views=6))
    shown = page.panel.panel_id()
    assert shown is None or shown == controller.context.document.site.site.panels[3].id


@pytest.mark.slow
def test_effects_are_looked_at_only_while_somebody_does(application, controller, page):
    names = []
    controller.context.jobsChanged.connect(lambda: names.extend(job.name for job in controller.context.jobs()))
    page.form.setValue(PlanRequest(n_views=9))
    page.controller.set_request(PlanRequest(n_views=9))
    page.controller.set_viewpoint(moved(first_views(controller)[0], 0.5))
    turn_until_idle(application, controller)
    assert LOOK not in names
    page.right.setCurrentWidget(page.effects_area)
    turn_until_idle(application, controller)
    assert names.count(LOOK) == 1
    assert len(page.effects._choices) >= 5
    assert controller.window.minimumSizeHint().height() <= 720, "however many effects there are"
    page.controller.set_request(PlanRequest(n_views=10))
    page.right.setCurrentWidget(page.chart)
    page.right.setCurrentWidget(page.effects_area)
    turn_until_idle(application, controller)
    assert names.count(LOOK) == 1, "the number of views has no effect on effects"


@pytest.mark.slow
def test_asking_for_something_else_leaves_the_list_of_viewpoints_alone(application, controller, page):
    model, changes, resets = page.lists.waypoints.model(), [], []
    model.modelReset.connect(lambda: resets.append(1))
    model.dataChanged.connect(lambda *_: changes.append(1))
    page.controller.set_request(PlanRequest(n_views=9))
    application.processEvents()
    assert not changes
    page.controller.set_viewpoint(moved(first_views(controller)[0], 0.5))
    assert changes
    changes.clear()
    page.lists.setCurrentWidget(page.lists.plans)
    page.controller.set_viewpoint(moved(first_views(controller)[0], 0.5))
    assert not changes, "nobody sees it"
    page.lists.setCurrentWidget(page.lists.waypoints)
    assert changes
    assert not resets, "the waypoints are the same, elsewhere"


@pytest.mark.slow
def test_a_plan_that_was_not_looked_at_says_so_and_is_taken_up_again(application, controller, page):
    entry = controller.context.document.current
    home = controller.context.document.site.site.home_enu_m
    site = controller.context.document.site
    edited = replace(site, site=replace(site.site, home_enu_m=(home[0] + 1.0, *home[1:])))
    controller.context.change("Move home", replace(controller.context.document, site=edited))
    (job,) = [job for job in controller.context.jobs() if job.name == "Look at the plan"]
    assert "being looked at" in page.verdict()
    controller.context.cancel(job)
    turn_until_idle(application, controller)
    assert "Choose it in the list of plans" in page.verdict()
    refused = []
    page.controller.refused.connect(refused.append)
    page.controller.set_viewpoint(moved(first_views(controller)[0], 0.5))
    assert refused
    page.controller.choose(entry.id)
    turn_until_idle(application, controller)
    assert "ready to fly" in page.verdict().lower()


@pytest.mark.slow
def test_an_edit_that_is_refused_leaves_the_boxes_as_they_were(application, controller, page):
    (viewpoint,) = first_views(controller)
    controller.context.select(Item(ItemKind.VIEWPOINT, viewpoint.id))
    page.viewpoint.toggle_lock()
    kept = controller.context.document.current.viewpoint(viewpoint.id)
    editor = page.viewpoint.editor
    assert not editor._position[0].isEnabled()
    editor._position[0].box().setValue(99.0)
    assert editor.value() == kept
    assert "Keep in the next plan" in editor._says.text()
    assert controller.context.document.current.viewpoint(viewpoint.id) == kept


@pytest.mark.slow
def test_a_method_that_keeps_no_viewpoints_is_refused_where_some_are_kept(application, controller, page):
    (viewpoint,) = first_views(controller)
    page.controller.set_viewpoint(replace(viewpoint, locked=True))
    page.controller.set_request(PlanRequest(n_views=8, method="pso"))
    page.controller.plan()
    assert not page.controller.is_planning
    text = controller.window.messages.texts().splitlines()[-1]
    assert "Optimised (recommended)" in text
    assert viewpoint.id in text


@pytest.mark.slow
def test_a_plan_for_a_site_that_is_gone_is_not_put_on_the_one_that_is_open(application, controller):
    opened(application, controller, "roof")
    controller.window.show_tab("plan")
    page = controller.window.tab("plan")
    page.controller.set_request(QUICK)
    page.controller.plan()
    controller.context.session.undo()
    assert controller.context.document.site is None
    turn_until_idle(application, controller)
    assert controller.context.document.plans == ()
    assert "not kept" in controller.window.messages.texts()
    assert not page.controller.is_planning


@pytest.mark.slow
def test_what_panels_and_routes_show_both_have_their_scale(application, controller, page):
    page.paint.setValue(PanelPaint.GSD, RoutePaint.CLEARANCE)
    overlay = controller.window.shared_view.scene()._overlay
    assert [scale.title for scale in overlay._scales] == ["Finest pixel", "Clearance"]
    page.paint.setValue(PanelPaint.FACADE, RoutePaint.CLEARANCE)
    assert [scale.title for scale in overlay._scales] == ["Clearance"]


@pytest.mark.slow
def test_an_edit_draws_the_plan_once(application, controller, page, monkeypatch):
    from groundstation.gui.view3d import scene_picture

    drawn = []
    whole = scene_picture.plan_scene
    monkeypatch.setattr(scene_picture, "plan_scene", lambda *args: drawn.append(1) or whole(*args))
    page.controller.set_viewpoint(moved(first_views(controller)[0], 0.5))
    application.processEvents()
    assert len(drawn) == 1


def test_a_plan_found_in_one_go_has_a_curve(application):
    from groundstation.gui.charts.quality_chart import QualityChart
    from planning.base.progress import QualityPoint

    chart = QualityChart(lambda: 0.0)
    chart.show_history((QualityPoint(8.6, 500.0),), 800.0)
    curve = chart.plot.curve()
    assert np.ptp(curve.x) > 0.1
    assert set(curve.y) == {500.0}


@pytest.mark.slow
def test_nothing_is_planned_while_the_form_makes_no_sense(application, controller, page):
    page.form._is_gsd_limited.setChecked(True)
    page.form._gsd.setValue(0.001)
    page.form._edited()
    assert page.form.problem()
    page._plan_button.click()
    assert not page.controller.is_planning
    page.form._is_gsd_limited.setChecked(False)
    page._plan_button.click()
    assert page.controller.is_planning
    page.controller.stop_here()
    turn_until(application, lambda: not page.controller.is_planning)


@pytest.mark.slow
def test_moving_in_the_view_goes_on_from_where_the_viewpoint_is_until_it_is_put_away(application, controller, page):
    from groundstation.gui.view3d.tools import MovedViewpoint, ViewpointTool

    first, second = first_views(controller, 2)
    scene = controller.window.shared_view.scene()
    controller.context.select(Item(ItemKind.VIEWPOINT, first.id))
    page.viewpoint._move.setChecked(True)
    scene.toolFinished.emit(MovedViewpoint(first.id, moved(first, 1.0).position_enu_m))
    assert page.viewpoint._move.isChecked()
    assert scene.tool().value.position_enu_m == pytest.approx(moved(first, 1.0).position_enu_m)
    controller.context.session.undo()
    assert scene.tool().value.position_enu_m == pytest.approx(first.position_enu_m)
    page.viewpoint.toggle_lock()
    assert scene.tool() is None, "it is kept as it is"
    controller.context.select(Item(ItemKind.VIEWPOINT, second.id))
    assert isinstance(scene.tool(), ViewpointTool)
    controller.context.select(None)
    assert scene.tool() is None
    controller.context.select(Item(ItemKind.VIEWPOINT, second.id))
    scene.cancel_tool()
    assert not page.viewpoint._move.isChecked()
