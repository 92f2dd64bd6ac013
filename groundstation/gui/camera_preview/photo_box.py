"""What stands beside the camera preview and lies over it: lines or photo, outlines, light, effects, figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QDate, QDateTime, QEvent, QLineF, QLocale, QPointF, QRectF, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QKeyEvent, QPainter, QPaintEvent, QPen, QPixmap
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QDateTimeEdit,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from groundstation.gui.view3d.orbit import Pinhole
from groundstation.gui.widgets.inputs import ChoiceBox, NumberBox, calm, moment_of
from groundstation.gui.widgets.theme import colours
from planning.geo.frames import Origin
from planning.geo.sun import sun_place_deg
from reconstruction.scenes.world.look import Look

# What lies over the preview: the rendered photo with panels' outlines, cross, horizon, figures, and the shutter.

CROSS_PX = 14.0
FLASH_OPACITY = 150
HORIZON = "#d55e00"
"""Vermilion, which building, sky and panels have nothing of."""


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Lines of one pen; `ends_px` are x and y of both ends, shape (n, 4)."""

    ends_px: NDArray[np.float64]
    colour: str
    width_px: float


class PhotoOverlay(QWidget):
    """Transparent for the mouse."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self.setAttribute(Qt.WidgetAttribute.WA_NoSystemBackground)
        self._view: Pinhole | None = None
        self._text, self._note = "", ""
        self._is_flashing = False
        self._picture: QImage | None = None
        self._lines: tuple[Lines, ...] = ()
        self._painted: QPixmap | None = None
        """Picture and lines as they were painted last: there can be thousands of lines."""

    def show_photo(self, view: Pinhole | None, text: str) -> None:
        """Draw for a view; None draws nothing but the text."""
        self._view, self._text = view, text
        self.update()

    def show_picture(self, picture: QImage | None, lines: Sequence[Lines] = ()) -> None:
        """Put a photo in the place of what is drawn below, and lines over it; None takes both away."""
        self._picture, self._lines, self._painted = picture, tuple(lines), None
        self.update()

    def show_note(self, text: str) -> None:
        """Say something at the lower edge; nothing where it is empty."""
        if text != self._note:
            self._note = text
            self.update()

    def note(self) -> str:
        """What is said there."""
        return self._note

    def flash(self, is_on: bool) -> None:
        """Whiten the picture as long as the shutter is open."""
        if is_on != self._is_flashing:
            self._is_flashing = is_on
            self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802
        """Draw everything."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if self._picture is not None:
            painter.drawPixmap(0, 0, self._photo(self._picture))
        if self._is_flashing:
            painter.fillRect(self.rect(), QColor(255, 255, 255, FLASH_OPACITY))
        # A photo without outlines is seen as it is.
        if self._view is not None and (self._picture is None or self._lines):
            self._paint_horizon(painter, self._view)
            self._paint_cross(painter)
        if self._text:
            self._paint_plate(painter, self._text, QPointF(8.0, 8.0))
        if self._note:
            self._paint_plate(painter, self._note, QPointF(8.0, self.height() - 8.0), is_low=True)
        painter.end()

    def _photo(self, picture: QImage) -> QPixmap:
        size = self.size() * self.devicePixelRatio()
        if self._painted is None or self._painted.size() != size:
            self._painted = QPixmap(size)
            self._painted.setDevicePixelRatio(self.devicePixelRatio())
            painter = QPainter(self._painted)
            painter.setRenderHints(QPainter.RenderHint.SmoothPixmapTransform | QPainter.RenderHint.Antialiasing)
            painter.drawImage(QRectF(self.rect()), picture)
            for lines in self._lines:
                painter.setPen(QPen(QColor(lines.colour), lines.width_px))
                painter.drawLines([QLineF(*ends) for ends in lines.ends_px.tolist()])
            painter.end()
        return self._painted

    def _paint_cross(self, painter: QPainter) -> None:
        x, y = 0.5 * self.width(), 0.5 * self.height()
        for colour, width in (("#000000", 3.0), ("#ffffff", 1.2)):
            painter.setPen(QPen(QColor(colour), width))
            painter.drawLine(QPointF(x - CROSS_PX, y), QPointF(x + CROSS_PX, y))
            painter.drawLine(QPointF(x, y - CROSS_PX), QPointF(x, y + CROSS_PX))

    def _paint_horizon(self, painter: QPainter, view: Pinhole) -> None:
        """Roll is 0, so the horizon is level; it is in the picture where the pitch is within half the angle of view."""
        y = horizon_px(view)
        if not 0.0 <= y <= view.height_px:
            return
        for pen in (QPen(QColor("#ffffff"), 3.0), QPen(QColor(HORIZON), 1.5, Qt.PenStyle.DashLine)):
            painter.setPen(pen)
            painter.drawLine(QPointF(0.0, y), QPointF(self.width(), y))
        self._paint_plate(painter, self.tr("horizon"), QPointF(self.width() - 8.0, y + 4.0), is_right=True)

    def _paint_plate(
        self, painter: QPainter, shown: str, corner: QPointF, *, is_right: bool = False, is_low: bool = False
    ) -> None:
        """A text on a plate; `corner` is its upper left corner, unless it is one on the right or a lower one."""
        limit = QRectF(0.0, 0.0, self.width() - 30.0, self.height())
        size = QFontMetricsF(self.font()).boundingRect(limit, Qt.TextFlag.TextWordWrap, shown).size()
        box = QRectF(corner.x(), corner.y(), size.width() + 14.0, size.height() + 8.0)
        if is_right:
            box.moveRight(corner.x())
        if is_low:
            box.moveBottom(corner.y())
        plate = QColor(colours().base)
        plate.setAlpha(225)
        painter.setPen(QPen(QColor(colours().line), 1.0))
        painter.setBrush(plate)
        painter.drawRoundedRect(box, 3.0, 3.0)
        painter.setPen(QColor(colours().text))
        inner = box.adjusted(7.0, 4.0, -7.0, -4.0)
        painter.drawText(inner, Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextWordWrap, shown)


def horizon_px(view: Pinhole) -> float:
    """Row of the horizon in a picture without roll; infinite where the camera looks straight up or down."""
    level = float(np.hypot(view.forward[0], view.forward[1]))
    if level < 1e-9:
        return float("inf")
    rise = -float(view.forward[2]) / level
    return 0.5 * view.height_px * (1.0 - rise / view.half_height)


# Editor of a scene's light: where the sun stands, or when, and whether anything stands around the building.

DATES = QDate(1980, 1, 1), QDate(2100, 12, 31)
"""Every system knows its time zone then, and the sun's place is as good as it is said to be."""


class LightBox(QWidget):
    """Edits a `Look`; what it has no box for stays as it was.

    Signals
    -------
    valueChanged(Look)
        The user chose another light.
    """

    valueChanged = Signal(object)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._value = Look()
        self._origin: Origin | None = None
        self._by = ChoiceBox()
        self._by.addItems([self.tr("Sun by direction"), self.tr("Sun by date and time")])
        self._by.setToolTip(self.tr("Say where the sun stands, or when the photo is taken"))
        self._heading = NumberBox(0.0, 360.0, 5.0, "°", 0)
        self._heading.setWrapping(True)
        self._heading.setAccessibleName(self.tr("Heading of the sun"))
        self._heading.setToolTip(self.tr("Where the sun stands, clockwise from north"))
        self._elevation = NumberBox(-20.0, 90.0, 5.0, "°", 0)
        self._elevation.setAccessibleName(self.tr("Elevation of the sun"))
        self._elevation.setToolTip(self.tr("How high the sun stands above the horizon"))
        self._when = QDateTimeEdit(QDateTime.currentDateTime())
        calm(self._when)
        self._when.setDisplayFormat("yyyy-MM-dd HH:mm")
        self._when.setLocale(QLocale.c())
        self._when.setDateRange(*DATES)
        self._when.setCalendarPopup(True)
        self._when.setAccessibleName(self.tr("Date and time"))
        self._when.setToolTip(self.tr("By this computer's clock and time zone"))
        self._near = QCheckBox(self.tr("Simulated surroundings"))
        self._near.setToolTip(
            self.tr(
                "Buildings opposite, trees, cars and people, drawn at random; without them the building stands alone"
            )
        )
        self._words = QLabel()
        self._words.setProperty("role", "muted")
        self._words.setWordWrap(True)
        self._lay_out()
        self.setValue(self._value)
        for signal in (self._by.currentIndexChanged, self._when.dateTimeChanged, self._near.toggled):
            signal.connect(self._edited)
        for box in (self._heading, self._elevation):
            box.valueChanged.connect(self._edited)
        self._show_kind()

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(4)
        for box in (self._heading, self._elevation):
            row.addWidget(box, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self._by)
        layout.addLayout(row)
        for widget in (self._when, self._words, self._near):
            layout.addWidget(widget)

    def value(self) -> Look:
        """The light."""
        return self._value

    def setValue(self, look: Look) -> None:  # noqa: N802
        """Show another light; the sun is then said by its direction."""
        self._value = look
        with QSignalBlocker(self._by):
            self._by.setCurrentIndex(0)
        self._show_sun(look.sun_heading_deg, look.sun_elevation_deg)
        with QSignalBlocker(self._near):
            self._near.setChecked(look.near)
        self._show_kind()

    def set_time(self, when: QDateTime) -> None:
        """Show the sun as it stands at a time of this computer's clock."""
        with QSignalBlocker(self):
            self._by.setCurrentIndex(1)
            self._when.setDateTime(when)

    def set_origin(self, origin: Origin | None) -> None:
        """Where on earth the sun is looked for; a sun that was said by time moves with it."""
        if origin == self._origin:
            return
        self._origin = origin
        if self._is_by_time():
            self._edited()

    def _is_by_time(self) -> bool:
        return self._by.currentIndex() == 1

    def _edited(self, *_: object) -> None:
        heading_deg, elevation_deg = self._sun_deg()
        if self._is_by_time():
            self._show_sun(heading_deg, elevation_deg)
        found = replace(
            self._value,
            sun_heading_deg=heading_deg,
            sun_elevation_deg=elevation_deg,
            near=self._near.isChecked(),
        )
        changed, self._value = found != self._value, found
        self._show_kind()
        if changed:
            self.valueChanged.emit(found)

    def _sun_deg(self) -> tuple[float, float]:
        """Heading and elevation as the user says them; the boxes round what comes from a time."""
        if not self._is_by_time():
            return self._heading.value(), self._elevation.value()
        if self._origin is None:
            return self._value.sun_heading_deg, self._value.sun_elevation_deg
        at = moment_of(self._when)
        heading_deg, elevation_deg = sun_place_deg(self._origin.lat_deg, self._origin.lon_deg, at)
        return heading_deg % 360.0, elevation_deg

    def _show_sun(self, heading_deg: float, elevation_deg: float) -> None:
        for box, degrees in ((self._heading, heading_deg % 360.0), (self._elevation, elevation_deg)):
            with QSignalBlocker(box):
                box.setValue(degrees)

    def _show_kind(self) -> None:
        by_time = self._is_by_time()
        for box in (self._heading, self._elevation):
            box.setVisible(not by_time)
        self._when.setVisible(by_time)
        heading_deg, elevation_deg = self._value.sun_heading_deg, self._value.sun_elevation_deg
        if by_time and self._origin is None:
            words = self.tr("Open a site first: the sun is looked for above it.")
        elif elevation_deg <= 0.0:
            words = self.tr("Sun at {0:.0f}°, {1:.0f}°: below the horizon. No shadows, but a bright sky.").format(
                heading_deg, elevation_deg
            )
        elif by_time:
            words = self.tr("Sun at {0:.0f}°, {1:.0f}° high.").format(heading_deg, elevation_deg)
        else:
            words = ""
        self._words.setText(words)
        self._words.setVisible(bool(words))


WIDTH_PX = 210
"""Pictures are 4 : 3 and the room for them is wide: at 1280 x 720 this takes nothing from them."""


class PhotoBox(QWidget):
    """Chooses between lines and photo; what is for photos only is shown with them.

    Signals
    -------
    valueChanged(bool)
        Whether photos are shown: the user chose lines or photo, or photo once more.
    outlinesChanged(bool)
        Whether panels are outlined on photos.
    """

    valueChanged = Signal(bool)  # noqa: N815  (Qt's own way of naming)
    outlinesChanged = Signal(bool)  # noqa: N815

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFixedWidth(WIDTH_PX)
        self.lines, self.photo = QPushButton(self.tr("Lines")), QPushButton(self.tr("Photo"))
        self.lines.setToolTip(self.tr("Building, panels and what is covered, drawn at once"))
        self.photo.setToolTip(self.tr("As photographed: what the glass will mirror from here"))
        group = QButtonGroup(self)
        for button in (self.lines, self.photo):
            button.setCheckable(True)
            group.addButton(button)
        self.lines.setChecked(True)
        self.outlines = QCheckBox(self.tr("Outlines"))
        self.outlines.setToolTip(self.tr("Panels' outlines over the photo, thick where this view covers them"))
        self.light, self.effects = LightBox(), QPushButton(self.tr("Effects ..."))
        self.effects.setToolTip(self.tr("What is simulated in this photo, what is not, and why"))
        self._lay_out()
        for button in (self.lines, self.photo):
            button.clicked.connect(self._chosen)
        self.outlines.toggled.connect(self.outlinesChanged)
        self._show_choice()

    def _lay_out(self) -> None:
        row = QHBoxLayout()
        row.setSpacing(4)
        row.addWidget(self.lines, 1)
        row.addWidget(self.photo, 1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addLayout(row)
        for widget in (self.outlines, self.light, self.effects):
            layout.addWidget(widget)
        layout.addStretch(1)

    def value(self) -> bool:
        """Whether photos are shown."""
        return self.photo.isChecked()

    def setValue(self, is_photo: bool) -> None:  # noqa: N802
        """Show photos, or lines."""
        (self.photo if is_photo else self.lines).setChecked(True)
        self._show_choice()

    def event(self, event: QEvent) -> bool:
        """Let the space bar press the button that has the keyboard; elsewhere it flies through the sortie."""
        is_override = event.type() == QEvent.Type.ShortcutOverride
        if is_override and isinstance(event, QKeyEvent) and event.key() == Qt.Key.Key_Space:
            event.accept()
            return True
        return super().event(event)

    def _chosen(self) -> None:
        self._show_choice()
        self.valueChanged.emit(self.value())

    def _show_choice(self) -> None:
        for widget in (self.outlines, self.light, self.effects):
            widget.setVisible(self.value())
