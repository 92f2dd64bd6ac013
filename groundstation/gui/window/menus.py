"""The menus: project, undo and redo, how the window looks, the shown tab's own actions, and help with all shortcuts."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Protocol

from PySide6.QtCore import QObject, Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QMenu, QMessageBox

from groundstation import __version__
from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.shared_view import SharedViewPage
from groundstation.gui.window.main_window import MainWindow
from groundstation.services.plugins import plugin_rows
from groundstation.services.settings import Language, Settings, Theme
from groundstation.services.units import UnitSystem
from planning.base.plugins import PluginGroup

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

    def open_map_tiles(self) -> None:
        """Ask for a file with map tiles."""

    def settings(self) -> Settings:
        """As they are."""

    def choose(self, **changes: object) -> None:
        """Change settings by name."""


class Menus(QObject):
    """Fills the menu bar of a window."""

    def __init__(self, window: MainWindow, workspace: ApplicationContext, commands: Commands) -> None:
        super().__init__(window)
        self._window, self._workspace, self._commands = window, workspace, commands
        bar = window.menuBar()
        self._project_menu(bar.addMenu(self.tr("&Project")))
        self._edit_menu(bar.addMenu(self.tr("&Edit")))
        self._view_menu(bar.addMenu(self.tr("&View")))
        self._go_menu(bar.addMenu(self.tr("&Go")))
        self._tab_menu = bar.addMenu("")
        self._help_menu(bar.addMenu(self.tr("&Help")))
        for action, text in (
            (self._undo, self.tr("Undo")),
            (self._redo, self.tr("Redo")),
            (self._save, self.tr("Save")),
        ):
            action.setIconText(text)
        window.add_quick_actions((self._undo, self._redo, self._save))
        window.tabShown.connect(self._fill_tab_menu)
        workspace.documentChanged.connect(self._update)
        self._update()

    def _add(
        self,
        menu: QMenu,
        text: str,
        shortcut: QKeySequence.StandardKey | str,
        slot: Callable[[], None],
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
        session = self._workspace.session
        self._undo = self._add(menu, self.tr("&Undo"), QKeySequence.StandardKey.Undo, session.undo)
        self._redo = self._add(menu, self.tr("&Redo"), "Ctrl+Shift+Z", session.redo)

    def _view_menu(self, menu: QMenu) -> None:
        look, choose = self._commands.settings(), self._commands.choose
        for page, text, key in (
            (SharedViewPage.SCENE, self.tr("&3-D view"), "F5"),
            (SharedViewPage.MAP, self.tr("&Map"), "F6"),
            (SharedViewPage.CAMERA, self.tr("&Camera preview"), "F7"),
        ):
            self._add(menu, text, key, lambda page=page: self._window.stage.show_page(page))
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
        for name, title, entries, now in (
            ("theme", self.tr("&Theme"), themes, look.theme),
            ("units", self.tr("&Units"), units, look.units),
            ("text_scale", self.tr("Te&xt size"), scales, look.text_scale),
            ("language", self.tr("&Language"), languages, look.language),
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
        for number, spec in enumerate(self._window.specs(), 1):
            name = spec.name
            self._add(menu, spec.shown_title(), f"Ctrl+{number}", lambda name=name: self._window.show_tab(name))

    def _help_menu(self, menu: QMenu) -> None:
        self._add(menu, self.tr("&Shortcuts"), "F1", self.show_shortcuts)
        self._add(menu, self.tr("&About Reflight"), "", self._show_about)

    def _fill_tab_menu(self, name: str) -> None:
        tab = self._window.tab(name)
        self._tab_menu.clear()
        self._tab_menu.setTitle(next(spec.shown_title() for spec in self._window.specs() if spec.name == name))
        for action in tab.actions():
            self._tab_menu.addAction(action)
        self._tab_menu.menuAction().setVisible(bool(tab.actions()))

    def _list_recent(self) -> None:
        self._recent.clear()
        for folder in self._commands.settings().recent_projects:
            self._add(self._recent, folder, "", lambda folder=folder: self._commands.open_recent(folder))
        if self._recent.isEmpty():
            self._recent.addAction(self.tr("none yet")).setEnabled(False)

    def _update(self) -> None:
        session = self._workspace.session
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
        from groundstation.gui.window.shortcuts import ShortcutsDialog

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
                line += "<br>" + escape(self._workspace.words(str(row.problem)))
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
