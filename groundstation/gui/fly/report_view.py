"""The flight report: what was achieved in figures, every view with its photo or the reason why it has none."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.widgets.scrolling import scrolled
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.services.fly.events import FlightEnded
from groundstation.services.units import UnitSystem, length_unit, minutes_text, per_cent
from missions.flight.outcome import FlightReport, Reason, ViewOutcome

UNKNOWN = "-"


class ReportView(QWidget):
    """Shows the report of a flight that ended.

    Signals
    -------
    picked(str)
        Identifier of a view.
    topUpRequested(), resumeRequested()
    """

    picked = Signal(str)
    topUpRequested = Signal()  # noqa: N815  (Qt's own way of naming)
    resumeRequested = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._report: FlightReport | None = None
        self._ended: FlightEnded | None = None
        self._units = UnitSystem.METRIC
        self._words = QLabel()
        self._words.setWordWrap(True)
        self._words.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._model: RowModel[ViewOutcome] = RowModel(self._columns(), self)
        self.table = table_of(self._model, self.tr("Views of the flight"))
        self.table.clicked.connect(self._row_picked)
        self.table.activated.connect(self._row_picked)
        self.top_up = QPushButton(self.tr("Top-up flight"))
        self.top_up.setToolTip(self.tr("Plan the shortest flight that closes what is missing, with the battery left"))
        self.resume = QPushButton(self.tr("Resume sortie"))
        self.resume.setToolTip(self.tr("Plan the rest of the sortie that was interrupted, for a full battery"))
        self.top_up.clicked.connect(self.topUpRequested)
        self.resume.clicked.connect(self.resumeRequested)
        side = QVBoxLayout()
        side.addWidget(scrolled(self._words), 1)
        buttons = QHBoxLayout()
        for button in (self.top_up, self.resume):
            buttons.addWidget(button)
        side.addLayout(buttons)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addLayout(side, 2)
        layout.addWidget(self.table, 3)
        self.set_ended(None)

    def set_ended(self, ended: FlightEnded | None) -> None:
        """Show a flight, or none."""
        self._ended, self._report = ended, None if ended is None else ended.report
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._model.set_columns(self._columns())
        self._fill()

    def text(self) -> str:
        """The figures."""
        return self._words.text()

    def rows(self) -> tuple[tuple[str, ...], ...]:
        """What stands in the table."""
        columns = self._columns()
        return tuple(tuple(column.text(row) for column in columns) for row in self._model.rows())

    def _fill(self) -> None:
        report = self._report
        self._model.set_rows(() if report is None else report.views)
        self.table.resizeColumnsToContents()
        views = () if report is None else report.views
        is_open = any(view.reason is not Reason.TAKEN for view in views)
        self.resume.setEnabled(is_open)
        self.top_up.setEnabled(report is not None)
        self._words.setText(
            self.tr("After the landing, the flight report stands here.")
            if report is None
            else "\n".join(self._lines(report))
        )

    def _lines(self, report: FlightReport) -> list[str]:
        found, length = report.summary, length_unit(self._units)
        lines = [
            self.tr("Photos: {0} of {1} views; sections covered: {2} of {3} planned ({4:.1f} %)").format(
                found.n_taken,
                found.n_views,
                found.covered,
                found.covered_planned,
                per_cent(found.covered, found.covered_planned),
            )
        ]
        if found.duration_flown_s is not None:
            lines.append(self.tr("Flown: {0}").format(minutes_text(found.duration_flown_s)))
        used = sum(sortie.battery_used or 0.0 for sortie in report.sorties)
        if used:
            lines.append(self.tr("Battery used: {0:.0%}").format(used))
        if found.least_distance_m is not None:
            lines.append(self.tr("Smallest distance kept: {0}").format(length.text(found.least_distance_m)))
        if found.lost_panels:
            lines.append(self.tr("Panels that no photo shows: {0}").format(len(found.lost_panels)))
        if self._ended is not None and self._ended.path is not None:
            lines.append(self.tr("Kept in {0}").format(self._ended.path))
        return lines

    def _columns(self) -> tuple[Column[ViewOutcome], ...]:
        length = length_unit(self._units)

        def metres(value: float | None) -> str:
            return UNKNOWN if value is None else length.text(value)

        def degrees(value: float | None) -> str:
            return UNKNOWN if value is None else f"{value:+.1f}"

        reasons = self._reasons()
        return (
            Column(self.tr("View"), lambda row: row.view_id),
            Column(self.tr("Sortie"), lambda row: str(row.sortie), is_number=True),
            Column(self.tr("Photo"), lambda row: reasons[row.reason]),
            Column(self.tr("Place off"), lambda row: metres(row.position_error_m), is_number=True),
            Column(self.tr("Heading off, deg"), lambda row: degrees(row.heading_error_deg), is_number=True),
            Column(self.tr("Pitch off, deg"), lambda row: degrees(row.gimbal_pitch_error_deg), is_number=True),
            Column(
                self.tr("Blur, px"),
                lambda row: UNKNOWN if row.blur_px is None else f"{row.blur_px:.1f}",
                is_number=True,
            ),
            Column(self.tr("Distance"), lambda row: metres(row.distance_m), is_number=True),
        )

    def _reasons(self) -> dict[Reason, str]:
        return {
            Reason.TAKEN: self.tr("taken"),
            Reason.NOT_FLOWN: self.tr("sortie not flown"),
            Reason.NOT_REACHED: self.tr("not reached"),
            Reason.NO_PHOTO: self.tr("no answer of the camera"),
            Reason.REPORT_LOST: self.tr("taken, but its report was lost"),
            Reason.TOO_FAR: self.tr("taken too far away"),
            Reason.WRONG_ANGLE: self.tr("looks elsewhere"),
            Reason.FLIGHT_ENDED: self.tr("not reached, flight broken off"),
            Reason.NOT_RECORDED: self.tr("not recorded any more"),
            Reason.NO_TRACK: self.tr("place not known"),
        }

    def _row_picked(self, index: QModelIndex) -> None:
        self.picked.emit(self._model.row(index).view_id)
