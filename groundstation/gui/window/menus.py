"""The menus: project, undo and redo, the window's looks, the shown tab's own actions, and help with all keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from html import escape
from typing import Protocol

from PySide6.QtCore import QCoreApplication, QObject, Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QMenu, QMessageBox, QTextBrowser, QVBoxLayout

from groundstation import __version__
from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import shown_keys
from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.tabs import TABS
from groundstation.gui.widgets.icons import NAME
from groundstation.gui.window.main_window import MainWindow
from groundstation.gui.window.next_step import NEXT_STEP_KEY
from groundstation.services.plugins import plugin_rows
from groundstation.services.settings import DrawnBy, Language, Settings, Theme
from groundstation.services.units import UnitSystem
from planning.base.plugins import PluginGroup

# All keys of the window (F1): those of menus and tabs, read from them, and those of views, listed here.
#
# Views take keys while they have the keyboard; each has a row here, and a test finds those that are missing.

Row = tuple[str, str]
"""Keys, and what they do."""


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
    for spec in TABS:
        rows = _rows(window.tab(spec.name).actions())
        if spec.name == "fly":
            from groundstation.gui.fly.fleet_box import N_KEYS, aircraft_keys  # imported with its tab

            aircraft = [shown_keys(QKeySequence(aircraft_keys(number))) for number in range(1, N_KEYS + 1)]
            rows.append((", ".join(aircraft), translate("Shortcuts", "Select the aircraft of this number")))
        if rows:
            found.append((translate("Shortcuts", "{0} tab").format(spec.shown_title()), rows))
    return found + view_keys()


def view_keys() -> list[tuple[str, list[Row]]]:
    """Keys of views, while they have the keyboard; a section each."""
    translate = QCoreApplication.translate
    arrows, enter = translate("Shortcuts", "Arrows"), translate("Shortcuts", "Enter")
    names = ("Ins", "Del", "Space", "PgUp", "PgDown", "Backspace", "Home")
    ins, gone, bar, page_up, page_down, back, home = (shown_keys(QKeySequence(name)) for name in names)
    shift = translate("Shortcuts", "with Shift")
    return [
        (
            translate("Shortcuts", "Buttons"),
            [(f"{enter}, {bar}", translate("Shortcuts", "Press the button that has the keyboard"))],
        ),
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
                ("Esc", translate("Shortcuts", "Pick no place")),
            ],
        ),
        (
            translate("Shortcuts", "Camera preview"),
            [(bar, translate("Shortcuts", "Fly through the sortie, or stop"))],
        ),
        (
            translate("Shortcuts", "Tree of the site"),
            [(gone, translate("Shortcuts", "Delete what is selected"))],
        ),
        (
            translate("Shortcuts", "Start, Return and Land"),
            [(f"{bar}, {enter}", translate("Shortcuts", "Hold for 0.7 s; the key of the Fly tab acts at once"))],
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
                (gone, translate("Shortcuts", "Delete the line, or the panel")),
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
        (translate("Shortcuts", "Tour"), [("Esc", translate("Shortcuts", "Leave the tour"))]),
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


TEXT_SCALES = (0.9, 1.0, 1.15, 1.3, 1.6)

LANGUAGES = {Language.SYSTEM: "", Language.ENGLISH: "English", Language.GERMAN: "Deutsch"}
"""Languages name themselves, so that they are found by those who read no other."""


class Commands(Protocol):
    """What the menus call; `groundstation.gui.window.project_controller` has it."""

    def new_project(self) -> None:
        """Start over."""

    def open_project(self) -> None:
        """Ask for a folder, and open it."""

    def open_recent(self, folder: str) -> None:
        """Open a project that was open before."""

    def save(self) -> None:
        """Save where the project is kept."""

    def save_as(self) -> None:
        """Ask for a folder, and save there."""

    def take_tour(self) -> None:
        """Show the window part by part."""

    def open_map_tiles(self) -> None:
        """Ask for a file with map tiles."""

    def settings(self) -> Settings:
        """As they are."""

    def choose(self, **changes: object) -> None:
        """Change settings by name."""


class Menus(QObject):
    """Fills the menu bar of a window."""

    def __init__(self, window: MainWindow, context: ApplicationContext, commands: Commands) -> None:
        super().__init__(window)
        self._window, self._context, self._commands = window, context, commands
        bar = window.menuBar()
        self._project_menu(bar.addMenu(self.tr("&Project")))
        self._edit_menu(bar.addMenu(self.tr("&Edit")))
        self._view_menu(bar.addMenu(self.tr("&View")))
        self._go_menu(bar.addMenu(self.tr("&Go")))
        self._tab_menu = bar.addMenu("")
        self._help_menu(bar.addMenu(self.tr("&Help")))
        for action, text, name in (
            (self._undo, self.tr("Undo"), "undo"),
            (self._redo, self.tr("Redo"), "redo"),
            (self._save, self.tr("Save"), "save"),
        ):
            action.setIconText(text)
            action.setProperty(NAME, name)
        window.add_quick_actions((self._undo, self._redo, self._save))
        window.tabShown.connect(self._fill_tab_menu)
        context.documentChanged.connect(self._update)
        self._update()

    def _add(
        self,
        menu: QMenu,
        text: str,
        shortcut: QKeySequence.StandardKey | str,
        slot: Callable[[], object],
        *,
        group: QActionGroup | None = None,
        checked: bool | None = None,
    ) -> QAction:
        action = QAction(text, self._window)
        if shortcut:
            action.setShortcut(QKeySequence(shortcut))
        if checked is not None:
            action.setCheckable(True)
            action.setChecked(checked)
        if group is not None:
            group.addAction(action)
        action.triggered.connect(lambda _checked=False: slot())
        menu.addAction(action)
        return action

    def _project_menu(self, menu: QMenu) -> None:
        key, commands = QKeySequence.StandardKey, self._commands
        self._add(menu, self.tr("&New project"), key.New, commands.new_project)
        self._add(menu, self.tr("&Open project ..."), key.Open, commands.open_project)
        self._recent = menu.addMenu(self.tr("Open &recent"))
        self._recent.aboutToShow.connect(self._list_recent)
        menu.addSeparator()
        self._save = self._add(menu, self.tr("&Save"), key.Save, commands.save)
        self._add(menu, self.tr("Save &as ..."), "Ctrl+Shift+S", commands.save_as)
        menu.addSeparator()
        self._add(menu, self.tr("&Quit"), "Ctrl+Q", lambda: (self._window.close(), None)[1])

    def _edit_menu(self, menu: QMenu) -> None:
        session = self._context.session
        self._undo = self._add(menu, self.tr("&Undo"), QKeySequence.StandardKey.Undo, session.undo)
        self._redo = self._add(menu, self.tr("&Redo"), "Ctrl+Shift+Z", session.redo)

    def _view_menu(self, menu: QMenu) -> None:
        look, choose = self._commands.settings(), self._commands.choose
        for page, text, key in (
            (SharedViewPage.SCENE, self.tr("&3-D view"), "F5"),
            (SharedViewPage.MAP, self.tr("&Map"), "F6"),
            (SharedViewPage.CAMERA, self.tr("&Camera preview"), "F7"),
        ):
            self._add(menu, text, key, partial(self._window.shared_view.show_page, page))
        menu.addSeparator()
        themes = {
            Theme.SYSTEM: self.tr("As the desktop"),
            Theme.LIGHT: self.tr("Light"),
            Theme.DARK: self.tr("Dark"),
            Theme.SUNLIGHT: self.tr("Bright sun"),
        }
        units = {UnitSystem.METRIC: self.tr("Metres"), UnitSystem.IMPERIAL: self.tr("Feet")}
        scales = {scale: f"{scale:.0%}" for scale in TEXT_SCALES}
        languages = {**LANGUAGES, Language.SYSTEM: self.tr("As the desktop")}
        drawn_by = {
            DrawnBy.AUTO: self.tr("What is faster"),
            DrawnBy.CARD: self.tr("Graphics card"),
            DrawnBy.PROCESSOR: self.tr("Processor"),
        }
        for name, title, entries, now in (
            ("theme", self.tr("&Theme"), themes, look.theme),
            ("units", self.tr("&Units"), units, look.units),
            ("text_scale", self.tr("Te&xt size"), scales, look.text_scale),
            ("language", self.tr("&Language"), languages, look.language),
            ("models_drawn_by", self.tr("Models drawn &by"), drawn_by, look.models_drawn_by),
        ):
            sub, group = menu.addMenu(title), QActionGroup(self)
            for value, text in entries.items():
                chosen = lambda name=name, value=value: choose(**{name: value})  # noqa: E731
                self._add(sub, text, "", chosen, group=group, checked=value == now)
        menu.addSeparator()
        self._add(menu, self.tr("Map &tiles ..."), "", self._commands.open_map_tiles)
        self._add(menu, self.tr("Copy all &messages"), "Ctrl+Shift+M", self._window.messages.copy_all)
        self._add(menu, self.tr("&Full screen"), "F11", self._toggle_full_screen)

    def _go_menu(self, menu: QMenu) -> None:
        for number, spec in enumerate(TABS):
            name = spec.name
            self._add(menu, spec.shown_title(), f"Ctrl+{number}", partial(self._window.lead_to, name))
        menu.addSeparator()
        self._add(menu, self.tr("Next &step"), NEXT_STEP_KEY, self._window.next_step.take)

    def _help_menu(self, menu: QMenu) -> None:
        self._add(menu, self.tr("&Manual"), "Ctrl+F1", self._window.open_manual)
        self._add(menu, self.tr("&Tour"), "", self._commands.take_tour)
        self._add(menu, self.tr("&Shortcuts"), "F1", self.show_shortcuts)
        self._add(menu, self.tr("&About Reflight"), "", self._show_about)

    def _fill_tab_menu(self, name: str) -> None:
        tab = self._window.tab(name)
        self._tab_menu.clear()
        self._tab_menu.setTitle(next(spec.shown_title() for spec in TABS if spec.name == name))
        for action in tab.actions():
            self._tab_menu.addAction(action)
        self._tab_menu.menuAction().setVisible(bool(tab.actions()))

    def _list_recent(self) -> None:
        self._recent.clear()
        for folder in self._commands.settings().recent_projects:
            self._add(self._recent, folder.replace("&", "&&"), "", partial(self._commands.open_recent, folder))
        if self._recent.isEmpty():
            self._recent.addAction(self.tr("none yet")).setEnabled(False)

    def _update(self) -> None:
        session = self._context.session
        for action, label, words in (
            (self._undo, session.undo_label, self.tr("&Undo")),
            (self._redo, session.redo_label, self.tr("&Redo")),
        ):
            action.setEnabled(bool(label))
            action.setText(f"{words} ({label})" if label else words)

    def _toggle_full_screen(self) -> None:
        if self._window.isFullScreen():
            self._window.showNormal()
        else:
            self._window.showFullScreen()

    def show_shortcuts(self) -> None:
        """A window with all keys."""
        dialog = ShortcutsDialog(self._window)
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.open()

    def _show_about(self) -> None:
        text = self.tr("Reflight {0}: ground station for the second flight over a glass facade.").format(__version__)
        self._box(self.tr("About Reflight"), f"<p>{text}</p>{self._plugins()}")

    def _plugins(self) -> str:
        """What plug-ins add, as a list; empty where there are none."""
        kinds = {
            PluginGroup.AIRCRAFT: self.tr("aircraft"),
            PluginGroup.MISSION_FORMATS: self.tr("mission format"),
            PluginGroup.MODEL_FORMATS: self.tr("model format"),
            PluginGroup.TRAINING_METHODS: self.tr("training method"),
        }
        lines = []
        for row in plugin_rows():
            line = escape(f"{row.plugin.name}: {kinds[row.plugin.group]} ({row.plugin.package})")
            if row.problem is not None:
                line += "<br>" + escape(self._context.localized(str(row.problem)))
            lines.append(f"<li>{line}</li>")
        title = self.tr("Plug-ins")
        return f"<p>{title}</p><ul>{''.join(lines)}</ul>" if lines else ""

    def _box(self, title: str, text: str) -> None:
        box = QMessageBox(self._window)
        box.setWindowTitle(title)
        box.setTextFormat(Qt.TextFormat.RichText)
        box.setText(text)
        box.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        box.open()
