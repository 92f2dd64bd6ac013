"""Moves the 3-D view: turning, shifting and zooming by mouse, fingers and keys, and coming to rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QWidget

from groundstation.gui.view3d.orbit import Orbit, shifted_by_drag, turned_by_drag
from groundstation.gui.view3d.pinhole import Pinhole

Array = NDArray[np.float64]

REST_MS = 200
"""The view is at rest when it has not been moved for this long."""

KEY_TURN_DEG = 7.5
KEY_ZOOM = 1.2
TURNS = {
    Qt.Key.Key_Left: (-KEY_TURN_DEG, 0.0),
    Qt.Key.Key_Right: (KEY_TURN_DEG, 0.0),
    Qt.Key.Key_Up: (0.0, KEY_TURN_DEG),
    Qt.Key.Key_Down: (0.0, -KEY_TURN_DEG),
}
ZOOMS = {Qt.Key.Key_Plus: KEY_ZOOM, Qt.Key.Key_Equal: KEY_ZOOM, Qt.Key.Key_Minus: 1.0 / KEY_ZOOM}


class Navigator(QObject):
    """Keeps the orbit of the view on a canvas.

    Signals
    -------
    changed(Orbit)
        However it came about.
    moved(Orbit)
        By the user, or because something is looked at; not by `follow`.
    rested()
        The view has not changed for `REST_MS`.
    """

    changed = Signal(object)
    moved = Signal(object)
    rested = Signal()

    def __init__(self, canvas: QWidget) -> None:
        super().__init__(canvas)
        self._canvas = canvas
        self._orbit = Orbit()
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.timeout.connect(self.rested)

    @property
    def orbit(self) -> Orbit:
        """Where the view is looked at from."""
        return self._orbit

    @property
    def aspect(self) -> float:
        """Width / height of the view."""
        return self._canvas.width() / max(1, self._canvas.height())

    def pinhole(self) -> Pinhole:
        """Projection of the view onto its widget."""
        return self._orbit.pinhole(max(1, self._canvas.width()), max(1, self._canvas.height()))

    def follow(self, orbit: Orbit) -> None:
        """Look from elsewhere without saying so to whoever follows this view."""
        self._orbit = orbit
        self.changed.emit(orbit)
        self.wait_for_rest()

    def go(self, orbit: Orbit) -> None:
        """Look from elsewhere."""
        self.follow(orbit)
        self.moved.emit(orbit)

    def wait_for_rest(self) -> None:
        """Tell when nothing has moved for a while."""
        self._rest.start(REST_MS)

    def stop(self) -> None:
        """Tell nothing more."""
        self._rest.stop()

    def turn(self, right_deg: float, up_deg: float) -> None:
        """The user turns the view."""
        self.go(self._orbit.turned(right_deg, up_deg))

    def drag_turn(self, step: QPointF) -> None:
        """The user turns the view by so many pixels."""
        self.go(turned_by_drag(self._orbit, step.x(), step.y()))

    def drag_shift(self, step: QPointF) -> None:
        """The user shifts the view by so many pixels."""
        self.go(shifted_by_drag(self._orbit, self.pinhole(), step.x(), step.y()))

    def zoom(self, factor: float, anchor_enu_m: Array | None) -> None:
        """The user zooms; a point given as anchor keeps its pixel."""
        self.go(self._orbit.zoomed(factor, anchor_enu_m))

    def key(self, event: QKeyEvent) -> bool:
        """A key; True where it moved the view."""
        key = Qt.Key(event.key())
        if key in TURNS:
            self.turn(*TURNS[key])
        elif key in ZOOMS:
            self.zoom(ZOOMS[key], None)
        else:
            return False
        return True
