"""Export: choose format and options, read what the checks of the files say, then write them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from PySide6.QtCore import QDateTime, QLocale, QSignalBlocker, QTimer, Signal
from PySide6.QtWidgets import QCheckBox, QDialog, QHBoxLayout, QLabel, QLineEdit, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.inputs import ChoiceBox, Form, LengthBox
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.parameter_form import (
    add_rows,
    rows_of,
    title_of,
    typed_range,
)
from groundstation.gui.widgets.questions import Questions, agrees, choose_new_file, file_name
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.files import (
    PreparedExport,
    export_paths,
    not_ready,
    prepare_export,
    write_proved_export,
)
from groundstation.services.mission.sending import (
    Payload,
    PreparedSending,
    SentFile,
    payload_of_plan,
    prepare_sending,
    send,
)
from groundstation.services.mission.storages import App, Route, Storage, find_storages, storage_at
from groundstation.services.settings import data_folder
from groundstation.services.units import UnitSystem
from missions.formats.options import ExportOptions
from missions.formats.registry import mission_format, mission_formats
from missions.mission.export_choices import FileFormat
from planning.base.errors import GroundStationError
from planning.base.files import PLAIN_ENDINGS
from planning.base.findings import Finding, Severity
from planning.base.parameters import declared
from planning.plan import Plan
from planning.site.records import SiteModel

# What a pilot chooses for mission files: the format and the options that it has.

FIRST_RETURN_HEIGHT_M = 60.0

KNOWN = declared(ExportOptions)


class ExportForm(QWidget):
    """`value()`, `setValue()` and `valueChanged` of a format with its options; what a format lacks is hidden.

    Parameters
    ----------
    only
        The one format that there is to choose; None for all.
    """

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, units: UnitSystem, parent: QWidget | None = None, only: str | None = None) -> None:
        super().__init__(parent)
        self._format = ChoiceBox()
        for name, each in mission_formats().items():
            if only in (None, name):
                self._format.addItem(translated(each.title, units), name)
        self._rows = rows_of(KNOWN, but=("rth_height_m",))
        known = KNOWN["rth_height_m"].parameter
        self._return_auto = QCheckBox(self.tr("above everything on the site"))
        self._return_auto.setChecked(True)
        self._return = LengthBox(*typed_range(known), known.step, units)
        self._return.setValue(FIRST_RETURN_HEIGHT_M)
        form = self._form = Form(self)
        form.setContentsMargins(0, 0, 0, 0)
        form.addRow(self.tr("Format"), self._format)
        form.setRowVisible(self._format, only is None)
        add_rows(form, self._rows)
        form.addRow(title_of(known), self._return_auto)
        form.addRow(self.tr("Above take-off"), self._return)
        self._format.currentIndexChanged.connect(self._changed)
        for row in self._rows.values():
            row.valueChanged.connect(self._changed)
        self._return_auto.toggled.connect(self._changed)
        self._return.valueChanged.connect(self._changed)
        self._show_options()

    def value(self) -> tuple[str, ExportOptions]:
        """The format and its options; what is hidden has its usual value."""
        name = str(self._format.currentData())
        chosen = mission_format(name)
        values = {option: row.value() for option, row in self._rows.items() if chosen.takes(option)}
        if chosen.takes("rth_height_m") and not self._return_auto.isChecked():
            values["rth_height_m"] = self._return.value()
        return name, ExportOptions(**values)

    def setValue(self, file_format: str, options: ExportOptions) -> None:  # noqa: N802
        """Show a format and options."""
        with QSignalBlocker(self):
            self._format.setCurrentIndex(max(0, self._format.findData(str(file_format))))
            for option, row in self._rows.items():
                row.setValue(getattr(options, option))
            self._return_auto.setChecked(options.rth_height_m is None)
            if options.rth_height_m is not None:
                self._return.setValue(options.rth_height_m)
            self._show_options()

    def set_units(self, units: UnitSystem) -> None:
        """Show the return height in other units."""
        self._return.set_units(units)

    def _changed(self) -> None:
        self._show_options()
        self.valueChanged.emit()

    def _show_options(self) -> None:
        chosen = mission_format(str(self._format.currentData()))
        self._rows["height_reference"].offer(chosen.heights)
        for option, row in self._rows.items():
            self._form.setRowVisible(row.widget, chosen.takes(option))
        returns = chosen.takes("rth_height_m")
        self._form.setRowVisible(self._return_auto, returns)
        self._form.setRowVisible(self._return, returns and not self._return_auto.isChecked())


FORM_WIDTH_PX = 360

REST_MS = 200
"""Turning a wheel through choices, or typing, asks once, not once for each."""


class AnsweringDialog(QDialog):
    """Shows what a service answers to what is chosen in it, and does it once the user agrees.

    Answers to what was chosen before are not shown. Closed while it writes, it goes when that is over.

    Parameters
    ----------
    action
        On its button, which can be pressed while an answer stands.
    """

    def __init__(self, context: ApplicationContext, action: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self._asked, self._is_writing = 0, False
        self._state, self._findings = QLabel(), FindingsList()
        self._state.setWordWrap(True)
        self._findings.set_units(context.units)
        self._action = QPushButton(action)
        self._action.setProperty("primary", True)
        self._action.setDefault(True)
        self._ask_soon = QTimer(self, interval=REST_MS, singleShot=True)
        self.finished.connect(self._let_go)

    def state_text(self) -> str:
        """What is said of the answer."""
        return self._state.text()

    def findings(self) -> FindingsList:
        """What the checks say."""
        return self._findings

    def _edited(self) -> None:
        self._forget()
        self._ask_soon.start()

    def _forget(self) -> int:
        """Answers to what was asked before are not shown any more; the number of the new question."""
        self._asked += 1
        self._action.setEnabled(False)
        return self._asked

    def _say(self, role: str, text: str) -> None:
        self._state.setProperty("role", role)
        self._state.style().polish(self._state)
        self._state.setText(text)

    def _say_failed(self, text: str) -> None:
        """That it was not done: here, or among the messages where the dialog was closed meanwhile."""
        self._is_writing = False
        if self.isVisible():
            self._say("error", text)
        else:
            self._context.say(Severity.WARNING, text)
            self._let_go()

    def _foot(self) -> QHBoxLayout:
        """Close, and the button of what it does."""
        close, foot = QPushButton(self.tr("Close")), QHBoxLayout()
        close.clicked.connect(self.reject)
        foot.addStretch(1)
        foot.addWidget(close)
        foot.addWidget(self._action)
        return foot

    def _let_go(self) -> None:
        """Closed: nothing more is shown, and nothing is left in the window once files that are being written are."""
        self._asked += 1
        self._ask_soon.stop()
        if not self._is_writing:
            self.deleteLater()


class ExportDialog(AnsweringDialog):
    """Exports one plan of one site.

    Signals
    -------
    written(tuple of Path)
    """

    written = Signal(object)

    def __init__(
        self,
        context: ApplicationContext,
        plan: Plan,
        site_model: SiteModel,
        folder: Path,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(context, self.tr("Write ..."), parent)
        self.setWindowTitle(self.tr("Export mission files"))
        self._plan, self._site_model, self._folder = plan, site_model, folder
        self._prepared: PreparedExport | None = None
        self._form = ExportForm(context.units)
        left = QWidget()
        left.setFixedWidth(FORM_WIDTH_PX)
        left_layout = QVBoxLayout(left)
        left_layout.setContentsMargins(0, 0, 0, 0)
        left_layout.addWidget(self._form)
        left_layout.addStretch(1)
        right = QVBoxLayout()
        right.addWidget(self._state)
        right.addWidget(self._findings, 1)
        columns = QHBoxLayout()
        columns.addWidget(left)
        columns.addLayout(right, 1)
        layout = QVBoxLayout(self)
        layout.addLayout(columns, 1)
        layout.addWidget(DialogFoot(context))
        layout.addLayout(self._foot())
        self.resize(820, 460)
        self._ask_soon.timeout.connect(self._prepare)
        self._form.valueChanged.connect(self._edited)
        self._action.clicked.connect(self._choose_file)
        self._prepare()

    def form(self) -> ExportForm:
        """Format and options."""
        return self._form

    def prepared(self) -> PreparedExport | None:
        """What would be written; None while it is being made."""
        return self._prepared

    def folder(self) -> Path:
        """Where files were written last."""
        return self._folder

    def write(self, path: Path) -> None:
        """Write the files that are ready; the first to `path`."""
        prepared = self._prepared
        if prepared is None:
            return
        self._folder = path.parent
        site_model, (file_format, _) = self._site_model, self._form.value()

        def work(context: JobContext) -> tuple[tuple[Path, ...], Finding | None]:
            return write_proved_export(prepared, site_model, file_format, path, context.run_in_process)

        self._is_writing = True
        self._context.start(self.tr("Export"), work, self._when_written, self._when_failed)

    def _forget(self) -> int:
        self._prepared = None
        return super()._forget()

    def _prepare(self) -> None:
        """Make the files in memory; an answer to older options is not shown."""
        file_format, options = self._form.value()
        plan, site_model = self._plan, self._site_model
        request = self._forget()
        self._say("heading", self.tr("Making the files ..."))

        def work(_context: JobContext) -> PreparedExport:
            return prepare_export(plan, site_model, file_format, options)

        def done(prepared: Any) -> None:
            if request == self._asked:
                self._show(prepared)

        self._context.start(self.tr("Prepare export"), work, done)

    def _show(self, prepared: PreparedExport) -> None:
        self._prepared = prepared
        self._findings.set_findings(prepared.findings)
        self._findings.set_placeholder("" if prepared.encoded is None else self.tr("No objections to these files."))
        self._action.setEnabled(prepared.can_be_written)
        if prepared.encoded is None:
            self._say("error", self.tr("Cannot be exported: {0}").format(prepared.refusal))
        elif not prepared.can_be_written:
            self._say("error", self.tr("Not to be written like this: see the errors."))
        elif not prepared.is_ready_to_fly:
            text = self.tr(
                "NOT ready to fly: see the finding. Files that can be written all the same, to look at: {0}. Do not "
                "fly them before the plan is corrected."
            )
            self._say("error", text.format(prepared.n_files))
        elif any(found.severity is Severity.WARNING for found in prepared.findings):
            self._say(
                "warning", self.tr("Ready to be written, files: {0}. Read the warnings.").format(prepared.n_files)
            )
        else:
            self._say("ok", self.tr("Ready to be written, files: {0}").format(prepared.n_files))

    def _choose_file(self) -> None:
        file_format, _ = self._form.value()
        suffix, *others = mission_format(file_format).endings
        proposed = self._folder / f"{file_name(self._plan.site)}{suffix}"
        kinds = self.tr("Mission files (*{0})").format(suffix)
        path = choose_new_file(self, self.tr("Write mission files"), proposed, kinds, suffix, (*others, *PLAIN_ENDINGS))
        if path is None or self._prepared is None:
            return
        if self._may_replace(path):
            self.write(path)

    def _may_replace(self, path: Path) -> bool:
        """Ask before files of further sorties are replaced; for the first the file dialog has asked."""
        there = [p.name for p in export_paths(self._prepared, path)[1:] if p.exists()] if self._prepared else []
        if not there:
            return True
        text = self.tr("These files are replaced: {0}").format(", ".join(there))
        return agrees(self, self.tr("Replace files?"), text, warns=True)

    def _when_written(self, done: tuple[tuple[Path, ...], Finding | None]) -> None:
        paths, proof = done
        self._is_writing = False
        self._context.say(Severity.OK, self.tr("Written: {0}").format(", ".join(str(path) for path in paths)))
        if proof is not None:
            self._context.say(proof.severity, proof.message)
        self.written.emit(paths)
        self.accept()

    def _when_failed(self, error: BaseException) -> None:
        self._say_failed(self.tr("Not written: {0}").format(self._context.localized(str(error))))


class SendDialog(AnsweringDialog):
    """Puts one plan of one site onto a card or a remote controller.

    Signals
    -------
    sent(tuple of SentFile)
    """

    sent = Signal(object)

    def __init__(
        self,
        context: ApplicationContext,
        plan: Plan,
        site_model: SiteModel,
        name: str,
        parent: QWidget | None = None,
        find: Callable[[], tuple[Storage, ...]] = find_storages,
    ) -> None:
        super().__init__(context, self.tr("Send"), parent)
        self.setWindowTitle(self.tr("Send to controller"))
        self._plan, self._site_model, self._find = plan, site_model, find
        self._storages: list[Storage] = []
        self._payload: Payload | None = None
        self._prepared: PreparedSending | None = None
        self._routes: list[ChoiceBox] = []
        self._make_widgets(name)
        self._lay_out()
        self.look()

    # How it is put together

    def _make_widgets(self, name: str) -> None:
        self._place, self._app, self._name = ChoiceBox(), ChoiceBox(), QLineEdit(name)
        for app, text in (
            (App.PILOT2, self.tr("DJI Pilot 2, imports files")),
            (App.DJI_FLY, self.tr("DJI Fly, a route is replaced")),
            (App.FLIGHTHUB, self.tr("FlightHub 2, folder waylines")),
        ):
            self._app.addItem(text, app)
        self._again = QPushButton(self.tr("Look again"))
        self._again.setToolTip(self.tr("Look for cards and remote controllers that were connected meanwhile"))
        self._folder = QPushButton(self.tr("Folder ..."))
        self._folder.setToolTip(self.tr("Send into a folder that you choose"))
        self._options = ExportForm(self._context.units, only=FileFormat.DJI_KMZ)
        self._despite = QCheckBox(self.tr("Send it all the same: it may crash, or break the law"))
        self._despite.setToolTip(
            self.tr("The aircraft flies what it is sent: into things, or where flights are forbidden")
        )
        self._despite.hide()

    def _lay_out(self) -> None:
        left = QWidget()
        left.setFixedWidth(FORM_WIDTH_PX)
        buttons, self._form = QHBoxLayout(), Form()
        buttons.addWidget(self._again)
        buttons.addWidget(self._folder)
        self._form.addRow(self.tr("Device"), self._place)
        self._form.addRow("", buttons)
        self._form.addRow(self.tr("Read by"), self._app)
        self._form.addRow(self.tr("Name there"), self._name)
        self._route_rows = Form()
        left_layout = QVBoxLayout(left)
        left_layout.setContentsMargins(0, 0, 0, 0)
        left_layout.addLayout(self._form)
        left_layout.addLayout(self._route_rows)
        left_layout.addWidget(self._options)
        left_layout.addStretch(1)
        right, columns = QVBoxLayout(), QHBoxLayout()
        right.addWidget(self._state)
        right.addWidget(self._despite)
        right.addWidget(self._findings, 1)
        columns.addWidget(left)
        columns.addLayout(right, 1)
        layout = QVBoxLayout(self)
        layout.addLayout(columns, 1)
        layout.addWidget(DialogFoot(self._context))
        layout.addLayout(self._foot())
        self.resize(860, 480)
        self._ask_soon.timeout.connect(self._look_there)
        self._place.currentIndexChanged.connect(self._place_chosen)
        self._app.currentIndexChanged.connect(self._app_chosen)
        self._name.textChanged.connect(self._edited)
        self._options.valueChanged.connect(self._prepare)
        self._again.clicked.connect(self.look)
        self._folder.clicked.connect(self._choose_folder)
        self._despite.toggled.connect(self._risk_taken)
        self._action.clicked.connect(self._ask_and_send)

    # What there is

    def storage(self) -> Storage | None:
        """Where it is to go."""
        index = self._place.currentIndex()
        return self._storages[index] if 0 <= index < len(self._storages) else None

    def look(self) -> None:
        """Look for cards and remote controllers; those that were chosen as folders stay."""
        find = self._find
        self._say("heading", self.tr("Looking for cards and remote controllers ..."))
        self._action.setEnabled(False)

        def work(_context: JobContext) -> tuple[Storage, ...]:
            return find()

        self._context.start(self.tr("Look for devices"), work, self._show_storages)

    def _show_storages(self, found: Sequence[Storage]) -> None:
        self._storages = list(found)
        self._place.blockSignals(True)
        self._place.clear()
        for storage in found:
            self._place.addItem(storage.name)
            self._place.setItemData(self._place.count() - 1, str(storage.root), 3)
        self._place.blockSignals(False)
        self._place_chosen()

    def _choose_folder(self) -> None:
        folder = Questions().folder(self, self.tr("Send into this folder"), Path.home())
        if folder is not None:
            self._add(folder)

    def _add(self, folder: Path) -> None:
        """A folder that was chosen, as one more place."""

        def work(_context: JobContext) -> Storage:
            return storage_at(folder)

        def done(storage: Storage) -> None:
            others = [each for each in self._storages if each.root != storage.root]
            self._show_storages([storage, *others])

        self._context.start(self.tr("Look for devices"), work, done, self._failed)

    def _place_chosen(self) -> None:
        storage = self.storage()
        if storage is not None:
            self._app.blockSignals(True)
            self._app.setCurrentIndex(self._app.findData(storage.app))
            self._app.blockSignals(False)
        self._show_routes()
        self._prepare()

    def _app_chosen(self) -> None:
        """Read the place as another app does."""
        index, storage = self._place.currentIndex(), self.storage()
        if storage is None:
            return
        root, app = storage.root, App(self._app.currentData())

        def work(_context: JobContext) -> Storage:
            return storage_at(root, app)

        def done(found: Storage) -> None:
            if index < len(self._storages) and self._storages[index].root == root:
                self._storages[index] = found
                self._show_routes()
                self._prepare()

        self._action.setEnabled(False)
        self._context.start(self.tr("Look for devices"), work, done, self._failed)

    # What will be sent

    def _prepare(self) -> None:
        """Make the files in memory; an answer to older options is not shown."""
        plan, site_model, name = self._plan, self._site_model, self._name.text()
        options = self._options.value()[1]
        request = self._forget()
        self._payload = None
        if self.storage() is None:
            self._findings.set_findings(())
            self._findings.set_placeholder("")
            self._say(
                "warning",
                self.tr(
                    "No card or remote controller is connected. On Windows and macOS a controller that is connected by "
                    "USB has no path: use its card, or choose a folder."
                ),
            )
            return
        self._say("heading", self.tr("Making the files ..."))

        def work(_context: JobContext) -> Payload | str:
            try:
                return payload_of_plan(plan, site_model, name, options)
            except GroundStationError as error:
                return str(error)

        def done(payload: Payload | str) -> None:
            if request != self._asked:
                return
            if isinstance(payload, str):
                self._refuse(payload)
                return
            self._payload = payload
            self._show_routes()
            self._look_there()

        self._context.start(self.tr("Prepare export"), work, done, self._failed)

    def _look_there(self) -> None:
        """Find out what is at the places of the files; a device may take its time to tell."""
        payload, storage, request = self._payload, self.storage(), self._forget()
        if payload is None or storage is None:
            return
        payload = replace(payload, name=self._name.text())
        ids = [str(box.currentData()) for box in self._routes]

        def work(_context: JobContext) -> PreparedSending:
            return prepare_sending(payload, storage, ids)

        def done(prepared: PreparedSending) -> None:
            if request == self._asked:
                self._payload, self._prepared = payload, prepared
                self._show(prepared)

        self._context.start(self.tr("Look for devices"), work, done, self._failed)

    def _forget(self) -> int:
        """What is asked anew may be another mission: the risk of it is to be taken anew."""
        self._prepared = None
        self._show_risk(False)
        return super()._forget()

    def _refuse(self, reason: str) -> None:
        self._findings.set_findings(())
        self._say("error", self.tr("Cannot be sent: {0}").format(self._context.localized(reason)))

    def _show_routes(self) -> None:
        """A list of DJI Fly's routes for each sortie, the newest ones proposed."""
        storage, payload = self.storage(), self._payload
        wanted = len(payload.contents) if payload is not None else 0
        is_fly = storage is not None and storage.app is App.DJI_FLY
        self._form.setRowVisible(self._name, not is_fly)
        routes = storage.routes if storage is not None and is_fly else ()
        while self._route_rows.rowCount():
            self._route_rows.removeRow(0)
        self._routes = []
        for number in range(min(wanted, len(routes))):
            box = ChoiceBox()
            box.want_letters(30)
            for route in routes:
                box.addItem(self._route_text(route), route.id)
            box.setCurrentIndex(number)
            box.currentIndexChanged.connect(self._look_there)
            self._route_rows.addRow(self.tr("Replaced by sortie {0}").format(number + 1), box)
            self._routes.append(box)

    def _route_text(self, route: Route) -> str:
        changed = QDateTime.fromSecsSinceEpoch(round(route.modified_s))
        when = QLocale().toString(changed, QLocale.FormatType.ShortFormat)
        n = "?" if route.n_waypoints is None else str(route.n_waypoints)
        return self.tr("{0}, waypoints: {1}, {2}").format(when, n, route.id[:8])

    def _show(self, prepared: PreparedSending) -> None:
        if prepared.refusal:
            self._refuse(prepared.refusal)
            return
        n = len(prepared.targets)
        self._findings.set_findings(prepared.findings)
        self._findings.set_placeholder(self.tr("No objections to these files."))
        self._action.setEnabled(prepared.is_ready_to_fly)
        self._show_risk(not prepared.is_ready_to_fly)
        if not prepared.is_ready_to_fly:
            text = self.tr(
                "NOT ready to fly, and not sent as it stands: see the finding, and correct the plan. The aircraft "
                "flies what it is sent, into things or where flights are forbidden."
            )
            self._say("error", text)
        elif any(found.severity is Severity.WARNING for found in prepared.findings):
            self._say("warning", self.tr("Ready to be sent, files: {0}. Read the warnings.").format(n))
        else:
            self._say("ok", self.tr("Ready to be sent, files: {0}").format(n))

    def _show_risk(self, is_shown: bool) -> None:
        """The box that takes the risk is shown without its tick, each time."""
        self._despite.setChecked(False)
        self._despite.setVisible(is_shown)

    def _risk_taken(self, is_taken: bool) -> None:
        if self._prepared is not None:
            self._action.setEnabled(is_taken or self._prepared.is_ready_to_fly)

    # Sending

    def _ask_and_send(self) -> None:
        payload, storage, prepared = self._payload, self.storage(), self._prepared
        if payload is None or storage is None or prepared is None:
            return
        if prepared.replaced:
            names = ", ".join(path.name for path in prepared.replaced)
            text = self.tr("These files are replaced on {0}: {1}\n\nCopies of them are kept on this computer.")
            if not agrees(self, self.tr("Replace files?"), text.format(storage.name, names), warns=True):
                return
        backups = data_folder() / "replaced"

        def work(context: JobContext) -> tuple[SentFile, ...]:
            return send(payload, storage, prepared.targets, backups, context)

        self._is_writing = True
        self._action.setEnabled(False)
        self._show_risk(False)
        self._say("heading", self.tr("Writing and reading back ..."))
        self._context.start(
            self.tr("Send to controller"), work, lambda files: self._when_sent(files, payload), self._failed
        )

    def _when_sent(self, files: tuple[SentFile, ...], payload: Payload) -> None:
        self._is_writing = False
        against = not_ready(payload.findings)
        if against is not None:
            self._context.say(
                Severity.WARNING, self.tr("Sent all the same. {0}").format(self._context.localized(against.message))
            )
        text = self.tr("Sent, read back and equal to the plan: {0}. Eject the device before you pull it out.")
        self._context.say(Severity.OK, text.format(", ".join(str(each.path) for each in files)))
        for each in files:
            if each.backup is not None:
                self._context.say(Severity.NOTE, self.tr("What was replaced is kept: {0}").format(each.backup))
        self.sent.emit(files)
        self.accept()

    def _failed(self, error: BaseException) -> None:
        self._action.setEnabled(False)
        self._show_risk(False)
        self._say_failed(self.tr("Not sent: {0}").format(self._context.localized(str(error))))
