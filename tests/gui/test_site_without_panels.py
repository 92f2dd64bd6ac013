"""A coarse model without panels in the real window: imported, kept, shown everywhere, filled from photos, planned."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.view3d.drawables import Layer
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from groundstation.services.project.folder import open_project
from planning.base.findings import Severity
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import roof
from tests.gui.driving import choose, clicked, close_controller, press_in, turn_until, turn_until_idle
from tests.planning.revision.cases import QUICK
from tests.reconstruction.synthetic_photos import ORIGIN, made_photos, write_flight, write_model

TABS = ("site", "plan", "mission", "fly", "photos")


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A folder of photos and a coarse model, and what they show."""
    folder = tmp_path_factory.mktemp("flight")
    made = made_photos(0.0, (0.0, 12.0))
    write_flight(folder / "photos", made)
    write_model(folder / "coarse.ply", made[0].case.wall)
    return folder, made


class Window:
    """The whole program, and hands to work it."""

    def __init__(self, application, worker):
        from groundstation.gui.window.project_controller import ProjectController

        self.application = application
        self.controller = ProjectController(application, worker=worker)
        self.controller.show()
        self.window, self.context = self.controller.window, self.controller.context
        self.window.setGeometry(0, 0, 1280, 720)
        self.messages = []
        self.context.messageShown.connect(self.messages.append)
        turn_until(application, lambda: self.window.shared_view.scene() is not None)

    @property
    def site(self):
        return self.context.document.site.site

    def idle(self):
        turn_until_idle(self.application, self.controller)

    def show(self, tab):
        self.window.show_tab(tab)
        self.idle()
        return self.window.tab(tab)

    def look_everywhere(self):
        """Every tab, and every way to look at the site."""
        for page in SharedViewPage:
            self.window.shared_view.show_page(page)
            for name in TABS:
                self.show(name)
                self.window.grab()

    def errors(self):
        return [message.text for message in self.messages if message.severity is Severity.ERROR]

    def close(self):
        close_controller(self.controller)


@pytest.fixture
def opened(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    window = Window(application, worker)
    yield window
    window.close()


def bare_roof():
    model = roof()
    return replace(model, site=replace(model.site, facades=()))


@pytest.mark.slow
def test_a_coarse_model_is_imported_kept_filled_from_photos_and_planned(opened, flight, tmp_path):
    folder, made = flight
    dialog = opened.show("site").left.opener.import_site(folder / "coarse.ply")
    opened.idle()
    dialog.form.origin_box().setValue(ORIGIN)
    dialog.form._origin_edited(None)
    dialog.preview()
    opened.idle()
    assert dialog.can_import(), dialog.error()
    assert "No panels yet" in dialog._summary.text()
    press_in(dialog, "Import")
    opened.idle()
    assert opened.site.n_panels == 0
    assert len(opened.window.shared_view.scene()._site.drawables[Layer.BUILDING]) == 1
    plan = opened.show("plan")
    assert "No panels yet: find them in photos (Photos tab), or draw them" in plan.verdict()
    assert not plan._plan_button.isEnabled()
    opened.controller.save_in(tmp_path / "project")
    opened.idle()
    assert open_project(tmp_path / "project").document.site.site == opened.site
    photos = opened.show("photos")
    with clicked(choose(folder / "photos")):
        QTest.mouseClick(photos.choose, Qt.MouseButton.LeftButton)
    opened.idle()
    assert "2 photos, 2 of them usable. The site has no panels yet" in photos.coverage.text()
    QTest.mouseClick(photos.find, Qt.MouseButton.LeftButton)
    opened.idle()
    assert photos.use.isEnabled(), opened.errors()
    QTest.mouseClick(photos.use, Qt.MouseButton.LeftButton)
    opened.idle()
    assert opened.site.n_panels == len(made[0].panels)
    request = PlanRequest(n_views=4, greedy=QUICK, time_budget_s=1.0)
    opened.context.amend(replace(opened.context.document, request=request))
    plan = opened.show("plan")
    QTest.mouseClick(plan._plan_button, Qt.MouseButton.LeftButton)
    opened.idle()
    assert opened.context.document.current.plan.coverage.covered > 0
    assert opened.errors() == []


@pytest.mark.slow
def test_every_tab_shows_a_site_without_panels(opened):
    model = roof()
    emptied = tuple(replace(facade, panels=()) for facade in model.site.facades)
    opened.context.session.open(Document(replace(model, site=replace(model.site, facades=emptied))), None)
    opened.show("site")
    opened.context.jump_to(Item(ItemKind.FACADE, "A"))
    opened.idle()
    opened.context.session.open(Document(bare_roof()), None)
    opened.look_everywhere()
    opened.context.jump_to(Item(ItemKind.BUILDING))
    opened.idle()
    assert opened.errors() == []
    findings = opened.show("site").detail.findings
    opened.idle()
    assert [finding.code for finding in findings.findings()] == ["no-panels"]


@pytest.mark.slow
def test_a_plan_stays_when_the_panels_go_and_says_what_it_lacks(opened):
    model = roof()
    entry = PlanEntry("plan-1", "First", plan_flight(model, PlanRequest(n_views=4, greedy=QUICK)).plan)
    opened.context.session.open(Document(model).with_plan(entry), None)
    opened.show("plan")
    opened.context.select(Item(ItemKind.PANEL, "A-0003"))
    opened.context.change("Remove A", replace(opened.context.document, site=bare_roof()))
    opened.look_everywhere()
    assert "This plan cannot be judged. site 'roof' has no panels yet" in opened.show("plan").verdict()
    opened.context.session.undo()
    opened.idle()
    assert "covered" in opened.show("plan").verdict()
    assert opened.errors() == []
