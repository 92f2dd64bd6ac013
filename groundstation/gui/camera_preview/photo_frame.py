"""A picture in the aspect ratio of the photo, as large as there is room for."""

from __future__ import annotations

from PySide6.QtCore import QRect, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QWidget

from groundstation.gui.camera_preview.photo_overlay import PhotoOverlay
from groundstation.gui.view3d.canvas import Canvas


class PhotoFrame(QWidget):
    """Canvas and overlay in the middle, bars beside or above them.

    Signals
    -------
    fitted()
        The picture has another size.
    """

    fitted = Signal()

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setMinimumSize(160, 120)
        self.canvas = Canvas(self)
        self.overlay = PhotoOverlay(self)
        self._aspect = 4.0 / 3.0

    def set_aspect(self, aspect: float) -> None:
        """Width / height of the photo."""
        if aspect != self._aspect:
            self._aspect = aspect
            self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the aspect ratio."""
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        width = min(self.width(), int(self.height() * self._aspect))
        height = max(1, round(width / self._aspect))
        place = QRect((self.width() - width) // 2, (self.height() - height) // 2, max(1, width), height)
        self.canvas.setGeometry(place)
        self.overlay.setGeometry(place)
        self.overlay.raise_()
        self.fitted.emit()
