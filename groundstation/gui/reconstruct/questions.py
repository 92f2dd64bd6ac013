"""Questions of the Reconstruct tab; a class of its own so that whoever drives the window without a user can answer."""

from __future__ import annotations

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QWidget

from groundstation.gui.questions import agrees


class ReconstructQuestions(QObject):
    """Asks by dialogs."""

    def break_off(self, parent: QWidget) -> bool:
        """Whether to break a training off because the window closes."""
        return agrees(
            parent,
            self.tr("A model is being trained"),
            self.tr(
                "Closing the window breaks the training off. What it has reached is kept, and the Reconstruct tab "
                "goes on with it later. Close the window?"
            ),
        )
