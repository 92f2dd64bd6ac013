"""The camera of a flight: its settings, by what the camera can do, and what photos come of them."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.inputs import Form, NumberBox, QuantityBox
from groundstation.gui.widgets.parameter_form import add_rows, rows_of
from groundstation.gui.widgets.value_boxes import ErrorLine
from groundstation.services.mission.camera import CameraReport
from groundstation.services.units import UnitSystem
from planning.base.parameters import declared, with_values
from planning.optics import CameraControls
from planning.parameters import CameraSettings

FIRST_FOCUS_M = 20.0
"""Offered for a focus at a distance: twice the usual safety distance holds pane and infinity best."""


LIST_PX = 180
"""Height of the findings: two of them, of five."""


class CameraPage(QWidget):
    """`value()`, `setValue()` and `valueChanged` of camera settings, and what was found about them.

    Signals
    -------
    valueChanged(CameraSettings)
        After an edit that makes sense; while it makes none, the reason stands below the form.
    placePicked(str)
        The user wants to see the place of a finding.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    placePicked = Signal(str)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = CameraSettings()
        self._controls: CameraControls | None = None
        self._report: CameraReport | None = None
        self._units = UnitSystem.METRIC
        self.rows = rows_of(declared(CameraSettings))
        distance = self.rows["focus_distance_m"].widget
        assert isinstance(distance, QuantityBox)
        distance.setValue(FIRST_FOCUS_M)
        self._form = Form()
        add_rows(self._form, self.rows)
        self._wrong, self._steps, self.findings = ErrorLine(), QLabel(), FindingsList()
        self._steps.setWordWrap(True)
        self._steps.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.findings.set_placeholder(self.tr("What comes of these settings stands here, once there is a plan."))
        self.findings.setMinimumHeight(LIST_PX)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(self._form)
        layout.addWidget(self._wrong)
        layout.addWidget(self._steps)
        layout.addWidget(self.findings, 1)
        for row in self.rows.values():
            row.valueChanged.connect(self._edited)
        self.findings.placePicked.connect(self.placePicked)
        self.set_controls(None)

    def value(self) -> CameraSettings:
        """The last settings that made sense."""
        return self._value

    def setValue(self, settings: CameraSettings) -> None:  # noqa: N802
        """Show settings."""
        if settings == self._value and not self._wrong.text():
            return
        self._value = settings
        self._fill()

    def set_controls(self, controls: CameraControls | None) -> None:
        """Offer what a camera can do; all of it where that is not known."""
        self._controls = controls
        self._offer()
        self._fill()

    def set_report(self, report: CameraReport | None) -> None:
        """Show what comes of the settings; None takes it away."""
        self._report = report
        self.findings.set_findings(() if report is None else report.findings)
        self._say_steps()

    def set_units(self, system: UnitSystem) -> None:
        """Show distances in other units."""
        self._units = system
        for row in self.rows.values():
            row.set_units(system)
        self.findings.set_units(system)
        self._say_steps()

    def problem(self) -> str:
        """Why what stands in the boxes makes no sense; empty where it does."""
        return self._wrong.text()

    def steps_text(self) -> str:
        """Who sets what."""
        return self._steps.text()

    def _say_steps(self) -> None:
        lines = []
        if self._report is not None:
            steps = self._report.steps
            for text, found in (
                (self.tr("By hand: {0}"), steps.by_hand),
                (self.tr("By the mission: {0}"), steps.by_mission),
            ):
                if found:
                    lines.append(text.format("; ".join(translated(step, self._units) for step in found)))
            lines += [translated(self._report.cost, self._units)] if self._report.cost else []
        self._steps.setText("\n".join(lines))
        self._steps.setVisible(bool(lines))

    def _offer(self) -> None:
        """What lists hold: the camera's own range, and always what is set."""
        controls, known = self._controls, declared(CameraSettings)
        for name in ("shutter_s", "aperture", "iso", "white_balance", "focus", "shutter"):
            parameter = known[name].parameter
            offered = [choice.value for choice in parameter.choices] or [None, *parameter.suggested]
            if controls is not None:
                offered = [each for each in offered if self._can(controls, name, each)]
            with QSignalBlocker(self.rows[name]):
                self.rows[name].offer(offered)
        kelvin = self.rows["white_balance_k"].widget
        if controls is not None and controls.white_balance_k is not None and isinstance(kelvin, NumberBox):
            kelvin.setRange(*controls.white_balance_k)

    @staticmethod
    def _can(controls: CameraControls, name: str, value: Any) -> bool:
        if value is None:
            return True
        match name:
            case "shutter_s":
                times = (controls.mechanical_shutter_s, controls.electronic_shutter_s)
                return any(each is not None and each[0] * 0.99 <= value <= each[1] * 1.01 for each in times)
            case "aperture":
                return bool(controls.aperture[0] <= value <= controls.aperture[1])
            case "iso":
                return bool(controls.iso[0] <= value <= controls.iso[1])
            case "white_balance":
                return value in controls.white_balances and (value != "kelvin" or controls.white_balance_k is not None)
            case "focus":
                return value in controls.focus
            case _:
                return bool(controls.shutter_kind(value) == value)

    def _fill(self) -> None:
        """Show the settings in the boxes."""
        for name, row in self.rows.items():
            value = getattr(self._value, name)
            with QSignalBlocker(row):
                row.setValue(FIRST_FOCUS_M if name == "focus_distance_m" and value is None else value)
        self._wrong.show_error("")
        self._show_rows()

    def _show_rows(self) -> None:
        """Only what counts for what is chosen is shown, and only what the camera leaves to choose."""
        focus, balance = self.rows["focus"].value(), self.rows["white_balance"].value()
        controls = self._controls
        has_both = controls is None or (
            controls.mechanical_shutter_s is not None and controls.electronic_shutter_s is not None
        )
        is_fixed = controls is not None and controls.aperture[0] == controls.aperture[1]
        shown = {
            "focus_distance_m": focus == "distance",
            "white_balance_k": balance == "kelvin",
            "compensation_ev": self.rows["exposure"].value() != "manual",
            "aperture": not is_fixed or self._value.aperture is not None,
            "shutter": has_both,
        }
        for name, is_shown in shown.items():
            self._form.setRowVisible(self.rows[name].widget, is_shown)

    def _edited(self) -> None:
        self._show_rows()
        values: dict[tuple[str, ...], Any] = {(name,): row.value() for name, row in self.rows.items()}
        if values["focus",] != "distance":
            values["focus_distance_m",] = None
        try:
            settings = with_values(self._value, values)
        except ValueError as error:
            self._wrong.show_error(translated(str(error), self._units))
            return
        self._wrong.show_error("")
        if settings != self._value:
            self._value = settings
            self.valueChanged.emit(settings)
