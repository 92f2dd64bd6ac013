"""A list of layers of a picture, the topmost first: each can be hidden and made translucent, some can be removed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QFrame,
    QGridLayout,
    QLabel,
    QScrollArea,
    QSizePolicy,
    QSlider,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

SWATCH_PX = 12
SLIDER_PX = 84
LEAST_PX = 150
"""Height of the list at least; what is longer is scrolled."""

FAINTEST = 0.1
"""Least opacity: what is fainter is hidden by its check box."""


@dataclass(frozen=True, slots=True)
class LayerRow:
    """A layer as the list shows it.

    Parameters
    ----------
    key
        Names it for the program.
    colour
        `#rrggbb` of a mark before the title; empty for none.
    tip
        What is in it, beside the pointer.
    can_fade, can_remove
        Whether it has a slider, and a button that removes it.
    note
        What is to be known of how it is drawn, below it; empty for nothing.
    """

    key: str
    title: str
    is_visible: bool = True
    opacity: float = 1.0
    colour: str = ""
    tip: str = ""
    can_fade: bool = True
    can_remove: bool = False
    note: str = ""


class LayerList(QWidget):
    """Edits which layers are shown, and how strongly.

    Signals
    -------
    changed(str, bool, float)
        Key of a layer, whether it is shown, and its opacity, 0 to 1.
    removed(str)
        Key of a layer that is to go.
    """

    changed = Signal(str, bool, float)
    removed = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._rows: tuple[LayerRow, ...] = ()
        self._boxes: dict[str, tuple[QCheckBox, QSlider]] = {}
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(6)
        self._grid.setVerticalSpacing(0)
        self._grid.setColumnStretch(0, 1)

    def value(self) -> tuple[LayerRow, ...]:
        """The layers as they are shown, the topmost first."""
        return self._rows

    def setValue(self, rows: Sequence[LayerRow]) -> None:  # noqa: N802
        """Show layers; those that are there already keep their widgets, so that a slider under the hand stays."""
        before, self._rows = self._rows, tuple(rows)
        if [_fixed(row) for row in before] != [_fixed(row) for row in self._rows]:
            self._build()
        for row in self._rows:
            box, slider = self._boxes[row.key]
            for widget in (box, slider):
                widget.blockSignals(True)
            box.setChecked(row.is_visible)
            slider.setValue(round(100.0 * row.opacity))
            slider.setEnabled(row.is_visible)
            for widget in (box, slider):
                widget.blockSignals(False)

    def boxes(self, key: str) -> tuple[QCheckBox, QSlider]:
        """Check box and slider of a layer."""
        return self._boxes[key]

    def _build(self) -> None:
        while (item := self._grid.takeAt(0)) is not None:
            widget = item.widget()
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        self._boxes.clear()
        for number, row in enumerate(self._rows):
            box = QCheckBox(row.title)
            box.setToolTip(row.tip or self.tr("Show or hide {0}").format(row.title))
            box.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            box.setMinimumWidth(110)
            if row.colour:
                swatch = QPixmap(SWATCH_PX, SWATCH_PX)
                swatch.fill(QColor(row.colour))
                box.setIcon(QIcon(swatch))
                box.setIconSize(QSize(SWATCH_PX, SWATCH_PX))
            slider = QSlider(Qt.Orientation.Horizontal)
            slider.setRange(round(100.0 * FAINTEST), 100)
            slider.setFixedWidth(SLIDER_PX)
            slider.setToolTip(self.tr("Translucent to the left, opaque to the right"))
            slider.setAccessibleName(self.tr("Opacity of {0}").format(row.title))
            box.toggled.connect(lambda checked, key=row.key: self._edited(key, is_visible=checked))
            slider.valueChanged.connect(lambda value, key=row.key: self._edited(key, opacity=value / 100.0))
            self._boxes[row.key] = box, slider
            self._grid.addWidget(box, 2 * number, 0)
            self._grid.addWidget(slider, 2 * number, 1)
            if row.note:
                note = QLabel(row.note)
                note.setWordWrap(True)
                note.setProperty("role", "muted")
                self._grid.addWidget(note, 2 * number + 1, 0, 1, 2)
                note.show()
            # Qt shows them by itself only later, and until then the list has no size.
            box.show()
            slider.setVisible(row.can_fade)
            if row.can_remove:
                remove = QToolButton()
                remove.setText("×")
                remove.setToolTip(self.tr("Remove {0} from the map; the file stays").format(row.title))
                remove.clicked.connect(lambda _checked=False, key=row.key: self.removed.emit(key))
                self._grid.addWidget(remove, 2 * number, 2)
                remove.show()

    def _edited(self, key: str, *, is_visible: bool | None = None, opacity: float | None = None) -> None:
        rows = []
        for row in self._rows:
            if row.key == key:
                row = replace(
                    row,
                    is_visible=row.is_visible if is_visible is None else is_visible,
                    opacity=row.opacity if opacity is None else opacity,
                )
                self._boxes[key][1].setEnabled(row.is_visible)
                edited = row
            rows.append(row)
        self._rows = tuple(rows)
        self.changed.emit(key, edited.is_visible, edited.opacity)


def _fixed(row: LayerRow) -> LayerRow:
    """A row without what the user edits in it."""
    return replace(row, is_visible=True, opacity=1.0)


class LayerPanel(QFrame):
    """A layer list with a heading, on a plate that lies over a view; further widgets come below it."""

    def __init__(self, heading: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.list = LayerList()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self.setCursor(Qt.CursorShape.ArrowCursor)
        title = QLabel(heading)
        title.setProperty("role", "heading")
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(self.list)
        self._area = area
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(8, 6, 8, 6)
        self._layout.setSpacing(4)
        title.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self._layout.addWidget(title)
        self._layout.addWidget(area, 1)
        self.setFixedWidth(280)

    def add(self, widget: QWidget) -> None:
        """Put a widget below the list."""
        self._layout.addWidget(widget)

    def setValue(self, rows: Sequence[LayerRow]) -> None:  # noqa: N802
        """Show layers, as high as they need, and no higher than the view lets them be."""
        self.list.setValue(rows)
        height = self.list.sizeHint().height() + 4
        self._area.setMinimumHeight(min(height, LEAST_PX))
        self._area.setMaximumHeight(height)

    def wanted_px(self) -> int:
        """Height at which the whole list is seen."""
        least, most = self._area.minimumHeight(), self._area.maximumHeight()
        return self.sizeHint().height() - min(max(self._area.sizeHint().height(), least), most) + most
