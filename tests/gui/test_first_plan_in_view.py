"""The first plan of a site is seen whole; afterwards the view is the user's."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint

from groundstation.services.project.document import Document, PlanEntry
from planning.site.bundled import SCENES
from tests.gui.driving import click_on, close_controller, press_in, scroll_to, turn_until
from tests.planning.insight.cases import plan, scene


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    from groundstation.gui.window.project_controller import ProjectController

    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.shared_view.scene() is not None)
    yield controller
    close_controller(controller)


def entry(name):
    return PlanEntry(name, name, plan("single-panel"))


@pytest.mark.slow
def test_the_first_plan_of_a_site_is_brought_in_once(controller):
    context, view = controller.context, controller.window.shared_view.scene()
    context.session.open(Document(scene("single-panel")), None)
    near = view.orbit().zoomed(8.0)
    view.set_orbit(near)
    context.change("Plan", context.document.with_plan(entry("first")))
    assert view.orbit() != near
    view.set_orbit(near)
    context.change("Plan", context.document.with_plan(entry("second")))
    assert view.orbit() == near, "the second plan leaves the view alone"
    context.session.undo()
    context.session.undo()
    context.session.redo()
    assert view.orbit() == near, "so does the first one when it comes back"


@pytest.mark.slow
def test_an_edited_site_is_the_same_one_and_another_building_is_not(controller):
    context, view = controller.context, controller.window.shared_view.scene()
    model = scene("single-panel")
    context.session.open(Document(model).with_plan(entry("first")), None)
    near = view.orbit().zoomed(8.0)
    view.set_orbit(near)
    edited = replace(model, site=replace(model.site, home_enu_m=model.site.home_enu_m))
    context.change("Edit", replace(context.document, site=edited))
    context.change("Plan", context.document.with_plan(entry("second")))
    assert view.orbit() == near
    context.session.open(Document(SCENES["office"]()), None)
    view.set_orbit(near)
    context.change("Plan", context.document.with_plan(entry("third")))
    assert view.orbit() != near


@pytest.mark.slow
def test_simulated_surroundings_are_made_when_their_box_is_ticked_and_go_with_another_site(application, controller):
    from groundstation.gui.view3d.drawables import Layer

    context, shared = controller.context, controller.window.shared_view
    context.session.open(Document(scene("office")), None)
    controller.window.show_tab("site")
    turn_until(application, lambda: not context.jobs())
    view = shared.scene()
    press_in(controller.window, "Layers")
    box, _slider = view.layer_panel().list.boxes(Layer.SURROUNDINGS.value)
    scroll_to(box)
    click_on(controller.window, box, QPoint(12, box.height() // 2))
    assert "Simulated surroundings" in [job.name for job in context.jobs()]
    turn_until(application, lambda: Layer.SURROUNDINGS in view.canvas()._drawn)
    assert sum(part.drawable.picture is not None for part in view.canvas()._drawn[Layer.SURROUNDINGS]) >= 3
    context.session.open(Document(), None)
    assert Layer.SURROUNDINGS not in view.canvas()._drawn
