"""What a pilot chooses for mission files: the format and the options that it has."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtCore import QSignalBlocker, Signal
from PySide6.QtWidgets import QCheckBox, QWidget

from groundstation.gui.inputs import ChoiceBox, Form, LengthBox
from groundstation.services.mission_files import MAVLINK_FORMATS
from groundstation.services.units import UnitSystem
from missions.dji.write import MIN_RTH_HEIGHT_M, LinkLoss
from missions.encode import ExportOptions
from missions.mavlink.autopilots import Autopilot
from missions.model import FileFormat, HeightReference

MAX_RETURN_HEIGHT_M = 1500.0
"""Highest that DJI's waylines allow for any height above take-off."""

FIRST_RETURN_HEIGHT_M = 60.0


class ExportForm(QWidget):
    """`value()`, `setValue()` and `valueChanged` of a format with its options; what a format lacks is hidden."""

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._format, self._heights, self._autopilot, self._link_loss = (ChoiceBox() for _ in range(4))
        self._return_auto = QCheckBox(self.tr("above everything on the site"))
        self._return_auto.setChecked(True)
        self._return = LengthBox(MIN_RTH_HEIGHT_M, MAX_RETURN_HEIGHT_M, 5.0, units)
        self._return.setValue(FIRST_RETURN_HEIGHT_M)
        self._fill()
        form = self._form = Form(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.addRow(self.tr("Format"), self._format)
        form.addRow(self.tr("Heights in the file"), self._heights)
        form.addRow(self.tr("Autopilot"), self._autopilot)
        form.addRow(self.tr("Without radio link"), self._link_loss)
        form.addRow(self.tr("Return height"), self._return_auto)
        form.addRow(self.tr("Above take-off"), self._return)
        for box in (self._format, self._heights, self._autopilot, self._link_loss):
            box.currentIndexChanged.connect(self._changed)
        self._return_auto.toggled.connect(self._changed)
        self._return.valueChanged.connect(self._changed)
        self._show_options()

    def value(self) -> tuple[FileFormat, ExportOptions]:
        """The format and its options; what is hidden has its usual value."""
        file_format = FileFormat(self._format.currentData())
        options = ExportOptions()
        if self._form.isRowVisible(self._heights):
            options = replace(options, height_reference=HeightReference(self._heights.currentData()))
        if file_format in MAVLINK_FORMATS and self._autopilot.currentData():
            options = replace(options, autopilot=Autopilot(self._autopilot.currentData()))
        if file_format is FileFormat.DJI_KMZ:
            height_m = None if self._return_auto.isChecked() else self._return.value()
            options = replace(options, link_loss=LinkLoss(self._link_loss.currentData()), rth_height_m=height_m)
        return file_format, options

    def setValue(self, file_format: FileFormat, options: ExportOptions) -> None:  # noqa: N802
        """Show a format and options."""
        with QSignalBlocker(self):
            for box, value in (
                (self._format, file_format.value),
                (self._heights, options.height_reference.value),
                (self._autopilot, options.autopilot.value if options.autopilot else ""),
                (self._link_loss, options.link_loss.value),
            ):
                box.setCurrentIndex(max(0, box.findData(value)))
            self._return_auto.setChecked(options.rth_height_m is None)
            if options.rth_height_m is not None:
                self._return.setValue(options.rth_height_m)
            self._show_options()

    def set_units(self, units: UnitSystem) -> None:
        """Show the return height in other units."""
        self._return.set_units(units)

    def _fill(self) -> None:
        for text, value in (
            (self.tr("DJI (.kmz)"), FileFormat.DJI_KMZ),
            (self.tr("QGroundControl (.plan)"), FileFormat.MAVLINK_PLAN),
            (self.tr("Mission Planner (.waypoints)"), FileFormat.MAVLINK_WPL),
            (self.tr("Google Earth (.kml), to look at"), FileFormat.KML),
            (self.tr("Table of photos (.csv)"), FileFormat.CSV),
        ):
            self._format.addItem(text, value.value)
        self._autopilot.addItem(self.tr("by aircraft"), "")
        self._autopilot.addItem("ArduPilot", Autopilot.ARDUPILOT.value)
        self._autopilot.addItem("PX4", Autopilot.PX4.value)
        self._link_loss.addItem(self.tr("fly the mission to its end"), LinkLoss.CONTINUE.value)
        self._link_loss.addItem(self.tr("return home straight"), LinkLoss.GO_HOME.value)
        self._fill_heights(FileFormat.DJI_KMZ)

    def _fill_heights(self, file_format: FileFormat) -> None:
        kept = self._heights.currentData()
        choices = [
            (self.tr("above take-off"), HeightReference.ABOVE_TAKEOFF),
            (self.tr("above sea level (EGM96)"), HeightReference.AMSL),
        ]
        if file_format is FileFormat.DJI_KMZ:
            choices.append((self.tr("above ellipsoid (WGS 84)"), HeightReference.ELLIPSOID))
        with QSignalBlocker(self._heights):
            self._heights.clear()
            for text, value in choices:
                self._heights.addItem(text, value.value)
            self._heights.setCurrentIndex(max(0, self._heights.findData(kept)))

    def _changed(self) -> None:
        self._show_options()
        self.valueChanged.emit()

    def _show_options(self) -> None:
        file_format = FileFormat(self._format.currentData())
        is_dji, is_mavlink = file_format is FileFormat.DJI_KMZ, file_format in MAVLINK_FORMATS
        self._fill_heights(file_format)
        self._form.setRowVisible(self._heights, is_dji or is_mavlink)
        self._form.setRowVisible(self._autopilot, is_mavlink)
        for row in (self._link_loss, self._return_auto):
            self._form.setRowVisible(row, is_dji)
        self._form.setRowVisible(self._return, is_dji and not self._return_auto.isChecked())
