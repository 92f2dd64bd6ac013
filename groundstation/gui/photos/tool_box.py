"""Buttons that choose what a press on the picture does, and take corrections back."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.photos.grid_view import Tool
from groundstation.gui.widgets.scrolling import ButtonGrid


class ToolBox(QWidget):
    """Edits a `Tool`; `undo` and `redo` are its buttons for that.

    Signals
    -------
    valueChanged(Tool)
    nudged(int, int)
        What is chosen in the picture is to go one step to the right and down; negative to the left and up.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    nudged = Signal(int, int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.undo, self.redo = QPushButton("\u21b6"), QPushButton("\u21b7")
        self.undo.setAccessibleName(self.tr("Undo"))
        self.redo.setAccessibleName(self.tr("Redo"))
        self._buttons: dict[Tool, QPushButton] = {}
        group = QButtonGroup(self)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        tools, steps = ButtonGrid(), ButtonGrid(6)
        layout.addLayout(tools)
        layout.addLayout(steps)
        texts = (
            (
                Tool.MOVE,
                self.tr("Move"),
                self.tr(
                    "Drag a line to its place, or press it and move it with the arrows; elsewhere, drag the picture"
                ),
            ),
            (
                Tool.PANEL,
                self.tr("Panel on or off"),
                self.tr("A press takes a panel out, or puts it back; arrows and the space bar do the same"),
            ),
            (Tool.ADD_COLUMN, self.tr("Add upright line"), self.tr("A press adds a vertical line of the grid")),
            (Tool.ADD_ROW, self.tr("Add level line"), self.tr("A press adds a horizontal line of the grid")),
            (Tool.REMOVE_LINE, self.tr("Remove line"), self.tr("A press on a line removes it")),
        )
        for tool, text, tip in texts:
            button = QPushButton(text)
            button.setCheckable(True)
            button.setToolTip(tip)
            button.clicked.connect(lambda _checked=False, tool=tool: self.valueChanged.emit(tool))
            group.addButton(button)
            self._buttons[tool] = button
            tools.addWidget(button)
        self._arrows = tuple(self._arrow(*each) for each in self._directions())
        for button in (self.undo, self.redo, *self._arrows):
            steps.addWidget(button)
        self.setValue(Tool.MOVE)

    def _directions(self) -> tuple[tuple[str, str, int, int], ...]:
        return (
            ("\u2190", self.tr("To the left"), -1, 0),
            ("\u2192", self.tr("To the right"), 1, 0),
            ("\u2191", self.tr("Upwards"), 0, -1),
            ("\u2193", self.tr("Downwards"), 0, 1),
        )

    def _arrow(self, sign: str, name: str, right: int, down: int) -> QPushButton:
        """A button for fingers, which have no arrow keys."""
        button = QPushButton(sign)
        button.setAccessibleName(name)
        button.setToolTip(
            self.tr("Move the chosen line by a pixel, or choose the next panel; arrow keys do the same, Shift by ten")
        )
        button.setAutoRepeat(True)
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        button.clicked.connect(lambda: self.nudged.emit(right, down))
        return button

    def value(self) -> Tool:
        """What a press does."""
        return next(tool for tool, button in self._buttons.items() if button.isChecked())

    def setValue(self, tool: Tool) -> None:  # noqa: N802
        """Choose another tool."""
        self._buttons[tool].setChecked(True)

    def set_possible(self, *, can_edit: bool, undo_label: str, redo_label: str) -> None:
        """Enable what can be done; labels say what would be taken back or done again, empty for nothing."""
        for button in (*self._buttons.values(), *self._arrows):
            button.setEnabled(can_edit)
        for button, label, tip in (
            (self.undo, undo_label, self.tr("Take back: {0}")),
            (self.redo, redo_label, self.tr("Do again: {0}")),
        ):
            button.setEnabled(bool(label))
            button.setToolTip(tip.format(label) if label else "")
