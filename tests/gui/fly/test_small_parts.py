"""Parts of the Fly tab that need no flight: what is kept for the next start, and the notes."""

import dataclasses
from functools import partial

import pytest
from PySide6.QtCore import QPoint

from groundstation.gui.fly.flight_settings_page import SettingsPage
from groundstation.gui.widgets.terms import TermLabel
from groundstation.services.fly.options import USUAL_ADDRESS, ConnectionChoice, FlightSettings, LinkKind
from groundstation.services.jobs.runner import JobRunner
from groundstation.services.project.document import Document
from groundstation.services.project.session import Session
from planning.base.findings import Severity
from tests.gui.driving import turn_until


@pytest.fixture
def new_controller(application, tmp_path, monkeypatch):
    """Makes the controller of another start of the program."""
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    from groundstation.gui.application.context import ApplicationContext
    from groundstation.gui.fly.fly_controller import FlyController

    runner = JobRunner()
    yield lambda: FlyController(ApplicationContext(Session(Document()), runner))
    runner.shutdown()


def test_whether_rtk_is_needed_is_known_at_the_next_start(new_controller):
    new_controller().set_settings(FlightSettings(needs_rtk=True))
    assert new_controller().settings == FlightSettings(needs_rtk=True)
    new_controller().set_settings(FlightSettings())
    assert new_controller().settings == FlightSettings()


def test_a_setting_that_cannot_be_kept_is_told_and_holds_for_now(new_controller, tmp_path):
    controller, said = new_controller(), []
    controller.parent().messageShown.connect(lambda message: said.append(message.text))
    (tmp_path / "flight.toml").mkdir()
    controller.set_settings(FlightSettings(needs_rtk=True))
    assert controller.settings.needs_rtk
    assert "this is a folder" in said[0]


@pytest.mark.parametrize(
    ("time_s", "words"),
    [(0.0, "0:00.0"), (59.94, "0:59.9"), (59.96, "1:00.0"), (60.0, "1:00.0"), (3599.99, "60:00.0"), (None, "armed")],
)
def test_times_of_notes_never_have_sixty_seconds(application, time_s, words):
    from groundstation.gui.fly.fly_page import FlightNotes

    notes = FlightNotes()
    notes.add(time_s, Severity.NOTE, "armed")
    assert notes.texts().startswith(words)


def test_an_operators_number_is_proved_kept_without_its_secret_and_refused_where_it_is_wrong(application):
    from PySide6.QtWidgets import QApplication

    from groundstation.gui.fly.flight_settings_page import SettingsPage
    from tests.gui.driving import type_into

    page = SettingsPage()
    page.show()
    heard = []
    page.valueChanged.connect(heard.append)

    def typed(line, text):
        type_into(line, text)
        line.clearFocus()
        line.editingFinished.emit()
        QApplication.processEvents()

    typed(page.operator, "FIN87astrdge12k9-xyz")
    assert "its checksum is wrong" in page.identity_said()
    assert heard == []
    typed(page.operator, "FIN87astrdge12k8-xyz")
    assert page.identity_said() == "Operator number: its checksum is right."
    assert page.operator.text() == heard[-1].operator == "FIN87astrdge12k8"
    typed(page.serial, "1581F5FHB229F0020")
    assert (heard[-1].serial_number, heard[-1].operator) == ("1581F5FHB229F0020", "FIN87astrdge12k8")
    page.needs_rtk.setChecked(True)
    assert (heard[-1].needs_rtk, heard[-1].operator) == (True, "FIN87astrdge12k8")
    typed(page.operator, "")
    assert heard[-1].operator == ""
    other = SettingsPage()
    other.setValue(heard[2])
    assert other.operator.text() == "FIN87astrdge12k8"
    page.close()


@pytest.mark.long
def test_a_cameras_definition_file_is_chosen_read_refused_and_taken_off(application, tmp_path):
    from groundstation.gui.fly.flight_settings_page import SettingsPage
    from tests.gui.driving import choose, click_on, clicked
    from tests.missions.mavlink.test_camera_definition import GUIDE

    good, bad = tmp_path / "t100.xml", tmp_path / "notes.xml"
    good.write_bytes(GUIDE)
    bad.write_text("<notes/>")
    page, kept = SettingsPage(), []
    page.valueChanged.connect(kept.append)
    page.show()
    assert not page.definition.without.isVisible()
    with clicked(choose(bad)):
        click_on(page, page.definition.choose)
    assert "is no camera definition: expected <mavlinkcamera>, got <notes>" in page.definition_said()
    assert (kept, page.definition.value()) == ([], None)
    with clicked(choose(good)):
        click_on(page, page.definition.choose)
    assert page.definition_said() == "Foo T100: parameters that can be set: 3"
    assert kept[-1].camera_definition == str(good)
    with clicked(choose(bad)):
        click_on(page, page.definition.choose)
    assert page.definition.value() == good, "the one before is still there"
    other = SettingsPage()
    other.setValue(kept[-1])
    assert other.definition.choose.text() == "t100.xml"
    click_on(page, page.definition.without)
    assert kept[-1].camera_definition == ""
    assert page.definition_said() == ""
    page.close()


def test_a_caster_is_kept_and_its_password_is_not(application, tmp_path, monkeypatch):
    from groundstation.gui.fly.flight_settings_page import SettingsPage
    from groundstation.services.fly.options import flight_settings_path
    from groundstation.services.settings import write_preferences
    from tests.gui.driving import type_into

    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path))
    page = SettingsPage()
    page.show()
    kept, passwords = [], []
    page.valueChanged.connect(kept.append)
    page.passwordTyped.connect(passwords.append)
    for line, text in ((page.corrections, "nowhere"), (page.corrections, "me@h:2101/VRS"), (page.password, "secret")):
        type_into(line, text)
        line.editingFinished.emit()
    assert "expected USER@HOST:PORT/MOUNTPOINT" not in page.corrections_said()
    assert [each.corrections for each in kept] == ["me@h:2101/VRS"]
    assert passwords == ["secret"]
    write_preferences(flight_settings_path(), kept[-1])
    assert "secret" not in flight_settings_path().read_text()
    page.close()


def test_each_aircraft_has_a_row_and_many_have_one_line_each(application):
    from groundstation.gui.fly.fleet_box import FleetBox, FleetRow

    box, chosen = FleetBox(), []
    box.resize(400, 300)
    box.selected.connect(chosen.append)
    rows = tuple(FleetRow(n, f"Aircraft {n}", "AUTO", "sortie 1, 80%", is_in_air=n == 2) for n in (1, 2, 3))
    box.set_rows(rows[:1], 1)
    assert not box.return_all.isEnabled()
    box.set_rows(rows[:2], 2)
    assert box.text() == "Aircraft 1: AUTO\nsortie 1, 80%\nAircraft 2: AUTO\nsortie 1, 80%"
    assert [box.button(n).isChecked() for n in (1, 2)] == [False, True]
    assert box.return_all.isEnabled()
    box.button(1).click()
    assert chosen == [1]
    tall = box.button(1).minimumHeight()
    box.set_rows((*rows[:2], dataclasses.replace(rows[2], role="error")), 2)
    assert box.button(1).text() == "Aircraft 1: AUTO, sortie 1, 80%"
    assert box.button(1).minimumHeight() < tall
    assert box.button(3).text().startswith("\u2717 Aircraft 3"), "no warning is told by colour alone"
    box.set_rows((), 1)
    assert not box.isVisibleTo(None)


def colours_in(widget):
    picture = widget.grab().toImage()
    return {picture.pixel(x, y) for x in range(5, picture.width() - 5) for y in range(5, picture.height() - 5)}


@pytest.mark.parametrize("kind", [LinkKind.UDP, LinkKind.TCP, LinkKind.SERIAL])
def test_usual_addresses_are_read_whole_beside_their_title_or_below_it(application, letters, kind):
    from groundstation.gui.fly.connection_box import ConnectionBox

    box = ConnectionBox()
    box.resize(277, 600)
    box.setValue(ConnectionChoice(kind=kind))
    box.show()
    turn_until(application, lambda: box.address.isVisible() and box.address.width() > 0)
    assert box.address.text() == USUAL_ADDRESS[kind]
    assert box.address.fontMetrics().horizontalAdvance(box.address.text()) < box.address.width() - 8
    assert box.width() == 277
    box.close()


def test_examples_of_addresses_are_read_whole_and_what_says_nothing_takes_no_room(application, letters):
    from groundstation.gui.fly.flight_settings_page import EXAMPLE, EXAMPLE_CASTER, VIDEO_EXAMPLE, SettingsPage
    from groundstation.gui.widgets.scrolling import scrolled
    from groundstation.gui.window.main_window import DETAIL_WIDTH_PX

    page = SettingsPage()
    area = scrolled(page)
    area.resize(DETAIL_WIDTH_PX, 900)
    area.show()
    turn_until(application, lambda: page.video.width() > 0 and page.isVisible())
    lines = (page.operator, EXAMPLE), (page.corrections, EXAMPLE_CASTER), (page.video, VIDEO_EXAMPLE)
    for line, example in lines:
        assert line.shown_example() == example
        assert len(colours_in(line)) > 10, "the example is written"
        line.setText(" ")
        assert len(colours_in(line)) < 10, "the example makes room for what is typed"
    said = (page._identity_said, page._corrections_said, page._video_said, page._definition_said)
    assert not any(label.isVisible() for label in said)
    # However little room there is, what is wrong with a field is seen: right below it, scrolled to.
    area.resize(DETAIL_WIDTH_PX, 320)
    for field, wrong, label in (
        (page.operator, "FIN87astrdge12k9-xyz", page._identity_said),
        (page.corrections, "nowhere", page._corrections_said),
        (page.video, "nowhere", page._video_said),
    ):
        field.setText(wrong)
        field.editingFinished.emit()
        seen = partial(_is_seen, label, area)
        turn_until(application, seen)
        assert label.property("role") == "error"
    area.close()


def _is_seen(widget, area):
    """Whether a widget lies in the height that an area shows; the window makes room for its width."""
    top = widget.mapTo(area.viewport(), QPoint(0, 0)).y()
    return widget.isVisible() and top >= 0 and top + widget.height() <= area.viewport().height()


def test_terms_of_the_settings_of_a_flight_say_what_they_mean(application):
    page = SettingsPage()
    signs = {label.text() for label in page.findChildren(TermLabel)}
    assert {"Operator number", "Serial number", "RTK corrections"} <= signs
    page.close()
