"""Properties of what is selected, each in its editor; values that cannot be stay at their box with the reason."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtWidgets import QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.site.item_pages import FacadePage, ItemPage, NoFlyPage, ObstaclePage, PanelPage, RallyPage
from groundstation.gui.site.pages import SITE, AirspacePage, Edit, HomePage, Page, SitePage
from groundstation.gui.site.site_editor import SiteEditor
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.units import UnitSystem

PAGES: dict[ItemKind, Callable[[UnitSystem], Page]] = {
    ItemKind.BUILDING: SitePage,
    ItemKind.FACADE: FacadePage,
    ItemKind.PANEL: PanelPage,
    ItemKind.OBSTACLE: ObstaclePage,
    ItemKind.NO_FLY: NoFlyPage,
    ItemKind.AIRSPACE: AirspacePage,
    ItemKind.HOME: HomePage,
    ItemKind.RALLY: RallyPage,
}


class PropertyPanel(QWidget):
    """Shows the page of the selected thing; of the site where nothing of a site is selected."""

    def __init__(self, workspace: ApplicationContext, editor: SiteEditor, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._workspace, self._editor = workspace, editor
        self._pages: dict[ItemKind, Page] = {}
        self._shown: Page | None = None
        # No stack: it would be as tall as its tallest page.
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        workspace.documentChanged.connect(self._document_changed)
        workspace.selectionChanged.connect(self._show)
        workspace.unitsChanged.connect(self._set_units)
        self._show(workspace.selection)

    def page(self) -> Page | None:
        """The page that is shown."""
        return self._shown

    def focus_name(self) -> None:
        """Put the cursor into the name of what is selected."""
        page = self.page()
        if isinstance(page, ItemPage):
            page.name_box().setFocus()
            page.name_box().selectAll()

    def _show(self, item: Item | None) -> None:
        model = self._workspace.document.site
        if model is None:
            return
        shown = item if item is not None and item.kind in PAGES else SITE
        page = self._page(shown.kind)
        page.show_error("")
        if isinstance(page, PanelPage):
            page.set_found(self._workspace.document.found_facades)
        page.show_item(model, shown)
        for other in self._pages.values():
            other.setVisible(other is page)
        self._shown = page

    def _page(self, kind: ItemKind) -> Page:
        if kind not in self._pages:
            page = PAGES[kind](self._workspace.units)
            page.edited.connect(self._edit)
            self._pages[kind] = page
            self._layout.addWidget(page)
        return self._pages[kind]

    def _edit(self, label: str, edit: Edit, select: Item | None) -> None:
        page = self.page()
        error = self._editor.apply(label, edit, select)
        if page is not None:
            page.show_error(error)

    def _document_changed(self, before: Document, after: Document) -> None:
        if after.site is not before.site:
            self._show(self._workspace.selection)

    def _set_units(self, units: UnitSystem) -> None:
        for page in self._pages.values():
            page.set_units(units)
        self._show(self._workspace.selection)
