"""What the pilot reads: in flight at a glance, in large figures, and afterwards as a report of every view.

Figures, attitude and heading that lie over the view are painted on opaque plates, to be read at arm's length.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPainterPath, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.application.translate import translated
from groundstation.gui.widgets.scrolling import FittedLine, scrolled
from groundstation.gui.widgets.tab_order import set_enabled
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.gui.widgets.theme import colours
from groundstation.services.fly.events import FlightEnded, LinkState, LiveView, PhotoCounted, Readouts, ViewState
from groundstation.services.units import UnitSystem, length_unit, minutes_text, per_cent, speed_unit
from groundstation.vehicle.preflight import fix_name
from missions.flight.outcome import FlightReport, Reason, ViewOutcome
from planning.geo.frames import Angles

UNKNOWN = "-"

# The figures: one below the other, the two that keep the aircraft off things largest.

LARGE, USUAL = 1.5, 1.0
"""Shares of the height that rows get."""

LEAST_ROW_PX = 34.0
"""Of a row of usual size; where rows would be lower, the last are left out."""

MOST_ROW_PX = 84.0
FIGURE_PART = 0.60
"""Of a row's height that its figure takes; the caption has the rest."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A row: what it is, its value, a note behind what it is, and the severity of a warning about it, or empty."""

    name: str
    caption: str
    value: str
    note: str = ""
    role: str = ""
    share: float = USUAL


class FlightFigures(QWidget):
    """Height, distance, speed, battery, time to go, next photo and wind, in this order."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName(self.tr("Flight figures"))
        self._units = UnitSystem.METRIC
        self._view: LiveView | None = None
        self._figures: tuple[Figure, ...] = ()
        self._widest_px = 0
        self._is_old = False
        self._find()

    def set_view(self, view: LiveView | None) -> None:
        """Show a flight as it stands."""
        self._view = view
        self._find()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths and speeds in other units."""
        self._units = units
        self._find()

    def text(self) -> str:
        """Everything that is shown, a line for each figure."""
        return "\n".join(f"{_line(each)}: {each.value}" for each in self._figures)

    def sizeHint(self) -> QSize:  # noqa: N802
        """As wide as the longest caption, as high as rows of full size."""
        shares = sum(each.share for each in self._figures)
        return QSize(self._widest_px, round(MOST_ROW_PX * shares))

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Paint the rows that have room."""
        painter, look = QPainter(self), colours()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(look.base))
        shown = list(self._figures)
        while len(shown) > 1 and self.height() < LEAST_ROW_PX * sum(each.share for each in shown):
            shown.pop()
        unit_px = min(MOST_ROW_PX, self.height() / sum(each.share for each in shown))
        top = 0.0
        for figure in shown:
            room = QRectF(0.0, top, self.width(), unit_px * figure.share)
            self._paint_row(painter, figure, room)
            top = room.bottom()
        painter.setPen(QPen(QColor(look.line), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5))
        painter.end()

    def _paint_row(self, painter: QPainter, figure: Figure, room: QRectF) -> None:
        look = colours()
        ground = {"error": look.error, "warning": look.warning}.get(figure.role)
        ink = QColor(look.base if ground else look.muted if self._is_old else look.text)
        if ground:
            painter.fillRect(room.adjusted(1.0, 1.0, -1.0, 0.0), QColor(ground))
        inner = room.adjusted(8.0, 1.0, -6.0, -2.0)
        font = fitting_font(self.font(), figure.value, inner.width(), FIGURE_PART * room.height())
        painter.setFont(font)
        painter.setPen(ink)
        high = QFontMetricsF(font).height()
        painter.drawText(
            QRectF(inner.left(), inner.top(), inner.width(), high), Qt.AlignmentFlag.AlignLeft, figure.value
        )
        caption = QFont(self.font())
        caption.setPixelSize(max(9, int(min(QFontMetricsF(self.font()).height(), room.height() - 0.9 * high) / 1.25)))
        painter.setFont(caption)
        painter.setPen(ink if ground else QColor(look.muted))
        text = _line(figure)
        metrics = QFontMetricsF(caption)
        place = QRectF(inner.left(), inner.top() + high - 0.1 * high, inner.width(), metrics.height())
        shown = metrics.elidedText(text, Qt.TextElideMode.ElideRight, inner.width())
        painter.drawText(place, Qt.AlignmentFlag.AlignLeft, shown)
        painter.setPen(QPen(QColor(look.line), 1.0))
        painter.drawLine(room.bottomLeft(), room.bottomRight())

    def _find(self) -> None:
        view = self._view
        was_old, self._is_old = self._is_old, view is not None and view.link is LinkState.LOST
        found = self._now(view)
        if found != self._figures or was_old is not self._is_old:
            self._figures = found
            metrics = QFontMetricsF(self.font())
            # It never becomes narrower again: figures that move are not read.
            self._widest_px = max(
                self._widest_px, *(round(metrics.horizontalAdvance(_line(each))) + 20 for each in self._figures)
            )
            self.update()

    def _now(self, view: LiveView | None) -> tuple[Figure, ...]:
        shown = Readouts() if view is None else view.readouts
        roles = {} if view is None else {warning.code: warning.severity.value for warning in view.warnings}
        length, speed = length_unit(self._units), speed_unit(self._units)
        least = self.tr("min {0}").format(length.text(shown.least_facade_m)) if shown.least_facade_m > 0.0 else ""
        left = (
            "" if shown.battery_left_s is None else self.tr("reserve in {0}").format(minutes_text(shown.battery_left_s))
        )
        wind_from = "" if not shown.wind_m_s or shown.wind_from_deg is None else f"{shown.wind_from_deg:.0f}°"
        percent = UNKNOWN if shown.battery is None else f"{shown.battery:.0%}"
        return (
            Figure(
                "height",
                self.tr("above ground"),
                _text(length.text, shown.above_ground_m),
                role=roles.get("airspace", ""),
                share=LARGE,
            ),
            Figure(
                "facade",
                self.tr("to the facade"),
                _text(length.text, shown.facade_m),
                least,
                roles.get("facade-distance", ""),
                LARGE,
            ),
            Figure("speed", self.tr("speed"), _text(speed.text, shown.speed_m_s), role=roles.get("off-path", "")),
            Figure("battery", self.tr("battery"), percent, left, roles.get("battery", "")),
            Figure("to-go", self.tr("to go"), _text(minutes_text, shown.to_go_s)),
            self._photo(view, shown),
            Figure("wind", self.tr("wind"), _text(speed.text, shown.wind_m_s), wind_from, roles.get("wind", "")),
        )

    def _photo(self, view: LiveView | None, shown: Readouts) -> Figure:
        """Which photo comes next, of how many, and when."""
        states = () if view is None else tuple(state for _, state in view.view_states)
        following = next((n for n, state in enumerate(states, 1) if state is ViewState.NEXT), None)
        n_missing = sum(state is ViewState.MISSING for state in states)
        value = UNKNOWN if not states else f"{len(states) if following is None else following}/{len(states)}"
        note = "" if shown.next_photo_s is None else self.tr("in {0}").format(minutes_text(shown.next_photo_s))
        if n_missing:
            note = self.tr("{0} missing").format(n_missing)
        caption = self.tr("next photo") if following is not None or not states else self.tr("all photos")
        return Figure("photo", caption, value, note, "warning" if n_missing else "")


def fitting_font(font: QFont, text: str, width_px: float, height_px: float) -> QFont:
    """A bold font for a text in so much room, as large as it can be."""
    found = QFont(font)
    found.setBold(True)
    size = max(9, int(height_px / 1.17))
    found.setPixelSize(size)
    wide = QFontMetricsF(found).horizontalAdvance(text)
    if wide > width_px > 0.0:
        found.setPixelSize(max(9, int(size * width_px / wide)))
    return found


def _line(figure: Figure) -> str:
    return f"{figure.caption}, {figure.note}" if figure.note else figure.caption


def _text(worded: Callable[[float], str], value: float | None) -> str:
    return UNKNOWN if value is None else worded(value)


# Attitude and heading.

SKY, GROUND, INK = "#1f6fb2", "#6b4423", "#ffffff"
"""As on every artificial horizon; white on either has a contrast of more than 5 : 1."""

PITCH_PX_PER_DEG = 2.2
TAPE_DEG = 90.0
"""Width of the heading tape."""

TAPE_PX = 40
LETTERS = {0: "N", 45: "NE", 90: "E", 135: "SE", 180: "S", 225: "SW", 270: "W", 315: "NW"}


def tape_font(font: QFont) -> QFont:
    """That of the words of a heading tape."""
    small = QFont(font)
    small.setPixelSize(13)
    small.setBold(True)
    return small


def tape_marks(
    heading_deg: float, room: QRectF, box: QRectF, metrics: QFontMetricsF
) -> Iterator[tuple[float, str, bool]]:
    """Marks of a heading tape, every 15 degrees: where, what is written there, and whether there is room for it.

    There is none where the words would be cut by the end of the tape, or by the box with the heading itself.
    """
    first = 15 * math.ceil((heading_deg - TAPE_DEG / 2.0) / 15.0)
    for mark in range(first, round(heading_deg + TAPE_DEG / 2.0) + 1, 15):
        x = room.center().x() + (mark - heading_deg) * room.width() / TAPE_DEG
        text = LETTERS.get(mark % 360, f"{mark % 360:03d}")
        left, right = x - 0.5 * metrics.horizontalAdvance(text), x + 0.5 * metrics.horizontalAdvance(text)
        is_inside = left >= room.left() + 2.0 and right <= room.right() - 2.0
        yield x, text, is_inside and (right < box.left() or left > box.right())


class AttitudeView(QWidget):
    """A heading tape above an artificial horizon: nose and wings of the aircraft, and where the camera points."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAccessibleName(self.tr("Attitude and heading"))
        self._attitude: Angles | None = None
        self._camera: Angles | None = None
        self._is_old = False

    def set_angles(self, attitude: Angles | None, camera: Angles | None, *, is_old: bool = False) -> None:
        """Show others."""
        if (attitude, camera, is_old) != (self._attitude, self._camera, self._is_old):
            self._attitude, self._camera, self._is_old = attitude, camera, is_old
            self.update()

    def text(self) -> str:
        """Heading, pitch and roll, in degrees; empty where nothing is known."""
        found = self._attitude
        if found is None:
            return ""
        heading, pitch, roll = (math.degrees(value) for value in (found.heading_rad, found.pitch_rad, found.roll_rad))
        return self.tr("heading {0:03.0f}°, pitch {1:+.0f}°, roll {2:+.0f}°").format(round(heading) % 360, pitch, roll)

    def sizeHint(self) -> QSize:  # noqa: N802
        """Tape and horizon."""
        return QSize(200, TAPE_PX + 150)

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Paint both."""
        painter, look = QPainter(self), colours()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.fillRect(self.rect(), QColor(look.base))
        self._paint_horizon(painter, QRectF(0.0, TAPE_PX, self.width(), self.height() - TAPE_PX))
        self._paint_tape(painter, QRectF(0.0, 0.0, self.width(), TAPE_PX))
        painter.setPen(QPen(QColor(look.line), 1.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(QRectF(self.rect()).adjusted(0.5, 0.5, -0.5, -0.5))
        painter.end()

    def _paint_tape(self, painter: QPainter, room: QRectF) -> None:
        look, found = colours(), self._attitude
        painter.save()
        painter.setClipRect(room)
        painter.fillRect(room, QColor(look.base))
        font = tape_font(self.font())
        painter.setFont(font)
        if found is not None:
            heading = math.degrees(found.heading_rad) % 360.0
            px_per_deg, middle = room.width() / TAPE_DEG, room.center().x()
            box = QRectF(middle - 24.0, room.top(), 48.0, 26.0)
            painter.setPen(QPen(QColor(look.text), 1.5))
            for x, text, is_whole in tape_marks(heading, room, box, QFontMetricsF(font)):
                painter.drawLine(QPointF(x, room.top()), QPointF(x, room.top() + 6.0))
                if is_whole:
                    painter.drawText(QRectF(x - 20, room.top() + 6, 40, 16), Qt.AlignmentFlag.AlignCenter, text)
            if self._camera is not None:
                off = (math.degrees(self._camera.heading_rad) - heading + 180.0) % 360.0 - 180.0
                x = min(max(middle + off * px_per_deg, room.left() + 6.0), room.right() - 6.0)
                painter.setPen(Qt.PenStyle.NoPen)
                painter.setBrush(QColor(look.accent))
                painter.drawPolygon(QPolygonF([QPointF(x, 30), QPointF(x - 6, 39), QPointF(x + 6, 39)]))
            painter.setPen(QPen(QColor(look.text), 2.0))
            painter.setBrush(QColor(look.base))
            painter.drawRect(box)
            font.setPixelSize(20)
            painter.setFont(font)
            painter.setPen(QColor(look.muted if self._is_old else look.text))
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"{round(heading) % 360:03d}")
        else:
            painter.setPen(QColor(look.muted))
            painter.drawText(room, Qt.AlignmentFlag.AlignCenter, UNKNOWN)
        painter.restore()

    def _paint_horizon(self, painter: QPainter, room: QRectF) -> None:
        look, found = colours(), self._attitude
        radius = 0.5 * min(room.width(), room.height()) - 5.0
        centre = room.center()
        circle = QPainterPath()
        circle.addEllipse(centre, radius, radius)
        painter.save()
        painter.setClipPath(circle)
        if found is None or self._is_old:
            painter.fillRect(room, QColor(look.handle))
        if found is not None:
            painter.translate(centre)
            painter.rotate(-math.degrees(found.roll_rad))
            drop = math.degrees(found.pitch_rad) * PITCH_PX_PER_DEG
            if not self._is_old:
                painter.fillRect(QRectF(-2 * radius, -4 * radius + drop, 4 * radius, 4 * radius), QColor(SKY))
                painter.fillRect(QRectF(-2 * radius, drop, 4 * radius, 4 * radius), QColor(GROUND))
            painter.setPen(QPen(QColor(INK if not self._is_old else look.muted), 2.0))
            painter.drawLine(QPointF(-2 * radius, drop), QPointF(2 * radius, drop))
            for pitch_deg in (-20, -10, 10, 20):
                y = drop - pitch_deg * PITCH_PX_PER_DEG
                painter.drawLine(QPointF(-14.0, y), QPointF(14.0, y))
        painter.restore()
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(look.text), 2.0))
        painter.drawEllipse(centre, radius, radius)
        # The aircraft itself: fixed, as the pilot sits in it.
        for colour, width in ((QColor("#000000"), 6.0), (QColor("#ffd400"), 3.5)):
            painter.setPen(QPen(colour, width))
            for side in (-1.0, 1.0):
                painter.drawLine(
                    QPointF(centre.x() + side * 0.25 * radius, centre.y()),
                    QPointF(centre.x() + side * 0.6 * radius, centre.y()),
                )
            painter.drawPoint(centre)
        if self._camera is not None:
            self._paint_camera(painter, room, math.degrees(self._camera.pitch_rad))

    def _paint_camera(self, painter: QPainter, room: QRectF, pitch_deg: float) -> None:
        """The gimbal's pitch, as a figure in the corner."""
        look = colours()
        font = QFont(self.font())
        font.setPixelSize(13)
        painter.setFont(font)
        text = self.tr("cam {0:+.0f}°").format(pitch_deg)
        size = QFontMetricsF(font).size(0, text)
        box = QRectF(room.left() + 4.0, room.bottom() - size.height() - 4.0, size.width() + 8.0, size.height() + 2.0)
        painter.fillRect(box, QColor(look.base))
        painter.setPen(QColor(look.accent))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


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
            return UNKNOWN if value is None else f"{value:+z.1f}"

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
        fix = UNKNOWN if shown.fix_type is None else translated(fix_name(shown.fix_type), self._units)
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
        self._figure, self._caption_text = FittedLine(UNKNOWN), caption
        self._caption = FittedLine(caption)
        self._caption.setProperty("role", "muted")
        font = self._figure.font()
        font.setPointSizeF(FIGURE_SCALE * font.pointSizeF())
        font.setBold(True)
        self._figure.setFont(font)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 2, 6, 2)
        layout.setSpacing(0)
        for label in (self._figure, self._caption):
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
