"""Editor of the site's place on earth, its height told in both references."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.inputs import Form, LengthBox, NumberBox
from groundstation.gui.widgets.value_boxes import DECIMALS, ErrorLine, muted
from groundstation.services.site.edits import HeightReference, height_above_sea_m, origin_at
from groundstation.services.units import UnitSystem
from planning.base.errors import InputError
from planning.geo.frames import Origin

DEGREE_DECIMALS = 7
"""1 cm on the ground."""


class OriginBox(QWidget):
    """Edits an origin. The two heights are one value: whichever is edited, the other follows.

    Signals
    -------
    valueChanged(Origin)
        Only with places that exist; what does not is told below the boxes.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = units
        self._value = Origin(0.0, 0.0, 0.0)
        self._lat = NumberBox(-90.0, 90.0, 0.0001, " °", DEGREE_DECIMALS)
        self._lon = NumberBox(-180.0, 180.0, 0.0001, " °", DEGREE_DECIMALS)
        self._ellipsoid = LengthBox(-1200.0, 10_100.0, 0.5, units, DECIMALS)
        self._sea = LengthBox(-1200.0, 10_100.0, 0.5, units, DECIMALS)
        self._error = ErrorLine()
        self._lat.setToolTip(self.tr("North positive, WGS 84"))
        self._lon.setToolTip(self.tr("East positive, WGS 84"))
        self._sea.setToolTip(
            self.tr("Mean sea level by the EGM96 geoid, as autopilots and DJI use it; good to about a metre")
        )
        layout = Form(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addRow(self.tr("Latitude"), self._lat)
        layout.addRow(self.tr("Longitude"), self._lon)
        layout.addRow(muted(self.tr("Height of the site's zero:")))
        layout.addRow(self.tr("Above ellipsoid"), self._ellipsoid)
        layout.addRow(self.tr("Above sea level"), self._sea)
        layout.addRow(self._error)
        for degrees in (self._lat, self._lon):
            degrees.valueChanged.connect(self._place_edited)
        self._ellipsoid.valueChanged.connect(self._place_edited)
        self._sea.valueChanged.connect(self._sea_edited)

    def value(self) -> Origin:
        """The origin."""
        return self._value

    def setValue(self, origin: Origin) -> None:  # noqa: N802
        """Show an origin."""
        self._value = origin
        self._error.show_error("")
        for box, degrees in ((self._lat, origin.lat_deg), (self._lon, origin.lon_deg)):
            box.blockSignals(True)
            box.setValue(degrees)
            box.blockSignals(False)
        self._ellipsoid.setValue(origin.ellipsoid_height_m)
        self._sea.setValue(height_above_sea_m(origin))

    def set_units(self, units: UnitSystem) -> None:
        """Show the same heights in other units."""
        self._units = units
        self._ellipsoid.set_units(units)
        self._sea.set_units(units)

    def boxes(self) -> tuple[NumberBox, NumberBox, LengthBox, LengthBox]:
        """Latitude, longitude, height above the ellipsoid and above the sea."""
        return self._lat, self._lon, self._ellipsoid, self._sea

    def _place_edited(self, _value: float) -> None:
        # The ellipsoidal height is what the site keeps: moved over the map, the height above the sea follows.
        self._take(self._ellipsoid.value(), HeightReference.ELLIPSOID)

    def _sea_edited(self, _value: float) -> None:
        self._take(self._sea.value(), HeightReference.SEA_LEVEL)

    def _take(self, height_m: float, reference: HeightReference) -> None:
        try:
            origin = origin_at(
                self._degrees(self._lat, "lat_deg"), self._degrees(self._lon, "lon_deg"), height_m, reference
            )
        except InputError as error:
            self._error.show_error(translated(str(error), self._units))
            return
        self.setValue(origin)
        self.valueChanged.emit(origin)

    def _degrees(self, box: NumberBox, field: str) -> float:
        """What stands in a box; the exact value where it is still the one that was set."""
        exact: float = getattr(self._value, field)
        return exact if round(exact, DEGREE_DECIMALS) == round(box.value(), DEGREE_DECIMALS) else box.value()
