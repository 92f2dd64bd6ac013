"""Property pages of what every site has: the site itself, its airspace and its home."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QCoreApplication, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from groundstation.gui.site.origin_box import OriginBox
from groundstation.gui.site.site_tree import size_text
from groundstation.gui.widgets.value_boxes import (
    ErrorLine,
    ExtentBox,
    FormColumn,
    NameBox,
    PointBox,
    coordinate_box,
    muted,
)
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import HeightReference, move_home, rename_site, set_airspace, set_origin
from groundstation.services.site.sources import site_summary
from groundstation.services.units import UnitSystem, area_unit
from planning.geo.frames import Origin, Vec3
from planning.site.records import SiteModel

Edit = Callable[[SiteModel], SiteModel]

SITE, HOME = Item(ItemKind.BUILDING), Item(ItemKind.HOME)


class Page(FormColumn):
    """Properties of one kind of thing.

    Signals
    -------
    edited(str, Edit, Item)
        The user wants this done, and the item selected afterwards; the text says what, for Undo.
    """

    edited = Signal(str, object, object)

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = units
        self._error = ErrorLine()

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show the properties as they are."""
        raise NotImplementedError

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units; `show_item` follows."""
        self._units = units

    def show_error(self, text: str) -> None:
        """Say why what stands in the boxes was not taken over."""
        self._error.show_error(text)


class SitePage(Page):
    """Name, size and place on earth of the site."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._name, self._summary, self._origin = NameBox(), QLabel(), OriginBox(units)
        self._summary.setWordWrap(True)
        self.add(self._name, title=self.tr("Name of the site"))
        self.add(self._summary)
        self.add(self._origin, title=self.tr("Place of the site's zero"))
        self.add(self._error)
        self._name.valueChanged.connect(self._rename)
        self._origin.valueChanged.connect(self._move)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show the site."""
        self._name.setValue(model.site.name)
        self._origin.setValue(model.site.origin)
        self._summary.setText(summary_text(model, self._units))

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        super().set_units(units)
        self._origin.set_units(units)

    def _rename(self, name: str) -> None:
        self.edited.emit(self.tr("Rename site"), lambda model: rename_site(model, name), SITE)

    def _move(self, origin: Origin) -> None:
        self.edited.emit(
            self.tr("Set origin"),
            lambda model: set_origin(
                model, origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m, HeightReference.ELLIPSOID
            ),
            SITE,
        )


def summary_text(model: SiteModel, units: UnitSystem) -> str:
    """A site in two lines."""
    summary = site_summary(model)
    return QCoreApplication.translate(
        "SiteSummary", "Panels: {0} on {1} facades, {2} of glass\nSize: {3}; triangles: {4}"
    ).format(
        summary.n_panels,
        len(summary.facades),
        area_unit(units).text(summary.area_m2),
        size_text(list(summary.size_m), units),
        summary.n_triangles,
    )


class AirspacePage(Page):
    """The box in which the aircraft must stay, and the level of the ground."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._extent, self._ground = ExtentBox(units), coordinate_box(units)
        self.add(self._extent, title=self.tr("Airspace"))
        self.add(self._ground, title=self.tr("Ground"))
        self.add(
            self._error,
            muted(self.tr("Heights are above the site's zero. Only the climb above home may be below the airspace.")),
        )
        self._extent.valueChanged.connect(self._set)
        self._ground.valueChanged.connect(self._set)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show the airspace."""
        airspace = model.site.airspace
        self._extent.setValue((airspace.min_enu_m, airspace.max_enu_m))
        self._ground.setValue(airspace.ground_z_m)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        super().set_units(units)
        self._extent.set_units(units)
        self._ground.set_units(units)

    def extent_box(self) -> ExtentBox:
        """Editor of the box."""
        return self._extent

    def _set(self, _value: object) -> None:
        (low, high), ground_z_m = self._extent.value(), self._ground.value()
        label = self.tr("Change airspace")
        self.edited.emit(label, lambda model: set_airspace(model, low, high, ground_z_m), Item(ItemKind.AIRSPACE))


class HomePage(Page):
    """Where the aircraft takes off and lands."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._point = PointBox(units)
        ground = QPushButton(self.tr("Put it on the ground"))
        self.add(self._point, title=self.tr("Home"))
        self.add(ground, self._error)
        self._point.valueChanged.connect(self._move)
        ground.clicked.connect(self._put_down)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show home."""
        self._point.setValue(model.site.home_enu_m)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        super().set_units(units)
        self._point.set_units(units)

    def point_box(self) -> PointBox:
        """Editor of the place."""
        return self._point

    def _move(self, point: Vec3) -> None:
        self.edited.emit(self.tr("Move home"), lambda model: move_home(model, point), HOME)

    def _put_down(self) -> None:
        self.edited.emit(
            self.tr("Put home on the ground"),
            lambda model: move_home(model, model.site.home_enu_m, on_ground=True),
            HOME,
        )
