"""Help: the manual, and the tour through the window.

The manual has a window of its own: contents and search beside the page, with links and pictures, offline. The tour is a
card that goes from part to part of the window and says what each is for; it can be left at any time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QSize, Qt, QUrl, Signal
from PySide6.QtGui import (
    QColor,
    QDesktopServices,
    QImage,
    QKeyEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QTextCursor,
    QTextDocument,
)
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QTextBrowser,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.icons import set_icon
from groundstation.gui.widgets.scrolling import split
from groundstation.gui.widgets.theme import colours
from groundstation.services.glossary import TERMS
from groundstation.services.manual import FIRST, anchor, chapters, found_in, manual_folder, page_part
from planning.base.errors import InputError
from planning.base.searching import folded

SIDE_PX, PAGE_PX, HIGH_PX = 260, 720, 640

MARGIN_PX = 24
"""Of a page beside its pictures."""

GLOSSARY = "glossary"
"""The page of terms, which is made of the same record that the "?" show."""


class ManualPage(QTextBrowser):
    """Shows pages; pictures are as wide as the page at most."""

    def __init__(self, folder: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._folder = folder
        self.name = ""
        self.setOpenLinks(False)

    def show_page(self, name: str, text: str, heading: str = "") -> None:
        """Show a page by its name in the folder, from a heading on."""
        self.name = name
        document = self.document()
        document.setBaseUrl(QUrl.fromLocalFile(str((self._folder / name).parent) + "/"))
        self.setMarkdown(text)
        self.moveCursor(QTextCursor.MoveOperation.Start)
        if heading:
            self._go_to(heading)

    def loadResource(self, kind: int, url: QUrl | str) -> object:  # noqa: N802
        """A picture of the folder, scaled to the page; nothing from elsewhere."""
        if kind != QTextDocument.ResourceType.ImageResource.value:
            return None
        path = Path(self.document().baseUrl().resolved(QUrl(url)).toLocalFile())
        if not path.is_file():
            return None
        widest = max(200, self.viewport().width() - 2 * MARGIN_PX)
        picture = _drawn(path, widest) if path.suffix == ".svg" else QImage(str(path))
        if picture.width() > widest:
            picture = picture.scaledToWidth(widest, Qt.TransformationMode.SmoothTransformation)
        return picture

    def _go_to(self, heading: str) -> None:
        block = self.document().begin()
        while block.isValid():
            if block.blockFormat().headingLevel() and anchor(block.text()) == heading:
                cursor = QTextCursor(block)
                self.setTextCursor(cursor)
                bar = self.verticalScrollBar()
                bar.setValue(bar.value() + self.cursorRect(cursor).top())
                return
            block = block.next()


class ManualWindow(QWidget):
    """The manual; it stands beside the main window and asks nothing."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self._context = context
        self._folder = manual_folder()
        self._before: list[str] = []
        self._place = ""
        self.setWindowTitle(self.tr("Manual"))
        self.tree, self.search, self.page = QTreeWidget(), QLineEdit(), ManualPage(self._folder)
        self.back = QPushButton(self.tr("Back"))
        self.tree.setHeaderHidden(True)
        self.tree.setAccessibleName(self.tr("Contents of the manual"))
        self.page.setAccessibleName(self.tr("Page of the manual"))
        self.search.setPlaceholderText(self.tr("Search the manual"))
        self.search.setAccessibleName(self.tr("Search the manual"))
        self.search.setClearButtonEnabled(True)
        set_icon(self.back, "undo")
        self.back.setEnabled(False)
        side = QWidget()
        column, row = QVBoxLayout(side), QHBoxLayout()
        column.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.search, 1)
        row.addWidget(self.back)
        column.addLayout(row)
        column.addWidget(self.tree, 1)
        layout = QVBoxLayout(self)
        layout.addWidget(split((side, self.page), (SIDE_PX, PAGE_PX), 1))
        screen = self.screen().availableGeometry()
        self.resize(QSize(SIDE_PX + PAGE_PX, HIGH_PX).boundedTo(screen.size()))
        self._list_contents()
        self.tree.currentItemChanged.connect(self._chosen)
        self.search.textChanged.connect(self._search)
        self.page.anchorClicked.connect(self._follow)
        self.back.clicked.connect(self._go_back)

    def open_page(self, place: str = FIRST) -> None:
        """Show a page, such as `guide/plan.md#ask-for-a-plan`, and come to the front."""
        self._show_page(place)
        self.show()
        self.raise_()
        self.activateWindow()

    def _show_page(self, place: str, *, is_back: bool = False) -> None:
        name, _, heading = place.partition("#")
        try:
            text = self._glossary() if name == GLOSSARY else self._text(name, heading)
        except InputError as error:
            text = self._context.localized(str(error))
        if not is_back and self._place:
            self._before.append(self._place)
        self._place = place
        self.back.setEnabled(bool(self._before))
        self.page.show_page(name, text, heading)
        self._mark(name)

    def _text(self, name: str, heading: str) -> str:
        """A page, or the part of a long one with a heading; above it the way to its other parts."""
        text, parts = page_part(self._folder / name, heading)
        if not parts:
            return text
        links = " \u00b7 ".join(f"[{title}](#{mark})" for mark, title in parts)
        return f"{links}\n\n{text}"

    def _glossary(self) -> str:
        """All terms, as Markdown."""
        words = self._context.localized
        more = self.tr("More")
        parts = [f"# {self.tr('Words')}"]
        for term in sorted(TERMS, key=lambda term: folded(words(term.name))):
            parts.append(f"**{words(term.name)}** {words(term.says)} [{more}]({term.page})")
        return "\n\n".join(parts)

    def _list_contents(self) -> None:
        self.tree.clear()
        self._add(self.tree.invisibleRootItem(), self.tr("Words"), GLOSSARY)
        try:
            found = chapters(self._folder)
        except InputError as error:
            self.page.setHtml(f"<p>{escape(self._context.localized(str(error)))}</p>")
            return
        for chapter in found:
            above = self._add(self.tree.invisibleRootItem(), chapter.title, "")
            for name, title in chapter.pages:
                self._add(above, title, name)
        self.tree.expandToDepth(0)

    def _add(self, above: QTreeWidgetItem, text: str, name: str) -> QTreeWidgetItem:
        item = QTreeWidgetItem(above, [text])
        item.setData(0, Qt.ItemDataRole.UserRole, name)
        return item

    def _mark(self, name: str) -> None:
        """Show in the contents which page stands there."""
        for item in self.tree.findItems("*", Qt.MatchFlag.MatchWildcard | Qt.MatchFlag.MatchRecursive):
            if item.data(0, Qt.ItemDataRole.UserRole) == name:
                self.tree.blockSignals(True)
                self.tree.setCurrentItem(item)
                self.tree.blockSignals(False)
                return

    def _chosen(self, item: QTreeWidgetItem | None) -> None:
        name = "" if item is None else item.data(0, Qt.ItemDataRole.UserRole)
        if name:
            self._show_page(name)

    def _search(self, words: str) -> None:
        if not words.strip():
            self._list_contents()
            self._mark(self.page.name)
            return
        self.tree.blockSignals(True)
        self.tree.clear()
        for name, title in found_in(self._folder, words):
            self._add(self.tree.invisibleRootItem(), title, name)
        if self.tree.topLevelItemCount() == 0:
            self._add(self.tree.invisibleRootItem(), self.tr("Nothing found."), "")
        self.tree.blockSignals(False)

    def _follow(self, url: QUrl) -> None:
        """Go where a link leads: to another page, or, if the user's browser is to be asked, to the network."""
        if url.scheme() in ("http", "https"):
            QDesktopServices.openUrl(url)
            return
        path = Path(self.page.document().baseUrl().resolved(QUrl(url.path())).toLocalFile()) if url.path() else None
        name = self.page.name if path is None else path.resolve().relative_to(self._folder.resolve()).as_posix()
        self._show_page(f"{name}#{url.fragment()}" if url.fragment() else name)

    def _go_back(self) -> None:
        if self._before:
            self._show_page(self._before.pop(), is_back=True)


def _drawn(path: Path, wide: int) -> QImage:
    """A drawing, as wide as the page."""
    from PySide6.QtSvg import QSvgRenderer

    drawing = QSvgRenderer(str(path))
    size = drawing.defaultSize()
    size.scale(min(wide, size.width()), 10_000, Qt.AspectRatioMode.KeepAspectRatio)
    picture = QImage(size, QImage.Format.Format_ARGB32_Premultiplied)
    picture.fill(Qt.GlobalColor.white)
    painter = QPainter(picture)
    drawing.render(painter)
    painter.end()
    return picture


CARD_PX, APART_PX, FRAME_PX = 360, 10, 3


@dataclass(frozen=True, slots=True)
class Stop:
    """One part of the window.

    Parameters
    ----------
    part
        Found when the tour comes there; None where it is not shown.
    """

    title: str
    says: str
    part: Callable[[], QWidget | None]


class Tour(QFrame):
    """The card, and a frame around what it speaks of.

    Signals
    -------
    ended()
        It came to its end, or was left.
    """

    ended = Signal()

    def __init__(self, window: QWidget, stops: Sequence[Stop]) -> None:
        super().__init__(window)
        self._window, self._stops, self._number = window, tuple(stops), 0
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.setAutoFillBackground(True)
        self._frame = _Frame(window)
        self._title, self._says, self._count = QLabel(), QLabel(), QLabel()
        self._title.setProperty("role", "heading")
        self._count.setProperty("role", "muted")
        self._says.setWordWrap(True)
        self.before, self.next, self.leave = QPushButton(self.tr("Back")), QPushButton(), QPushButton(self.tr("Leave"))
        self.next.setProperty("primary", True)
        buttons = QHBoxLayout()
        buttons.addWidget(self._count)
        buttons.addStretch(1)
        for button in (self.leave, self.before, self.next):
            buttons.addWidget(button)
        layout = QVBoxLayout(self)
        for label in (self._title, self._says):
            layout.addWidget(label)
        layout.addLayout(buttons)
        self.leave.clicked.connect(self.end)
        self.before.clicked.connect(lambda: self._go_to(self._number - 1))
        self.next.clicked.connect(lambda: self._go_to(self._number + 1))
        window.installEventFilter(self)

    def begin(self) -> None:
        """Show the first stop."""
        self.show()
        self._go_to(0)

    def end(self) -> None:
        """Go away."""
        self._window.removeEventFilter(self)
        self._frame.hide()
        self._frame.deleteLater()
        self.hide()
        self.ended.emit()
        self.deleteLater()

    def text(self) -> str:
        """What is said now."""
        return f"{self._title.text()}\n{self._says.text()}"

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Esc leaves the tour."""
        if event.key() == Qt.Key.Key_Escape:
            self.end()
        else:
            super().keyPressEvent(event)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Stay beside what it speaks of when the window changes its size."""
        if event.type() == QEvent.Type.Resize and self.isVisible():
            self._place()
        return super().eventFilter(watched, event)

    def _go_to(self, number: int) -> None:
        if number >= len(self._stops):
            self.end()
            return
        self._number = max(0, number)
        stop = self._stops[self._number]
        is_last = self._number == len(self._stops) - 1
        self._title.setText(stop.title)
        self._says.setText(stop.says)
        self._count.setText(f"{self._number + 1} / {len(self._stops)}")
        self.before.setEnabled(self._number > 0)
        self.next.setText(self.tr("Finish") if is_last else self.tr("Next"))
        self._place()
        self.next.setFocus()

    def _place(self) -> None:
        """Below what it speaks of where there is room, else above; always inside the window."""
        window, part = self._window.rect(), self._stops[self._number].part()
        self.setFixedWidth(min(CARD_PX + 4 * self.fontMetrics().averageCharWidth(), window.width() - 2 * APART_PX))
        self.adjustSize()
        around = QRect(window.center(), window.center())
        if part is not None and part.isVisible():
            around = QRect(part.mapTo(self._window, QPoint(0, 0)), part.size())
        self._frame.show_around(around if part is not None and part.isVisible() else QRect())
        if around.height() > window.height() // 2:
            self.move(window.center() - self.rect().center())
            self.raise_()
            return
        top = around.bottom() + APART_PX
        if top + self.height() > window.height():
            top = around.top() - self.height() - APART_PX
        top = max(APART_PX, min(top, window.height() - self.height() - APART_PX))
        left = max(APART_PX, min(around.left(), window.width() - self.width() - APART_PX))
        self.move(left, top)
        self.raise_()


class _Frame(QWidget):
    """A frame that lets every click through."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)

    def show_around(self, room: QRect) -> None:
        """Stand around a part of the window; nowhere for an empty one."""
        self.setVisible(not room.isEmpty())
        self.setGeometry(room.adjusted(-FRAME_PX, -FRAME_PX, FRAME_PX, FRAME_PX))
        self.raise_()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """The frame alone."""
        painter = QPainter(self)
        painter.setPen(QPen(QColor(colours().warning), FRAME_PX))
        half = FRAME_PX // 2 + 1
        painter.drawRect(self.rect().adjusted(half, half, -half, -half))
        painter.end()
