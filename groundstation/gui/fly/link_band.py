"""A band across the whole window while the link is lost, whatever tab is in front."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QMainWindow, QVBoxLayout, QWidget

from groundstation.gui.theme import colours

FONT_SCALE = 1.3


class LinkBand(QLabel):
    """Says that the link is lost, since when, and that the aircraft goes on by itself."""

    def __init__(self) -> None:
        super().__init__()
        self.setWordWrap(True)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        font = self.font()
        font.setPointSizeF(FONT_SCALE * font.pointSizeF())
        font.setBold(True)
        self.setFont(font)
        self.setContentsMargins(8, 6, 8, 6)
        self.hide()

    def put_into(self, window: QWidget) -> None:
        """Stand above the messages of a main window, where it moves no button, or on top of any other."""
        centre = window.centralWidget() if isinstance(window, QMainWindow) else None
        page = window if centre is None else centre
        layout = page.layout()
        if isinstance(layout, QVBoxLayout):
            layout.insertWidget(layout.count() - 1, self)
        else:
            self.setParent(page)

    def show_lost(self, silent_s: float | None) -> None:
        """Appear; `silent_s` since the vehicle was last heard."""
        look = colours()
        self.setStyleSheet(f"background: {look.error}; color: {look.base};")
        if silent_s is None:
            text = self.tr("LINK LOST. It is opened again; the aircraft goes on by itself.")
        else:
            text = self.tr("LINK LOST for {0:.0f} s. What is shown is old; the aircraft goes on by itself.").format(
                silent_s
            )
        if self.text() != text:
            self.setText(text)
        self.setVisible(True)
