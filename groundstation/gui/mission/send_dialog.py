"""Send to controller: choose the card or remote controller, read what will happen, then write, read back, compare."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QDateTime, QLocale, Signal
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.mission.export_dialog import FORM_WIDTH_PX, AnsweringDialog, ExportForm
from groundstation.gui.widgets.inputs import ChoiceBox, Form
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.questions import Questions, agrees
from groundstation.services.jobs.runner import JobContext
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
from missions.mission.export_choices import FileFormat
from planning.base.errors import GroundStationError
from planning.base.findings import Severity
from planning.plan import Plan
from planning.site.records import SiteModel


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
        self._findings.set_placeholder(self.tr("No objections to these files."))
        self._action.setDefault(True)

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
        self._prepared = None
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
        self._action.setEnabled(True)
        if any(found.severity is Severity.WARNING for found in prepared.findings):
            self._say("warning", self.tr("Ready to be sent, files: {0}. Read the warnings.").format(n))
        else:
            self._say("ok", self.tr("Ready to be sent, files: {0}").format(n))

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
        self._say("heading", self.tr("Writing and reading back ..."))
        self._context.start(self.tr("Send to controller"), work, self._when_sent, self._failed)

    def _when_sent(self, files: tuple[SentFile, ...]) -> None:
        self._is_writing = False
        text = self.tr("Sent, read back and equal to the plan: {0}. Eject the device before you pull it out.")
        self._context.say(Severity.OK, text.format(", ".join(str(each.path) for each in files)))
        for each in files:
            if each.backup is not None:
                self._context.say(Severity.NOTE, self.tr("What was replaced is kept: {0}").format(each.backup))
        self.sent.emit(files)
        self.accept()

    def _failed(self, error: BaseException) -> None:
        self._action.setEnabled(False)
        self._say_failed(self.tr("Not sent: {0}").format(self._context.localized(str(error))))
