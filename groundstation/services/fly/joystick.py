"""Buttons of a joystick or gamepad, as Linux reports them, and what each does in flight.

The kernel's joystick interface (Documentation/input/joydev/joystick-api.rst) gives events of eight bytes: the time in
milliseconds (u32), the value (s16), the type (u8: 1 button, 2 axis, 0x80 added where it tells how things stand at the
beginning) and the number (u8), in the machine's own byte order. Other systems have no such file; nothing is read there.
"""

from __future__ import annotations

import os
import stat
import struct
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, fields
from enum import StrEnum
from pathlib import Path

from groundstation.services.settings import Tell, read_preferences, settings_path

EVENT = struct.Struct("=IhBB")
BUTTON, AT_FIRST = 0x01, 0x80
MAX_EVENTS = 256
"""Read at once; a stick that is moved gives some hundred events a second."""

MAX_BUTTON = 255
NO_BUTTON = -1
FOLDER, PATTERN = Path("/dev/input"), "js*"


class JoystickAction(StrEnum):
    """What a button may do. Nothing here starts motors; Return and Land are held as on the screen."""

    PAUSE = "pause"
    RESUME = "resume"
    RETURN = "return_home"
    LAND = "land"
    VIEW = "view"
    LISTS = "lists"
    MUTE = "mute"


@dataclass(frozen=True, slots=True)
class JoystickButtons:
    """The button of each action, -1 for none; pads differ, so that at first there are none."""

    pause: int = NO_BUTTON
    resume: int = NO_BUTTON
    return_home: int = NO_BUTTON
    land: int = NO_BUTTON
    view: int = NO_BUTTON
    lists: int = NO_BUTTON
    mute: int = NO_BUTTON

    def __post_init__(self) -> None:
        for each in fields(self):
            number = getattr(self, each.name)
            if not NO_BUTTON <= number <= MAX_BUTTON:
                raise ValueError(f"{each.name}: expected a button from 0 to {MAX_BUTTON}, or -1 for none, got {number}")

    def button(self, action: JoystickAction) -> int:
        """The button of an action; -1 for none."""
        return int(getattr(self, action.value))

    def action(self, button: int) -> JoystickAction | None:
        """What a button does; None where it does nothing."""
        return next((each for each in JoystickAction if self.button(each) == button != NO_BUTTON), None)

    def with_button(self, action: JoystickAction, button: int) -> JoystickButtons:
        """The same with another button for an action; no button does two things."""
        numbers = {
            each.value: NO_BUTTON if self.button(each) == button else self.button(each) for each in JoystickAction
        }
        return JoystickButtons(**{**numbers, action.value: button})

    @property
    def is_any(self) -> bool:
        """Whether a button does anything."""
        return any(self.button(each) != NO_BUTTON for each in JoystickAction)


def joystick_path() -> Path:
    """Where the buttons are kept: beside the settings."""
    return settings_path().with_name("joystick.toml")


def read_joystick_buttons(path: Path, tell: Tell = lambda _: None) -> JoystickButtons:
    """What was kept, as `read_preferences`."""
    return read_preferences(path, JoystickButtons(), tell)


@dataclass(frozen=True, slots=True)
class ButtonEvent:
    """A button went down, or up."""

    button: int
    is_down: bool


def button_events(read: bytes) -> Iterator[ButtonEvent]:
    """Buttons that went down or up; axes, how things stood at the beginning, and unknown types are passed over."""
    whole = len(read) - len(read) % EVENT.size
    for _, value, kind, number in EVENT.iter_unpack(read[:whole]):
        if kind == BUTTON:
            yield ButtonEvent(number, value != 0)


class Joystick:
    """The device file of one joystick, read without waiting."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._left = b""

    @classmethod
    def open_first(cls, folder: Path = FOLDER) -> Joystick | None:
        """The first joystick that can be opened; None where there is none."""
        for path in sorted(folder.glob(PATTERN)):
            with suppress(OSError):
                descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
                kind = os.fstat(descriptor).st_mode
                if stat.S_ISCHR(kind) or stat.S_ISFIFO(kind):
                    return cls(descriptor)
                os.close(descriptor)
        return None

    def read(self) -> tuple[ButtonEvent, ...] | None:
        """Events since the last time; None where the joystick has gone."""
        try:
            read = os.read(self.descriptor, MAX_EVENTS * EVENT.size)
        except BlockingIOError:
            return ()
        except OSError:
            return None
        if not read:
            return None
        read = self._left + read
        whole = len(read) - len(read) % EVENT.size
        self._left = read[whole:]
        return tuple(button_events(read[:whole]))

    def close(self) -> None:
        """Let go of it."""
        with suppress(OSError):
            os.close(self.descriptor)
