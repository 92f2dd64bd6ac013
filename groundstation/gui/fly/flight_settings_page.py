"""What the pilot decides about flights: RTK, corrections, remote identification, warnings, video, the camera's file."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QRect, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QPainter, QPaintEvent, QPalette
from PySide6.QtWidgets import QCheckBox, QLabel, QLineEdit, QStyle, QStyleOptionFrame, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.fly.joystick_controller import JoystickBox
from groundstation.gui.widgets.inputs import Form
from groundstation.gui.widgets.scrolling import LEAST_SCALE, fitted, scroll_to
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.gui.widgets.terms import label_of
from groundstation.gui.widgets.value_boxes import FileBox, muted
from groundstation.services.fly.options import FlightSettings
from groundstation.services.fly.video import typed_video
from groundstation.services.fly.video_offer import OfferedVideo
from groundstation.services.units import UnitSystem
from missions.mavlink.camera_definition import read_definition
from missions.mavlink.ntrip import EXAMPLE_CASTER, caster_of
from missions.mavlink.remote_id import EXAMPLE, operator_number, serial_number
from planning.base.errors import InputError

VIDEO_EXAMPLE = "rtsp://192.168.144.25:8554/main.264"


EXAMPLE_ASIDE_PX = 2
"""Between the frame of a line and what stands in it, as Qt has it."""


class ExampleLine(QLineEdit):
    """A line to type into; the example that says the form of what is wanted is written smaller where it has no room."""

    def __init__(self, example: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._example = example
        self.setAccessibleDescription(example)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Room for the smallest letters; a title goes above before there is less."""
        hint = super().minimumSizeHint()
        return QSize(
            hint.width() + math.ceil(LEAST_SCALE * self.fontMetrics().horizontalAdvance(self._example)), hint.height()
        )

    def shown_example(self) -> str:
        """The example, as far as there is room for it."""
        return fitted(self.font(), self._example, self._room().width())[1]

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Write the example where nothing was typed yet."""
        super().paintEvent(event)
        if self.text():
            return
        painter, room = QPainter(self), self._room()
        font, text = fitted(self.font(), self._example, room.width())
        painter.setFont(font)
        painter.setPen(self.palette().color(QPalette.ColorRole.PlaceholderText))
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, text)
        painter.end()

    def _room(self) -> QRect:
        option = QStyleOptionFrame()
        self.initStyleOption(option)
        room = self.style().subElementRect(QStyle.SubElement.SE_LineEditContents, option, self)
        return room.adjusted(EXAMPLE_ASIDE_PX, 0, -EXAMPLE_ASIDE_PX, 0)


class SettingsPage(QWidget):
    """Edits `FlightSettings`.

    Signals
    -------
    valueChanged(FlightSettings), passwordTyped(str)
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    passwordTyped = Signal(str)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.needs_rtk = QCheckBox(self.tr("RTK needed for take-off"))
        self.speaks = QCheckBox(self.tr("Warnings are spoken"))
        self._voice_text, self.joystick = muted(""), JoystickBox()
        self._kept = FlightSettings()
        self.operator, self.serial = ExampleLine(EXAMPLE), QLineEdit()
        # What is said of a field stands right below it, where it is looked at.
        said = [QLabel() for _ in range(4)]
        self._identity_said, self._corrections_said, self._video_said, self._definition_said = said
        self.operator.setToolTip(
            self.tr("For aircraft with remote ID. The secret part proves the checksum, and is neither sent nor kept")
        )
        self.battery, self.corrections, self.password = QLineEdit(), ExampleLine(EXAMPLE_CASTER), QLineEdit()
        self.battery.setMaxLength(40)
        self.battery.setToolTip(self.tr("Its name: the log book counts its flights and cycles"))
        self.corrections.setToolTip(
            self.tr(
                "NTRIP caster, from the next connection on: USER@HOST:PORT/MOUNTPOINT; over TLS ntrips:// before it"
            )
        )
        self.password.setEchoMode(QLineEdit.EchoMode.Password)
        self.password.setToolTip(self.tr("Kept until the program ends, and never written down"))
        self.serial.setToolTip(self.tr("Only where the aircraft's module does not know it"))
        form = Form()
        form.addRow(self.tr("Battery on board"), self.battery)
        form.addRow(self.tr("Operator number"), self.operator)
        form.addRow(self.tr("Serial number"), self.serial)
        form.addRow(self._identity_said)
        # Addresses have the whole width: beside its title half of the example that says their form is cut off.
        _add_below(form, self.tr("RTK corrections"), self.corrections)
        form.addRow(self._corrections_said)
        form.addRow(self.tr("Their password"), self.password)
        self.video = ExampleLine(VIDEO_EXAMPLE)
        self._offered: OfferedVideo | None = None
        self.video.setToolTip(self.tr("The camera's stream, by RTSP, or as an MPEG transport stream by UDP"))
        _add_below(form, self.tr("Video"), self.video)
        form.addRow(self._video_said)
        self.definition = FileBox(
            self.tr("Choose file ..."),
            self.tr("Camera definition file"),
            self.tr("Camera definitions (*.xml *.xz);;All files (*)"),
        )
        self.definition.setToolTip(
            self.tr(
                "Definition file of a MAVLink camera: from the next upload on, it is set by the names and options in "
                "it; without one, the camera is asked for its own"
            )
        )
        form.addRow(self.tr("Camera definition"), self.definition)
        form.addRow(self._definition_said)
        for label in said:
            label.setWordWrap(True)
            _say(label, "muted", "")
        layout = QVBoxLayout(self)
        layout.addWidget(self.needs_rtk)
        layout.addWidget(muted(self.tr("Start waits for RTK, and a warning comes when it is lost in flight.")))
        layout.addWidget(self.speaks)
        layout.addWidget(self._voice_text)
        layout.addLayout(form)
        layout.addWidget(self.joystick)
        layout.addStretch(1)
        self.needs_rtk.toggled.connect(self._edited)
        self.speaks.toggled.connect(self._edited)
        self.operator.editingFinished.connect(self._identity_typed)
        self.serial.editingFinished.connect(self._identity_typed)
        self.battery.editingFinished.connect(self._battery_typed)
        self.corrections.editingFinished.connect(self._corrections_typed)
        self.password.editingFinished.connect(lambda: self.passwordTyped.emit(self.password.text()))
        self.video.editingFinished.connect(self._video_typed)
        self.definition.valueChanged.connect(self._definition_chosen)

    def value(self) -> FlightSettings:
        """What was chosen."""
        return replace(self._kept, needs_rtk=self.needs_rtk.isChecked(), speaks=self.speaks.isChecked())

    def setValue(self, value: FlightSettings) -> None:  # noqa: N802
        """Show another choice."""
        blockers = [QSignalBlocker(box) for box in (self.needs_rtk, self.speaks)]
        self.needs_rtk.setChecked(value.needs_rtk)
        self.speaks.setChecked(value.speaks)
        del blockers
        self._kept = value
        self.operator.setText(value.operator)
        self.serial.setText(value.serial_number)
        self.corrections.setText(value.corrections)
        self.battery.setText(value.battery)
        self.video.setText(value.video)
        self.definition.setValue(Path(value.camera_definition) if value.camera_definition else None)
        _say(self._definition_said, "muted", "")

    def set_voice(self, *, has_voice: bool) -> None:
        """Say whether this computer can speak, and what it lacks."""
        set_enabled(self.speaks, has_voice)
        self._voice_text.setText(
            self.tr("Each as it comes, and again while it holds.")
            if has_voice
            else self.tr("This computer has no speech program: install speech-dispatcher or espeak-ng.")
        )

    def identity_said(self) -> str:
        """What is said of the operator's and the aircraft's numbers."""
        return self._identity_said.text()

    def corrections_said(self) -> str:
        """What is wrong with the address of the corrections; empty for nothing."""
        return self._corrections_said.text()

    def video_said(self) -> str:
        """What is wrong with the address of the video; empty for nothing."""
        return self._video_said.text()

    def take_video(self, url: str) -> None:
        """Take the stream that the camera offers, as if it had been typed."""
        self.video.setText(url)
        self._video_typed()

    def offer_video(self, offered: OfferedVideo | None) -> None:
        """Say what the vehicle's camera tells, where that is not what is shown."""
        if offered is None or offered == self._offered:
            return
        self._offered = offered
        if offered.problem:
            _say(self._video_said, "muted", translated(offered.problem, UnitSystem.METRIC))
        elif offered.url != self._kept.video:
            _say(self._video_said, "muted", self.tr("The vehicle's camera offers {0}").format(offered.url))

    def _video_typed(self) -> None:
        """Take the address of the video, or say what is wrong with it."""
        try:
            url = typed_video(self.video.text())
        except InputError as error:
            _say(self._video_said, "error", translated(str(error), UnitSystem.METRIC))
            return
        _say(self._video_said, "muted", "")
        if url != self._kept.video:
            self._kept = replace(self._kept, video=url)
            self.valueChanged.emit(self.value())

    def definition_said(self) -> str:
        """What is said of the camera's definition file."""
        return self._definition_said.text()

    def _definition_chosen(self, path: Path | None) -> None:
        """Take the camera's definition file, or say why it is none and go on with the one before."""
        try:
            found = None if path is None else read_definition(path)
        except InputError as error:
            before = self._kept.camera_definition
            self.definition.setValue(Path(before) if before else None)
            _say(self._definition_said, "error", translated(str(error), UnitSystem.METRIC))
            return
        if found is None:
            text = ""
        else:
            name = " ".join(filter(None, (found.vendor, found.model)))
            n_settable = sum(parameter.is_settable for parameter in found.parameters)
            text = self.tr("{0}: parameters that can be set: {1}").format(name, n_settable)
        _say(self._definition_said, "ok", text)
        self._kept = replace(self._kept, camera_definition="" if path is None else str(path))
        self.valueChanged.emit(self.value())

    def _identity_typed(self) -> None:
        """Take the operator's and the aircraft's numbers, or say what is wrong with them."""
        typed, serial = self.operator.text().strip(), self.serial.text().strip()
        if (typed, serial) == (self._kept.operator, self._kept.serial_number):
            return
        try:
            number = operator_number(typed) if typed else None
            numbers = "" if number is None else number.public, serial_number(serial) if serial else ""
            kept = replace(self._kept, operator=numbers[0], serial_number=numbers[1])
        except InputError as error:
            _say(self._identity_said, "error", translated(str(error), UnitSystem.METRIC))
            return
        if number is None:
            _say(self._identity_said, "muted", "")
        elif number.is_proved:
            _say(self._identity_said, "ok", self.tr("Operator number: its checksum is right."))
        elif number.is_eu:
            text = self.tr("The form is right. With the secret part the checksum can be proved.")
            _say(self._identity_said, "muted", text)
        else:
            _say(self._identity_said, "muted", self.tr("No number of an EASA state: nothing about it can be proved."))
        self._kept = kept
        self.operator.setText(kept.operator)
        self.valueChanged.emit(self.value())

    def _battery_typed(self) -> None:
        """Take the name of the battery that is on board now."""
        typed = self.battery.text().strip()
        if typed != self._kept.battery:
            self._kept = replace(self._kept, battery=typed)
            self.valueChanged.emit(self.value())

    def _corrections_typed(self) -> None:
        """Take the caster's address, or say what is wrong with it."""
        typed = self.corrections.text().strip()
        if typed == self._kept.corrections:
            return
        try:
            if typed:
                caster_of(typed)
        except InputError as error:
            _say(self._corrections_said, "error", translated(str(error), UnitSystem.METRIC))
            return
        _say(self._corrections_said, "muted", "")
        self._kept = replace(self._kept, corrections=typed)
        self.valueChanged.emit(self.value())

    def _edited(self, _is_on: bool) -> None:
        self.valueChanged.emit(self.value())


def _add_below(form: Form, title: str, field: QWidget) -> None:
    label = label_of(title, field)
    label.setBuddy(field)
    form.addRow(label)
    form.addRow(field)


def _say(label: QLabel, role: str, text: str) -> None:
    label.setProperty("role", role)
    label.style().polish(label)
    label.setText(text)
    label.setVisible(bool(text))
    # What a vehicle offers by itself moves nothing under the pilot's hands.
    if role == "error":
        scroll_to(label)
