"""The flight screen: figures over the view, keys and joystick buttons, in the real window with the simulation."""

from dataclasses import replace

import pytest
from PySide6.QtTest import QTest

from groundstation.gui.shared_view import SharedViewPage
from groundstation.services.fly.announce import aged_warnings
from groundstation.services.fly.events import Request
from groundstation.services.fly.joystick import JoystickAction
from groundstation.vehicle.watch import FlightWarning
from planning.base.findings import Severity
from planning.base.messages import say
from tests.gui.driving import click_on, clicked, escape, turn_until
from tests.gui.fly.test_fly_page import connect, controller, has_landed, page, take_off

__all__ = ["controller", "page"]


@pytest.mark.long
def test_in_flight_the_view_has_the_room_of_the_lists_and_a_joystick_returns_by_a_hold(application, controller, page):
    """Figures over the view, the lists when they are wanted; the report brings them back."""
    shared_view = controller.window.shared_view
    assert page.bottom.isVisible()
    before_px = shared_view.height()
    connect(application, page)
    assert not page.bottom.isVisible()
    assert shared_view.height() > 1.3 * before_px
    assert page.overlay.figures.isVisible()
    assert page.overlay.banner.isHidden()
    take_off(application, page)
    turn_until(application, lambda: page.overlay.camera.pose() is not None)
    assert "to the facade, min 10.0 m" in page.overlay.figures.text()
    assert page.overlay.attitude.text().startswith("heading ")
    warned = FlightWarning("wind", Severity.ERROR, say("the wind is {:.1f} m/s", 9.0), 0.0, 9.0, 8.0, "m/s")
    page.overlay.set_warnings(aged_warnings(replace(page.controller.active.view, warnings=(warned,))))
    page.overlay.draw()
    banner = page.overlay.banner
    assert banner.isVisible()
    assert banner.height() >= banner.fontMetrics().height()
    assert shared_view.childAt(banner.geometry().center()).parentWidget() is banner, "nothing lies over it"
    page.lists.click()
    application.processEvents()
    assert page.bottom.isVisible()
    assert not page.overlay.figures.isVisible()
    page.lists.click()
    controller.window.show_tab("site")
    assert not page.overlay.figures.isVisible()
    controller.window.show_tab("fly")
    application.processEvents()
    assert page.overlay.figures.isVisible()
    looks = (page.lists.isChecked, page.overlay.camera.width, lambda: page.settings.value().speaks)
    for action, look in zip(page.actions()[-3:], looks, strict=True):
        before = look()
        action.trigger()
        assert look() != before, action.text()
        action.trigger()
        assert look() == before, action.text()
    page.joystick.pressed.emit(JoystickAction.VIEW)
    assert shared_view.page() is SharedViewPage.MAP
    heard = []
    page.buttons.requested.connect(heard.append)
    page.joystick.pressed.emit(JoystickAction.RETURN)
    application.processEvents()
    page.joystick.released.emit(JoystickAction.RETURN)
    QTest.qWait(900)
    assert heard == [], "a slip of the thumb"
    page.joystick.pressed.emit(JoystickAction.RETURN)
    turn_until(application, lambda: heard == [Request.RETURN])
    page.joystick.released.emit(JoystickAction.RETURN)
    turn_until(application, lambda: has_landed(page))
    application.processEvents()
    assert page.report.isVisible()
    assert not page.overlay.figures.isVisible()
    turn_until(application, lambda: not page.buttons.button(Request.RETURN).isEnabled())
    assert not page.buttons.button(Request.LAND).isEnabled()


@pytest.mark.slow
def test_the_keys_of_return_and_land_work_while_a_dialog_asks_something(application, controller, page):
    connect(application, page)
    take_off(application, page)
    heard = []
    page.buttons.requested.connect(heard.append)
    action = page.buttons.emergency_actions()[0]

    def order(dialog):
        dialog.activateWindow()
        turn_until(application, dialog.isActiveWindow)
        QTest.keySequence(dialog, action.shortcut())
        turn_until(application, lambda: heard == [Request.RETURN])
        escape(dialog)

    with clicked(order):
        click_on(controller.window, page.connection.button)
    assert heard == [Request.RETURN]
    assert page.controller.is_connected
