"""The Mission tab's widgets put together, with its findings: signals go to the controller, changes come back here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QDateTime, QEvent, QLocale, QSignalBlocker, Qt, QTimer, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QCheckBox,
    QDateTimeEdit,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.gradual import GradualTab
from groundstation.gui.application.translate import translated, translated_finding
from groundstation.gui.map.map_view import MapView
from groundstation.gui.mission.export_dialog import ExportDialog, SendDialog
from groundstation.gui.mission.mission_controller import MissionController, Proved
from groundstation.gui.mission.mission_lists import MissionLists, SortieTable
from groundstation.gui.shared_view import SharedView
from groundstation.gui.widgets.findings_list import SIZE_PX, FindingsList, severity_icon
from groundstation.gui.widgets.inputs import NumberBox, calm, moment_of
from groundstation.gui.widgets.questions import choose_files
from groundstation.gui.widgets.theme import colours
from groundstation.services.mission.files import in_order_of_sorties
from groundstation.services.mission.readiness import (
    SEVERITIES,
    UNKNOWN_DAY,
    FlightDay,
    Preflight,
    Readiness,
    counts_by_severity,
    duration_text,
    not_looked_at,
    readiness_of,
)
from groundstation.services.plan.places import item_of_place
from groundstation.services.project.document import Document, Item
from groundstation.services.project.steps import Act
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity
from planning.insight.ground_risk_request import GroundRiskRequest

if TYPE_CHECKING:
    from groundstation.gui.mission.sora_dialog import SoraDialog
    from groundstation.services.mission.sora import SoraDraft

# The pre-flight findings of a plan: a verdict, how fresh it is, how many of each severity, and the list.


class FindingsView(QWidget):
    """Shows findings and how fresh they are.

    Signals
    -------
    placePicked(str)
        The user wants to see the place of a finding.
    checkRequested()
    dayChanged(FlightDay)
        The user says when it is flown, or how cold it is.
    """

    placePicked = Signal(str)  # noqa: N815  (Qt's own way of naming)
    checkRequested = Signal()  # noqa: N815
    dayChanged = Signal(object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._findings: tuple[Finding, ...] | None = None
        self._is_stale = False
        self._verdict_icon, self._verdict, self._state = QLabel(), QLabel(), QLabel()
        self._verdict.setWordWrap(True)
        self._state.setWordWrap(True)
        self._proof = QLabel()
        self._proof.setWordWrap(True)
        self._proof.setToolTip(self.tr("What a program that shares nothing with this one says of the plan"))
        self._check = QPushButton(self.tr("Check"))
        self._check.setToolTip(self.tr("Measure every pre-flight rule again, and have the plan proved"))
        self._list, self._day = FindingsList(), DayBox()
        self._show = {severity: self._filter_button(severity) for severity in SEVERITIES}
        head, filters = QHBoxLayout(), QHBoxLayout()
        head.addWidget(self._verdict_icon)
        head.addWidget(self._verdict, 1)
        head.addWidget(self._check)
        for button in self._show.values():
            filters.addWidget(button, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addLayout(head)
        layout.addWidget(self._day)
        layout.addWidget(self._state)
        layout.addWidget(self._proof)
        layout.addLayout(filters)
        layout.addWidget(self._list, 1)
        self._check.clicked.connect(self.checkRequested)
        self._day.valueChanged.connect(self.dayChanged)
        self._list.placePicked.connect(self.placePicked)
        self._filter()
        self.set_findings(None)
        self.set_proof(None)

    def set_findings(self, findings: Sequence[Finding] | None) -> None:
        """Show findings that are as fresh as the plan; None where nothing was checked."""
        self._findings = None if findings is None else tuple(findings)
        self._is_stale = False
        self._say_state("" if findings is not None else self.tr("Not checked yet."))
        self._list.set_findings(self._findings or ())
        kept, unknown = self.tr("All checks passed. The button with the tick lists them."), self._not_looked_at()
        if unknown:
            kept = self.tr("All checks passed; not looked at: {0}. The button with the tick lists them.").format(
                unknown
            )
        self._list.set_placeholder(kept if self._findings else "")
        self._show_counts()

    def set_stale(self) -> None:
        """Say that the plan or the site has changed since."""
        if self._findings is not None:
            self._is_stale = True
            self._say_state(self.tr("Older than the plan: it was changed after this check."))
            self._show_counts()

    def set_checking(self) -> None:
        """Say that a check runs."""
        self._say_state(self.tr("Checking ..."))

    def set_proof(self, finding: Finding | None, *, is_proving: bool = False) -> None:
        """Show what an independent check says of the plan as it is now, in the window's language; None: nothing."""
        text = self.tr("Being proved ...") if is_proving else ""
        if finding is not None and not is_proving:
            text = finding.message[:1].upper() + finding.message[1:]
        role = "" if finding is None or is_proving else {Severity.OK: "ok"}.get(finding.severity, "warning")
        self._proof.setText(text)
        self._proof.setVisible(bool(text))
        self._proof.setProperty("role", role)
        self._proof.style().polish(self._proof)

    def proof_text(self) -> str:
        """What an independent check said, as it is read; empty where none did."""
        return self._proof.text()

    def set_can_check(self, can_check: bool) -> None:
        """Whether there is a plan on a site to check."""
        self._check.setEnabled(can_check)

    def set_units(self, units: UnitSystem) -> None:
        """Show values in other units."""
        self._list.set_units(units)

    def day_box(self) -> DayBox:
        """What is known of the day of the flight."""
        return self._day

    def verdict(self) -> str:
        """The verdict as it is read."""
        return self._verdict.text()

    def state_text(self) -> str:
        """How fresh the findings are; empty where they are up to date."""
        return self._state.text()

    def show_severity(self, severity: Severity, is_shown: bool) -> None:
        """Show or hide the findings of one severity."""
        self._show[severity].setChecked(is_shown)

    def list_view(self) -> FindingsList:
        """The list."""
        return self._list

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw the pictures in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show_counts()

    def _filter_button(self, severity: Severity) -> QToolButton:
        button = QToolButton()
        button.setCheckable(True)
        button.setChecked(severity is not Severity.OK)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setToolTip(self._list.severity_word(severity))
        button.toggled.connect(self._filter)
        return button

    def _filter(self) -> None:
        self._list.set_shown([severity for severity, button in self._show.items() if button.isChecked()])

    def _show_counts(self) -> None:
        for severity, count in counts_by_severity(self._findings or ()).items():
            self._show[severity].setText(str(count))
            self._show[severity].setIcon(severity_icon(severity, colours()))
        if self._findings is None or self._is_stale:
            text, severity, role = self.tr("Readiness not known"), Severity.WARNING, "warning"
        else:
            text, severity, role = {
                Readiness.READY: (self.tr("Ready to fly"), Severity.OK, "ok"),
                Readiness.WITH_WARNINGS: (self.tr("Ready to fly, but read the warnings"), Severity.WARNING, "warning"),
                Readiness.NOT_READY: (self.tr("NOT ready to fly"), Severity.ERROR, "error"),
            }[readiness_of(self._findings)]
            unknown = self._not_looked_at()
            if unknown and severity is not Severity.ERROR:
                text = self.tr("{0}; not looked at: {1}").format(text, unknown)
        self._verdict.setText(text)
        self._verdict.setProperty("role", role)
        self._verdict.style().polish(self._verdict)
        self._verdict_icon.setPixmap(severity_icon(severity, colours()).pixmap(SIZE_PX, SIZE_PX))

    def _not_looked_at(self) -> str:
        """What the check could not look at, in the window's language; empty for nothing."""
        return ", ".join(translated(text, UnitSystem.METRIC) for text in not_looked_at(self._findings or ()))

    def _say_state(self, text: str) -> None:
        self._state.setText(text)
        self._state.setVisible(bool(text))


class DayBox(QWidget):
    """Edits a `FlightDay`: when the flight is planned, and how cold it is; each may be left open.

    Signals
    -------
    valueChanged(FlightDay)
    """

    valueChanged = Signal(object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.has_time, self.has_temperature = QCheckBox(self.tr("Planned for")), QCheckBox(self.tr("Temperature"))
        self.has_time.setToolTip(self.tr("Look where the sun stands, and where glass mirrors it"))
        self.has_temperature.setToolTip(self.tr("Look what cold takes from the batteries"))
        self.when = QDateTimeEdit(QDateTime.currentDateTime())
        calm(self.when)
        self.when.setDisplayFormat("yyyy-MM-dd HH:mm")
        self.when.setLocale(QLocale.c())
        self.when.setCalendarPopup(True)
        self.when.setAccessibleName(self.tr("Date and time of the flight"))
        self.when.setToolTip(self.tr("By this computer's clock and time zone"))
        self.temperature = NumberBox(-40.0, 55.0, 1.0, " \u00b0C", 0)
        self.temperature.setValue(20.0)
        self.temperature.setAccessibleName(self.tr("Temperature at the flight"))
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for row, (check, box) in enumerate(((self.has_time, self.when), (self.has_temperature, self.temperature))):
            layout.addWidget(check, row, 0)
            layout.addWidget(box, row, 1)
            check.toggled.connect(self._edited)
        layout.setColumnStretch(1, 1)
        self.when.dateTimeChanged.connect(self._edited)
        self.temperature.valueChanged.connect(self._edited)
        self._show(UNKNOWN_DAY)

    def value(self) -> FlightDay:
        """What is known of the day."""
        at = moment_of(self.when) if self.has_time.isChecked() else None
        return FlightDay(at, self.temperature.value() if self.has_temperature.isChecked() else None)

    def setValue(self, day: FlightDay) -> None:  # noqa: N802
        """Show another day."""
        blockers = [QSignalBlocker(box) for box in (self.has_time, self.has_temperature, self.when, self.temperature)]
        if day.at is not None:
            self.when.setDateTime(QDateTime.fromSecsSinceEpoch(round(day.at.timestamp())))
        if day.temperature_c is not None:
            self.temperature.setValue(day.temperature_c)
        self.has_time.setChecked(day.at is not None)
        self.has_temperature.setChecked(day.temperature_c is not None)
        del blockers
        self._show(day)

    def _show(self, day: FlightDay) -> None:
        self.when.setEnabled(day.at is not None)
        self.temperature.setEnabled(day.temperature_c is not None)

    def _edited(self, *_changed: object) -> None:
        day = self.value()
        self._show(day)
        self.valueChanged.emit(day)


REST_MS = 300
"""Without changes for so long, a plan is checked."""

NO_BREAK_SPACE = "\u00a0"

READABLE = "*.kmz *.plan *.waypoints *.txt *.kml *.csv"


class MissionPage(GradualTab):
    """The tab."""

    def __init__(self, context: ApplicationContext, shared_view: SharedView, *, at_once: bool = True) -> None:
        self._context, self._shared_view = context, shared_view
        super().__init__(shared_view, at_once=at_once)

    def _parts(self) -> Iterator[None]:
        context = self._context
        self._is_shown = False
        self._drawn: Document | None = None
        self._preflight: Preflight | None = None
        self._proved: Proved | None = None
        self._folder: Path | None = None
        self._ground_risk: GroundRiskRequest | None = None
        self.controller = MissionController(context, self)
        self.findings, self.sorties = FindingsView(), SortieTable()
        yield
        self.lists = MissionLists()
        yield
        self._title, self._summary = QLabel(), QLabel()
        self._make_actions()
        self.left = self._make_left()
        self.right: QWidget | None = self.findings
        self.bottom: QWidget | None = self.lists
        yield
        self._check_soon = QTimer(self, interval=REST_MS, singleShot=True)
        self._check_soon.timeout.connect(self.controller.check)
        self._connect()
        self._show_units(context.units)
        self._say_summary()
        yield

    # A tab

    def shown(self) -> None:
        """Bring everything up to date, and check a plan that was changed elsewhere."""
        self._is_shown = True
        self._show_document()
        self._show_selection(self._context.selection)

    def hidden(self) -> None:
        """Nothing of the shared view was taken."""
        self._is_shown = False
        self._check_soon.stop()

    def actions(self) -> tuple[QAction, ...]:
        """For the tab's menu."""
        return self._actions

    def take_step(self, act: Act) -> None:
        """Check the plan, show what is wrong with it, or take a mission of another program over."""
        match act:
            case Act.CHECK:
                self.controller.check()
            case Act.SHOW_FINDING:
                found = () if self._preflight is None else self._preflight.findings
                wrong = next((one for one in found if one.severity is Severity.ERROR), None)
                if wrong is not None:
                    self._go_to(wrong.place)
            case Act.IMPORT_MISSION:
                self._choose_import()
            case _:
                pass

    # What the user does

    def export(self) -> ExportDialog | None:
        """Ask how to export the current plan; None where there is none."""
        plan, site_model = self.controller.plan, self._context.document.site
        if plan is None or site_model is None:
            return None
        dialog = ExportDialog(self._context, plan, site_model, self._export_folder(), self._shared_view.window())
        self._context.report_plugin_problems()
        dialog.written.connect(self._note_folder)
        dialog.open()
        return dialog

    def send(self) -> SendDialog | None:
        """Ask which card or remote controller the current plan is to be put on; None where there is none."""
        document, plan = self._context.document, self.controller.plan
        if plan is None or document.site is None or document.current is None:
            return None
        name = document.current.title
        dialog = SendDialog(self._context, plan, document.site, name, self._shared_view.window())
        dialog.open()
        return dialog

    def assess_ground_risk(self) -> SoraDialog | None:
        """Ask what is known of flight and people, and show the ground risk; None where there is no plan."""
        document, plan = self._context.document, self.controller.plan
        if plan is None or document.site is None or document.current is None:
            return None
        from groundstation.gui.mission.sora_dialog import SoraDialog

        name, window = document.current.title, self._shared_view.window()
        dialog = SoraDialog(self._context, plan, document.site, name, self._ground_risk, window)
        dialog.drafted.connect(self._note_ground_risk)
        dialog.open()
        return dialog

    def _note_ground_risk(self, draft: SoraDraft) -> None:
        """What was stated counts for the brief, too."""
        self._ground_risk = draft.risk.request

    def print_brief(self) -> None:
        """Show the flight brief of the current plan, to be printed or saved as PDF."""
        if self._preflight is None:
            return
        from groundstation.gui.mission.brief_printer import BriefDialog

        folder = self._export_folder()
        window = self._shared_view.window()
        found = self._preflight
        if self._proved is not None and found.is_of(self._proved.plan, self._proved.site_model):
            found = replace(found, findings=(*found.findings, self._proved.finding))
        BriefDialog(self._context, found, self._tiles(), folder, window, self._ground_risk).open()

    def _tiles(self) -> Path | None:
        """The map file that the shared view shows; a map that was never looked at has none."""
        map_view = self._shared_view.findChild(MapView)
        return None if map_view is None else map_view.map_file()

    def _choose_import(self) -> None:
        self.controller.import_files(self._ask_for_files(self.tr("Import the mission files of one flight")))

    def _choose_compare(self) -> None:
        self.controller.compare_files(self._ask_for_files(self.tr("Compare the plan with mission files")))

    def _ask_for_files(self, title: str) -> tuple[Path, ...]:
        kinds = self.tr("Missions ({0});;All files (*)").format(READABLE)
        paths = choose_files(self._shared_view.window(), title, kinds, self._export_folder())
        if paths:
            self._folder = paths[0].parent
        return in_order_of_sorties(list(paths))

    def _export_folder(self) -> Path:
        """Where files went last; else the project's folder for missions."""
        if self._folder is not None:
            return self._folder
        project = self._context.session.folder
        if project is None:
            return Path.home()
        return project / "missions" if (project / "missions").is_dir() else project

    def _note_folder(self, paths: tuple[Path, ...]) -> None:
        self._folder = paths[0].parent
        self._context.note(is_exported=True)

    # How it is put together

    def _make_actions(self) -> None:
        actions = []
        for text, key, tip, slot in (
            (self.tr("Export mission files ..."), "Ctrl+E", self.tr("For DJI, QGroundControl, ..."), self.export),
            (
                self.tr("Send to controller ..."),
                "Ctrl+Shift+E",
                self.tr("Onto an SD card or a connected remote controller of DJI, read back and compared"),
                self.send,
            ),
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
            (
                self.tr("SORA ..."),
                "Ctrl+Shift+R",
                self.tr("Ground risk: volumes, buffer and class, as a draft with formulas and sources"),
                self.assess_ground_risk,
            ),
            (
                self.tr("Check"),
                "Ctrl+K",
                self.tr("Measure every pre-flight rule again, and have the plan proved"),
                self.controller.check_and_prove,
            ),
        ):
            action = QAction(text, self)
            action.setShortcut(QKeySequence(key))
            action.setToolTip(tip)
            action.triggered.connect(lambda _checked=False, slot=slot: slot())
            actions.append(action)
        self._export, self._send, self._import, self._compare, self._brief, self._sora, self._check = actions
        self._actions = tuple(actions)

    def _make_left(self) -> QWidget:
        left = QWidget()
        layout = QVBoxLayout(left)
        layout.setContentsMargins(6, 6, 6, 6)
        self._title.setProperty("role", "heading")
        for label in (self._title, self._summary):
            label.setWordWrap(True)
            layout.addWidget(label)
        layout.addWidget(self.sorties, 1)
        for action in (self._export, self._send, self._import, self._compare, self._brief, self._sora):
            button = QPushButton(action.text())
            button.setToolTip(action.toolTip())
            button.clicked.connect(action.trigger)
            button.setProperty("primary", action is self._export)
            action.changed.connect(lambda button=button, action=action: button.setEnabled(action.isEnabled()))
            layout.addWidget(button)
        return left

    def _connect(self) -> None:
        context = self._context
        self.findings.checkRequested.connect(self.controller.check_and_prove)
        self.controller.proved.connect(self._take_proof)
        self.findings.dayChanged.connect(self._day_changed)
        context.takeOffPlanned.connect(self._plan_take_off)
        self.findings.placePicked.connect(self._go_to)
        self.lists.picked.connect(context.select)
        self.lists.activated.connect(context.jump_to)
        self.sorties.picked.connect(context.jump_to)
        self.controller.checked.connect(self._take_preflight)
        self.controller.compared.connect(self.lists.show_comparison)
        context.documentChanged.connect(self._document_changed)
        context.selectionChanged.connect(self._show_selection)
        context.unitsChanged.connect(self._show_units)
        context.jobsChanged.connect(self._show_freshness)

    # What changes

    def _document_changed(self, _before: Document, _after: Document) -> None:
        if self._is_shown:
            self._show_document()

    def _show_document(self) -> None:
        """Draw what changed since it was last drawn; hidden tabs wait."""
        document, drawn = self._context.document, self._drawn
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
        found, plan, site_model = self._preflight, self.controller.plan, self._context.document.site
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
        self._show_proof()
        for action in (self._export, self._send, self._compare, self._sora):
            action.setEnabled(plan is not None)
        self._check.setEnabled(self.controller.can_check and not is_checking)
        self._brief.setEnabled(plan is not None and self._is_fresh())

    def _take_proof(self, proved: Proved) -> None:
        self._proved = proved
        self._show_proof()

    def _show_proof(self) -> None:
        proved, is_proving = self._proved, self.controller.is_proving
        is_fresh = (
            proved is not None
            and proved.plan is self.controller.plan
            and proved.site_model is self._context.document.site
        )
        shown = translated_finding(proved.finding, self._context.units) if proved is not None and is_fresh else None
        self.findings.set_proof(shown, is_proving=is_proving)

    def _take_preflight(self, found: Preflight) -> None:
        self._preflight = found
        if self._is_fresh():
            self.findings.set_findings(found.findings)
            self.lists.set_panels_covered(found.panels_covered)
            counts = counts_by_severity(found.findings)
            self._context.note(
                n_errors=counts[Severity.ERROR],
                n_warnings=counts[Severity.WARNING],
                not_looked_at=not_looked_at(found.findings),
            )
        elif self._is_shown:
            self._check_soon.start()
        self._show_freshness()

    def _say_summary(self) -> None:
        document, plan = self._context.document, self.controller.plan
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

    def _plan_take_off(self, at: datetime) -> None:
        box = self.findings.day_box()
        box.setValue(replace(box.value(), at=at))
        self.controller.set_day(box.value())
        self._show_freshness()

    def _day_changed(self, day: FlightDay) -> None:
        self.controller.set_day(day)
        self._show_freshness()
        self._check_soon.start()

    def _go_to(self, place: str) -> None:
        item = item_of_place(place, self._context.document)
        if item is None:
            self._context.say(
                Severity.NOTE, self.tr("{0} is not shown in the view").format(self._context.localized(place))
            )
        else:
            self._context.jump_to(item)

    def _show_selection(self, item: Item | None) -> None:
        if self._is_shown:
            self.lists.set_selection(item)

    def _show_units(self, units: UnitSystem) -> None:
        for widget in (self.findings, self.lists, self.sorties):
            widget.set_units(units)
        self._show_proof()
