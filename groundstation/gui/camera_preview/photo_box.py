"""What stands beside the camera preview: lines or photo, panels' outlines, light and effects."""

from __future__ import annotations

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QButtonGroup, QCheckBox, QHBoxLayout, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.camera_preview.light_box import LightBox

WIDTH_PX = 210
"""Pictures are 4 : 3 and the room for them is wide: at 1280 x 720 this takes nothing from them."""


class PhotoBox(QWidget):
    """Chooses between lines and photo; what is for photos only is shown with them.

    Signals
    -------
    valueChanged(bool)
        Whether photos are shown: the user chose lines or photo, or photo once more.
    outlinesChanged(bool)
        Whether panels are outlined on photos.
    """

    valueChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)
    outlinesChanged = Signal(bool)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFixedWidth(WIDTH_PX)
        self.lines, self.photo = QPushButton(self.tr("Lines")), QPushButton(self.tr("Photo"))
        self.lines.setToolTip(self.tr("Building, panels and what is covered, drawn at once"))
        self.photo.setToolTip(self.tr("As photographed: what the glass will mirror from here"))
        group = QButtonGroup(self)
        for button in (self.lines, self.photo):
            button.setCheckable(True)
            group.addButton(button)
        self.lines.setChecked(True)
        self.outlines = QCheckBox(self.tr("Outlines"))
        self.outlines.setToolTip(self.tr("Panels' outlines over the photo, thick where this view covers them"))
        self.light, self.effects = LightBox(), QPushButton(self.tr("Effects ..."))
        self.effects.setToolTip(self.tr("What is simulated in this photo, what is not, and why"))
        self._lay_out()
        for button in (self.lines, self.photo):
            button.clicked.connect(self._chosen)
        self.outlines.toggled.connect(self.outlinesChanged)
        self._show_choice()

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(4)
        row.addWidget(self.lines, 1)
        row.addWidget(self.photo, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addLayout(row)
        for widget in (self.outlines, self.light, self.effects):
            layout.addWidget(widget)
        layout.addStretch(1)

    def value(self) -> bool:
        """Whether photos are shown."""
        return self.photo.isChecked()

    def setValue(self, is_photo: bool) -> None:  # noqa: N802
        """Show photos, or lines."""
        (self.photo if is_photo else self.lines).setChecked(True)
        self._show_choice()

    def event(self, event: QEvent) -> bool:
        """Let the space bar press the button that has the keyboard; elsewhere it flies through the sortie."""
        is_override = isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride
        if is_override and event.key() == Qt.Key.Key_Space:
            event.accept()
            return True
        return super().event(event)

    def _chosen(self) -> None:
        self._show_choice()
        self.valueChanged.emit(self.value())

    def _show_choice(self) -> None:
        for widget in (self.outlines, self.light, self.effects):
            widget.setVisible(self.value())
