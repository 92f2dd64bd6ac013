"""The two sides of the Site tab, and how tree, tools, properties and findings work together."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QColor
from PySide6.QtWidgets import QLabel, QListWidget, QListWidgetItem, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.application.translate import translated
from groundstation.gui.shared_view import SharedView
from groundstation.gui.site.grid_form import GridController, GridForm
from groundstation.gui.site.pages import (
    SITE,
    AirspacePage,
    Edit,
    FacadePage,
    HomePage,
    ItemPage,
    NoFlyPage,
    ObstaclePage,
    Page,
    PanelPage,
    RallyPage,
    SitePage,
)
from groundstation.gui.site.site_editor import SiteEditor
from groundstation.gui.site.site_opener import SiteOpener
from groundstation.gui.site.site_tools import SiteTool, SiteTools
from groundstation.gui.site.site_tree import SiteTree
from groundstation.gui.site.terrain_dialog import TerrainDialog
from groundstation.gui.widgets.scrolling import ButtonGrid, CurrentStack, scrolled
from groundstation.gui.widgets.theme import colours
from groundstation.gui.widgets.value_boxes import FormColumn, NameBox, muted
from groundstation.services.project.document import Document, Item, ItemKind
from groundstation.services.project.steps import Act
from groundstation.services.site.zones import not_here, permit, remove_zones, zone_facts
from groundstation.services.units import UnitSystem, length_unit
from planning.base.findings import Finding, Severity
from planning.checks.zones import source_text
from planning.site.records import SiteModel
from planning.site.zones.keep_out import known_files, near_zones


class ZonePage(Page):
    """A geo-zone: what it asks for, from which source, the pilot's authorisation, and who says that it is not here."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._item: Item | None = None
        self._zone_id = self._file = ""
        self._facts, self._source = QLabel(), muted("")
        self._facts.setWordWrap(True)
        self._reference = NameBox()
        self._reference.setPlaceholderText(self.tr("number and date"))
        self._answer = NameBox()
        self._answer.setPlaceholderText(self.tr("who said so, and when"))
        about = self.tr(
            "Where the file leaves open where this zone lies: plans keep out of what can be read of it, and the rest "
            "of it no longer holds up flights."
        )
        self._unsure = FormColumn()
        self._unsure.add(self._answer, muted(about), title=self.tr("Not here, according to"))
        self.add(self._facts, title=self.tr("Geo-zone"))
        self.add(self._reference, title=self.tr("Authorisation"))
        self.add(
            muted(
                self.tr("With an authorisation plans may enter all of this zone. It holds for this state of the file.")
            ),
            self._unsure,
            self._error,
        )
        self.add(self._source, title=self.tr("Source"))
        self._reference.valueChanged.connect(self._permit)
        self._answer.valueChanged.connect(self._say_not_here)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a zone."""
        near = next(found for found in near_zones(model) if found.key == item.id)
        self._item, self._zone_id, self._file = item, near.local.zone.id, near.source.file
        distance_m = near.local.distance_m
        away = self.tr("{0} from the airspace").format(length_unit(self._units).text(distance_m))
        if not math.isfinite(distance_m):
            away = self.tr("Its place is not known.")
        elif distance_m <= 0.0:
            away = self.tr("It reaches over the airspace.")
        lines = [translated(line, self._units) for line in zone_facts(near)]
        self._facts.setText("\n".join([*lines, away]))
        known = next(found for found in known_files(model) if found.source is near.source)
        self._source.setText(translated(source_text(known), self._units))
        self._reference.setValue(near.permitted)
        self._answer.setValue(near.not_here)
        self._unsure.setVisible(near.local.is_unsure or bool(near.not_here))

    def text(self) -> str:
        """What is said of the zone."""
        return self._facts.text()

    def reference_box(self) -> NameBox:
        """Editor of the authorisation."""
        return self._reference

    def answer_box(self) -> NameBox:
        """Editor of who says that what cannot be read of the zone is not here."""
        return self._answer

    def _say_not_here(self, reference: str) -> None:
        if self._item is not None:
            edit = partial(not_here, zone_id=self._zone_id, reference=reference, file=self._file)
            self.edited.emit(self.tr("Answer for {0}").format(self._zone_id), edit, self._item)

    def _permit(self, reference: str) -> None:
        if self._item is not None:
            edit = partial(permit, zone_id=self._zone_id, reference=reference, file=self._file)
            self.edited.emit(self.tr("Authorisation for {0}").format(self._zone_id), edit, self._item)


class ZoneFilePage(Page):
    """A file of geo-zones: format, publisher, dates, and its problem where it has one."""

    def __init__(self, units: UnitSystem, parent: QWidget | None = None) -> None:
        super().__init__(units, parent)
        self._file = ""
        self._facts = QLabel()
        self._facts.setWordWrap(True)
        remove = QPushButton(self.tr("Remove this file"))
        remove.clicked.connect(self._remove)
        self.add(self._facts, title=self.tr("File of geo-zones"))
        self.add(remove, self._error)

    def show_item(self, model: SiteModel, item: Item) -> None:
        """Show a file."""
        self._file = item.id
        known = next(found for found in known_files(model) if found.source.file == item.id)
        lines = [translated(source_text(known), self._units)]
        if known.content is None or known.local is None:
            lines.append(translated(known.problem, self._units))
        else:
            lines.append(
                self.tr("Zones: {0}, near the site: {1}").format(len(known.content.zones), len(known.local.near))
            )
        self._facts.setText("\n".join([*lines, f"SHA-256 {known.source.sha256[:16]}"]))

    def text(self) -> str:
        """What is said of the file."""
        return self._facts.text()

    def _remove(self) -> None:
        edit = partial(remove_zones, name=self._file)
        self.edited.emit(self.tr("Remove {0}").format(self._file), edit, Item(ItemKind.BUILDING))


# What the check of the site found, one line each; a click shows the place.


def item_of(finding: Finding) -> Item | None:
    """What a finding of `site_findings` is about: "home", "facade/A"."""
    kind, _, name = finding.place.partition("/")
    return Item(ItemKind(kind), name) if kind in set(ItemKind) else None


class FindingsList(QWidget):
    """Shows findings.

    Signals
    -------
    chosen(Item)
        The user wants to see what a finding is about.
    """

    chosen = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._title, self._list = QLabel(), QListWidget()
        self._title.setWordWrap(True)
        self._list.setWordWrap(True)
        self._list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.itemClicked.connect(self._choose)
        self._findings: tuple[Finding, ...] = ()
        self._units = UnitSystem.METRIC
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._title)
        layout.addWidget(self._list)
        self.set_findings(None)

    def set_findings(self, findings: tuple[Finding, ...] | None) -> None:
        """Show findings; None while there are none of the site as it is."""
        self._shown, self._findings = findings, findings or ()
        self._list.clear()
        self._list.setVisible(bool(findings))
        worst = {finding.severity for finding in self._findings}
        role = "muted" if findings is None else "ok"
        if worst:
            role = "error" if Severity.ERROR in worst else "warning"
        self._title.setProperty("role", role)
        self._title.style().unpolish(self._title)
        self._title.style().polish(self._title)
        if findings is None:
            self._title.setText(self.tr("The site is being checked ..."))
        elif not findings:
            self._title.setText(self.tr("All checks passed: home, airspace, facades."))
        else:
            self._title.setText(self.tr("The site's check found: {0}").format(len(findings)))
        look = {Severity.ERROR: colours().error, Severity.WARNING: colours().warning}
        words = {Severity.ERROR: self.tr("Error"), Severity.WARNING: self.tr("Warning"), Severity.NOTE: self.tr("Note")}
        for finding in self._findings:
            row = QListWidgetItem(f"{words.get(finding.severity, '')}: {translated(finding.message, self._units)}")
            row.setForeground(QColor(look.get(finding.severity, colours().text)))
            row.setSizeHint(QSize(0, self._height(row.text())))
            self._list.addItem(row)
        # As tall as its rows: the column that it stands in scrolls.
        self._list.setFixedHeight(sum(self._list.item(k).sizeHint().height() for k in range(self._list.count())) + 6)

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        if units is not self._units:
            self._units = units
            self.set_findings(self._shown)

    def findings(self) -> tuple[Finding, ...]:
        """What is shown."""
        return self._findings

    def _height(self, text: str) -> int:
        """Height of a wrapped row; the list itself reckons with one line."""
        width = max(200, self.width() - 40)
        flags = Qt.TextFlag.TextWordWrap
        return int(self.fontMetrics().boundingRect(0, 0, width, 4000, flags, text).height()) + 14

    def _choose(self, row: QListWidgetItem) -> None:
        item = item_of(self._findings[self._list.row(row)])
        if item is not None:
            self.chosen.emit(item)


# Properties of what is selected, each in its editor; values that cannot be stay at their box with the reason.

PAGES: dict[ItemKind, Callable[[UnitSystem], Page]] = {
    ItemKind.BUILDING: SitePage,
    ItemKind.FACADE: FacadePage,
    ItemKind.PANEL: PanelPage,
    ItemKind.OBSTACLE: ObstaclePage,
    ItemKind.NO_FLY: NoFlyPage,
    ItemKind.AIRSPACE: AirspacePage,
    ItemKind.HOME: HomePage,
    ItemKind.RALLY: RallyPage,
    ItemKind.ZONE: ZonePage,
    ItemKind.ZONE_FILE: ZoneFilePage,
}


class PropertyPanel(QWidget):
    """Shows the page of the selected thing; of the site where nothing of a site is selected."""

    def __init__(self, context: ApplicationContext, editor: SiteEditor, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context, self._editor = context, editor
        self._pages: dict[ItemKind, Page] = {}
        self._shown: Page | None = None
        # No stack: it would be as tall as its tallest page.
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        context.documentChanged.connect(self._document_changed)
        context.selectionChanged.connect(self._show)
        context.unitsChanged.connect(self._set_units)
        self._show(context.selection)

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
        model = self._context.document.site
        if model is None:
            return
        shown = item if item is not None and item.kind in PAGES else SITE
        page = self._page(shown.kind)
        page.show_error("")
        if isinstance(page, PanelPage):
            page.set_found(self._context.document.found_facades)
        page.show_item(model, shown)
        for other in self._pages.values():
            other.setVisible(other is page)
        self._shown = page

    def _page(self, kind: ItemKind) -> Page:
        if kind not in self._pages:
            page = PAGES[kind](self._context.units)
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
            self._show(self._context.selection)

    def _set_units(self, units: UnitSystem) -> None:
        for page in self._pages.values():
            page.set_units(units)
        self._show(self._context.selection)


# What stands in the Site tab before there is a site: what to do first.

BUTTON_HEIGHT_PX = 52


class StartPage(QWidget):
    """Three large buttons."""

    def __init__(self, opener: SiteOpener, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(8)
        heading = QLabel(self.tr("Begin with a site"))
        heading.setProperty("role", "heading")
        heading.setWordWrap(True)
        layout.addWidget(heading)
        layout.addWidget(muted(self.tr("A site holds the glass panels, the building, and where you may fly.")))
        self.import_button = _large(self.tr("Import building model"), primary=True)
        self.open_button = _large(self.tr("Open a site file"))
        self.bundled_button = _large(self.tr("Try a bundled site"))
        self.import_button.clicked.connect(opener.choose_import)
        self.open_button.clicked.connect(opener.choose_site)
        self.bundled_button.setMenu(opener.bundled_menu(self.bundled_button))
        for button, text in (
            (self.import_button, self.tr("IFC, CityGML, CityJSON, OBJ, PLY, GLB or STL")),
            (self.open_button, self.tr("A site.json that was saved before")),
            (self.bundled_button, self.tr("To look around, and to try a plan")),
        ):
            layout.addWidget(button)
            layout.addWidget(muted(text))
        layout.addStretch(1)


def _large(text: str, *, primary: bool = False) -> QPushButton:
    button = QPushButton(text)
    button.setStyleSheet(f"min-height: {BUTTON_HEIGHT_PX}px;")
    button.setProperty("primary", primary)
    return button


class SiteTab(GradualTab):
    """The Site tab; see `groundstation.gui.tabs.Tab`."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView, *, at_once: bool = True) -> None:
        self._context, self._shared_view = context, shared_view
        super().__init__(shared_view, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        context = self._context
        self.left = SiteSide(context)
        yield
        editor = SiteEditor(context, self)
        tools, grid_form = SiteTools(context, self._shared_view, editor), GridForm(context.units)
        yield
        grid_maker = GridController(context, self._shared_view, editor, tools, grid_form)
        properties = PropertyPanel(context, editor)
        yield
        self.detail = SiteDetail(context, self.left, editor, grid_maker, tools, grid_form, properties)
        yield
        self.right: QWidget | None = scrolled(self.detail)
        self.bottom: QWidget | None = None
        yield

    def shown(self) -> None:
        """Check the site after edits."""
        self.detail.editor.set_active(True)

    def hidden(self) -> None:
        """Put tools and previews away."""
        self.detail.editor.set_active(False)
        self.detail.cancel_drawing()

    def actions(self) -> tuple[QAction, ...]:
        """Open, import, and add geo-zones."""
        return (*self.left.actions_of_tab, self.detail.tools.zones_action)

    def take_step(self, act: Act) -> None:
        """Import a building, or lay panels on its facade."""
        match act:
            case Act.IMPORT_BUILDING:
                self.left.opener.choose_import()
            case Act.DRAW_PANELS:
                self.detail.tools.use(SiteTool.GRID)
            case _:
                pass


class SiteSide(QWidget):
    """Where a site comes from, and the tree of what is on it."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self.opener = SiteOpener(context, self)
        self.start = StartPage(self.opener)
        self.tree = SiteTree()
        self._pages = CurrentStack()
        self._pages.addWidget(self.start)
        self._pages.addWidget(self._site_page())
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.addWidget(self._pages)
        self.actions_of_tab = self._make_actions()
        self.tree.valueChanged.connect(self._select)
        self.tree.lookRequested.connect(context.jump_to)
        context.selectionChanged.connect(self.tree.setValue)
        context.documentChanged.connect(self._document_changed)
        context.unitsChanged.connect(self._show_units)
        self._show_site()

    def _site_page(self) -> QWidget:
        page = QWidget()
        buttons = ButtonGrid()
        imported, opened, bundled = (
            QPushButton(text) for text in (self.tr("Import..."), self.tr("Open..."), self.tr("Bundled site"))
        )
        opened.clicked.connect(self.opener.choose_site)
        imported.clicked.connect(self.opener.choose_import)
        bundled.setMenu(self.opener.bundled_menu(bundled))
        terrain = QPushButton(self.tr("Terrain..."))
        terrain.clicked.connect(self.open_terrain)
        for button in (imported, opened, bundled, terrain):
            buttons.addWidget(button)
        layout = QVBoxLayout(page)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(buttons)
        layout.addWidget(self.tree, 1)
        return page

    def open_terrain(self) -> None:
        """Attach terrain to the site, or take it off."""
        if self._context.document.site is None:
            self._context.say(Severity.NOTE, self.tr("Open a site first: terrain belongs to its place."))
            return
        dialog = TerrainDialog(self._context, self.window())
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def _make_actions(self) -> tuple[QAction, ...]:
        actions = []
        for text, shortcut, slot in (
            (self.tr("Open site..."), "Ctrl+Shift+O", self.opener.choose_site),
            (self.tr("Import building model..."), "Ctrl+I", self.opener.choose_import),
            (self.tr("Terrain..."), "", self.open_terrain),
            (self.tr("Delete what is selected"), "Del", self.tree.ask_remove),
        ):
            action = QAction(text, self)
            action.setShortcut(shortcut)
            action.triggered.connect(slot)
            actions.append(action)
        return tuple(actions)

    def _select(self, item: Item | None) -> None:
        self._context.select(item)

    def _document_changed(self, before: Document, after: Document) -> None:
        if after.site is not before.site:
            self._show_site()

    def _show_units(self, _units: UnitSystem) -> None:
        self._show_site()

    def _show_site(self) -> None:
        model = self._context.document.site
        self.tree.set_site(model, self._context.units)
        self.tree.setValue(self._context.selection)
        self._pages.setCurrentIndex(0 if model is None else 1)


class SiteDetail(QWidget):
    """Tools, the panel grid while one is made, properties of what is selected, and what the check found."""

    def __init__(
        self,
        context: ApplicationContext,
        side: SiteSide,
        editor: SiteEditor,
        grid_maker: GridController,
        tools: SiteTools,
        grid_form: GridForm,
        properties: PropertyPanel,
    ) -> None:
        super().__init__()
        self._context = context
        self.editor, self.grid_maker, self.tools, self.grid_form = editor, grid_maker, tools, grid_form
        self.properties = properties
        self.findings = FindingsList()
        self.findings.set_units(context.units)
        self._empty = QLabel(self.tr("What is selected on the site is shown here."))
        self._empty.setProperty("role", "muted")
        self._empty.setWordWrap(True)
        self._filled = QWidget()
        column = QVBoxLayout(self._filled)
        column.setContentsMargins(0, 0, 0, 0)
        for widget in (self.tools, self.grid_form, self.properties, self.findings):
            column.addWidget(widget)
        column.addStretch(1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.addWidget(self._empty)
        layout.addWidget(self._filled)
        layout.addStretch(1)
        self.editor.findingsChanged.connect(self._show_findings)
        self.findings.chosen.connect(context.jump_to)
        self.grid_maker.activeChanged.connect(self.properties.setHidden)
        side.tree.removeRequested.connect(self.editor.remove)
        side.tree.flipRequested.connect(self.editor.flip)
        side.tree.renameRequested.connect(self._rename)
        context.documentChanged.connect(self._document_changed)
        context.unitsChanged.connect(self.grid_form.set_units)
        context.unitsChanged.connect(self.findings.set_units)
        self._show_site()

    def cancel_drawing(self) -> None:
        """Put away what the user began to draw."""
        self.tools.cancel_drawing()
        if not self.grid_form.isHidden():
            self.grid_maker.end()

    def _rename(self, item: Item) -> None:
        self._context.select(item)
        self.properties.focus_name()

    def _show_findings(self, findings: tuple[Finding, ...] | None) -> None:
        self.findings.set_findings(findings)

    def _document_changed(self, before: Document, after: Document) -> None:
        if after.site is not before.site:
            self._show_site()

    def _show_site(self) -> None:
        has_site = self._context.document.site is not None
        self._empty.setVisible(not has_site)
        self._filled.setVisible(has_site)
        if not has_site:
            self.cancel_drawing()
