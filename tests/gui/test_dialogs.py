"""The dialogs of the window, clicked: what accepting them does, and that nothing happens without."""

from pathlib import Path

import pytest
import trimesh
from PySide6.QtWidgets import QAbstractSpinBox, QLineEdit, QPushButton

from groundstation.services.project.document import Document, PlanEntry
from missions.formats.registry import read_missions
from planning.parameters import FlightRules
from planning.plan import write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from tests.gui.driving import (
    accept_button,
    choose,
    click_on,
    clicked,
    close_controller,
    escape,
    press,
    press_in,
    shut,
    trigger,
    turn_until,
    turn_until_idle,
    type_into,
)
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK

NO = ("Cancel", escape, shut)


@pytest.fixture(scope="module")
def planned():
    model = kiosk()
    return model, plan_flight(model, PlanRequest(n_views=10, greedy=QUICK)).plan


@pytest.fixture(scope="module")
def shown(application, worker, tmp_path_factory):
    """One window for all of these tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path_factory.mktemp("config")))
        from groundstation.gui.window.project_controller import ProjectController

        controller = ProjectController(application, worker=worker)
        controller.show()
        controller.window.setGeometry(0, 0, 1400, 900)
        turn_until(application, lambda: controller.window.shared_view.scene() is not None)
        yield controller
        close_controller(controller)


@pytest.fixture
def controller(application, shown, planned):
    """The window with a site and a plan that are saved nowhere and not changed."""
    model, plan = planned
    shown.context.session.open(Document(model, (PlanEntry("plan-1", "First", plan),), "plan-1"), None)
    turn_until_idle(application, shown)
    return shown


def in_tab(name, text):
    def open_it(application, controller):
        controller.window.show_tab(name)
        turn_until_idle(application, controller)
        press_in(controller.window, text)

    return open_it


def from_menu(text, tab="site"):
    def open_it(application, controller):
        controller.window.show_tab(tab)
        turn_until_idle(application, controller)
        trigger(controller.window, text)

    return open_it


def aircraft_file(application, controller):
    from PySide6.QtCore import Qt
    from PySide6.QtTest import QTest

    controller.window.show_tab("plan")
    turn_until_idle(application, controller)
    box = controller.window.tab("plan").form.aircraft
    box.setFocus()
    QTest.keyClick(box, Qt.Key.Key_End)


def obstacle_mesh(application, controller):
    in_tab("site", "Obstacle mesh...")(application, controller)


def rename(application, controller):
    controller.window.show_tab("plan")
    turn_until_idle(application, controller)
    lists = controller.window.tab("plan").lists
    lists.setCurrentWidget(lists.plans)
    lists.plans.select(("plan-1",))
    press_in(controller.window, "Rename ...")


def open_plan(application, controller):
    controller.window.show_tab("plan")
    turn_until_idle(application, controller)
    lists = controller.window.tab("plan").lists
    lists.setCurrentWidget(lists.plans)
    press_in(controller.window, "Open plan ...")


def open_map(application, controller):
    from groundstation.gui.shared_view import SharedViewPage

    controller.window.show_tab("site")
    controller.window.shared_view.show_page(SharedViewPage.MAP)
    turn_until_idle(application, controller)
    press_in(controller.window.shared_view, "Map file")


ASKING = {
    "open a project": from_menu("Open project ..."),
    "save as": from_menu("Save as ..."),
    "map tiles": from_menu("Map tiles ..."),
    "open a map": open_map,
    "open a site": in_tab("site", "Open..."),
    "import a building": in_tab("site", "Import..."),
    "obstacle mesh": obstacle_mesh,
    "aircraft from a file": aircraft_file,
    "open a plan": open_plan,
    "rename a plan": rename,
    "import missions": from_menu("Import mission files ...", "mission"),
    "compare with missions": from_menu("Compare with file ...", "mission"),
    "photos": in_tab("photos", "Choose folder ..."),
    "model": in_tab("model", "Open a model ..."),
}


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("name", ASKING)
def test_nothing_happens_when_the_user_thinks_better_of_it(application, controller, name):
    before, told = controller.context.document, controller.window.messages.texts()
    for no in NO:
        with clicked(no):
            ASKING[name](application, controller)
        turn_until_idle(application, controller)
    assert controller.context.document is before
    assert controller.window.messages.texts() == told


@pytest.mark.long
def test_a_plan_gets_the_name_that_is_typed(application, controller):
    def name_it(text, button):
        def step(dialog):
            from PySide6.QtWidgets import QLineEdit

            type_into(dialog.findChild(QLineEdit), text)
            press(button)(dialog)

        return step

    with clicked(name_it("Second", "Cancel")):
        rename(application, controller)
    assert controller.context.document.current.title == "First"
    with clicked(name_it("South side", "OK")):
        rename(application, controller)
    assert controller.context.document.current.title == "South side"


@pytest.mark.slow
def test_a_plan_an_aircraft_and_a_mesh_are_opened_from_files(application, controller, planned, tmp_path):
    write_plan(tmp_path / "other.json", planned[1])
    with clicked(choose(tmp_path / "other.json")):
        open_plan(application, controller)
    turn_until_idle(application, controller)
    assert len(controller.context.document.plans) == 2
    path = tmp_path / "pole.ply"
    trimesh.creation.box((1.0, 1.0, 3.0)).export(path)
    n_before = len(controller.context.document.site.site.obstacles)
    with clicked(choose(path)):
        obstacle_mesh(application, controller)
    turn_until_idle(application, controller)
    assert len(controller.context.document.site.site.obstacles) == n_before + 1
    (tmp_path / "bad.toml").write_text("= no aircraft")
    before = controller.window.tab("plan").form.aircraft.value()
    with clicked(choose(tmp_path / "bad.toml")):
        aircraft_file(application, controller)
    assert "bad.toml" in controller.window.tab("plan").form._wrong.text()
    assert controller.window.tab("plan").form.aircraft.value() == before


@pytest.mark.long
def test_missions_are_written_after_a_name_and_replaced_after_a_yes_only(application, controller, tmp_path):
    from groundstation.gui.mission.export_dialog import ExportDialog

    controller.window.show_tab("mission")
    turn_until_idle(application, controller)
    trigger(controller.window, "Export mission files ...")
    dialog = next(each for each in controller.window.findChildren(ExportDialog) if each.isVisible())
    turn_until(application, lambda: dialog.prepared() is not None)
    with clicked(escape):
        press_in(dialog, "Write ...")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "kiosk.kmz").write_bytes(b"before")
    # For the name without its ending too.
    for name in ("kiosk.kmz", "kiosk"):
        with clicked(choose(tmp_path / name), "Cancel") as asked:
            press_in(dialog, "Write ...")
        assert "kiosk.kmz is there already" in asked[1]
        assert (tmp_path / "kiosk.kmz").read_bytes() == b"before"
    with clicked(choose(tmp_path / "kiosk"), "Yes"):
        press_in(dialog, "Write ...")
    turn_until(application, lambda: (tmp_path / "kiosk.kmz").read_bytes() != b"before")
    turn_until_idle(application, controller)
    assert read_missions(tmp_path / "kiosk.kmz")[0].n_photos == 10
    assert controller.window.findChildren(ExportDialog) == []


@pytest.mark.slow
def test_files_of_further_sorties_are_replaced_after_a_yes_only(application, controller, tmp_path):
    from groundstation.gui.mission.export_dialog import ExportDialog

    model = kiosk()
    request = PlanRequest(n_views=10, greedy=QUICK, rules=FlightRules(settle_s=250.0))
    plan = plan_flight(model, request).plan
    assert len(plan.sorties) == 2
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "Slow", plan),), "plan-1"), None)
    controller.window.show_tab("mission")
    turn_until_idle(application, controller)
    trigger(controller.window, "Export mission files ...")
    dialog = controller.window.findChildren(ExportDialog)[-1]
    turn_until(application, lambda: dialog.prepared() is not None)
    second = tmp_path / "kiosk-2.kmz"
    second.write_bytes(b"before")
    for no in NO:
        with clicked(choose(tmp_path / "kiosk.kmz"), no) as asked:
            press_in(dialog, "Write ...")
        turn_until_idle(application, controller)
        assert "These files are replaced: kiosk-2.kmz" in asked[1]
        assert [path.name for path in tmp_path.iterdir()] == ["kiosk-2.kmz"]
    with clicked(choose(tmp_path / "kiosk.kmz"), "Yes"):
        press_in(dialog, "Write ...")
    turn_until_idle(application, controller)
    assert second.read_bytes() != b"before"
    assert (tmp_path / "kiosk.kmz").is_file()


@pytest.mark.slow
def test_the_brief_is_saved_where_it_is_told_and_printed_after_a_yes(application, controller, tmp_path):
    from groundstation.gui.mission.brief_printer import BriefDialog

    controller.window.show_tab("mission")
    turn_until_idle(application, controller)
    trigger(controller.window, "Flight brief ...")
    dialog = controller.window.findChild(BriefDialog)
    turn_until(application, dialog.is_ready)
    for no in NO:
        with clicked(no):
            press_in(dialog, "Save as PDF ...")
        with clicked(no):
            press_in(dialog, "Print ...")
    assert list(tmp_path.iterdir()) == []
    with clicked(choose(tmp_path / "flight No. 12")):
        press_in(dialog, "Save as PDF ...")
    assert (tmp_path / "flight No. 12.pdf").read_bytes().startswith(b"%PDF")
    with clicked(choose(tmp_path / "flight No. 12"), "Cancel") as asked:
        press_in(dialog, "Save as PDF ...")
    assert "flight No. 12.pdf is there already" in asked[1]
    click_on(dialog, next(box for box in dialog.findChildren(QPushButton) if box.text() == "Close"))
    assert not dialog.isVisible()


def test_the_boxes_of_the_help_menu_go_by_every_way(application, controller):
    for text in ("Shortcuts", "About Reflight"):
        for step in ("OK", escape, shut):
            with clicked(step) as shown:
                trigger(controller.window, text)
            assert text in shown[0]


@pytest.mark.slow
@pytest.mark.parametrize("begins_in", ["/", "there"])
def test_a_path_that_is_typed_is_taken_wherever_the_dialog_begins(application, controller, tmp_path, begins_in):
    """Qt's own dialog takes the folder on the way to it."""
    from groundstation.gui.widgets.questions import Questions, choose_file, choose_files

    window, folder = controller.window, tmp_path / "on the way"
    folder.mkdir()
    for name in ("a b.json", "c.json"):
        (folder / name).touch()
    start = tmp_path if begins_in == "there" else Path(begins_in)
    with clicked(choose(folder / "a b.json")):
        assert choose_file(window, "Open", "All (*)") == folder / "a b.json"
    with clicked(choose(folder)):
        assert Questions().folder(window, "Folder") == folder
    with clicked(choose(folder / "new one")):
        assert Questions().new_folder(window, "New", start / "proposed") == folder / "new one"
    with clicked(choose(folder / "a b.json", folder / "c.json")):
        assert choose_files(window, "Files", "All (*)", start) == (folder / "a b.json", folder / "c.json")


def test_a_file_that_is_not_there_is_told_and_another_can_be_named(application, controller, tmp_path):
    from groundstation.gui.widgets.questions import choose_file

    (tmp_path / "right.json").touch()

    def wrong_then_right(dialog):
        line = dialog.findChild(QLineEdit, "fileNameEdit")
        type_into(line, str(tmp_path / "wrong.json"))
        click_on(dialog, accept_button(dialog))
        choose(tmp_path / "right.json")(dialog)

    with clicked(wrong_then_right, "OK") as asked:
        assert choose_file(controller.window, "Open", "All (*)") == tmp_path / "right.json"
    assert "wrong.json: there is nothing of that name." in asked[1]


@pytest.mark.long
@pytest.mark.parametrize("name", ["sora", "terrain", "import"])
def test_enter_in_a_field_presses_what_the_dialog_is_for_and_escape_leaves(
    application, controller, planned, tmp_path, name
):
    """And not the first button that stands in it, which chooses a file."""
    from groundstation.gui.mission.sora_dialog import SoraDialog
    from groundstation.gui.site.site_opener import ImportDialog
    from groundstation.gui.site.terrain_dialog import TerrainDialog

    (model, plan), context, window = planned, controller.context, controller.window
    if name == "sora":
        dialog = SoraDialog(context, plan, model, "kiosk", parent=window)
    elif name == "terrain":
        dialog = TerrainDialog(context, window)
    else:
        path = tmp_path / "box.obj"
        trimesh.creation.box((10.0, 10.0, 10.0)).export(path)
        dialog = ImportDialog(context, path, window)
    dialog.open()
    turn_until_idle(application, controller)
    field = next(
        box for box in dialog.findChildren(QAbstractSpinBox) + dialog.findChildren(QLineEdit) if box.isVisible()
    )
    field.setFocus()
    turn_until(application, field.hasFocus)
    (usual,) = (button for button in dialog.findChildren(QPushButton) if button.isDefault())
    assert usual.property("primary"), usual.text()
    escape(dialog)
    turn_until(application, lambda: not dialog.isVisible())
