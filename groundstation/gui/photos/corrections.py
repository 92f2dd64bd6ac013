"""Corrections made by hand over a photo, given to the desk as steps that can be undone."""

from __future__ import annotations

from PySide6.QtCore import QObject

from groundstation.gui.photos.photo_pane import PhotoPane
from groundstation.gui.photos.photos_desk import PhotosDesk
from groundstation.services.photo_edits import add_line, move_line, remove_line, set_panel
from reconstruction.panels.record import Axis


class Corrections(QObject):
    """Turns what a pane's view says into edits of the grid that is in hand."""

    def __init__(self, desk: PhotosDesk, pane: PhotoPane, parent: QObject) -> None:
        super().__init__(parent)
        self._desk, self._pane = desk, pane
        view = pane.view
        view.lineMoved.connect(self._move_line)
        view.lineAdded.connect(self._add_line)
        view.lineRemoved.connect(self._remove_line)
        view.panelSwitched.connect(self._switch_panel)

    def _move_line(self, axis: Axis, index: int, position_px: float) -> None:
        place = self._pane.place()
        if place is not None:
            self._desk.edit(self.tr("Move line"), lambda draft: move_line(draft, place, axis, index, position_px))

    def _add_line(self, axis: Axis, position_px: float) -> None:
        place = self._pane.place()
        if place is not None:
            self._desk.edit(self.tr("Add line"), lambda draft: add_line(draft, place, axis, position_px))

    def _remove_line(self, axis: Axis, index: int) -> None:
        place = self._pane.place()
        if place is not None:
            self._desk.edit(self.tr("Remove line"), lambda draft: remove_line(draft, place, axis, index))

    def _switch_panel(self, row: int, column: int, is_panel: bool) -> None:
        place = self._pane.place()
        if place is not None:
            label = self.tr("Restore panel") if is_panel else self.tr("Remove panel")
            self._desk.edit(label, lambda draft: set_panel(draft, place, row, column, is_panel=is_panel))
