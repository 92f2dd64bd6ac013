"""The Mission tab's widgets put together: signals go to the controller or the workspace, changes come back here."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.map.map_view import MapView
from groundstation.gui.mission.export_dialog import ExportDialog
from groundstation.gui.mission.findings_view import FindingsView
from groundstation.gui.mission.mission_controller import MissionController
from groundstation.gui.mission.mission_lists import MissionLists, SortieTable
from groundstation.gui.shared_view import Stage
from groundstation.gui.widgets.questions import choose_files
from groundstation.services.mission.files import in_order_of_sorties
from groundstation.services.mission.readiness import FlightDay, Preflight, duration_text
from groundstation.services.plan.places import item_of_place
from groundstation.services.project.document import Document, Item
from groundstation.services.units import UnitSystem
from planning.base.findings import Severity

REST_MS = 300
"""Without changes for so long, a plan is checked."""

NO_BREAK_SPACE = "\u00a0"

READABLE = "*.kmz *.plan *.waypoints *.txt *.kml *.csv"


class MissionPage(QObject):
    """The tab."""

    def __init__(self, workspace: ApplicationContext, stage: Stage) -> None:
        super().__init__(stage)
        self._workspace, self._stage = workspace, stage
        self._is_shown = False
        self._drawn: Document | None = None
        self._preflight: Preflight | None = None
        self._folder: Path | None = None
        self.controller = MissionController(workspace, self)
        self.findings, self.lists, self.sorties = FindingsView(), MissionLists(), SortieTable()
        self._title, self._summary = QLabel(), QLabel()
        self._make_actions()
        self.left = self._make_left()
        self.right: QWidget | None = self.findings
        self.bottom: QWidget | None = self.lists
        self._check_soon = QTimer(self, interval=REST_MS, singleShot=True)
        self._check_soon.timeout.connect(self.controller.check)
        self._connect()
        self._show_units(workspace.units)
        self._say_summary()

    # A tab

    def shown(self) -> None:
        """Bring everything up to date, and check a plan that was changed elsewhere."""
        self._is_shown = True
        self._show_document()
        self._show_selection(self._workspace.selection)

    def hidden(self) -> None:
        """Nothing of the shared view was taken."""
        self._is_shown = False
        self._check_soon.stop()

    def actions(self) -> tuple[QAction, ...]:
        """For the tab's menu."""
        return self._actions

    # What the user does

    def export(self) -> ExportDialog | None:
        """Ask how to export the current plan; None where there is none."""
        plan, site_model = self.controller.plan, self._workspace.document.site
        if plan is None or site_model is None:
            return None
        dialog = ExportDialog(self._workspace, plan, site_model, self._export_folder(), self._stage.window())
        self._workspace.tell_of_plugins()
        dialog.written.connect(self._note_folder)
        dialog.open()
        return dialog

    def print_brief(self) -> None:
        """Show the flight brief of the current plan, to be printed or saved as PDF."""
        if self._preflight is None:
            return
        from groundstation.gui.mission.brief_dialog import BriefDialog

        folder = self._export_folder()
        BriefDialog(self._workspace, self._preflight, self._tiles(), folder, self._stage.window()).open()

    def _tiles(self) -> Path | None:
        """The map file that the stage shows; a map that was never looked at has none."""
        map_view = self._stage.findChild(MapView)
        return None if map_view is None else map_view.map_file()

    def _choose_import(self) -> None:
        self.controller.import_files(self._ask_for_files(self.tr("Import the mission files of one flight")))

    def _choose_compare(self) -> None:
        self.controller.compare_files(self._ask_for_files(self.tr("Compare the plan with mission files")))

    def _ask_for_files(self, title: str) -> tuple[Path, ...]:
        kinds = self.tr("Missions ({0});;All files (*)").format(READABLE)
        paths = choose_files(self._stage.window(), title, kinds, self._export_folder())
        if paths:
            self._folder = paths[0].parent
        return in_order_of_sorties(list(paths))

    def _export_folder(self) -> Path:
        """Where files went last; else the project's folder for missions."""
        if self._folder is not None:
            return self._folder
        project = self._workspace.session.folder
        if project is None:
            return Path.home()
        return project / "missions" if (project / "missions").is_dir() else project

    def _note_folder(self, paths: tuple[Path, ...]) -> None:
        self._folder = paths[0].parent

    # How it is put together

    def _make_actions(self) -> None:
        made = []
        for text, key, tip, slot in (
            (self.tr("Export mission files ..."), "Ctrl+E", self.tr("For DJI, QGroundControl, ..."), self.export),
            (
                self.tr("Import mission files ..."),
                "Ctrl+Shift+I",
                self.tr("As a plan of this project; without a site, on a bare one of its own"),
                self._choose_import,
            ),
            (
                self.tr("Compare with file ..."),
                "Ctrl+Shift+C",
                self.tr("Is this file the plan? Shows what differs"),
                self._choose_compare,
            ),
            (self.tr("Flight brief ..."), "Ctrl+R", self.tr("To print or save as PDF"), self.print_brief),
            (self.tr("Check"), "Ctrl+K", self.tr("Measure every pre-flight rule again"), self.controller.check),
        ):
            action = QAction(text, self)
            action.setShortcut(QKeySequence(key))
            action.setToolTip(tip)
            action.triggered.connect(lambda _checked=False, slot=slot: slot())
            made.append(action)
        self._export, self._import, self._compare, self._brief, self._check = self._actions = tuple(made)

    def _make_left(self) -> QWidget:
        left = QWidget()
        layout = QVBoxLayout(left)
        layout.setContentsMargins(6, 6, 6, 6)
        self._title.setProperty("role", "heading")
        for label in (self._title, self._summary):
            label.setWordWrap(True)
            layout.addWidget(label)
        layout.addWidget(self.sorties, 1)
        for action in (self._export, self._import, self._compare, self._brief):
            button = QPushButton(action.text())
            button.setToolTip(action.toolTip())
            button.clicked.connect(action.trigger)
            button.setProperty("primary", action is self._export)
            action.changed.connect(lambda button=button, action=action: button.setEnabled(action.isEnabled()))
            layout.addWidget(button)
        return left

    def _connect(self) -> None:
        workspace = self._workspace
        self.findings.checkRequested.connect(self.controller.check)
        self.findings.dayChanged.connect(self._day_changed)
        self.findings.placePicked.connect(self._go_to)
        self.lists.picked.connect(workspace.select)
        self.lists.activated.connect(workspace.jump_to)
        self.sorties.picked.connect(workspace.jump_to)
        self.controller.checked.connect(self._take_preflight)
        self.controller.compared.connect(self.lists.show_comparison)
        workspace.documentChanged.connect(self._document_changed)
        workspace.selectionChanged.connect(self._show_selection)
        workspace.unitsChanged.connect(self._show_units)
        workspace.jobsChanged.connect(self._show_freshness)

    # What changes

    def _document_changed(self, _before: Document, _after: Document) -> None:
        if self._is_shown:
            self._show_document()

    def _show_document(self) -> None:
        """Draw what changed since it was last drawn; hidden tabs wait."""
        document, drawn = self._workspace.document, self._drawn
        plan, site_model = self.controller.plan, document.site
        is_new = drawn is None or drawn.site is not site_model or drawn.current is not document.current
        self._drawn = document
        if is_new:
            self.sorties.set_plan(plan)
            self.lists.set_plan(plan, site_model)
            self._say_summary()
        self._show_freshness()
        if self._is_shown and plan is not None and not self._is_fresh():
            self._check_soon.start()

    def _is_fresh(self) -> bool:
        found, plan, site_model = self._preflight, self.controller.plan, self._workspace.document.site
        return found is not None and found.is_of(plan, site_model) and found.day == self.controller.day

    def _show_freshness(self) -> None:
        """Say whether the findings are of the plan as it is, and what can be done with it; hidden tabs wait."""
        if not self._is_shown:
            return
        plan, is_checking = self.controller.plan, self.controller.is_checking
        if plan is None:
            self._preflight = None
            self.findings.set_findings(None)
        elif not self._is_fresh():
            self.findings.set_stale()
            if is_checking:
                self.findings.set_checking()
        self.findings.set_can_check(self.controller.can_check and not is_checking)
        for action in (self._export, self._compare):
            action.setEnabled(plan is not None)
        self._check.setEnabled(self.controller.can_check and not is_checking)
        self._brief.setEnabled(plan is not None and self._is_fresh())

    def _take_preflight(self, found: Preflight) -> None:
        self._preflight = found
        if self._is_fresh():
            self.findings.set_findings(found.findings)
            self.lists.set_panels_covered(found.panels_covered)
        elif self._is_shown:
            self._check_soon.start()
        self._show_freshness()

    def _say_summary(self) -> None:
        document, plan = self._workspace.document, self.controller.plan
        if document.site is None:
            self._title.setText(self.tr("No site"))
            self._summary.setText(self.tr("Open or import a site first, on the Site tab."))
        elif plan is None or document.current is None:
            self._title.setText(self.tr("No plan"))
            self._summary.setText(self.tr("Plan a flight on the Plan tab, or import a mission file."))
        else:
            self._title.setText(document.current.title)
            self._summary.setText(
                self.tr("{0}, photos: {1}, batteries: {2}, {3}").format(
                    plan.aircraft.name,
                    len(plan.viewpoints),
                    len(plan.sorties),
                    duration_text(plan.duration_s).replace(" ", NO_BREAK_SPACE),
                )
            )

    def _day_changed(self, day: FlightDay) -> None:
        self.controller.day = day
        self._show_freshness()
        self._check_soon.start()

    def _go_to(self, place: str) -> None:
        item = item_of_place(place, self._workspace.document)
        if item is None:
            self._workspace.say(
                Severity.NOTE, self.tr("{0} is not shown in the view").format(self._workspace.words(place))
            )
        else:
            self._workspace.jump_to(item)

    def _show_selection(self, item: Item | None) -> None:
        if self._is_shown:
            self.lists.set_selection(item)

    def _show_units(self, units: UnitSystem) -> None:
        for widget in (self.findings, self.lists, self.sorties):
            widget.set_units(units)
