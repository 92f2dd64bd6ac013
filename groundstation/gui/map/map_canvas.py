"""A widget that shows a part of the world, moved by mouse, wheel, keys, touch and touch pad; it paints nothing."""

from __future__ import annotations

import math

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QNativeGestureEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QPinchGesture, QWidget

from groundstation.gui.map.viewport import Viewport

CLICK_PX = 6
"""Mouse travel up to which pressing and letting go is a click."""

WHEEL_LEVELS = 0.5 / 120.0
"""Levels per eighth of a degree of the wheel: a notch is half a level."""

KEY_PX = 80.0
"""How far an arrow key moves the map."""


class MapCanvas(QWidget):
    """Holds a viewport.

    Signals
    -------
    clicked(QPointF)
        Pressed and let go at one place.
    pointed(QPointF or None)
        The pointer moved with no button down, or left.
    """

    clicked = Signal(object)
    pointed = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._viewport = Viewport()
        self._press: QPointF | None = None
        self._last = QPointF()
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.grabGesture(Qt.GestureType.PinchGesture)

    def viewport(self) -> Viewport:
        """What is in sight."""
        return self._viewport

    def set_viewport(self, viewport: Viewport) -> None:
        """Show another part of the world; the size stays the widget's."""
        self._viewport = viewport.resized(self.width(), self.height())
        self.update()

    def look_at_all(self) -> None:
        """Bring everything into view: for widgets that have something to show."""

    def zoom_by(self, levels: float) -> None:
        """Zoom around the middle."""
        self.set_viewport(self._viewport.zoomed(levels, self.width() / 2.0, self.height() / 2.0))

    def pinch(self, factor: float, at: QPointF) -> None:
        """Zoom by a factor at a point of the widget."""
        if factor > 0.0:
            self._press = None
            self.set_viewport(self._viewport.zoomed(math.log2(factor), at.x(), at.y()))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Keep the centre."""
        super().resizeEvent(event)
        self._viewport = self._viewport.resized(self.width(), self.height())

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Zoom at the pointer."""
        at = event.position()
        self.set_viewport(self._viewport.zoomed(event.angleDelta().y() * WHEEL_LEVELS, at.x(), at.y()))
        event.accept()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Begin to pan, or to click."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._press = self._last = event.position()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Pan with the button down, else tell where the pointer is."""
        at = event.position()
        if self._press is None:
            self.pointed.emit(at)
            return
        if self._travel(at) > CLICK_PX:
            self.setCursor(Qt.CursorShape.ClosedHandCursor)
        self.set_viewport(self._viewport.panned(at.x() - self._last.x(), at.y() - self._last.y()))
        self._last = at

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """End panning, or click."""
        if event.button() != Qt.MouseButton.LeftButton or self._press is None:
            return
        is_click = self._travel(event.position()) <= CLICK_PX
        self._press = None
        self.unsetCursor()
        if is_click:
            self.clicked.emit(event.position())

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802
        """Nothing is pointed at."""
        super().leaveEvent(event)
        self.pointed.emit(None)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Arrows pan, plus and minus zoom, F shows everything."""
        moves = {
            Qt.Key.Key_Left: (KEY_PX, 0.0),
            Qt.Key.Key_Right: (-KEY_PX, 0.0),
            Qt.Key.Key_Up: (0.0, KEY_PX),
            Qt.Key.Key_Down: (0.0, -KEY_PX),
        }
        levels = {Qt.Key.Key_Plus: 1.0, Qt.Key.Key_Equal: 1.0, Qt.Key.Key_Minus: -1.0}
        key = Qt.Key(event.key())
        if key in moves:
            self.set_viewport(self._viewport.panned(*moves[key]))
        elif key in levels:
            self.zoom_by(levels[key])
        elif key == Qt.Key.Key_F:
            self.look_at_all()
        else:
            super().keyPressEvent(event)

    def event(self, event: QEvent) -> bool:
        """Pinch on touch screens and touch pads."""
        if event.type() == QEvent.Type.Gesture:
            gesture = event.gesture(Qt.GestureType.PinchGesture)  # type: ignore[attr-defined]
            if isinstance(gesture, QPinchGesture):
                self.pinch(gesture.scaleFactor(), self.mapFromGlobal(gesture.centerPoint()))
                return True
        if isinstance(event, QNativeGestureEvent) and event.gestureType() == Qt.NativeGestureType.ZoomNativeGesture:
            self.pinch(1.0 + event.value(), event.position())
            return True
        return super().event(event)

    def _travel(self, at: QPointF) -> float:
        step = at - (self._press or at)
        return math.hypot(step.x(), step.y())
