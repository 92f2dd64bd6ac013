"""A joystick in the window: its buttons are learned by pressing them, and held while they are down."""

import os
import time

import pytest
from PySide6.QtCore import QObject
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from groundstation.gui.fly.joystick_controller import JoystickBox, JoystickController
from groundstation.services.fly.joystick import EVENT, NO_BUTTON, JoystickAction, JoystickButtons


class Pad:
    """The other end of a device file."""

    def __init__(self, folder):
        os.mkfifo(folder / "js0")
        self.end = os.open(folder / "js0", os.O_RDWR | os.O_NONBLOCK)

    def send(self, button, is_down):
        os.write(self.end, EVENT.pack(0, int(is_down), 1, button))


@pytest.fixture
def pad(tmp_path):
    pad = Pad(tmp_path)
    yield pad
    os.close(pad.end)


@pytest.fixture
def controller(application, pad, tmp_path):
    parent = QObject()
    controller = JoystickController(parent, tmp_path)
    controller.heard = []
    controller.pressed.connect(lambda action: controller.heard.append((action, True)))
    controller.released.connect(lambda action: controller.heard.append((action, False)))
    yield controller
    controller.close()


def wait_for(condition):
    end = time.monotonic() + 20.0
    while not condition():
        QApplication.processEvents()
        time.sleep(0.005)
        assert time.monotonic() < end


def test_without_a_button_that_does_anything_no_device_is_opened(controller):
    controller.set_buttons(JoystickButtons())
    assert not controller.is_found()
    controller.set_buttons(JoystickButtons(pause=1))
    assert controller.is_found()
    controller.set_buttons(JoystickButtons())
    assert not controller.is_found()


def test_presses_and_releases_are_told_once_and_others_not(controller, pad):
    controller.set_buttons(JoystickButtons(return_home=4))
    for button, is_down in ((3, True), (4, True), (4, True), (3, False), (4, False), (4, False)):
        pad.send(button, is_down)
    wait_for(lambda: len(controller.heard) >= 2)
    QTest.qWait(30)
    assert controller.heard == [(JoystickAction.RETURN, True), (JoystickAction.RETURN, False)]


def test_a_button_that_is_held_when_the_joystick_goes_is_let_go(controller, pad):
    controller.set_buttons(JoystickButtons(land=2))
    pad.send(2, True)
    wait_for(lambda: controller.heard)
    controller.close()
    assert controller.heard == [(JoystickAction.LAND, True), (JoystickAction.LAND, False)]


def test_a_button_is_learned_by_pressing_it_and_does_nothing_else_then(controller, pad):
    box = JoystickBox()
    box.learningChanged.connect(lambda is_on: controller.learn(is_learning=is_on))
    box.valueChanged.connect(controller.set_buttons)
    controller.learned.connect(box.learn)
    box.rows[JoystickAction.PAUSE].click()
    assert box.rows[JoystickAction.PAUSE].text() == "Press it ..."
    pad.send(9, True)
    wait_for(lambda: box.value().pause == 9)
    assert box.rows[JoystickAction.PAUSE].text() == "button 9"
    assert controller.heard == []
    pad.send(9, False)
    pad.send(9, True)
    wait_for(lambda: controller.heard == [(JoystickAction.PAUSE, True)])
    box.rows[JoystickAction.PAUSE].click()
    box.rows[JoystickAction.PAUSE].click()
    assert box.value().pause == NO_BUTTON
    assert not controller.is_found()
