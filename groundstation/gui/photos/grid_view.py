"""The tools, keys and buttons that correct a grid over its photo."""

from __future__ import annotations

from enum import Enum, auto

import numpy as np
from PySide6.QtCore import QEvent, QPointF, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QHelpEvent, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QButtonGroup, QPushButton, QToolTip, QVBoxLayout, QWidget

from groundstation.gui.photos.grid_picture import GridPicture
from groundstation.gui.widgets.scrolling import ButtonGrid
from groundstation.services.photos.grid_edits import (
    LinePlace,
    cell_at,
    cell_beside,
    following_line,
    line_near,
    lines_of,
    panels_in,
    place_beside,
    room_for_line,
)
from reconstruction.panels.search.record import FacadeGrid

GRAB_PX = 12.0
"""On the screen; a finger on a large picture hits that well enough, for lines are far apart there."""

STEP_PX, LARGE_STEP_PX = 1.0, 10.0
"""How far one press of an arrow key moves a line, in the rectified view; with Shift."""

LEAST_MOVE_PX = 0.01

PUT_DOWN_MS = 700
"""After the last press of an arrow key the line stays where it is: the facade is not solved anew for every pixel."""

ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}


class Tool(Enum):
    """What a press on the picture does."""

    MOVE = auto()
    ADD_COLUMN = auto()
    ADD_ROW = auto()
    REMOVE_LINE = auto()
    PANEL = auto()


class GridView(GridPicture):
    """Lets the active grid be corrected, by pointer, finger and keys.

    A press or Tab chooses a line; arrows move it by a pixel of the rectified view, with Shift by ten; Delete removes
    it, Insert adds one beside it, Esc lets go of it. With the tool for panels, arrows choose a panel, Delete takes it
    out, Insert puts it back and the space bar does either.

    Signals
    -------
    lineMoved(str, int, float), lineAdded(str, float), lineRemoved(str, int)
        Axis ("column" or "row"), number of the line, position in the rectified view.
    panelSwitched(int, int, bool)
        Row, column, and whether the cell is a panel now.
    """

    lineMoved = Signal(str, int, float)  # noqa: N815  (Qt's own way of naming)
    lineAdded = Signal(str, float)  # noqa: N815
    lineRemoved = Signal(str, int)  # noqa: N815
    panelSwitched = Signal(int, int, bool)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._tool = Tool.MOVE
        self._is_dragging = False
        self._rest = QTimer(self, singleShot=True, interval=PUT_DOWN_MS)
        self._rest.timeout.connect(self.put_down)
        self.setAccessibleName(self.tr("Photo with the grid found in it"))
        self.setAccessibleDescription(
            self.tr("Tab chooses a line, arrows move it, Shift by ten pixels; Delete removes it, Insert adds one.")
        )

    def set_grids(self, grids: tuple[FacadeGrid, ...], active: FacadeGrid | None, *, is_rectified: bool) -> None:
        """Draw these grids, of which one is active; the picture is the rectified view of that, or the photo."""
        before = self._grid
        is_same = before is not None and active is not None and before.rectification is active.rectification
        if not is_same or is_rectified is not self._is_rectified:
            self._let_go()
        if before is not active:
            self._held_px, self._is_dragging = None, False
            self._rest.stop()
        super().set_grids(grids, active, is_rectified=is_rectified)
        self._keep_within()

    def set_tool(self, tool: Tool) -> None:
        """What a press does from now on."""
        self.put_down()
        self._tool = tool
        self._let_go()
        shape = Qt.CursorShape.OpenHandCursor if tool is Tool.MOVE else Qt.CursorShape.CrossCursor
        self.setCursor(shape)

    def tool(self) -> Tool:
        """What a press does."""
        return self._tool

    def chosen_line(self) -> LinePlace | None:
        """The line that keys work on."""
        return self._line

    def chosen_cell(self) -> tuple[int, int] | None:
        """Row and column of the cell that keys work on."""
        return self._cell

    def nudge(self, right: int, down: int, step_px: float = STEP_PX) -> bool:
        """Move the chosen line across itself, or choose the cell beside; False where there is nothing to move."""
        if self._grid is None:
            return False
        if self._tool is Tool.PANEL:
            self._cell = cell_beside(self._grid, self._cell, -down, right)
            self.update()
            return self._cell is not None
        if self._line is None:
            return False
        axis, index = self._line
        step = right if axis == "column" else down
        if step == 0:
            return False
        at = lines_of(self._grid, axis)[index].position_px if self._held_px is None else self._held_px
        low, high = room_for_line(self._grid, axis, index)
        self._held_px = min(max(at + step * step_px, low), high)
        self._rest.start()
        self.update()
        return True

    def put_down(self) -> None:
        """Leave the line that is being moved where it is now."""
        held, line = self._held_px, self._line
        self._held_px, self._is_dragging = None, False
        self._rest.stop()
        self.update()
        if held is None or line is None or self._grid is None:
            return
        axis, index = line
        if abs(held - lines_of(self._grid, axis)[index].position_px) > LEAST_MOVE_PX:
            self.lineMoved.emit(axis, index, held)

    # Where things are

    def _rectified(self, at: QPointF) -> tuple[tuple[float, float], float] | None:
        """Point of the rectified view under a point of the widget, and how far the grab reaches there."""
        if self._grid is None:
            return None
        near = [self.to_picture(at + QPointF(x, y)) for x, y in ((0.0, 0.0), (GRAB_PX, 0.0), (0.0, GRAB_PX))]
        points = np.array([[point.x(), point.y()] for point in near])
        if not self._is_rectified:
            points = self._grid.rectification.to_rectified(points)
        if not np.isfinite(points).all():
            return None
        reach = float(np.linalg.norm(points[1:] - points[0], axis=1).max())
        return (float(points[0, 0]), float(points[0, 1])), reach

    def _let_go(self) -> None:
        self._line, self._cell, self._held_px = None, None, None
        self.update()

    def _keep_within(self) -> None:
        """What is chosen may have gone with a correction: the one that has its place now is chosen."""
        if self._grid is None:
            self._let_go()
            return
        if self._line is not None:
            axis, index = self._line
            n_lines = len(lines_of(self._grid, axis))
            self._line = (axis, min(index, n_lines - 1)) if n_lines else None
        if self._cell is not None:
            self._cell = cell_beside(self._grid, self._cell, 0, 0)

    # Pointer and finger

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Do what the tool does; on nothing, take hold of the picture."""
        self.put_down()
        found = self._rectified(event.position())
        if found is None or self._grid is None or event.button() != Qt.MouseButton.LeftButton:
            super().mousePressEvent(event)
            return
        point, reach = found
        line = line_near(self._grid, point, reach)
        if self._tool is Tool.MOVE:
            self._line, self._is_dragging = line, line is not None
            self.update()
            if line is None:
                super().mousePressEvent(event)
        else:
            self._use(self._grid, point, line)

    def _use(self, grid: FacadeGrid, point: tuple[float, float], line: LinePlace | None) -> None:
        cell = cell_at(grid, point)
        match self._tool:
            case Tool.ADD_COLUMN:
                self.lineAdded.emit("column", point[0])
            case Tool.ADD_ROW:
                self.lineAdded.emit("row", point[1])
            case Tool.REMOVE_LINE if line is not None:
                self.lineRemoved.emit(*line)
            case Tool.PANEL if cell is not None:
                self._cell = cell
                self.panelSwitched.emit(*cell, cell in grid.missing)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Take the line along, or the picture."""
        if not self._is_dragging or self._line is None or self._grid is None:
            super().mouseMoveEvent(event)
            return
        found = self._rectified(event.position())
        if found is not None:
            axis, index = self._line
            low, high = room_for_line(self._grid, axis, index)
            self._held_px = min(max(found[0][0 if axis == "column" else 1], low), high)
            self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Put the line down."""
        if self._is_dragging:
            self.put_down()
        super().mouseReleaseEvent(event)

    # Keys

    def focusNextPrevChild(self, next: bool) -> bool:  # noqa: A002, N802
        """Tab goes through the lines first, then on to the next widget."""
        self.put_down()
        if self._grid is not None and self._tool is not Tool.PANEL:
            self._line = following_line(self._grid, self._line, 1 if next else -1)
            self.update()
            if self._line is not None:
                return True
        return super().focusNextPrevChild(next)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802
        """Moving by keys ends."""
        self.put_down()
        super().focusOutEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Work on what is chosen; without that, arrows move the picture."""
        if not self._key(Qt.Key(event.key()), bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)):
            super().keyPressEvent(event)

    def _key(self, key: Qt.Key, has_shift: bool) -> bool:
        if key in ARROWS:
            return self.nudge(*ARROWS[key], LARGE_STEP_PX if has_shift else STEP_PX)
        if self._grid is None or (self._line is None and self._cell is None):
            return False
        match key:
            case Qt.Key.Key_Escape:
                self._let_go()
            case Qt.Key.Key_Return | Qt.Key.Key_Enter:
                self.put_down()
            case Qt.Key.Key_Delete | Qt.Key.Key_Insert | Qt.Key.Key_Space:
                self._change(self._grid, key)
            case _:
                return False
        return True

    def _change(self, grid: FacadeGrid, key: Qt.Key) -> None:
        """Remove or add what the key says, at what is chosen."""
        if self._cell is not None:
            is_none = self._cell in grid.missing
            if (key == Qt.Key.Key_Space) or is_none is (key == Qt.Key.Key_Insert):
                self.panelSwitched.emit(*self._cell, is_none)
        elif self._line is not None and key == Qt.Key.Key_Delete:
            self._held_px = None
            self.lineRemoved.emit(*self._line)
        elif self._line is not None and key == Qt.Key.Key_Insert:
            self.put_down()
            self.lineAdded.emit(self._line[0], place_beside(self._grid or grid, self._line))

    # What is known

    def event(self, event: QEvent) -> bool:
        """Say what is known of the panel under the pointer."""
        if isinstance(event, QHelpEvent):
            QToolTip.showText(event.globalPos(), self.words_at(QPointF(event.pos())), self)
            return True
        return super().event(event)

    def words_at(self, at: QPointF) -> str:
        """What is known of the panel under a point of the widget."""
        found = self._rectified(at)
        cell = None if found is None or self._grid is None else cell_at(self._grid, found[0])
        if cell is None or self._grid is None:
            return ""
        where = self.tr("row {0}, column {1}").format(cell[0] + 1, cell[1] + 1)
        panels = panels_in(self._grid, cell)
        if not panels:
            return self.tr("{0}: no panel").format(where)
        least = min(panel.confidence for panel in panels)
        return self.tr("{0}: confidence {1:.0f} %").format(where, 100.0 * least)


# Buttons that choose what a press on the picture does, and take corrections back.


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
            (Tool.REMOVE_LINE, self.tr("Delete line"), self.tr("A press on a line deletes it")),
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
