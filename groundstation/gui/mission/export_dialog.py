"""Export: choose format and options, read what the checks of the files say, then write them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QTimer, Signal
from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.job_bar import DialogFoot
from groundstation.gui.mission.export_form import ExportForm
from groundstation.gui.mission.findings_list import FindingsList
from groundstation.gui.questions import agrees, choose_new_file, file_name
from groundstation.gui.workspace import Workspace
from groundstation.services.jobs import JobContext
from groundstation.services.mission_files import (
    SUFFIXES,
    PreparedExport,
    export_paths,
    prepare_export,
    write_export,
)
from planning.findings import Severity
from planning.folders import PLAIN_ENDINGS
from planning.plan import Plan
from planning.site import SiteModel

FORM_WIDTH_PX = 360

REST_MS = 200


class ExportDialog(QDialog):
    """Exports one plan of one site.

    Signals
    -------
    written(tuple of Path)
    """

    written = Signal(object)

    def __init__(
        self, workspace: Workspace, plan: Plan, site_model: SiteModel, folder: Path, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Export mission files"))
        self._workspace, self._plan, self._site_model, self._folder = workspace, plan, site_model, folder
        self._prepared: PreparedExport | None = None
        self._asked = 0
        self._form = ExportForm(workspace.units)
        self._state = QLabel()
        self._state.setWordWrap(True)
        self._findings = FindingsList()
        self._findings.set_units(workspace.units)
        self._write = QPushButton(self.tr("Write ..."))
        self._write.setProperty("primary", True)
        self._write.setDefault(True)
        close = QPushButton(self.tr("Close"))
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
        buttons = QHBoxLayout()
        buttons.addStretch(1)
        buttons.addWidget(close)
        buttons.addWidget(self._write)
        layout = QVBoxLayout(self)
        layout.addLayout(columns, 1)
        layout.addWidget(DialogFoot(workspace))
        layout.addLayout(buttons)
        self.resize(820, 460)
        # Turning a wheel through the choices makes one set of files, not one for each.
        self._prepare_soon = QTimer(self, interval=REST_MS, singleShot=True)
        self._prepare_soon.timeout.connect(self._prepare)
        self._form.valueChanged.connect(self._wishes_changed)
        self._write.clicked.connect(self._choose_file)
        close.clicked.connect(self.reject)
        self._prepare()

    def form(self) -> ExportForm:
        """Format and options."""
        return self._form

    def prepared(self) -> PreparedExport | None:
        """What would be written; None while it is being made."""
        return self._prepared

    def state_text(self) -> str:
        """What is said of the files."""
        return self._state.text()

    def findings(self) -> FindingsList:
        """What the checks say of the files."""
        return self._findings

    def folder(self) -> Path:
        """Where files were written last."""
        return self._folder

    def write(self, path: Path) -> None:
        """Write the files that are ready; the first to `path`."""
        prepared = self._prepared
        if prepared is None:
            return
        self._folder = path.parent

        def work(_context: JobContext) -> tuple[Path, ...]:
            return write_export(prepared, path)

        self._workspace.start(self.tr("Export"), work, self._when_written, self._when_failed)

    def _wishes_changed(self) -> None:
        self._asked += 1
        self._prepared = None
        self._write.setEnabled(False)
        self._prepare_soon.start()

    def _prepare(self) -> None:
        """Make the files in memory; an answer to an older wish is not shown."""
        file_format, options = self._form.value()
        plan, site_model = self._plan, self._site_model
        self._asked += 1
        asked, self._prepared = self._asked, None
        self._write.setEnabled(False)
        self._say("heading", self.tr("Making the files ..."))

        def work(_context: JobContext) -> PreparedExport:
            return prepare_export(plan, site_model, file_format, options)

        def done(prepared: Any) -> None:
            if asked == self._asked:
                self._show(prepared)

        self._workspace.start(self.tr("Prepare export"), work, done)

    def _show(self, prepared: PreparedExport) -> None:
        self._prepared = prepared
        self._findings.set_findings(prepared.findings)
        self._findings.set_placeholder("" if prepared.encoded is None else self.tr("No objections to these files."))
        self._write.setEnabled(prepared.can_be_written)
        if prepared.encoded is None:
            self._say("error", self.tr("Cannot be exported: {0}").format(prepared.refusal))
        elif not prepared.can_be_written:
            self._say("error", self.tr("Not to be written like this: see the errors."))
        elif any(found.severity is Severity.WARNING for found in prepared.findings):
            self._say(
                "warning", self.tr("Ready to be written, files: {0}. Read the warnings.").format(prepared.n_files)
            )
        else:
            self._say("ok", self.tr("Ready to be written, files: {0}").format(prepared.n_files))

    def _say(self, role: str, text: str) -> None:
        self._state.setProperty("role", role)
        self._state.style().polish(self._state)
        self._state.setText(text)

    def _choose_file(self) -> None:
        file_format, _ = self._form.value()
        suffix = SUFFIXES[file_format][0]
        proposed = self._folder / f"{file_name(self._plan.site)}{suffix}"
        kinds = self.tr("Mission files (*{0})").format(suffix)
        others = (*SUFFIXES[file_format][1:], *PLAIN_ENDINGS)
        path = choose_new_file(self, self.tr("Write mission files"), proposed, kinds, suffix, others)
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

    def _when_written(self, paths: tuple[Path, ...]) -> None:
        self._workspace.say(Severity.OK, self.tr("Written: {0}").format(", ".join(str(path) for path in paths)))
        self.written.emit(paths)
        self.accept()

    def _when_failed(self, error: BaseException) -> None:
        self._say("error", self.tr("Not written: {0}").format(self._workspace.words(str(error))))
