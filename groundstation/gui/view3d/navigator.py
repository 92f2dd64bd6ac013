"""Moves the 3-D view: turning, shifting and zooming by mouse, fingers and keys, and coming to rest."""

from __future__ import annotations

from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent, QMouseEvent, QTouchEvent, QWheelEvent
from PySide6.QtWidgets import QWidget

from groundstation.gui.view3d.orbit import Orbit, Pinhole, shifted_by_drag, turned_by_drag

# Mouse, wheel, keys and fingers on the canvas, told apart into clicks, drags, zooms and hovering.

CLICK_PX = 5.0
"""A press that moves less is a click; the hand shakes more than a pixel, a finger more than a mouse."""

HOVER_MS = 15
"""What is under the pointer is looked up once in this time, however many mouse events arrive."""

WHEEL_ZOOM = 1.15
"""Zoom for one notch of the wheel."""

KEY_REASONS = (Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason, Qt.FocusReason.ShortcutFocusReason)
"""Ways in which the keyboard brings the focus."""


class Drag(Enum):
    """What a drag is for."""

    TURN = auto()
    SHIFT = auto()


class State(Enum):
    """What the pointer is doing."""

    IDLE = auto()
    PRESSED = auto()
    DRAGGING = auto()
    TWO_FINGERS = auto()


class Gestures(QObject):
    """Filters the events of one widget.

    ===========  ======================  ===========
    state        event                   next state
    ===========  ======================  ===========
    IDLE         press                   PRESSED
    IDLE         move                    IDLE: hovered
    PRESSED      moved `CLICK_PX`        DRAGGING: drag_started, dragged
    PRESSED      release                 IDLE: clicked
    DRAGGING     move                    DRAGGING: dragged
    DRAGGING     release                 IDLE: drag_ended
    any          second finger           TWO_FINGERS: shifts and zooms
    TWO_FINGERS  finger lifted           IDLE
    any          double click            IDLE: double_clicked
    ===========  ======================  ===========

    Signals
    -------
    hovered(QPointF, KeyboardModifiers), left()
    clicked, double_clicked(QPointF, KeyboardModifiers)
    drag_started(QPointF, Drag, KeyboardModifiers)
        Where the button was pressed.
    dragged(QPointF, QPointF, KeyboardModifiers)
        Where the pointer is, and how far it came since the last time.
    drag_ended(QPointF, KeyboardModifiers)
    zoomed(float, QPointF)
        Factor, and the pixel to zoom at.
    shifted(QPointF)
        Two fingers moved together by this much.
    keyed(QKeyEvent)
        Whoever uses it accepts it.
    keysTaken(bool)
        Keys go to the widget because the user came to it by key, or they no longer do.
    """

    hovered = Signal(QPointF, object)
    left = Signal()
    clicked = Signal(QPointF, object)
    double_clicked = Signal(QPointF, object)
    drag_started = Signal(QPointF, object, object)
    dragged = Signal(QPointF, QPointF, object)
    drag_ended = Signal(QPointF, object)
    zoomed = Signal(float, QPointF)
    shifted = Signal(QPointF)
    keyed = Signal(QKeyEvent)
    keysTaken = Signal(bool)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, widget: QWidget) -> None:
        super().__init__(widget)
        self._state = State.IDLE
        self._button = Qt.MouseButton.NoButton
        self._start, self._last = QPointF(), QPointF()
        self._hover: tuple[QPointF, Qt.KeyboardModifier] | None = None
        self._hover_timer = QTimer(self)
        self._hover_timer.setSingleShot(True)
        self._hover_timer.timeout.connect(self._hover_now)
        self._spread_px = 0.0
        widget.setAttribute(Qt.WidgetAttribute.WA_AcceptTouchEvents)
        widget.setMouseTracking(True)
        widget.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Take what is a gesture; let everything else through."""
        kind = event.type()
        if isinstance(event, QMouseEvent):
            self._mouse(event)
            return True
        if isinstance(event, QWheelEvent):
            self.zoomed.emit(WHEEL_ZOOM ** (event.angleDelta().y() / 120.0), event.position())
            return True
        if isinstance(event, QTouchEvent):
            self._touch(event)
            return True
        if isinstance(event, QKeyEvent) and kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            # What nobody uses goes on to the parent, never to the widget: VTK has keys of its own, such as w and q.
            event.ignore()
            if kind == QEvent.Type.KeyPress:
                self.keyed.emit(event)
            return True
        if isinstance(event, QFocusEvent):
            self.keysTaken.emit(event.gotFocus() and event.reason() in KEY_REASONS)
        if kind == QEvent.Type.Leave:
            self._hover = None
            self.left.emit()
        return False

    def _mouse(self, event: QMouseEvent) -> None:
        place, modifiers = event.position(), event.modifiers()
        match event.type():
            case QEvent.Type.MouseButtonPress:
                if self._state is State.IDLE:
                    self._press(place, event.button())
            case QEvent.Type.MouseMove:
                self._move(place, modifiers)
            case QEvent.Type.MouseButtonRelease:
                if event.button() is self._button:
                    self._release(place, modifiers)
            case QEvent.Type.MouseButtonDblClick:
                self._state = State.IDLE
                if event.button() == Qt.MouseButton.LeftButton:
                    self.double_clicked.emit(place, modifiers)

    def _press(self, place: QPointF, button: Qt.MouseButton) -> None:
        self._state, self._button = State.PRESSED, button
        self._start = self._last = place
        self._hover = None

    def _move(self, place: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        if self._state is State.IDLE:
            self._hover = (place, modifiers)
            if not self._hover_timer.isActive():
                self._hover_timer.start(HOVER_MS)
            return
        moved = place - self._start
        if self._state is State.PRESSED and moved.manhattanLength() >= CLICK_PX:
            self._state = State.DRAGGING
            is_turn = self._button == Qt.MouseButton.LeftButton
            self.drag_started.emit(self._start, Drag.TURN if is_turn else Drag.SHIFT, modifiers)
        if self._state is State.DRAGGING:
            step, self._last = place - self._last, place
            self.dragged.emit(place, step, modifiers)

    def _release(self, place: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        was, self._state = self._state, State.IDLE
        if was is State.DRAGGING:
            self.drag_ended.emit(place, modifiers)
        elif was is State.PRESSED and self._button == Qt.MouseButton.LeftButton:
            self.clicked.emit(place, modifiers)

    def _touch(self, event: QTouchEvent) -> None:
        event.accept()
        points = [point.position() for point in event.points()]
        ends = event.type() in (QEvent.Type.TouchEnd, QEvent.Type.TouchCancel)
        if ends or not points:
            if self._state in (State.PRESSED, State.DRAGGING) and points:
                self._release(points[0], event.modifiers())
            self._state = State.IDLE
        elif len(points) == 1 and self._state is not State.TWO_FINGERS:
            if self._state is State.IDLE:
                self._press(points[0], Qt.MouseButton.LeftButton)
            else:
                self._move(points[0], event.modifiers())
        elif len(points) >= 2:
            self._two_fingers(points[0], points[1], event.modifiers())

    def _two_fingers(self, a: QPointF, b: QPointF, modifiers: Qt.KeyboardModifier) -> None:
        middle, between = (a + b) * 0.5, b - a
        spread_px = max(1.0, (between.x() ** 2 + between.y() ** 2) ** 0.5)
        if self._state is not State.TWO_FINGERS:
            if self._state is State.DRAGGING:
                self.drag_ended.emit(self._last, modifiers)
            self._state = State.TWO_FINGERS
        else:
            self.shifted.emit(middle - self._last)
            self.zoomed.emit(spread_px / self._spread_px, middle)
        self._last, self._spread_px = middle, spread_px

    def _hover_now(self) -> None:
        if self._hover is not None and self._state is State.IDLE:
            place, modifiers = self._hover
            self._hover = None
            self.hovered.emit(place, modifiers)


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
