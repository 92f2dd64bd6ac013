"""Entering a flight in the log book that this program did not watch, with the times of its photos filled in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from PySide6.QtCore import QDateTime, QLocale
from PySide6.QtWidgets import (
    QCheckBox,
    QDateTimeEdit,
    QDialog,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.inputs import Form, NumberBox, calm, moment_of
from groundstation.gui.widgets.scrolling import scrolled
from groundstation.services.fly.connection import flights_folder
from groundstation.services.fly.log_book import StatedSortie, book_path, enter_stated, stated_entry
from groundstation.services.fly.options import flight_settings_path, read_flight_settings
from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.plan import Plan
from planning.site.records import Site

LONGEST_MIN = 600.0


@dataclass(frozen=True, slots=True)
class _Row:
    """What is typed of a sortie."""

    stated: StatedSortie
    is_flown: QCheckBox
    start: QDateTimeEdit
    minutes: NumberBox
    battery: QLineEdit

    def value(self) -> StatedSortie:
        """The sortie as it is typed; what was left as it was stays exact."""
        stated = replace(self.stated, battery=self.battery.text().strip())
        if self.start.dateTime().toSecsSinceEpoch() != round(stated.started_unix_s):
            stated = replace(stated, started_unix_s=moment_of(self.start).timestamp())
        if abs(self.minutes.value() - stated.duration_s / 60.0) > 0.05:
            stated = replace(stated, duration_s=60.0 * self.minutes.value())
        return stated


class EnterFlightDialog(QDialog):
    """Edits what the photos say of a flight, and enters it in the book of the project and of this user.

    Parameters
    ----------
    stated
        Sorties as the photos say them.
    findings
        Of the report on the flight.
    """

    def __init__(
        self,
        context: ApplicationContext,
        plan: Plan,
        site: Site,
        stated: Sequence[StatedSortie],
        findings: Sequence[Finding],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Enter the flight in the log book"))
        self._context, self._plan, self._site, self._findings = context, plan, site, tuple(findings)
        about = QLabel(
            self.tr(
                "Take-off and minutes are those of the photos, and at least as long as planned. Correct them, and name "
                "the batteries: their cycles are counted."
            )
        )
        about.setWordWrap(True)
        self.rows = tuple(self._row(each) for each in stated)
        self.aircraft, self.remarks = QLineEdit(plan.aircraft.name), QLineEdit()
        self.enter, self._state = QPushButton(self.tr("Enter")), QLabel()
        self.enter.setProperty("primary", True)
        self.enter.setDefault(True)
        self._state.setWordWrap(True)
        self._state.setProperty("role", "error")
        cancel = QPushButton(self.tr("Cancel"))
        form, foot, layout = Form(), QHBoxLayout(), QVBoxLayout(self)
        form.addRow(self.tr("Aircraft"), self.aircraft)
        form.addRow(self.tr("Remarks"), self.remarks)
        foot.addStretch(1)
        foot.addWidget(cancel)
        foot.addWidget(self.enter)
        layout.addWidget(about)
        layout.addWidget(scrolled(self._table()), 1)
        layout.addLayout(form)
        layout.addWidget(self._state)
        layout.addLayout(foot)
        self.resize(620, 360)
        cancel.clicked.connect(self.reject)
        self.enter.clicked.connect(self._enter)
        self.finished.connect(self.deleteLater)
        self._show_state()

    def state_text(self) -> str:
        """Why it was not entered; empty where nothing is wrong."""
        return self._state.text()

    def _row(self, stated: StatedSortie) -> _Row:
        name = self.tr("Sortie {0}").format(stated.number)
        row = _Row(stated, QCheckBox(name), QDateTimeEdit(), NumberBox(0.1, LONGEST_MIN, 1.0, " min"), QLineEdit())
        row.is_flown.setChecked(True)
        row.is_flown.toggled.connect(self._show_state)
        calm(row.start)
        row.start.setLocale(QLocale.c())
        row.start.setDisplayFormat("yyyy-MM-dd HH:mm:ss")
        row.start.setDateTime(QDateTime.fromSecsSinceEpoch(round(stated.started_unix_s)))
        row.start.setAccessibleName(self.tr("{0}, take-off").format(name))
        row.start.setToolTip(self.tr("By this computer's clock and time zone"))
        row.minutes.setValue(stated.duration_s / 60.0)
        row.minutes.setAccessibleName(self.tr("{0}, minutes").format(name))
        row.battery.setMaxLength(40)
        row.battery.setAccessibleName(self.tr("{0}, battery").format(name))
        return row

    def _table(self) -> QWidget:
        table, grid = QWidget(), QGridLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        for column, title in enumerate(
            (self.tr("Take-off"), self.tr("Time"), self.tr("Battery"), self.tr("Photos")), 1
        ):
            grid.addWidget(QLabel(title), 0, column)
        for number, row in enumerate(self.rows, 1):
            photos = QLabel(str(row.stated.n_photos))
            for column, widget in enumerate((row.is_flown, row.start, row.minutes, row.battery, photos)):
                grid.addWidget(widget, number, column)
        grid.setColumnStretch(3, 1)
        layout = QVBoxLayout(table)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(grid)
        layout.addStretch(1)
        return table

    def _show_state(self) -> None:
        self.enter.setEnabled(any(row.is_flown.isChecked() for row in self.rows))

    def _enter(self) -> None:
        folder = self._context.session.folder
        books = (book_path(),) if folder is None else (book_path(flights_folder(folder)), book_path())
        operator = read_flight_settings(flight_settings_path()).operator
        entries = [
            stated_entry(
                row.value(),
                self._plan,
                self._site,
                aircraft=self.aircraft.text().strip(),
                operator=operator,
                remarks=self.remarks.text().strip(),
                findings=self._findings,
            )
            for row in self.rows
            if row.is_flown.isChecked()
        ]
        try:
            enter_stated(entries, books)
        except InputError as error:
            self._state.setText(self._context.localized(str(error)))
            return
        self._context.say(Severity.OK, self.tr("Entered in the log book, sorties: {0}").format(len(entries)))
        self.accept()
