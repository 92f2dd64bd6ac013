"""Send to controller as a pilot does it: choose the device, read, agree to what is replaced, and send."""

from dataclasses import replace

import pytest
from PySide6.QtCore import QPoint
from PySide6.QtWidgets import QPushButton

from groundstation.gui.mission.export_dialog import ExportDialog
from groundstation.services.mission.storages import FLY_ROUTES, App, storage_at
from missions.formats.registry import read_missions
from planning.base.findings import Severity
from tests.gui.driving import choose, click_on, clicked, escape, press_in
from tests.gui.mission.test_mission_page import context, idle, opened, page, planned, said  # noqa: F401

ID = "1A2B3C4D-0000-4000-8000-00000000000A"


@pytest.fixture
def devices(tmp_path, monkeypatch):
    """A remote controller with one route of DJI Fly, and a card; nothing else is connected."""
    route = tmp_path / "RC2" / FLY_ROUTES / ID
    route.mkdir(parents=True)
    (route / f"{ID}.kmz").write_bytes(b"old")
    (tmp_path / "CARD").mkdir()
    found = [tmp_path / "RC2", tmp_path / "CARD"]
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.setattr("groundstation.services.mission.storages.mounted_volumes", lambda: iter(found))
    return found


def dialog_of(page, idle, context, planned):  # noqa: F811
    from groundstation.gui.mission.export_dialog import SendDialog

    context.session.open(opened(planned), None)
    idle()
    press_in(page.left, "Send to controller ...")
    idle()
    return page._shared_view.window().findChildren(SendDialog)[-1]


@pytest.mark.long
def test_a_route_of_dji_fly_is_replaced_once_the_pilot_agrees(page, context, planned, idle, said, devices):  # noqa: F811
    dialog = dialog_of(page, idle, context, planned)
    assert (dialog.storage().name, dialog.storage().app) == ("RC2", App.DJI_FLY)
    assert dialog.state_text() == "Ready to be sent, files: 1. Read the warnings."
    path = devices[0] / FLY_ROUTES / ID / f"{ID}.kmz"
    with clicked(escape) as words:
        click_on(dialog, dialog._action)
    assert f"These files are replaced on RC2: {ID}.kmz" in words[0]
    assert path.read_bytes() == b"old"
    with clicked("Yes"):
        click_on(dialog, dialog._action)
    idle()
    assert sum(mission.n_photos for mission in read_missions(path)) == 10
    assert [message.severity for message in said[-2:]] == [Severity.OK, Severity.NOTE]
    assert "Sent, read back and equal to the plan" in said[-2].text
    assert page._shared_view.window().findChildren(type(dialog)) == []


@pytest.mark.slow
def test_a_card_takes_the_mission_by_name(page, context, planned, idle, said, devices):  # noqa: F811
    dialog = dialog_of(page, idle, context, planned)
    dialog._place.setCurrentIndex(1)
    idle()
    dialog._name.setText("north")
    idle()
    assert dialog.state_text().startswith("Ready to be sent, files: 1")
    click_on(dialog, dialog._action)
    idle()
    assert [path.name for path in devices[1].iterdir()] == ["north.kmz"]


@pytest.mark.slow
def test_without_a_device_the_dialog_says_what_to_do_and_a_folder_helps(page, context, planned, idle, devices):  # noqa: F811
    card = devices.pop()
    controller = devices.pop()
    dialog = dialog_of(page, idle, context, planned)
    assert "No card or remote controller is connected" in dialog.state_text()
    assert not dialog._action.isEnabled()
    with clicked(choose(card)):
        press_in(dialog, "Folder ...")
    idle()
    assert dialog.storage() == replace(storage_at(card), free_bytes=dialog.storage().free_bytes)
    assert dialog._action.isEnabled()
    dialog._app.setCurrentIndex(dialog._app.findData(App.DJI_FLY))
    idle()
    assert "has no routes of DJI Fly" in dialog.state_text()
    assert not dialog._action.isEnabled()
    devices.append(controller)
    press_in(dialog, "Look again")
    idle()
    assert dialog.storage().name == "RC2"
    dialog.close()


@pytest.mark.slow
def test_too_few_routes_are_said_and_nothing_can_be_sent(page, context, planned, idle, devices):  # noqa: F811
    (devices[0] / FLY_ROUTES / ID / f"{ID}.kmz").unlink()
    dialog = dialog_of(page, idle, context, planned)
    assert "Cannot be sent: " in dialog.state_text()
    assert "make more in DJI Fly where there are too few" in dialog.state_text()
    assert not next(button for button in dialog.findChildren(QPushButton) if button.text() == "Send").isEnabled()
    dialog.close()


@pytest.mark.slow
def test_a_plan_that_is_not_ready_is_sent_only_once_its_box_is_ticked(page, context, planned, idle, said, devices):  # noqa: F811
    model, plan = planned
    too_far = replace(plan, aircraft=replace(plan.aircraft, endurance_s=100.0))
    dialog = dialog_of(page, idle, context, (model, too_far))
    dialog._place.setCurrentIndex(1)
    idle()
    assert dialog.state_text().startswith("NOT ready to fly, and not sent as it stands")
    assert not dialog._action.isEnabled()
    assert not dialog._despite.isChecked()
    assert "it may crash, or break the law" in dialog._despite.text()
    dialog._name.setText("north")
    idle()
    tick = QPoint(8, dialog._despite.height() // 2)
    click_on(dialog, dialog._despite, tick)
    assert dialog._action.isEnabled()
    dialog._name.setText("south")
    idle()
    assert not dialog._despite.isChecked()
    assert not dialog._action.isEnabled()
    click_on(dialog, dialog._despite, tick)
    click_on(dialog, dialog._action)
    idle()
    assert [path.name for path in devices[1].iterdir()] == ["south.kmz"]
    assert said[-2].severity is Severity.WARNING
    assert said[-2].text.startswith(
        "Sent all the same. NOT ready to fly: sortie 1: duration with the battery reserve kept"
    )


@pytest.mark.slow
def test_files_of_a_plan_that_is_not_ready_are_never_called_ready(page, context, planned, idle):  # noqa: F811
    model, plan = planned
    too_far = replace(plan, aircraft=replace(plan.aircraft, endurance_s=100.0))
    context.session.open(opened((model, too_far)), None)
    idle()
    press_in(page.left, "Export mission files ...")
    idle()
    dialog = page._shared_view.window().findChildren(ExportDialog)[-1]
    assert dialog.state_text().startswith("NOT ready to fly: see the finding.")
    assert "Ready" not in dialog.state_text()
    assert dialog._action.isEnabled()
    dialog.close()
