"""What makes everything fit a small screen with large type: panels that scroll, rows that wrap, stacks of one page.

A window of 1280 x 720 pixels with text of 160 % has room for all of its buttons: none is ever pushed off the screen.
"""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QPoint, QRect, QSize, Qt, QTimer, Signal
from PySide6.QtGui import QFont, QFontMetricsF, QMouseEvent, QPainter, QPaintEvent, QTextLayout
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QLayoutItem,
    QScrollArea,
    QSizePolicy,
    QSplitter,
    QStackedWidget,
    QTabWidget,
    QWidget,
)

from groundstation.gui.widgets.terms import label_of
from groundstation.gui.widgets.theme import TOUCH_PX
from planning.base.findings import Severity

# A text in few lines that pushes nothing away, and what severities are called.

N_LINES = 2
"""Lines at most; the list of messages has all of a text."""


class ShortText(QLabel):
    """A text in two lines at most, so that a long one pushes nothing away; the tool tip has all of it.

    Signals
    -------
    clicked()
    """

    clicked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)

    def setText(self, text: str) -> None:  # noqa: N802
        """Show a text."""
        super().setText(text)
        self.setToolTip(text)

    def sizeHint(self) -> QSize:  # noqa: N802
        """As high as its lines, whatever stands in it: nothing moves when a message comes."""
        return QSize(100, N_LINES * self.fontMetrics().lineSpacing())

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """The same."""
        return self.sizeHint()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """A click asks for more."""
        if event.button() == Qt.MouseButton.LeftButton:
            self.clicked.emit()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Break lines at words, and end in dots where there is more."""
        painter, metrics = QPainter(self), self.fontMetrics()
        lines = self._lines()
        top = max(0, (self.height() - len(lines) * metrics.lineSpacing()) // 2)
        for number, line in enumerate(lines):
            room = QRect(0, top + number * metrics.lineSpacing(), self.width(), metrics.lineSpacing())
            flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
            self.style().drawItemText(painter, room, flags, self.palette(), True, line, self.foregroundRole())
        painter.end()

    def _lines(self) -> list[str]:
        layout, text = QTextLayout(self.text(), self.font()), self.text()
        lines: list[str] = []
        layout.beginLayout()
        while len(lines) < N_LINES:
            line = layout.createLine()
            if not line.isValid():
                break
            line.setLineWidth(self.width())
            start = line.textStart()
            end = start + line.textLength()
            is_last = len(lines) == N_LINES - 1
            shown = text[start:] if is_last else text[start:end]
            lines.append(self.fontMetrics().elidedText(shown.strip(), Qt.TextElideMode.ElideRight, self.width()))
        layout.endLayout()
        return lines


FRAME_PX, TITLE_BAR_PX = 20, 40
"""Of windows, with some room."""


def resize_on_screen(window: QWidget, width_px: int, height_px: int) -> None:
    """Give a window a size, or what the screen has of it."""
    room = window.screen().availableGeometry()
    window.resize(min(width_px, room.width() - FRAME_PX), min(height_px, room.height() - TITLE_BAR_PX))


LEAST_SCALE = 0.6
"""Of letters that are made smaller for want of room."""


def fitted(font: QFont, text: str, room_px: float) -> tuple[QFont, str]:
    """A font in which a line has room, and the line: letters get smaller, and what is longer still ends in dots."""
    wide, least = QFontMetricsF(font).horizontalAdvance(text), LEAST_SCALE * font.pointSizeF()
    fitting = QFont(font)
    # Letters have whole pixels: half as large, they are not half as wide.
    while wide > room_px and fitting.pointSizeF() > least:
        fitting.setPointSizeF(max(least, fitting.pointSizeF() * min(0.97, room_px / wide)))
        wide = QFontMetricsF(fitting).horizontalAdvance(text)
    return fitting, QFontMetricsF(fitting).elidedText(text, Qt.TextElideMode.ElideRight, room_px)


class FittedLine(QLabel):
    """A line that is written smaller where it has no room; it makes nothing wider."""

    def __init__(self, text: str = "", parent: QWidget | None = None) -> None:
        super().__init__(text, parent)
        self.setTextFormat(Qt.TextFormat.PlainText)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Write it at the left, in its font or a smaller one."""
        painter, room = QPainter(self), self.contentsRect()
        font, text = fitted(self.font(), self.text(), room.width())
        painter.setFont(font)
        flags = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
        self.style().drawItemText(painter, room, flags, self.palette(), self.isEnabled(), text, self.foregroundRole())
        painter.end()


def severity_words() -> dict[Severity, str]:
    """Severities of messages in the user's language."""
    translate = QCoreApplication.translate
    return {
        Severity.ERROR: translate("MessageArea", "Error"),
        Severity.WARNING: translate("MessageArea", "Warning"),
        Severity.NOTE: translate("MessageArea", "Note"),
        Severity.OK: translate("MessageArea", "Done"),
    }


WIDEST_PX = 320
"""Width up to which what scrolls is shown whole; with the view beside it, that leaves room at 1280 pixels."""


class _SideArea(QScrollArea):
    """As wide as what is in it needs, up to `WIDEST_PX`."""

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Nothing is cut at the side; a bar comes for what is wider still."""
        hint, inside = super().minimumSizeHint(), self.widget()
        if inside is None:
            return hint
        wide = inside.minimumSizeHint().width() + self.verticalScrollBar().sizeHint().width()
        return QSize(min(WIDEST_PX, wide), hint.height())

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Hear of it when what is inside needs another width."""
        if watched is self.widget() and event.type() == QEvent.Type.LayoutRequest:
            self.updateGeometry()
        return super().eventFilter(watched, event)


def scroll_to(widget: QWidget) -> None:
    """Scroll what a widget stands in so that it is seen, once it has its place; where it is shown at all."""
    area = widget.parentWidget()
    while area is not None and not isinstance(area, QScrollArea):
        area = area.parentWidget()
    if isinstance(area, QScrollArea) and widget.isVisible():
        QTimer.singleShot(0, widget, lambda: area.ensureWidgetVisible(widget))


def scrolled(widget: QWidget) -> QScrollArea:
    """A widget in a frame that scrolls."""
    area = _SideArea()
    area.setWidget(widget)
    area.setWidgetResizable(True)
    # What is inside takes the keyboard, and the area follows it.
    area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    area.setFrameShape(QFrame.Shape.NoFrame)
    return area


class CurrentStack(QStackedWidget):
    """Pages of which one is shown, and only that one needs room: others may be wider than the screen has left."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.currentChanged.connect(lambda _index: self.updateGeometry())

    def sizeHint(self) -> QSize:  # noqa: N802
        """Of the page that is shown."""
        page = self.currentWidget()
        return super().sizeHint() if page is None else page.sizeHint()

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        """Of the page that is shown."""
        page = self.currentWidget()
        return super().minimumSizeHint() if page is None else _least_size(page)


class TabsCorner(QStackedWidget):
    """What stands beside the titles of a row of tabs, as wide as it wants, but the widest title keeps its room."""

    def __init__(self, tabs: QTabWidget) -> None:
        super().__init__(tabs)
        self._tabs = tabs
        tabs.setCornerWidget(self)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Up to what the widest title and the arrows beside it leave."""
        hint, bar = super().sizeHint(), self._tabs.tabBar()
        widest = max((bar.tabRect(number).width() for number in range(bar.count())), default=0)
        arrows = 0 if bar.count() < 2 else 2 * (TOUCH_PX - 4)
        return QSize(min(hint.width(), max(0, self._tabs.width() - widest - arrows)), hint.height())


class WrappingRow(QLayout):
    """Widgets beside each other, and in further rows where there is no room.

    `first_grows`: the first of each row takes what is left of it, so that the others stand at its end.
    """

    def __init__(self, parent: QWidget | None = None, *, first_grows: bool = False) -> None:
        super().__init__(parent)
        self._items: list[QLayoutItem] = []
        self._first_grows = first_grows
        self.setContentsMargins(0, 0, 0, 0)
        self.setSpacing(4)

    def addItem(self, item: QLayoutItem) -> None:  # noqa: N802
        """As layouts do."""
        self._items.append(item)

    def count(self) -> int:
        """As layouts do."""
        return len(self._items)

    def itemAt(self, index: int) -> QLayoutItem | None:  # noqa: N802
        """As layouts do."""
        return self._items[index] if 0 <= index < len(self._items) else None

    def takeAt(self, index: int) -> QLayoutItem | None:  # noqa: N802
        """As layouts do."""
        return self._items.pop(index) if 0 <= index < len(self._items) else None

    def expandingDirections(self) -> Qt.Orientation:  # noqa: N802
        """It takes no more room than it needs."""
        return Qt.Orientation(0)

    def hasHeightForWidth(self) -> bool:  # noqa: N802
        """The narrower, the more rows."""
        return True

    def heightForWidth(self, width: int) -> int:  # noqa: N802
        """Height of as many rows as it takes."""
        around = self.contentsMargins()
        room = QRect(0, 0, width - around.left() - around.right(), 0)
        return self._arrange(room, is_trial=True) + around.top() + around.bottom()

    def sizeHint(self) -> QSize:  # noqa: N802
        """All in one row."""
        hints = [item.sizeHint() for item in self._shown()]
        wide = sum(hint.width() for hint in hints) + self.spacing() * max(0, len(hints) - 1)
        return QSize(wide, max((hint.height() for hint in hints), default=0)).grownBy(self.contentsMargins())

    def minimumSize(self) -> QSize:  # noqa: N802
        """One below the other."""
        sizes = [item.minimumSize() for item in self._shown()]
        return QSize(
            max((size.width() for size in sizes), default=0), max((size.height() for size in sizes), default=0)
        ).grownBy(self.contentsMargins())

    def setGeometry(self, room: QRect) -> None:  # noqa: N802
        """Put everything where it goes."""
        super().setGeometry(room)
        self._arrange(room.marginsRemoved(self.contentsMargins()), is_trial=False)

    def _shown(self) -> list[QLayoutItem]:
        return [item for item in self._items if not item.isEmpty()]

    def _rows(self, width: int) -> list[list[tuple[QLayoutItem, QSize]]]:
        """What stands in each row, and its size."""
        rows: list[list[tuple[QLayoutItem, QSize]]] = []
        left = 0
        for item in self._shown():
            size = item.sizeHint()
            if size.width() > width:
                size.setWidth(max(width, item.minimumSize().width()))
                if item.hasHeightForWidth():
                    size.setHeight(item.heightForWidth(size.width()))
            if not rows or size.width() > left:
                rows.append([])
                left = width
            rows[-1].append((item, size))
            left -= size.width() + self.spacing()
        if self._first_grows:
            for row in rows:
                used = sum(size.width() for _, size in row) + self.spacing() * (len(row) - 1)
                first, size = row[0]
                size.setWidth(size.width() + max(0, width - used))
                if first.hasHeightForWidth():
                    size.setHeight(first.heightForWidth(size.width()))
        return rows

    def _arrange(self, room: QRect, *, is_trial: bool) -> int:
        y = room.y()
        for row in self._rows(room.width()):
            x, high = room.x(), max(size.height() for _, size in row)
            for item, size in row:
                if not is_trial:
                    item.setGeometry(QRect(QPoint(x, y), QSize(size.width(), high) if self._first_grows else size))
                x += size.width() + self.spacing()
            y += high + self.spacing()
        return max(0, y - self.spacing() - room.y())


class ButtonGrid(WrappingRow):
    """Buttons of equal width, in as many columns as have room for their words; those of each row fill it."""

    def __init__(self, n_columns: int = 2, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._n_columns = n_columns

    def sizeHint(self) -> QSize:  # noqa: N802
        """With all columns."""
        around = self.contentsMargins()
        wide = self._n_columns * (self._cell_px() + self.spacing()) - self.spacing() + around.left() + around.right()
        return QSize(wide, self.heightForWidth(wide))

    def _cell_px(self) -> int:
        return max((item.sizeHint().width() for item in self._shown()), default=0)

    def _rows(self, width: int) -> list[list[tuple[QLayoutItem, QSize]]]:
        items, gap = self._shown(), self.spacing()
        n_columns = max(1, min(self._n_columns, (width + gap) // (self._cell_px() + gap)))
        rows = [items[first : first + n_columns] for first in range(0, len(items), n_columns)]
        return [
            [(item, QSize((width - gap * (len(row) - 1)) // len(row), item.sizeHint().height())) for item in row]
            for row in rows
        ]


def labelled(title: str, box: QWidget) -> QWidget:
    """A box and its title beside it, as one thing of a row that wraps."""
    pair, label = QWidget(), label_of(title, box)
    label.setBuddy(box)
    row = QHBoxLayout(pair)
    row.setContentsMargins(0, 0, 0, 0)
    row.addWidget(label)
    row.addWidget(box, 1)
    return pair


def _least_size(widget: QWidget) -> QSize:
    """What a layout would give it at least."""
    hint = widget.minimumSizeHint().expandedTo(widget.minimumSize())
    return hint.boundedTo(widget.maximumSize())


def split(
    widgets: Sequence[QWidget],
    sizes_px: Sequence[int],
    growing: int,
    orientation: Qt.Orientation = Qt.Orientation.Horizontal,
) -> QSplitter:
    """Widgets beside or above each other; the `growing` one gets what the window has more than the first sizes."""
    splitter = QSplitter(orientation)
    for number, widget in enumerate(widgets):
        splitter.addWidget(widget)
        splitter.setStretchFactor(number, int(number == growing))
    splitter.setSizes(list(sizes_px))
    splitter.setChildrenCollapsible(False)
    return splitter


def padded(content: QWidget) -> QWidget:
    """A page with room around what it shows."""
    page = QWidget()
    layout = QHBoxLayout(page)
    layout.setContentsMargins(6, 6, 6, 6)
    layout.addWidget(content)
    return page
