"""The import dialog: options on the left, what would come of them on the right, nothing taken over before "Import"."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QDialog,
    QHBoxLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.job_bar import DialogFoot
from groundstation.gui.scrolling import scrolled
from groundstation.gui.site.grid_form import GridForm, GridWish
from groundstation.gui.site.import_form import ImportForm
from groundstation.gui.site.import_texts import preview_text
from groundstation.gui.site.value_boxes import ErrorLine
from groundstation.gui.view3d.drawing_tools import PickedRectangle, RectangleTool
from groundstation.gui.view3d.layers import Layer
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.workspace import Workspace
from groundstation.services.jobs import Job, JobContext, JobProgress
from groundstation.services.site_sources import ImportPreview, grid_in_file, preview_import, shown_site
from planning.errors import InputError
from planning.scenes import Rectangle
from planning.site_import.options import ImportOptions
from planning.site_import.panel_grid import PanelGridError, panels_on_building

FORM_WIDTH_PX = 340
NOTES_HEIGHT_PX = 130


class ImportDialog(QDialog):
    """Looks at a file before it becomes the site.

    Signals
    -------
    imported(SiteModel)
        The user took the site over; the dialog is closed.
    """

    imported = Signal(object)

    def __init__(self, workspace: Workspace, path: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._workspace, self._path = workspace, path
        self._job: Job[ImportPreview | InputError] | None = None
        self._preview: ImportPreview | None = None
        self._is_done = False
        self.setWindowTitle(self.tr("Import {0}").format(path.name))
        self.form = ImportForm(path, workspace.units)
        self.grid = GridForm(workspace.units)
        self.grid.set_words(self.tr("Use these panels"), self.tr("Clear"))
        self.scene = SceneView(self)
        self.scene.set_units(workspace.units)
        self._summary, self._error = QLabel(), ErrorLine()
        self._summary.setWordWrap(True)
        self._notes = QPlainTextEdit()
        self._notes.setReadOnly(True)
        self._notes.setFixedHeight(NOTES_HEIGHT_PX)
        self._again = QPushButton(self.tr("Preview again"))
        self._accept = QPushButton(self.tr("Import"))
        self._accept.setProperty("primary", True)
        self._cancel = QPushButton(self.tr("Cancel"))
        self._lay_out()
        self._connect()
        self.resize(1180, 660)
        self.preview()

    def _lay_out(self) -> None:
        left = QWidget()
        column = QVBoxLayout(left)
        column.addWidget(self.form)
        heading = QLabel(self.tr("Panel grid"))
        heading.setProperty("role", "heading")
        column.addWidget(heading)
        column.addWidget(self.grid)
        column.addStretch(1)
        area = scrolled(left)
        area.setMinimumWidth(FORM_WIDTH_PX)
        right = QWidget()
        column = QVBoxLayout(right)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.scene, 1)
        for widget in (self._summary, self._error, self._notes):
            column.addWidget(widget)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(area)
        splitter.addWidget(right)
        splitter.setStretchFactor(1, 1)
        splitter.setChildrenCollapsible(False)
        buttons = QHBoxLayout()
        buttons.addWidget(self._again)
        buttons.addStretch(1)
        buttons.addWidget(self._accept)
        buttons.addWidget(self._cancel)
        layout = QVBoxLayout(self)
        layout.addWidget(splitter, 1)
        layout.addWidget(DialogFoot(self._workspace))
        layout.addLayout(buttons)

    def _connect(self) -> None:
        self.form.valueChanged.connect(self._options_changed)
        self._again.clicked.connect(self.preview)
        self._accept.clicked.connect(self.accept)
        self._cancel.clicked.connect(self.reject)
        self.grid.valueChanged.connect(self._check_grid)
        self.grid.pickAsked.connect(self._pick)
        self.grid.accepted.connect(self._use_grid)
        self.grid.cancelled.connect(self._clear_grids)
        self.scene.toolFinished.connect(self._picked)
        self._workspace.bridge.progressed.connect(self._show_progress)

    def preview(self) -> None:
        """Import into memory with the options as they are, and show what comes of it."""
        self._stop_job()
        path, options = self._path, self.form.value()
        self._say(self.tr("Reading {0} ...").format(path.name))
        self._error.show_error("")
        self._accept.setEnabled(False)

        def work(context: JobContext) -> ImportPreview | InputError:
            try:
                return preview_import(path, options, context)
            except InputError as error:  # an answer for this dialog, not a failure for the message area
                return error

        self._job = self._workspace.start(
            self.tr("Preview {0}").format(path.name), work, self._show_result, lambda _error: self._failed()
        )

    def is_busy(self) -> bool:
        """Whether the file is being read."""
        return self._job is not None

    def shown(self) -> ImportPreview | None:
        """The preview that is shown; None while there is none."""
        return self._preview

    def can_import(self) -> bool:
        """Whether what is shown can be taken over."""
        return self._accept.isEnabled()

    def error(self) -> str:
        """Why nothing can be taken over."""
        return self._error.text()

    def accept(self) -> None:
        """Take the site over, where what is shown is what the options say."""
        if self._preview is None or self._preview.model is None or not self.can_import():
            return
        model = self._preview.model
        super().accept()
        self.imported.emit(model)

    def done(self, result: int) -> None:
        """Stop reading, and free the view; asked again, there is nothing left to do."""
        if not self._is_done:
            self._is_done = True
            self._stop_job()
            self.scene.close_view()
        super().done(result)

    def _stop_job(self) -> None:
        if self._job is not None:
            self._workspace.cancel(self._job, quietly=True)
            self._job = None

    def _failed(self) -> None:
        self._job = None
        self._say(self.tr("Reading failed; the reason stands below."))

    def _show_progress(self, event: JobProgress) -> None:
        if self._job is not None and event.job_id == self._job.id:
            self._say(self.tr("Reading {0}: {1} ...").format(self._path.name, self._workspace.words(event.stage)))

    def _show_result(self, result: ImportPreview | InputError) -> None:
        self._job = None
        if self._is_done:
            return
        if isinstance(result, InputError):
            self._preview = None
            self._say("")
            self._notes.setPlainText("")
            self._error.show_error(self._words(str(result)))
            self.scene.set_site(None)
            return
        has_same_view = self._preview is not None and _without_grids(self._preview) == _without_grids(result)
        self._preview = result
        self.form.set_choices(result.source.choices)
        self.scene.set_site(shown_site(result), keep_camera=has_same_view)
        for layer in (Layer.HOME, Layer.AIRSPACE, Layer.LABELS):
            self.scene.set_layer_visible(layer, result.model is not None)
        self._notes.setPlainText("\n".join("• " + self._words(note) for note in result.notes))
        self._error.show_error(self._words(result.problem))
        self._accept.setEnabled(result.model is not None)
        self._say("" if result.model is None else preview_text(result.model, self._workspace.units))

    def _options_changed(self, _options: ImportOptions) -> None:
        self._accept.setEnabled(False)
        self._error.show_error(self.tr("The options were changed: press “Preview again”."))

    def _say(self, text: str) -> None:
        self._summary.setText(text)
        self._summary.setVisible(bool(text))

    def _words(self, text: str) -> str:
        """A message of the import in words of the window, without the folder."""
        return self._workspace.words(text.replace(f"{self._path}: ", ""))

    def _pick(self) -> None:
        wish = self.grid.value()
        self.scene.start_tool(RectangleTool(wish.n_rows, wish.n_columns))

    def _picked(self, picked: PickedRectangle) -> None:
        self.grid.set_rectangle((picked.lower_left_enu_m, picked.lower_right_enu_m, picked.upper_left_enu_m))

    def _check_grid(self, wish: GridWish) -> None:
        preview, rectangle = self._preview, wish.rectangle_enu_m
        tool = self.scene.tool()
        if isinstance(tool, RectangleTool):
            tool.set_grid(wish.n_rows, wish.n_columns)
        if preview is None or rectangle is None:
            return
        self.grid.show_state(self.tr("Checking ..."), is_good=False)

        def work(_context: JobContext) -> PanelGridError | tuple[str, ...]:
            return _grid_notes(preview, rectangle, wish)

        def checked(result: PanelGridError | tuple[str, ...]) -> None:
            if self._is_done or self.grid.value() != wish or self._preview is not preview:
                return
            if isinstance(result, PanelGridError):
                self.grid.show_error(result.field, self._workspace.words(str(result)))
            else:
                good = self.tr("The panels lie on the building and look outwards.")
                self.grid.show_state("\n".join(map(self._workspace.words, result)) or good, is_good=True)

        self._workspace.start(self.tr("Check the panel grid"), work, checked)

    def _use_grid(self) -> None:
        wish = self.grid.value()
        if self._preview is None or wish.rectangle_enu_m is None:
            return
        grid = grid_in_file(self._preview, wish.rectangle_enu_m, wish.n_rows, wish.n_columns, wish.gap_m)
        options = self.form.value()
        self.form.setValue(
            replace(options, panel_grids=(*options.panel_grids, grid), grid_tolerance_m=wish.tolerance_m)
        )
        self.grid.setValue(replace(wish, rectangle_enu_m=None))
        self.preview()

    def _clear_grids(self) -> None:
        """Forget the rectangle that was picked, and all grids before it."""
        self.scene.cancel_tool()
        self.grid.setValue(replace(self.grid.value(), rectangle_enu_m=None))
        if self.form.value().panel_grids:
            self.form.setValue(replace(self.form.value(), panel_grids=()))
            self.preview()


def _without_grids(preview: ImportPreview) -> ImportOptions:
    """What decides where the building stands."""
    return replace(preview.options, panel_grids=(), grid_tolerance_m=0.0)


def _grid_notes(preview: ImportPreview, rectangle: Rectangle, wish: GridWish) -> PanelGridError | tuple[str, ...]:
    """What is worth knowing about a grid on the building that is looked at, or why it cannot be."""
    counts = (wish.n_rows, wish.n_columns)
    try:
        return panels_on_building(
            np.array(rectangle), counts, wish.gap_m, preview.source.building, wish.tolerance_m
        ).notes
    except PanelGridError as error:
        return error
