"""SORA: the pilot states what is known, sees volumes, numbers and what was simulated, and saves the draft."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor
from PySide6.QtWidgets import (
    QHBoxLayout,
    QScrollArea,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.map.map_view import MapView
from groundstation.gui.mission.export_dialog import AnsweringDialog
from groundstation.gui.widgets.inputs import ChoiceBox, Form
from groundstation.gui.widgets.job_bar import DialogFoot
from groundstation.gui.widgets.parameter_form import ParameterRow, add_rows, rows_of
from groundstation.gui.widgets.questions import Questions
from groundstation.gui.widgets.scrolling import resize_on_screen
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.gui.widgets.value_boxes import FileBox
from groundstation.services.jobs.runner import JobContext
from groundstation.services.mission.sora import (
    SoraDraft,
    buffer_text,
    class_text,
    simulated_text,
    sora_draft,
    table_rows,
    table_titles,
    volume_shapes,
    write_sora,
)
from planning.base.errors import GroundStationError
from planning.base.findings import Severity
from planning.base.messages import say
from planning.base.parameters import declared
from planning.insight.ground_risk import known_body, usual_wind_m_s
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.plan import Plan
from planning.site.importing.elevation import HEIGHT_FILES
from planning.site.records import SiteModel

FORM_WIDTH_PX = 380

KNOWN = declared(GroundRiskRequest)


class GroundRiskForm(QWidget):
    """`value()`, `setValue()` and `valueChanged` of what a pilot states; boxes begin with what is known already.

    What is left as it is known counts as not stated, so that its source stays the aircraft or the plan.
    """

    valueChanged = Signal()  # noqa: N815  (Qt's own way of naming)

    def __init__(self, plan: Plan, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        people = {"population": ParameterRow(KNOWN["population"], self._people_text)}
        self._rows = people | rows_of(KNOWN, but=tuple(people))
        self._known: dict[str, Any] = {}
        self._take_known(plan)
        first = {name: row for name, row in self._rows.items() if KNOWN[name].parameter.row == "first"}
        more = {name: row for name, row in self._rows.items() if name not in first}
        self._more, self._further = QToolButton(), QWidget()
        self._more.setText(self.tr("More settings"))
        self._more.setCheckable(True)
        form, further = Form(), Form(self._further)
        add_rows(form, first)
        self.people = FileBox(
            self.tr("People from a raster ..."),
            self.tr("Population raster"),
            self.tr("Population rasters (*.tif *.tiff);;All files (*)"),
        )
        self.people.setToolTip(
            self.tr("GeoTIFF of GHS-POP, WorldPop or others: people below the buffer, beside what you state")
        )
        self.ground = FileBox(
            self.tr("Ground from a raster ..."),
            self.tr("Heights of the ground"),
            self.tr("Heights ({0});;All files (*)").format(" ".join(f"*{ending}" for ending in HEIGHT_FILES)),
        )
        self.ground.setToolTip(
            self.tr("GeoTIFF of the ground's heights, for this assessment in place of the site's own terrain")
        )
        add_rows(further, more)
        further.setContentsMargins(0, 0, 0, 0)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(self.people)
        layout.addWidget(self.ground)
        layout.addWidget(self._more)
        layout.addWidget(self._further)
        layout.addStretch(1)
        self._further.hide()
        self._more.toggled.connect(self._further.setVisible)
        for row in self._rows.values():
            row.valueChanged.connect(self.valueChanged)
        for box in self._files().values():
            box.valueChanged.connect(lambda _path: self.valueChanged.emit())

    def _people_text(self, band: str | None) -> str:
        """A word of SORA for people per square kilometre, with its number; None: nobody said."""
        texts = {
            None: self.tr("not stated"),
            "controlled": self.tr("controlled: nobody"),
            "remote": self.tr("remote: under 5 per km²"),
            "lightly": self.tr("lightly: under 50 per km²"),
            "sparsely": self.tr("sparsely: under 500 per km²"),
            "suburban": self.tr("suburban: under 5000 per km²"),
            "city": self.tr("city: under 50000 per km²"),
            "assembly": self.tr("assembly: more"),
        }
        return texts[band]

    def _files(self) -> dict[str, FileBox]:
        """Boxes of files, by the name of their parameter."""
        return {"population_raster": self.people, "terrain_raster": self.ground}

    def row(self, name: str) -> ParameterRow:
        """The row of a parameter."""
        return self._rows[name]

    def value(self) -> GroundRiskRequest:
        """What the pilot states.

        Raises
        ------
        ValueError
            Two mitigations exclude each other.
        """
        values: dict[str, Any] = {name: row.value() for name, row in self._rows.items()}
        values |= {name: None for name, known in self._known.items() if values[name] == known}
        values |= {name: str(box.value()) for name, box in self._files().items() if box.value() is not None}
        return GroundRiskRequest(**values)

    def setValue(self, request: GroundRiskRequest) -> None:  # noqa: N802
        """Show another request; what it leaves open stays as it is known."""
        for name, row in self._rows.items():
            row.setValue(getattr(request, name))
        for name, box in self._files().items():
            path = getattr(request, name)
            box.setValue(None if path is None else Path(path))

    def _take_known(self, plan: Plan) -> None:
        """Put into the boxes what aircraft and plan say; a box of what nobody knows begins at its lowest value."""
        body = known_body(plan)
        known = {"wind_m_s": usual_wind_m_s(plan)}
        if body is not None:
            known |= {
                "dimension_m": body.characteristic_dimension_m,
                "mass_kg": body.max_takeoff_mass_kg,
                "speed_m_s": body.full_speed_m_s,
                "tilt_deg": body.braking_tilt_deg,
            }
        for name, value in known.items():
            self._rows[name].setValue(value)
        for name, row in self._rows.items():
            if KNOWN[name].default is None and not isinstance(row.widget, ChoiceBox):
                self._known[name] = row.value()


class SoraDialog(AnsweringDialog):
    """Ground risk of one plan on one site.

    Signals
    -------
    drafted(SoraDraft)
        A draft of what is stated now was made.
    """

    drafted = Signal(object)

    def __init__(
        self,
        context: ApplicationContext,
        plan: Plan,
        site_model: SiteModel,
        name: str,
        request: GroundRiskRequest | None = None,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(context, self.tr("Save draft ..."), parent)
        self.setWindowTitle(self.tr("Ground risk (SORA 2.5)"))
        self._plan, self._site_model, self._name = plan, site_model, name
        self._draft: SoraDraft | None = None
        self.form, self.map = GroundRiskForm(plan), MapView()
        if request is not None:
            self.form.setValue(request)
        titles = table_titles(context.localized)
        columns = [Column(title, _cell(number)) for number, title in enumerate(titles)]
        self._rows: RowModel[tuple[str, ...]] = RowModel(columns, self)
        self._table = table_of(self._rows, self.tr("Numbers with formula and source"))
        self._action.setToolTip(self.tr("Table, KML and GeoJSON into a folder"))
        self._lay_out()
        self.map.set_units(context.units)
        self.map.set_site(site_model)
        self.map.set_plan(plan)
        self._ask_soon.timeout.connect(self._assess)
        self.form.valueChanged.connect(self._edited)
        self._action.clicked.connect(self._choose_folder)
        self._assess()

    def draft(self) -> SoraDraft | None:
        """The draft of what is stated now; None while it is being made."""
        return self._draft

    def table_texts(self) -> list[tuple[str, ...]]:
        """Rows of the table."""
        return list(self._rows.rows())

    def _lay_out(self) -> None:
        scroll = QScrollArea()
        scroll.setWidget(self.form)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QScrollArea.Shape.NoFrame)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setFixedWidth(FORM_WIDTH_PX)
        below = QSplitter()
        below.addWidget(self._table)
        below.addWidget(self._findings)
        below.setSizes([480, 280])
        right, columns = QVBoxLayout(), QHBoxLayout()
        right.addWidget(self._state)
        right.addWidget(self.map, 3)
        right.addWidget(below, 2)
        columns.addWidget(scroll)
        columns.addLayout(right, 1)
        layout = QVBoxLayout(self)
        layout.addLayout(columns, 1)
        layout.addWidget(DialogFoot(self._context))
        layout.addLayout(self._foot())
        resize_on_screen(self, 1180, 760)

    def _forget(self) -> int:
        self._draft = None
        return super()._forget()

    def _assess(self) -> None:
        number = self._forget()
        try:
            request = self.form.value()
        except ValueError as error:
            self._refuse(str(error))
            return
        plan, site_model, name = self._plan, self._site_model, self._name
        self._say("heading", self.tr("Assessing, and letting aircraft fly away ..."))

        def work(context: JobContext) -> SoraDraft | str:
            try:
                return sora_draft(plan, site_model, request, name, monitor=context)
            except GroundStationError as error:
                return str(error)

        def done(result: SoraDraft | str) -> None:
            if number != self._asked:
                return
            if isinstance(result, str):
                self._refuse(result)
            else:
                self._show(result)

        self._context.start(self.tr("Ground risk"), work, done, self._failed)

    def _show(self, draft: SoraDraft) -> None:
        self._draft = draft
        risk = draft.risk
        people = say("uninvolved people inside: {}", risk.people_allowed)
        lines = buffer_text(risk), class_text(risk), people, simulated_text(draft.fly_aways)
        texts = [self._context.localized(line) for line in lines]
        texts.append(self.tr("A draft: check every number before you use it."))
        worst = {found.severity for found in draft.findings}
        role = "error" if Severity.ERROR in worst else "warning" if Severity.WARNING in worst else "ok"
        self._say(role, "\n".join(text[:1].upper() + text[1:] for text in texts))
        self._rows.set_rows(list(table_rows(risk, self._context.localized)))
        letter_px = self.fontMetrics().averageCharWidth()
        for column, n_letters in enumerate((9, 28, 11, 22)):
            self._table.setColumnWidth(column, n_letters * letter_px)
        self._findings.set_findings(draft.findings)
        self.map.set_volumes([(QColor(colour), rings) for colour, rings in volume_shapes(draft)])
        self.map.look_at_volumes()
        self._action.setEnabled(True)
        self.drafted.emit(draft)

    def _refuse(self, reason: str) -> None:
        self._rows.set_rows(())
        self._findings.set_findings(())
        self.map.set_volumes([])
        self._say("error", self.tr("Not assessed: {0}").format(self._context.localized(reason)))

    def _failed(self, error: BaseException) -> None:
        self._refuse(str(error))

    def _not_saved(self, error: BaseException) -> None:
        self._say_failed(self.tr("Not written: {0}").format(self._context.localized(str(error))))

    def _choose_folder(self) -> None:
        project = self._context.session.folder
        folder = Questions().folder(self, self.tr("Save the draft into this folder"), project or Path.home())
        if folder is not None:
            self.save(folder)

    def save(self, folder: Path) -> None:
        """Write the files of the draft into a folder."""
        draft, words = self._draft, self._context.localized
        if draft is None:
            return

        def work(_context: JobContext) -> tuple[Path, ...]:
            return write_sora(draft, folder, words)

        def done(paths: tuple[Path, ...]) -> None:
            self._is_writing = False
            if not self.isVisible():
                self._let_go()
            names = ", ".join(path.name for path in paths)
            self._context.say(Severity.OK, self.tr("Draft saved in {0}: {1}").format(folder, names))

        self._is_writing = True
        self._context.start(self.tr("Save draft"), work, done, self._not_saved)

    def _let_go(self) -> None:
        self.map.close_view()
        super()._let_go()


def _cell(number: int) -> Callable[[tuple[str, ...]], str]:
    """What stands in a column of a row."""
    return lambda row: row[number]
