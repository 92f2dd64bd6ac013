"""A button that is held down until it acts: no slip of a finger, a glove or a key gives an order."""

from __future__ import annotations

from PySide6.QtCore import QElapsedTimer, QRectF, Qt, QTimer
from PySide6.QtGui import QColor, QFocusEvent, QHideEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import QPushButton, QToolTip, QWidget

HOLD_MS = 700
"""Time for which it is held: longer than a slip, which lifts within 0.2 s, and short enough for an emergency."""

STEP_MS = 20
MOST_STEP_MS = 200
"""Of one step that counts: while the window stands still, a finger may have been lifted without being heard."""

BAR_PX = 7.0
NEAR_PX = 16
"""A finger that slides so far off the button still holds it."""

KEYS = (Qt.Key.Key_Space, Qt.Key.Key_Return, Qt.Key.Key_Enter)


class HoldButton(QPushButton):
    """Clicked once it was held for `HOLD_MS`, by a finger or by Space or Enter; letting go before does nothing.

    A bar along its lower edge grows meanwhile; who lets go before it is full is told to keep the button pressed.
    `click()`, which shortcuts and screen readers call, acts at once.
    """

    def __init__(self, text: str, parent: QWidget | None = None) -> None:
        super().__init__(text, parent)
        self._clock = QElapsedTimer()
        self._held_ms = 0
        self._timer = QTimer(self, interval=STEP_MS)
        self._timer.timeout.connect(self._step)

    def is_held(self) -> bool:
        """Whether it is being held."""
        return self._timer.isActive()

    def hold(self) -> None:
        """Begin to hold it, as a key of a joystick does."""
        if self.isEnabled() and not self.is_held():
            self._clock.start()
            self._held_ms = 0
            self._timer.start()
            self.setDown(True)
            self.update()

    def let_go(self) -> None:
        """Hold it no longer."""
        if self.is_held():
            self._timer.stop()
            self.setDown(False)
            self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Begin."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.hold()
        event.accept()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """The second press is one like the first."""
        self.mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Sliding off lets go."""
        if not self.rect().adjusted(-NEAR_PX, -NEAR_PX, NEAR_PX, NEAR_PX).contains(event.position().toPoint()):
            self.let_go()
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Let go."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._let_go_early()
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Space and Enter hold it; a key that repeats itself is still the same press."""
        if Qt.Key(event.key()) not in KEYS:
            super().keyPressEvent(event)
        elif not event.isAutoRepeat():
            self.hold()

    def keyReleaseEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Let go."""
        if Qt.Key(event.key()) not in KEYS:
            super().keyReleaseEvent(event)
        elif not event.isAutoRepeat():
            self._let_go_early()

    def _let_go_early(self) -> None:
        """Let go by hand: where it was still held, it did nothing, which looks like a broken button without a word."""
        if self.is_held():
            self.let_go()
            text = self.tr("Keep it pressed until the bar is full")
            QToolTip.showText(self.mapToGlobal(self.rect().bottomLeft()), text, self)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802
        """Where the keyboard goes elsewhere, nothing tells when the key is let go."""
        self.let_go()
        super().focusOutEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        """What is not seen is not held."""
        self.let_go()
        super().hideEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Paint the bar over the button."""
        super().paintEvent(event)
        if self.is_held():
            part = min(1.0, self._held_ms / HOLD_MS)
            painter = QPainter(self)
            colour = QColor(self.palette().color(self.foregroundRole()))
            role = self.palette().buttonText().color()
            bar = QRectF(0.0, self.height() - BAR_PX, part * self.width(), BAR_PX)
            painter.fillRect(bar, role if role.isValid() else colour)
            painter.end()

    def _step(self) -> None:
        self._held_ms += min(self._clock.restart(), MOST_STEP_MS)
        if not self.isEnabled():
            self.let_go()
        elif self._held_ms >= HOLD_MS:
            self.let_go()
            self.click()
        else:
            self.update()
