"""What the pilot reads: in flight at a glance, in large figures, and afterwards as a report of every view."""

from __future__ import annotations

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.widgets.scrolling import scrolled
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.services.fly.events import FlightEnded, LiveView, PhotoCounted, Readouts, ViewState
from groundstation.services.units import UnitSystem, length_unit, minutes_text, per_cent, speed_unit
from groundstation.vehicle.preflight import FIX_NAMES
from missions.flight.outcome import FlightReport, Reason, ViewOutcome

UNKNOWN = "-"


# The flight report: what was achieved in figures, every view with its photo or the reason why it has none.


class ReportView(QWidget):
    """Shows the report of a flight that ended.

    Signals
    -------
    picked(str)
        Identifier of a view.
    topUpRequested(), resumeRequested(), logRequested()
    """

    picked = Signal(str)
    topUpRequested = Signal()  # noqa: N815  (Qt's own way of naming)
    resumeRequested = Signal()  # noqa: N815
    logRequested = Signal()  # noqa: N815

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
        self.log = QPushButton()
        self.log.setToolTip(
            self.tr("Fetch the autopilot's own log from its card, and report from it: it knows what the link lost")
        )
        self.log.clicked.connect(self.logRequested)
        side = QVBoxLayout()
        side.addWidget(scrolled(self._words), 1)
        buttons = QHBoxLayout()
        for button in (self.top_up, self.resume, self.log):
            buttons.addWidget(button)
        side.addLayout(buttons)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.addLayout(side, 2)
        layout.addWidget(self.table, 3)
        self.set_log(may_fetch=False, is_fetching=False)
        self.set_ended(None)

    def set_log(self, *, may_fetch: bool, is_fetching: bool) -> None:
        """Offer to fetch the vehicle's own log, or to stop that."""
        text = self.tr("Stop fetching") if is_fetching else self.tr("Vehicle's log")
        if self.log.text() != text:
            self.log.setText(text)
        set_enabled(self.log, may_fetch)

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


FIGURE_SCALE = 1.7
DONE = (ViewState.TAKEN, ViewState.OFF)


class ReadoutsView(QWidget):
    """Two columns of figures; those that a warning is about are shown in its colour."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._units = UnitSystem.METRIC
        self._view: LiveView | None = None
        self._is_live = False
        self._tiles: dict[str, _Tile] = {}
        self._coverage = QProgressBar()
        self._coverage.setRange(0, 1000)
        self._coverage.setTextVisible(False)
        self._covered = QLabel()
        self._covered.setWordWrap(True)
        self._counted: PhotoCounted | None = None
        layout = QGridLayout(self)
        layout.setContentsMargins(4, 4, 4, 4)
        layout.setSpacing(4)
        for number, (name, caption) in enumerate(self._captions()):
            tile = self._tiles[name] = _Tile(caption)
            layout.addWidget(tile, number // 2, number % 2)
        for column in (0, 1):
            layout.setColumnStretch(column, 1)
        layout.addWidget(self._covered, len(self._tiles) // 2 + 1, 0, 1, 2)
        layout.addWidget(self._coverage, len(self._tiles) // 2 + 2, 0, 1, 2)
        self._show()

    def _captions(self) -> tuple[tuple[str, str], ...]:
        return (
            ("height", self.tr("above take-off")),
            ("speed", self.tr("speed")),
            ("facade", self.tr("facade")),
            ("photos", self.tr("photos")),
            ("battery", self.tr("battery")),
            ("left", self.tr("to reserve")),
            ("wind", self.tr("wind")),
            ("gnss", self.tr("GNSS")),
        )

    def set_view(self, view: LiveView | None) -> None:
        """Show a flight as it stands."""
        self._view = view
        self._show()

    def set_live(self, *, is_live: bool) -> None:
        """Say whether the vehicle is connected: what it told last is not shown for what it is now."""
        if is_live is not self._is_live:
            self._is_live = is_live
            self._show()

    def set_counted(self, counted: PhotoCounted | None) -> None:
        """Show the coverage after a photo."""
        self._counted = counted
        self._show_coverage()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        self._units = units
        self._show()

    def text(self) -> str:
        """Everything that is shown."""
        return "\n".join([*(tile.text() for tile in self._tiles.values()), self._covered.text()])

    def _show(self) -> None:
        view = self._view
        shown = view.readouts if view is not None and self._is_live else Readouts()
        length, speed = length_unit(self._units), speed_unit(self._units)
        codes = {} if view is None else {warning.code: warning.severity.value for warning in view.warnings}
        states = () if view is None else view.view_states
        n_done = sum(state in DONE for _, state in states)
        n_missing = sum(state is ViewState.MISSING for _, state in states)
        photos = f"{n_done}/{len(states)}" if states else UNKNOWN
        self._tiles["photos"].set_text(
            photos, "" if n_missing == 0 else "warning", self.tr("{0} missing").format(n_missing) if n_missing else ""
        )
        fix = UNKNOWN if shown.fix_type is None else FIX_NAMES.get(shown.fix_type, str(shown.fix_type))
        for name, text, code in (
            ("height", UNKNOWN if shown.height_m is None else length.text(shown.height_m), "airspace"),
            ("speed", UNKNOWN if shown.speed_m_s is None else speed.text(shown.speed_m_s), "off-path"),
            ("facade", UNKNOWN if shown.facade_m is None else length.text(shown.facade_m), "facade-distance"),
            ("battery", UNKNOWN if shown.battery is None else f"{shown.battery:.0%}", "battery"),
            ("left", UNKNOWN if shown.battery_left_s is None else minutes_text(shown.battery_left_s), "battery"),
            ("wind", UNKNOWN if shown.wind_m_s is None else speed.text(shown.wind_m_s), "wind"),
            ("gnss", fix, "gnss"),
        ):
            self._tiles[name].set_text(text, codes.get(code, ""), self._note(name, shown))
        self._show_coverage()

    def _note(self, name: str, shown: Readouts) -> str:
        if name == "facade" and shown.least_facade_m > 0.0:
            return self.tr("min {0}").format(length_unit(self._units).text(shown.least_facade_m))
        if name == "wind" and shown.wind_from_deg is not None and shown.wind_m_s:
            return self.tr("from {0:.0f}°").format(shown.wind_from_deg)
        if name == "gnss" and shown.n_satellites is not None:
            return self.tr("{0} sat").format(shown.n_satellites)
        return ""

    def _show_coverage(self) -> None:
        counted = self._counted
        if counted is None or counted.covered_planned == 0:
            self._coverage.setValue(0)
            self._covered.setText(self.tr("coverage: no photo yet"))
            return
        share = per_cent(counted.covered, counted.covered_planned)
        self._coverage.setValue(min(1000, round(10 * share)))
        self._covered.setText(
            self.tr("coverage {0:.1f} % of planned ({1} of {2})").format(
                share, counted.covered, counted.covered_planned
            )
        )


class _Tile(QFrame):
    """A figure, what it is, and a note."""

    def __init__(self, caption: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self._figure, self._caption_text = QLabel(UNKNOWN), caption
        self._caption = QLabel(caption)
        self._caption.setProperty("role", "muted")
        font = self._figure.font()
        font.setPointSizeF(FIGURE_SCALE * font.pointSizeF())
        font.setBold(True)
        self._figure.setFont(font)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 2, 6, 2)
        layout.setSpacing(0)
        for label in (self._figure, self._caption):
            label.setAlignment(Qt.AlignmentFlag.AlignLeft)
            # A longer figure does not make its column wider.
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
            layout.addWidget(label)

    def set_text(self, figure: str, severity: str, note: str = "") -> None:
        """Show a figure; `severity` of the warning about it, empty for none."""
        role = severity if severity in ("error", "warning") else ""
        if self._figure.text() != figure:
            self._figure.setText(figure)
        caption = f"{self._caption_text}, {note}" if note else self._caption_text
        if self._caption.text() != caption:
            self._caption.setText(caption)
        if self._figure.property("role") != role:
            self._figure.setProperty("role", role)
            self._figure.style().polish(self._figure)

    def text(self) -> str:
        """What it says."""
        return f"{self._caption.text()}: {self._figure.text()}"
