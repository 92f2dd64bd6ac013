"""A large picture that can be moved and enlarged."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QSizePolicy, QWidget

from groundstation.gui.photos.photo_store import LargePicture
from groundstation.gui.widgets.theme import colours

MAX_ZOOM = 16.0
"""Screen pixels per pixel of the picture."""

WHEEL_STEP = 1.25
PAN_PX = 60.0


class PictureView(QWidget):
    """Shows a picture: the wheel enlarges, dragging moves, a double click shows it whole."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._picture: LargePicture | None = None
        self._text = ""
        self._zoom, self._corner = 1.0, QPointF()
        self._is_whole = True
        self._grabbed: QPointF | None = None
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.setMinimumSize(QSize(240, 180))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def set_picture(self, picture: LargePicture | None) -> None:
        """Show another picture; of the same size, the same part of it."""
        before = self._size()
        self._picture = picture if picture is not None and picture.levels else None
        if self._size() != before:
            self._is_whole = True
        if self._is_whole:
            self.show_whole()
        self.update()

    def set_text(self, text: str) -> None:
        """Say something in the place of a picture."""
        self._text = text
        self.update()

    def picture(self) -> LargePicture | None:
        """What is shown."""
        return self._picture

    def show_whole(self) -> None:
        """Show all of the picture."""
        self._is_whole = True
        size = self._size()
        if not size.isEmpty():
            room = self.room()
            self._zoom = self._whole_zoom()
            self._corner = room.center() - QPointF(size.width(), size.height()) * (0.5 * self._zoom)
        self.update()

    def room(self) -> QRectF:
        """Where the whole picture has its place."""
        return QRectF(self.rect())

    def zoom(self) -> float:
        """Screen pixels per pixel of the picture."""
        return self._zoom

    def zoom_by(self, factor: float, about: QPointF | None = None) -> None:
        """Enlarge about a point of the widget, its middle where none is given."""
        about = QPointF(self.rect().center()) if about is None else about
        here = self.to_picture(about)
        whole = self._whole_zoom()
        self._zoom = min(MAX_ZOOM, max(0.5 * whole, self._zoom * factor))
        self._is_whole = False
        self._corner = about - here * self._zoom
        self.update()

    def to_picture(self, point: QPointF) -> QPointF:
        """Pixels of the picture, of a point of the widget."""
        return (point - self._corner) / self._zoom

    def to_widget(self, point: QPointF) -> QPointF:
        """Point of the widget, of pixels of the picture."""
        return point * self._zoom + self._corner

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """The picture, then what lies over it."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(colours().scene))
        if self._picture is None:
            painter.setPen(QColor(colours().muted))
            room = self.rect().adjusted(16, 16, -16, -16)
            painter.drawText(room, Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignCenter, self._text)
        else:
            self._paint_picture(painter, self._picture)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            self._paint_over(painter)
        if self.hasFocus():
            painter.setPen(QColor(colours().accent))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(self.rect().adjusted(0, 0, -1, -1))
        painter.end()

    def _paint_picture(self, painter: QPainter, picture: LargePicture) -> None:
        """Only the part that is seen, from the smallest copy that is fine enough."""
        full = picture.levels[0]
        suffices = [level for level in picture.levels if level.width() >= self._zoom * full.width()]
        level = suffices[-1] if suffices else full
        shrink = level.width() / full.width()
        seen = QRectF(self.to_picture(QPointF(0, 0)), self.to_picture(QPointF(self.width(), self.height())))
        seen = seen.intersected(QRectF(0, 0, full.width(), full.height()))
        if seen.isEmpty():
            return
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, self._zoom < 2.0)
        source = QRectF(seen.topLeft() * shrink, seen.bottomRight() * shrink)
        painter.drawImage(QRectF(self.to_widget(seen.topLeft()), self.to_widget(seen.bottomRight())), level, source)

    def _paint_over(self, painter: QPainter) -> None:
        """For views that draw something over the picture."""

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        """Stay whole."""
        super().resizeEvent(event)
        if self._is_whole:
            self.show_whole()

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802
        """Enlarge about the pointer."""
        self.zoom_by(WHEEL_STEP ** (event.angleDelta().y() / 120.0), event.position())

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take hold of the picture."""
        self._grabbed = event.position()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Move the picture."""
        if self._grabbed is not None:
            self._pan(event.position() - self._grabbed)
            self._grabbed = event.position()

    def mouseReleaseEvent(self, _event: QMouseEvent) -> None:  # noqa: N802
        """Let go."""
        self._grabbed = None

    def mouseDoubleClickEvent(self, _event: QMouseEvent) -> None:  # noqa: N802
        """Show all of it."""
        self.show_whole()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Arrows move, plus and minus enlarge, 0 shows the whole."""
        key = Qt.Key(event.key())
        moves = {
            Qt.Key.Key_Left: QPointF(PAN_PX, 0),
            Qt.Key.Key_Right: QPointF(-PAN_PX, 0),
            Qt.Key.Key_Up: QPointF(0, PAN_PX),
            Qt.Key.Key_Down: QPointF(0, -PAN_PX),
        }
        if key in moves:
            self._pan(moves[key])
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Minus):
            self.zoom_by(WHEEL_STEP if key == Qt.Key.Key_Plus else 1.0 / WHEEL_STEP)
        elif key == Qt.Key.Key_0:
            self.show_whole()
        else:
            super().keyPressEvent(event)

    def _pan(self, step: QPointF) -> None:
        self._is_whole = False
        self._corner += step
        self.update()

    def _size(self) -> QSize:
        return QSize() if self._picture is None else self._picture.levels[0].size()

    def _whole_zoom(self) -> float:
        size = self._size()
        room = self.room()
        return 1.0 if size.isEmpty() else min(room.width() / size.width(), room.height() / size.height())
