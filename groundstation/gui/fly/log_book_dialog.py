"""The log book: flights of this project or of this user, cycles of batteries, and the table for spreadsheets."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QDateTime, QLocale, Qt
from PySide6.QtWidgets import QCheckBox, QDialog, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.widgets.questions import choose_new_file
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.services.fly.connection import flights_folder
from groundstation.services.fly.log_book import (
    BookEntry,
    battery_uses,
    book_path,
    read_book,
    write_book_csv,
)
from groundstation.services.units import minutes_text
from planning.base.errors import InputError
from planning.base.findings import Severity

UNKNOWN = "-"


class LogBookDialog(QDialog):
    """Shows the book; writes it as a table."""

    def __init__(self, context: ApplicationContext, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Log book"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self._context = context
        self._entries: tuple[BookEntry, ...] = ()
        self.every, self.simulated = QCheckBox(self.tr("Flights of all projects")), QCheckBox(self.tr("Simulated, too"))
        self._model: RowModel[BookEntry] = RowModel(self._columns(), self)
        self.table = table_of(self._model, self.tr("Flights"))
        self._batteries, self._state = QLabel(), QLabel()
        self.export = QPushButton(self.tr("Export as CSV ..."))
        close = QPushButton(self.tr("Close"))
        for label in (self._batteries, self._state):
            label.setWordWrap(True)
        head, foot = QHBoxLayout(), QHBoxLayout()
        head.addWidget(self.every)
        head.addWidget(self.simulated)
        head.addStretch(1)
        foot.addWidget(self._state, 1)
        foot.addWidget(close)
        foot.addWidget(self.export)
        layout = QVBoxLayout(self)
        layout.addLayout(head)
        layout.addWidget(self.table, 1)
        layout.addWidget(self._batteries)
        layout.addLayout(foot)
        self.resize(860, 460)
        has_project = context.session.folder is not None
        self.every.setChecked(not has_project)
        self.every.setEnabled(has_project)
        self.every.toggled.connect(lambda _is_on: self._read())
        self.simulated.toggled.connect(lambda _is_on: self._show())
        self.export.clicked.connect(self._choose_file)
        close.clicked.connect(self.reject)
        self._read()

    def batteries_text(self) -> str:
        """What is said of the batteries."""
        return self._batteries.text()

    def state_text(self) -> str:
        """What is said of the book."""
        return self._state.text()

    def shown_entries(self) -> tuple[BookEntry, ...]:
        """Flights that are shown."""
        return tuple(each for each in self._entries if self.simulated.isChecked() or not each.is_simulated)

    def write(self, path: Path) -> None:
        """Write what is shown as a table."""
        try:
            write_book_csv(path, self.shown_entries())
        except InputError as error:
            self._state.setText(self._context.localized(str(error)))
            return
        self._state.setText(self.tr("Written: {0}").format(path))
        self._context.say(Severity.OK, self.tr("Written: {0}").format(path))

    def _read(self) -> None:
        folder = self._context.session.folder
        path = book_path(None if self.every.isChecked() or folder is None else flights_folder(folder))
        try:
            self._entries = read_book(path)
            self._state.setText("")
        except InputError as error:
            self._entries = ()
            self._state.setText(self._context.localized(str(error)))
        self._show()

    def _show(self) -> None:
        shown = self.shown_entries()
        self._model.set_rows(tuple(reversed(shown)))
        self.table.resizeColumnsToContents()
        self.export.setEnabled(bool(shown))
        uses = battery_uses(self._entries)
        self._batteries.setText(
            "\n".join(
                self.tr("Battery {0}: flights: {1}, cycles: {2:.1f}").format(use.name, use.n_flights, use.cycles)
                for use in uses
            )
        )
        n_hidden = len(self._entries) - len(shown)
        if n_hidden and not shown:
            self._state.setText(self.tr("No flights yet; simulated ones: {0}").format(n_hidden))

    def _choose_file(self) -> None:
        folder = self._context.session.folder or Path.home()
        kinds = self.tr("Tables (*{0})").format(".csv")
        path = choose_new_file(self, self.tr("Write the log book"), folder / "log-book.csv", kinds, ".csv")
        if path is not None:
            self.write(path)

    def _columns(self) -> tuple[Column[BookEntry], ...]:
        def when(entry: BookEntry) -> str:
            moment = QDateTime.fromSecsSinceEpoch(round(entry.started_unix_s))
            return str(QLocale().toString(moment, QLocale.FormatType.ShortFormat))

        return (
            Column(self.tr("Start"), when),
            Column(self.tr("Time"), lambda row: minutes_text(row.duration_s), is_number=True),
            Column(self.tr("Site"), lambda row: row.site),
            Column(self.tr("Aircraft"), lambda row: row.aircraft),
            Column(self.tr("Battery"), lambda row: row.battery or UNKNOWN),
            Column(
                self.tr("Charge used"),
                lambda row: UNKNOWN if row.battery_used is None else f"{row.battery_used:.0%}",
                is_number=True,
            ),
            Column(self.tr("Photos"), lambda row: f"{row.n_photos}/{row.n_planned}", is_number=True),
            Column(self.tr("Findings"), lambda row: str(len(row.findings)), is_number=True),
            Column(self.tr("Ended"), lambda row: self._context.localized(row.ended) or self.tr("landed")),
        )
