"""The part of the world that a map shows, and the widget that mouse, wheel, keys and fingers move it by."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent, QNativeGestureEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QPinchGesture, QWidget

from groundstation.services.map.web_mercator import MAX_ZOOM, TILE_POINTS, Tile, geodetic_from_world, metres_per_point

MIN_ZOOM = 0.0


@dataclass(frozen=True, slots=True)
class Viewport:
    """North is up. `centre` is in world coordinates (see `web_mercator`); x may lie beyond 0 to 1 near 180 E."""

    centre: tuple[float, float] = (0.5, 0.5)
    zoom: float = 1.0
    width_px: int = 1
    height_px: int = 1

    @property
    def scale(self) -> float:
        """Pixels that the width of the world would take."""
        return TILE_POINTS * math.exp2(self.zoom)

    @property
    def metres_per_px(self) -> float:
        """Metres from west to east that a pixel at the centre spans."""
        return metres_per_point(geodetic_from_world(*self.centre)[0], self.zoom)

    def screen(self, world: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels, shape (n, 2), of world coordinates, shape (n, 2)."""
        # The difference comes first: at zoom 24 a pixel is 2e-10 of the world.
        return (world - self.centre) * self.scale + (self.width_px / 2.0, self.height_px / 2.0)

    def world(self, x_px: float, y_px: float) -> tuple[float, float]:
        """World coordinates of a pixel."""
        x = self.centre[0] + (x_px - self.width_px / 2.0) / self.scale
        return x, self.centre[1] + (y_px - self.height_px / 2.0) / self.scale

    def resized(self, width_px: int, height_px: int) -> Viewport:
        """The same centre in another size."""
        return replace(self, width_px=max(1, width_px), height_px=max(1, height_px))

    def panned(self, dx_px: float, dy_px: float) -> Viewport:
        """Everything moved on the screen by so much; the centre stays in the world from north to south."""
        x, y = self.centre[0] - dx_px / self.scale, self.centre[1] - dy_px / self.scale
        return replace(self, centre=(x, min(max(y, 0.0), 1.0)))

    def zoomed(self, levels: float, x_px: float, y_px: float) -> Viewport:
        """Nearer by so many levels; what is at the pixel stays there."""
        zoom = min(max(self.zoom + levels, MIN_ZOOM), float(MAX_ZOOM))
        held = self.world(x_px, y_px)
        nearer = replace(self, zoom=zoom)
        moved = nearer.world(x_px, y_px)
        return replace(
            nearer,
            centre=(self.centre[0] + held[0] - moved[0], min(max(self.centre[1] + held[1] - moved[1], 0.0), 1.0)),
        )

    def fitted(self, world: NDArray[np.float64], margin_px: float = 40.0, max_zoom: float = 21.0) -> Viewport:
        """All points, shape (n, 2), n >= 1, within the margins; a single point at `max_zoom`."""
        low, high = world.min(axis=0), world.max(axis=0)
        room = np.maximum([self.width_px - 2.0 * margin_px, self.height_px - 2.0 * margin_px], 20.0)
        widest = float(((high - low) / room).max())
        zoom = max_zoom if widest <= 0.0 else min(max_zoom, -math.log2(widest * TILE_POINTS))
        centre = (low + high) / 2.0
        return replace(self, centre=(float(centre[0]), float(centre[1])), zoom=max(MIN_ZOOM, zoom))

    def tiles(self, level: int) -> list[tuple[Tile, float, float]]:
        """Tiles of a level in sight, with the pixels of their upper left corners, the nearest to the centre first."""
        n = 2**level
        size_px = self.scale / n
        left, top = self.world(0.0, 0.0)
        right, bottom = self.world(self.width_px, self.height_px)
        found = []
        for row in range(max(0, math.floor(top * n)), min(n - 1, math.floor(bottom * n)) + 1):
            for column in range(math.floor(left * n), math.floor(right * n) + 1):
                corner = self.screen(np.array([[column / n, row / n]]))[0]
                found.append((Tile(level, column % n, row), float(corner[0]), float(corner[1])))
        middle = self.width_px / 2.0 - size_px / 2.0, self.height_px / 2.0 - size_px / 2.0
        return sorted(found, key=lambda tile: math.dist(tile[1:], middle))


# A widget that shows a part of the world, moved by mouse, wheel, keys, touch and touch pad; it paints nothing.

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

    def is_picking(self) -> bool:
        """Whether a place is waited for: for widgets that ask for one."""
        return False

    def cancel_pick(self) -> None:
        """Wait for a place no longer."""

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
        """Arrows pan, plus and minus zoom, F shows everything, Escape ends picking."""
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
        elif key == Qt.Key.Key_Escape and self.is_picking():
            self.cancel_pick()
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
