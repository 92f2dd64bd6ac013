"""Buttons of a joystick: the kernel's events, whatever bytes come, and what each button does."""

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.joystick import (
    EVENT,
    NO_BUTTON,
    ButtonEvent,
    Joystick,
    JoystickAction,
    JoystickButtons,
    button_events,
    read_joystick_buttons,
)
from groundstation.services.settings import write_preferences

ACTIONS = st.sampled_from(list(JoystickAction))


def event(kind, number, value, time_ms=1234):
    return EVENT.pack(time_ms, value, kind, number)


def test_buttons_are_heard_and_all_else_is_passed_over():
    """As the kernel's documentation has them: first how things stand (0x80), then events; axes are of type 2."""
    read = event(0x81, 0, 1) + event(0x82, 0, -32767) + event(1, 3, 1) + event(2, 1, 12000) + event(1, 3, 0)
    assert tuple(button_events(read)) == (ButtonEvent(3, True), ButtonEvent(3, False))
    assert EVENT.size == 8


@given(st.binary(max_size=200))
def test_whatever_bytes_come_no_button_is_out_of_range(read):
    for found in button_events(read):
        assert 0 <= found.button <= 255


@given(st.lists(st.tuples(ACTIONS, st.integers(-1, 255)), max_size=30))
def test_no_button_ever_does_two_things(pairs):
    buttons = JoystickButtons()
    for action, number in pairs:
        buttons = buttons.with_button(action, number)
        assert buttons.button(action) == number
        used = [buttons.button(each) for each in JoystickAction if buttons.button(each) != NO_BUTTON]
        assert len(used) == len(set(used))
        assert number == NO_BUTTON or buttons.action(number) is action
    assert buttons.is_any == any(buttons.button(each) != NO_BUTTON for each in JoystickAction)
    assert buttons.action(NO_BUTTON) is None


def test_choices_are_kept_and_a_damaged_file_is_put_aside(tmp_path):
    path, told = tmp_path / "joystick.toml", []
    wanted = JoystickButtons(return_home=4, pause=0)
    write_preferences(path, wanted)
    assert read_joystick_buttons(path, told.append) == wanted
    for damaged in ("land = 999", "land = 'x'", "\x00"):
        path.write_text(damaged)
        assert read_joystick_buttons(path, told.append) == JoystickButtons()
    assert len(told) == 3


@pytest.fixture
def pipe(tmp_path):
    """A device file and the other end of it."""
    os.mkfifo(tmp_path / "js0")
    end = os.open(tmp_path / "js0", os.O_RDWR | os.O_NONBLOCK)
    yield tmp_path, end
    os.close(end)


def test_a_device_is_read_without_waiting_in_pieces_and_until_it_is_gone(pipe):
    folder, end = pipe
    joystick = Joystick.open_first(folder)
    assert joystick.read() == ()
    whole = event(1, 7, 1) + event(1, 7, 0)
    os.write(end, whole[:5])
    assert joystick.read() == ()
    os.write(end, whole[5:])
    assert joystick.read() == (ButtonEvent(7, True), ButtonEvent(7, False))
    joystick.close()
    assert joystick.read() is None


def test_what_is_no_device_is_no_joystick(tmp_path):
    assert Joystick.open_first(tmp_path / "none") is None
    (tmp_path / "js0").write_bytes(event(1, 0, 1))
    (tmp_path / "js1").mkdir()
    (tmp_path / "js2").symlink_to(tmp_path / "nowhere")
    assert Joystick.open_first(tmp_path) is None
