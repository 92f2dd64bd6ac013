"""A list of findings, each with its severity as a picture, what was measured, and where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

from PySide6.QtCore import QEvent, QModelIndex, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QIcon,
    QImage,
    QPainter,
    QPaintEvent,
    QPen,
    QPixmap,
    QPolygonF,
    QStandardItem,
    QStandardItemModel,
)
from PySide6.QtWidgets import QAbstractItemView, QListView, QWidget

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.theme import Colours, colours
from groundstation.services.mission.readiness import SEVERITIES, by_severity, measured_text, subject_of
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity

# One small picture per severity: shapes differ, so that nobody depends on their colours.

SIZE_PX = 22


def severity_colour(severity: Severity, found: Colours) -> QColor:
    """Colour of a severity in a theme."""
    return QColor(
        {Severity.ERROR: found.error, Severity.WARNING: found.warning, Severity.OK: found.ok}.get(severity, found.note)
    )


def severity_icon(severity: Severity, found: Colours) -> QIcon:
    """An octagon with a cross, a triangle with a bar, a circle with an i, or a tick."""
    return QIcon(QPixmap.fromImage(_drawn(severity, found)))


@lru_cache(maxsize=16)
def _drawn(severity: Severity, found: Colours) -> QImage:
    """An image and no pixmap: it may outlive the application."""
    ratio = 2.0  # sharp on screens with two pixels to the point
    picture = QImage(int(SIZE_PX * ratio), int(SIZE_PX * ratio), QImage.Format.Format_ARGB32_Premultiplied)
    picture.setDevicePixelRatio(ratio)
    picture.fill(Qt.GlobalColor.transparent)
    painter = QPainter(picture)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    colour, paper = severity_colour(severity, found), QColor(found.base)
    # A rim keeps the shape visible on a pressed button of the same colour.
    painter.setPen(QPen(paper, 1.5))
    painter.setBrush(colour)
    sign = QPen(paper, 2.4, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap)
    match severity:
        case Severity.ERROR:
            painter.drawPolygon(_polygon(8, 11.0, 10.5, math.pi / 8.0))
            painter.setPen(sign)
            painter.drawLine(QPointF(7.5, 7.5), QPointF(14.5, 14.5))
            painter.drawLine(QPointF(14.5, 7.5), QPointF(7.5, 14.5))
        case Severity.WARNING:
            painter.drawPolygon(_polygon(3, 12.5, 12.0, -math.pi / 2.0))
            painter.setPen(sign)
            painter.drawLine(QPointF(11.0, 8.0), QPointF(11.0, 12.5))
            painter.drawPoint(QPointF(11.0, 16.0))
        case Severity.NOTE:
            painter.drawEllipse(QRectF(1.5, 1.5, 19.0, 19.0))
            painter.setPen(sign)
            painter.drawPoint(QPointF(11.0, 6.5))
            painter.drawLine(QPointF(11.0, 10.5), QPointF(11.0, 16.0))
        case Severity.OK:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            for ink, width in ((paper, 5.0), (colour, 3.0)):
                painter.setPen(QPen(ink, width, Qt.PenStyle.SolidLine, Qt.PenCapStyle.RoundCap))
                painter.drawPolyline(QPolygonF([QPointF(4.0, 12.0), QPointF(9.0, 17.0), QPointF(18.0, 5.0)]))
    painter.end()
    return picture


def _polygon(corners: int, centre_y: float, radius: float, first_rad: float) -> QPolygonF:
    angles = [first_rad + 2.0 * math.pi * i / corners for i in range(corners)]
    return QPolygonF([QPointF(11.0 + radius * math.cos(a), centre_y + radius * math.sin(a)) for a in angles])


PLACE_ROLE = Qt.ItemDataRole.UserRole


class FindingsList(QListView):
    """The gravest first.

    Signals
    -------
    placePicked(str)
        The user wants to see the place of a finding.
    """

    placePicked = Signal(str)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._findings: tuple[Finding, ...] = ()
        self._shown = frozenset(SEVERITIES)
        self._units = UnitSystem.METRIC
        self._placeholder = ""
        self._rows = QStandardItemModel(self)
        self.setModel(self._rows)
        self.setWordWrap(True)
        self.setIconSize(QSize(SIZE_PX, SIZE_PX))
        self.setResizeMode(QListView.ResizeMode.Adjust)
        # Long lists are laid out a batch at a time, so that the window answers meanwhile.
        self.setLayoutMode(QListView.LayoutMode.Batched)
        self.setBatchSize(200)
        self.setSpacing(1)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setAccessibleName(self.tr("Findings"))
        self.clicked.connect(self._row_picked)
        self.activated.connect(self._row_picked)

    def set_findings(self, findings: Sequence[Finding]) -> None:
        """Show findings."""
        self._findings = by_severity(findings)
        self._fill()

    def set_shown(self, severities: Sequence[Severity]) -> None:
        """Show only these severities."""
        self._shown = frozenset(severities)
        self._fill()

    def set_units(self, units: UnitSystem) -> None:
        """Show values in other units."""
        self._units = units
        self._fill()

    def set_placeholder(self, text: str) -> None:
        """Say something where no finding is shown."""
        self._placeholder = text
        self.viewport().update()

    def texts(self) -> tuple[str, ...]:
        """What the rows say, from the top."""
        return tuple(self._rows.item(row).text() for row in range(self._rows.rowCount()))

    def severity_word(self, severity: Severity) -> str:
        """A severity in the user's language."""
        words = {
            Severity.ERROR: self.tr("Error"),
            Severity.WARNING: self.tr("Warning"),
            Severity.NOTE: self.tr("Note"),
            Severity.OK: self.tr("Kept"),
        }
        return words[severity]

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """The rows, or what is said instead."""
        super().paintEvent(event)
        if not self._rows.rowCount() and self._placeholder:
            painter = QPainter(self.viewport())
            painter.setPen(QColor(colours().muted))
            room = self.viewport().rect().adjusted(12, 12, -12, -12)
            painter.drawText(room, Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignCenter, self._placeholder)
            painter.end()

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Draw the pictures in the colours of another theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._fill()

    def _fill(self) -> None:
        icons = {severity: severity_icon(severity, colours()) for severity in SEVERITIES}
        self._rows.clear()
        for finding in self._findings:
            if finding.severity in self._shown:
                row = QStandardItem(icons[finding.severity], self._text(finding))
                row.setData(finding.place, PLACE_ROLE)
                row.setToolTip(self.tr("Click to see the place") if finding.place else "")
                self._rows.appendRow(row)

    def _text(self, finding: Finding) -> str:
        title, subject = self.severity_word(finding.severity), translated(subject_of(finding.code), self._units)
        if subject:
            title = self.tr("{0} ({1})").format(title, subject)
        facts = []
        if finding.value is not None:
            facts.append(self.tr("measured {0}").format(self._measured(finding.value, finding.unit)))
        if finding.limit is not None:
            facts.append(self.tr("limit {0}").format(self._measured(finding.limit, finding.unit)))
        if finding.place:
            facts.append(self.tr("at {0}").format(translated(finding.place, self._units)))
        return "\n".join([title, translated(finding.message, self._units), *([" · ".join(facts)] if facts else [])])

    def _measured(self, value: float, unit: str) -> str:
        return translated(measured_text(value, unit, self._units), self._units)

    def _row_picked(self, index: QModelIndex) -> None:
        place = index.data(PLACE_ROLE)
        if place:
            self.placePicked.emit(place)
