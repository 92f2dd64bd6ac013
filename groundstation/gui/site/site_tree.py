"""The tree of things on a site: choose one, remove it with Delete, or ask for more with the right button."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from PySide6.QtCore import (
    QAbstractItemModel,
    QItemSelectionModel,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    QPoint,
    QSignalBlocker,
    Qt,
    Signal,
)
from PySide6.QtGui import QAction, QKeyEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QMenu, QTreeView, QWidget

from groundstation.services.project.document import Item, ItemKind
from groundstation.services.site.edits import REMOVABLE
from groundstation.services.units import Unit, UnitSystem, length_unit
from planning.site.records import Site, SiteModel
from planning.site.zones.keep_out import near_zones

# The things on a site as a Qt item model: name and size of each, grouped by kind.

Index = QModelIndex | QPersistentModelIndex

N_COLUMNS = 2
ROOT = 0
LEAST_COLUMN_PX = 24


@dataclass(slots=True)
class _Node:
    """One row; `parent` and `children` are numbers of nodes."""

    item: Item | None
    texts: tuple[str, str]
    parent: int = ROOT
    row: int = 0
    children: list[int] = field(default_factory=list)


class SiteTreeModel(QAbstractItemModel):
    """Site, facades with their panels, obstacles, no-fly zones, rally points, geo-zones, airspace and home.

    The first row is the site itself; it stands for `ItemKind.BUILDING`. Rows of groups stand for nothing.
    """

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._nodes: list[_Node] = [_Node(None, ("", ""))]
        self._by_item: dict[Item, int] = {}

    def set_site(self, model: SiteModel | None, units: UnitSystem) -> None:
        """Show another site, or the same one after an edit; rows stay where only their texts changed."""
        nodes: list[_Node] = [_Node(None, ("", ""))]
        if model is not None:
            self._fill(nodes, model, units)
        if [(node.item, node.parent) for node in nodes] == [(node.item, node.parent) for node in self._nodes]:
            changed = [n for n, (old, new) in enumerate(zip(self._nodes, nodes, strict=True)) if old.texts != new.texts]
            self._nodes = nodes
            for number in changed:
                row = nodes[number].row
                self.dataChanged.emit(self.createIndex(row, 0, number), self.createIndex(row, N_COLUMNS - 1, number))
            return
        self.beginResetModel()
        self._nodes = nodes
        self._by_item = {node.item: number for number, node in enumerate(nodes) if node.item is not None}
        self.endResetModel()

    def item(self, index: Index) -> Item | None:
        """What a row stands for."""
        return self._nodes[index.internalId()].item if index.isValid() else None

    def index_of(self, item: Item | None) -> QModelIndex:
        """Row that stands for an item; not valid where there is none."""
        number = None if item is None else self._by_item.get(item)
        return QModelIndex() if number is None else self.createIndex(self._nodes[number].row, 0, number)

    def groups(self) -> Iterator[QModelIndex]:
        """Rows that stand for nothing but have rows of their own."""
        for number in self._nodes[ROOT].children:
            if self._nodes[number].item is None:
                yield self.createIndex(self._nodes[number].row, 0, number)

    def index(self, row: int, column: int, parent: Index = QModelIndex()) -> QModelIndex:  # noqa: B008
        """Index of a child."""
        if not self.hasIndex(row, column, parent):
            return QModelIndex()
        return self.createIndex(row, column, self._nodes[self._number(parent)].children[row])

    def parent(self, index: Index = QModelIndex()) -> QModelIndex:  # type: ignore[override]  # noqa: B008
        """Index of the row that an index is below."""
        if not index.isValid():
            return QModelIndex()
        number = self._nodes[index.internalId()].parent
        return QModelIndex() if number == ROOT else self.createIndex(self._nodes[number].row, 0, number)

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008
        """Rows below an index."""
        return 0 if parent.isValid() and parent.column() > 0 else len(self._nodes[self._number(parent)].children)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008
        """Name, and what there is to say about it."""
        return N_COLUMNS

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> str | None:
        """Text of a cell."""
        if not index.isValid() or role not in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            return None
        return self._nodes[index.internalId()].texts[index.column()]

    def headerData(  # noqa: N802
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> str | None:
        """Titles of the columns."""
        if orientation != Qt.Orientation.Horizontal or role != Qt.ItemDataRole.DisplayRole:
            return None
        return (self.tr("On the site"), self.tr("Size"))[section]

    def _number(self, parent: Index) -> int:
        return parent.internalId() if parent.isValid() else ROOT

    def _fill(self, nodes: list[_Node], model: SiteModel, units: UnitSystem) -> None:
        def add(item: Item | None, name: str, info: str, parent: int = ROOT) -> int:
            nodes.append(_Node(item, (name, info), parent, len(nodes[parent].children)))
            nodes[parent].children.append(len(nodes) - 1)
            return len(nodes) - 1

        site = model.site
        add(Item(ItemKind.BUILDING), site.name, self.tr("panels: {0}").format(site.n_panels))
        group = add(None, self.tr("Facades"), str(len(site.facades)))
        for facade in site.facades:
            info = self.tr("panels: {0}").format(len(facade.panels))
            row = add(Item(ItemKind.FACADE, facade.id), facade.id, info, group)
            for panel in facade.panels:
                add(Item(ItemKind.PANEL, panel.id), panel.id, "", row)
        group = add(None, self.tr("Obstacles"), str(len(site.obstacles)))
        for obstacle, mesh in zip(site.obstacles, model.obstacles, strict=True):
            size = np.ptp(mesh.vertices_enu_m, axis=0) if len(mesh.vertices_enu_m) else np.zeros(3)
            add(Item(ItemKind.OBSTACLE, obstacle.id), obstacle.id, size_text(size.tolist(), units), group)
        group = add(None, self.tr("No-fly zones"), str(len(site.airspace.no_fly)))
        for zone in site.airspace.no_fly:
            size = [*np.ptp(np.array(zone.polygon_enu_m), axis=0).tolist(), zone.ceiling_m - zone.floor_m]
            add(Item(ItemKind.NO_FLY, zone.id), zone.id, size_text(size, units), group)
        height = length_unit(units)
        group = add(None, self.tr("Rally points"), str(len(site.rally_points)))
        for point in site.rally_points:
            add(Item(ItemKind.RALLY, point.id), point.id, height.text(point.position_enu_m[2]), group)
        self._fill_zones(add, model, height)
        add(Item(ItemKind.AIRSPACE), self.tr("Airspace"), size_text(_airspace_size(site), units))
        add(Item(ItemKind.HOME), self.tr("Home"), height.text(site.home_enu_m[2]))

    def _fill_zones(self, add: Callable[[Item | None, str, str, int], int], model: SiteModel, height: Unit) -> None:
        """Files of geo-zones, and below each the zones near the site, the nearest first."""
        site = model.site
        group = add(None, self.tr("Geo-zones"), str(len(site.zones)), ROOT)
        near = sorted(near_zones(model), key=lambda each: each.local.distance_m)
        for source in site.zones:
            own = [each for each in near if each.source == source]
            row = add(Item(ItemKind.ZONE_FILE, source.file), source.file, self.tr("near: {0}").format(len(own)), group)
            for each in own:
                away_m = each.local.distance_m
                info = height.text(away_m) if math.isfinite(away_m) else "?"
                add(Item(ItemKind.ZONE, each.key), each.local.zone.name, info, row)


def _airspace_size(site: Site) -> list[float]:
    low, high = site.airspace.min_enu_m, site.airspace.max_enu_m
    return [b - a for a, b in zip(low, high, strict=True)]


def size_text(size_m: list[float], units: UnitSystem) -> str:
    """Lengths to the east, to the north and upwards as one text: "36 × 20 × 42 m"."""
    unit = length_unit(units)
    return f"{' × '.join(f'{unit.shown(length):.0f}' for length in size_m)} {unit.symbol}"


class SiteTree(QTreeView):
    """Edits one value: the item that is selected, or None.

    Signals
    -------
    valueChanged(Item or None)
        The user selected another item.
    removeRequested(Item), renameRequested(Item), lookRequested(Item), flipRequested(Item)
        The user wants this done.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    removeRequested = Signal(object)  # noqa: N815
    renameRequested = Signal(object)  # noqa: N815
    lookRequested = Signal(object)  # noqa: N815
    flipRequested = Signal(object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._model = SiteTreeModel(self)
        self.setModel(self._model)
        self.setUniformRowHeights(True)
        self.setAlternatingRowColors(False)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.customContextMenuRequested.connect(self._show_menu)
        self.header().setStretchLastSection(True)
        # What has no room ends in dots, and stands in its tool tip.
        self.header().setMinimumSectionSize(LEAST_COLUMN_PX)
        self.header().setSectionResizeMode(0, QHeaderView.ResizeMode.ResizeToContents)
        self.selectionModel().currentChanged.connect(self._choose)
        self.doubleClicked.connect(self._look)

    def set_site(self, model: SiteModel | None, units: UnitSystem) -> None:
        """Show a site; what was selected and unfolded stays so where it still is."""
        selected = self.value()
        unfolded = [item for item in self._unfolded_items() if item is not None]
        with QSignalBlocker(self.selectionModel()):
            self._model.set_site(model, units)
            for index in self._model.groups():
                self.expand(index)
            for item in unfolded:
                self.expand(self._model.index_of(item))
        self.setValue(selected)

    def value(self) -> Item | None:
        """The item that is selected."""
        return self._model.item(self.currentIndex())

    def setValue(self, item: Item | None) -> None:  # noqa: N802
        """Select an item and bring its row into view."""
        index = self._model.index_of(item)
        with QSignalBlocker(self.selectionModel()):
            flags = QItemSelectionModel.SelectionFlag
            if index.isValid():
                self.selectionModel().setCurrentIndex(index, flags.ClearAndSelect | flags.Rows)
                self.scrollTo(index)
            else:
                self.selectionModel().clear()
        self.viewport().update()

    def menu(self, item: Item) -> QMenu:
        """What can be done with an item."""
        menu = QMenu(self)
        entries = [(self.tr("Show it"), self.lookRequested)]
        if item.kind in REMOVABLE:
            entries.append((self.tr("Rename"), self.renameRequested))
            if item.kind is ItemKind.FACADE:
                entries.append((self.tr("Turn to the other side"), self.flipRequested))
            entries.append((self.tr("Delete"), self.removeRequested))
        for text, signal in entries:
            action = QAction(text, menu)
            action.triggered.connect(lambda _checked=False, signal=signal: signal.emit(item))
            menu.addAction(action)
        return menu

    def _unfolded_items(self) -> Iterator[Item | None]:
        for group in self._model.groups():
            for row in range(self._model.rowCount(group)):
                index = self._model.index(row, 0, group)
                if self.isExpanded(index):
                    yield self._model.item(index)

    def _choose(self, current: QModelIndex, _previous: QModelIndex) -> None:
        self.valueChanged.emit(self._model.item(current))

    def _look(self, index: QModelIndex) -> None:
        item = self._model.item(index)
        if item is not None:
            self.lookRequested.emit(item)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Delete removes what is selected."""
        if event.key() == Qt.Key.Key_Delete:
            self.ask_remove()
        else:
            super().keyPressEvent(event)

    def ask_remove(self) -> None:
        """Ask for what is selected to be removed, where that can be."""
        item = self.value()
        if item is not None and item.kind in REMOVABLE:
            self.removeRequested.emit(item)

    def _show_menu(self, position: QPoint) -> None:
        item = self._model.item(self.indexAt(position))
        if item is not None:
            menu = self.menu(item)
            menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            menu.popup(self.viewport().mapToGlobal(position))
