"""The pre-flight findings of a plan: a verdict, how fresh it is, how many of each severity, and the list."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QDateTime, QEvent, QLocale, QSignalBlocker, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QDateTimeEdit,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.widgets.findings_list import FindingsList
from groundstation.gui.widgets.inputs import NumberBox, calm
from groundstation.gui.widgets.severity_icon import SIZE_PX, severity_icon
from groundstation.gui.widgets.theme import colours
from groundstation.services.mission.readiness import (
    SEVERITIES,
    UNKNOWN_DAY,
    FlightDay,
    Readiness,
    counts_by_severity,
    readiness_of,
)
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity


class FindingsView(QWidget):
    """Shows findings and how fresh they are.

    Signals
    -------
    placePicked(str)
        The user wants to see the place of a finding.
    checkRequested()
    dayChanged(FlightDay)
        The user says when it is flown, or how cold it is.
    """

    placePicked = Signal(str)  # noqa: N815  (Qt's own way of naming)
    checkRequested = Signal()  # noqa: N815
    dayChanged = Signal(object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._findings: tuple[Finding, ...] | None = None
        self._is_stale = False
        self._verdict_icon, self._verdict, self._state = QLabel(), QLabel(), QLabel()
        self._verdict.setWordWrap(True)
        self._state.setWordWrap(True)
        self._check = QPushButton(self.tr("Check"))
        self._check.setToolTip(self.tr("Measure every pre-flight rule again"))
        self._list, self._day = FindingsList(), DayBox()
        self._show = {severity: self._filter_button(severity) for severity in SEVERITIES}
        head, filters = QHBoxLayout(), QHBoxLayout()
        head.addWidget(self._verdict_icon)
        head.addWidget(self._verdict, 1)
        head.addWidget(self._check)
        for button in self._show.values():
            filters.addWidget(button, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addLayout(head)
        layout.addWidget(self._day)
        layout.addWidget(self._state)
        layout.addLayout(filters)
        layout.addWidget(self._list, 1)
        self._check.clicked.connect(self.checkRequested)
        self._day.valueChanged.connect(self.dayChanged)
        self._list.placePicked.connect(self.placePicked)
        self._filter()
        self.set_findings(None)

    def set_findings(self, findings: Sequence[Finding] | None) -> None:
        """Show findings that are as fresh as the plan; None where nothing was checked."""
        self._findings = None if findings is None else tuple(findings)
        self._is_stale = False
        self._say_state("" if findings is not None else self.tr("Not checked yet."))
        self._list.set_findings(self._findings or ())
        kept = self.tr("Nothing stands against the flight. The button with the tick lists the rules that are kept.")
        self._list.set_placeholder(kept if self._findings else "")
        self._show_counts()

    def set_stale(self) -> None:
        """Say that the plan or the site has changed since."""
        if self._findings is not None:
            self._is_stale = True
            self._say_state(self.tr("Older than the plan: it was changed after this check."))
            self._show_counts()

    def set_checking(self) -> None:
        """Say that a check runs."""
        self._say_state(self.tr("Checking ..."))

    def set_can_check(self, can_check: bool) -> None:
        """Whether there is a plan on a site to check."""
        self._check.setEnabled(can_check)

    def set_units(self, units: UnitSystem) -> None:
        """Show values in other units."""
        self._list.set_units(units)

    def day_box(self) -> DayBox:
        """What is known of the day of the flight."""
        return self._day

    def verdict(self) -> str:
        """The verdict as it is read."""
        return self._verdict.text()

    def state_text(self) -> str:
        """How fresh the findings are; empty where they are up to date."""
        return self._state.text()

    def show_severity(self, severity: Severity, is_shown: bool) -> None:
        """Show or hide the findings of one severity."""
        self._show[severity].setChecked(is_shown)

    def list_view(self) -> FindingsList:
        """The list."""
        return self._list

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw the pictures in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._show_counts()

    def _filter_button(self, severity: Severity) -> QToolButton:
        button = QToolButton()
        button.setCheckable(True)
        button.setChecked(severity is not Severity.OK)
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        button.setToolTip(self._list.severity_word(severity))
        button.toggled.connect(self._filter)
        return button

    def _filter(self) -> None:
        self._list.set_shown([severity for severity, button in self._show.items() if button.isChecked()])

    def _show_counts(self) -> None:
        for severity, count in counts_by_severity(self._findings or ()).items():
            self._show[severity].setText(str(count))
            self._show[severity].setIcon(severity_icon(severity, colours()))
        if self._findings is None or self._is_stale:
            text, severity, role = self.tr("Readiness not known"), Severity.WARNING, "warning"
        else:
            text, severity, role = {
                Readiness.READY: (self.tr("Ready to fly"), Severity.OK, "ok"),
                Readiness.WITH_WARNINGS: (self.tr("Ready to fly, but read the warnings"), Severity.WARNING, "warning"),
                Readiness.NOT_READY: (self.tr("NOT ready to fly"), Severity.ERROR, "error"),
            }[readiness_of(self._findings)]
        self._verdict.setText(text)
        self._verdict.setProperty("role", role)
        self._verdict.style().polish(self._verdict)
        self._verdict_icon.setPixmap(severity_icon(severity, colours()).pixmap(SIZE_PX, SIZE_PX))

    def _say_state(self, text: str) -> None:
        self._state.setText(text)
        self._state.setVisible(bool(text))


class DayBox(QWidget):
    """Edits a `FlightDay`: when the flight is planned, and how cold it is; each may be left open.

    Signals
    -------
    valueChanged(FlightDay)
    """

    valueChanged = Signal(object)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.has_time, self.has_temperature = QCheckBox(self.tr("Planned for")), QCheckBox(self.tr("Temperature"))
        self.has_time.setToolTip(self.tr("Look where the sun stands, and where glass mirrors it"))
        self.has_temperature.setToolTip(self.tr("Look what cold takes from the batteries"))
        self.when = QDateTimeEdit(QDateTime.currentDateTime())
        calm(self.when)
        self.when.setDisplayFormat("yyyy-MM-dd HH:mm")
        self.when.setLocale(QLocale.c())
        self.when.setCalendarPopup(True)
        self.when.setAccessibleName(self.tr("Date and time of the flight"))
        self.when.setToolTip(self.tr("By this computer's clock and time zone"))
        self.temperature = NumberBox(-40.0, 55.0, 1.0, " \u00b0C", 0)
        self.temperature.setValue(20.0)
        self.temperature.setAccessibleName(self.tr("Temperature at the flight"))
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for row, (check, box) in enumerate(((self.has_time, self.when), (self.has_temperature, self.temperature))):
            layout.addWidget(check, row, 0)
            layout.addWidget(box, row, 1)
            check.toggled.connect(self._edited)
        layout.setColumnStretch(1, 1)
        self.when.dateTimeChanged.connect(self._edited)
        self.temperature.valueChanged.connect(self._edited)
        self._show(UNKNOWN_DAY)

    def value(self) -> FlightDay:
        """What is known of the day."""
        at = self.when.dateTime().toPython().astimezone() if self.has_time.isChecked() else None
        return FlightDay(at, self.temperature.value() if self.has_temperature.isChecked() else None)

    def setValue(self, day: FlightDay) -> None:  # noqa: N802
        """Show another day."""
        blockers = [QSignalBlocker(box) for box in (self.has_time, self.has_temperature, self.when, self.temperature)]
        if day.at is not None:
            self.when.setDateTime(QDateTime.fromSecsSinceEpoch(round(day.at.timestamp())))
        if day.temperature_c is not None:
            self.temperature.setValue(day.temperature_c)
        self.has_time.setChecked(day.at is not None)
        self.has_temperature.setChecked(day.temperature_c is not None)
        del blockers
        self._show(day)

    def _show(self, day: FlightDay) -> None:
        self.when.setEnabled(day.at is not None)
        self.temperature.setEnabled(day.temperature_c is not None)

    def _edited(self, *_changed: object) -> None:
        day = self.value()
        self._show(day)
        self.valueChanged.emit(day)
