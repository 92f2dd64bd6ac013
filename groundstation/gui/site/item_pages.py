"""Property pages of what a site may have any number of: facades, panels, obstacles, no-fly zones, rally points."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from PySide6.QtWidgets import QLabel, QPushButton, QWidget

from groundstation.gui.site.pages import Page
from groundstation.gui.site.site_tree import size_text
from groundstation.gui.widgets.value_boxes import ExtentBox, NameBox, PointBox, PolygonBox, coordinate_box, muted
from groundstation.services.project.document import Item
from groundstation.services.site.edits import flip_facade, move_rally_point, remove_item, rename_item, set_box, set_zone
from groundstation.services.units import UnitSystem, area_unit, length_unit, sampling_unit
from planning.coverage.sections import panel_frames
from planning.geo.frames import Vec3
from planning.site.importing.polygons import quad_areas
from planning.site.records import Facade, SiteModel
from reconstruction.panels.solving.accuracy import FoundFacades


class ItemPage(Page):
    """Name, and a button to remove the thing; kinds add their own boxes between the two with `add_between`."""

    def __init__(self, title: str, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._item: Item | None = None
        self._name = NameBox()
        self.add(self._name, title=title)
        self._name.valueChanged.connect(self._rename)

    def add_end(self) -> None:
        """The line for errors, and the button that removes the thing."""
        remove = QPushButton(self.tr("Remove"))
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
            self.edited.emit(self.tr("Remove {0}").format(item.id), lambda model: remove_item(model, item), None)


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

    def polygon_box(self) -> PolygonBox:
        """Editor of the corners."""
        return self._polygon

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
