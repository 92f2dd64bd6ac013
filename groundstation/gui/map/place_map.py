"""A small map of where photos were taken and in which direction, around the facades of the site."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.intake import PhotoCard
from planning.site.records import Site

Array = NDArray[np.float64]

BORDER_PX, LOOK_PX, DOT_PX, PICK_PX = 16.0, 13.0, 3.5, 20.0


class PlaceMap(QWidget):
    """Seen from above, north up.

    Signals
    -------
    chosen(int)
        Number of a photo.
    """

    chosen = Signal(int)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._numbers: list[int] = []
        self._places, self._looks = np.zeros((0, 2)), np.zeros((0, 2))
        self._marked: frozenset[int] = frozenset()
        self._walls: list[Array] = []
        self._low, self._high = np.zeros(2), np.ones(2)
        self._chosen = -1
        self.setMinimumHeight(150)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(self.tr("Where the photos were taken"))

    def sizeHint(self) -> QSize:  # noqa: N802
        """Wide enough for a path along a facade."""
        return QSize(260, 200)

    def set_photos(self, cards: tuple[PhotoCard, ...]) -> None:
        """Show photos; those without a pose are left out."""
        posed = [(number, card.posed) for number, card in enumerate(cards) if card.posed is not None]
        self._numbers = [number for number, _ in posed]
        self._places = np.array([photo.pose.position_enu_m[:2] for _, photo in posed]).reshape(-1, 2)
        self._looks = np.array([photo.pose.forward_enu[:2] for _, photo in posed]).reshape(-1, 2)
        self._marked = frozenset(number for number, card in enumerate(cards) if card.marks)
        self._frame()

    def set_site(self, site: Site | None) -> None:
        """Show the facades of a site as lines."""
        facades = () if site is None else [facade for facade in site.facades if facade.panels]
        self._walls = [
            np.array([corner[:2] for panel in facade.panels for corner in panel.corners_enu_m]) for facade in facades
        ]
        self._frame()

    def choose(self, number: int) -> None:
        """Show which photo is chosen."""
        self._chosen = number
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        """Facades, then photos, the chosen one last."""
        painter, look = QPainter(self), colours()
        painter.fillRect(self.rect(), QColor(look.scene))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(QPen(QColor(look.muted), 3))
        for wall in self._walls:
            low, high = _ends(wall)
            painter.drawLine(self._at(low), self._at(high))
        order = sorted(range(len(self._numbers)), key=lambda k: self._numbers[k] == self._chosen)
        for k in order:
            self._paint_photo(painter, k)
        painter.setPen(QColor(look.muted))
        painter.drawText(self.rect().adjusted(6, 4, -6, -4), Qt.AlignmentFlag.AlignTop, self.tr("N \u2191"))
        painter.end()

    def _paint_photo(self, painter: QPainter, k: int) -> None:
        look, number = colours(), self._numbers[k]
        is_chosen = number == self._chosen
        colour = QColor(look.accent if is_chosen else look.warning if number in self._marked else look.ok)
        at, size = self._at(self._places[k]), 1.6 if is_chosen else 1.0
        painter.setPen(QPen(colour, 2.0 * size))
        painter.drawLine(at, at + QPointF(self._looks[k, 0], -self._looks[k, 1]) * LOOK_PX * size)
        painter.setBrush(colour)
        painter.drawEllipse(at, DOT_PX * size, DOT_PX * size)

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        """Choose the nearest photo."""
        apart = [(self._at(place) - event.position()).manhattanLength() for place in self._places]
        if apart and min(apart) <= PICK_PX:
            self.chosen.emit(self._numbers[int(np.argmin(apart))])

    def _frame(self) -> None:
        """What has to be in the picture."""
        shown = np.concatenate([self._places, *self._walls])
        if len(shown):
            self._low, self._high = shown.min(axis=0), shown.max(axis=0)
        self.update()

    def _at(self, place: Array) -> QPointF:
        room = np.array([self.width(), self.height()]) - 2.0 * BORDER_PX
        scale = float((np.maximum(room, 1.0) / np.maximum(self._high - self._low, 1.0)).min())
        off = (place - 0.5 * (self._low + self._high)) * scale
        return QPointF(0.5 * self.width() + float(off[0]), 0.5 * self.height() - float(off[1]))


def _ends(points: Array) -> tuple[Array, Array]:
    """The two points of a wall, seen from above, that are furthest apart along its main direction."""
    middle = points.mean(axis=0)
    direction = np.linalg.svd(points - middle, full_matrices=False)[2][0]
    along = (points - middle) @ direction
    return points[int(along.argmin())], points[int(along.argmax())]
