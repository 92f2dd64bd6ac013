"""Brings a site into the document: from a site file, from the sites that come with the program, or by import."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.questions import choose_file
from groundstation.services.project.folder import facades_beside
from groundstation.services.site.sources import bundled_site, open_site, with_new_site
from planning.base.findings import Severity
from planning.site.bundled import SCENES
from planning.site.importing.importer import SUFFIXES
from planning.site.records import SiteModel
from reconstruction.panels.solving.accuracy import FoundFacades

if TYPE_CHECKING:
    from groundstation.gui.site.import_dialog import ImportDialog


class SiteOpener(QObject):
    """The three ways to a site; each is one step that can be undone."""

    def __init__(self, workspace: ApplicationContext, window: QWidget) -> None:
        super().__init__(window)
        self._workspace, self._window = workspace, window

    def choose_site(self) -> None:
        """Ask for a site file and open it."""
        path = choose_file(self._window, self.tr("Open site"), self.tr("Sites (*.json);;All files (*)"))
        if path is not None:
            self.open_site(path)

    def choose_import(self) -> None:
        """Ask for a building model and look at it."""
        kinds = " ".join(f"*{suffix}" for suffix in SUFFIXES)
        kinds = self.tr("Building models ({0});;All files (*)").format(kinds)
        path = choose_file(self._window, self.tr("Import a building model"), kinds)
        if path is not None:
            self.import_site(path)

    def open_site(self, path: Path) -> None:
        """Open a site file."""
        label = self.tr("Open {0}").format(path.name)
        self._workspace.start(
            label,
            lambda context: (open_site(path, context), facades_beside(path)),
            lambda found: self._take(label, *found),
        )

    def open_bundled(self, name: str) -> None:
        """Open one of the sites that come with the program."""
        label = self.tr("Open {0}").format(name)
        self._workspace.start(label, lambda _context: bundled_site(name), lambda model: self._take(label, model))

    def import_site(self, path: Path) -> ImportDialog:
        """Look at a building model, and import it if the user wants that."""
        from groundstation.gui.site.import_dialog import ImportDialog

        dialog = ImportDialog(self._workspace, path, self._window.window())
        dialog.imported.connect(lambda model: self._take(self.tr("Import {0}").format(path.name), model))
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()
        return dialog

    def bundled_menu(self, parent: QWidget) -> QMenu:
        """The sites that come with the program, each with what it is."""
        menu = QMenu(parent)
        texts = {
            "office": self.tr("Office: one flat facade of 280 panels"),
            "library": self.tr("Library: one curved facade of 300 panels"),
            "court": self.tr("Court: two wings that hide each other"),
            "canyon": self.tr("Canyon: a facade on a narrow street"),
            "roof": self.tr("Roof: horizontal skylights"),
            "tower": self.tr("Tower: 3 640 panels on four sides"),
            "single-panel": self.tr("A single panel"),
        }
        for name in SCENES:
            action = QAction(texts.get(name, name), menu)
            action.triggered.connect(lambda _checked=False, name=name: self.open_bundled(name))
            menu.addAction(action)
        return menu

    def _take(self, label: str, model: SiteModel, facades: FoundFacades | None = None) -> None:
        before = self._workspace.document
        self._workspace.change(label, with_new_site(before, model, facades))
        self._workspace.select(None)
        site = model.site
        self._workspace.say(
            Severity.OK, self.tr("{0}: panels {1}, facades {2}").format(site.name, site.n_panels, len(site.facades))
        )
        if before.plans:
            self._workspace.say(
                Severity.NOTE,
                self.tr("The plans of the site before are removed with it: {0}. Undo brings them back.").format(
                    len(before.plans)
                ),
            )
