"""A page in the place of a tab that is not built yet: it says so, and what to do meanwhile."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget


class PreparedTab:
    """A tab with two sentences."""

    def __init__(self, missing: str, advice: str) -> None:
        self.left = QWidget()
        self.right: QWidget | None = None
        self.bottom: QWidget | None = None
        layout = QVBoxLayout(self.left)
        for text, role in ((missing, "heading"), (advice, "muted")):
            label = QLabel(text)
            label.setProperty("role", role)
            label.setAlignment(Qt.AlignmentFlag.AlignCenter)
            label.setWordWrap(True)
            layout.addWidget(label)
        layout.insertStretch(0, 1)
        layout.addStretch(1)

    def shown(self) -> None:
        """Nothing is shared with others."""

    def hidden(self) -> None:
        """Nothing is shared with others."""

    def actions(self) -> tuple[QAction, ...]:
        """There are none."""
        return ()
