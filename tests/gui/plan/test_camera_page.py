"""The camera on the Plan tab, chosen and clicked as a pilot does."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from groundstation.gui.plan.plan_page import CameraPage
from groundstation.services.mission.camera import camera_report
from groundstation.services.project.document import Document, PlanEntry
from planning.aircraft.catalogue import profile
from planning.parameters import CameraSettings
from tests.gui.driving import click_on, turn_until_idle, type_into
from tests.gui.window.test_main_window import controller
from tests.planning.plan_cases import kiosk
from tests.planning.test_camera_rules import row

__all__ = ["controller"]


@pytest.fixture
def page(application):
    page = CameraPage()
    page.resize(360, 640)
    page.set_controls(profile("m3e").controls)
    page.show()
    application.processEvents()
    return page


def choose(page, name, text):
    """Open the list of a setting by the keyboard and go to the entry that begins with a text, as a user types."""
    box = page.rows[name].widget
    click_on(page, box)
    view = box.view()
    for _ in range(box.count()):
        if box.itemText(view.currentIndex().row()).startswith(text):
            break
        QTest.keyClick(view, Qt.Key.Key_Down)
    else:
        for _ in range(box.count()):
            if box.itemText(view.currentIndex().row()).startswith(text):
                break
            QTest.keyClick(view, Qt.Key.Key_Up)
    QTest.keyClick(view, Qt.Key.Key_Return)
    assert box.currentText().startswith(text)


def is_shown(page, name):
    return page.rows[name].widget.isVisible()


def offered(page, name):
    box = page.rows[name].widget
    return [box.itemText(number) for number in range(box.count())]


def test_a_manual_exposure_is_asked_for_what_it_needs_before_it_counts(application, page):
    told = []
    page.valueChanged.connect(told.append)
    choose(page, "exposure", "manual")
    assert "manual exposure needs a shutter time and an ISO" in page.problem()
    assert told == []
    choose(page, "shutter_s", "1/500 s")
    choose(page, "iso", "200")
    assert page.problem() == ""
    assert told == [CameraSettings("manual", 1 / 500, None, 200)]
    assert not is_shown(page, "compensation_ev"), "a manual exposure has none"


def test_only_what_counts_for_what_is_chosen_is_shown(application, page):
    assert is_shown(page, "white_balance_k")
    assert not is_shown(page, "focus_distance_m")
    choose(page, "white_balance", "cloudy")
    choose(page, "focus", "at a distance")
    assert not is_shown(page, "white_balance_k")
    assert is_shown(page, "focus_distance_m")
    assert page.value().focus_distance_m == 20.0
    line = page.rows["focus_distance_m"].widget.box().lineEdit()
    type_into(line, "15")
    QTest.keyClick(line, Qt.Key.Key_Return)
    assert page.value().focus_distance_m == 15.0
    choose(page, "focus", "infinity")
    assert page.value() == CameraSettings(white_balance="cloudy", focus="infinity")


def test_a_camera_is_offered_what_it_can_do(application, page):
    assert offered(page, "aperture")[1::14] == ["2.8"]
    assert offered(page, "aperture")[-1] == "11.0"
    assert offered(page, "iso")[-1] == "6400"
    assert is_shown(page, "shutter")
    page.set_controls(profile("m3t").controls)
    assert not is_shown(page, "aperture"), "it is fixed"
    assert not is_shown(page, "shutter"), "it has an electronic one only"
    assert offered(page, "iso")[-1] == "6400"
    page.set_controls(profile("m4e").controls)
    assert "infinity" not in offered(page, "focus")
    assert page.value() == CameraSettings(), "and nothing was changed by that"


def test_what_a_file_says_stays_though_no_list_offers_it(application, page):
    odd = CameraSettings("manual", 1 / 777, 6.0, 123, 0.0, "auto", 3333.0, "auto", None, "electronic")
    page.setValue(odd)
    assert page.value() == odd
    assert page.rows["shutter_s"].widget.currentText() == "1/777 s"


def test_what_comes_of_it_stands_below_with_who_sets_what(application, page):
    page.set_report(camera_report(replace(row(), camera_settings=CameraSettings(aperture=2.8)), kiosk()))
    assert "By hand: exposure mode A (aperture priority); ISO automatic; aperture f/2.8" in page.steps_text()
    assert "By the mission: automatic focus before the first photo, then locked" in page.steps_text()
    assert any("f/4 keeps both sharp" in text for text in page.findings.texts())
    page.set_report(None)
    assert page.findings.texts() == ()


@pytest.mark.long
def test_the_plan_is_changed_at_once_and_undone_and_the_next_plan_has_it(application, controller):
    model = kiosk()
    controller.context.session.open(Document(model, (PlanEntry("plan-1", "Row", row()),), "plan-1"), None)
    controller.window.show_tab("plan")
    turn_until_idle(application, controller)
    tab = controller.window.tab("plan")
    assert not tab.camera.isVisible()
    click_on(controller.window, tab.camera_button)
    application.processEvents()
    choose(tab.camera, "aperture", "2.8")
    turn_until_idle(application, controller)
    document = controller.context.document
    assert document.current.plan.camera_settings == CameraSettings(aperture=2.8)
    assert document.request.camera == CameraSettings(aperture=2.8)
    assert any("f/4 keeps both sharp" in text for text in tab.camera.findings.texts())
    controller.context.session.undo()
    turn_until_idle(application, controller)
    assert controller.context.document.current.plan.camera_settings == CameraSettings()
    assert tab.camera.value() == CameraSettings()
    assert not any("f/4" in text for text in tab.camera.findings.texts())
