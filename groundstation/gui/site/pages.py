"""Property pages of all that stands on a site: the site itself, airspace, home, facades, panels, obstacles, zones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from PySide6.QtCore import QCoreApplication, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.site.site_tree import size_text
from groundstation.gui.widgets.inputs import Form, LengthBox, NumberBox
from groundstation.gui.widgets.value_boxes import (
    DECIMALS,
    ErrorLine,
    ExtentBox,
    FormColumn,
    NameBox,
    PointBox,
    PolygonBox,
    coordinate_box,
    muted,
)
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import (
    HeightReference,
    flip_facade,
    height_above_sea_m,
    move_home,
    move_rally_point,
    origin_at,
    remove_item,
    rename_item,
    rename_site,
    set_airspace,
    set_box,
    set_origin,
    set_zone,
)
from groundstation.services.site.sources import site_summary
from groundstation.services.units import UnitSystem, area_unit, length_unit, sampling_unit
from planning.base.errors import InputError
from planning.coverage.sections import panel_frames
from planning.geo.frames import Origin, Vec3
from planning.site.importing.polygons import quad_areas
from planning.site.records import Facade, SiteModel
from reconstruction.panels.solving.accuracy import FoundFacades

# Editor of the site's place on earth, its height told in both references.

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
        layout.addRow(muted(self.tr("Height of the site origin:")))
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
        self.add(self._origin, title=self.tr("Site origin"))
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
            muted(self.tr("Heights are above the site origin. Only the climb above home may be below the airspace.")),
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


# Property pages of what a site may have any number of: facades, panels, obstacles, no-fly zones, rally points.


class ItemPage(Page):
    """Name, and a button to remove the thing; kinds add their own boxes between the two."""

    def __init__(self, title: str, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._item: Item | None = None
        self._name = NameBox()
        self.add(self._name, title=title)
        self._name.valueChanged.connect(self._rename)

    def add_end(self) -> None:
        """The line for errors, and the button that removes the thing."""
        remove = QPushButton(self.tr("Delete"))
        remove.clicked.connect(self._remove)
        self.add(self._error, remove)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show what all kinds have."""
        self._item = item
        self._name.setValue(item.id)

    def name_box(self) -> NameBox:
        """Editor of the name."""
        return self._name

    def _rename(self, name: str) -> None:
        if self._item is not None:
            item, renamed = self._item, replace(self._item, id=name.strip())
            label = self.tr("Rename {0}").format(item.id)
            self.edited.emit(label, lambda model: rename_item(model, item, name), renamed)

    def _remove(self) -> None:
        if self._item is not None:
            item = self._item
            self.edited.emit(self.tr("Delete {0}").format(item.id), lambda model: remove_item(model, item), None)


class FacadePage(ItemPage):
    """A facade: its glass, and the side it looks to."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(self.tr("Facade"), units, parent)
        self._facts = QLabel()
        self._facts.setWordWrap(True)
        flip = QPushButton(self.tr("Turn to the other side"))
        flip.clicked.connect(self._flip)
        self.add(self._facts, flip)
        self.add_end()

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a facade."""
        super().show_item(model, item)
        facade = next(found for found in model.site.facades if found.id == item.id)
        if not facade.panels:
            self._facts.setText(self.tr("No panels"))
            return
        corners = _corners(facade)
        self._facts.setText(
            self.tr("Panels: {0}, {1} of glass\nFaces: {2}").format(
                len(facade.panels),
                area_unit(self._units).text(float(quad_areas(corners).sum())),
                _direction(corners, self.tr("up"), self.tr("down")),
            )
        )

    def _flip(self) -> None:
        if self._item is not None:
            name = self._item.id
            self.edited.emit(
                self.tr("Turn facade {0}").format(name), lambda model: flip_facade(model, name), self._item
            )


class PanelPage(ItemPage):
    """One panel."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(self.tr("Panel"), units, parent)
        self._found: FoundFacades | None = None
        self._facts = QLabel()
        self._facts.setWordWrap(True)
        self.add(self._facts)
        self.add_end()

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a panel."""
        super().show_item(model, item)
        facade, panel = next((f, p) for f in model.site.facades for p in f.panels if p.id == item.id)
        corners = np.array([panel.corners_enu_m])
        unit = length_unit(self._units)
        text = self.tr("On facade {0}\nSize: {1} × {2}\nFaces: {3}").format(
            facade.id,
            unit.text(float(np.linalg.norm(corners[0, 1] - corners[0, 0]))),
            unit.text(float(np.linalg.norm(corners[0, 3] - corners[0, 0]))),
            _direction(corners, self.tr("up"), self.tr("down")),
        )
        if panel.source_id is not None:
            text += "\n" + self.tr("In the imported file: {0}").format(panel.source_id)
        accuracy = None if self._found is None else self._found.of(panel)
        if accuracy is not None:
            fine = sampling_unit(self._units)
            text += "\n" + self.tr("Found in photos: corners \u00b1 {0:.3g} {1}, confidence {2:.0f} %").format(
                fine.shown(accuracy.corner_sigma_m), fine.symbol, 100.0 * accuracy.confidence
            )
        self._facts.setText(text)

    def set_found(self, found: FoundFacades | None) -> None:
        """How good the panels are that were found in photos; `show_item` follows."""
        self._found = found

    def text(self) -> str:
        """What is said of the panel."""
        return self._facts.text()


class ObstaclePage(ItemPage):
    """An obstacle: a box that can be changed, or a mesh."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(self.tr("Obstacle"), units, parent)
        self._extent, self._facts = ExtentBox(units), muted("")
        self.add(self._extent, self._facts)
        self.add_end()
        self._extent.valueChanged.connect(self._set)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show an obstacle."""
        super().show_item(model, item)
        index = next(i for i, found in enumerate(model.site.obstacles) if found.id == item.id)
        obstacle, mesh = model.site.obstacles[index], model.obstacles[index]
        self._extent.setVisible(obstacle.box_enu_m is not None)
        self._facts.setVisible(obstacle.box_enu_m is None)
        if obstacle.box_enu_m is not None:
            self._extent.setValue(obstacle.box_enu_m)
        else:
            size = np.ptp(mesh.vertices_enu_m, axis=0).tolist()
            self._facts.setText(
                self.tr("Mesh {0}\nSize: {1}; triangles: {2}").format(
                    obstacle.mesh, size_text(size, self._units), len(mesh.triangles)
                )
            )

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        super().set_units(units)
        self._extent.set_units(units)

    def extent_box(self) -> ExtentBox:
        """Editor of the box."""
        return self._extent

    def _set(self, extent: object) -> None:
        if self._item is not None:
            name, (low, high) = self._item.id, self._extent.value()
            self.edited.emit(
                self.tr("Change {0}").format(name), lambda model: set_box(model, name, low, high), self._item
            )


class NoFlyPage(ItemPage):
    """A no-fly zone: its corners on the ground, and from which height to which."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(self.tr("No-fly zone"), units, parent)
        self._polygon = PolygonBox(units)
        self._floor, self._ceiling = coordinate_box(units), coordinate_box(units)
        self.add(self._floor, title=self.tr("From height"))
        self.add(self._ceiling, title=self.tr("To height"))
        self.add(self._polygon, title=self.tr("Corners"))
        self.add_end()
        for box in (self._floor, self._ceiling, self._polygon):
            box.valueChanged.connect(self._set)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a zone."""
        super().show_item(model, item)
        zone = next(found for found in model.site.airspace.no_fly if found.id == item.id)
        self._floor.setValue(zone.floor_m)
        self._ceiling.setValue(zone.ceiling_m)
        self._polygon.setValue(zone.polygon_enu_m)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        super().set_units(units)
        for box in (self._floor, self._ceiling, self._polygon):
            box.set_units(units)

    def _set(self, _value: object) -> None:
        if self._item is not None:
            edit = partial(
                set_zone,
                zone_id=self._item.id,
                polygon_enu_m=self._polygon.value(),
                floor_m=self._floor.value(),
                ceiling_m=self._ceiling.value(),
            )
            self.edited.emit(self.tr("Change {0}").format(self._item.id), edit, self._item)


class RallyPage(ItemPage):
    """A rally point: where the aircraft may land instead of home."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(self.tr("Rally point"), units, parent)
        self._point = PointBox(units)
        ground = QPushButton(self.tr("Put it on the ground"))
        self.add(self._point, title=self.tr("Place"))
        self.add(ground, muted(self.tr("An aircraft that returns lands at the nearest of home and the rally points.")))
        self.add_end()
        self._point.valueChanged.connect(self._move)
        ground.clicked.connect(self._put_down)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a rally point."""
        super().show_item(model, item)
        found = next(point for point in model.site.rally_points if point.id == item.id)
        self._point.setValue(found.position_enu_m)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        super().set_units(units)
        self._point.set_units(units)

    def point_box(self) -> PointBox:
        """Editor of the place."""
        return self._point

    def _move(self, place: Vec3) -> None:
        self._set(place, on_ground=False)

    def _put_down(self) -> None:
        self._set(self._point.value(), on_ground=True)

    def _set(self, place: Vec3, *, on_ground: bool) -> None:
        if self._item is not None:
            edit = partial(move_rally_point, point_id=self._item.id, position_enu_m=place, on_ground=on_ground)
            self.edited.emit(self.tr("Change {0}").format(self._item.id), edit, self._item)


def _corners(facade: Facade) -> np.ndarray:
    return np.array([panel.corners_enu_m for panel in facade.panels])


def _direction(corners: np.ndarray, up: str, down: str) -> str:
    """Mean direction that panels look in, as a compass bearing, or up or down."""
    east, north, z = panel_frames(corners).normals.mean(axis=0)
    if abs(z) > np.hypot(east, north):
        return up if z > 0.0 else down
    return f"{np.degrees(np.arctan2(east, north)) % 360.0:.0f}°"
