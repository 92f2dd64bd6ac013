"""Editing one viewpoint by hand: where it is, where it looks, and whether a new plan must keep it."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QCheckBox, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.inputs import Form, LengthBox, NumberBox
from groundstation.gui.scrolling import ButtonGrid
from groundstation.services.units import UnitSystem
from planning.mesh import MAX_COORDINATE_M
from planning.plan import ANGLE_DECIMALS, Camera, Viewpoint

NUDGE_M = 0.5


class ViewpointEditor(QWidget):
    """`value()`, `setValue()` and `valueChanged` of a viewpoint, and buttons for what concerns it as a whole.

    Signals
    -------
    valueChanged(Viewpoint)
    addWanted(), deleteWanted(), aimWanted()
        A new viewpoint beside this one; this one away; this one turned towards the selected panel.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    addWanted = Signal()  # noqa: N815
    deleteWanted = Signal()  # noqa: N815
    aimWanted = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value: Viewpoint | None = None
        self._name, self._says = QLabel(), QLabel()
        self._name.setProperty("role", "heading")
        self._says.setWordWrap(True)
        self._position = tuple(LengthBox(-MAX_COORDINATE_M, MAX_COORDINATE_M, NUDGE_M, decimals=2) for _ in range(3))
        self._heading = NumberBox(-180.0, 180.0, 5.0, "°")
        self._heading.setWrapping(True)
        self._pitch = NumberBox(-90.0, 90.0, 5.0, "°")
        self._locked = QCheckBox(self.tr("Keep when planning again"))
        self._locked.setToolTip(self.tr("Keep this viewpoint as it is when planning again"))
        self._add = QPushButton(self.tr("Add"))
        self._add.setToolTip(self.tr("A new viewpoint beside this one"))
        self._delete = QPushButton(self.tr("Delete"))
        self._aim = QPushButton(self.tr("Aim at panel"))
        self._aim.setToolTip(self.tr("Turn towards the panel that was selected last"))
        self._lay_out()
        for box in (*self._position, self._heading, self._pitch):
            box.valueChanged.connect(self._edited)
        self._locked.toggled.connect(self._edited)
        for button, signal in (
            (self._add, self.addWanted),
            (self._delete, self.deleteWanted),
            (self._aim, self.aimWanted),
        ):
            button.clicked.connect(lambda _checked=False, signal=signal: signal.emit())
        self.setValue(None)

    def _lay_out(self) -> None:
        form = Form()
        names = (self.tr("East"), self.tr("North"), self.tr("Up"), self.tr("Heading"), self.tr("Pitch"))
        for name, box in zip(names, (*self._position, self._heading, self._pitch), strict=True):
            form.addRow(name, box)
        buttons = ButtonGrid(3)
        for button in (self._aim, self._add, self._delete):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 0)
        # What an edit did must be seen without scrolling.
        for widget in (self._name, self._says):
            layout.addWidget(widget)
        layout.addLayout(form)
        layout.addLayout(buttons)
        layout.addWidget(self._locked)

    def value(self) -> Viewpoint | None:
        """The viewpoint as it is edited; None where none is shown."""
        return self._value

    def setValue(self, viewpoint: Viewpoint | None) -> None:  # noqa: N802
        """Show a viewpoint, or none."""
        self._value = viewpoint
        self._locked.setEnabled(viewpoint is not None)
        for widget in (*self._position, self._heading, self._pitch, self._delete, self._aim):
            widget.setEnabled(viewpoint is not None and not viewpoint.locked)
        self._name.setText(self.tr("No viewpoint selected") if viewpoint is None else viewpoint.id)
        if viewpoint is None:
            self._says.clear()
            return
        blockers = [QSignalBlocker(box) for box in (self._heading, self._pitch, self._locked)]
        for box, coordinate in zip(self._position, viewpoint.position_enu_m, strict=True):
            box.setValue(coordinate)
        self._heading.setValue(viewpoint.heading_deg)
        self._pitch.setValue(viewpoint.gimbal_pitch_deg)
        self._locked.setChecked(viewpoint.locked)
        del blockers

    def set_camera(self, camera: Camera) -> None:
        """Only pitches that the gimbal can do can be entered."""
        with QSignalBlocker(self._pitch):
            self._pitch.setRange(*camera.gimbal_pitch_deg)

    def set_units(self, system: UnitSystem) -> None:
        """Show positions in other units."""
        for box in self._position:
            box.set_units(system)

    def say(self, text: str, *, wrong: bool = False) -> None:
        """What the last edit did, or what is wrong with this viewpoint."""
        self._says.setText(text)
        self._says.setProperty("role", "error" if wrong else "muted")
        self._says.style().polish(self._says)

    def _edited(self) -> None:
        before = self._value
        if before is None:
            return
        x, y, z = (box.value() for box in self._position)
        heading, pitch = (
            old if box.value() == old else round(box.value(), ANGLE_DECIMALS)
            for box, old in ((self._heading, before.heading_deg), (self._pitch, before.gimbal_pitch_deg))
        )
        edited = replace(
            before,
            position_enu_m=(x, y, z),
            heading_deg=heading,
            gimbal_pitch_deg=pitch,
            locked=self._locked.isChecked(),
        )
        if edited != before:
            self._value = edited
            self.valueChanged.emit(edited)
