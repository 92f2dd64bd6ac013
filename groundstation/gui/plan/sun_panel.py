"""Sun and sky over the site on a day: a day chooser, the bar over the day, and what it means in words."""

from __future__ import annotations

import math
from collections.abc import Callable
from datetime import date, datetime, timedelta

from PySide6.QtCore import QDate, QLocale, QObject, QTimer, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QDateEdit, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import translated
from groundstation.gui.charts.sun_chart import SunChart
from groundstation.gui.widgets.inputs import calm
from groundstation.gui.widgets.scrolling import scrolled
from groundstation.services.jobs.runner import Job, JobContext
from groundstation.services.mission.sunlight import (
    SunReport,
    SunRequest,
    clock_text,
    day_rows,
    first_take_off,
    hour_marks,
    local_zone,
    moment_lines,
    sun_lines,
    sun_report,
)
from groundstation.services.project.document import Document
from groundstation.services.units import UnitSystem
from planning.base.findings import Severity
from planning.base.messages import say
from planning.plan import Plan
from planning.site.records import SiteModel

AFTER_MS = 300
"""The day changes several times in a row while somebody types or turns pages of the calendar."""


class SunPanel(QWidget):
    """Edits a day, and shows what was found for it.

    Signals
    -------
    valueChanged(date)
        Another day was chosen.
    lookedAt()
        It came into sight.
    takeOffChosen(datetime)
        The flight is to begin then.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)
    takeOffChosen = Signal(object)  # noqa: N815
    lookedAt = Signal()  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._report: SunReport | None = None
        self._second: float | None = None
        self._units = UnitSystem.METRIC
        self.day = QDateEdit(QDate.currentDate())
        calm(self.day)
        self.day.setDisplayFormat("yyyy-MM-dd")
        self.day.setLocale(QLocale.c())
        self.day.setCalendarPopup(True)
        self.day.setAccessibleName(self.tr("Day of the flight"))
        self.day.setToolTip(self.tr("By this computer's time zone, as all times here"))
        self.before, self.after = QPushButton("<"), QPushButton(">")
        self.before.setToolTip(self.tr("The day before"))
        self.after.setToolTip(self.tr("The next day"))
        for button, days in ((self.before, -1), (self.after, 1)):
            button.setAccessibleName(button.toolTip())
            button.setFixedWidth(button.sizeHint().height())
            button.clicked.connect(lambda _checked=False, days=days: self._turn(days))
        self.chart = SunChart()
        self.chart.empty = self.tr("Light and take-off times stand here, once they are found for a site.")
        self.choose = QPushButton()
        self.choose.setToolTip(self.tr("Check the plan for a take-off then, on the Mission tab"))
        self._legend, self._moment, self._words = QLabel(), QLabel(), QLabel()
        self._legend.setText(
            self.tr("Tall: in the sun, or a take-off that spoils no photo. Half: in part, or few. Low: shade, or many.")
        )
        self._legend.setProperty("role", "muted")
        for label in (self._legend, self._moment, self._words):
            label.setWordWrap(True)
        above = QHBoxLayout()
        for widget in (QLabel(self.tr("Day")), self.before, self.day, self.after):
            above.addWidget(widget)
        above.addStretch(1)
        words = QWidget()
        below = QVBoxLayout(words)
        below.setContentsMargins(0, 0, 0, 0)
        below.addWidget(self.choose)
        below.addWidget(self._moment)
        below.addWidget(self._words)
        below.addWidget(self._legend)
        below.addStretch(1)
        right = QVBoxLayout()
        right.addLayout(above)
        right.addWidget(scrolled(words), 1)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(4, 4, 0, 0)
        layout.addWidget(scrolled(self.chart), 3)
        layout.addLayout(right, 2)
        self.day.dateChanged.connect(lambda _day: self.valueChanged.emit(self.value()))
        self.chart.picked.connect(self._pick)
        self.choose.clicked.connect(self._choose)
        self.set_report(None)

    def value(self) -> date:
        """The chosen day."""
        found = self.day.date()
        return date(found.year(), found.month(), found.day())

    def setValue(self, day: date) -> None:  # noqa: N802
        """Choose another day."""
        self.day.setDate(QDate(day.year, day.month, day.day))

    def set_report(self, report: SunReport | None) -> None:
        """Show what was found; None while it is not known."""
        self._report = report
        self._moment.clear()
        self.chart.set_mark(None)
        self._legend.setVisible(report is not None)
        self._moment.setVisible(report is not None)
        self._second = None if report is None else first_take_off(report)
        self._show_choice()
        if report is None:
            self.chart.set_rows((), ())
            self._words.clear()
            return
        rows = [type(row)(translated(row.name, self._units), row.stretches) for row in day_rows(report)]
        self.chart.set_rows(rows, hour_marks(report.day.track))
        self._moment.setText(self.tr("Click a time to see what it means."))
        self._words.setText("\n\n".join(translated(line, self._units) for line in sun_lines(report)))

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self.set_report(self._report)

    def text(self) -> str:
        """What is said below the bar."""
        return f"{self._moment.text()}\n{self._words.text()}"

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Somebody looks."""
        super().showEvent(event)
        self.lookedAt.emit()

    def _turn(self, days: int) -> None:
        self.setValue(self.value() + timedelta(days=days))

    def _pick(self, share: float) -> None:
        if self._report is None:
            return
        # To the minute: that is what is said.
        second = 60.0 * math.floor(share * self._report.day.track.length_s / 60.0)
        self.chart.set_mark(share)
        self._second = second
        self._show_choice()
        self._moment.setText("\n".join(translated(line, self._units) for line in moment_lines(self._report, second)))

    def _show_choice(self) -> None:
        found, second = self._report, self._second
        is_flight = found is not None and found.times is not None and second is not None
        self.choose.setVisible(is_flight)
        if found is not None and second is not None:
            self.choose.setText(self.tr("Plan take-off for {0}").format(clock_text(found.day.track, second)))

    def _choose(self) -> None:
        if self._report is not None and self._second is not None:
            self.takeOffChosen.emit(self._report.day.track.time(self._second))


class SunController(QObject):
    """Keeps the sun of the chosen day up to date; one job at a time, and none while nobody looks.

    Signals
    -------
    reportChanged(SunReport or None)
        None while nothing is known of the site.
    """

    reportChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, context: ApplicationContext, panel: SunPanel, is_planning: Callable[[], bool]) -> None:
        super().__init__(panel)
        self._context, self._panel, self._is_planning = context, panel, is_planning
        self._report: SunReport | None = None
        self._job: Job[SunReport] | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(AFTER_MS)
        self._timer.timeout.connect(self.look)
        self.reportChanged.connect(panel.set_report)
        panel.lookedAt.connect(self.look)
        panel.takeOffChosen.connect(self._plan_take_off)
        panel.valueChanged.connect(lambda _day: self._timer.start())
        context.documentChanged.connect(self._document_changed)
        context.jobsChanged.connect(self._forget_ended)

    def look(self) -> None:
        """Look at the day, unless what is known still holds."""
        site, plan, day = *_flight_of(self._context.document), self._panel.value()
        if site is None or self._job is not None or not self._panel.isVisible():
            return
        if self._report is not None and self._report.is_of(plan, site, day):
            return
        if self._is_planning():
            self._timer.start()  # it would wait behind the plan
            return

        def work(context: JobContext) -> SunReport:
            context.report(say("sun in pictures"), 0, 1)
            return sun_report(site, plan, SunRequest(day, local_zone(day)), context)

        self._job = self._context.start(self.tr("Look at the sun"), work, self._found)

    def _found(self, report: SunReport) -> None:
        self._job = None
        if report.site_model is self._context.document.site:
            self._report = report
            self.reportChanged.emit(report)
        self.look()

    def _plan_take_off(self, at: datetime) -> None:
        self._context.takeOffPlanned.emit(at)
        text = self.tr("Take-off planned for {0}; the Mission tab checks the plan for it.")
        self._context.say(Severity.OK, text.format(f"{at:%Y-%m-%d %H:%M}"))

    def _forget_ended(self) -> None:
        """Also a job that failed or was cancelled is over."""
        if self._job is not None and self._job not in self._context.jobs():
            self._job = None

    def _document_changed(self, before: Document, after: Document) -> None:
        if before.site is not after.site:
            self._report = None
            self.reportChanged.emit(None)
        if self._panel.isVisible():
            self._timer.start()


def _flight_of(document: Document) -> tuple[SiteModel | None, Plan | None]:
    return document.site, None if document.current is None else document.current.plan
