"""The hemisphere of one panel as seen along its normal: every section with its state, and which views see it.

The panel lies in the middle of the picture; the radius is the angle theta from its normal (90 degrees at the rim), the
direction is phi, with phi = 0 towards the panel's tangent t (to the right as seen from outside, see
`planning.coverage.sections`). States differ in pattern as well as in colour.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QBrush, QColor, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QToolTip, QWidget

from groundstation.gui.widgets.theme import colours
from planning.coverage.sections import SectionGrid
from planning.insight.sections import SectionState, section_shapes

MARGIN_PX = 26
"""Around the disc, for the angles at its rim."""

MARK_PX, SMALL_MARK_PX, MANY_MARKS = 2.5, 1.6, 40
"""Radius of the mark of a view, and where there are many: the sections' numbers must stay readable."""


@dataclass(frozen=True, slots=True)
class ShownSection:
    """One section: its state, how many views cover it, and what is to be said about it."""

    state: SectionState
    n_views: int
    tip: str


class HemisphereView(QWidget):
    """A polar picture of a panel's sections.

    Signals
    -------
    sectionPicked(int)
        Number of the section that was clicked.
    """

    sectionPicked = Signal(int)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._step_deg = 30.0
        self._sections: tuple[ShownSection, ...] = ()
        self._shapes = section_shapes(SectionGrid(self._step_deg))
        self._picked: int | None = None
        self._marks: tuple[tuple[float, float], ...] = ()
        self.setMinimumSize(150, 130)
        self.setMouseTracking(True)

    def set_sections(self, step_deg: float, sections: tuple[ShownSection, ...]) -> None:
        """Show a panel; no sections for none."""
        grid = SectionGrid(step_deg)
        if sections and len(sections) != grid.n_sections:
            raise ValueError(f"expected {grid.n_sections} sections of {step_deg} degrees, got {len(sections)}")
        if step_deg != self._step_deg:
            self._shapes = section_shapes(grid)
        self._step_deg, self._sections, self._picked, self._marks = step_deg, sections, None, ()
        self.update()

    def set_picked(self, section: int | None) -> None:
        """Outline one section."""
        self._picked = section
        self.update()

    def set_marks(self, directions_deg: tuple[tuple[float, float], ...]) -> None:
        """Mark the directions of views, as (theta, phi) in degrees."""
        self._marks = directions_deg
        self.update()

    def section_at(self, point: QPointF) -> int | None:
        """Section at a place of the picture; None beside the disc."""
        centre, radius = self._disc()
        x, y = point.x() - centre.x(), centre.y() - point.y()
        theta_deg = 90.0 * math.hypot(x, y) / radius
        if theta_deg >= 90.0 or not self._sections:
            return None
        phi_deg = math.degrees(math.atan2(y, x)) % 360.0
        n_sectors = round(360.0 / self._step_deg)
        # phi can round up to exactly 360.
        sector = min(int(phi_deg / self._step_deg), n_sectors - 1)
        return int(theta_deg / self._step_deg) * n_sectors + sector

    def place_of(self, theta_deg: float, phi_deg: float) -> QPointF:
        """Place of a direction in the picture."""
        centre, radius = self._disc()
        distance, phi = radius * theta_deg / 90.0, math.radians(phi_deg)
        return QPointF(centre.x() + distance * math.cos(phi), centre.y() - distance * math.sin(phi))

    def _disc(self) -> tuple[QPointF, float]:
        radius = max(10.0, 0.5 * min(self.width(), self.height()) - MARGIN_PX)
        return QPointF(0.5 * self.width(), 0.5 * self.height()), radius

    def _outline(self, section: int) -> QPolygonF:
        centre, radius = self._disc()
        points = self._shapes.outlines_disc[section]
        return QPolygonF([QPointF(centre.x() + radius * x, centre.y() - radius * y) for x, y in points])

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Sections, angles, marks."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        found = colours()
        if not self._sections:
            painter.setPen(QColor(found.muted))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.rect(), flags, self.tr("Click a panel to see from where it is photographed."))
            return
        for number, section in enumerate(self._sections):
            self._paint_section(painter, number, section)
        self._paint_marks(painter)
        for number, section in enumerate(self._sections):
            self._paint_number(painter, number, section)
        painter.setPen(QColor(found.muted))
        _, radius = self._disc()
        for phi in range(0, 360, 90):
            place = self.place_of(90.0 * (radius + 0.5 * MARGIN_PX) / radius, phi)
            painter.drawText(QRectF(place.x() - 20, place.y() - 10, 40, 20), Qt.AlignmentFlag.AlignCenter, f"{phi}°")
        if self._picked is not None:
            painter.setBrush(Qt.BrushStyle.NoBrush)
            # Dark on light on whatever colour the section has.
            for colour, width_px in ((found.base, 5), (found.text, 2)):
                painter.setPen(QPen(QColor(colour), width_px))
                painter.drawPolygon(self._outline(self._picked))

    def _paint_marks(self, painter: QPainter) -> None:
        found = colours()
        size_px = MARK_PX if len(self._marks) <= MANY_MARKS else SMALL_MARK_PX
        painter.setPen(QPen(QColor(found.base), 1 if size_px == MARK_PX else 0.5))
        painter.setBrush(QColor(found.text))
        for theta_deg, phi_deg in self._marks:
            painter.drawEllipse(self.place_of(theta_deg, phi_deg), size_px, size_px)

    def _paint_section(self, painter: QPainter, number: int, section: ShownSection) -> None:
        found = colours()
        colour, pattern = {
            SectionState.COVERED: (found.covered, Qt.BrushStyle.SolidPattern),
            SectionState.MISSED: (found.open, Qt.BrushStyle.SolidPattern),
            SectionState.UNREACHABLE: (found.unreachable, Qt.BrushStyle.BDiagPattern),
            SectionState.UNDECIDED: (found.undecided, Qt.BrushStyle.Dense4Pattern),
        }[section.state]
        painter.setPen(QPen(QColor(found.base), 1))
        painter.setBrush(QBrush(QColor(colour), pattern))
        painter.drawPolygon(self._outline(number))

    def _paint_number(self, painter: QPainter, number: int, section: ShownSection) -> None:
        """How many views see a section, where the number has room in it."""
        theta_deg = (int(self._shapes.ring[number]) + 0.55) * self._step_deg
        text, (_, radius) = str(section.n_views), self._disc()
        width_px = math.radians(self._step_deg) * radius * theta_deg / 90.0
        if not section.n_views or width_px < painter.fontMetrics().horizontalAdvance(text):
            return
        place = self.place_of(theta_deg, (int(self._shapes.sector[number]) + 0.5) * self._step_deg)
        box = QRectF(place.x() - 14, place.y() - 10, 28, 20)
        painter.setPen(QColor("#ffffff"))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Pick a section."""
        section = self.section_at(event.position())
        if section is not None:
            self.set_picked(section)
            self.sectionPicked.emit(section)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Say what the section under the pointer is."""
        section = self.section_at(event.position())
        QToolTip.showText(
            event.globalPosition().toPoint(), "" if section is None else self._sections[section].tip, self
        )

    def changeEvent(self, event: QEvent) -> None:  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self.update()
