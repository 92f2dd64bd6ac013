"""The tree of things on a site: choose one, remove it with Delete, or ask for more with the right button."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QItemSelectionModel, QModelIndex, QPoint, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QAction, QKeyEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QMenu, QTreeView, QWidget

from groundstation.gui.site.site_tree_model import SiteTreeModel
from groundstation.services.document import Item, ItemKind
from groundstation.services.item_edits import REMOVABLE
from groundstation.services.units import UnitSystem
from planning.site import SiteModel


class SiteTree(QTreeView):
    """Edits one value: the item that is selected, or None.

    Signals
    -------
    valueChanged(Item or None)
        The user selected another item.
    removeAsked(Item), renameAsked(Item), lookAsked(Item), flipAsked(Item)
        The user wants this done.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    removeAsked = Signal(object)  # noqa: N815
    renameAsked = Signal(object)  # noqa: N815
    lookAsked = Signal(object)  # noqa: N815
    flipAsked = Signal(object)  # noqa: N815

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
        entries = [(self.tr("Show it"), self.lookAsked)]
        if item.kind in REMOVABLE:
            entries.append((self.tr("Rename"), self.renameAsked))
            if item.kind is ItemKind.FACADE:
                entries.append((self.tr("Turn to the other side"), self.flipAsked))
            entries.append((self.tr("Remove"), self.removeAsked))
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
            self.lookAsked.emit(item)

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
            self.removeAsked.emit(item)

    def _show_menu(self, position: QPoint) -> None:
        item = self._model.item(self.indexAt(position))
        if item is not None:
            menu = self.menu(item)
            menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
            menu.popup(self.viewport().mapToGlobal(position))
