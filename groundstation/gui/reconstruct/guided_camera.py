"""The camera of a view, led by the view's mouse and keys."""

from __future__ import annotations

from PySide6.QtCore import QObject, Signal

from groundstation.gui.reconstruct.model_view import ModelView
from groundstation.services.reconstruct.guided_camera import NEAREST_M, moved, orbited, turned
from reconstruction.base.cameras import PosedPhoto

USUAL_DISTANCE_M = 15.0
"""To what is looked at, before a picture has told it."""

MOST_FORWARD = 0.9
"""Of the distance, that one step may go."""


class LedCamera(QObject):
    """Keeps a camera and how far away it is from what is in its middle.

    Signals
    -------
    led()
        It was turned or moved.
    """

    led = Signal()

    def __init__(self, view: ModelView, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.camera: PosedPhoto | None = None
        self.distance_m = USUAL_DISTANCE_M
        view.orbited.connect(self._orbit)
        view.turned.connect(self._turn)
        view.moved.connect(self._move)
        view.flown.connect(self._fly)

    def _orbit(self, right_rad: float, up_rad: float) -> None:
        if self.camera is not None:
            self._lead(orbited(self.camera, self.distance_m, right_rad, up_rad))

    def _turn(self, right_rad: float, up_rad: float) -> None:
        if self.camera is not None:
            self._lead(turned(self.camera, right_rad, up_rad))

    def _move(self, right: float, up: float, forward: float) -> None:
        if self.camera is not None:
            far_m = self.distance_m
            self.distance_m = max(NEAREST_M, far_m * (1.0 - min(forward, MOST_FORWARD)))
            self._lead(moved(self.camera, far_m * right, far_m * up, far_m * forward))

    def _fly(self, right: float, up: float, forward: float) -> None:
        if self.camera is not None:
            far_m = self.distance_m
            self._lead(moved(self.camera, far_m * right, far_m * up, far_m * forward))

    def _lead(self, camera: PosedPhoto) -> None:
        self.camera = camera
        self.led.emit()
