"""All keys of the window (F1): those of menus and tabs, read from them, and those of views, listed here.

Views take keys while they have the keyboard; each has a row here, and a test finds those that are missing.
"""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QCoreApplication
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QMenu, QTextBrowser, QVBoxLayout

from groundstation.gui.application.languages import shown_keys
from groundstation.gui.window.main_window import MainWindow

Row = tuple[str, str]
"""Keys, and what they do."""

VIEWS = {
    "3-D view": ("view3d/navigator.py", "view3d/scene_view.py"),
    "Tools in the 3-D view": ("view3d/tool_driver.py",),
    "Map": ("map/map_canvas.py",),
    "Camera preview": ("camera_preview/preview.py", "camera_preview/photo_box.py"),
    "Tree of the site": ("site/site_tree.py",),
    "Photo strip of a flight": ("fly/photo_strip.py",),
    "Photos": ("photos/picture_view.py", "photos/grid_view.py"),
    "Models": ("reconstruct/model_view.py",),
    "Messages": ("window/message_area.py",),
}
"""Modules of the window that take keys by themselves, by the section that tells of them."""


class ShortcutsDialog(QDialog):
    """Says all keys, section by section; it scrolls where the screen is small."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self.setWindowTitle(self.tr("Shortcuts"))
        self._page = QTextBrowser()
        self._page.setHtml("".join(_section(title, rows) for title, rows in sections(window)))
        self._page.setAccessibleName(self.tr("Shortcuts"))
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok)
        buttons.accepted.connect(self.accept)
        layout = QVBoxLayout(self)
        layout.addWidget(self._page, 1)
        layout.addWidget(buttons)
        room = window.screen().availableGeometry()
        wide = 46 * self.fontMetrics().averageCharWidth()
        self.resize(min(2 * wide, room.width() - 40), min(window.height(), room.height() - 60))

    def text(self) -> str:
        """Everything it says."""
        return self._page.toPlainText()


def sections(window: MainWindow) -> list[tuple[str, list[Row]]]:
    """Keys of the menus, of each tab, and of each view, under titles."""
    translate = QCoreApplication.translate
    menus = [action.menu() for action in window.menuBar().actions()]
    shown = {action for name in window.tab_names() for action in window.tab(name).actions()}
    always = [action for menu in menus if isinstance(menu, QMenu) for action in _all_of(menu) if action not in shown]
    found = [(translate("Shortcuts", "Everywhere"), _rows(always))]
    found[0][1].append(("Tab", translate("Shortcuts", "To the next part of the window; with Shift to the one before")))
    for spec in window.specs():
        rows = _rows(window.tab(spec.name).actions())
        if rows:
            found.append((translate("Shortcuts", "{0} tab").format(spec.shown_title()), rows))
    return found + view_keys()


def view_keys() -> list[tuple[str, list[Row]]]:
    """Keys of views, while they have the keyboard; sections in the order of `VIEWS`."""
    translate = QCoreApplication.translate
    arrows, enter = translate("Shortcuts", "Arrows"), translate("Shortcuts", "Enter")
    names = ("Ins", "Del", "Space", "PgUp", "PgDown", "Backspace", "Home")
    ins, gone, bar, page_up, page_down, back, home = (shown_keys(QKeySequence(name)) for name in names)
    shift = translate("Shortcuts", "with Shift")
    return [
        (
            translate("Shortcuts", "3-D view"),
            [
                (arrows, translate("Shortcuts", "Turn")),
                ("+ = -", translate("Shortcuts", "Nearer, farther")),
                ("F", translate("Shortcuts", "Show everything")),
            ],
        ),
        (
            translate("Shortcuts", "Tools in the 3-D view"),
            [
                (arrows, translate("Shortcuts", "Move what is held by a step")),
                (f"{page_up}, {page_down}", translate("Shortcuts", "Nearer to the facade, farther from it")),
                (enter, translate("Shortcuts", "Finish")),
                (back, translate("Shortcuts", "Take the last corner back")),
                ("Esc", translate("Shortcuts", "Put the tool away")),
            ],
        ),
        (
            translate("Shortcuts", "Map"),
            [
                (arrows, translate("Shortcuts", "Shift")),
                ("+ = -", translate("Shortcuts", "Nearer, farther")),
                ("F", translate("Shortcuts", "Show everything")),
            ],
        ),
        (
            translate("Shortcuts", "Camera preview"),
            [(bar, translate("Shortcuts", "Fly through the sortie, or stop"))],
        ),
        (
            translate("Shortcuts", "Tree of the site"),
            [(gone, translate("Shortcuts", "Remove what is selected"))],
        ),
        (
            translate("Shortcuts", "Photo strip of a flight"),
            [
                (arrows, translate("Shortcuts", "To the view before, to the next")),
                (f"{enter}, {bar}", translate("Shortcuts", "Show the view's place")),
            ],
        ),
        (
            translate("Shortcuts", "Photos"),
            [
                (arrows, translate("Shortcuts", "Move the line or choose the panel, else shift the picture")),
                (f"{arrows} {shift}", translate("Shortcuts", "Move the line by ten pixels")),
                ("+ -", translate("Shortcuts", "Nearer, farther")),
                ("0", translate("Shortcuts", "Show all of the photo")),
                ("Tab", translate("Shortcuts", "Choose the next line")),
                (gone, translate("Shortcuts", "Remove the line, or the panel")),
                (ins, translate("Shortcuts", "Add a line beside it, or put the panel back")),
                (bar, translate("Shortcuts", "The panel on or off")),
                (enter, translate("Shortcuts", "Leave the line where it is")),
                ("Esc", translate("Shortcuts", "Let go of the line or panel")),
            ],
        ),
        (
            translate("Shortcuts", "Models"),
            [
                (arrows, translate("Shortcuts", "Fly around what is in the middle")),
                (f"{arrows} {shift}", translate("Shortcuts", "Shift")),
                (translate("Shortcuts", "Ctrl and arrows"), translate("Shortcuts", "Look elsewhere")),
                ("W A S D E Q", translate("Shortcuts", "Fly: forward, left, back, right, up, down")),
                (f"+ = {page_up}, - {page_down}", translate("Shortcuts", "Nearer, farther")),
                (f"0, {home}", translate("Shortcuts", "Back to the first view")),
            ],
        ),
        (translate("Shortcuts", "Messages"), [("Esc", translate("Shortcuts", "Close the list"))]),
    ]


def _all_of(menu: QMenu) -> list[QAction]:
    """Entries of a menu and of those in it."""
    found = []
    for action in menu.actions():
        below = action.menu()
        found += _all_of(below) if isinstance(below, QMenu) else [action]
    return found


def _rows(actions: Iterable[QAction]) -> list[Row]:
    texts = {
        shown_keys(action.shortcut()): action.text().replace("&", "")
        for action in actions
        if not action.shortcut().isEmpty()
    }
    return list(texts.items())


def _section(title: str, rows: list[Row]) -> str:
    cell = '<td style="padding-right: 16px;">'
    lines = "".join(f"<tr>{cell}<b>{keys}</b></td>{cell}{words}</td></tr>" for keys, words in rows)
    return f"<h4>{title}</h4><table>{lines}</table>"
