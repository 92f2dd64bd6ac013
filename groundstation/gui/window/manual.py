"""The manual in a window of its own: contents and search beside the page, with links and pictures, offline."""

from __future__ import annotations

from html import escape
from pathlib import Path

from PySide6.QtCore import QSize, Qt, QUrl
from PySide6.QtGui import QDesktopServices, QImage, QPainter, QTextCursor, QTextDocument
from PySide6.QtWidgets import (
    QHBoxLayout,
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
from groundstation.services.glossary import TERMS
from groundstation.services.manual import FIRST, anchor, chapters, found_in, manual_folder, page_part
from planning.base.errors import InputError

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
        for term in sorted(TERMS, key=lambda term: words(term.name).casefold()):
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
