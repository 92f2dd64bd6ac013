"""The picture of a model, led through the air by mouse and keys, and another one beside it behind a line to drag."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

from PySide6.QtCore import QElapsedTimer, QEvent, QObject, QPointF, QRectF, QSize, Qt, QTimer, Signal
from PySide6.QtGui import (
    QColor,
    QFocusEvent,
    QHelpEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QPolygonF,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from groundstation.gui.widgets.theme import colours
from groundstation.services.reconstruct.guided_camera import NEAREST_M, moved, orbited, turned
from reconstruction.base.cameras import PosedPhoto

TURN_RAD_PX = 0.004
"""Of a drag: the width of the view is about half a turn."""

TURN_RAD_KEY = 0.05
STEP_KEY = 0.06
"""Share of the distance to what is looked at, that a key goes."""

STEP_WHEEL = 0.12
FLYING: dict[Qt.Key, tuple[int, int, int]] = {
    Qt.Key.Key_W: (0, 0, 1),
    Qt.Key.Key_S: (0, 0, -1),
    Qt.Key.Key_A: (-1, 0, 0),
    Qt.Key.Key_D: (1, 0, 0),
    Qt.Key.Key_E: (0, 1, 0),
    Qt.Key.Key_Q: (0, -1, 0),
}
"""Keys that fly as long as they are held: to the right, up, forward."""

SHARE_S = 0.5
"""Of the distance to what is looked at, that is flown in a second."""

FASTER = 4.0
"""With Shift."""

FLIGHT_MS = 33
LONGEST_S = 0.2
"""Of one step: a window that was busy must not leap."""

GRAB_PX = 10.0
"""On either side of the line, that it is taken hold of by; wider for fingers than it is drawn."""

PAD_PX = 6.0

CLICK_PX = 4.0
"""That the mouse may move between being pressed and let go."""

MARK_PX = 2.5


@dataclass(frozen=True, slots=True)
class Mark:
    """A line or outline drawn over the picture.

    Parameters
    ----------
    points
        In shares of the picture's width and height, from its upper left corner.
    colour
        As Qt has it.
    text
        Beside its middle; "" for none.
    """

    points: tuple[tuple[float, float], ...]
    colour: str
    is_closed: bool = True
    text: str = ""


def flight(held: Collection[Qt.Key], seconds: float, is_fast: bool) -> tuple[float, float, float]:
    """How far held keys fly in some seconds: right, up, forward, in shares of the distance to what is looked at."""
    right, up, forward = (float(sum(FLYING[key][axis] for key in held)) for axis in range(3))
    length = math.hypot(right, up, forward)
    share = SHARE_S * min(seconds, LONGEST_S) * (FASTER if is_fast else 1.0) / max(length, 1.0)
    return share * right, share * up, share * forward


class ModelView(QWidget):
    """Shows one picture, or two that are divided by an upright line.

    Signals
    -------
    orbited(float, float), turned(float, float)
        Fly around what is looked at, or look elsewhere: radians to the right and up.
    moved(float, float, float)
        Go to the right, up and forward, in shares of the distance to what is looked at.
    flown(float, float, float)
        The same with what is looked at: it stays as far away.
    homeRequested()
        Back to where the photo was taken.
    valueChanged(float)
        Where the line is, 0 at the left, 1 at the right.
    clicked(float, float), pointed(float, float)
        A place in the picture was clicked, or the mouse is there: shares of its width and height.
    resized()
    """

    orbited = Signal(float, float)
    turned = Signal(float, float)
    moved = Signal(float, float, float)
    flown = Signal(float, float, float)
    homeRequested = Signal()  # noqa: N815  (Qt's own way of naming)
    valueChanged = Signal(float)  # noqa: N815
    clicked = Signal(float, float)
    pointed = Signal(float, float)
    resized = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._left: QImage | None = None
        self._right: QImage | None = None
        self._words, self._note = ("", ""), ""
        self._device, self._device_box = ("", ""), QRectF()
        self._line, self._grabbed, self._holds_line = 0.5, QPointF(), False
        self._pressed: QPointF | None = None
        self._marks: tuple[Mark, ...] = ()
        self._held: set[Qt.Key] = set()
        self._is_fast = False
        self._since, self._steps = QElapsedTimer(), QTimer(self, interval=FLIGHT_MS)
        self._steps.timeout.connect(self._fly)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setMinimumSize(QSize(240, 160))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(self.tr("Picture of the model"))

    def set_pictures(self, left: QImage | None, right: QImage | None) -> None:
        """Show one picture, or two of the same view."""
        self._left, self._right = left, right
        self.update()

    def pictures(self) -> tuple[QImage | None, QImage | None]:
        """What is shown."""
        return self._left, self._right

    def set_words(self, left: str, right: str) -> None:
        """Say what the pictures are."""
        if (left, right) != self._words:
            self._words = left, right
            self.update()

    def set_note(self, note: str) -> None:
        """Say something below the pictures, or in their place."""
        if note != self._note:
            self._note = note
            self.update()

    def set_device(self, words: str, reason: str) -> None:
        """Say in the lower left corner what draws, and why where the mouse rests there."""
        if (words, reason) != self._device:
            self._device = words, reason
            self.setAccessibleDescription(f"{words}: {reason}" if reason else words)
            self.update()

    def device(self) -> tuple[str, str]:
        """What is said of it."""
        return self._device

    def set_marks(self, marks: tuple[Mark, ...]) -> None:
        """Draw lines over the picture, in the place of those that were there."""
        if marks != self._marks:
            self._marks = marks
            self.update()

    def marks(self) -> tuple[Mark, ...]:
        """What is drawn over the picture."""
        return self._marks

    def note(self) -> str:
        """What is said."""
        return self._note

    def value(self) -> float:
        """Where the line is."""
        return self._line

    def setValue(self, value: float) -> None:  # noqa: N802
        """Put the line elsewhere."""
        value = min(1.0, max(0.0, value))
        if value != self._line:
            self._line = value
            self.update()
            self.valueChanged.emit(value)

    def room(self) -> QRectF:
        """Where the pictures are."""
        picture = self._left if self._left is not None else self._right
        whole = QRectF(self.rect())
        if picture is None:
            return whole
        scale = min(whole.width() / picture.width(), whole.height() / picture.height())
        room = QRectF(0.0, 0.0, scale * picture.width(), scale * picture.height())
        room.moveCenter(whole.center())
        return room

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Pictures, line, words."""
        painter, look = QPainter(self), colours()
        painter.fillRect(self.rect(), QColor(look.scene))
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        room, left, right = self.room(), self._left, self._right
        at = room.left() + self._line * room.width()
        if left is not None:
            painter.drawImage(room, left)
        if right is not None:
            painter.save()
            if left is not None:
                painter.setClipRect(QRectF(at, room.top(), room.right() - at, room.height()))
            painter.drawImage(room, right)
            painter.restore()
        if left is not None:
            self._paint_marks(painter, room)
        if left is not None and right is not None:
            painter.setPen(QPen(QColor("#000000"), 5.0))
            painter.drawLine(QPointF(at, room.top()), QPointF(at, room.bottom()))
            painter.setPen(QPen(QColor("#ffffff"), 2.5))
            painter.drawLine(QPointF(at, room.top()), QPointF(at, room.bottom()))
        if left is not None:
            self._paint_words(painter, room, self._words[0], Qt.AlignmentFlag.AlignLeft)
        if right is not None:
            self._paint_words(painter, room, self._words[1], Qt.AlignmentFlag.AlignRight)
        if left is not None:
            self._paint_device(painter, room)
        self._paint_note(painter, left is None and right is None)
        if self.hasFocus():
            painter.setPen(QColor(look.accent))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def _paint_marks(self, painter: QPainter, room: QRectF) -> None:
        painter.save()
        painter.setClipRect(room)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for mark in self._marks:
            points = [QPointF(room.left() + x * room.width(), room.top() + y * room.height()) for x, y in mark.points]
            for pen in (QPen(QColor(0, 0, 0, 170), 2.0 * MARK_PX), QPen(QColor(mark.colour), MARK_PX)):
                painter.setPen(pen)
                if mark.is_closed:
                    painter.drawPolygon(QPolygonF(points))
                else:
                    painter.drawPolyline(QPolygonF(points))
                    for point in points:
                        painter.drawEllipse(point, MARK_PX, MARK_PX)
            if mark.text:
                middle = QPointF(sum(at.x() for at in points) / len(points), sum(at.y() for at in points) / len(points))
                self._paint_box(painter, middle, mark.text)
        painter.restore()

    def _paint_box(self, painter: QPainter, at: QPointF, text: str) -> None:
        box = QRectF(painter.fontMetrics().boundingRect(text)).adjusted(-PAD_PX, -3.0, PAD_PX, 3.0)
        box.moveCenter(at)
        painter.fillRect(box, QColor(0, 0, 0, 160))
        painter.setPen(QColor("#ffffff"))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_words(self, painter: QPainter, room: QRectF, words: str, side: Qt.AlignmentFlag) -> None:
        if not words:
            return
        metrics = painter.fontMetrics()
        is_alone = self._left is None or self._right is None
        words = metrics.elidedText(words, Qt.TextElideMode.ElideRight, int((0.9 if is_alone else 0.48) * room.width()))
        size = metrics.boundingRect(words).size()
        box = QRectF(0.0, 0.0, size.width() + 2.0 * PAD_PX, size.height() + PAD_PX)
        box.moveTop(room.top() + PAD_PX)
        if side == Qt.AlignmentFlag.AlignLeft:
            box.moveLeft(room.left() + PAD_PX)
        else:
            box.moveRight(room.right() - PAD_PX)
        painter.fillRect(box, QColor(0, 0, 0, 160))
        painter.setPen(QColor("#ffffff"))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, words)

    def _paint_device(self, painter: QPainter, room: QRectF) -> None:
        words = self._device[0]
        self._device_box = QRectF()
        if not words:
            return
        box = QRectF(painter.fontMetrics().boundingRect(words)).adjusted(-PAD_PX, -3.0, PAD_PX, 3.0)
        box.moveBottomLeft(room.bottomLeft() + QPointF(PAD_PX, -PAD_PX))
        painter.fillRect(box, QColor(0, 0, 0, 110))
        painter.setPen(QColor(255, 255, 255, 200))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, words)
        self._device_box = box

    def _paint_note(self, painter: QPainter, is_alone: bool) -> None:
        if not self._note:
            return
        whole = QRectF(self.rect()).adjusted(16.0, 16.0, -16.0, -16.0)
        flags = Qt.TextFlag.TextWordWrap.value | Qt.AlignmentFlag.AlignHCenter.value
        if is_alone:
            painter.setPen(QColor(colours().muted))
            painter.drawText(whole, flags | Qt.AlignmentFlag.AlignVCenter.value, self._note)
            return
        box = QRectF(painter.boundingRect(whole, flags | Qt.AlignmentFlag.AlignBottom.value, self._note))
        painter.fillRect(box.adjusted(-PAD_PX, -3.0, PAD_PX, 3.0), QColor(0, 0, 0, 160))
        painter.setPen(QColor("#ffffff"))
        painter.drawText(box, flags, self._note)

    # Mouse and keys

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Another size asks for another picture."""
        super().resizeEvent(event)
        self.resized.emit()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of the line, or of the scene."""
        self._grabbed = event.position()
        self._pressed = event.position() if event.button() == Qt.MouseButton.LeftButton else None
        self._holds_line = self._is_at_line(event.position()) and event.button() == Qt.MouseButton.LeftButton

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Drag the line; or orbit, with the right button or Shift shift, with Ctrl turn."""
        at, buttons = event.position(), event.buttons()
        if buttons == Qt.MouseButton.NoButton or not buttons:
            is_line = self._is_at_line(at)
            self.setCursor(Qt.CursorShape.SplitHCursor if is_line else Qt.CursorShape.ArrowCursor)
            self.pointed.emit(*self._shares(at))
            return
        if self._pressed is not None and (at - self._pressed).manhattanLength() <= CLICK_PX:
            return  # a hand that clicks is not quite still
        self._pressed = None
        step, self._grabbed = at - self._grabbed, at
        if self._holds_line:
            room = self.room()
            self.setValue((at.x() - room.left()) / max(room.width(), 1.0))
        elif buttons & Qt.MouseButton.RightButton or event.modifiers() & Qt.KeyboardModifier.ShiftModifier:
            side = max(1.0, self.room().height())
            self.moved.emit(-step.x() / side, step.y() / side, 0.0)
        elif event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            self.turned.emit(-TURN_RAD_PX * step.x(), TURN_RAD_PX * step.y())
        else:
            self.orbited.emit(-TURN_RAD_PX * step.x(), TURN_RAD_PX * step.y())

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go; where nothing was dragged, it was a click."""
        pressed, self._pressed = self._pressed, None
        if pressed is not None and not self._holds_line and self._left is not None:
            self.clicked.emit(*self._shares(event.position()))
        self._holds_line = False

    def _shares(self, at: QPointF) -> tuple[float, float]:
        room = self.room()
        return (at.x() - room.left()) / max(room.width(), 1.0), (at.y() - room.top()) / max(room.height(), 1.0)

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:  # noqa: N802
        """Back to the photo's own place."""
        self.homeRequested.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Come nearer, go away."""
        self.moved.emit(0.0, 0.0, STEP_WHEEL * event.angleDelta().y() / 120.0)

    def event(self, event: QEvent) -> bool:
        """Keys that fly are no shortcuts of the window while the view has the keyboard."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and _flies(event):
            event.accept()
            return True
        if event.type() == QEvent.Type.ToolTip and isinstance(event, QHelpEvent):
            is_there = self._device_box.contains(QPointF(event.pos()))
            QToolTip.showText(event.globalPos(), self._device[1] if is_there else "", self)
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """W, A, S, D, E, Q fly while they are held, with Shift faster.

        Arrows orbit, with Shift they shift, with Ctrl they turn; plus and minus come nearer and go; 0 is home.
        """
        key, mods = Qt.Key(event.key()), event.modifiers()
        self._is_fast = bool(mods & Qt.KeyboardModifier.ShiftModifier)
        if _flies(event):
            if not event.isAutoRepeat():
                self._held.add(key)
                if not self._steps.isActive():
                    self._since.start()
                    self._steps.start()
            return
        ways = {
            Qt.Key.Key_Left: (-1.0, 0.0),
            Qt.Key.Key_Right: (1.0, 0.0),
            Qt.Key.Key_Up: (0.0, 1.0),
            Qt.Key.Key_Down: (0.0, -1.0),
        }
        if key in ways:
            x, y = ways[key]
            if mods & Qt.KeyboardModifier.ShiftModifier:
                self.moved.emit(STEP_KEY * x, STEP_KEY * y, 0.0)
            elif mods & Qt.KeyboardModifier.ControlModifier:
                self.turned.emit(TURN_RAD_KEY * x, TURN_RAD_KEY * y)
            else:
                self.orbited.emit(TURN_RAD_KEY * x, TURN_RAD_KEY * y)
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_PageUp):
            self.moved.emit(0.0, 0.0, STEP_WHEEL)
        elif key in (Qt.Key.Key_Minus, Qt.Key.Key_PageDown):
            self.moved.emit(0.0, 0.0, -STEP_WHEEL)
        elif key in (Qt.Key.Key_0, Qt.Key.Key_Home):
            self.homeRequested.emit()
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Fly on with the keys that are still held."""
        self._is_fast = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if not event.isAutoRepeat() and event.key() in self._held:
            self._fly()
            self._held.discard(Qt.Key(event.key()))
        if not self._held:
            self._steps.stop()
        super().keyReleaseEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802
        """Whoever has the keyboard now hears of keys that are let go."""
        self._held.clear()
        self._steps.stop()
        super().focusOutEvent(event)

    def _fly(self) -> None:
        way = flight(self._held, 1e-3 * self._since.restart(), self._is_fast)
        if any(way):
            self.flown.emit(*way)

    def _is_at_line(self, at: QPointF) -> bool:
        if self._left is None or self._right is None:
            return False
        room = self.room()
        return abs(at.x() - room.left() - self._line * room.width()) <= GRAB_PX


def _flies(event: QKeyEvent) -> bool:
    others = event.modifiers() & ~(Qt.KeyboardModifier.ShiftModifier | Qt.KeyboardModifier.KeypadModifier)
    return event.key() in FLYING and others == Qt.KeyboardModifier.NoModifier


# The camera of a view, led by the view's mouse and keys.

USUAL_DISTANCE_M = 15.0
"""To what is looked at, before a picture has told it."""

MOST_FORWARD = 0.9
"""Of the distance, that one step may go."""


class GuidedCamera(QObject):
    """Keeps a camera and how far away it is from what is in its middle.

    Signals
    -------
    cameraMoved()
        It was turned or moved.
    """

    cameraMoved = Signal()  # noqa: N815

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
        self.cameraMoved.emit()
