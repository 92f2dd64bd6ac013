"""The line under the tabs: what is done in the step that is shown, what comes next, and the button that leads there."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtGui import QKeySequence, QPixmap
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QToolButton, QWidget

from groundstation.gui.application.translate import shown_keys
from groundstation.gui.widgets.icons import ICON_PX, picture, set_icon
from groundstation.gui.widgets.scrolling import ShortText
from groundstation.gui.widgets.theme import TOUCH_PX, colours
from groundstation.services.project.steps import Act, Guidance

NEXT_STEP_KEY = "F8"


class NextStepBar(QWidget):
    """Shows the guidance of one step.

    Signals
    -------
    wanted(Act)
        The user wants to be led on.
    helpRequested()
        The manual's page of this step is wanted.
    """

    wanted = Signal(object)
    helpRequested = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._act: Act | None = None
        self._tick, self._text, self.button = QLabel(), ShortText(), QPushButton()
        self.help = QToolButton()
        self.help.setAccessibleName(self.tr("Manual: this tab"))
        self.help.setToolTip(self.tr("What the manual says of this tab"))
        set_icon(self.help, "help")
        self.help.clicked.connect(self.helpRequested)
        self._tick.setFixedWidth(ICON_PX)
        self._text.setAccessibleName(self.tr("What is done, and what comes next"))
        self.button.setProperty("primary", True)
        set_icon(self.button, "next")
        layout = QHBoxLayout(self)
        layout.setContentsMargins(8, 0, 6, 0)
        # First, where it stays: one step after the other is taken by pressing at the same place.
        layout.addWidget(self.button)
        layout.addWidget(self._tick)
        layout.addWidget(self._text, 1)
        layout.addWidget(self.help)
        # Without a button, too: nothing below moves.
        self.setMinimumHeight(TOUCH_PX)
        self.button.clicked.connect(self._pressed)
        self.button.setToolTip(self.tr("What comes next ({0})").format(shown_keys(QKeySequence(NEXT_STEP_KEY))))

    def set_guidance(self, found: Guidance, done: str, following: str, label: str) -> None:
        """Show what a step says, in the user's language."""
        self._act = found.act
        self._tick.setPixmap(
            picture("done", colours().ok, ICON_PX, self.devicePixelRatioF()) if found.is_done else QPixmap()
        )
        self._tick.setAccessibleName(self.tr("Done") if found.is_done else "")
        parts = [self.tr("Done: {0}.").format(done)] if done else []
        parts.append(self.tr("Next: {0}.").format(following))
        self._text.setText(" ".join(parts))
        self.button.setVisible(found.act is not None)
        self.button.setText(label)

    def text(self) -> str:
        """What it says."""
        return self._text.text()

    def take(self) -> None:
        """Press the button, where there is one."""
        if self.button.isVisible():
            self.button.click()

    def _pressed(self) -> None:
        if self._act is not None:
            self.wanted.emit(self._act)
