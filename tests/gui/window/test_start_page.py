"""The start page and what leads on from it, by clicks: the sample, the ways to begin, and the steps that are ticked."""

import pytest
from PySide6.QtWidgets import QPushButton

from groundstation.gui.tabs import TABS
from groundstation.services.project.steps import Step
from tests.gui.driving import clicked, close_controller, escape, press_in, turn_until, turn_until_idle


@pytest.fixture
def controller(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    from groundstation.gui.window.project_controller import ProjectController

    controller = ProjectController(application, worker=worker)
    controller.show()
    controller.window.setGeometry(0, 0, 1280, 720)
    turn_until(application, lambda: controller.window.shown_tab() == "start")
    yield controller
    close_controller(controller)


def ticked(window):
    """Steps whose tab says that they are done."""
    tips = {spec.name: window._bar.tabToolTip(number) for number, spec in enumerate(TABS)}
    return {name for name, tip in tips.items() if tip.startswith("Done. ")}


@pytest.mark.long
def test_the_sample_opens_with_its_steps_ticked(application, controller):
    window = controller.window
    assert ticked(window) == set()
    assert not window.next_step.isVisible()
    press_in(window, "Sample project")
    turn_until(application, lambda: window.shown_tab() == "site")
    turn_until_idle(application, controller)
    assert ticked(window) == {"site", "plan", "fly", "photos", "reconstruct"}
    assert "panels: 160" in window.next_step.text()
    assert controller.settings().recent_projects == (str(controller.context.session.folder),)


@pytest.mark.slow
def test_each_step_of_the_sample_leads_to_the_next(application, controller):
    window = controller.window
    press_in(window, "Sample project")
    turn_until(application, lambda: window.shown_tab() == "site")
    turn_until_idle(application, controller)
    seen = [window.shown_tab()]
    for label in ("To Plan", "To Mission"):
        assert window.next_step.button.text() == label
        press_in(window, label)
        turn_until_idle(application, controller)
        seen.append(window.shown_tab())
    turn_until(application, lambda: "mission" in ticked(window))
    for label in ("To Fly", "To Photos", "To Reconstruct", "To Model"):
        press_in(window, label)
        turn_until_idle(application, controller)
        seen.append(window.shown_tab())
    assert seen == [str(step) for step in Step]
    assert window.next_step.button.text() == "Open the model"


@pytest.mark.long
@pytest.mark.parametrize(
    ("way", "tab", "dialog"),
    [
        ("Building model ...", "site", "Import building model"),
        ("Photos of a first flight ...", "photos", "Photos of the first flight"),
        ("Mission of another program ...", "mission", "Import the mission files of one flight"),
    ],
)
def test_each_way_to_begin_shows_its_tab_and_asks_for_files(application, controller, way, tab, dialog):
    with clicked(escape) as asked:
        press_in(controller.window, way)
    assert asked[0].startswith(dialog)
    assert controller.window.shown_tab() == tab
    assert controller.window.next_step.isVisible()


def test_projects_that_were_open_are_told_apart_and_named_as_their_folders(controller):
    controller.window.tab("start").set_recent(("/a/Nord & Co/tower", "/b/S\u00fcd/tower", "/c/Ost & West"))
    buttons = controller.window.findChildren(QPushButton)
    texts = [button.text() for button in buttons if button.toolTip().startswith(("/a/", "/b/", "/c/"))]
    assert texts == ["tower in Nord && Co", "tower in S\u00fcd", "Ost && West"], "a single & marks a shortcut"


def test_projects_that_were_open_are_offered_and_one_that_has_gone_is_told(application, controller, tmp_path):
    window = controller.window
    controller.window.tab("start").set_recent((str(tmp_path / "gone"), str(tmp_path / "other")))
    turn_until_idle(application, controller)
    press_in(window, "gone")
    turn_until_idle(application, controller)
    assert "is not there any more" in window.messages.texts()
