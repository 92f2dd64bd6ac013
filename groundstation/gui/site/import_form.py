"""What the user may say about an import: only what matters for the file's format."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import cast

from PySide6.QtCore import QLocale, Signal
from PySide6.QtGui import QDoubleValidator
from PySide6.QtWidgets import QComboBox, QWidget

from groundstation.gui.inputs import ChoiceBox, Form, LengthBox
from groundstation.gui.site.origin_box import OriginBox
from groundstation.gui.site.site_tree_model import size_text
from groundstation.gui.site.value_boxes import NameBox
from groundstation.services.site_sources import holds_many_buildings
from groundstation.services.units import UnitSystem
from planning.geodesy.crs import AxisOrder, HeightReference
from planning.mesh import MESH_SUFFIXES
from planning.site_import.options import UNITS_M, ImportOptions
from planning.site_import.source import BuildingChoice

FILE_SAYS, ZERO_POINT, SYSTEM = "file", "zero", "system"

MARGIN_M = (5.0, 500.0)
"""Least and largest distance of the airspace's sides from the building."""


class ImportForm(QWidget):
    """Edits one `ImportOptions`, but for the panel grids, which are kept as they were set.

    Signals
    -------
    valueChanged(ImportOptions)
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, path: Path, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = units
        self._rest = ImportOptions()
        self._has_map = holds_many_buildings(path)
        is_mesh = path.suffix.lower() in MESH_SUFFIXES
        self._building = _combo((("", self.tr("As the file suggests")),))
        self._building.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._name, self._crs = NameBox(), NameBox()
        self._name.setPlaceholderText(self.tr("as the file says"))
        self._crs.setPlaceholderText("EPSG:25832")
        self._unit = _combo((name, name) for name in UNITS_M)
        self._up = _combo((("", self.tr("As usual for the format")), ("z", "z"), ("y", "y")))
        places = ((ZERO_POINT, self.tr("Zero point on earth")), (SYSTEM, self.tr("Coordinate system")))
        self._place = _combo(places if is_mesh else ((FILE_SAYS, self.tr("As the file says")), *places))
        self._origin = OriginBox(units)
        self._has_origin = False
        self._axis_order = _combo(
            (("auto", self.tr("Found out")), ("xy", self.tr("East first")), ("yx", self.tr("North first")))
        )
        self._heights = _combo(
            (
                ("auto", self.tr("As the system says")),
                ("orthometric", self.tr("Above sea level")),
                ("ellipsoid", self.tr("Above the ellipsoid")),
            )
        )
        self._ground = NameBox()
        self._ground.setPlaceholderText(self.tr("found around the building"))
        self._ground.setValidator(_numbers(self._ground))
        self._margin = LengthBox(*MARGIN_M, 5.0, units)
        self._lay_out(is_mesh)
        self._connect()
        self.setValue(ImportOptions())

    def _lay_out(self, is_mesh: bool) -> None:
        self._form = Form(self)
        self._form.setContentsMargins(0, 0, 0, 0)
        if self._has_map:
            self._form.addRow(self.tr("Building"), self._building)
        if is_mesh:
            self._form.addRow(self.tr("Unit of lengths"), self._unit)
            self._form.addRow(self.tr("Axis that points up"), self._up)
        self._form.addRow(self.tr("Place on earth"), self._place)
        self._form.addRow(self._origin)
        self._form.addRow(self.tr("Code of the system"), self._crs)
        self._form.addRow(self.tr("Order of coordinates"), self._axis_order)
        self._form.addRow(self.tr("Heights are"), self._heights)
        self._form.addRow(self.tr("Height of the ground in the file"), self._ground)
        self._form.addRow(self.tr("Airspace around the building"), self._margin)
        self._form.addRow(self.tr("Name of the site"), self._name)

    def _connect(self) -> None:
        for box in (self._building, self._unit, self._up, self._place, self._axis_order, self._heights):
            box.activated.connect(self._edited)
        for box in (self._name, self._crs, self._ground, self._margin):
            box.valueChanged.connect(self._edited)
        self._origin.valueChanged.connect(self._origin_edited)

    def value(self) -> ImportOptions:
        """The options."""
        place = self._place.currentData()
        return replace(
            self._rest,
            name=self._name.value().strip() or None,
            origin=self._origin.value() if place == ZERO_POINT and self._has_origin else None,
            crs=(self._crs.value().strip() or None) if place == SYSTEM else None,
            axis_order=cast("AxisOrder", self._axis_order.currentData()),
            height_reference=cast("HeightReference", "auto" if place == ZERO_POINT else self._heights.currentData()),
            up=self._up.currentData() or None,
            unit=self._unit.currentData(),
            building=self._building.currentData() or None,
            ground_z=_number(self._ground.value()),
            airspace_margin_m=self._margin.value(),
        )

    def setValue(self, options: ImportOptions) -> None:  # noqa: N802
        """Show options."""
        self._rest = options
        self._name.setValue(options.name or "")
        self._crs.setValue(options.crs or "")
        self._ground.setValue("" if options.ground_z is None else repr(float(options.ground_z)))
        self._margin.setValue(options.airspace_margin_m)
        self._has_origin = options.origin is not None
        if options.origin is not None:
            self._origin.setValue(options.origin)
        place = ZERO_POINT if options.origin is not None else SYSTEM if options.crs is not None else FILE_SAYS
        for box, wanted in (
            (self._unit, options.unit),
            (self._up, options.up or ""),
            (self._building, options.building or ""),
            (self._axis_order, options.axis_order),
            (self._heights, options.height_reference),
        ):
            box.show_value(wanted)
        # A mesh says nothing itself.
        self._place.setCurrentIndex(max(0, self._place.findData(place)))
        self._show_place()

    def set_choices(self, choices: tuple[BuildingChoice, ...]) -> None:
        """List the buildings of the file, those with most windows first, then the highest."""
        chosen = self._building.currentData()
        while self._building.count() > 1:
            self._building.removeItem(1)
        for choice in sorted(choices, key=lambda found: (-found.n_windows, -found.size_m[2])):
            text = self.tr("{0}: windows {1}, {2}").format(
                choice.name or choice.id, choice.n_windows, size_text(list(choice.size_m), self._units)
            )
            self._building.addItem(text, choice.id)
        self._building.setCurrentIndex(max(0, self._building.findData(chosen)))

    def origin_box(self) -> OriginBox:
        """Editor of the zero point; there is none until the user has put one in."""
        return self._origin

    def _origin_edited(self, origin: object) -> None:
        self._has_origin = True
        self._edited(origin)

    def _edited(self, _value: object) -> None:
        self._show_place()
        self.valueChanged.emit(self.value())

    def _show_place(self) -> None:
        place = self._place.currentData()
        self._form.setRowVisible(self._origin, place == ZERO_POINT)
        self._form.setRowVisible(self._crs, place == SYSTEM)
        # City models come in coordinates of a map; other files have such only where the user names the system.
        self._form.setRowVisible(self._axis_order, place == SYSTEM or (place == FILE_SAYS and self._has_map))
        self._form.setRowVisible(self._heights, place != ZERO_POINT)


def _numbers(parent: QWidget) -> QDoubleValidator:
    """Lets numbers through, with a decimal point as in all texts of the window."""
    validator = QDoubleValidator(parent)
    validator.setLocale(QLocale.c())
    return validator


def _number(text: str) -> float | None:
    return float(text) if text.strip() else None


def _combo(entries: Iterable[tuple[str, str]]) -> QComboBox:
    """Box to choose from (value, text) pairs."""
    box = ChoiceBox()
    for value, text in entries:
        box.addItem(text, value)
    return box
