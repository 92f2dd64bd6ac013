"""The first plan of a site is seen whole; afterwards the view is the user's."""

from dataclasses import replace

import pytest

from groundstation.services.project.document import Document, PlanEntry
from planning.site.bundled import SCENES
from tests.gui.driving import close_controller, turn_until
from tests.planning.insight.cases import plan, scene


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    from groundstation.gui.window.project_controller import ProjectController

    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.stage.scene() is not None)
    yield controller
    close_controller(controller)


def entry(name):
    return PlanEntry(name, name, plan("single-panel"))


def test_the_first_plan_of_a_site_is_brought_in_once(controller):
    workspace, view = controller.workspace, controller.window.stage.scene()
    workspace.session.open(Document(scene("single-panel")), None)
    near = view.orbit().zoomed(8.0)
    view.set_orbit(near)
    workspace.change("Plan", workspace.document.with_plan(entry("first")))
    assert view.orbit() != near
    view.set_orbit(near)
    workspace.change("Plan", workspace.document.with_plan(entry("second")))
    assert view.orbit() == near, "the second plan leaves the view alone"
    workspace.session.undo()
    workspace.session.undo()
    workspace.session.redo()
    assert view.orbit() == near, "so does the first one when it comes back"


def test_an_edited_site_is_the_same_one_and_another_building_is_not(controller):
    workspace, view = controller.workspace, controller.window.stage.scene()
    model = scene("single-panel")
    workspace.session.open(Document(model).with_plan(entry("first")), None)
    near = view.orbit().zoomed(8.0)
    view.set_orbit(near)
    edited = replace(model, site=replace(model.site, home_enu_m=model.site.home_enu_m))
    workspace.change("Edit", replace(workspace.document, site=edited))
    workspace.change("Plan", workspace.document.with_plan(entry("second")))
    assert view.orbit() == near
    workspace.session.open(Document(SCENES["office"]()), None)
    view.set_orbit(near)
    workspace.change("Plan", workspace.document.with_plan(entry("third")))
    assert view.orbit() != near
